//! Where rays of paths arrive: what they bring to the eye, and where paths are scattered next.

use super::airlight::Airway;
use super::vertices::{Scattering, Vertices};
use super::walk::Walk;
use super::{Path, Scratch};
use crate::color::Rgb;
use crate::film::Sample;
use crate::geometry::{Hit, Ray};
use crate::integrator::Source;
use crate::integrator::dimensions::Bounce;
use crate::integrator::media::Crossing;
use crate::integrator::record::{Recorder, add};
use crate::math::BLOCK;
use crate::sampler::PathPoints;
use crate::scene::description::{Material, Medium};
use crate::scene::{LookAt, Plain, Points, Scene};
use crate::shading::bsdf::{Frame, Kind, Lobe, Matte};
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::light::environment::Meet;
use crate::shading::volume::HenyeyGreenstein;
use glam::Vec3;
use std::slice::Iter;

/// What becomes of rays that arrive.
struct Arrivals<'a, R> {
    path: &'a Path<'a>,
    bounce: u32,
    points: &'a [PathPoints],
    /// What the environment gives to each ray that hit nothing, as [`Meet`] says.
    sky: Iter<'a, (Rgb, f32)>,
    vertices: &'a mut Vertices,
    airways: &'a mut Vec<Airway>,
    samples: &'a mut [Sample],
    on_surface: &'a mut Vec<u32>,
    recorder: &'a mut R,
}

