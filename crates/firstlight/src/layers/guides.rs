//! What a denoiser is told of a picture.

use super::Channel;

/// What is seen in each pixel, row by row from the top, as a mean over the pixel like its colour; 0 where nothing is.
#[derive(Debug, Clone, PartialEq)]
pub struct Guides {
    /// Red, green and blue of the fraction of light that is scattered, 0..1.
    pub albedo: Vec<[f32; 3]>,
    /// The normal that light is reckoned with, on the side of the camera; shorter than 1 where it varies within the pixel.
    pub normal: Vec<[f32; 3]>,
}

impl Guides {
    /// Their names in files.
    pub(crate) const NAMES: [&str; 6] = ["albedo.R", "albedo.G", "albedo.B", "N.X", "N.Y", "N.Z"];

    /// As channels of a file.
    pub(crate) fn channels(&self) -> impl Iterator<Item = Channel> {
        Self::NAMES.into_iter().enumerate().map(|(i, name)| {
            let plane = if i < 3 { &self.albedo } else { &self.normal };
            Channel::numbers(name, plane.iter().map(|pixel| pixel[i % 3]))
        })
    }

    /// From the values of such channels, in their order.
    pub(crate) fn from_planes([r, g, b, x, y, z]: [&[f32]; 6]) -> Self {
        let triples = |a: &[f32], b: &[f32], c: &[f32]| {
            a.iter().zip(b).zip(c).map(|((a, b), c)| [*a, *b, *c]).collect()
        };
        Self { albedo: triples(r, g, b), normal: triples(x, y, z) }
    }
}
