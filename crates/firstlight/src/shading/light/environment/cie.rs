//! The fifteen skies of the CIE: how luminance is spread over the sky, from overcast to clear.
//!
//! ISO 15469:2004 (CIE S 011), after Kittler, Perez and Darula: L / L_zenith = f(χ) φ(Z) / (f(Z_sun) φ(0)), where Z is
//! the angle from the zenith and χ that from the sun.

use glam::DVec3;
use std::f64::consts::FRAC_PI_2;

/// One of the skies under a sun.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct CieSky {
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
    pub(crate) fn new(number: u8, sun: DVec3) -> Self {
        let [gradation, indicatrix] = TYPES[usize::from(number.clamp(1, 15)) - 1];
        let (gradation, indicatrix) = (GRADATIONS[gradation], INDICATRICES[indicatrix]);
        let mut sky = Self { gradation, indicatrix, sun, scale: 1.0 };
        sky.scale = 1.0 / sky.relative(DVec3::Z);
        sky
    }

    /// Luminance in the unit direction `from`, relative to that of the zenith; 0 below the horizon.
    pub(crate) fn relative(&self, from: DVec3) -> f64 {
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
