//! A whole picture: passes over tiles over threads.

use crate::color::luminance;
use crate::film::{Film, FilterSampler, Half, Noise, Sample, Spread, Tile};
use crate::geometry::Ray;
use crate::image::Image;
use crate::integrator::{FILM, Gatherer, LENS, RayCounts, Record, Recorder, TIME};
use crate::layers::{LightLayers, LightTile, Taken};
use crate::sampler::{Pairs, PathPoints, Sampler};
use crate::scene::Scene;
use crate::scene::description::FilmDescription;
use crate::simd::{Kernel, Simd};
use glam::Vec2;
use rayon::prelude::*;
use std::ops::{ControlFlow, Range};
use std::sync::Mutex;

mod guides;

pub use guides::render_guides;

/// What to render and with what.
#[derive(Debug, Clone, Copy, Default)]
pub struct RenderOptions {
    /// Worker threads; 0: one per processor. The picture does not depend on it.
    pub threads: usize,
    /// Only this rectangle of the picture.
    pub crop: Option<Crop>,
    /// Only these of the film's samples of each pixel: from the first up to, not including, the second.
    pub samples: Option<[u32; 2]>,
    /// Take samples until told to stop, and not as many as the film says; after the first few, more of them where there is
    /// more noise. The noise is then known without bias, by two halves that know nothing of each other. Negative lobes of
    /// filters are left out.
    pub endless: bool,
    /// Stop when the relative noise of the picture ([`Noise::relative`]) is down to this; it needs `endless`.
    pub noise: Option<f64>,
}

/// How a render is to end before all is done.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stop {
    /// At once: some pixels get more samples than others.
    Now,
    /// When every pixel has the samples that it is to have so far: as many as the others, unless there is no end.
    AfterPass,
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
    /// Samples that pixels have got so far, in the mean.
    pub samples: u32,
    /// Whether this is the end of a pass over the picture.
    pub whole: bool,
}

/// A picture, and what is to be said about it.
#[derive(Debug, Clone)]
pub struct Rendered {
    /// Linear radiance; transparent where no sample was taken.
    pub image: Image,
    /// Samples per pixel: those that every pixel got, or the mean if there is no end.
    pub samples: u32,
    /// How many samples the pixels have that have the fewest and the most.
    pub spread: Spread,
    /// Whether it was stopped before all samples were taken and before it was good enough.
    pub interrupted: bool,
    /// The part of all light that the film's clamping has left out, 0..1.
    pub clamped: f64,
    /// How noisy it is; `None` if there are too few samples to tell.
    pub noise: Option<Noise>,
    /// The sums that the picture is made of.
    pub film: Film,
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

impl Rendered {
    /// A picture of sums that were made before, with so many samples of each pixel. What its rays met is not known.
    pub fn of_film(film: Film, samples: u32) -> Self {
        Self {
            image: film.image(),
            samples,
            spread: Spread { fewest: samples, mean: samples.into(), most: samples },
            interrupted: false,
            clamped: film.clamped(),
            noise: film.noise(),
            film,
            rays: RayCounts::default(),
            surface_rays: 0,
            brightest: 0.0,
            dropped: 0,
            first_dropped: None,
        }
    }
}

/// Samples per pixel in one pass over the picture.
pub const PASS: u32 = 4;
/// Samples per pixel before its noise is judged: fewer may have missed what is rare.
const FEWEST_TO_JUDGE: u32 = 16;
/// Samples of each half of an endless render, at most: a power of two.
const HALF: u32 = FilmDescription::MOST_SAMPLES / 2;

/// Renders the picture that the scene's film asks for. `observe` is called after each tile, from any thread, and
/// may break off; the picture then holds what was done.
pub fn render(
    scene: &Scene,
    options: &RenderOptions,
    observe: &(dyn Fn(Progress) -> ControlFlow<Stop> + Sync),
) -> Rendered {
    with_threads(options.threads, || Render::new(scene, options, observe).run::<()>().0)
}

/// The same, with the light of each source kept apart.
pub fn render_layers(
    scene: &Scene,
    options: &RenderOptions,
    observe: &(dyn Fn(Progress) -> ControlFlow<Stop> + Sync),
) -> (Rendered, LightLayers) {
    let render = Render::new(scene, options, observe);
    let (rendered, tiles) = with_threads(options.threads, || render.run());
    let layers = LightLayers::new(scene, render.origin, render.size, tiles);
    (rendered, layers)
}

/// Does `work`, such as building a scene, with so many worker threads; 0: one per processor.
pub fn with_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    match rayon::ThreadPoolBuilder::new().num_threads(threads).build() {
        Ok(pool) => pool.install(work),
        // The system refuses threads: do the work on this one and on whatever rayon has.
        Err(_) => work(),
    }
}

