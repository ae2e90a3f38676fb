//! From radiance to pixels.

use super::scenes::*;
use super::{Case, Readings, Tolerance};
use crate::color::{Rgb, luminance, srgb_code8, srgb_encode};
use crate::scene::description::*;
use glam::DVec3;

pub(super) const CASES: &[Case] = &[
    Case::exact(
        "K04-srgb-oetf",
        "linear values encoded for screens, and their 8-bit codes",
        "IEC 61966-2-1",
        k04,
    )
    .within(Tolerance::Absolute(1e-6)),
    Case::exact("K05-luminance", "luminance of (0.2, 0.5, 0.1)", "ITU-R BT.709", k05),
    Case::sampled(
        "K06-box-filter-edge",
        "an edge at 0.3 of a pixel, under the box filter",
        "area",
        k06,
    )
    .within(Tolerance::Absolute(2e-3)),
];

fn k04(readings: &mut Readings) {
    for (linear, code) in [(0.001_f32, 3), (0.0031308, 10), (0.18, 118), (0.5, 188), (0.8, 231)] {
        let x = f64::from(linear);
        let encoded = if x <= 0.0031308 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
        readings.exact(format!("{linear}, f"), srgb_encode(linear), encoded);
        readings.exact(format!("{linear}, code"), srgb_code8(linear), f64::from(code));
    }
}

fn k05(readings: &mut Readings) {
    readings.exact("", luminance(Rgb::new(0.2, 0.5, 0.1)), 0.40734);
}

fn k06(readings: &mut Readings) {
    let mut scene = scene_of(Rgb::ZERO);
    scene.materials[0].emission = Texture::constant(Rgb::ONE);
    add(&mut scene, quad(v(-1.0, 0.0, -1.0), v(0.8, 0.0, 0.0), v(0.0, 0.0, 2.0)));
    let view = Projection::Orthographic { height: 1.0 };
    scene.cameras.push(camera(v(0.0, -1.0, 0.0), DVec3::ZERO, view));
    let filter = Filter::Box { radius: 0.5 };
    scene.film = FilmDescription { width: 1, height: 1, samples: 4096, filter, ..scene.film };
    readings.repeated("", |seed| mean_of_picture(&scene, seed), 0.3);
}
