//! Every way that light takes to the eye: L = L_emitted + ∫ f · L · cos θ, followed from the eye's end.
//!
//! Kajiya, *The Rendering Equation*, 1986. At each surface, all lights are asked as in the lecture; then the path goes
//! on in a direction picked by the BSDF. A light that both may find is weighted by how likely each is to find it (the
//! balance heuristic; Veach 1997 §9.2), so that nothing is counted twice. Batches of paths go through the stages
//! together, bounce by bounce; what one path gathers depends on no other.
//!
//! Unlike the lecture's sum, this is compiled once, not once per SIMD level: it is many branches and little arithmetic that would
//! gain by it, and it is long. What it calls is compiled for each: tracing, and what is worked out for a block of paths at once,
//! as the directions that matte surfaces pick.

mod airlight;
mod arrive;
mod clarity;
mod lights;
mod occlusion;
#[cfg(test)]
mod tests;
mod vertices;
mod walk;

pub(crate) use clarity::Clarity;
pub(crate) use occlusion::Occlusion;

use super::RayCounts;
use super::dimensions::{Bounce, time};
use super::media::Around;
use super::record::Recorder;
use super::shadows::ShadowRays;
use crate::color::Rgb;
use crate::film::Sample;
use crate::geometry::{Cone, Hit, Ray};
use crate::math::{BLOCK, Columns};
use crate::sampler::PathPoints;
use crate::scene::{Meets, Points, Scene, SeenByCamera};
use crate::shading::bsdf::{BsdfSample, Matte};
use crate::shading::interaction::clearance;
use crate::simd::{Kernel, Simd};
use airlight::Airway;
use glam::{DVec3, Vec2, Vec3};
use lights::{Aims, Draws, Techniques};
use std::f32::consts::PI;
use vertices::{VertexBlock, Vertices};
use walk::Walk;

/// Up to so many lights are all asked at the surface that is seen, as in the lecture, and after that.
const ASKED: [u32; 2] = [32, 1];
/// Up to this reflection, paths end only where nothing is left of them.
const SAFE_BOUNCES: u32 = 4;
/// From this reflection on, even paths that lose nothing end sometimes, so that light between perfect mirrors does.
const MANY_BOUNCES: u32 = 1000;

/// Follows paths.
pub(crate) struct Path<'a> {
    scene: &'a Scene,
    transparent: bool,
    /// Reflections at most.
    bounces: u32,
    /// How much each way of finding lights counts.
    techniques: Techniques,
}

/// Buffers that one worker reuses from batch to batch.
#[derive(Default)]
pub(crate) struct Scratch {
    rays: Vec<Ray>,
    /// What leads to each ray.
    walks: Vec<Walk>,
    hits: Vec<Hit>,
    /// The points that a block of them met.
    met: Points,
    /// What those that met nothing get from the environment.
    sky: Vec<(Rgb, f32)>,
    vertices: Vertices,
    draws: Draws,
    aims: Aims,
    onward: Onward,
    /// Where lights are asked in media.
    airways: Vec<Airway>,
    shadows: ShadowRays,
    /// One answer per camera ray.
    pub samples: Vec<Sample>,
    /// What was traced so far.
    pub counts: RayCounts,
    /// Which camera rays met a surface.
    on_surface: Vec<u32>,
}

impl<'a> Path<'a> {
    /// Follows paths in `scene` over at most so many reflections.
    pub(crate) fn new(scene: &'a Scene, transparent: bool, bounces: Option<u32>) -> Self {
        let techniques = Techniques { lights: 1.0, bsdf: 1.0 };
        Self { scene, transparent, bounces: bounces.unwrap_or(u32::MAX), techniques }
    }

    /// Radiance along each of `rays`, one sample each by its `points`, into `scratch.samples`.
    #[inline(always)]
    pub(crate) fn gather(
        &self,
        rays: &[Ray],
        points: &[PathPoints],
        scratch: &mut Scratch,
        recorder: &mut impl Recorder,
    ) {
        self.look(rays, scratch);
        self.arrive(0, points, scratch, recorder);
        self.follow(points, scratch, recorder);
    }

    /// Traces the camera rays.
    #[inline(always)]
    fn look(&self, rays: &[Ray], scratch: &mut Scratch) {
        scratch.begin(rays.len());
        scratch.counts.camera += rays.len() as u64;
        scratch.rays.extend_from_slice(rays);
        let mut around = Around::default();
        for (sample, ray) in (0..).zip(rays) {
            let media = around.media(self.scene, ray.origin, ray.time);
            let eye = Walk::from_eye(sample, ray.time);
            scratch.walks.push(Walk { media, cone: self.scene.cone, ..eye });
        }
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
        self.stand(position, normal, PI, points, scratch);
        scratch.samples.iter_mut().for_each(|sample| sample.radiance = PI * self.scene.ambient);
        if self.bounces > 0 {
            self.follow(points, scratch, &mut ());
        }
    }

    /// Begins a path for each of `points` at `position` on a surface that faces `normal` and reflects so many times the
    /// light.
    fn stand(
        &self,
        position: DVec3,
        normal: Vec3,
        reflectance: f32,
        points: &[PathPoints],
        scratch: &mut Scratch,
    ) {
        let position = position.as_vec3();
        let start = position + clearance(normal, position.abs(), 0.0) * normal;
        let matte = Matte { normal, reflectance: Rgb::splat(reflectance) };
        scratch.begin(points.len());
        let mut around = Around::default();
        for (sample, points) in (0..).zip(points) {
            let time = time(self.scene, points);
            let media = around.media(self.scene, start, time);
            scratch.walks.push(Walk { sharp_only: false, media, ..Walk::from_eye(sample, time) });
            scratch.vertices.push_matte(sample, [position, start], matte);
        }
    }

