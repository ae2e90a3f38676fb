//! Closest hit and any hit of rays that have nothing in common but the tree, one after the other: the few of a group
//! that have come far, and all where turns do not pay.

use super::group::Group;
use super::layout::{Child, Tree};
use super::traverse::{FLATTENED, HitFilter, Others, Search, Stack};
use crate::geometry::Ray;
use crate::simd::{Simd, Vectors};

/// What is walked through, and what for.
pub(super) struct Walk<'a, O> {
    pub tree: &'a Tree,
    pub others: &'a O,
    pub filter: &'a dyn HitFilter,
    /// The flags that the filter wants to be asked about.
    pub flags: u32,
    pub rays: &'a [Ray],
}

impl<O> Clone for Walk<'_, O> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<O> Copy for Walk<'_, O> {}

impl<O: Others> Walk<'_, O> {
    /// Brings rays of group `g` to what is below `start`. Returns whether a hit was replaced.
    #[inline(always)]
    pub(super) fn alone<S: Simd, const ANY: bool>(
        &self,
        simd: S,
        (g, group): (usize, &mut Group<S::Rays>),
        mut lanes: u32,
        start: Child,
        stack: &mut Stack,
    ) -> bool {
        let mut changed = false;
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize % S::Rays::COUNT;
            lanes &= lanes - 1;
            let (ray, mut hit) = (&self.rays[S::Rays::COUNT * g + lane], group.hit(lane));
            let search = Search { simd, ray, filter: self.filter, flags: self.flags };
            let prepared = (group.slabs_of(simd, lane), group.shear_of(simd, lane));
            let start = (self.tree, start);
            let (others, hit) = (self.others, &mut hit);
            if search.walk_from::<O, ANY>(start, ray, prepared, FLATTENED, others, hit, stack) {
                group.found::<ANY>(lane, hit);
                changed = true;
            }
        }
        changed
    }

    /// Brings rays of group `g` to a surface that is not triangles. Returns whether a hit was replaced.
    #[inline(always)]
    pub(super) fn visit<S: Simd, const ANY: bool>(
        &self,
        (g, group): (usize, &mut Group<S::Rays>),
        mut lanes: u32,
        surface: u32,
        stack: &mut Stack,
    ) -> bool {
        let mut changed = false;
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize % S::Rays::COUNT;
            lanes &= lanes - 1;
            let (ray, mut hit) = (&self.rays[S::Rays::COUNT * g + lane], group.hit(lane));
            let search = Search { simd: (), ray, filter: self.filter, flags: self.flags };
            if self.others.visit::<ANY>(&search, surface, &mut hit, stack) {
                group.found::<ANY>(lane, &hit);
                changed = true;
            }
        }
        changed
    }
}
