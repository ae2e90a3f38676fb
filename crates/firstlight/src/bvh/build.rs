//! The binary tree: top down, by the surface area heuristic over bins of centroids.
//!
//! Wald, *On fast Construction of SAH-based Bounding Volume Hierarchies*, 2007. Both halves of a large node are
//! built in parallel; where they are cut does not depend on the number of threads.

use crate::geometry::Bounds;
use crate::simd::LANES;
use glam::Vec3;

/// One thing to be put into a tree.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reference {
    pub bounds: Bounds,
    pub item: Item,
}

/// What a [`Reference`] refers to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Item {
    /// A triangle by its number.
    Triangle(u32),
    /// Something else by its surface.
    Other(u32),
}

/// A binary tree.
pub(super) struct Branch {
    pub bounds: Bounds,
    pub content: Content,
}

/// What is in a [`Branch`].
pub(super) enum Content {
    /// Up to eight triangles, or one other thing.
    Leaf(Vec<Item>),
    /// Two halves.
    Split(Box<[Branch; 2]>),
}

const BINS: usize = 16;
/// Cost of a step down the tree, in tests of a block of triangles.
const STEP: f32 = 0.5;
/// From this depth on halves are equal in number, which bounds the depth of the whole.
const DEEP: usize = 32;
/// Nodes with fewer references are built by one thread.
const PARALLEL: usize = 4096;

/// Gives the corners and flags of a triangle by its number.
pub(super) type Triangles<'a> = &'a (dyn Fn(u32) -> ([Vec3; 3], u32) + Sync);

/// Builds a tree over `references`, which must not be empty.
pub(super) fn build(references: &mut [Reference], triangles: Triangles) -> Branch {
    branch(references, triangles, 0)
}

fn branch(references: &mut [Reference], triangles: Triangles, depth: usize) -> Branch {
    let kept = if coincide(references) {
        first_of_equals(references, triangles)
    } else {
        references.len()
    };
    let references = &mut references[..kept];
    let bounds = references.iter().fold(Bounds::EMPTY, |b, r| b.union(r.bounds));
    let content = match choose_cut(references, bounds, depth) {
        None => Content::Leaf(references.iter().map(|r| r.item).collect()),
        Some(cut) => {
            let middle = cut.partition(references);
            let (left, right) = references.split_at_mut(middle);
            Content::Split(Box::new(halves([left, right], triangles, depth + 1)))
        }
    };
    Branch { bounds, content }
}

fn halves(halves: [&mut [Reference]; 2], triangles: Triangles, depth: usize) -> [Branch; 2] {
    let [left, right] = halves;
    if left.len() + right.len() < PARALLEL {
        return [branch(left, triangles, depth), branch(right, triangles, depth)];
    }
    rayon::join(|| branch(left, triangles, depth), || branch(right, triangles, depth)).into()
}

/// Whether there are too many for a leaf and no cut can part them.
fn coincide(references: &[Reference]) -> bool {
    references.len() > LANES && references.iter().all(|r| r.bounds == references[0].bounds)
}

/// Moves the first of each set of equal triangles to the front and returns their number: of equal triangles a ray
/// hits the first. Others stay, as do triangles with flags, which may differ in what they show.
fn first_of_equals(references: &mut [Reference], triangles: Triangles) -> usize {
    let key = |reference: &Reference| match reference.item {
        Item::Triangle(number) => match triangles(number) {
            (corners, 0) => (corners.map(|p| p.to_array().map(f32::to_bits)), 0, number),
            (_, _) => (Default::default(), 1, number),
        },
        Item::Other(surface) => (Default::default(), 2, surface),
    };
    let mut keyed: Vec<_> = references.iter().map(|r| (key(r), *r)).collect();
    keyed.sort_unstable_by_key(|(key, _)| *key);
    keyed.dedup_by(|(a, _), (b, _)| a.1 == 0 && b.1 == 0 && a.0 == b.0);
    for (slot, (_, reference)) in references.iter_mut().zip(&keyed) {
        *slot = *reference;
    }
    keyed.len()
}

/// Where a node is cut.
#[derive(Clone, Copy)]
enum Cut {
    /// By the bin of the centroid along an axis.
    Bin(Bins, usize, usize),
    /// In the middle of the list.
    Middle,
}

