//! From the binary tree to the eight-wide one that is traversed.

use super::build::{Branch, Content, Item, Reference, Triangles, build};
use crate::geometry::Bounds;
use crate::kernels::{Child, Node, Tree, TriangleBlock};
use crate::simd::LANES;

/// Builds the tree over `references`.
pub(super) fn tree(mut references: Vec<Reference>, triangles: Triangles) -> Tree {
    let mut tree =
        Tree { nodes: Vec::new(), blocks: Vec::new(), bounds: Bounds::EMPTY, reach: 0.0 };
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

fn emit_leaf(tree: &mut Tree, items: &[Item], triangles: Triangles) -> Child {
    let mut block = TriangleBlock::empty();
    for (lane, item) in items.iter().enumerate() {
        match *item {
            Item::Other(surface) => return Child::other(surface),
            Item::Triangle(number) => {
                let (corners, flags) = triangles(number);
                block.set(lane, corners, number, flags);
            }
        }
    }
    tree.blocks.push(block);
    Child::block(tree.blocks.len() - 1)
}
