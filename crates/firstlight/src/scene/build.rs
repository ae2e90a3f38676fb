//! From the description to the scene.

use super::Studio;
use super::description::{
    Alpha, CameraLightAmount, Light, LightDescription, Material, SceneDescription, Shape, Surface,
};
use super::lights::{LocalLights, area_lights, environment, mean_emission};
use super::material::plain_surfaces;
use super::{NearAmbient, Scene};
use crate::bvh::{BuildQuality, MeshPart, Part, World};
use crate::camera::Camera;
use crate::color::Rgb;
use crate::geometry::Analytic;
use crate::kernels::{ONE_SIDED, PARTLY_THERE};
use crate::shading::light::environment::Sun;
use crate::shading::light::{Cone, Light as BuiltLight, RoundLight, Source};
use crate::shading::texture::Picture;
use crate::simd::Level;
use glam::DMat3;
use std::sync::Arc;

/// A mesh whose copies would have more triangles than this is instanced; otherwise its copies stand in the world's
/// own tree, where they are traced faster.
const FLATTENED_TRIANGLES: usize = 1 << 18;

impl Scene {
    /// Builds the scene for tracing, with the best instructions that the processor has.
    ///
    /// The description must be sound, see [`SceneDescription::check`].
    pub fn build(description: &SceneDescription) -> Self {
        Self::build_with(description, Level::detect(), BuildQuality::Final)
    }

    /// Builds the scene to be traced with the instructions of `level`, with as much work on its trees as `quality` asks
    /// for. The picture is the same for all of them.
    pub fn build_with(description: &SceneDescription, level: Level, quality: BuildQuality) -> Self {
        let film = &description.film;
        let studio = Studio { up: description.up.0, ..Studio::default() };
        let view = description.cameras.first().cloned().unwrap_or_else(|| studio.view(description));
        let camera = Camera::new(&view, film.width, film.height);
        let (near_numbers, near_ambient) = numbered(description, near_ambient);
        let near_ambient = near_ambient.into_iter().zip(near_numbers);
        let near_ambient = near_ambient.map(|(light, number)| NearAmbient { number, ..light });
        let ambient = description.lights.iter().filter_map(ambient).sum();
        let motions = description.surfaces.iter().map(|surface| surface.motion).collect();
        let world = World::build(parts(description), motions, level, quality);
        let material_of: Vec<_> = description.surfaces.iter().map(|s| s.material as u32).collect();
        let sky = description.environment.as_ref();
        let (light_numbers, lights) = numbered(description, |light| pointlike(light, &camera));
        let (round_numbers, round_lights) = numbered(description, |light| round(light, &camera));
        let (sun_numbers, suns) = numbered(description, sun);
        let area_lights = area_lights(&world, &material_of, &description.materials);
        let mean = |material| mean_emission(material, &description.images);
        let mean_of: Vec<_> = description.materials.iter().map(mean).collect();
        let emission = |surface: u32| mean_of[material_of[surface as usize] as usize];
        let local_lights =
            LocalLights::new(&lights, &round_lights, &area_lights, level, emission, &world);
        Self {
            is_lecture: description.is_lecture(),
            plain: plain_surfaces(&world, &material_of, &description.materials),
            local_lights,
            area_lights,
            environment: sky.map(|sky| (environment(sky), sky.visible)),
            world,
            material_of,
            materials: description.materials.clone(),
            has_blends: description.materials.iter().any(|m| m.alpha == Alpha::Blend),
            has_panes: description.materials.iter().any(Material::passes_light),
            has_solids: description.materials.iter().any(|material| material.interior.is_some()),
            medium: description.medium,
            cone: camera.cone(film.samples),
            pictures: description.images.iter().cloned().map(Picture::new).collect(),
            lights,
            round_lights,
            suns,
            light_numbers,
            round_numbers,
            sun_numbers,
            ambient,
            near_ambient: near_ambient.collect(),
            background: description.background,
            shadows: description.shadows,
            integrator: description.integrator,
            camera,
            film: film.clone(),
            luminous_efficacy: description.luminous_efficacy,
        }
    }
}

/// What becomes of the lights that are of one kind, with their places in the description.
fn numbered<T>(
    description: &SceneDescription,
    build: impl Fn(&LightDescription) -> Option<T>,
) -> (Vec<u32>, Vec<T>) {
    let lights = (0..).zip(&description.lights);
    lights.filter_map(|(number, light)| Some((number, build(light)?))).unzip()
}

fn ambient(light: &LightDescription) -> Option<Rgb> {
    match light.light {
        Light::Ambient { radiance, reach: f64::INFINITY } => Some(radiance),
        _ => None,
    }
}

/// Ambient light that near surfaces keep out.
fn near_ambient(light: &LightDescription) -> Option<NearAmbient> {
    match light.light {
        Light::Ambient { radiance, reach } if reach.is_finite() => {
            Some(NearAmbient { radiance, reach: reach as f32, number: 0 })
        }
        _ => None,
    }
}

