//! Which hits count: holes in materials, and surfaces that are seen from one side only.

use super::Scene;
use super::description::Alpha;
use crate::geometry::{Hit, Ray};
use crate::kernels::{HitFilter, ONE_SIDED, PARTLY_THERE};
use crate::math::hash;

/// Camera rays: they pass through holes, through the backs of one-sided surfaces and through what is invisible. The number tells repetitions of
/// a ray apart where chance decides.
pub(crate) struct SeenByCamera<'a>(pub &'a Scene, pub u32);

/// Rays for data of what is seen: as those of the camera, but they pass through what only bounds a medium as well.
pub(crate) struct Solid<'a>(pub &'a Scene);

/// Rays from surface to surface: they pass through holes only. The number is that of [`SeenByCamera`].
pub(crate) struct Meets<'a>(pub &'a Scene, pub u32);

/// Shadow rays: they pass through holes, panes and what bounds a medium without bending light. The number is that of [`SeenByCamera`].
pub(crate) struct StopsLight<'a>(pub &'a Scene, pub u32);

/// Whatever there is, seen or not.
pub(crate) struct Everything;

/// What shadow rays pass through.
pub(crate) struct OnlyPanes<'a>(pub &'a Scene, pub u32);

impl HitFilter for SeenByCamera<'_> {
    fn flags(&self) -> u32 {
        ONE_SIDED | PARTLY_THERE
    }

    fn accepts(&self, ray: &Ray, hit: &Hit, from_behind: bool) -> bool {
        let scene = self.0;
        let material = scene.material(hit);
        material.visible
            && (material.double_sided || !scene.is_back(hit, from_behind))
            && scene.is_there(ray, hit, self.1)
    }
}

impl HitFilter for Solid<'_> {
    fn flags(&self) -> u32 {
        ONE_SIDED | PARTLY_THERE
    }

    fn accepts(&self, ray: &Ray, hit: &Hit, from_behind: bool) -> bool {
        !self.0.material(hit).only_bounds()
            && SeenByCamera(self.0, 0).accepts(ray, hit, from_behind)
    }
}

impl HitFilter for Meets<'_> {
    fn flags(&self) -> u32 {
        PARTLY_THERE
    }

    fn accepts(&self, ray: &Ray, hit: &Hit, _: bool) -> bool {
        self.0.is_there(ray, hit, self.1)
    }
}

impl HitFilter for StopsLight<'_> {
    fn flags(&self) -> u32 {
        PARTLY_THERE
    }

    fn accepts(&self, ray: &Ray, hit: &Hit, _: bool) -> bool {
        !self.0.material(hit).passes_light() && self.0.is_there(ray, hit, self.1)
    }
}

impl HitFilter for OnlyPanes<'_> {
    fn flags(&self) -> u32 {
        // Others do not stand in the way of rays that reach their light.
        PARTLY_THERE
    }

    fn accepts(&self, ray: &Ray, hit: &Hit, _: bool) -> bool {
        self.0.material(hit).passes_light() && self.0.is_there(ray, hit, self.1)
    }
}

impl HitFilter for Everything {
    fn flags(&self) -> u32 {
        0
    }

    fn accepts(&self, _: &Ray, _: &Hit, _: bool) -> bool {
        true
    }
}

impl Scene {
    /// Whether the surface is there at a hit, by the alpha of its material.
    fn is_there(&self, ray: &Ray, hit: &Hit, repetition: u32) -> bool {
        let material = self.material(hit);
        let alpha = || self.alpha(material, &self.interaction(ray, hit));
        match material.alpha {
            Alpha::Opaque => true,
            Alpha::Mask { cutoff } => alpha() >= cutoff,
            Alpha::Blend => alpha() > threshold(ray, hit, repetition),
        }
    }
}

/// A number in 0..1 that depends on nothing but the ray, its time, its repetition and what it hit.
fn threshold(ray: &Ray, hit: &Hit, repetition: u32) -> f32 {
    let bits = |x: f32| u64::from(x.to_bits());
    let (o, d) = (ray.origin, ray.direction);
    let words = [
        bits(o.x) << 32 | bits(o.y),
        bits(o.z) << 32 | bits(d.x),
        bits(d.y) << 32 | bits(d.z),
        (u64::from(hit.surface) << 32 | u64::from(hit.primitive)) ^ bits(ray.time) << 16,
    ];
    (words.into_iter().fold(u64::from(repetition), |state, word| hash(state ^ word)) >> 40) as f32
        / (1 << 24) as f32
}
