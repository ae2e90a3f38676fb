//! Eight floats at a time: the vocabulary kernels are written in, and the only place with `unsafe`.
//!
//! A kernel is a [`Kernel`], generic over [`Simd`]; [`Level::run`] compiles it once per level and picks the
//! best one that the processor has. Operations round like the scalar ones, lane by lane, at every level;
//! only [`Lanes::mul_add`] may round once or twice.

mod level;
mod portable;
#[cfg(target_arch = "x86_64")]
mod x86;

pub(crate) use level::Kernel;
pub use level::Level;

use std::ops::{Add, BitAnd, BitOr, Mul, Sub};

/// Number of lanes.
pub(crate) const LANES: usize = 8;

/// A level's instructions. Holding a value proves that the processor has them.
pub(crate) trait Simd: Copy {
    /// Eight floats.
    type F: Lanes;

    /// The same number in every lane.
    fn splat(self, x: f32) -> Self::F;

    /// Eight numbers from memory.
    fn load(self, x: &[f32; LANES]) -> Self::F;
}

/// Eight floats.
pub(crate) trait Lanes:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self>
{
    /// Eight truth values.
    type Mask: Mask;

    /// `self * a + b`, fused or not.
    fn mul_add(self, a: Self, b: Self) -> Self;
    /// The smaller of each lane.
    fn min(self, other: Self) -> Self;
    /// The larger of each lane.
    fn max(self, other: Self) -> Self;
    /// `self <= other`; false for NaN.
    fn le(self, other: Self) -> Self::Mask;
    /// `self != other`; true for NaN.
    fn ne(self, other: Self) -> Self::Mask;
    /// The lanes as an array.
    fn to_array(self) -> [f32; LANES];
}

/// Eight truth values.
pub(crate) trait Mask: Copy + BitAnd<Output = Self> + BitOr<Output = Self> {
    /// Lane `i` as bit `i`.
    fn bits(self) -> u32;
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Everything([f32; LANES], [f32; LANES]);

    impl Kernel for Everything {
        type Output = ([[f32; LANES]; 6], [u32; 4]);

        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> Self::Output {
            let (a, b) = (simd.load(&self.0), simd.load(&self.1));
            let numbers = [a + b, a - b, a * b, a.min(b), a.max(b), simd.splat(self.0[0])];
            let (le, ne) = (a.le(b), a.ne(b));
            (
                numbers.map(Lanes::to_array),
                [le.bits(), ne.bits(), (le & ne).bits(), (le | ne).bits()],
            )
        }
    }

    #[test]
    fn every_level_computes_what_scalar_arithmetic_does() {
        let a = [1.0, -2.5, 3.25e7, 0.1, 0.0, -1e-20, 7.0, 1e30];
        let b = [3.0, -2.5, 1.5e-3, 0.3, 2.0, 1e20, -7.0, 1e-9];
        for level in Level::all() {
            let (numbers, masks) = level.run(Everything(a, b));
            for i in 0..LANES {
                let (x, y) = (a[i], b[i]);
                let expected = [x + y, x - y, x * y, x.min(y), x.max(y), a[0]];
                assert_eq!(numbers.map(|n| n[i]), expected, "{level:?} lane {i}");
                let bits = [x <= y, x != y, x < y, x <= y || x > y];
                assert_eq!(masks.map(|m| m >> i & 1 == 1), bits, "{level:?} lane {i}");
            }
        }
    }
}
