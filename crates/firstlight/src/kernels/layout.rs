//! How a tree lies in memory: nodes of eight boxes, leaves of eight triangles.

use crate::geometry::Bounds;
use crate::simd::{LANES, Pages, Simd};
use glam::Vec3;

/// Flag of a triangle that is hidden from camera rays when seen from behind.
pub(crate) const ONE_SIDED: u32 = 1 << 31;
/// Flag of a triangle whose material leaves holes.
pub(crate) const PARTLY_THERE: u32 = 1 << 30;
/// The part of a triangle's word that is its number.
const NUMBER: u32 = PARTLY_THERE - 1;

/// One of the three axes: an index that needs no check.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(usize)]
pub(super) enum Axis {
    X,
    Y,
    Z,
}

/// One of the six rows of [`Node::planes`]: an index that needs no check.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(usize)]
pub(super) enum Plane {
    LoX,
    LoY,
    LoZ,
    HiX,
    HiY,
    HiZ,
}

/// Which of a node's six planes rays enter and leave through, by axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct EntryPlanes {
    pub near: [Plane; 3],
    pub far: [Plane; 3],
}

impl EntryPlanes {
    /// For directions whose signs are the bits of `octant`.
    #[inline(always)]
    pub(super) fn of(octant: u32) -> &'static Self {
        const OCTANTS: [EntryPlanes; 8] = {
            let lo = [Plane::LoX, Plane::LoY, Plane::LoZ];
            let hi = [Plane::HiX, Plane::HiY, Plane::HiZ];
            let mut octants = [EntryPlanes { near: lo, far: hi }; 8];
            let mut i = 0;
            while i < 3 * 8 {
                let (octant, axis) = (i / 3, i % 3);
                if octant >> axis & 1 == 1 {
                    octants[octant].near[axis] = hi[axis];
                    octants[octant].far[axis] = lo[axis];
                }
                i += 1;
            }
            octants
        };
        &OCTANTS[octant as usize % 8]
    }
}

/// Eight boxes, structure of arrays, and what is in them.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub(crate) struct Node {
    /// Smallest x, y, z, then largest x, y, z of each child.
    pub planes: [[f32; LANES]; 6],
    /// What is in each box: the bits of a [`Child`].
    children: [u32; LANES],
}

/// Reference to a node, a block of triangles or another surface: two bits of kind, thirty of index. The highest bit tells
/// what is not a node.
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
    const BLOCK: u32 = 2;
    const OTHER: u32 = 3;

    /// Reference to nothing.
    pub(crate) const NOTHING: Self = Self(u32::MAX);

    /// Reference to `nodes[index]`.
    pub(crate) fn node(index: usize) -> Self {
        Self(index as u32)
    }

    /// Reference to `blocks[index]`.
    pub(crate) fn block(index: usize) -> Self {
        Self(Self::BLOCK << Self::INDEX_BITS | index as u32)
    }

    /// Reference to something that is not triangles, by its surface.
    pub(crate) fn other(surface: u32) -> Self {
        Self(Self::OTHER << Self::INDEX_BITS | surface)
    }

    /// As a number.
    #[inline(always)]
    pub(super) fn bits(self) -> u32 {
        self.0
    }

    /// From [`Child::bits`].
    #[inline(always)]
    pub(super) fn from_bits(bits: u32) -> Self {
        Self(bits)
    }

    /// 0 for a node, 1 for everything else.
    #[inline(always)]
    pub(super) fn is_no_node(self) -> u32 {
        self.0 >> (u32::BITS - 1)
    }

    /// The number of the node that it is.
    #[inline(always)]
    pub(super) fn node_index(self) -> usize {
        self.0 as usize
    }

    #[inline(always)]
    pub(super) fn target(self) -> Target {
        let index = self.0 & ((1 << Self::INDEX_BITS) - 1);
        match self.0 >> Self::INDEX_BITS {
            Self::BLOCK => Target::Block(index as usize),
            Self::OTHER if self == Self::NOTHING => Target::Nothing,
            Self::OTHER => Target::Other(index),
            _ => Target::Node(index as usize),
        }
    }
}

