//! Light between surfaces: radiosity in closed form, and mirrors.

use super::scenes::*;
use super::{Case, Readings};
use crate::scene::Scene;
use glam::DVec3;

pub(super) const CASES: &[Case] = &[
    Case::sampled(
        "C11-parallel-plates",
        "a bright floor and a ceiling between mirrors",
        "L = 1 / (1 - R₁ R₂)",
        c11,
    ),
    Case::sampled(
        "C13-concentric-spheres",
        "a bright sphere inside another",
        "radiosity of two surfaces",
        c13,
    ),
    Case::sampled(
        "C15-two-squares-radiosity",
        "two opposed squares, one of them bright: centres and corners",
        "Fredholm's equation by Nyström's method on 28² nodes",
        c15,
    ),
    Case::exact("C17-mirror-corridor", "a light behind k reflections of 0.9", "0.9^k", c17),
];

fn c11(readings: &mut Readings) {
    let mut scene = scene_for_paths(0.6);
    scene.materials[1] = emitter(1.0, 0.3);
    scene.materials.push(mirror(1.0));
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    add_with(&mut scene, quad(DVec3::ZERO, x, y), 1);
    add_with(&mut scene, quad(z, y, x), 0);
    for (corner, u) in [(DVec3::ZERO, x), (y, x), (DVec3::ZERO, y), (x, y)] {
        add_with(&mut scene, quad(corner, u, z), 3);
    }
    let (scene, eye, floor) = (Scene::build(&scene), v(0.4, 0.3, 0.6), 1.0 / (1.0 - 0.3 * 0.6));
    readings.radiance("floor", &scene, eye, v(0.7, 0.6, 0.0), floor);
    readings.radiance("ceiling", &scene, eye, v(0.7, 0.6, 1.0), 0.6 * floor);
}

/// With the inner sphere a quarter as large, the outer sees it with a quarter of its light and itself with the rest.
fn c13(readings: &mut Readings) {
    let mut scene = scene_for_paths(0.7);
    scene.materials[1] = emitter(1.0, 0.4);
    add_with(&mut scene, ball(DVec3::ZERO, 0.5), 1);
    add(&mut scene, ball(DVec3::ZERO, 1.0));
    let (scene, eye) = (Scene::build(&scene), v(0.0, 0.7, 0.1));
    let (inner, outer) = (0.4, 0.7);
    // B₁ = 1 + R₁ B₂ and B₂ = R₂ (B₁ / 4 + 3/4 B₂).
    let passed = 0.25 * outer / (1.0 - 0.75 * outer);
    let bright = 1.0 / (1.0 - inner * passed);
    readings.radiance("inner", &scene, eye, v(0.0, 0.4, 0.1), bright);
    readings.radiance("outer", &scene, eye, v(0.2, 1.0, 0.1), passed * bright);
}

fn c15(readings: &mut Readings) {
    let mut scene = scene_for_paths(0.5);
    scene.materials[1] = emitter(1.0, 0.5);
    add_with(&mut scene, quad(DVec3::ZERO, DVec3::X, DVec3::Y), 1);
    add(&mut scene, quad(DVec3::Z, DVec3::Y, DVec3::X));
    let (scene, eye) = (Scene::build(&scene), v(0.6, 0.7, 0.4));
    let in_corner = 1.0 - 1e-6;
    for (at, target, expected) in [
        ("emitter_centre", v(0.5, 0.5, 0.0), 1.01232676),
        ("emitter_corner", v(in_corner, in_corner, 0.0), 1.00700635),
        ("other_centre", v(0.5, 0.5, 1.0), 0.120976802),
        ("other_corner", v(in_corner, in_corner, 1.0), 0.0699750448),
    ] {
        readings.radiance(at, &scene, eye, target, expected);
    }
}

/// A ray that rises by 0.1 from mirror to mirror leaves after k of them.
fn c17(readings: &mut Readings) {
    for k in [1, 2, 5, 10, 50] {
        let mut scene = scene_for_paths(0.0);
        scene.materials.push(mirror(0.9));
        scene.materials[1].emits_behind = true;
        let end = 0.1 * f64::from(k) + 0.05;
        for x in [0.0, 1.0] {
            let (across, up) = (v(0.0, 2.0, 0.0), v(0.0, 0.0, 1.0 + end));
            add_with(&mut scene, quad(v(x, -1.0, -1.0), across, up), 3);
        }
        add_with(&mut scene, quad(v(-9.0, -9.0, end + 0.1), 18.0 * DVec3::X, 18.0 * DVec3::Y), 1);
        let (scene, expected) = (Scene::build(&scene), 0.9_f64.powi(k));
        readings.radiance(format!("k={k}"), &scene, DVec3::ZERO, v(1.0, 0.0, 0.1), expected);
    }
}
