//! Small mathematics that glam does not have.

mod columns;

pub(crate) use columns::{BLOCK, Columns};

use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// Two unit vectors that make a right-handed orthonormal frame with the unit vector `normal` as third axis.
///
/// Duff et al., *Building an Orthonormal Basis, Revisited*, JCGT 6(1), 2017.
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
/// Shirley & Chiu, *A Low Distortion Map Between Disk and Square*, 1997.
pub(crate) fn concentric(u: DVec2) -> DVec2 {
    let (radius, angle) = concentric_polar(u);
    radius * DVec2::from_angle(angle)
}

/// The same as a radius of −1..1 and an angle, rad.
#[inline(always)]
pub(crate) fn concentric_polar(u: DVec2) -> (f64, f64) {
    let square = 2.0 * u - 1.0;
    if square.x.abs() > square.y.abs() {
        (square.x, FRAC_PI_4 * (square.y / square.x))
    } else if square.y != 0.0 {
        (square.y, FRAC_PI_2 - FRAC_PI_4 * (square.x / square.y))
    } else {
        (0.0, 0.0)
    }
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
