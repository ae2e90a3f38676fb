//! Closest hit and any hit of single rays through an eight-wide tree, watertight.
//!
//! Contract: `rays` in world space (m), one answer per ray in the same order. The triangle test is Woop, Benthin,
//! Wald, *Watertight Ray/Triangle Intersection*, JCGT 2(1), 2013, with two deviations: edges that come out exactly
//! zero count as inside (no second evaluation: at worst a ray hits both neighbours, never neither), and the
//! distance of a triangle that was hit is computed again in double precision, so that its sign is right for rays
//! that start next to it (see [`plane_distance`]). No fused operation takes part in either, so every level gives
//! the same bits.
//!
//! Boxes are tested with a pad on the ray's origin that is larger than every rounding error of the box test and of
//! the triangle test's shear, which costs nothing per box (after Ize, *Robust BVH Ray Traversal*, JCGT 2(2), 2013).

use super::layout::{Child, Node, ROWS, Target, Tree, TriangleBlock};
use super::packet::{Packet, PacketStack, are_coherent};
use crate::geometry::triangle::plane_distance;
use crate::geometry::{Hit, Ray};
use crate::simd::{Kernel, LANES, Lanes, Level, Mask, Simd};
use glam::Vec3;

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
    /// Looks for hits of `surface` before `hit`; returns whether there was one.
    fn visit<S: Simd, const ANY: bool>(
        &self,
        search: &Search<S>,
        surface: u32,
        hit: &mut Hit,
        stack: &mut Stack,
    ) -> bool;
}

/// What stays the same while one ray looks for its hit.
pub(crate) struct Search<'a, S> {
    pub(super) simd: S,
    /// The ray in world space.
    pub ray: &'a Ray,
    /// Asked about triangles with flags.
    pub filter: &'a dyn HitFilter,
}

/// Nodes still to be visited.
pub(crate) struct Stack {
    entries: [(Child, f32); Stack::SIZE],
    len: usize,
}

impl Stack {
    /// Two trees of at most [`Stack::DEPTH`] levels, seven postponed children each.
    const SIZE: usize = 2 * 7 * Self::DEPTH;
    /// Deepest tree that fits.
    pub(crate) const DEPTH: usize = 64;

    fn new() -> Self {
        Self { entries: [(Child::NOTHING, 0.0); Self::SIZE], len: 0 }
    }

    #[inline(always)]
    fn push(&mut self, child: Child, near: f32) {
        self.entries[self.len] = (child, near);
        self.len += 1;
    }

    /// The next child nearer than `t`, above the level `base`.
    #[inline(always)]
    fn pop(&mut self, base: usize, t: f32) -> Option<Child> {
        while self.len > base {
            self.len -= 1;
            let (child, near) = self.entries[self.len];
            if near <= t {
                return Some(child);
            }
        }
        None
    }

    /// Sinks the newest entry below nearer ones, down to the level `base`.
    #[inline(always)]
    fn settle(&mut self, base: usize) {
        let mut i = self.len - 1;
        while i > base && self.entries[i - 1].1 < self.entries[i].1 {
            self.entries.swap(i - 1, i);
            i -= 1;
        }
    }
}

/// Answers each of `rays`: the closest hit, or (`ANY`) whether there is any, in which case only
/// [`Hit::surface`] has a meaning.
pub(crate) fn search<const ANY: bool>(
    level: Level,
    tree: &Tree,
    others: &impl Others,
    filter: &dyn HitFilter,
    rays: &[Ray],
    hits: &mut [Hit],
) {
    level.run(Batch::<_, ANY> { tree, others, filter, rays, hits });
}

struct Batch<'a, O, const ANY: bool> {
    tree: &'a Tree,
    others: &'a O,
    filter: &'a dyn HitFilter,
    rays: &'a [Ray],
    hits: &'a mut [Hit],
}

