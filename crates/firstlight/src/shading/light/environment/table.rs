//! A density over directions, constant in each cell of a lat-long grid, and directions picked by it.
//!
//! The cumulative sums are inverted, which keeps points that are spread evenly spread evenly; within a cell, all
//! directions are alike. The density is that of the sums as they are stored, so that rounding them biases nothing.

use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_1_PI, PI, TAU};

/// How a table divides its attention.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Aim {
    /// In proportion to the light: right where nothing else looks for it.
    #[cfg(test)]
    Alone,
    /// Only at what is brighter than the mean, and the more so: the rest is left to directions picked by the BSDF,
    /// with which multiple importance sampling combines them.
    ///
    /// Karlík, Šik, Vévoda, Skřivan, Křivánek, *MIS Compensation*, ACM TOG 38(6), 2019.
    Compensated,
}

/// A grid of directions: rows from the zenith (+z) to the nadir with equal steps of the angle, columns all around,
/// the middle of a row north (+y), east (+x) to its right.
#[derive(Debug, Clone)]
pub(crate) struct DirectionTable {
    columns: usize,
    /// Probability of all rows up to and including each.
    rows: Vec<f32>,
    /// In each row, probability of all its cells up to and including each.
    cells: Vec<f32>,
    /// z where each row begins, from 1 to −1.
    heights: Vec<f64>,
}

impl DirectionTable {
    /// A table of `columns` × `rows` cells that are as bright as `brightness(column, row)` ≥ 0; `None` if none is
    /// to be preferred.
    pub(crate) fn new(
        columns: usize,
        rows: usize,
        aim: Aim,
        brightness: impl Fn(usize, usize) -> f64,
    ) -> Option<Self> {
        let heights: Vec<_> = (0..=rows).map(|y| (PI * y as f64 / rows as f64).cos()).collect();
        let share = |y: usize| 0.5 * (heights[y] - heights[y + 1]) / columns as f64;
        let at = |i: usize| (i % columns, i / columns);
        let light = (0..columns * rows).map(at).map(|(x, y)| (share(y) * brightness(x, y)) as f32);
        let mut cells: Vec<f32> = light.collect();
        let mean = sum(&cells);
        if aim == Aim::Compensated {
            let left_out = |i: usize| (share(i / columns) * mean) as f32;
            cells
                .iter_mut()
                .enumerate()
                .for_each(|(i, cell)| *cell = (*cell - left_out(i)).max(0.0));
        }
        let mut marginal: Vec<_> =
            cells.chunks_exact_mut(columns).map(|row| accumulate(row) as f32).collect();
        // Less than this is rounding.
        let is_worth_it = accumulate(&mut marginal) > 1e-5 * mean;
        is_worth_it.then_some(Self { columns, rows: marginal, cells, heights })
    }

    /// A table of `columns` × `rows` cells for a smooth `brightness` of directions.
    pub(crate) fn of(
        columns: usize,
        rows: usize,
        aim: Aim,
        brightness: impl Fn(DVec3) -> f64,
    ) -> Option<Self> {
        const PARTS: usize = 4;
        let at = |i: usize, count: usize| (i as f64 + 0.5) / (count * PARTS) as f64;
        let toward = |i: usize, j: usize| {
            let (sin, cos) = (PI * at(j, rows)).sin_cos();
            direction(TAU * at(i, columns), cos, sin)
        };
        let mean = |x: usize, y: usize| {
            let parts = (0..PARTS * PARTS).map(|k| (PARTS * x + k % PARTS, PARTS * y + k / PARTS));
            parts.map(|(i, j)| brightness(toward(i, j))).sum::<f64>() / (PARTS * PARTS) as f64
        };
        Self::new(columns, rows, aim, mean)
    }

    /// A unit direction picked by two numbers in 0..1, and its density, sr⁻¹.
    pub(crate) fn sample(&self, u: DVec2) -> (DVec3, f64) {
        let row = pick(&self.rows, u.y);
        let cell = pick(self.row(row.index), u.x);
        let z = self.heights[row.index] + row.rest * self.height(row.index);
        let longitude = TAU * (cell.index as f64 + cell.rest) / self.columns as f64;
        let across = ((1.0 - z) * (1.0 + z)).max(0.0).sqrt();
        (
            direction(longitude, z, across),
            row.probability * cell.probability / self.steradians(row.index),
        )
    }

    /// Density of a unit direction, sr⁻¹.
    pub(crate) fn pdf(&self, direction: DVec3) -> f64 {
        let from_zenith = direction.truncate().length().atan2(direction.z) * FRAC_1_PI;
        let around = 0.5 + direction.x.atan2(direction.y) / TAU;
        let index = |part: f64, count: usize| ((part * count as f64) as usize).min(count - 1);
        let (y, x) = (index(from_zenith, self.rows.len()), index(around, self.columns));
        probability(&self.rows, y) * probability(self.row(y), x) / self.steradians(y)
    }

    fn row(&self, y: usize) -> &[f32] {
        &self.cells[y * self.columns..][..self.columns]
    }

    /// How far z falls over a row; negative.
    fn height(&self, y: usize) -> f64 {
        self.heights[y + 1] - self.heights[y]
    }

    /// Solid angle of a cell, sr.
    fn steradians(&self, y: usize) -> f64 {
        -self.height(y) * TAU / self.columns as f64
    }
}

/// The unit direction at `longitude`, rad from south over west to north and east; `across` is its distance from the z axis.
fn direction(longitude: f64, z: f64, across: f64) -> DVec3 {
    let (sin, cos) = longitude.sin_cos();
    DVec3::new(-across * sin, -across * cos, z)
}

fn sum(weights: &[f32]) -> f64 {
    weights.iter().copied().map(f64::from).sum()
}

/// Turns weights into the cumulative shares of their sum, which is returned; all are 0 if it is 0.
fn accumulate(weights: &mut [f32]) -> f64 {
    let (total, mut so_far) = (sum(weights), 0.0);
    for weight in weights {
        so_far += f64::from(*weight);
        *weight = if total > 0.0 { (so_far / total) as f32 } else { 0.0 };
    }
    total
}

/// An entry of cumulative shares that was picked.
struct Picked {
    index: usize,
    probability: f64,
    /// How far into the entry the picking number fell, 0..1.
    rest: f64,
}

/// The entry of cumulative shares where `u` in 0..1 falls.
fn pick(shares: &[f32], u: f64) -> Picked {
    let index = shares.partition_point(|&share| f64::from(share) <= u).min(shares.len() - 1);
    let probability = probability(shares, index);
    let before = f64::from(shares[index]) - probability;
    Picked { index, probability, rest: ((u - before) / probability).clamp(0.0, 1.0) }
}

/// Probability of an entry of cumulative shares.
fn probability(shares: &[f32], index: usize) -> f64 {
    let before = index.checked_sub(1).map_or(0.0, |before| f64::from(shares[before]));
    f64::from(shares[index]) - before
}
