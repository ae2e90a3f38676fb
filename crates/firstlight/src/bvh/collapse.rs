//! Which nodes of the binary tree become nodes and leaves of the eight-wide one, at the least expected cost.
//!
//! Dynamic programming over (node, number of children to spend on it), after Ylitie, Karras, Laine, *Efficient
//! Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs*, HPG 2017, section 3.1. A cost is the area of a box,
//! to which the chance of a ray to come by is proportional, times what the ray does there; and a price for the memory
//! of each node and leaf, so that where few rays come by leaves are full.

use super::build::{BinaryNode, join};
use super::reference::{Item, Triangles};
use crate::kernels::Vertices;
use crate::simd::LANES;

/// What a ray does at a node.
const NODE: f32 = 1.0;
/// What it does at a leaf, besides each of its triangles.
const LEAF: f32 = 1.0;
/// What it does at each triangle of a leaf.
const TRIANGLE: f32 = 0.02;
/// Price of a node's or a leaf's memory, in units of the whole box's area by the number of items.
const MEMORY: f32 = 1.0;
/// Trees with more binary nodes are planned in parallel.
const PARALLEL: usize = 8192;

/// The plan of one branch, in its `word`: whether it becomes a leaf; and for 2 to 8 children in its place how many of
/// them its left half gets, in three bits each. 0: no more than with one child less.
#[derive(Debug, Clone, Copy)]
struct Plan(u32);

impl Plan {
    const LEAF: u32 = 1 << 31;

    fn is_leaf(self) -> bool {
        self.0 & Self::LEAF != 0
    }

    fn left(self, children: usize) -> usize {
        (self.0 >> (3 * (children - 2)) & 7) as usize
    }

    fn set_left(&mut self, children: usize, left: usize) {
        self.0 |= (left as u32) << (3 * (children - 2));
    }
}

/// What is known of a subtree.
#[derive(Clone, Copy)]
struct Costs {
    /// The least cost for 1 to 7 children in its place.
    by_children: [f32; LANES - 1],
    /// How many triangles it has; more than fit into a leaf if there is anything else.
    triangles: usize,
    /// Their vertices; `None` if they do not fit into a leaf.
    vertices: Option<Vertices>,
}

/// Plans the collapse of a tree; the words of its branches then tell [`children`] and [`is_leaf`]. Returns the cost.
pub(super) fn plan(nodes: &mut [BinaryNode], triangles: &impl Triangles) -> f32 {
    let items = (nodes.len() / 2 + 1) as f32;
    let price = MEMORY * nodes[0].bounds.half_area() / items;
    costs(nodes, triangles, price).by_children[0]
}

fn costs(nodes: &mut [BinaryNode], triangles: &impl Triangles, price: f32) -> Costs {
    let parallel = nodes.len() > PARALLEL;
    let Some((node, below)) = nodes.split_first_mut() else { unreachable!("trees have roots") };
    let area = node.bounds.half_area();
    if node.is_leaf() {
        let cost = price + area * (LEAF + TRIANGLE);
        let (triangles, vertices) = match node.item() {
            Item::Triangle(number) => (1, Vertices::of(triangles.triangle(number).0)),
            Item::Other(_) => (LANES + 1, None),
        };
        return Costs { by_children: [cost; LANES - 1], triangles, vertices };
    }
    let (left, right) = below.split_at_mut(node.right as usize - 1);
    let (left, right) =
        join(parallel, || costs(left, triangles, price), || costs(right, triangles, price));
    let (costs, plan) = combine(area, price, &left, &right);
    node.word = plan.0;
    costs
}

/// The costs of a branch by those of its halves, and how they come about.
fn combine(area: f32, price: f32, left: &Costs, right: &Costs) -> (Costs, Plan) {
    let mut plan = Plan(0);
    let (all, share) = cheapest_share(left, right, LANES);
    plan.set_left(LANES, share);
    let node = price + area * NODE + all;
    let triangles = left.triangles + right.triangles;
    let leaf = price + area * (LEAF + TRIANGLE * triangles as f32);
    let vertices = match (&left.vertices, &right.vertices) {
        (Some(left), Some(right)) if triangles <= LANES => left.union(right),
        _ => None,
    };
    let mut by_children = [node; LANES - 1];
    if vertices.is_some() && leaf <= node {
        by_children[0] = leaf;
        plan.0 |= Plan::LEAF;
    }
    for children in 2..LANES {
        let (cost, share) = cheapest_share(left, right, children);
        by_children[children - 1] = by_children[children - 2];
        if cost < by_children[children - 1] {
            by_children[children - 1] = cost;
            plan.set_left(children, share);
        }
    }
    (Costs { by_children, triangles, vertices }, plan)
}

/// The cheapest way to share so many children between two halves: the cost, and how many the left one gets.
fn cheapest_share(left: &Costs, right: &Costs, children: usize) -> (f32, usize) {
    let mut best = (f32::INFINITY, 1);
    for k in 1..children {
        let cost = left.by_children[k - 1] + right.by_children[children - k - 1];
        if cost < best.0 {
            best = (cost, k);
        }
    }
    best
}

/// Up to eight nodes of the binary tree, by index.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Children {
    list: [u32; LANES],
    len: usize,
}

