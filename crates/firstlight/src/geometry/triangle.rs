//! Triangles in double precision: what the single-precision kernels refine their answers with.

use glam::{DVec3, Vec3};

/// Distance along the ray `origin + t · direction` to the plane of a triangle, in double precision.
///
/// NaN or infinite for a triangle without area or seen edge-on. The corners are f32, so their differences are
/// nearly exact here: the sign of t is right for any origin that is off the plane by more than 4·10⁻¹⁶ times
/// the size of the triangle. That is what lets rays start a single-precision rounding error above a surface
/// without a minimum distance, see `shading::interaction`.
#[inline(always)]
pub(crate) fn plane_distance(origin: Vec3, direction: Vec3, corners: [Vec3; 3]) -> f32 {
    let (a, b, c) = (corners[0].as_dvec3(), corners[1].as_dvec3(), corners[2].as_dvec3());
    let normal = (b - a).cross(c - a);
    normal.dot(a - origin.as_dvec3()) as f32 / normal.dot(direction.as_dvec3()) as f32
}

/// Solid angle of a triangle seen from the origin, sr (Van Oosterom & Strackee 1983).
pub fn solid_angle(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    let (la, lb, lc) = (a.length(), b.length(), c.length());
    let numerator = a.dot(b.cross(c)).abs();
    let denominator = la * lb * lc + a.dot(b) * lc + a.dot(c) * lb + b.dot(c) * la;
    2.0 * numerator.atan2(denominator)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn solid_angles_match_closed_forms() {
        let relative = |value: f64, expected: f64| (value / expected - 1.0).abs();
        assert!(relative(solid_angle(DVec3::X, DVec3::Y, DVec3::Z), PI / 2.0) < 1e-12);
        let big = [(1.0, 0.0), (0.0, 1.0), (-1.0, -1.0)].map(|(x, y)| DVec3::new(x, y, 1.0));
        assert!(relative(solid_angle(big[0], big[1], big[2]), PI / 3.0) < 1e-8);
        let tiny = [(0.0, 0.0), (1e-4, 0.0), (0.0, 1e-4)].map(|(x, y)| DVec3::new(x, y, 1.0));
        assert!(relative(solid_angle(tiny[0], tiny[1], tiny[2]), 4.999_999_98e-9) < 1e-5);
    }
}
