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
use crate::math::{BLOCK, Columns};
use crate::simd::LANES;
use glam::{DVec2, DVec3, Vec2};
use polygon::NearAndFar;
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

/// What a block of points sees of a light.
#[derive(Debug, Clone)]
pub(crate) struct ShapeSamples {
    position: Columns<f64>,
    normal: Columns<f64>,
    incoming: Columns<f64>,
    distance: [f64; BLOCK],
    pdf: [f64; BLOCK],
}

impl Default for ShapeSamples {
    fn default() -> Self {
        let [position, normal, incoming] = std::array::from_fn(|_| Columns::default());
        Self { position, normal, incoming, distance: [0.0; BLOCK], pdf: [0.0; BLOCK] }
    }
}

impl ShapeSamples {
    /// Nothing is seen by those who would see the back.
    #[inline(always)]
    pub(crate) fn hide_backs(&mut self) {
        for k in 0..BLOCK {
            let front = self.normal.get(k).dot(self.incoming.get(k)) < 0.0;
            self.pdf[k] = if front { self.pdf[k] } else { 0.0 };
        }
    }

    /// What point `k` sees; `None` if that is nothing.
    #[inline(always)]
    pub(crate) fn get(&self, k: usize) -> Option<ShapeSample> {
        (self.pdf[k] > 0.0).then(|| self.row(k))
    }

    /// The density of what point `k` sees, sr⁻¹; `None` if that is nothing.
    #[inline(always)]
    pub(crate) fn pdf(&self, k: usize) -> Option<f64> {
        (self.pdf[k] > 0.0).then_some(self.pdf[k])
    }

    /// What point `k` sees, which means nothing where the density is 0.
    #[inline(always)]
    pub(crate) fn row(&self, k: usize) -> ShapeSample {
        ShapeSample {
            position: self.position.get(k),
            normal: self.normal.get(k),
            incoming: self.incoming.get(k),
            distance: self.distance[k],
            pdf: self.pdf[k],
        }
    }

    #[inline(always)]
    fn set(&mut self, k: usize, sample: Option<ShapeSample>) {
        let sample = sample.unwrap_or(ShapeSample::NOTHING);
        self.position.set(k, sample.position);
        self.normal.set(k, sample.normal);
        self.incoming.set(k, sample.incoming);
        self.distance[k] = sample.distance;
        self.pdf[k] = sample.pdf;
    }
}

/// What the first `count` points of a block see of a flat shape: of all as if from afar, then of those that are near.
#[inline(always)]
fn sample_flat(
    shape: &impl NearAndFar,
    from: &Columns<f64>,
    u: &[Vec2; BLOCK],
    count: usize,
    into: &mut ShapeSamples,
) {
    let (mut near, mut nears, mut far) = ([0; BLOCK], 0, [false; BLOCK]);
    for (k, u) in u.iter().enumerate() {
        into.set(k, shape.sample_afar(from.get(k), u.as_dvec2()));
    }
    for (k, far) in far.iter_mut().enumerate() {
        *far = shape.is_far(from.get(k));
    }
    for (k, &far) in far[..count].iter().enumerate() {
        near[nears % BLOCK] = k;
        nears += usize::from(!far);
    }
    if nears == 0 {
        return;
    }
    // Side by side, so that they are looked at several at a time too; so many that none are left over.
    let (mut side_by_side, mut samples) = (Places::default(), ShapeSamples::default());
    for (i, &k) in near[..nears].iter().enumerate() {
        side_by_side.set(i, from.get(k), u[k]);
    }
    for i in 0..nears.next_multiple_of(LANES).min(BLOCK) {
        let (from, u) = side_by_side.get(i);
        samples.set(i, shape.sample_near(from, u.as_dvec2()));
    }
    for (i, &k) in near[..nears].iter().enumerate() {
        into.set(k, samples.get(i));
    }
}

/// From where a block of points looks, and by which two numbers in 0..1.
struct Places {
    from: Columns<f64>,
    u: [Vec2; BLOCK],
}

impl Default for Places {
    #[inline(always)]
    fn default() -> Self {
        Self { from: Columns::default(), u: [Vec2::ZERO; BLOCK] }
    }
}

impl Places {
    #[inline(always)]
    fn get(&self, k: usize) -> (DVec3, Vec2) {
        (self.from.get(k), self.u[k])
    }

    #[inline(always)]
    fn set(&mut self, k: usize, from: DVec3, u: Vec2) {
        self.from.set(k, from);
        self.u[k] = u;
    }
}

impl LightShape {
    /// What the first `count` points of a block see, as [`LightShape::sample`] says, each by its own two numbers.
    #[inline(always)]
    pub(crate) fn sample_all(
        &self,
        from: &Columns<f64>,
        u: &[Vec2; BLOCK],
        count: usize,
        into: &mut ShapeSamples,
    ) {
        match self {
            Self::Parallelogram(shape) => sample_flat(shape, from, u, count, into),
            Self::Triangle(shape) => sample_flat(shape, from, u, count, into),
            _ => {
                for (k, u) in u[..count].iter().enumerate() {
                    into.set(k, self.sample(from.get(k), u.as_dvec2()));
                }
            }
        }
    }

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
    /// Nothing is seen.
    const NOTHING: Self = Self {
        position: DVec3::ZERO,
        normal: DVec3::ZERO,
        incoming: DVec3::ZERO,
        distance: 0.0,
        pdf: 0.0,
    };

    /// `None` if the density is no positive number, as at a point of the light itself or in its plane, or if the light
    /// is too thin to have a normal.
    #[inline(always)]
    fn new(from: DVec3, position: DVec3, normal: DVec3, pdf: f64) -> Option<Self> {
        let to_light = position - from;
        let distance = to_light.length();
        // Comparisons, which loops over blocks can make several at a time.
        let length2 = normal.length_squared();
        let has_normal = length2 > 0.0 && length2 < f64::INFINITY;
        let usable = pdf > 0.0 && pdf < f64::INFINITY && distance > 0.0 && has_normal;
        let incoming = to_light / distance;
        usable.then_some(Self { position, normal, incoming, distance, pdf })
    }
}
