//! Ambient occlusion: how much of a sky of radiance 1 a white surface would see, if nothing further away than a distance
//! stood in between (Zhukov, Iones, Kronin, *An Ambient Light Illumination Model*, 1998).

use super::{Path, Scratch};
use crate::color::Rgb;
use crate::geometry::Ray;
use crate::integrator::Source;
use crate::integrator::dimensions::Bounce;
use crate::integrator::record::{Recorder, add};
use crate::sampler::PathPoints;
use crate::scene::Scene;
use crate::shading::bsdf::Matte;
use glam::{DVec3, Vec3};
use std::f32::consts::PI;

/// Looks for the sky.
pub(crate) struct Occlusion<'a> {
    path: Path<'a>,
    /// Surfaces further away than this do not count, m.
    distance: f32,
}

impl<'a> Occlusion<'a> {
    /// In `scene`, of surfaces nearer than `distance` (m).
    pub(crate) fn new(scene: &'a Scene, transparent: bool, distance: f64) -> Self {
        Self { path: Path::new(scene, transparent, Some(1)), distance: distance as f32 }
    }

    /// Openness, 0..1, of what each of `rays` meets, one sample each by its `points`, into `scratch.samples`; the
    /// background where it meets nothing.
    #[inline(never)]
    pub(crate) fn gather(
        &self,
        rays: &[Ray],
        points: &[PathPoints],
        scratch: &mut Scratch,
        recorder: &mut impl Recorder,
    ) {
        self.path.look(rays, scratch);
        self.arrive(scratch, recorder);
        self.ask_the_sky(points, scratch, recorder);
    }

    /// π times the openness at `position` of a surface that faces the unit vector `normal`, one sample for each of
    /// `points`: the irradiance under a sky of radiance 1.
    pub(crate) fn irradiance(
        &self,
        position: DVec3,
        normal: Vec3,
        points: &[PathPoints],
        scratch: &mut Scratch,
    ) {
        self.path.stand(position, normal, PI, points, scratch);
        self.ask_the_sky(points, scratch, &mut ());
    }

    /// Makes white vertices of the surfaces that were met.
    #[inline(always)]
    fn arrive(&self, scratch: &mut Scratch, recorder: &mut impl Recorder) {
        let Path { scene, transparent, .. } = self.path;
        let Scratch { rays, walks, hits, vertices, samples, on_surface, .. } = scratch;
        for (((number, ray), walk), hit) in (0..).zip(&*rays).zip(&*walks).zip(&*hits) {
            recorder.follow(&walk.along(0, ray, hit));
            if hit.is_some() {
                on_surface.push(walk.sample);
                let at = scene.interaction(ray, hit);
                let matte = Matte { normal: at.shading_normal, reflectance: Rgb::ONE };
                vertices.push_matte(number, [at.position, at.ray_origin()], matte);
            } else if transparent {
                samples[walk.sample as usize].alpha = 0.0;
            } else {
                add(scene, samples, recorder, walk.gain(0, Source::Background, scene.background));
            }
        }
    }

    #[inline(always)]
    fn ask_the_sky(
        &self,
        points: &[PathPoints],
        scratch: &mut Scratch,
        recorder: &mut impl Recorder,
    ) {
        let pair = Bounce::new(0).direction();
        let Scratch { draws, vertices, walks, .. } = &mut *scratch;
        draws.begin(points, vertices, walks);
        self.path.ask(0, [pair], scratch, recorder, |vertex, [u]| {
            vertex.light_from_sky(Source::Environment, self.distance, 0.0, u)
        });
    }
}
