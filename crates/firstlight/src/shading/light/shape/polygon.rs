//! Triangles and parallelograms, sampled by solid angle: each direction that meets them is picked alike.
//!
//! The way of Arvo, *Stratified Sampling of Spherical Triangles*, 1995: a triangle A, B, C on the unit sphere is cut
//! from B to a point C′ between A and C, so that the area of A, B, C′ is the first number's part of the whole; the
//! second number picks a point between B and C′. C′ comes from the formula of Van Oosterom & Strackee 1983,
//! tan(Ω/2) = A·(B×C′) / (1 + A·B + B·C′ + C′·A), which needs no angles and loses no digits on small triangles.
//! Half a solid angle is the argument of a complex number with that tangent; those of several triangles add up where the
//! numbers are multiplied, so that one arc tangent does for all. A parallelogram is a fan of two triangles around one
//! corner, so that the picked point moves without a jump over both.
//!
//! From afar all points of a shape look nearly alike. There they are picked evenly, which takes a fraction of the time and
//! gives nearly the same noise.

use super::ShapeSample;
use crate::geometry::Bounds;
use crate::math::{angle_above, on_circle, unit_or_zero};
use glam::{DAffine3, DVec2, DVec3};

/// From so many times further away from the middle than the furthest corner, shapes are seen from afar.
const AFAR: f64 = 3.0;

/// A triangle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Triangle(Corner);

/// A parallelogram.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Parallelogram(Corner);

/// A corner of a flat shape, and the edges that leave it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Corner {
    /// Where it is, m.
    position: DVec3,
    /// The edges, m.
    edges: [DVec3; 2],
    /// Of length 1, to the side from which the edges turn anticlockwise; NaN if they are parallel.
    normal: DVec3,
    /// In the plane, each at a right angle to the other edge, with product 1 with its own, m⁻¹.
    dual: [DVec3; 2],
    /// Of the parallelogram of both edges, m².
    area: f64,
    /// The middle of the shape, m, and the square of the distance from there from which on it is far away, m².
    middle: DVec3,
    afar: f64,
}

impl Corner {
    /// `corners` of a shape, by their coordinates along the edges.
    fn new(position: DVec3, [u, v]: [DVec3; 2], corners: &[DVec2]) -> Self {
        let across = u.cross(v);
        let normal = across / across.length();
        let dual = [v.cross(across), across.cross(u)].map(|d| d / across.length_squared());
        let corners = corners.iter().map(|corner| position + corner.x * u + corner.y * v);
        let middle = corners.clone().sum::<DVec3>() / corners.len() as f64;
        let furthest = corners.map(|corner| corner.distance_squared(middle)).fold(0.0, f64::max);
        let (area, afar) = (across.length(), AFAR * AFAR * furthest);
        Self { position, edges: [u, v], normal, dual, area, middle, afar }
    }

    /// The point with coordinates `place` along the edges.
    #[inline(always)]
    fn at(&self, place: DVec2) -> DVec3 {
        self.position + place.x * self.edges[0] + place.y * self.edges[1]
    }

    /// Where the plane is met in `direction` from `from`: coordinates along the edges.
    #[inline(always)]
    fn on_plane(&self, from: DVec3, direction: DVec3) -> DVec2 {
        let corner = self.position - from;
        let met = direction * (self.normal.dot(corner) / self.normal.dot(direction)) - corner;
        DVec2::new(met.dot(self.dual[0]), met.dot(self.dual[1]))
    }

    /// The point of these coordinates along the edges.
    #[inline(always)]
    fn sample(&self, from: DVec3, place: DVec2, pdf: f64) -> Option<ShapeSample> {
        ShapeSample::new(from, self.at(place), self.normal, pdf)
    }

    /// The same if points of `area` m² are picked evenly.
    #[inline(always)]
    fn sample_evenly(&self, from: DVec3, place: DVec2, area: f64) -> Option<ShapeSample> {
        self.sample(from, place, self.even_pdf(from, self.at(place), area))
    }

    fn bounds<const N: usize>(&self, ends: [DVec2; N]) -> Bounds {
        Bounds::around(ends.map(|end| self.at(end).as_vec3()))
    }

    /// Whether all points look nearly alike from there.
    #[inline(always)]
    fn is_far(&self, from: DVec3) -> bool {
        from.distance_squared(self.middle) > self.afar
    }

    /// Density of the direction from `from` to `position`, sr⁻¹, where points of `area` m² are picked evenly.
    #[inline(always)]
    fn even_pdf(&self, from: DVec3, position: DVec3, area: f64) -> f64 {
        let to_light = position - from;
        let distance2 = to_light.length_squared();
        distance2 * distance2.sqrt() / (self.normal.dot(to_light).abs() * area)
    }

