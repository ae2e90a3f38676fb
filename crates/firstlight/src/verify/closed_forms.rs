//! What is known without any rendering: irradiance from shapes, form factors, skies.

use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, PI};

/// Irradiance at `point`, facing the unit vector `normal`, from a flat polygon of radiance 1, W·m⁻²: ½ Σ Θ_i Γ_i · n over
/// the edges of the part above the horizon, Θ_i the angle an edge is seen under and Γ_i the normal of its plane.
///
/// Lambert, *Photometria*, 1760.
pub(super) fn polygon(point: DVec3, normal: DVec3, corners: &[DVec3]) -> f64 {
    let seen: Vec<_> = corners.iter().map(|corner| *corner - point).collect();
    let above = above_horizon(&seen, normal);
    let edges = above.iter().zip(above.iter().cycle().skip(1));
    let sum: f64 = edges.map(|(a, b)| edge(*a, *b).dot(normal)).sum();
    0.5 * sum.abs()
}

/// Θ Γ of an edge seen from the origin.
fn edge(a: DVec3, b: DVec3) -> DVec3 {
    let normal = a.cross(b);
    normal.normalize_or_zero() * normal.length().atan2(a.dot(b))
}

/// The part of a polygon with p · normal ≥ 0 (Sutherland & Hodgman 1974).
fn above_horizon(corners: &[DVec3], normal: DVec3) -> Vec<DVec3> {
    let mut above = Vec::new();
    for (&a, &b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
        let (height_a, height_b) = (a.dot(normal), b.dot(normal));
        if height_a >= 0.0 {
            above.push(a);
        }
        if height_a * height_b < 0.0 {
            above.push(a.lerp(b, height_a / (height_a - height_b)));
        }
    }
    above
}

/// The corners of a rectangle.
pub(super) fn rectangle(corner: DVec3, edge_u: DVec3, edge_v: DVec3) -> [DVec3; 4] {
    [corner, corner + edge_u, corner + edge_u + edge_v, corner + edge_v]
}

/// Irradiance from a disk of radiance 1 and radius `a` that faces a parallel surface at distance `h`, `x` from its axis
/// (Howell, *A Catalog of Radiation Heat Transfer Configuration Factors*, B-13).
pub(super) fn disk(a: f64, h: f64, x: f64) -> f64 {
    let (sum, aa) = (h * h + x * x, a * a);
    FRAC_PI_2 * (1.0 - (sum - aa) / ((sum + aa).powi(2) - 4.0 * aa * x * x).sqrt())
}

/// Irradiance from a sphere of radiance 1 that is seen under half angle `sigma`, at angle `theta` from the normal: the
/// sphere's projection, or what of it is above the horizon (Snyder, *Area Light Sources for Real-Time Graphics*, 1996).
pub(super) fn sphere(sigma: f64, theta: f64) -> f64 {
    let (sin_s, cos_s) = sigma.sin_cos();
    let (sin_t, cos_t) = theta.sin_cos();
    if theta + sigma <= FRAC_PI_2 {
        return PI * sin_s * sin_s * cos_t;
    }
    let x = cos_s / sin_s;
    let y = -x * cos_t / sin_t;
    let w = sin_t * (1.0 - y * y).sqrt();
    (cos_t * y.acos() - x * w) * sin_s * sin_s + (w / x).atan()
}

/// Form factor of two opposed rectangles of sides `a`, `b` at distance `c` (Howell C-11).
pub(super) fn parallel_rectangles(a: f64, b: f64, c: f64) -> f64 {
    let (x, y) = (a / c, b / c);
    let (xx, yy) = (1.0 + x * x, 1.0 + y * y);
    let cross = |x: f64, yy: f64| x * yy.sqrt() * (x / yy.sqrt()).atan() - x * x.atan();
    let logarithm = 0.5 * (xx * yy / (xx + y * y)).ln();
    2.0 / (PI * x * y) * (logarithm + cross(x, yy) + cross(y, xx))
}

/// Form factor from a rectangle of width `w` to one of height `h`, at right angles along a common edge of length `l`
/// (Howell C-14).
pub(super) fn perpendicular_rectangles(l: f64, w: f64, h: f64) -> f64 {
    let (w, h) = (w / l, h / l);
    let (ww, hh) = (w * w, h * h);
    let (sum, all) = (ww + hh, 1.0 + ww + hh);
    let product = (1.0 + ww) * (1.0 + hh) / all;
    let share = |xx: f64| xx * (xx * all / ((1.0 + xx) * sum)).ln();
    let angles =
        w * w.recip().atan() + h * h.recip().atan() - sum.sqrt() * sum.sqrt().recip().atan();
    (angles + 0.25 * (product.ln() + share(ww) + share(hh))) / (PI * w)
}

/// The part of what leaves a small sphere that reaches a coaxial disk of radius `r` at distance `a`: its solid angle.
pub(super) fn sphere_to_disk(r: f64, a: f64) -> f64 {
    0.5 * (1.0 - 1.0 / (1.0 + (r / a).powi(2)).sqrt())
}

/// The mean over the unit square of what `value` says of its points: by Gauss's rule of two points each way, in each of
/// `cells` × `cells` cells.
pub(super) fn over_square(cells: u32, value: impl Fn(DVec2) -> f64) -> f64 {
    let half = 0.5 / 3.0_f64.sqrt();
    let at = |index: u32| {
        let shift = if index.is_multiple_of(2) { -half } else { half };
        (f64::from(index / 2) + 0.5 + shift) / f64::from(cells)
    };
    let all = (0..2 * cells).flat_map(|i| (0..2 * cells).map(move |j| (i, j)));
    all.map(|(i, j)| value(DVec2::new(at(i), at(j)))).sum::<f64>() / f64::from(4 * cells * cells)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nine digits of values that others have published or found by quadrature.
    #[test]
    fn formulas_give_what_is_in_the_books() {
        let close = |value: f64, expected: f64| {
            assert!((value / expected - 1.0).abs() < 1e-8, "{value} is not {expected}");
        };
        let square = rectangle(DVec3::new(-0.5, -0.5, 1.0), DVec3::X, DVec3::Y);
        close(polygon(DVec3::ZERO, DVec3::Z, &square), 0.752274688);
        let wall = rectangle(DVec3::new(1.0, -1.0, -1.0), 2.0 * DVec3::Y, 2.0 * DVec3::Z);
        close(polygon(DVec3::ZERO, DVec3::Z, &wall), 0.350188288);
        close(disk(1.0, 2.0, 0.0), 0.628318531);
        close(disk(1.0, 2.0, 5.0), 0.0157872984);
        let sigma = 0.25_f64.asin();
        for (degrees, expected) in
            [(60, 0.0981747704), (80, 0.0347227199), (90, 0.010618796), (100, 0.00062697993)]
        {
            close(sphere(sigma, f64::from(degrees).to_radians()), expected);
        }
        close(parallel_rectangles(1.0, 1.0, 0.5), 0.415253284);
        close(perpendicular_rectangles(1.0, 1.0, 1.0), 0.200043776);
        close(perpendicular_rectangles(2.0, 1.0, 3.0), 0.308140293);
        close(sphere_to_disk(1.0, 0.5), 0.276393202);
    }
}
