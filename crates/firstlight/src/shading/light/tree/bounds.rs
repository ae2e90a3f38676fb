//! Where lights are and where they shine to: boxes, cones and intensities, and how much of it may reach a point.

use crate::geometry::Bounds;
use glam::Vec3;
use std::f32::consts::{FRAC_PI_2, PI};

/// What is known of a light, or of several, without asking them one by one.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LightBounds {
    /// Where they are.
    pub bounds: Bounds,
    /// Where they shine to.
    pub cone: EmissionCone,
    /// What they give per solid angle along their axes, at most, W·sr⁻¹.
    pub intensity: f32,
}

/// Directions of lights: their axes lie within an angle of one axis, and they shine within another angle around theirs.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EmissionCone {
    /// Unit vector.
    pub axis: Vec3,
    /// Angle around `axis` that holds all axes, θ_o, rad.
    pub spread: f32,
    /// Angle around each of them from which on it is dark, θ_e, rad.
    pub falloff: f32,
    /// Whether it is the same in the opposite direction.
    pub two_sided: bool,
}

impl EmissionCone {
    /// Shines everywhere alike.
    pub(crate) const EVERYWHERE: Self =
        Self { axis: Vec3::Z, spread: PI, falloff: FRAC_PI_2, two_sided: false };

    /// A flat surface, as Lambert has it.
    pub(crate) fn flat(normal: Vec3, two_sided: bool) -> Self {
        Self { axis: normal, spread: 0.0, falloff: FRAC_PI_2, two_sided }
    }

    /// The smallest cone around both (Conty & Kulla 2018, algorithm 1).
    pub(super) fn union(self, other: Self) -> Self {
        let (wide, narrow) =
            if self.spread >= other.spread { (self, other) } else { (other, self) };
        let falloff = wide.falloff.max(narrow.falloff);
        let two_sided = wide.two_sided || narrow.two_sided;
        let between = wide.axis.dot(narrow.axis).clamp(-1.0, 1.0).acos();
        if (between + narrow.spread).min(PI) <= wide.spread {
            return Self { falloff, two_sided, ..wide };
        }
        let spread = 0.5 * (wide.spread + between + narrow.spread);
        let across = (narrow.axis - wide.axis * wide.axis.dot(narrow.axis)).try_normalize();
        match across {
            Some(across) if spread < PI => {
                let (sin, cos) = (spread - wide.spread).sin_cos();
                let axis = (cos * wide.axis + sin * across).normalize();
                Self { axis, spread, falloff, two_sided }
            }
            _ => Self { spread: PI, falloff, two_sided, ..wide },
        }
    }

    /// How many directions it covers, weighted by how bright they may be (their M_Ω).
    pub(super) fn measure(self) -> f32 {
        let (spread, wide) = (self.spread, (self.spread + self.falloff).min(PI));
        let (sin, cos) = spread.sin_cos();
        let rim = 2.0 * wide * sin - (spread - 2.0 * wide).cos() - 2.0 * spread * sin + cos;
        2.0 * PI * (1.0 - cos) + FRAC_PI_2 * rim
    }
}

impl LightBounds {
    pub(super) fn union(self, other: Self) -> Self {
        // What gives nothing shines nowhere.
        if self.intensity == 0.0 || other.intensity == 0.0 {
            let bounds = self.bounds.union(other.bounds);
            return Self { bounds, ..if self.intensity > 0.0 { self } else { other } };
        }
        Self {
            bounds: self.bounds.union(other.bounds),
            cone: self.cone.union(other.cone),
            intensity: self.intensity + other.intensity,
        }
    }
}