    /// Goes on from the vertices of the first bounce until all paths have ended.
    #[inline(never)]
    fn follow(&self, points: &[PathPoints], scratch: &mut Scratch, recorder: &mut impl Recorder) {
        for bounce in 0..u32::MAX {
            if scratch.vertices.len() == 0 {
                break;
            }
            let Scratch { draws, vertices, walks, .. } = &mut *scratch;
            draws.begin(points, vertices, walks);
            self.add_lights(bounce, scratch, recorder);
            scatter(self.scene, bounce, scratch);
            scratch.counts.bounce += scratch.rays.len() as u64;
            let filter = Meets(self.scene, 0);
            self.scene.world.closest_hits(&scratch.rays, &filter, &mut scratch.hits);
            self.arrive(bounce + 1, points, scratch, recorder);
        }
    }

    /// Whether all local lights are asked at this reflection, or one of them.
    pub(crate) fn asks_all(&self, bounce: u32) -> bool {
        self.scene.local_lights.len() <= ASKED[usize::from(bounce > 0)]
    }
}

/// Directions that a block of matte vertices picks, their densities, sr⁻¹, and the spreads that they stand for.
struct Onward {
    incoming: Columns<f32>,
    pdf: [f32; BLOCK],
    part: [f32; BLOCK],
}

impl Default for Onward {
    fn default() -> Self {
        Self { incoming: Columns::default(), pdf: [0.0; BLOCK], part: [0.0; BLOCK] }
    }
}

/// Picks them for the first vertices of a block, by two numbers in 0..1 each.
struct PickAll<'a> {
    block: &'a VertexBlock,
    numbers: &'a [Vec2],
    onward: &'a mut Onward,
}

impl Kernel for PickAll<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        let mut u = [Vec2::ZERO; BLOCK];
        u[..self.numbers.len()].copy_from_slice(self.numbers);
        self.onward.pick(self.block, &u);
    }
}

impl Onward {
    #[inline(always)]
    fn pick(&mut self, block: &VertexBlock, u: &[Vec2; BLOCK]) {
        for (k, &u) in u.iter().enumerate() {
            let (incoming, pdf) = block.matte(k).sample(u);
            self.incoming.set(k, incoming);
            self.pdf[k] = pdf;
            self.part[k] = Cone::part(pdf);
        }
    }
}

/// Sends each path on in a direction that its BSDF picks, or ends it.
#[inline(always)]
fn scatter(scene: &Scene, bounce: u32, scratch: &mut Scratch) {
    let pairs = Bounce::new(bounce);
    let Scratch { vertices, draws, onward, rays, walks, .. } = scratch;
    rays.clear();
    let numbers = [pairs.choice(), pairs.direction()];
    draws.draw(scene.level(), numbers);
    for (number, block) in vertices.blocks().iter().enumerate() {
        let numbers = draws.block(1, number);
        scene.level().run(PickAll { block, numbers, onward: &mut *onward });
        for k in 0..numbers.len() {
            let vertex = vertices.get(number * BLOCK + k, walks);
            let [choice, u] = draws.get(number * BLOCK + k);
            let matte = vertex.other.is_none();
            let sample = if matte {
                let picked = (onward.incoming.get(k), onward.pdf[k]);
                BsdfSample::of_matte(vertex.matte.reflectance, picked)
            } else {
                vertex.sample(choice.x, u)
            };
            let Some(sample) = sample else { continue };
            let walk = vertex.walk;
            let throughput = walk.throughput * sample.weight;
            let sharp_only = walk.sharp_only && sample.pdf.is_infinite();
            let media = vertex.media_of(sample.through);
            // Radiance in a solid is higher by the square of its index, and gets lower again where it leaves.
            let index = media.interior(scene).map_or(1.0, |interior| interior.index);
            let survival = survival(bounce, sharp_only, throughput * index * index);
            if choice.y >= survival {
                continue;
            }
            let (start, horizon) = (vertex.start_of(sample.through), vertex.horizon());
            let beyond = if sample.through { Some(*media) } else { None };
            // Vertices are in the order of their walks, so that those that go on close up in place.
            let next = rays.len();
            rays.push(Ray { time: walk.time, ..Ray::new(start, sample.incoming) });
            walks[next] = walks[block.walk[k] as usize];
            let walk = &mut walks[next];
            walk.throughput = throughput / survival;
            walk.sharp_only = sharp_only;
            if let Some(beyond) = beyond {
                walk.media = beyond;
            }
            if !sample.straight {
                let part = if matte { onward.part[k] } else { Cone::part(sample.pdf) };
                walk.scatter(bounce, sample.pdf, part, [start, horizon]);
            }
        }
    }
    walks.truncate(rays.len());
}

/// Russian roulette: the probability with which a path goes on. What ends it makes the others count more, so that
/// nothing is lost on average. Paths are followed until little is left of them, and then in proportion to that: with no
/// other bound than 1, the deviation stays finite in rooms of any reflectance, and small where it is high. What is seen
/// in mirrors is followed for longer, since chance has had no part in it yet.
fn survival(bounce: u32, sharp_only: bool, throughput: Rgb) -> f32 {
    let left = throughput.max_element();
    let little = if sharp_only { 1.0 / 256.0 } else { 1.0 / 4.0 };
    match bounce {
        0..SAFE_BOUNCES => f32::from(left > 0.0),
        SAFE_BOUNCES..MANY_BOUNCES => (left / little).min(1.0),
        _ => (left / little).min(0.99),
    }
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
        self.samples.resize(count, Sample::of(Rgb::ZERO));
    }
}