/// The best cut, or `None` for a leaf.
fn choose_cut(references: &[Reference], bounds: Bounds, depth: usize) -> Option<Cut> {
    let may_be_leaf = is_leaf(references);
    if references.len() == 1 {
        return None;
    }
    let best = if depth < DEEP { best_bin(references) } else { None };
    match best {
        Some((cost, _))
            if may_be_leaf && cost + STEP * bounds.half_area() >= bounds.half_area() =>
        {
            None
        }
        Some((_, cut)) => Some(cut),
        None if may_be_leaf => None,
        None => Some(Cut::Middle),
    }
}

fn is_leaf(references: &[Reference]) -> bool {
    let triangle = |r: &Reference| matches!(r.item, Item::Triangle(_));
    references.len() == 1 || references.len() <= LANES && references.iter().all(triangle)
}

impl Cut {
    /// Reorders `references`; returns how many are in the first half, at least one and not all.
    fn partition(self, references: &mut [Reference]) -> usize {
        let Self::Bin(bins, axis, cut) = self else { return references.len() / 2 };
        let (mut first, mut end) = (0, references.len());
        while first < end {
            if bins.of(references[first].bounds, axis) < cut {
                first += 1;
            } else {
                end -= 1;
                references.swap(first, end);
            }
        }
        first
    }
}

/// Maps centroids to bins.
#[derive(Clone, Copy)]
struct Bins {
    lo: Vec3,
    scale: Vec3,
}

impl Bins {
    /// Bins over the box of all centroids (times two); `None` if they coincide.
    fn over(references: &[Reference]) -> Option<Self> {
        let centroids = Bounds::around(references.iter().map(|r| r.bounds.lo + r.bounds.hi));
        let extent = centroids.hi - centroids.lo;
        let scale = extent.map(|e| if e > 0.0 { BINS as f32 * (1.0 - 1e-6) / e } else { 0.0 });
        (extent.max_element() > 0.0 && scale.is_finite())
            .then_some(Self { lo: centroids.lo, scale })
    }

    #[inline]
    fn of(&self, bounds: Bounds, axis: usize) -> usize {
        let place = (bounds.lo[axis] + bounds.hi[axis] - self.lo[axis]) * self.scale[axis];
        (place as usize).min(BINS - 1)
    }
}

#[derive(Clone, Copy)]
struct Bin {
    bounds: Bounds,
    count: usize,
}

impl Bin {
    const EMPTY: Self = Self { bounds: Bounds::EMPTY, count: 0 };

    fn join(self, other: Self) -> Self {
        Self { bounds: self.bounds.union(other.bounds), count: self.count + other.count }
    }

    /// Area times the number of blocks its triangles will fill.
    fn cost(self) -> f32 {
        self.bounds.half_area() * (self.count as f32 / LANES as f32).max(1.0)
    }
}

/// The cheapest cut between bins, with its cost in block tests times area.
fn best_bin(references: &[Reference]) -> Option<(f32, Cut)> {
    let bins = Bins::over(references)?;
    let mut table = [[Bin::EMPTY; BINS]; 3];
    for reference in references {
        for (axis, row) in table.iter_mut().enumerate() {
            let bin = &mut row[bins.of(reference.bounds, axis)];
            *bin = bin.join(Bin { bounds: reference.bounds, count: 1 });
        }
    }
    let cuts = table.iter().enumerate().filter_map(|(axis, row)| cheapest(row).map(|c| (axis, c)));
    let (axis, (cost, cut)) = cuts.min_by(|a, b| a.1.0.total_cmp(&b.1.0))?;
    Some((cost, Cut::Bin(bins, axis, cut)))
}

/// The cheapest place to cut a row of bins: its cost and the first bin of the second half.
fn cheapest(row: &[Bin; BINS]) -> Option<(f32, usize)> {
    let mut after = [Bin::EMPTY; BINS + 1];
    for i in (0..BINS).rev() {
        after[i] = after[i + 1].join(row[i]);
    }
    let mut before = Bin::EMPTY;
    let cuts = (1..BINS).filter_map(|cut| {
        before = before.join(row[cut - 1]);
        let both = before.count > 0 && after[cut].count > 0;
        both.then(|| (before.cost() + after[cut].cost(), cut))
    });
    cuts.min_by(|a, b| a.0.total_cmp(&b.0))
}
