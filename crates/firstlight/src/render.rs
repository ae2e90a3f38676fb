//! A whole picture: passes over tiles over threads.

use crate::film::{FilterSampler, Tile, assemble};
use crate::geometry::Ray;
use crate::image::Image;
use crate::integrator::{FILM, Gatherer, LENS, RayCounts};
use crate::sampler::{PathPoints, Sampler, pairs};
use crate::scene::Scene;
use crate::simd::{Kernel, Simd};
use glam::Vec2;
use rayon::prelude::*;
use std::ops::ControlFlow;
use std::sync::Mutex;

/// What to render and with what.
#[derive(Debug, Clone, Copy, Default)]
pub struct RenderOptions {
    /// Worker threads; 0: one per processor. The picture does not depend on it.
    pub threads: usize,
    /// Only this rectangle of the picture.
    pub crop: Option<Crop>,
}

/// A rectangle of pixels. It must lie inside the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Crop {
    /// Column of its left edge.
    pub x: u32,
    /// Row of its upper edge.
    pub y: u32,
    /// Its width, ≥ 1.
    pub width: u32,
    /// Its height, ≥ 1.
    pub height: u32,
}

/// How far a render has come.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Part of the work that is done, 0..1.
    pub done: f64,
    /// Rays traced so far.
    pub rays: RayCounts,
}

/// A picture, and what is to be said about it.
#[derive(Debug, Clone)]
pub struct Rendered {
    /// Linear radiance; transparent where no sample was taken.
    pub image: Image,
    /// Samples per pixel that every pixel got.
    pub samples: u32,
    /// Whether it was stopped before all samples were taken.
    pub interrupted: bool,
    /// Rays traced.
    pub rays: RayCounts,
    /// Camera rays that met a surface.
    pub surface_rays: u64,
    /// The largest radiance of any channel that came from a surface, W·sr⁻¹·m⁻²; 0 if all are black.
    pub brightest: f32,
    /// Samples that were dropped because they were not finite.
    pub dropped: u64,
    /// Column and row of the first pixel (in tile order) with a dropped sample.
    pub first_dropped: Option<[u32; 2]>,
}

/// Samples per pixel in one pass over the picture.
const PASS: u32 = 4;

/// Renders the picture that the scene's film asks for. `observe` is called after each tile, from any thread, and
/// may break off; the picture then holds what was done.
pub fn render(
    scene: &Scene,
    options: &RenderOptions,
    observe: &(dyn Fn(Progress) -> ControlFlow<()> + Sync),
) -> Rendered {
    with_threads(options.threads, || Render::new(scene, options, observe).run())
}

/// Does `work`, such as building a scene, with so many worker threads; 0: one per processor.
pub fn with_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    match rayon::ThreadPoolBuilder::new().num_threads(threads).build() {
        Ok(pool) => pool.install(work),
        // The system refuses threads: do the work on this one and on whatever rayon has.
        Err(_) => work(),
    }
}

struct Render<'a> {
    scene: &'a Scene,
    filter: FilterSampler,
    origin: [u32; 2],
    size: [u32; 2],
    observe: &'a (dyn Fn(Progress) -> ControlFlow<()> + Sync),
    tally: Mutex<Tally>,
}

/// What workers report.
#[derive(Default)]
struct Tally {
    rays: RayCounts,
    tiles: u64,
    stop: bool,
    surface_rays: u64,
    brightest: f32,
    dropped: u64,
    first_dropped: Option<[u32; 2]>,
}

impl<'a> Render<'a> {
    fn new(
        scene: &'a Scene,
        options: &RenderOptions,
        observe: &'a (dyn Fn(Progress) -> ControlFlow<()> + Sync),
    ) -> Self {
        let film = scene.film();
        let whole = Crop { x: 0, y: 0, width: film.width, height: film.height };
        let crop = options.crop.unwrap_or(whole);
        Self {
            scene,
            filter: FilterSampler::new(&film.filter, film.samples),
            origin: [crop.x, crop.y],
            size: [crop.width, crop.height],
            observe,
            tally: Mutex::default(),
        }
    }

