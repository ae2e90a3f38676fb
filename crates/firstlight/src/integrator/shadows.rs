//! Shadow rays: light that was asked for waits until it is known what stands in the way.

use super::RayCounts;
use super::media::Media;
use super::panes;
use super::record::{Asked, Gain, Recorder, add};
use crate::color::Rgb;
use crate::film::Sample;
use crate::geometry::Ray;
use crate::scene::{Scene, StopsLight};

/// The shadow rays of a batch, and what waits for each.
#[derive(Default)]
pub(super) struct ShadowRays {
    rays: Vec<Ray>,
    awaited: Vec<Awaited>,
    /// The solids that each starts in, if there are any.
    media: Vec<Media>,
    occluded: Vec<bool>,
}

/// Light that reaches the eye if nothing is in the way.
struct Awaited {
    gain: Gain,
    /// The recorder's number of it.
    number: u32,
}

impl ShadowRays {
    /// Forgets those of the last batch.
    #[inline(always)]
    pub(super) fn clear(&mut self) {
        self.rays.clear();
        self.awaited.clear();
        self.media.clear();
    }

    /// Takes note of light that a ray asks for from within `media`, or adds it at once if nothing can stop it.
    #[inline(always)]
    pub(super) fn ask(
        &mut self,
        scene: &Scene,
        asked: &Asked,
        media: &Media,
        samples: &mut [Sample],
        recorder: &mut impl Recorder,
    ) {
        let number = recorder.ask(asked);
        match asked.ray {
            Some(ray) => {
                self.rays.push(ray);
                self.awaited.push(Awaited { gain: asked.gain, number });
                if scene.has_solids {
                    self.media.push(*media);
                }
            }
            None => add(scene, samples, recorder, asked.gain),
        }
    }

    /// Traces the rays, and adds the light of those that nothing stops; panes tint it, media weaken it. The number tells repetitions of
    /// a ray apart where chance decides.
    #[inline(never)]
    pub(super) fn settle(
        &mut self,
        scene: &Scene,
        repetition: u32,
        samples: &mut [Sample],
        counts: &mut RayCounts,
        recorder: &mut impl Recorder,
    ) {
        let Self { rays, awaited, media, occluded } = self;
        counts.shadow += rays.len() as u64;
        scene.world.occluded(rays, &StopsLight(scene, repetition), occluded);
        for (i, (awaited, ray)) in awaited.iter().zip(&*rays).enumerate() {
            if occluded[i] {
                recorder.answer(awaited.number, Rgb::ZERO);
                continue;
            }
            let media = media.get(i).copied().unwrap_or_default();
            let passed = panes::tint(scene, ray, media, repetition);
            recorder.answer(awaited.number, passed);
            let radiance = awaited.gain.radiance * passed;
            add(scene, samples, recorder, Gain { radiance, ..awaited.gain });
        }
    }
}
