//! From the binary tree to the eight-wide one that is traversed.

use super::BuildQuality;
use super::build::{BinaryNode, build};
use super::collapse::{children, is_leaf, plan};
use super::reference::{Item, Reference, Triangles};
use super::reinsert::improve;
use crate::geometry::Bounds;
use crate::kernels::{Child, Node, Tree, TriangleBlock, Word, slots_for};
use crate::simd::{LANES, Pages};
use rayon::prelude::*;

/// Builds the tree over `references`.
pub(super) fn tree(
    mut references: Vec<Reference>,
    triangles: &impl Triangles,
    quality: BuildQuality,
) -> Tree {
    if references.is_empty() {
        let (nodes, blocks, words) = (Pages::new(&[]), Pages::new(&[]), Pages::new(&[]));
        return Tree { nodes, blocks, words, depth: 0, bounds: Bounds::EMPTY, reach: 0.0 };
    }
    let mut binary = build(&mut references, triangles);
    drop(references);
    if quality == BuildQuality::Final {
        binary = improve(binary);
    }
    plan(&mut binary, triangles);
    let bounds = binary[0].bounds;
    let (wide, leaves, depth) = number(&binary);
    let nodes: Vec<_> = wide.par_iter().map(|wide| wide.node(&binary)).collect();
    let blocks: Vec<_> = leaves.par_iter().map(|leaf| leaf.block(&binary, triangles)).collect();
    let words: Vec<_> =
        leaves.par_iter().flat_map_iter(|leaf| leaf.words(&binary, triangles)).collect();
    let (nodes, blocks, words) = (Pages::new(&nodes), Pages::new(&blocks), Pages::new(&words));
    Tree { nodes, blocks, words, depth, bounds, reach: bounds.reach() }
}

/// A wide node to be: the root of its part of the binary tree, and the numbers of the first node and the first block
/// among its children, which follow one another.
#[derive(Clone, Copy)]
struct Wide {
    root: u32,
    first_node: u32,
    first_block: u32,
}

/// A leaf to be: the root of its part of the binary tree, and the number of the first of its words.
#[derive(Clone, Copy)]
struct Leaf {
    root: u32,
    first_word: u32,
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

/// All wide nodes and all leaves, in the order in which they will lie in memory: the children of a node
/// side by side, depth first. And the most wide nodes on a way down.
fn number(binary: &[BinaryNode]) -> (Vec<Wide>, Vec<Leaf>, usize) {
    let (mut wide, mut leaves) = (vec![Wide { root: 0, first_node: 0, first_block: 0 }], vec![]);
    let (mut open, mut first_word, mut deepest) = (vec![(0, 1)], 0, 1);
    while let Some((index, depth)) = open.pop() {
        deepest = deepest.max(depth);
        let first = wide.len();
        wide[index].first_node = first as u32;
        wide[index].first_block = leaves.len() as u32;
        for &root in children(binary, wide[index].root).list() {
            match kind(&binary[root as usize]) {
                Kind::Node => wide.push(Wide { root, first_node: 0, first_block: 0 }),
                Kind::Block => {
                    leaves.push(Leaf { root, first_word });
                    each_item(binary, root, &mut |_| first_word += 1);
                }
                Kind::Other(_) => {}
            }
        }
        open.extend((first..wide.len()).rev().map(|child| (child, depth + 1)));
    }
    (wide, leaves, deepest)
}

impl Wide {
    fn node(&self, binary: &[BinaryNode]) -> Node {
        let mut node = Node::empty();
        let (mut next_node, mut next_block) = (self.first_node as usize, self.first_block as usize);
        let roots = children(binary, self.root);
        for (&root, slot) in roots.list().iter().zip(slots(binary, roots.list())) {
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

/// The slots of children.
fn slots(binary: &[BinaryNode], roots: &[u32]) -> [usize; LANES] {
    let mut bounds = [Bounds::EMPTY; LANES];
    for (bounds, &root) in bounds.iter_mut().zip(roots) {
        *bounds = binary[root as usize].bounds;
    }
    slots_for(&bounds[..roots.len()])
}

impl Leaf {
    fn block(&self, binary: &[BinaryNode], triangles: &impl Triangles) -> TriangleBlock {
        let mut block = TriangleBlock::starting_at(self.first_word);
        each_item(binary, self.root, &mut |item| {
            if let Item::Triangle(number) = item {
                let fits = block.add(triangles.triangle(number).0);
                debug_assert!(fits, "leaves are planned so");
            }
        });
        block
    }

    fn words(&self, binary: &[BinaryNode], triangles: &impl Triangles) -> Vec<Word> {
        let mut words = Vec::with_capacity(LANES);
        each_item(binary, self.root, &mut |item| {
            if let Item::Triangle(number) = item {
                words.push(Word::new(number, triangles.triangle(number).1));
            }
        });
        words
    }
}

fn each_item(binary: &[BinaryNode], root: u32, visit: &mut impl FnMut(Item)) {
    let node = &binary[root as usize];
    if node.is_leaf() {
        return visit(node.item());
    }
    each_item(binary, root + 1, visit);
    each_item(binary, root + node.right, visit);
}
