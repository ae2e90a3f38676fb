//! Microfacets: a rough boundary of many small smooth ones, by the distribution of Trowbridge & Reitz (GGX).

use glam::{Vec2, Vec3, Vec3Swizzles};
use std::f32::consts::{PI, TAU};

/// Which way the facets lean: widths along tangent and bitangent (alpha = roughness²).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Ggx {
    /// Along tangent and bitangent, at least [`Ggx::LEAST`].
    pub alpha: Vec2,
}

impl Ggx {
    /// Narrower than this, a surface is taken as smooth.
    pub(crate) const LEAST: f32 = 3e-4;

    /// Density of facets with the unit normal `m`, per area and solid angle, sr⁻¹ (Walter et al. 2007).
    pub(crate) fn density(&self, m: Vec3) -> f32 {
        let across = m.xy() / self.alpha;
        let length2 = across.length_squared() + m.z * m.z;
        1.0 / (PI * self.alpha.x * self.alpha.y * length2 * length2)
    }

    /// Smith's Λ: facets in the way per facet that is seen.
    pub(crate) fn lambda(&self, direction: Vec3) -> f32 {
        // (√(z² + s²) − |z|) / 2|z| without cancellation; infinite on the horizon.
        let (s2, z) = ((direction.xy() * self.alpha).length_squared(), direction.z.abs());
        0.5 * s2 / (z * (z + (z * z + s2).sqrt()))
    }

    /// The fraction of facets that is seen from a direction.
    pub(crate) fn visible(&self, direction: Vec3) -> f32 {
        1.0 / (1.0 + self.lambda(direction))
    }

    /// The fraction that is seen from both, which know of each other's heights (Heitz 2014).
    pub(crate) fn both_visible(&self, outgoing: Vec3, incoming: Vec3) -> f32 {
        1.0 / (1.0 + self.lambda(outgoing) + self.lambda(incoming))
    }

    /// Density of [`Ggx::sample`], sr⁻¹.
    pub(crate) fn visible_density(&self, outgoing: Vec3, m: Vec3) -> f32 {
        let seen = outgoing.dot(m).max(0.0) / outgoing.z.max(f32::MIN_POSITIVE);
        self.visible(outgoing) * self.density(m) * seen
    }

    /// The normal of a facet that is seen from `outgoing`, which lies above.
    ///
    /// Dupuy & Benyoub, *Sampling Visible GGX Normals with Spherical Caps*, 2023.
    pub(crate) fn sample(&self, outgoing: Vec3, u: Vec2) -> Vec3 {
        let stretched = (outgoing.xy() * self.alpha).extend(outgoing.z).normalize();
        let z = (1.0 - u.y) * (1.0 + stretched.z) - stretched.z;
        let across = ((1.0 - z) * (1.0 + z)).max(0.0).sqrt();
        let (sin, cos) = (TAU * u.x).sin_cos();
        let m = Vec3::new(across * cos, across * sin, z) + stretched;
        (m.xy() * self.alpha).extend(m.z.max(1e-12)).normalize()
    }
}

/// `direction` mirrored at a facet.
pub(crate) fn mirrored(direction: Vec3, m: Vec3) -> Vec3 {
    2.0 * direction.dot(m) * m - direction
}

/// `direction` bent by a facet, whose normal lies on its side: towards the other side. `eta`: index beyond over index
/// here; `cos_beyond`: of the refracted direction with the facet.
pub(crate) fn refracted(direction: Vec3, m: Vec3, eta: f32, cos_beyond: f32) -> Vec3 {
    -direction / eta + (direction.dot(m) / eta - cos_beyond) * m
}
