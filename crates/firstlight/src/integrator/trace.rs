//! The lecture's `scene.trace(ray, tMin, tMax)`.

use super::Gatherer;
use crate::color::Rgb;
use crate::geometry::{Hit, Ray};
use crate::sampler::Sampler;
use crate::scene::{Scene, SeenByCamera, StopsLight};

impl Scene {
    /// Radiance that arrives along `ray` from the nearest surface between `t_min` (exclusive) and `t_max` (m), or
    /// from the background, W·sr⁻¹·m⁻². The same stages as a render, with a batch of one; where chance decides, one
    /// sample.
    pub fn trace(&self, ray: &Ray, t_min: f32, t_max: f32) -> Rgb {
        let ray = Ray { t_min, t_max, ..*ray };
        let points = Sampler::new(self.film().seed, 1).points(0, 0, 0);
        Gatherer::default().gather_alone(self, &[ray], &[points])[0].radiance
    }

    /// What each ray hits first, in its range, as a camera would see it. Rays that lie close to each other and in
    /// order are answered fastest, in batches of thousands.
    pub fn closest_hits(&self, rays: &[Ray], hits: &mut Vec<Hit>) {
        self.world.closest_hits(rays, &SeenByCamera(self, 0), hits);
    }

    /// Whether each ray meets anything in its range that stops light.
    pub fn occluded(&self, rays: &[Ray], occluded: &mut Vec<bool>) {
        self.world.occluded(rays, &StopsLight(self, 0), occluded);
    }
}
