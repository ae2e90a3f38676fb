//! Pictures to be compared: any format, with their noise if they tell it.

use super::access::{read_file, shown};
use super::{Limits, layers, load_image, part};
use crate::compare::{Holds, Measured};
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
        let exposure_ev = part.info.exposure.map(|stops| stops as f32);
        return Ok(Measured::of_film(&part.film, exposure_ev, part.info.view));
    }
    let image = load_image(&bytes, &shown(path), limits)?;
    if is_exr {
        let layers = layers::load_layers(path, limits)?;
        let variance = layers.rgb("variance");
        let variance = variance.map(|variance| variance.into_iter().map(of_luminance).collect());
        let (exposure_ev, view) = (layers.exposure_ev, layers.view.unwrap_or_default());
        let holds = Holds::Radiance { exposure_ev, view };
        return Ok(Measured { image, variance, holds });
    }
    let is_linear = bytes.starts_with(b"#?") || bytes.starts_with(b"P");
    Ok(Measured::of_image(image, if is_linear { Holds::RADIANCE } else { Holds::Display }))
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
