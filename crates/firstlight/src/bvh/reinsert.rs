//! Improving the upper part of a binary tree: moving subtrees to where they cost less.
//!
//! Meister, Bittner, *Parallel Reinsertion for Bounding Volume Hierarchy Optimization*, Computer Graphics Forum 37(2),
//! 2018: for each subtree the best place is looked for, all at once; then those moves are made that do not meet, the
//! best first. Only the branches with the largest boxes take part, where a bad cut costs most; what is below them moves
//! as one.

use super::build::BinaryNode;
use crate::geometry::Bounds;
use crate::kernels::Stack;
use rayon::prelude::*;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// One branch in so many takes part,
const SHARE: usize = 64;
/// but as many as this if there are.
const LEAST: usize = 1024;
/// Most rounds of moves.
const ROUNDS: usize = 8;
/// The least part of the cost that a round must save to be followed by another, and all of them to be kept.
const WORTH: f64 = 0.01;
/// Index of no node.
const NONE: u32 = u32::MAX;

/// The upper part of a tree.
struct Top(Vec<TopNode>);

/// A node of the upper part.
#[derive(Debug, Clone, Copy)]
struct TopNode {
    bounds: Bounds,
    parent: u32,
    /// [`NONE`]: what is below moves as one.
    halves: [u32; 2],
    /// Where its part of the built tree begins, and how long it is.
    place: usize,
    len: usize,
}

/// Where a subtree would better be.
#[derive(Debug, Clone, Copy)]
struct Move {
    /// What it saves of the sum of all areas.
    saves: f32,
    from: u32,
    /// What will be its other half.
    to: u32,
}

/// Moves subtrees as long as it is worth it.
pub(super) fn improve(nodes: Vec<BinaryNode>) -> Vec<BinaryNode> {
    if nodes[0].is_leaf() {
        return nodes;
    }
    let mut top = Top::of(&nodes);
    let before = top.cost();
    let mut cost = before;
    for _ in 0..ROUNDS {
        top.round();
        let last = std::mem::replace(&mut cost, top.cost());
        if cost > (1.0 - WORTH) * last {
            break;
        }
    }
    let order = top.depth_first();
    let is_kept = cost < (1.0 - WORTH) * before && top.depth(&order, &nodes) <= Stack::DEPTH;
    if is_kept { top.laid_out(&order, &nodes) } else { nodes }
}

impl TopNode {
    fn new(nodes: &[BinaryNode], parent: u32, place: usize, len: usize) -> Self {
        Self { bounds: nodes[place].bounds, parent, halves: [NONE; 2], place, len }
    }

    fn is_branch(&self) -> bool {
        self.halves[0] != NONE
    }

    /// How much of the slice is its own.
    fn own_len(&self) -> usize {
        if self.is_branch() { 1 } else { self.len }
    }
}

impl Top {
    /// The branches of a tree with the largest boxes, all in one piece, and the roots of what is below them.
    fn of(nodes: &[BinaryNode]) -> Self {
        let mut top = Self(vec![TopNode::new(nodes, NONE, 0, nodes.len())]);
        let mut open = BinaryHeap::from([(0, Reverse(0))]);
        for _ in 0..LEAST.max(nodes.len() / 2 / SHARE) {
            let Some((_, Reverse(index))) = open.pop() else { break };
            for half in top.open(index, nodes) {
                let node = &top.0[half as usize];
                if !nodes[node.place].is_leaf() {
                    open.push((node.bounds.half_area().to_bits(), Reverse(half)));
                }
            }
        }
        top
    }

    /// Adds the halves of a node, which must be a branch.
    fn open(&mut self, index: u32, nodes: &[BinaryNode]) -> [u32; 2] {
        let TopNode { place, len, .. } = self.0[index as usize];
        let right = nodes[place].right as usize;
        let first = self.0.len() as u32;
        self.0.push(TopNode::new(nodes, index, place + 1, right - 1));
        self.0.push(TopNode::new(nodes, index, place + right, len - right));
        self.0[index as usize].halves = [first, first + 1];
        [first, first + 1]
    }

