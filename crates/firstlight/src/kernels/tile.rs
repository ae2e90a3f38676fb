//! Closest hit and any hit of up to 64 coherent rays at once: one walk through the tree for all of them.
//!
//! Contract: as `traverse`, with the same bits: each ray's triangle tests are the same operations on the same numbers,
//! and boxes only decide what is not tested.
//!
//! Rays come in groups of eight. A node's eight boxes are tested against the interval of all rays (Boulos et al.,
//! *Interval Arithmetic Culling*, 2006); each box that is left, against the intervals of eight groups at once; and a
//! leaf's box against the eight rays of a group. In leaves, eight rays meet one triangle after the other, or, if few
//! are left, one ray after the other meets eight triangles.
//!
//! Intervals are taken from the end of the rays that lies closer together: shadow rays to a point light share their
//! end, so that they are culled as if they came from the light.

use super::layout::{Child, Node, Target, Tree, TriangleBlock};
use super::traverse::{FLATTENED, HitFilter, Others, PAD, SMALLEST, Search, Slabs, Stack};
use super::triangles::{Shear, accept, axes, cross, plane_distances};
use crate::geometry::{Hit, Ray};
use crate::simd::{LANES, Lanes, Mask, Simd};
use std::ops::Range;

/// Groups of eight rays in a tile, at most.
pub(super) const GROUPS: usize = LANES;
/// The place of the whole tile behind those of its groups.
const WHOLE: usize = GROUPS;
/// Groups with fewer live rays than this are walked on ray by ray.
const FEW: u32 = 3;

/// Eight numbers, aligned.
#[derive(Clone, Copy)]
#[repr(C, align(32))]
struct Row([f32; LANES]);

impl Row {
    const ZERO: Self = Self([0.0; LANES]);
}

/// Three rows. (Not a closure: those are compiled without the level's instructions.)
#[inline(always)]
fn load<S: Simd>(simd: S, rows: &[Row; 3]) -> [S::F; 3] {
    [simd.load(&rows[0].0), simd.load(&rows[1].0), simd.load(&rows[2].0)]
}

/// One lane of three rows, in every lane.
#[inline(always)]
fn splat<S: Simd>(simd: S, rows: &[Row; 3], lane: usize) -> [S::F; 3] {
    [simd.splat(rows[0].0[lane]), simd.splat(rows[1].0[lane]), simd.splat(rows[2].0[lane])]
}

/// Eight rays, structure of arrays.
#[derive(Clone, Copy)]
struct Group {
    origin: [Row; 3],
    direction: [Row; 3],
    /// Per axis and ray: `t = plane · scale + offset`, padded away from the box.
    scale: [Row; 3],
    near: [Row; 3],
    far: [Row; 3],
    t_min: Row,
    /// How far each ray still looks; −∞ if it has its answer.
    t: Row,
    /// The order of the axes for triangles, and the shears in it.
    axes: [usize; 3],
    shear: [Row; 2],
    /// The largest coordinate of its origins.
    magnitude: f32,
    /// The signs of its directions as bits, or `None` if its rays do not agree in them or in their largest axis.
    octant: Option<u32>,
}

/// A number for each group, and one for the whole tile.
#[derive(Clone, Copy)]
struct PerGroup([Row; 2]);

impl PerGroup {
    const ZERO: Self = Self([Row::ZERO; 2]);

    #[inline(always)]
    fn get(&self, place: usize) -> f32 {
        self.0[place / LANES % 2].0[place % LANES]
    }

    #[inline(always)]
    fn set(&mut self, place: usize, x: f32) {
        self.0[place / LANES % 2].0[place % LANES] = x;
    }

    #[inline(always)]
    fn groups(&self) -> &[f32; LANES] {
        &self.0[0].0
    }
}

/// Intervals of groups of rays: per axis `t = plane · scale + offset`, for the earliest entry and the latest exit.
#[derive(Clone, Copy)]
struct Beams {
    near_scale: [PerGroup; 3],
    near: [PerGroup; 3],
    far_scale: [PerGroup; 3],
    far: [PerGroup; 3],
    /// How far each still looks.
    t: PerGroup,
    entry: EntryPlanes,
}

