//! Every way that light takes to the eye: L = L_emitted + ∫ f · L · cos θ, followed from the eye's end.
//!
//! Kajiya, *The Rendering Equation*, 1986. At each surface, all lights are asked as in the lecture; then the path goes
//! on in a direction picked by the BSDF. A light that both may find is weighted by how likely each is to find it (the
//! balance heuristic; Veach 1997 §9.2), so that nothing is counted twice. Batches of paths go through the stages
//! together, bounce by bounce; what one path gathers depends on no other.

mod occlusion;

pub(crate) use occlusion::Occlusion;

use super::RayCounts;
use super::dimensions::Bounce;
use crate::color::Rgb;
use crate::film::Sample;
use crate::geometry::{Hit, Ray};
use crate::sampler::PathPoints;
use crate::scene::{LocalLight, LocalLights, Scene, SeenByCamera, StopsLight};
use crate::shading::bsdf::Bsdf;
use crate::shading::interaction::{SurfaceInteraction, clearance};
use crate::shading::light::LightSample;
use crate::shading::light::area::AreaLight;
use crate::shading::light::environment::EnvironmentSample;
use glam::{DVec3, Vec2, Vec3};
use std::f32::consts::PI;

/// Up to so many lights are all asked at the surface that is seen, as in the lecture, and after that.
const ASKED: [u32; 2] = [32, 1];
/// Up to this reflection, paths end only where nothing is left of them.
const SAFE_BOUNCES: u32 = 4;
/// From this reflection on, even paths that lose nothing end sometimes, so that light between perfect mirrors does.
const MANY_BOUNCES: u32 = 1000;

/// Of the two numbers that pick a light, the second has the digits behind the first's.
const PAIR_STEP: f64 = 1.0 / (1 << 24) as f64;

/// Follows paths.
pub(crate) struct Path<'a> {
    scene: &'a Scene,
    transparent: bool,
    /// Reflections at most.
    bounces: u32,
}

/// Buffers that one worker reuses from batch to batch.
#[derive(Default)]
pub(crate) struct Scratch {
    rays: Vec<Ray>,
    /// What leads to each ray.
    walks: Vec<Walk>,
    hits: Vec<Hit>,
    vertices: Vec<Vertex>,
    shadow_rays: Vec<Ray>,
    awaited: Vec<Awaited>,
    occluded: Vec<bool>,
    /// One answer per camera ray.
    pub samples: Vec<Sample>,
    /// What was traced so far.
    pub counts: RayCounts,
    /// Which camera rays met a surface.
    on_surface: Vec<u32>,
}

/// A path up to its last ray.
#[derive(Clone, Copy)]
struct Walk {
    /// Index of the camera ray.
    sample: u32,
    /// What the light along the last ray is multiplied by on its way to the eye.
    throughput: Rgb,
    /// Density with which the last direction was picked, sr⁻¹; infinite if there was no other.
    pdf: f32,
    /// Shading normal of the surface that the last ray left.
    normal: Vec3,
    /// Whether only mirrors lie between the eye and the last ray.
    mirrors_only: bool,
}

/// A point where a path is reflected.
struct Vertex {
    walk: Walk,
    /// Where it is, m.
    position: Vec3,
    /// Where rays leave it.
    start: Vec3,
    shading_normal: Vec3,
    outgoing: Vec3,
    bsdf: Bsdf,
}

/// What a light gives to a vertex, reflected towards the eye.
struct Answer {
    /// The ray that anything in the way would stop; `None` if nothing can.
    ray: Option<Ray>,
    radiance: Rgb,
}

/// Light that reaches the eye if nothing is in the way.
struct Awaited {
    sample: u32,
    radiance: Rgb,
}

impl<'a> Path<'a> {
    /// Follows paths in `scene` over at most so many reflections.
    pub(crate) fn new(scene: &'a Scene, transparent: bool, bounces: Option<u32>) -> Self {
        Self { scene, transparent, bounces: bounces.unwrap_or(u32::MAX) }
    }

