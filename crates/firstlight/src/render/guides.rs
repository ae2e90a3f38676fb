//! What a picture's first rays meet, for denoisers.

use super::{Crop, Render, RenderOptions, Worker, with_threads};
use crate::film::{Tile, in_rows};
use crate::layers::{Guides, meet};
use crate::scene::{Scene, Solid};
use glam::Vec3;
use rayon::prelude::*;
use std::ops::ControlFlow;

/// Samples of each pixel, if the picture has as many: edges, lenses and motions are blurred as in it, and what noise that
/// leaves is for the denoiser.
const SAMPLES: u32 = 16;

/// Looks at the albedo and the normal of the surfaces that the scene's camera sees, through the first samples of each of
/// the picture's pixels. What mirrors and what is clear is seen itself, fog is not seen. It takes no light and so little time.
pub fn render_guides(scene: &Scene, threads: usize, crop: Option<Crop>) -> Guides {
    let options = RenderOptions { threads, crop, ..RenderOptions::default() };
    let render = Render::new(scene, &options, &|_| ControlFlow::Continue(()));
    let tiles = Tile::cut(render.origin, render.size);
    let see = |worker: &mut Worker, tile: Tile| see(&render, &tile, worker);
    let tiles: Vec<_> =
        with_threads(threads, || tiles.into_par_iter().map_init(Worker::default, see).collect());
    let seen = in_rows(render.origin, render.size, tiles);
    let of = |seen: fn(&Seen) -> Vec3, pixels: &[Seen]| {
        pixels.iter().map(|pixel| seen(pixel).to_array()).collect()
    };
    Guides { albedo: of(|seen| seen.albedo, &seen), normal: of(|seen| seen.normal, &seen) }
}

/// What is seen in one pixel, weighted by its filter.
#[derive(Debug, Clone, Copy, Default)]
struct Seen {
    albedo: Vec3,
    normal: Vec3,
    weight: f32,
}

impl Seen {
    /// The mean. Filters with negative lobes may overshoot.
    fn mean(self) -> Self {
        let Self { albedo, normal, weight } = self;
        let scale = if weight > 0.0 { weight.recip() } else { 0.0 };
        Self {
            albedo: (scale * albedo).clamp(Vec3::ZERO, Vec3::ONE),
            normal: (scale * normal).clamp_length_max(1.0),
            weight,
        }
    }
}

/// What is seen in each pixel of a tile.
fn see(render: &Render<'_>, tile: &Tile, worker: &mut Worker) -> Vec<Seen> {
    let (scene, samples) = (render.scene, render.scene.film().samples.min(SAMPLES));
    render.aim(worker, tile, 0..samples, None);
    let Worker { pixels, rays, weights, .. } = worker;
    let mut hits = Vec::new();
    scene.world.closest_hits(rays, &Solid(scene), &mut hits);
    let mut seen = vec![Seen::default(); tile.pixels.len()];
    let samples = pixels.iter().zip(&*weights).zip(rays.iter().zip(&hits));
    for ((&(index, _), &weight), (ray, hit)) in samples {
        seen[index].weight += weight;
        if hit.is_some() {
            let (_, frame, albedo) = meet(scene, ray, hit);
            seen[index].albedo += weight * albedo;
            seen[index].normal += weight * frame.normal();
        }
    }
    seen.into_iter().map(Seen::mean).collect()
}
