//! A ray and what traversal answers.

use bytemuck::{Pod, Zeroable, cast_ref};
use glam::Vec3;
use std::f32::consts::PI;

/// A half-line with a range: the points `origin + t · direction`, `t_min < t ≤ t_max`.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Ray {
    /// Where t = 0, m.
    pub origin: Vec3,
    /// Unit vector in world space; in an instance's own space its length carries the scale.
    pub direction: Vec3,
    /// Start of the range, exclusive, ≥ 0.
    pub t_min: f32,
    /// End of the range, inclusive.
    pub t_max: f32,
    /// When, as a part of the scene's time, 0..1: where things are that move.
    pub time: f32,
}

impl Ray {
    /// The ray from `origin` in the unit direction `direction` without end, at time 0.
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        Self { origin, direction, t_min: 0.0, t_max: f32::INFINITY, time: 0.0 }
    }

    /// Origin, direction, start and end of the range, as they lie in memory.
    #[inline(always)]
    pub(crate) fn numbers(&self) -> &[f32; 8] {
        let all: &[f32; 9] = cast_ref(self);
        all.first_chunk().unwrap_or_else(|| unreachable!("nine are more than eight"))
    }

    /// The signs of the direction along x, y, z as bits.
    #[inline(always)]
    pub(crate) fn octant(&self) -> u32 {
        self.direction.is_negative_bitmask()
    }

    /// The point at `t`, as rounded as the lecture's blunder needs it.
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + t * self.direction
    }
}

/// [`Hit::surface`] of a ray that hit nothing.
pub(crate) const NOTHING: u32 = u32::MAX;

/// What a ray hit: traversal's raw answer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Where along the ray; the end of its range if it hit nothing.
    pub t: f32,
    /// Weight of a triangle's second corner.
    pub u: f32,
    /// Weight of a triangle's third corner.
    pub v: f32,
    /// Index of the surface in the description's list; no surface has the number `u32::MAX`.
    pub surface: u32,
    /// Triangle of a mesh, part of an analytic surface.
    pub primitive: u32,
}

impl Hit {
    /// No hit up to `t_max`.
    pub(crate) fn none(t_max: f32) -> Self {
        Self { t: t_max, u: 0.0, v: 0.0, surface: NOTHING, primitive: 0 }
    }

    /// Whether something was hit.
    #[inline(always)]
    pub fn is_some(&self) -> bool {
        self.surface != NOTHING
    }

    /// Whether this hit comes before `other`; equal distances are ordered by identity, so that the answer does
    /// not depend on the order of traversal.
    #[inline(always)]
    pub(crate) fn is_before(&self, other: &Hit) -> bool {
        let identity = (self.surface, self.primitive);
        self.t < other.t || (self.t == other.t && identity < (other.surface, other.primitive))
    }
}
/// What a ray and those beside it see together, as far as textures are concerned: a cone around the ray.
///
/// Amanatides, *Ray Tracing with Cones*, 1984; Akenine-Möller et al., *Texture Level of Detail Strategies for Real-Time Ray
/// Tracing*, Ray Tracing Gems ch. 20, 2019.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Cone {
    /// Width where the ray starts, m.
    pub width: f32,
    /// How much wider it gets per length of the ray.
    pub spread: f32,
}

impl Cone {
    /// The cone after so much of the ray, m.
    pub(crate) fn after(self, distance: f32) -> Self {
        Self { width: self.width + self.spread * distance, ..self }
    }

    /// The cone in a direction that [stands for](Cone::part) others.
    pub(crate) fn scattered(self, part: f32) -> Self {
        Self { spread: self.spread.max(part), ..self }
    }

    /// The spread that stands for a direction that was picked with a density, sr⁻¹: of a part of all directions that it stands
    /// for, so that many paths together blur nothing that matters.
    #[inline(always)]
    pub(crate) fn part(pdf: f32) -> f32 {
        const PART: f32 = 0.2;
        (PART / (PI * pdf).sqrt()).min(PART)
    }
}
