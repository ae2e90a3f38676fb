//! A path up to its last ray.

use crate::color::Rgb;
use crate::geometry::{Cone, Hit, Ray};
use crate::integrator::Source;
use crate::integrator::media::{Crossing, Media};
use crate::integrator::record::{Followed, Gain};
use crate::scene::Scene;
use crate::shading::interaction::SurfaceInteraction;
use glam::Vec3;

/// A path up to its last ray.
#[derive(Clone, Copy)]
pub(super) struct Walk {
    /// Index of the camera ray.
    pub(super) sample: u32,
    /// What the light along the last ray is multiplied by on its way to the eye.
    pub(super) throughput: Rgb,
    /// Density with which the last direction was picked, sr⁻¹; infinite if there was no other.
    pub(super) pdf: f32,
    /// The reflection at which it was picked.
    pub(super) bounce: u32,
    /// How often it was scattered, straight on not counted.
    pub(super) reflections: u32,
    /// Where it was picked, m, and where lights had to be there (see
    /// [`Bsdf::horizon`](crate::shading::bsdf::Bsdf::horizon)): panes that were passed since do not count.
    pub(super) from: Vec3,
    pub(super) normal: Vec3,
    /// Whether only mirrors and clear glass lie between the eye and the last ray.
    pub(super) sharp_only: bool,
    /// The solids that it is in.
    pub(super) media: Media,
    /// The colour channel that it is followed for, once glass has torn colours apart.
    pub(super) channel: Option<u8>,
    /// The cone around the last ray.
    pub(super) cone: Cone,
    /// When all this is, see [`Ray::time`].
    pub(super) time: f32,
}

impl Walk {
    pub(super) fn from_eye(sample: u32, time: f32) -> Self {
        Self {
            sample,
            throughput: Rgb::ONE,
            pdf: f32::INFINITY,
            bounce: 0,
            reflections: 0,
            from: Vec3::ZERO,
            normal: Vec3::ZERO,
            sharp_only: true,
            media: Media::default(),
            channel: None,
            cone: Cone::default(),
            time,
        }
    }

    /// Where the last ray met a surface of a solid: what is before it and beyond. `channel`, in 0..1, picks a colour channel
    /// if it takes one.
    #[inline(always)]
    pub(super) fn cross(
        &mut self,
        scene: &Scene,
        surface: &SurfaceInteraction,
        channel: impl FnOnce() -> f32,
    ) -> Option<Crossing> {
        if !scene.has_solids {
            return None;
        }
        let interior = scene.material(&surface.hit).interior?;
        if interior.dispersion > 0.0 && self.channel.is_none() {
            self.follow_channel(channel());
        }
        let material = scene.material_of[surface.hit.surface as usize];
        let crossing = self.media.cross(scene, material, surface.front, self.channel);
        self.media = crossing.before;
        Some(crossing)
    }

    /// Turns aside at the reflection with this number, where rays start at `from` and lights have to be on the side of `normal`,
    /// if it is not 0; the density of the direction is `pdf`, sr⁻¹, and the spread that it stands for `part`.
    #[inline(always)]
    pub(super) fn scatter(&mut self, bounce: u32, pdf: f32, part: f32, [from, normal]: [Vec3; 2]) {
        (self.pdf, self.bounce, self.from, self.normal) = (pdf, bounce, from, normal);
        self.cone = self.cone.scattered(part);
        self.reflections += 1;
    }

    /// Light of `radiance` that comes along the last ray from what it met.
    #[inline(always)]
    pub(super) fn gain(&self, bounce: u32, source: Source, radiance: Rgb) -> Gain {
        let Self { sample, reflections, throughput, .. } = *self;
        let radiance = throughput * radiance;
        Gain { sample, source, bounce, reflections, asked: false, radiance }
    }

    /// The same for light that what it met reflects.
    #[inline(always)]
    pub(super) fn reflected(&self, bounce: u32, source: Source, radiance: Rgb) -> Gain {
        Gain { reflections: self.reflections + 1, ..self.gain(bounce, source, radiance) }
    }

    /// The last ray, and what it met.
    #[inline(always)]
    pub(super) fn along(&self, bounce: u32, ray: &Ray, hit: &Hit) -> Followed {
        let Self { sample, throughput, cone, .. } = *self;
        let width = cone.after(hit.t).width;
        Followed { sample, bounce, ray: *ray, hit: *hit, throughput, width }
    }

    /// Goes on for one of the three channels, picked by a number in 0..1.
    pub(super) fn follow_channel(&mut self, u: f32) {
        let channel = ((3.0 * u) as u8).min(2);
        self.throughput *= 3.0 * Rgb::AXES[usize::from(channel)];
        self.channel = Some(channel);
    }
}
