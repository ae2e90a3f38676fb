//! How fast pictures are made of a scene that is made on the spot: 200,000 triangles on a plane, two shadowed lights.

use crate::meshes::bumpy_ball;
use crate::race::median;
use crate::recipe::description;
use crate::report::{print_head, print_row};
use firstlight::render::{RenderOptions, render, with_threads};
use firstlight::scene::Studio;
use firstlight::scene::description::{Light, LightDescription, Up};
use firstlight::{BuildQuality, Level, Scene, SceneDescription};
use glam::{DVec3, Vec3};
use std::f32::consts::PI;
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

const RUNS: usize = 5;

/// Prints the median of five runs for building and rendering, per level and number of threads.
pub(crate) fn run() {
    let scene = scene();
    print_head(&["level", "threads", "building, s", "rendering, s", "Mray/s"].map(String::from));
    for level in Level::all() {
        for threads in [1, 2] {
            let runs: Vec<_> =
                (0..RUNS).map(|_| build_and_render(&scene, level, threads)).collect();
            let build = median(&runs.iter().map(|run| run.0).collect::<Vec<_>>()).as_secs_f64();
            let draw = median(&runs.iter().map(|run| run.1).collect::<Vec<_>>()).as_secs_f64();
            let speed = format!("{:.1}", runs[0].2 as f64 / draw / 1e6);
            let seconds = [build, draw].map(|seconds| format!("{seconds:.3}"));
            let [build, draw] = seconds;
            print_row(&[level.name().into(), threads.to_string(), build, draw, speed]);
        }
    }
}

/// How long building and rendering take, and how many rays were traced.
fn build_and_render(
    scene: &SceneDescription,
    level: Level,
    threads: usize,
) -> (Duration, Duration, u64) {
    let start = Instant::now();
    let built = with_threads(threads, || Scene::build_with(scene, level, BuildQuality::Final));
    let build = start.elapsed();
    let start = Instant::now();
    let options = RenderOptions { threads, ..RenderOptions::default() };
    let done = render(&built, &options, &|_| ControlFlow::Continue(()));
    (build, start.elapsed(), done.rays.camera + done.rays.shadow)
}

/// A bumpy ball in the studio, under two point lights.
fn scene() -> SceneDescription {
    let mut scene = description(bumpy_ball(200_000));
    scene.cameras.clear();
    scene.up = Up(DVec3::Y);
    for (x, watts) in [(-4.0, 900.0), (5.0, 500.0)] {
        let intensity = Vec3::splat(watts / (4.0 * PI));
        let light = Light::Point { position: DVec3::new(x, 5.0, 4.0), intensity };
        scene.lights.push(LightDescription { name: "light".into(), light, shadows: true });
    }
    Studio { up: DVec3::Y, ..Studio::default() }.dress(&mut scene);
    scene.film.samples = 4;
    scene
}
