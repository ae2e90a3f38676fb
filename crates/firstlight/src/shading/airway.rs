//! Places along a ray through a medium, picked in two ways: where a light is near, and where its light is not lost on the way to
//! the ray's start.

use super::volume::{each, pick};
use crate::color::Rgb;
use crate::math::{angle_above, on_circle};
use glam::DVec2;
use std::ops::Range;

/// Places spread evenly over the angle that a light sees of the ray, so that 1/r² is in their density.
///
/// Kulla & Fajardo, *Importance Sampling Techniques for Path Tracing in Participating Media*, 2012.
#[derive(Debug, Clone)]
pub(crate) struct Equiangular {
    /// Where the ray is nearest to the light, m along it.
    nearest: f64,
    /// How near it is there, m.
    distance: f64,
    /// Where the light sees the start and the end, rad off the ray's direction.
    angles: [f64; 2],
}

impl Equiangular {
    /// Over a span of a ray, m, whose end may be infinite. At `nearest` (m) it is `distance` away from the light (m, more than 0).
    pub(crate) fn new(span: &Range<f64>, nearest: f64, distance: f64) -> Self {
        let angle = |t: f64| match t {
            f64::INFINITY => 0.0,
            _ => angle_above(DVec2::new(t - nearest, distance)),
        };
        Self { nearest, distance, angles: [span.start, span.end].map(angle) }
    }

    /// The place picked by a number in 0..1, m.
    pub(crate) fn sample(&self, u: f64) -> f64 {
        let [first, last] = self.angles;
        let seen = on_circle(first + u * (last - first));
        self.nearest + self.distance * seen.x / seen.y
    }

    /// Density with which a place is picked, m⁻¹.
    pub(crate) fn pdf(&self, t: f64) -> f64 {
        let ([first, last], along) = (self.angles, t - self.nearest);
        self.distance / ((first - last) * (self.distance * self.distance + along * along))
    }
}

/// Places spread as light that is left from there to the ray's start, channels mixed.
#[derive(Debug, Clone)]
pub(crate) struct Attenuated {
    start: f64,
    /// What is lost per length in each channel, m⁻¹.
    extinction: Rgb,
    /// How much each counts.
    weights: Rgb,
    /// The part that is lost over the whole span.
    lost: Rgb,
    /// What weights are multiplied by for the density at the start, m⁻¹.
    densities: Rgb,
}

impl Attenuated {
    /// Over a span of a ray, m, whose end may be infinite, channels in proportion to `weights`; those with any have an
    /// extinction (m⁻¹).
    pub(crate) fn new(span: &Range<f64>, extinction: Rgb, weights: Rgb) -> Self {
        let length = (span.end - span.start) as f32;
        let lost = each(extinction, |k| if k > 0.0 { -(-k * length).exp_m1() } else { 1.0 });
        let densities = extinction / (lost * weights.element_sum());
        Self { start: span.start, extinction, weights, lost, densities }
    }

    /// What is left in each channel, weighted, of light that goes from a place to the start of the span.
    pub(crate) fn left(&self, t: f64) -> Rgb {
        let distance = (t - self.start) as f32;
        self.weights * each(self.extinction, |k| (-k * distance).exp())
    }

    /// The place picked by a number in 0..1, m.
    pub(crate) fn sample(&self, u: f64) -> f64 {
        let (channel, u) = pick(self.weights, u);
        let lost = u as f32 * self.lost[channel];
        self.start - f64::from((-lost).ln_1p() / self.extinction[channel])
    }

    /// Density with which a place is picked from which so much is left, m⁻¹.
    pub(crate) fn pdf(&self, left: Rgb) -> f64 {
        self.densities.dot(left).into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Random, chi_squared_z};

    /// Both densities, over a span with an end and one without: as many places fall into each part as their integrals say.
    #[test]
    fn places_follow_their_densities() {
        let (extinction, weights) = (Rgb::new(0.3, 2.0, 0.0), Rgb::new(1.0, 0.5, 0.0));
        for end in [5.0, f64::INFINITY] {
            let span = 1.5..end;
            let near = Equiangular::new(&span, 2.1, 0.4);
            let far = Attenuated::new(&span, extinction, weights);
            let pdf = |t: f64| far.pdf(far.left(t));
            assert_follows(&span, |u| near.sample(u), |t| near.pdf(t));
            assert_follows(&span, |u| far.sample(u), pdf);
        }
    }

    fn assert_follows(span: &Range<f64>, sample: impl Fn(f64) -> f64, pdf: impl Fn(f64) -> f64) {
        const CELLS: usize = 40;
        let (last, mut random) = (span.end.min(6.0), Random::new(3));
        let edge = |cell: usize| span.start + (last - span.start) * cell as f64 / CELLS as f64;
        let share = |cell: usize| {
            let (from, step) = (edge(cell), (edge(cell + 1) - edge(cell)) / 100.0);
            (0..100).map(|i| pdf(from + (f64::from(i) + 0.5) * step) * step).sum::<f64>()
        };
        let mut shares: Vec<_> = (0..CELLS).map(share).collect();
        shares.push((1.0 - shares.iter().sum::<f64>()).max(0.0));
        assert_eq!(shares[CELLS] > 1e-3, span.end.is_infinite(), "{shares:?}");
        let mut counts = vec![0; CELLS + 1];
        for _ in 0..200_000 {
            let place = sample(random.unit());
            assert!(place >= span.start - 1e-6 && place <= span.end + 1e-6, "{place}");
            let cell = (place - span.start) / (last - span.start) * CELLS as f64;
            counts[(cell.max(0.0) as usize).min(if place < last { CELLS - 1 } else { CELLS })] += 1;
        }
        if shares[CELLS] < 1e-3 {
            counts[CELLS - 1] += counts.pop().expect("there is a last");
            shares.pop();
        }
        let z = chi_squared_z(&counts, &shares);
        assert!(z < 4.5, "{z} standard deviations from the density");
    }

    /// Fog so thin that nothing is lost, and a light straight ahead.
    #[test]
    fn no_place_is_lost_to_rounding() {
        let thin = Attenuated::new(&(0.0..10.0), Rgb::splat(1e-9), Rgb::X);
        assert!((thin.pdf(thin.left(3.0)) - 0.1).abs() < 1e-6);
        assert!((thin.sample(0.25) - 2.5).abs() < 1e-5);
        let ahead = Equiangular::new(&(0.0..f64::INFINITY), 3.0, 1e-9);
        assert!((ahead.sample(0.5) - 3.0).abs() < 1e-6 && ahead.pdf(3.0).is_finite());
    }
}
