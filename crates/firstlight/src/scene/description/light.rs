//! Lights as plain data.

use super::PhotometricWeb;
use crate::color::Rgb;
use crate::units::Dimension;
use glam::{DQuat, DVec3};
use schemars::JsonSchema;
use serde::Deserialize;
use std::sync::Arc;

/// A light and its name.
#[derive(Debug, Clone, PartialEq)]
pub struct LightDescription {
    /// The name it has in its file.
    pub name: String,
    /// What it gives.
    pub light: Light,
    /// Whether surfaces in between cast shadows.
    pub shadows: bool,
    /// Radius of the sphere that shines in place of a point, spot or measured luminaire, m, and gives the same from afar;
    /// 0: none does. It is not seen, and does nothing without shadows.
    pub radius: f64,
    /// Its quantity as its file has it, with the unit, such as `800 lm`; empty if it comes from no file.
    pub written: String,
}

impl LightDescription {
    /// A light that casts shadows and has no radius.
    pub fn new(name: impl Into<String>, light: Light) -> Self {
        Self { name: name.into(), light, shadows: true, radius: 0.0, written: String::new() }
    }

    /// Whether it is ambient light that near surfaces keep out.
    pub fn is_near_ambient(&self) -> bool {
        matches!(self.light, Light::Ambient { reach, .. } if reach.is_finite())
    }

    /// Whether its shadows have soft edges. Without shadows, its middle is as good.
    pub fn has_extent(&self) -> bool {
        self.shadows && (self.radius > 0.0 || matches!(self.light, Light::Sun { .. }))
    }
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
    /// A point that gives in each direction what was measured.
    Photometric {
        /// Where it is, m.
        position: DVec3,
        /// From the luminaire's own space to the world.
        rotation: DQuat,
        /// What was measured, cd.
        web: Arc<PhotometricWeb>,
        /// Radiant intensity for each candela that was measured, W·sr⁻¹·cd⁻¹.
        factor: Rgb,
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
        /// Surfaces nearer than this keep it out, m; infinite: none does, as in the lecture.
        reach: f64,
    },
    /// The dim light at the camera. It follows the camera in use and casts no visible shadow.
    Camera {
        /// How its light reaches a surface.
        amount: CameraLightAmount,
    },
}

impl Light {
    /// The kind of light, as it is called in scene files.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Point { .. } => "point",
            Self::Spot { .. } => "spot",
            Self::Photometric { .. } => "photometric",
            Self::Directional { .. } => "directional",
            Self::Sun { .. } => "sun",
            Self::Ambient { .. } => "ambient",
            Self::Camera { .. } => "camera",
        }
    }

    /// What its quantity is, and how much it gives in its brightest direction, in SI units of energy.
    pub fn quantity(&self) -> (Dimension, Rgb) {
        use CameraLightAmount as At;
        match self {
            Self::Point { intensity, .. }
            | Self::Spot { intensity, .. }
            | Self::Camera { amount: At::Intensity(intensity) } => {
                (Dimension::Intensity, *intensity)
            }
            Self::Photometric { web, factor, .. } => {
                (Dimension::Intensity, *factor * web.brightest())
            }
            Self::Directional { irradiance, .. }
            | Self::Sun { irradiance, .. }
            | Self::Camera { amount: At::Irradiance(irradiance) } => {
                (Dimension::Irradiance, *irradiance)
            }
            Self::Ambient { radiance, .. } => (Dimension::Radiance, *radiance),
        }
    }

    /// Where it is, m; `None` if it is everywhere alike, infinitely far away or at the camera.
    pub fn position(&self) -> Option<DVec3> {
        match self {
            Self::Point { position, .. }
            | Self::Spot { position, .. }
            | Self::Photometric { position, .. } => Some(*position),
            _ => None,
        }
    }
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
