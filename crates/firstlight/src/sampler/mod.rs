//! Owen-scrambled Sobol' points for every pixel, sample and dimension, spread over the picture as blue noise.
//!
//! All dimensions come in pairs, and each pair is the same two-dimensional Sobol' sequence in another order and with
//! other scrambles (Burley, *Practical Hash-based Owen Scrambling*, JCGT 9(4), 2020): two dimensions need no tables,
//! and pairs that know nothing of each other never fit badly. One sequence runs along the Morton curve through all
//! pixels, so that the samples of neighbours fill each other's gaps and their errors cancel (Ahmed & Wonka,
//! *Screen-Space Blue-Noise Diffusion of Monte Carlo Sampling Error via Hierarchical Ordering of Pixels*, 2020).

use crate::math::hash;
use crate::simd::{Kernel, Simd};
use glam::Vec2;

/// Where the samples of a picture are taken.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sampler {
    /// Its bits mixed.
    seed: u64,
    /// Each pixel has 2 to the power of this many points of the sequence.
    bits: u32,
}

/// The points of one sample of one pixel, in all dimensions.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PathPoints {
    /// Place in the sequence, with its bits reversed.
    reversed: u32,
    /// What tells sequences apart.
    sequence: u64,
}

impl Sampler {
    /// For so many samples per pixel, fewer than 2³². Samples beyond the next power of two belong to further sequences.
    pub(crate) fn new(seed: u64, samples: u32) -> Self {
        let bits = u32::BITS - samples.saturating_sub(1).leading_zeros();
        Self { seed: hash(seed), bits }
    }

    /// The sequence that all others are scrambled from. Its first coordinate is the radical inverse of the index.
    pub(crate) fn unscrambled(index: u32) -> Vec2 {
        Vec2::new(unit(index.reverse_bits()), unit(pascal(index).reverse_bits()))
    }

    /// The points of sample number `index` of the pixel in column `x`, row `y`, each below 2¹⁶.
    #[inline(always)]
    pub(crate) fn points(&self, x: u32, y: u32, index: u32) -> PathPoints {
        let (round, index) = (u64::from(index) >> self.bits, u64::from(index));
        let place = morton(x, y) << self.bits | (index & ((1 << self.bits) - 1));
        let sequence = hash(self.seed ^ place >> 32 ^ round << 32);
        PathPoints { reversed: (place as u32).reverse_bits(), sequence }
    }
}

impl PathPoints {
    /// The point of a pair of dimensions, each coordinate in 0..1. Pairs with different numbers are independent.
    #[inline(always)]
    pub(crate) fn pair(&self, number: u32) -> Vec2 {
        Coins::new(self.sequence, number).point(self.reversed)
    }

    /// One of `2^bits` parts of the sample, for a decision that is made so many times. The parts of all samples of a pixel,
    /// and of its neighbours, fill each other's gaps as samples do.
    #[inline(always)]
    pub(crate) fn part(&self, number: u32, bits: u32) -> Self {
        let left_out = self.reversed & ((1 << bits) - 1);
        Self {
            reversed: self.reversed >> bits | number.reverse_bits(),
            sequence: self.sequence ^ u64::from(left_out) << 32,
        }
    }
}

/// The same pair of dimensions of many paths, as [`PathPoints::pair`]; replaces what is in `pairs`.
///
/// Paths of one sequence share their coins, and what is left is done for several at a time.
pub(crate) struct Pairs<'a> {
    /// The paths.
    pub paths: &'a [PathPoints],
    /// The number of the pair.
    pub number: u32,
    /// The points, one for each path.
    pub pairs: &'a mut Vec<Vec2>,
}

impl Kernel for Pairs<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        let Self { paths, number, pairs } = self;
        pairs.resize(paths.len(), Vec2::ZERO);
        let mut rest = pairs.as_mut_slice();
        for paths in paths.chunk_by(|a, b| a.sequence == b.sequence) {
            let coins = Coins::new(paths[0].sequence, number);
            let (own, others) = rest.split_at_mut(paths.len());
            for (pair, path) in own.iter_mut().zip(paths) {
                *pair = coins.point(path.reversed);
            }
            rest = others;
        }
    }
}

/// What a sequence's pair of dimensions is scrambled by.
#[derive(Clone, Copy)]
struct Coins {
    order: u32,
    x: u32,
    y: u32,
}

impl Coins {
    #[inline(always)]
    fn new(sequence: u64, number: u32) -> Self {
        let first = hash(sequence ^ u64::from(number));
        let order = (first.wrapping_mul(0xd6e8_feb8_6659_fd93) >> 32) as u32;
        Self { order, x: first as u32, y: (first >> 32) as u32 }
    }

    /// The point at a place in the sequence with its bits reversed.
    #[inline(always)]
    fn point(self, reversed: u32) -> Vec2 {
        let index = scramble(reversed, self.order).reverse_bits();
        let (x, y) = (scramble(index, self.x), scramble(pascal(index), self.y));
        Vec2::new(unit(x.reverse_bits()), unit(y.reverse_bits()))
    }
}

