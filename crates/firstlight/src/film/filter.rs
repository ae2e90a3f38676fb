//! Reconstruction filters, by placing samples: each sample belongs to one pixel and is placed around its centre with
//! the density of the filter, so that pixels are independent of each other and tiles of their neighbours.
//!
//! Ernst, Stamminger, Greiner, *Filter Importance Sampling*, 2006.

use crate::scene::description::Filter;
use glam::Vec2;

/// Places samples by a filter.
#[derive(Debug, Clone)]
pub(crate) struct FilterSampler {
    radius: f32,
    /// Integral of |f| up to each of `STEPS + 1` places from −radius to radius, scaled to end at 1.
    cumulative: Vec<f32>,
    /// Sign of f in each step.
    signs: Vec<f32>,
}

/// Pieces of the tabulated filter; it is constant on each.
const STEPS: usize = 2048;
/// Samples per pixel from which on negative weights are outnumbered for certain.
const ENOUGH_FOR_LOBES: u32 = 16;

impl FilterSampler {
    /// Tabulates `filter` for pictures of `samples` samples per pixel. Negative lobes are left out where so few
    /// samples could cancel each other.
    pub(crate) fn new(filter: &Filter, samples: u32) -> Self {
        let lowest = if samples < ENOUGH_FOR_LOBES { 0.0 } else { f64::NEG_INFINITY };
        let radius = radius(filter);
        let place = |i: usize| ((i as f64 + 0.5) / STEPS as f64 * 2.0 - 1.0) * radius;
        let values: Vec<f64> = (0..STEPS).map(|i| value(filter, place(i)).max(lowest)).collect();
        let total: f64 = values.iter().map(|v| v.abs()).sum();
        let mut sum = 0.0;
        let mut cumulative = vec![0.0];
        for v in &values {
            sum += v.abs();
            cumulative.push((sum / total) as f32);
        }
        let signs = values.iter().map(|v| v.signum() as f32).collect();
        Self { radius: radius as f32, cumulative, signs }
    }

    /// The place of a sample relative to the pixel's centre, in pixels, and its weight, from numbers in 0..1.
    pub(crate) fn place(&self, sample: Vec2) -> (Vec2, f32) {
        let ((x, sign_x), (y, sign_y)) = (self.invert(sample.x), self.invert(sample.y));
        (Vec2::new(x, y), sign_x * sign_y)
    }

    fn invert(&self, sample: f32) -> (f32, f32) {
        let step = (self.cumulative.partition_point(|&c| c <= sample) - 1).min(STEPS - 1);
        let (from, to) = (self.cumulative[step], self.cumulative[step + 1]);
        let part = if to > from { (sample - from) / (to - from) } else { 0.5 };
        let place = (step as f32 + part) / STEPS as f32 * 2.0 - 1.0;
        (place * self.radius, self.signs[step])
    }
}

fn radius(filter: &Filter) -> f64 {
    match *filter {
        Filter::Box { radius } | Filter::Tent { radius } => radius,
        Filter::Gaussian { radius, .. } | Filter::Mitchell { radius, .. } => radius,
    }
}

/// The filter at distance `x` from its centre along one axis, up to a constant factor.
fn value(filter: &Filter, x: f64) -> f64 {
    match *filter {
        Filter::Box { .. } => 1.0,
        Filter::Tent { radius } => 1.0 - x.abs() / radius,
        Filter::Gaussian { radius, sigma } => {
            let bell = |x: f64| (-0.5 * (x / sigma).powi(2)).exp();
            bell(x) - bell(radius)
        }
        Filter::Mitchell { radius, b, c } => mitchell((2.0 * x / radius).abs(), b, c),
    }
}

/// Mitchell & Netravali, *Reconstruction Filters in Computer Graphics*, 1988, with `x` in 0..2.
fn mitchell(x: f64, b: f64, c: f64) -> f64 {
    if x < 1.0 {
        (12.0 - 9.0 * b - 6.0 * c) * x.powi(3) + (-18.0 + 12.0 * b + 6.0 * c) * x.powi(2) + 6.0
            - 2.0 * b
    } else {
        (-b - 6.0 * c) * x.powi(3)
            + (6.0 * b + 30.0 * c) * x.powi(2)
            + (-12.0 * b - 48.0 * c) * x
            + 8.0 * b
            + 24.0 * c
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Moments of the placed, signed samples against integrals of the filter's formula.
    #[test]
    fn placed_samples_have_the_moments_of_the_filter() {
        let filters = [
            (Filter::Box { radius: 0.5 }, 1.0 / 12.0),
            (Filter::Tent { radius: 1.0 }, 1.0 / 6.0),
            (Filter::Gaussian { radius: 4.0, sigma: 0.5 }, 0.25),
        ];
        for (filter, variance) in filters {
            let sampler = FilterSampler::new(&filter, 64);
            let n = 100_000;
            let places = (0..n).map(|i| sampler.place(Vec2::new((i as f32 + 0.5) / n as f32, 0.3)));
            let sum: f64 = places.map(|(p, w)| f64::from(w) * f64::from(p.x).powi(2)).sum();
            assert!((sum / f64::from(n) / variance - 1.0).abs() < 1e-3, "{filter:?}");
        }
    }

    #[test]
    fn mitchell_keeps_straight_lines_straight_and_has_negative_lobes() {
        let filter = Filter::Mitchell { radius: 2.0, b: 1.0 / 3.0, c: 1.0 / 3.0 };
        for x in [0.0, 0.25, 0.5, 0.9] {
            let inside: f64 = (-2..=2)
                .map(|k| x + f64::from(k))
                .filter(|x| x.abs() < 2.0)
                .map(|x| value(&filter, x))
                .sum();
            assert!((inside - 6.0).abs() < 1e-9, "{x}: {inside}");
        }
        let sampler = FilterSampler::new(&filter, 64);
        assert_eq!(sampler.place(Vec2::new(0.5, 0.5)).1, 1.0);
        assert_eq!(sampler.place(Vec2::new(0.01, 0.5)).1, -1.0);
    }
}
