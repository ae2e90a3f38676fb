//! Small mathematics that glam does not have.

mod angles;
mod columns;

pub(crate) use angles::{angle_above, on_circle};
pub(crate) use columns::{BLOCK, Columns};

use glam::{DVec3, Vec2};
use std::f32::consts::FRAC_PI_4;

/// A vector of length 1 along another; zero if that is. (glam's asks for finite numbers in a way that no loop is vectorised
/// with.)
#[inline(always)]
pub(crate) fn unit_or_zero(v: DVec3) -> DVec3 {
    let length2 = v.length_squared();
    if length2 > 0.0 { v / length2.sqrt() } else { DVec3::ZERO }
}

/// Two unit vectors that make a right-handed orthonormal frame with the unit vector `normal` as third axis.
///
/// Duff et al., *Building an Orthonormal Basis, Revisited*, JCGT 6(1), 2017.
#[inline(always)]
pub(crate) fn tangents(normal: DVec3) -> (DVec3, DVec3) {
    let sign = 1.0_f64.copysign(normal.z);
    let a = -1.0 / (sign + normal.z);
    let b = normal.x * normal.y * a;
    let tangent = DVec3::new(1.0 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x);
    let bitangent = DVec3::new(b, sign + normal.y * normal.y * a, -normal.y);
    (tangent, bitangent)
}

/// The square 0..1 mapped onto the unit disk ring by ring, which keeps areas and neighbours.
///
/// Shirley & Chiu, *A Low Distortion Map Between Disk and Square*, 1997. Angles are at most π/4, so that short
/// series do (Chebyshev's, as in `angles.rs`, to 2 · 10⁻⁷).
#[inline(always)]
pub(crate) fn concentric(u: Vec2) -> Vec2 {
    let square = 2.0 * u - 1.0;
    let wide = square.x.abs() > square.y.abs();
    let (radius, other) = if wide { (square.x, square.y) } else { (square.y, square.x) };
    let angle = FRAC_PI_4 * if radius == 0.0 { 0.0 } else { other / radius };
    let z = angle * angle;
    let sin = angle * (1.0 + z * (-0.166_666_5 + z * (0.008_332_036 - z * 0.000_195_039_04)));
    let cos = 1.0 + z * (-0.5 + z * (0.041_666_617 + z * (-0.001_388_661_8 + z * 2.437_983e-5)));
    radius * if wide { Vec2::new(cos, sin) } else { Vec2::new(sin, cos) }
}

/// Mixes the bits of `x` (the finaliser of SplitMix64; Steele, Lea, Flood 2014): a good 64-bit hash.
pub(crate) fn hash(x: u64) -> u64 {
    let x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    /// Along rings, angles grow evenly.
    #[test]
    fn the_disk_is_filled_ring_by_ring() {
        assert_eq!(concentric(Vec2::splat(0.5)), Vec2::ZERO);
        for i in 0..=1000_u16 {
            let part = f64::from(i) / 1000.0;
            let angle = std::f64::consts::FRAC_PI_2 * (part - 0.5);
            let expected = 0.6 * DVec2::from_angle(angle);
            let along = 0.5 + 0.6 * (part - 0.5);
            let right = concentric(Vec2::new(0.8, along as f32)).as_dvec2();
            assert!((right - expected).length() < 2e-7, "{part}");
            let top = concentric(Vec2::new(along as f32, 0.8)).as_dvec2();
            assert!((top - DVec2::new(expected.y, expected.x)).length() < 2e-7, "{part}");
        }
    }

    #[test]
    fn tangents_make_a_right_handed_frame() {
        for i in 0..1000_u64 {
            let unit = |k: u64| hash(i * 3 + k) as f64 / u64::MAX as f64 * 2.0 - 1.0;
            let normal = DVec3::new(unit(0), unit(1), unit(2)).normalize();
            let (tangent, bitangent) = tangents(normal);
            assert!((tangent.cross(bitangent) - normal).length() < 1e-14);
            assert!(tangent.dot(normal).abs() < 1e-14);
        }
    }
}
