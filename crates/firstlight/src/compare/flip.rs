//! How different two pictures look to someone who flips between them.
//!
//! Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild, *FLIP: A Difference Evaluator for Alternating Images*,
//! Proc. ACM Comput. Graph. Interact. Tech. 3(2), 2020. Made from the paper; its names and constants are kept.

use crate::color::{Rgb, srgb_decode};
use glam::{Mat3, Vec3};
use std::f32::consts::PI;

/// Pixels of a degree of the field of view: a screen of 0.7 m and 3840 pixels, seen from 0.7 m away.
pub const PIXELS_PER_DEGREE: f32 = 67.020_64;

/// Exponents of the difference in colour and in features.
const QC: f32 = 0.7;
const QF: f32 = 0.5;
/// The part of the largest difference in colour that is mapped to the part `PT` of the result.
const PC: f32 = 0.4;
const PT: f32 = 0.95;
/// Width of what counts as an edge or a point, degrees.
const FEATURE: f32 = 0.082;
/// The eye's contrast sensitivity in each channel: sums of two Gaussians a √(π/b) exp(−π² r² / b), r in degrees.
const ACHROMATIC: [(f32, f32); 2] = [(1.0, 0.0047), (0.0, 1e-5)];
const RED_GREEN: [(f32, f32); 2] = [(1.0, 0.0053), (0.0, 1e-5)];
const BLUE_YELLOW: [(f32, f32); 2] = [(34.1, 0.04), (13.5, 0.025)];

/// White: linear RGB 1, 1, 1 in XYZ.
const WHITE: Vec3 = Vec3::new(0.950_428_55, 1.0, 1.088_900_4);

fn to_xyz() -> Mat3 {
    Mat3::from_cols(
        Vec3::new(0.412_390_8, 0.212_639, 0.019_330_82),
        Vec3::new(0.357_584_33, 0.715_168_65, 0.119_194_78),
        Vec3::new(0.180_480_8, 0.072_192_32, 0.950_532_15),
    )
}

/// FLIP of each pixel, 0..1, of two pictures of one size, given as sRGB codes 0..1.
pub fn flip(test: &[Rgb], reference: &[Rgb], size: [u32; 2]) -> Vec<f32> {
    let [test, reference] = [test, reference].map(|codes| Seen::of(codes, size));
    let largest = largest_difference();
    let color =
        test.lab.iter().zip(&reference.lab).map(|(a, b)| spread(hyab(*a, *b).powf(QC), largest));
    let features = test.features.iter().zip(&reference.features);
    let features = features.map(|(a, b)| {
        let [edge, point] = [(a[0] - b[0]).abs(), (a[1] - b[1]).abs()];
        (edge.max(point) * std::f32::consts::FRAC_1_SQRT_2).powf(QF)
    });
    color.zip(features).map(|(color, feature)| color.powf(1.0 - feature)).collect()
}

/// A picture as the eye has it.
struct Seen {
    /// Hunt-adjusted L*a*b* after the eye's blur.
    lab: Vec<Vec3>,
    /// How strong edges and points are.
    features: Vec<[f32; 2]>,
}

impl Seen {
    fn of(codes: &[Rgb], size: [u32; 2]) -> Self {
        let opponent: Vec<Vec3> = codes.iter().map(|c| ycxcz(c.map(srgb_decode))).collect();
        let blurred = blur(&opponent, size);
        let lab = blurred.iter().map(|c| hunt(lab(rgb(*c).clamp(Vec3::ZERO, Vec3::ONE)))).collect();
        let grey: Vec<f32> = opponent.iter().map(|c| (c.x + 16.0) / 116.0).collect();
        Self { lab, features: features(&grey, size) }
    }
}

/// Linear RGB → the opponent space YCxCz, a linear form of L*a*b*.
fn ycxcz(linear: Vec3) -> Vec3 {
    let n = to_xyz() * linear / WHITE;
    Vec3::new(116.0 * n.y - 16.0, 500.0 * (n.x - n.y), 200.0 * (n.y - n.z))
}

