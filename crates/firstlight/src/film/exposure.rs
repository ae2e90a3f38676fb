//! An exposure from the picture itself.

use crate::color::{Rgb, luminance};
use crate::image::Image;
use crate::scene::description::FilmDescription;
use rayon::prelude::*;

/// Which part of the pixels may be brighter than [`TARGET`].
const PERCENTILE: f64 = 0.98;
/// The display value, 0..1, that the percentile is brought to: bright, yet below white.
const TARGET: f64 = 0.8;

/// The exposure in EV, rounded to 0.01, that brings the 98th percentile of the luminance of all covered pixels
/// (alpha > 0) to 0.8: display = radiance × 2^EV.
///
/// If so few pixels are lit that the percentile is black, it is taken of the lit ones. A black picture gets 0.
pub fn auto_exposure(image: &Image) -> f64 {
    let covered = image.pixels().par_iter().filter(|pixel| pixel[3] > 0.0);
    let mut values: Vec<f32> = covered
        .map(|&[r, g, b, _]| luminance(Rgb::new(r, g, b)))
        .filter(|l| l.is_finite())
        .collect();
    let mut level = percentile(&mut values);
    if level <= 0.0 {
        values.retain(|value| *value > 0.0);
        level = percentile(&mut values);
    }
    if level <= 0.0 {
        return 0.0;
    }
    const LIMIT: f64 = FilmDescription::MOST_STOPS;
    let stops = (TARGET / f64::from(level)).log2().clamp(-LIMIT, LIMIT);
    (100.0 * stops).round() / 100.0
}

/// The smallest value that is not below [`PERCENTILE`] of all; 0 if there are none.
fn percentile(values: &mut [f32]) -> f32 {
    let rank = (PERCENTILE * values.len() as f64).ceil() as usize;
    let Some(index) = rank.checked_sub(1) else { return 0.0 };
    *values.select_nth_unstable_by(index, f32::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(values: &[f32]) -> Image {
        let pixels = values.iter().map(|&v| [v, v, v, 1.0]).collect();
        Image::from_pixels(values.len() as u32, 1, pixels)
    }

    #[test]
    fn the_percentile_becomes_four_fifths() {
        // 98 of 100 pixels are at most 0.2, so that two bright ones do not count: log2(0.8 / 0.2) = 2.
        let mut values = [0.2; 100];
        values[7] = 1e6;
        values[93] = 50.0;
        assert_eq!(auto_exposure(&grey(&values)), 2.0);
        values[50] = 0.4;
        assert_eq!(auto_exposure(&grey(&values)), 1.0);
    }

    #[test]
    fn it_is_rounded_to_hundredths() {
        let ev = auto_exposure(&grey(&[0.3]));
        assert_eq!(ev, 1.42);
    }

    #[test]
    fn transparent_pixels_and_black_pictures_do_not_count() {
        let pixels = vec![[0.2, 0.2, 0.2, 0.5], [1e3, 1e3, 1e3, 0.0]];
        assert_eq!(auto_exposure(&Image::from_pixels(2, 1, pixels)), 2.0);
        assert_eq!(auto_exposure(&grey(&[0.0; 4])), 0.0);
        assert_eq!(auto_exposure(&Image::from_pixels(0, 0, vec![])), 0.0);
        let mut lonely = [0.0; 1000];
        lonely[3] = 0.1;
        assert_eq!(auto_exposure(&grey(&lonely)), 3.0);
    }
}
