//! The tree, from the root down: at each node the split that promises the least.

use super::node::{CHILDREN, Child, Node};
use super::{LightBounds, LightTree, Place};
use crate::geometry::Bounds;
use crate::simd::Level;
use glam::Vec3;

/// Parts of an axis between which a node may be split.
const PARTS: usize = 12;
/// Below this depth, nodes are split in halves, so that the tree ends soon.
const DEEP: u32 = 20;

/// A light and its number.
type Numbered = (u32, LightBounds);

impl LightTree {
    /// A tree over `lights`, to be walked with the instructions of `level`; lights that give nothing are never picked.
    pub(crate) fn build(lights: &[LightBounds], level: Level) -> Self {
        let mut numbered: Vec<_> = (0..).zip(lights.iter().copied()).collect();
        let place_of = vec![Place::default(); lights.len()];
        let mut tree = Self { nodes: Vec::new(), place_of, level };
        if !numbered.is_empty() {
            tree.grow(&mut numbered, 0, None);
        }
        tree
    }

    /// Appends the tree over `lights`, so many nodes below the root.
    fn grow(&mut self, lights: &mut [Numbered], depth: u32, parent: Option<Place>) {
        let mut groups = divide(lights, depth);
        let bounds: Vec<_> = groups.iter().map(|group| around(group)).collect();
        let node = self.nodes.len() as u32;
        self.nodes.push(Node::new(&bounds, parent));
        for (child, group) in (0..).zip(&mut groups) {
            let place = Place { node, child };
            self.nodes[node as usize].children[child as usize] = match group {
                [(number, _)] => {
                    self.place_of[*number as usize] = place;
                    Child::Light(*number)
                }
                _ => Child::Node(self.nodes.len() as u32),
            };
            if group.len() > 1 {
                self.grow(group, depth + 1, Some(place));
            }
        }
    }
}

/// The lights in at most eight groups: those that cost most are split first.
fn divide(lights: &mut [Numbered], depth: u32) -> Vec<&mut [Numbered]> {
    // One light cannot be split.
    let cost = |group: &[Numbered]| if group.len() > 1 { cost(&around(group)) } else { -1.0 };
    let mut groups = vec![(cost(lights), lights)];
    while groups.len() < CHILDREN {
        let worst = groups.iter().enumerate().max_by(|(_, a), (_, b)| a.0.total_cmp(&b.0));
        let Some((worst, _)) = worst.filter(|(_, (_, group))| group.len() > 1) else { break };
        let (_, group) = groups.swap_remove(worst);
        let middle = split(group, depth);
        let (first, second) = group.split_at_mut(middle);
        groups.extend([(cost(first), first), (cost(second), second)]);
    }
    groups.into_iter().map(|(_, group)| group).collect()
}

fn around(lights: &[Numbered]) -> LightBounds {
    let all = lights.iter().map(|(_, light)| *light);
    all.reduce(LightBounds::union).unwrap_or_else(|| unreachable!("a node has lights"))
}

fn middle(light: &LightBounds) -> Vec3 {
    0.5 * (light.bounds.lo + light.bounds.hi)
}

/// Orders the lights so that those before the returned place belong together, and those behind.
fn split(lights: &mut [Numbered], depth: u32) -> usize {
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
fn best_split(lights: &[Numbered], middles: Bounds, axis: usize) -> Option<Split> {
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
