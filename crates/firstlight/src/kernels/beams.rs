//! Where groups of rays may meet boxes: intervals instead of rays.
//!
//! Boulos et al., *Interval Arithmetic Culling*, 2006.

use super::layout::{EntryPlanes, Node, Plane};
use crate::simd::{LANES, Lanes, Mask, Simd, Vectors};

/// Groups of rays in a tile, at most.
pub(super) const GROUPS: usize = LANES;
/// The place of the whole tile behind those of its groups.
pub(super) const WHOLE: usize = GROUPS;

/// Eight numbers, aligned.
#[derive(Clone, Copy)]
#[repr(C, align(32))]
pub(super) struct Row(pub [f32; LANES]);

impl Row {
    /// Zeros.
    const ZERO: Self = Self([0.0; LANES]);
}

/// Eight numbers to memory.
#[inline(always)]
fn row<F: Lanes<Row = [f32; LANES]>>(x: F) -> Row {
    Row(x.to_array())
}

/// A number for each group, and one for the whole tile.
#[derive(Clone, Copy)]
pub(super) struct PerGroup {
    pub groups: Row,
    pub whole: f32,
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
pub(super) struct Beams {
    near_scale: [PerGroup; 3],
    near: [PerGroup; 3],
    far_scale: [PerGroup; 3],
    far: [PerGroup; 3],
    /// How far each group still looks.
    pub reach: Row,
    /// Which planes they enter and leave boxes through.
    pub entry: &'static EntryPlanes,
}

impl Beams {
    /// Not aimed yet.
    pub(super) const NONE: Self = Self {
        near_scale: [PerGroup::ZERO; 3],
        near: [PerGroup::ZERO; 3],
        far_scale: [PerGroup::ZERO; 3],
        far: [PerGroup::ZERO; 3],
        reach: Row::ZERO,
        entry: &EntryPlanes { near: [Plane::LoX; 3], far: [Plane::HiX; 3] },
    };

    /// Sets one axis for all groups from the smallest and largest reciprocals of directions and apexes. Entries count
    /// from 0 on, so that the smallest slope and the apex next to the box bound them; exits, the largest slope and the
    /// other apex.
    #[inline(always)]
    pub(super) fn set<S: Simd>(
        &mut self,
        simd: S,
        axis: usize,
        scale: [S::F; 2],
        apex: [S::F; 2],
        pad: f32,
    ) {
        let pad = simd.splat(pad);
        let [slow, fast] = scale;
        let [lo, hi] = [apex[0] - pad, apex[1] + pad];
        let backward = self.entry.near[axis] as usize >= 3;
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
    pub(super) fn meet_node<S: Simd>(&self, simd: S, place: usize, node: &Node) -> (u32, S::F) {
        let reach = simd.load(&self.reach.0);
        let reach = if place == WHOLE { reach.largest() } else { self.reach.0[place % GROUPS] };
        let (mut enter, mut leave) = (simd.splat(0.0), simd.splat(reach));
        for axis in 0..3 {
            let near = simd.load(node.row(self.entry.near[axis]));
            let far = simd.load(node.row(self.entry.far[axis]));
            let near_scale = simd.splat(self.near_scale[axis].at(place));
            let far_scale = simd.splat(self.far_scale[axis].at(place));
            enter = enter.max(near.mul_add(near_scale, simd.splat(self.near[axis].at(place))));
            leave = leave.min(far.mul_add(far_scale, simd.splat(self.far[axis].at(place))));
        }
        (enter.le(leave).bits(), enter)
    }

    /// Which groups may meet one box of a node.
    #[inline(always)]
    pub(super) fn meet_box<S: Simd>(&self, simd: S, node: &Node, slot: usize) -> u32 {
        let (mut enter, mut leave) = (simd.splat(0.0), simd.load(&self.reach.0));
        for axis in 0..3 {
            let near = simd.splat(node.row(self.entry.near[axis])[slot]);
            let far = simd.splat(node.row(self.entry.far[axis])[slot]);
            let near_scale = simd.load(&self.near_scale[axis].groups.0);
            let far_scale = simd.load(&self.far_scale[axis].groups.0);
            enter = enter.max(near.mul_add(near_scale, simd.load(&self.near[axis].groups.0)));
            leave = leave.min(far.mul_add(far_scale, simd.load(&self.far[axis].groups.0)));
        }
        enter.le(leave).bits()
    }

    /// Notes how far a group still looks.
    #[inline(always)]
    pub(super) fn set_reach<S: Simd>(&mut self, simd: S, group: usize, t: f32) {
        let reach = simd.load(&self.reach.0);
        self.reach = row(simd.splat(t).select(simd.mask(1 << group), reach));
    }
}

/// The smallest and the largest number of each group, as lanes.
#[inline(always)]
pub(super) fn extremes<S: Simd>(simd: S, groups: &[<S::Rays as Vectors>::F; GROUPS]) -> [S::F; 2] {
    let (mut lo, mut hi) = (simd.splat(f32::INFINITY), simd.splat(f32::NEG_INFINITY));
    for part in 0..S::Rays::COUNT / LANES {
        let mut rows = [lo; GROUPS];
        for (row, &group) in rows.iter_mut().zip(groups) {
            *row = simd.part(group, part);
        }
        for column in simd.transpose(rows) {
            (lo, hi) = (lo.min(column), hi.max(column));
        }
    }
    [lo, hi]
}
