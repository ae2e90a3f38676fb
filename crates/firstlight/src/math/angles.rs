//! Angles and points of the circle, without branches and calls: loops over a block work on several at a time.
//!
//! Polynomials that interpolate at Chebyshev's points, in the square of the argument, good to 2 · 10⁻¹⁵.

use glam::DVec2;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// tan(π/8)
const TAN_PI_8: f64 = std::f64::consts::SQRT_2 - 1.0;

/// sin √z / √z up to z = (π/2)².
const SIN: [f64; 9] = [
    1.0,
    -0.16666666666666666,
    0.008333333333333186,
    -0.00019841269841208676,
    2.7557319211229606e-06,
    -2.505210689056952e-08,
    1.605894087848656e-10,
    -7.643026557971632e-13,
    2.7215749422983443e-15,
];

/// cos √z up to the same.
const COS: [f64; 10] = [
    1.0,
    -0.5,
    0.04166666666666666,
    -0.001388888888888853,
    2.480158730149264e-05,
    -2.755731920965447e-07,
    2.0876755666578904e-09,
    -1.1470670165323271e-11,
    4.7768722491448073e-14,
    -1.5119827834217995e-16,
];

/// atan √z / √z up to z = tan²(π/8).
const ATAN: [f64; 12] = [
    1.0,
    -0.3333333333333312,
    0.19999999999940893,
    -0.14285714279250245,
    0.11111110744919658,
    -0.09090896809064027,
    0.07692045330902225,
    -0.06662951813629191,
    0.05846878297330872,
    -0.05035102456601552,
    0.03796525745386593,
    -0.017805397205419446,
];

/// The sum of `coefficients[i]` times the i-th power of `x`.
#[inline(always)]
fn polynomial<const N: usize>(x: f64, coefficients: [f64; N]) -> f64 {
    let square = x * x;
    // Even and odd powers do not wait for each other.
    let mut sums = [0.0; 2];
    for i in (0..N).rev() {
        sums[i % 2] = sums[i % 2] * square + coefficients[i];
    }
    sums[0] + x * sums[1]
}

/// The point of the unit circle at an angle of −π..π, rad.
#[inline(always)]
pub(crate) fn on_circle(angle: f64) -> DVec2 {
    let half = 0.5 * angle;
    let z = half * half;
    let (sin, cos) = (half * polynomial(z, SIN), polynomial(z, COS));
    DVec2::new(1.0 - 2.0 * sin * sin, 2.0 * sin * cos)
}

/// The angle of a point that is not below the first axis, 0..π, rad; NaN of the origin.
#[inline(always)]
pub(crate) fn angle_above(point: DVec2) -> f64 {
    let (x, y) = (point.x.abs(), point.y);
    let (low, high) = (x.min(y), x.max(y));
    let steep = low > TAN_PI_8 * high;
    let (rise, run) = if steep { (low - high, low + high) } else { (low, high) };
    let tan = rise / run;
    let rest = tan * polynomial(tan * tan, ATAN);
    let angle = if steep { FRAC_PI_4 + rest } else { rest };
    let angle = if y > x { FRAC_PI_2 - angle } else { angle };
    if point.x < 0.0 { PI - angle } else { angle }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_of_the_circle_are_where_they_should_be() {
        for i in -10_000..=10_000 {
            let angle = PI * f64::from(i) / 10_000.0;
            let error = on_circle(angle) - DVec2::from_angle(angle);
            assert!(error.abs().max_element() < 2e-15, "{angle}: {error}");
        }
        let small = on_circle(1e-150);
        assert_eq!(small, DVec2::new(1.0, 1e-150));
    }

    #[test]
    fn angles_are_those_of_the_points() {
        for i in 0..=10_000 {
            let angle = PI * f64::from(i) / 10_000.0;
            let point = 3.7e-5 * DVec2::from_angle(angle).abs().with_x(angle.cos());
            let expected = point.y.atan2(point.x);
            let error = (angle_above(point) - expected).abs();
            assert!(error <= 4.0 * f64::EPSILON * expected, "{angle}: {error:e}");
        }
        assert_eq!(angle_above(DVec2::new(2.0, 1e-200)), 5e-201);
    }
}