    /// Radiance along each of `rays`, one sample each by its `points`, into `scratch.samples`.
    #[inline(always)]
    pub(crate) fn gather(&self, rays: &[Ray], points: &[PathPoints], scratch: &mut Scratch) {
        self.look(rays, scratch);
        self.arrive(0, scratch);
        self.follow(points, scratch);
    }

    /// Traces the camera rays.
    #[inline(always)]
    fn look(&self, rays: &[Ray], scratch: &mut Scratch) {
        scratch.begin(rays.len());
        scratch.counts.camera += rays.len() as u64;
        scratch.rays.extend_from_slice(rays);
        scratch.walks.extend((0..rays.len() as u32).map(Walk::from_eye));
        let filter = SeenByCamera(self.scene, 0);
        self.scene.world.closest_hits(&scratch.rays, &filter, &mut scratch.hits);
    }

    /// Irradiance at `position` on a surface that faces the unit vector `normal`, W·m⁻², one sample for each of
    /// `points`: what a surface that reflects π times the light would send out.
    pub(crate) fn irradiance(
        &self,
        position: DVec3,
        normal: Vec3,
        points: &[PathPoints],
        scratch: &mut Scratch,
    ) {
        self.stand(position, normal, points.len(), scratch);
        scratch.samples.iter_mut().for_each(|sample| sample.radiance = PI * self.scene.ambient);
        self.follow(points, scratch);
    }

    /// Begins `count` paths at `position` on a surface that faces `normal` and reflects π times the light.
    fn stand(&self, position: DVec3, normal: Vec3, count: usize, scratch: &mut Scratch) {
        let position = position.as_vec3();
        let start = position + clearance(normal, position.abs(), 0.0) * normal;
        let bsdf = Bsdf::Lambert { reflectance: Rgb::splat(PI) };
        scratch.begin(count);
        scratch.vertices.extend((0..count as u32).map(|sample| Vertex {
            walk: Walk { mirrors_only: false, ..Walk::from_eye(sample) },
            position,
            start,
            shading_normal: normal,
            outgoing: normal,
            bsdf,
        }));
    }

    /// Goes on from the vertices of the first bounce until all paths have ended.
    #[inline(always)]
    fn follow(&self, points: &[PathPoints], scratch: &mut Scratch) {
        for bounce in 0..self.bounces {
            if scratch.vertices.is_empty() {
                break;
            }
            self.add_lights(bounce, points, scratch);
            scatter(bounce, points, scratch);
            scratch.counts.bounce += scratch.rays.len() as u64;
            let filter = StopsLight(self.scene, 0);
            self.scene.world.closest_hits(&scratch.rays, &filter, &mut scratch.hits);
            self.arrive(bounce + 1, scratch);
        }
    }

    /// Adds what comes along each ray, and makes vertices of the surfaces that were met.
    #[inline(always)]
    fn arrive(&self, bounce: u32, scratch: &mut Scratch) {
        let Scratch { rays, walks, hits, vertices, samples, on_surface, .. } = scratch;
        vertices.clear();
        for ((ray, walk), hit) in rays.iter().zip(&*walks).zip(&*hits) {
            let sample = &mut samples[walk.sample as usize];
            if !hit.is_some() {
                if bounce == 0 && self.transparent {
                    sample.alpha = 0.0;
                } else {
                    sample.radiance += walk.throughput * self.behind_all(bounce, walk, ray);
                }
                continue;
            }
            if bounce == 0 {
                on_surface.push(walk.sample);
            }
            let surface = self.scene.interaction(ray, hit);
            let material = self.scene.material(hit);
            let emitted = self.scene.emitted(material, &surface);
            if emitted != Rgb::ZERO {
                let weight = self.weight_of_emission(bounce, walk, ray, &surface);
                sample.radiance += walk.throughput * emitted * weight;
            }
            if bounce == self.bounces {
                continue;
            }
            if self.scene.ambient != Rgb::ZERO {
                let reflected = self.scene.ambient_reflectance(material, &surface);
                sample.radiance += walk.throughput * reflected * self.scene.ambient;
            }
            let bsdf = self.scene.bsdf(material, &surface);
            if bsdf.is_black() {
                continue;
            }
            vertices.push(Vertex::new(*walk, ray, &surface, bsdf));
        }
    }

