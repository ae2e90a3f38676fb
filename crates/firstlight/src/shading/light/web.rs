//! What a measured luminaire gives in a direction.

use crate::scene::description::{Goniometer, PhotometricWeb};
use glam::DVec3;
use std::f64::consts::TAU;

impl PhotometricWeb {
    /// Luminous intensity in a unit direction of the luminaire's own space (its axis is −z), cd: straight lines between the
    /// measured angles.
    pub(crate) fn intensity(&self, direction: DVec3) -> f32 {
        let DVec3 { x, y, z: up } = direction;
        // Not −up: a negative zero would turn what lies across by 180°.
        let z = 0.0 - up;
        let across = |c: f64| c.clamp(-1.0, 1.0).asin();
        let (horizontal, vertical) = match self.goniometer {
            Goniometer::C => (y.atan2(x).rem_euclid(TAU), z.clamp(-1.0, 1.0).acos()),
            Goniometer::B => (across(x), y.atan2(z)),
            Goniometer::A => (x.atan2(z), across(y)),
        };
        let turns = self.goniometer == Goniometer::C;
        let around = if turns {
            turn(&self.horizontal, horizontal)
        } else {
            side(&self.horizontal, horizontal)
        };
        let (Some(around), Some(along)) = (around, side(&self.vertical, vertical)) else {
            return 0.0;
        };
        let at = |plane: usize, row: usize| self.intensities[plane * self.vertical.len() + row];
        let plane = |plane| along.mix(|row| at(plane, row));
        around.mix(plane)
    }

    /// Luminous flux of all directions, lm, by midpoints of small parts of the sphere.
    pub fn flux(&self) -> f64 {
        const PARTS: u32 = 512;
        let middle = |i: u32| (f64::from(i) + 0.5) / f64::from(PARTS);
        let part = |i: u32| {
            let z = 1.0 - 2.0 * middle(i % PARTS);
            let (sin, cos) = (TAU * middle(i / PARTS)).sin_cos();
            let across = (1.0 - z * z).sqrt();
            f64::from(self.intensity(DVec3::new(across * cos, across * sin, z)))
        };
        2.0 * TAU * (0..PARTS * PARTS).map(part).sum::<f64>() / f64::from(PARTS * PARTS)
    }

    /// The largest intensity, cd.
    pub fn brightest(&self) -> f32 {
        self.intensities.iter().copied().fold(0.0, f32::max)
    }
}

/// A place between two entries of a list.
struct Between {
    entries: [usize; 2],
    /// How far it is from the first, 0..1.
    part: f32,
}

impl Between {
    fn mix(&self, value: impl Fn(usize) -> f32) -> f32 {
        let [first, second] = self.entries.map(value);
        first + self.part * (second - first)
    }
}

/// The place of an angle in an ascending list; `None` if it lies outside. Lists from 0 on hold for both sides.
fn side(angles: &[f64], angle: f64) -> Option<Between> {
    let angle = if angles[0] == 0.0 { angle.abs() } else { angle };
    let last = angles.len() - 1;
    if angle < angles[0] || angle > angles[last] {
        return None;
    }
    let after = angles.partition_point(|&a| a <= angle).clamp(1, last.max(1));
    let entries = [after - 1, after.min(last)];
    Some(between(entries, angles[entries[0]], angles[entries[1]], angle))
}

/// The place of an angle in an ascending list that starts again after a whole turn.
fn turn(angles: &[f64], angle: f64) -> Option<Between> {
    let after = angles.partition_point(|&a| a <= angle);
    let before = (after + angles.len() - 1) % angles.len();
    let from = if after == 0 { angles[before] - TAU } else { angles[before] };
    let to = angles.get(after).map_or(angles[0] + TAU, |&to| to);
    Some(between([before, after % angles.len()], from, to, angle))
}

fn between(entries: [usize; 2], from: f64, to: f64, angle: f64) -> Between {
    let part = if to > from { (angle - from) / (to - from) } else { 0.0 };
    Between { entries, part: part as f32 }
}
