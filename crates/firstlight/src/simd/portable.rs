//! The level every processor has: arrays that the compiler vectorises as it can.

use super::{LANES, Lanes, Mask, Simd};
use std::ops::{Add, BitAnd, BitOr, Mul, Sub};

/// No special instructions.
#[derive(Clone, Copy)]
pub(crate) struct Portable;

/// Eight floats in an array.
#[derive(Clone, Copy)]
pub(crate) struct Array([f32; LANES]);

/// Eight truth values as bits.
#[derive(Clone, Copy)]
pub(crate) struct Bits(u32);

impl Simd for Portable {
    type F = Array;

    #[inline(always)]
    fn splat(self, x: f32) -> Array {
        Array([x; LANES])
    }

    #[inline(always)]
    fn load(self, x: &[f32; LANES]) -> Array {
        Array(*x)
    }
}

impl Array {
    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        Self(std::array::from_fn(|i| f(self.0[i], other.0[i])))
    }

    #[inline(always)]
    fn test(self, other: Self, f: impl Fn(f32, f32) -> bool) -> Bits {
        Bits((0..LANES).fold(0, |bits, i| bits | u32::from(f(self.0[i], other.0[i])) << i))
    }
}

impl Add for Array {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl Sub for Array {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl Mul for Array {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
}

impl Lanes for Array {
    type Mask = Bits;

    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        self * a + b
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.zip(other, |a, b| if a < b { a } else { b })
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    fn le(self, other: Self) -> Bits {
        self.test(other, |a, b| a <= b)
    }

    #[inline(always)]
    fn ne(self, other: Self) -> Bits {
        self.test(other, |a, b| a != b)
    }

    #[inline(always)]
    fn to_array(self) -> [f32; LANES] {
        self.0
    }
}

impl BitAnd for Bits {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

impl BitOr for Bits {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl Mask for Bits {
    #[inline(always)]
    fn bits(self) -> u32 {
        self.0
    }
}
