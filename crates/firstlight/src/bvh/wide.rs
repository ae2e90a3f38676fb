//! From the binary tree to the eight-wide one that is traversed.

use super::build::{BinaryNode, build};
use super::collapse::{Children, children, is_leaf, plan};
use super::reference::{Item, Reference, Triangles};
use crate::geometry::Bounds;
use crate::kernels::{Child, Node, Tree, TriangleBlock};
use rayon::prelude::*;

/// Builds the tree over `references`.
pub(super) fn tree(mut references: Vec<Reference>, triangles: &impl Triangles) -> Tree {
    if references.is_empty() {
        return Tree { nodes: Vec::new(), blocks: Vec::new(), bounds: Bounds::EMPTY, reach: 0.0 };
    }
    let mut binary = build(&mut references, triangles);
    drop(references);
    plan(&mut binary);
    let bounds = binary[0].bounds;
    let (wide, leaves) = number(&binary);
    let nodes = wide.par_iter().map(|wide| wide.node(&binary)).collect();
    let blocks = leaves.par_iter().map(|&leaf| block(&binary, leaf, triangles)).collect();
    Tree { nodes, blocks, bounds, reach: bounds.reach() }
}

/// A wide node to be: its children in the binary tree, and the numbers of the first node and the first block among
/// them, which follow one another.
struct Wide {
    children: Children,
    first_node: usize,
    first_block: usize,
}

/// What a child becomes.
enum Kind {
    Node,
    Block,
    Other(u32),
}

fn kind(node: &BinaryNode) -> Kind {
    if !is_leaf(node) {
        return Kind::Node;
    }
    match Item::from_bits(node.word) {
        Item::Other(surface) if node.is_leaf() => Kind::Other(surface),
        _ => Kind::Block,
    }
}

/// All wide nodes and the roots of all leaves, in the order in which they will lie in memory: the children of a node
/// side by side, depth first.
fn number(binary: &[BinaryNode]) -> (Vec<Wide>, Vec<u32>) {
    let (mut wide, mut leaves) = (vec![Wide::new(binary, 0)], vec![]);
    let mut open = vec![0];
    while let Some(index) = open.pop() {
        let children = wide[index].children;
        (wide[index].first_node, wide[index].first_block) = (wide.len(), leaves.len());
        for &root in children.list() {
            match kind(&binary[root as usize]) {
                Kind::Node => wide.push(Wide::new(binary, root)),
                Kind::Block => leaves.push(root),
                Kind::Other(_) => {}
            }
        }
        open.extend((wide[index].first_node..wide.len()).rev());
    }
    (wide, leaves)
}

impl Wide {
    fn new(binary: &[BinaryNode], root: u32) -> Self {
        Self { children: children(binary, root), first_node: 0, first_block: 0 }
    }

    fn node(&self, binary: &[BinaryNode]) -> Node {
        let mut node = Node::empty();
        let (mut next_node, mut next_block) = (self.first_node, self.first_block);
        for (slot, &root) in self.children.list().iter().enumerate() {
            let root = &binary[root as usize];
            let child = match kind(root) {
                Kind::Node => {
                    next_node += 1;
                    Child::node(next_node - 1)
                }
                Kind::Block => {
                    next_block += 1;
                    Child::block(next_block - 1)
                }
                Kind::Other(surface) => Child::other(surface),
            };
            node.set(slot, root.bounds, child);
        }
        node
    }
}

/// The leaf over all triangles below `binary[root]`.
fn block(binary: &[BinaryNode], root: u32, triangles: &impl Triangles) -> TriangleBlock {
    let mut block = TriangleBlock::empty();
    let mut lane = 0;
    each_item(binary, root, &mut |item| {
        if let Item::Triangle(number) = item {
            let (corners, flags) = triangles.triangle(number);
            block.set(lane, corners, number, flags);
            lane += 1;
        }
    });
    block
}

fn each_item(binary: &[BinaryNode], root: u32, visit: &mut impl FnMut(Item)) {
    let node = &binary[root as usize];
    if node.is_leaf() {
        return visit(node.item());
    }
    each_item(binary, root + 1, visit);
    each_item(binary, root + node.right, visit);
}
