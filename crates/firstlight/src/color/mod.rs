//! Colour: linear Rec. 709 with D65 white inside, sRGB at the edges.

mod map;
mod srgb;
mod view;

pub use map::ColorMap;
pub use srgb::{
    srgb_code8, srgb_code16, srgb_decode, srgb_dithered8, srgb_encode, srgb_linear8, srgb_linear16,
};
mod parse;

pub use parse::parse;
pub use view::View;

/// Linear Rec. 709 red, green, blue: a radiance, irradiance, intensity or reflectance per channel.
pub type Rgb = glam::Vec3;

/// Luminance Y of a linear Rec. 709 colour (ITU-R BT.709).
pub fn luminance(color: Rgb) -> f32 {
    color.dot(Rgb::new(0.2126, 0.7152, 0.0722))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn luminance_weighs_the_channels() {
        assert!((luminance(Rgb::new(0.2, 0.5, 0.1)) / 0.407_34 - 1.0).abs() < 1e-5);
        assert!((luminance(Rgb::ONE) - 1.0).abs() < 1e-6);
    }
}
