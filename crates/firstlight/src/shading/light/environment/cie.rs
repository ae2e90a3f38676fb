//! The fifteen skies of the CIE: how luminance is spread over the sky, from overcast to clear.
//!
//! ISO 15469:2004 (CIE S 011), after Kittler, Perez and Darula: L / L_zenith = f(χ) φ(Z) / (f(Z_sun) φ(0)), where Z is
//! the angle from the zenith and χ that from the sun.

use glam::DVec3;
use std::f64::consts::FRAC_PI_2;

/// One of the skies under a sun.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CieSky {
    /// φ(Z) = 1 + a exp(b / cos Z): from zenith to horizon.
    gradation: [f64; 2],
    /// f(χ) = 1 + c (exp(d χ) − exp(d π/2)) + e cos² χ: around the sun.
    indicatrix: [f64; 3],
    sun: DVec3,
    /// 1 / (f(Z_sun) φ(0)).
    scale: f64,
}

const GRADATIONS: [[f64; 2]; 6] =
    [[4.0, -0.7], [1.1, -0.8], [0.0, -1.0], [-1.0, -0.55], [-1.0, -0.32], [-1.0, -0.15]];

const INDICATRICES: [[f64; 3]; 6] = [
    [0.0, -1.0, 0.0],
    [2.0, -1.5, 0.15],
    [5.0, -2.5, 0.3],
    [10.0, -3.0, 0.45],
    [16.0, -3.0, 0.3],
    [24.0, -2.8, 0.15],
];

/// Of each type: which gradation and which indicatrix.
const TYPES: [[usize; 2]; 15] = [
    [0, 0],
    [0, 1],
    [1, 0],
    [1, 1],
    [2, 0],
    [2, 1],
    [2, 2],
    [2, 3],
    [3, 1],
    [3, 2],
    [3, 3],
    [4, 3],
    [4, 4],
    [5, 4],
    [5, 5],
];

impl CieSky {
    /// Sky number `number`, 1..=15, under a sun in the unit direction `sun` above the horizon.
    pub(super) fn new(number: u8, sun: DVec3) -> Self {
        let [gradation, indicatrix] = TYPES[usize::from(number.clamp(1, 15)) - 1];
        let (gradation, indicatrix) = (GRADATIONS[gradation], INDICATRICES[indicatrix]);
        let mut sky = Self { gradation, indicatrix, sun, scale: 1.0 };
        sky.scale = 1.0 / sky.relative(DVec3::Z);
        sky
    }

    /// Luminance in the unit direction `from`, relative to that of the zenith; 0 below the horizon.
    pub(super) fn relative(&self, from: DVec3) -> f64 {
        if from.z <= 0.0 {
            return 0.0;
        }
        let ([a, b], [c, d, e]) = (self.gradation, self.indicatrix);
        let cos = from.dot(self.sun).clamp(-1.0, 1.0);
        let around_sun = 1.0 + c * ((d * cos.acos()).exp() - (d * FRAC_PI_2).exp()) + e * cos * cos;
        self.scale * (1.0 + a * (b / from.z).exp()) * around_sun
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{PI, TAU};

    fn sun(elevation: f64) -> DVec3 {
        let (sin, cos) = elevation.to_radians().sin_cos();
        DVec3::new(0.0, cos, sin)
    }

    /// ∫ L cos over the directions from a receiver to a horizontal or vertical rectangle, by midpoints.
    fn through(sky: &CieSky, from: DVec3, normal: DVec3, corner: DVec3, edges: [DVec3; 2]) -> f64 {
        const PARTS: usize = 600;
        let outward = edges[0].cross(edges[1]) / (PARTS * PARTS) as f64;
        let middle = |i: usize| (i as f64 + 0.5) / PARTS as f64;
        let part = |i: usize| {
            let to = corner + middle(i % PARTS) * edges[0] + middle(i / PARTS) * edges[1] - from;
            let distance = to.length();
            let cos = normal.dot(to).max(0.0) / distance;
            sky.relative(to / distance) * cos * outward.dot(to).abs() / distance.powi(3)
        };
        (0..PARTS * PARTS).map(part).sum()
    }

    fn horizontal(sky: &CieSky) -> f64 {
        const PARTS: usize = 1000;
        let middle = |i: usize| (i as f64 + 0.5) / PARTS as f64;
        let part = |i: usize| {
            // Equal parts of the projected hemisphere.
            let (sin2, phi) = (middle(i % PARTS), TAU * middle(i / PARTS));
            let (sin, cos) = (sin2.sqrt(), (1.0 - sin2).sqrt());
            sky.relative(DVec3::new(sin * phi.cos(), sin * phi.sin(), cos))
        };
        PI * (0..PARTS * PARTS).map(part).sum::<f64>() / (PARTS * PARTS) as f64
    }

    #[test]
    fn the_overcast_and_the_uniform_sky_have_closed_forms() {
        assert!((horizontal(&CieSky::new(5, sun(60.0))) / PI - 1.0).abs() < 1e-9);
        // Type 1 is the standard's stand-in for the traditional (1 + 2 sin γ) / 3.
        let overcast = CieSky::new(1, sun(60.0));
        for degrees in [5.0_f64, 30.0, 60.0, 90.0] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let traditional = (1.0 + 2.0 * sin) / 3.0;
            assert!((overcast.relative(DVec3::new(cos, 0.0, sin)) - traditional).abs() < 0.06);
        }
    }