    fn area(&self, index: u32) -> f32 {
        self.0[index as usize].bounds.half_area()
    }

    fn parent(&self, index: u32) -> u32 {
        self.0[index as usize].parent
    }

    /// The other half of its parent.
    fn sibling(&self, index: u32) -> u32 {
        let [a, b] = self.0[self.parent(index) as usize].halves;
        if a == index { b } else { a }
    }

    /// The sum of the areas of all branches.
    fn cost(&self) -> f64 {
        let branches = self.0.iter().filter(|node| node.is_branch());
        branches.map(|node| f64::from(node.bounds.half_area())).sum()
    }

    /// Finds the best move of each node and makes those that do not meet.
    fn round(&mut self) {
        let nodes = (0..self.0.len() as u32).into_par_iter();
        let moves = nodes.map_init(Vec::new, |open, from| self.best_move(from, open));
        let mut moves: Vec<_> = moves.flatten_iter().collect();
        moves.sort_unstable_by(|a, b| b.saves.total_cmp(&a.saves).then(a.from.cmp(&b.from)));
        let mut is_touched = vec![false; self.0.len()];
        for Move { from, to, .. } in moves {
            let parent = self.parent(from);
            let involved =
                [from, to, parent, self.sibling(from), self.parent(parent), self.parent(to)];
            let free = involved.iter().all(|&i| i != NONE && !is_touched[i as usize]);
            if free && !self.is_inside(to, from) {
                involved.iter().for_each(|&i| is_touched[i as usize] = true);
                self.make(from, to);
            }
        }
    }

    /// The place where a node costs least, if it is not where it is.
    fn best_move(&self, from: u32, open: &mut Vec<(f32, u32)>) -> Option<Move> {
        let parent = self.parent(from);
        if parent == NONE || self.parent(parent) == NONE {
            return None;
        }
        let mut best = Move { saves: 0.0, from, to: NONE };
        let mut other = self.sibling(from);
        // Its sibling takes the place of its parent; boxes above shrink to what else is in them.
        let (mut above, mut saved) = (parent, self.area(parent));
        let mut shrunk = self.0[other as usize].bounds;
        self.look_inside(&mut best, (saved, other), open);
        while self.parent(above) != NONE {
            other = self.sibling(above);
            above = self.parent(above);
            self.look_inside(&mut best, (saved, other), open);
            shrunk = shrunk.union(self.0[other as usize].bounds);
            saved += self.area(above) - shrunk.half_area();
        }
        (best.to != NONE).then_some(best)
    }

    /// Looks for a better place at and below `start`, given what taking the node away has `saved`. What a place costs
    /// is the area of the box around both, and how much the boxes from `start` down to it grow.
    fn look_inside(&self, best: &mut Move, start: (f32, u32), open: &mut Vec<(f32, u32)>) {
        let bounds = self.0[best.from as usize].bounds;
        let area = bounds.half_area();
        let sibling = self.sibling(best.from);
        open.push(start);
        while let Some((saved, index)) = open.pop() {
            if saved - area <= best.saves {
                continue;
            }
            let node = &self.0[index as usize];
            let saves = saved - node.bounds.union(bounds).half_area();
            if saves > best.saves && index != sibling {
                *best = Move { saves, to: index, ..*best };
            }
            if node.is_branch() {
                let saved = saves + node.bounds.half_area();
                open.extend(node.halves.map(|half| (saved, half)));
            }
        }
    }

    fn is_inside(&self, mut index: u32, of: u32) -> bool {
        while index != NONE && index != of {
            index = self.parent(index);
        }
        index == of
    }

    /// Takes `from` from its sibling and makes it the other half of `to`, with its parent above both.
    fn make(&mut self, from: u32, to: u32) {
        let (parent, sibling) = (self.parent(from), self.sibling(from));
        let grandparent = self.parent(parent);
        self.replace(grandparent, parent, sibling);
        self.replace(self.parent(to), to, parent);
        self.0[parent as usize].halves = [to, from];
        self.0[to as usize].parent = parent;
        self.refit(grandparent);
        self.refit(parent);
    }

