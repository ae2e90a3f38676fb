//! A few rays into a scene: what the camera sees, and from where light may come to it.

use crate::geometry::{Hit, Ray};
use crate::math::{concentric, hash, tangents};
use crate::sampler::Sampler;
use crate::scene::description::{Integrator, Material, Scattering};
use crate::scene::{Meets, Scene, SeenByCamera};
use crate::shading::interaction::SurfaceInteraction;
use glam::{DVec3, Vec2, Vec3};

/// Rays of the camera, in the middle of the time that its shutter is open.
const RAYS: u32 = 512;
/// Those that look for what is small, if the others have met nothing.
const MANY_RAYS: u32 = 1 << 15;
/// Reflections by which light is looked for, at most.
const REFLECTIONS: u32 = 4;

/// What a few hundred rays of the camera meet, and what rays from there meet in turn.
pub(super) struct Probes {
    /// Rays of the camera, evenly spread over the picture.
    pub rays: Vec<Probe>,
    /// Points that light would have to reach to be seen: first those that the camera sees.
    pub witnesses: Vec<Witness>,
    /// Rays from witnesses that met nothing.
    pub escaped: u32,
    /// Number of a studio's ground.
    ground: Option<u32>,
}

/// A ray of the camera.
pub(super) struct Probe {
    /// Where it crosses the picture, 0..1 from the upper left.
    pub film: Vec2,
    /// The ray.
    pub ray: Ray,
    /// What the camera sees along it.
    pub hit: Hit,
    /// What is there first, seen or not.
    pub first: Hit,
}

/// A point of a surface that passes light on to the camera.
#[derive(Clone, Copy)]
pub(super) struct Witness {
    /// Number of the surface.
    pub surface: u32,
    /// Whether its front is seen.
    pub front: bool,
    /// Where it is, m.
    pub position: DVec3,
    /// Unit normal on the side it is seen from.
    pub normal: Vec3,
    /// Where rays start, on that side and on the other.
    pub start: Vec3,
    pub behind: Vec3,
    /// Whether light from the other side counts as well.
    pub passes_light: bool,
    /// Which of the camera's rays led here.
    pub probe: usize,
    /// Whether the camera sees it.
    pub seen: bool,
    /// Whether it is a part of what is to be shown: a studio's ground is not.
    pub counts: bool,
}

impl Probes {
    /// Sends them out. `ground` is no part of what is to be shown.
    pub(super) fn send(scene: &Scene, ground: Option<u32>) -> Self {
        let rays = rays(scene, RAYS);
        let mut probes = Self { rays, witnesses: Vec::new(), escaped: 0, ground };
        let mut walks = Vec::new();
        for (number, probe) in probes.rays.iter().enumerate().filter(|(_, p)| p.hit.is_some()) {
            let point = scene.interaction(&probe.ray, &probe.hit);
            let counts = probes.counts(&probe.hit);
            walks.push((probe.ray, Witness { counts, ..witness(scene, &point, number, true) }));
        }
        let most = match scene.integrator {
            Integrator::Path { bounces } => bounces.unwrap_or(REFLECTIONS).min(REFLECTIONS),
            _ => 1,
        };
        for reflections in 1..=most {
            probes.witnesses.extend(walks.iter().map(|(_, witness)| *witness));
            let last = reflections == most;
            let next: Vec<Ray> = (0_u64..).zip(&walks).map(|(i, w)| onward(scene, w, i)).collect();
            let mut hits = Vec::new();
            scene.world.closest_hits(&next, &Meets(scene, 0), &mut hits);
            probes.escaped += hits.iter().filter(|hit| !hit.is_some()).count() as u32;
            let met = next.iter().zip(&hits).zip(&walks).filter(|((_, hit), _)| hit.is_some());
            let met = met.map(|((ray, hit), (_, from))| {
                (*ray, witness(scene, &scene.interaction(ray, hit), from.probe, false))
            });
            walks = if last { Vec::new() } else { met.collect() };
        }
        probes
    }