    fn run(&self) -> Rendered {
        let mut tiles = Tile::cut(self.origin, self.size);
        let samples = self.scene.film().samples;
        let mut complete = 0;
        while complete < samples && !self.tally().stop {
            let pass = complete..samples.min(complete + PASS);
            let work = tiles.len() as u64 * u64::from(samples.div_ceil(PASS));
            tiles.par_iter_mut().for_each_init(Worker::default, |worker, tile| {
                if !self.tally().stop {
                    let level = self.scene.level();
                    level.run(TilePass { render: self, tile, samples: pass.clone(), worker });
                    self.report(worker, work);
                }
            });
            if !self.tally().stop || self.tally().tiles == work {
                complete = pass.end;
            }
        }
        let tally = self.tally();
        Rendered {
            image: assemble(&tiles, self.origin, self.size),
            samples: complete,
            interrupted: complete < samples,
            rays: tally.rays,
            surface_rays: tally.surface_rays,
            brightest: tally.brightest,
            dropped: tally.dropped,
            first_dropped: tally.first_dropped,
        }
    }

    fn report(&self, worker: &mut Worker, work: u64) {
        let mut tally = self.tally();
        tally.tiles += 1;
        tally.rays += worker.gatherer.take_counts();
        let (surface_rays, brightest) = worker.gatherer.seen(self.scene);
        tally.surface_rays += surface_rays;
        tally.brightest = tally.brightest.max(brightest);
        if let Some((place, count)) = worker.dropped.take() {
            tally.dropped += count;
            let order = |[x, y]: [u32; 2]| (y, x);
            let first = tally
                .first_dropped
                .map_or(place, |p| if order(place) < order(p) { place } else { p });
            tally.first_dropped = Some(first);
        }
        let progress = Progress { done: tally.tiles as f64 / work as f64, rays: tally.rays };
        drop(tally);
        if (self.observe)(progress).is_break() {
            self.tally().stop = true;
        }
    }

    fn tally(&self) -> std::sync::MutexGuard<'_, Tally> {
        self.tally.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}

/// One pass over one tile, with all its stages compiled for the processor's level.
struct TilePass<'a> {
    render: &'a Render<'a>,
    tile: &'a mut Tile,
    samples: std::ops::Range<u32>,
    worker: &'a mut Worker,
}

impl Kernel for TilePass<'_> {
    type Output = ();

    /// Adds the samples to every pixel of the tile.
    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        let Self { render, tile, samples, worker } = self;
        let (camera, film) = (render.scene.camera(), render.scene.film());
        let sampler = Sampler::new(film.seed, film.samples);
        let Worker { pixels, points, film_points, lens_points, rays, weights, .. } = worker;
        pixels.clear();
        points.clear();
        for index in tile.order() {
            let [x, y] = tile.place(index);
            pixels.extend(samples.clone().map(|_| index));
            points.extend(samples.clone().map(|sample| sampler.points(x, y, sample)));
        }
        pairs(points, FILM, film_points);
        if camera.has_lens() {
            pairs(points, LENS, lens_points);
        }
        rays.clear();
        weights.clear();
        for (i, (&pixel, &film_point)) in pixels.iter().zip(&*film_points).enumerate() {
            let [x, y] = tile.place(pixel);
            let (shift, weight) = render.filter.place(film_point);
            let place = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) + shift;
            rays.push(camera.ray(place, lens_points.get(i).copied().unwrap_or_default()));
            weights.push(weight);
        }
        let samples = worker.gatherer.gather(render.scene, film.transparent, rays, points);
        for ((sample, &pixel), &weight) in samples.iter().zip(&*pixels).zip(&*weights) {
            if !tile.pixels[pixel].add(sample, weight) {
                worker.dropped.get_or_insert((tile.place(pixel), 0)).1 += 1;
            }
        }
    }
}

/// What one thread keeps from tile to tile.
#[derive(Default)]
struct Worker {
    /// Index of each path's pixel in the tile.
    pixels: Vec<usize>,
    /// What decides about each path.
    points: Vec<PathPoints>,
    /// Where each path crosses the film, and the lens if that matters: pairs of numbers in 0..1.
    film_points: Vec<Vec2>,
    lens_points: Vec<Vec2>,
    /// Each path's first ray and its weight under the filter.
    rays: Vec<Ray>,
    weights: Vec<f32>,
    gatherer: Gatherer,
    /// First pixel with a dropped sample, and how many were dropped.
    dropped: Option<([u32; 2], u64)>,
}
