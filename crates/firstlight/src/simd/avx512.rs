//! AVX-512: sixteen rays at a time, beside AVX2's vectors of eight. Truth values are bits.

#![allow(unsafe_code)]

use super::x86::{F32x8, RayVectors, X86};
use super::{Doubles, LANES, Lanes, MOST, Mask, Vectors};
use std::arch::x86_64::*;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Sub};

/// Proof that the processor has AVX-512.
#[derive(Clone, Copy)]
pub(crate) struct Sixteen(());

/// Sixteen floats in a register; exists only where a [`Sixteen`] does.
#[derive(Clone, Copy)]
pub(crate) struct F32x16(__m512);

/// Eight doubles in a register; exists only where a [`Sixteen`] does.
#[derive(Clone, Copy)]
pub(crate) struct F64x8(__m512d);

/// Sixteen truth values.
#[derive(Clone, Copy)]
pub(crate) struct Mask16(__mmask16);

impl Sixteen {
    /// The proof; callable only where the features are enabled.
    #[target_feature(enable = "avx512f,avx512dq")]
    pub(super) fn detected() -> Self {
        Self(())
    }
}

/// Rays in vectors of sixteen.
impl RayVectors for Sixteen {
    type Rays = Self;

    #[inline(always)]
    fn rays(X86(sixteen): X86<Self>) -> Self {
        sixteen
    }

    #[inline(always)]
    fn part(x: F32x16, part: usize) -> F32x8 {
        // SAFETY: values of this type exist only where AVX-512 does.
        F32x8(unsafe {
            if part == 0 { _mm512_castps512_ps256(x.0) } else { _mm512_extractf32x8_ps::<1>(x.0) }
        })
    }

    #[inline(always)]
    fn columns(_: X86<Self>, rows: &[[f32; LANES]; MOST]) -> [F32x16; LANES] {
        /// Half of every fourth row from number `i` on.
        macro_rules! every_fourth {
            ($half:expr, $i:expr) => {{
                let all = _mm512_castps128_ps512(_mm_loadu_ps(rows[$i].as_ptr().add(4 * $half)));
                let row = _mm_loadu_ps(rows[$i + 4].as_ptr().add(4 * $half));
                let all = _mm512_insertf32x4::<1>(all, row);
                let row = _mm_loadu_ps(rows[$i + 8].as_ptr().add(4 * $half));
                let all = _mm512_insertf32x4::<2>(all, row);
                let row = _mm_loadu_ps(rows[$i + 12].as_ptr().add(4 * $half));
                _mm512_insertf32x4::<3>(all, row)
            }};
        }
        /// Four columns.
        macro_rules! four {
            ($half:expr) => {{
                let [a, b] = [every_fourth!($half, 0), every_fourth!($half, 1)];
                let [c, d] = [every_fourth!($half, 2), every_fourth!($half, 3)];
                let [ab, cd] = [_mm512_unpacklo_ps(a, b), _mm512_unpacklo_ps(c, d)];
                let [ab2, cd2] = [_mm512_unpackhi_ps(a, b), _mm512_unpackhi_ps(c, d)];
                [
                    F32x16(_mm512_shuffle_ps::<0x44>(ab, cd)),
                    F32x16(_mm512_shuffle_ps::<0xee>(ab, cd)),
                    F32x16(_mm512_shuffle_ps::<0x44>(ab2, cd2)),
                    F32x16(_mm512_shuffle_ps::<0xee>(ab2, cd2)),
                ]
            }};
        }
        // SAFETY: the first argument proves AVX-512; halves of rows have the four numbers that are read, unaligned.
        let ([a, b, c, d], [e, f, g, h]) = unsafe { (four!(0), four!(1)) };
        [a, b, c, d, e, f, g, h]
    }
}

impl Vectors for Sixteen {
    const ZERO: Self::Row = [0.0; 16];

    type Row = [f32; 16];
    type F = F32x16;
    type M = Mask16;
    type D = F64x8;

    #[inline(always)]
    fn splat(self, x: f32) -> F32x16 {
        // SAFETY: `self` proves AVX-512.
        F32x16(unsafe { _mm512_set1_ps(x) })
    }

    #[inline(always)]
    fn splat_f64(self, x: f64) -> F64x8 {
        // SAFETY: `self` proves AVX-512.
        F64x8(unsafe { _mm512_set1_pd(x) })
    }

    #[inline(always)]
    fn load(self, x: &[f32; 16]) -> F32x16 {
        // SAFETY: `self` proves AVX-512; the reference covers the 64 bytes that are read, unaligned.
        F32x16(unsafe { _mm512_loadu_ps(x.as_ptr()) })
    }

    #[inline(always)]
    fn mask(self, bits: u32) -> Mask16 {
        Mask16(bits as __mmask16)
    }
}

