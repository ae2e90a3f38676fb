//! Where radiance is added up, pixel by pixel.

mod allotment;
mod exposure;
mod filter;
mod noise;
mod sums;

pub use exposure::auto_exposure;
pub(crate) use filter::FilterSampler;
pub use noise::Noise;

use crate::color::{Rgb, luminance};
use crate::image::Image;
use crate::math::BLOCK;
use allotment::Watch;
use rayon::prelude::*;
use sums::{ExactSums, Split};

/// Radiance and coverage of one camera ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sample {
    /// Radiance, W·sr⁻¹·m⁻².
    pub radiance: Rgb,
    /// 0 where the background shows and counts as transparent, else 1.
    pub alpha: f32,
    /// Luminance that was left out because the film wants no indirect light above a bound, W·sr⁻¹·m⁻².
    pub clamped: f32,
}

impl Sample {
    /// Such light, of which nothing was left out.
    pub(crate) fn of(radiance: Rgb) -> Self {
        Self { radiance, alpha: 1.0, clamped: 0.0 }
    }
}

/// Half of the samples. What the halves differ by tells how much is left to chance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Half {
    First,
    Second,
}

impl Half {
    /// The one that is not this one.
    pub(crate) fn other(self) -> Self {
        if self == Self::First { Self::Second } else { Self::First }
    }
}

/// The sums of one pixel. They are the same for the same samples, whatever their order and in how many parts they came.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Pixel {
    /// Radiance per channel, and luminance of the first half.
    sums: ExactSums<4>,
    /// Of samples that are covered.
    alpha: i32,
    /// Of all samples, each 1 or −1 by its place under the filter.
    weight: i32,
    /// Of the first half.
    first_weight: i32,
}

impl Pixel {
    /// Numbers of 32 bits that say all about a pixel.
    pub(crate) const WORDS: usize = 20;

    /// Adds a sample, whose light is four numbers of `light` from number `first` on, with the weight of its place under the
    /// filter.
    #[inline(always)]
    fn add<const M: usize>(
        &mut self,
        (light, first): (&Split<M>, usize),
        (alpha, weight, first_weight): (f32, f32, f32),
    ) {
        self.sums.add(light, first);
        self.alpha += (weight * alpha) as i32;
        self.weight += weight as i32;
        self.first_weight += first_weight as i32;
    }

    /// Adds the samples of another part.
    pub(crate) fn merge(&mut self, other: &Self) {
        self.sums.merge(&other.sums);
        self.alpha = self.alpha.wrapping_add(other.alpha);
        self.weight = self.weight.wrapping_add(other.weight);
        self.first_weight = self.first_weight.wrapping_add(other.first_weight);
    }

    /// The weighted mean as linear RGBA, colour not multiplied by alpha; transparent if there is no sample.
    pub(crate) fn develop(&self) -> [f32; 4] {
        let alpha = (f64::from(self.alpha) / f64::from(self.weight)).clamp(0.0, 1.0);
        if alpha.is_nan() || alpha <= 0.0 {
            return [0.0; 4];
        }
        let [r, g, b, _] = self.sums.values().map(|sum| (sum / f64::from(self.alpha)) as f32);
        [r, g, b, alpha as f32]
    }

    /// Mean luminance of all samples, black where it is transparent; `None` if there are none.
    fn mean_luminance(&self) -> Option<f64> {
        let [r, g, b, _] = self.sums.values();
        let sum = 0.2126 * r + 0.7152 * g + 0.0722 * b;
        (self.weight > 0).then(|| sum / f64::from(self.weight))
    }

    /// Mean luminance, black where it is transparent, and its variance as the difference of the halves tells it; `None`
    /// if one of them has no samples.
    fn luminance(&self) -> Option<(f64, f64)> {
        let [all, first] = [self.weight, self.first_weight].map(f64::from);
        let second = all - first;
        if first <= 0.0 || second <= 0.0 {
            return None;
        }
        let [.., first_sum] = self.sums.values();
        let mean = self.mean_luminance()?;
        let difference = first_sum / first - (mean * all - first_sum) / second;
        Some((mean, difference * difference * (first / all) * (second / all)))
    }

    /// All about it, to be stored.
    pub(crate) fn to_words(self) -> [u32; Self::WORDS] {
        let mut words = [0; Self::WORDS];
        for (pair, bin) in words.chunks_exact_mut(2).zip(self.sums.bins.as_flattened()) {
            pair.copy_from_slice(&[*bin as u32, (*bin >> 32) as u32]);
        }
        let weights = [self.alpha, self.weight, self.first_weight].map(|weight| weight as u32);
        words[16..19].copy_from_slice(&weights);
        words[19] = u32::from_le_bytes(self.sums.tops);
        words
    }

