//! AVX2 with FMA: eight floats at a time.

#![allow(unsafe_code)]

use super::{Doubles, Eight, LANES, Lanes, MOST, Mask, Simd, Vectors};
use std::arch::x86_64::*;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Sub};

/// Proof that the processor has AVX2 and FMA, and what its vectors for rays need.
#[derive(Clone, Copy)]
pub(crate) struct X86<R>(pub(super) R);

/// AVX2 and nothing more.
pub(crate) type Avx2 = X86<()>;

/// Vectors for rays.
pub(crate) trait RayVectors: Copy {
    /// Instructions for them.
    type Rays: Vectors;
    /// See [`Simd::rays`].
    fn rays(eight: X86<Self>) -> Self::Rays;
    /// See [`Simd::part`].
    fn part(x: <Self::Rays as Vectors>::F, part: usize) -> F32x8;
    /// See [`Simd::columns`].
    fn columns(
        eight: X86<Self>,
        rows: &[[f32; LANES]; MOST],
    ) -> [<Self::Rays as Vectors>::F; LANES];
}

/// Rays in vectors of eight.
impl RayVectors for () {
    type Rays = Avx2;

    #[inline(always)]
    fn rays(eight: Avx2) -> Avx2 {
        eight
    }

    #[inline(always)]
    fn part(x: F32x8, _: usize) -> F32x8 {
        x
    }

    #[inline(always)]
    fn columns(_: Avx2, rows: &[[f32; LANES]; MOST]) -> [F32x8; LANES] {
        /// Half of rows `i` and `i + 4`.
        macro_rules! two {
            ($half:expr, $i:expr) => {{
                let [lo, hi] = [&rows[$i], &rows[$i + 4]].map(|row| row.as_ptr().add(4 * $half));
                _mm256_insertf128_ps::<1>(
                    _mm256_castps128_ps256(_mm_loadu_ps(lo)),
                    _mm_loadu_ps(hi),
                )
            }};
        }
        /// Four columns.
        macro_rules! four {
            ($half:expr) => {{
                let [a, b] = [two!($half, 0), two!($half, 1)];
                let [c, d] = [two!($half, 2), two!($half, 3)];
                let [ab, cd] = [_mm256_unpacklo_ps(a, b), _mm256_unpacklo_ps(c, d)];
                let [ab2, cd2] = [_mm256_unpackhi_ps(a, b), _mm256_unpackhi_ps(c, d)];
                [
                    F32x8(_mm256_shuffle_ps::<0x44>(ab, cd)),
                    F32x8(_mm256_shuffle_ps::<0xee>(ab, cd)),
                    F32x8(_mm256_shuffle_ps::<0x44>(ab2, cd2)),
                    F32x8(_mm256_shuffle_ps::<0xee>(ab2, cd2)),
                ]
            }};
        }
        // SAFETY: the first argument proves AVX2; halves of rows have the four numbers that are read, unaligned.
        let ([a, b, c, d], [e, f, g, h]) = unsafe { (four!(0), four!(1)) };
        [a, b, c, d, e, f, g, h]
    }
}

/// Eight floats in a register; exists only where an [`Avx2`] does.
#[derive(Clone, Copy)]
pub(crate) struct F32x8(pub(super) __m256);

/// Four doubles in a register; exists only where an [`Avx2`] does.
#[derive(Clone, Copy)]
pub(crate) struct F64x4(__m256d);

/// Eight truth values, each a lane of ones or zeros.
#[derive(Clone, Copy)]
pub(crate) struct Mask8(__m256);

impl<R> X86<R> {
    /// The proof; callable only where the features are enabled.
    #[target_feature(enable = "avx2,fma")]
    pub(super) fn detected(rays: R) -> Self {
        Self(rays)
    }
}

impl<R: Copy> Vectors for X86<R> {
    const ZERO: Self::Row = [0.0; LANES];

    type Row = [f32; LANES];
    type F = F32x8;
    type M = Mask8;
    type D = F64x4;

    #[inline(always)]
    fn splat(self, x: f32) -> F32x8 {
        // SAFETY: `self` proves AVX2.
        F32x8(unsafe { _mm256_set1_ps(x) })
    }

    #[inline(always)]
    fn splat_f64(self, x: f64) -> F64x4 {
        // SAFETY: `self` proves AVX2.
        F64x4(unsafe { _mm256_set1_pd(x) })
    }

    #[inline(always)]
    fn load(self, x: &[f32; LANES]) -> F32x8 {
        // SAFETY: `self` proves AVX2; the reference covers the 32 bytes that are read, unaligned.
        F32x8(unsafe { _mm256_loadu_ps(x.as_ptr()) })
    }

