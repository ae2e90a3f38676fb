//! Lights that have a shape: where one point sees them, and with which density chance picks a direction there.
//!
//! Everything is in double precision and in metres. `sample` turns two numbers in 0..1 into a point of the light, as
//! evenly over what is seen as the shape allows; `pdf` is the same density asked the other way round, for a point
//! that a ray met. Neither knows what stands in between.

mod cylinder;
mod disk;
mod ellipsoid;
mod polygon;
#[cfg(test)]
mod tests;

pub(crate) use cylinder::CylinderSide;
pub(crate) use disk::EllipticDisk;
pub(crate) use ellipsoid::Ellipsoid;
pub(crate) use polygon::{Parallelogram, Triangle};

use super::tree::EmissionCone;
use crate::geometry::Bounds;
use glam::{DVec2, DVec3};
use std::f64::consts::FRAC_1_PI;

/// The shape of a light in the world.
#[derive(Debug, Clone, Copy)]
pub(crate) enum LightShape {
    /// A sphere, or what an affine map makes of it.
    Ellipsoid(Ellipsoid),
    /// A flat disk, or what an affine map makes of it.
    Disk(EllipticDisk),
    /// A parallelogram.
    Parallelogram(Parallelogram),
    /// A triangle.
    Triangle(Triangle),
    /// The round side of a cylinder.
    CylinderSide(CylinderSide),
}

/// A point of a light as seen from another point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ShapeSample {
    /// Where it is, m.
    pub position: DVec3,
    /// Outward unit normal of the light there.
    pub normal: DVec3,
    /// Unit vector to it.
    pub incoming: DVec3,
    /// How far it is, m.
    pub distance: f64,
    /// Density of `incoming`, sr⁻¹.
    pub pdf: f64,
}

impl LightShape {
    /// A point of the light that `from` may see, picked by two numbers in 0..1; `None` if the light has no extent
    /// from there.
    pub(crate) fn sample(&self, from: DVec3, u: DVec2) -> Option<ShapeSample> {
        match self {
            Self::Ellipsoid(shape) => shape.sample(from, u),
            Self::Disk(shape) => shape.sample(from, u),
            Self::Parallelogram(shape) => shape.sample(from, u),
            Self::Triangle(shape) => shape.sample(from, u),
            Self::CylinderSide(shape) => shape.sample(from, u),
        }
    }

    /// Density with which [`LightShape::sample`] picks the direction from `from` to the point `position` of the
    /// light, which a ray from there met first, sr⁻¹.
    pub(crate) fn pdf(&self, from: DVec3, position: DVec3) -> f64 {
        match self {
            Self::Ellipsoid(shape) => shape.pdf(from, position),
            Self::Disk(shape) => shape.pdf(from, position),
            Self::Parallelogram(shape) => shape.pdf(from, position),
            Self::Triangle(shape) => shape.pdf(from, position),
            Self::CylinderSide(shape) => shape.pdf(from, position),
        }
    }

    /// A box around it, and where it shines to.
    pub(crate) fn extent(&self, two_sided: bool) -> (Bounds, EmissionCone) {
        let flat = |normal: DVec3| EmissionCone::flat(normal.as_vec3(), two_sided);
        match self {
            Self::Ellipsoid(shape) => (shape.bounds(), EmissionCone::EVERYWHERE),
            Self::Disk(shape) => (shape.bounds(), flat(shape.normal())),
            Self::Parallelogram(shape) => (shape.bounds(), flat(shape.normal())),
            Self::Triangle(shape) => (shape.bounds(), flat(shape.normal())),
            Self::CylinderSide(shape) => (shape.bounds(), EmissionCone::EVERYWHERE),
        }
    }

    /// The largest area that it shows to any side, m².
    pub(crate) fn widest(&self) -> f64 {
        match self {
            Self::Ellipsoid(shape) => 0.25 * shape.area(),
            Self::CylinderSide(shape) => shape.area() * FRAC_1_PI,
            _ => self.area(),
        }
    }

    /// Its area, one side, m².
    pub(crate) fn area(&self) -> f64 {
        match self {
            Self::Ellipsoid(shape) => shape.area(),
            Self::Disk(shape) => shape.area(),
            Self::Parallelogram(shape) => shape.area(),
            Self::Triangle(shape) => shape.area(),
            Self::CylinderSide(shape) => shape.area(),
        }
    }
}

/// A box around what reaches from `center` to `half` away along each axis.
fn box_around(center: DVec3, half: DVec3) -> Bounds {
    Bounds { lo: (center - half).as_vec3(), hi: (center + half).as_vec3() }
}

impl ShapeSample {
    /// `None` if the density is no positive number, as at a point of the light itself or in its plane, or if the light
    /// is too thin to have a normal.
    #[inline(always)]
    fn new(from: DVec3, position: DVec3, normal: DVec3, pdf: f64) -> Option<Self> {
        let to_light = position - from;
        let distance = to_light.length();
        let usable = pdf > 0.0 && pdf.is_finite() && distance > 0.0 && normal.is_finite();
        let incoming = to_light / distance;
        usable.then_some(Self { position, normal, incoming, distance, pdf })
    }
}
