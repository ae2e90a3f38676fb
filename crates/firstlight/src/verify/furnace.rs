//! Places where all light is the same, whatever reflects it: no energy is lost or made.

use super::scenes::*;
use super::white::{self, glass, pane};
use super::{Case, Readings, Tolerance};
use crate::scene::Scene;
use crate::scene::description::*;
use glam::{DAffine3, DVec3, Vec3};

pub(super) const CASES: &[Case] = &[
    Case::sampled(
        "C01-white-furnace-diffuse",
        "convex white things under a uniform sky",
        "L = 1",
        c01,
    ),
    Case::sampled(
        "C02-grey-furnace",
        "convex grey things under a uniform sky",
        "L = reflectance",
        c02,
    ),
    Case::sampled(
        "C03-emissive-sphere",
        "inside a sphere that emits 0.5 and reflects half",
        "L_e / (1 - R)",
        c03,
    ),
    Case::sampled(
        "C04-emissive-box",
        "inside a box that emits 1, up to a reflectance of 0.99",
        "1 / (1 - R)",
        c04,
    )
    .slow(),
    Case::sampled(
        "C05-box-depth-limited",
        "the same box of reflectance 0.8, with at most n reflections",
        "(1 - R^(n+1)) / (1 - R)",
        c05,
    ),
    Case::sampled(
        "C06-box-mixed-brdf",
        "a box of matte mirrors that emit 0.25",
        "L_e / (1 - R)",
        c06,
    ),
    Case::sampled(
        "C18-glass-furnace",
        "a ball of glass of index 1.5 under a uniform sky",
        "L = 1",
        c18,
    ),
    Case::sampled(
        "C19-inside-glass-furnace",
        "seen from inside of that ball",
        "L = n^2; Veach 1997, section 5.2",
        c19,
    ),
    Case::sampled(
        "C21-kirchhoff-isothermal",
        "a room full of things that emit what they do not reflect",
        "Kirchhoff: L = 1 in every pixel",
        c21,
    )
    .within(Tolerance::Relative(5e-3)),
    Case::sampled(
        "white-balls",
        "balls of every material that loses nothing, of every roughness, under a uniform sky",
        "L = 1",
        white_balls,
    )
    .within(Tolerance::Relative(5e-3))
    .slow(),
    Case::sampled(
        "white-inside",
        "seen from inside of balls of glass of every roughness",
        "L = n^2",
        white_inside,
    )
    .within(Tolerance::Relative(5e-3)),
    Case::sampled(
        "white-room",
        "a room that emits what it does not reflect, full of what loses nothing",
        "Kirchhoff: L = 1",
        white_room,
    )
    .within(Tolerance::Relative(5e-3))
    .slow(),
    Case::sampled(
        "nested-glass",
        "a ball in water in a glass that overlap, under a uniform sky",
        "L = 1",
        nested,
    ),
    Case::sampled(
        "dispersion",
        "a ball of flint glass that tears colours apart",
        "L = 1",
        dispersion,
    ),
    Case::sampled("behind-panes", "a white floor in a bubble of thin glass", "L = 1", behind_panes),
];

const EYE: DVec3 = DVec3::new(0.2, 0.1, -0.3);
const TARGET: DVec3 = DVec3::new(1.0, 2.0, 3.0);

fn under_the_sky(readings: &mut Readings, at: &str, reflectance: f32) {
    let mut scene = scene_for_paths(reflectance);
    scene.environment = uniform(1.0);
    for (name, shape, z) in
        [("sphere", ball(DVec3::ZERO, 1.0), 0.5), ("cube", cube(DVec3::ZERO, 1.0), 0.3)]
    {
        scene.surfaces.clear();
        add(&mut scene, shape);
        let (scene, target) = (Scene::build(&scene), v(0.3, 0.2, z));
        let at = format!("{at}{name}");
        readings.radiance(at, &scene, v(3.0, 2.0, 1.0), target, reflectance.into());
    }
}

fn c01(readings: &mut Readings) {
    under_the_sky(readings, "", 1.0);
}

fn c02(readings: &mut Readings) {
    for reflectance in [0.18, 0.5, 0.8] {
        under_the_sky(readings, &format!("{reflectance}, "), reflectance);
    }
}

/// What is seen in a closed shape whose walls are of `material`.
fn inside(
    readings: &mut Readings,
    at: impl ToString,
    shape: Shape,
    material: Material,
    bounces: Option<u32>,
    expected: f64,
) {
    let mut scene = scene_for_paths(0.0);
    scene.integrator = Integrator::Path { bounces };
    scene.materials[0] = material;
    add(&mut scene, shape);
    readings.radiance(at, &Scene::build(&scene), EYE, TARGET, expected);
}