/// Which of a node's six planes rays enter and leave through, by axis.
#[derive(Clone, Copy)]
struct EntryPlanes {
    near: [usize; 3],
    far: [usize; 3],
}

impl EntryPlanes {
    /// For directions whose signs are the bits of `octant`.
    #[inline(always)]
    fn of(octant: u32) -> Self {
        let (mut near, mut far) = ([0, 1, 2], [3, 4, 5]);
        for axis in 0..3 {
            if octant >> axis & 1 == 1 {
                (near[axis], far[axis]) = (far[axis], near[axis]);
            }
        }
        Self { near, far }
    }
}

/// Reciprocal directions and apexes along one axis.
#[derive(Clone, Copy)]
struct Interval {
    scale: [f32; 2],
    apex: [f32; 2],
}

impl Interval {
    const EMPTY: Self = Self {
        scale: [f32::INFINITY, f32::NEG_INFINITY],
        apex: [f32::INFINITY, f32::NEG_INFINITY],
    };

    #[inline(always)]
    fn of<F: Lanes>(scale: F, apex: F) -> Self {
        Self {
            scale: [scale.smallest(), scale.largest()],
            apex: [apex.smallest(), apex.largest()],
        }
    }

    #[inline(always)]
    fn union(self, other: Self) -> Self {
        let join = |a: [f32; 2], b: [f32; 2]| [a[0].min(b[0]), a[1].max(b[1])];
        Self { scale: join(self.scale, other.scale), apex: join(self.apex, other.apex) }
    }
}

impl Beams {
    const NONE: Self = Self {
        near_scale: [PerGroup::ZERO; 3],
        near: [PerGroup::ZERO; 3],
        far_scale: [PerGroup::ZERO; 3],
        far: [PerGroup::ZERO; 3],
        t: PerGroup::ZERO,
        entry: EntryPlanes { near: [0; 3], far: [0; 3] },
    };

    /// Sets one axis of one place. Entries count from 0 on, so that the smallest slope and the apex next to the box
    /// bound them; exits, the largest slope and the other apex.
    #[inline(always)]
    fn set(&mut self, place: usize, axis: usize, interval: Interval, pad: f32) {
        let Interval { scale: [slow, fast], apex: [lo, hi] } = interval;
        let (near_scale, near, far_scale, far) = if slow > 0.0 {
            (slow, hi + pad, fast, lo - pad)
        } else {
            (fast, lo - pad, slow, hi + pad)
        };
        self.near_scale[axis].set(place, near_scale);
        self.near[axis].set(place, -near * near_scale);
        self.far_scale[axis].set(place, far_scale);
        self.far[axis].set(place, -far * far_scale);
    }

    /// Which of a node's boxes the beam at `place` may meet, and not before where.
    #[inline(always)]
    fn meet_node<S: Simd>(&self, simd: S, place: usize, node: &Node) -> (u32, S::F) {
        let (mut enter, mut leave) = (simd.splat(0.0), simd.splat(self.t.get(place)));
        for axis in 0..3 {
            let near = simd.load(&node.planes[self.entry.near[axis] % 6]);
            let far = simd.load(&node.planes[self.entry.far[axis] % 6]);
            let near_scale = simd.splat(self.near_scale[axis].get(place));
            let far_scale = simd.splat(self.far_scale[axis].get(place));
            enter = enter.max(near.mul_add(near_scale, simd.splat(self.near[axis].get(place))));
            leave = leave.min(far.mul_add(far_scale, simd.splat(self.far[axis].get(place))));
        }
        (enter.le(leave).bits(), enter)
    }

    /// Which groups may meet one box of a node.
    #[inline(always)]
    fn meet_box<S: Simd>(&self, simd: S, node: &Node, slot: usize) -> u32 {
        let (mut enter, mut leave) = (simd.splat(0.0), simd.load(self.t.groups()));
        for axis in 0..3 {
            let near = simd.splat(node.planes[self.entry.near[axis] % 6][slot]);
            let far = simd.splat(node.planes[self.entry.far[axis] % 6][slot]);
            let near_scale = simd.load(self.near_scale[axis].groups());
            let far_scale = simd.load(self.far_scale[axis].groups());
            enter = enter.max(near.mul_add(near_scale, simd.load(self.near[axis].groups())));
            leave = leave.min(far.mul_add(far_scale, simd.load(self.far[axis].groups())));
        }
        enter.le(leave).bits()
    }
}

