//! Vectors as a structure of arrays: a plain loop over a block of them works on as many at a time as the processor can.

use glam::{DVec3, Vec3};

/// How many vectors there are in a block.
pub(crate) const BLOCK: usize = 64;

/// A block of vectors, coordinate by coordinate.
#[derive(Debug, Clone)]
#[repr(align(64))]
pub(crate) struct Columns<T> {
    x: [T; BLOCK],
    y: [T; BLOCK],
    z: [T; BLOCK],
}

/// Zeros.
impl<T: Copy + Default> Default for Columns<T> {
    #[inline(always)]
    fn default() -> Self {
        let zeros = [T::default(); BLOCK];
        Self { x: zeros, y: zeros, z: zeros }
    }
}

impl Columns<f32> {
    /// The vector in row `k`.
    #[inline(always)]
    pub(crate) fn get(&self, k: usize) -> Vec3 {
        Vec3::new(self.x[k], self.y[k], self.z[k])
    }

    /// Replaces the vector in row `k`.
    #[inline(always)]
    pub(crate) fn set(&mut self, k: usize, v: Vec3) {
        (self.x[k], self.y[k], self.z[k]) = v.into();
    }
}

impl Columns<f64> {
    /// The vector in row `k`.
    #[inline(always)]
    pub(crate) fn get(&self, k: usize) -> DVec3 {
        DVec3::new(self.x[k], self.y[k], self.z[k])
    }

    /// Replaces the vector in row `k`.
    #[inline(always)]
    pub(crate) fn set(&mut self, k: usize, v: DVec3) {
        (self.x[k], self.y[k], self.z[k]) = v.into();
    }
}
