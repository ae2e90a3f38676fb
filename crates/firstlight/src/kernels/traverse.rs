//! Closest hit and any hit of one ray through an eight-wide tree, watertight.
//!
//! Contract: a ray in world space (m) or in an instance's own. The triangle test is that of `triangles`. Boxes are
//! tested with a pad on the ray's origin that is larger than every rounding error of the box test and of the triangle
//! test's shear, which costs nothing per box (after Ize, *Robust BVH Ray Traversal*, JCGT 2(2), 2013).

use super::layout::{Child, EntryPlanes, Node, Target, Tree, TriangleBlock};
use super::triangles::{Shear, accept, reciprocal};
use crate::geometry::{Hit, NOTHING, Ray};
use crate::simd::{LANES, Lanes, Mask, Simd};

/// [`Hit::surface`] of a triangle of the world's own tree, before its surface has been looked up.
pub(crate) const FLATTENED: u32 = u32::MAX - 1;

/// Pad of boxes in units of the largest coordinate: eight half-ulps cover the rounding of the reciprocal, of both
/// products and sums, and of the shear.
pub(super) const PAD: f32 = 4.0 * f32::EPSILON;
/// Directions are kept this far from zero; the pad covers the difference.
pub(super) const SMALLEST: f32 = 1e-18;

/// Decides about hits of triangles that carry flags.
pub(crate) trait HitFilter: Sync {
    /// The flags it wants to be asked about.
    fn flags(&self) -> u32;

    /// Whether `hit` of `ray` (world space) counts. `from_behind`: the ray meets the triangle's back as wound.
    fn accepts(&self, ray: &Ray, hit: &Hit, from_behind: bool) -> bool;
}

/// What a tree holds besides triangles.
pub(crate) trait Others: Sync {
    /// Looks for hits of `surface` before `hit`; returns whether there was one. What has a tree of its own runs a kernel of
    /// its own, so that this one stays small.
    fn visit<const ANY: bool>(
        &self,
        search: &Search<()>,
        surface: u32,
        hit: &mut Hit,
        stack: &mut Stack,
    ) -> bool;

    /// Names the surfaces of hits that are [`FLATTENED`].
    fn name(&self, hits: &mut [Hit]);
}

/// What is wanted of a ray: its closest hit, or (`ANY`) whether there is any.
pub(crate) trait Answer<const ANY: bool>: Copy {
    /// No hit up to `t_max`.
    fn none(t_max: f32) -> Self;
    /// That of a ray with this hit.
    fn of(hit: &Hit) -> Self;
    /// The hit, as far as it is known, of a ray that ends at `t_max`.
    fn hit(&self, t_max: f32) -> Hit;
    /// The hit itself, or else `spare`, which is none.
    fn hit_or<'a>(&'a mut self, spare: &'a mut Hit) -> &'a mut Hit;
    /// Names the surfaces of hits.
    fn name(answers: &mut [Self], others: &impl Others);
}

impl Answer<false> for Hit {
    #[inline(always)]
    fn none(t_max: f32) -> Self {
        Self::none(t_max)
    }

    #[inline(always)]
    fn of(hit: &Hit) -> Self {
        *hit
    }

    #[inline(always)]
    fn hit(&self, _: f32) -> Hit {
        *self
    }

    #[inline(always)]
    fn hit_or<'a>(&'a mut self, _: &'a mut Hit) -> &'a mut Hit {
        self
    }

    #[inline(always)]
    fn name(answers: &mut [Self], others: &impl Others) {
        others.name(answers);
    }
}

impl Answer<true> for bool {
    #[inline(always)]
    fn none(_: f32) -> Self {
        false
    }

    #[inline(always)]
    fn of(hit: &Hit) -> Self {
        hit.is_some()
    }

    #[inline(always)]
    fn hit(&self, t_max: f32) -> Hit {
        Hit { surface: if *self { FLATTENED } else { NOTHING }, ..Hit::none(t_max) }
    }

    #[inline(always)]
    fn hit_or<'a>(&'a mut self, spare: &'a mut Hit) -> &'a mut Hit {
        spare
    }

    fn name(_: &mut [Self], _: &impl Others) {}
}

/// What stays the same while one ray looks for its hit, and the instructions that it is looked for with, if they are known.
pub(crate) struct Search<'a, S> {
    pub simd: S,
    /// The ray in world space.
    pub ray: &'a Ray,
    /// Asked about triangles with flags.
    pub filter: &'a dyn HitFilter,
    /// The flags it wants to be asked about.
    pub flags: u32,
}

/// A child that waits: where the ray enters its box in the upper half, what it is in the lower, so that of two boxes
/// (entered at 0 or later) the nearer one is the smaller number.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Waiting(u64);

impl Waiting {
    #[inline(always)]
    fn new(child: Child, near: f32) -> Self {
        Self(u64::from(near.to_bits()) << 32 | u64::from(child.bits()))
    }

