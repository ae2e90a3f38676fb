//! Light from far away, and what stands in its way.

use super::scenes::*;
use super::{Case, Readings};
use crate::color::Rgb;
use crate::scene::Scene;
use crate::scene::description::*;
use glam::DVec3;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

pub(super) const CASES: &[Case] = &[
    Case::sampled(
        "E01-uniform-sky",
        "a uniform sky of radiance 1 over a floor of reflectance 0.18",
        "E = π",
        e01,
    ),
    Case::sampled("E02-half-sky", "the same sky, half of it behind a black wall", "E = π/2", e02),
    Case::sampled(
        "E03-tilted-plane",
        "half a sky, on tilted surfaces",
        "Liu & Jordan: E = π (1 + cos b)/2",
        e03,
    ),
    Case::sampled(
        "E04-canyon-svf",
        "between two black walls as high as they are apart",
        "Hottel's crossed strings",
        e04,
    ),
    Case::sampled(
        "E06-ao-sphere-on-plane",
        "beside a black sphere that lies on a plane",
        "sphere's form factor",
        e06,
    ),
    Case::sampled(
        "E08-bowl",
        "a matte bowl under the sky: its wall shines alike everywhere",
        "integrating sphere",
        e08,
    ),
    Case::sampled(
        "E10-cie-overcast",
        "an overcast sky, upright and level",
        "Moon & Spencer 1942",
        e10,
    ),
    Case::sampled(
        "E12-hot-texel",
        "one bright texel of a lat-long picture, nearest look-up",
        "integral over it",
        e12,
    ),
];

fn e01(readings: &mut Readings) {
    let mut scene = scene_for_paths(0.18);
    scene.environment = uniform(1.0);
    readings.irradiance("E", &Scene::build(&scene), DVec3::ZERO, DVec3::Z, PI);
    add(&mut scene, floor());
    readings.radiance("L", &Scene::build(&scene), v(0.3, 0.2, 1.0), DVec3::ZERO, 0.18);
}

fn e02(readings: &mut Readings) {
    let mut scene = scene_for_paths(0.18);
    scene.environment = uniform(1.0);
    let wall = Plane { point: v(0.0, 1e-9, 0.0), normal: DVec3::Y };
    add_with(&mut scene, Shape::Plane(wall), 2);
    readings.irradiance("", &Scene::build(&scene), v(0.0, -1e-6, 0.0), DVec3::Z, PI / 2.0);
}

/// A lat-long picture that is looked up texel by texel.
fn sky_of(width: u32, height: u32, texel: impl Fn(u32) -> f32) -> Sky {
    let texel = |index| [texel(index), texel(index), texel(index), 1.0];
    let texels = Texels::Linear((0..width * height).map(texel).collect());
    let pixels = Arc::new(Pixels { name: "sky".into(), width, height, texels });
    Sky::Picture { pixels, sampling: Sampling::Nearest }
}

fn e03(readings: &mut Readings) {
    let mut scene = scene_for_paths(0.5);
    scene.environment = under(sky_of(1, 2, |index| [1.0, 0.0][index as usize]), 1.0);
    let scene = Scene::build(&scene);
    for degrees in [0.0, 30.0, 45.0, 60.0, 90.0, 135.0, 180.0] {
        let (sin, cos) = f64::to_radians(degrees).sin_cos();
        let expected = 0.5 * PI * (1.0 + cos);
        readings.irradiance(
            format!("b={degrees}"),
            &scene,
            DVec3::ZERO,
            v(sin, 0.0, cos),
            expected,
        );
    }
}

fn e04(readings: &mut Readings) {
    let mut scene = scene_for_paths(0.5);
    scene.environment = uniform(1.0);
    for x in [-0.5, 0.5] {
        add_with(&mut scene, quad(v(x, -1e4, 0.0), v(0.0, 2e4, 0.0), DVec3::Z), 2);
    }
    let centre = PI * f64::atan(2.0).cos();
    readings.irradiance("centre_E", &Scene::build(&scene), DVec3::ZERO, DVec3::Z, centre);
    let strip = quad(v(-0.5, -1.0, 0.0), DVec3::X, v(0.0, 2.0, 0.0));
    add(&mut scene, strip);
    let view = Projection::Orthographic { height: 1.0 };
    scene.cameras.push(camera(v(0.0, 0.0, 0.1), DVec3::ZERO, view));
    let filter = Filter::Box { radius: 0.5 };
    scene.film = FilmDescription { width: 32, height: 32, samples: 16, filter, ..scene.film };
    let mean = PI * (2.0_f64.sqrt() - 1.0);
    readings.repeated("mean_E", |seed| PI / 0.5 * mean_of_picture(&scene, seed), mean);
}

