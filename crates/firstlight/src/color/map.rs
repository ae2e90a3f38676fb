//! Numbers as colours.

use super::{Rgb, srgb_decode};

/// A scale of colours, from dark to bright: each step looks equally large, in grey and to the colour-blind as well
/// (Smith, van der Walt 2015; here with straight lines between nine of their colours).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColorMap {
    /// From blue by green to yellow.
    Viridis,
    /// From black by violet to light yellow.
    Magma,
}

const VIRIDIS: [u32; 9] =
    [0x440154, 0x472D7B, 0x3B528B, 0x2C728E, 0x21918C, 0x28AE80, 0x5EC962, 0xADDC30, 0xFDE725];
const MAGMA: [u32; 9] =
    [0x000004, 0x1C1044, 0x4F127B, 0x812581, 0xB5367A, 0xE55064, 0xFB8761, 0xFEC287, 0xFCFDBF];

impl ColorMap {
    /// The linear colour of a number in 0..1; what is outside is taken to the end.
    pub fn color(self, value: f32) -> Rgb {
        let steps = if self == Self::Viridis { VIRIDIS } else { MAGMA };
        let place = 8.0 * if value > 0.0 { value.min(1.0) } else { 0.0 };
        let first = (place as usize).min(7);
        let code = |step: u32| {
            Rgb::from_array([16, 8, 0].map(|shift| (step >> shift & 0xFF) as f32 / 255.0))
        };
        code(steps[first]).lerp(code(steps[first + 1]), place - first as f32).map(srgb_decode)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::{luminance, srgb_code8};

    #[test]
    fn scales_get_brighter_all_the_way() {
        for map in [ColorMap::Viridis, ColorMap::Magma] {
            let lights: Vec<_> =
                (0..=100).map(|i| luminance(map.color(i as f32 / 100.0))).collect();
            assert!(lights.is_sorted(), "{map:?}");
            assert_eq!(map.color(-1.0), map.color(f32::NAN));
            assert_eq!(map.color(9.0), map.color(1.0));
        }
        assert_eq!(ColorMap::Viridis.color(1.0).to_array().map(srgb_code8), [0xFD, 0xE7, 0x25]);
    }
}
