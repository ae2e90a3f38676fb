//! What the camera sees in the middle of each pixel.

use super::{Channel, Layer};
use crate::color::Rgb;
use crate::geometry::{Hit, Ray};
use crate::integrator::{Gatherer, Way};
use crate::sampler::{PathPoints, Sampler};
use crate::scene::description::{Integrator, Mesh, SceneDescription, Shape};
use crate::scene::{Scene, Solid};
use crate::shading::bsdf::Frame;
use crate::shading::interaction::SurfaceInteraction;
use crate::units::photometric;
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::collections::HashMap;
use std::f32::consts::PI;
use std::sync::Arc;

/// Samples of a pixel that are taken without asking whether to stop.
const BATCH: u32 = 256;

/// What there is in the middle of one pixel.
#[derive(Debug, Clone, Copy, Default)]
struct Seen {
    depth: f32,
    distance: f32,
    position: Vec3,
    normal: Vec3,
    geo_normal: Vec3,
    uv: Vec3,
    albedo: Rgb,
    roughness: f32,
    object: u32,
    material: u32,
    primitive: u32,
    instance: u32,
    facing: f32,
    ao: f32,
    irradiance: Rgb,
}

/// The wanted layers of data for the rectangle at `origin` of size `size` of the scene's picture. `scene` was built
/// from `description`. Where light has to be measured, that takes so many `samples`, unless `stop` says to leave off: what
/// was not measured by then is 0.
pub fn data_layers(
    scene: &Scene,
    description: &SceneDescription,
    [origin, size]: [[u32; 2]; 2],
    wanted: &[Layer],
    samples: u32,
    stop: &(dyn Fn() -> bool + Sync),
) -> Vec<Channel> {
    let viewer = Viewer::new(scene, description, wanted, samples, stop);
    let row = |gatherer: &mut Gatherer, y: u32| {
        let columns = origin[0]..origin[0] + size[0];
        columns.map(|x| viewer.see(x, origin[1] + y, gatherer)).collect()
    };
    let rows: Vec<Vec<Seen>> =
        (0..size[1]).into_par_iter().map_init(Gatherer::default, row).collect();
    let seen: Vec<Seen> = rows.into_iter().flatten().collect();
    wanted.iter().flat_map(|layer| channels(scene, *layer, &seen)).collect()
}

struct Viewer<'a> {
    scene: &'a Scene,
    sampler: Sampler,
    samples: u32,
    stop: &'a (dyn Fn() -> bool + Sync),
    light: Option<Way<'a>>,
    sky: Option<Way<'a>>,
    instances: Vec<u32>,
}

impl<'a> Viewer<'a> {
    fn new(
        scene: &'a Scene,
        description: &SceneDescription,
        wanted: &[Layer],
        samples: u32,
        stop: &'a (dyn Fn() -> bool + Sync),
    ) -> Self {
        let measures = [Layer::Irradiance, Layer::Illuminance];
        let measures_light = wanted.iter().any(|layer| measures.contains(layer));
        let sees_sky = wanted.contains(&Layer::Ao);
        Self {
            scene,
            sampler: Sampler::new(scene.film().seed, samples),
            samples,
            stop,
            light: measures_light.then(|| Way::of(scene, false)),
            sky: sees_sky.then(|| Way::to_sky(scene, occlusion_distance(description))),
            instances: instances(description),
        }
    }

    fn see(&self, x: u32, y: u32, gatherer: &mut Gatherer) -> Seen {
        let ray = self.scene.camera().get_ray(x, y);
        let mut hits = Vec::<Hit>::new();
        self.scene.world.closest_hits(&[ray], &Solid(self.scene), &mut hits);
        match hits[0].is_some() {
            true => {
                let (seen, at) = self.describe(&ray, &hits[0]);
                self.measure(seen, &at, |sample| self.sampler.points(x, y, sample), gatherer)
            }
            false => Seen { depth: f32::INFINITY, distance: f32::INFINITY, ..Seen::default() },
        }
    }

    fn describe(&self, ray: &Ray, hit: &Hit) -> (Seen, SurfaceInteraction) {
        let (at, frame, albedo) = meet(self.scene, ray, hit);
        let material = self.scene.material(hit);
        let seen = Seen {
            depth: (at.position - ray.origin).dot(self.scene.camera().forward()),
            distance: hit.t,
            position: at.position,
            normal: frame.normal(),
            geo_normal: at.geometric_normal,
            uv: at.uv.extend(0.0),
            albedo,
            roughness: self.scene.roughness(material, &at),
            object: hit.surface + 1,
            material: self.scene.material_of[hit.surface as usize] + 1,
            primitive: hit.primitive + 1,
            instance: self.instances[hit.surface as usize],
            facing: frame.normal().dot(-ray.direction),
            ..Seen::default()
        };
        (seen, at)
    }

