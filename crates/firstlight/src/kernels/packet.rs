//! Closest hit and any hit of eight coherent rays at once: one walk through the tree for all of them.
//!
//! Contract: as `traverse`, with the same bits: each ray's triangle tests are the same operations on the same numbers,
//! and boxes only decide what is not tested. A node's eight boxes are tested against the interval of all rays first
//! (Boulos et al., *Interval Arithmetic Culling*, 2006), then one by one against eight rays; leaves test eight rays
//! against one triangle. Rays are coherent if the signs of their directions agree, and the axis along which they go
//! furthest.

use super::layout::{Child, Node, ROWS, Target, Tree, TriangleBlock};
use super::traverse::{FLATTENED, HitFilter, Others, PAD, SMALLEST, Search, Stack};
use crate::geometry::{Hit, Ray};
use crate::simd::{LANES, Lanes, Mask, Simd};

/// Whether eight rays can go together.
#[inline(always)]
pub(super) fn are_coherent(rays: &[Ray]) -> bool {
    let first = rays[0].direction;
    let mut coherent = rays.len() == LANES;
    for ray in rays {
        let d = ray.direction;
        coherent &= d.is_negative_bitmask() == first.is_negative_bitmask();
        coherent &= d.abs().max_position() == first.abs().max_position();
    }
    coherent
}

/// Nodes still to be visited, with where the first ray enters them and which rays do.
pub(super) struct PacketStack {
    entries: [(Child, f32, u32); 7 * Stack::DEPTH],
    len: usize,
}

impl PacketStack {
    pub(super) fn new() -> Self {
        Self { entries: [(Child::NOTHING, 0.0, 0); 7 * Stack::DEPTH], len: 0 }
    }

    /// Adds a child; nearer ones stay on top of the level `base`.
    #[inline(always)]
    fn push(&mut self, child: Child, near: f32, rays: u32, base: usize) {
        let mut i = self.len;
        self.len += 1;
        while i > base && self.entries[i - 1].1 < near {
            self.entries[i] = self.entries[i - 1];
            i -= 1;
        }
        self.entries[i] = (child, near, rays);
    }
}

/// Eight rays, structure of arrays.
pub(super) struct Packet<'a, S: Simd> {
    simd: S,
    rays: &'a [Ray],
    filter: &'a dyn HitFilter,
    /// Per axis and ray: `t = plane · scale + offset`, padded away from the box.
    scale: [S::F; 3],
    near: [S::F; 3],
    far: [S::F; 3],
    /// Per axis, in every lane: the intervals of scales and padded origins.
    scale_ends: [[S::F; 2]; 3],
    near_origin: [S::F; 3],
    far_origin: [S::F; 3],
    near_plane: [usize; 3],
    far_plane: [usize; 3],
    t_min: S::F,
    smallest_t_min: f32,
    /// The order of the axes for triangles, and per ray the shear and origin in it.
    axes: [usize; 3],
    shear: [S::F; 2],
    origin: [S::F; 3],
}

impl<'a, S: Simd> Packet<'a, S> {
    /// Prepares eight coherent rays for `tree`.
    #[inline(always)]
    pub(super) fn new(simd: S, tree: &Tree, rays: &'a [Ray], filter: &'a dyn HitFilter) -> Self {
        let zero = simd.splat(0.0);
        let z = rays[0].direction.abs().max_position();
        let mut packet = Self {
            simd,
            rays,
            filter,
            scale: [zero; 3],
            near: [zero; 3],
            far: [zero; 3],
            scale_ends: [[zero; 2]; 3],
            near_origin: [zero; 3],
            far_origin: [zero; 3],
            near_plane: [0; 3],
            far_plane: [0; 3],
            t_min: zero,
            smallest_t_min: 0.0,
            axes: [(z + 1) % 3, (z + 2) % 3, z],
            shear: [zero; 2],
            origin: [zero; 3],
        };
        for axis in 0..3 {
            packet.prepare_slabs(tree, axis);
        }
        packet.prepare_triangles();
        packet
    }

