//! Light that is exchanged between a few surfaces until nothing changes.

use super::scenes::*;
use super::{Case, Readings};
use crate::color::Rgb;
use crate::scene::Scene;
use crate::scene::description::*;
use glam::DVec3;
use std::f64::consts::PI;

pub(super) const CASES: &[Case] = &[
    Case::sampled(
        "C07-point-in-sphere-centre",
        "a point light in the middle of a sphere",
        "L = 1",
        c07,
    ),
    Case::sampled(
        "C08-point-in-sphere-offcentre",
        "a point light off the middle of a sphere: direct light, and the same indirect light everywhere",
        "integrating sphere",
        c08,
    ),
];

fn sphere_with_light(position: DVec3, intensity: f64) -> Scene {
    let mut scene = scene_for_paths(0.5);
    add(&mut scene, ball(DVec3::ZERO, 1.0));
    light(&mut scene, Light::Point { position, intensity: Rgb::splat(intensity as f32) });
    Scene::build(&scene)
}

fn c07(readings: &mut Readings) {
    let scene = sphere_with_light(DVec3::ZERO, PI);
    readings.radiance("", &scene, v(0.2, 0.1, -0.3), v(0.4, 0.7, 0.6), 1.0);
}

fn c08(readings: &mut Readings) {
    let position = v(0.0, 0.0, 0.6);
    let scene = sphere_with_light(position, 1.0);
    for degrees in [0.0, 60.0, 90.0, 120.0, 180.0] {
        let (sin, cos) = f64::to_radians(degrees).sin_cos();
        let (place, rho) = (v(sin, 0.0, cos), 0.5);
        let to_light = position - place;
        let direct = to_light.normalize().dot(-place) / to_light.length_squared();
        let expected = rho / PI * (direct + rho / (1.0 - rho));
        readings.radiance(degrees, &scene, v(0.1, 0.2, 0.1), place, expected);
    }
}
