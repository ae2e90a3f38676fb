//! Light from far away on all sides, as plain data.

use super::{Pixels, Sampling};
use crate::color::Rgb;
use glam::{DQuat, DVec3};
use std::sync::Arc;

/// Light from directions that hit nothing.
#[derive(Debug, Clone, PartialEq)]
pub struct EnvironmentDescription {
    /// What comes from where.
    pub sky: Sky,
    /// Multiplies what comes from the sky.
    pub factor: Rgb,
    /// From the sky's own space (x east, y north, z up) to the world.
    pub rotation: DQuat,
    /// Whether the camera sees it; otherwise it sees the background.
    pub visible: bool,
}

/// What comes from where, W·sr⁻¹·m⁻² before the environment's factor.
#[derive(Debug, Clone, PartialEq)]
pub enum Sky {
    /// 1 from everywhere.
    Uniform,
    /// Straight from one radiance to the next with the sine of the elevation.
    Gradient {
        /// From straight above.
        zenith: Rgb,
        /// From the horizon.
        horizon: Rgb,
        /// From straight below.
        nadir: Rgb,
    },
    /// A lat-long picture: zenith in the first row, north in the middle, east to its right.
    Picture {
        /// The picture.
        pixels: Arc<Pixels>,
        /// How pixels are joined.
        sampling: Sampling,
    },
    /// One of the CIE's general skies (ISO 15469:2004), 1 at its zenith.
    Cie {
        /// Which of them, 1..=15.
        number: u8,
        /// Unit vector to the sun, which is not part of it.
        sun: DVec3,
        /// Radiance of the ground below the horizon.
        ground: Rgb,
    },
    /// A clear or hazy sky, in cd·m⁻².
    Clear {
        /// How hazy: 2 is clear, 6 hazy.
        turbidity: f64,
        /// Unit vector to the sun, which is not part of it.
        sun: DVec3,
        /// Luminance of the ground below the horizon per channel.
        ground: Rgb,
    },
}
