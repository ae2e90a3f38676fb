//! The light meter: irradiance at a point that need not be on a surface.

use crate::color::Rgb;
use crate::scene::{Scene, StopsLight};
use crate::shading::interaction::clearance;
use glam::DVec3;
use std::f32::consts::PI;

impl Scene {
    /// Irradiance at `point` (m) on a surface facing the unit direction `normal`: Σ over lights of E · cos θ, shadows
    /// included, plus π times the ambient radiance, W·m⁻² per channel.
    pub fn irradiance(&self, point: DVec3, normal: DVec3) -> Rgb {
        let (position, normal) = (point.as_vec3(), normal.as_vec3());
        let origin = position + clearance(normal, position.abs(), 0.0) * normal;
        let mut sum = PI * self.ambient;
        for light in &self.lights {
            let Some(sample) = light.sample(point) else { continue };
            let cos = normal.dot(sample.incoming);
            let ray = sample.ray_from(position, origin, 0.0);
            let mut occluded = Vec::new();
            if cos > 0.0 && light.shadows {
                self.world.occluded(&[ray], &StopsLight(self), &mut occluded);
            }
            if cos > 0.0 && occluded != [true] {
                sum += sample.irradiance * cos;
            }
        }
        sum
    }
}
