//! Are two pictures the same? By statistics where it is known how noisy they are; else by how different they look (FLIP)
//! and by their relative mean square error.

mod flip;
mod statistics;

use crate::color::{Rgb, View, luminance, srgb_encode};
use crate::film::{Film, auto_exposure};
use crate::image::Image;
pub use flip::{PIXELS_PER_DEGREE, flip};
pub use statistics::greatest_z;

/// Side of the squares whose pixels are judged together.
pub const SQUARE: u32 = 16;
/// Mean FLIP up to which pictures without a known noise count as the same, unless asked otherwise.
pub const USUAL_THRESHOLD: f64 = 0.01;
/// What squares are told to differ by, if their noise is not known: mean FLIP.
const VISIBLE: f64 = 0.1;
/// Keeps relative errors of what is nearly black finite (Rousselle, Knaus, Zwicker 2011).
const RELATIVE_FLOOR: f64 = 0.01;

/// A picture, and how noisy it is.
#[derive(Debug, Clone)]
pub struct Measured {
    /// Linear numbers.
    pub image: Image,
    /// Variance of each pixel's luminance; `None` if that is not known.
    pub variance: Option<Vec<f64>>,
    /// What they are.
    pub holds: Holds,
}

/// What the numbers of a picture are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Holds {
    /// What is shown on a screen, as in PNG.
    Display,
    /// Radiance, and how it is meant to be shown.
    Radiance {
        /// Stops of exposure; `None`: those that suit the picture.
        exposure_ev: Option<f32>,
        /// What is made of light that is brighter than white.
        view: View,
    },
}

impl Holds {
    /// Radiance of which nothing more is known.
    pub const RADIANCE: Self = Self::Radiance { exposure_ev: None, view: View::Srgb };
}

/// How two pictures of one size differ.
#[derive(Debug, Clone)]
pub struct Comparison {
    /// Whether they are the same, bit for bit.
    pub identical: bool,
    /// Whether they count as the same: within their noise, or within the threshold.
    pub same: bool,
    /// Mean FLIP, 0..1.
    pub flip: f64,
    /// Mean of ((a − b) / b)² over pixels and channels, with 0.01 added to b².
    pub relative_mse: f64,
    /// Mean luminance of both.
    pub means: [f64; 2],
    /// The statistical test, if the noise of one of them is known.
    pub test: Option<Test>,
    /// Squares that differ, put together to rectangles, the largest first.
    pub regions: Vec<Region>,
    /// What differs how much, pixel by pixel, 0..1: FLIP, or |z| as a part of what is allowed.
    pub map: Vec<f32>,
}

/// What the statistical test of a comparison says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Test {
    /// The greatest |z| of all squares: their difference in its standard deviations.
    pub greatest: f64,
    /// What chance alone makes it exceed once in a hundred comparisons.
    pub allowed: f64,
    /// z of the whole pictures' means.
    pub of_means: f64,
}

/// A rectangle in which pictures differ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Region {
    /// Column of its left edge.
    pub x: u32,
    /// Row of its upper edge.
    pub y: u32,
    /// Its width in pixels.
    pub width: u32,
    /// Its height in pixels.
    pub height: u32,
    /// Mean luminance of the two pictures there.
    pub means: [f64; 2],
}

impl Measured {
    /// A picture whose noise is not known.
    pub fn of_image(image: Image, holds: Holds) -> Self {
        Self { image, variance: None, holds }
    }

    /// A picture of radiance, with the noise that the difference of its two halves tells, if both have samples.
    pub fn of_film(film: &Film, exposure_ev: Option<f32>, view: View) -> Self {
        let variance: Option<Vec<f64>> = film.variances().into_iter().collect();
        Self { image: film.image(), variance, holds: Holds::Radiance { exposure_ev, view } }
    }

    /// What is shown of it. How noisy that is is not known, unless it is what was given.
    fn displayed(&self) -> Self {
        let Holds::Radiance { exposure_ev, view } = self.holds else { return self.clone() };
        let gain = exposure_ev.map_or_else(|| auto_exposure(&self.image), f64::from).exp2() as f32;
        let show =
            |&[r, g, b, a]: &[f32; 4]| view.display(gain * Rgb::new(r, g, b)).extend(a).to_array();
        let pixels = self.image.pixels().iter().map(show).collect();
        let image = Image::from_pixels(self.image.width(), self.image.height(), pixels);
        Self::of_image(image, Holds::Display)
    }

