//! Direct light, as the lecture sums it: L = L_emitted + R_a · L_a + Σ over lights of f · E · cos θ · visibility.
//!
//! Batches of rays go through the stages in the lecture's order; each stage takes slices and fills vectors.

use super::media::Media;
use super::points::{Lit, MATTE, Point, Points};
use super::record::{Asked, Draw, Followed, Gain, Recorder, add};
use super::shadows::ShadowRays;
use super::source::Source;
use crate::color::Rgb;
use crate::film::Sample;
use crate::geometry::{Hit, Ray};
use crate::scene::description::Shadows;
use crate::scene::{Scene, SeenByCamera};
use crate::shading::bsdf::{Bsdf, Frame, Lobe};
use crate::shading::interaction::{SurfaceInteraction, clearance};
use crate::shading::light::{Light, LightSample};
use glam::{DVec3, Vec3, Vec4Swizzles};
use std::f32::consts::{FRAC_1_PI, PI};
use std::ops::{AddAssign, Range};

/// How many rays were traced.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct RayCounts {
    /// From the camera.
    pub camera: u64,
    /// From surface to surface.
    pub bounce: u64,
    /// Towards lights.
    pub shadow: u64,
}

impl RayCounts {
    /// All of them.
    pub fn total(&self) -> u64 {
        self.camera + self.bounce + self.shadow
    }
}

impl AddAssign for RayCounts {
    fn add_assign(&mut self, other: Self) {
        self.camera += other.camera;
        self.bounce += other.bounce;
        self.shadow += other.shadow;
    }
}

/// Gathers direct light.
pub(crate) struct Direct<'a> {
    scene: &'a Scene,
    transparent: bool,
    /// Tells repetitions of one ray apart where chance decides, at partly transparent surfaces.
    repetition: u32,
}

/// Buffers that one worker reuses from batch to batch.
#[derive(Default)]
pub(crate) struct Scratch {
    hits: Vec<Hit>,
    points: Points,
    lit: Lit,
    /// What the points on surfaces that are more than matte do with light, and their lobes.
    glossy: Vec<Glossy>,
    lobes: Vec<Lobe>,
    shadows: ShadowRays,
    /// One answer per camera ray.
    pub samples: Vec<Sample>,
    /// What was traced so far.
    pub counts: RayCounts,
}

/// What else there is to know of a point on a surface that is more than matte.
struct Glossy {
    frame: Frame,
    outgoing: Vec3,
    /// Its lobes among all.
    lobes: Range<usize>,
    /// Where shadow rays start on the other side.
    behind: Vec3,
}

impl Scratch {
    /// Of the last batch: how many rays met a surface, and the largest radiance of any channel that one sent back.
    pub(crate) fn seen(&self) -> (u64, f32) {
        let radiance = self.points.rays().map(|ray| self.samples[ray as usize].radiance);
        (self.points.len() as u64, radiance.map(Rgb::max_element).fold(0.0, f32::max))
    }
}

impl<'a> Direct<'a> {
    /// Gathers light in `scene`.
    pub(crate) fn new(scene: &'a Scene, transparent: bool) -> Self {
        Self { scene, transparent, repetition: 0 }
    }

    /// The same with other decisions of chance for the same rays.
    pub(crate) fn repeated(self, repetition: u32) -> Self {
        Self { repetition, ..self }
    }

    /// Radiance along each of `rays`, into `scratch.samples`.
    #[inline(always)]
    pub(crate) fn gather(&self, rays: &[Ray], scratch: &mut Scratch, recorder: &mut impl Recorder) {
        self.closest_hits(rays, scratch);
        self.surface_points(rays, scratch, recorder);
        self.add_lights(scratch, recorder);
    }

    /// Irradiance at `position` on a surface that faces the unit vector `normal`, W·m⁻²: what a surface that reflects
    /// π times the light would send out.
    pub(crate) fn irradiance(&self, position: DVec3, normal: Vec3, scratch: &mut Scratch) -> Rgb {
        let rounded = position.as_vec3();
        let start = rounded + clearance(normal, rounded.abs(), 0.0) * normal;
        let shading_normal = normal;
        scratch.points.clear();
        let matte = Rgb::ONE;
        scratch.points.push(Point {
            ray: 0,
            position,
            start,
            shading_normal,
            matte,
            glossy: MATTE,
        });
        scratch.samples.clear();
        scratch.samples.push(Sample::of(PI * self.scene.ambient));
        self.add_lights(scratch, &mut ());
        scratch.samples[0].radiance
    }

    /// The lecture's loop over lights, for all points.
    #[inline(always)]
    fn add_lights(&self, scratch: &mut Scratch, recorder: &mut impl Recorder) {
        for (light, &number) in self.scene.lights.iter().zip(&self.scene.light_numbers) {
            self.sample_light(light, Source::Light(number), scratch, recorder);
            let Scratch { shadows, samples, counts, .. } = scratch;
            shadows.settle(self.scene, self.repetition, samples, counts, recorder);
        }
    }

    #[inline(always)]
    fn closest_hits(&self, rays: &[Ray], scratch: &mut Scratch) {
        scratch.counts.camera += rays.len() as u64;
        self.scene.world.closest_hits(
            rays,
            &SeenByCamera(self.scene, self.repetition),
            &mut scratch.hits,
        );
    }

