//! The environment asked for many directions at once: what can be worked out for several at a time is, and what has to
//! be fetched from memory is not waited for one by one.

use super::sky::Spot;
use super::table::{Cell, DirectionTable, Picked, direction, place};
use super::{Environment, EnvironmentSample};
use crate::color::Rgb;
use crate::geometry::{Hit, Ray};
use crate::math::{BLOCK, Columns};
use crate::simd::{Kernel, Simd};
use glam::{DVec2, Vec2};

/// [`Environment::sample`] by each of many pairs of numbers.
pub(crate) struct Ask<'a> {
    /// What is asked.
    pub environment: &'a Environment,
    /// The pairs, each number in 0..1.
    pub pairs: &'a [Vec2],
    /// The directions; what was there is replaced. None, if none is to be preferred.
    pub samples: &'a mut Vec<EnvironmentSample>,
}

impl Kernel for Ask<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        let Self { environment, pairs, samples } = self;
        samples.clear();
        let Some(table) = &environment.table else { return };
        let mut block = Block::default();
        for pairs in pairs.chunks(BLOCK) {
            block.pick(table, pairs);
            block.turn_to_world(environment);
            block.find_spots(environment);
            for (k, pdf) in block.pdf[..pairs.len()].iter().enumerate() {
                let radiance = environment.at(block.own.get(k), &block.spots[k]);
                samples.push(EnvironmentSample {
                    incoming: block.world.get(k),
                    radiance,
                    pdf: *pdf,
                });
            }
        }
    }
}

/// [`Environment::radiance()`] and [`Environment::pdf()`] along each ray that hits nothing.
pub(crate) struct Meet<'a> {
    /// What is behind everything.
    pub environment: &'a Environment,
    /// The rays.
    pub rays: &'a [Ray],
    /// What they hit.
    pub hits: &'a [Hit],
    /// Radiance (W·sr⁻¹·m⁻²) and density (sr⁻¹) for those that hit nothing; what was there is replaced.
    pub met: &'a mut Vec<(Rgb, f32)>,
}

impl Kernel for Meet<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        let Self { environment, rays, hits, met } = self;
        met.clear();
        let (mut block, mut next) = (Block::default(), 0);
        while next < rays.len() {
            let mut count = 0;
            while next < rays.len() && count < BLOCK {
                block.world.set(count, rays[next].direction);
                count += usize::from(!hits[next].is_some());
                next += 1;
            }
            block.meet(environment, count, met);
        }
    }
}

/// A block of directions.
struct Block {
    /// In the world, and in the sky's own space.
    world: Columns<f32>,
    own: Columns<f32>,
    /// Their [`place`].
    right: [f64; BLOCK],
    down: [f64; BLOCK],
    /// Height above the horizon of those that were picked.
    z: [f64; BLOCK],
    /// Density of those that were picked, sr⁻¹.
    pdf: [f32; BLOCK],
    /// Where to look in the sky's picture, and in its table.
    spots: [Spot; BLOCK],
    cells: [Cell; BLOCK],
}

impl Default for Block {
    #[inline(always)]
    fn default() -> Self {
        let [world, own] = [Columns::default(), Columns::default()];
        let [right, down, z] = [[0.0; BLOCK]; 3];
        let (spots, cells) = ([Spot::default(); BLOCK], [Cell::default(); BLOCK]);
        Self { world, own, right, down, z, pdf: [0.0; BLOCK], spots, cells }
    }
}

impl Block {
    #[inline(always)]
    fn place(&self, k: usize) -> DVec2 {
        DVec2::new(self.right[k], self.down[k])
    }

    /// Picks directions by up to as many pairs of numbers as there are rows.
    #[inline(always)]
    fn pick(&mut self, table: &DirectionTable, pairs: &[Vec2]) {
        for (k, u) in pairs.iter().enumerate() {
            let Picked { around, z, pdf } = table.pick(u.as_dvec2());
            (self.right[k], self.z[k], self.pdf[k]) = (around, z, pdf as f32);
        }
    }

    /// From where they lie in the sky to where that is in the world.
    #[inline(always)]
    fn turn_to_world(&mut self, environment: &Environment) {
        let to_world = environment.to_sky.transpose();
        for k in 0..BLOCK {
            let own = direction(self.right[k], self.z[k]);
            (self.right[k], self.down[k]) = place(own).into();
            self.own.set(k, own.as_vec3());
            self.world.set(k, to_world * own.as_vec3());
        }
    }

    /// From where they lie in the world to where that is in the sky.
    #[inline(always)]
    fn turn_to_sky(&mut self, environment: &Environment) {
        for k in 0..BLOCK {
            let own = environment.to_sky * self.world.get(k);
            (self.right[k], self.down[k]) = place(own.as_dvec3()).into();
            self.own.set(k, own);
        }
    }

    /// Finds where to look for what comes from there.
    #[inline(always)]
    fn find_spots(&mut self, environment: &Environment) {
        for k in 0..BLOCK {
            self.spots[k] = environment.radiance.spot(self.place(k));
        }
    }

    /// What comes from the first `count` of the directions in the world.
    #[inline(always)]
    fn meet(&mut self, environment: &Environment, count: usize, met: &mut Vec<(Rgb, f32)>) {
        if count == 0 {
            return;
        }
        self.turn_to_sky(environment);
        for k in 0..BLOCK {
            self.cells[k] = environment.cell(self.place(k));
        }
        self.find_spots(environment);
        for k in 0..count {
            let radiance = environment.at(self.own.get(k), &self.spots[k]);
            met.push((radiance, environment.density(self.cells[k])));
        }
    }
}
