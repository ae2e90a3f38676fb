//! How a tree lies in memory: nodes of eight boxes, leaves of eight triangles.

use crate::geometry::Bounds;
use crate::simd::LANES;
use glam::Vec3;

/// Flag of a triangle that is hidden from camera rays when seen from behind.
pub(crate) const ONE_SIDED: u32 = 1 << 31;
/// Flag of a triangle whose material leaves holes.
pub(crate) const PARTLY_THERE: u32 = 1 << 30;
/// Word of an unused lane.
const EMPTY: u32 = u32::MAX;
/// Rows of a block: three corners of three coordinates.
pub(super) const ROWS: usize = 9;
/// The part of a triangle's word that is its number.
const NUMBER: u32 = PARTLY_THERE - 1;

/// Eight boxes, structure of arrays, and what is in them.
#[derive(Debug, Clone)]
#[repr(C, align(64))]
pub(crate) struct Node {
    /// Smallest x, y, z, then largest x, y, z of each child.
    pub planes: [[f32; LANES]; 6],
    /// What is in each box.
    pub children: [Child; LANES],
}

/// Reference to a node, a block of triangles or another surface: two bits of kind, thirty of index.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Child(u32);

/// A [`Child`], decoded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Target {
    Node(usize),
    Block(usize),
    Other(u32),
    Nothing,
}

impl Child {
    const INDEX_BITS: u32 = 30;

    /// Reference to nothing.
    pub(crate) const NOTHING: Self = Self(3 << Self::INDEX_BITS);

    /// Reference to `nodes[index]`.
    pub(crate) fn node(index: usize) -> Self {
        Self(index as u32)
    }

    /// Reference to `blocks[index]`.
    pub(crate) fn block(index: usize) -> Self {
        Self(1 << Self::INDEX_BITS | index as u32)
    }

    /// Reference to something that is not triangles, by its surface.
    pub(crate) fn other(surface: u32) -> Self {
        Self(2 << Self::INDEX_BITS | surface)
    }

    #[inline(always)]
    pub(super) fn target(self) -> Target {
        let index = self.0 & ((1 << Self::INDEX_BITS) - 1);
        match self.0 >> Self::INDEX_BITS {
            0 => Target::Node(index as usize),
            1 => Target::Block(index as usize),
            2 => Target::Other(index),
            _ => Target::Nothing,
        }
    }
}

impl Node {
    /// Eight boxes that nothing hits.
    pub(crate) fn empty() -> Self {
        let (lo, hi) = ([f32::INFINITY; LANES], [f32::NEG_INFINITY; LANES]);
        Self { planes: [lo, lo, lo, hi, hi, hi], children: [Child::NOTHING; LANES] }
    }

    /// Fills box `slot`.
    pub(crate) fn set(&mut self, slot: usize, bounds: Bounds, child: Child) {
        for axis in 0..3 {
            self.planes[axis][slot] = bounds.lo[axis];
            self.planes[axis + 3][slot] = bounds.hi[axis];
        }
        self.children[slot] = child;
    }
}

/// Up to eight triangles, structure of arrays. Unused lanes have no area.
#[derive(Debug, Clone)]
#[repr(C, align(64))]
pub(crate) struct TriangleBlock {
    /// x, y, z of the first corners, then of the second and third.
    pub corners: [[f32; LANES]; ROWS],
    /// Number of each triangle in its tree, with flags.
    words: [u32; LANES],
}

impl TriangleBlock {
    /// No triangles.
    pub(crate) fn empty() -> Self {
        Self { corners: [[0.0; LANES]; ROWS], words: [EMPTY; LANES] }
    }

    /// Fills lane `lane` with triangle `number`.
    pub(crate) fn set(&mut self, lane: usize, corners: [Vec3; 3], number: u32, flags: u32) {
        for (corner, p) in corners.into_iter().enumerate() {
            for axis in 0..3 {
                self.corners[3 * corner + axis][lane] = p[axis];
            }
        }
        self.words[lane] = number | flags;
    }

    /// The corners of one triangle.
    #[inline(always)]
    pub(crate) fn triangle(&self, lane: usize) -> [Vec3; 3] {
        let corner =
            |c: usize| Vec3::from_array([0, 1, 2].map(|axis| self.corners[3 * c + axis][lane]));
        [corner(0), corner(1), corner(2)]
    }

    /// Whether a lane and all after it are unused.
    #[inline(always)]
    pub(super) fn is_empty(&self, lane: usize) -> bool {
        self.words[lane] == EMPTY
    }

    /// Its number in the tree.
    #[inline(always)]
    pub(crate) fn number(&self, lane: usize) -> u32 {
        self.words[lane] & NUMBER
    }

    /// Its flags, [`ONE_SIDED`] and [`PARTLY_THERE`].
    #[inline(always)]
    pub(crate) fn flags(&self, lane: usize) -> u32 {
        self.words[lane] & !NUMBER
    }
}

/// A bounding volume hierarchy.
#[derive(Debug, Clone)]
pub(crate) struct Tree {
    /// All nodes; the root first. Empty: nothing to hit.
    pub nodes: Vec<Node>,
    /// All triangles.
    pub blocks: Vec<TriangleBlock>,
    /// The box around everything.
    pub bounds: Bounds,
    /// The largest absolute coordinate of that box.
    pub reach: f32,
}

impl Tree {
    /// Bytes it takes.
    pub(crate) fn memory(&self) -> usize {
        size_of_val(self.nodes.as_slice()) + size_of_val(self.blocks.as_slice())
    }
}