/// The bits of two 16-bit numbers in turn, those of `x` lower: the place of a pixel along the Morton curve.
#[inline(always)]
fn morton(x: u32, y: u32) -> u64 {
    u64::from(spread(x) | spread(y) << 1)
}

/// Moves the lower 16 bits apart, one place each.
#[inline(always)]
fn spread(x: u32) -> u32 {
    let x = (x ^ x << 8) & 0x00ff_00ff;
    let x = (x ^ x << 4) & 0x0f0f_0f0f;
    let x = (x ^ x << 2) & 0x3333_3333;
    (x ^ x << 1) & 0x5555_5555
}

/// The second coordinate of the Sobol' sequence, both index and coordinate with bits reversed as compared to the usual
/// figure: its generator matrix is Pascal's triangle modulo 2, bit j of the result the sum of all bits k with (k over
/// j) odd. By Lucas' theorem these are the k whose binary digits contain those of j.
#[inline(always)]
fn pascal(index: u32) -> u32 {
    let x = index ^ (index >> 1 & 0x5555_5555);
    let x = x ^ (x >> 2 & 0x3333_3333);
    let x = x ^ (x >> 4 & 0x0f0f_0f0f);
    let x = x ^ (x >> 8 & 0x00ff_00ff);
    x ^ x >> 16
}

/// Flips every bit by a coin that is tossed anew for each value of the bits below: Owen's scrambling of a number with
/// its bits reversed. The hash is of Laine & Karras 2011, its constants were found by Vegdahl 2021.
#[inline(always)]
fn scramble(x: u32, seed: u32) -> u32 {
    let x = x ^ x.wrapping_mul(0x3d20_adea);
    let x = x.wrapping_add(seed).wrapping_mul(seed >> 16 | 1);
    let x = x ^ x.wrapping_mul(0x0552_6c56);
    x ^ x.wrapping_mul(0x53a2_2864)
}