    /// Starts each ray's sum: the background, or what the surface emits and reflects of the ambient light.
    #[inline(always)]
    fn surface_points(&self, rays: &[Ray], scratch: &mut Scratch, recorder: &mut impl Recorder) {
        let Scratch { hits, points, glossy, lobes, samples, .. } = scratch;
        points.clear();
        glossy.clear();
        lobes.clear();
        samples.clear();
        for (ray, hit) in hits.iter().enumerate() {
            let sample = ray as u32;
            let gain = |source, radiance, reflections| Gain {
                sample,
                source,
                bounce: 0,
                reflections,
                asked: false,
                radiance,
            };
            recorder.follow(&Followed {
                sample,
                bounce: 0,
                ray: rays[ray],
                hit: *hit,
                throughput: Rgb::ONE,
                width: self.scene.cone.after(hit.t).width,
            });
            samples.push(Sample::of(Rgb::ZERO));
            if !hit.is_some() {
                if self.transparent {
                    samples[ray].alpha = 0.0;
                } else {
                    add(
                        self.scene,
                        samples,
                        recorder,
                        gain(Source::Background, self.scene.background, 0),
                    );
                }
                continue;
            }
            let mut surface = self.scene.interaction(&rays[ray], hit);
            surface.seen_width = self.scene.cone.after(hit.t).width;
            let material = self.scene.material(hit);
            let start = self.scene.shadow_start(&surface, &rays[ray]);
            let is_plain = material.is_matte() && !material.has_relief();
            let (scattered, matte, number) = if is_plain {
                let reflectance = self.scene.evaluate(&material.reflectance, &surface).xyz();
                (reflectance, reflectance * FRAC_1_PI, MATTE)
            } else {
                let (first, outgoing) = (lobes.len(), -rays[ray].direction);
                let boundary = self.scene.boundary_from_air(material, &surface);
                let (frame, scattered) =
                    self.scene.add_lobes(material, &surface, outgoing, boundary, lobes);
                let behind = 2.0 * surface.position - start;
                glossy.push(Glossy { frame, outgoing, lobes: first..lobes.len(), behind });
                (scattered, Rgb::ZERO, glossy.len() as u32 - 1)
            };
            let ambient = self.scene.openness(material, &surface)
                * self.scene.ambient_reflectance(material, &surface).unwrap_or(scattered);
            let emitted = self.scene.emitted(material, &surface, -rays[ray].direction);
            add(self.scene, samples, recorder, gain(Source::Surface(hit.surface), emitted, 0));
            add(
                self.scene,
                samples,
                recorder,
                gain(Source::Ambient, ambient * self.scene.ambient, 1),
            );
            points.push(Point {
                ray: sample,
                position: surface.position.as_dvec3(),
                start,
                shading_normal: surface.shading_normal,
                matte,
                glossy: number,
            });
        }
    }

    /// What `light` would add to each point, with the shadow rays that decide whether it does.
    #[inline(always)]
    fn sample_light(
        &self,
        light: &Light,
        source: Source,
        scratch: &mut Scratch,
        recorder: &mut impl Recorder,
    ) {
        let Scratch { points, lit, glossy, lobes, shadows: shadow_rays, samples, .. } = scratch;
        let t_min = self.scene.shadow_t_min();
        let shadows = light.shadows && self.scene.shadows != Shadows::Off;
        shadow_rays.clear();
        for (block, count) in points.blocks() {
            lit.ask(light, block, count);
            for k in 0..count {
                let point = block.get(k);
                let (sample, cos, mut ray) = lit.get(k, point.start, t_min);
                let LightSample { incoming, irradiance, .. } = sample;
                let glossy = glossy.get(point.glossy as usize);
                let scattered = match glossy {
                    _ if irradiance == Rgb::ZERO => continue,
                    None if cos <= 0.0 => continue,
                    None => point.matte * cos,
                    Some(glossy) => glossy.eval(lobes, incoming),
                };
                let radiance = scattered * irradiance;
                if radiance == Rgb::ZERO {
                    continue;
                }
                if let Some(glossy) = glossy.filter(|_| cos <= 0.0) {
                    ray = sample.ray_from(point.position.as_vec3(), glossy.behind, t_min);
                }
                let gain = Gain {
                    sample: point.ray,
                    source,
                    bounce: 0,
                    reflections: 1,
                    asked: true,
                    radiance,
                };
                let ray = shadows.then_some(ray);
                let (draw, passed) = (Draw::of_point(1.0), Rgb::ONE);
                let asked =
                    Asked { gain, after: None, ray, incoming, scattered, irradiance, draw, passed };
                shadow_rays.ask(self.scene, &asked, &Media::default(), samples, recorder);
            }
        }
    }
}

impl Glossy {
    /// BSDF × |cosine| for light from `incoming`, sr⁻¹, as far as lights can be asked for it.
    fn eval(&self, lobes: &[Lobe], incoming: Vec3) -> Rgb {
        let lobes = &lobes[self.lobes.clone()];
        Bsdf { frame: self.frame, outgoing: self.outgoing, lobes }.eval(incoming).0
    }
}

impl Scene {
    /// Where shadow rays from a surface start, by the scene's way of keeping them off it.
    #[inline(always)]
    fn shadow_start(&self, surface: &SurfaceInteraction, seen_along: &Ray) -> Vec3 {
        let naive = || seen_along.at(surface.hit.t);
        match self.shadows {
            Shadows::Robust | Shadows::Off => surface.ray_origin(),
            Shadows::Naive | Shadows::TRange { .. } => naive(),
            Shadows::MovedStart { epsilon } => naive() + epsilon as f32 * surface.geometric_normal,
        }
    }

    /// Where the range of shadow rays starts.
    #[inline(always)]
    fn shadow_t_min(&self) -> f32 {
        if let Shadows::TRange { epsilon } = self.shadows { epsilon as f32 } else { 0.0 }
    }
}