impl Children {
    /// The nodes, in the order of the tree.
    pub(super) fn list(&self) -> &[u32] {
        &self.list[..self.len]
    }

    /// Adds the best `count` nodes in the place of `nodes[index]`, or fewer.
    fn collect(&mut self, nodes: &[BinaryNode], index: u32, mut count: usize) {
        let node = &nodes[index as usize];
        let plan = Plan(node.word);
        while !node.is_leaf() && count > 1 && plan.left(count) == 0 {
            count -= 1;
        }
        if node.is_leaf() || count == 1 {
            self.list[self.len] = index;
            self.len += 1;
            return;
        }
        let left = plan.left(count);
        self.collect(nodes, index + 1, left);
        self.collect(nodes, index + node.right, count - left);
    }
}

/// Whether a node of a planned tree becomes a leaf.
pub(super) fn is_leaf(node: &BinaryNode) -> bool {
    node.is_leaf() || Plan(node.word).is_leaf()
}

/// What becomes the children of the wide node made from `nodes[index]`; of a leaf, itself.
pub(super) fn children(nodes: &[BinaryNode], index: u32) -> Children {
    let mut children = Children::default();
    let count = if is_leaf(&nodes[index as usize]) { 1 } else { LANES };
    children.collect(nodes, index, count);
    children
}

#[cfg(test)]
mod tests {
    use super::super::build::build;
    use super::super::reference::{Reference, Triangles};
    use super::*;
    use crate::geometry::Bounds;
    use crate::testing::Random;
    use glam::Vec3;

    /// All vertices fit into every leaf.
    struct OneTriangle;

    impl Triangles for OneTriangle {
        fn triangle(&self, _: u32) -> ([Vec3; 3], u32) {
            ([Vec3::ZERO, Vec3::X, Vec3::Y], 0)
        }
    }

    /// A tree over boxes of all sizes, every ninth of them not a triangle.
    fn tree() -> Vec<BinaryNode> {
        let mut random = Random::new(7);
        let mut reference = |i: u32| {
            let (center, size) = (random.point().as_vec3(), 0.2 * random.unit().powi(4) as f32);
            let bounds = Bounds::around([center - size * Vec3::ONE, center + size * Vec3::X]);
            let item = if i.is_multiple_of(9) { Item::Other(i) } else { Item::Triangle(i) };
            Reference::new(bounds, item)
        };
        let mut references: Vec<_> = (0..5000).map(&mut reference).collect();
        build(&mut references, &OneTriangle)
    }

    fn price(nodes: &[BinaryNode]) -> f32 {
        MEMORY * nodes[0].bounds.half_area() / (nodes.len() / 2 + 1) as f32
    }

    fn triangles(nodes: &[BinaryNode], index: u32) -> usize {
        let node = &nodes[index as usize];
        match node.is_leaf() {
            true if matches!(node.item(), Item::Triangle(_)) => 1,
            true => LANES + 1,
            false => triangles(nodes, index + 1) + triangles(nodes, index + node.right),
        }
    }

    fn leaf_cost(nodes: &[BinaryNode], index: u32) -> f32 {
        let area = nodes[index as usize].bounds.half_area();
        let triangles = triangles(nodes, index).min(LANES);
        price(nodes) + area * (LEAF + TRIANGLE * triangles as f32)
    }

    /// The cost of the collapse that was planned, added up from the top.
    fn planned(nodes: &[BinaryNode], index: u32) -> f32 {
        let node = &nodes[index as usize];
        if node.is_leaf() {
            return price(nodes) + node.bounds.half_area() * (LEAF + TRIANGLE);
        }
        if is_leaf(node) {
            assert!(triangles(nodes, index) <= LANES, "a leaf holds eight triangles");
            return leaf_cost(nodes, index);
        }
        let children = children(nodes, index);
        let below: f32 = children.list().iter().map(|&child| planned(nodes, child)).sum();
        price(nodes) + node.bounds.half_area() * NODE + below
    }

    /// The cost of opening the largest branch until there are eight children, with leaves where they fit.
    fn greedy(nodes: &[BinaryNode], index: u32) -> f32 {
        let node = &nodes[index as usize];
        if node.is_leaf() || triangles(nodes, index) <= LANES {
            return leaf_cost(nodes, index);
        }
        let mut open = vec![index];
        while open.len() < LANES {
            let area = |i: u32| nodes[i as usize].bounds.half_area();
            let branches = (0..open.len()).filter(|&i| !nodes[open[i] as usize].is_leaf());
            let Some(i) = branches.max_by(|&a, &b| area(open[a]).total_cmp(&area(open[b]))) else {
                break;
            };
            let branch = open.swap_remove(i);
            open.extend([branch + 1, branch + nodes[branch as usize].right]);
        }
        let below: f32 = open.into_iter().map(|child| greedy(nodes, child)).sum();
        price(nodes) + node.bounds.half_area() * NODE + below
    }

    #[test]
    fn the_plan_costs_what_it_says_and_less_than_the_greedy_one() {
        let mut nodes = tree();
        let said = plan(&mut nodes, &OneTriangle);
        let (planned, greedy) = (planned(&nodes, 0), greedy(&nodes, 0));
        assert!((said - planned).abs() < 1e-3 * said, "{said} {planned}");
        assert!(planned < 0.95 * greedy, "{planned} {greedy}");
    }
}
