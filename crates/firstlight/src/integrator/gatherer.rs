//! The scene's way of gathering light, whichever it is.

use super::RayCounts;
use super::direct::{self, Direct};
use super::path::{self, Occlusion, Path};
use super::record::Recorder;
use crate::film::Sample;
use crate::geometry::Ray;
use crate::sampler::PathPoints;
use crate::scene::Scene;
use crate::scene::description::Integrator;

/// How light is gathered in a scene.
pub(crate) enum Way<'a> {
    /// The lecture's sum, where nothing is left to chance.
    Sum(Direct<'a>),
    /// Paths; of one reflection for the lecture's sum over lights that have an extent.
    Paths(Path<'a>),
    /// What the sky would give.
    Occlusion(Occlusion<'a>),
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
        }
    }
}

impl Way<'_> {
    /// Whether every light is asked at a path's point with this number, or one for all.
    pub(crate) fn asks_all(&self, bounce: u32) -> bool {
        match self {
            Self::Paths(path) => path.asks_all(bounce),
            Self::Sum(_) | Self::Occlusion(_) => true,
        }
    }
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
            Way::Sum(direct) => {
                direct.gather(rays, &mut self.direct, recorder);
                return &self.direct.samples;
            }
            Way::Paths(path) => path.gather(rays, points, &mut self.path, recorder),
            Way::Occlusion(occlusion) => {
                occlusion.gather(rays, points, &mut self.path, recorder);
            }
        }
        &self.path.samples
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
            Way::Paths(_) | Way::Occlusion(_) => self.path.seen(),
        }
    }
}
