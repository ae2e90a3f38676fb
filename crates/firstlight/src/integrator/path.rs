//! Every way that light takes to the eye: L = L_emitted + ∫ f · L · cos θ, followed from the eye's end.
//!
//! Kajiya, *The Rendering Equation*, 1986. At each surface, all lights are asked as in the lecture; then the path goes
//! on in a direction picked by the BSDF. A light that both may find is weighted by how likely each is to find it (the
//! balance heuristic; Veach 1997 §9.2), so that nothing is counted twice. Batches of paths go through the stages
//! together, bounce by bounce; what one path gathers depends on no other.
//!
//! Unlike the lecture's sum, this is compiled once, not once per SIMD level: it is many branches and little arithmetic that would
//! gain by it, and it is long. What it calls to trace is compiled for each.

mod clarity;
mod occlusion;
#[cfg(test)]
mod tests;

pub(crate) use clarity::Clarity;
pub(crate) use occlusion::Occlusion;

use super::RayCounts;
use super::dimensions::{Bounce, time};
use super::media::{Around, Crossing, Media};
use super::record::{Asked, Draw, Followed, Gain, Recorder, add};
use super::shadows::ShadowRays;
use super::source::Source;
use crate::color::Rgb;
use crate::film::Sample;
use crate::geometry::{Cone, Hit, Ray};
use crate::sampler::{Pairs, PathPoints};
use crate::scene::{Interactions, LocalLight, LocalLights, Meets, Scene, SeenByCamera};
use crate::shading::bsdf::{Bsdf, Frame, Kind, Lobe};
use crate::shading::interaction::{SurfaceInteraction, clearance};
use crate::shading::light::LightSample;
use crate::shading::light::area::{AreaLight, Look, Views};
use crate::shading::light::environment::{Ask, Environment, EnvironmentSample, Meet};
use crate::shading::light::shape::ShapeSample;
use crate::shading::volume::HenyeyGreenstein;
use crate::simd::Level;
use glam::{DAffine3, DVec3, Vec2, Vec3};
use std::f32::consts::PI;
use std::ops::Range;

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
    /// How much each way of finding lights counts.
    techniques: Techniques,
}

/// The samples that count for each of two ways to find a light: those that ask lights, and those of the BSDF that meet
/// them. One each in pictures; with any others, the mean stays the same (Veach 1997 §9.2).
#[derive(Debug, Clone, Copy, PartialEq)]
struct Techniques {
    lights: f32,
    bsdf: f32,
}

impl Techniques {
    /// What to divide light by that was asked for in a direction that lights pick with one density and the BSDF with
    /// another.
    #[inline(always)]
    fn asked(self, lights: f32, bsdf: f32) -> f32 {
        (self.lights * lights + self.bsdf * bsdf) / self.lights
    }

    /// The weight of light that was met in such a direction. What lights never pick is the BSDF's alone.
    #[inline(always)]
    fn met(self, lights: f32, bsdf: f32) -> f32 {
        if lights == 0.0 || bsdf.is_infinite() {
            return 1.0;
        }
        1.0 / (1.0 + self.lights * lights / (self.bsdf * bsdf))
    }
}

/// Buffers that one worker reuses from batch to batch.
#[derive(Default)]
pub(crate) struct Scratch {
    rays: Vec<Ray>,
    /// What leads to each ray.
    walks: Vec<Walk>,
    hits: Vec<Hit>,
    /// The points that they met.
    met: Vec<Option<SurfaceInteraction>>,
    /// What those that met nothing get from the environment.
    sky: Vec<(Rgb, f32)>,
    vertices: Vec<Vertex>,
    /// What the vertices' surfaces do with light.
    lobes: Vec<Lobe>,
    draws: Draws,
    shadows: ShadowRays,
    /// One answer per camera ray.
    pub samples: Vec<Sample>,
    /// What was traced so far.
    pub counts: RayCounts,
    /// Which camera rays met a surface.
    on_surface: Vec<u32>,
}

/// Numbers in 0..1 that decide about vertices.
#[derive(Default)]
struct Draws {
    paths: Vec<PathPoints>,
    pairs: [Vec<Vec2>; 2],
    /// What the vertices see of an area light by the first pairs.
    views: Views,
    /// What they get from the environment by them.
    sky: Vec<EnvironmentSample>,
}

