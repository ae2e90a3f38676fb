//! Sums that do not depend on the order of what is added, nor on how it was grouped before.
//!
//! Every number is split at fixed places of the binary scale into bins that are added as integers, without rounding and
//! without carrying. Only the two highest bins in use are kept; what falls below them is dropped, whenever it comes. So
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
    /// Adds one finite number to each series.
    #[inline(always)]
    pub(crate) fn add(&mut self, values: [f32; N]) {
        for (series, value) in values.into_iter().enumerate() {
            let (top, bins) = split(value);
            self.absorb(series, top, bins);
        }
    }

    /// Adds the sums of other numbers.
    pub(crate) fn merge(&mut self, other: &Self) {
        for series in 0..N {
            self.absorb(series, other.tops[series], other.bins[series]);
        }
    }

    #[inline(always)]
    fn absorb(&mut self, series: usize, top: u8, [high, low]: [i64; 2]) {
        let (own, own_top) = (&mut self.bins[series], &mut self.tops[series]);
        match i32::from(top) - i32::from(*own_top) {
            0 => *own = [own[0].wrapping_add(high), own[1].wrapping_add(low)],
            -1 => own[1] = own[1].wrapping_add(high),
            ..-1 => {}
            above => {
                let kept = if above == 1 { own[0] } else { 0 };
                (*own, *own_top) = ([high, low.wrapping_add(kept)], top);
            }
        }
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

/// The bin of a number's highest bit, and its parts in that bin and the one below.
#[inline(always)]
fn split(value: f32) -> (u8, [i64; 2]) {
    let bits = value.to_bits();
    let exponent = bits >> 23 & 0xff;
    let hidden = u32::from(exponent > 0) << 23;
    let mantissa = i64::from(bits & 0x7f_ffff | hidden);
    if mantissa == 0 {
        return (0, [0; 2]);
    }
    // The value is ± mantissa · 2^(shift − 149). A number and its negative are split alike, so that they cancel.
    let shift = exponent.max(1) - 1;
    let top = (shift + 23) / BIN;
    let [high, low] = match shift.checked_sub(top * BIN) {
        Some(up) => [mantissa << up, 0],
        None => {
            let down = top * BIN - shift;
            [mantissa >> down, (mantissa & ((1 << down) - 1)) << (BIN - down)]
        }
    };
    (top as u8, if value.is_sign_negative() { [-high, -low] } else { [high, low] })
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
        values.iter().for_each(|value| sums.add([*value]));
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

    #[test]
    fn sums_are_as_good_as_those_of_doubles() {
        let mut random = Random::new(5);
        let values: Vec<f32> = (0..1 << 16).map(|_| random.unit().powi(20) as f32).collect();
        let doubles: f64 = values.iter().map(|value| f64::from(*value)).sum();
        assert!((sum_of(&values).values()[0] / doubles - 1.0).abs() < 1e-10);
    }
}
