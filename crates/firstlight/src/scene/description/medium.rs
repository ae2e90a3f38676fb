//! What fills space: fog, smoke, milk.

use crate::color::Rgb;

/// A medium that is the same everywhere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Medium {
    /// What is absorbed per length, m⁻¹.
    pub absorption: Rgb,
    /// What is scattered per length, m⁻¹.
    pub scattering: Rgb,
    /// Mean cosine between the directions of flight before and after scattering, −1 < g < 1; 0: the same everywhere
    /// (Henyey & Greenstein).
    pub anisotropy: f32,
}
