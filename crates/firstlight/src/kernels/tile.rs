//! Closest hit and any hit of coherent rays, up to eight groups at once: one walk through the tree for all of them.
//!
//! Contract: as `traverse`, with the same bits: each ray's triangle tests are the same operations on the same numbers,
//! and boxes only decide what is not tested.
//!
//! Rays come in groups, as many as a vector for rays has lanes: eight, or sixteen. A node's eight boxes are tested against
//! the interval of all rays; each box that is left, against the intervals of all groups at once; and a leaf's box against
//! the rays of a group. In leaves, a group's rays meet one triangle after the other. Hits stay with the groups until all
//! have their answers.
//!
//! Intervals are taken from the end of the rays that lies closer together: shadow rays to a point light share their
//! end, so that they are culled as if they came from the light.

use super::alone::Walk;
use super::beams::{Beams, GROUPS, Row, WHOLE, extremes};
use super::group::{Group, all, load};
use super::layout::{Child, EntryPlanes, Node, Target, Tree, TriangleBlock};
use super::stream::Strays;
use super::traverse::{Answer, FLATTENED, Others, PAD, Search, Stack};
use super::triangles::{accept, cross, plane_distances};
use crate::geometry::Ray;
use crate::simd::{LANES, Lanes, MOST, Mask, Simd, Vectors};
use std::ops::Range;

/// Groups with fewer live rays than this are walked on ray by ray.
const FEW: u32 = 3;
/// After so many boxes that groups were brought to for nothing, in excess of the others, intervals are not trusted
/// any more in this walk: rays that start far apart, or at grazing angles, are too wide for them.
const TOO_WIDE: i32 = 16;

/// A box to be entered: child `slot` of `node`, met by `groups` not before `near`.
#[derive(Clone, Copy)]
struct Entry {
    near: f32,
    node: u32,
    slot: u16,
    groups: u16,
}

/// Coherent rays on their way through a tree, up to eight groups.
pub(super) struct Tile<S: Simd> {
    simd: S,
    groups: [Group<S::Rays>; GROUPS],
    /// The signs of each group's directions as bits, if it goes together.
    octants: [Option<u32>; GROUPS],
    beams: Beams,
    entry: &'static EntryPlanes,
    stack: [Entry; STACK],
    len: usize,
    /// Boxes that groups were brought to for nothing, less those that a ray of them met.
    wasted: i32,
    /// For rays that go on alone.
    single: Stack,
}

const STACK: usize = (7 * Stack::DEPTH).next_power_of_two();

impl<S: Simd> Tile<S> {
    pub(super) fn new(simd: S) -> Self {
        Self {
            simd,
            groups: [Group::EMPTY; GROUPS],
            octants: [None; GROUPS],
            beams: Beams::NONE,
            entry: EntryPlanes::of(0),
            stack: [Entry { near: 0.0, node: 0, slot: 0, groups: 0 }; STACK],
            len: 0,
            wasted: 0,
            single: Stack::new(),
        }
    }

    /// Answers the rays of `walk`, at most eight groups. `known`: there are answers already. Rays that do not go together are
    /// added to `strays`, if there are to be any; they count from `base`.
    #[inline(always)]
    pub(super) fn answer<O: Others, A: Answer<ANY>, const ANY: bool>(
        &mut self,
        walk: Walk<O>,
        (answers, known): (&mut [A], bool),
        (base, mut strays): (usize, Option<&mut Strays>),
    ) {
        let (size, mut count) = (S::Rays::COUNT, 0);
        for (rays, answers) in walk.rays.chunks(size).zip(answers.chunks_mut(size)) {
            self.prefetch_next(rays);
            // Most that do not go together differ in the first and the last.
            let apart = strays.is_some() && rays[0].octant() != rays[rays.len() - 1].octant();
            let octant = if apart { None } else { self.load(count, rays) };
            if octant.is_some() || strays.is_none() {
                self.prepare(count, walk.tree.reach, (answers, known));
            }
            let group = &self.groups[count % GROUPS];
            self.octants[count % GROUPS] = octant.filter(|_| group.goes_one_way());
            match &mut strays {
                _ if self.octants[count % GROUPS].is_some() => {}
                Some(strays) => strays.add(base + size * count, rays, (answers, known)),
                None => self.alone::<O, ANY>(count, &walk),
            }
            count += 1;
        }
        let mut first = 0;
        while first < count {
            let end = self.together_from(first, count);
            if end > first {
                self.walk::<O, ANY>(first..end, &walk);
            }
            first = end.max(first + 1);
        }
        for (g, answers) in answers.chunks_mut(size).enumerate() {
            if self.octants[g % GROUPS].is_some() || strays.is_none() {
                self.groups[g % GROUPS].answer(answers);
            }
        }
        A::name(answers, walk.others);
    }

