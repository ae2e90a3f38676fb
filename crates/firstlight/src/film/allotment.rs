//! Where samples go: to the tiles that need them, without bias.
//!
//! What stops when it happens to look good is biased: it stops too soon where something bright has not been found yet.
//! Here no sample decides about its own kind. A picture has two halves that know nothing of each other; how many samples a
//! half of a tile gets follows from the *other* half alone, and from those of its samples that every tile has,
//! however the decisions fall. So the number of a half's samples knows nothing of their values, its mean is what it
//! would be with any number, and so is the mean of both (Kirk & Arvo, *Unbiased Sampling Techniques for Image Synthesis*,
//! 1991).

use super::noise::{DARK, SQUARE};
use super::{Film, Half, Tile};
use std::ops::Range;

/// What the samples of one half of a tile say of how much they differ.
#[derive(Debug, Clone, Default)]
pub(crate) struct Watch {
    /// Passes that were taken.
    pub passes: u32,
    /// Of each square of pixels.
    squares: Vec<Square>,
    /// What was known after 1, 2, 4, … passes.
    milestones: Vec<Vec<Square>>,
}

/// Sums over the pixels of a square and over passes.
#[derive(Debug, Clone, Copy, Default)]
struct Square {
    /// Pixels × passes.
    count: f64,
    luminance: f64,
    /// Variance of a single sample.
    variance: f64,
}

/// Passes of each half that all tiles get before any gets more than others.
const EVEN_PASSES: u32 = 2;
/// After that, so many passes follow the noise for each one that all tiles get.
const AIMED: u32 = 3;
/// No tile gets more than so many times what tiles get in the mean: nobody shall wait for a single one.
const LARGEST_SHARE: f64 = 16.0;
/// Passes over a tile in one round, at most.
const MOST_AT_ONCE: u32 = 32;

impl Watch {
    /// Notes what one pass has seen of a pixel in a square.
    #[inline(always)]
    pub(crate) fn note(&mut self, square: usize, luminances: impl Iterator<Item = f64> + Clone) {
        let n = luminances.clone().count() as f64;
        let mean = luminances.clone().sum::<f64>() / n;
        let squares: f64 = luminances.map(|luminance| (luminance - mean).powi(2)).sum();
        if n > 1.0 && squares.is_finite() {
            if self.squares.len() <= square {
                self.squares.resize(square + 1, Square::default());
            }
            let Square { count, luminance, variance } = &mut self.squares[square];
            *count += 1.0;
            *luminance += mean;
            *variance += squares / (n - 1.0);
        }
    }

    /// Ends a pass.
    pub(crate) fn end_pass(&mut self) {
        self.passes += 1;
        if self.passes.is_power_of_two() {
            self.milestones.push(self.squares.clone());
        }
    }
}

/// Passes that every tile has after a round, counted from 1.
fn even_passes(round: u32) -> u32 {
    round.min(EVEN_PASSES) + round.saturating_sub(EVEN_PASSES) / (1 + AIMED)
}

/// How noisy a square is: the variance of a sample, relative to its luminance as [`Film::noise`] counts it.
fn relative_variance(square: &Square, mean: f64) -> f64 {
    let luminance = (square.luminance / square.count).max(DARK * mean);
    if square.variance > 0.0 { square.variance / (luminance * luminance) } else { 0.0 }
}

impl Tile {
    /// The number of the square that a pixel is in.
    #[inline(always)]
    pub(crate) fn square(&self, index: usize) -> usize {
        let (x, y) = (index as u32 % self.size[0], index as u32 / self.size[0]);
        (y / SQUARE * Self::SIDE.div_ceil(SQUARE) + x / SQUARE) as usize
    }

    /// What a half knew after so many passes, as a power of two.
    fn known(&self, half: Half, milestone: usize) -> &[Square] {
        self.watches[half as usize].milestones.get(milestone).map_or(&[], Vec::as_slice)
    }

    /// Samples of a half for one round, counted from where it stands, if it is to have so many passes.
    pub(crate) fn next_samples(&self, half: Half, passes: u32, pass: u32, most: u32) -> Range<u32> {
        let taken = self.watches[half as usize].passes;
        let end = passes.clamp(taken, taken + MOST_AT_ONCE);
        taken * pass..(end * pass).min(most)
    }
}

impl Film {
    /// How many passes over each tile the half that is not `judge` is to have after a round, counted from 1.
    pub(crate) fn passes(&self, judge: Half, round: u32) -> Vec<u32> {
        let all = even_passes(round);
        let aimed = f64::from(round - all);
        let known =
            even_passes(round - 1).checked_ilog2().map_or(0, |milestone| milestone as usize);
        let shares = self.shares(judge, known);
        shares.into_iter().map(|share| all + (aimed * share) as u32).collect()
    }

    /// How many samples each tile should get, as a multiple of the mean: in proportion to its standard deviation, which
    /// leaves the least noise in the whole (Neyman 1934).
    fn shares(&self, judge: Half, milestone: usize) -> Vec<f64> {
        let known: Vec<&[Square]> =
            self.tiles.iter().map(|tile| tile.known(judge, milestone)).collect();
        let total =
            |of: fn(&Square) -> f64| known.iter().flat_map(|squares| *squares).map(of).sum::<f64>();
        let mean = total(|square| square.luminance) / total(|square| square.count);
        let deviation = |squares: &&[Square]| {
            let count: f64 = squares.iter().map(|square| square.count).sum();
            let variance =
                squares.iter().map(|square| relative_variance(square, mean)).sum::<f64>();
            if count > 0.0 { (variance / count).sqrt() } else { 0.0 }
        };
        let deviations: Vec<f64> = known.iter().map(deviation).collect();
        let pixels = |tile: &Tile| f64::from(tile.size[0] * tile.size[1]);
        let all: f64 = self.tiles.iter().zip(&deviations).map(|(tile, d)| pixels(tile) * d).sum();
        let mean = all / self.tiles.iter().map(pixels).sum::<f64>();
        let share = |deviation: f64| {
            if deviation > 0.0 { (deviation / mean).min(LARGEST_SHARE) } else { 0.0 }
        };
        deviations.into_iter().map(share).collect()
    }
}
