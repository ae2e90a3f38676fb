//! Which surface a triangle of the world's own tree belongs to.

use crate::geometry::Hit;
use crate::kernels::FLATTENED;

/// Triangles of one surface: from number `first` up to the first of the next run.
#[derive(Debug, Clone, Copy)]
pub(super) struct Run {
    /// The number of its first triangle.
    pub first: u32,
    /// Whose they are.
    pub surface: u32,
    /// Whether every two of them are one part of an analytic surface.
    pub in_pairs: bool,
}

/// All triangles of the world's own tree.
#[derive(Debug)]
pub(super) struct Runs {
    /// In order.
    runs: Vec<Run>,
    /// The run of every 2^`shift`-th triangle, so that the others' are near.
    guide: Vec<u32>,
    shift: u32,
}

/// Length of the guide, at most: what stays in the nearest cache.
const GUIDE: u32 = 1024;

impl Runs {
    /// Of so many `triangles` in all; `runs` are in order.
    pub(super) fn new(runs: Vec<Run>, triangles: u32) -> Self {
        let shift = triangles.div_ceil(GUIDE).next_power_of_two().ilog2();
        let numbers = (0..triangles).step_by(1 << shift);
        let run_of = |number| runs.partition_point(|run| run.first <= number) as u32 - 1;
        let guide = numbers.map(run_of).collect();
        Self { runs, guide, shift }
    }

    /// The run of a triangle.
    #[inline(always)]
    pub(super) fn of(&self, number: u32) -> Run {
        self.runs[self.index(number)]
    }

    #[inline(always)]
    fn index(&self, number: u32) -> usize {
        let mut i = self.guide[(number >> self.shift) as usize] as usize;
        while self.runs.get(i + 1).is_some_and(|next| next.first <= number) {
            i += 1;
        }
        i
    }

    /// Names the surfaces of hits that only name triangles. Those that follow one another are mostly of the same.
    #[inline(always)]
    pub(super) fn name(&self, hits: &mut [Hit]) {
        let (mut numbers, mut run) = (0..0, Run { first: 0, surface: 0, in_pairs: false });
        for hit in hits.iter_mut().filter(|hit| hit.surface == FLATTENED) {
            if !numbers.contains(&hit.primitive) {
                let i = self.index(hit.primitive);
                run = self.runs[i];
                numbers = run.first..self.runs.get(i + 1).map_or(u32::MAX, |next| next.first);
            }
            run.name(hit);
        }
    }
}

impl Run {
    /// Names the surface and its part that a hit of one of its triangles is on.
    #[inline(always)]
    fn name(&self, hit: &mut Hit) {
        hit.surface = self.surface;
        hit.primitive -= self.first;
        if self.in_pairs {
            hit.primitive >>= 1;
            (hit.u, hit.v) = (0.0, 0.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Short and long runs, and some of no triangles, among more triangles than the guide has entries.
    #[test]
    fn every_triangle_finds_its_run() {
        let lengths = [1, 0, 2, 12, 0, 0, 5000, 1, 1, 700, 0, 9];
        let mut first = 0;
        let mut expected = Vec::new();
        let run = |(surface, length)| {
            let run = Run { first, surface: surface as u32, in_pairs: surface % 2 == 1 };
            expected.extend((0..length).map(|triangle| (run.surface, triangle)));
            first += length;
            run
        };
        let runs: Vec<_> = lengths.into_iter().enumerate().map(run).collect();
        let runs = Runs::new(runs, first);
        let at = |primitive| Hit { t: 1.0, u: 0.25, v: 0.5, surface: FLATTENED, primitive };
        let mut hits: Vec<_> = (0..first).map(at).collect();
        hits.push(Hit::none(3.0));
        hits.push(Hit { surface: 4, ..at(7) });
        let others = hits[hits.len() - 2..].to_vec();
        let mut backward: Vec<_> = hits.iter().rev().copied().collect();
        runs.name(&mut backward);
        runs.name(&mut hits);
        assert!(hits.iter().eq(backward.iter().rev()));
        for (hit, (surface, triangle)) in hits.iter().zip(&expected) {
            let in_pairs = surface % 2 == 1;
            let (part, u, v) =
                if in_pairs { (triangle / 2, 0.0, 0.0) } else { (*triangle, 0.25, 0.5) };
            assert_eq!(*hit, Hit { t: 1.0, u, v, surface: *surface, primitive: part });
        }
        assert_eq!(hits[hits.len() - 2..], others);
    }

    #[test]
    fn without_triangles_there_is_nothing_to_name() {
        let others = [Hit::none(1.0), Hit { surface: 2, primitive: 3, ..Hit::none(1.0) }];
        let without_any = Run { first: 0, surface: 5, in_pairs: true };
        for runs in [Vec::new(), vec![without_any]] {
            let mut hits = others;
            Runs::new(runs, 0).name(&mut hits);
            assert_eq!(hits, others);
        }
    }
}
