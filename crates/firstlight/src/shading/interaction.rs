//! All that is known about the point a ray hit, and where the next ray starts.

use crate::geometry::Hit;
use crate::math::tangents;
use glam::{Vec2, Vec3};

/// A point of a surface, seen from one side.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SurfaceInteraction {
    /// Traversal's answer.
    pub hit: Hit,
    /// Where, m; the surface's own point, not `o + t·d`.
    pub position: Vec3,
    /// Distance along the geometric normal that clears every rounding error of `position`, m.
    pub clearance: f32,
    /// How far `position` lies below the smooth surface that the normals suggest, as a vector, m.
    pub lift: Vec3,
    /// Whether it is the front of the surface that is seen.
    pub front: bool,
    /// Unit normal of the surface as it is, on the side of the eye.
    pub geometric_normal: Vec3,
    /// Unit normal of the surface as it should look, on the same side.
    pub shading_normal: Vec3,
    /// Texture coordinates, first set.
    pub uv: Vec2,
    /// Width of the cone around the ray that stands for its neighbours, m; 0: it is seen by a ray alone.
    pub seen_width: f32,
    /// Unit direction of the ray.
    pub seen_along: Vec3,
    /// When it is seen, see [`Ray::time`](crate::Ray::time).
    pub time: f32,
    /// Linear RGBA vertex colour, 1 if there is none.
    pub color: [f32; 4],
}

impl SurfaceInteraction {
    /// The axes of the ellipse that the ray's cone cuts out of the surface, from end to end, m. At grazing angles it is
    /// as long as at a twentieth of a right angle's cosine.
    pub(crate) fn seen_axes(&self) -> [Vec3; 2] {
        let (normal, along) = (self.geometric_normal, self.seen_along);
        let flat = along - along.dot(normal) * normal;
        let Some(long) = flat.try_normalize() else {
            let (a, b) = tangents(normal.as_dvec3());
            return [a, b].map(|axis| self.seen_width * axis.as_vec3());
        };
        let cos = along.dot(normal).abs().max(0.05);
        [self.seen_width / cos * long, self.seen_width * normal.cross(long)]
    }

    /// Where rays that leave on the other side start, t_min = 0: just behind the surface.
    #[inline(always)]
    pub(crate) fn behind(&self) -> Vec3 {
        self.position - self.clearance * self.geometric_normal
    }

    /// Where rays that leave on the side of the eye start, t_min = 0: just off the surface, so that they cannot
    /// hit what they leave, and on the smooth surface instead of its facets.
    ///
    /// Pharr, Jakob, Humphreys, *Physically Based Rendering* §6.8, with positions in double precision, so that the
    /// distance is a rounding error of the coordinates themselves. The lift: Hanika, *Hacking the Shadow Terminator*,
    /// Ray Tracing Gems II ch. 4.
    #[inline(always)]
    pub(crate) fn ray_origin(&self) -> Vec3 {
        self.position + self.lift + self.clearance * self.geometric_normal
    }
}

/// [`SurfaceInteraction::clearance`] of a point with the given unit normal.
///
/// `rounded`: absolute values of every number that was rounded to f32 on the way, per axis; `error`: how far off
/// they were before, m. Each f32 is off by half an ulp, and so is the sum with the clearance; the
/// factor of two is margin.
#[inline(always)]
pub(crate) fn clearance(normal: Vec3, rounded: Vec3, error: f64) -> f32 {
    2.0 * f32::EPSILON * normal.abs().dot(rounded) + error as f32
}

/// [`SurfaceInteraction::lift`] of the point with weights `weights` between three corners with unit normals.
///
/// The point is projected onto the tangent plane of each corner that lies above it; the results are mixed by the
/// same weights. All normals are on the side of the eye, which mirrors the surface for its back.
#[inline(always)]
pub(crate) fn lift(point: Vec3, corners: [Vec3; 3], normals: [Vec3; 3], weights: [f32; 3]) -> Vec3 {
    let below = |i: usize| (point - corners[i]).dot(normals[i]).min(0.0);
    (0..3).map(|i| -weights[i] * below(i) * normals[i]).sum()
}