    /// What the camera sees of what is to be shown.
    pub(super) fn seen(&self) -> impl Iterator<Item = &Witness> {
        self.witnesses.iter().take_while(|witness| witness.seen).filter(|witness| witness.counts)
    }

    /// Whether a ray has met something that is to be shown.
    pub(super) fn counts(&self, hit: &Hit) -> bool {
        hit.is_some() && Some(hit.surface) != self.ground
    }

    /// Whether anything that is to be shown is in the picture, however small.
    pub(super) fn any_seen(&self, scene: &Scene) -> bool {
        let seen = |rays: &[Probe]| rays.iter().any(|probe| self.counts(&probe.hit));
        seen(&self.rays) || seen(&rays(scene, MANY_RAYS))
    }
}

/// The camera's rays through a net of so many points.
fn rays(scene: &Scene, count: u32) -> Vec<Probe> {
    let camera = scene.camera();
    let size = Vec2::new(camera.width() as f32, camera.height() as f32);
    let films: Vec<Vec2> = (0..count).map(Sampler::unscrambled).collect();
    let rays: Vec<Ray> =
        films.iter().map(|film| camera.ray(*film * size, Vec2::ZERO, 0.5)).collect();
    let (mut hits, mut first) = (Vec::new(), Vec::new());
    scene.world.closest_hits(&rays, &SeenByCamera(scene, 0), &mut hits);
    scene.world.closest_hits(&rays, &Meets(scene, 0), &mut first);
    let all = films.iter().zip(rays).zip(hits.into_iter().zip(first));
    all.map(|((film, ray), (hit, first))| Probe { film: *film, ray, hit, first }).collect()
}

fn witness(scene: &Scene, point: &SurfaceInteraction, probe: usize, seen: bool) -> Witness {
    Witness {
        surface: point.hit.surface,
        front: point.front,
        position: point.position.as_dvec3(),
        normal: point.geometric_normal,
        start: point.ray_origin(),
        behind: point.behind(),
        passes_light: passes_light(scene, scene.material(&point.hit)),
        probe,
        seen,
        counts: true,
    }
}

/// Whether light gets through a material.
fn passes_light(scene: &Scene, material: &Material) -> bool {
    match &material.scattering {
        Scattering::Dielectric { .. } | Scattering::ThinGlass { .. } => true,
        Scattering::Principled(p) => !p.transmission.is(0.0) || !p.diffuse_transmission.is(0.0),
        Scattering::Mix { materials, .. } => {
            materials.iter().any(|&part| passes_light(scene, &scene.materials[part]))
        }
        _ => false,
    }
}

/// A ray that goes on from a witness: straight through every second time if light does, else mirrored or to anywhere.
fn onward(scene: &Scene, (arrived, from): &(Ray, Witness), number: u64) -> Ray {
    let chance = hash(number ^ hash(u64::from(arrived.origin.x.to_bits())));
    if from.passes_light && chance.is_multiple_of(2) {
        return Ray { origin: from.behind, ..*arrived };
    }
    let material = &scene.materials[scene.material_of[from.surface as usize] as usize];
    let mirrored = arrived.direction.reflect(from.normal);
    let mirrors = material.shows_its_surroundings() && chance >> 1 & 1 == 0;
    let direction = if mirrors { mirrored } else { diffuse(from.normal, chance) };
    Ray { time: arrived.time, ..Ray::new(from.start, direction) }
}

/// A unit direction over a surface, by the cosine.
fn diffuse(normal: Vec3, chance: u64) -> Vec3 {
    let unit = |bits: u64| (bits & 0xFFFF) as f32 / 65_536.0;
    let disk = concentric(Vec2::new(unit(chance >> 16), unit(chance >> 40))).as_dvec2();
    let (tangent, bitangent) = tangents(normal.as_dvec3());
    let up = (1.0 - disk.length_squared()).max(1e-6).sqrt();
    (disk.x * tangent + disk.y * bitangent + up * normal.as_dvec3()).normalize().as_vec3()
}
