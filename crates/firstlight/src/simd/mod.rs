//! Eight floats at a time, and for rays sixteen where the processor has such registers: the vocabulary kernels are written
//! in, and the only place with `unsafe`.
//!
//! A kernel is a [`Kernel`], generic over [`Simd`]; [`Level::run`] compiles it once per level and picks the
//! best one that the processor has. Operations round like the scalar ones, lane by lane, at every level;
//! only [`Lanes::mul_add`] may round once or twice.

#[cfg(target_arch = "x86_64")]
mod avx512;
mod level;
mod pages;
mod portable;
#[cfg(target_arch = "x86_64")]
mod x86;

pub(crate) use level::Kernel;
pub use level::Level;
pub(crate) use pages::Pages;

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Sub};

/// Number of lanes of [`Simd`]'s vectors: a node's boxes, a leaf's triangles.
pub(crate) const LANES: usize = 8;

/// The most lanes of [`Simd::Rays`]' vectors.
pub(crate) const MOST: usize = 2 * LANES;

/// Instructions for vectors of so many floats. Holding a value proves that the processor has them.
pub(crate) trait Vectors: Copy {
    /// The number of lanes, a multiple of [`LANES`].
    const COUNT: usize = size_of::<Self::Row>() / size_of::<f32>();
    /// A vector in memory: zeros.
    const ZERO: Self::Row;

    /// A vector in memory.
    type Row: Copy + AsRef<[f32]> + AsMut<[f32]>;
    /// A vector.
    type F: Lanes<Row = Self::Row, D = Self::D, Mask = Self::M>;
    /// Truth values.
    type M: Mask;
    /// Half as many doubles.
    type D: Doubles;

    /// The same number in every lane.
    fn splat(self, x: f32) -> Self::F;

    /// The same number in every lane.
    fn splat_f64(self, x: f64) -> Self::D;

    /// Numbers from memory.
    fn load(self, x: &Self::Row) -> Self::F;

    /// Bit `i` as lane `i`.
    fn mask(self, bits: u32) -> Self::M;
}

/// A level's instructions: vectors of eight, and what rays are put into that go together.
pub(crate) trait Simd: Vectors<Row = [f32; LANES], F: Eight> {
    /// Whether lanes are permuted by one instruction.
    const PERMUTES: bool;

    /// Vectors for rays.
    type Rays: Vectors;

    /// Instructions for them.
    fn rays(self) -> Self::Rays;

    /// The lanes of rays from number `LANES · part` on.
    fn part(self, x: <Self::Rays as Vectors>::F, part: usize) -> Self::F;

    /// The columns of rows, one for each lane of rays; the others mean nothing.
    fn columns(self, rows: &[[f32; LANES]; MOST]) -> [<Self::Rays as Vectors>::F; LANES];

    /// Asks for the cache lines of what is needed soon. The address need not be one of anything.
    fn prefetch<T>(self, x: *const T);

    /// Word `i` becomes word `indices[i]`, all below eight.
    fn permute_words(self, words: &[u32; LANES], indices: &[u8; LANES]) -> [u32; LANES];

    /// Rows become columns.
    fn transpose(self, rows: [Self::F; LANES]) -> [Self::F; LANES];
}

/// Some floats.
pub(crate) trait Lanes:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// The same in memory.
    type Row;
    /// As many truth values.
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
    /// The smallest lane.
    fn smallest(self) -> f32;
    /// The largest lane.
    fn largest(self) -> f32;
    /// The lower and the upper half in double precision.
    fn to_doubles(self) -> [Self::D; 2];
    /// Both halves, rounded.
    fn from_doubles(halves: [Self::D; 2]) -> Self;
    /// The lanes as an array.
    fn to_array(self) -> Self::Row;
}

/// Eight floats.
pub(crate) trait Eight: Lanes {
    /// Lane `i` becomes lane `indices[i]`, all below eight.
    fn permute(self, indices: &[u8; LANES]) -> Self;
}

/// Half as many doubles.
pub(crate) trait Doubles:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
}

/// Truth values.
pub(crate) trait Mask: Copy + BitAnd<Output = Self> + BitOr<Output = Self> {
    /// Lane `i` as bit `i`.
    fn bits(self) -> u32;
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers for vectors of any length.
    type Numbers = [f32; MOST];

    const PLACES: [u8; LANES] = [7, 0, 3, 3, 1, 6, 2, 5];
    const A: Numbers =
        [1.0, -2.5, 3.25e7, 0.1, 0.0, -1e-20, 7.0, 1e30, 5.0, -0.3, 2e-9, 8.0, 9.5, 0.7, -6.0, 3.0];
    const B: Numbers =
        [3.0, -2.5, 1.5e-3, 0.3, 2.0, 1e20, -7.0, 1e-9, 5.0, 0.3, -2e-9, 4.0, 1.5, -7.0, 6.0, 0.1];
    const CHOSEN: u32 = 0b0110_0101_1010_0110;

