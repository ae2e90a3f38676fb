//! Places where all light is the same, whatever reflects it: no energy is lost or made.

use super::scenes::*;
use super::{Case, Readings, Tolerance};
use crate::color::Rgb;
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
    Case::sampled("C18-glass-furnace", "a ball of clear glass under a uniform sky", "L = 1", c18),
    Case::sampled(
        "C19-inside-glass-furnace",
        "the same from its centre",
        "L = n²: radiance over the square of the index stays the same",
        c19,
    ),
    Case::sampled(
        "C21-kirchhoff-isothermal",
        "a room full of things that emit what they do not reflect",
        "Kirchhoff: L = 1 in every pixel",
        c21,
    )
    .within(Tolerance::Relative(5e-3)),
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

fn ball_of_glass() -> Scene {
    let mut scene = scene_for_paths(0.0);
    scene.environment = uniform(1.0);
    scene.materials[0] = clear(1.5, Rgb::ZERO);
    add(&mut scene, ball(DVec3::ZERO, 1.0));
    Scene::build(&scene)
}

fn c18(readings: &mut Readings) {
    let scene = ball_of_glass();
    for offset in [0.0, 0.5, 0.9, 0.99] {
        let at = format!("{offset} from the axis");
        readings.radiance(at, &scene, v(0.0, -5.0, 0.0), v(offset, 0.0, 0.0), 1.0);
    }
}

fn c19(readings: &mut Readings) {
    readings.radiance("", &ball_of_glass(), DVec3::ZERO, v(0.3, 1.0, 0.2), 2.25);
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
    const SIDE: u32 = 24;
    let mut scene = isothermal_room();
    scene.film = FilmDescription { width: SIDE, height: SIDE, samples: 512, ..scene.film };
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