    /// Asks for the rays of the next tile, as far as they stand where these do in this one.
    #[inline(always)]
    fn prefetch_next(&self, rays: &[Ray]) {
        for part in 0..S::Rays::COUNT / LANES {
            let next = rays.as_ptr().wrapping_add(GROUPS * S::Rays::COUNT + LANES * part);
            self.simd.prefetch(next.cast::<[Ray; LANES]>());
        }
    }

    /// Takes up the rays of a group. Returns the signs of their directions as bits, if they agree.
    #[inline(always)]
    fn load(&mut self, g: usize, rays: &[Ray]) -> Option<u32> {
        let group = &mut self.groups[g % GROUPS];
        let padded: [_; MOST] = std::array::from_fn(|lane| &rays[lane.min(rays.len() - 1)]);
        group.load(self.simd, &padded[..rays.len().min(S::Rays::COUNT)]);
        group.octant()
    }

    /// Prepares the rays of a group, some of which may have answers that are known.
    #[inline(always)]
    fn prepare<A: Answer<ANY>, const ANY: bool>(
        &mut self,
        g: usize,
        reach: f32,
        (answers, known): (&[A], bool),
    ) {
        let group = &mut self.groups[g % GROUPS];
        group.prepare(self.simd.rays(), reach);
        group.forget(self.simd.rays());
        if known {
            group.know(answers);
        }
    }

    /// Looks for the hits of a group, ray by ray.
    #[inline(always)]
    fn alone<O: Others, const ANY: bool>(&mut self, g: usize, walk: &Walk<O>) {
        let group = &mut self.groups[g % GROUPS];
        let (looking, start) = (group.looking(self.simd.rays()), Child::node(0));
        walk.alone::<S, ANY>(self.simd, (g, group), looking, start, &mut self.single);
    }

    /// The end of the groups from number `first` on that can go together; `first` if not even its rays can.
    #[inline(always)]
    fn together_from(&self, first: usize, count: usize) -> usize {
        let octant = self.octants[first % GROUPS];
        let mut end = first;
        while octant.is_some() && end < count && self.octants[end % GROUPS] == octant {
            end += 1;
        }
        end
    }

    /// Looks for the hits of `range` groups.
    #[inline(always)]
    pub(super) fn walk<O: Others, const ANY: bool>(&mut self, range: Range<usize>, walk: &Walk<O>) {
        self.aim::<ANY>(&range, walk.tree.reach);
        (self.len, self.wasted) = (0, 0);
        self.enter::<ANY>(walk.tree, 0, (1_u32 << range.end) - (1 << range.start));
        while self.len > 0 {
            self.len -= 1;
            let entry = self.stack[self.len % STACK];
            let reach = self.simd.load(&self.beams.reach.0);
            let groups = u32::from(entry.groups) & self.simd.splat(entry.near).le(reach).bits();
            let node = &walk.tree.nodes[entry.node as usize];
            let slot = usize::from(entry.slot) % LANES;
            let groups =
                if self.wasted > TOO_WIDE { self.that_meet(groups, node, slot) } else { groups };
            match node.child(slot).target() {
                Target::Node(index) if groups & groups.wrapping_sub(1) != 0 => {
                    self.enter::<ANY>(walk.tree, index, groups);
                }
                _ => self.part::<O, ANY>(groups, node, slot, walk),
            }
        }
    }

    /// Those of `groups` of which a ray meets a box.
    #[inline(always)]
    fn that_meet(&self, groups: u32, node: &Node, slot: usize) -> u32 {
        let (mut rest, mut met) = (groups, 0);
        while rest != 0 {
            let g = rest.trailing_zeros() as usize % GROUPS;
            rest &= rest - 1;
            let lanes = self.groups[g].meet_box(self.simd.rays(), node, slot, self.entry);
            met |= u32::from(lanes != 0) << g;
        }
        met
    }