    #[inline(always)]
    fn child(self) -> Child {
        Child::from_bits(self.0 as u32)
    }

    #[inline(always)]
    fn near(self) -> f32 {
        f32::from_bits((self.0 >> 32) as u32)
    }
}

/// Nodes still to be visited, the nearest on top.
pub(crate) struct Stack {
    entries: [Waiting; Stack::SIZE],
    pub(super) len: usize,
}

impl Stack {
    /// Deepest tree that fits.
    pub(crate) const DEPTH: usize = 64;
    /// Two trees of at most [`Stack::DEPTH`] levels, seven postponed children each, and a power of two.
    const SIZE: usize = (2 * 7 * Self::DEPTH).next_power_of_two();

    pub(super) fn new() -> Self {
        Self { entries: [Waiting::new(Child::NOTHING, 0.0); Self::SIZE], len: 0 }
    }

    #[inline(always)]
    fn push(&mut self, waiting: Waiting) {
        self.entries[self.len % Self::SIZE] = waiting;
        self.len += 1;
    }

    /// Adds a child below nearer ones, down to the level `floor`. Which is nearer cannot be foreseen, so that nothing
    /// branches on it.
    #[inline(always)]
    fn push_sorted(&mut self, mut waiting: Waiting, floor: usize) {
        let mut i = self.len;
        self.len += 1;
        while i > floor {
            let above = self.entries[(i - 1) % Self::SIZE];
            self.entries[i % Self::SIZE] = above.min(waiting);
            waiting = above.max(waiting);
            i -= 1;
        }
        self.entries[floor % Self::SIZE] = waiting;
    }

    /// The next child nearer than `t`, above the level `base`.
    #[inline(always)]
    pub(super) fn pop(&mut self, base: usize, t: f32) -> Option<Child> {
        while self.len > base {
            self.len -= 1;
            let waiting = self.entries[self.len % Self::SIZE];
            if waiting.near() <= t {
                return Some(waiting.child());
            }
        }
        None
    }

    /// The nearest of the boxes of node `index` that a ray has met, each where it enters it; the others wait. If there is
    /// none, what waits nearer than `t`, above the level `base`.
    #[inline(always)]
    fn enter<S: Simd, const ANY: bool>(
        &mut self,
        simd: S,
        tree: &Tree,
        index: usize,
        (mut met, enter): (u32, S::F),
        (t, base): (f32, usize),
    ) -> Option<Child> {
        let node = &tree.nodes[index];
        if met == 0 {
            return self.pop(base, t);
        }
        let slot = met.trailing_zeros() as usize % LANES;
        met &= met - 1;
        if met == 0 {
            return Some(node.child(slot));
        }
        let enter = enter.to_array();
        let first = Waiting::new(node.child(slot), enter[slot]);
        let slot = met.trailing_zeros() as usize % LANES;
        met &= met - 1;
        let second = Waiting::new(node.child(slot), enter[slot]);
        tree.prefetch(simd, second.child());
        let (first, second) =
            if ANY { (second, first) } else { (first.min(second), first.max(second)) };
        if met == 0 {
            self.push(second);
            return Some(first.child());
        }
        let floor = self.len;
        self.push(second);
        self.push(first);
        while met != 0 {
            let slot = met.trailing_zeros() as usize % LANES;
            met &= met - 1;
            let waiting = Waiting::new(node.child(slot), enter[slot]);
            tree.prefetch(simd, waiting.child());
            if ANY {
                self.push(waiting);
            } else {
                self.push_sorted(waiting, floor);
            }
        }
        self.len -= 1;
        Some(self.entries[self.len % Stack::SIZE].child())
    }
}

impl<'a, S> Search<'a, S> {
    /// The same with other instructions.
    #[inline(always)]
    pub(crate) fn with<T>(&self, simd: T) -> Search<'a, T> {
        let Self { ray, filter, flags, .. } = *self;
        Search { simd, ray, filter, flags }
    }
}

