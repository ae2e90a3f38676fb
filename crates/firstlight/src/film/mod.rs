//! Where radiance is added up, pixel by pixel.

mod exposure;
mod filter;

pub use exposure::auto_exposure;
pub(crate) use filter::FilterSampler;

use crate::color::Rgb;
use crate::image::Image;

/// Radiance and coverage of one camera ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sample {
    /// Radiance, W·sr⁻¹·m⁻².
    pub radiance: Rgb,
    /// 0 where the background shows and counts as transparent, else 1.
    pub alpha: f32,
}

/// The sums of one pixel.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Pixel {
    radiance: [f64; 3],
    alpha: f64,
    weight: f64,
    count: u32,
}

impl Pixel {
    /// Adds a sample with the weight of its place under the filter. Returns whether it was finite; others are dropped.
    #[inline(always)]
    pub(crate) fn add(&mut self, sample: &Sample, weight: f32) -> bool {
        if !sample.radiance.is_finite() {
            return false;
        }
        let weight = f64::from(weight);
        for (sum, value) in self.radiance.iter_mut().zip(sample.radiance.to_array()) {
            *sum += weight * f64::from(value);
        }
        self.alpha += weight * f64::from(sample.alpha);
        self.weight += weight;
        self.count += 1;
        true
    }

    /// The weighted mean as linear RGBA, colour not multiplied by alpha; transparent if there is no sample.
    pub(crate) fn develop(&self) -> [f32; 4] {
        let alpha = (self.alpha / self.weight).clamp(0.0, 1.0);
        if self.count == 0 || alpha.is_nan() || alpha <= 0.0 {
            return [0.0; 4];
        }
        let [r, g, b] = self.radiance.map(|sum| (sum / self.alpha) as f32);
        [r, g, b, alpha as f32]
    }
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
}

impl Tile {
    /// Side of a tile in pixels.
    pub(crate) const SIDE: u32 = 16;

    /// Cuts the rectangle at `origin` of size `size` into tiles.
    pub(crate) fn cut(origin: [u32; 2], size: [u32; 2]) -> Vec<Self> {
        let starts = |length: u32| (0..length).step_by(Self::SIDE as usize);
        let tile = |x: u32, y: u32| {
            let tile_size = [Self::SIDE.min(size[0] - x), Self::SIDE.min(size[1] - y)];
            let pixels = vec![Pixel::default(); (tile_size[0] * tile_size[1]) as usize];
            Self { origin: [origin[0] + x, origin[1] + y], size: tile_size, pixels }
        };
        starts(size[1])
            .flat_map(|y| starts(size[0]).map(move |x| (x, y)))
            .map(|(x, y)| tile(x, y))
            .collect()
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

/// Puts developed tiles together to the rectangle at `origin` of size `size`.
pub(crate) fn assemble(tiles: &[Tile], origin: [u32; 2], size: [u32; 2]) -> Image {
    let mut pixels = vec![[0.0; 4]; size[0] as usize * size[1] as usize];
    for tile in tiles {
        for (index, pixel) in tile.pixels.iter().enumerate() {
            let [x, y] = tile.place(index);
            let row = (y - origin[1]) as usize * size[0] as usize;
            pixels[row + (x - origin[0]) as usize] = pixel.develop();
        }
    }
    Image::from_pixels(size[0], size[1], pixels)
}