    /// Brings the rays of each of `groups` that meet a box to what is in it.
    #[inline(always)]
    fn part<O: Others, const ANY: bool>(
        &mut self,
        mut groups: u32,
        node: &Node,
        slot: usize,
        walk: &Walk<O>,
    ) {
        while groups != 0 {
            let g = groups.trailing_zeros() as usize % GROUPS;
            groups &= groups - 1;
            let lanes = self.groups[g].meet_box(self.simd.rays(), node, slot, self.entry);
            self.wasted += if lanes == 0 { 1 } else { -1 };
            if lanes == 0 {
                continue;
            }
            let child = node.child(slot);
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
                Target::Node(_) => {
                    let group = (g, &mut self.groups[g]);
                    walk.alone::<S, ANY>(self.simd, group, lanes, child, &mut self.single)
                }
                Target::Other(surface) => {
                    let group = (g, &mut self.groups[g]);
                    walk.visit::<S, ANY>(group, lanes, surface, &mut self.single)
                }
            };
            if changed {
                let t = self.simd.rays().load(&self.groups[g].t).largest();
                self.beams.set_reach(self.simd, g, t);
            }
        }
    }

    /// Tests rays of a group against one triangle after the other. Returns whether a hit was replaced.
    #[inline(always)]
    fn each_triangle<O, const ANY: bool>(
        &mut self,
        g: usize,
        lanes: u32,
        block: &TriangleBlock,
        walk: &Walk<O>,
    ) -> bool {
        let points = self.groups[g].across(self.simd.rays(), block);
        let mut changed = false;
        for triangle in 0..block.len() % (LANES + 1) {
            let a = points[block.corner_vertex(0, triangle)];
            let b = points[block.corner_vertex(1, triangle)];
            let c = points[block.corner_vertex(2, triangle)];
            let (crossed, weights) = cross(self.simd.rays(), a, b, c);
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
        weights: [<S::Rays as Vectors>::F; 3],
        walk: &Walk<O>,
    ) -> bool {
        let (simd, group) = (self.simd.rays(), &mut self.groups[g]);
        let (origin, direction) = (load(simd, &group.origin), load(simd, &group.direction));
        let t = plane_distances(simd, origin, direction, block.triangle(triangle));
        let (t_min, t_max) = (simd.load(&group.t_min), simd.load(&group.t));
        let word = walk.tree.word(block, triangle);
        // Where t is not a number, or equals that of the hit there is, the scalar test decides.
        let nearer = t_min.lt(t) & t.lt(t_max);
        let out = (t.le(t_min).bits() | t_max.lt(t).bits())
            & t.abs().lt(simd.splat(f32::INFINITY)).bits();
        let asked = word.flags() & walk.flags != 0;
        let clear = if asked { 0 } else { nearer.bits() & crossed };
        group.take::<ANY>(simd, simd.mask(clear), (t, weights), word.number());
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
        weights: [<S::Rays as Vectors>::F; 3],
        walk: &Walk<O>,
    ) -> bool {
        let weights = [weights[0].to_array(), weights[1].to_array(), weights[2].to_array()];
        let weights = [weights[0].as_ref(), weights[1].as_ref(), weights[2].as_ref()];
        let mut taken = false;
        while rays != 0 {
            let lane = rays.trailing_zeros() as usize % S::Rays::COUNT;
            rays &= rays - 1;
            let number = S::Rays::COUNT * g + lane;
            let (ray, mut hit) = (&walk.rays[number], self.groups[g].hit(lane));
            let search = Search { simd: self.simd, ray, filter: walk.filter, flags: walk.flags };
            let weights = [weights[0][lane], weights[1][lane], weights[2][lane]];
            let triangle = (walk.tree, block, triangle);
            if accept(&search, ray, triangle, weights, FLATTENED, &mut hit) {
                self.groups[g].found::<ANY>(lane, &hit);
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
        let octant = self.octants[range.start % GROUPS].unwrap_or(0);
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
            let (scale, apex) = (extremes(self.simd, &scale), extremes(self.simd, &apex));
            self.beams.set(self.simd, axis, scale, apex, pad);
        }
        let mut reach = Row([f32::NEG_INFINITY; LANES]);
        for g in range.clone() {
            reach.0[g % GROUPS] = self.simd.rays().load(&self.groups[g % GROUPS].t).largest();
        }
        self.beams.reach = reach;
    }

    /// Reciprocal directions and apexes of all groups along one axis, seen from the ends of the rays if `reversed`;
    /// groups outside `range` count as its first.
    #[inline(always)]
    fn rows(
        &self,
        range: &Range<usize>,
        axis: usize,
        reversed: bool,
    ) -> [[<S::Rays as Vectors>::F; GROUPS]; 2] {
        let simd = self.simd.rays();
        let zero = simd.splat(0.0);
        let (mut scales, mut apexes) = ([zero; GROUPS], [zero; GROUPS]);
        for (g, (scale, apex)) in scales.iter_mut().zip(&mut apexes).enumerate() {
            let group = &self.groups[if range.contains(&g) { g } else { range.start } % GROUPS];
            *scale = simd.load(&group.scale[axis]);
            *apex = simd.load(&group.origin[axis]);
            if reversed {
                (*scale, *apex) = (zero - *scale, group.end(simd, axis));
            }
        }
        [scales, apexes]
    }

    /// The largest coordinate of the rays' ends, if these lie closer together than the origins.
    #[inline(always)]
    fn converging(&self, range: &Range<usize>) -> Option<f32> {
        let simd = self.simd.rays();
        let infinite = simd.splat(f32::INFINITY);
        let (mut origins, mut ends, mut magnitude) = (0.0_f32, 0.0_f32, 0.0_f32);
        for axis in 0..3 {
            let [mut lo, mut hi, mut end_lo] = [infinite, simd.splat(f32::NEG_INFINITY), infinite];
            let mut end_hi = hi;
            for g in range.clone() {
                let group = &self.groups[g % GROUPS];
                let (origin, end) = (simd.load(&group.origin[axis]), group.end(simd, axis));
                if end.abs().lt(infinite).bits() != all::<S::Rays>() {
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
}
