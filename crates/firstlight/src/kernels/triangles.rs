//! Rays against triangles, watertight.
//!
//! Woop, Benthin, Wald, *Watertight Ray/Triangle Intersection*, JCGT 2(1), 2013, with two deviations: edges that come
//! out exactly zero count as inside (no second evaluation: at worst a ray hits both neighbours, never neither), and
//! the distance of a triangle that was hit is computed again in double precision, so that its sign is right for rays
//! that start next to it (see [`plane_distance`]). No fused operation takes part in either, and one ray against eight
//! triangles takes the same roundings as many rays against one, so that every way gives the same bits.

use super::layout::{Axis, Tree, TriangleBlock};
use super::traverse::{SMALLEST, Search};
use crate::geometry::triangle::plane_distance;
use crate::geometry::{Hit, Ray};
use crate::simd::{Eight, Lanes, Mask, Simd, Vectors};
use glam::Vec3;

/// Rays prepared for triangles: shears that make them the z axis. One ray in every lane, or as many as there are lanes.
#[derive(Clone, Copy)]
pub(super) struct Shear<V: Vectors> {
    /// The order of the axes; the last is the rays' largest.
    pub axes: [Axis; 3],
    /// Shear along the first two, and the origin in this order.
    pub shear: [V::F; 2],
    pub origin: [V::F; 3],
}

/// The order of the axes for a ray whose largest is number `z`: from a table, as nobody could foresee a branch.
#[inline(always)]
pub(super) fn axes(z: usize) -> [Axis; 3] {
    const ORDERS: [[Axis; 3]; 4] = [
        [Axis::Y, Axis::Z, Axis::X],
        [Axis::Z, Axis::X, Axis::Y],
        [Axis::X, Axis::Y, Axis::Z],
        [Axis::X, Axis::Y, Axis::Z],
    ];
    ORDERS[z % 4]
}

/// The reciprocal of a direction's coordinate, which is kept away from zero.
#[inline(always)]
pub(super) fn reciprocal(x: f32) -> f32 {
    1.0 / x.abs().max(SMALLEST).copysign(x)
}

impl<V: Vectors> Shear<V> {
    /// A point's x, y, z, in the order of `axes`, with the rays as z axis: x and y.
    #[inline(always)]
    pub(super) fn apply(&self, x: V::F, y: V::F, z: V::F) -> (V::F, V::F) {
        let z = z - self.origin[2];
        (x - self.origin[0] - self.shear[0] * z, y - self.origin[1] - self.shear[1] * z)
    }
}

impl<S: Simd> Shear<S> {
    /// One ray in every lane.
    #[inline(always)]
    pub(super) fn of_ray(simd: S, ray: &Ray) -> Self {
        let (o, d) = (ray.origin, ray.direction);
        let axes = axes(d.abs().max_position());
        let [x, y, z] = axes.map(|axis| axis as usize);
        let scale = reciprocal(d[z]);
        Self {
            axes,
            shear: [simd.splat(d[x] * scale), simd.splat(d[y] * scale)],
            origin: [simd.splat(o[x]), simd.splat(o[y]), simd.splat(o[z])],
        }
    }

    /// One ray: which triangles of a block its line crosses, and the weights of their corners (not normalised).
    #[inline(always)]
    pub(super) fn cross_block(&self, simd: S, block: &TriangleBlock) -> (u32, [S::F; 3]) {
        let (x, y) = self.apply(
            simd.load(block.row(self.axes[0])),
            simd.load(block.row(self.axes[1])),
            simd.load(block.row(self.axes[2])),
        );
        let [a, b, c] = &block.corners;
        cross(
            simd,
            (x.permute(a), y.permute(a)),
            (x.permute(b), y.permute(b)),
            (x.permute(c), y.permute(c)),
        )
    }
}