    /// Reference cases Q59: the part of the sky's illuminance that comes through a hole of 4 × 4 m in the roof of a black
    /// room of 4 × 4 × 3 m, at the top and the bottom of a wall and beside it on the floor, percent.
    #[test]
    fn q59_skies_through_a_roof() {
        for (number, expected) in [
            (1, [35.8228502, 14.3601419, 31.8575248, 43.3242775]),
            (2, [40.3685391, 19.7474037, 41.9615089, 50.0829817]),
            (4, [45.3442639, 18.9967879, 39.1369883, 46.1639051]),
            (5, [45.1226036, 12.9673724, 26.7951875, 35.5665925]),
            (6, [49.5752602, 18.3773506, 36.5891112, 42.5701489]),
            (8, [53.1016854, 26.5634499, 50.5774783, 51.1136169]),
            (10, [61.7363471, 21.0546892, 37.7789375, 38.9775647]),
            (12, [67.278023, 24.1954735, 42.2831133, 40.9150653]),
            (13, [68.1528968, 27.0769707, 47.0132978, 44.0391898]),
        ] {
            let sky = CieSky::new(number, sun(60.0));
            let all = horizontal(&sky);
            let receivers = [
                (DVec3::new(2.0, 0.0, 2.75), DVec3::Y),
                (DVec3::new(2.0, 0.0, 0.25), DVec3::Y),
                (DVec3::new(2.0, 0.25, 0.0), DVec3::Z),
                (DVec3::new(2.0, 1.75, 0.0), DVec3::Z),
            ];
            for ((from, normal), expected) in receivers.into_iter().zip(expected) {
                let edges = [4.0 * DVec3::X, 4.0 * DVec3::Y];
                let share = 100.0 * through(&sky, from, normal, 3.0 * DVec3::Z, edges) / all;
                assert!(
                    (share / expected - 1.0).abs() < 1e-3,
                    "{number}: {share} is not {expected}"
                );
            }
        }
    }

    #[test]
    fn every_sky_is_1_at_the_zenith_and_nowhere_negative() {
        for number in 1..=15 {
            for elevation in [0.0, 10.0, 45.0, 90.0] {
                let sky = CieSky::new(number, sun(elevation));
                assert!((sky.relative(DVec3::Z) - 1.0).abs() < 1e-12);
                assert_eq!(sky.relative(-DVec3::Z), 0.0);
                for i in 0..2000 {
                    let z = 1e-6 + f64::from(i) / 2000.0;
                    let (sin, cos) = (0.7 * f64::from(i)).sin_cos();
                    let r = (1.0 - z * z).max(0.0).sqrt();
                    let value = sky.relative(DVec3::new(r * cos, r * sin, z));
                    assert!(value >= 0.0 && value.is_finite(), "{number} {elevation} {z}: {value}");
                }
            }
        }
    }
}
