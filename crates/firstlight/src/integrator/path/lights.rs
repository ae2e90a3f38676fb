//! Lights asked at vertices: the lecture's f · cos θ · E.

use super::vertices::{Vertex, VertexBlock, Vertices};
use super::walk::Walk;
use super::{Path, Scratch};
use crate::color::Rgb;
use crate::geometry::Ray;
use crate::integrator::Source;
use crate::integrator::dimensions::Bounce;
use crate::integrator::media::Media;
use crate::integrator::record::{Asked, Draw, Gain, Recorder};
use crate::math::{BLOCK, Columns};
use crate::sampler::{Pairs, PathPoints};
use crate::scene::{LocalLight, LocalLights};
use crate::shading::light::LightSample;
use crate::shading::light::area::AreaLight;
use crate::shading::light::environment::{Ask, Environment, EnvironmentSample};
use crate::shading::light::shape::{ShapeSample, ShapeSamples};
use crate::simd::{Kernel, Level, Simd};
use glam::{Vec2, Vec3};

/// Of the two numbers that pick a light, the second has the digits behind the first's.
pub(super) const PAIR_STEP: f64 = 1.0 / (1 << 24) as f64;

/// The samples that count for each of two ways to find a light: those that ask lights, and those of the BSDF that meet
/// them. One each in pictures; with any others, the mean stays the same (Veach 1997 §9.2).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Techniques {
    pub(super) lights: f32,
    pub(super) bsdf: f32,
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
    pub(super) fn met(self, lights: f32, bsdf: f32) -> f32 {
        if lights == 0.0 || bsdf.is_infinite() {
            return 1.0;
        }
        1.0 / (1.0 + self.lights * lights / (self.bsdf * bsdf))
    }
}

/// What a light gives to a vertex: the lecture's f · cos θ · E.
#[derive(Debug, PartialEq)]
pub(super) struct Answer {
    pub(super) source: Source,
    /// The ray that anything in the way would stop; `None` if nothing can.
    pub(super) ray: Option<Ray>,
    /// Unit vector to the light.
    pub(super) incoming: Vec3,
    /// BSDF × |cosine|, sr⁻¹.
    pub(super) scattered: Rgb,
    /// Irradiance of a surface that faces the light, W·m⁻², or what one sample stands for.
    pub(super) irradiance: Rgb,
    /// How the light came to be asked.
    pub(super) draw: Draw,
}

/// Numbers in 0..1 that decide about vertices.
#[derive(Default)]
pub(super) struct Draws {
    paths: Vec<PathPoints>,
    pairs: [Vec<Vec2>; 2],
    /// What the vertices get from the environment by the first pairs.
    sky: Vec<EnvironmentSample>,
}

impl Draws {
    /// What is drawn from now on is for these vertices, by the `points` of their samples.
    pub(super) fn begin(&mut self, points: &[PathPoints], vertices: &Vertices, walks: &[Walk]) {
        self.paths.clear();
        let samples = vertices.walks().map(|walk| walks[walk as usize].sample);
        self.paths.extend(samples.map(|sample| points[sample as usize]));
    }

    /// Draws the pairs with these numbers for all vertices.
    pub(super) fn draw<const N: usize>(&mut self, level: Level, numbers: [u32; N]) {
        for (number, pairs) in numbers.into_iter().zip(&mut self.pairs) {
            level.run(Pairs { paths: &self.paths, number, pairs });
        }
    }

    /// The pairs of vertex `k`.
    #[inline(always)]
    pub(super) fn get<const N: usize>(&self, k: usize) -> [Vec2; N] {
        std::array::from_fn(|i| self.pairs[i][k])
    }

    /// Of the pairs with this place, those of the block of vertices with this number.
    #[inline(always)]
    pub(super) fn block(&self, place: usize, number: usize) -> &[Vec2] {
        let pairs = &self.pairs[place][number * BLOCK..];
        &pairs[..pairs.len().min(BLOCK)]
    }
}

/// A point of an area light as a vertex asks for it.
struct Aim {
    /// Unit vector to it.
    incoming: Vec3,
    /// BSDF × cosine, sr⁻¹.
    scattered: Rgb,
    /// What its radiance is divided by, sr⁻¹.
    asked: f32,
    /// The ray that anything in the way would stop.
    ray: Ray,
}

