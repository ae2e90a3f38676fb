//! The sRGB transfer function (IEC 61966-2-1): as real numbers, and as the integer codes that files hold.

use std::sync::LazyLock;

/// sRGB encoding of a linear value. Values outside 0..1 are not clamped.
pub fn srgb_encode(linear: f32) -> f32 {
    encode(f64::from(linear)) as f32
}

/// Linear value of an sRGB-encoded one.
pub fn srgb_decode(encoded: f32) -> f32 {
    decode(f64::from(encoded)) as f32
}

/// The 8-bit code nearest to a linear value, which is clamped to 0..1 first. NaN is black.
pub fn srgb_code8(linear: f32) -> u8 {
    CODES8.nearest(linear)
}

/// One of the two 8-bit codes around a linear value, which is clamped to 0..1 first: the upper one if the value lies
/// further than `threshold` (0..1) of the way from the lower to the upper. Over all thresholds the mean is the value
/// itself, in linear light. NaN is black.
pub fn srgb_dithered8(linear: f32, threshold: f32) -> u8 {
    let near = CODES8.nearest(linear);
    let at = |code: u8| CODES8.linear[usize::from(code)];
    let low = if at(near) > linear { near.saturating_sub(1) } else { near };
    let high = low.saturating_add(1);
    let part = (linear - at(low)) / (at(high) - at(low));
    if part > threshold { high } else { low }
}

/// The 16-bit code nearest to a linear value, which is clamped to 0..1 first. NaN is black.
pub fn srgb_code16(linear: f32) -> u16 {
    (encode(f64::from(linear).clamp(0.0, 1.0)) * 65_535.0).round() as u16
}

/// The linear value of an 8-bit code.
pub fn srgb_linear8(code: u8) -> f32 {
    CODES8.linear[usize::from(code)]
}

/// The linear value of a 16-bit code.
pub fn srgb_linear16(code: u16) -> f32 {
    LINEAR16[usize::from(code)]
}

// In double precision, so that the rounded results hardly depend on the platform's `pow`.
fn encode(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

fn decode(encoded: f64) -> f64 {
    if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

static CODES8: LazyLock<Codes8> = LazyLock::new(Codes8::new);
static LINEAR16: LazyLock<Vec<f32>> = LazyLock::new(|| {
    (0..=u16::MAX).map(|code| decode(f64::from(code) / 65_535.0) as f32).collect()
});

/// Equal cells of 0..1, narrower than the closest two linear values at which the nearest code changes (the
/// curve is steepest at black: 12.92 · 255 codes per unit). So a cell holds at most one change.
const CELLS: usize = 4096;

/// Finds codes by look-up and a single comparison instead of a power.
struct Codes8 {
    /// The linear value of every code.
    linear: [f32; 256],
    /// The smallest linear value whose nearest code is this one; nothing reaches code 256.
    from: [f32; 257],
    /// The nearest code at the lower end of every cell, and at 1.
    at_cell: [u8; CELLS + 1],
}

impl Codes8 {
    fn new() -> Self {
        let mut from = [f32::INFINITY; 257];
        for (code, first) in from.iter_mut().enumerate().take(256) {
            *first = round_up(decode((code as f64 - 0.5) / 255.0));
        }
        let at_cell =
            std::array::from_fn(|cell| (encode(cell as f64 / CELLS as f64) * 255.0).round() as u8);
        let linear = std::array::from_fn(|code| decode(code as f64 / 255.0) as f32);
        Self { linear, from, at_cell }
    }

    fn nearest(&self, linear: f32) -> u8 {
        let linear = linear.clamp(0.0, 1.0);
        let code = self.at_cell[(linear * CELLS as f32) as usize];
        if linear >= self.from[usize::from(code) + 1] { code + 1 } else { code }
    }
}

/// The smallest `f32` that is not below `value`.
fn round_up(value: f64) -> f32 {
    let near = value as f32;
    if f64::from(near) < value { near.next_up() } else { near }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Linear value, encoded value, 8-bit code.
    const KNOWN: [(f32, f32, u8); 5] = [
        (0.001, 0.012_92, 3),
        (0.003_130_8, 0.040_449_936, 10),
        (0.18, 0.461_356_13, 118),
        (0.5, 0.735_357, 188),
        (0.8, 0.906_331_8, 231),
    ];

    #[test]
    fn encodes_known_values_and_codes() {
        for (linear, encoded, code) in KNOWN {
            assert!((srgb_encode(linear) - encoded).abs() < 1e-6, "{linear}");
            assert!((srgb_decode(encoded) - linear).abs() < 1e-6, "{linear}");
            assert_eq!(srgb_code8(linear), code, "{linear}");
        }
    }

    #[test]
    fn every_code_survives_decoding_and_encoding() {
        for code in 0..=u8::MAX {
            assert_eq!(srgb_code8(srgb_linear8(code)), code);
            assert_eq!(srgb_code8(srgb_decode(f32::from(code) / 255.0)), code);
        }
        for code in 0..=u16::MAX {
            assert_eq!(srgb_code16(srgb_linear16(code)), code);
        }
    }

    #[test]
    fn table_agrees_with_rounding_the_curve() {
        let reference = |linear: f32| (encode(f64::from(linear)) * 255.0).round() as u8;
        for step in 0..=1_000_000 {
            let linear = step as f32 * 1e-6;
            assert_eq!(srgb_code8(linear), reference(linear), "{linear}");
        }
        for first in &CODES8.from[1..256] {
            for linear in [first.next_down(), *first, first.next_up()] {
                assert_eq!(srgb_code8(linear), reference(linear), "{linear}");
            }
        }
    }

    #[test]
    fn dither_keeps_steps_and_means() {
        let thresholds = || (0..64).map(|k| (k as f32 + 0.5) / 64.0);
        for code in 0..=u8::MAX {
            for value in [0.99997, 1.0, 1.00003].map(|rounding| rounding * srgb_linear8(code)) {
                assert!(thresholds().all(|t| srgb_dithered8(value, t) == code), "{code}");
            }
        }
        for value in [0.0001, 0.01234, 0.2, 0.777] {
            let codes = thresholds().map(|t| srgb_linear8(srgb_dithered8(value, t)));
            let mean = codes.sum::<f32>() / 64.0;
            assert!((mean / value - 1.0).abs() < 2e-3 || value < 2e-4, "{value}: {mean}");
        }
        for value in [f32::NAN, -1.0, 0.0, 1.0, 7.0] {
            assert!(thresholds().all(|t| srgb_dithered8(value, t) == srgb_code8(value)), "{value}");
        }
    }

    #[test]
    fn clamps_what_is_not_a_display_value() {
        for (linear, code) in [
            (f32::NAN, 0),
            (f32::NEG_INFINITY, 0),
            (-1.0, 0),
            (-0.0, 0),
            (1.0, 255),
            (7.0, 255),
            (f32::INFINITY, 255),
        ] {
            assert_eq!(srgb_code8(linear), code, "{linear}");
            assert_eq!(srgb_code16(linear), u16::from(code) * 257, "{linear}");
        }
    }
}
