//! A rough boundary between two transparent media.

use super::fresnel::{Gloss, dielectric};
use super::ggx::{Ggx, mirrored, refracted};
use crate::color::Rgb;
use glam::{DVec3, Vec2, Vec3};

/// Walter et al., *Microfacet Models for Refraction through Rough Surfaces*, 2007.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Glass {
    /// The facets.
    pub facets: Ggx,
    /// Index beyond over index on the side of `outgoing`.
    pub eta: f32,
    /// The fraction of light from the eye that comes out after one scattering, to either side.
    pub once: f32,
}

impl Glass {
    /// BSDF × |cosine of `incoming`|, sr⁻¹, and density of [`Glass::sample`], sr⁻¹. Light that comes through is weaker
    /// by η², since radiance counts light per solid angle and solid angles change (Veach 1997 §5.2).
    pub(crate) fn eval(&self, outgoing: Vec3, incoming: Vec3) -> (f32, f32) {
        let reflects = incoming.z > 0.0;
        let (m, cos_o, cos_i) = self.facet(outgoing, incoming);
        if cos_o <= 0.0 || (cos_i > 0.0) != reflects {
            return (0.0, 0.0);
        }
        let eta = f64::from(self.eta);
        let (reflected, _) = dielectric(cos_o.min(1.0), eta);
        let seen = self.facets.visible_density(outgoing, m);
        let hidden = self.facets.both_visible(outgoing, incoming) / self.facets.visible(outgoing);
        if reflects {
            let value = (reflected / (4.0 * cos_o)) as f32 * seen * hidden;
            return (value, value / self.once);
        }
        let spread = cos_i + cos_o / eta;
        let power = ((1.0 - reflected) * cos_i.abs() / (spread * spread)) as f32 * seen * hidden;
        (power / (self.eta * self.eta), power / self.once)
    }

    /// What the light of [`Glass::eval`] is to be multiplied by if facets reflect by `gloss`.
    pub(crate) fn glossed(&self, outgoing: Vec3, incoming: Vec3, gloss: Gloss) -> Rgb {
        let (_, cos, _) = self.facet(outgoing, incoming);
        let (exact, _) = dielectric(cos.min(1.0), self.eta.into());
        let reflected = gloss.at(cos.min(1.0) as f32, self.eta);
        match incoming.z > 0.0 {
            true => reflected / exact as f32,
            false => (Rgb::ONE - reflected) / (1.0 - exact) as f32,
        }
    }

    /// The facet that sends light from `incoming` to `outgoing`, and its cosines with both. In double precision: where
    /// the indices are nearly the same, the two directions nearly cancel.
    fn facet(&self, outgoing: Vec3, incoming: Vec3) -> (Vec3, f64, f64) {
        let (outgoing, toward) = (outgoing.as_dvec3().normalize(), incoming.as_dvec3().normalize());
        let weight = if incoming.z > 0.0 { 1.0 } else { f64::from(self.eta) };
        let m = (outgoing + weight * toward).normalize_or(DVec3::Z);
        let m = if m.z < 0.0 { -m } else { m };
        (m.as_vec3(), outgoing.dot(m), toward.dot(m))
    }

    /// A direction of either side: `choice` in 0..1 decides which.
    pub(crate) fn sample(&self, outgoing: Vec3, choice: f32, u: Vec2) -> Option<Vec3> {
        self.facets.sample_open(outgoing, (choice, u), |m, choice| {
            let cos = outgoing.dot(m).clamp(0.0, 1.0);
            match dielectric(cos.into(), self.eta.into()) {
                (reflected, Some(beyond)) if f64::from(choice) >= reflected => {
                    let incoming = refracted(outgoing, m, self.eta, beyond as f32).normalize();
                    (incoming.z < 0.0).then_some(incoming)
                }
                _ => Some(mirrored(outgoing, m)).filter(|incoming| incoming.z > 0.0),
            }
        })
    }
}
