//! Where a light is and which part of a ray it may shine on.

use glam::{DVec3, Vec3};
use std::f64::consts::FRAC_PI_2;
use std::ops::Range;

/// What rounding hides would be lost for good: cones are taken for this much wider, rad.
const SLACK: f64 = 1e-4;

/// Where a light is and where it shines to.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Reach {
    /// The middle of it, m.
    pub center: DVec3,
    /// The square of how far it reaches from there, m².
    pub radius2: f64,
    /// Outside of it, it is dark; `None` if it may shine everywhere.
    beam: Option<Beam>,
}

/// A cone with half an angle of at most 90°.
#[derive(Debug, Clone, Copy)]
struct Beam {
    apex: DVec3,
    axis: DVec3,
    cos: f64,
}

impl Reach {
    /// Around `center`, m; it is dark that far off the unit vector `axis`, rad, and if it is not two-sided, behind.
    pub(super) fn new(
        center: Vec3,
        radius2: f32,
        (axis, dark_from): (Vec3, f32),
        two_sided: bool,
    ) -> Self {
        let (center, radius2) = (center.as_dvec3(), f64::from(radius2));
        let angle = f64::from(dark_from) + SLACK;
        let axis = axis.as_dvec3().normalize();
        // Light from every point of the ball stays within a cone around it all.
        let beam = || Beam {
            apex: center - radius2.sqrt() / angle.sin() * axis,
            axis,
            cos: angle.cos().max(0.0),
        };
        let is_wide = two_sided || angle > FRAC_PI_2 + 2.0 * SLACK;
        Self { center, radius2, beam: (!is_wide).then(beam) }
    }

    /// The part of a ray's first `length` metres (may be infinite) that it may shine on; `None` if there is none.
    pub(crate) fn span(&self, origin: DVec3, direction: DVec3, length: f64) -> Option<Range<f64>> {
        match &self.beam {
            None => Some(0.0..length),
            Some(beam) => beam.span(origin, direction, length),
        }
    }

    /// Where a ray comes nearest to it, m along the ray, and how near that is, m, more than 0; a light that has an extent is never nearer
    /// than its surface is to its middle.
    pub(crate) fn nearest(&self, origin: DVec3, direction: DVec3) -> (f64, f64) {
        const LEAST: f64 = 1e-15;
        let to_center = self.center - origin;
        let nearest = to_center.dot(direction);
        let off = (to_center - nearest * direction).length_squared() + self.softness2();
        (nearest, off.sqrt().max(LEAST * (1.0 + nearest.abs())))
    }

    /// About how much of its light comes to a point, in no unit; never 0 if it has an extent.
    pub(crate) fn shine(&self, point: DVec3) -> f64 {
        const LEAST: f64 = 0.1;
        let to_point = point - self.center;
        let distance2 = to_point.length_squared() + self.softness2();
        let cos = |beam: &Beam| (to_point.dot(beam.axis) / distance2.sqrt()).max(0.0);
        self.beam.as_ref().map_or(1.0, |beam| LEAST + cos(beam)) / distance2
    }

    /// The square of how far its surface is from its middle, m²: a third of what its box is, as a sphere has it.
    fn softness2(&self) -> f64 {
        self.radius2 / 3.0
    }
}

impl Beam {
    /// Cut where the ray meets the cone or its mirror image, the part whose middle is inside. Cones are convex: there is only one.
    fn span(&self, origin: DVec3, direction: DVec3, length: f64) -> Option<Range<f64>> {
        let mut ends = [0.0, length, length, length];
        let cuts = self.cuts(origin, direction).map(|t| t.clamp(0.0, length));
        (ends[1], ends[2]) = (cuts[0].min(cuts[1]), cuts[0].max(cuts[1]));
        let inside = |piece: &&[f64]| {
            let middle = if piece[1].is_finite() {
                0.5 * (piece[0] + piece[1])
            } else {
                2.0 * piece[0] + 1.0
            };
            piece[0] < piece[1] && self.contains(origin + middle * direction)
        };
        let pieces = || ends.windows(2).filter(inside);
        Some(pieces().next()?[0]..pieces().next_back()?[1])
    }

    fn contains(&self, point: DVec3) -> bool {
        let from_apex = point - self.apex;
        from_apex.dot(self.axis) >= self.cos * from_apex.length()
    }

    /// Where (p · axis)² = cos² p², with p what the ray's points are from the apex.
    fn cuts(&self, origin: DVec3, direction: DVec3) -> [f64; 2] {
        let from_apex = origin - self.apex;
        let (across, before) = (direction.dot(self.axis), from_apex.dot(self.axis));
        let cos2 = self.cos * self.cos;
        let a = across * across - cos2 * direction.length_squared();
        let b = across * before - cos2 * direction.dot(from_apex);
        let c = before * before - cos2 * from_apex.length_squared();
        let root = (b * b - a * c).max(0.0).sqrt();
        let q = -(b + root.copysign(b));
        [q / a, c / q].map(|t| if t.is_nan() { 0.0 } else { t })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;
    use std::f32::consts::PI;

    /// Points of a ray from which something of the ball is seen inside of the cone are in the span, and its ends are where that ends.
    #[test]
    fn spans_are_where_light_may_be() {
        let (mut random, mut found) = (Random::new(5), [0; 2]);
        let mut number = |scale: f64| scale * (2.0 * random.unit() - 1.0);
        for _ in 0..2000 {
            let mut vector = |scale: f64| DVec3::from_array([0; 3].map(|_| number(scale)));
            let (axis, direction) = (vector(1.0).normalize().as_vec3(), vector(1.0).normalize());
            let (center, origin) = (vector(2.0).as_vec3(), vector(4.0));
            let angle = (0.05 + 1.5 * number(1.0).abs()) as f32;
            let length = if number(1.0) > 0.0 { f64::INFINITY } else { 5.0 };
            let reach = Reach::new(center, 0.0, (axis, angle), false);
            let span = reach.span(origin, direction, length);
            for _ in 0..50 {
                let t = 5.0 * number(1.0).abs();
                let from = origin + t * direction - center.as_dvec3();
                let off = from.normalize().dot(axis.as_dvec3().normalize()).clamp(-1.0, 1.0).acos();
                let known = span.as_ref().is_some_and(|span| span.contains(&t));
                if (off - f64::from(angle)).abs() > 1e-3 {
                    assert_eq!(
                        known,
                        off < f64::from(angle),
                        "{t} of {span:?} at {off} of {angle}"
                    );
                    found[usize::from(known)] += 1;
                }
            }
        }
        assert!(found.iter().all(|found| *found > 5000), "{found:?}");
    }

    #[test]
    fn what_shines_everywhere_is_cut_nowhere() {
        for (angle, two_sided) in [(1.5 * PI, false), (0.5 * PI, true)] {
            let reach = Reach::new(Vec3::ZERO, 1.0, (Vec3::Z, angle), two_sided);
            assert_eq!(reach.span(DVec3::ONE, DVec3::X, 7.0), Some(0.0..7.0));
        }
    }
}
