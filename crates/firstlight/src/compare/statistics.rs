//! Whether the difference of two noisy pictures is chance: squares of pixels, each by its z.

use super::{Region, SQUARE, Test};
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// Probability that chance alone makes two samples of the same picture differ.
const SIGNIFICANCE: f64 = 0.01;
/// Rounding of pictures, relative to them.
const ROUNDING: f64 = 1e-5;

/// Variance of each pixel's difference, if that of one picture is known.
pub(super) fn variance(a: Option<&[f64]>, b: Option<&[f64]>, level: &[f64]) -> Option<Vec<f64>> {
    a.or(b)?;
    let of = |of: Option<&[f64]>, i: usize| of.map_or(0.0, |variances| variances[i]);
    let sum = |i: usize| of(a, i) + of(b, i) + (ROUNDING * level[i]).powi(2) + f64::MIN_POSITIVE;
    Some((0..level.len()).map(sum).collect())
}

/// Pixels put together to squares.
pub(super) struct Squares {
    size: [u32; 2],
    columns: u32,
    /// Sums over each square: of both pictures' luminance, of the variance of their difference, and how many pixels.
    sums: Vec<([f64; 2], f64, f64)>,
}

impl Squares {
    pub(super) fn new(size: [u32; 2], a: &[f64], b: &[f64], noise: Option<&[f64]>) -> Self {
        let [columns, rows] = size.map(|side| side.div_ceil(SQUARE));
        let mut squares =
            Self { size, columns, sums: vec![Default::default(); (columns * rows) as usize] };
        for i in 0..a.len() {
            let square = squares.square(i);
            let (means, variance, pixels) = &mut squares.sums[square];
            *means = [means[0] + a[i], means[1] + b[i]];
            *variance += noise.map_or(0.0, |noise| noise[i]);
            *pixels += 1.0;
        }
        squares
    }

    /// The square that a pixel belongs to.
    fn square(&self, pixel: usize) -> usize {
        let (x, y) = (pixel as u32 % self.size[0], pixel as u32 / self.size[0]);
        (y / SQUARE * self.columns + x / SQUARE) as usize
    }

    fn z(&self, square: usize) -> f64 {
        let ([a, b], variance, _) = self.sums[square];
        if a == b { 0.0 } else { (a - b) / variance.sqrt() }
    }

    pub(super) fn test(&self, noise: &[f64]) -> Test {
        let zs = (0..self.sums.len()).map(|square| self.z(square).abs());
        let difference: f64 = self.sums.iter().map(|([a, b], ..)| a - b).sum();
        let of_means = difference / noise.iter().sum::<f64>().sqrt();
        // The mean of all is one more.
        let allowed = greatest_z(self.sums.len() + 1);
        Test { greatest: zs.fold(0.0, f64::max), allowed, of_means }
    }

    /// Which squares differ by more than chance allows.
    pub(super) fn beyond(&self, allowed: f64) -> Vec<bool> {
        (0..self.sums.len()).map(|square| self.z(square).abs() > allowed).collect()
    }

    /// |z| of each pixel's square as a part of twice what is allowed.
    pub(super) fn map(&self, allowed: f64) -> Vec<f32> {
        let pixels = self.size[0] as usize * self.size[1] as usize;
        let part = |pixel| (0.5 * self.z(self.square(pixel)).abs() / allowed).min(1.0) as f32;
        (0..pixels).map(part).collect()
    }

    /// Which squares have a mean above `limit`.
    pub(super) fn where_mean(&self, values: &[f32], limit: f64) -> Vec<bool> {
        let mut sums = vec![0.0; self.sums.len()];
        for (pixel, value) in values.iter().enumerate() {
            sums[self.square(pixel)] += f64::from(*value);
        }
        sums.iter().zip(&self.sums).map(|(sum, (.., pixels))| sum / pixels > limit).collect()
    }