impl<S: Simd> Search<'_, S> {
    /// Looks through `tree` with `ray`, given in the tree's space. Returns whether `hit` was replaced.
    #[inline(always)]
    pub(crate) fn walk<O: Others, const ANY: bool>(
        &self,
        tree: &Tree,
        ray: &Ray,
        surface: u32,
        others: &O,
        hit: &mut Hit,
        stack: &mut Stack,
    ) -> bool {
        if tree.nodes.is_empty() {
            return false;
        }
        let prepared = (Slabs::new(self.simd, tree, ray), Shear::of_ray(self.simd, ray));
        let start = (tree, Child::node(0));
        self.walk_from::<O, ANY>(start, ray, prepared, surface, others, hit, stack)
    }

    /// As [`Search::walk`], through what is below `start`, with a ray that is prepared.
    #[inline(always)]
    #[expect(clippy::too_many_arguments, reason = "what a walk needs is to stay in registers")]
    pub(super) fn walk_from<O: Others, const ANY: bool>(
        &self,
        (tree, start): (&Tree, Child),
        ray: &Ray,
        (slabs, shear): (Slabs<S>, Shear<S>),
        surface: u32,
        others: &O,
        hit: &mut Hit,
        stack: &mut Stack,
    ) -> bool {
        let entry = EntryPlanes::of(ray.direction.is_negative_bitmask());
        let (base, mut found) = (stack.len, false);
        let mut next = Some(start);
        while let Some(child) = next {
            next = match child.target() {
                Target::Node(index) => {
                    let met = slabs.meet(entry, &tree.nodes[index], hit.t);
                    stack.enter::<S, ANY>(self.simd, tree, index, met, (hit.t, base))
                }
                Target::Block(index) => {
                    let block = &tree.blocks[index];
                    found |= self.meet(tree, block, ray, &shear, surface, hit);
                    if ANY && found { None } else { stack.pop(base, hit.t) }
                }
                Target::Other(surface) => {
                    found |= others.visit::<ANY>(&self.with(()), surface, hit, stack);
                    if ANY && found { None } else { stack.pop(base, hit.t) }
                }
                Target::Nothing => stack.pop(base, hit.t),
            };
        }
        stack.len = base;
        found
    }

    /// Tests a block of triangles. Returns whether `hit` was replaced.
    #[inline(always)]
    pub(super) fn meet(
        &self,
        tree: &Tree,
        block: &TriangleBlock,
        ray: &Ray,
        shear: &Shear<S>,
        surface: u32,
        hit: &mut Hit,
    ) -> bool {
        let (mut crossed, weights) = shear.cross_block(self.simd, block);
        if crossed == 0 {
            return false;
        }
        let weights = [weights[0].to_array(), weights[1].to_array(), weights[2].to_array()];
        let mut found = false;
        while crossed != 0 {
            let lane = crossed.trailing_zeros() as usize % LANES;
            crossed &= crossed - 1;
            let weights = [weights[0][lane], weights[1][lane], weights[2][lane]];
            found |= accept(self, ray, (tree, block, lane), weights, surface, hit);
        }
        found
    }
}

/// A ray prepared for boxes: per axis `t = plane · scale + offset`, padded away from the box.
pub(super) struct Slabs<S: Simd> {
    pub scale: [S::F; 3],
    pub near: [S::F; 3],
    pub far: [S::F; 3],
    pub t_min: S::F,
    pub simd: S,
}

impl<S: Simd> Slabs<S> {
    #[inline(always)]
    fn new(simd: S, tree: &Tree, ray: &Ray) -> Self {
        let pad = PAD * (ray.origin.abs().max_element() + tree.reach);
        let zero = simd.splat(0.0);
        let (mut scale, mut near, mut far) = ([zero; 3], [zero; 3], [zero; 3]);
        for axis in 0..3 {
            let (o, d) = (ray.origin[axis], ray.direction[axis]);
            let reciprocal = reciprocal(d);
            let pad = pad.copysign(reciprocal);
            scale[axis] = simd.splat(reciprocal);
            near[axis] = simd.splat(-(o + pad) * reciprocal);
            far[axis] = simd.splat(-(o - pad) * reciprocal);
        }
        Self { scale, near, far, t_min: simd.splat(ray.t_min), simd }
    }

    /// Which of a node's boxes the ray, which enters them through the planes of `entry`, meets before `t`, and where
    /// it enters each.
    #[inline(always)]
    pub(super) fn meet(&self, entry: &EntryPlanes, node: &Node, t: f32) -> (u32, S::F) {
        let Self { scale: [sx, sy, sz], near, far, t_min, simd, .. } = self;
        let [x, y, z] = entry.near;
        let [x, y, z] = [
            simd.load(node.row(x)).mul_add(*sx, near[0]),
            simd.load(node.row(y)).mul_add(*sy, near[1]),
            simd.load(node.row(z)).mul_add(*sz, near[2]),
        ];
        let enter = x.max(y).max(z.max(*t_min));
        let [x, y, z] = entry.far;
        let [x, y, z] = [
            simd.load(node.row(x)).mul_add(*sx, far[0]),
            simd.load(node.row(y)).mul_add(*sy, far[1]),
            simd.load(node.row(z)).mul_add(*sz, far[2]),
        ];
        let leave = x.min(y).min(z.min(simd.splat(t)));
        (enter.le(leave).bits(), enter)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn children_wait_nearest_on_top_and_above_those_that_waited_before() {
        let mut stack = Stack::new();
        let entries = [0.5, 2.0, 0.0, 1.0, 1.0, 3.0];
        stack.push(Waiting::new(Child::node(9), 0.25));
        for (i, near) in entries.into_iter().enumerate() {
            stack.push_sorted(Waiting::new(Child::node(i), near), 1);
        }
        let order: Vec<_> = std::iter::from_fn(|| stack.pop(0, 2.5)).collect();
        assert_eq!(order, [2, 0, 3, 4, 1, 9].map(Child::node));
    }
}