    /// Radiance along a ray that meets nothing, W·sr⁻¹·m⁻², as far as lights were not asked for it.
    #[inline(always)]
    fn behind_all(&self, bounce: u32, walk: &Walk, ray: &Ray) -> Rgb {
        let suns = self
            .scene
            .suns
            .iter()
            .map(|sun| sun.radiance(ray.direction) * balance(walk.pdf, sun.pdf(ray.direction)));
        let sky = match &self.scene.environment {
            Some((environment, visible)) if *visible || bounce > 0 => {
                let weight = balance(walk.pdf, environment.pdf(ray.direction));
                environment.radiance(ray.direction) * weight
            }
            _ if walk.mirrors_only => self.scene.background,
            _ => Rgb::ZERO,
        };
        sky + suns.sum::<Rgb>()
    }

    /// The part of what a surface emits that lights were not asked for.
    #[inline(always)]
    fn weight_of_emission(
        &self,
        bounce: u32,
        walk: &Walk,
        ray: &Ray,
        surface: &SurfaceInteraction,
    ) -> f32 {
        let Hit { surface: index, primitive, .. } = surface.hit;
        let found = self.scene.area_lights.find(index, primitive);
        let Some(number) = found.filter(|_| walk.pdf.is_finite()) else { return 1.0 };
        let light = self.scene.area_lights.get(number);
        let pdf = light.shape.pdf(ray.origin.as_dvec3(), surface.position.as_dvec3());
        let chance = match self.asks_all(bounce - 1) {
            true => 1.0,
            false => self.scene.local_lights.probability(ray.origin, walk.normal, number),
        };
        balance(walk.pdf, chance * pdf as f32)
    }

    /// Whether all local lights are asked at this reflection, or one of them.
    fn asks_all(&self, bounce: u32) -> bool {
        self.scene.local_lights.len() <= ASKED[usize::from(bounce > 0)]
    }

    /// The lecture's loop over lights, for all vertices.
    #[inline(always)]
    fn add_lights(&self, bounce: u32, points: &[PathPoints], scratch: &mut Scratch) {
        let pairs = Bounce::new(bounce);
        let pair = |vertex: &Vertex, pair: u32| points[vertex.walk.sample as usize].pair(pair);
        let asks_all = self.asks_all(bounce);
        let LocalLights { points: near, elsewhere, .. } = &self.scene.local_lights;
        let near = if asks_all { near.as_slice() } else { &[] };
        for &place in elsewhere.iter().chain(near) {
            let light = &self.scene.lights[place as usize];
            self.ask(scratch, |vertex| {
                vertex.light_from(light.sample(vertex.position.as_dvec3())?, light.shadows, 1.0)
            });
        }
        if asks_all {
            for (number, light) in (0..).zip(&self.scene.round_lights) {
                let place = pairs.light(number);
                self.ask(scratch, |vertex| {
                    let u = pair(vertex, place).as_dvec2();
                    vertex.light_from(light.sample(vertex.position.as_dvec3(), u)?, true, 1.0)
                });
            }
            for (number, light) in (0..).zip(self.scene.area_lights.iter()) {
                let place = pairs.light(self.scene.round_lights.len() as u32 + number);
                self.ask(scratch, |vertex| {
                    vertex.light_from_area(self.scene, light, 1.0, pair(vertex, place))
                });
            }
        } else {
            self.ask(scratch, |vertex| {
                let u = pair(vertex, pairs.pick()).as_dvec2();
                self.light_from_any(vertex, u.x + u.y * PAIR_STEP, pair(vertex, pairs.light(0)))
            });
        }
        for (number, sun) in (0..).zip(&self.scene.suns) {
            self.ask(scratch, |vertex| {
                vertex.light_from_afar(sun.sample(pair(vertex, pairs.sun(number))))
            });
        }
        if let Some((environment, _)) = &self.scene.environment {
            self.ask(scratch, |vertex| {
                vertex.light_from_afar(environment.sample(pair(vertex, pairs.environment()))?)
            });
        }
    }