    /// Rectangles around squares that differ and touch, the largest first.
    pub(super) fn regions(&self, differing: &[bool]) -> Vec<Region> {
        let mut open = differing.to_vec();
        let mut regions = Vec::new();
        for first in 0..open.len() {
            if std::mem::take(&mut open[first]) {
                regions.push(self.region(first, &mut open));
            }
        }
        regions.sort_by_key(|r| (std::cmp::Reverse(r.width * r.height), r.y, r.x));
        regions
    }

    /// The rectangle around a square and all that touch it, which are taken from the `open` ones.
    fn region(&self, first: usize, open: &mut [bool]) -> Region {
        let (mut found, mut next) = (vec![first], 0);
        while let Some(&square) = found.get(next) {
            for neighbour in self.neighbours(square) {
                if std::mem::take(&mut open[neighbour]) {
                    found.push(neighbour);
                }
            }
            next += 1;
        }
        let place = |&square: &usize| {
            [square as u32 % self.columns * SQUARE, square as u32 / self.columns * SQUARE]
        };
        let least = |axis: usize| found.iter().map(|s| place(s)[axis]).min().unwrap_or(0);
        let most = |axis: usize| found.iter().map(|s| place(s)[axis]).max().unwrap_or(0);
        let end = |axis: usize| (most(axis) + SQUARE).min(self.size[axis]);
        let pixels: f64 = found.iter().map(|s| self.sums[*s].2).sum();
        let mean = |i: usize| found.iter().map(|s| self.sums[*s].0[i]).sum::<f64>() / pixels;
        let (x, y) = (least(0), least(1));
        Region { x, y, width: end(0) - x, height: end(1) - y, means: [mean(0), mean(1)] }
    }

    fn neighbours(&self, square: usize) -> impl Iterator<Item = usize> + use<> {
        let (x, y) =
            (square as i64 % i64::from(self.columns), square as i64 / i64::from(self.columns));
        let (columns, rows) =
            (i64::from(self.columns), self.sums.len() as i64 / i64::from(self.columns));
        let around = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dx, dy)));
        around.filter_map(move |(dx, dy)| {
            let (x, y) = (x + dx, y + dy);
            let inside = (0..columns).contains(&x) && (0..rows).contains(&y);
            inside.then_some((y * columns + x) as usize)
        })
    }
}

/// The |z| that the largest of so many independent ones exceeds by chance once in a hundred times (Šidák 1967).
pub fn greatest_z(count: usize) -> f64 {
    let each = 1.0 - (1.0 - SIGNIFICANCE).powf(1.0 / count.max(1) as f64);
    let (mut low, mut high) = (0.0, 40.0);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if both_tails(middle) > each { low = middle } else { high = middle }
    }
    high
}

/// Probability that a normal deviate is at least `z` away from 0: erfc(z / √2), by its continued fraction (Abramowitz and
/// Stegun 7.1.14) for large z, and by its series (7.1.6) for small ones.
fn both_tails(z: f64) -> f64 {
    let x = z * FRAC_1_SQRT_2;
    if x < 2.0 {
        let (mut term, mut sum) = (x, x);
        for n in 1..60 {
            term *= 2.0 * x * x / (2.0 * f64::from(n) + 1.0);
            sum += term;
        }
        return 1.0 - 2.0 / PI.sqrt() * (-x * x).exp() * sum;
    }
    let fraction = (1..60).rev().fold(x, |below, n| x + 0.5 * f64::from(n) / below);
    (-x * x).exp() / (PI.sqrt() * fraction)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tails_match_tables() {
        for (z, p) in [
            (1.0, 0.317_310_507_9),
            (1.96, 0.049_995_790_3),
            (3.0, 0.002_699_796_1),
            (5.0, 5.733_031_4e-7),
        ] {
            assert!((both_tails(z) / p - 1.0).abs() < 1e-7, "{z}: {}", both_tails(z));
        }
        assert!((greatest_z(1) - 2.575_829_3).abs() < 1e-6);
        assert!((greatest_z(1000) - 4.416).abs() < 2e-3, "{}", greatest_z(1000));
    }
}
