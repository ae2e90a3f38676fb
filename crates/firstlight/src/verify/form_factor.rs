//! How much of what leaves one surface reaches another.

use super::closed_forms::{parallel_rectangles, perpendicular_rectangles, sphere_to_disk};
use super::scenes::*;
use super::{Case, Random, Readings};
use crate::integrator::Meter;
use crate::scene::Scene;
use crate::scene::description::*;
use glam::DVec3;
use std::f64::consts::PI;

pub(super) const CASES: &[Case] = &[
    Case::sampled(
        "F01-ff-parallel-rect",
        "opposed unit squares at several distances",
        "Howell C-11",
        f01,
    ),
    Case::sampled(
        "F02-ff-perp-rect",
        "rectangles at right angles along a common edge",
        "Howell C-14",
        f02,
    ),
    Case::sampled(
        "F04-ff-sphere-disk",
        "the part of what leaves a sphere that reaches a disk on its axis",
        "Howell: solid angle of the disk",
        f04,
    ),
];

/// Mean of a picture that shows exactly a rectangle of reflectance 0.5 in z = 0, over 0.5: its form factor to what
/// shines on it with radiance 1.
fn mean_irradiance(scene: &SceneDescription, width: f64, depth: f64, seed: u64) -> f64 {
    let mut scene = scene.clone();
    add(&mut scene, quad(DVec3::ZERO, v(width, 0.0, 0.0), v(0.0, depth, 0.0)));
    let middle = v(width / 2.0, depth / 2.0, 0.0);
    let view = Projection::Orthographic { height: depth };
    scene.cameras.push(camera(middle + v(0.0, 0.0, 0.1), middle, view));
    let filter = Filter::Box { radius: 0.5 };
    let (pixels_across, height) = ((32.0 * width / depth) as u32, 32);
    scene.film =
        FilmDescription { width: pixels_across, height, samples: 16, filter, ..scene.film };
    mean_of_picture(&scene, seed) / 0.5
}

fn f01(readings: &mut Readings) {
    for distance in [0.5, 1.0, 2.0] {
        let mut scene = scene_for_paths(0.5);
        add_with(&mut scene, panel(v(0.5, 0.5, distance), 1.0, 1.0), 1);
        let expected = parallel_rectangles(1.0, 1.0, distance);
        let measure = |seed| mean_irradiance(&scene, 1.0, 1.0, seed);
        readings.repeated(format!("c={distance}"), measure, expected);
    }
}

fn f02(readings: &mut Readings) {
    for (at, edge, width, height) in [("1x1", 1.0, 1.0, 1.0), ("l2w1h3", 2.0, 1.0, 3.0)] {
        let mut scene = scene_for_paths(0.5);
        add_with(&mut scene, quad(DVec3::ZERO, height * DVec3::Z, edge * DVec3::X), 1);
        let expected = perpendicular_rectangles(edge, width, height);
        readings.repeated(at, |seed| mean_irradiance(&scene, edge, width, seed), expected);
    }
}

/// By reciprocity: what the disk sees of the sphere, over rings of equal area.
fn f04(readings: &mut Readings) {
    for (at, distance) in [("a=1", 1.0), ("a=.5", 0.5)] {
        let (radius, rings) = (0.4, 64);
        let mut scene = scene_for_paths(0.5);
        add_with(&mut scene, ball(v(0.0, 0.0, distance), radius), 1);
        let measure = |seed| {
            scene.film.seed = seed;
            let (scene, mut random) = (Scene::build(&scene), Random::new(seed));
            let meter = Meter::new(&scene).samples(4096);
            let irradiance = |ring: u32| {
                let r = ((f64::from(ring) + random.unit()) / f64::from(rings)).sqrt();
                f64::from(meter.irradiance(v(r, 0.0, 0.0), DVec3::Z).value.x)
            };
            let flux = (0..rings).map(irradiance).sum::<f64>() / f64::from(rings) * PI;
            flux / (PI * 4.0 * PI * radius * radius)
        };
        readings.repeated(at, measure, sphere_to_disk(1.0, distance));
    }
}
