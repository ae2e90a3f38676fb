//! Shape above all, for visualization and CAD: colours as they are under a light at the camera, narrow places darker
//! than open ones, and lines where surfaces end, bend or hide each other. Nothing casts a shadow.
//!
//! Lines: a few rays around each one tell whether it is near an edge (Choudhury & Parker, *Ray Tracing NPR-Style Feature
//! Lines*, 2009).

use super::lights::Answer;
use super::walk::Walk;
use super::{Path, Scratch};
use crate::color::Rgb;
use crate::geometry::{Hit, Ray};
use crate::integrator::Source;
use crate::integrator::dimensions::Bounce;
use crate::integrator::record::{Recorder, add};
use crate::sampler::PathPoints;
use crate::scene::description::Section;
use crate::scene::{Meets, Scene, SeenByCamera};
use crate::shading::bsdf::Matte;
use glam::{DVec3, Vec2, Vec3, Vec4Swizzles};
use std::f32::consts::PI;

/// The samples of a pixel look for the sky in 2 to the power of this many directions together: enough for no grain to show.
const LOOKS_BITS: u32 = 7;
/// Each does so in 2 to the power of this many, at least and at most.
const LOOK_BITS: [u32; 2] = [2, 6];
/// The part of a colour that is there even where no sky is.
const ALWAYS: f32 = 0.4;
/// The part of a colour that surfaces keep that are seen edge-on.
const EDGE_ON: f32 = 0.5;
/// Rays around each one, to look for edges.
const AROUND: usize = 8;
/// Cosine of the angle by which a surface has to bend for a line.
const BEND: f32 = 0.9;
/// By how many pixels' size a surface has to lie behind the other one for a line.
const BEHIND: f32 = 8.0;
/// How bright lines are.
const INK: f32 = 0.02;
/// The part of a colour that cut surfaces show.
const CUT: f32 = 0.6;

/// Shows shapes.
pub(crate) struct Clarity<'a> {
    path: Path<'a>,
    /// Surfaces further away than this make no place narrow, m.
    distance: f32,
    /// Width of the lines, pixels.
    lines: f32,
    section: Option<Section>,
}

/// What there is to compare of what two rays meet.
#[derive(Clone, Copy)]
struct Mark {
    /// The number of what was met; that of [`Hit::none`] if nothing was.
    surface: u32,
    /// Whether the inside is seen, where a section has opened it.
    cut: bool,
    position: Vec3,
    normal: Vec3,
    distance: f32,
}

impl<'a> Clarity<'a> {
    /// In `scene`; surfaces nearer than `distance` (m) make places narrow, lines are `lines` pixels wide.
    pub(crate) fn new(
        scene: &'a Scene,
        transparent: bool,
        distance: f64,
        lines: f64,
        section: Option<Section>,
    ) -> Self {
        let path = Path::new(scene, transparent, Some(1));
        Self { path, distance: distance as f32, lines: lines as f32, section }
    }

    /// What each of `rays` shows, one sample each by its `points`, into `scratch.samples`.
    #[inline(never)]
    pub(crate) fn gather(
        &self,
        rays: &[Ray],
        points: &[PathPoints],
        scratch: &mut Scratch,
        recorder: &mut impl Recorder,
    ) {
        scratch.begin(rays.len());
        scratch.counts.camera += rays.len() as u64;
        scratch.rays.extend(rays.iter().map(|ray| self.kept(ray)));
        let cone = self.path.scene.cone;
        let walk = |(sample, ray): (u32, &Ray)| Walk { cone, ..Walk::from_eye(sample, ray.time) };
        scratch.walks.extend((0..).zip(rays).map(walk));
        self.closest_hits(&scratch.rays, &mut scratch.hits);
        let inks = self.inks(&scratch.rays, &scratch.hits);
        self.shade(&inks, scratch, recorder);
        self.look_for_sky(points, scratch, recorder);
    }

    /// π times the openness at `position` of a surface that faces the unit vector `normal`, one sample for each of
    /// `points`.
    pub(crate) fn irradiance(
        &self,
        position: DVec3,
        normal: Vec3,
        points: &[PathPoints],
        scratch: &mut Scratch,
    ) {
        self.path.stand(position, normal, PI / (1.0 - ALWAYS), points, scratch);
        self.look_for_sky(points, scratch, &mut ());
    }

    /// Where a section has opened things, their insides are seen.
    fn closest_hits(&self, rays: &[Ray], hits: &mut Vec<Hit>) {
        let Path { scene, .. } = self.path;
        match self.section {
            Some(_) => scene.world.closest_hits(rays, &Meets(scene, 0), hits),
            None => scene.world.closest_hits(rays, &SeenByCamera(scene, 0), hits),
        }
    }

    /// The part of a ray on the side of the section that is left.
    fn kept(&self, ray: &Ray) -> Ray {
        let Some(Section { point, normal }) = self.section else { return *ray };
        let before = (ray.origin.as_dvec3() - point).dot(normal);
        let leaving = ray.direction.as_dvec3().dot(normal);
        let crossing = (-before / leaving) as f32;
        match (before > 0.0, leaving < 0.0) {
            (true, true) => Ray { t_min: ray.t_min.max(crossing), ..*ray },
            (true, false) => Ray { t_min: f32::INFINITY, ..*ray },
            (false, true) => *ray,
            (false, false) => Ray { t_max: ray.t_max.min(crossing), ..*ray },
        }
    }