    fn normal_or_zero(&self) -> DVec3 {
        if self.normal.is_finite() { self.normal } else { DVec3::ZERO }
    }
}

impl Triangle {
    /// The triangle with these corners; its front is where they run anticlockwise.
    pub(crate) fn new([a, b, c]: [DVec3; 3]) -> Self {
        Self(Corner::new(a, [b - a, c - a], &[DVec2::ZERO, DVec2::X, DVec2::Y]))
    }

    pub(super) fn pdf(&self, from: DVec3, position: DVec3) -> f64 {
        if self.0.is_far(from) {
            return self.0.even_pdf(from, position, self.area());
        }
        self.seen(from).pdf()
    }

    pub(super) fn normal(&self) -> DVec3 {
        self.0.normal_or_zero()
    }

    pub(super) fn bounds(&self) -> Bounds {
        self.0.bounds([DVec2::ZERO, DVec2::X, DVec2::Y])
    }

    pub(super) fn area(&self) -> f64 {
        0.5 * self.0.area
    }

    #[inline(always)]
    fn seen(&self, from: DVec3) -> Fan<2> {
        let a = self.0.position - from;
        Fan::new(a, self.0.edges.map(|edge| a + edge))
    }
}

impl Parallelogram {
    /// The unit square 0..1 in z = 0, its front up, under `to_world`.
    pub(crate) fn new(to_world: &DAffine3) -> Self {
        let axes = to_world.matrix3;
        let mut edges = [axes.x_axis, axes.y_axis];
        // Its front is where the product of its edges points; a mirror would turn it round.
        if axes.determinant() < 0.0 {
            edges.reverse();
        }
        let corners = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE];
        Self(Corner::new(to_world.translation, edges, &corners))
    }

    pub(super) fn pdf(&self, from: DVec3, position: DVec3) -> f64 {
        if self.0.is_far(from) {
            return self.0.even_pdf(from, position, self.area());
        }
        self.seen(from).pdf()
    }

    pub(super) fn normal(&self) -> DVec3 {
        self.0.normal_or_zero()
    }

    pub(super) fn bounds(&self) -> Bounds {
        self.0.bounds([DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE])
    }

    pub(super) fn area(&self) -> f64 {
        self.0.area
    }

    #[inline(always)]
    fn seen(&self, from: DVec3) -> Fan<3> {
        let a = self.0.position - from;
        let [u, v] = self.0.edges;
        Fan::new(a, [a + u, a + u + v, a + v])
    }
}

/// A shape that looks different from near and from afar.
pub(super) trait NearAndFar {
    /// Its corner.
    fn corner(&self) -> &Corner;

    /// A sample from afar.
    fn sample_afar(&self, from: DVec3, u: DVec2) -> Option<ShapeSample>;

    /// A sample from near.
    fn sample_near(&self, from: DVec3, u: DVec2) -> Option<ShapeSample>;

    /// Whether all points look nearly alike from there.
    #[inline(always)]
    fn is_far(&self, from: DVec3) -> bool {
        self.corner().is_far(from)
    }

    /// A sample from anywhere.
    fn sample(&self, from: DVec3, u: DVec2) -> Option<ShapeSample> {
        if self.is_far(from) { self.sample_afar(from, u) } else { self.sample_near(from, u) }
    }
}

impl NearAndFar for Triangle {
    #[inline(always)]
    fn corner(&self) -> &Corner {
        &self.0
    }

    #[inline(always)]
    fn sample_afar(&self, from: DVec3, u: DVec2) -> Option<ShapeSample> {
        self.0.sample_evenly(from, folded(u), self.area())
    }

    #[inline(always)]
    fn sample_near(&self, from: DVec3, u: DVec2) -> Option<ShapeSample> {
        let fan = self.seen(from);
        let place = within_triangle(self.0.on_plane(from, fan.direction(u)));
        self.0.sample(from, place, fan.pdf())
    }
}

impl NearAndFar for Parallelogram {
    #[inline(always)]
    fn corner(&self) -> &Corner {
        &self.0
    }

    #[inline(always)]
    fn sample_afar(&self, from: DVec3, u: DVec2) -> Option<ShapeSample> {
        self.0.sample_evenly(from, u, self.area())
    }

    #[inline(always)]
    fn sample_near(&self, from: DVec3, u: DVec2) -> Option<ShapeSample> {
        let fan = self.seen(from);
        let place = self.0.on_plane(from, fan.direction(u));
        self.0.sample(from, place.clamp(DVec2::ZERO, DVec2::ONE), fan.pdf())
    }
}

