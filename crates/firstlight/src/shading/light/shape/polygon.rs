//! Triangles and parallelograms, sampled by solid angle: each direction that meets them is picked alike.
//!
//! The way of Arvo, *Stratified Sampling of Spherical Triangles*, 1995: a triangle A, B, C on the unit sphere is cut
//! from B to a point C′ between A and C, so that the area of A, B, C′ is the first number's part of the whole; the
//! second number picks a point between B and C′. C′ comes from the formula of Van Oosterom & Strackee 1983,
//! tan(Ω/2) = A·(B×C′) / (1 + A·B + B·C′ + C′·A), which needs no angles and loses no digits on small triangles.
//! A parallelogram is a fan of two such triangles around one corner, so that the picked point moves without a jump
//! over both.

use super::ShapeSample;
use crate::geometry::Bounds;
use glam::{DAffine3, DVec2, DVec3};

/// A triangle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Triangle {
    /// The first corner, m.
    corner: DVec3,
    /// From there to the other two, m.
    edges: [DVec3; 2],
}

/// A parallelogram.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Parallelogram {
    /// The corner between both edges, m.
    corner: DVec3,
    /// The edges, m.
    edges: [DVec3; 2],
}

impl Triangle {
    /// The triangle with these corners; its front is where they run anticlockwise.
    pub(crate) fn new([a, b, c]: [DVec3; 3]) -> Self {
        Self { corner: a, edges: [b - a, c - a] }
    }

    pub(super) fn sample(&self, from: DVec3, u: DVec2) -> Option<ShapeSample> {
        let triangle = self.seen(from);
        let direction = triangle.direction(u);
        let place = within_triangle(on_plane(self.corner - from, self.edges, direction));
        sample(from, self.corner, self.edges, place, 1.0 / triangle.solid_angle)
    }

    pub(super) fn pdf(&self, from: DVec3) -> f64 {
        self.seen(from).solid_angle.recip()
    }

    pub(super) fn normal(&self) -> DVec3 {
        self.edges[0].cross(self.edges[1]).normalize_or_zero()
    }

    pub(super) fn bounds(&self) -> Bounds {
        let [u, v] = self.edges;
        let ends = [DVec3::ZERO, u, v];
        Bounds::around(ends.map(|end| (self.corner + end).as_vec3()))
    }

    pub(super) fn area(&self) -> f64 {
        0.5 * self.edges[0].cross(self.edges[1]).length()
    }

    fn seen(&self, from: DVec3) -> SphericalTriangle {
        let a = self.corner - from;
        SphericalTriangle::new([a + self.edges[0], a, a + self.edges[1]])
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
        Self { corner: to_world.translation, edges }
    }

    pub(super) fn sample(&self, from: DVec3, u: DVec2) -> Option<ShapeSample> {
        let fan = self.seen(from);
        let solid_angle = fan[0].solid_angle + fan[1].solid_angle;
        let picked = u.x * solid_angle;
        let (triangle, rest) = match picked - fan[0].solid_angle {
            rest if rest < 0.0 => (&fan[0], picked),
            rest => (&fan[1], rest),
        };
        let direction = triangle.direction(DVec2::new(rest / triangle.solid_angle, u.y));
        let place = on_plane(self.corner - from, self.edges, direction);
        let place = place.clamp(DVec2::ZERO, DVec2::ONE);
        sample(from, self.corner, self.edges, place, 1.0 / solid_angle)
    }

    pub(super) fn pdf(&self, from: DVec3) -> f64 {
        let fan = self.seen(from);
        1.0 / (fan[0].solid_angle + fan[1].solid_angle)
    }

    pub(super) fn normal(&self) -> DVec3 {
        self.edges[0].cross(self.edges[1]).normalize_or_zero()
    }

    pub(super) fn bounds(&self) -> Bounds {
        let [u, v] = self.edges;
        let ends = [DVec3::ZERO, u, v, u + v];
        Bounds::around(ends.map(|end| (self.corner + end).as_vec3()))
    }

    pub(super) fn area(&self) -> f64 {
        self.edges[0].cross(self.edges[1]).length()
    }

    fn seen(&self, from: DVec3) -> [SphericalTriangle; 2] {
        let a = self.corner - from;
        let (b, d) = (a + self.edges[0], a + self.edges[1]);
        let c = b + self.edges[1];
        [SphericalTriangle::new([b, a, c]), SphericalTriangle::new([c, a, d])]
    }
}

/// The point with coordinates `place` along the edges.
fn sample(
    from: DVec3,
    corner: DVec3,
    edges: [DVec3; 2],
    place: DVec2,
    pdf: f64,
) -> Option<ShapeSample> {
    let position = corner + place.x * edges[0] + place.y * edges[1];
    ShapeSample::new(from, position, edges[0].cross(edges[1]).normalize(), pdf)
}

/// Where the plane of two edges, from `corner` as seen by the eye, is met in `direction`: coordinates along the edges.
fn on_plane(corner: DVec3, edges: [DVec3; 2], direction: DVec3) -> DVec2 {
    let normal = edges[0].cross(edges[1]);
    let met = direction * (normal.dot(corner) / normal.dot(direction)) - corner;
    DVec2::new(met.cross(edges[1]).dot(normal), edges[0].cross(met).dot(normal))
        / normal.length_squared()
}

/// Rounding may leave a point just outside its triangle.
fn within_triangle(place: DVec2) -> DVec2 {
    let place = place.max(DVec2::ZERO);
    place / (place.x + place.y).max(1.0)
}

/// A triangle on the unit sphere around the eye.
struct SphericalTriangle {
    /// The corners A, B, C, unit vectors.
    corners: [DVec3; 3],
    /// |A·(B×C)|.
    volume: f64,
    /// sr
    solid_angle: f64,
}

impl SphericalTriangle {
    /// `corners`: A, B and C as seen from the eye, m.
    fn new(corners: [DVec3; 3]) -> Self {
        let [a, b, c] = corners;
        let lengths = corners.map(DVec3::length);
        let [la, lb, lc] = lengths;
        let volume = a.dot((b - a).cross(c - a)).abs() / (la * lb * lc);
        let corners = [a / la, b / lb, c / lc];
        let [a, b, c] = corners;
        let solid_angle = 2.0 * volume.atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a));
        Self { corners, volume, solid_angle }
    }

    /// A direction inside, each alike.
    fn direction(&self, u: DVec2) -> DVec3 {
        let [_, b, _] = self.corners;
        let cut = self.cut(u.x);
        let one_minus_cos = 0.5 * b.distance_squared(cut);
        let across = (cut - b) + one_minus_cos * b;
        let picked = u.y * one_minus_cos;
        let sin = (picked * (2.0 - picked)).max(0.0).sqrt();
        (1.0 - picked) * b + sin * across.normalize_or_zero()
    }

    /// C′ between A and C, so that A, B, C′ has the given part of the area.
    fn cut(&self, part: f64) -> DVec3 {
        let [a, b, c] = self.corners;
        let tangent = (c - a) + 0.5 * a.distance_squared(c) * a;
        let sin_ac = tangent.length();
        let tangent = tangent / sin_ac;
        let (sin, cos) = (0.5 * part * self.solid_angle).sin_cos();
        // tan of half the angle from A to C′, as a fraction.
        let numerator = sin * (1.0 + a.dot(b));
        let denominator = cos * self.volume / sin_ac - sin * (b - a).dot(tangent);
        let (n2, d2) = (numerator * numerator, denominator * denominator);
        ((d2 - n2) * a + 2.0 * numerator * denominator * tangent) / (n2 + d2)
    }
}
