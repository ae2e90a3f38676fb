//! Reconstruction filters, by placing samples: each sample belongs to one pixel and is placed around its centre with
//! the density of the filter, so that pixels are independent of each other and tiles of their neighbours.
//!
//! Ernst, Stamminger, Greiner, *Filter Importance Sampling*, 2006.

use crate::scene::description::Filter;
use glam::Vec2;

/// Places samples by a filter.
#[derive(Debug, Clone)]
pub(crate) struct FilterSampler {
    filter: Filter,
    /// Places that cut the integral of |f| into `PIECES` equal parts, from −radius to radius.
    quantiles: Vec<f32>,
    has_lobes: bool,
}

/// Pieces of equal probability; the density is constant on each.
const PIECES: usize = 1024;
/// Samples per pixel from which on negative weights are outnumbered for certain.
const ENOUGH_FOR_LOBES: u32 = 16;

impl FilterSampler {
    /// Tabulates `filter` for pictures of `samples` samples per pixel. Negative lobes are left out where so few
    /// samples could cancel each other.
    pub(crate) fn new(filter: &Filter, samples: u32) -> Self {
        let with_lobes = samples >= ENOUGH_FOR_LOBES;
        let lowest = if with_lobes { f64::NEG_INFINITY } else { 0.0 };
        let quantiles = quantiles(radius(filter), |x| value(filter, x).max(lowest).abs());
        let has_lobes = with_lobes && matches!(filter, Filter::Mitchell { .. });
        Self { filter: *filter, quantiles, has_lobes }
    }

    /// The place of a sample relative to the pixel's centre, in pixels, and its weight, from numbers in 0..1.
    #[inline(always)]
    pub(crate) fn place(&self, sample: Vec2) -> (Vec2, f32) {
        let place = Vec2::new(self.invert(sample.x), self.invert(sample.y));
        (place, if self.has_lobes { self.sign(place.x) * self.sign(place.y) } else { 1.0 })
    }

    #[inline(always)]
    fn invert(&self, sample: f32) -> f32 {
        let place = sample * PIECES as f32;
        let piece = (place as usize).min(PIECES - 1);
        let (from, to) = (self.quantiles[piece], self.quantiles[piece + 1]);
        from + (place - piece as f32) * (to - from)
    }

    fn sign(&self, place: f32) -> f32 {
        value(&self.filter, f64::from(place)).signum() as f32
    }
}

/// Places from −radius to radius between which a density has equal integrals.
fn quantiles(radius: f64, density: impl Fn(f64) -> f64) -> Vec<f32> {
    const STEPS: usize = 16 * PIECES;
    let edge = |step: usize| (step as f64 / STEPS as f64 * 2.0 - 1.0) * radius;
    let weights: Vec<f64> = (0..STEPS).map(|i| density(0.5 * (edge(i) + edge(i + 1)))).collect();
    let piece = weights.iter().sum::<f64>() / PIECES as f64;
    let (mut places, mut sum) = (vec![-radius as f32], 0.0);
    for (step, weight) in weights.iter().enumerate() {
        while places.len() < PIECES && sum + weight >= piece * places.len() as f64 {
            let part = (piece * places.len() as f64 - sum) / weight;
            places.push((edge(step) + part * (edge(step + 1) - edge(step))) as f32);
        }
        sum += weight;
    }
    places.resize(PIECES, radius as f32);
    places.push(radius as f32);
    places
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
        let mitchell = Filter::Mitchell { radius: 2.0, b: 1.0 / 3.0, c: 1.0 / 3.0 };
        let filters = [
            Filter::Box { radius: 0.5 },
            Filter::Tent { radius: 1.0 },
            Filter::default(),
            mitchell,
        ];
        for filter in filters {
            let places = (0..100_000).map(|i| (f64::from(i) / 50_000.0 - 1.0) * radius(&filter));
            let integral = |power| {
                places.clone().map(|x| value(&filter, x) * f64::powi(x, power)).sum::<f64>()
            };
            let variance = integral(2) / integral(0);
            let sampler = FilterSampler::new(&filter, 64);
            let n = 100_000;
            let samples = (0..n).map(|i| Vec2::new((i as f32 + 0.5) / n as f32, 0.5));
            let places = samples.map(|sample| sampler.place(sample));
            let moment =
                |power| places.clone().map(|(p, w)| f64::from(w * p.x.powi(power))).sum::<f64>();
            let sampled = moment(2) / moment(0);
            assert!(
                (sampled - variance).abs() < 1e-3 * radius(&filter),
                "{filter:?}: {sampled} {variance}"
            );
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