fn e06(readings: &mut Readings) {
    let mut scene = scene_for_paths(0.5);
    scene.environment = uniform(1.0);
    add_with(&mut scene, ball(DVec3::Z, 1.0), 2);
    let scene = Scene::build(&scene);
    for x in [0.25_f64, 0.5, 1.0, 2.0, 4.0] {
        let expected = PI * (1.0 - (1.0 + x * x).powf(-1.5));
        readings.irradiance(format!("x={x}"), &scene, v(x, 0.0, 0.0), DVec3::Z, expected);
    }
}

/// How many facets the bowl has from its rim to its bottom, and all around.
const ROWS: u32 = 256;
const COLUMNS: u32 = 512;

/// The middle of a facet of the bowl: the one place where it faces as the sphere does. At its edges it is turned by 0.2°,
/// which makes it a tenth of a percent brighter or darker.
fn middle_of_facet(row: u32, column: u32) -> DVec3 {
    let (sin, cos) = (0.25 * TAU * (f64::from(row) + 0.5) / f64::from(ROWS)).sin_cos();
    let (sin_phi, cos_phi) = (TAU * (f64::from(column) + 0.5) / f64::from(COLUMNS)).sin_cos();
    v(cos * cos_phi, cos * sin_phi, -sin)
}

/// The inside of the lower half of a sphere.
fn bowl() -> Mesh {
    let mut mesh = Mesh::default();
    for i in 0..=ROWS * COLUMNS {
        let (row, column) = (i / COLUMNS, i % COLUMNS);
        let (sin, cos) = (0.25 * TAU * f64::from(row) / f64::from(ROWS)).sin_cos();
        let (sin_phi, cos_phi) = (TAU * f64::from(column) / f64::from(COLUMNS)).sin_cos();
        let (across, z) = if row == ROWS { (0.0, -1.0) } else { (cos, -sin) };
        mesh.positions.push(v(across * cos_phi, across * sin_phi, z).as_vec3());
    }
    for (row, column) in (0..ROWS).flat_map(|row| (0..COLUMNS).map(move |column| (row, column))) {
        let at =
            |r: u32, c: u32| if r == ROWS { ROWS * COLUMNS } else { r * COLUMNS + c % COLUMNS };
        let (a, b) = (at(row, column), at(row, column + 1));
        mesh.triangles.push([a, b, at(row + 1, column)]);
        if row + 1 < ROWS {
            mesh.triangles.push([b, at(row + 1, column + 1), at(row + 1, column)]);
        }
    }
    mesh
}

fn e08(readings: &mut Readings) {
    let bowl = bowl();
    for reflectance in [0.2_f32, 0.5, 0.8, 0.95] {
        let mut scene = scene_for_paths(reflectance);
        scene.environment = uniform(1.0);
        add_mesh(&mut scene, bowl.clone());
        let (scene, rho) = (Scene::build(&scene), f64::from(reflectance));
        let expected = 0.5 * rho / (1.0 - 0.5 * rho);
        for (place, row, column) in [("bottom", 240, 40), ("wall", 100, 10)] {
            let at = format!("rho={reflectance}, {place}");
            readings.radiance(
                at,
                &scene,
                v(-0.1, 0.2, 0.5),
                middle_of_facet(row, column),
                expected,
            );
        }
    }
}

/// A gradient from the horizon to three times as much in the zenith. From the side, its lower half shows a ground that
/// falls from 1/3 to 0.
fn e10(readings: &mut Readings) {
    let (horizon, zenith) = (Rgb::splat(1.0 / 3.0), Rgb::ONE);
    let mut scene = scene_for_paths(0.5);
    scene.environment = under(Sky::Gradient { zenith, horizon, nadir: Rgb::ZERO }, 1.0);
    readings.irradiance("horizontal", &Scene::build(&scene), DVec3::ZERO, DVec3::Z, 7.0 * PI / 9.0);
    add_with(&mut scene, Shape::Plane(Plane { point: v(0.0, 0.0, -1e-6), normal: DVec3::Z }), 2);
    let vertical = PI / 6.0 + 4.0 / 9.0;
    readings.irradiance("vertical", &Scene::build(&scene), DVec3::ZERO, DVec3::X, vertical);
}

fn e12(readings: &mut Readings) {
    let mut scene = scene_for_paths(0.5);
    let sky = sky_of(64, 32, |index| if index == 5 * 64 + 20 { 1000.0 } else { 0.0 });
    scene.environment = under(sky, 1.0);
    let sin2 = |row: f64| (PI * row / 32.0).sin().powi(2);
    let expected = 1000.0 * TAU / 64.0 * 0.5 * (sin2(6.0) - sin2(5.0));
    readings.irradiance("", &Scene::build(&scene), DVec3::ZERO, DVec3::Z, expected);
}