impl<O: Others, const ANY: bool> Kernel for Batch<'_, O, ANY> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        if self.tree.nodes.is_empty() {
            return;
        }
        let (mut stack, mut packet_stack) = (Stack::new(), PacketStack::new());
        for (rays, hits) in self.rays.chunks(LANES).zip(self.hits.chunks_mut(LANES)) {
            if are_coherent(rays) {
                let packet = Packet::new(simd, self.tree, rays, self.filter);
                let stacks = (&mut packet_stack, &mut stack);
                packet.walk::<O, ANY>(self.tree, self.others, hits, stacks);
                continue;
            }
            for (ray, hit) in rays.iter().zip(hits) {
                let search = Search { simd, ray, filter: self.filter };
                search.walk::<O, ANY>(self.tree, ray, FLATTENED, self.others, hit, &mut stack);
            }
        }
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
        let (slabs, shear) = (Slabs::new(self.simd, tree, ray), Shear::new(self.simd, ray));
        let (base, mut found) = (stack.len, false);
        let mut next = Some(Child::node(0));
        while let Some(child) = next {
            match child.target() {
                Target::Node(index) => slabs.enter::<ANY>(&tree.nodes[index], hit.t, stack),
                Target::Block(index) => {
                    found |= self.meet(&tree.blocks[index], ray, &shear, surface, hit);
                }
                Target::Other(surface) => {
                    found |= others.visit::<S, ANY>(self, surface, hit, stack);
                }
                Target::Nothing => {}
            }
            if ANY && found {
                stack.len = base;
                return true;
            }
            next = stack.pop(base, hit.t);
        }
        found
    }

    /// Tests a block of triangles. Returns whether `hit` was replaced.
    #[inline(always)]
    fn meet(
        &self,
        block: &TriangleBlock,
        ray: &Ray,
        shear: &Shear<S>,
        surface: u32,
        hit: &mut Hit,
    ) -> bool {
        let (mut crossed, weights) = shear.cross(self.simd, block);
        if crossed == 0 {
            return false;
        }
        let weights = [weights[0].to_array(), weights[1].to_array(), weights[2].to_array()];
        let mut found = false;
        while crossed != 0 {
            let lane = crossed.trailing_zeros() as usize;
            crossed &= crossed - 1;
            let weights = [weights[0][lane], weights[1][lane], weights[2][lane]];
            found |= self.accept(block, lane, ray, weights, surface, hit);
        }
        found
    }

    /// The scalar end of the triangle test: distance, range, order, filter.
    #[inline(always)]
    pub(super) fn accept(
        &self,
        block: &TriangleBlock,
        lane: usize,
        ray: &Ray,
        weights: [f32; 3],
        surface: u32,
        hit: &mut Hit,
    ) -> bool {
        let scale = 1.0 / (weights[0] + weights[1] + weights[2]);
        let t = distance(ray, block.triangle(lane), weights, scale);
        if !(t > ray.t_min && t <= hit.t) {
            return false;
        }
        let (u, v) = (weights[1] * scale, weights[2] * scale);
        let candidate = Hit { t, u, v, surface, primitive: block.number(lane) };
        if hit.is_some() && !candidate.is_before(hit) {
            return false;
        }
        let flags = block.flags(lane) & self.filter.flags();
        if flags != 0 && !self.filter.accepts(self.ray, &candidate, from_behind(ray, block, lane)) {
            return false;
        }
        *hit = candidate;
        true
    }
}

/// Distance to a triangle that was hit; for one without area, to the point with the given weights times `scale`.
#[inline(always)]
fn distance(ray: &Ray, corners: [Vec3; 3], weights: [f32; 3], scale: f32) -> f32 {
    let t = plane_distance(ray.origin, ray.direction, corners) as f32;
    if t.is_finite() {
        return t;
    }
    let point = weights[0] * corners[0] + weights[1] * corners[1] + weights[2] * corners[2];
    (point * scale - ray.origin).dot(ray.direction) / ray.direction.length_squared()
}

#[inline(never)]
fn from_behind(ray: &Ray, block: &TriangleBlock, lane: usize) -> bool {
    let [a, b, c] = block.triangle(lane).map(Vec3::as_dvec3);
    (b - a).cross(c - a).dot(ray.direction.as_dvec3()) > 0.0
}

/// A ray prepared for boxes: per axis `t = plane · scale + offset`, padded away from the box.
struct Slabs<S: Simd> {
    scale: [S::F; 3],
    near: [S::F; 3],
    far: [S::F; 3],
    /// Which of a node's six planes is entered first and last, by axis.
    near_plane: [usize; 3],
    far_plane: [usize; 3],
    t_min: S::F,
    simd: S,
}

impl<S: Simd> Slabs<S> {
    #[inline(always)]
    fn new(simd: S, tree: &Tree, ray: &Ray) -> Self {
        let pad = PAD * (ray.origin.abs().max_element() + tree.reach);
        let zero = simd.splat(0.0);
        let (mut scale, mut near, mut far) = ([zero; 3], [zero; 3], [zero; 3]);
        let mut near_plane = [0; 3];
        for axis in 0..3 {
            let (o, d) = (ray.origin[axis], ray.direction[axis]);
            let reciprocal = 1.0 / d.abs().max(SMALLEST).copysign(d);
            let pad = pad.copysign(reciprocal);
            scale[axis] = simd.splat(reciprocal);
            near[axis] = simd.splat(-(o + pad) * reciprocal);
            far[axis] = simd.splat(-(o - pad) * reciprocal);
            near_plane[axis] = if reciprocal > 0.0 { axis } else { axis + 3 };
        }
        let far_plane = [(near_plane[0] + 3) % 6, (near_plane[1] + 3) % 6, (near_plane[2] + 3) % 6];
        Self { scale, near, far, near_plane, far_plane, t_min: simd.splat(ray.t_min), simd }
    }

