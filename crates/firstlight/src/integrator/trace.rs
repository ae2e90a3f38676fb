//! The lecture's `scene.trace(ray, tMin, tMax)`.

use super::{Direct, Scratch};
use crate::color::Rgb;
use crate::geometry::Ray;
use crate::scene::Scene;

impl Scene {
    /// Radiance that arrives along `ray` from the nearest surface between `t_min` (exclusive) and `t_max` (m), or
    /// from the background, W·sr⁻¹·m⁻². The same stages as a render, with a batch of one.
    pub fn trace(&self, ray: &Ray, t_min: f32, t_max: f32) -> Rgb {
        let mut scratch = Scratch::default();
        Direct::new(self, false).gather(&[Ray { t_min, t_max, ..*ray }], &mut scratch);
        scratch.samples[0].radiance
    }
}