impl Draws {
    /// Draws the pairs with these numbers for all vertices.
    fn draw<const N: usize>(
        &mut self,
        level: Level,
        points: &[PathPoints],
        vertices: &[Vertex],
        numbers: [u32; N],
    ) {
        if N == 0 {
            return;
        }
        self.paths.clear();
        self.paths.extend(vertices.iter().map(|vertex| points[vertex.walk.sample as usize]));
        for (number, pairs) in numbers.into_iter().zip(&mut self.pairs) {
            level.run(Pairs { paths: &self.paths, number, pairs });
        }
    }

    /// Looks from all vertices at a light, by the first of their pairs.
    fn look(&mut self, scene: &Scene, light: &AreaLight, vertices: &[Vertex]) {
        let from = |vertex: &Vertex| (vertex.starts[0], vertex.moved(scene, light));
        self.views.begin(vertices.iter().map(from));
        scene.level().run(Look { light, pairs: &self.pairs[0], views: &mut self.views });
    }

    /// The pairs of vertex `k`.
    #[inline(always)]
    fn get<const N: usize>(&self, k: usize) -> [Vec2; N] {
        std::array::from_fn(|i| self.pairs[i][k])
    }
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
    /// The reflection at which it was picked.
    bounce: u32,
    /// How often it was scattered, straight on not counted.
    reflections: u32,
    /// Where it was picked, m, and where lights had to be there ([`Bsdf::horizon`]): panes that were passed since do not
    /// count.
    from: Vec3,
    normal: Vec3,
    /// Whether only mirrors and clear glass lie between the eye and the last ray.
    sharp_only: bool,
    /// The solids that it is in.
    media: Media,
    /// The colour channel that it is followed for, once glass has torn colours apart.
    channel: Option<u8>,
    /// The cone around the last ray.
    cone: Cone,
    /// When all this is, see [`Ray::time`].
    time: f32,
}

/// A point where a path is scattered.
struct Vertex {
    walk: Walk,
    /// Where it is, m.
    position: Vec3,
    /// Where rays leave it on the side that the path came from, and on the other.
    starts: [Vec3; 2],
    frame: Frame,
    outgoing: Vec3,
    /// Its lobes among all.
    lobes: Range<u32>,
    /// The solids on the other side.
    beyond: Media,
    /// The part of ambient light that its surface's occlusion map lets come to it.
    openness: f32,
}