/// Some samples of one pixel, and all that happened to them.
pub(crate) struct Replayed<'a> {
    /// Their numbers in the picture.
    pub samples: Range<u32>,
    /// The weight of each under the filter; 0 if it was dropped.
    pub weights: &'a [f32],
    /// What happened.
    pub record: &'a Record,
}

/// Takes these samples of the pixel in column `x`, row `y` as [`render`] does, and shows them to `observe`, a pass at a
/// time. Returns the pixel's linear RGBA.
pub(crate) fn replay(
    scene: &Scene,
    [x, y]: [u32; 2],
    samples: Range<u32>,
    mut observe: impl FnMut(Replayed<'_>),
) -> [f32; 4] {
    let crop = Some(Crop { x, y, width: 1, height: 1 });
    let options = RenderOptions { crop, ..RenderOptions::default() };
    let render = Render::new(scene, &options, &|_| ControlFlow::Continue(()));
    let (mut film, mut worker) = (Film::new(render.origin, render.size), Worker::default());
    let mut record = Record::default();
    for first in samples.clone().step_by(PASS as usize) {
        let samples = first..samples.end.min(first + PASS);
        record.clear();
        for tile in film.tiles_mut() {
            let (samples, worker, recorder) = (samples.clone(), &mut worker, &mut record);
            take_recorded(TilePass {
                render: &render,
                tile,
                samples,
                half: None,
                worker,
                recorder,
            });
        }
        observe(Replayed { samples, weights: &worker.weights, record: &record });
    }
    film.image().pixels()[0]
}

struct Render<'a> {
    scene: &'a Scene,
    options: RenderOptions,
    filter: FilterSampler,
    sampler: Sampler,
    /// From the first sample of each pixel up to, not including, the last.
    samples: [u32; 2],
    origin: [u32; 2],
    size: [u32; 2],
    observe: &'a (dyn Fn(Progress) -> ControlFlow<Stop> + Sync),
    tally: Mutex<Tally>,
    /// Which half decides how many samples another gets.
    judge: fn(Half) -> Half,
}

/// What workers report.
#[derive(Default)]
struct Tally {
    rays: RayCounts,
    tiles: u64,
    /// Samples of all pixels.
    samples: u64,
    stop: Option<Stop>,
    surface_rays: u64,
    brightest: f32,
    dropped: u64,
    first_dropped: Option<[u32; 2]>,
}

impl<'a> Render<'a> {
    fn new(
        scene: &'a Scene,
        options: &RenderOptions,
        observe: &'a (dyn Fn(Progress) -> ControlFlow<Stop> + Sync),
    ) -> Self {
        let film = scene.film();
        let whole = Crop { x: 0, y: 0, width: film.width, height: film.height };
        let crop = options.crop.unwrap_or(whole);
        let [for_filter, for_sampler, most] = match options.endless {
            true => [1, HALF, 2 * HALF],
            false => [film.samples; 3],
        };
        Self {
            scene,
            options: *options,
            filter: FilterSampler::new(&film.filter, for_filter),
            sampler: Sampler::new(film.seed, for_sampler),
            samples: options.samples.unwrap_or([0, most]),
            origin: [crop.x, crop.y],
            size: [crop.width, crop.height],
            observe,
            tally: Mutex::default(),
            judge: Half::other,
        }
    }

