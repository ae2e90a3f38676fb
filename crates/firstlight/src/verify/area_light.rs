//! Surfaces that emit.

use super::closed_forms::{disk, polygon, rectangle, sphere};
use super::scenes::*;
use super::statistics::mean_over_sphere;
use super::{Case, Readings, Tolerance};
use crate::integrator::Meter;
use crate::scene::Scene;
use crate::scene::description::*;
use glam::{DVec3, Vec3};
use std::f64::consts::PI;

const LAMBERT: &str = "Lambert 1760: irradiance from a polygon";
const SPHERE: &str = "Snyder 1996: irradiance from a sphere, cut by the horizon";

pub(super) const CASES: &[Case] = &[
    Case::sampled("A01-square-above", "a unit square of radiance 1, 1 m above", LAMBERT, a01),
    Case::sampled("A02-square-offaxis", "the same square, from beside", LAMBERT, a02),
    Case::sampled(
        "A04-horizon-clipped",
        "a wall of light, half of it below the horizon",
        LAMBERT,
        a04,
    ),
    Case::sampled(
        "A06-nori-polylum",
        "five triangles of radiance 1 on a surface of reflectance 0.5",
        "Lambert 1760; W. Jakob's Nori, test-mesh",
        a06,
    ),
    Case::sampled("A08-disk-coaxial", "a disk of radius 1, 2 m above", "Howell B-12", a08),
    Case::sampled("A09-disk-offaxis", "the same disk, from beside", "Howell B-13", a09),
    Case::sampled("A11-sphere-light", "a sphere of light, on tilted surfaces", SPHERE, a11),
    Case::sampled(
        "A12-sphere-light-horizon",
        "the same sphere, partly below the horizon",
        SPHERE,
        a12,
    ),
    Case::sampled("A14-near-field", "the unit square, close to the surface", LAMBERT, a14),
    Case::exact("A16-back-face", "behind a one-sided square: exactly nothing", "geometry", a16)
        .within(Tolerance::Absolute(0.0)),
    Case::sampled(
        "A17-area-light-power",
        "all that leaves a rectangle of 2 m × 0.5 m and radiance 3, on a sphere around it",
        "Lambert: P = π L A",
        a17,
    ),
    Case::sampled("A18-penumbra", "a half plane between a square and a floor", LAMBERT, a18),
];

/// A square or other rectangle of light that faces down, around a point above the origin.
fn panel_irradiance(at: DVec3, height: f64, width: f64, depth: f64) -> f64 {
    let corner = v(-width / 2.0, -depth / 2.0, height);
    polygon(at, DVec3::Z, &rectangle(corner, v(width, 0.0, 0.0), v(0.0, depth, 0.0)))
}

/// Below the unit square at a height: by the meter, and seen on a floor, with the light as two triangles.
fn unit_square(readings: &mut Readings, at: &str, height: f64, point: DVec3) {
    let expected = panel_irradiance(point, height, 1.0, 1.0);
    let mut scene = scene_for_paths(0.5);
    add_with(&mut scene, panel(DVec3::Z * height, 1.0, 1.0), 1);
    readings.irradiance(at, &Scene::build(&scene), point, DVec3::Z, expected);
    scene.surfaces.clear();
    let corners = [(-0.5, -0.5), (-0.5, 0.5), (0.5, 0.5), (0.5, -0.5)];
    let positions = corners.map(|(x, y)| Vec3::new(x, y, height as f32)).to_vec();
    let triangles = vec![[0, 1, 2], [0, 2, 3]];
    add_mesh(&mut scene, Mesh { positions, triangles, ..Mesh::default() });
    scene.surfaces[0].material = 1;
    add(&mut scene, floor());
    let (scene, eye) = (Scene::build(&scene), point + 0.5 * height * v(0.1, 0.2, 1.0));
    readings.radiance(format!("{at} as a mesh, seen"), &scene, eye, point, 0.5 / PI * expected);
}

fn a01(readings: &mut Readings) {
    unit_square(readings, "", 1.0, DVec3::ZERO);
}

fn a02(readings: &mut Readings) {
    for (x, y) in [(0.5, 0.0), (1.5, 0.5), (4.0, -2.0)] {
        unit_square(readings, &format!("({x}, {y})"), 1.0, v(x, y, 0.0));
    }
}

fn a04(readings: &mut Readings) {
    let (corner, up, across) = (v(1.0, -1.0, -1.0), v(0.0, 0.0, 2.0), v(0.0, 2.0, 0.0));
    let mut scene = scene_for_paths(0.5);
    add_with(&mut scene, quad(corner, up, across), 1);
    let expected = polygon(DVec3::ZERO, DVec3::Z, &rectangle(corner, up, across));
    readings.irradiance("", &Scene::build(&scene), DVec3::ZERO, DVec3::Z, expected);
}

const NORI: [[[f32; 3]; 3]; 5] = [
    [
        [-0.443432, 0.596366, 0.495985],
        [-0.320397, 0.0677699, -0.229359],
        [0.0341197, 0.11415, -0.343049],
    ],
    [
        [0.461963, 0.397843, 0.412747],
        [-0.0381582, 0.851323, -0.156872],
        [0.195443, 0.891957, -0.260672],
    ],
    [
        [0.100871, 0.289075, -0.422609],
        [-0.308386, 0.629587, 0.423966],
        [-0.373132, 0.237287, 0.351592],
    ],
    [
        [-0.17575, 0.639397, 0.151268],
        [0.318604, 0.732996, 0.459771],
        [0.139095, 0.294498, 0.478556],
    ],
    [
        [-0.17487, 0.447916, 0.367201],
        [-0.405259, 0.249607, -0.354079],
        [0.356029, 0.0918984, -0.132271],
    ],
];