impl Aim {
    /// From `start`, where light of the sample is scattered so, and the BSDF picks its direction with that density; the light had
    /// this chance of being asked.
    #[inline(always)]
    fn new(
        techniques: Techniques,
        (light, chance): (&AreaLight, f32),
        sample: &ShapeSample,
        (scattered, pdf): (Rgb, f32),
        start: Vec3,
    ) -> Self {
        Self {
            incoming: sample.incoming.as_vec3(),
            scattered,
            asked: techniques.asked(chance * sample.pdf as f32, pdf),
            ray: sample.shadow_ray(start, 0.0, light.error),
        }
    }
}

impl Aim {
    /// What it brings from a light that had this chance of being asked, if the density of the direction is `pdf`, sr⁻¹, and the radiance
    /// that the light emits along it, W·sr⁻¹·m⁻².
    #[inline(always)]
    fn answer(self, (light, chance): (&AreaLight, f32), pdf: f32, emitted: Rgb) -> Answer {
        let Self { incoming, scattered, asked, ray } = self;
        let (source, irradiance) = (Source::Surface(light.surface), emitted / asked);
        let draw = Draw { solid_angle: pdf.recip(), chance, weight: chance * pdf / asked };
        Answer { source, ray: Some(ray), incoming, scattered, irradiance, draw }
    }
}

/// How a block of vertices asks for an area light.
#[derive(Default)]
pub(super) struct Aims {
    /// What each sees of it.
    seen: ShapeSamples,
    /// For the matte ones.
    matte: AimColumns,
}

/// A block of [`Aim`].
struct AimColumns {
    incoming: Columns<f32>,
    scattered: Columns<f32>,
    asked: [f32; BLOCK],
    along: Columns<f32>,
    reach: [f32; BLOCK],
}

impl Default for AimColumns {
    fn default() -> Self {
        let [incoming, scattered, along] = std::array::from_fn(|_| Columns::default());
        Self { incoming, scattered, asked: [0.0; BLOCK], along, reach: [0.0; BLOCK] }
    }
}

impl AimColumns {
    #[inline(always)]
    fn set(&mut self, k: usize, aim: &Aim) {
        self.incoming.set(k, aim.incoming);
        self.scattered.set(k, aim.scattered);
        self.asked[k] = aim.asked;
        self.along.set(k, aim.ray.direction);
        self.reach[k] = aim.ray.t_max;
    }

    #[inline(always)]
    fn fill(
        &mut self,
        techniques: Techniques,
        light: &AreaLight,
        block: &VertexBlock,
        seen: &ShapeSamples,
    ) {
        for k in 0..BLOCK {
            let sample = seen.row(k);
            let scattered = block.matte(k).eval(sample.incoming.as_vec3());
            let aim = Aim::new(techniques, (light, 1.0), &sample, scattered, block.start.get(k));
            self.set(k, &aim);
        }
    }

    /// That of vertex `k`, whose rays start there; `None` if it scatters no light from there.
    #[inline(always)]
    fn get(&self, k: usize, start: Vec3) -> Option<Aim> {
        let (incoming, scattered) = (self.incoming.get(k), self.scattered.get(k));
        let ray = Ray { t_max: self.reach[k], ..Ray::new(start, self.along.get(k)) };
        let aim = Aim { incoming, scattered, asked: self.asked[k], ray };
        (scattered != Rgb::ZERO).then_some(aim)
    }
}

impl Aims {
    /// What matte vertex `k`, whose rays start there, gets of the light if that emits everywhere alike.
    #[inline(always)]
    pub(super) fn answer(
        &self,
        k: usize,
        light: &AreaLight,
        start: Vec3,
        emitted: Rgb,
    ) -> Option<Answer> {
        let (pdf, aim) = (self.seen.pdf(k)?, self.matte.get(k, start)?);
        Some(aim.answer((light, 1.0), pdf as f32, emitted))
    }
}

