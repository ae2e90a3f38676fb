//! Axis-aligned boxes.

use crate::scene::description::Motion;
use glam::{DAffine3, DVec3, Vec3};
use std::f64::consts::PI;

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

    /// Its eight corners.
    pub(crate) fn corners(self) -> impl Iterator<Item = DVec3> {
        let ends = [self.lo.as_dvec3(), self.hi.as_dvec3()];
        (0..8_usize).map(move |corner| {
            let pick = |axis: usize| ends[corner >> axis & 1][axis];
            DVec3::new(pick(0), pick(1), pick(2))
        })
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

impl Bounds {
    /// The box around everywhere that what is in it comes to by `motion`, if it moves.
    pub(crate) fn moving(self, motion: Option<&Motion>) -> Self {
        let Some(motion) = motion else { return self };
        Self::swept(self.lo.as_dvec3(), self.hi.as_dvec3(), &DAffine3::IDENTITY, motion)
    }

    /// A box around the image of the box `lo..hi` under `map`, and everywhere it comes to by `motion`, if it moves.
    pub(crate) fn of_moving(lo: DVec3, hi: DVec3, map: &DAffine3, motion: Option<&Motion>) -> Self {
        match motion {
            None => Self::of_mapped(lo, hi, map),
            Some(motion) => Self::swept(lo, hi, map, motion),
        }
    }

    /// A box around everywhere that the image of the box `lo..hi` under `map` comes to by `motion`.
    ///
    /// Between two moments, points keep to the straight lines between where they are then, but for [`Motion::bend`].
    fn swept(lo: DVec3, hi: DVec3, map: &DAffine3, motion: &Motion) -> Self {
        const FINEST: f64 = PI / 64.0;
        const MOST: f64 = 4096.0;
        let steps = (motion.angle.abs() / FINEST).clamp(1.0, MOST).ceil() as u32;
        let at_rest = Self::of_mapped(lo, hi, map);
        let [lower, upper] = [at_rest.lo, at_rest.hi].map(|corner| corner.as_dvec3());
        let radius = (lower - motion.pivot).abs().max((upper - motion.pivot).abs()).length();
        let moments = (0..=steps).map(|step| motion.at(f64::from(step) / f64::from(steps)));
        let boxes = moments.map(|moved| Self::of_mapped(lo, hi, &(moved * *map)));
        let bend = DVec3::splat(motion.bend(radius, steps));
        let Self { lo, hi } = boxes.fold(Self::EMPTY, Self::union);
        Self { lo: below(lo.as_dvec3() - bend), hi: above(hi.as_dvec3() + bend) }
    }
}

fn below(p: DVec3) -> Vec3 {
    Vec3::new(p.x as f32, p.y as f32, p.z as f32).map(f32::next_down)
}

fn above(p: DVec3) -> Vec3 {
    Vec3::new(p.x as f32, p.y as f32, p.z as f32).map(f32::next_up)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;
    use glam::{DMat3, DQuat};

    fn random_map(random: &mut Random) -> DAffine3 {
        let turn =
            DMat3::from_quat(DQuat::from_axis_angle(random.direction(), 7.0 * random.unit()));
        DAffine3::from_mat3_translation(turn * (0.1 + random.unit()), 3.0 * random.point())
    }

    /// Wherever a point of a box comes to, by however many turns, the box around the motion has it; and it is not much larger
    /// than it needs to be.
    #[test]
    fn boxes_of_what_moves_hold_it_at_every_time() {
        let mut random = Random::new(4);
        for number in 0..400 {
            let (map, angle) = (random_map(&mut random), 100.0 * (random.unit() - 0.5).powi(3));
            let motion = Motion {
                pivot: 4.0 * random.point(),
                axis: random.direction(),
                angle: if number % 4 == 0 { 0.0 } else { angle },
                growth: 0.1 + 3.0 * random.unit(),
                shift: 2.0 * random.point(),
            };
            let half = random.point().abs();
            let bounds = Bounds::of_moving(-half, half, &map, Some(&motion));
            let mut met = Bounds::EMPTY;
            for _ in 0..2000 {
                // Corners, which come furthest, at any time, and more often near the ends.
                let corner = half * random.point().signum();
                let time = (1.5 * random.unit() - 0.25).clamp(0.0, 1.0);
                let p = motion.at(time).transform_point3(map.transform_point3(corner));
                let inside = p.cmpge(bounds.lo.as_dvec3()) & p.cmple(bounds.hi.as_dvec3());
                assert!(inside.all(), "{p} at {time} is not in {bounds:?}: {motion:?}");
                met = met.union(Bounds::around([p.as_vec3()]));
            }
            let [size, needed] = [bounds, met].map(|b| (b.hi - b.lo).max_element());
            assert!(size < 1.5 * needed, "{size} for {needed}: {motion:?}");
        }
    }
}
