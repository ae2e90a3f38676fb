//! Sums that do not depend on the order of what is added, nor on how it was grouped before.
//!
//! Every number is split at fixed places of the binary scale into bins that are added as integers, without
//! carrying. Only the two highest bins in use are kept; what falls below them is dropped, whenever it comes. So
//! the bins are a function of the set of numbers alone (Demmel & Nguyen, *Fast Reproducible Floating-Point Summation*,
//! 2013), and what is dropped is less than 2⁻³⁸ of the largest number, each time.

/// Bits of one bin. With 2²⁴ samples at most, its sum stays below 2⁶³.
const BIN: u32 = 38;
/// The exponent of the lowest bit that an `f32` can have.
const LOWEST: i32 = -149;

/// The sums of `N` series of numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct ExactSums<const N: usize> {
    /// Of each series, the sums of its two highest bins, the higher one first.
    pub bins: [[i64; 2]; N],
    /// The number of the higher bin, counted from the lowest bit.
    pub tops: [u8; N],
}

impl<const N: usize> Default for ExactSums<N> {
    fn default() -> Self {
        Self { bins: [[0; 2]; N], tops: [0; N] }
    }
}

impl<const N: usize> ExactSums<N> {
    /// Adds one number to each series: those of `split` from number `first` on.
    #[inline(always)]
    pub(crate) fn add<const M: usize>(&mut self, split: &Split<M>, first: usize) {
        for series in 0..N {
            let bins = [split.high[first + series], split.low[first + series]];
            self.absorb(series, split.tops[first + series], bins);
        }
    }

    /// Adds the sums of other numbers.
    pub(crate) fn merge(&mut self, other: &Self) {
        for series in 0..N {
            self.absorb(series, other.tops[series], other.bins[series]);
        }
    }

    /// Nothing here branches: which of the two is higher cannot be foreseen.
    #[inline(always)]
    fn absorb(&mut self, series: usize, top: u8, bins: [i64; 2]) {
        let own = self.tops[series];
        let level = own.max(top);
        let [high, low] = lowered(bins, level - top);
        let [own_high, own_low] = lowered(self.bins[series], level - own);
        self.bins[series] = [own_high.wrapping_add(high), own_low.wrapping_add(low)];
        self.tops[series] = level;
    }

    /// The sums, rounded.
    pub(crate) fn values(&self) -> [f64; N] {
        std::array::from_fn(|series| {
            let [high, low] = self.bins[series].map(|bin| bin as f64);
            let unit = LOWEST + BIN as i32 * (i32::from(self.tops[series]) - 1);
            (high * power_of_two(BIN as i32) + low) * power_of_two(unit)
        })
    }
}

/// What there is in a bin and the one below, as seen from so many bins higher.
#[inline(always)]
fn lowered([high, low]: [i64; 2], by: u8) -> [i64; 2] {
    let only = |x: i64, at: u8| if by == at { x } else { 0 };
    [only(high, 0), only(low, 0) + only(high, 1)]
}

/// `M` numbers, each with its parts in the bin of its highest bit and in the one below.
pub(crate) struct Split<const M: usize> {
    high: [i64; M],
    low: [i64; M],
    tops: [u8; M],
}

impl<const M: usize> Split<M> {
    /// Splits numbers; of those that are not finite nothing sensible comes out.
    #[inline(always)]
    pub(crate) fn of(values: &[f32; M]) -> Self {
        let mut split = Self { high: [0; M], low: [0; M], tops: [0; M] };
        for (i, &value) in values.iter().enumerate() {
            (split.tops[i], split.high[i], split.low[i]) = split_one(value);
        }
        split
    }
}

/// A bin and a number's parts in it and the one below. A number and its negative are split alike, so that they cancel.
#[inline(always)]
fn split_one(value: f32) -> (u8, i64, i64) {
    // The value is ± a whole number below 2²⁴ · 2^(shift − 149), so that all that follows is exact.
    let shift = (value.to_bits() >> 23 & 0xff).max(1) - 1;
    let top = (shift + 23) / BIN;
    let unit = (1023 - LOWEST) as u32 - BIN * top;
    let in_bins = f64::from(value) * f64::from_bits(u64::from(unit) << 52);
    let high = nearest(in_bins);
    (top as u8, whole(high), whole(nearest((in_bins - (high - WHOLE)) * (1_u64 << BIN) as f64)))
}

/// Doubles of this size have no bits below 1.
const WHOLE: f64 = 1.5 * (1_u64 << 52) as f64;

/// The nearest whole number to one below 2⁵¹, plus [`WHOLE`].
#[inline(always)]
fn nearest(x: f64) -> f64 {
    x + WHOLE
}

/// A whole number that [`WHOLE`] was added to.
#[inline(always)]
fn whole(x: f64) -> i64 {
    x.to_bits().wrapping_sub(WHOLE.to_bits()) as i64
}

/// 2^`exponent` for the exponents of normal numbers.
fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((1023 + exponent) as u64) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;

    fn sum_of(values: &[f32]) -> ExactSums<1> {
        let mut sums = ExactSums::default();
        values.iter().for_each(|value| sums.add(&Split::of(&[*value]), 0));
        sums
    }

    #[test]
    fn single_numbers_keep_every_bit() {
        let mut random = Random::new(3);
        let any = (0..100_000).map(|_| f32::from_bits(random.below(1 << 32) as u32));
        let special = [0.0, 1.0, -1.0, f32::MAX, f32::MIN_POSITIVE, f32::from_bits(1)];
        for value in any.chain(special).filter(|value| value.is_finite()) {
            assert_eq!(sum_of(&[value]).values()[0], f64::from(value), "{value:e}");
            assert_eq!(sum_of(&[value, -value]).values()[0], 0.0, "{value:e}");
        }
    }

    /// Numbers of all sizes, in any order and any grouping.
    #[test]
    fn order_and_grouping_change_no_bit() {
        let mut random = Random::new(4);
        for round in 0..200 {
            let wide = f64::from(round % 10) * 8.0;
            let mut value = || {
                let size = 2_f64.powf(wide * (random.unit() - 0.5));
                ((random.unit() - 0.3) * size) as f32
            };
            let mut values: Vec<f32> = (0..100).map(|_| value()).collect();
            let expected = sum_of(&values);
            for _ in 0..5 {
                for i in (1..values.len()).rev() {
                    values.swap(i, random.below(i + 1));
                }
                let mut merged = ExactSums::default();
                let mut rest = &values[..];
                while !rest.is_empty() {
                    let (part, after) = rest.split_at(1 + random.below(rest.len()));
                    merged.merge(&sum_of(part));
                    rest = after;
                }
                assert_eq!((sum_of(&values), merged), (expected, expected));
            }
        }
    }

    /// Whichever comes first.
    #[test]
    fn numbers_a_bin_apart_keep_their_digits() {
        for values in [[16.0, 0.001], [0.001, 16.0]] {
            let exact = f64::from(values[0]) + f64::from(values[1]);
            assert!((sum_of(&values).values()[0] - exact).abs() < 2_f64.powi(-34), "{values:?}");
        }
    }

    #[test]
    fn sums_are_as_good_as_those_of_doubles() {
        let mut random = Random::new(5);
        let values: Vec<f32> = (0..1 << 16).map(|_| random.unit().powi(20) as f32).collect();
        let doubles: f64 = values.iter().map(|value| f64::from(*value)).sum();
        assert!((sum_of(&values).values()[0] / doubles - 1.0).abs() < 1e-10);
    }
}
