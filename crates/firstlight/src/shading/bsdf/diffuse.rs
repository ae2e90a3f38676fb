//! Light that is scattered in a rough, pale ground.

use super::Frame;
use crate::color::Rgb;
use crate::math::concentric;
use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_1_PI, PI, TAU};

/// A direction of the upper hemisphere in proportion to its cosine: points of a disk, lifted onto the hemisphere above
/// (Malley).
#[inline(always)]
pub(crate) fn cosine_weighted(u: Vec2) -> Vec3 {
    let radius = (2.0 * u - 1.0).abs().max_element();
    concentric(u).extend(((1.0 - radius) * (1.0 + radius)).sqrt())
}

/// A matte surface and nothing else, in the world: the lecture's k_d = R_d / π. Without a branch or a call, so that loops over
/// many of them work on several at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Matte {
    /// Unit normal on the side of the eye.
    pub normal: Vec3,
    /// The fraction of light that it reflects, 0..1.
    pub reflectance: Rgb,
}

impl Matte {
    /// BSDF × cosine of `incoming`, sr⁻¹, and the density with which [`Matte::sample`] picks it, sr⁻¹.
    #[inline(always)]
    pub(crate) fn eval(&self, incoming: Vec3) -> (Rgb, f32) {
        let density = incoming.dot(self.normal).max(0.0) * FRAC_1_PI;
        (self.reflectance * density, density)
    }

    /// A direction in proportion to its cosine, and its density, sr⁻¹. What comes from there counts as much as the reflectance.
    #[inline(always)]
    pub(crate) fn sample(&self, u: Vec2) -> (Vec3, f32) {
        Frame::around(self.normal).cosine_weighted(u)
    }
}

/// The energy-preserving Oren–Nayar model: a matte surface of many small matte facets.
///
/// Portsmouth, Kutz, Hill, *EON: A Practical Energy-Preserving Rough Diffuse BRDF*, JCGT 14(1), 2025.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Eon {
    /// What a flat piece of the ground reflects, 0..1.
    pub color: Rgb,
    /// 0 (Lambert) to 1.
    pub roughness: f32,
}

/// ½ − 2/3π and ⅔ − 28/15π of the paper.
const C1: f32 = 0.5 - 2.0 / (3.0 * PI);
const C2: f32 = 2.0 / 3.0 - 28.0 / (15.0 * PI);

impl Eon {
    /// The BRDF, sr⁻¹, of two directions of the upper hemisphere.
    pub(crate) fn value(&self, outgoing: Vec3, incoming: Vec3) -> Rgb {
        let r = self.roughness;
        let s = outgoing.dot(incoming) - outgoing.z * incoming.z;
        let ratio = if s > 0.0 { s / outgoing.z.max(incoming.z) } else { s };
        let once = self.color * (FRAC_1_PI * a(r) * (1.0 + r * ratio));
        let lost = |cos: f32| (1.0 - single_albedo(cos, r)).max(0.0);
        let lost_on_average = (1.0 - mean_albedo(r)).max(1e-7);
        let many = lost(outgoing.z) * lost(incoming.z) / (PI * lost_on_average);
        once + self.many_times() * many
    }

    /// The fraction of light from (or to) a direction with this cosine that is reflected.
    pub(crate) fn albedo(&self, cos: f32) -> Rgb {
        let once = single_albedo(cos, self.roughness);
        self.color * once + self.many_times() * (1.0 - once).max(0.0)
    }

    /// What becomes of light that strikes more than one facet.
    fn many_times(&self) -> Rgb {
        let mean = mean_albedo(self.roughness);
        self.color * self.color * mean / (1.0 - self.color * (1.0 - mean))
    }

    /// Density of [`Eon::sample`], sr⁻¹.
    pub(crate) fn pdf(&self, outgoing: Vec3, incoming: Vec3) -> f32 {
        let uniform = self.uniform_share(outgoing);
        (1.0 - uniform) * incoming.z * FRAC_1_PI + uniform / TAU
    }

    /// A direction by the cosine, or, where grazing light is sent back strongly, by nothing.
    pub(crate) fn sample(&self, outgoing: Vec3, u: Vec2) -> Vec3 {
        let uniform = self.uniform_share(outgoing);
        if u.x >= uniform {
            return cosine_weighted(Vec2::new((u.x - uniform) / (1.0 - uniform), u.y));
        }
        let z = u.x / uniform;
        let (sin, cos) = (TAU * u.y).sin_cos();
        let across = (1.0 - z * z).max(0.0).sqrt();
        Vec3::new(across * cos, across * sin, z)
    }

    fn uniform_share(&self, outgoing: Vec3) -> f32 {
        0.5 * self.roughness * (1.0 - outgoing.z)
    }
}

fn a(roughness: f32) -> f32 {
    1.0 / (1.0 + C1 * roughness)
}

/// The fraction of light that one facet reflects into the open, for a white ground.
fn single_albedo(cos: f32, roughness: f32) -> f32 {
    let cos = cos.clamp(0.0, 1.0);
    let sin = (1.0 - cos * cos).max(0.0).sqrt();
    // (sin / cos)(1 − sin³) with the cosine divided out.
    let steep = sin * cos * (1.0 + sin + sin * sin) / (1.0 + sin);
    let g = sin * (cos.acos() - sin * cos) + (2.0 / 3.0) * (steep - sin);
    a(roughness) * (1.0 + roughness * FRAC_1_PI * g)
}

fn mean_albedo(roughness: f32) -> f32 {
    a(roughness) * (1.0 + C2 * roughness)
}
