//! The scene's way of gathering light, whichever it is.

use super::RayCounts;
use super::direct::{self, Direct};
use super::path::{self, Clarity, Occlusion, Path};
use super::record::Recorder;
use crate::film::Sample;
use crate::geometry::Ray;
use crate::sampler::PathPoints;
use crate::scene::Scene;
use crate::scene::description::Integrator;
use glam::{DVec3, Vec3};

/// How light is gathered in a scene.
pub(crate) enum Way<'a> {
    /// The lecture's sum, where nothing is left to chance.
    Sum(Direct<'a>),
    /// Paths; of one reflection for the lecture's sum over lights that have an extent.
    Paths(Path<'a>),
    /// What the sky would give.
    Occlusion(Occlusion<'a>),
    /// What shows shapes best.
    Clarity(Clarity<'a>),
}

impl<'a> Way<'a> {
    /// The way of `scene`. With `transparent`, what lies behind all surfaces counts as nothing.
    pub(crate) fn of(scene: &'a Scene, transparent: bool) -> Self {
        match scene.integrator {
            Integrator::Direct if scene.is_lecture => Self::Sum(Direct::new(scene, transparent)),
            Integrator::Direct => Self::Paths(Path::new(scene, transparent, Some(1))),
            Integrator::Path { bounces } => Self::Paths(Path::new(scene, transparent, bounces)),
            Integrator::AmbientOcclusion { distance } => {
                Self::Occlusion(Occlusion::new(scene, transparent, distance))
            }
            Integrator::Clarity { distance, lines, section } => {
                Self::Clarity(Clarity::new(scene, transparent, distance, lines, section))
            }
        }
    }
}

impl Way<'_> {
    /// Whether every light is asked at a path's point with this number, or one for all.
    pub(crate) fn asks_all(&self, bounce: u32) -> bool {
        match self {
            Self::Paths(path) => path.asks_all(bounce),
            Self::Sum(_) | Self::Occlusion(_) | Self::Clarity(_) => true,
        }
    }
}

impl Way<'_> {
    /// Irradiance at `position` on a surface that faces the unit vector `normal`, W·m⁻²: the mean of one sample for each
    /// of `points`.
    pub(crate) fn irradiance(
        &self,
        position: DVec3,
        normal: Vec3,
        points: &[PathPoints],
        gatherer: &mut Gatherer,
    ) -> DVec3 {
        let Gatherer { direct: sums, path: paths } = gatherer;
        match self {
            Self::Sum(direct) => return direct.irradiance(position, normal, sums).as_dvec3(),
            Self::Paths(path) => path.irradiance(position, normal, points, paths),
            Self::Occlusion(occlusion) => occlusion.irradiance(position, normal, points, paths),
            Self::Clarity(clarity) => clarity.irradiance(position, normal, points, paths),
        }
        mean_radiance(&paths.samples)
    }

    /// π times the fraction of the sky that is not hidden by surfaces nearer than `distance`, m.
    pub(crate) fn to_sky(scene: &Scene, distance: f64) -> Way<'_> {
        Way::Occlusion(Occlusion::new(scene, false, distance))
    }
}

/// The mean of what samples gathered.
pub(super) fn mean_radiance(samples: &[Sample]) -> DVec3 {
    let sum: DVec3 = samples.iter().map(|sample| sample.radiance.as_dvec3()).sum();
    sum / samples.len() as f64
}

/// What one worker needs to gather light; its buffers are reused from batch to batch.
#[derive(Default)]
pub(crate) struct Gatherer {
    direct: direct::Scratch,
    path: path::Scratch,
}

impl Gatherer {
    /// Radiance along each of `rays`, one sample each by its `points`. With `transparent`, what lies behind all surfaces
    /// counts as nothing. `recorder` is told what happens.
    #[inline(always)]
    pub(crate) fn gather(
        &mut self,
        scene: &Scene,
        transparent: bool,
        rays: &[Ray],
        points: &[PathPoints],
        recorder: &mut impl Recorder,
    ) -> &[Sample] {
        match Way::of(scene, transparent) {
            Way::Sum(direct) => direct.gather(rays, &mut self.direct, recorder),
            Way::Paths(path) => path.gather(rays, points, &mut self.path, recorder),
            Way::Clarity(clarity) => clarity.gather(rays, points, &mut self.path, recorder),
            Way::Occlusion(occlusion) => {
                occlusion.gather(rays, points, &mut self.path, recorder);
            }
        }
        self.samples(scene)
    }

    /// The same outside of a picture, compiled for every processor and once for all who ask.
    #[inline(never)]
    pub(crate) fn gather_alone(
        &mut self,
        scene: &Scene,
        rays: &[Ray],
        points: &[PathPoints],
    ) -> &[Sample] {
        self.gather(scene, false, rays, points, &mut ())
    }

    /// The samples of the last batch in `scene`.
    #[inline(always)]
    pub(crate) fn samples(&self, scene: &Scene) -> &[Sample] {
        match Way::of(scene, false) {
            Way::Sum(_) => &self.direct.samples,
            _ => &self.path.samples,
        }
    }

    /// Rays traced since this was last asked.
    pub(crate) fn take_counts(&mut self) -> RayCounts {
        let mut counts = std::mem::take(&mut self.direct.counts);
        counts += std::mem::take(&mut self.path.counts);
        counts
    }

    /// Of the last batch in `scene`: how many rays met a surface, and the largest radiance of any channel that one sent
    /// back.
    pub(crate) fn seen(&self, scene: &Scene) -> (u64, f32) {
        match Way::of(scene, false) {
            Way::Sum(_) => self.direct.seen(),
            _ => self.path.seen(),
        }
    }
}
