//! The light meter: single quantities with their error, through the stages of a render.

use super::dimensions::time;
use super::direct::{self, Direct};
use super::gatherer::{Gatherer, Way, mean_radiance};
use crate::color::Rgb;
use crate::geometry::Ray;
use crate::math::hash;
use crate::sampler::{PathPoints, Sampler};
use crate::scene::Scene;
use glam::DVec3;
use rayon::prelude::*;

/// A measured quantity per colour channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measurement {
    /// The mean.
    pub value: Rgb,
    /// Standard error of the mean; zero where no chance was involved.
    pub standard_error: Rgb,
    /// How many samples the mean is of.
    pub samples: u32,
}

/// Measures single quantities in a scene.
#[derive(Debug, Clone, Copy)]
pub struct Meter<'a> {
    scene: &'a Scene,
    samples: u32,
}

/// Samples that are taken at a time.
const BATCH: u32 = 1 << 10;

impl Scene {
    /// Irradiance at `point` (m) on a surface facing the unit direction `normal`: all light that arrives there, each
    /// direction by its cosine, W·m⁻².
    pub fn irradiance(&self, point: DVec3, normal: DVec3) -> Measurement {
        Meter::new(self).irradiance(point, normal)
    }

    /// Radiance that arrives along `ray` in its range, W·sr⁻¹·m⁻².
    pub fn radiance(&self, ray: &Ray) -> Measurement {
        Meter::new(self).radiance(ray)
    }
}

impl<'a> Meter<'a> {
    /// Sequences of samples along paths. Within one, samples make up for each other's errors; only whole sequences are
    /// independent and tell how large the error is.
    pub const SEQUENCES: u32 = 16;

    /// For `scene`, with a usual number of samples.
    pub fn new(scene: &'a Scene) -> Self {
        Self { scene, samples: 1 << 16 }
    }

    /// With so many samples, rounded up to 16 times a power of two, where chance decides.
    #[must_use]
    pub fn samples(self, samples: u32) -> Self {
        Self { samples, ..self }
    }

    /// See [`Scene::irradiance`].
    pub fn irradiance(&self, point: DVec3, normal: DVec3) -> Measurement {
        let (way, normal) = (Way::of(self.scene, false), normal.as_vec3());
        let Way::Sum(_) = way else {
            return self.follow(|points, gatherer| way.irradiance(point, normal, points, gatherer));
        };
        let mut scratch = direct::Scratch::default();
        self.repeat(|repetition| self.sum(repetition).irradiance(point, normal, &mut scratch))
    }

    /// See [`Scene::radiance`].
    pub fn radiance(&self, ray: &Ray) -> Measurement {
        let Way::Sum(_) = Way::of(self.scene, false) else {
            return self.follow(|points, gatherer| {
                let at = |points| Ray { time: time(self.scene, points), ..*ray };
                let rays: Vec<_> = points.iter().map(at).collect();
                mean_radiance(gatherer.gather_alone(self.scene, &rays, points))
            });
        };
        let mut scratch = direct::Scratch::default();
        self.repeat(|repetition| {
            self.sum(repetition).gather(&[*ray], &mut scratch, &mut ());
            scratch.samples[0].radiance
        })
    }

    /// The lecture's sum with decisions of chance of its own.
    fn sum(&self, repetition: u32) -> Direct<'a> {
        Direct::new(self.scene, false).repeated(repetition)
    }

    /// One sample if nothing in the scene is left to chance, else many.
    fn repeat(&self, mut sample: impl FnMut(u32) -> Rgb) -> Measurement {
        if !self.scene.has_blends {
            return Measurement { value: sample(0), standard_error: Rgb::ZERO, samples: 1 };
        }
        let repetitions = self.samples.div_ceil(Self::SEQUENCES).max(2);
        mean((0..repetitions).map(|repetition| sample(repetition).as_dvec3()))
    }

    /// The mean over several sequences of samples; `gather` finds that of a batch.
    fn follow(&self, gather: impl Fn(&[PathPoints], &mut Gatherer) -> DVec3 + Sync) -> Measurement {
        let length = self.samples.div_ceil(Self::SEQUENCES).next_power_of_two();
        let sequence = |number: u32| {
            let seed = hash(self.scene.film().seed) ^ u64::from(number);
            let (sampler, mut gatherer) = (Sampler::new(seed, length), Gatherer::default());
            let batches = (0..length).step_by(BATCH as usize).map(|start| {
                let points = |index| sampler.points(0, 0, index);
                let points: Vec<_> = (start..length.min(start + BATCH)).map(points).collect();
                points.len() as f64 * gather(&points, &mut gatherer)
            });
            batches.sum::<DVec3>() / f64::from(length)
        };
        let means: Vec<_> = (0..Self::SEQUENCES).into_par_iter().map(sequence).collect();
        Measurement { samples: Self::SEQUENCES * length, ..mean(means.into_iter()) }
    }
}

/// The mean of independent values, with its standard error.
fn mean(values: impl ExactSizeIterator<Item = DVec3>) -> Measurement {
    let samples = values.len() as u32;
    let (mut sum, mut squares) = (DVec3::ZERO, DVec3::ZERO);
    for value in values {
        sum += value;
        squares += value * value;
    }
    let n = f64::from(samples);
    let variance = (squares / n - (sum / n).powf(2.0)).max(DVec3::ZERO) / (n - 1.0);
    let standard_error = variance.map(f64::sqrt).as_vec3();
    Measurement { value: (sum / n).as_vec3(), standard_error, samples }
}