impl Group {
    const EMPTY: Self = Self {
        origin: [Row::ZERO; 3],
        direction: [Row::ZERO; 3],
        scale: [Row::ZERO; 3],
        near: [Row::ZERO; 3],
        far: [Row::ZERO; 3],
        t_min: Row::ZERO,
        t: Row::ZERO,
        axes: [0; 3],
        shear: [Row::ZERO; 2],
        magnitude: 0.0,
        octant: None,
    };

    /// Takes up eight rays.
    #[inline(always)]
    fn load<S: Simd, const ANY: bool>(
        &mut self,
        simd: S,
        reach: f32,
        rays: &[Ray; LANES],
        hits: &[Hit; LANES],
    ) {
        let mut octant = 0;
        let mut agree = true;
        for axis in 0..3 {
            for i in 0..LANES {
                self.origin[axis].0[i] = rays[i].origin[axis];
                self.direction[axis].0[i] = rays[i].direction[axis];
            }
            let signs = simd.load(&self.direction[axis].0).signs();
            agree &= signs == 0 || signs == (1 << LANES) - 1;
            octant |= (signs & 1) << axis;
        }
        let largest = self.largest_axis(simd);
        self.octant = if agree && largest.is_some() { Some(octant) } else { None };
        self.axes = axes(largest.unwrap_or(0));
        if self.octant.is_some() {
            self.prepare(simd, reach);
        }
        for i in 0..LANES {
            self.t_min.0[i] = rays[i].t_min;
            let answered = ANY && hits[i].is_some();
            self.t.0[i] = if answered { f32::NEG_INFINITY } else { hits[i].t };
        }
    }

    /// The axis along which all rays go furthest, the first of equals.
    #[inline(always)]
    fn largest_axis<S: Simd>(&self, simd: S) -> Option<usize> {
        const ALL: u32 = (1 << LANES) - 1;
        let x = simd.load(&self.direction[0].0).abs();
        let y = simd.load(&self.direction[1].0).abs();
        let z = simd.load(&self.direction[2].0).abs();
        match ((y.le(x) & z.le(x)).bits(), z.le(y).bits()) {
            (ALL, _) => Some(0),
            (0, ALL) => Some(1),
            (0, 0) => Some(2),
            _ => None,
        }
    }

    #[inline(always)]
    fn prepare<S: Simd>(&mut self, simd: S, reach: f32) {
        let (zero, one) = (simd.splat(0.0), simd.splat(1.0));
        let [x, y, z] = load(simd, &self.origin);
        let magnitude = x.abs().max(y.abs()).max(z.abs());
        let pad = (magnitude + simd.splat(reach)) * simd.splat(PAD);
        self.magnitude = magnitude.largest();
        for axis in 0..3 {
            let (o, d) = (simd.load(&self.origin[axis].0), simd.load(&self.direction[axis].0));
            let scale = one / d.abs().max(simd.splat(SMALLEST)).copysign(d);
            let pad = pad.copysign(scale);
            self.scale[axis] = Row(scale.to_array());
            self.near[axis] = Row((zero - (o + pad) * scale).to_array());
            self.far[axis] = Row((zero - (o - pad) * scale).to_array());
        }
        let z = simd.load(&self.direction[self.axes[2] % 3].0);
        for i in 0..2 {
            let across = simd.load(&self.direction[self.axes[i] % 3].0);
            self.shear[i] = Row((across / z).to_array());
        }
    }

    /// Where its rays end along one axis.
    #[inline(always)]
    fn end<S: Simd>(&self, simd: S, axis: usize) -> S::F {
        let (o, d) = (simd.load(&self.origin[axis].0), simd.load(&self.direction[axis].0));
        d.mul_add(simd.load(&self.t.0), o)
    }

    /// Its rays, prepared for triangles.
    #[inline(always)]
    fn shear<S: Simd>(&self, simd: S) -> Shear<S> {
        let [x, y, z] = self.axes;
        Shear {
            axes: self.axes,
            shear: [simd.load(&self.shear[0].0), simd.load(&self.shear[1].0)],
            origin: [
                simd.load(&self.origin[x % 3].0),
                simd.load(&self.origin[y % 3].0),
                simd.load(&self.origin[z % 3].0),
            ],
        }
    }

