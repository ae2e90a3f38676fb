//! The level every processor has: arrays that the compiler vectorises as it can.

use super::{Doubles, Eight, LANES, Lanes, MOST, Mask, Simd, Vectors};
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Sub};

/// No special instructions.
#[derive(Clone, Copy)]
pub(crate) struct Portable;

/// Eight floats in an array.
#[derive(Clone, Copy)]
pub(crate) struct Array([f32; LANES]);

/// Four doubles in an array.
#[derive(Clone, Copy)]
pub(crate) struct DoubleArray([f64; LANES / 2]);

/// Eight truth values as bits.
#[derive(Clone, Copy)]
pub(crate) struct Bits(u32);

impl Vectors for Portable {
    const ZERO: Self::Row = [0.0; LANES];

    type Row = [f32; LANES];
    type F = Array;
    type M = Bits;
    type D = DoubleArray;

    #[inline(always)]
    fn splat(self, x: f32) -> Array {
        Array([x; LANES])
    }

    #[inline(always)]
    fn splat_f64(self, x: f64) -> DoubleArray {
        DoubleArray([x; LANES / 2])
    }

    #[inline(always)]
    fn load(self, x: &[f32; LANES]) -> Array {
        Array(*x)
    }

    #[inline(always)]
    fn mask(self, bits: u32) -> Bits {
        Bits(bits)
    }
}

impl Simd for Portable {
    const PERMUTES: bool = false;

    type Rays = Self;

    #[inline(always)]
    fn rays(self) -> Self {
        self
    }

    #[inline(always)]
    fn part(self, x: Array, _: usize) -> Array {
        x
    }

    #[inline(always)]
    fn columns(self, rows: &[[f32; LANES]; MOST]) -> [Array; LANES] {
        self.transpose(std::array::from_fn(|lane| Array(rows[lane])))
    }

    #[inline(always)]
    fn prefetch<T>(self, _: *const T) {}

    #[inline(always)]
    fn permute_words(self, words: &[u32; LANES], indices: &[u8; LANES]) -> [u32; LANES] {
        indices.map(|i| words[usize::from(i) % LANES])
    }

    #[inline(always)]
    fn transpose(self, rows: [Array; LANES]) -> [Array; LANES] {
        std::array::from_fn(|column| Array(std::array::from_fn(|row| rows[row].0[column])))
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

impl DoubleArray {
    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Self(std::array::from_fn(|i| f(self.0[i], other.0[i])))
    }
}

/// Implements a binary operator lane by lane.
macro_rules! operator {
    ($type:ident, $trait:ident, $method:ident, $operator:tt) => {
        impl $trait for $type {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.zip(other, |a, b| a $operator b)
            }
        }
    };
}

operator!(Array, Add, add, +);
operator!(Array, Sub, sub, -);
operator!(Array, Mul, mul, *);
operator!(Array, Div, div, /);
operator!(DoubleArray, Add, add, +);
operator!(DoubleArray, Sub, sub, -);
operator!(DoubleArray, Mul, mul, *);
operator!(DoubleArray, Div, div, /);

impl Doubles for DoubleArray {}

impl Lanes for Array {
    type Row = [f32; LANES];
    type Mask = Bits;
    type D = DoubleArray;

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
    fn sqrt(self) -> Self {
        Self(self.0.map(f32::sqrt))
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.map(f32::abs))
    }

    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        self.zip(sign, f32::copysign)
    }

    #[inline(always)]
    fn select(self, mask: Bits, other: Self) -> Self {
        Self(std::array::from_fn(|i| if mask.0 >> i & 1 == 1 { self.0[i] } else { other.0[i] }))
    }

    #[inline(always)]
    fn le(self, other: Self) -> Bits {
        self.test(other, |a, b| a <= b)
    }

    #[inline(always)]
    fn lt(self, other: Self) -> Bits {
        self.test(other, |a, b| a < b)
    }

    #[inline(always)]
    fn ne(self, other: Self) -> Bits {
        self.test(other, |a, b| a != b)
    }

    #[inline(always)]
    fn signs(self) -> u32 {
        self.test(self, |a, _| a.is_sign_negative()).0
    }

    #[inline(always)]
    fn smallest(self) -> f32 {
        self.0.into_iter().fold(f32::INFINITY, f32::min)
    }

    #[inline(always)]
    fn largest(self) -> f32 {
        self.0.into_iter().fold(f32::NEG_INFINITY, f32::max)
    }

    #[inline(always)]
    fn to_doubles(self) -> [DoubleArray; 2] {
        let [a, b, c, d, e, f, g, h] = self.0.map(f64::from);
        [DoubleArray([a, b, c, d]), DoubleArray([e, f, g, h])]
    }

    #[inline(always)]
    fn from_doubles([lo, hi]: [DoubleArray; 2]) -> Self {
        let ([a, b, c, d], [e, f, g, h]) = (lo.0, hi.0);
        Self([a, b, c, d, e, f, g, h].map(|x| x as f32))
    }

    #[inline(always)]
    fn to_array(self) -> [f32; LANES] {
        self.0
    }
}

impl Eight for Array {
    #[inline(always)]
    fn permute(self, indices: &[u8; LANES]) -> Self {
        Self(indices.map(|i| self.0[usize::from(i) % LANES]))
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