/// What a light gives to a vertex: the lecture's f · cos θ · E.
struct Answer {
    source: Source,
    /// The ray that anything in the way would stop; `None` if nothing can.
    ray: Option<Ray>,
    /// Unit vector to the light.
    incoming: Vec3,
    /// BSDF × |cosine|, sr⁻¹.
    scattered: Rgb,
    /// Irradiance of a surface that faces the light, W·m⁻², or what one sample stands for.
    irradiance: Rgb,
    /// How the light came to be asked.
    draw: Draw,
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
        self.stand(position, normal, points, scratch);
        scratch.samples.iter_mut().for_each(|sample| sample.radiance = PI * self.scene.ambient);
        if self.bounces > 0 {
            self.follow(points, scratch, &mut ());
        }
    }

    /// Begins a path for each of `points` at `position` on a surface that faces `normal` and reflects π times the light.
    fn stand(&self, position: DVec3, normal: Vec3, points: &[PathPoints], scratch: &mut Scratch) {
        let position = position.as_vec3();
        let start = position + clearance(normal, position.abs(), 0.0) * normal;
        scratch.begin(points.len());
        scratch.lobes.push(Lobe::new(Kind::Lambert, Rgb::splat(PI)));
        let mut around = Around::default();
        scratch.vertices.extend((0..).zip(points).map(|(sample, points)| {
            let time = time(self.scene, points);
            let media = around.media(self.scene, start, time);
            Vertex {
                walk: Walk { sharp_only: false, media, ..Walk::from_eye(sample, time) },
                position,
                starts: [start; 2],
                frame: Frame::around(normal),
                outgoing: normal,
                lobes: 0..1,
                beyond: media,
                openness: 1.0,
            }
        }));
    }

    /// Goes on from the vertices of the first bounce until all paths have ended.
    #[inline(never)]
    fn follow(&self, points: &[PathPoints], scratch: &mut Scratch, recorder: &mut impl Recorder) {
        for bounce in 0..u32::MAX {
            if scratch.vertices.is_empty() {
                break;
            }
            self.add_lights(bounce, points, scratch, recorder);
            scatter(self.scene, bounce, points, scratch);
            scratch.counts.bounce += scratch.rays.len() as u64;
            let filter = Meets(self.scene, 0);
            self.scene.world.closest_hits(&scratch.rays, &filter, &mut scratch.hits);
            self.arrive(bounce + 1, points, scratch, recorder);
        }
    }

    /// Adds what comes along each ray, and makes vertices of the surfaces that were met.
    #[inline(never)]
    fn arrive(
        &self,
        bounce: u32,
        points: &[PathPoints],
        scratch: &mut Scratch,
        recorder: &mut impl Recorder,
    ) {
        let Scratch { rays, walks, hits, met, sky, vertices, lobes, samples, on_surface, .. } =
            scratch;
        vertices.clear();
        lobes.clear();
        self.scene.level().run(Interactions { scene: self.scene, rays, hits, points: met });
        if let Some((environment, _)) = &self.scene.environment {
            self.scene.level().run(Meet { environment, rays, hits, met: sky });
        }
        let mut sky = sky.drain(..);
        for (((ray, walk), hit), surface) in rays.iter().zip(&*walks).zip(&*hits).zip(&*met) {
            let (mut walk, points) = (*walk, &points[walk.sample as usize]);
            let pairs = Bounce::new(bounce);
            let sky = if hit.is_some() { None } else { sky.next() };
            let crossing = surface.as_ref().and_then(|surface| {
                walk.cross(self.scene, surface, || points.pair(pairs.channel()).x)
            });
            let scattered = walk.fly(self.scene, hit.t, || points.pair(pairs.flight()));
            if let Some((distance, phase)) = scattered {
                let ray = Ray { t_max: distance, ..*ray };
                recorder.follow(&walk.along(bounce, &ray, &Hit::none(distance)));
                if bounce == 0 {
                    on_surface.push(walk.sample);
                }
                if walk.reflections < self.bounces {
                    let gain = walk.reflected(bounce, Source::Ambient, self.scene.ambient);
                    add(self.scene, samples, recorder, gain);
                    vertices.push(Vertex::floating(walk, &ray, lobes.len() as u32));
                    lobes.push(Lobe::new(Kind::Phase(phase), Rgb::ONE));
                }
                continue;
            }
            recorder.follow(&walk.along(bounce, ray, hit));
            let Some(mut surface) = *surface else {
                if bounce == 0 && self.transparent {
                    samples[walk.sample as usize].alpha = 0.0;
                } else {
                    for (source, radiance) in self.behind_all(bounce, &walk, ray, sky) {
                        add(self.scene, samples, recorder, walk.gain(bounce, source, radiance));
                    }
                }
                continue;
            };
            if bounce == 0 {
                on_surface.push(walk.sample);
            }
            walk.cone = walk.cone.after(hit.t);
            surface.seen_width = walk.cone.width;
            let material = self.scene.material(hit);
            let (outgoing, first) = (-ray.direction, lobes.len() as u32);
            let boundary = crossing.and_then(|crossing| crossing.boundary);
            let openness = self.scene.openness(material, &surface);
            let frame = if crossing.is_some() && boundary.is_none() {
                lobes.push(Lobe::new(Kind::Straight, Rgb::ONE));
                Frame::around(surface.shading_normal)
            } else {
                let emitted = self.scene.emitted(material, &surface, -ray.direction);
                if emitted != Rgb::ZERO && (walk.sharp_only || !material.unlit) {
                    let weight = self.weight_of_emission(&walk, &surface);
                    let source = Source::Surface(hit.surface);
                    add(self.scene, samples, recorder, walk.gain(bounce, source, emitted * weight));
                }
                // What does not turn light aside is no reflection.
                let on = material.interior.is_some() && material.passes_light();
                if walk.reflections >= self.bounces && !on {
                    continue;
                }
                let (frame, scattered) =
                    self.scene.add_lobes(material, &surface, outgoing, boundary, lobes);
                if self.scene.ambient != Rgb::ZERO && !on {
                    let reflected = self.scene.ambient_reflectance(material, &surface);
                    let reflected = reflected.unwrap_or(scattered);
                    let ambient = openness * reflected * self.scene.ambient;
                    let gain = walk.reflected(bounce, Source::Ambient, ambient);
                    add(self.scene, samples, recorder, gain);
                }
                frame
            };
            let lobes = first..lobes.len() as u32;
            if !lobes.is_empty() {
                let beyond = crossing.map_or(walk.media, |crossing| crossing.beyond);
                let vertex = Vertex::new(walk, ray, &surface, frame, lobes);
                vertices.push(Vertex { beyond, openness, ..vertex });
            }
        }
    }

    /// Radiance along a ray that meets nothing but what the `sky` gives (see [`Meet`]), W·sr⁻¹·m⁻², as far as lights were not
    /// asked for it.
    #[inline(always)]
    fn behind_all(
        &self,
        bounce: u32,
        walk: &Walk,
        ray: &Ray,
        sky: Option<(Rgb, f32)>,
    ) -> impl Iterator<Item = (Source, Rgb)> {
        let Scene { suns, sun_numbers, environment, background, .. } = self.scene;
        let (pdf, direction, techniques) = (walk.pdf, ray.direction, self.techniques);
        let is_seen = environment.as_ref().is_some_and(|(_, visible)| *visible || bounce > 0);
        let sky = match sky.filter(|_| is_seen) {
            Some((radiance, lights)) => {
                Some((Source::Environment, radiance * techniques.met(lights, pdf)))
            }
            None => walk.sharp_only.then_some((Source::Background, *background)),
        };
        let suns = suns.iter().zip(sun_numbers).map(move |(sun, number)| {
            let weight = techniques.met(sun.pdf(direction), pdf);
            (Source::Light(*number), sun.radiance(direction) * weight)
        });
        sky.into_iter().chain(suns)
    }

    /// The part of what a surface emits that lights were not asked for.
    #[inline(always)]
    fn weight_of_emission(&self, walk: &Walk, surface: &SurfaceInteraction) -> f32 {
        let Hit { surface: index, primitive, .. } = surface.hit;
        let found = self.scene.area_lights.find(index, primitive);
        let Some(number) = found.filter(|_| walk.pdf.is_finite()) else { return 1.0 };
        let light = self.scene.area_lights.get(number);
        let moved = self.scene.world.moved(index, walk.time);
        let pdf = light.pdf(walk.from.as_dvec3(), surface.position.as_dvec3(), moved);
        let chance = match self.asks_all(walk.bounce) {
            true => 1.0,
            false => self.scene.local_lights.probability(walk.from, walk.normal, number),
        };
        self.techniques.met(chance * pdf as f32, walk.pdf)
    }

    /// Whether all local lights are asked at this reflection, or one of them.
    pub(crate) fn asks_all(&self, bounce: u32) -> bool {
        self.scene.local_lights.len() <= ASKED[usize::from(bounce > 0)]
    }

    /// The lecture's loop over lights, for all vertices.
    #[inline(always)]
    fn add_lights(
        &self,
        bounce: u32,
        points: &[PathPoints],
        scratch: &mut Scratch,
        recorder: &mut impl Recorder,
    ) {
        let pairs = Bounce::new(bounce);
        let asks_all = self.asks_all(bounce);
        let LocalLights { points: near, elsewhere, .. } = &self.scene.local_lights;
        let near = if asks_all { near.as_slice() } else { &[] };
        for &place in elsewhere.iter().chain(near) {
            self.ask(bounce, points, [], scratch, recorder, |vertex, lobes, []| {
                self.light_from_point(vertex, lobes, place, 1.0)
            });
        }
        if asks_all {
            for number in 0..self.scene.round_lights.len() as u32 {
                let place = [pairs.light(number)];
                self.ask(bounce, points, place, scratch, recorder, |vertex, lobes, [u]| {
                    self.light_from_round(vertex, lobes, number, 1.0, u)
                });
            }
            for (number, light) in (0..).zip(self.scene.area_lights.iter()) {
                let place = pairs.light(self.scene.round_lights.len() as u32 + number);
                self.ask_area(bounce, points, (light, place), scratch, recorder);
            }
        } else {
            let picks = [pairs.pick(), pairs.light(0)];
            self.ask(bounce, points, picks, scratch, recorder, |vertex, lobes, [pick, u]| {
                let pick = pick.as_dvec2();
                self.light_from_any(vertex, lobes, pick.x + pick.y * PAIR_STEP, u)
            });
        }
        for (place, (sun, number)) in (0..).zip(self.scene.suns.iter().zip(&self.scene.sun_numbers))
        {
            let place = [pairs.sun(place)];
            self.ask(bounce, points, place, scratch, recorder, |vertex, lobes, [u]| {
                self.light_from_afar(vertex, lobes, Source::Light(*number), sun.sample(u))
            });
        }
        for ambient in &self.scene.near_ambient {
            let draws = pairs.ambient();
            self.ask(bounce, points, draws, scratch, recorder, |vertex, lobes, draws| {
                let [direction, choice] = draws;
                let source = Source::Light(ambient.number);
                let answer =
                    vertex.light_from_sky(lobes, source, ambient.reach, choice.x, direction)?;
                Some(Answer { irradiance: vertex.openness * ambient.radiance, ..answer })
            });
        }
        if let Some((environment, _)) = &self.scene.environment {
            self.ask_environment(bounce, points, environment, scratch, recorder);
        }
    }

    /// From one local light, picked by `pick` in 0..1, which stands for all.
    #[inline(always)]
    fn light_from_any(
        &self,
        vertex: &Vertex,
        lobes: &[Lobe],
        pick: f64,
        u: Vec2,
    ) -> Option<Answer> {
        let Self { scene, .. } = self;
        match scene.local_lights.pick(vertex.starts[0], vertex.bsdf(lobes).horizon(), pick)? {
            (LocalLight::Point(place), chance) => {
                self.light_from_point(vertex, lobes, place, chance)
            }
            (LocalLight::Round(place), chance) => {
                self.light_from_round(vertex, lobes, place, chance, u)
            }
            (LocalLight::Area(number), chance) => {
                let light = scene.area_lights.get(number);
                let (from, moved) = (vertex.starts[0].as_dvec3(), vertex.moved(scene, light));
                let sample = light.sample(from, u.as_dvec2(), moved)?;
                self.light_from_area(vertex, lobes, light, chance, sample)
            }
        }
    }

    /// From the light without extent with this place, which had this chance of being asked.
    #[inline(always)]
    fn light_from_point(
        &self,
        vertex: &Vertex,
        lobes: &[Lobe],
        place: u32,
        chance: f32,
    ) -> Option<Answer> {
        let light = &self.scene.lights[place as usize];
        let source = Source::Light(self.scene.light_numbers[place as usize]);
        let sample = light.sample(vertex.position.as_dvec3())?;
        vertex.light_from(lobes, source, sample, light.shadows, chance)
    }

    /// From the round light with this place, which had this chance of being asked.
    #[inline(always)]
    fn light_from_round(
        &self,
        vertex: &Vertex,
        lobes: &[Lobe],
        place: u32,
        chance: f32,
        u: Vec2,
    ) -> Option<Answer> {
        let light = &self.scene.round_lights[place as usize];
        let source = Source::Light(self.scene.round_numbers[place as usize]);
        let sample = light.sample(vertex.position.as_dvec3(), u.as_dvec2())?;
        vertex.light_from(lobes, source, sample, true, chance)
    }

    /// From a point of a surface that emits and had this chance of being asked.
    #[inline(always)]
    fn light_from_area(
        &self,
        vertex: &Vertex,
        lobes: &[Lobe],
        light: &AreaLight,
        chance: f32,
        sample: ShapeSample,
    ) -> Option<Answer> {
        let incoming = sample.incoming.as_vec3();
        let (scattered, pdf, start) = vertex.scattered(lobes, incoming)?;
        let (source, pdf_light) = (Source::Surface(light.surface), sample.pdf as f32);
        let asked = self.techniques.asked(chance * pdf_light, pdf);
        let irradiance = self.scene.emitted_by(light, sample, vertex.walk.time) / asked;
        let ray = Some(sample.shadow_ray(start, 0.0, light.error));
        let weight = chance * pdf_light / asked;
        let draw = Draw { solid_angle: pdf_light.recip(), chance, weight };
        Some(Answer { source, ray, incoming, scattered, irradiance, draw })
    }

    /// From behind everything.
    #[inline(always)]
    fn light_from_afar(
        &self,
        vertex: &Vertex,
        lobes: &[Lobe],
        source: Source,
        sample: EnvironmentSample,
    ) -> Option<Answer> {
        let incoming = sample.incoming;
        let (scattered, pdf, start) = vertex.scattered(lobes, incoming)?;
        let asked = self.techniques.asked(sample.pdf, pdf);
        let irradiance = sample.radiance / asked;
        let ray = Some(Ray::new(start, incoming));
        let weight = sample.pdf / asked;
        let draw = Draw { solid_angle: sample.pdf.recip(), chance: 1.0, weight };
        Some(Answer { source, ray, incoming, scattered, irradiance, draw })
    }

    /// Asks a light at every vertex, by pairs of numbers in 0..1 with these numbers, and adds what it gives where nothing is in
    /// the way.
    #[inline(always)]
    fn ask<const N: usize>(
        &self,
        bounce: u32,
        points: &[PathPoints],
        numbers: [u32; N],
        scratch: &mut Scratch,
        recorder: &mut impl Recorder,
        light: impl Fn(&Vertex, &[Lobe], [Vec2; N]) -> Option<Answer>,
    ) {
        scratch.draws.draw(self.scene.level(), points, &scratch.vertices, numbers);
        self.settle(bounce, scratch, recorder, |vertex, lobes, draws, k| {
            light(vertex, lobes, draws.get(k))
        });
    }

    /// Asks an area light, by the pairs of numbers with this number.
    #[inline(always)]
    fn ask_area(
        &self,
        bounce: u32,
        points: &[PathPoints],
        (light, number): (&AreaLight, u32),
        scratch: &mut Scratch,
        recorder: &mut impl Recorder,
    ) {
        scratch.draws.draw(self.scene.level(), points, &scratch.vertices, [number]);
        scratch.draws.look(self.scene, light, &scratch.vertices);
        self.settle(bounce, scratch, recorder, |vertex, lobes, draws, k| {
            let moved = vertex.moved(self.scene, light);
            let sample = draws.views.get(k, light, vertex.starts[0], moved)?;
            self.light_from_area(vertex, lobes, light, 1.0, sample)
        });
    }

    /// Asks the environment, in directions that it picks.
    #[inline(always)]
    fn ask_environment(
        &self,
        bounce: u32,
        points: &[PathPoints],
        environment: &Environment,
        scratch: &mut Scratch,
        recorder: &mut impl Recorder,
    ) {
        let level = self.scene.level();
        let Scratch { draws, vertices, .. } = scratch;
        draws.draw(level, points, vertices, [Bounce::new(bounce).environment()]);
        let (pairs, samples) = (&draws.pairs[0], &mut draws.sky);
        level.run(Ask { environment, pairs, samples });
        self.settle(bounce, scratch, recorder, |vertex, lobes, draws, k| {
            self.light_from_afar(vertex, lobes, Source::Environment, *draws.sky.get(k)?)
        });
    }

    /// Adds what `light` gives to each vertex, by its place, where nothing is in the way.
    #[inline(always)]
    fn settle(
        &self,
        bounce: u32,
        scratch: &mut Scratch,
        recorder: &mut impl Recorder,
        light: impl Fn(&Vertex, &[Lobe], &Draws, usize) -> Option<Answer>,
    ) {
        let Scratch { vertices, lobes, draws, shadows, samples, counts, .. } = scratch;
        shadows.clear();
        for (k, vertex) in vertices.iter().enumerate() {
            if let Some(answer) = light(vertex, lobes, draws, k) {
                let asked = answer.at(vertex, bounce);
                shadows.ask(self.scene, &asked, vertex.media(answer.incoming), samples, recorder);
            }
        }
        shadows.settle(self.scene, 0, samples, counts, recorder);
    }
}

