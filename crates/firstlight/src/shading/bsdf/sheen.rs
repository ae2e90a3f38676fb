//! The soft rim of cloth: fibres that stand up.

use super::diffuse::cosine_weighted;
use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_1_PI, TAU};

/// Estevez & Kulla, *Production Friendly Microfacet Sheen BRDF*, 2017, as KHR_materials_sheen prescribes it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sheen {
    /// roughness², at least [`Sheen::LEAST`].
    pub alpha: f32,
}

impl Sheen {
    /// What is narrower is taken as this.
    pub(crate) const LEAST: f32 = 0.0225;

    /// The BRDF of a white sheen, sr⁻¹, of two directions of the upper hemisphere.
    pub(crate) fn value(&self, outgoing: Vec3, incoming: Vec3) -> f32 {
        let m = (outgoing + incoming).normalize_or(Vec3::Z);
        let inverse = 1.0 / self.alpha;
        let sin2 = (1.0 - m.z * m.z).max(0.0);
        let density = (2.0 + inverse) * sin2.powf(0.5 * inverse) / TAU;
        let hidden = 1.0 + self.lambda(outgoing.z) + self.lambda(incoming.z);
        density / (4.0 * outgoing.z * incoming.z * hidden)
    }

    fn lambda(&self, cos: f32) -> f32 {
        if cos < 0.5 {
            self.fitted(cos).exp()
        } else {
            (2.0 * self.fitted(0.5) - self.fitted(1.0 - cos)).exp()
        }
    }

    fn fitted(&self, x: f32) -> f32 {
        let smooth = (1.0 - self.alpha) * (1.0 - self.alpha);
        let mix = |rough: f32, fine: f32| rough + (fine - rough) * smooth;
        let (a, b, c) = (mix(21.5473, 25.3245), mix(3.82987, 3.32435), mix(0.19823, 0.16801));
        let (d, e) = (mix(-1.9776, -1.27393), mix(-4.32054, -4.85967));
        a / (1.0 + b * x.powf(c)) + d * x + e
    }

    /// Density of [`Sheen::sample`], sr⁻¹.
    pub(crate) fn pdf(incoming: Vec3) -> f32 {
        0.5 * (incoming.z * FRAC_1_PI + 1.0 / TAU)
    }

    /// A direction, half of the time by its cosine.
    pub(crate) fn sample(u: Vec2) -> Vec3 {
        if u.x < 0.5 {
            return cosine_weighted(Vec2::new(2.0 * u.x, u.y));
        }
        let z = 2.0 * u.x - 1.0;
        let across = (1.0 - z * z).max(0.0).sqrt();
        let (sin, cos) = (TAU * u.y).sin_cos();
        Vec3::new(across * cos, across * sin, z)
    }
}