    /// How much of a line each ray meets, 0..1.
    fn inks(&self, rays: &[Ray], hits: &[Hit]) -> Vec<f32> {
        if self.lines <= 0.0 {
            return vec![0.0; rays.len()];
        }
        let camera = self.path.scene.camera();
        let mut around = vec![0.0; rays.len()];
        let marks: Vec<Mark> =
            rays.iter().zip(hits).map(|(ray, hit)| self.mark(ray, hit)).collect();
        let (mut beside, mut met) = (Vec::with_capacity(rays.len()), Vec::new());
        for corner in 0..AROUND {
            let angle = std::f32::consts::TAU * (corner as f32 + 0.5) / AROUND as f32;
            let by = self.lines * Vec2::from_angle(angle);
            beside.clear();
            beside.extend(rays.iter().map(|ray| {
                let whole = Ray { t_min: 0.0, t_max: f32::INFINITY, ..*ray };
                self.kept(&camera.beside(&whole, by))
            }));
            self.closest_hits(&beside, &mut met);
            for (((count, mark), ray), hit) in around.iter_mut().zip(&marks).zip(&beside).zip(&met)
            {
                *count += f32::from(self.is_edge(mark, &self.mark(ray, hit)));
            }
        }
        // On an edge, half of the rays around meet something else.
        let half = 0.5 * AROUND as f32;
        around.into_iter().map(|count| 1.0 - (count - half).abs() / half).collect()
    }

    fn mark(&self, ray: &Ray, hit: &Hit) -> Mark {
        let nothing = Mark {
            surface: hit.surface,
            cut: false,
            position: Vec3::ZERO,
            normal: Vec3::ZERO,
            distance: f32::INFINITY,
        };
        if !hit.is_some() {
            return nothing;
        }
        let at = self.path.scene.interaction(ray, hit);
        let (position, normal) = (at.position, at.shading_normal);
        let cut = self.section.is_some() && !at.front;
        Mark { cut, position, normal, distance: hit.t, ..nothing }
    }

    /// Whether there is an edge between two points.
    fn is_edge(&self, a: &Mark, b: &Mark) -> bool {
        if (a.surface, a.cut) != (b.surface, b.cut) {
            return true;
        }
        if a.distance.is_infinite() || a.cut {
            return false;
        }
        let apart = b.position - a.position;
        let off = apart.dot(a.normal).abs().min(apart.dot(b.normal).abs());
        let pixel = self.path.scene.camera().cone(1);
        let size = pixel.after(a.distance.min(b.distance)).width;
        a.normal.dot(b.normal) < BEND || off > BEHIND * size
    }

    /// Adds what needs no sky, and makes vertices of the surfaces that were met, with what they reflect of it.
    fn shade(&self, inks: &[f32], scratch: &mut Scratch, recorder: &mut impl Recorder) {
        let Path { scene, transparent, .. } = self.path;
        let Scratch { rays, walks, hits, vertices, samples, on_surface, .. } = scratch;
        let rays = (0..).zip(&*rays);
        for ((((number, ray), walk), hit), ink) in rays.zip(&*walks).zip(&*hits).zip(inks) {
            recorder.follow(&walk.along(0, ray, hit));
            let paper = 1.0 - ink;
            add(scene, samples, recorder, walk.gain(0, Source::Look, Rgb::splat(ink * INK)));
            if !hit.is_some() {
                match transparent {
                    true => samples[walk.sample as usize].alpha = f32::from(*ink > 0.5),
                    false => add(
                        scene,
                        samples,
                        recorder,
                        walk.gain(0, Source::Background, paper * scene.background),
                    ),
                }
                continue;
            }
            on_surface.push(walk.sample);
            let mut at = scene.interaction(ray, hit);
            at.seen_width = walk.cone.after(hit.t).width;
            let (material, is_cut) = (scene.material(hit), self.section.is_some() && !at.front);
            let emitted = scene.emitted(material, &at, -ray.direction);
            let color = match emitted.max_element() {
                0.0 => scene.evaluate(&material.reflectance, &at).xyz(),
                brightest => emitted / brightest.max(1.0),
            };
            if is_cut {
                add(scene, samples, recorder, walk.reflected(0, Source::Look, paper * CUT * color));
                continue;
            }
            let facing = at.shading_normal.dot(-ray.direction).clamp(0.0, 1.0);
            let shown = paper * (EDGE_ON + (1.0 - EDGE_ON) * facing) * color;
            add(scene, samples, recorder, walk.reflected(0, Source::Look, ALWAYS * shown));
            let reflectance = scene.openness(material, &at) * shown;
            let matte = Matte { normal: at.shading_normal, reflectance };
            vertices.push_matte(number, [at.position, at.ray_origin()], matte);
        }
    }

    /// Each sample looks for the sky in 2 to the power of this many directions: in the more, the fewer samples there are.
    fn look_bits(&self) -> u32 {
        let samples = self.path.scene.film().samples.next_power_of_two().ilog2();
        let [least, most] = LOOK_BITS;
        LOOKS_BITS.saturating_sub(samples).clamp(least, most)
    }

    fn look_for_sky(
        &self,
        points: &[PathPoints],
        scratch: &mut Scratch,
        recorder: &mut impl Recorder,
    ) {
        let bits = self.look_bits();
        let looks = 1 << bits;
        let share = Rgb::splat((1.0 - ALWAYS) / looks as f32);
        let pair = Bounce::new(0).direction();
        let mut parts = Vec::with_capacity(points.len());
        for look in 0..looks {
            parts.clear();
            parts.extend(points.iter().map(|points| points.part(look, bits)));
            let Scratch { draws, vertices, walks, .. } = &mut *scratch;
            draws.begin(&parts, vertices, walks);
            self.path.ask(0, [pair], scratch, recorder, |vertex, [u]| {
                let answer = vertex.light_from_sky(Source::Look, self.distance, 0.0, u)?;
                let ray = answer.ray.map(|ray| self.kept(&ray));
                Some(Answer { ray, irradiance: share, ..answer })
            });
        }
    }
}