/// Which lanes' lines cross their triangle, whose corners are given across the line, and the weights of the corners
/// (not normalised). Products and differences are rounded one by one, so that neighbours agree about their edge.
#[inline(always)]
pub(super) fn cross<F: Lanes>(
    simd: impl Vectors<F = F>,
    a: (F, F),
    b: (F, F),
    c: (F, F),
) -> (u32, [F; 3]) {
    let u = c.0 * b.1 - c.1 * b.0;
    let v = a.0 * c.1 - a.1 * c.0;
    let w = b.0 * a.1 - b.1 * a.0;
    let zero = simd.splat(0.0);
    let inside = zero.le(u.min(v).min(w));
    let behind = u.max(v).max(w).le(zero);
    (((inside | behind) & (u + v + w).ne(zero)).bits(), [u, v, w])
}

/// The scalar end of the triangle test: distance, range, order, filter. `ray` is in the tree's space. Returns whether
/// `hit` was replaced.
#[inline(always)]
pub(super) fn accept<S>(
    search: &Search<S>,
    ray: &Ray,
    (tree, block, lane): (&Tree, &TriangleBlock, usize),
    weights: [f32; 3],
    surface: u32,
    hit: &mut Hit,
) -> bool {
    let scale = 1.0 / (weights[0] + weights[1] + weights[2]);
    let t = distance(ray, block.triangle(lane), weights, scale);
    if !(t > ray.t_min && t <= hit.t) {
        return false;
    }
    let word = tree.word(block, lane);
    let (u, v) = (weights[1] * scale, weights[2] * scale);
    let candidate = Hit { t, u, v, surface, primitive: word.number() };
    if hit.is_some() && !candidate.is_before(hit) {
        return false;
    }
    let asked = word.flags() & search.flags != 0;
    if asked && !search.filter.accepts(search.ray, &candidate, from_behind(ray, block, lane)) {
        return false;
    }
    *hit = candidate;
    true
}

/// Distance to a triangle that was hit; for one without area, to the point with the given weights times `scale`.
#[inline(always)]
fn distance(ray: &Ray, corners: [Vec3; 3], weights: [f32; 3], scale: f32) -> f32 {
    let t = plane_distance(ray.origin, ray.direction, corners);
    if t.is_finite() {
        return t;
    }
    let point = weights[0] * corners[0] + weights[1] * corners[1] + weights[2] * corners[2];
    (point * scale - ray.origin).dot(ray.direction) / ray.direction.length_squared()
}

/// [`plane_distance`] of rays to one triangle, with the same roundings.
#[inline(always)]
pub(super) fn plane_distances<V: Vectors>(
    simd: V,
    origin: [V::F; 3],
    direction: [V::F; 3],
    corners: [Vec3; 3],
) -> V::F {
    let [a, b, c] = [corners[0].as_dvec3(), corners[1].as_dvec3(), corners[2].as_dvec3()];
    let normal = (b - a).cross(c - a);
    let [ox, oy, oz] = [origin[0].to_doubles(), origin[1].to_doubles(), origin[2].to_doubles()];
    let [dx, dy, dz] =
        [direction[0].to_doubles(), direction[1].to_doubles(), direction[2].to_doubles()];
    let [nx, ny, nz] =
        [simd.splat_f64(normal.x), simd.splat_f64(normal.y), simd.splat_f64(normal.z)];
    let [ax, ay, az] = [simd.splat_f64(a.x), simd.splat_f64(a.y), simd.splat_f64(a.z)];
    let along = [
        nx * (ax - ox[0]) + ny * (ay - oy[0]) + nz * (az - oz[0]),
        nx * (ax - ox[1]) + ny * (ay - oy[1]) + nz * (az - oz[1]),
    ];
    let slope = [nx * dx[0] + ny * dy[0] + nz * dz[0], nx * dx[1] + ny * dy[1] + nz * dz[1]];
    V::F::from_doubles(along) / V::F::from_doubles(slope)
}

#[inline(never)]
fn from_behind(ray: &Ray, block: &TriangleBlock, lane: usize) -> bool {
    let [a, b, c] = block.triangle(lane).map(Vec3::as_dvec3);
    (b - a).cross(c - a).dot(ray.direction.as_dvec3()) > 0.0
}