impl Node {
    /// Eight boxes that nothing hits.
    pub(crate) fn empty() -> Self {
        let (lo, hi) = ([f32::INFINITY; LANES], [f32::NEG_INFINITY; LANES]);
        Self { planes: [lo, lo, lo, hi, hi, hi], children: [Child::NOTHING.0; LANES] }
    }

    /// One plane of each child.
    #[inline(always)]
    pub(super) fn row(&self, plane: Plane) -> &[f32; LANES] {
        &self.planes[plane as usize]
    }

    /// Fills box `slot`.
    pub(crate) fn set(&mut self, slot: usize, bounds: Bounds, child: Child) {
        for axis in 0..3 {
            self.planes[axis][slot] = bounds.lo[axis];
            self.planes[axis + 3][slot] = bounds.hi[axis];
        }
        self.children[slot] = child.0;
    }

    /// What is in one box.
    #[inline(always)]
    pub(super) fn child(&self, slot: usize) -> Child {
        Child(self.children[slot])
    }

    /// What is in all boxes: the bits of each [`Child`].
    #[inline(always)]
    pub(super) fn children(&self) -> &[u32; LANES] {
        &self.children
    }
}

/// Up to eight points, told apart by their bits, so that triangles of different faces, meshes and files share them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Vertices {
    rows: [[f32; LANES]; 3],
    len: u8,
}

impl Vertices {
    const NONE: Self = Self { rows: [[0.0; LANES]; 3], len: 0 };

    /// The corners of one triangle.
    pub(crate) fn of(corners: [Vec3; 3]) -> Option<Self> {
        let mut vertices = Self::NONE;
        for corner in corners {
            vertices.find_or_add(corner)?;
        }
        Some(vertices)
    }

    /// Those of both, if they are at most eight.
    pub(crate) fn union(&self, other: &Self) -> Option<Self> {
        let mut both = *self;
        for vertex in 0..usize::from(other.len) {
            both.find_or_add(other.get(vertex))?;
        }
        Some(both)
    }

    #[inline(always)]
    fn get(&self, vertex: usize) -> Vec3 {
        Vec3::new(self.rows[0][vertex], self.rows[1][vertex], self.rows[2][vertex])
    }

    /// The number of a point; it is added if it is new and there is room.
    fn find_or_add(&mut self, p: Vec3) -> Option<u8> {
        let bits = |p: Vec3| p.to_array().map(f32::to_bits);
        let known = (0..self.len).find(|&v| bits(self.get(usize::from(v))) == bits(p));
        if known.is_some() {
            return known;
        }
        let vertex = self.len;
        for (row, x) in self.rows.iter_mut().zip(p.to_array()) {
            *row.get_mut(usize::from(vertex))? = x;
        }
        self.len += 1;
        Some(vertex)
    }
}

/// Up to eight triangles that share up to eight vertices: two cache lines. Unused lanes have no area.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub(crate) struct TriangleBlock {
    /// x, y, z of the vertices.
    rows: [[f32; LANES]; 3],
    /// Which vertices are the first, second and third corner of each triangle.
    pub(super) corners: [[u8; LANES]; 3],
    /// Index of the first triangle's word in [`Tree::words`].
    first_word: u32,
    triangles: u8,
    vertices: u8,
}

const _: () = assert!(size_of::<Node>() == 256 && size_of::<TriangleBlock>() == 128);

impl TriangleBlock {
    /// No triangles; the words of those to come start at `first_word`.
    pub(crate) fn starting_at(first_word: u32) -> Self {
        let (rows, corners) = ([[0.0; LANES]; 3], [[0; LANES]; 3]);
        Self { rows, corners, first_word, triangles: 0, vertices: 0 }
    }

    /// Adds a triangle, if there is room for it and those of its corners that are not here yet.
    pub(crate) fn add(&mut self, corners: [Vec3; 3]) -> bool {
        let lane = self.len();
        let mut vertices = Vertices { rows: self.rows, len: self.vertices };
        for (row, corner) in self.corners.iter_mut().zip(corners) {
            let (Some(slot), Some(vertex)) = (row.get_mut(lane), vertices.find_or_add(corner))
            else {
                return false;
            };
            *slot = vertex;
        }
        (self.rows, self.vertices) = (vertices.rows, vertices.len);
        self.triangles += 1;
        true
    }

