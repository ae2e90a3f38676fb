//! The light meter: single quantities with their error, through the stages of a render.

use super::{Direct, Scratch};
use crate::color::Rgb;
use crate::geometry::Ray;
use crate::scene::Scene;
use crate::scene::description::Alpha;
use glam::DVec3;

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

/// Samples of a quantity that chance decides about.
const REPETITIONS: u32 = 4096;

impl Scene {
    /// Irradiance at `point` (m) on a surface facing the unit direction `normal`: Σ over lights of E · cos θ, shadows
    /// included, plus π times the ambient radiance, W·m⁻².
    pub fn irradiance(&self, point: DVec3, normal: DVec3) -> Measurement {
        let normal = normal.as_vec3();
        let mut scratch = Scratch::default();
        self.measure(|repetition| {
            let direct = Direct::new(self, false).repeated(repetition);
            direct.irradiance(point, normal, &mut scratch)
        })
    }

    /// Radiance that arrives along `ray` in its range, W·sr⁻¹·m⁻².
    pub fn radiance(&self, ray: &Ray) -> Measurement {
        let mut scratch = Scratch::default();
        self.measure(|repetition| {
            Direct::new(self, false).repeated(repetition).gather(&[*ray], &mut scratch);
            scratch.samples[0].radiance
        })
    }

    /// One sample if nothing in the scene is left to chance, else many.
    fn measure(&self, mut sample: impl FnMut(u32) -> Rgb) -> Measurement {
        if self.materials.iter().all(|material| material.alpha != Alpha::Blend) {
            return Measurement { value: sample(0), standard_error: Rgb::ZERO, samples: 1 };
        }
        let (mut sum, mut squares) = (DVec3::ZERO, DVec3::ZERO);
        for repetition in 0..REPETITIONS {
            let value = sample(repetition).as_dvec3();
            sum += value;
            squares += value * value;
        }
        let n = f64::from(REPETITIONS);
        let variance = (squares / n - (sum / n).powf(2.0)).max(DVec3::ZERO) / (n - 1.0);
        let standard_error = variance.map(f64::sqrt).as_vec3();
        Measurement { value: (sum / n).as_vec3(), standard_error, samples: REPETITIONS }
    }
}