    #[inline(always)]
    fn prepare_slabs(&mut self, tree: &Tree, axis: usize) {
        let (mut scale, mut near, mut far) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        let (mut lo, mut hi) = (f32::INFINITY, f32::NEG_INFINITY);
        let (mut smallest, mut largest) = (f32::INFINITY, f32::NEG_INFINITY);
        for (i, ray) in self.rays.iter().enumerate().take(LANES) {
            let (o, d) = (ray.origin[axis], ray.direction[axis]);
            let reciprocal = 1.0 / d.abs().max(SMALLEST).copysign(d);
            let pad = PAD * (ray.origin.abs().max_element() + tree.reach);
            let signed = pad.copysign(reciprocal);
            scale[i] = reciprocal;
            near[i] = -(o + signed) * reciprocal;
            far[i] = -(o - signed) * reciprocal;
            (lo, hi) = (lo.min(o - pad), hi.max(o + pad));
            (smallest, largest) = (smallest.min(reciprocal), largest.max(reciprocal));
        }
        let forward = smallest > 0.0;
        self.scale[axis] = self.simd.load(&scale);
        self.near[axis] = self.simd.load(&near);
        self.far[axis] = self.simd.load(&far);
        self.scale_ends[axis] = [self.simd.splat(smallest), self.simd.splat(largest)];
        self.near_origin[axis] = self.simd.splat(if forward { hi } else { lo });
        self.far_origin[axis] = self.simd.splat(if forward { lo } else { hi });
        self.near_plane[axis] = if forward { axis } else { axis + 3 };
        self.far_plane[axis] = if forward { axis + 3 } else { axis };
    }

    #[inline(always)]
    fn prepare_triangles(&mut self) {
        let (mut x, mut y, mut t_min) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        let mut origin = [[0.0; LANES]; 3];
        for (i, ray) in self.rays.iter().enumerate().take(LANES) {
            let d = ray.direction;
            x[i] = d[self.axes[0]] / d[self.axes[2]];
            y[i] = d[self.axes[1]] / d[self.axes[2]];
            t_min[i] = ray.t_min;
            for (row, axis) in origin.iter_mut().zip(self.axes) {
                row[i] = ray.origin[axis];
            }
        }
        self.shear = [self.simd.load(&x), self.simd.load(&y)];
        for (row, values) in self.origin.iter_mut().zip(&origin) {
            *row = self.simd.load(values);
        }
        self.t_min = self.simd.load(&t_min);
        self.smallest_t_min = t_min[0];
        for t in t_min {
            self.smallest_t_min = self.smallest_t_min.min(t);
        }
    }

    /// Looks through `tree` with all rays; `hits` has one entry per ray.
    #[inline(always)]
    pub(super) fn walk<O: Others, const ANY: bool>(
        &self,
        tree: &Tree,
        others: &O,
        hits: &mut [Hit],
        stacks: (&mut PacketStack, &mut Stack),
    ) {
        let (stack, single) = stacks;
        let mut open = if ANY { without_hit(hits) } else { (1 << LANES) - 1 };
        stack.len = 0;
        stack.push(Child::node(0), 0.0, open, 0);
        let mut reach = Reach::of(self.simd, hits);
        while stack.len > 0 && open != 0 {
            stack.len -= 1;
            let (child, near, rays) = stack.entries[stack.len];
            let rays = rays & open;
            if near > reach.furthest || rays == 0 {
                continue;
            }
            let changed = match child.target() {
                Target::Node(index) => {
                    self.enter(&tree.nodes[index], &reach, rays, stack);
                    false
                }
                Target::Block(index) => self.meet(&tree.blocks[index], rays, hits),
                Target::Other(surface) => self.visit::<O, ANY>(others, surface, rays, hits, single),
                Target::Nothing => false,
            };
            if changed && ANY {
                open = without_hit(hits);
            } else if changed {
                reach = Reach::of(self.simd, hits);
            }
        }
    }

    /// Pushes the children of `node` that one of `rays` meets before its hit, the nearest last.
    #[inline(always)]
    fn enter(&self, node: &Node, reach: &Reach<S>, rays: u32, stack: &mut PacketStack) {
        let enter = self.earliest(node, 0).max(self.earliest(node, 1)).max(self.earliest(node, 2));
        let leave = self.latest(node, 0).min(self.latest(node, 1)).min(self.latest(node, 2));
        let enter = enter.max(self.simd.splat(self.smallest_t_min));
        let mut possible = enter.le(leave.min(self.simd.splat(reach.furthest))).bits();
        let (enter, base) = (enter.to_array(), stack.len);
        while possible != 0 {
            let slot = possible.trailing_zeros() as usize;
            possible &= possible - 1;
            let met = self.meets(node, slot % LANES, reach) & rays;
            if met != 0 {
                stack.push(node.children[slot % LANES], enter[slot % LANES], met, base);
            }
        }
    }

    /// A lower bound of where any ray enters each child's slab.
    #[inline(always)]
    fn earliest(&self, node: &Node, axis: usize) -> S::F {
        let way = self.simd.load(&node.planes[self.near_plane[axis] % 6]) - self.near_origin[axis];
        let [smallest, largest] = self.scale_ends[axis];
        (way * smallest).min(way * largest)
    }

