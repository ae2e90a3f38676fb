//! Lights as plain data.

use crate::color::Rgb;
use glam::DVec3;
use schemars::JsonSchema;
use serde::Deserialize;

/// A light and its name.
#[derive(Debug, Clone, PartialEq)]
pub struct LightDescription {
    /// The name it has in its file.
    pub name: String,
    /// What it gives.
    pub light: Light,
    /// Whether surfaces in between cast shadows.
    pub shadows: bool,
}

/// What a light gives. Every quantity is per colour channel.
#[derive(Debug, Clone, PartialEq)]
pub enum Light {
    /// An isotropic point: E = I cos θ / r², I = P / 4π.
    Point {
        /// Where it is, m.
        position: DVec3,
        /// Radiant intensity, W·sr⁻¹.
        intensity: Rgb,
    },
    /// A point that shines into a cone.
    Spot {
        /// Where it is, m.
        position: DVec3,
        /// Unit vector along the axis, away from the light.
        direction: DVec3,
        /// Radiant intensity on the axis, W·sr⁻¹.
        intensity: Rgb,
        /// Angle from the axis up to which the intensity is full, rad.
        inner_angle: f64,
        /// Angle from the axis from which on there is no light, rad.
        outer_angle: f64,
        /// How the intensity falls between the two.
        falloff: SpotFalloff,
    },
    /// Parallel light from infinitely far away.
    Directional {
        /// Unit vector in which the light travels.
        direction: DVec3,
        /// Irradiance of a surface facing the light, W·m⁻².
        irradiance: Rgb,
    },
    /// A round light infinitely far away, such as the sun: its shadows have soft edges.
    Sun {
        /// Unit vector in which the light from its middle travels.
        direction: DVec3,
        /// Irradiance of a surface facing the light, W·m⁻².
        irradiance: Rgb,
        /// Angle from its middle to its rim, rad, more than 0 and at most π/2.
        angular_radius: f64,
    },
    /// The lecture's constant ambient light: adds R_a · L_a everywhere.
    Ambient {
        /// Radiance from every direction, W·sr⁻¹·m⁻².
        radiance: Rgb,
    },
    /// The dim light at the camera. It follows the camera in use and casts no visible shadow.
    Camera {
        /// How its light reaches a surface.
        amount: CameraLightAmount,
    },
}

/// The strength of a light at the camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CameraLightAmount {
    /// A point light: radiant intensity, W·sr⁻¹, falling with the square of the distance.
    Intensity(Rgb),
    /// A headlight: irradiance of a surface facing the camera, W·m⁻², at any distance.
    Irradiance(Rgb),
}

/// How a spot's intensity falls between its inner and outer angle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SpotFalloff {
    /// KHR_lights_punctual: the square of the cosine's linear ramp.
    #[default]
    Gltf,
    /// pbrt-v4: smoothstep of the cosine.
    Smoothstep,
}
