//! Homogeneous media: how far light goes in them, and where it goes when it is scattered.

use crate::color::Rgb;
use crate::math::tangents;
use crate::scene::description::Medium;
use glam::{DVec3, Vec2, Vec3};
use std::f64::consts::{PI, TAU};

/// A flight through a medium: it either meets a particle or reaches the end of its range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Flight {
    /// How far it went, m.
    pub distance: f32,
    /// Whether it ended at a particle that scatters, inside the range.
    pub scattered: bool,
    /// What the light that comes along the flight is multiplied by: transmittance, times scattering if it was
    /// scattered, over the probability of the flight.
    pub weight: Rgb,
}

impl Medium {
    /// What is lost per length, m⁻¹.
    pub(crate) fn extinction(&self) -> Rgb {
        self.absorption + self.scattering
    }

    /// The fraction of light that goes straight on over `distance`, m (Beer & Lambert).
    pub(crate) fn transmittance(&self, distance: f32) -> Rgb {
        // Where nothing is lost, nothing is lost on the way to infinity either.
        each(self.extinction(), |k| if k > 0.0 { (-k * distance).exp() } else { 1.0 })
    }

    /// A flight of at most `t_max` (m, may be infinite), picked by two numbers in 0..1: the first picks the channel
    /// whose extinction decides, in proportion to `importance`, the second the distance. All channels are weighted by
    /// the mean density, so that none is left to chance (the one-sample balance heuristic; Veach 1997 §9.2.4).
    pub(crate) fn fly(&self, t_max: f32, importance: Rgb, u: impl FnOnce() -> Vec2) -> Flight {
        let extinction = self.extinction();
        let shares = importance / importance.element_sum();
        // What only absorbs is passed without chance.
        let distance = match self.scattering {
            Rgb::ZERO => f32::INFINITY,
            _ => {
                let u = u();
                let (channel, _) = pick(importance, u.x.into());
                -(-u.y).ln_1p() / extinction[channel]
            }
        };
        let scattered = distance < t_max;
        let distance = if scattered { distance } else { t_max };
        let transmittance = self.transmittance(distance);
        let weight = if scattered {
            self.scattering * transmittance / (shares * extinction * transmittance).element_sum()
        } else if self.scattering == Rgb::ZERO {
            transmittance
        } else {
            transmittance / (shares * transmittance).element_sum()
        };
        Flight { distance, scattered, weight }
    }
}

/// A function of each channel, worked out once if they are all the same, as they mostly are.
pub(super) fn each(channels: Rgb, f: impl Fn(f32) -> f32) -> Rgb {
    let grey = channels.x == channels.y && channels.y == channels.z;
    if grey { Rgb::splat(f(channels.x)) } else { channels.map(f) }
}

/// A channel picked by a number in 0..1 in proportion to its weight, and what is left of the number, in 0..1 too.
pub(super) fn pick(weights: Rgb, u: f64) -> (usize, f64) {
    let [x, y, z] = weights.as_dvec3().to_array();
    let (before, u) = ([0.0, x, x + y], u * (x + y + z));
    let channel = usize::from(u >= before[1]) + usize::from(u >= before[2]);
    (channel, (u - before[channel]) / f64::from(weights[channel]))
}

/// Scattering that depends on nothing but the angle between before and after.
///
/// Henyey & Greenstein, *Diffuse radiation in the galaxy*, 1941.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct HenyeyGreenstein {
    /// Mean cosine between the directions of flight before and after, −1 < g < 1; 0: the same everywhere.
    pub g: f32,
}

impl HenyeyGreenstein {
    /// The fraction scattered per solid angle from one unit direction of flight to another, sr⁻¹: the value, and the
    /// density of [`HenyeyGreenstein::sample`].
    pub(crate) fn pdf(&self, before: Vec3, after: Vec3) -> f32 {
        self.density(0.5 * before.as_dvec3().distance_squared(after.as_dvec3())) as f32
    }

    /// By 1 − cos, which keeps its digits where nearly all the light goes straight on.
    fn density(&self, one_minus_cos: f64) -> f64 {
        let g = f64::from(self.g);
        let denominator = (1.0 - g).powi(2) + 2.0 * g * one_minus_cos;
        (1.0 - g * g) / (4.0 * PI * denominator * denominator.sqrt())
    }

    /// The unit direction of flight after `before`, picked by two numbers in 0..1.
    pub(crate) fn sample(&self, before: Vec3, u: Vec2) -> Vec3 {
        let one_minus_cos = self.one_minus_cos(f64::from(u.x));
        let across = (one_minus_cos * (2.0 - one_minus_cos)).max(0.0).sqrt();
        let before = before.as_dvec3();
        let (tangent, bitangent) = tangents(before);
        let (sin_phi, cos_phi) = (TAU * f64::from(u.y)).sin_cos();
        let after: DVec3 =
            (1.0 - one_minus_cos) * before + across * (cos_phi * tangent + sin_phi * bitangent);
        after.as_vec3()
    }