    fn run<K: Keeper>(&self) -> (Rendered, Vec<K>) {
        let mut film = self.empty_film::<K>();
        let mut keepers: Vec<K> =
            film.tiles_mut().iter().map(|tile| K::of(self.scene, tile)).collect();
        let [first, end] = self.samples;
        let (mut next, mut judged_at, mut good) = (first, FEWEST_TO_JUDGE, false);
        while next < end && !good && self.tally().stop.is_none() {
            let pass = next..end.min(next + PASS);
            self.pass(&mut film, &mut keepers, pass.clone());
            if self.tally().stop != Some(Stop::Now) || self.passes_done() {
                next = pass.end;
            }
            if let Some(target) = self.options.noise.filter(|_| next >= judged_at) {
                let noise = film.noise().map_or(f64::INFINITY, |noise| noise.relative);
                good = noise <= target;
                judged_at = judge_again(next, noise / target);
            }
        }
        let (tally, spread) = (self.tally(), film.spread());
        let samples = if self.options.endless { spread.mean.round() as u32 } else { next - first };
        let rendered = Rendered {
            spread,
            interrupted: next < end && !good && tally.stop != Some(Stop::AfterPass),
            rays: tally.rays,
            surface_rays: tally.surface_rays,
            brightest: tally.brightest,
            dropped: tally.dropped,
            first_dropped: tally.first_dropped,
            ..Rendered::of_film(film, samples)
        };
        drop(tally);
        (rendered, keepers)
    }

    fn empty_film<K: Keeper>(&self) -> Film {
        let new = if self.options.endless && K::AIMS { Film::in_halves } else { Film::new };
        new(self.origin, self.size)
    }

    /// Takes samples of every pixel: these, or, without end, as many as each tile is to have by then in one of the halves,
    /// which take turns.
    fn pass<K: Keeper>(&self, film: &mut Film, keepers: &mut [K], samples: Range<u32>) {
        let (number, mut even, mut half) = (samples.start / PASS, samples, None);
        if self.options.endless {
            half = Some(if number.is_multiple_of(2) { Half::First } else { Half::Second });
            even = number / 2 * PASS..(number / 2 + 1) * PASS;
        }
        let aiming = half.filter(|_| film.is_in_halves());
        let passes = aiming.map(|half| film.passes((self.judge)(half), number / 2 + 1));
        let tiles = film.tiles_mut().par_iter_mut().zip(keepers).enumerate();
        tiles.for_each_init(Worker::default, |worker, (i, (tile, keeper))| {
            let samples = match (aiming, &passes) {
                (Some(half), Some(passes)) => tile.next_samples(half, passes[i], PASS, HALF),
                _ => even.clone(),
            };
            self.fill(worker, tile, keeper, samples, half);
        });
    }

    /// Takes samples of every pixel of a tile.
    fn fill<K: Keeper>(
        &self,
        worker: &mut Worker,
        tile: &mut Tile,
        keeper: &mut K,
        samples: Range<u32>,
        half: Option<Half>,
    ) {
        let pixels = tile.pixels.len() as u64;
        let mut taken = 0;
        for start in samples.clone().step_by(PASS as usize) {
            if self.tally().stop == Some(Stop::Now) {
                return;
            }
            let samples = start..samples.end.min(start + PASS);
            taken += pixels * samples.len() as u64;
            keeper.take(TilePass { render: self, tile, samples, half, worker, recorder: &mut () });
        }
        self.report(worker, taken);
    }

    /// Which of the sampler's points a sample has, and which half it belongs to. Halves that take turns are two sequences
    /// that know nothing of each other.
    #[inline(always)]
    fn point(&self, sample: u32, half: Option<Half>) -> (u32, Half) {
        match half {
            None if sample < self.scene.film().samples.div_ceil(2) => (sample, Half::First),
            None => (sample, Half::Second),
            Some(Half::First) => (sample, Half::First),
            Some(Half::Second) => (HALF + sample, Half::Second),
        }
    }

