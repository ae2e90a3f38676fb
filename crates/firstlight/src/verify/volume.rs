//! Media that absorb and scatter.

use super::scenes::*;
use super::{Case, Readings};
use crate::color::Rgb;
use crate::scene::Scene;
use glam::DVec3;

pub(super) const CASES: &[Case] = &[Case::sampled(
    "M16-beer-lambert",
    "a uniform sky through 2 m of what absorbs 0.7 per metre, without a boundary",
    "Beer 1852: exp(-σ d)",
    m16,
)];

fn m16(readings: &mut Readings) {
    let mut scene = scene_for_paths(0.0);
    scene.environment = uniform(1.0);
    scene.materials[0] = clear(1.0, Rgb::splat(0.7));
    add(&mut scene, cube(DVec3::ZERO, 2.0));
    let scene = Scene::build(&scene);
    readings.radiance("", &scene, v(0.0, -5.0, 0.0), DVec3::ZERO, (-1.4_f64).exp());
}