/// A light without extent; if it has one, but casts no shadows that could tell, its middle.
fn pointlike(described: &LightDescription, camera: &Camera) -> Option<BuiltLight> {
    if described.has_extent() { None } else { light_middle(described, camera) }
}

/// A sphere that shines in place of a point.
fn round(described: &LightDescription, camera: &Camera) -> Option<RoundLight> {
    let is_round = described.has_extent() && described.radius > 0.0;
    RoundLight::new(&light_middle(described, camera).filter(|_| is_round)?, described.radius)
}

/// The light as if it had no extent; `None` if it comes from everywhere.
pub(crate) fn light_middle(described: &LightDescription, camera: &Camera) -> Option<BuiltLight> {
    let source = match described.light {
        Light::Ambient { .. } => return None,
        Light::Point { position, intensity } => Source::Point { position, intensity },
        Light::Spot { position, direction, intensity, inner_angle, outer_angle, falloff } => {
            let cone = Cone::new(direction, inner_angle, outer_angle, falloff);
            Source::Spot { position, intensity, cone }
        }
        Light::Photometric { position, rotation, ref web, factor } => {
            let to_luminaire = DMat3::from_quat(rotation.inverse());
            Source::Photometric { position, to_luminaire, web: Arc::clone(web), factor }
        }
        Light::Directional { direction, irradiance } | Light::Sun { direction, irradiance, .. } => {
            Source::Directional { toward: -direction.as_vec3(), irradiance }
        }
        Light::Camera { amount } => at_camera(amount, camera),
    };
    let is_visible = !matches!(described.light, Light::Camera { .. });
    Some(BuiltLight { source, shadows: described.shadows && is_visible })
}

/// A light with extent, infinitely far away.
fn sun(described: &LightDescription) -> Option<Sun> {
    match described.light {
        Light::Sun { direction, irradiance, angular_radius } if described.shadows => {
            Some(Sun::new(-direction, angular_radius, irradiance))
        }
        _ => None,
    }
}

fn at_camera(amount: CameraLightAmount, camera: &Camera) -> Source {
    match (amount, camera.eye()) {
        (CameraLightAmount::Intensity(intensity), Some(position)) => {
            Source::Point { position, intensity }
        }
        (CameraLightAmount::Irradiance(irradiance), Some(position)) => {
            Source::Headlight { position, irradiance }
        }
        (
            CameraLightAmount::Intensity(irradiance) | CameraLightAmount::Irradiance(irradiance),
            None,
        ) => Source::Directional { toward: -camera.forward(), irradiance },
    }
}

fn parts(description: &SceneDescription) -> Vec<Part> {
    let mut uses = vec![0_usize; description.meshes.len()];
    for surface in &description.surfaces {
        if let Shape::Mesh(mesh) = surface.shape {
            uses[mesh] += 1;
        }
    }
    let instanced = |mesh: usize| {
        uses[mesh] > 1
            && uses[mesh] * description.meshes[mesh].triangles.len() > FLATTENED_TRIANGLES
    };
    let part = |surface: &Surface| {
        let part = part(description, surface, &instanced);
        if surface.motion.is_some() { part.on_its_own() } else { part }
    };
    description.surfaces.iter().map(part).collect()
}

pub(super) fn part(
    description: &SceneDescription,
    surface: &Surface,
    instanced: &impl Fn(usize) -> bool,
) -> Part {
    let flags = flags(&description.materials[surface.material]);
    let transform = &surface.transform;
    let analytic = match &surface.shape {
        Shape::Mesh(mesh) => {
            let triangles = Arc::clone(&description.meshes[*mesh]);
            let instanced = surface.motion.is_some() || instanced(*mesh);
            return Part::Mesh(MeshPart::new(triangles, *transform, instanced, flags));
        }
        Shape::Sphere(sphere) => Analytic::sphere(sphere, transform),
        Shape::Plane(plane) => Analytic::plane(plane, transform),
        Shape::Disk(disk) => Analytic::disk(disk, transform),
        Shape::Quad(quad) => Analytic::quad(quad, transform),
        Shape::Block(block) => Analytic::block(block, transform),
        Shape::Cylinder(cylinder) => Analytic::cylinder(cylinder, transform),
        Shape::Cone(cone) => Analytic::cone(cone, transform),
    };
    Part::Analytic(analytic, flags)
}

/// What traversal has to ask about surfaces of this material.
fn flags(material: &Material) -> u32 {
    let one_sided = if material.double_sided && material.visible { 0 } else { ONE_SIDED };
    let solid = material.alpha == Alpha::Opaque && !material.passes_light();
    let partly_there = if solid { 0 } else { PARTLY_THERE };
    one_sided | partly_there
}