    /// What [`Pixel::to_words`] has stored.
    pub(crate) fn from_words(words: [u32; Self::WORDS]) -> Self {
        let mut pixel = Self::default();
        for (pair, bin) in words.chunks_exact(2).zip(pixel.sums.bins.as_flattened_mut()) {
            *bin = (u64::from(pair[0]) | u64::from(pair[1]) << 32) as i64;
        }
        [pixel.alpha, pixel.weight, pixel.first_weight] =
            [words[16], words[17], words[18]].map(|word| word as i32);
        // No number has its highest bit above bin 7; a file may say anything.
        pixel.sums.tops = words[19].to_le_bytes().map(|top| top.min(7));
        pixel
    }
}

/// All sums of a rectangle of the picture.
#[derive(Debug, Clone)]
pub struct Film {
    /// Column of its left edge and row of its upper edge, in the whole picture.
    origin: [u32; 2],
    size: [u32; 2],
    tiles: Vec<Tile>,
}

impl Film {
    /// A black one for the rectangle at `origin` of size `size`.
    pub(crate) fn new(origin: [u32; 2], size: [u32; 2]) -> Self {
        Self { origin, size, tiles: Tile::cut(origin, size) }
    }

    /// The same in two halves that have pixels, and numbers of samples, of their own.
    pub(crate) fn in_halves(origin: [u32; 2], size: [u32; 2]) -> Self {
        let mut film = Self::new(origin, size);
        film.tiles.iter_mut().for_each(|tile| tile.second.clone_from(&tile.pixels));
        film
    }

    /// Whether its halves are kept apart.
    pub(crate) fn is_in_halves(&self) -> bool {
        self.tiles.first().is_some_and(Tile::is_in_halves)
    }

    /// The tiles, to be filled.
    pub(crate) fn tiles_mut(&mut self) -> &mut [Tile] {
        &mut self.tiles
    }

    /// Column and row of its upper left pixel in the whole picture.
    pub fn origin(&self) -> [u32; 2] {
        self.origin
    }

    /// Its width and height.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Adds other samples of the same rectangle.
    ///
    /// # Panics
    /// If it is not the same rectangle.
    pub fn merge(&mut self, other: &Self) {
        assert_eq!((self.origin, self.size), (other.origin, other.size), "another rectangle");
        for (tile, other) in self.tiles.iter_mut().zip(&other.tiles) {
            for (pixel, other) in tile.pixels.iter_mut().zip(&other.pixels) {
                pixel.merge(other);
            }
            tile.samples += other.samples;
            tile.clamped += other.clamped;
        }
    }

    /// The part of all light, by luminance, that was left out by clamping.
    pub(crate) fn clamped(&self) -> f64 {
        let removed = |tile: &Tile| tile.clamped / f64::from(tile.samples.max(1));
        let removed: f64 = self.tiles.iter().map(removed).sum();
        if removed <= 0.0 {
            return 0.0;
        }
        let kept = |tile: &Tile| {
            let kept = (0..tile.pixels.len()).filter_map(|index| tile.mean_luminance(index));
            kept.sum::<f64>()
        };
        let kept: f64 = self.tiles.iter().map(kept).sum();
        removed / (removed + kept)
    }

    /// How many samples its pixels have.
    pub(crate) fn spread(&self) -> Spread {
        let samples = |tile: &Tile| u64::from(tile.samples) * tile.pixels.len() as u64;
        let pixels: usize = self.tiles.iter().map(|tile| tile.pixels.len()).sum();
        let all: u64 = self.tiles.iter().map(samples).sum();
        Spread {
            fewest: self.tiles.iter().map(|tile| tile.samples).min().unwrap_or(0),
            mean: all as f64 / pixels as f64,
            most: self.tiles.iter().map(|tile| tile.samples).max().unwrap_or(0),
        }
    }

    /// The picture: linear radiance, transparent where no sample was taken.
    pub fn image(&self) -> Image {
        let pixels = self.rows(Tile::develop);
        Image::from_pixels(self.size[0], self.size[1], pixels)
    }

    /// Variance of every pixel's luminance by the difference of its halves, row by row; pixels that only one half has
    /// samples of have none.
    pub(crate) fn variances(&self) -> Vec<Option<f64>> {
        self.rows(|tile, index| tile.luminance(index).map(|(_, variance)| variance))
    }

