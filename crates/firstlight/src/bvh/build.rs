//! The binary tree: top down, by the surface area heuristic over bins of centroids.
//!
//! Wald, *On fast Construction of SAH-based Bounding Volume Hierarchies*, 2007. Both halves of a large node are
//! built in parallel; where they are cut does not depend on the number of threads.

use super::reference::{Extent, Item, Reference, Triangles};
use crate::geometry::Bounds;
use crate::simd::LANES;
use glam::Vec4;
use rayon::prelude::*;

/// A node of the binary tree, 32 bytes. A tree is a slice of nodes: the root, all of the left half, all of the right.
#[derive(Debug, Clone, Copy)]
pub(super) struct BinaryNode {
    /// The box around everything below.
    pub bounds: Bounds,
    /// How many nodes further on the right half begins; 0: there are no halves.
    pub right: u32,
    /// Without halves, the bits of the [`Item`]; else first the height, then the plan for collapsing.
    pub word: u32,
}

impl BinaryNode {
    const UNUSED: Self = Self { bounds: Bounds::EMPTY, right: 0, word: 0 };

    fn leaf(reference: &Reference) -> Self {
        Self { bounds: reference.bounds(), right: 0, word: reference.item().to_bits() }
    }

    /// Whether it is one item.
    #[inline(always)]
    pub(super) fn is_leaf(&self) -> bool {
        self.right == 0
    }

    /// How many levels it has, as long as the tree is not planned.
    pub(super) fn height(&self) -> usize {
        if self.is_leaf() { 1 } else { self.word as usize }
    }

    /// The branch over two halves, the second `offset` nodes further on.
    fn branch(left: &Self, right: &Self, offset: usize) -> Self {
        let height = 1 + left.height().max(right.height());
        let bounds = left.bounds.union(right.bounds);
        Self { bounds, right: offset as u32, word: height as u32 }
    }

    /// What it is, if a leaf.
    pub(super) fn item(&self) -> Item {
        Item::from_bits(self.word)
    }
}

/// Bins per axis, at most.
const BINS: usize = 16;
/// Nodes with at most so many references are cut at the best of all places.
const FEW: usize = 8;
/// From this depth on halves are equal in number, which bounds the depth of the whole.
const DEEP: usize = 32;
/// Halves of nodes with at least so many references are built in parallel.
const PARALLEL: usize = 4096;
/// Nodes with more references are binned and cut in parallel.
const LARGE: usize = 1 << 15;

/// Builds a tree over `references`, which must not be empty.
pub(super) fn build(references: &mut [Reference], triangles: &impl Triangles) -> Vec<BinaryNode> {
    let nodes = (0..2 * references.len() - 1).into_par_iter();
    let mut nodes: Vec<_> = nodes.map(|_| BinaryNode::UNUSED).collect();
    branch(references, &mut nodes, triangles, 0);
    nodes
}

/// Builds the tree over `references` at the front of `nodes`.
fn branch(
    references: &mut [Reference],
    nodes: &mut [BinaryNode],
    triangles: &impl Triangles,
    depth: usize,
) {
    let kept = if coincide(references) {
        first_of_equals(references, triangles)
    } else {
        references.len()
    };
    if let [reference] = references[..kept] {
        nodes[0] = BinaryNode::leaf(&reference);
        return;
    }
    let middle = cut(&mut references[..kept], depth);
    let (first, second) = references[..kept].split_at_mut(middle);
    let (left, right) = nodes[1..].split_at_mut(2 * middle - 1);
    join(
        kept >= PARALLEL,
        || branch(first, left, triangles, depth + 1),
        || branch(second, right, triangles, depth + 1),
    );
    nodes[0] = BinaryNode::branch(&left[0], &right[0], 2 * middle);
}

/// Does both, at the same time if asked to.
pub(super) fn join<A: Send, B: Send>(
    parallel: bool,
    a: impl FnOnce() -> A + Send,
    b: impl FnOnce() -> B + Send,
) -> (A, B) {
    if parallel { rayon::join(a, b) } else { (a(), b()) }
}