/// The square 0..1 folded onto the triangle below its diagonal, which keeps neighbours and, up to a factor, areas.
///
/// Heitz, *A Low-Distortion Map Between Triangle and Square*, 2019.
#[inline(always)]
fn folded(u: DVec2) -> DVec2 {
    if u.x < u.y {
        DVec2::new(0.5 * u.x, u.y - 0.5 * u.x)
    } else {
        DVec2::new(u.x - 0.5 * u.y, 0.5 * u.y)
    }
}

/// Rounding may leave a point just outside its triangle.
#[inline(always)]
fn within_triangle(place: DVec2) -> DVec2 {
    let place = place.max(DVec2::ZERO);
    place / (place.x + place.y).max(1.0)
}

/// Triangles on the unit sphere around the eye that share one corner, each with the next corner of `N` on the rim.
struct Fan<const N: usize> {
    /// The shared corner, a unit vector.
    pivot: DVec3,
    /// The others, unit vectors.
    rim: [DVec3; N],
    /// Of each triangle but the last, which there is not: a complex number whose argument is half of its solid angle; its
    /// second part is the triangle's |A·(B×C)|.
    halves: [DVec2; N],
    /// Half of the whole solid angle, sr.
    half: f64,
}

impl<const N: usize> Fan<N> {
    /// From the corners as seen from the eye, m.
    #[inline(always)]
    fn new(pivot: DVec3, rim: [DVec3; N]) -> Self {
        let nearness = rim.map(|corner| corner.length_recip());
        let near_pivot = pivot.length_recip();
        let on_sphere = pivot * near_pivot;
        let (mut halves, mut whole) = ([DVec2::ZERO; N], DVec2::X);
        for i in 1..N {
            let (a, c) = (rim[i - 1], rim[i]);
            let nearness = [nearness[i - 1], nearness[i]];
            let volume = pivot.dot((a - pivot).cross(c - pivot)).abs();
            let volume = volume * near_pivot * nearness[0] * nearness[1];
            let (a, c) = (a * nearness[0], c * nearness[1]);
            let base = 1.0 + a.dot(on_sphere) + on_sphere.dot(c) + c.dot(a);
            halves[i - 1] = DVec2::new(base, volume);
            whole = whole.rotate(halves[i - 1]);
        }
        let mut rim = rim;
        for i in 0..N {
            rim[i] *= nearness[i];
        }
        // No flat shape fills more than half of the sphere.
        Self { pivot: on_sphere, rim, halves, half: angle_above(whole.with_y(whole.y.abs())) }
    }

    /// Density of directions inside, sr⁻¹.
    #[inline(always)]
    fn pdf(&self) -> f64 {
        0.5 / self.half
    }

    /// A direction inside, each alike.
    #[inline(always)]
    fn direction(&self, u: DVec2) -> DVec3 {
        let mut picked = on_circle(u.x * self.half);
        let mut triangle = self.triangle(0);
        let mut beyond = true;
        for next in 1..N - 1 {
            let half = self.halves[next - 1];
            beyond &= half.perp_dot(picked) >= 0.0;
            // What is left after the last triangle; the length of these numbers means nothing.
            let left = half.with_y(-half.y).rotate(picked);
            picked = if beyond { left } else { picked };
            triangle = if beyond { self.triangle(next) } else { triangle };
        }
        let cut = self.cut(triangle, picked);
        let b = self.pivot;
        let one_minus_cos = 0.5 * b.distance_squared(cut);
        let across = (cut - b) + one_minus_cos * b;
        let picked = u.y * one_minus_cos;
        let sin = (picked * (2.0 - picked)).max(0.0).sqrt();
        (1.0 - picked) * b + sin * unit_or_zero(across)
    }

    /// A and C of a triangle, and its |A·(B×C)|.
    #[inline(always)]
    fn triangle(&self, number: usize) -> (DVec3, DVec3, f64) {
        (self.rim[number], self.rim[number + 1], self.halves[number].y)
    }

    /// C′ between A and C of a triangle, so that half of the solid angle of A, B, C′ is the argument of `picked`.
    #[inline(always)]
    fn cut(&self, (a, c, volume): (DVec3, DVec3, f64), picked: DVec2) -> DVec3 {
        let b = self.pivot;
        let tangent = (c - a) + 0.5 * a.distance_squared(c) * a;
        let per_sin_ac = tangent.length_recip();
        let tangent = tangent * per_sin_ac;
        // tan of half the angle from A to C′, as a fraction.
        let numerator = picked.y * (1.0 + a.dot(b));
        let denominator = picked.x * volume * per_sin_ac - picked.y * (b - a).dot(tangent);
        let (n2, d2) = (numerator * numerator, denominator * denominator);
        ((d2 - n2) * a + 2.0 * numerator * denominator * tangent) * (n2 + d2).recip()
    }
}