    /// Where the ray enters the slabs of one axis.
    #[inline(always)]
    fn near(&self, node: &Node, axis: usize) -> S::F {
        let planes = &node.planes[self.near_plane[axis] % 6];
        self.simd.load(planes).mul_add(self.scale[axis], self.near[axis])
    }

    /// Where the ray leaves the slabs of one axis.
    #[inline(always)]
    fn far(&self, node: &Node, axis: usize) -> S::F {
        let planes = &node.planes[self.far_plane[axis] % 6];
        self.simd.load(planes).mul_add(self.scale[axis], self.far[axis])
    }

    /// Pushes the children of `node` that the ray meets before `t`, the nearest last.
    #[inline(always)]
    fn enter<const ANY: bool>(&self, node: &Node, t: f32, stack: &mut Stack) {
        let enter =
            self.near(node, 0).max(self.near(node, 1)).max(self.near(node, 2).max(self.t_min));
        let end = self.simd.splat(t);
        let leave = self.far(node, 0).min(self.far(node, 1)).min(self.far(node, 2).min(end));
        let mut met = enter.le(leave).bits();
        let (enter, base) = (enter.to_array(), stack.len);
        while met != 0 {
            let slot = met.trailing_zeros() as usize;
            met &= met - 1;
            stack.push(node.children[slot], enter[slot % LANES]);
            if !ANY {
                stack.settle(base);
            }
        }
    }
}

/// A ray prepared for triangles: a shear that makes it the z axis.
struct Shear<S: Simd> {
    /// The order of the axes; the last is the ray's largest.
    axes: [usize; 3],
    /// Shear along the first two, and the origin in this order.
    shear: [S::F; 2],
    origin: [S::F; 3],
}

impl<S: Simd> Shear<S> {
    #[inline(always)]
    fn new(simd: S, ray: &Ray) -> Self {
        let d = ray.direction;
        let z = d.abs().max_position();
        let axes = [(z + 1) % 3, (z + 2) % 3, z];
        let o = ray.origin;
        Self {
            axes,
            shear: [simd.splat(d[axes[0]] / d[z]), simd.splat(d[axes[1]] / d[z])],
            origin: [simd.splat(o[axes[0]]), simd.splat(o[axes[1]]), simd.splat(o[axes[2]])],
        }
    }

    /// One corner of each triangle, with the ray as z axis.
    #[inline(always)]
    fn corner(&self, simd: S, block: &TriangleBlock, first_row: usize) -> (S::F, S::F) {
        let x = simd.load(&block.corners[(first_row + self.axes[0]) % ROWS]) - self.origin[0];
        let y = simd.load(&block.corners[(first_row + self.axes[1]) % ROWS]) - self.origin[1];
        let z = simd.load(&block.corners[(first_row + self.axes[2]) % ROWS]) - self.origin[2];
        (x - self.shear[0] * z, y - self.shear[1] * z)
    }

    /// Which triangles the ray's line crosses, and the weights of their corners (not normalised).
    #[inline(always)]
    fn cross(&self, simd: S, block: &TriangleBlock) -> (u32, [S::F; 3]) {
        let a = self.corner(simd, block, 0);
        let b = self.corner(simd, block, 3);
        let c = self.corner(simd, block, 6);
        cross(simd, a, b, c)
    }
}

/// Which lanes' lines cross their triangle, whose corners are given across the line, and the weights of the corners
/// (not normalised). Products and differences are rounded one by one, so that neighbours agree about their edge.
#[inline(always)]
pub(super) fn cross<F: Lanes>(
    simd: impl Simd<F = F>,
    a: (F, F),
    b: (F, F),
    c: (F, F),
) -> (u32, [F; 3]) {
    let u = c.0 * b.1 - c.1 * b.0;
    let v = a.0 * c.1 - a.1 * c.0;
    let w = b.0 * a.1 - b.1 * a.0;
    let zero = simd.splat(0.0);
    let inside = zero.le(u) & zero.le(v) & zero.le(w);
    let behind = u.le(zero) & v.le(zero) & w.le(zero);
    (((inside | behind) & (u + v + w).ne(zero)).bits(), [u, v, w])
}
