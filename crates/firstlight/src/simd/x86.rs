//! AVX2 with FMA.

#![allow(unsafe_code)]

use super::{LANES, Lanes, Mask, Simd};
use std::arch::x86_64::*;
use std::ops::{Add, BitAnd, BitOr, Mul, Sub};

/// Proof that the processor has AVX2 and FMA.
#[derive(Clone, Copy)]
pub(crate) struct Avx2(());

/// Eight floats in a register; exists only where an [`Avx2`] does.
#[derive(Clone, Copy)]
pub(crate) struct F32x8(__m256);

/// Eight truth values, each a lane of ones or zeros.
#[derive(Clone, Copy)]
pub(crate) struct Mask8(__m256);

impl Avx2 {
    /// The proof; callable only where the features are enabled.
    #[target_feature(enable = "avx2,fma")]
    pub(super) fn detected() -> Self {
        Self(())
    }
}

impl Simd for Avx2 {
    type F = F32x8;

    #[inline(always)]
    fn splat(self, x: f32) -> F32x8 {
        // SAFETY: `self` proves AVX2.
        F32x8(unsafe { _mm256_set1_ps(x) })
    }

    #[inline(always)]
    fn load(self, x: &[f32; LANES]) -> F32x8 {
        // SAFETY: `self` proves AVX2; the reference covers the 32 bytes that are read, unaligned.
        F32x8(unsafe { _mm256_loadu_ps(x.as_ptr()) })
    }
}

/// Implements a binary operator by an intrinsic.
macro_rules! operator {
    ($type:ident, $trait:ident, $method:ident, $intrinsic:ident) => {
        impl $trait for $type {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                // SAFETY: values of this type exist only where AVX2 does.
                Self(unsafe { $intrinsic(self.0, other.0) })
            }
        }
    };
}

operator!(F32x8, Add, add, _mm256_add_ps);
operator!(F32x8, Sub, sub, _mm256_sub_ps);
operator!(F32x8, Mul, mul, _mm256_mul_ps);
operator!(Mask8, BitAnd, bitand, _mm256_and_ps);
operator!(Mask8, BitOr, bitor, _mm256_or_ps);

impl Lanes for F32x8 {
    type Mask = Mask8;

    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        // SAFETY: values of this type exist only where AVX2 and FMA do.
        Self(unsafe { _mm256_fmadd_ps(self.0, a.0, b.0) })
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        // SAFETY: values of this type exist only where AVX2 does.
        Self(unsafe { _mm256_min_ps(self.0, other.0) })
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        // SAFETY: values of this type exist only where AVX2 does.
        Self(unsafe { _mm256_max_ps(self.0, other.0) })
    }

    #[inline(always)]
    fn le(self, other: Self) -> Mask8 {
        // SAFETY: values of this type exist only where AVX2 does.
        Mask8(unsafe { _mm256_cmp_ps::<_CMP_LE_OQ>(self.0, other.0) })
    }

    #[inline(always)]
    fn ne(self, other: Self) -> Mask8 {
        // SAFETY: values of this type exist only where AVX2 does.
        Mask8(unsafe { _mm256_cmp_ps::<_CMP_NEQ_UQ>(self.0, other.0) })
    }

    #[inline(always)]
    fn to_array(self) -> [f32; LANES] {
        let mut array = [0.0; LANES];
        // SAFETY: the array has the 32 bytes that are written, unaligned.
        unsafe { _mm256_storeu_ps(array.as_mut_ptr(), self.0) };
        array
    }
}

impl Mask for Mask8 {
    #[inline(always)]
    fn bits(self) -> u32 {
        // SAFETY: values of this type exist only where AVX2 does.
        unsafe { _mm256_movemask_ps(self.0) as u32 }
    }
}
