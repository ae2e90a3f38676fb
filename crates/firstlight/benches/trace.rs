//! How fast pictures are made of a scene that is made on the spot: 200,000 triangles on a plane, two shadowed lights.
//!
//! `cargo xtask bench` prints the median of five runs for building and rendering, per level and number of threads.

#![allow(clippy::disallowed_methods, reason = "measuring needs the clock")]

use firstlight::render::{RenderOptions, render, with_threads};
use firstlight::scene::Studio;
use firstlight::scene::description::{Light, LightDescription, Material, Mesh, Shape, Surface};
use firstlight::{Level, Scene, SceneDescription};
use glam::{DAffine3, DVec3, Vec3};
use std::f64::consts::{PI, TAU};
use std::ops::ControlFlow;
use std::time::Instant;

const RUNS: usize = 5;

fn main() {
    let scene = scene();
    println!(
        "{:>9} {:>8} {:>10} {:>10} {:>10}",
        "level", "threads", "build s", "render s", "Mray/s"
    );
    for level in Level::all() {
        for threads in [1, 2] {
            let mut build = Vec::new();
            let mut draw = Vec::new();
            let mut rays = 0;
            for _ in 0..RUNS {
                let start = Instant::now();
                let built = with_threads(threads, || Scene::build_for(&scene, level));
                build.push(start.elapsed().as_secs_f64());
                let start = Instant::now();
                let options = RenderOptions { threads, ..RenderOptions::default() };
                let done = render(&built, &options, &|_| ControlFlow::Continue(()));
                draw.push(start.elapsed().as_secs_f64());
                rays = done.rays.total();
            }
            let (build, draw) = (median(build), median(draw));
            let speed = rays as f64 / draw / 1e6;
            println!("{:>9} {threads:>8} {build:>10.3} {draw:>10.3} {speed:>10.1}", level.name());
        }
    }
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

/// A bumpy ball of 200,000 triangles in the studio, under two point lights.
fn scene() -> SceneDescription {
    let mut scene = SceneDescription::default();
    scene.materials.push(Material::matte("ball", Vec3::splat(0.7)));
    scene.meshes.push(bumpy_ball(224).into());
    let transform = DAffine3::IDENTITY;
    scene.surfaces.push(Surface {
        name: "ball".into(),
        shape: Shape::Mesh(0),
        material: 0,
        transform,
    });
    for (x, watts) in [(-4.0, 900.0), (5.0, 500.0)] {
        let intensity = Vec3::splat(watts / (4.0 * std::f32::consts::PI));
        let light = Light::Point { position: DVec3::new(x, -4.0, 5.0), intensity };
        scene.lights.push(LightDescription { name: "light".into(), light, shadows: true });
    }
    Studio::default().dress(&mut scene);
    scene.film.samples = 4;
    scene
}

fn bumpy_ball(rows: u32) -> Mesh {
    let columns = 2 * rows;
    let mut mesh = Mesh::default();
    for row in 0..=rows {
        for column in 0..columns {
            let (theta, phi) = (
                PI * f64::from(row) / f64::from(rows),
                TAU * f64::from(column) / f64::from(columns),
            );
            let r = 1.0 + 0.05 * (23.0 * theta).sin() * (31.0 * phi).cos();
            let p = DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos());
            mesh.positions.push((r * p).as_vec3());
        }
    }
    for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
        let at = |r: u32, c: u32| r * columns + c % columns;
        let (a, b) = (at(row, column), at(row + 1, column));
        let (c, d) = (at(row + 1, column + 1), at(row, column + 1));
        mesh.triangles.extend([[a, b, c], [a, c, d]]);
    }
    mesh
}
