//! What a case measures, point by point, and whether that is right.

use super::Tolerance;
use super::statistics::normal_of_student;
use crate::geometry::Ray;
use crate::integrator::{Measurement, Meter};
use crate::scene::Scene;
use glam::DVec3;

/// One number that was measured, and what it should be.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// Which point of the case; empty if there is only one.
    pub at: String,
    /// What was measured.
    pub measured: f64,
    /// What is expected.
    pub expected: f64,
    /// Standard error of what was measured; 0 if chance had no part in it.
    pub standard_error: f64,
    /// How far `measured` is from `expected`; 0 where it is on the right side of a bound.
    pub difference: f64,
    /// How far it may be.
    pub allowed: f64,
    /// The difference in standard deviations: those of chance, and of rounding.
    pub z: f64,
}

/// The readings of a case while it is measured.
#[derive(Debug)]
pub struct Readings {
    tolerance: Tolerance,
    /// What all that is measured is multiplied by: 1, unless an error is planted.
    gain: f64,
    readings: Vec<Reading>,
}

/// Rounding to single precision and what follows from it, relative: its standard deviation as far as z is concerned.
const ROUNDING: f64 = 2.5e-6;
/// Samples that a measurement starts with.
const FEWEST_SAMPLES: u32 = 1 << 14;
/// Samples up to which it gets better than it has to be.
const CHEAP_SAMPLES: u32 = 1 << 18;
/// Samples that it does not go beyond.
const MOST_SAMPLES: u32 = 1 << 26;

impl Reading {
    /// The difference relative to what is expected; as it is where nothing is expected.
    pub fn error(&self) -> f64 {
        let scale = if self.expected == 0.0 { 1.0 } else { self.expected };
        (self.difference / scale).abs()
    }

    /// Whether it is within its tolerance, known well enough to tell, and no further off than chance explains:
    /// `greatest_z` standard deviations.
    pub fn passes(&self, greatest_z: f64) -> bool {
        let right = self.difference.abs() <= self.allowed;
        right && self.standard_error <= 0.5 * self.allowed && self.z.abs() <= greatest_z
    }
}

/// The ray from `origin` to `target`.
fn toward(origin: DVec3, target: DVec3) -> Ray {
    Ray::new(origin.as_vec3(), (target - origin).normalize().as_vec3())
}

impl Readings {
    /// Independent repetitions of a measurement of any kind.
    pub(super) const REPETITIONS: u64 = 16;

    pub(super) fn new(tolerance: Tolerance, gain: f64) -> Self {
        Self { tolerance, gain, readings: Vec::new() }
    }

    pub(super) fn into_inner(self) -> Vec<Reading> {
        self.readings
    }

    /// A number that chance has no part in.
    pub(super) fn exact(&mut self, at: impl ToString, measured: impl Into<f64>, expected: f64) {
        self.estimate(at, measured, 0.0, f64::INFINITY, expected);
    }

    /// A number that must not be greater than `bound`.
    pub(super) fn at_most(&mut self, at: impl ToString, measured: f64, bound: f64) {
        self.exact(at, measured.max(bound), bound);
        if let Some(reading) = self.readings.last_mut() {
            reading.measured = measured;
        }
    }

    /// A mean with its standard error, which is known from `freedom` + 1 independent numbers.
    pub(super) fn estimate(
        &mut self,
        at: impl ToString,
        measured: impl Into<f64>,
        standard_error: f64,
        freedom: f64,
        expected: f64,
    ) {
        let (at, measured) = (at.to_string(), self.gain * measured.into());
        let difference = measured - expected;
        let rounding = ROUNDING * expected.abs();
        let deviation = standard_error.hypot(rounding);
        let z = if difference == 0.0 {
            0.0
        } else {
            normal_of_student(difference / deviation, freedom)
        };
        let allowed = self.tolerance.of(expected);
        let reading = Reading { at, measured, expected, standard_error, difference, allowed, z };
        self.readings.push(reading);
    }

    /// Irradiance at `point` on a surface that faces `normal`.
    pub(super) fn irradiance(
        &mut self,
        at: impl ToString,
        scene: &Scene,
        point: DVec3,
        normal: DVec3,
        expected: f64,
    ) {
        let meter = Meter::new(scene);
        self.meter(at, |samples| meter.samples(samples).irradiance(point, normal), expected);
    }

    /// Radiance from `target` towards `origin`.
    pub(super) fn radiance(
        &mut self,
        at: impl ToString,
        scene: &Scene,
        origin: DVec3,
        target: DVec3,
        expected: f64,
    ) {
        let ray = toward(origin, target);
        self.meter(at, |samples| Meter::new(scene).samples(samples).radiance(&ray), expected);
    }

    /// Radiance from `target` towards `origin` that is known to be approximate, see
    /// [`Readings::known_to_tolerance`].
    pub(super) fn approximation(
        &mut self,
        at: impl ToString,
        scene: &Scene,
        origin: DVec3,
        target: DVec3,
        expected: f64,
    ) {
        let ray = toward(origin, target);
        let measure = |samples| Meter::new(scene).samples(samples).radiance(&ray);
        let allowed = self.tolerance.of(expected);
        self.meter_to(at, measure, |_| allowed / 4.0, expected);
        self.known_to_tolerance();
    }

    /// Of the last number, what was measured or what is expected is known to the tolerance only: z counts what is
    /// beyond.
    pub(super) fn known_to_tolerance(&mut self) {
        if let Some(reading) = self.readings.last_mut() {
            let beyond = (reading.difference.abs() - reading.allowed).max(0.0);
            reading.z *= beyond / reading.difference.abs().max(f64::MIN_POSITIVE);
        }
    }

    /// What a meter shows in its first channel, well enough for the tolerance, which chance alone then does not exceed once
    /// in thousands of readings; where that is cheap, well enough to find a bias of half the tolerance in hundreds.
    pub(super) fn meter(
        &mut self,
        at: impl ToString,
        measure: impl Fn(u32) -> Measurement,
        expected: f64,
    ) {
        let allowed = self.tolerance.of(expected);
        let enough = |samples| if samples < CHEAP_SAMPLES { allowed / 16.0 } else { allowed / 5.0 };
        self.meter_to(at, measure, enough, expected);
    }

    /// What a meter shows in its first channel, with a standard error of at most `enough` for so many samples.
    fn meter_to(
        &mut self,
        at: impl ToString,
        measure: impl Fn(u32) -> Measurement,
        enough: impl Fn(u32) -> f64,
        expected: f64,
    ) {
        let mut samples = FEWEST_SAMPLES;
        let measured = loop {
            let measured = measure(samples);
            let known = f64::from(measured.standard_error.x) <= enough(samples);
            if known || samples >= MOST_SAMPLES {
                break measured;
            }
            samples *= 4;
        };
        let freedom = f64::from(Meter::SEQUENCES - 1);
        let standard_error = f64::from(measured.standard_error.x);
        self.estimate(at, measured.value.x, standard_error, freedom, expected);
    }

    /// The mean of what `measure` makes of different seeds.
    pub(super) fn repeated(
        &mut self,
        at: impl ToString,
        measure: impl FnMut(u64) -> f64,
        expected: f64,
    ) {
        let values: Vec<f64> = (0..Self::REPETITIONS).map(measure).collect();
        let n = Self::REPETITIONS as f64;
        let mean = values.iter().sum::<f64>() / n;
        let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        self.estimate(at, mean, (squares / (n - 1.0) / n).sqrt(), n - 1.0, expected);
    }
}
