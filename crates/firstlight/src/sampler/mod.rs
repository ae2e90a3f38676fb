//! Where samples are taken: Owen-scrambled Sobol' points, a pure function of pixel, sample and seed.
//!
//! Burley, *Practical Hash-based Owen Scrambling*, JCGT 9(4), 2020, by its author's library.

use crate::math::hash;
use glam::Vec2;

/// One sample of one pixel: all in 0..1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct CameraSample {
    /// Picks the place around the pixel's centre.
    pub film: Vec2,
    /// Picks the place on the lens.
    pub lens: Vec2,
}

/// After this many samples a sequence starts again with another scramble (a limit of the library).
const SEQUENCE: u32 = 1 << 16;

/// Sample number `index` of the pixel in column `x`, row `y`.
#[inline(always)]
pub(crate) fn camera_sample(x: u32, y: u32, index: u32, seed: u64) -> CameraSample {
    let pixel = u64::from(x) << 32 | u64::from(y);
    let scramble = hash(hash(seed ^ u64::from(index / SEQUENCE) << 32) ^ pixel) as u32;
    let [a, b, c, d] = sobol_burley::sample_4d(index % SEQUENCE, 0, scramble);
    CameraSample { film: Vec2::new(a, b), lens: Vec2::new(c, d) }
}
