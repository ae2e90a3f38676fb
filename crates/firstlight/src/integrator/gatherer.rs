//! The scene's way of gathering light, whichever it is.

use super::{RayCounts, direct, path};
use crate::film::Sample;
use crate::geometry::Ray;
use crate::sampler::PathPoints;
use crate::scene::Scene;
use crate::scene::description::Integrator;

/// What one worker needs to gather light; its buffers are reused from batch to batch.
#[derive(Default)]
pub(crate) struct Gatherer {
    direct: direct::Scratch,
    path: path::Scratch,
}

impl Gatherer {
    /// Radiance along each of `rays`, one sample each by its `points`. With `transparent`, what lies behind all surfaces
    /// counts as nothing.
    #[inline(always)]
    pub(crate) fn gather(
        &mut self,
        scene: &Scene,
        transparent: bool,
        rays: &[Ray],
        points: &[PathPoints],
    ) -> &[Sample] {
        match scene.integrator {
            Integrator::Direct => {
                direct::Direct::new(scene, transparent).gather(rays, &mut self.direct);
                &self.direct.samples
            }
            Integrator::Path { bounces } => {
                let path = path::Path::new(scene, transparent, bounces);
                path.gather(rays, points, &mut self.path);
                &self.path.samples
            }
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
        match scene.integrator {
            Integrator::Direct => self.direct.seen(),
            Integrator::Path { .. } => self.path.seen(),
        }
    }
}
