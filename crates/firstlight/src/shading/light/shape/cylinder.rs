//! The side of a cylinder, and what affine maps make of it: sampled by the part that faces the eye.

use super::{ShapeSample, box_around};
use crate::geometry::Bounds;
use glam::{DAffine3, DMat3, DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// The side x² + y² = 1, 0 ≤ z ≤ 1, under an affine map.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CylinderSide {
    base: DVec3,
    /// From the unit cylinder to the world, without the shift.
    axes: DMat3,
    /// Its inverse.
    to_unit: DMat3,
}

impl CylinderSide {
    /// The unit side under `to_world`.
    pub(crate) fn new(to_world: &DAffine3) -> Self {
        let axes = to_world.matrix3;
        Self { base: to_world.translation, axes, to_unit: axes.inverse() }
    }

    /// Angle and height are picked alike: from outside on the half that shows its outside, from inside all around.
    pub(super) fn sample(&self, from: DVec3, u: DVec2) -> Option<ShapeSample> {
        let (middle, half_width) = self.facing(from);
        let around = DVec2::from_angle(middle + half_width * (2.0 * u.x - 1.0));
        let position = self.base + self.axes * around.extend(u.y);
        let normal = (self.to_unit.transpose() * around.extend(0.0)).normalize();
        ShapeSample::new(from, position, normal, self.pdf(from, position))
    }

    pub(super) fn pdf(&self, from: DVec3, position: DVec3) -> f64 {
        let (_, half_width) = self.facing(from);
        let around = (self.to_unit * (position - self.base)).truncate().normalize();
        let outward = self.outward(around);
        let to_light = position - from;
        let cos_times_area = outward.dot(to_light);
        // From outside, only the outside is picked.
        if half_width < PI && cos_times_area >= 0.0 {
            return 0.0;
        }
        to_light.length().powi(3) / (2.0 * half_width * cos_times_area.abs())
    }

    pub(super) fn bounds(&self) -> Bounds {
        let DMat3 { x_axis: u, y_axis: v, z_axis: up } = self.axes;
        let half = (u * u + v * v).map(f64::sqrt);
        box_around(self.base, half).union(box_around(self.base + up, half))
    }

    /// Its area by midpoints all around, which is exact for round cylinders.
    pub(super) fn area(&self) -> f64 {
        const PARTS: u32 = 256;
        let angle = |i: u32| TAU * f64::from(i) / f64::from(PARTS);
        let width = |i: u32| self.outward(DVec2::from_angle(angle(i))).length();
        TAU * (0..PARTS).map(width).sum::<f64>() / f64::from(PARTS)
    }

    /// The part of the side whose outside `from` sees: the angle in its middle and half its width, rad.
    fn facing(&self, from: DVec3) -> (f64, f64) {
        let eye = (self.to_unit * (from - self.base)).truncate();
        let cos = eye.length().recip();
        if cos < 1.0 { (eye.to_angle(), cos.acos()) } else { (0.0, PI) }
    }

    /// The outward normal at `around`, as long as the area per angle and height.
    fn outward(&self, around: DVec2) -> DVec3 {
        let along = (self.axes * around.perp().extend(0.0)).cross(self.axes.z_axis);
        along * self.axes.determinant().signum()
    }
}