    /// One coordinate of each vertex.
    #[inline(always)]
    pub(super) fn row(&self, axis: Axis) -> &[f32; LANES] {
        &self.rows[axis as usize]
    }

    /// Number of vertices.
    #[inline(always)]
    pub(super) fn vertex_count(&self) -> usize {
        usize::from(self.vertices)
    }

    /// Number of triangles.
    #[inline(always)]
    pub(crate) fn len(&self) -> usize {
        usize::from(self.triangles)
    }

    /// The corners of one triangle.
    #[inline(always)]
    pub(crate) fn triangle(&self, lane: usize) -> [Vec3; 3] {
        [self.corner(0, lane), self.corner(1, lane), self.corner(2, lane)]
    }

    #[inline(always)]
    fn corner(&self, corner: usize, lane: usize) -> Vec3 {
        let vertex = self.corner_vertex(corner, lane);
        Vec3::new(self.rows[0][vertex], self.rows[1][vertex], self.rows[2][vertex])
    }

    /// Which vertex a corner of a triangle is.
    #[inline(always)]
    pub(super) fn corner_vertex(&self, corner: usize, lane: usize) -> usize {
        usize::from(self.corners[corner][lane]) % LANES
    }
}

/// A triangle's number in its tree, with flags.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Word(u32);

impl Word {
    /// Triangle `number` with `flags`.
    pub(crate) fn new(number: u32, flags: u32) -> Self {
        Self(number | flags)
    }

    /// Its number in the tree.
    #[inline(always)]
    pub(super) fn number(self) -> u32 {
        self.0 & NUMBER
    }

    /// Its flags, [`ONE_SIDED`] and [`PARTLY_THERE`].
    #[inline(always)]
    pub(super) fn flags(self) -> u32 {
        self.0 & !NUMBER
    }
}

/// A bounding volume hierarchy.
#[derive(Debug)]
pub(crate) struct Tree {
    /// All nodes; the root first. Empty: nothing to hit.
    pub nodes: Pages<Node>,
    /// All triangles.
    pub blocks: Pages<TriangleBlock>,
    /// What the triangles are, block by block.
    pub words: Pages<Word>,
    /// The most nodes on a way from the root down.
    pub depth: usize,
    /// The box around everything.
    pub bounds: Bounds,
    /// The largest absolute coordinate of that box.
    pub reach: f32,
}

impl Tree {
    /// Asks for what `child` refers to, which is needed soon.
    #[inline(always)]
    pub(super) fn prefetch<S: Simd>(&self, simd: S, child: Child) {
        match child.target() {
            Target::Node(index) => simd.prefetch(&self.nodes[index]),
            Target::Block(index) => simd.prefetch(&self.blocks[index]),
            Target::Other(_) | Target::Nothing => {}
        }
    }

    /// Where nodes and blocks lie.
    #[inline(always)]
    pub(super) fn places(&self) -> Places {
        Places([self.nodes.as_ptr().cast(), self.blocks.as_ptr().cast()])
    }

    /// What the triangle in `lane` of a block is.
    #[inline(always)]
    pub(super) fn word(&self, block: &TriangleBlock, lane: usize) -> Word {
        self.words[block.first_word as usize + lane]
    }

    /// Bytes it takes.
    pub(crate) fn memory(&self) -> usize {
        size_of_val(&*self.nodes) + size_of_val(&*self.blocks) + size_of_val(&*self.words)
    }
}

/// Where nodes and blocks lie in memory.
#[derive(Clone, Copy)]
pub(super) struct Places([*const u8; 2]);

impl Places {
    /// Asks for what `child` refers to, without asking what it is: nobody could foresee the answer.
    #[inline(always)]
    pub(super) fn prefetch<S: Simd>(&self, simd: S, child: Child) {
        const KIND_BITS: u32 = u32::BITS - Child::INDEX_BITS;
        const SHIFT: u32 = size_of::<Node>().ilog2() - KIND_BITS;
        let is_block = child.is_no_node();
        // A block is half as large as a node.
        let offset = ((child.0 << KIND_BITS) as usize) << SHIFT >> is_block;
        simd.prefetch(self.0[is_block as usize].wrapping_add(offset).cast::<Node>());
    }
}
