//! Batches of rays: those that go together walk the tree together, the others alone.

use super::layout::Tree;
use super::tile::{GROUPS, Tile, Walk};
use super::traverse::{FLATTENED, HitFilter, Others, Search, Stack};
use crate::geometry::{Hit, Ray};
use crate::simd::{Kernel, LANES, Level, Simd};

/// Answers each of `rays`: the closest hit, or (`ANY`) whether there is any, in which case only
/// [`Hit::surface`] has a meaning. `hits` holds the ends of the rays' ranges, or, if `known`, hits that there are
/// already.
pub(crate) fn search<const ANY: bool>(
    level: Level,
    tree: &Tree,
    others: &impl Others,
    filter: &dyn HitFilter,
    (rays, hits, known): (&[Ray], &mut [Hit], bool),
) {
    if !tree.nodes.is_empty() {
        level.run(Batch::<_, ANY> { tree, others, filter, rays, hits, known });
    }
}

struct Batch<'a, O, const ANY: bool> {
    tree: &'a Tree,
    others: &'a O,
    filter: &'a dyn HitFilter,
    rays: &'a [Ray],
    hits: &'a mut [Hit],
    known: bool,
}

impl<O: Others, const ANY: bool> Kernel for Batch<'_, O, ANY> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        const RAYS: usize = GROUPS * LANES;
        let Self { tree, others, filter, rays, hits, known } = self;
        let alone = Alone { simd, tree, others, filter, flags: filter.flags() };
        let mut stack = Stack::new();
        let mut tile = Tile::new(simd, filter, alone.flags);
        for (rays, hits) in rays.chunks(RAYS).zip(hits.chunks_mut(RAYS)) {
            let groups = tile.load(tree, rays);
            if known {
                tile.know::<ANY>(hits);
            }
            let mut first = 0;
            while first < groups {
                let together = tile.together_from(first);
                let range = first..first + together.max(1);
                first = range.end;
                if together > 0 {
                    tile.walk::<O, ANY>(range, Walk { tree, others, rays, hits });
                } else {
                    let range = LANES * range.start..LANES * range.end;
                    alone.walk::<ANY>(&rays[range.clone()], &mut hits[range], &mut stack);
                }
            }
            let rest = LANES * groups;
            alone.walk::<ANY>(&rays[rest..], &mut hits[rest..], &mut stack);
        }
    }
}

/// Rays that have nothing in common.
struct Alone<'a, S, O> {
    simd: S,
    tree: &'a Tree,
    others: &'a O,
    filter: &'a dyn HitFilter,
    flags: u32,
}

impl<S: Simd, O: Others> Alone<'_, S, O> {
    #[inline(always)]
    fn walk<const ANY: bool>(&self, rays: &[Ray], hits: &mut [Hit], stack: &mut Stack) {
        let Self { simd, tree, filter, flags, .. } = *self;
        for (ray, hit) in rays.iter().zip(hits) {
            if !(ANY && hit.is_some()) {
                let search = Search { simd, ray, filter, flags };
                search.walk::<O, ANY>(tree, ray, FLATTENED, self.others, hit, stack);
            }
        }
    }
}
