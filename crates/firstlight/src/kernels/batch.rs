//! Batches of rays: those that go together walk the tree together, the others take turns.

use super::alone::Walk;
use super::beams::GROUPS;
use super::layout::Tree;
use super::stream::Strays;
use super::tile::Tile;
use super::traverse::{HitFilter, Others};
use crate::geometry::{Hit, Ray};
use crate::simd::{Kernel, Level, Simd, Vectors};

/// Answers each of `rays`: the closest hit, or (`ANY`) whether there is any, in which case only
/// [`Hit::surface`] has a meaning. If `known`, `hits` holds hits that there are already.
pub(crate) fn search<const ANY: bool>(
    level: Level,
    tree: &Tree,
    others: &impl Others,
    filter: &dyn HitFilter,
    (rays, hits, known): (&[Ray], &mut [Hit], bool),
) {
    if tree.nodes.is_empty() {
        if !known {
            forget(rays, hits);
        }
        return;
    }
    let flags = filter.flags();
    let walk = Walk { tree, others, filter, flags, rays, hits: &mut *hits };
    let strays = level.run(Together::<_, ANY> { walk, known });
    if let Some(strays) = strays.filter(|strays| !strays.is_empty()) {
        let walk = Walk { tree, others, filter, flags, rays, hits };
        level.of_eight().run(InTurns::<_, ANY> { walk, strays });
    }
}

/// As many hits of nothing.
#[inline(always)]
pub(crate) fn forget(rays: &[Ray], hits: &mut [Hit]) {
    for (ray, hit) in rays.iter().zip(hits) {
        *hit = Hit::none(ray.t_max);
    }
}

/// Answers rays, but for those that are returned.
struct Together<'a, O, const ANY: bool> {
    walk: Walk<'a, O>,
    known: bool,
}

impl<O: Others, const ANY: bool> Kernel for Together<'_, O, ANY> {
    type Output = Option<Strays>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Option<Strays> {
        let size = GROUPS * S::Rays::COUNT;
        let Walk { tree, others, filter, flags, rays, hits } = self.walk;
        let (mut tile, mut strays) = (Tile::new(simd), Strays::through::<S>(tree));
        for (i, (rays, hits)) in rays.chunks(size).zip(hits.chunks_mut(size)).enumerate() {
            let walk = Walk { tree, others, filter, flags, rays, hits };
            tile.answer::<O, ANY>(walk, self.known, (size * i, strays.as_mut()));
        }
        strays
    }
}

/// Answers those.
struct InTurns<'a, O, const ANY: bool> {
    walk: Walk<'a, O>,
    strays: Strays,
}

impl<O: Others, const ANY: bool> Kernel for InTurns<'_, O, ANY> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        self.strays.answer::<S, O, ANY>(simd, self.walk);
    }
}
