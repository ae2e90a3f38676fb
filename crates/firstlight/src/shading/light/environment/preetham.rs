//! A clear or hazy sky and its sun, by turbidity and the sun's elevation.
//!
//! Preetham, Shirley, Smits, *A Practical Analytic Model for Daylight*, 1999: luminance and chromaticity of the sky are
//! fitted to simulations with the formula of Perez, Seals and Michalsky 1993. Of the sun, what the atmosphere lets
//! through: molecules, dust and ozone, each by its own law of wavelength.

use glam::{DMat3, DVec3};
use std::f64::consts::PI;

/// A sky under a sun.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PreethamSky {
    sun: DVec3,
    /// A to E of the formula, for luminance Y and chromaticities x and y.
    perez: [[f64; 5]; 3],
    /// Y (cd/m²), x and y at the zenith over the formula's value there.
    scale: [f64; 3],
}

/// Turbidities that the fit was made for; 2 is a clear sky, 6 a hazy one.
pub(crate) const TURBIDITIES: [f64; 2] = [1.7, 10.0];

impl PreethamSky {
    /// The sky for a turbidity (clamped to what the fit was made for) and a sun in the unit direction `sun`.
    pub(super) fn new(turbidity: f64, sun: DVec3) -> Self {
        let t = turbidity.clamp(TURBIDITIES[0], TURBIDITIES[1]);
        let sun = if sun.z < 0.0 { sun.with_z(0.0).normalize_or(DVec3::Y) } else { sun };
        let perez = [
            [
                [0.1787, -1.4630],
                [-0.3554, 0.4275],
                [-0.0227, 5.3251],
                [0.1206, -2.5771],
                [-0.0670, 0.3703],
            ],
            [
                [-0.0193, -0.2592],
                [-0.0665, 0.0008],
                [-0.0004, 0.2125],
                [-0.0641, -0.8989],
                [-0.0033, 0.0452],
            ],
            [
                [-0.0167, -0.2608],
                [-0.0950, 0.0092],
                [-0.0079, 0.2102],
                [-0.0441, -1.6537],
                [-0.0109, 0.0529],
            ],
        ];
        let perez = perez.map(|of_channel| of_channel.map(|[slope, offset]| slope * t + offset));
        let zenith = zenith(t, sun.z.clamp(-1.0, 1.0).acos());
        let scale = [0, 1, 2].map(|i| zenith[i] / formula(&perez[i], 1.0, sun.z));
        Self { sun, perez, scale }
    }

    /// Luminance of each linear Rec. 709 channel in the unit direction `from`, cd/m²: white of 1 in all three has 1
    /// cd/m². 0 below the horizon.
    pub(super) fn luminance(&self, from: DVec3) -> DVec3 {
        if from.z <= 0.0 {
            return DVec3::ZERO;
        }
        let value = |i: usize| self.scale[i] * formula(&self.perez[i], from.z, from.dot(self.sun));
        let (luminance, x, y) = (value(0), value(1), value(2));
        let xyz = DVec3::new(x, y, 1.0 - x - y) * (luminance / y);
        from_xyz(xyz).max(DVec3::ZERO)
    }
}

/// The formula of Perez et al. with the cosines of the angles to the zenith and to the sun.
fn formula(&[a, b, c, d, e]: &[f64; 5], cos_zenith: f64, cos_sun: f64) -> f64 {
    let cos_sun = cos_sun.clamp(-1.0, 1.0);
    // At the very horizon, the exponent goes to −∞.
    let gradation = 1.0 + a * (b / cos_zenith.max(1e-3)).exp();
    gradation * (1.0 + c * (d * cos_sun.acos()).exp() + e * cos_sun * cos_sun)
}

/// Y (cd/m²), x and y at the zenith, for the sun's angle from there, rad.
fn zenith(t: f64, theta: f64) -> [f64; 3] {
    let chi = (4.0 / 9.0 - t / 120.0) * (PI - 2.0 * theta);
    let luminance = 1e3 * ((4.0453 * t - 4.9710) * chi.tan() - 0.2155 * t + 2.4192);
    let cubic = |[a, b, c, d]: [f64; 4]| ((a * theta + b) * theta + c) * theta + d;
    let x = cubic([0.00166, -0.00375, 0.00209, 0.0]) * t * t
        + cubic([-0.02903, 0.06377, -0.03202, 0.00394]) * t
        + cubic([0.11693, -0.21196, 0.06052, 0.25886]);
    let y = cubic([0.00275, -0.00610, 0.00317, 0.0]) * t * t
        + cubic([-0.04214, 0.08970, -0.04153, 0.00516]) * t
        + cubic([0.15346, -0.26756, 0.06670, 0.26688]);
    [luminance.max(0.0), x, y]
}

/// Illuminance of each linear Rec. 709 channel from the sun alone on what faces it, lx, for its sine of elevation.
pub(super) fn sunlight(turbidity: f64, sin_elevation: f64) -> DVec3 {
    const STEP: f64 = 5.0;
    let t = turbidity.clamp(TURBIDITIES[0], TURBIDITIES[1]);
    let mass = air_mass(sin_elevation);
    let xyz = |i: i32| {
        let nm = 380.0 + STEP * (f64::from(i) + 0.5);
        color_matching(nm) * (outside(nm) * transmittance(nm, t, mass) * STEP)
    };
    let xyz = (0..80).map(xyz).sum::<DVec3>();
    683.0 * from_xyz(xyz).max(DVec3::ZERO)
}

/// How many times the air above a point the light goes through (Kasten & Young 1989).
fn air_mass(sin_elevation: f64) -> f64 {
    let degrees = sin_elevation.clamp(0.0, 1.0).asin().to_degrees();
    1.0 / (sin_elevation.max(0.0) + 0.50572 * (degrees + 6.07995).powf(-1.6364))
}

