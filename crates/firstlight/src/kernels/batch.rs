//! Batches of rays: those that go together walk the tree together, the others take turns.

use super::alone::Walk;
use super::beams::GROUPS;
use super::layout::Tree;
use super::stream::Strays;
use super::tile::Tile;
use super::traverse::{Answer, HitFilter, Others};
use crate::geometry::Ray;
use crate::simd::{Kernel, Level, Simd, Vectors};

/// Answers each of `rays`, in the tree's space. If `known`, there are answers already that may be better.
pub(crate) fn search<A: Answer<ANY>, const ANY: bool>(
    level: Level,
    tree: &Tree,
    others: &impl Others,
    filter: &dyn HitFilter,
    (rays, answers, known): (&[Ray], &mut [A], bool),
) {
    if tree.nodes.is_empty() {
        if !known {
            forget(rays, answers);
        }
        return;
    }
    let walk = Walk { tree, others, filter, flags: filter.flags(), rays };
    let strays = level.run(Together { walk, answers: &mut *answers, known });
    if let Some(strays) = strays.filter(|strays| !strays.is_empty()) {
        level.of_eight().run(InTurns { walk, answers, strays });
    }
}

/// As many answers of no hit.
pub(crate) fn forget<A: Answer<ANY>, const ANY: bool>(rays: &[Ray], answers: &mut [A]) {
    for (ray, answer) in rays.iter().zip(answers) {
        *answer = A::none(ray.t_max);
    }
}

/// Answers rays, but for those that are returned.
struct Together<'a, O, A, const ANY: bool> {
    walk: Walk<'a, O>,
    answers: &'a mut [A],
    known: bool,
}

impl<O: Others, A: Answer<ANY>, const ANY: bool> Kernel for Together<'_, O, A, ANY> {
    type Output = Option<Strays>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Option<Strays> {
        let (size, walk) = (GROUPS * S::Rays::COUNT, self.walk);
        let (mut tile, mut strays) = (Tile::new(simd), Strays::through::<S>(walk.tree));
        let chunks = walk.rays.chunks(size).zip(self.answers.chunks_mut(size));
        for (i, (rays, answers)) in chunks.enumerate() {
            let (walk, strays) = (Walk { rays, ..walk }, (size * i, strays.as_mut()));
            tile.answer::<O, A, ANY>(walk, (answers, self.known), strays);
        }
        strays
    }
}

/// Answers those.
struct InTurns<'a, O, A, const ANY: bool> {
    walk: Walk<'a, O>,
    answers: &'a mut [A],
    strays: Strays,
}

impl<O: Others, A: Answer<ANY>, const ANY: bool> Kernel for InTurns<'_, O, A, ANY> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        self.strays.answer::<S, O, A, ANY>(simd, self.walk, self.answers);
    }
}
