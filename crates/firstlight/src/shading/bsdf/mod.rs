//! How a surface scatters light at one point.

use crate::color::Rgb;
use std::f32::consts::FRAC_1_PI;

/// The ratio of radiance leaving a point to the irradiance that causes it, sr⁻¹.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Bsdf {
    /// Matte: the same radiance in every direction.
    Lambert {
        /// R_d, the fraction of the light that is reflected, 0..1.
        reflectance: Rgb,
    },
}

impl Bsdf {
    /// The lecture's k_d = R_d / π: what is reflected spreads over π projected steradians.
    pub(crate) fn value(&self) -> Rgb {
        match self {
            Self::Lambert { reflectance } => *reflectance * FRAC_1_PI,
        }
    }
}