    /// Makes the first rays of these samples of every pixel of a tile, with their weights under the filter.
    #[inline(always)]
    fn aim(&self, worker: &mut Worker, tile: &Tile, samples: Range<u32>, half: Option<Half>) {
        let (camera, level) = (self.scene.camera(), self.scene.level());
        let Worker { pixels, points, film_points, lens_points, times, rays, weights, .. } = worker;
        pixels.clear();
        points.clear();
        for index in tile.order() {
            let [x, y] = tile.place(index);
            for (point, half) in samples.clone().map(|sample| self.point(sample, half)) {
                pixels.push((index, half));
                points.push(self.sampler.points(x, y, point));
            }
        }
        level.run(Pairs { paths: points, number: FILM, pairs: film_points });
        if camera.has_lens() {
            level.run(Pairs { paths: points, number: LENS, pairs: lens_points });
        }
        if self.scene.moves() {
            level.run(Pairs { paths: points, number: TIME, pairs: times });
        }
        weights.clear();
        let count = samples.len();
        for (film_points, pixels) in film_points.chunks_mut(count).zip(pixels.chunks(count)) {
            let center = Vec2::from(tile.place(pixels[0].0).map(|place| place as f32 + 0.5));
            for point in film_points {
                let (shift, weight) = self.filter.place(*point);
                *point = center + shift;
                weights.push(weight);
            }
        }
        camera.rays(film_points, lens_points, times, rays);
    }

    /// Tiles of one pass.
    fn tiles_per_pass(&self) -> u64 {
        self.size.map(|side| u64::from(side.div_ceil(Tile::SIDE))).into_iter().product()
    }

    /// Whether no pass is half done.
    fn passes_done(&self) -> bool {
        self.tally().tiles.is_multiple_of(self.tiles_per_pass())
    }

    fn progress(&self, tally: &Tally) -> Progress {
        let [first, end] = self.samples;
        let per_pass = self.tiles_per_pass();
        let passes = u64::from((end - first).div_ceil(PASS));
        let pixels = self.size.map(u64::from).into_iter().product::<u64>();
        let samples = tally.samples / pixels;
        Progress {
            done: tally.tiles as f64 / (passes * per_pass) as f64,
            rays: tally.rays,
            samples: samples.min(u64::from(end - first)) as u32,
            whole: tally.tiles.is_multiple_of(per_pass),
        }
    }

    /// After `taken` more samples of a tile.
    fn report(&self, worker: &mut Worker, taken: u64) {
        let mut tally = self.tally();
        tally.tiles += 1;
        tally.samples += taken;
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
        let progress = self.progress(&tally);
        drop(tally);
        if let ControlFlow::Break(stop) = (self.observe)(progress) {
            let mut tally = self.tally();
            // What has to end at once does, whatever else was asked.
            tally.stop = tally.stop.filter(|earlier| *earlier == Stop::Now).or(Some(stop));
        }
    }

    fn tally(&self) -> std::sync::MutexGuard<'_, Tally> {
        self.tally.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}

/// The number of samples after which to judge the noise again: as many as it takes if the error falls as slowly as
/// chance lets it, and at most half as many again, for it may have been overestimated, or go down faster.
fn judge_again(samples: u32, above: f64) -> u32 {
    let needed = f64::from(samples) * above * above;
    let next = needed.clamp(f64::from(samples + 2 * PASS), 1.5 * f64::from(samples));
    (next as u32).next_multiple_of(2 * PASS)
}

/// Takes samples of a tile, and keeps what it wants to know of them besides their sums.
trait Keeper: Send {
    /// For a tile that has no samples yet.
    fn of(scene: &Scene, tile: &Tile) -> Self;

    /// Whether samples may go where the noise is. What is kept is one mean of all samples, which has to be the picture's.
    const AIMS: bool;

    /// Takes the samples.
    fn take(&mut self, pass: TilePass<'_, '_, ()>);
}

/// Keeps nothing.
impl Keeper for () {
    const AIMS: bool = true;

    fn of(_: &Scene, _: &Tile) {}

    fn take(&mut self, pass: TilePass<'_, '_, ()>) {
        pass.render.scene.level().run(pass);
    }
}