    #[inline(always)]
    fn mask(self, bits: u32) -> Mask8 {
        // SAFETY: `self` proves AVX2.
        Mask8(unsafe {
            let bit = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
            let set = _mm256_and_si256(_mm256_set1_epi32(bits as i32), bit);
            _mm256_castsi256_ps(_mm256_cmpeq_epi32(set, bit))
        })
    }
}

impl<R: RayVectors> Simd for X86<R> {
    const PERMUTES: bool = true;

    type Rays = R::Rays;

    #[inline(always)]
    fn rays(self) -> R::Rays {
        R::rays(self)
    }

    #[inline(always)]
    fn part(self, x: <R::Rays as Vectors>::F, part: usize) -> F32x8 {
        R::part(x, part)
    }

    #[inline(always)]
    fn columns(self, rows: &[[f32; LANES]; MOST]) -> [<R::Rays as Vectors>::F; LANES] {
        R::columns(self, rows)
    }

    #[inline(always)]
    fn prefetch<T>(self, x: *const T) {
        const LINE: usize = 64;
        for line in 0..size_of::<T>().div_ceil(LINE) {
            let address = x.cast::<i8>().wrapping_add(LINE * line);
            // SAFETY: a prefetch is a hint for any address; it reads nothing that the program sees and cannot fail.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(address) };
        }
    }

    #[inline(always)]
    fn permute_words(self, words: &[u32; LANES], indices: &[u8; LANES]) -> [u32; LANES] {
        let mut permuted = [0; LANES];
        // SAFETY: `self` proves AVX2; the arrays have the bytes that are read and written, unaligned.
        unsafe {
            let indices = _mm256_cvtepu8_epi32(_mm_loadl_epi64(indices.as_ptr().cast()));
            let words = _mm256_loadu_si256(words.as_ptr().cast());
            let words = _mm256_permutevar8x32_epi32(words, indices);
            _mm256_storeu_si256(permuted.as_mut_ptr().cast(), words);
        }
        permuted
    }

