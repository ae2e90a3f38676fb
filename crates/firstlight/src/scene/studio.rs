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

/// Radiance of the surroundings straight up, at the horizon and straight down, W·sr⁻¹·m⁻².
const SKY: [f32; 3] = [0.6, 0.35, 0.2];
/// Irradiance of a ground under that sky, W·m⁻²: the integral of radiance × cosine.
const UNDER_SKY: f64 = PI * SKY[1] as f64 + 2.0 / 3.0 * PI * (SKY[0] - SKY[1]) as f64;
/// The part of the key light that is left beside the sky.
const KEY_BESIDE_SKY: f64 = 0.6;

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
    /// Whether something soft to be mirrored stands around a model that is not all matte: a sky in place of the light at
    /// the camera and of a part of the key light, with light that bounces.
    pub surroundings: bool,
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
            surroundings: true,
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
        let bare = scene.lights.is_empty() && scene.environment.is_none();
        let mirrors = !scene.materials.iter().all(Material::is_matte);
        let surrounded = bare && mirrors && self.surroundings;
        if surrounded {
            self.surround(scene);
        } else if bare {
            scene.lights.extend(self.lights());
        }
        let far = self.far_radiance(scene, surrounded);
        scene.background = self.background.unwrap_or(far);
        if let Some(reflectance) = self.ground {
            self.lay_ground(scene, reflectance);
        }
    }

    /// Lights what mirrors: black metal is what stands in an empty room.
    fn surround(&self, scene: &mut SceneDescription) {
        let key = self.key.map(|irradiance| KEY_BESIDE_SKY * irradiance);
        scene.lights.extend(Self { key, headlight: None, ..self.clone() }.lights());
        scene.integrator = Integrator::Path { bounces: None };
        let [zenith, horizon, nadir] = SKY.map(Rgb::splat);
        scene.environment = Some(EnvironmentDescription {
            sky: Sky::Gradient { zenith, horizon, nadir },
            factor: Rgb::ONE,
            rotation: DQuat::from_rotation_arc(DVec3::Z, self.up),
            visible: false,
        });
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
    fn far_radiance(&self, scene: &SceneDescription, surrounded: bool) -> Rgb {
        let radiance = scene.lights.iter().map(|described| match described.light {
            Light::Directional { direction, irradiance }
            | Light::Sun { direction, irradiance, .. } => {
                irradiance * (direction.dot(-self.up).max(0.0) / PI) as f32
            }
            Light::Ambient { radiance, .. } => radiance,
            _ => Rgb::ZERO,
        });
        let sky = if surrounded { (UNDER_SKY / PI) as f32 } else { 0.0 };
        self.ground.unwrap_or(GROUND) * (radiance.sum::<Rgb>() + sky)
    }

    fn lay_ground(&self, scene: &mut SceneDescription, reflectance: Rgb) {
        let (lowest, size) = (lowest(scene, self.up), size(scene));
        let height = lowest - GAP * size;
        scene.materials.push(Material::matte("ground", reflectance));
        scene.ground = Some(scene.surfaces.len());
        scene.surfaces.push(Surface {
            name: "ground".into(),
            shape: Shape::Plane(Plane { point: height * self.up, normal: self.up }),
            material: scene.materials.len() - 1,
            transform: DAffine3::IDENTITY,
            motion: None,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Scene;

    fn ball(material: Material, up: DVec3) -> SceneDescription {
        let mut scene = SceneDescription::default();
        scene.materials.push(material);
        let shape = Shape::Sphere(Sphere { center: DVec3::ZERO, radius: 0.5 });
        let transform = DAffine3::IDENTITY;
        let name = "ball".into();
        scene.surfaces.push(Surface { name, shape, material: 0, transform, motion: None });
        Studio { up, ..Studio::default() }.dress(&mut scene);
        scene
    }

    /// No horizon shows: far away the ground is as bright as what is behind it, whichever way the model stands and
    /// whether it is matte or not.
    #[test]
    fn the_ground_goes_over_into_the_background() {
        let matte = || Material::matte("matte", Rgb::splat(0.5));
        let mirror = || Material::mirror("mirror", Rgb::splat(0.5));
        for material in [matte(), mirror()] {
            for up in [DVec3::Y, DVec3::Z] {
                let described = ball(material.clone(), up);
                let scene = Scene::build(&described);
                let aside = up.any_orthogonal_vector() * 1e3;
                let seen = scene.irradiance(aside - 0.4999 * up, up).value;
                let background = described.background;
                let ground = seen * GROUND / PI as f32;
                assert!((ground / background - 1.0).abs().max_element() < 5e-3, "{ground} {up}");
            }
        }
    }

    #[test]
    fn what_mirrors_has_something_to_mirror() {
        let scene = ball(Material::mirror("mirror", Rgb::splat(0.9)), DVec3::Z);
        let toward = (scene.cameras[0].target - scene.cameras[0].position).normalize();
        let ray = crate::Ray::new(scene.cameras[0].position.as_vec3(), toward.as_vec3());
        let seen = Scene::build(&scene).radiance(&ray).value;
        assert!(seen.min_element() > 0.1, "{seen}");
    }
}