impl Keeper for LightTile {
    const AIMS: bool = false;

    fn of(scene: &Scene, tile: &Tile) -> Self {
        Self::new(scene, tile.pixels.len())
    }

    fn take(&mut self, pass: TilePass<'_, '_, ()>) {
        let TilePass { render, tile, samples, half, worker, .. } = pass;
        let mut record = Record::default();
        let recorder = &mut record;
        take_recorded(TilePass { render, tile, samples, half, worker: &mut *worker, recorder });
        let pixels = worker.pixels.iter().map(|&(pixel, _)| pixel);
        let samples: Vec<Taken> = pixels
            .zip(&worker.weights)
            .zip(worker.gatherer.samples(render.scene))
            .map(|((pixel, &weight), sample)| Taken { pixel, weight, sample: *sample })
            .collect();
        self.add(render.scene, &samples, &record);
    }
}

/// Takes samples and records all that happens, with instructions that every processor has: to compile all stages for this
/// once more at each level would not pay.
fn take_recorded(pass: TilePass<'_, '_, Record>) {
    pass.take();
}

/// One pass over one tile, with all its stages compiled for the processor's level.
struct TilePass<'a, 'r, R> {
    render: &'a Render<'r>,
    tile: &'a mut Tile,
    samples: Range<u32>,
    /// The half of the picture that they belong to, where halves take turns.
    half: Option<Half>,
    worker: &'a mut Worker,
    recorder: &'a mut R,
}

impl<R: Recorder> Kernel for TilePass<'_, '_, R> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        self.take();
    }
}

impl<R: Recorder> TilePass<'_, '_, R> {
    /// Takes the samples of every pixel of the tile.
    #[inline(always)]
    fn take(self) {
        let Self { render, tile, samples, half, worker, recorder } = self;
        render.aim(worker, tile, samples.clone(), half);
        let (film, count) = (render.scene.film(), samples.len());
        let Worker { pixels, points, rays, weights, lost, gatherer, dropped, .. } = worker;
        let samples = gatherer.gather(render.scene, film.transparent, rays, points, recorder);
        lost.clear();
        tile.add(samples, pixels, weights, |sample| lost.push(sample));
        for &mut sample in lost {
            dropped.get_or_insert((tile.place(pixels[sample].0), 0)).1 += 1;
            weights[sample] = 0.0;
        }
        let clamped = |(sample, weight): (&Sample, &f32)| f64::from(sample.clamped * weight);
        tile.clamped += samples.iter().zip(&*weights).map(clamped).sum::<f64>();
        tile.samples += count as u32;
        if let Some(half) = half.filter(|_| tile.is_in_halves()) {
            for (samples, pixels) in samples.chunks(count).zip(pixels.chunks(count)) {
                let luminances = samples.iter().map(|sample| f64::from(luminance(sample.radiance)));
                let square = tile.square(pixels[0].0);
                tile.watches[half as usize].note(square, luminances);
            }
            tile.watches[half as usize].end_pass();
        }
    }
}

/// What one thread keeps from tile to tile.
#[derive(Default)]
struct Worker {
    /// Index of each path's pixel in the tile, and the half of its samples that the path belongs to.
    pixels: Vec<(usize, Half)>,
    /// What decides about each path.
    points: Vec<PathPoints>,
    /// Where each path crosses the film, first by its pair of numbers in 0..1, then in pixels.
    film_points: Vec<Vec2>,
    /// Where it crosses the lens if that matters, by its pair of numbers.
    lens_points: Vec<Vec2>,
    /// When it is if anything moves, by the first of its pair of numbers.
    times: Vec<Vec2>,
    /// Each path's first ray and its weight under the filter, 0 if its sample was dropped.
    rays: Vec<Ray>,
    weights: Vec<f32>,
    /// The numbers of samples that are not finite.
    lost: Vec<usize>,
    gatherer: Gatherer,
    /// First pixel with a dropped sample, and how many were dropped.
    dropped: Option<([u32; 2], u64)>,
}

#[cfg(test)]
mod tests;
