//! The CIE's general skies as the standard prints them: what is expected. The renderer has a table of its own, put together
//! from groups; a slip in either shows as a difference.

use glam::DVec3;
use std::f64::consts::FRAC_PI_2;

/// ISO 15469:2004 (CIE S 011), table 1: a and b of the gradation, c, d and e of the indicatrix, type by type.
const PARAMETERS: [[f64; 5]; 15] = [
    [4.0, -0.70, 0.0, -1.0, 0.00],
    [4.0, -0.70, 2.0, -1.5, 0.15],
    [1.1, -0.80, 0.0, -1.0, 0.00],
    [1.1, -0.80, 2.0, -1.5, 0.15],
    [0.0, -1.00, 0.0, -1.0, 0.00],
    [0.0, -1.00, 2.0, -1.5, 0.15],
    [0.0, -1.00, 5.0, -2.5, 0.30],
    [0.0, -1.00, 10.0, -3.0, 0.45],
    [-1.0, -0.55, 2.0, -1.5, 0.15],
    [-1.0, -0.55, 5.0, -2.5, 0.30],
    [-1.0, -0.55, 10.0, -3.0, 0.45],
    [-1.0, -0.32, 10.0, -3.0, 0.45],
    [-1.0, -0.32, 16.0, -3.0, 0.30],
    [-1.0, -0.15, 16.0, -3.0, 0.30],
    [-1.0, -0.15, 24.0, -2.8, 0.15],
];

/// Luminance of sky number `number`, 1..=15, in the unit direction `from` above the horizon, relative to that of the
/// zenith: f(χ) φ(Z) / (f(Z_sun) φ(0)).
pub(super) fn luminance(number: u8, sun: DVec3, from: DVec3) -> f64 {
    let [a, b, c, d, e] = PARAMETERS[usize::from(number - 1)];
    let gradation = |zenith_angle: f64| 1.0 + a * (b / zenith_angle.cos()).exp();
    let indicatrix = |angle: f64| {
        1.0 + c * ((d * angle).exp() - (d * FRAC_PI_2).exp()) + e * angle.cos().powi(2)
    };
    let [zenith_angle, sun_angle] = [from.z, sun.z].map(|z| z.min(1.0).acos());
    let angle_to_sun = from.dot(sun).clamp(-1.0, 1.0).acos();
    let here = indicatrix(angle_to_sun) * gradation(zenith_angle);
    here / (indicatrix(sun_angle) * gradation(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::description::{SceneDescription, Sky};
    use crate::verify::Random;
    use crate::verify::scenes::{look, under};
    use glam::Vec3;

    /// At least some six degrees above the horizon.
    fn above(random: &mut Random) -> DVec3 {
        let from = random.direction();
        from.with_z(0.1 + from.z.abs()).normalize()
    }

    #[test]
    fn the_renderers_skies_are_those_of_the_standard() {
        let mut random = Random::new(0);
        for number in 1..=15 {
            let (sun, ground) = (above(&mut random), Vec3::ZERO);
            let environment = under(Sky::Cie { number, sun, ground }, 1.0);
            let scene = SceneDescription { environment, ..Default::default() };
            for _ in 0..50 {
                let from = above(&mut random);
                let seen = f64::from(look(&scene, DVec3::ZERO, from).x);
                let expected = luminance(number, sun, from);
                assert!((seen / expected - 1.0).abs() < 1e-4, "{number} {sun} {from}: {seen}");
            }
        }
    }
}