    /// Something about every pixel, row by row.
    pub(crate) fn rows<T: Clone + Default + Send>(
        &self,
        of: impl Fn(&Tile, usize) -> T + Sync,
    ) -> Vec<T> {
        let [width, height] = self.size.map(|side| side as usize);
        let mut rows = vec![T::default(); width * height];
        // A file may hold a film without pixels.
        let bands = rows.par_chunks_mut((width * Tile::SIDE as usize).max(1));
        let tiles = self.tiles.par_chunks(width.div_ceil(Tile::SIDE as usize).max(1));
        bands.zip(tiles).for_each(|(band, tiles)| {
            for tile in tiles {
                let upper = [self.origin[0], tile.origin[1]];
                for index in 0..tile.pixels.len() {
                    band[row_index(upper, self.size, tile.place(index))] = of(tile, index);
                }
            }
        });
        rows
    }

    /// A film of pixels that are given row by row.
    pub(crate) fn from_rows(
        origin: [u32; 2],
        size: [u32; 2],
        pixel: impl Fn(usize) -> Pixel,
    ) -> Self {
        let mut film = Self::new(origin, size);
        for tile in &mut film.tiles {
            for index in 0..tile.pixels.len() {
                tile.pixels[index] = pixel(row_index(origin, size, tile.place(index)));
            }
        }
        film
    }
}

/// What the tiles of the rectangle at `origin` of size `size` have of each pixel, row by row.
pub(crate) fn in_rows<T: Clone + Default>(
    origin: [u32; 2],
    size: [u32; 2],
    tiles: impl IntoIterator<Item = Vec<T>>,
) -> Vec<T> {
    let mut rows = vec![T::default(); size[0] as usize * size[1] as usize];
    for (tile, pixels) in Tile::cut(origin, size).iter().zip(tiles) {
        for (index, pixel) in pixels.into_iter().enumerate() {
            rows[row_index(origin, size, tile.place(index))] = pixel;
        }
    }
    rows
}

/// The number of the pixel in column `x`, row `y` of the whole picture, counted row by row in a rectangle of it.
fn row_index(origin: [u32; 2], size: [u32; 2], [x, y]: [u32; 2]) -> usize {
    (y - origin[1]) as usize * size[0] as usize + (x - origin[0]) as usize
}

/// What a sample of weight `weight` weighs in the first half.
#[inline(always)]
fn first_weight(weight: f32, half: Half) -> f32 {
    if half == Half::First { weight } else { 0.0 }
}

/// The mean of two colours that are not multiplied by their alpha.
fn mean_color([r, g, b, a]: [f32; 4], [r2, g2, b2, a2]: [f32; 4]) -> [f32; 4] {
    let part = if a + a2 > 0.0 { a / (a + a2) } else { 0.5 };
    let mean = |one: f32, other: f32| part * one + (1.0 - part) * other;
    [mean(r, r2), mean(g, g2), mean(b, b2), 0.5 * (a + a2)]
}

/// A rectangle of pixels that one worker fills.
#[derive(Debug, Clone)]
pub(crate) struct Tile {
    /// Column of its left edge and row of its upper edge, in the whole picture.
    pub origin: [u32; 2],
    /// Its width and height.
    pub size: [u32; 2],
    /// Its pixels, row by row.
    pub pixels: Vec<Pixel>,
    /// The second half of them, where the halves are kept apart; else empty.
    second: Vec<Pixel>,
    /// Samples of each pixel.
    pub samples: u32,
    /// Luminance that was left out of all of them.
    pub clamped: f64,
    /// What the halves know of their noise, where that is asked for.
    pub watches: [Watch; 2],
}

/// How many samples pixels have.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Spread {
    /// Of the pixels with the fewest.
    pub fewest: u32,
    /// In the mean over the picture.
    pub mean: f64,
    /// Of those with the most.
    pub most: u32,
}

impl Tile {
    /// Side of a tile in pixels.
    pub(crate) const SIDE: u32 = 16;

    /// Cuts the rectangle at `origin` of size `size` into tiles, row by row.
    pub(crate) fn cut(origin: [u32; 2], size: [u32; 2]) -> Vec<Self> {
        let [columns, rows] = size.map(|side| side.div_ceil(Self::SIDE));
        let tile = |number: u32| {
            let [x, y] = [number % columns, number / columns].map(|place| place * Self::SIDE);
            let tile_size = [Self::SIDE.min(size[0] - x), Self::SIDE.min(size[1] - y)];
            Self {
                origin: [origin[0] + x, origin[1] + y],
                size: tile_size,
                pixels: vec![Pixel::default(); (tile_size[0] * tile_size[1]) as usize],
                second: Vec::new(),
                samples: 0,
                clamped: 0.0,
                watches: Default::default(),
            }
        };
        // In parallel, for the system takes its time to hand out memory.
        (0..columns * rows).into_par_iter().map(tile).collect()
    }

