//! From the binary tree to the eight-wide one that is traversed.

use super::build::{Branch, Content, Item, Reference, Triangles, build};
use crate::geometry::Bounds;
use crate::kernels::{Child, Node, Tree, TriangleBlock, Word};
use crate::simd::LANES;

/// Builds the tree over `references`.
pub(super) fn tree(mut references: Vec<Reference>, triangles: Triangles) -> Tree {
    let mut tree = Tree::empty();
    if references.is_empty() {
        return tree;
    }
    let root = build(&mut references, triangles);
    drop(references);
    tree.bounds = root.bounds;
    tree.reach = root.bounds.reach();
    match root.content {
        Content::Split(_) => emit_node(&mut tree, widen(root), triangles),
        Content::Leaf(_) => emit_node(&mut tree, vec![root], triangles),
    };
    tree
}

/// Opens the largest branches until there are eight.
fn widen(root: Branch) -> Vec<Branch> {
    let mut children = vec![root];
    while children.len() < LANES {
        let can_open = |b: &Branch| matches!(b.content, Content::Split(_));
        let open = children.iter().enumerate().filter(|(_, b)| can_open(b));
        let area = |b: &Branch| b.bounds.half_area();
        let largest = open.max_by(|a, b| area(a.1).total_cmp(&area(b.1))).map(|(i, _)| i);
        let Some(largest) = largest else { break };
        if let Content::Split(halves) = children.swap_remove(largest).content {
            children.extend(*halves);
        }
    }
    children
}

/// Appends a node over up to eight branches, and all below it.
fn emit_node(tree: &mut Tree, children: Vec<Branch>, triangles: Triangles) -> Child {
    let index = tree.nodes.len();
    tree.nodes.push(Node::empty());
    for (slot, branch) in children.into_iter().enumerate() {
        let bounds = branch.bounds;
        let child = match branch.content {
            Content::Leaf(items) => emit_leaf(tree, &items, triangles),
            Content::Split(_) => emit_node(tree, widen(branch), triangles),
        };
        tree.nodes[index].set(slot, bounds, child);
    }
    Child::node(index)
}

/// Appends triangles as one block, or, if their vertices do not fit, as a node over several.
fn emit_leaf(tree: &mut Tree, items: &[Item], triangles: Triangles) -> Child {
    let mut blocks = vec![(TriangleBlock::starting_at(tree.words.len()), Bounds::EMPTY)];
    for item in items {
        let number = match *item {
            Item::Other(surface) => return Child::other(surface),
            Item::Triangle(number) => number,
        };
        let (corners, flags) = triangles(number);
        let last = blocks.len() - 1;
        if !blocks[last].0.add(corners) {
            let mut block = TriangleBlock::starting_at(tree.words.len());
            block.add(corners);
            blocks.push((block, Bounds::EMPTY));
        }
        let last = blocks.len() - 1;
        blocks[last].1 = blocks[last].1.union(Bounds::around(corners));
        tree.words.push(Word::new(number, flags));
    }
    let first = tree.blocks.len();
    tree.blocks.extend(blocks.iter().map(|(block, _)| block.clone()));
    if blocks.len() == 1 {
        return Child::block(first);
    }
    let mut node = Node::empty();
    for (slot, (_, bounds)) in blocks.iter().enumerate() {
        node.set(slot, *bounds, Child::block(first + slot));
    }
    tree.nodes.push(node);
    Child::node(tree.nodes.len() - 1)
}