    /// 1 − cos by the inverse of its distribution: cos = (1 + g² − ((1 − g²) / (1 + g − 2 g u))²) / 2 g, written so
    /// that neither small g nor small angles cancel.
    fn one_minus_cos(&self, u: f64) -> f64 {
        let g = f64::from(self.g);
        let s = 1.0 + g - 2.0 * g * u;
        2.0 * u * (1.0 - g).powi(2) * (1.0 + g - g * u) / (s * s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Random, chi_squared_z};

    fn pair(random: &mut Random) -> Vec2 {
        Vec2::new(random.unit() as f32, random.unit() as f32)
    }

    fn medium(absorption: Rgb, scattering: Rgb) -> Medium {
        Medium { absorption, scattering, anisotropy: 0.0 }
    }

    /// Reference case M16.
    #[test]
    fn absorption_follows_beer_and_lambert() {
        let slab = medium(Rgb::new(0.7, 0.0, 1e3), Rgb::ZERO);
        assert!((f64::from(slab.transmittance(2.0).x) - 0.246596964).abs() < 1e-7);
        let flight = slab.fly(2.0, Rgb::ONE, || Vec2::new(0.3, 0.9));
        assert_eq!(
            flight,
            Flight { distance: 2.0, scattered: false, weight: slab.transmittance(2.0) }
        );
        assert_eq!(slab.transmittance(f32::INFINITY), Rgb::new(0.0, 1.0, 0.0));
    }

    /// Flights are as long as the exponential says, and as many arrive.
    #[test]
    fn flights_follow_the_exponential() {
        let (k, t_max, cells) = (1.7, 1.3_f64, 50);
        let fog = medium(Rgb::splat(0.5), Rgb::splat(k - 0.5));
        let (mut counts, mut random) = (vec![0; cells + 1], Random::new(1));
        for _ in 0..400_000 {
            let flight = fog.fly(t_max as f32, Rgb::ONE, || pair(&mut random));
            let cell = (f64::from(flight.distance) / t_max * cells as f64) as usize;
            counts[if flight.scattered { cell.min(cells - 1) } else { cells }] += 1;
            let expected = if flight.scattered { 1.0 - 0.5 / k } else { 1.0 };
            assert!((flight.weight - expected).abs().max_element() < 1e-5);
        }
        let left = |cell: usize| (-f64::from(k) * t_max * cell as f64 / cells as f64).exp();
        let mut shares: Vec<_> = (0..cells).map(|cell| left(cell) - left(cell + 1)).collect();
        shares.push(left(cells));
        let z = chi_squared_z(&counts, &shares);
        assert!(z < 4.5, "{z} standard deviations from the density");
    }

    /// With different channels, the weights make up for what chance preferred: in every stretch of the way.
    #[test]
    fn channels_that_differ_are_weighted_to_their_transmittance() {
        let fog = medium(Rgb::new(0.1, 0.0, 2.0), Rgb::new(0.3, 2.0, 0.0));
        let (t_max, cells, n) = (2.0_f32, 4, 400_000);
        for importance in [Rgb::ONE, Rgb::new(0.1, 1.0, 3.0), Rgb::new(1.0, 0.0, 0.0)] {
            let mut random = Random::new(8);
            let mut sums = vec![DVec3::ZERO; cells + 1];
            for _ in 0..n {
                let flight = fog.fly(t_max, importance, || pair(&mut random));
                let cell = (flight.distance / t_max * cells as f32) as usize;
                sums[if flight.scattered { cell } else { cells }] += flight.weight.as_dvec3();
            }
            for (cell, sum) in sums.into_iter().enumerate() {
                let left = |cell| fog.transmittance(t_max * cell as f32 / cells as f32).as_dvec3();
                let albedo = (fog.scattering / fog.extinction()).as_dvec3();
                let expected =
                    if cell < cells { albedo * (left(cell) - left(cell + 1)) } else { left(cells) };
                let seen = importance.as_dvec3().cmpgt(DVec3::ZERO);
                let off = DVec3::select(seen, sum / f64::from(n) - expected, DVec3::ZERO);
                assert!(off.abs().max_element() < 6e-3, "{importance} {cell}: {off}");
            }
        }
    }

    #[test]
    fn henyey_greenstein_is_sampled_by_its_density() {
        let before = Vec3::new(0.3, -0.4, 0.6).normalize();
        for g in [-0.99, -0.5, -1e-6, 0.0, 1e-9, 0.3, 0.85, 0.99] {
            let phase = HenyeyGreenstein { g };
            let (rows, columns, parts) = (40, 8, 400);
            // Cells of equal probability, by the distribution of the cosine.
            let edge = |row: f64| phase.one_minus_cos(row / rows as f64);
            let mut shares = Vec::new();
            for row in 0..rows {
                let strip = |part: usize| {
                    let at = |part: f64| edge(row as f64 + part / parts as f64);
                    let (part, width) = (part as f64, at(part as f64 + 1.0) - at(part as f64));
                    phase.density(at(part + 0.5)) * width
                };
                let share = TAU * (0..parts).map(strip).sum::<f64>();
                assert!((share * rows as f64 - 1.0).abs() < 1e-3, "{g} {row}: {share}");
                shares.extend([share / columns as f64; 8]);
            }
            let (mut counts, mut random, mut sum) = (vec![0; rows * columns], Random::new(3), 0.0);
            let (tangent, bitangent) = tangents(before.as_dvec3());
            for _ in 0..200_000 {
                let after = phase.sample(before, pair(&mut random)).as_dvec3();
                assert!((after.length() - 1.0).abs() < 1e-6);
                let one_minus_cos = 0.5 * after.distance_squared(before.as_dvec3());
                sum += 1.0 - one_minus_cos;
                let (pdf, exact) =
                    (phase.pdf(before, after.as_vec3()), phase.density(one_minus_cos));
                assert!((f64::from(pdf) / exact - 1.0).abs() < 1e-3);
                let row = (1..rows).filter(|&row| one_minus_cos >= edge(row as f64)).count();
                let around = after.dot(bitangent).atan2(after.dot(tangent)).rem_euclid(TAU) / TAU;
                counts[row * columns + ((around * columns as f64) as usize).min(columns - 1)] += 1;
            }
            let z = chi_squared_z(&counts, &shares);
            assert!(z < 4.5, "{g}: {z} standard deviations from the density");
            assert!(
                (sum / 2e5 - f64::from(g)).abs() < 6e-3,
                "{g}: the mean cosine is {}",
                sum / 2e5
            );
        }
    }
}