    /// From one local light, picked by `pick` in 0..1, which stands for all.
    #[inline(always)]
    fn light_from_any(&self, vertex: &Vertex, pick: f64, u: Vec2) -> Option<Answer> {
        let Self { scene, .. } = self;
        match scene.local_lights.pick(vertex.start, vertex.shading_normal, pick)? {
            (LocalLight::Point(place), chance) => {
                let light = &scene.lights[place as usize];
                vertex.light_from(light.sample(vertex.position.as_dvec3())?, light.shadows, chance)
            }
            (LocalLight::Round(place), chance) => {
                let light = &scene.round_lights[place as usize];
                let sample = light.sample(vertex.position.as_dvec3(), u.as_dvec2())?;
                vertex.light_from(sample, true, chance)
            }
            (LocalLight::Area(number), chance) => {
                vertex.light_from_area(scene, scene.area_lights.get(number), chance, u)
            }
        }
    }

    /// Asks a light at every vertex, and adds what it gives where nothing is in the way.
    #[inline(always)]
    fn ask(&self, scratch: &mut Scratch, light: impl Fn(&Vertex) -> Option<Answer>) {
        let Scratch { vertices, shadow_rays, awaited, occluded, samples, counts, .. } = scratch;
        shadow_rays.clear();
        awaited.clear();
        for vertex in vertices.iter() {
            let Some(Answer { ray, radiance }) = light(vertex) else { continue };
            let sample = vertex.walk.sample;
            let radiance = vertex.walk.throughput * radiance;
            match ray {
                Some(ray) => {
                    shadow_rays.push(ray);
                    awaited.push(Awaited { sample, radiance });
                }
                None => samples[sample as usize].radiance += radiance,
            }
        }
        counts.shadow += shadow_rays.len() as u64;
        self.scene.world.occluded(shadow_rays, &StopsLight(self.scene, 0), occluded);
        for (awaited, _) in awaited.iter().zip(&*occluded).filter(|(_, occluded)| !**occluded) {
            samples[awaited.sample as usize].radiance += awaited.radiance;
        }
    }
}

/// Sends each path on in a direction that its BSDF picks, or ends it.
#[inline(always)]
fn scatter(bounce: u32, points: &[PathPoints], scratch: &mut Scratch) {
    let pairs = Bounce::new(bounce);
    let Scratch { vertices, rays, walks, .. } = scratch;
    rays.clear();
    walks.clear();
    for Vertex { walk, start, shading_normal, outgoing, bsdf, .. } in vertices.iter() {
        let points = &points[walk.sample as usize];
        let (choice, u) = (points.pair(pairs.choice()), points.pair(pairs.direction()));
        let Some(sample) = bsdf.sample(*shading_normal, *outgoing, choice.x, u) else { continue };
        let throughput = walk.throughput * sample.weight;
        let mirrors_only = walk.mirrors_only && sample.pdf.is_infinite();
        let survival = survival(bounce, mirrors_only, throughput);
        if choice.y >= survival {
            continue;
        }
        rays.push(Ray::new(*start, sample.incoming));
        let throughput = throughput / survival;
        let (pdf, normal) = (sample.pdf, *shading_normal);
        walks.push(Walk { sample: walk.sample, throughput, pdf, normal, mirrors_only });
    }
}

