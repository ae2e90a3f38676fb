//! Points to be shaded with direct light, in blocks: loops over a block work on several points at a time.

use crate::color::Rgb;
use crate::geometry::Ray;
use crate::math::{BLOCK, Columns};
use crate::shading::light::{Light, LightSample, LightSamples};
use glam::{DVec3, Vec3};

/// What the lights need to know of a surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Point {
    /// Index of the camera ray.
    pub ray: u32,
    /// Where it is, m.
    pub position: DVec3,
    /// Where shadow rays start.
    pub start: Vec3,
    /// Unit normal of the surface as it should look.
    pub shading_normal: Vec3,
    /// The lecture's k_d = R_d / π, sr⁻¹, of a matte surface.
    pub matte: Rgb,
    /// Place among the glossy points, or [`MATTE`].
    pub glossy: u32,
}

/// Says that a point is on a matte surface.
pub(super) const MATTE: u32 = u32::MAX;

/// Any number of points.
#[derive(Default)]
pub(super) struct Points {
    blocks: Vec<PointBlock>,
    len: usize,
}

impl Points {
    /// Forgets all points.
    pub(super) fn clear(&mut self) {
        self.len = 0;
    }

    /// Number of points.
    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// Adds a point.
    #[inline(always)]
    pub(super) fn push(&mut self, point: Point) {
        let (block, k) = (self.len / BLOCK, self.len % BLOCK);
        if block == self.blocks.len() {
            self.blocks.push(PointBlock::default());
        }
        self.blocks[block].set(k, point);
        self.len += 1;
    }

    /// The camera ray of each point.
    pub(super) fn rays(&self) -> impl Iterator<Item = u32> {
        let rays = self.blocks.iter().flat_map(|block| &block.ray);
        rays.take(self.len).copied()
    }

    /// The blocks, each with the number of its points.
    #[inline(always)]
    pub(super) fn blocks(&self) -> impl Iterator<Item = (&PointBlock, usize)> {
        let counts = (0..self.len).step_by(BLOCK).map(|first| (self.len - first).min(BLOCK));
        self.blocks.iter().zip(counts)
    }
}

/// A block of points.
pub(super) struct PointBlock {
    ray: [u32; BLOCK],
    position: Columns<f64>,
    start: Columns<f32>,
    shading_normal: Columns<f32>,
    matte: Columns<f32>,
    glossy: [u32; BLOCK],
}

impl Default for PointBlock {
    fn default() -> Self {
        Self {
            ray: [0; BLOCK],
            position: Columns::default(),
            start: Columns::default(),
            shading_normal: Columns::default(),
            matte: Columns::default(),
            glossy: [MATTE; BLOCK],
        }
    }
}

impl PointBlock {
    /// Point `k`.
    #[inline(always)]
    pub(super) fn get(&self, k: usize) -> Point {
        Point {
            ray: self.ray[k],
            position: self.position.get(k),
            start: self.start.get(k),
            shading_normal: self.shading_normal.get(k),
            matte: self.matte.get(k),
            glossy: self.glossy[k],
        }
    }

    #[inline(always)]
    fn set(&mut self, k: usize, point: Point) {
        self.ray[k] = point.ray;
        self.position.set(k, point.position);
        self.start.set(k, point.start);
        self.shading_normal.set(k, point.shading_normal);
        self.matte.set(k, point.matte);
        self.glossy[k] = point.glossy;
    }
}

/// What a block of points gets from one light, if nothing is in the way.
pub(super) struct Lit {
    received: LightSamples,
    cos: [f32; BLOCK],
    direction: Columns<f32>,
    t_max: [f32; BLOCK],
}

impl Default for Lit {
    fn default() -> Self {
        Self {
            received: LightSamples::default(),
            cos: [0.0; BLOCK],
            direction: Columns::default(),
            t_max: [0.0; BLOCK],
        }
    }
}

impl Lit {
    /// Asks `light` for the first `count` points; shadow rays leave them on the side of the eye.
    #[inline(always)]
    pub(super) fn ask(&mut self, light: &Light, points: &PointBlock, count: usize) {
        light.sample_all(&points.position, count, &mut self.received);
        for k in 0..BLOCK {
            let sample = self.received.get(k);
            self.cos[k] = points.shading_normal.get(k).dot(sample.incoming);
            let ray = sample.ray_from(points.position.get(k).as_vec3(), points.start.get(k), 0.0);
            self.direction.set(k, ray.direction);
            self.t_max[k] = ray.t_max;
        }
    }

    /// What reaches point `k`, the cosine to its normal, and the shadow ray that leaves it at `start`.
    #[inline(always)]
    pub(super) fn get(&self, k: usize, start: Vec3, t_min: f32) -> (LightSample, f32, Ray) {
        let (direction, t_max) = (self.direction.get(k), self.t_max[k]);
        let ray = Ray { t_min, t_max, ..Ray::new(start, direction) };
        (self.received.get(k), self.cos[k], ray)
    }
}
