//! Microfacets: a rough boundary of many small smooth ones, by the distribution of Trowbridge & Reitz (GGX).

use crate::math::hash;
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

    /// Where light comes from that `scatter` turns to `outgoing` at a facet, given the facet's normal and a number in
    /// 0..1, as far as no other facet is in its way: its density is what facets scatter once, in proportion. `None` if
    /// next to nothing gets out.
    ///
    /// Facets are picked until light gets out from one. Weighting those that it does not get out from by nothing, and
    /// others by more, would be right as well; but a path that is scattered many times, as inside of frosted glass,
    /// multiplies weights until few paths carry all the light.
    pub(crate) fn sample_open(
        &self,
        outgoing: Vec3,
        (choice, u): (f32, Vec2),
        scatter: impl Fn(Vec3, f32) -> Option<Vec3>,
    ) -> Option<Vec3> {
        const TRIES: u32 = 64;
        let bits = |x: f32| u64::from(x.to_bits());
        let mut seed = hash(bits(u.x) << 32 | bits(u.y)) ^ bits(choice);
        let mut numbers = (choice, u);
        let seen = self.visible(outgoing);
        for _ in 0..TRIES {
            let random: [f32; 4] = std::array::from_fn(|_| {
                seed = hash(seed.wrapping_add(1));
                (seed >> 40) as f32 / (1 << 24) as f32
            });
            let incoming = scatter(self.sample(outgoing, numbers.1), numbers.0);
            let open = incoming.map_or(0.0, |i| self.both_visible(outgoing, i) / seen);
            if random[0] < open {
                return incoming;
            }
            numbers = (random[1], Vec2::new(random[2], random[3]));
        }
        None
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