    #[inline(always)]
    fn transpose(self, rows: [F32x8; LANES]) -> [F32x8; LANES] {
        let [a, b, c, d, e, f, g, h] = rows;
        // SAFETY: `self` proves AVX2.
        unsafe {
            let [ab, cd] = [_mm256_unpacklo_ps(a.0, b.0), _mm256_unpacklo_ps(c.0, d.0)];
            let [ef, gh] = [_mm256_unpacklo_ps(e.0, f.0), _mm256_unpacklo_ps(g.0, h.0)];
            let [ab2, cd2] = [_mm256_unpackhi_ps(a.0, b.0), _mm256_unpackhi_ps(c.0, d.0)];
            let [ef2, gh2] = [_mm256_unpackhi_ps(e.0, f.0), _mm256_unpackhi_ps(g.0, h.0)];
            let quarters = [
                (_mm256_shuffle_ps::<0x44>(ab, cd), _mm256_shuffle_ps::<0x44>(ef, gh)),
                (_mm256_shuffle_ps::<0xee>(ab, cd), _mm256_shuffle_ps::<0xee>(ef, gh)),
                (_mm256_shuffle_ps::<0x44>(ab2, cd2), _mm256_shuffle_ps::<0x44>(ef2, gh2)),
                (_mm256_shuffle_ps::<0xee>(ab2, cd2), _mm256_shuffle_ps::<0xee>(ef2, gh2)),
            ];
            let [p, q, r, s] = quarters;
            [
                F32x8(_mm256_permute2f128_ps::<0x20>(p.0, p.1)),
                F32x8(_mm256_permute2f128_ps::<0x20>(q.0, q.1)),
                F32x8(_mm256_permute2f128_ps::<0x20>(r.0, r.1)),
                F32x8(_mm256_permute2f128_ps::<0x20>(s.0, s.1)),
                F32x8(_mm256_permute2f128_ps::<0x31>(p.0, p.1)),
                F32x8(_mm256_permute2f128_ps::<0x31>(q.0, q.1)),
                F32x8(_mm256_permute2f128_ps::<0x31>(r.0, r.1)),
                F32x8(_mm256_permute2f128_ps::<0x31>(s.0, s.1)),
            ]
        }
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
operator!(F32x8, Div, div, _mm256_div_ps);
operator!(F64x4, Add, add, _mm256_add_pd);
operator!(F64x4, Sub, sub, _mm256_sub_pd);
operator!(F64x4, Mul, mul, _mm256_mul_pd);
operator!(F64x4, Div, div, _mm256_div_pd);
operator!(Mask8, BitAnd, bitand, _mm256_and_ps);
operator!(Mask8, BitOr, bitor, _mm256_or_ps);

impl Doubles for F64x4 {}

impl Lanes for F32x8 {
    type Row = [f32; LANES];
    type Mask = Mask8;
    type D = F64x4;

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
    fn sqrt(self) -> Self {
        // SAFETY: values of this type exist only where AVX2 does.
        Self(unsafe { _mm256_sqrt_ps(self.0) })
    }

    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: values of this type exist only where AVX2 does.
        Self(unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0) })
    }

    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        // SAFETY: values of this type exist only where AVX2 does.
        Self(unsafe { _mm256_or_ps(self.abs().0, _mm256_and_ps(_mm256_set1_ps(-0.0), sign.0)) })
    }

    #[inline(always)]
    fn select(self, mask: Mask8, other: Self) -> Self {
        // SAFETY: values of this type exist only where AVX2 does.
        Self(unsafe { _mm256_blendv_ps(other.0, self.0, mask.0) })
    }

    #[inline(always)]
    fn le(self, other: Self) -> Mask8 {
        // SAFETY: values of this type exist only where AVX2 does.
        Mask8(unsafe { _mm256_cmp_ps::<_CMP_LE_OQ>(self.0, other.0) })
    }

    #[inline(always)]
    fn lt(self, other: Self) -> Mask8 {
        // SAFETY: values of this type exist only where AVX2 does.
        Mask8(unsafe { _mm256_cmp_ps::<_CMP_LT_OQ>(self.0, other.0) })
    }

    #[inline(always)]
    fn ne(self, other: Self) -> Mask8 {
        // SAFETY: values of this type exist only where AVX2 does.
        Mask8(unsafe { _mm256_cmp_ps::<_CMP_NEQ_UQ>(self.0, other.0) })
    }

    #[inline(always)]
    fn signs(self) -> u32 {
        Mask8(self.0).bits()
    }

    #[inline(always)]
    fn smallest(self) -> f32 {
        // SAFETY: values of this type exist only where AVX2 does.
        unsafe {
            let four =
                _mm_min_ps(_mm256_castps256_ps128(self.0), _mm256_extractf128_ps::<1>(self.0));
            let two = _mm_min_ps(four, _mm_movehl_ps(four, four));
            _mm_cvtss_f32(_mm_min_ss(two, _mm_movehdup_ps(two)))
        }
    }

    #[inline(always)]
    fn largest(self) -> f32 {
        // SAFETY: values of this type exist only where AVX2 does.
        unsafe {
            let four =
                _mm_max_ps(_mm256_castps256_ps128(self.0), _mm256_extractf128_ps::<1>(self.0));
            let two = _mm_max_ps(four, _mm_movehl_ps(four, four));
            _mm_cvtss_f32(_mm_max_ss(two, _mm_movehdup_ps(two)))
        }
    }

    #[inline(always)]
    fn to_doubles(self) -> [F64x4; 2] {
        // SAFETY: values of this type exist only where AVX2 does.
        unsafe {
            [
                F64x4(_mm256_cvtps_pd(_mm256_castps256_ps128(self.0))),
                F64x4(_mm256_cvtps_pd(_mm256_extractf128_ps::<1>(self.0))),
            ]
        }
    }

    #[inline(always)]
    fn from_doubles([lo, hi]: [F64x4; 2]) -> Self {
        // SAFETY: values of this type exist only where AVX2 does.
        Self(unsafe { _mm256_set_m128(_mm256_cvtpd_ps(hi.0), _mm256_cvtpd_ps(lo.0)) })
    }

    #[inline(always)]
    fn to_array(self) -> [f32; LANES] {
        let mut array = [0.0; LANES];
        // SAFETY: the array has the 32 bytes that are written, unaligned.
        unsafe { _mm256_storeu_ps(array.as_mut_ptr(), self.0) };
        array
    }
}

impl Eight for F32x8 {
    #[inline(always)]
    fn permute(self, indices: &[u8; LANES]) -> Self {
        // SAFETY: values of this type exist only where AVX2 does; the array has the eight bytes that are read.
        Self(unsafe {
            let indices = _mm256_cvtepu8_epi32(_mm_loadl_epi64(indices.as_ptr().cast()));
            _mm256_permutevar8x32_ps(self.0, indices)
        })
    }
}

impl Mask for Mask8 {
    #[inline(always)]
    fn bits(self) -> u32 {
        // SAFETY: values of this type exist only where AVX2 does.
        unsafe { _mm256_movemask_ps(self.0) as u32 }
    }
}