    /// What vectors compute: numbers lane by lane, truth values, the smallest and the largest.
    struct Computed {
        numbers: Vec<Vec<f32>>,
        masks: [u32; 6],
        ends: [f32; 2],
    }

    #[inline(always)]
    fn load<V: Vectors>(simd: V, numbers: &Numbers) -> V::F {
        let mut row = V::ZERO;
        row.as_mut().copy_from_slice(&numbers[..V::COUNT]);
        simd.load(&row)
    }

    #[inline(always)]
    fn compute<V: Vectors>(simd: V) -> Computed {
        let (a, b) = (load(simd, &A), load(simd, &B));
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
            simd.splat(A[0]).copysign(b),
            a.abs(),
            a.abs().sqrt(),
            V::F::from_doubles(doubles),
            a.select(simd.mask(CHOSEN), b),
        ];
        let (le, lt, ne) = (a.le(b), a.lt(b), a.ne(b));
        Computed {
            numbers: numbers.map(|x| x.to_array().as_ref().to_vec()).to_vec(),
            masks: [le.bits(), ne.bits(), (le & ne).bits(), (le | ne).bits(), lt.bits(), a.signs()],
            ends: [a.smallest(), a.largest()],
        }
    }

    fn check(computed: &Computed, level: Level) {
        let count = computed.numbers[0].len();
        for i in 0..count {
            let (x, y) = (A[i], B[i]);
            let (dx, dy) = (f64::from(x), f64::from(y));
            let expected = [
                x + y,
                x - y,
                x * y,
                x / y,
                x.min(y),
                x.max(y),
                A[0].copysign(y),
                x.abs(),
                x.abs().sqrt(),
                ((dx * dy + 3.0) / dy - dx) as f32,
                if CHOSEN >> i & 1 == 1 { x } else { y },
            ];
            let numbers: Vec<_> = computed.numbers.iter().map(|numbers| numbers[i]).collect();
            assert_eq!(numbers, expected, "{level:?} lane {i} of {count}");
            let bits = [x <= y, x != y, x < y, x <= y || x > y, x < y, x < 0.0];
            let masks = computed.masks.map(|mask| mask >> i & 1 == 1);
            assert_eq!(masks, bits, "{level:?} lane {i} of {count}");
        }
        assert!(computed.masks.iter().all(|mask| mask >> count == 0), "{level:?}");
        let first = &A[..count];
        let smallest = first.iter().copied().fold(f32::INFINITY, f32::min);
        assert_eq!(computed.ends, [smallest, 1e30], "{level:?}");
    }

    struct Arithmetic;

    impl Kernel for Arithmetic {
        type Output = [Computed; 2];

        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> Self::Output {
            [compute(simd), compute(simd.rays())]
        }
    }

    #[test]
    fn every_level_computes_what_scalar_arithmetic_does() {
        for level in Level::all() {
            level.run(Arithmetic).iter().for_each(|computed| check(computed, level));
        }
    }

    /// Row `i` is 100 i and what follows.
    fn rows() -> [[f32; LANES]; MOST] {
        std::array::from_fn(|i| std::array::from_fn(|j| (100 * i + j) as f32))
    }

    /// What moves lanes: permuted, as words, transposed, columns, parts of them.
    struct Moves;

    impl Kernel for Moves {
        type Output = ([f32; LANES], [u32; LANES], Vec<Vec<f32>>, Vec<Vec<f32>>, Vec<Vec<f32>>);

        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> Self::Output {
            let (a, rows) = (load(simd, &A), rows());
            let mut eight = [a; LANES];
            for (vector, row) in eight.iter_mut().zip(&rows) {
                *vector = simd.load(row);
            }
            let columns = simd.columns(&rows);
            let last = <S::Rays as Vectors>::COUNT / LANES - 1;
            (
                a.permute(&PLACES).to_array(),
                simd.permute_words(&std::array::from_fn(|i| A[i].to_bits()), &PLACES),
                simd.transpose(eight).map(|x| x.to_array().to_vec()).to_vec(),
                columns.map(|x| x.to_array().as_ref().to_vec()).to_vec(),
                columns.map(|x| simd.part(x, last).to_array().to_vec()).to_vec(),
            )
        }
    }

    #[test]
    fn every_level_moves_lanes_to_the_same_places() {
        for level in Level::all() {
            let (permuted, words, transposed, columns, parts) = level.run(Moves);
            let expected = PLACES.map(|i| A[usize::from(i)]);
            assert_eq!(permuted, expected, "{level:?}");
            assert_eq!(words, expected.map(f32::to_bits), "{level:?}");
            let column =
                |rows: &[[f32; LANES]], j| rows.iter().map(|row| row[j]).collect::<Vec<_>>();
            let (rows, count) = (rows(), columns[0].len());
            for j in 0..LANES {
                assert_eq!(transposed[j], column(&rows[..LANES], j), "{level:?}");
                assert_eq!(columns[j], column(&rows[..count], j), "{level:?}");
                assert_eq!(parts[j], column(&rows[count - LANES..count], j), "{level:?}");
            }
        }
    }
}