/// What the atmosphere lets through of sunlight of a wavelength in nm.
fn transmittance(nm: f64, turbidity: f64, mass: f64) -> f64 {
    let um = 1e-3 * nm;
    let molecules = 0.008735 * um.powf(-4.08);
    let dust = (0.04608 * turbidity - 0.04586) * um.powf(-1.3);
    // 0.35 cm of ozone; the Chappuis band as a bell around 600 nm.
    let ozone = 0.35 * 0.13 * (-((nm - 600.0) / 65.0).powi(2)).exp();
    (-mass * (molecules + dust + ozone)).exp()
}

/// Spectral irradiance of the sun above the atmosphere, W·m⁻²·nm⁻¹: a black body of 5778 K of the sun's size (Planck).
fn outside(nm: f64) -> f64 {
    const SOLID_ANGLE: f64 = 6.794e-5;
    const HC2: f64 = 5.955_214_9e-17;
    const HC_OVER_K: f64 = 1.438_776_877e-2;
    let m = 1e-9 * nm;
    let radiance = 2.0 * HC2 / m.powi(5) / ((HC_OVER_K / (m * 5778.0)).exp() - 1.0);
    1e-9 * SOLID_ANGLE * radiance
}

/// The CIE 1931 colour matching functions x̄, ȳ, z̄ by sums of bells (Wyman, Sloan, Shirley, JCGT 2(2), 2013).
fn color_matching(nm: f64) -> DVec3 {
    let bell = |height: f64, center: f64, left: f64, right: f64| {
        let width = if nm < center { left } else { right };
        height * (-0.5 * ((nm - center) * width).powi(2)).exp()
    };
    DVec3::new(
        bell(1.056, 599.8, 0.0264, 0.0323) + bell(0.362, 442.0, 0.0624, 0.0374)
            - bell(0.065, 501.1, 0.0490, 0.0382),
        bell(0.821, 568.8, 0.0213, 0.0247) + bell(0.286, 530.9, 0.0613, 0.0322),
        bell(1.217, 437.0, 0.0845, 0.0278) + bell(0.681, 459.0, 0.0385, 0.0725),
    )
}

/// Linear Rec. 709 of XYZ (ITU-R BT.709 primaries, D65).
fn from_xyz(xyz: DVec3) -> DVec3 {
    DMat3::from_cols(
        DVec3::new(3.240_454_2, -0.969_266_0, 0.055_643_4),
        DVec3::new(-1.537_138_5, 1.876_010_8, -0.204_025_9),
        DVec3::new(-0.498_531_4, 0.041_556_0, 1.057_225_2),
    ) * xyz
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lux(channels: DVec3) -> f64 {
        channels.dot(DVec3::new(0.2126, 0.7152, 0.0722))
    }

    fn sun(elevation: f64) -> DVec3 {
        let (sin, cos) = elevation.to_radians().sin_cos();
        DVec3::new(0.0, cos, sin)
    }

    /// The sun gives some 100 klx at its highest through clear air, and less and redder light the lower it stands.
    #[test]
    fn the_sun_is_as_bright_as_it_is() {
        let high = lux(sunlight(2.0, 1.0));
        assert!((0.9e5..1.2e5).contains(&high), "{high}");
        let mut before = f64::INFINITY;
        let mut redness = 0.0;
        for degrees in [90.0_f64, 60.0, 30.0, 10.0, 5.0, 1.0] {
            let light = sunlight(2.0, degrees.to_radians().sin());
            assert!(lux(light) < before && light.x / light.z > redness, "{degrees}: {light}");
            (before, redness) = (lux(light), light.x / light.z);
        }
        assert!(lux(sunlight(6.0, 0.5)) < 0.8 * lux(sunlight(2.0, 0.5)));
        // Without air: the black body's 133 klx, whose true value is 128.
        let steps = (0..80).map(|i| 380.0 + 5.0 * (f64::from(i) + 0.5));
        let outside: f64 = steps.map(|nm| 683.0 * 5.0 * outside(nm) * color_matching(nm).y).sum();
        assert!((1.25e5..1.4e5).contains(&outside), "{outside}");
    }

    /// At the zenith the formula is the fit itself; towards the sun the sky is brighter, away from it bluer.
    #[test]
    fn the_sky_is_blue_and_bright_around_the_sun() {
        for turbidity in [2.0, 4.0, 6.0] {
            let sky = PreethamSky::new(turbidity, sun(40.0));
            let theta = 50_f64.to_radians();
            let [luminance, x, y] = zenith(turbidity, theta);
            let xyz = DVec3::new(x, y, 1.0 - x - y) * (luminance / y);
            assert!(sky.luminance(DVec3::Z).abs_diff_eq(from_xyz(xyz).max(DVec3::ZERO), 1e-6));
            // (4.0453 T − 4.9710) tan χ − 0.2155 T + 2.4192 kcd/m², written out for T = 2.
            let chi = (4.0 / 9.0 - 2.0 / 120.0) * (PI - 2.0 * theta);
            let written_out = 3119.6 * chi.tan() + 1988.2;
            assert!(turbidity != 2.0 || (luminance / written_out - 1.0).abs() < 1e-9);
            let zenith = sky.luminance(DVec3::Z);
            let near = sky.luminance(sun(45.0));
            let opposite = sky.luminance(DVec3::new(0.0, -0.6, 0.8));
            assert!(lux(near) > 2.0 * lux(zenith), "{near} {zenith}");
            assert!(opposite.z / opposite.x > near.z / near.x && zenith.z > zenith.x);
        }
    }
}