    /// One of its rays, prepared for triangles.
    #[inline(always)]
    fn shear_of<S: Simd>(&self, simd: S, lane: usize) -> Shear<S> {
        let [x, y, z] = self.axes;
        Shear {
            axes: self.axes,
            shear: [simd.splat(self.shear[0].0[lane]), simd.splat(self.shear[1].0[lane])],
            origin: [
                simd.splat(self.origin[x % 3].0[lane]),
                simd.splat(self.origin[y % 3].0[lane]),
                simd.splat(self.origin[z % 3].0[lane]),
            ],
        }
    }

    /// One of its rays, prepared for boxes.
    #[inline(always)]
    fn slabs_of<S: Simd>(&self, simd: S, lane: usize, entry: EntryPlanes) -> Slabs<S> {
        Slabs {
            scale: splat(simd, &self.scale, lane),
            near: splat(simd, &self.near, lane),
            far: splat(simd, &self.far, lane),
            near_plane: entry.near,
            far_plane: entry.far,
            t_min: simd.splat(self.t_min.0[lane]),
            simd,
        }
    }

    /// Which of its rays meet one box of a node before their hit.
    #[inline(always)]
    fn meet_box<S: Simd>(&self, simd: S, node: &Node, slot: usize, entry: EntryPlanes) -> u32 {
        let (mut enter, mut leave) = (simd.load(&self.t_min.0), simd.load(&self.t.0));
        for axis in 0..3 {
            let near = simd.splat(node.planes[entry.near[axis] % 6][slot]);
            let far = simd.splat(node.planes[entry.far[axis] % 6][slot]);
            let scale = simd.load(&self.scale[axis].0);
            enter = enter.max(near.mul_add(scale, simd.load(&self.near[axis].0)));
            leave = leave.min(far.mul_add(scale, simd.load(&self.far[axis].0)));
        }
        enter.le(leave).bits()
    }
}

/// A box to be entered: child `slot` of `node`, met by `groups` not before `near`.
#[derive(Clone, Copy)]
struct Entry {
    near: f32,
    node: u32,
    slot: u16,
    groups: u16,
}

/// What is walked through, and what for.
pub(super) struct Walk<'a, O> {
    pub tree: &'a Tree,
    pub others: &'a O,
    pub rays: &'a [Ray],
    pub hits: &'a mut [Hit],
}

/// Up to 64 rays on their way through a tree.
pub(super) struct Tile<'a, S: Simd> {
    simd: S,
    filter: &'a dyn HitFilter,
    flags: u32,
    groups: [Group; GROUPS],
    count: usize,
    beams: Beams,
    entry: EntryPlanes,
    stack: [Entry; STACK],
    len: usize,
    single: Stack,
}

const STACK: usize = (7 * Stack::DEPTH).next_power_of_two();

impl<'a, S: Simd> Tile<'a, S> {
    pub(super) fn new(simd: S, filter: &'a dyn HitFilter, flags: u32) -> Self {
        let (groups, beams) = ([Group::EMPTY; GROUPS], Beams::NONE);
        let stack = [Entry { near: 0.0, node: 0, slot: 0, groups: 0 }; STACK];
        let (entry, single) = (EntryPlanes::of(0), Stack::new());
        Self { simd, filter, flags, groups, count: 0, beams, entry, stack, len: 0, single }
    }

    /// Takes up the full groups of eight among `rays`; returns how many there are.
    #[inline(always)]
    pub(super) fn load<const ANY: bool>(
        &mut self,
        tree: &Tree,
        rays: &[Ray],
        hits: &[Hit],
    ) -> usize {
        self.count = 0;
        let (rays, hits) = (rays.as_chunks().0, hits.as_chunks().0);
        for (rays, hits) in rays.iter().zip(hits) {
            self.groups[self.count % GROUPS].load::<S, ANY>(self.simd, tree.reach, rays, hits);
            self.count += 1;
        }
        self.count
    }

    /// How many groups, from number `first` on, can go together; 0 if not even the rays of the first can.
    #[inline(always)]
    pub(super) fn together_from(&self, first: usize) -> usize {
        let octant = self.groups[first % GROUPS].octant;
        if octant.is_none() {
            return 0;
        }
        let mut end = first + 1;
        while end < self.count && self.groups[end % GROUPS].octant == octant {
            end += 1;
        }
        end - first
    }