    /// An upper bound of where any ray leaves each child's slab.
    #[inline(always)]
    fn latest(&self, node: &Node, axis: usize) -> S::F {
        let way = self.simd.load(&node.planes[self.far_plane[axis] % 6]) - self.far_origin[axis];
        let [smallest, largest] = self.scale_ends[axis];
        (way * smallest).max(way * largest)
    }

    /// Which rays meet one child.
    #[inline(always)]
    fn meets(&self, node: &Node, slot: usize, reach: &Reach<S>) -> u32 {
        let (mut enter, mut leave) = (self.t_min, reach.each);
        for axis in 0..3 {
            let near = self.simd.splat(node.planes[self.near_plane[axis] % 6][slot]);
            let far = self.simd.splat(node.planes[self.far_plane[axis] % 6][slot]);
            enter = enter.max(near.mul_add(self.scale[axis], self.near[axis]));
            leave = leave.min(far.mul_add(self.scale[axis], self.far[axis]));
        }
        enter.le(leave).bits()
    }

    /// Tests a block of triangles, one after the other. Returns whether a hit was replaced.
    #[inline(always)]
    fn meet(&self, block: &TriangleBlock, rays: u32, hits: &mut [Hit]) -> bool {
        let mut changed = false;
        for lane in 0..LANES {
            if block.is_empty(lane) {
                break;
            }
            let (crossed, weights) = self.cross(block, lane);
            let mut crossed = crossed & rays;
            if crossed == 0 {
                continue;
            }
            let weights = [weights[0].to_array(), weights[1].to_array(), weights[2].to_array()];
            while crossed != 0 {
                let i = crossed.trailing_zeros() as usize % LANES;
                crossed &= crossed - 1;
                let weights = [weights[0][i], weights[1][i], weights[2][i]];
                let ray = &self.rays[i];
                let search = Search { simd: self.simd, ray, filter: self.filter };
                changed |= search.accept(block, lane, ray, weights, FLATTENED, &mut hits[i]);
            }
        }
        changed
    }

    /// Which rays' lines cross a triangle, and the weights of its corners (not normalised); see `Shear::cross`.
    #[inline(always)]
    fn cross(&self, block: &TriangleBlock, lane: usize) -> (u32, [S::F; 3]) {
        let a = self.corner(block, 0, lane);
        let b = self.corner(block, 3, lane);
        let c = self.corner(block, 6, lane);
        super::traverse::cross(self.simd, a, b, c)
    }

    #[inline(always)]
    fn corner(&self, block: &TriangleBlock, first_row: usize, lane: usize) -> (S::F, S::F) {
        let x = self.simd.splat(block.corners[(first_row + self.axes[0]) % ROWS][lane])
            - self.origin[0];
        let y = self.simd.splat(block.corners[(first_row + self.axes[1]) % ROWS][lane])
            - self.origin[1];
        let z = self.simd.splat(block.corners[(first_row + self.axes[2]) % ROWS][lane])
            - self.origin[2];
        (x - self.shear[0] * z, y - self.shear[1] * z)
    }

    /// Brings each ray to a surface that is not triangles. Returns whether a hit was replaced.
    #[inline(always)]
    fn visit<O: Others, const ANY: bool>(
        &self,
        others: &O,
        surface: u32,
        rays: u32,
        hits: &mut [Hit],
        stack: &mut Stack,
    ) -> bool {
        let (mut rays, mut changed) = (rays, false);
        while rays != 0 {
            let i = rays.trailing_zeros() as usize % LANES;
            rays &= rays - 1;
            let search = Search { simd: self.simd, ray: &self.rays[i], filter: self.filter };
            changed |= others.visit::<S, ANY>(&search, surface, &mut hits[i], stack);
        }
        changed
    }
}

/// How far each ray still looks, and the furthest of them.
struct Reach<S: Simd> {
    each: S::F,
    furthest: f32,
}

impl<S: Simd> Reach<S> {
    #[inline(always)]
    fn of(simd: S, hits: &[Hit]) -> Self {
        let (mut each, mut furthest) = ([0.0; LANES], f32::NEG_INFINITY);
        for (t, hit) in each.iter_mut().zip(hits) {
            *t = hit.t;
            furthest = furthest.max(hit.t);
        }
        Self { each: simd.load(&each), furthest }
    }
}

/// The rays that have not hit anything yet, as bits.
#[inline(always)]
fn without_hit(hits: &[Hit]) -> u32 {
    let mut open = 0;
    for (i, hit) in hits.iter().enumerate().take(LANES) {
        open |= u32::from(!hit.is_some()) << i;
    }
    open
}
