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

/// Eight numbers to memory.
#[inline(always)]
fn row<F: Lanes>(x: F) -> Row {
    Row(x.to_array())
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
struct PerGroup {
    groups: Row,
    whole: f32,
}

impl PerGroup {
    const ZERO: Self = Self { groups: Row::ZERO, whole: 0.0 };

    /// At the place of a group, or of the whole tile.
    #[inline(always)]
    fn at(&self, place: usize) -> f32 {
        if place == WHOLE { self.whole } else { self.groups.0[place % GROUPS] }
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

impl Beams {
    const NONE: Self = Self {
        near_scale: [PerGroup::ZERO; 3],
        near: [PerGroup::ZERO; 3],
        far_scale: [PerGroup::ZERO; 3],
        far: [PerGroup::ZERO; 3],
        t: PerGroup::ZERO,
        entry: EntryPlanes { near: [0; 3], far: [0; 3] },
    };

    /// Sets one axis for all groups from the smallest and largest reciprocals of directions and apexes. Entries count
    /// from 0 on, so that the smallest slope and the apex next to the box bound them; exits, the largest slope and the
    /// other apex.
    #[inline(always)]
    fn set<S: Simd>(&mut self, simd: S, axis: usize, scale: [S::F; 2], apex: [S::F; 2], pad: f32) {
        let pad = simd.splat(pad);
        let [slow, fast] = scale;
        let [lo, hi] = [apex[0] - pad, apex[1] + pad];
        let backward = self.entry.near[axis] >= 3;
        let [near_scale, far_scale] = if backward { [fast, slow] } else { [slow, fast] };
        let [near, far] = if backward { [lo, hi] } else { [hi, lo] };
        let (near_whole, far_whole) = if backward {
            (near_scale.largest(), far_scale.smallest())
        } else {
            (near_scale.smallest(), far_scale.largest())
        };
        let (near_apex, far_apex) = if backward {
            (near.smallest(), far.largest())
        } else {
            (near.largest(), far.smallest())
        };
        let zero = simd.splat(0.0);
        self.near_scale[axis] = PerGroup { groups: row(near_scale), whole: near_whole };
        self.near[axis] =
            PerGroup { groups: row(zero - near * near_scale), whole: -near_apex * near_whole };
        self.far_scale[axis] = PerGroup { groups: row(far_scale), whole: far_whole };
        self.far[axis] =
            PerGroup { groups: row(zero - far * far_scale), whole: -far_apex * far_whole };
    }

    /// Which of a node's boxes the beam at `place` may meet, and not before where.
    #[inline(always)]
    fn meet_node<S: Simd>(&self, simd: S, place: usize, node: &Node) -> (u32, S::F) {
        let (mut enter, mut leave) = (simd.splat(0.0), simd.splat(self.t.at(place)));
        for axis in 0..3 {
            let near = simd.load(&node.planes[self.entry.near[axis] % 6]);
            let far = simd.load(&node.planes[self.entry.far[axis] % 6]);
            let near_scale = simd.splat(self.near_scale[axis].at(place));
            let far_scale = simd.splat(self.far_scale[axis].at(place));
            enter = enter.max(near.mul_add(near_scale, simd.splat(self.near[axis].at(place))));
            leave = leave.min(far.mul_add(far_scale, simd.splat(self.far[axis].at(place))));
        }
        (enter.le(leave).bits(), enter)
    }

    /// Which groups may meet one box of a node.
    #[inline(always)]
    fn meet_box<S: Simd>(&self, simd: S, node: &Node, slot: usize) -> u32 {
        let (mut enter, mut leave) = (simd.splat(0.0), simd.load(&self.t.groups.0));
        for axis in 0..3 {
            let near = simd.splat(node.planes[self.entry.near[axis] % 6][slot]);
            let far = simd.splat(node.planes[self.entry.far[axis] % 6][slot]);
            let near_scale = simd.load(&self.near_scale[axis].groups.0);
            let far_scale = simd.load(&self.far_scale[axis].groups.0);
            enter = enter.max(near.mul_add(near_scale, simd.load(&self.near[axis].groups.0)));
            leave = leave.min(far.mul_add(far_scale, simd.load(&self.far[axis].groups.0)));
        }
        enter.le(leave).bits()
    }
}

/// The axis along which all rays go furthest, the first of equals, from the absolute values of their directions.
#[inline(always)]
fn largest_axis<F: Lanes>([x, y, z]: [F; 3]) -> Option<usize> {
    const ALL: u32 = (1 << LANES) - 1;
    match ((y.le(x) & z.le(x)).bits(), z.le(y).bits()) {
        (ALL, _) => Some(0),
        (0, ALL) => Some(1),
        (0, 0) => Some(2),
        _ => None,
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
    fn load<S: Simd>(&mut self, simd: S, reach: f32, rays: &[Ray; LANES]) {
        let mut rows = [simd.splat(0.0); LANES];
        for (row, ray) in rows.iter_mut().zip(rays) {
            let (o, d) = (ray.origin, ray.direction);
            *row = simd.load(&[o.x, o.y, o.z, d.x, d.y, d.z, ray.t_min, ray.t_max]);
        }
        let [ox, oy, oz, dx, dy, dz, t_min, t_max] = simd.transpose(rows);
        self.origin = [row(ox), row(oy), row(oz)];
        self.direction = [row(dx), row(dy), row(dz)];
        (self.t_min, self.t) = (row(t_min), row(t_max));
        let signs = [dx.signs(), dy.signs(), dz.signs()];
        let agree = signs.iter().all(|&signs| signs == 0 || signs == (1 << LANES) - 1);
        let largest = largest_axis([dx.abs(), dy.abs(), dz.abs()]).filter(|_| agree);
        self.octant = largest.map(|_| signs[0] & 1 | signs[1] & 2 | signs[2] & 4);
        if let Some(largest) = largest {
            self.axes = axes(largest);
            self.prepare(simd, reach);
        }
    }

    /// Leaves out rays that have their answer, and looks no further than known hits.
    #[inline(always)]
    fn know<const ANY: bool>(&mut self, hits: &[Hit; LANES]) {
        for (t, hit) in self.t.0.iter_mut().zip(hits) {
            *t = if ANY && hit.is_some() { f32::NEG_INFINITY } else { hit.t };
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
            self.scale[axis] = row(scale);
            self.near[axis] = row(zero - (o + pad) * scale);
            self.far[axis] = row(zero - (o - pad) * scale);
        }
        let z = simd.load(&self.direction[self.axes[2] % 3].0);
        for i in 0..2 {
            let across = simd.load(&self.direction[self.axes[i] % 3].0);
            self.shear[i] = row(across / z);
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
    pub(super) fn load(&mut self, tree: &Tree, rays: &[Ray]) -> usize {
        let groups = rays.as_chunks().0;
        for (group, rays) in self.groups.iter_mut().zip(groups) {
            group.load(self.simd, tree.reach, rays);
        }
        self.count = groups.len().min(GROUPS);
        self.count
    }

    /// Takes over hits that are known.
    #[inline(always)]
    pub(super) fn know<const ANY: bool>(&mut self, hits: &[Hit]) {
        for (group, hits) in self.groups.iter_mut().zip(hits.as_chunks().0) {
            group.know::<ANY>(hits);
        }
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
            let reach = self.simd.load(&self.beams.t.groups.0);
            let groups = u32::from(entry.groups) & self.simd.splat(entry.near).le(reach).bits();
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
                    self.each_triangle::<O, ANY>(g, lanes, block, walk)
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
            if search.walk_from::<O, ANY>(start, ray, &prepared, FLATTENED, walk.others, hit, stack)
            {
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
        // Where t is not a number, or equals that of the hit there is, the scalar test decides.
        let nearer = t_min.lt(t) & t.lt(t_max);
        let out = (t.le(t_min).bits() | t_max.lt(t).bits())
            & t.abs().lt(simd.splat(f32::INFINITY)).bits();
        let asked = word.flags() & self.flags != 0;
        let clear = if asked { 0 } else { nearer.bits() & crossed };
        let reach = if ANY { simd.splat(f32::NEG_INFINITY) } else { t };
        group.t = row(reach.select(simd.mask(clear), t_max));
        let scale = simd.splat(1.0) / (weights[0] + weights[1] + weights[2]);
        let (u, v) = ((weights[1] * scale).to_array(), (weights[2] * scale).to_array());
        let (t, surface, primitive) = (t.to_array(), FLATTENED, word.number());
        let mut rest = clear;
        while rest != 0 {
            let lane = rest.trailing_zeros() as usize % LANES;
            rest &= rest - 1;
            let hit = Hit { t: t[lane], u: u[lane], v: v[lane], surface, primitive };
            walk.hits[LANES * g + lane] = hit;
        }
        let unclear = crossed & !clear & !out;
        let tried =
            unclear != 0 && self.try_each::<O, ANY>(g, unclear, (block, triangle), weights, walk);
        clear != 0 || tried
    }

    /// As [`Tile::take`], ray by ray.
    #[inline(always)]
    fn try_each<O, const ANY: bool>(
        &mut self,
        g: usize,
        mut rays: u32,
        (block, triangle): (&TriangleBlock, usize),
        weights: [S::F; 3],
        walk: &mut Walk<O>,
    ) -> bool {
        let weights = [weights[0].to_array(), weights[1].to_array(), weights[2].to_array()];
        let mut taken = false;
        while rays != 0 {
            let lane = rays.trailing_zeros() as usize % LANES;
            rays &= rays - 1;
            let (ray, hit) = (&walk.rays[LANES * g + lane], &mut walk.hits[LANES * g + lane]);
            let search = Search { simd: self.simd, ray, filter: self.filter, flags: self.flags };
            let weights = [weights[0][lane], weights[1][lane], weights[2][lane]];
            let triangle = (walk.tree, block, triangle);
            if accept(&search, ray, triangle, weights, FLATTENED, hit) {
                self.groups[g].t.0[lane] = if ANY { f32::NEG_INFINITY } else { hit.t };
                taken = true;
            }
        }
        taken
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
            let [scale, apex] = self.rows(range, axis, ends.is_some());
            let (scale, apex) = (extremes(self.simd, scale), extremes(self.simd, apex));
            self.beams.set(self.simd, axis, scale, apex, pad);
        }
        let mut reach = Row([f32::NEG_INFINITY; LANES]);
        for g in range.clone() {
            reach.0[g % GROUPS] = self.simd.load(&self.groups[g % GROUPS].t.0).largest();
        }
        self.beams.t = PerGroup { groups: reach, whole: self.simd.load(&reach.0).largest() };
    }

    /// Reciprocal directions and apexes of all groups along one axis, seen from the ends of the rays if `reversed`;
    /// groups outside `range` count as its first.
    #[inline(always)]
    fn rows(&self, range: &Range<usize>, axis: usize, reversed: bool) -> [[S::F; GROUPS]; 2] {
        let simd = self.simd;
        let zero = simd.splat(0.0);
        let (mut scales, mut apexes) = ([zero; GROUPS], [zero; GROUPS]);
        for (g, (scale, apex)) in scales.iter_mut().zip(&mut apexes).enumerate() {
            let group = &self.groups[if range.contains(&g) { g } else { range.start } % GROUPS];
            *scale = simd.load(&group.scale[axis].0);
            *apex = simd.load(&group.origin[axis].0);
            if reversed {
                (*scale, *apex) = (zero - *scale, group.end(simd, axis));
            }
        }
        [scales, apexes]
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
        let simd = self.simd;
        let reach = simd.splat(simd.load(&self.groups[g].t.0).largest());
        let groups = reach.select(simd.mask(1 << g), simd.load(&self.beams.t.groups.0));
        self.beams.t = PerGroup { groups: row(groups), whole: groups.largest() };
    }
}

/// The smallest and the largest of each row, as lanes.
#[inline(always)]
fn extremes<S: Simd>(simd: S, rows: [S::F; LANES]) -> [S::F; 2] {
    let columns = simd.transpose(rows);
    let (mut lo, mut hi) = (columns[0], columns[0]);
    for column in columns {
        (lo, hi) = (lo.min(column), hi.max(column));
    }
    [lo, hi]
}