/// Back to linear RGB.
fn rgb(ycxcz: Vec3) -> Vec3 {
    let y = (ycxcz.x + 16.0) / 116.0;
    let n = Vec3::new(y + ycxcz.y / 500.0, y, y - ycxcz.z / 200.0);
    to_xyz().inverse() * (n * WHITE)
}

/// Linear RGB → CIE L*a*b*.
fn lab(linear: Vec3) -> Vec3 {
    const LIMIT: f32 = 6.0 / 29.0;
    let curve = |t: f32| match t > LIMIT.powi(3) {
        true => t.cbrt(),
        false => t / (3.0 * LIMIT * LIMIT) + 4.0 / 29.0,
    };
    let n = (to_xyz() * linear / WHITE).map(curve);
    Vec3::new(116.0 * n.y - 16.0, 500.0 * (n.x - n.y), 200.0 * (n.y - n.z))
}

/// Colours look weaker where it is dark.
fn hunt(lab: Vec3) -> Vec3 {
    lab * Vec3::new(1.0, 0.01 * lab.x, 0.01 * lab.x)
}

/// Distance of large differences in colour.
fn hyab(a: Vec3, b: Vec3) -> f32 {
    let d = a - b;
    d.x.abs() + d.y.hypot(d.z)
}

/// The largest difference there is: of green and blue.
fn largest_difference() -> f32 {
    hyab(hunt(lab(Vec3::Y)), hunt(lab(Vec3::Z))).powf(QC)
}

/// Differences in colour on 0..1: small ones get most of it.
fn spread(difference: f32, largest: f32) -> f32 {
    let limit = PC * largest;
    match difference < limit {
        true => PT / limit * difference,
        false => PT + (difference - limit) / (largest - limit) * (1.0 - PT),
    }
}

/// What contrast sensitivity leaves of a picture.
fn blur(opponent: &[Vec3], size: [u32; 2]) -> Vec<Vec3> {
    let radius = (3.0 * (0.04 / (2.0 * PI * PI)).sqrt() * PIXELS_PER_DEGREE).ceil() as i32;
    let channel = |pick: fn(&Vec3) -> f32, terms: &[(f32, f32); 2]| {
        let plane: Vec<f32> = opponent.iter().map(pick).collect();
        // A sum of round Gaussians is no product of rows and columns, but each of them is.
        let gaussian = |b: f32| -> Vec<f32> {
            let degrees = |i: i32| i as f32 / PIXELS_PER_DEGREE;
            (-radius..=radius).map(|i| (-(PI * degrees(i)).powi(2) / b).exp()).collect()
        };
        let mut sum = vec![0.0; plane.len()];
        let mut whole = 0.0;
        for (a, b) in terms.iter().filter(|(a, _)| *a > 0.0) {
            let kernel = gaussian(*b);
            let weight = a * (PI / b).sqrt();
            whole += weight * kernel.iter().sum::<f32>().powi(2);
            let part = filter(&plane, size, &kernel, &kernel);
            sum.iter_mut().zip(part).for_each(|(sum, part)| *sum += weight * part);
        }
        sum.iter_mut().for_each(|value| *value /= whole);
        sum
    };
    let (y, cx, cz) = (
        channel(|c| c.x, &ACHROMATIC),
        channel(|c| c.y, &RED_GREEN),
        channel(|c| c.z, &BLUE_YELLOW),
    );
    y.into_iter().zip(cx).zip(cz).map(|((y, cx), cz)| Vec3::new(y, cx, cz)).collect()
}

