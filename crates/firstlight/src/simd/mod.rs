//! Eight floats at a time: the vocabulary kernels are written in, and the only place with `unsafe`.
//!
//! A kernel is a [`Kernel`], generic over [`Simd`]; [`Level::run`] compiles it once per level and picks the
//! best one that the processor has. Operations round like the scalar ones, lane by lane, at every level;
//! only [`Lanes::mul_add`] may round once or twice.

mod level;
mod pages;
mod portable;
#[cfg(target_arch = "x86_64")]
mod x86;

pub(crate) use level::Kernel;
pub use level::Level;
pub(crate) use pages::Pages;

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Sub};

/// Number of lanes.
pub(crate) const LANES: usize = 8;

/// A level's instructions. Holding a value proves that the processor has them.
pub(crate) trait Simd: Copy {
    /// Whether lanes are permuted by one instruction.
    const PERMUTES: bool;

    /// Eight floats.
    type F: Lanes<D = Self::D, Mask = Self::M>;
    /// Eight truth values.
    type M: Mask;
    /// Four doubles.
    type D: Doubles;

    /// The same number in every lane.
    fn splat(self, x: f32) -> Self::F;

    /// The same number in every lane.
    fn splat_f64(self, x: f64) -> Self::D;

    /// Eight numbers from memory.
    fn load(self, x: &[f32; LANES]) -> Self::F;

    /// Bit `i` as lane `i`.
    fn mask(self, bits: u32) -> Self::M;

    /// Asks for the cache lines of what is needed soon. The address need not be one of anything.
    fn prefetch<T>(self, x: *const T);

    /// Word `i` becomes word `indices[i]`, all below eight.
    fn permute_words(self, words: &[u32; LANES], indices: &[u8; LANES]) -> [u32; LANES];

    /// Rows become columns.
    fn transpose(self, rows: [Self::F; LANES]) -> [Self::F; LANES];
}

/// Eight floats.
pub(crate) trait Lanes:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// Eight truth values.
    type Mask: Mask;
    /// Half of the lanes in double precision.
    type D: Doubles;

    /// `self * a + b`, fused or not.
    fn mul_add(self, a: Self, b: Self) -> Self;
    /// The smaller of each lane; the second where either is NaN.
    fn min(self, other: Self) -> Self;
    /// The larger of each lane; the second where either is NaN.
    fn max(self, other: Self) -> Self;
    /// The square root.
    fn sqrt(self) -> Self;
    /// Without sign.
    fn abs(self) -> Self;
    /// With the sign of `sign`.
    fn copysign(self, sign: Self) -> Self;
    /// `self` where `mask` holds, else `other`.
    fn select(self, mask: Self::Mask, other: Self) -> Self;
    /// `self <= other`; false for NaN.
    fn le(self, other: Self) -> Self::Mask;
    /// `self < other`; false for NaN.
    fn lt(self, other: Self) -> Self::Mask;
    /// `self != other`; true for NaN.
    fn ne(self, other: Self) -> Self::Mask;
    /// The sign of lane `i` as bit `i`.
    fn signs(self) -> u32;
    /// Lane `i` becomes lane `indices[i]`, all below eight.
    fn permute(self, indices: &[u8; LANES]) -> Self;
    /// The smallest lane.
    fn smallest(self) -> f32;
    /// The largest lane.
    fn largest(self) -> f32;
    /// The lower and the upper half in double precision.
    fn to_doubles(self) -> [Self::D; 2];
    /// Both halves, rounded.
    fn from_doubles(halves: [Self::D; 2]) -> Self;
    /// The lanes as an array.
    fn to_array(self) -> [f32; LANES];
}

/// Four doubles.
pub(crate) trait Doubles:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
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

    const PLACES: [u8; LANES] = [7, 0, 3, 3, 1, 6, 2, 5];

    impl Kernel for Everything {
        type Output = ([[f32; LANES]; 12], [u32; 6], [f32; 2], [[f32; LANES]; LANES], [u32; LANES]);

        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> Self::Output {
            let (a, b) = (simd.load(&self.0), simd.load(&self.1));
            let [lo, hi] = a.to_doubles();
            let [lo2, hi2] = b.to_doubles();
            let three = simd.splat_f64(3.0);
            let doubles = [(lo * lo2 + three) / lo2 - lo, (hi * hi2 + three) / hi2 - hi];
            let numbers = [
                a + b,
                a - b,
                a * b,
                a / b,
                a.min(b),
                a.max(b),
                simd.splat(self.0[0]).copysign(b),
                a.abs(),
                a.abs().sqrt(),
                a.permute(&PLACES),
                S::F::from_doubles(doubles),
                a.select(simd.mask(0b1010_0110), b),
            ];
            let (le, lt, ne) = (a.le(b), a.lt(b), a.ne(b));
            (
                numbers.map(Lanes::to_array),
                [le.bits(), ne.bits(), (le & ne).bits(), (le | ne).bits(), lt.bits(), a.signs()],
                [a.smallest(), a.largest()],
                simd.transpose([a, b, a + b, a - b, a, b, b, a]).map(Lanes::to_array),
                simd.permute_words(&self.0.map(f32::to_bits), &PLACES),
            )
        }
    }

    #[test]
    fn every_level_computes_what_scalar_arithmetic_does() {
        let a = [1.0, -2.5, 3.25e7, 0.1, 0.0, -1e-20, 7.0, 1e30];
        let b = [3.0, -2.5, 1.5e-3, 0.3, 2.0, 1e20, -7.0, 1e-9];
        for level in Level::all() {
            let (numbers, masks, ends, columns, words) = level.run(Everything(a, b));
            for i in 0..LANES {
                let (x, y) = (a[i], b[i]);
                let (dx, dy) = (f64::from(x), f64::from(y));
                let expected = [
                    x + y,
                    x - y,
                    x * y,
                    x / y,
                    x.min(y),
                    x.max(y),
                    a[0].copysign(y),
                    x.abs(),
                    x.abs().sqrt(),
                    a[usize::from(PLACES[i])],
                    ((dx * dy + 3.0) / dy - dx) as f32,
                    if 0b1010_0110 >> i & 1 == 1 { x } else { y },
                ];
                assert_eq!(columns[i], [x, y, x + y, x - y, x, y, y, x], "{level:?} column {i}");
                assert_eq!(numbers.map(|n| n[i]), expected, "{level:?} lane {i}");
                let bits = [x <= y, x != y, x < y, x <= y || x > y, x < y, x < 0.0];
                assert_eq!(masks.map(|m| m >> i & 1 == 1), bits, "{level:?} lane {i}");
            }
            assert_eq!(ends, [-2.5, 1e30], "{level:?}");
            assert_eq!(words, PLACES.map(|i| a[usize::from(i)].to_bits()), "{level:?}");
        }
    }
}