fn a06(readings: &mut Readings) {
    for (number, corners) in NORI.into_iter().enumerate() {
        let positions = corners.map(Vec3::from_array);
        let expected = polygon(DVec3::ZERO, DVec3::Y, &positions.map(Vec3::as_dvec3)) * 0.5 / PI;
        let mut scene = scene_for_paths(0.5);
        scene.materials[1].emits_behind = true;
        let mesh =
            Mesh { positions: positions.to_vec(), triangles: vec![[0, 1, 2]], ..Mesh::default() };
        add_mesh(&mut scene, mesh);
        scene.surfaces[0].material = 1;
        add(&mut scene, Shape::Plane(Plane { point: DVec3::ZERO, normal: DVec3::Y }));
        let at = format!("polylum{}", number + 1);
        let eye = v(0.01, 0.03, 0.02);
        readings.radiance(at, &Scene::build(&scene), eye, DVec3::ZERO, expected);
    }
}

/// A disk of radius 1 at a height of 2 m.
fn below_disk(readings: &mut Readings, at: &str, x: f64) {
    let mut scene = scene_for_paths(0.5);
    let shape = Disk { center: v(0.0, 0.0, 2.0), normal: -DVec3::Z, radius: 1.0 };
    add_with(&mut scene, Shape::Disk(shape), 1);
    readings.irradiance(at, &Scene::build(&scene), v(x, 0.0, 0.0), DVec3::Z, disk(1.0, 2.0, x));
}

fn a08(readings: &mut Readings) {
    below_disk(readings, "", 0.0);
}

fn a09(readings: &mut Readings) {
    for x in [0.5, 1.0, 2.0, 5.0] {
        below_disk(readings, &format!("x={x}"), x);
    }
}

/// A sphere of radius 0.5, 2 m above surfaces tilted by so many degrees.
fn below_sphere(readings: &mut Readings, tilts: &[f64]) {
    let mut scene = scene_for_paths(0.5);
    add_with(&mut scene, ball(v(0.0, 0.0, 2.0), 0.5), 1);
    let scene = Scene::build(&scene);
    for degrees in tilts {
        let theta = degrees.to_radians();
        let (normal, expected) = (v(theta.sin(), 0.0, theta.cos()), sphere(0.25_f64.asin(), theta));
        readings.irradiance(format!("t={degrees}"), &scene, DVec3::ZERO, normal, expected);
    }
}

fn a11(readings: &mut Readings) {
    below_sphere(readings, &[0.0, 30.0, 60.0]);
}

fn a12(readings: &mut Readings) {
    below_sphere(readings, &[80.0, 85.0, 90.0, 95.0, 100.0]);
}

fn a14(readings: &mut Readings) {
    for height in [0.1, 1e-2, 1e-3] {
        unit_square(readings, &format!("h={height}"), height, DVec3::ZERO);
    }
}

fn a16(readings: &mut Readings) {
    let mut scene = scene_for_paths(0.5);
    add_with(&mut scene, panel(DVec3::Z, 1.0, 1.0), 1);
    let (scene, above) = (Scene::build(&scene), v(0.1, 0.2, 1.5));
    readings.irradiance("E", &scene, above, -DVec3::Z, 0.0);
    readings.radiance("L", &scene, above, above.with_z(0.0), 0.0);
}

/// On a black sphere 20 m around it.
fn a17(readings: &mut Readings) {
    for (at, emits_behind, sides) in [("one", false, 1.0), ("two", true, 2.0)] {
        let mut scene = scene_for_paths(0.0);
        scene.materials[1] = Material { emits_behind, ..emitter(3.0, 0.0) };
        add_with(&mut scene, panel(DVec3::ZERO, 2.0, 0.5), 1);
        let measure = |seed| {
            scene.film.seed = seed;
            let scene = Scene::build(&scene);
            let meter = Meter::new(&scene).samples(64);
            let inward = |outward: DVec3| meter.irradiance(20.0 * outward, -outward).value.x;
            4.0 * PI * 400.0 * mean_over_sphere(32, seed, |outward| inward(outward).into())
        };
        readings.repeated(at, measure, sides * PI * 3.0);
    }
}

fn a18(readings: &mut Readings) {
    let mut scene = scene_for_paths(0.5);
    add_with(&mut scene, panel(DVec3::Z * 2.0, 1.0, 1.0), 1);
    let half_plane = quad(v(-1e3, -1e3, 1.0), v(1e3, 0.0, 0.0), v(0.0, 2e3, 0.0));
    add_with(&mut scene, half_plane, 2);
    let scene = Scene::build(&scene);
    for x in [-0.6, -0.5, -0.4, -0.2, 0.0, 0.2, 0.4, 0.5, 0.6] {
        // The edge of the half plane cuts the light at −x.
        let from = f64::clamp(-x, -0.5, 0.5);
        let visible = rectangle(v(from, -0.5, 2.0), v(0.5 - from, 0.0, 0.0), DVec3::Y);
        let (point, expected) = (v(x, 0.0, 0.0), polygon(v(x, 0.0, 0.0), DVec3::Z, &visible));
        readings.irradiance(format!("x={x}"), &scene, point, DVec3::Z, expected);
    }
}