impl Path<'_> {
    /// Adds what comes along each ray, and makes vertices of the surfaces that were met.
    #[inline(never)]
    pub(super) fn arrive(
        &self,
        bounce: u32,
        points: &[PathPoints],
        scratch: &mut Scratch,
        recorder: &mut impl Recorder,
    ) {
        let Scratch { rays, walks, hits, met, sky, vertices, airways, samples, on_surface, .. } =
            &mut *scratch;
        let (path, scene) = (self, self.scene);
        vertices.clear();
        airways.clear();
        sky.clear();
        if let Some((environment, _)) = &scene.environment {
            scene.level().run(Meet { environment, rays, hits, met: &mut *sky });
        }
        let sky = sky.iter();
        let mut arrivals = Arrivals {
            path,
            bounce,
            points,
            sky,
            vertices,
            airways,
            samples,
            on_surface,
            recorder: &mut *recorder,
        };
        let mut walks = (0..).zip(walks);
        for (rays, hits) in rays.chunks(BLOCK).zip(hits.chunks(BLOCK)) {
            scene.level().run(LookAt { scene, rays, hits, points: &mut *met });
            for (k, ((ray, hit), walk)) in rays.iter().zip(hits).zip(&mut walks).enumerate() {
                arrivals.add(walk, ray, hit, (met, k));
            }
        }
        if !airways.is_empty() {
            self.add_airlight(bounce, points, scratch, recorder);
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
        sky: Option<&(Rgb, f32)>,
    ) -> impl Iterator<Item = (Source, Rgb)> {
        let Scene { suns, sun_numbers, environment, background, .. } = self.scene;
        let (pdf, direction, techniques) = (walk.pdf, ray.direction, self.techniques);
        let is_seen = environment.as_ref().is_some_and(|(_, visible)| *visible || bounce > 0);
        let sky = match sky.filter(|_| is_seen) {
            Some((radiance, lights)) => {
                Some((Source::Environment, radiance * techniques.met(*lights, pdf)))
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
}

impl<R: Recorder> Arrivals<'_, R> {
    /// One arrives where it hit something, if it did: the point with this place among those that were met.
    #[inline(always)]
    fn add(
        &mut self,
        (number, walk): (u32, &mut Walk),
        ray: &Ray,
        hit: &Hit,
        (met, k): (&Points, usize),
    ) {
        let Path { scene, .. } = *self.path;
        let (points, pairs) = (&self.points[walk.sample as usize], Bounce::new(self.bounce));
        let sky = if hit.is_some() { None } else { self.sky.next() };
        let plain = scene.plain(hit);
        let flat = plain.filter(|plain| plain.flat);
        let surface = if flat.is_some() { None } else { met.get(k, scene, ray, hit) };
        let crossing = surface
            .as_ref()
            .and_then(|surface| walk.cross(scene, surface, || points.pair(pairs.channel()).x));
        let medium = walk.media.medium(scene).filter(|_| walk.throughput != Rgb::ZERO);
        let scattered = medium.and_then(|medium| self.fly((number, walk), medium, hit.t));
        if self.bounce == 0 && (scattered.is_some() || hit.is_some()) {
            self.on_surface.push(walk.sample);
        }
        if let Some((distance, phase)) = scattered {
            return self.float(number, walk, &Ray { t_max: distance, ..*ray }, phase);
        }
        self.recorder.follow(&walk.along(self.bounce, ray, hit));
        walk.cone = walk.cone.after(hit.t);
        match (plain, surface) {
            (Some(plain), None) => self.meet_plain((number, walk), met.flat(k), plain),
            (Some(plain), Some(at)) => {
                let places = [at.position, at.ray_origin()];
                self.meet_plain((number, walk), (places, at.shading_normal), plain);
            }
            (None, Some(mut surface)) => {
                surface.seen_width = walk.cone.width;
                self.meet((number, walk), ray, &surface, crossing);
            }
            (None, None) => self.pass(walk, ray, sky),
        }
    }

    /// Goes along the last ray, of which there is so much, m, through a medium. Returns how far and how light is scattered there;
    /// `None` if it came to the end.
    #[inline(never)]
    fn fly(
        &mut self,
        (number, walk): (u32, &mut Walk),
        medium: Medium,
        length: f32,
    ) -> Option<(f32, HenyeyGreenstein)> {
        let (points, pairs) = (&self.points[walk.sample as usize], Bounce::new(self.bounce));
        if medium.scattering != Rgb::ZERO && walk.reflections < self.path.bounces {
            let throughput = walk.throughput;
            self.airways.push(Airway { walk: number, length, throughput, medium });
        }
        let flight = medium.fly(length, walk.throughput, || points.pair(pairs.flight()));
        walk.throughput *= flight.weight;
        flight.scattered.then_some((flight.distance, HenyeyGreenstein { g: medium.anisotropy }))
    }

    /// At the end of `ray`, between the particles of a medium.
    #[inline(never)]
    fn float(&mut self, number: u32, walk: &Walk, ray: &Ray, phase: HenyeyGreenstein) {
        let Path { scene, bounces, .. } = *self.path;
        self.recorder.follow(&walk.along(self.bounce, ray, &Hit::none(ray.t_max)));
        if walk.reflections < bounces {
            self.reflect(walk, scene.ambient);
            self.vertices.push_floating(number, walk, ray, phase);
        }
    }

    /// At nothing.
    #[inline(never)]
    fn pass(&mut self, walk: &Walk, ray: &Ray, sky: Option<&(Rgb, f32)>) {
        if self.bounce == 0 && self.path.transparent {
            self.samples[walk.sample as usize].alpha = 0.0;
            return;
        }
        for (source, radiance) in self.path.behind_all(self.bounce, walk, ray, sky) {
            let gain = walk.gain(self.bounce, source, radiance);
            add(self.path.scene, self.samples, self.recorder, gain);
        }
    }

    /// At a point of a plain surface: where it is and rays start, and its normal.
    #[inline(always)]
    fn meet_plain(
        &mut self,
        (number, walk): (u32, &Walk),
        (places, normal): ([Vec3; 2], Vec3),
        plain: &Plain,
    ) {
        if walk.reflections >= self.path.bounces {
            return;
        }
        let reflectance = plain.reflectance;
        self.reflect(walk, reflectance * self.path.scene.ambient);
        if reflectance != Rgb::ZERO {
            self.vertices.push_matte(number, places, Matte { normal, reflectance });
        }
    }

    /// At any surface.
    #[inline(never)]
    fn meet(
        &mut self,
        (number, walk): (u32, &Walk),
        ray: &Ray,
        surface: &SurfaceInteraction,
        crossing: Option<Crossing>,
    ) {
        let Path { scene, bounces, .. } = *self.path;
        let (material, outgoing) = (scene.material(&surface.hit), -ray.direction);
        let boundary = crossing.and_then(|crossing| crossing.boundary);
        let openness = scene.openness(material, surface);
        let first = self.vertices.lobes.len();
        let frame = if crossing.is_some() && boundary.is_none() {
            self.vertices.lobes.push(Lobe::new(Kind::Straight, Rgb::ONE));
            Frame::around(surface.shading_normal)
        } else {
            self.see(walk, material, surface, outgoing);
            // What does not turn light aside is no reflection.
            let on = material.interior.is_some() && material.passes_light();
            if walk.reflections >= bounces && !on {
                return;
            }
            let lobes = &mut self.vertices.lobes;
            let (frame, scattered) = scene.add_lobes(material, surface, outgoing, boundary, lobes);
            if scene.ambient != Rgb::ZERO && !on {
                let reflected = scene.ambient_reflectance(material, surface);
                self.reflect(walk, openness * reflected.unwrap_or(scattered) * scene.ambient);
            }
            frame
        };
        let places = [surface.position, surface.ray_origin()];
        match self.vertices.lobes[first..] {
            [] => {}
            [Lobe { kind: Kind::Lambert, weight: reflectance, .. }]
                if crossing.is_none() && openness == 1.0 && frame.is_upright() =>
            {
                self.vertices.lobes.truncate(first);
                let matte = Matte { normal: frame.normal(), reflectance };
                self.vertices.push_matte(number, places, matte);
            }
            _ => {
                let lobes = [first as u32, self.vertices.lobes.len() as u32];
                let beyond = crossing.map_or(walk.media, |crossing| crossing.beyond);
                let behind = surface.behind();
                let other = Scattering { frame, outgoing, lobes, behind, beyond, openness };
                self.vertices.push_other(number, places, other);
            }
        }
    }

    /// Adds what a surface emits.
    #[inline(always)]
    fn see(&mut self, walk: &Walk, material: &Material, at: &SurfaceInteraction, outgoing: Vec3) {
        let emitted = self.path.scene.emitted(material, at, outgoing);
        if emitted != Rgb::ZERO && (walk.sharp_only || !material.unlit) {
            let radiance = emitted * self.path.weight_of_emission(walk, at);
            let gain = walk.gain(self.bounce, Source::Surface(at.hit.surface), radiance);
            add(self.path.scene, self.samples, self.recorder, gain);
        }
    }

    /// Adds what is reflected of ambient light.
    #[inline(always)]
    fn reflect(&mut self, walk: &Walk, ambient: Rgb) {
        if ambient != Rgb::ZERO {
            let gain = walk.reflected(self.bounce, Source::Ambient, ambient);
            add(self.path.scene, self.samples, self.recorder, gain);
        }
    }
}
