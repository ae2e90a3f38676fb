//! The tree, from the root down: at each node the split that promises the least.

use super::{Content, LightBounds, LightTree, Node};
use crate::geometry::Bounds;
use glam::Vec3;

/// Parts of an axis between which a node may be split.
const PARTS: usize = 12;
/// Below this depth, nodes are split in halves, so that every way fits into a trail.
const DEEP: u32 = 30;

impl LightTree {
    /// A tree over `lights`; those that give nothing are never picked.
    pub(crate) fn build(lights: &[LightBounds]) -> Self {
        let mut numbered: Vec<_> = (0..).zip(lights.iter().copied()).collect();
        let mut tree = Self { nodes: Vec::new(), trails: vec![0; lights.len()] };
        if !numbered.is_empty() {
            tree.grow(&mut numbered, 0, 0);
        }
        tree
    }

    /// Appends the tree over `lights`, which stands at the end of `trail`.
    fn grow(&mut self, lights: &mut [(u32, LightBounds)], depth: u32, trail: u64) {
        if let [(number, light)] = lights {
            self.trails[*number as usize] = trail;
            self.nodes.push(Node::new(light, Content::Light(*number)));
            return;
        }
        let place = self.nodes.len();
        self.nodes.push(Node::new(&around(lights), Content::Children(0)));
        let middle = split(lights, depth);
        let (first, second) = lights.split_at_mut(middle);
        self.grow(first, depth + 1, trail);
        self.nodes[place].content = Content::Children(self.nodes.len() as u32);
        self.grow(second, depth + 1, trail | 1 << depth);
    }
}

fn around(lights: &[(u32, LightBounds)]) -> LightBounds {
    let all = lights.iter().map(|(_, light)| *light);
    all.reduce(LightBounds::union).unwrap_or_else(|| unreachable!("a node has lights"))
}

fn middle(light: &LightBounds) -> Vec3 {
    0.5 * (light.bounds.lo + light.bounds.hi)
}

/// Orders the lights so that those before the returned place belong together, and those behind.
fn split(lights: &mut [(u32, LightBounds)], depth: u32) -> usize {
    let middles = Bounds::around(lights.iter().map(|(_, light)| middle(light)));
    let best = (0..3).filter_map(|axis| best_split(lights, middles, axis));
    let best = best.min_by(|a, b| a.cost.total_cmp(&b.cost)).filter(|_| depth < DEEP);
    let Some(Split { axis, part, .. }) = best else {
        // All in one place, or deep down: halves by number.
        let half = lights.len() / 2;
        lights.select_nth_unstable_by_key(half, |(number, _)| *number);
        return half;
    };
    lights.sort_by_key(|(number, light)| (part_of(light, middles, axis) > part, *number));
    lights.partition_point(|(_, light)| part_of(light, middles, axis) <= part)
}

struct Split {
    axis: usize,
    /// The last part that belongs to the first child.
    part: usize,
    cost: f32,
}

fn part_of(light: &LightBounds, middles: Bounds, axis: usize) -> usize {
    let place = (middle(light)[axis] - middles.lo[axis]) / (middles.hi[axis] - middles.lo[axis]);
    ((place * PARTS as f32) as usize).min(PARTS - 1)
}

/// The cheapest split along an axis; `None` if all lights lie in one plane across it.
fn best_split(lights: &[(u32, LightBounds)], middles: Bounds, axis: usize) -> Option<Split> {
    let extent = middles.hi - middles.lo;
    let mut parts: [Option<LightBounds>; PARTS] = [None; PARTS];
    for (_, light) in lights.iter().filter(|_| extent[axis] > 0.0) {
        let part = &mut parts[part_of(light, middles, axis)];
        *part = Some(part.map_or(*light, |others| others.union(*light)));
    }
    let sum =
        |parts: &[Option<LightBounds>]| parts.iter().flatten().copied().reduce(LightBounds::union);
    // Thin boxes are split across, not along.
    let regular = extent.max_element() / extent[axis];
    let split = |part: usize| {
        let (first, second) = (sum(&parts[..=part])?, sum(&parts[part + 1..])?);
        Some(Split { axis, part, cost: regular * (cost(&first) + cost(&second)) })
    };
    (0..PARTS - 1).filter_map(split).min_by(|a, b| a.cost.total_cmp(&b.cost))
}

/// Intensity, times the directions, times the surface (the paper's surface area orientation heuristic).
fn cost(lights: &LightBounds) -> f32 {
    // Points on a line have no surface either; a length will do.
    let extent = (lights.bounds.hi - lights.bounds.lo).max(Vec3::ZERO);
    let surface = lights.bounds.half_area() + 1e-6 * extent.length_squared();
    lights.intensity * lights.cone.measure() * surface
}
