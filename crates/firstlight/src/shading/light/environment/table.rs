//! A density over directions, constant in each cell of a lat-long grid, and directions picked by it.
//!
//! The cumulative sums are inverted, which keeps points that are spread evenly spread evenly; within a cell, all
//! directions are alike. The density is that of the sums as they are stored, so that rounding them biases nothing.

use super::shares::Shares;
use crate::math::{angle_above, on_circle};
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
pub(super) struct DirectionTable {
    /// How probable each row is.
    rows: Shares,
    /// How probable the cells of each row are.
    cells: Shares,
    /// z where each row begins, from 1 to −1.
    heights: Vec<f64>,
    /// Probability of each row over the solid angle of one of its cells, sr⁻¹.
    densities: Vec<f64>,
}

impl DirectionTable {
    /// A table of `columns` × `rows` cells that are as bright as `brightness(column, row)` ≥ 0; `None` if none is
    /// to be preferred.
    pub(super) fn new(
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
        let mean = cells.iter().copied().map(f64::from).sum::<f64>();
        if aim == Aim::Compensated {
            let left_out = |i: usize| (share(i / columns) * mean) as f32;
            cells
                .iter_mut()
                .enumerate()
                .for_each(|(i, cell)| *cell = (*cell - left_out(i)).max(0.0));
        }
        let (cells, sums) = Shares::new(columns, cells);
        let (rows, sum) = Shares::new(rows, sums.into_iter().map(|sum| sum as f32).collect());
        // Less than this is rounding.
        let is_worth_it = sum[0] > 1e-5 * mean;
        let density = |y: usize| rows.probability(0, y) / (4.0 * PI * share(y));
        let densities = (0..heights.len() - 1).map(density).collect();
        is_worth_it.then_some(Self { rows, cells, heights, densities })
    }

    /// A table of `columns` × `rows` cells for a smooth `brightness` of directions.
    pub(super) fn of(
        columns: usize,
        rows: usize,
        aim: Aim,
        brightness: impl Fn(DVec3) -> f64,
    ) -> Option<Self> {
        const PARTS: usize = 4;
        let at = |i: usize, count: usize| (i as f64 + 0.5) / (count * PARTS) as f64;
        let toward = |i: usize, j: usize| direction(at(i, columns), (PI * at(j, rows)).cos());
        let mean = |x: usize, y: usize| {
            let parts = (0..PARTS * PARTS).map(|k| (PARTS * x + k % PARTS, PARTS * y + k / PARTS));
            parts.map(|(i, j)| brightness(toward(i, j))).sum::<f64>() / (PARTS * PARTS) as f64
        };
        Self::new(columns, rows, aim, mean)
    }

    /// A direction picked by two numbers in 0..1.
    #[inline(always)]
    pub(super) fn pick(&self, u: DVec2) -> Picked {
        let row = self.rows.pick(0, u.y);
        let cell = self.cells.pick(row.index, u.x);
        let [top, bottom] = [self.heights[row.index], self.heights[row.index + 1]];
        Picked {
            around: (cell.index as f64 + cell.rest) / self.cells.columns() as f64,
            z: top + row.rest * (bottom - top),
            pdf: self.densities[row.index] * cell.probability,
        }
    }

    /// Row and column of the cell of a unit direction with this [`place`].
    #[inline(always)]
    pub(super) fn cell(&self, place: DVec2) -> Cell {
        let (rows, columns) = (self.densities.len() as i32, self.cells.columns() as i32);
        let (row, column) = (place.y * f64::from(rows), place.x * f64::from(columns));
        Cell { row: (row as i32).min(rows - 1), column: (column as i32).min(columns - 1) }
    }

    /// Density of the directions of a cell, sr⁻¹.
    #[inline(always)]
    pub(super) fn pdf(&self, Cell { row, column }: Cell) -> f64 {
        self.densities[row as usize] * self.cells.probability(row as usize, column as usize)
    }
}

/// Row and column of a cell.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Cell {
    row: i32,
    column: i32,
}

/// A [`direction`] that was picked.
#[derive(Debug, Clone, Copy)]
pub(super) struct Picked {
    /// How far around, 0..1.
    pub around: f64,
    /// How high.
    pub z: f64,
    /// Its density, sr⁻¹.
    pub pdf: f64,
}

/// The unit direction at a height `z` after so much of the turn from south over west to north and east, 0..1.
#[inline(always)]
pub(super) fn direction(around: f64, z: f64) -> DVec3 {
    let across = ((1.0 - z) * (1.0 + z)).max(0.0).sqrt();
    let from_north = on_circle(TAU * (around - 0.5));
    DVec3::new(across * from_north.y, across * from_north.x, z)
}

/// Where a direction lies between the borders of a grid: to the right and down, 0..1.
#[inline(always)]
pub(super) fn place(direction: DVec3) -> DVec2 {
    let DVec3 { x, y, z } = direction;
    // The poles lie north.
    let from_north = angle_above(DVec2::new(y + f64::MIN_POSITIVE, x.abs())).copysign(x);
    let from_zenith = angle_above(DVec2::new(z, (x * x + y * y).sqrt()));
    DVec2::new(0.5 + from_north / TAU, from_zenith * FRAC_1_PI)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;

    /// By the arc tangents of the system's library.
    #[test]
    fn directions_lie_where_their_angles_say() {
        let mut random = Random::new(8);
        for _ in 0..10_000 {
            let toward = random.direction();
            let from_zenith = toward.truncate().length().atan2(toward.z) / PI;
            let expected = DVec2::new(0.5 + toward.x.atan2(toward.y) / TAU, from_zenith);
            let found = place(toward);
            assert!((found - expected).abs().max_element() < 1e-15, "{toward}: {found}");
            // Near the poles, the height says little about how far they are.
            let error = 3e-15 / toward.truncate().length();
            assert!(direction(found.x, toward.z).abs_diff_eq(toward, error), "{toward}");
        }
        let poles = [DVec3::Z, -DVec3::Z, DVec3::new(-0.0, -0.0, 1.0)].map(place);
        assert_eq!(poles, [0.0, 1.0, 0.0].map(|down| DVec2::new(0.5, down)));
        assert_eq!(place(-DVec3::X), DVec2::new(0.25, 0.5));
    }
}