    /// The same, taken to be as noisy as this part of each pixel, if its noise is not known.
    #[must_use]
    pub fn with_noise(mut self, relative: f64) -> Self {
        let luminances = self.luminances();
        let mean = luminances.iter().sum::<f64>() / luminances.len().max(1) as f64;
        let variance = |l: &f64| (relative * l.max(0.1 * mean)).powi(2);
        self.variance.get_or_insert_with(|| luminances.iter().map(variance).collect());
        self
    }

    /// Luminance of each pixel, black where it is transparent.
    fn luminances(&self) -> Vec<f64> {
        let of = |&[r, g, b, a]: &[f32; 4]| f64::from(luminance(Rgb::new(r, g, b)) * a);
        self.image.pixels().iter().map(of).collect()
    }

    /// sRGB codes 0..1 of each pixel as it is shown over black, with an exposure if it is radiance.
    fn shown(&self, exposure_ev: f64) -> Vec<Rgb> {
        let gain = if self.holds == Holds::Display { 1.0 } else { exposure_ev.exp2() as f32 };
        let code = |x: f32| srgb_encode((gain * x).clamp(0.0, 1.0));
        let of = |&[r, g, b, a]: &[f32; 4]| Rgb::new(code(a * r), code(a * g), code(a * b));
        self.image.pixels().iter().map(of).collect()
    }
}

/// Compares picture `a` with the reference `b`, which must have the same size. If one of them is what is shown, so is the
/// other. Without a known noise, they count as the same up to a mean FLIP of `threshold`; with one, `threshold` if given is
/// held as well.
pub fn compare(a: &Measured, b: &Measured, threshold: Option<f64>) -> Comparison {
    if (a.holds == Holds::Display) != (b.holds == Holds::Display) {
        return compare(&a.displayed(), &b.displayed(), threshold);
    }
    let size = [b.image.width(), b.image.height()];
    let exposure = auto_exposure(&b.image);
    let flip_map = flip(&a.shown(exposure), &b.shown(exposure), size);
    let flip = flip_map.iter().map(|x| f64::from(*x)).sum::<f64>() / flip_map.len().max(1) as f64;
    let (of_a, of_b) = (a.luminances(), b.luminances());
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
    let noise = statistics::variance(a.variance.as_deref(), b.variance.as_deref(), &of_b);
    let squares = statistics::Squares::new(size, &of_a, &of_b, noise.as_deref());
    let test = noise.as_ref().map(|noise| squares.test(noise));
    let limit = threshold.unwrap_or(if test.is_some() { f64::INFINITY } else { USUAL_THRESHOLD });
    let within = test.is_none_or(|t| t.greatest <= t.allowed && t.of_means.abs() <= t.allowed);
    let (differing, map) = match test {
        Some(test) => (squares.beyond(test.allowed), squares.map(test.allowed)),
        None => (squares.where_mean(&flip_map, VISIBLE), flip_map),
    };
    Comparison {
        identical: a.image == b.image,
        same: within && flip <= limit,
        flip,
        relative_mse: relative_mse(&a.image, &b.image),
        means: [mean(&of_a), mean(&of_b)],
        test,
        regions: squares.regions(&differing),
        map,
    }
}

fn relative_mse(a: &Image, b: &Image) -> f64 {
    let channels = |image: &Image| -> Vec<f64> {
        let over_black = |&[r, g, b, a]: &[f32; 4]| [r * a, g * a, b * a].map(f64::from);
        image.pixels().iter().flat_map(over_black).collect()
    };
    let (a, b) = (channels(a), channels(b));
    let error = |(a, b): (&f64, &f64)| (a - b).powi(2) / (b * b + RELATIVE_FLOOR);
    a.iter().zip(&b).map(error).sum::<f64>() / a.len().max(1) as f64
}