    /// Puts `new` in the place of a half of `branch`.
    fn replace(&mut self, branch: u32, half: u32, new: u32) {
        let halves = &mut self.0[branch as usize].halves;
        *halves = halves.map(|h| if h == half { new } else { h });
        self.0[new as usize].parent = branch;
    }

    /// Makes boxes fit again, from a branch upwards.
    fn refit(&mut self, mut index: u32) {
        while index != NONE {
            let [a, b] = self.0[index as usize].halves.map(|half| self.0[half as usize].bounds);
            self.0[index as usize].bounds = a.union(b);
            index = self.parent(index);
        }
    }

    /// All nodes, parents first and left halves before right ones.
    fn depth_first(&self) -> Vec<u32> {
        let (mut order, mut open) = (Vec::with_capacity(self.0.len()), vec![0]);
        while let Some(index) = open.pop() {
            order.push(index);
            let node = &self.0[index as usize];
            if node.is_branch() {
                open.extend([node.halves[1], node.halves[0]]);
            }
        }
        order
    }

    /// The depth of the whole tree.
    fn depth(&self, order: &[u32], nodes: &[BinaryNode]) -> usize {
        let mut depths = vec![0; self.0.len()];
        for &index in &order[1..] {
            depths[index as usize] = depths[self.parent(index) as usize] + 1;
        }
        let depth = |(node, depth): (&TopNode, usize)| depth + nodes[node.place].height();
        let ends = self.0.iter().zip(depths).filter(|(node, _)| !node.is_branch());
        ends.map(depth).max().unwrap_or(0)
    }

    /// The tree in its new order.
    fn laid_out(&self, order: &[u32], nodes: &[BinaryNode]) -> Vec<BinaryNode> {
        let mut out = nodes.to_vec();
        let (mut places, mut place) = (vec![0; self.0.len()], 0);
        let (mut parts, mut rest) = (Vec::with_capacity(order.len()), out.as_mut_slice());
        for &index in order {
            let len = self.0[index as usize].own_len();
            let (part, after) = rest.split_at_mut(len);
            parts.push((index, part));
            rest = after;
            places[index as usize] = place;
            place += len as u32;
        }
        parts.into_par_iter().for_each(|(index, part)| {
            let node = &self.0[index as usize];
            if node.is_branch() {
                let right = places[node.halves[1] as usize] - places[index as usize];
                part[0] = BinaryNode { bounds: node.bounds, right, word: 0 };
            } else {
                part.copy_from_slice(&nodes[node.place..node.place + node.len]);
            }
        });
        out
    }
}

#[cfg(test)]
mod tests {
    use super::super::build::build;
    use super::super::build::tests::{check, references};
    use super::*;
    use crate::math::hash;
    use glam::Vec3;

    /// The sum of the areas of all branches.
    fn cost(nodes: &[BinaryNode]) -> f64 {
        let node = &nodes[0];
        if node.is_leaf() {
            return 0.0;
        }
        let (left, right) = (&nodes[1..], &nodes[node.right as usize..]);
        f64::from(node.bounds.half_area()) + cost(left) + cost(right)
    }

    #[test]
    fn a_better_tree_has_the_same_triangles_and_boxes_that_hold_them() {
        // Needles of all lengths and directions, which a cut by centres parts badly.
        let number = |i: u32, k: u64| (hash(8 * u64::from(i) + k) >> 40) as f32 / (1 << 24) as f32;
        let point = |i: u32, k| Vec3::new(number(i, k), number(i, k + 1), number(i, k + 2));
        let needle = |i: u32| {
            let (from, along) = (point(i, 0), (point(i, 3) - 0.5) * 4.0 * number(i, 6).powi(4));
            [from, from + along, from + along + Vec3::splat(1e-3)]
        };
        let needles: Vec<_> = (0..4000).map(needle).collect();
        let built = build(&mut references(4000, &needle), &needles);
        let improved = improve(built.clone());
        let mut found = Vec::new();
        check(&improved, &needles, &mut found);
        found.sort_unstable();
        assert!(found.into_iter().eq(0..4000));
        assert!(cost(&improved) < 0.97 * cost(&built), "{} {}", cost(&improved), cost(&built));
    }
}
