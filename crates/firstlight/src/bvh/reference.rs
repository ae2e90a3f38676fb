//! What is put into a tree: boxes around triangles and other surfaces.

use crate::geometry::Bounds;
use glam::{Vec3, Vec4};

/// A box as two registers; the fourth lanes mean nothing here.
#[derive(Debug, Clone, Copy)]
pub(super) struct Extent {
    /// Smallest coordinates.
    pub lo: Vec4,
    /// Largest coordinates.
    pub hi: Vec4,
}

/// One thing to be put into a tree, 32 bytes: its box, and in the fourth lane of `lo` the bits of its [`Item`].
#[derive(Debug, Clone, Copy)]
#[repr(align(32))]
pub(super) struct Reference(Extent);

/// What a [`Reference`] refers to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Item {
    /// A triangle by its number.
    Triangle(u32),
    /// Something else by its surface.
    Other(u32),
}

/// Where a tree's triangles come from.
pub(super) trait Triangles: Sync {
    /// Corners and flags of a triangle by its number.
    fn triangle(&self, number: u32) -> ([Vec3; 3], u32);
}

impl Extent {
    /// Contains nothing.
    pub(super) const EMPTY: Self = Self { lo: Vec4::INFINITY, hi: Vec4::NEG_INFINITY };

    /// The smallest box around both.
    #[inline(always)]
    pub(super) fn union(self, other: Self) -> Self {
        Self { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }

    /// The smallest box around this one and a point.
    #[inline(always)]
    pub(super) fn with(self, point: Vec4) -> Self {
        Self { lo: self.lo.min(point), hi: self.hi.max(point) }
    }

    /// Half the surface area; without meaning for an empty box.
    #[inline(always)]
    pub(super) fn half_area(self) -> f32 {
        let d = self.hi - self.lo;
        d.x * d.y + d.y * d.z + d.z * d.x
    }
}

impl Item {
    /// Bit of a word that says that it is not a triangle.
    const OTHER: u32 = 1 << 31;
    /// Bit of every word: read as a float, none is subnormal, with which processors reckon slowly.
    const NORMAL: u32 = 1 << 30;

    /// As one word; numbers and surfaces have thirty bits.
    pub(super) fn to_bits(self) -> u32 {
        match self {
            Self::Triangle(number) => Self::NORMAL | number,
            Self::Other(surface) => Self::OTHER | Self::NORMAL | surface,
        }
    }

    /// From one word.
    pub(super) fn from_bits(bits: u32) -> Self {
        let number = bits & (Self::NORMAL - 1);
        if bits & Self::OTHER == 0 { Self::Triangle(number) } else { Self::Other(number) }
    }
}

impl Reference {
    /// A box and what is in it.
    pub(super) fn new(bounds: Bounds, item: Item) -> Self {
        let lo = bounds.lo.extend(f32::from_bits(item.to_bits()));
        Self(Extent { lo, hi: bounds.hi.extend(0.0) })
    }

    /// Its box.
    #[inline(always)]
    pub(super) fn extent(&self) -> Extent {
        self.0
    }

    /// Its box.
    pub(super) fn bounds(&self) -> Bounds {
        Bounds { lo: self.0.lo.truncate(), hi: self.0.hi.truncate() }
    }

    /// Twice its box's centre.
    #[inline(always)]
    pub(super) fn center(&self) -> Vec4 {
        self.0.lo + self.0.hi
    }

    /// What is in the box.
    pub(super) fn item(&self) -> Item {
        Item::from_bits(self.0.lo.w.to_bits())
    }
}
