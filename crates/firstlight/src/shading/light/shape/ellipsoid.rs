//! Spheres, and what affine maps make of them: sampled by the cone that they fill.

use super::{ShapeSample, box_around};
use crate::geometry::Bounds;
use crate::math::tangents;
use glam::{DAffine3, DMat3, DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// The unit sphere under an affine map.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ellipsoid {
    center: DVec3,
    /// From the unit sphere to the world, without the shift.
    axes: DMat3,
    /// Its inverse.
    to_unit: DMat3,
    /// How many times a volume grows from the world to the space of the unit sphere.
    growth: f64,
}

impl Ellipsoid {
    /// The unit sphere around the origin under `to_world`.
    pub(crate) fn new(to_world: &DAffine3) -> Self {
        let axes = to_world.matrix3;
        let growth = 1.0 / axes.determinant().abs();
        Self { center: to_world.translation, axes, to_unit: axes.inverse(), growth }
    }

    /// Every direction that meets it is picked alike if it is a sphere; of an ellipsoid, in the space of its sphere.
    pub(crate) fn sample(&self, from: DVec3, u: DVec2) -> Option<ShapeSample> {
        let eye = self.to_unit * (from - self.center);
        let outward =
            if eye.length_squared() > 1.0 { from_outside(eye, u) } else { inside(eye, u) };
        let position = self.center + self.axes * outward;
        let normal = (self.to_unit.transpose() * outward).normalize();
        ShapeSample::new(from, position, normal, self.pdf(from, position))
    }

    pub(super) fn pdf(&self, from: DVec3, position: DVec3) -> f64 {
        let (eye, at) =
            (self.to_unit * (from - self.center), self.to_unit * (position - self.center));
        let is_outside = eye.length_squared() > 1.0;
        if is_outside && at.dot(at - eye) >= 0.0 {
            return 0.0;
        }
        let steradians = if is_outside { TAU * cone(eye).1 } else { 4.0 * PI };
        // Solid angles grow by the volume over the cube of the length.
        let shrinking = from.distance(position) / eye.distance(at);
        self.growth * shrinking.powi(3) / steradians
    }

    pub(super) fn bounds(&self) -> Bounds {
        let rows = self.axes.transpose();
        let half = DVec3::new(rows.x_axis.length(), rows.y_axis.length(), rows.z_axis.length());
        box_around(self.center, half)
    }

    /// By midpoints of equal parts of the sphere; no error for spheres, below 0.1 % for half axes of ratio 1 : 5.
    pub(super) fn area(&self) -> f64 {
        const ROWS: u32 = 64;
        let middle = |i: u32| (f64::from(i) + 0.5) / f64::from(ROWS);
        let stretch = |u: DVec2| (self.to_unit.transpose() * on_sphere(u)).length();
        let row = |i: u32| (0..ROWS).map(move |j| DVec2::new(middle(i), middle(j)));
        let mean = (0..ROWS).flat_map(row).map(stretch).sum::<f64>() / f64::from(ROWS * ROWS);
        4.0 * PI * mean / self.growth
    }
}

/// A point of the unit sphere as `eye` outside sees it, each direction alike. Akalin, *Sampling the Visible Sphere*,
/// 2015: the angle at the centre follows from that at the eye without a ray that could miss.
fn from_outside(eye: DVec3, u: DVec2) -> DVec3 {
    let (d, one_minus_cos_max) = cone(eye);
    let one_minus_cos = u.x * one_minus_cos_max;
    let (cos, sin2) = (1.0 - one_minus_cos, one_minus_cos * (2.0 - one_minus_cos));
    let half_chord = (1.0 - sin2 * d * d).max(0.0).sqrt();
    let cos_at_center = sin2 * d + cos * half_chord;
    let sin_at_center = sin2.sqrt() * (d * cos - half_chord);
    let axis = eye / d;
    let (tangent, bitangent) = tangents(axis);
    let (sin_phi, cos_phi) = (TAU * u.y).sin_cos();
    let outward = cos_at_center * axis + sin_at_center * (cos_phi * tangent + sin_phi * bitangent);
    outward.normalize()
}

/// Where a ray from `eye` inside the unit sphere in any direction, all alike, leaves it.
fn inside(eye: DVec3, u: DVec2) -> DVec3 {
    let direction = on_sphere(u);
    let b = eye.dot(direction);
    let t = (b * b + (1.0 - eye.length_squared()).max(0.0)).sqrt() - b;
    (eye + t * direction).normalize()
}

/// Distance of `eye` from the centre of the unit sphere, and 1 − cos of the half angle of the cone that the sphere
/// fills there, without the cancellation that spheres far away suffer from.
fn cone(eye: DVec3) -> (f64, f64) {
    let d = eye.length();
    let cos = ((d - 1.0).max(0.0) * (d + 1.0)).sqrt() / d;
    (d, 1.0 / (d * d * (1.0 + cos)))
}

/// A point of the unit sphere, each alike.
fn on_sphere(u: DVec2) -> DVec3 {
    let z = 1.0 - 2.0 * u.x;
    let (sin, cos) = (TAU * u.y).sin_cos();
    let r = (1.0 - z * z).max(0.0).sqrt();
    DVec3::new(r * cos, r * sin, z)
}
