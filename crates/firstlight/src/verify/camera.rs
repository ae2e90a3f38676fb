//! Where things are in a picture, and how sharp.

use super::scenes::*;
use super::{Case, Readings, Tolerance};
use crate::color::Rgb;
use crate::scene::description::*;
use glam::DVec3;
use std::f64::consts::PI;

pub(super) const CASES: &[Case] = &[
    Case::sampled(
        "K01-sphere-coverage",
        "the part of a square picture that a sphere fills",
        "geometry",
        k01,
    )
    .within(Tolerance::Relative(5e-4)),
    Case::sampled(
        "K03-thin-lens-coc",
        "blur of a small sphere out of focus",
        "similar triangles",
        k03,
    )
    .within(Tolerance::Relative(1e-2)),
];

fn k01(readings: &mut Readings) {
    let fov = 40_f64.to_radians();
    let mut scene = scene_of(Rgb::splat(0.5));
    add(&mut scene, ball(DVec3::ZERO, 1.0));
    let view = Projection::Perspective { vertical_fov: fov };
    scene.cameras.push(camera(v(0.0, -5.0, 0.0), DVec3::ZERO, view));
    scene.film = FilmDescription { width: 256, height: 256, transparent: true, ..scene.film };
    let radius_squared = 1.0 / (5.0 * 5.0 - 1.0);
    let expected = PI * radius_squared / (2.0 * (0.5 * fov).tan()).powi(2);
    let covered = |seed| {
        scene.film.seed = seed;
        let image = picture(&scene).image;
        image.pixels().iter().map(|pixel| f64::from(pixel[3])).sum::<f64>() / (256.0 * 256.0)
    };
    readings.repeated("", covered, expected);
}

/// A small sphere out of focus becomes a disk of diameter A |d − d_f| / d on the plane in focus. The diameter is found
/// from the second moment of the picture, D²/16 along each axis, less that of the sphere itself, r²/4.
fn k03(readings: &mut Readings) {
    let (focus_distance, aperture) = (2.0, 0.1);
    for depth in [1.0_f64, 3.0, 10.0] {
        let expected = aperture * (depth - focus_distance).abs() / depth;
        let (window, radius) = (1.5 * expected, expected / 8.0);
        let mut scene = scene_of(Rgb::ZERO);
        add(&mut scene, ball(v(0.0, depth, 0.0), radius * depth / focus_distance));
        let vertical_fov = 2.0 * f64::atan(window / 2.0 / focus_distance);
        let view = Projection::ThinLens { vertical_fov, aperture, focus_distance };
        scene.cameras.push(camera(DVec3::ZERO, DVec3::Y, view));
        let (width, samples, filter) = (128, 16, Filter::Box { radius: 0.5 });
        let transparent = true;
        scene.film =
            FilmDescription { width, height: width, samples, filter, transparent, ..scene.film };
        let diameter = |seed| {
            scene.film.seed = seed;
            let (mut weight, mut moment) = (0.0, 0.0);
            for (index, pixel) in picture(&scene).image.pixels().iter().enumerate() {
                let column = (index % width as usize) as f64 + 0.5;
                let x = (column / f64::from(width) - 0.5) * window;
                weight += f64::from(pixel[3]);
                moment += f64::from(pixel[3]) * x * x;
            }
            4.0 * (moment / weight - radius * radius / 4.0).sqrt()
        };
        readings.repeated(format!("d={depth}"), diameter, expected);
    }
}
