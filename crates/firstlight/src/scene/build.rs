//! From the description to the scene.

use super::Scene;
use super::Studio;
use super::description::{
    Alpha, CameraLightAmount, Integrator, Light, LightDescription, Material, SceneDescription,
    Shape, Surface,
};
use super::lights::{area_lights, environment};
use crate::bvh::{BuildQuality, MeshPart, Part, World};
use crate::camera::Camera;
use crate::color::Rgb;
use crate::geometry::Analytic;
use crate::kernels::{ONE_SIDED, PARTLY_THERE};
use crate::shading::light::environment::Sun;
use crate::shading::light::{Cone, Light as BuiltLight, Source};
use crate::simd::Level;
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
        let ambient = description.lights.iter().filter_map(ambient).sum();
        let world = World::build(parts(description), level, quality);
        let material_of: Vec<_> = description.surfaces.iter().map(|s| s.material as u32).collect();
        let sky = description.environment.as_ref();
        let lights = description.lights.iter();
        Self {
            area_lights: area_lights(&world, &material_of, &description.materials),
            environment: sky.map(|sky| (environment(sky), sky.visible)),
            world,
            material_of,
            materials: description.materials.clone(),
            has_panes: description.materials.iter().any(Material::is_pane),
            images: description.images.clone(),
            lights: lights.filter_map(|l| light(l, &camera, description.integrator)).collect(),
            suns: description.lights.iter().filter_map(sun).collect(),
            ambient,
            background: description.background,
            shadows: description.shadows,
            integrator: description.integrator,
            camera,
            film: film.clone(),
            luminous_efficacy: description.luminous_efficacy,
        }
    }
}

fn ambient(light: &LightDescription) -> Option<Rgb> {
    if let Light::Ambient { radiance } = light.light { Some(radiance) } else { None }
}

/// A light without extent, as `integrator` sees it.
fn light(
    described: &LightDescription,
    camera: &Camera,
    integrator: Integrator,
) -> Option<BuiltLight> {
    let source = match described.light {
        Light::Ambient { .. } => return None,
        Light::Point { position, intensity } => Source::Point { position, intensity },
        Light::Spot { position, direction, intensity, inner_angle, outer_angle, falloff } => {
            let cone = Cone::new(direction, inner_angle, outer_angle, falloff);
            Source::Spot { position, intensity, cone }
        }
        Light::Sun { .. } if integrator != Integrator::Direct && described.shadows => return None,
        // Without shadows, or for those who sum over points, its middle stands for it.
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
    description.surfaces.iter().map(|surface| part(description, surface, &instanced)).collect()
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
            return Part::Mesh(MeshPart::new(triangles, *transform, instanced(*mesh), flags));
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
    let solid = material.alpha == Alpha::Opaque && !material.is_pane();
    let partly_there = if solid { 0 } else { PARTLY_THERE };
    one_sided | partly_there
}