/// Aims at a light that stands still from all vertices of a block.
pub(super) struct AimAll<'a> {
    pub(super) techniques: Techniques,
    pub(super) light: &'a AreaLight,
    pub(super) block: &'a VertexBlock,
    /// The place on the light for each of the first vertices, as two numbers in 0..1.
    pub(super) places: &'a [Vec2],
    pub(super) aims: &'a mut Aims,
}

impl Kernel for AimAll<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        let Self { techniques, light, block, places, aims } = self;
        let (mut from, mut u) = (Columns::<f64>::default(), [Vec2::ZERO; BLOCK]);
        u[..places.len()].copy_from_slice(places);
        for k in 0..BLOCK {
            from.set(k, block.start.get(k).as_dvec3());
        }
        light.sample_all(&from, &u, places.len(), &mut aims.seen);
        aims.matte.fill(techniques, light, block, &aims.seen);
    }
}

impl Path<'_> {
    /// The lecture's loop over lights, for all vertices.
    #[inline(always)]
    pub(super) fn add_lights(
        &self,
        bounce: u32,
        scratch: &mut Scratch,
        recorder: &mut impl Recorder,
    ) {
        let pairs = Bounce::new(bounce);
        let asks_all = self.asks_all(bounce);
        let LocalLights { points: near, elsewhere, .. } = &self.scene.local_lights;
        let near = if asks_all { near.as_slice() } else { &[] };
        for &place in elsewhere {
            self.ask(bounce, [], scratch, recorder, |vertex, []| {
                self.light_from_point(vertex, place, 1.0)
            });
        }
        for &place in near {
            self.ask(bounce, [], scratch, recorder, |vertex, []| {
                self.light_from_point(vertex.on_surface()?, place, 1.0)
            });
        }
        if asks_all {
            for number in 0..self.scene.round_lights.len() as u32 {
                let place = [pairs.light(number)];
                self.ask(bounce, place, scratch, recorder, |vertex, [u]| {
                    self.light_from_round(vertex.on_surface()?, number, 1.0, u)
                });
            }
            for (number, light) in (0..).zip(self.scene.area_lights.iter()) {
                let place = pairs.light(self.scene.round_lights.len() as u32 + number);
                self.ask_area(bounce, (light, place), scratch, recorder);
            }
        } else {
            let picks = [pairs.pick(), pairs.light(0)];
            self.ask(bounce, picks, scratch, recorder, |vertex, [pick, u]| {
                let pick = pick.as_dvec2();
                self.light_from_any(vertex.on_surface()?, pick.x + pick.y * PAIR_STEP, u)
            });
        }
        for (place, (sun, number)) in (0..).zip(self.scene.suns.iter().zip(&self.scene.sun_numbers))
        {
            let place = [pairs.sun(place)];
            self.ask(bounce, place, scratch, recorder, |vertex, [u]| {
                self.light_from_afar(vertex, Source::Light(*number), sun.sample(u))
            });
        }
        for ambient in &self.scene.near_ambient {
            let draws = pairs.ambient();
            self.ask(bounce, draws, scratch, recorder, |vertex, draws| {
                let [direction, choice] = draws;
                let source = Source::Light(ambient.number);
                let answer = vertex.light_from_sky(source, ambient.reach, choice.x, direction)?;
                Some(Answer { irradiance: vertex.openness() * ambient.radiance, ..answer })
            });
        }
        if let Some((environment, _)) = &self.scene.environment {
            self.ask_environment(bounce, environment, scratch, recorder);
        }
    }

    /// From one local light, picked by `pick` in 0..1, which stands for all.
    #[inline(always)]
    fn light_from_any(&self, vertex: &Vertex, pick: f64, u: Vec2) -> Option<Answer> {
        let Self { scene, .. } = self;
        match scene.local_lights.pick(vertex.start, vertex.horizon(), pick)? {
            (LocalLight::Point(place), chance) => self.light_from_point(vertex, place, chance),
            (LocalLight::Round(place), chance) => self.light_from_round(vertex, place, chance, u),
            (LocalLight::Area(number), chance) => {
                self.light_from_area(vertex, scene.area_lights.get(number), chance, u)
            }
        }
    }

    /// From the light without extent with this place, which had this chance of being asked.
    #[inline(always)]
    pub(super) fn light_from_point(
        &self,
        vertex: &Vertex,
        place: u32,
        chance: f32,
    ) -> Option<Answer> {
        let light = &self.scene.lights[place as usize];
        let source = Source::Light(self.scene.light_numbers[place as usize]);
        let sample = light.sample(vertex.position.as_dvec3())?;
        vertex.light_from(source, sample, light.shadows, chance)
    }

    /// From the round light with this place, which had this chance of being asked.
    #[inline(always)]
    pub(super) fn light_from_round(
        &self,
        vertex: &Vertex,
        place: u32,
        chance: f32,
        u: Vec2,
    ) -> Option<Answer> {
        let light = &self.scene.round_lights[place as usize];
        let source = Source::Light(self.scene.round_numbers[place as usize]);
        let sample = light.sample(vertex.position.as_dvec3(), u.as_dvec2())?;
        vertex.light_from(source, sample, true, chance)
    }

    /// From a point of a surface that emits and had this chance of being asked.
    #[inline(always)]
    pub(super) fn light_from_area(
        &self,
        vertex: &Vertex,
        light: &AreaLight,
        chance: f32,
        u: Vec2,
    ) -> Option<Answer> {
        let (from, moved) = (vertex.start.as_dvec3(), vertex.moved(self.scene, light));
        let sample = light.sample(from, u.as_dvec2(), moved)?;
        self.light_from_sample(vertex, (light, chance), sample)
    }

    /// The same with the point picked.
    #[inline(always)]
    fn light_from_sample(
        &self,
        vertex: &Vertex,
        (light, chance): (&AreaLight, f32),
        sample: ShapeSample,
    ) -> Option<Answer> {
        let (scattered, pdf, start) = vertex.scattered(sample.incoming.as_vec3())?;
        let asked = (light, chance);
        let aim = Aim::new(self.techniques, asked, &sample, (scattered, pdf), start);
        let emitted = self.scene.emitted_by(light, sample, vertex.walk.time);
        Some(aim.answer(asked, sample.pdf as f32, emitted))
    }

    /// From behind everything.
    #[inline(always)]
    fn light_from_afar(
        &self,
        vertex: &Vertex,
        source: Source,
        sample: EnvironmentSample,
    ) -> Option<Answer> {
        let incoming = sample.incoming;
        let (scattered, pdf, start) = vertex.scattered(incoming)?;
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
    pub(super) fn ask<const N: usize>(
        &self,
        bounce: u32,
        numbers: [u32; N],
        scratch: &mut Scratch,
        recorder: &mut impl Recorder,
        light: impl Fn(&Vertex, [Vec2; N]) -> Option<Answer>,
    ) {
        scratch.draws.draw(self.scene.level(), numbers);
        self.settle(bounce, scratch, recorder, |vertex, draws, k| light(vertex, draws.get(k)));
    }

    /// The same for the environment, in directions that it picks.
    #[inline(always)]
    fn ask_environment(
        &self,
        bounce: u32,
        environment: &Environment,
        scratch: &mut Scratch,
        recorder: &mut impl Recorder,
    ) {
        let (level, draws) = (self.scene.level(), &mut scratch.draws);
        draws.draw(level, [Bounce::new(bounce).environment()]);
        let (pairs, samples) = (&draws.pairs[0], &mut draws.sky);
        level.run(Ask { environment, pairs, samples });
        self.settle(bounce, scratch, recorder, |vertex, draws, k| {
            self.light_from_afar(vertex, Source::Environment, *draws.sky.get(k)?)
        });
    }

    /// Adds what `light` gives to each vertex, by its place, where nothing is in the way.
    #[inline(always)]
    fn settle(
        &self,
        bounce: u32,
        scratch: &mut Scratch,
        recorder: &mut impl Recorder,
        light: impl Fn(&Vertex, &Draws, usize) -> Option<Answer>,
    ) {
        let Scratch { walks, vertices, draws, shadows, samples, counts, .. } = scratch;
        shadows.clear();
        for k in 0..vertices.len() {
            let vertex = vertices.get(k, walks);
            if let Some(answer) = light(&vertex, draws, k) {
                let (asked, media) = (answer.at(&vertex, bounce), answer.media(&vertex));
                shadows.ask(self.scene, &asked, media, samples, recorder);
            }
        }
        shadows.settle(self.scene, 0, samples, counts, recorder);
    }

    /// The same for an area light, by the pairs with this number.
    #[inline(always)]
    fn ask_area(
        &self,
        bounce: u32,
        (light, number): (&AreaLight, u32),
        scratch: &mut Scratch,
        recorder: &mut impl Recorder,
    ) {
        let Scratch { walks, vertices, draws, aims, shadows, samples, counts, .. } = scratch;
        let (level, techniques) = (self.scene.level(), self.techniques);
        let moves = self.scene.world.motion(light.surface).is_some();
        let even = self.scene.even_emission(light);
        draws.draw(level, [number]);
        shadows.clear();
        for (number, block) in vertices.blocks().iter().enumerate() {
            let places = draws.block(0, number);
            if !moves {
                level.run(AimAll { techniques, light, block, places, aims: &mut *aims });
            }
            for (k, &place) in places.iter().enumerate() {
                let vertex = vertices.get(number * BLOCK + k, walks);
                let answer = match (even, vertex.other) {
                    _ if vertex.on_surface().is_none() => None,
                    _ if moves => self.light_from_area(&vertex, light, 1.0, place),
                    (Some(emitted), None) => aims.answer(k, light, vertex.start, emitted),
                    _ => aims
                        .seen
                        .get(k)
                        .and_then(|sample| self.light_from_sample(&vertex, (light, 1.0), sample)),
                };
                if let Some(answer) = answer {
                    let (asked, media) = (answer.at(&vertex, bounce), answer.media(&vertex));
                    shadows.ask(self.scene, &asked, media, samples, recorder);
                }
            }
        }
        shadows.settle(self.scene, 0, samples, counts, recorder);
    }
}