/// Implements a binary operator by an intrinsic.
macro_rules! operator {
    ($type:ident, $trait:ident, $method:ident, $intrinsic:ident) => {
        impl $trait for $type {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                // SAFETY: values of this type exist only where AVX-512 does.
                Self(unsafe { $intrinsic(self.0, other.0) })
            }
        }
    };
}

operator!(F32x16, Add, add, _mm512_add_ps);
operator!(F32x16, Sub, sub, _mm512_sub_ps);
operator!(F32x16, Mul, mul, _mm512_mul_ps);
operator!(F32x16, Div, div, _mm512_div_ps);
operator!(F64x8, Add, add, _mm512_add_pd);
operator!(F64x8, Sub, sub, _mm512_sub_pd);
operator!(F64x8, Mul, mul, _mm512_mul_pd);
operator!(F64x8, Div, div, _mm512_div_pd);

impl Doubles for F64x8 {}

impl Lanes for F32x16 {
    type Row = [f32; 16];
    type Mask = Mask16;
    type D = F64x8;

    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        // SAFETY: values of this type exist only where AVX-512 does.
        Self(unsafe { _mm512_fmadd_ps(self.0, a.0, b.0) })
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        // SAFETY: values of this type exist only where AVX-512 does.
        Self(unsafe { _mm512_min_ps(self.0, other.0) })
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        // SAFETY: values of this type exist only where AVX-512 does.
        Self(unsafe { _mm512_max_ps(self.0, other.0) })
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: values of this type exist only where AVX-512 does.
        Self(unsafe { _mm512_sqrt_ps(self.0) })
    }

    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: values of this type exist only where AVX-512 does.
        Self(unsafe { _mm512_abs_ps(self.0) })
    }

    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        // SAFETY: values of this type exist only where AVX-512 does.
        Self(unsafe {
            let sign = _mm512_and_ps(_mm512_set1_ps(-0.0), sign.0);
            _mm512_or_ps(_mm512_abs_ps(self.0), sign)
        })
    }

    #[inline(always)]
    fn select(self, mask: Mask16, other: Self) -> Self {
        // SAFETY: values of this type exist only where AVX-512 does.
        Self(unsafe { _mm512_mask_blend_ps(mask.0, other.0, self.0) })
    }

    #[inline(always)]
    fn le(self, other: Self) -> Mask16 {
        // SAFETY: values of this type exist only where AVX-512 does.
        Mask16(unsafe { _mm512_cmp_ps_mask::<_CMP_LE_OQ>(self.0, other.0) })
    }

    #[inline(always)]
    fn lt(self, other: Self) -> Mask16 {
        // SAFETY: values of this type exist only where AVX-512 does.
        Mask16(unsafe { _mm512_cmp_ps_mask::<_CMP_LT_OQ>(self.0, other.0) })
    }

    #[inline(always)]
    fn ne(self, other: Self) -> Mask16 {
        // SAFETY: values of this type exist only where AVX-512 does.
        Mask16(unsafe { _mm512_cmp_ps_mask::<_CMP_NEQ_UQ>(self.0, other.0) })
    }

    #[inline(always)]
    fn signs(self) -> u32 {
        // SAFETY: values of this type exist only where AVX-512 does.
        u32::from(unsafe { _mm512_movepi32_mask(_mm512_castps_si512(self.0)) })
    }

    #[inline(always)]
    fn smallest(self) -> f32 {
        let [lo, hi] = [Sixteen::part(self, 0), Sixteen::part(self, 1)];
        lo.min(hi).smallest()
    }

    #[inline(always)]
    fn largest(self) -> f32 {
        let [lo, hi] = [Sixteen::part(self, 0), Sixteen::part(self, 1)];
        lo.max(hi).largest()
    }

    #[inline(always)]
    fn to_doubles(self) -> [F64x8; 2] {
        let [lo, hi] = [Sixteen::part(self, 0), Sixteen::part(self, 1)];
        // SAFETY: values of this type exist only where AVX-512 does.
        unsafe { [F64x8(_mm512_cvtps_pd(lo.0)), F64x8(_mm512_cvtps_pd(hi.0))] }
    }

    #[inline(always)]
    fn from_doubles([lo, hi]: [F64x8; 2]) -> Self {
        // SAFETY: values of this type exist only where AVX-512 does.
        Self(unsafe {
            let [lo, hi] = [_mm512_cvtpd_ps(lo.0), _mm512_cvtpd_ps(hi.0)];
            _mm512_insertf32x8::<1>(_mm512_castps256_ps512(lo), hi)
        })
    }

    #[inline(always)]
    fn to_array(self) -> [f32; 16] {
        let mut array = [0.0; 16];
        // SAFETY: the array has the 64 bytes that are written, unaligned.
        unsafe { _mm512_storeu_ps(array.as_mut_ptr(), self.0) };
        array
    }
}

impl BitAnd for Mask16 {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

impl BitOr for Mask16 {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl Mask for Mask16 {
    #[inline(always)]
    fn bits(self) -> u32 {
        self.0.into()
    }
}
