//! One light out of many, picked by how much it may give to a point.
//!
//! Conty Estevez & Kulla, *Importance Sampling of Many Lights with Adaptive Tree Splitting*, 2018: a binary tree over
//! boxes, cones and intensities; at each node, chance goes to the child that may give more, in proportion. Where a child can
//! give nothing at all, chance never goes, and all other lights can be reached from any point: nothing is left out.

mod bounds;
mod build;
#[cfg(test)]
mod tests;

pub(crate) use bounds::{EmissionCone, LightBounds};

use bounds::Angle;
use glam::Vec3;

/// A tree over lights.
#[derive(Debug, Clone)]
pub(crate) struct LightTree {
    nodes: Vec<Node>,
    /// For each light, the way to its leaf: the lowest bit tells whether the second child comes first, and so on.
    trails: Vec<u64>,
}

/// All lights below a place of the tree.
#[derive(Debug, Clone, Copy)]
struct Node {
    /// Middle of the box, m.
    center: Vec3,
    /// Square of half its diagonal, m².
    radius2: f32,
    /// W·sr⁻¹
    intensity: f32,
    axis: Vec3,
    spread: Angle,
    /// Cosine from which on it is dark.
    cos_falloff: f32,
    two_sided: bool,
    content: Content,
}

#[derive(Debug, Clone, Copy)]
enum Content {
    /// The first child follows its parent; this is the place of the second.
    Children(u32),
    /// One light.
    Light(u32),
}

impl LightTree {
    /// A light, by its number, that may give something to a surface at `point` with the unit normal `normal`, and the
    /// probability of having been picked by `u` in 0..1; `None` if none does.
    pub(crate) fn pick(&self, point: Vec3, normal: Vec3, mut u: f64) -> Option<(u32, f32)> {
        let (mut place, mut probability) = (0, 1.0);
        // A single light is picked only if it gives something, as in any larger tree.
        if self.nodes.first()?.importance(point, normal) <= 0.0 {
            return None;
        }
        loop {
            let second = match self.nodes[place].content {
                Content::Light(light) => return Some((light, probability)),
                Content::Children(second) => second as usize,
            };
            let share = self.share_of_first(place + 1, second, point, normal)?;
            if u < f64::from(share) {
                place += 1;
                probability *= share;
                u /= f64::from(share);
            } else {
                place = second;
                probability *= 1.0 - share;
                u = (u - f64::from(share)) / f64::from(1.0 - share);
            }
            u = u.clamp(0.0, 1.0 - f64::EPSILON);
        }
    }

    /// Probability with which [`LightTree::pick`] picks the light with this number.
    pub(crate) fn probability(&self, point: Vec3, normal: Vec3, light: u32) -> f32 {
        let (mut place, mut probability) = (0, 1.0);
        let mut trail = self.trails[light as usize];
        if self.nodes[0].importance(point, normal) <= 0.0 {
            return 0.0;
        }
        while let Content::Children(second) = self.nodes[place].content {
            let second = second as usize;
            let Some(share) = self.share_of_first(place + 1, second, point, normal) else {
                return 0.0;
            };
            let goes_second = trail & 1 == 1;
            trail >>= 1;
            probability *= if goes_second { 1.0 - share } else { share };
            place = if goes_second { second } else { place + 1 };
        }
        probability
    }

    /// Probability of the first of two children; `None` if neither gives anything.
    fn share_of_first(
        &self,
        first: usize,
        second: usize,
        point: Vec3,
        normal: Vec3,
    ) -> Option<f32> {
        let [a, b] = [first, second].map(|child| self.nodes[child].importance(point, normal));
        let sum = a + b;
        (sum > 0.0).then(|| if sum.is_finite() { a / sum } else { f32::from(a >= b) })
    }
}

impl Node {
    fn new(lights: &LightBounds, content: Content) -> Self {
        let half = 0.5 * (lights.bounds.hi - lights.bounds.lo);
        let cone = lights.cone;
        Self {
            center: lights.bounds.lo + half,
            radius2: half.length_squared(),
            intensity: lights.intensity,
            axis: cone.axis,
            spread: Angle::of(cone.spread),
            cos_falloff: cone.falloff.cos(),
            two_sided: cone.two_sided,
            content,
        }
    }

    /// How much its lights may give to a surface, at most: their intensity over the square of the distance, with the
    /// largest cosines that are possible. 0 only if they give nothing.
    fn importance(&self, point: Vec3, normal: Vec3) -> f32 {
        let to_lights = self.center - point;
        let distance2 = to_lights.length_squared();
        if distance2 <= self.radius2 {
            // Inside the ball around them, every cosine is possible.
            return self.intensity / self.radius2.max(f32::MIN_POSITIVE);
        }
        let incoming = to_lights / distance2.sqrt();
        let ball = Angle::from_cos((1.0 - self.radius2 / distance2).max(0.0).sqrt());
        let at_surface = Angle::from_cos(normal.dot(incoming)).minus(ball);
        let cos = -self.axis.dot(incoming);
        let cos = if self.two_sided { cos.abs() } else { cos };
        let at_light = Angle::from_cos(cos).minus(self.spread).minus(ball);
        // Half a degree of slack, since what rounding hides would be lost for good.
        const SLACK: f32 = 0.01;
        if at_surface.cos <= -SLACK || at_light.cos <= self.cos_falloff - SLACK {
            return 0.0;
        }
        self.intensity * at_light.cos.max(SLACK) * at_surface.cos.max(SLACK)
            / distance2.max(self.radius2)
    }
}
