//! Batches of rays: those that go together walk the tree together, the others take turns.

use super::alone::Walk;
use super::beams::GROUPS;
use super::layout::Tree;
use super::stream::Strays;
use super::tile::Tile;
use super::traverse::{HitFilter, Others};
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
        let flags = filter.flags();
        let (mut tile, mut strays) = (Tile::new(simd), Strays::through::<S>(tree));
        for (i, (rays, hits)) in rays.chunks(RAYS).zip(hits.chunks_mut(RAYS)).enumerate() {
            let walk = Walk { tree, others, filter, flags, rays, hits };
            tile.answer::<O, ANY>(walk, known, (RAYS * i, strays.as_mut()));
        }
        if let Some(strays) = strays {
            let walk = Walk { tree, others, filter, flags, rays, hits };
            strays.answer::<S, O, ANY>(simd, walk);
        }
    }
}