    /// Looks for the hits of `range` groups.
    #[inline(always)]
    pub(super) fn walk<O: Others, const ANY: bool>(
        &mut self,
        range: Range<usize>,
        mut walk: Walk<O>,
    ) {
        self.aim::<ANY>(&range, walk.tree.reach);
        self.len = 0;
        self.enter::<ANY>(walk.tree, 0, (1_u32 << range.end) - (1 << range.start));
        while self.len > 0 {
            self.len -= 1;
            let entry = self.stack[self.len % STACK];
            let reach = self.simd.load(self.beams.t.groups());
            let groups =
                u32::from(entry.groups) & self.simd.splat(entry.near).le(reach).bits();
            let node = &walk.tree.nodes[entry.node as usize];
            let slot = usize::from(entry.slot) % LANES;
            match node.children[slot].target() {
                Target::Node(index) if groups & groups.wrapping_sub(1) != 0 => {
                    self.enter::<ANY>(walk.tree, index, groups);
                }
                _ => self.part::<O, ANY>(groups, node, slot, &mut walk),
            }
        }
    }

    /// Brings the rays of each of `groups` that meet a box to what is in it.
    #[inline(always)]
    fn part<O: Others, const ANY: bool>(
        &mut self,
        mut groups: u32,
        node: &Node,
        slot: usize,
        walk: &mut Walk<O>,
    ) {
        while groups != 0 {
            let g = groups.trailing_zeros() as usize % GROUPS;
            groups &= groups - 1;
            let lanes = self.groups[g].meet_box(self.simd, node, slot, self.entry);
            if lanes == 0 {
                continue;
            }
            let child = node.children[slot];
            let changed = match child.target() {
                Target::Nothing => false,
                Target::Node(index) if lanes.count_ones() >= FEW => {
                    self.enter::<ANY>(walk.tree, index, 1 << g);
                    false
                }
                Target::Block(index) => {
                    let block = &walk.tree.blocks[index];
                    if (lanes.count_ones() as usize) < block.len() {
                        self.each_ray::<O, ANY>(g, lanes, child, walk)
                    } else {
                        self.each_triangle::<O, ANY>(g, lanes, block, walk)
                    }
                }
                Target::Node(_) | Target::Other(_) => {
                    self.each_ray::<O, ANY>(g, lanes, child, walk)
                }
            };
            if changed {
                self.update_reach(g);
            }
        }
    }

