//! Rows of entries, picked in proportion to their weights.
//!
//! Cumulative sums are inverted. A guide tells for equal steps of the number that picks where to begin the search, so
//! that it takes a few steps on average however the weights are spread (Chen & Asau, *On Generating Random Variates from
//! an Empirical Distribution*, AIIE Transactions 6(2), 1974).

/// Rows of as many entries each.
#[derive(Debug, Clone)]
pub(super) struct Shares {
    columns: usize,
    /// In each row, probability of all entries up to and including each.
    cumulative: Vec<f32>,
    /// In each row, for equal steps of 0..1 the entry where each begins.
    guide: Vec<u32>,
    /// Steps of the guide in a row.
    steps: usize,
}

/// An entry that was picked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Picked {
    /// Its place in its row.
    pub index: usize,
    /// Its probability in its row.
    pub probability: f64,
    /// How far into the entry the picking number fell, 0..1.
    pub rest: f64,
}

/// Entries for each step of the guide.
const ENTRIES_A_STEP: usize = 4;

impl Shares {
    /// From weights ≥ 0, row by row, and their sums; rows without any weight are never to be asked.
    pub(super) fn new(columns: usize, mut weights: Vec<f32>) -> (Self, Vec<f64>) {
        let sums = weights.chunks_exact_mut(columns).map(accumulate).collect();
        let steps = columns.div_ceil(ENTRIES_A_STEP);
        let mut guide = Vec::with_capacity(weights.len() / columns * steps);
        for row in weights.chunks_exact(columns) {
            let mut index = 0;
            for step in 0..steps {
                index = first_above(row, index, step as f64 / steps as f64);
                guide.push(index as u32);
            }
        }
        (Self { columns, cumulative: weights, guide, steps }, sums)
    }

    /// Entries in a row.
    #[inline(always)]
    pub(super) fn columns(&self) -> usize {
        self.columns
    }

    /// The entry of `row` where `u` in 0..1 falls.
    #[inline(always)]
    pub(super) fn pick(&self, row: usize, u: f64) -> Picked {
        let step = ((u * self.steps as f64) as usize).min(self.steps - 1);
        let index = first_above(self.row(row), self.guide[row * self.steps + step] as usize, u);
        let probability = self.probability(row, index);
        let before = f64::from(self.row(row)[index]) - probability;
        Picked { index, probability, rest: ((u - before) / probability).clamp(0.0, 1.0) }
    }

    /// Probability of an entry in its row.
    #[inline(always)]
    pub(super) fn probability(&self, row: usize, index: usize) -> f64 {
        let row = self.row(row);
        let before = if index == 0 { 0.0 } else { row[index - 1] };
        f64::from(row[index]) - f64::from(before)
    }

    #[inline(always)]
    fn row(&self, row: usize) -> &[f32] {
        &self.cumulative[row * self.columns..][..self.columns]
    }
}

/// The first entry from `index` on with more than `u` up to there; the last if there is none.
#[inline(always)]
fn first_above(cumulative: &[f32], mut index: usize, u: f64) -> usize {
    while index + 1 < cumulative.len() && f64::from(cumulative[index]) <= u {
        index += 1;
    }
    index
}

/// Turns weights into the cumulative shares of their sum, which is returned; all are 0 if it is 0.
fn accumulate(weights: &mut [f32]) -> f64 {
    let total: f64 = weights.iter().copied().map(f64::from).sum();
    let mut so_far = 0.0;
    for weight in weights {
        so_far += f64::from(*weight);
        *weight = if total > 0.0 { (so_far / total) as f32 } else { 0.0 };
    }
    total
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;

    /// By searching from the start, in rows of all lengths, with weights of all sizes and none.
    #[test]
    fn the_guide_leads_to_where_the_number_falls() {
        let mut random = Random::new(3);
        for columns in (1..40).chain([1000]) {
            let mut weight = || (20.0 * random.unit()).exp() as f32;
            let weights: Vec<_> =
                (0..2 * columns).map(|i| if i % 3 == 1 { 0.0 } else { weight() }).collect();
            let (shares, sums) = Shares::new(columns, weights.clone());
            for (row, weights) in
                weights.chunks_exact(columns).enumerate().filter(|(row, _)| sums[*row] > 0.0)
            {
                let edges = shares.row(row).to_vec();
                let borders = edges.iter().flat_map(|&u| [u.next_down(), u, u.next_up()]);
                let anywhere = (0..1000).map(|_| random.unit() as f32);
                for u in borders.chain(anywhere).map(f64::from).filter(|u| (0.0..1.0).contains(u)) {
                    let picked = shares.pick(row, u);
                    let expected = edges.iter().position(|&edge| f64::from(edge) > u);
                    assert_eq!(picked.index, expected.unwrap_or(columns - 1), "{columns}: {u}");
                    let share = f64::from(weights[picked.index]) / sums[row];
                    assert!((picked.probability - share).abs() < 2e-7, "{columns}: {u}");
                    assert_eq!(picked.probability, shares.probability(row, picked.index));
                }
            }
        }
    }
}
