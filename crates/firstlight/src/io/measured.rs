//! Pictures to be compared: any format, with their noise if they tell it.

use super::access::{read_file, shown};
use super::{Limits, layers, load_image, part};
use crate::compare::Measured;
use crate::diagnostic::Result;
use std::path::Path;

/// Reads the picture at `path`: one of our parts, whose halves tell its noise; an OpenEXR file with layers
/// `variance.R`, `.G` and `.B`; or any other picture.
///
/// # Errors
/// If it cannot be read or is larger than `limits` allow.
pub fn load_measured(path: &Path, limits: &Limits) -> Result<Measured> {
    let bytes = read_file(path)?;
    let is_exr = bytes.starts_with(&[0x76, 0x2F, 0x31, 0x01]);
    if is_exr && let Ok(part) = part::load_part(path, limits) {
        return Ok(Measured::of_film(&part.film));
    }
    let image = load_image(&bytes, &shown(path), limits)?;
    let is_linear = is_exr || bytes.starts_with(b"#?") || bytes.starts_with(b"P");
    let variance = if is_exr { layers::load_layers(path, limits)?.rgb("variance") } else { None };
    let variance = variance.map(|variance| variance.into_iter().map(of_luminance).collect());
    Ok(Measured { variance, ..Measured::of_image(image, !is_linear) })
}

/// Reads variances from a picture of their own, as some renderers write them.
///
/// # Errors
/// As [`load_measured`].
pub fn load_variance(path: &Path, limits: &Limits) -> Result<Vec<f64>> {
    let image = load_image(&read_file(path)?, &shown(path), limits)?;
    Ok(image.pixels().iter().map(|&[r, g, b, _]| of_luminance([r, g, b])).collect())
}

/// Variance of the luminance, at most: as if the channels' errors were all the same way.
fn of_luminance(variance: [f32; 3]) -> f64 {
    let [r, g, b] = variance.map(|v| f64::from(v).max(0.0).sqrt());
    (0.2126 * r + 0.7152 * g + 0.0722 * b).powi(2)
}
