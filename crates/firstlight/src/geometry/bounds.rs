//! Axis-aligned boxes.

use glam::{DAffine3, DVec3, Vec3};

/// An axis-aligned box; empty if `lo > hi`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Bounds {
    /// Smallest coordinates.
    pub lo: Vec3,
    /// Largest coordinates.
    pub hi: Vec3,
}

impl Bounds {
    /// Contains nothing.
    pub(crate) const EMPTY: Self = Self { lo: Vec3::INFINITY, hi: Vec3::NEG_INFINITY };

    /// The smallest box around the given points.
    pub(crate) fn around(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |b, p| Self { lo: b.lo.min(p), hi: b.hi.max(p) })
    }

    /// The smallest box around both.
    #[inline]
    pub(crate) fn union(self, other: Self) -> Self {
        Self { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }

    /// Half the surface area; 0 for an empty box.
    #[inline]
    pub(crate) fn half_area(self) -> f32 {
        let d = (self.hi - self.lo).max(Vec3::ZERO);
        d.x * d.y + d.y * d.z + d.z * d.x
    }

    /// Whether it contains nothing.
    pub(crate) fn is_empty(self) -> bool {
        !(self.lo.cmple(self.hi).all())
    }

    /// The largest absolute coordinate.
    #[inline]
    pub(crate) fn reach(self) -> f32 {
        if self.is_empty() { 0.0 } else { self.lo.abs().max(self.hi.abs()).max_element() }
    }

    /// A box around the image of the box `lo..hi` under `map`, rounded outward.
    pub(crate) fn of_mapped(lo: DVec3, hi: DVec3, map: &DAffine3) -> Self {
        let center = map.transform_point3((lo + hi) * 0.5);
        let half = (hi - lo) * 0.5;
        let m = map.matrix3;
        let extent = m.x_axis.abs() * half.x + m.y_axis.abs() * half.y + m.z_axis.abs() * half.z;
        Self { lo: below(center - extent), hi: above(center + extent) }
    }
}

fn below(p: DVec3) -> Vec3 {
    Vec3::new(p.x as f32, p.y as f32, p.z as f32).map(f32::next_down)
}

fn above(p: DVec3) -> Vec3 {
    Vec3::new(p.x as f32, p.y as f32, p.z as f32).map(f32::next_up)
}
