//! How a surface scatters light at one point.
//!
//! All directions point away from the surface, on the side of the shading normal; cosines are with that normal.

use crate::color::Rgb;
use crate::math::{concentric, tangents};
use glam::{Vec2, Vec3};
use std::f32::consts::FRAC_1_PI;

/// The ratio of radiance leaving a point to the irradiance that causes it, sr⁻¹.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Bsdf {
    /// Matte: the same radiance in every direction.
    Lambert {
        /// R_d, the fraction of the light that is reflected, 0..1.
        reflectance: Rgb,
    },
    /// A perfect mirror, and what it lets through scattered by a matte ground.
    Mirror {
        /// The fraction that is mirrored, 0..1.
        mirrored: Rgb,
        /// The fraction that is scattered, 0..1.
        reflectance: Rgb,
    },
}

/// A direction from which light may come, picked by chance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct BsdfSample {
    /// Unit vector.
    pub incoming: Vec3,
    /// What light from there is multiplied by: BSDF × cosine / density.
    pub weight: Rgb,
    /// Density of `incoming`, sr⁻¹; infinite if no other direction was possible.
    pub pdf: f32,
}

impl Bsdf {
    /// The lecture's k_d = R_d / π: what is reflected spreads over π projected steradians. Without what is mirrored,
    /// which lights cannot be sampled for.
    pub(crate) fn value(&self) -> Rgb {
        self.reflectance() * FRAC_1_PI
    }

    /// Density with which [`Bsdf::sample`] picks a direction with this cosine > 0, mirrors aside, sr⁻¹.
    pub(crate) fn pdf(&self, cos: f32) -> f32 {
        self.matte_share() * cos * FRAC_1_PI
    }

    /// A direction picked by three numbers in 0..1: `choice` decides between mirror and ground. `None` if nothing is
    /// reflected there.
    pub(crate) fn sample(
        &self,
        normal: Vec3,
        outgoing: Vec3,
        choice: f32,
        u: Vec2,
    ) -> Option<BsdfSample> {
        let share = self.matte_share();
        if choice >= share {
            let Self::Mirror { mirrored, .. } = self else { return None };
            let incoming = 2.0 * outgoing.dot(normal) * normal - outgoing;
            return Some(BsdfSample {
                incoming,
                weight: *mirrored / (1.0 - share),
                pdf: f32::INFINITY,
            });
        }
        let (incoming, cos) = cosine_weighted(normal, u);
        let pdf = self.pdf(cos);
        (pdf > 0.0).then(|| BsdfSample { incoming, weight: self.reflectance() / share, pdf })
    }

    /// Whether it reflects nothing at all.
    pub(crate) fn is_black(&self) -> bool {
        let mirrors = matches!(self, Self::Mirror { mirrored, .. } if *mirrored != Rgb::ZERO);
        !mirrors && self.reflectance() == Rgb::ZERO
    }

    fn reflectance(&self) -> Rgb {
        match self {
            Self::Lambert { reflectance } | Self::Mirror { reflectance, .. } => *reflectance,
        }
    }

    /// Probability that the ground scatters and not the mirror.
    fn matte_share(&self) -> f32 {
        match self {
            Self::Lambert { .. } => 1.0,
            Self::Mirror { mirrored, reflectance } => {
                let (mirror, ground) = (mirrored.max_element(), reflectance.max_element());
                if ground > 0.0 { ground / (mirror + ground) } else { 0.0 }
            }
        }
    }
}

/// A unit vector around `normal` in proportion to its cosine, which is returned too: points of a disk, lifted onto the
/// hemisphere above (Malley).
fn cosine_weighted(normal: Vec3, u: Vec2) -> (Vec3, f32) {
    let place = concentric(u.as_dvec2());
    let cos = (1.0 - place.length_squared()).max(0.0).sqrt();
    let normal = normal.as_dvec3();
    let (tangent, bitangent) = tangents(normal);
    let direction = place.x * tangent + place.y * bitangent + cos * normal;
    (direction.as_vec3(), cos as f32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Random, chi_squared_z};
    use std::f64::consts::TAU;

    const NORMAL: Vec3 = Vec3::new(0.36, -0.48, 0.8);

    fn bsdfs() -> [Bsdf; 3] {
        let (reflectance, mirrored) = (Rgb::new(0.2, 0.3, 0.1), Rgb::new(0.5, 0.4, 0.9));
        [
            Bsdf::Lambert { reflectance },
            Bsdf::Mirror { mirrored, reflectance },
            Bsdf::Mirror { mirrored, reflectance: Rgb::ZERO },
        ]
    }

    fn samples(bsdf: Bsdf, outgoing: Vec3) -> impl Iterator<Item = Option<BsdfSample>> {
        let mut random = Random::new(5);
        (0..200_000).map(move |_| {
            let mut unit = || random.unit() as f32;
            bsdf.sample(NORMAL, outgoing, unit(), Vec2::new(unit(), unit()))
        })
    }

    /// Mean weights are what is reflected in all.
    #[test]
    fn samples_carry_the_whole_reflectance() {
        let outgoing = Vec3::new(0.6, 0.0, 0.8);
        for (bsdf, expected) in bsdfs().into_iter().zip([
            Rgb::new(0.2, 0.3, 0.1),
            Rgb::new(0.7, 0.7, 1.0),
            Rgb::new(0.5, 0.4, 0.9),
        ]) {
            let sum: Rgb = samples(bsdf, outgoing).flatten().map(|sample| sample.weight).sum();
            let off = (sum / 200_000.0 - expected).abs().max_element();
            assert!(off < 4e-3, "{bsdf:?}: {off}");
        }
    }

    #[test]
    fn matte_grounds_are_sampled_by_their_density_and_mirrors_mirror() {
        let outgoing = Vec3::new(0.6, 0.0, 0.8);
        let mirror = 2.0 * outgoing.dot(NORMAL) * NORMAL - outgoing;
        for bsdf in bsdfs() {
            // Rings of equal projected solid angle, and the mirror's direction as a cell of its own.
            let (rings, columns) = (20, 20);
            let mut counts = vec![0; rings * columns + 1];
            let (tangent, bitangent) = tangents(NORMAL.as_dvec3());
            for sample in samples(bsdf, outgoing).flatten() {
                let cos = sample.incoming.dot(NORMAL);
                if sample.pdf.is_infinite() {
                    assert!(sample.incoming.distance(mirror) < 1e-6);
                    counts[rings * columns] += 1;
                    continue;
                }
                assert!((sample.pdf / bsdf.pdf(cos) - 1.0).abs() < 2e-3, "{}", sample.pdf);
                let matte = bsdf.value() * cos / sample.pdf;
                assert!((matte - sample.weight).abs().max_element() < 2e-3);
                let incoming = sample.incoming.as_dvec3();
                let around = incoming.dot(bitangent).atan2(incoming.dot(tangent)) / TAU;
                let column = (around.rem_euclid(1.0) * columns as f64) as usize;
                let ring = ((1.0 - cos * cos) * rings as f32) as usize;
                counts[ring.min(rings - 1) * columns + column.min(columns - 1)] += 1;
            }
            let share = f64::from(bsdf.matte_share());
            let mut shares = vec![share / (rings * columns) as f64; rings * columns];
            shares.push(1.0 - share);
            let z = chi_squared_z(&counts, &shares);
            assert!(share == 0.0 || z < 4.5, "{bsdf:?}: {z} standard deviations");
        }
    }
}
