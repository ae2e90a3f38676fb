//! Colour: linear Rec. 709 with D65 white inside, sRGB at the edges.

mod parse;

pub use parse::parse;

/// Linear Rec. 709 red, green, blue: a radiance, irradiance, intensity or reflectance per channel.
pub type Rgb = glam::Vec3;

/// Luminance Y of a linear Rec. 709 colour (ITU-R BT.709).
pub fn luminance(color: Rgb) -> f32 {
    color.dot(Rgb::new(0.2126, 0.7152, 0.0722))
}

/// sRGB encoding of a linear value (IEC 61966-2-1). Values outside 0..1 are not clamped.
pub fn srgb_encode(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// Linear value of an sRGB-encoded one (IEC 61966-2-1).
pub fn srgb_decode(encoded: f32) -> f32 {
    if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}