/// Sends each path on in a direction that its BSDF picks, or ends it.
#[inline(always)]
fn scatter(scene: &Scene, bounce: u32, points: &[PathPoints], scratch: &mut Scratch) {
    let pairs = Bounce::new(bounce);
    let Scratch { vertices, lobes, draws, rays, walks, .. } = scratch;
    rays.clear();
    walks.clear();
    draws.draw(scene.level(), points, vertices, [pairs.choice(), pairs.direction()]);
    for (k, vertex) in vertices.iter().enumerate() {
        let (walk, [choice, u]) = (&vertex.walk, draws.get(k));
        let Some(sample) = vertex.bsdf(lobes).sample(choice.x, u) else { continue };
        let throughput = walk.throughput * sample.weight;
        let sharp_only = walk.sharp_only && sample.pdf.is_infinite();
        let media = if sample.through { vertex.beyond } else { walk.media };
        // Radiance in a solid is higher by the square of its index, and gets lower again where it leaves.
        let index = media.interior(scene).map_or(1.0, |interior| interior.index);
        let survival = survival(bounce, sharp_only, throughput * index * index);
        if choice.y >= survival {
            continue;
        }
        let start = vertex.starts[usize::from(sample.through)];
        rays.push(Ray { time: walk.time, ..Ray::new(start, sample.incoming) });
        let throughput = throughput / survival;
        let next = Walk { throughput, sharp_only, media, ..*walk };
        walks.push(if sample.straight {
            next
        } else {
            Walk {
                pdf: sample.pdf,
                bounce,
                cone: walk.cone.scattered(sample.pdf),
                reflections: walk.reflections + 1,
                from: start,
                normal: vertex.bsdf(lobes).horizon(),
                ..next
            }
        });
    }
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
        self.lobes.clear();
        self.on_surface.clear();
        self.samples.clear();
        self.samples.resize(count, Sample::of(Rgb::ZERO));
    }
}

