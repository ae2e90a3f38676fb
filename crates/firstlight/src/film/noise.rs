//! How far the picture still is from the one that infinitely many samples would give.

use super::{Film, Tile};
use rayon::prelude::*;

/// How large the errors of a picture are that chance has left in it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// The standard error of a pixel's luminance relative to it, as the root of the mean of squares over all pixels. Pixels
    /// darker than a tenth of the picture's mean count as if they were that bright.
    pub relative: f64,
    /// Mean luminance of the picture, W·sr⁻¹·m⁻².
    pub mean: f64,
    /// Standard error of the mean, if pixels are independent, W·sr⁻¹·m⁻².
    pub standard_error: f64,
}

/// Side of the squares of pixels whose variance is estimated together, since one pixel alone knows little of its own.
pub(super) const SQUARE: u32 = 4;
/// What is darker than this part of the mean is not looked at more closely.
pub(super) const DARK: f64 = 0.1;

/// A square of pixels.
struct Square {
    pixels: f64,
    /// Sums over its pixels.
    luminance: f64,
    variance: f64,
}

impl Film {
    /// How noisy the picture is, by the difference of its two halves; `None` before both have samples.
    ///
    /// The halves of one net of samples make up for each other's errors, so that their difference says at most how
    /// large the error of the whole is. Halves that know nothing of each other tell it without bias.
    pub fn noise(&self) -> Option<Noise> {
        let squares: Vec<Vec<_>> = self.tiles.par_iter().map(squares).collect::<Option<_>>()?;
        let total = |of: fn(&Square) -> f64| squares.iter().flatten().map(of).sum::<f64>();
        let pixels = total(|square| square.pixels);
        let mean = total(|square| square.luminance) / pixels;
        let relative = |square: &Square| {
            let luminance = (square.luminance / square.pixels).max(DARK * mean);
            if square.variance > 0.0 { square.variance / (luminance * luminance) } else { 0.0 }
        };
        Some(Noise {
            relative: (squares.iter().flatten().map(relative).sum::<f64>() / pixels).sqrt(),
            mean,
            standard_error: total(|square| square.variance).sqrt() / pixels,
        })
    }
}

/// The squares of a tile; `None` for one with a pixel that only one half has samples of.
fn squares(tile: &Tile) -> Option<Vec<Square>> {
    let [width, height] = tile.size;
    let corners = (0..height).step_by(SQUARE as usize);
    let corners =
        corners.flat_map(move |y| (0..width).step_by(SQUARE as usize).map(move |x| (x, y)));
    let square = |(left, upper)| {
        let mut square = Square { pixels: 0.0, luminance: 0.0, variance: 0.0 };
        for y in upper..height.min(upper + SQUARE) {
            for x in left..width.min(left + SQUARE) {
                let (luminance, variance) = tile.luminance((y * width + x) as usize)?;
                square.pixels += 1.0;
                square.luminance += luminance;
                square.variance += variance;
            }
        }
        Some(square)
    };
    corners.map(square).collect()
}
