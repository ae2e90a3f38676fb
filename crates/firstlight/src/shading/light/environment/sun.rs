//! A round light infinitely far away, such as the sun.

use super::EnvironmentSample;
use crate::color::Rgb;
use crate::math::tangents;
use glam::{DVec3, Vec2, Vec3};
use std::f64::consts::{PI, TAU};

/// All directions within an angle of one, of the same radiance.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sun {
    /// Unit vector to its middle.
    toward: DVec3,
    /// 1 − cos of its angular radius.
    one_minus_cos: f64,
    /// W·sr⁻¹·m⁻²
    radiance: Rgb,
}

impl Sun {
    /// A disk around the unit vector `toward`, up to `angular_radius` (rad, more than 0, at most π/2) from it, that
    /// causes `irradiance` (W·m⁻²) on what faces it.
    pub(crate) fn new(toward: DVec3, angular_radius: f64, irradiance: Rgb) -> Self {
        let projected = PI * angular_radius.sin().powi(2);
        let one_minus_cos = 2.0 * (0.5 * angular_radius).sin().powi(2);
        Self { toward, one_minus_cos, radiance: irradiance / projected as f32 }
    }

    /// What comes from the unit direction `incoming`, W·sr⁻¹·m⁻².
    pub(crate) fn radiance(&self, incoming: Vec3) -> Rgb {
        if self.covers(incoming) { self.radiance } else { Rgb::ZERO }
    }

    /// A direction of the disk picked by two numbers in 0..1, each alike.
    pub(crate) fn sample(&self, u: Vec2) -> EnvironmentSample {
        let one_minus_cos = f64::from(u.x) * self.one_minus_cos;
        let across = (one_minus_cos * (2.0 - one_minus_cos)).sqrt();
        let (tangent, bitangent) = tangents(self.toward);
        let (sin, cos) = (TAU * f64::from(u.y)).sin_cos();
        let incoming =
            (1.0 - one_minus_cos) * self.toward + across * (cos * tangent + sin * bitangent);
        EnvironmentSample {
            incoming: incoming.as_vec3(),
            radiance: self.radiance,
            pdf: self.density(),
        }
    }

    /// Density with which [`Sun::sample`] picks the unit direction `incoming`, sr⁻¹.
    pub(crate) fn pdf(&self, incoming: Vec3) -> f32 {
        if self.covers(incoming) { self.density() } else { 0.0 }
    }

    fn density(&self) -> f32 {
        (1.0 / (TAU * self.one_minus_cos)) as f32
    }

    /// By the chord, which keeps the digits that a cosine near 1 has lost.
    fn covers(&self, incoming: Vec3) -> bool {
        0.5 * incoming.as_dvec3().distance_squared(self.toward) <= self.one_minus_cos
    }
}