    /// Brings rays of a group to what is below `child`, one after the other. Returns whether a hit was replaced.
    #[inline(always)]
    fn each_ray<O: Others, const ANY: bool>(
        &mut self,
        g: usize,
        mut lanes: u32,
        child: Child,
        walk: &mut Walk<O>,
    ) -> bool {
        let mut changed = false;
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize % LANES;
            lanes &= lanes - 1;
            let group = &mut self.groups[g];
            let (ray, hit) = (&walk.rays[LANES * g + lane], &mut walk.hits[LANES * g + lane]);
            let search = Search { simd: self.simd, ray, filter: self.filter, flags: self.flags };
            let prepared =
                (group.slabs_of(self.simd, lane, self.entry), group.shear_of(self.simd, lane));
            let start = (walk.tree, child);
            let stack = &mut self.single;
            if search.walk_from::<O, ANY>(
                start,
                ray,
                &prepared,
                FLATTENED,
                walk.others,
                hit,
                stack,
            ) {
                group.t.0[lane] = if ANY { f32::NEG_INFINITY } else { hit.t };
                changed = true;
            }
        }
        changed
    }

    /// Tests rays of a group against one triangle after the other. Returns whether a hit was replaced.
    #[inline(always)]
    fn each_triangle<O, const ANY: bool>(
        &mut self,
        g: usize,
        lanes: u32,
        block: &TriangleBlock,
        walk: &mut Walk<O>,
    ) -> bool {
        let simd = self.simd;
        let shear = self.groups[g].shear(simd);
        let zero = simd.splat(0.0);
        let mut points = [(zero, zero); LANES];
        for (vertex, point) in points.iter_mut().enumerate().take(block.vertex_count()) {
            *point = shear.apply(
                simd.splat(block.vertices[shear.axes[0] % 3][vertex]),
                simd.splat(block.vertices[shear.axes[1] % 3][vertex]),
                simd.splat(block.vertices[shear.axes[2] % 3][vertex]),
            );
        }
        let mut changed = false;
        for triangle in 0..block.len() % (LANES + 1) {
            let a = points[block.corner_vertex(0, triangle)];
            let b = points[block.corner_vertex(1, triangle)];
            let c = points[block.corner_vertex(2, triangle)];
            let (crossed, weights) = cross(simd, a, b, c);
            if crossed & lanes != 0 {
                changed |=
                    self.take::<O, ANY>(g, crossed & lanes, (block, triangle), weights, walk);
            }
        }
        changed
    }

    /// Takes a triangle as the hit of those of `crossed` rays of a group that it is nearer for. Returns whether there
    /// are any.
    #[inline(always)]
    fn take<O, const ANY: bool>(
        &mut self,
        g: usize,
        crossed: u32,
        (block, triangle): (&TriangleBlock, usize),
        weights: [S::F; 3],
        walk: &mut Walk<O>,
    ) -> bool {
        let (simd, group) = (self.simd, &mut self.groups[g]);
        let (origin, direction) = (load(simd, &group.origin), load(simd, &group.direction));
        let t = plane_distances(simd, origin, direction, block.triangle(triangle));
        let (t_min, t_max) = (simd.load(&group.t_min.0), simd.load(&group.t.0));
        let word = walk.tree.word(block, triangle);
        let clear = if word.flags() & self.flags == 0 {
            (t_min.lt(t) & t.lt(t_max)).bits() & crossed
        } else {
            0
        };
        // Out of range for certain: beyond the end, or not beyond the start; not so where t is not a number.
        let out = (t.le(t_min).bits() | t_max.lt(t).bits()) & t.abs().lt(simd.splat(f32::INFINITY)).bits();
        let (mut unclear, mut taken) = (crossed & !clear & !out, clear);
        let scale = simd.splat(1.0) / (weights[0] + weights[1] + weights[2]);
        let (t, u, v) =
            (t.to_array(), (weights[1] * scale).to_array(), (weights[2] * scale).to_array());
        let mut rest = clear;
        while rest != 0 {
            let lane = rest.trailing_zeros() as usize % LANES;
            rest &= rest - 1;
            walk.hits[LANES * g + lane] = Hit {
                t: t[lane],
                u: u[lane],
                v: v[lane],
                surface: FLATTENED,
                primitive: word.number(),
            };
        }
        if unclear != 0 {
            let weights = [weights[0].to_array(), weights[1].to_array(), weights[2].to_array()];
            while unclear != 0 {
                let lane = unclear.trailing_zeros() as usize % LANES;
                unclear &= unclear - 1;
                let (ray, hit) = (&walk.rays[LANES * g + lane], &mut walk.hits[LANES * g + lane]);
                let search = Search { simd, ray, filter: self.filter, flags: self.flags };
                let weights = [weights[0][lane], weights[1][lane], weights[2][lane]];
                let triangle = (walk.tree, block, triangle);
                taken |= u32::from(accept(&search, ray, triangle, weights, FLATTENED, hit)) << lane;
            }
        }
        let mut rest = taken;
        while rest != 0 {
            let lane = rest.trailing_zeros() as usize % LANES;
            rest &= rest - 1;
            let hit = &walk.hits[LANES * g + lane];
            group.t.0[lane] = if ANY { f32::NEG_INFINITY } else { hit.t };
        }
        taken != 0
    }

    /// Puts the boxes of a node that any of `groups` may meet onto the stack, the nearest on top.
    #[inline(always)]
    fn enter<const ANY: bool>(&mut self, tree: &Tree, index: usize, groups: u32) {
        let node = &tree.nodes[index];
        let only = groups & (groups - 1) == 0;
        let place = if only { groups.trailing_zeros() as usize } else { WHOLE };
        let (mut met, near) = self.beams.meet_node(self.simd, place, node);
        let (near, floor) = (near.to_array(), self.len);
        while met != 0 {
            let slot = met.trailing_zeros() as usize % LANES;
            met &= met - 1;
            let groups =
                if only { groups } else { groups & self.beams.meet_box(self.simd, node, slot) };
            if groups != 0 {
                let entry = Entry {
                    near: near[slot],
                    node: index as u32,
                    slot: slot as u16,
                    groups: groups as u16,
                };
                self.push::<ANY>(entry, floor);
            }
        }
    }

    /// Adds an entry; if the order matters, below nearer ones down to the level `floor`.
    #[inline(always)]
    fn push<const ANY: bool>(&mut self, entry: Entry, floor: usize) {
        let mut i = self.len;
        self.len += 1;
        while !ANY && i > floor && self.stack[(i - 1) % STACK].near < entry.near {
            self.stack[i % STACK] = self.stack[(i - 1) % STACK];
            i -= 1;
        }
        self.stack[i % STACK] = entry;
    }

    /// Prepares the intervals of `range` groups.
    #[inline(always)]
    fn aim<const ANY: bool>(&mut self, range: &Range<usize>, reach: f32) {
        let octant = self.groups[range.start % GROUPS].octant.unwrap_or(0);
        self.entry = EntryPlanes::of(octant);
        let ends = if ANY { self.converging(range) } else { None };
        self.beams.entry = if ends.is_some() { EntryPlanes::of(!octant) } else { self.entry };
        let mut magnitude = ends.unwrap_or(0.0);
        for g in range.clone() {
            magnitude = magnitude.max(self.groups[g % GROUPS].magnitude);
        }
        let pad = 4.0 * PAD * (magnitude + reach);
        for axis in 0..3 {
            let mut whole = Interval::EMPTY;
            for g in range.clone() {
                let interval = self.interval(g % GROUPS, axis, ends.is_some());
                self.beams.set(g % GROUPS, axis, interval, pad);
                whole = whole.union(interval);
            }
            self.beams.set(WHOLE, axis, whole, pad);
        }
        self.beams.t = PerGroup([Row([f32::NEG_INFINITY; LANES]); 2]);
        for g in range.clone() {
            self.update_reach(g % GROUPS);
        }
    }

    /// The interval of a group along one axis, seen from the ends of its rays if `reversed`.
    #[inline(always)]
    fn interval(&self, g: usize, axis: usize, reversed: bool) -> Interval {
        let (simd, group) = (self.simd, &self.groups[g]);
        let scale = simd.load(&group.scale[axis].0);
        if reversed {
            Interval::of(simd.splat(0.0) - scale, group.end(simd, axis))
        } else {
            Interval::of(scale, simd.load(&group.origin[axis].0))
        }
    }

    /// The largest coordinate of the rays' ends, if these lie closer together than the origins.
    #[inline(always)]
    fn converging(&self, range: &Range<usize>) -> Option<f32> {
        let simd = self.simd;
        let infinite = simd.splat(f32::INFINITY);
        let (mut origins, mut ends, mut magnitude) = (0.0_f32, 0.0_f32, 0.0_f32);
        for axis in 0..3 {
            let [mut lo, mut hi, mut end_lo] = [infinite, simd.splat(f32::NEG_INFINITY), infinite];
            let mut end_hi = hi;
            for g in range.clone() {
                let group = &self.groups[g % GROUPS];
                let (origin, end) = (simd.load(&group.origin[axis].0), group.end(simd, axis));
                if end.abs().lt(infinite).bits() != (1 << LANES) - 1 {
                    return None;
                }
                (lo, hi) = (lo.min(origin), hi.max(origin));
                (end_lo, end_hi) = (end_lo.min(end), end_hi.max(end));
            }
            let [end_lo, end_hi] = [end_lo.smallest(), end_hi.largest()];
            origins = origins.max(hi.largest() - lo.smallest());
            ends = ends.max(end_hi - end_lo);
            magnitude = magnitude.max(end_lo.abs()).max(end_hi.abs());
        }
        (ends < origins).then_some(magnitude)
    }

    /// Notes how far a group still looks.
    #[inline(always)]
    fn update_reach(&mut self, g: usize) {
        let reach = self.simd.load(&self.groups[g].t.0).largest();
        self.beams.t.set(g, reach);
        let whole = self.simd.load(self.beams.t.groups()).largest();
        self.beams.t.set(WHOLE, whole);
    }
}