/// Russian roulette: the probability with which a path goes on. What ends it makes the others count more, so that
/// nothing is lost on average. Paths are followed until little is left of them, and then in proportion to that: with no
/// other bound than 1, the deviation stays finite in rooms of any reflectance, and small where it is high. What is seen
/// in mirrors is followed for longer, since chance has had no part in it yet.
fn survival(bounce: u32, mirrors_only: bool, throughput: Rgb) -> f32 {
    let left = throughput.max_element();
    let little = if mirrors_only { 1.0 / 256.0 } else { 1.0 / 4.0 };
    match bounce {
        0..SAFE_BOUNCES => f32::from(left > 0.0),
        SAFE_BOUNCES..MANY_BOUNCES => (left / little).min(1.0),
        _ => (left / little).min(0.99),
    }
}

/// Weight of a direction that one technique picked with density `own`, where another would have with density `other`.
#[inline(always)]
fn balance(own: f32, other: f32) -> f32 {
    1.0 / (1.0 + other / own)
}

impl Scratch {
    /// Of the last batch: how many rays met a surface, and the largest radiance of any channel that one sent back.
    pub(crate) fn seen(&self) -> (u64, f32) {
        let radiance = self.on_surface.iter().map(|&ray| self.samples[ray as usize].radiance);
        (self.on_surface.len() as u64, radiance.map(Rgb::max_element).fold(0.0, f32::max))
    }

    /// Nothing gathered yet, for so many camera rays.
    fn begin(&mut self, count: usize) {
        self.rays.clear();
        self.walks.clear();
        self.vertices.clear();
        self.on_surface.clear();
        self.samples.clear();
        self.samples.resize(count, Sample { radiance: Rgb::ZERO, alpha: 1.0 });
    }
}

impl Walk {
    fn from_eye(sample: u32) -> Self {
        let (throughput, pdf) = (Rgb::ONE, f32::INFINITY);
        Self { sample, throughput, pdf, normal: Vec3::ZERO, mirrors_only: true }
    }
}

impl Vertex {
    /// Where `ray` met `surface`.
    #[inline(always)]
    fn new(walk: Walk, ray: &Ray, surface: &SurfaceInteraction, bsdf: Bsdf) -> Self {
        Self {
            walk,
            position: surface.position,
            start: surface.ray_origin(),
            shading_normal: surface.shading_normal,
            outgoing: -ray.direction,
            bsdf,
        }
    }

    /// BSDF × cosine for light from `incoming`, with the density of that direction; `None` if it reflects nothing.
    #[inline(always)]
    fn reflected(&self, incoming: Vec3) -> Option<(Rgb, f32)> {
        let (cos, value) = (self.shading_normal.dot(incoming), self.bsdf.value());
        (cos > 0.0 && value != Rgb::ZERO).then(|| (value * cos, self.bsdf.pdf(cos)))
    }

    /// From a light that no ray can meet and that had this chance of being asked.
    #[inline(always)]
    fn light_from(&self, sample: LightSample, shadows: bool, chance: f32) -> Option<Answer> {
        let (reflected, _) = self.reflected(sample.incoming)?;
        let ray = shadows.then(|| sample.ray_from(self.position, self.start, 0.0));
        Some(Answer { ray, radiance: reflected * sample.irradiance / chance })
    }

    /// From a surface that emits and had this chance of being asked.
    #[inline(always)]
    fn light_from_area(
        &self,
        scene: &Scene,
        light: &AreaLight,
        chance: f32,
        u: Vec2,
    ) -> Option<Answer> {
        let sample = light.sample(self.start.as_dvec3(), u.as_dvec2())?;
        let (reflected, pdf) = self.reflected(sample.incoming.as_vec3())?;
        let radiance = scene.emitted_by(light, &sample) / (chance * sample.pdf as f32 + pdf);
        let ray = Some(sample.shadow_ray(self.start, 0.0, light.error));
        Some(Answer { ray, radiance: reflected * radiance })
    }

    /// From behind everything.
    #[inline(always)]
    fn light_from_afar(&self, sample: EnvironmentSample) -> Option<Answer> {
        let (reflected, pdf) = self.reflected(sample.incoming)?;
        let radiance = sample.radiance / (sample.pdf + pdf);
        let ray = Some(Ray::new(self.start, sample.incoming));
        Some(Answer { ray, radiance: reflected * radiance })
    }
}