    /// Adds what takes more rays, one for each sample.
    fn measure(
        &self,
        mut seen: Seen,
        at: &SurfaceInteraction,
        point: impl Fn(u32) -> PathPoints,
        gatherer: &mut Gatherer,
    ) -> Seen {
        let (position, normal) = (at.position.as_dvec3(), at.geometric_normal);
        let mut measure = |way: &Way<'_>| {
            let mut sum = DVec3::ZERO;
            for first in (0..self.samples).step_by(BATCH as usize) {
                if (self.stop)() {
                    return Rgb::ZERO;
                }
                let batch = first..self.samples.min(first + BATCH);
                let points: Vec<_> = batch.map(&point).collect();
                sum += points.len() as f64 * way.irradiance(position, normal, &points, gatherer);
            }
            (sum / f64::from(self.samples)).as_vec3()
        };
        seen.irradiance = self.light.as_ref().map_or(Rgb::ZERO, &mut measure);
        seen.ao = self.sky.as_ref().map_or(0.0, |sky| measure(sky).x / PI);
        seen
    }
}

/// The point that a ray hits, the frame that light is reckoned in there, and the fraction of light that is scattered.
pub(crate) fn meet(scene: &Scene, ray: &Ray, hit: &Hit) -> (SurfaceInteraction, Frame, Rgb) {
    let (at, material) = (scene.interaction(ray, hit), scene.material(hit));
    let boundary = scene.boundary_from_air(material, &at);
    let (frame, albedo) = scene.add_lobes(material, &at, -ray.direction, boundary, &mut Vec::new());
    (at, frame, albedo)
}

/// How far surfaces may be that keep the sky from others: what the scene says, or a tenth of what it takes up.
fn occlusion_distance(description: &SceneDescription) -> f64 {
    match description.integrator {
        Integrator::AmbientOcclusion { distance } => distance,
        _ => crate::scene::bounds(description)
            .map_or(f64::INFINITY, |[lo, hi]| 0.1 * (hi - lo).length()),
    }
}

/// The number of each surface among those of the same mesh.
fn instances(description: &SceneDescription) -> Vec<u32> {
    let mut uses = HashMap::<*const Mesh, u32>::new();
    let number = |shape: &Shape| match shape {
        Shape::Mesh(mesh) => {
            let count = uses.entry(Arc::as_ptr(&description.meshes[*mesh])).or_default();
            *count += 1;
            *count
        }
        _ => 1,
    };
    description.surfaces.iter().map(|surface| &surface.shape).map(number).collect()
}

fn channels(scene: &Scene, layer: Layer, seen: &[Seen]) -> Vec<Channel> {
    let number =
        |name: &str, of: fn(&Seen) -> f32| vec![Channel::numbers(name, seen.iter().map(of))];
    let whole = |name: &str, of: fn(&Seen) -> u32| vec![Channel::whole(name, seen.iter().map(of))];
    let triple = |name: &str, letters: &[&str], of: fn(&Seen) -> Vec3| {
        let channel = |(index, letter): (usize, &&str)| {
            Channel::numbers(format!("{name}.{letter}"), seen.iter().map(|seen| of(seen)[index]))
        };
        letters.iter().enumerate().map(channel).collect::<Vec<_>>()
    };
    let (xyz, rgb) = (["X", "Y", "Z"], ["R", "G", "B"]);
    match layer {
        Layer::Depth => number("Z", |seen| seen.depth),
        Layer::Distance => number("distance", |seen| seen.distance),
        Layer::Position => triple("P", &xyz, |seen| seen.position),
        Layer::Normal => triple("N", &xyz, |seen| seen.normal),
        Layer::GeoNormal => triple("Ng", &xyz, |seen| seen.geo_normal),
        Layer::Uv => triple("uv", &["U", "V"], |seen| seen.uv),
        Layer::Albedo => triple("albedo", &rgb, |seen| seen.albedo),
        Layer::Roughness => number("roughness", |seen| seen.roughness),
        Layer::Object => whole("object", |seen| seen.object),
        Layer::Material => whole("material", |seen| seen.material),
        Layer::Primitive => whole("primitive", |seen| seen.primitive),
        Layer::Instance => whole("instance", |seen| seen.instance),
        Layer::Facing => number("facing", |seen| seen.facing),
        Layer::Ao => number("ao", |seen| seen.ao),
        Layer::Irradiance => triple("irradiance", &rgb, |seen| seen.irradiance),
        Layer::Illuminance => {
            let efficacy = scene.luminous_efficacy().0;
            let lux = seen.iter().map(|seen| photometric(seen.irradiance, efficacy) as f32);
            vec![Channel::numbers("illuminance", lux)]
        }
        _ => Vec::new(),
    }
}