fn c03(readings: &mut Readings) {
    inside(readings, "", ball(DVec3::ZERO, 1.0), glowing(0.5, 0.5), None, 1.0);
}

fn c04(readings: &mut Readings) {
    for reflectance in [0.0, 0.5, 0.8, 0.95, 0.99] {
        let expected = 1.0 / (1.0 - f64::from(reflectance));
        let walls = glowing(1.0, reflectance);
        inside(readings, format!("a={reflectance}"), cube(DVec3::ZERO, 2.0), walls, None, expected);
    }
}

/// A depth counts reflections.
fn c05(readings: &mut Readings) {
    for bounces in [0, 1, 2, 3, 5, 8] {
        let expected = (1.0 - 0.8_f64.powi(bounces as i32 + 1)) / 0.2;
        let (room, walls) = (cube(DVec3::ZERO, 2.0), glowing(1.0, 0.8));
        inside(readings, format!("n={bounces}"), room, walls, Some(bounces), expected);
    }
}

fn c06(readings: &mut Readings) {
    let walls = Material { scattering: mirror(0.5).scattering, ..glowing(0.25, 0.25) };
    inside(readings, "", cube(DVec3::ZERO, 2.0), walls, None, 1.0);
}

/// Where everything sends out what it does not reflect, nothing can be told apart.
fn isothermal_room() -> SceneDescription {
    let mut scene = scene_for_paths(0.0);
    scene.materials = [0.2, 0.5, 0.9].map(|r| glowing(1.0 - r, r)).to_vec();
    scene.materials.push(Material { scattering: mirror(0.6).scattering, ..glowing(0.3, 0.1) });
    add_with(&mut scene, cube(DVec3::ZERO, 2.0), 1);
    add_with(&mut scene, ball(v(0.3, 0.2, -0.5), 0.4), 0);
    add_with(&mut scene, ball(v(-0.4, 0.1, 0.3), 0.3), 3);
    let base = v(-0.3, -0.6, -1.0);
    let cylinder = Cylinder { base, top: base + v(0.1, 0.0, 0.8), radius: 0.2, capped: true };
    add_with(&mut scene, Shape::Cylinder(cylinder), 2);
    let cone = Cone { base: v(0.6, 0.6, -1.0), apex: v(0.6, 0.6, 0.2), radius: 0.2, capped: false };
    add_with(&mut scene, Shape::Cone(cone), 2);
    let normal = v(1.0, 1.0, 1.0).normalize();
    let disk = Disk { center: v(0.5, -0.5, 0.2), normal, radius: 0.3 };
    add_with(&mut scene, Shape::Disk(disk), 3);
    let positions = [[-0.9, 0.4, -0.8], [0.1, 0.8, -0.9], [-0.5, 0.9, 0.6]].map(Vec3::from_array);
    let (positions, triangles) = (positions.to_vec(), vec![[0, 1, 2]]);
    add_mesh(&mut scene, Mesh { positions, triangles, ..Mesh::default() });
    if let Some(surface) = scene.surfaces.last_mut() {
        surface.transform = DAffine3::from_rotation_x(0.3);
    }
    let view = Projection::Perspective { vertical_fov: 2.0 };
    scene.cameras.push(camera(v(-0.9, -0.9, 0.8), v(0.2, 0.2, -0.3), view));
    scene
}

/// Each pixel of a picture.
fn c21(readings: &mut Readings) {
    const SIDE: u32 = 16;
    let mut scene = isothermal_room();
    scene.film = FilmDescription { width: SIDE, height: SIDE, samples: 1024, ..scene.film };
    let pictures: Vec<_> = (0..Readings::REPETITIONS)
        .map(|seed| {
            scene.film.seed = seed;
            picture(&scene).image
        })
        .collect();
    for (x, y) in (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y))) {
        let pixel = |seed: u64| f64::from(pictures[seed as usize].get(x, y).x);
        readings.repeated(format!("pixel {x}, {y}"), pixel, 1.0);
    }
}

/// Balls of one material under a sky of 1, each within the one before.
fn balls(materials: Vec<Material>, balls: &[(DVec3, f64)]) -> Scene {
    let mut scene = scene_for_paths(0.0);
    (scene.environment, scene.materials) = (uniform(1.0), materials);
    for (material, &(center, radius)) in balls.iter().enumerate() {
        add_with(&mut scene, ball(center, radius), material);
    }
    Scene::build(&scene)
}