impl Vertex<'_> {
    /// From a light that no ray can meet and that had this chance of being asked.
    #[inline(always)]
    fn light_from(
        &self,
        source: Source,
        sample: LightSample,
        shadows: bool,
        chance: f32,
    ) -> Option<Answer> {
        let (scattered, _, start) = self.scattered(sample.incoming)?;
        let ray = shadows.then(|| sample.ray_from(self.position, start, 0.0));
        let (incoming, irradiance) = (sample.incoming, sample.irradiance / chance);
        let draw = Draw::of_point(chance);
        Some(Answer { source, ray, incoming, scattered, irradiance, draw })
    }

    /// From a sky of radiance 1 that surfaces nearer than `reach` hide, in a direction that the BSDF picks.
    #[inline(always)]
    pub(super) fn light_from_sky(
        &self,
        source: Source,
        reach: f32,
        choice: f32,
        u: Vec2,
    ) -> Option<Answer> {
        let sample = self.sample(choice, u)?;
        let (incoming, scattered) = (sample.incoming, sample.weight);
        let start = self.start_of(sample.through);
        let ray = Some(Ray { t_max: reach, ..Ray::new(start, incoming) });
        let (irradiance, draw) = (Rgb::ONE, Draw::of_point(1.0));
        Some(Answer { source, ray, incoming, scattered, irradiance, draw })
    }
}

impl Answer {
    /// What the light would give to the eye by way of `vertex`.
    #[inline(always)]
    pub(super) fn at(&self, vertex: &Vertex, bounce: u32) -> Asked {
        let Self { source, ray, incoming, scattered, irradiance, draw } = *self;
        let ray = ray.map(|ray| Ray { time: vertex.walk.time, ..ray });
        let gain = vertex.walk.reflected(bounce, source, scattered * irradiance);
        let (gain, passed) = (Gain { asked: true, ..gain }, Rgb::ONE);
        Asked { gain, after: None, ray, incoming, scattered, irradiance, draw, passed }
    }

    /// The solids that the light arrives through.
    #[inline(always)]
    fn media<'a>(&self, vertex: &'a Vertex) -> &'a Media {
        vertex.media_of(vertex.passes(self.incoming))
    }
}