impl Walk {
    fn from_eye(sample: u32, time: f32) -> Self {
        Self {
            sample,
            throughput: Rgb::ONE,
            pdf: f32::INFINITY,
            bounce: 0,
            reflections: 0,
            from: Vec3::ZERO,
            normal: Vec3::ZERO,
            sharp_only: true,
            media: Media::default(),
            channel: None,
            cone: Cone::default(),
            time,
        }
    }

    /// Where the last ray met a surface of a solid: what is before it and beyond. `channel`, in 0..1, picks a colour channel
    /// if it takes one.
    #[inline(always)]
    fn cross(
        &mut self,
        scene: &Scene,
        surface: &SurfaceInteraction,
        channel: impl FnOnce() -> f32,
    ) -> Option<Crossing> {
        let interior = scene.material(&surface.hit).interior?;
        if interior.dispersion > 0.0 && self.channel.is_none() {
            self.follow_channel(channel());
        }
        let material = scene.material_of[surface.hit.surface as usize];
        let crossing = self.media.cross(scene, material, surface.front, self.channel);
        self.media = crossing.before;
        Some(crossing)
    }

    /// Goes along the last ray, of which there is so much, m, through what fills the space there, picking the distance by
    /// two numbers in 0..1. Returns that distance and how light is scattered there; `None` if it came to the end.
    #[inline(always)]
    fn fly(
        &mut self,
        scene: &Scene,
        length: f32,
        u: impl FnOnce() -> Vec2,
    ) -> Option<(f32, HenyeyGreenstein)> {
        let medium = self.media.medium(scene).filter(|_| self.throughput != Rgb::ZERO)?;
        let flight = medium.fly(length, self.throughput, u);
        self.throughput *= flight.weight;
        flight.scattered.then_some((flight.distance, HenyeyGreenstein { g: medium.anisotropy }))
    }