/// Strength of edges and of points: first and second derivatives of a Gaussian.
fn features(grey: &[f32], size: [u32; 2]) -> Vec<[f32; 2]> {
    let deviation = 0.5 * FEATURE * PIXELS_PER_DEGREE;
    let radius = (3.0 * deviation).ceil() as i32;
    let kernel = |of: &dyn Fn(f32) -> f32| -> Vec<f32> {
        let value = |i: i32| of(i as f32) * (-0.5 * (i as f32 / deviation).powi(2)).exp();
        let values: Vec<f32> = (-radius..=radius).map(value).collect();
        let [below, above] = [-1.0, 1.0].map(|sign| {
            values.iter().map(|v| (sign * v).max(0.0)).sum::<f32>().max(f32::MIN_POSITIVE)
        });
        values.iter().map(|v| if *v < 0.0 { v / below } else { v / above }).collect()
    };
    let round = kernel(&|_| 1.0);
    let edge = kernel(&|x| -x);
    let point = kernel(&|x| (x / deviation).powi(2) - 1.0);
    let strength = |kernel: &[f32]| -> Vec<f32> {
        let (x, y) = (filter(grey, size, kernel, &round), filter(grey, size, &round, kernel));
        x.iter().zip(&y).map(|(x, y)| x.hypot(*y)).collect()
    };
    strength(&edge).into_iter().zip(strength(&point)).map(|(e, p)| [e, p]).collect()
}

/// Filters rows, then columns; the picture's edge goes on outside.
fn filter(plane: &[f32], size: [u32; 2], across: &[f32], down: &[f32]) -> Vec<f32> {
    let [width, height] = size.map(|side| side as i32);
    let at = |plane: &[f32], x: i32, y: i32| {
        plane[(y.clamp(0, height - 1) * width + x.clamp(0, width - 1)) as usize]
    };
    let pass = |plane: &[f32], kernel: &[f32], dx: i32, dy: i32| -> Vec<f32> {
        let radius = kernel.len() as i32 / 2;
        let pixel = |i: i32| {
            let (x, y) = (i % width, i / width);
            let offsets = (-radius..=radius).zip(kernel);
            offsets.map(|(o, weight)| weight * at(plane, x + o * dx, y + o * dy)).sum()
        };
        (0..width * height).map(pixel).collect()
    };
    pass(&pass(plane, across, 1, 0), down, 0, 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(color: Rgb) -> Vec<Rgb> {
        vec![color; 32 * 32]
    }

    /// The formulas by hand: |ΔL| = 100, 100^0.7 = 25.119; green and blue are 203.3 apart, 203.3^0.7 = 41.27.
    #[test]
    fn black_and_white_are_what_the_formulas_say() {
        let map = flip(&flat(Rgb::ZERO), &flat(Rgb::ONE), [32, 32]);
        for value in &map {
            assert!((value - 0.9674).abs() < 5e-4, "{value}");
        }
        let most = flip(&flat(Rgb::Y), &flat(Rgb::Z), [32, 32]);
        assert!((most[0] - 1.0).abs() < 1e-3, "{}", most[0]);
    }

    #[test]
    fn the_same_is_the_same_and_order_does_not_matter() {
        let noise = |seed: u32| -> Vec<Rgb> {
            let value = |i: u32| {
                f32::from((crate::math::hash(u64::from(i * 7 + seed)) & 0xFF) as u8) / 255.0
            };
            (0..32 * 32)
                .map(|i| Rgb::new(value(3 * i), value(3 * i + 1), value(3 * i + 2)))
                .collect()
        };
        assert!(flip(&noise(1), &noise(1), [32, 32]).iter().all(|x| *x == 0.0));
        let (there, back) =
            (flip(&noise(1), &noise(2), [32, 32]), flip(&noise(2), &noise(1), [32, 32]));
        assert!(there.iter().zip(&back).all(|(a, b)| (a - b).abs() < 1e-5));
        assert!(there.iter().all(|x| (0.0..=1.0).contains(x)));
    }

    /// An edge that moved counts for more than the blurred colours do.
    #[test]
    fn edges_count() {
        let step = |at: u32, low: f32| -> Vec<Rgb> {
            (0..32 * 32).map(|i| Rgb::splat(if i % 32 < at { low } else { 0.6 })).collect()
        };
        let map = flip(&step(16, 0.5), &step(40, 0.5), [32, 32]);
        let (edge, inside) = (map[16 * 32 + 16], map[16 * 32 + 28]);
        assert!(edge > 0.0 && inside > 0.0, "{edge} {inside}");
        let same = flip(&step(16, 0.5), &step(16, 0.5), [32, 32]);
        assert_eq!(same[16], 0.0);
    }
}
