//! What moves while the shutter is open.

use glam::{DAffine3, DQuat, DVec3};

/// What a thing does while the scene's time runs from 0 to 1, at even speed: it turns and grows about a point, and goes
/// somewhere else with that point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// The point about which it turns and grows, m; at rest at time 0.
    pub pivot: DVec3,
    /// Unit vector that it turns about.
    pub axis: DVec3,
    /// How far it turns, rad, anticlockwise seen from the axis' tip; more than a whole turn if need be.
    pub angle: f64,
    /// How many times as large it is in the end; > 0.
    pub growth: f64,
    /// How far it goes, m.
    pub shift: DVec3,
}

impl Motion {
    /// Without turning or growing.
    pub fn shift(shift: DVec3) -> Self {
        Self { pivot: DVec3::ZERO, axis: DVec3::Z, angle: 0.0, growth: 1.0, shift }
    }

    /// Whether nothing happens.
    pub fn is_still(&self) -> bool {
        self.angle == 0.0 && self.growth == 1.0 && self.shift == DVec3::ZERO
    }

    /// From where things are at time 0 to where they are at `time`, 0..1.
    pub fn at(&self, time: f64) -> DAffine3 {
        let turn = DQuat::from_axis_angle(self.axis, time * self.angle);
        let scale = DVec3::splat(1.0 + time * (self.growth - 1.0));
        let place = self.pivot + time * self.shift;
        DAffine3::from_scale_rotation_translation(scale, turn, place)
            * DAffine3::from_translation(-self.pivot)
    }

    /// How far a point at most so far from the pivot, m, may be off the straight lines between where it is at `steps` + 1
    /// moments, evenly spread over the scene's time.
    ///
    /// A line between two points of a curve is off it by at most an eighth of the time between them squared times the
    /// largest acceleration. Here that is the one towards the axis, and the one across of what grows as it turns.
    pub(crate) fn bend(&self, radius: f64, steps: u32) -> f64 {
        let inward = self.angle * self.angle * self.growth.max(1.0);
        let across = 2.0 * (self.angle * (self.growth - 1.0)).abs();
        radius * (inward + across) / (8.0 * f64::from(steps).powi(2))
    }
}
