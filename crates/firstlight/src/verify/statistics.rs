//! How far chance reaches.

use crate::math::hash;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// The greatest |z| among so many readings that chance alone exceeds as rarely as it exceeds 4 in a single one
/// (Šidák, *Rectangular Confidence Regions for the Means of Multivariate Normal Distributions*, 1967).
pub fn greatest_z(readings: usize) -> f64 {
    let single = 2.0 * upper_tail(4.0);
    let each = -((-single).ln_1p() / readings.max(1) as f64).exp_m1();
    let (mut low, mut high) = (4.0, 40.0);
    for _ in 0..60 {
        let middle: f64 = f64::midpoint(low, high);
        if 2.0 * upper_tail(middle) > each { low = middle } else { high = middle }
    }
    low
}

/// The probability that a normal deviate is greater than `z` ≥ 0: by the series for its middle, by Laplace's continued
/// fraction for its tail.
pub(super) fn upper_tail(z: f64) -> f64 {
    let density = (-0.5 * z * z).exp() / TAU.sqrt();
    if z > 3.0 {
        return density / (1..=100).rev().fold(z, |rest, k| z + f64::from(k) / rest);
    }
    let next = |term: &f64, k: u32| term * z * z / f64::from(2 * k + 1);
    let terms = (1..60).scan(z, |term, k| {
        *term = next(term, k);
        Some(*term)
    });
    0.5 - density * (z + terms.sum::<f64>())
}

/// The greatest distance between the distribution of numbers in 0..1 and the uniform one, times √n (Kolmogorov): above
/// 1.95 with a probability of a thousandth.
pub(super) fn kolmogorov(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    let n = values.len() as f64;
    let distance = |(i, x): (usize, &f64)| (x - i as f64 / n).max((i + 1) as f64 / n - x);
    values.iter().enumerate().map(distance).fold(0.0, f64::max) * n.sqrt()
}

/// The normal deviate that is as improbable as Student's t with so many degrees of freedom (Wallace, *Bounds on Normal
/// Approximations to Student's and the Chi-Square Distributions*, 1959).
pub(super) fn normal_of_student(t: f64, freedom: f64) -> f64 {
    if freedom.is_infinite() {
        return t;
    }
    let factor = (8.0 * freedom + 1.0) / (8.0 * freedom + 3.0);
    factor * (freedom * (t * t / freedom).ln_1p()).sqrt().copysign(t)
}

/// The mean over the unit sphere of what `value` says of directions: one in each of `rows` × 2 `rows` cells of equal area.
pub(super) fn mean_over_sphere(rows: u32, seed: u64, value: impl Fn(DVec3) -> f64) -> f64 {
    let mut random = Random::new(seed);
    let mut sum = 0.0;
    for cell in 0..2 * rows * rows {
        let z = 2.0 * (f64::from(cell % rows) + random.unit()) / f64::from(rows) - 1.0;
        let phi = PI * (f64::from(cell / rows) + random.unit()) / f64::from(rows);
        let across = (1.0 - z * z).max(0.0).sqrt();
        sum += value(DVec3::new(across * phi.cos(), across * phi.sin(), z));
    }
    sum / f64::from(2 * rows * rows)
}

/// Slope of the line through (log n, log error) that is nearest to all points (n, error).
pub(super) fn slope(errors: &[(u32, f64)]) -> f64 {
    let points: Vec<_> = errors.iter().map(|&(n, e)| (f64::from(n).ln(), e.ln())).collect();
    let mean =
        |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / points.len() as f64;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let across: f64 = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    across / points.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>()
}

/// How far counts are from the shares of a whole that they are expected to be, in standard deviations: Pearson's χ²,
/// made normal as Wilson & Hilferty 1931 do. Above 4.5, chance is ruled out. Cells that expect little are put
/// together; if something is in cells where nothing may be, that is infinitely far off.
pub fn chi_squared_z(counts: &[u64], shares: &[f64]) -> f64 {
    const LEAST: f64 = 5.0;
    let samples = counts.iter().sum::<u64>() as f64;
    let (mut sum, mut cells) = (0.0, 0.0);
    let mut pooled = (0.0, 0.0);
    let mut cell = |(count, expected): (f64, f64)| {
        sum += (count - expected) * (count - expected) / expected;
        cells += 1.0;
    };
    for (&count, share) in counts.iter().zip(shares) {
        let here = (count as f64, share * samples);
        if here.1 >= LEAST { cell(here) } else { pooled = (pooled.0 + here.0, pooled.1 + here.1) }
    }
    if pooled.1 >= LEAST {
        cell(pooled);
    } else if pooled.0 > 25.0 {
        // Hardly anything is expected there, so hardly anything may be there.
        return f64::INFINITY;
    }
    let freedom = cells - 1.0;
    let spread = 2.0 / (9.0 * freedom);
    ((sum / freedom).cbrt() - (1.0 - spread)) / spread.sqrt()
}

/// Reproducible numbers for tests; pictures take theirs from the sampler.
#[derive(Debug)]
pub struct Random(u64);

impl Random {
    /// Another sequence for every seed.
    pub fn new(seed: u64) -> Self {
        Self(hash(seed))
    }

    /// In 0..1.
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(1);
        (hash(self.0) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Evenly over a range of integers from 0.
    pub fn below(&mut self, end: usize) -> usize {
        (self.unit() * end as f64) as usize
    }

    /// Each coordinate in −1..1.
    pub fn point(&mut self) -> DVec3 {
        DVec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
    }

    /// Evenly over the unit sphere.
    pub fn direction(&mut self) -> DVec3 {
        let (z, (sin, cos)) = (2.0 * self.unit() - 1.0, (TAU * self.unit()).sin_cos());
        let r = (1.0 - z * z).max(0.0).sqrt();
        DVec3::new(r * cos, r * sin, z).normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values of tables of the normal distribution and of Student's.
    #[test]
    fn tails_are_those_of_the_tables() {
        let close = |value: f64, expected: f64, relative: f64| {
            assert!((value / expected - 1.0).abs() < relative, "{value} is not {expected}");
        };
        close(upper_tail(0.5), 0.308_537_538_726, 1e-9);
        close(upper_tail(2.0), 0.022_750_131_948, 1e-9);
        close(upper_tail(4.0), 3.167_124_183e-5, 1e-9);
        close(greatest_z(1), 4.0, 1e-9);
        // 1 − (1 − 6.334e-5)^(1/100) is 6.334e-7, which 4.98 standard deviations are exceeded with.
        close(greatest_z(100), 4.98, 2e-3);
        // Student's t of 2.602 with 15 degrees of freedom has an upper tail of 1 %, as 2.326 of the normal.
        close(normal_of_student(2.602, 15.0), 2.326, 1e-3);
        close(normal_of_student(-4.073, 15.0), -3.291, 2e-3);
        assert_eq!(normal_of_student(1.5, f64::INFINITY), 1.5);
    }

    #[test]
    fn slopes_are_those_of_powers() {
        let errors: Vec<_> = [1_u32, 4, 16].map(|n| (n, 3.0 * f64::from(n).powf(-0.5))).to_vec();
        assert!((slope(&errors) + 0.5).abs() < 1e-12);
    }
}
