//! A photographer's studio for a model that comes without one: camera, key light, light at the camera, ground.

use super::description::*;
use super::framing::{frame, lowest, size};
use crate::color::Rgb;
use glam::{DAffine3, DQuat, DVec3};
use std::f64::consts::PI;

/// How far below the model the ground lies, relative to the model's size: enough to keep flat models apart from it.
const GAP: f64 = 1e-3;

/// Reflectance of the usual ground.
const GROUND: Rgb = Rgb::splat(0.7);

/// What to put around a model. Every part can be changed or left out; what the model brings itself is kept.
#[derive(Debug, Clone, PartialEq)]
pub struct Studio {
    /// Unit vector that is up, for the camera and the ground.
    pub up: DVec3,
    /// Direction of the camera from the model: anticlockwise around `up` from the front, rad.
    pub azimuth: f64,
    /// Direction of the camera from the model: above the horizon, rad.
    pub elevation: f64,
    /// Irradiance of a surface that faces the key light, which comes over the camera's left shoulder, W·m⁻².
    pub key: Option<f64>,
    /// Irradiance of a surface that faces the light at the camera, W·m⁻².
    pub headlight: Option<f64>,
    /// Reflectance of a ground under the model's lowest point, 0..1.
    pub ground: Option<Rgb>,
    /// Radiance of the background; `None`: that of the ground far away, so that no horizon shows.
    pub background: Option<Rgb>,
}

impl Default for Studio {
    fn default() -> Self {
        Self {
            up: DVec3::Z,
            azimuth: 30_f64.to_radians(),
            elevation: 20_f64.to_radians(),
            key: Some(2.8),
            headlight: Some(0.8),
            ground: Some(GROUND),
            background: None,
        }
    }
}

impl Studio {
    /// Puts the studio around `scene`: a camera if it has none, key light and headlight if it has no lights.
    pub fn dress(&self, scene: &mut SceneDescription) {
        if scene.cameras.is_empty() {
            scene.cameras.push(self.view(scene));
        }
        if scene.lights.is_empty() && scene.environment.is_none() {
            scene.lights.extend(self.lights());
        }
        scene.background = self.background.unwrap_or_else(|| self.far_radiance(scene));
        if let Some(reflectance) = self.ground {
            self.lay_ground(scene, reflectance);
        }
    }

    /// The camera that frames everything from the studio's side.
    pub fn view(&self, scene: &SceneDescription) -> CameraDescription {
        frame(scene, self.toward_camera(), self.up)
    }

    /// Unit vector from the model to the camera. The front is −y, or +z if y is up.
    fn toward_camera(&self) -> DVec3 {
        let front = if self.up.y.abs() > 0.5 { DVec3::Z } else { -DVec3::Y };
        let around = DQuat::from_axis_angle(self.up, self.azimuth) * front;
        around * self.elevation.cos() + self.up * self.elevation.sin()
    }

    /// Unit vector to the key light: left of the camera and high.
    fn toward_key(&self) -> DVec3 {
        let (azimuth, elevation) = (self.azimuth - 50_f64.to_radians(), 48_f64.to_radians());
        Self { azimuth, elevation, ..self.clone() }.toward_camera()
    }

    /// The key light and the light at the camera, those that there are.
    pub fn lights(&self) -> Vec<LightDescription> {
        let key = |e: f64| Light::Directional {
            direction: -self.toward_key(),
            irradiance: Rgb::splat(e as f32),
        };
        let head =
            |e: f64| Light::Camera { amount: CameraLightAmount::Irradiance(Rgb::splat(e as f32)) };
        let key = self.key.map(|e| LightDescription::new("key", key(e)));
        key.into_iter()
            .chain(self.headlight.map(|e| LightDescription::new("headlight", head(e))))
            .collect()
    }

    /// Radiance of the ground far away, where points and the light at the camera no longer reach; of the usual ground
    /// if there is none.
    fn far_radiance(&self, scene: &SceneDescription) -> Rgb {
        let radiance = scene.lights.iter().map(|described| match described.light {
            Light::Directional { direction, irradiance }
            | Light::Sun { direction, irradiance, .. } => {
                irradiance * (direction.dot(-self.up).max(0.0) / PI) as f32
            }
            Light::Ambient { radiance } => radiance,
            _ => Rgb::ZERO,
        });
        self.ground.unwrap_or(GROUND) * radiance.sum::<Rgb>()
    }

    fn lay_ground(&self, scene: &mut SceneDescription, reflectance: Rgb) {
        let (lowest, size) = (lowest(scene, self.up), size(scene));
        let height = lowest - GAP * size;
        scene.materials.push(Material::matte("ground", reflectance));
        scene.surfaces.push(Surface {
            name: "ground".into(),
            shape: Shape::Plane(Plane { point: height * self.up, normal: self.up }),
            material: scene.materials.len() - 1,
            transform: DAffine3::IDENTITY,
        });
    }
}