    /// Whether its halves are kept apart.
    pub(crate) fn is_in_halves(&self) -> bool {
        !self.second.is_empty()
    }

    /// Adds samples to pixels, each with the weight of its place under the filter, 1 or −1. Those that are not finite are
    /// dropped; `dropped` is told their numbers.
    #[inline(always)]
    pub(crate) fn add(
        &mut self,
        samples: &[Sample],
        pixels: &[(usize, Half)],
        weights: &[f32],
        mut dropped: impl FnMut(usize),
    ) {
        const SERIES: usize = 4;
        for (block, samples) in samples.chunks(BLOCK).enumerate() {
            let mut light = [0.0; SERIES * BLOCK];
            let first = block * BLOCK;
            for (k, sample) in samples.iter().enumerate() {
                let weight = weights[first + k];
                let in_first = first_weight(weight, pixels[first + k].1);
                let [r, g, b] = (weight * sample.radiance).to_array();
                light[SERIES * k] = r;
                light[SERIES * k + 1] = g;
                light[SERIES * k + 2] = b;
                light[SERIES * k + 3] = in_first * luminance(sample.radiance);
            }
            let split = Split::of(&light);
            for (k, sample) in samples.iter().enumerate() {
                if !luminance(sample.radiance.abs()).is_finite() {
                    dropped(first + k);
                    continue;
                }
                let (index, half) = pixels[first + k];
                let weight = weights[first + k];
                let apart = half == Half::Second && !self.second.is_empty();
                let pixels = if apart { &mut self.second } else { &mut self.pixels };
                let weights = (sample.alpha, weight, first_weight(weight, half));
                pixels[index].add((&split, SERIES * k), weights);
            }
        }
    }

    /// What a pixel shows; see [`Pixel::develop`]. Halves that are kept apart count the same, however many samples they
    /// have.
    fn develop(&self, index: usize) -> [f32; 4] {
        let halves = [Some(&self.pixels[index]), self.second.get(index)];
        let [first, second] =
            halves.map(|half| half.filter(|half| half.weight != 0).map(Pixel::develop));
        match (first, second) {
            (Some(first), Some(second)) => mean_color(first, second),
            (one, other) => one.or(other).unwrap_or_default(),
        }
    }

    /// A pixel's luminance; `None` if it has no samples.
    fn mean_luminance(&self, index: usize) -> Option<f64> {
        let halves = [Some(&self.pixels[index]), self.second.get(index)];
        let [first, second] = halves.map(|half| half.and_then(Pixel::mean_luminance));
        first.map(|first| second.map_or(first, |second| 0.5 * (first + second)))
    }

    /// A pixel's luminance and its variance; see [`Pixel::luminance`].
    fn luminance(&self, index: usize) -> Option<(f64, f64)> {
        let first = &self.pixels[index];
        let Some(second) = self.second.get(index) else { return first.luminance() };
        let (first, second) = (first.mean_luminance()?, second.mean_luminance()?);
        Some((0.5 * (first + second), 0.25 * (first - second).powi(2)))
    }

    /// The indices of its pixels in the order of Morton's curve, in which neighbours stay together: rays that follow
    /// one another go nearly the same way.
    pub(crate) fn order(&self) -> impl Iterator<Item = usize> {
        let [width, height] = self.size;
        let even_bits = |code: u32| (0..4).fold(0, |x, bit| x | (code >> (2 * bit) & 1) << bit);
        (0..Self::SIDE * Self::SIDE).filter_map(move |code| {
            let (x, y) = (even_bits(code), even_bits(code >> 1));
            (x < width && y < height).then_some((y * width + x) as usize)
        })
    }

    /// Column and row in the whole picture of a pixel of the tile.
    #[inline(always)]
    pub(crate) fn place(&self, index: usize) -> [u32; 2] {
        let (x, y) = (index as u32 % self.size[0], index as u32 / self.size[0]);
        [self.origin[0] + x, self.origin[1] + y]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_film_without_pixels_is_an_empty_picture() {
        for size in [[0, 0], [0, 20], [20, 0]] {
            let film = Film::new([3, 4], size);
            assert!(film.image().pixels().is_empty() && film.variances().is_empty(), "{size:?}");
        }
    }

    /// Tiles that are cut off at the right and below, in a rectangle that begins anywhere.
    #[test]
    fn rows_have_every_pixel_in_its_place() {
        let film = Film::new([5, 7], [37, 21]);
        let places = film.rows(|tile, index| tile.place(index));
        let expected = (7..28).flat_map(|y| (5..42).map(move |x| [x, y]));
        assert_eq!(places, expected.collect::<Vec<_>>());
    }
}