/// The 24 highest bits as a number in 0..1.
#[inline(always)]
fn unit(x: u32) -> f32 {
    (x >> 8) as f32 / (1 << 24) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Random, chi_squared_z};

    #[test]
    fn the_unscrambled_sequence_is_sobols() {
        let point = |i: u32| Sampler::unscrambled(i).to_array();
        let first = [[0.0, 0.0], [0.5, 0.5], [0.25, 0.75], [0.75, 0.25], [0.125, 0.625]];
        assert_eq!([0, 1, 2, 3, 4].map(point), first);
        assert_eq!(point(5), [0.625, 0.125]);
        assert_eq!(point(6), [0.375, 0.375]);
    }

    #[test]
    fn morton_codes_interleave_columns_and_rows() {
        assert_eq!(morton(0b101, 0b011), 0b01_10_11);
        assert_eq!(morton(0xffff, 0), 0x5555_5555);
        assert_eq!(morton(0, 0xffff), 0xaaaa_aaaa);
    }

    /// Whether of 2^m points exactly one lies in every box of sides 2^−a and 2^−b with a + b = m.
    fn is_net(points: &[Vec2]) -> bool {
        let m = points.len().ilog2();
        (0..=m).all(|a| {
            let columns = 1 << a;
            let rows = points.len() / columns;
            let mut filled = vec![false; points.len()];
            for p in points {
                let (x, y) = ((p.x * columns as f32) as usize, (p.y * rows as f32) as usize);
                filled[x * rows + y] = true;
            }
            filled.iter().all(|&f| f)
        })
    }

    #[test]
    fn the_samples_of_a_pixel_are_a_net_in_every_pair_of_dimensions() {
        for samples in [1_u32, 2, 16, 64, 256, 1024] {
            for (x, y, pair) in [(0, 0, 0), (13, 7, 1), (1023, 66, 5), (65_535, 65_535, 400)] {
                let sampler = Sampler::new(3, samples);
                let points: Vec<_> =
                    (0..samples).map(|i| sampler.points(x, y, i).pair(pair)).collect();
                assert!(is_net(&points), "{samples} samples, pixel {x} {y}, pair {pair}");
            }
        }
    }

    /// What each sample decides several times is a net as well, over all samples and over those of a square of pixels.
    #[test]
    fn the_parts_of_samples_are_a_net_together() {
        for (samples, bits) in [(1_u32, 4), (4, 4), (16, 2)] {
            let sampler = Sampler::new(9, samples);
            let parts = |x: u32, y: u32| {
                let points = (0..samples).map(move |i| sampler.points(x, y, i));
                points.flat_map(move |p| (0..1 << bits).map(move |n| p.part(n, bits).pair(3)))
            };
            assert!(is_net(&parts(40_003, 7).collect::<Vec<_>>()), "{samples} samples");
            let square: Vec<_> = (0..4).flat_map(|i| parts(40_002 + i % 2, 6 + i / 2)).collect();
            assert!(is_net(&square), "{samples} samples of four pixels");
        }
    }

    /// So are the first samples of a pixel that gets more, in blocks of any power of two.
    #[test]
    fn blocks_of_samples_are_nets_too() {
        let sampler = Sampler::new(8, 1000);
        for block in [4, 16, 64] {
            for start in (0..256).step_by(block) {
                let range = start..start + block;
                let points: Vec<_> =
                    range.map(|i| sampler.points(5, 9, i as u32).pair(2)).collect();
                assert!(is_net(&points), "{block} samples from {start}");
            }
        }
    }

    #[test]
    fn the_samples_of_a_square_of_pixels_are_a_net() {
        for (side, samples) in [(2_u32, 1_u32), (4, 4), (8, 16)] {
            let sampler = Sampler::new(5, samples);
            let (x, y) = (side * 11, side * 3);
            let pixels = (0..side * side).map(|i| (x + i % side, y + i / side));
            let points: Vec<_> = pixels
                .flat_map(|(x, y)| (0..samples).map(move |i| sampler.points(x, y, i).pair(1)))
                .collect();
            assert!(is_net(&points), "{side} pixels, {samples} samples");
        }
    }

    /// Whatever the sequence, each point is anywhere, whatever the others are: over pairs of coordinates of different
    /// dimensions, and of neighbouring pixels, samples and rounds far apart in the sequence.
    #[test]
    fn dimensions_know_nothing_of_each_other() {
        let sampler = Sampler::new(1, 4);
        let mut random = Random::new(2);
        let (cells, count) = (16, 200_000);
        // Of the points of a sample and of one in the next round.
        type Coordinates = fn(PathPoints, PathPoints) -> [f32; 2];
        let pairs: [(&str, Coordinates); 6] = [
            ("x0 y0", |p, _| p.pair(0).to_array()),
            ("x0 x1", |p, _| [p.pair(0).x, p.pair(1).x]),
            ("x0 y1", |p, _| [p.pair(0).x, p.pair(1).y]),
            ("y7 y8", |p, _| [p.pair(7).y, p.pair(8).y]),
            ("x3 x515", |p, _| [p.pair(3).x, p.pair(515).x]),
            ("rounds", |p, next| [p.pair(0).x, next.pair(0).x]),
        ];
        for (name, pair) in pairs {
            let mut counts = vec![0; cells * cells];
            for _ in 0..count {
                // Far from each other, so that the points of one pair are as good as independent.
                let [x, y] = [0; 2].map(|_: u32| random.below(65_536) as u32);
                let at = |index| sampler.points(x, y, index);
                let [a, b] = pair(at(3), at(7)).map(|x| (x * cells as f32) as usize);
                counts[a * cells + b] += 1;
            }
            let z = chi_squared_z(&counts, &vec![1.0 / (cells * cells) as f64; cells * cells]);
            assert!(z.abs() < 4.5, "{name}: {z}");
        }
    }

    /// The joint net over four dimensions is no worse than chance: errors of a product fall at least like n^−½.
    #[test]
    fn higher_dimensions_converge_at_least_like_chance() {
        let exact = (std::f64::consts::E - 1.0).powi(4);
        let error = |samples: u32| {
            let squares = (0..64_u64).map(|seed| {
                let sampler = Sampler::new(seed, samples);
                let value = |i| {
                    let points = sampler.points(0, 0, i);
                    let (a, b) = (points.pair(0).as_dvec2(), points.pair(1).as_dvec2());
                    (a.element_sum() + b.element_sum()).exp()
                };
                let sum: f64 = (0..samples).map(value).sum();
                (sum / f64::from(samples) - exact).powi(2)
            });
            (squares.sum::<f64>() / 64.0).sqrt()
        };
        // The deviation of one sample is 4.9.
        for samples in [16, 256, 4096] {
            assert!(error(samples) < 4.9 / f64::from(samples).sqrt(), "{samples}");
        }
    }

    /// Averaged over squares of 8 × 8 pixels that do not follow the curve, most of the error is gone: blue noise.
    #[test]
    fn errors_of_neighbouring_pixels_cancel() {
        let exact = (std::f64::consts::E - 1.0).powi(2);
        let sampler = Sampler::new(6, 4);
        let (size, side) = (128_u32, 8_u32);
        let error = |x: u32, y: u32| {
            let value = |i| f64::from(sampler.points(x, y, i).pair(3).element_sum()).exp();
            (0..4).map(value).sum::<f64>() / 4.0 - exact
        };
        let rms = |errors: Vec<f64>| {
            (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt()
        };
        let errors: Vec<f64> = (0..size * size).map(|i| error(i % size, i / size)).collect();
        let corners = (1..size - side)
            .step_by(5)
            .flat_map(|y| (3..size - side).step_by(5).map(move |x| (x, y)));
        let mean = |(x, y): (u32, u32)| {
            let cell = |i: u32| errors[((y + i / side) * size + x + i % side) as usize];
            (0..side * side).map(cell).sum::<f64>() / f64::from(side * side)
        };
        let blurred = rms(corners.map(mean).collect());
        let white = rms(errors.clone()) / f64::from(side);
        assert!(blurred < 0.5 * white, "{blurred} of {white}");
    }
}