const EYE_OUTSIDE: DVec3 = DVec3::new(0.0, -5.0, 0.0);
const UNIT: [(DVec3, f64); 1] = [(DVec3::ZERO, 1.0)];
/// Where a ball of radius 1 is looked at: from its middle to its rim.
const OFFSETS: [f64; 4] = [0.0, 0.5, 0.9, 0.99];
const ROUGHNESSES: [f32; 7] = [0.0, 0.1, 0.25, 0.4, 0.6, 0.8, 1.0];

fn c18(readings: &mut Readings) {
    let scene = balls(vec![glass(1.5, 0.0)], &UNIT);
    for offset in OFFSETS {
        readings.radiance(offset, &scene, EYE_OUTSIDE, v(offset, 0.0, 0.0), 1.0);
    }
}

fn c19(readings: &mut Readings) {
    let scene = balls(vec![glass(1.5, 0.0)], &UNIT);
    readings.radiance("", &scene, DVec3::ZERO, v(0.3, 1.0, 0.2), 2.25);
}

fn white_balls(readings: &mut Readings) {
    for roughness in ROUGHNESSES {
        for material in white::materials(roughness) {
            let name = material.name.clone();
            let scene = balls(vec![material], &UNIT);
            for offset in OFFSETS {
                let at = format!("{name} {roughness}, {offset}");
                readings.approximation(at, &scene, EYE_OUTSIDE, v(offset, 0.0, 0.0), 1.0);
            }
        }
    }
}

fn white_inside(readings: &mut Readings) {
    for (index, roughness) in
        [1.1_f32, 1.5, 2.4].into_iter().flat_map(|n| ROUGHNESSES.map(|r| (n, r)))
    {
        let scene = balls(vec![glass(index, roughness)], &UNIT);
        let (at, expected) = (format!("{index}, {roughness}"), f64::from(index).powi(2));
        readings.approximation(at, &scene, DVec3::ZERO, v(0.3, 1.0, 0.2), expected);
    }
}

fn white_room(readings: &mut Readings) {
    let mut scene = scene_for_paths(0.0);
    scene.materials = white::materials(0.3);
    let walls = scene.materials.len();
    for i in 0..walls {
        let (x, y) = ((i % 4) as f64, (i / 4) as f64);
        add_with(&mut scene, ball(v(1.8 * x - 2.7, 1.8 * y - 1.8, 0.3 * x), 0.7), i);
    }
    scene.materials.push(glowing(0.4, 0.6));
    add_with(&mut scene, cube(DVec3::ZERO, 8.0), walls);
    let scene = Scene::build(&scene);
    for i in 0..16 {
        let (angle, reach) = (2.4 * f64::from(i), 3.5 * (f64::from(i) / 16.0).sqrt());
        let target = v(reach * angle.cos(), reach * angle.sin(), 0.0);
        readings.approximation(i, &scene, v(0.2, 0.1, 3.5), target, 1.0);
    }
}

/// The wall of the glass reaches into the water, whose surface is not there: the glass has the higher priority.
fn nested(readings: &mut Readings) {
    let mut wall = glass(1.5, 0.0);
    if let Some(interior) = &mut wall.interior {
        interior.priority = 1;
    }
    let solids = vec![glass(1.33, 0.0), glass(2.0, 0.0), wall];
    let places = [(DVec3::ZERO, 1.0), (v(0.2, 0.0, 0.0), 0.4), (v(0.0, 0.9, 0.0), 0.5)];
    let scene = balls(solids, &places);
    for i in 0..20 {
        let angle = 0.32 * f64::from(i);
        let target = v(0.9 * angle.cos(), 0.0, 0.9 * angle.sin());
        readings.radiance(i, &scene, v(0.3, -5.0, 0.1), target, 1.0);
    }
}

fn dispersion(readings: &mut Readings) {
    let mut flint = glass(1.78, 0.0);
    if let Some(interior) = &mut flint.interior {
        interior.dispersion = 1.0 / 25.0;
    }
    let scene = balls(vec![flint], &UNIT);
    for offset in OFFSETS {
        readings.radiance(offset, &scene, EYE_OUTSIDE, v(offset, 0.0, 0.0), 1.0);
    }
}

/// What lies behind panes is found by light sampling and by chance, and counted once.
fn behind_panes(readings: &mut Readings) {
    let mut scene = scene_for_paths(1.0);
    (scene.environment, scene.materials[1]) = (uniform(1.0), pane(1.5));
    add(&mut scene, floor());
    add_with(&mut scene, ball(DVec3::ZERO, 2.0), 1);
    readings.radiance("", &Scene::build(&scene), v(0.1, -1.0, 1.0), DVec3::ZERO, 1.0);
}