    /// Light of `radiance` that comes along the last ray from what it met.
    #[inline(always)]
    fn gain(&self, bounce: u32, source: Source, radiance: Rgb) -> Gain {
        let Self { sample, reflections, throughput, .. } = *self;
        let radiance = throughput * radiance;
        Gain { sample, source, bounce, reflections, asked: false, radiance }
    }

    /// The same for light that what it met reflects.
    #[inline(always)]
    fn reflected(&self, bounce: u32, source: Source, radiance: Rgb) -> Gain {
        Gain { reflections: self.reflections + 1, ..self.gain(bounce, source, radiance) }
    }

    /// The last ray, and what it met.
    #[inline(always)]
    fn along(&self, bounce: u32, ray: &Ray, hit: &Hit) -> Followed {
        let Self { sample, throughput, cone, .. } = *self;
        let width = cone.after(hit.t).width;
        Followed { sample, bounce, ray: *ray, hit: *hit, throughput, width }
    }

    /// Goes on for one of the three channels, picked by a number in 0..1.
    fn follow_channel(&mut self, u: f32) {
        let channel = ((3.0 * u) as u8).min(2);
        self.throughput *= 3.0 * Rgb::AXES[usize::from(channel)];
        self.channel = Some(channel);
    }
}

impl Vertex {
    /// Where `ray` met `surface`, no solid's boundary, with these lobes.
    #[inline(always)]
    fn new(
        walk: Walk,
        ray: &Ray,
        surface: &SurfaceInteraction,
        frame: Frame,
        lobes: Range<u32>,
    ) -> Self {
        let starts = [surface.ray_origin(), surface.behind()];
        let (position, outgoing, beyond) = (surface.position, -ray.direction, walk.media);
        Self { walk, position, starts, frame, outgoing, lobes, beyond, openness: 1.0 }
    }