/// Whether there are too many for a leaf and no cut can part them.
fn coincide(references: &[Reference]) -> bool {
    references.len() > LANES && references.iter().all(|r| r.bounds() == references[0].bounds())
}

/// Moves the first of each set of equal triangles to the front and returns their number: of equal triangles a ray
/// hits the first. Others stay, as do triangles with flags, which may differ in what they show.
fn first_of_equals(references: &mut [Reference], triangles: &impl Triangles) -> usize {
    let key = |reference: &Reference| match reference.item() {
        Item::Triangle(number) => match triangles.triangle(number) {
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

/// Reorders two or more references into halves; returns how many are in the first, at least one and not all.
fn cut(references: &mut [Reference], depth: usize) -> usize {
    let middle = references.len() / 2;
    if references.len() == 2 || depth >= DEEP {
        return middle;
    }
    if references.len() <= FEW {
        return cut_few(references);
    }
    let Some(bins) = Bins::over(references) else { return middle };
    match Table::of(&bins, references).cheapest(bins.count) {
        Some((axis, cut)) => partition(references, &|r| Bins::bin(bins.place(r)[axis]) < cut),
        None => middle,
    }
}

/// The best of all cuts of a few references in the order of their centres along each axis.
fn cut_few(references: &mut [Reference]) -> usize {
    let count = references.len();
    let mut best = (f32::INFINITY, 0, count / 2);
    for axis in 0..3 {
        sort(references, axis);
        let mut extents = [Extent::EMPTY; FEW];
        for (extent, reference) in extents.iter_mut().zip(&*references) {
            *extent = reference.extent();
        }
        let (cost, cut) = cheapest(&extents[..count], &[1; FEW][..count]);
        if cost < best.0 {
            best = (cost, axis, cut);
        }
    }
    if best.1 != 2 {
        sort(references, best.1);
    }
    best.2
}

/// Sorts a few references by their centres along an axis.
fn sort(references: &mut [Reference], axis: usize) {
    for end in 1..references.len() {
        let reference = references[end];
        let place = reference.center()[axis];
        let mut i = end;
        while i > 0 && references[i - 1].center()[axis] > place {
            references[i] = references[i - 1];
            i -= 1;
        }
        references[i] = reference;
    }
}

/// The cheapest place to cut a row of boxes with so many references in each: its cost, area times number summed over
/// both sides, and the first box of the second side. The cost is infinite if no cut parts them.
fn cheapest(extents: &[Extent], counts: &[u32]) -> (f32, usize) {
    let mut costs_after = [f32::INFINITY; BINS];
    let (mut extent, mut count) = (Extent::EMPTY, 0);
    for i in (1..extents.len()).rev() {
        extent = extent.union(extents[i]);
        count += counts[i];
        costs_after[i] = cost(extent, count);
    }
    let mut best = (f32::INFINITY, extents.len() / 2);
    (extent, count) = (Extent::EMPTY, 0);
    for i in 1..extents.len() {
        extent = extent.union(extents[i - 1]);
        count += counts[i - 1];
        let cost = cost(extent, count) + costs_after[i];
        if cost < best.0 {
            best = (cost, i);
        }
    }
    best
}

/// Area times number; infinite for nothing, which is no side of a cut.
#[inline(always)]
fn cost(extent: Extent, count: u32) -> f32 {
    if count == 0 { f32::INFINITY } else { extent.half_area() * count as f32 }
}

/// Moves references that are in the first half to the front; returns how many. Without branches on the order, which
/// a processor cannot foresee.
fn partition(
    references: &mut [Reference],
    is_first: &(impl Fn(&Reference) -> bool + Sync),
) -> usize {
    if references.len() > LARGE {
        return partition_in_parallel(references, is_first);
    }
    let mut first = 0;
    for i in 0..references.len() {
        let reference = references[i];
        references.swap(i, first);
        first += usize::from(is_first(&reference));
    }
    first
}

/// Cuts both halves of the list, then swaps the end of the one with the beginning of the other.
fn partition_in_parallel(
    references: &mut [Reference],
    is_first: &(impl Fn(&Reference) -> bool + Sync),
) -> usize {
    let middle = references.len() / 2;
    let (a, b) = references.split_at_mut(middle);
    let (i, j) = rayon::join(|| partition(a, is_first), || partition(b, is_first));
    let moved = j.min(middle - i);
    let (from, to) = (&mut a[i..i + moved], &mut b[j - moved..j]);
    from.par_iter_mut().zip(to).for_each(|(x, y)| std::mem::swap(x, y));
    i + j
}

/// Maps centroids to bins.
struct Bins {
    lo: Vec4,
    scale: Vec4,
    count: usize,
}

impl Bins {
    /// Added to a number from 0 to 31 it leaves its integer part in the bits from [`Bins::SHIFT`].
    const INTEGERS: f32 = 32768.0;
    const SHIFT: u32 = 8;

    /// Bins over the box of all centroids; `None` if they coincide.
    fn over(references: &[Reference]) -> Option<Self> {
        let centers = centers(references);
        let extent = centers.hi - centers.lo;
        let count = (4 + references.len() / 8).min(BINS);
        let scale = (count as f32 - 0.01) / extent;
        let usable = extent.cmpgt(Vec4::ZERO) & scale.abs().cmplt(Vec4::INFINITY);
        let scale = Vec4::select(usable, scale, Vec4::ZERO);
        let some = scale.truncate().max_element() > 0.0;
        some.then_some(Self { lo: centers.lo, scale, count })
    }

    /// Where a reference is, in bins.
    #[inline(always)]
    fn place(&self, reference: &Reference) -> Vec4 {
        (reference.center() - self.lo) * self.scale + Self::INTEGERS
    }

    /// The bin of a place.
    #[inline(always)]
    fn bin(place: f32) -> usize {
        (place.to_bits() >> Self::SHIFT) as usize % BINS
    }
}

/// The box of all centroids, times two.
fn centers(references: &[Reference]) -> Extent {
    if references.len() > LARGE {
        let (a, b) = references.split_at(references.len() / 2);
        let (a, b) = rayon::join(|| centers(a), || centers(b));
        return a.union(b);
    }
    references.iter().fold(Extent::EMPTY, |extent, r| extent.with(r.center()))
}

/// What is in each bin, by axis.
struct Table {
    extents: [[Extent; BINS]; 3],
    counts: [[u32; BINS]; 3],
}

impl Table {
    const EMPTY: Self = Self { extents: [[Extent::EMPTY; BINS]; 3], counts: [[0; BINS]; 3] };

    /// Puts references into bins.
    fn of(bins: &Bins, references: &[Reference]) -> Self {
        if references.len() > LARGE {
            let (a, b) = references.split_at(references.len() / 2);
            let (a, b) = rayon::join(|| Self::of(bins, a), || Self::of(bins, b));
            return a.with(&b);
        }
        let mut table = Self::EMPTY;
        for reference in references {
            let place = bins.place(reference);
            for axis in 0..3 {
                let bin = Bins::bin(place[axis]);
                let extent = &mut table.extents[axis][bin];
                *extent = extent.union(reference.extent());
                table.counts[axis][bin] += 1;
            }
        }
        table
    }

    /// What is in either.
    fn with(mut self, other: &Self) -> Self {
        for axis in 0..3 {
            for bin in 0..BINS {
                let extent = &mut self.extents[axis][bin];
                *extent = extent.union(other.extents[axis][bin]);
                self.counts[axis][bin] += other.counts[axis][bin];
            }
        }
        self
    }

    /// The axis and the place of the cheapest cut between the first `count` bins, if any parts them.
    fn cheapest(&self, count: usize) -> Option<(usize, usize)> {
        let mut best = (f32::INFINITY, None);
        for axis in 0..3 {
            let (cost, cut) = cheapest(&self.extents[axis][..count], &self.counts[axis][..count]);
            if cost < best.0 {
                best = (cost, Some((axis, cut)));
            }
        }
        best.1
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::kernels::Stack;
    use crate::math::hash;
    use glam::Vec3;

    impl Triangles for Vec<[Vec3; 3]> {
        fn triangle(&self, number: u32) -> ([Vec3; 3], u32) {
            (self[number as usize], 0)
        }
    }

    /// A triangle by its number.
    type Shape<'a> = &'a dyn Fn(u32) -> [Vec3; 3];

    /// Checks the boxes of a tree and returns its depth; adds the triangles that are in it.
    pub(in crate::bvh) fn check(
        nodes: &[BinaryNode],
        shape: &Vec<[Vec3; 3]>,
        found: &mut Vec<u32>,
    ) -> usize {
        let node = &nodes[0];
        if node.is_leaf() {
            let Item::Triangle(number) = node.item() else { unreachable!("only triangles") };
            assert_eq!(node.bounds, Bounds::around(shape[number as usize]));
            found.push(number);
            return 1;
        }
        let (left, right) = (&nodes[1..], &nodes[node.right as usize..]);
        assert_eq!(node.bounds, left[0].bounds.union(right[0].bounds));
        1 + check(left, shape, found).max(check(right, shape, found))
    }

    pub(in crate::bvh) fn references(count: u32, shape: Shape) -> Vec<Reference> {
        let bounds = |i| Bounds::around(shape(i));
        (0..count).map(|i| Reference::new(bounds(i), Item::Triangle(i))).collect()
    }

    #[test]
    fn every_triangle_is_in_its_boxes_and_no_tree_too_deep() {
        let triangle = [Vec3::X, Vec3::Y, Vec3::ONE];
        let point = |_| [Vec3::ONE; 3];
        let almost_a_point = |i: u32| [Vec3::ONE, Vec3::ONE, Vec3::ONE + 1e-7 * (i % 7) as f32];
        let shrinking = |i: u32| {
            let x = 0.25_f32.powi(i as i32 - 60) * Vec3::X;
            [x, 0.5 * x, x + Vec3::Y]
        };
        let rim = |i: u32| Vec3::new((i as f32 * 0.01).cos(), (i as f32 * 0.01).sin(), 0.0);
        let fan = |i: u32| [Vec3::ZERO, rim(i), rim(i + 1)];
        let huge = |i: u32| triangle.map(|p| (i as f32 - 50.0) * 6e36 * p);
        let shapes: [(usize, Shape); 5] =
            [(1, &point), (7, &almost_a_point), (100, &shrinking), (100, &fan), (100, &huge)];
        for (distinct, shape) in shapes {
            let triangles: Vec<_> = (0..120).map(shape).collect();
            let nodes = build(&mut references(120, shape), &triangles);
            let mut found = Vec::new();
            let depth = check(&nodes, &triangles, &mut found);
            found.sort_unstable();
            found.dedup();
            assert!(found.len() >= distinct, "{} of {distinct}", found.len());
            // 2^7 triangles: seven levels of equal halves below those that are cut by cost, and the leaves.
            assert!(depth <= 32 + 7 + 1 && 32 + 30 < Stack::DEPTH, "{depth} deep");
        }
    }

    #[test]
    fn parallel_cuts_put_each_reference_on_its_side() {
        let count = 3 * LARGE as u32;
        for share in [0, 1, 30, 50, 70, 99, 100] {
            let mut list = references(count, &|i| [Vec3::splat(i as f32); 3]);
            let number = |r: &Reference| r.extent().hi.x as u64;
            let is_first = |r: &Reference| hash(number(r)) % 100 < share;
            let first = partition(&mut list, &is_first);
            assert!(list[..first].iter().all(is_first) && !list[first..].iter().any(is_first));
            list.sort_by_key(number);
            assert!(list.iter().enumerate().all(|(i, r)| number(r) == i as u64));
        }
    }
}
