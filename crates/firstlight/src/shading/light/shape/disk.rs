//! Disks, and what affine maps make of them: sampled by area.

use super::{ShapeSample, box_around};
use crate::geometry::Bounds;
use crate::math::concentric;
use glam::{DAffine3, DVec2, DVec3};
use std::f64::consts::PI;

/// The unit disk in z = 0 under an affine map.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EllipticDisk {
    center: DVec3,
    /// Two half diameters, m: images of the x and y axes.
    across: [DVec3; 2],
    /// Outward unit normal.
    normal: DVec3,
    area: f64,
}

impl EllipticDisk {
    /// The unit disk around the origin, its front up, under `to_world`.
    pub(crate) fn new(to_world: &DAffine3) -> Self {
        let axes = to_world.matrix3;
        let across = [axes.x_axis, axes.y_axis];
        let both = across[0].cross(across[1]) * axes.determinant().signum();
        let area = PI * both.length();
        Self { center: to_world.translation, across, normal: both.normalize(), area }
    }

    /// Every point of the disk is picked alike.
    pub(super) fn sample(&self, from: DVec3, u: DVec2) -> Option<ShapeSample> {
        let place = concentric(u.as_vec2()).as_dvec2();
        let position = self.center + place.x * self.across[0] + place.y * self.across[1];
        ShapeSample::new(from, position, self.normal, self.pdf(from, position))
    }

    pub(super) fn pdf(&self, from: DVec3, position: DVec3) -> f64 {
        let to_light = position - from;
        to_light.length().powi(3) / (self.area * self.normal.dot(to_light).abs())
    }

    pub(super) fn normal(&self) -> DVec3 {
        self.normal
    }

    pub(super) fn bounds(&self) -> Bounds {
        let [u, v] = self.across;
        box_around(self.center, (u * u + v * v).map(f64::sqrt))
    }

    pub(super) fn area(&self) -> f64 {
        self.area
    }
}