    /// At the end of `ray`, between the particles of a medium, with one lobe.
    fn floating(walk: Walk, ray: &Ray, lobe: u32) -> Self {
        let position = ray.origin + ray.t_max * ray.direction;
        // No surface straightens out what rounding adds up over hundreds of scatterings.
        let outgoing = -ray.direction.normalize();
        let (starts, frame, beyond) = ([position; 2], Frame::around(outgoing), walk.media);
        let (lobes, openness) = (lobe..lobe + 1, 1.0);
        Self { walk, position, starts, frame, outgoing, lobes, beyond, openness }
    }

    /// Where a light has moved to, if it does.
    #[inline(always)]
    fn moved(&self, scene: &Scene, light: &AreaLight) -> Option<DAffine3> {
        scene.world.moved(light.surface, self.walk.time)
    }

    /// The solids that light from `incoming` arrives through.
    #[inline(always)]
    fn media(&self, incoming: Vec3) -> Media {
        let through = incoming.dot(self.frame.normal()) < 0.0;
        if through { self.beyond } else { self.walk.media }
    }

    #[inline(always)]
    fn bsdf<'a>(&self, lobes: &'a [Lobe]) -> Bsdf<'a> {
        let lobes = &lobes[self.lobes.start as usize..self.lobes.end as usize];
        Bsdf { frame: self.frame, outgoing: self.outgoing, lobes }
    }

    /// BSDF × cosine for light from `incoming`, with the density of that direction, and where rays that way start;
    /// `None` if nothing is scattered.
    #[inline(always)]
    fn scattered(&self, lobes: &[Lobe], incoming: Vec3) -> Option<(Rgb, f32, Vec3)> {
        let (value, pdf) = self.bsdf(lobes).eval(incoming);
        let through = incoming.dot(self.frame.normal()) < 0.0;
        (value != Rgb::ZERO).then(|| (value, pdf, self.starts[usize::from(through)]))
    }

    /// From a light that no ray can meet and that had this chance of being asked.
    #[inline(always)]
    fn light_from(
        &self,
        lobes: &[Lobe],
        source: Source,
        sample: LightSample,
        shadows: bool,
        chance: f32,
    ) -> Option<Answer> {
        let (scattered, _, start) = self.scattered(lobes, sample.incoming)?;
        let ray = shadows.then(|| sample.ray_from(self.position, start, 0.0));
        let (incoming, irradiance) = (sample.incoming, sample.irradiance / chance);
        let draw = Draw::of_point(chance);
        Some(Answer { source, ray, incoming, scattered, irradiance, draw })
    }

    /// From a sky of radiance 1 that surfaces nearer than `reach` hide, in a direction that the BSDF picks.
    #[inline(always)]
    fn light_from_sky(
        &self,
        lobes: &[Lobe],
        source: Source,
        reach: f32,
        choice: f32,
        u: Vec2,
    ) -> Option<Answer> {
        let sample = self.bsdf(lobes).sample(choice, u)?;
        let (incoming, scattered) = (sample.incoming, sample.weight);
        let start = self.starts[usize::from(sample.through)];
        let ray = Some(Ray { t_max: reach, ..Ray::new(start, incoming) });
        let (irradiance, draw) = (Rgb::ONE, Draw::of_point(1.0));
        Some(Answer { source, ray, incoming, scattered, irradiance, draw })
    }
}

impl Answer {
    /// What the light would give to the eye by way of `vertex`.
    #[inline(always)]
    fn at(&self, vertex: &Vertex, bounce: u32) -> Asked {
        let Self { source, ray, incoming, scattered, irradiance, draw } = *self;
        let ray = ray.map(|ray| Ray { time: vertex.walk.time, ..ray });
        let gain = vertex.walk.reflected(bounce, source, scattered * irradiance);
        let (gain, passed) = (Gain { asked: true, ..gain }, Rgb::ONE);
        Asked { gain, ray, incoming, scattered, irradiance, draw, passed }
    }
}
