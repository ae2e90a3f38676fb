//! Where rays meet surfaces: precision, scale, place, gaps, facets.

use super::scenes::*;
use super::shapes::{bumpy_sphere, icosphere, menger_sponge};
use super::{Case, Random, Readings, Tolerance};
use crate::color::Rgb;
use crate::geometry::{Hit, Ray, solid_angle};
use crate::image::Image;
use crate::scene::Scene;
use crate::scene::description::*;
use glam::{DAffine3, DMat3, DVec3, Vec2, Vec3};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

pub(super) const CASES: &[Case] = &[
    Case::exact("G01-ray-sphere-precision", "far and huge spheres", "50-digit arithmetic", g01)
        .within(Tolerance::Relative(1e-6)),
    Case::exact(
        "G02-triangle-solid-angle",
        "solid angles of triangles",
        "Van Oosterom & Strackee 1983",
        g02,
    ),
    Case::exact(
        "G03-scale-invariance",
        "a scene scaled by 10^k: the same picture, no acne, no leaks",
        "the picture at scale 1",
        g03,
    )
    .within(Tolerance::Absolute(0.0)),
    Case::exact(
        "G04-translation-invariance",
        "a scene far from the origin",
        "the picture at the origin",
        g04,
    )
    .within(Tolerance::Absolute(0.0)),
    Case::exact(
        "G05-watertight",
        "rays that leave closed meshes, many of them through edges and vertices: none",
        "Woop, Benthin, Wald 2013",
        g05,
    )
    .within(Tolerance::Absolute(0.0)),
    Case::exact(
        "G06-reintersection",
        "rays that meet the surface they leave, with coordinates of 10^-8 to 10^8: none",
        "geometry",
        g06,
    )
    .within(Tolerance::Absolute(0.0)),
    Case::exact(
        "G07-shadow-terminator",
        "black points in the lit half of smooth n-gons: none, and the mean of a cylinder",
        "Hanika, Ray Tracing Gems II ch. 4",
        g07,
    )
    .within(Tolerance::Absolute(0.0)),
];

fn g01(readings: &mut Readings) {
    let mut met = |at: &str, center: DVec3, radius: f64, origin: Vec3, direction: Vec3, t: f64| {
        let mut scene = scene_of(Rgb::ONE);
        add(&mut scene, ball(center, radius));
        let (scene, mut hits) = (Scene::build(&scene), Vec::new());
        scene.closest_hits(&[Ray::new(origin, direction)], &mut hits);
        readings.exact(at, hits[0].t, t);
    };
    let (far, edge) = (Vec3::new(0.0, 0.5, -1e6), Vec3::new(0.0, 0.999, -1e5));
    met(
        "far: o=(0,0.5,-1e6) d=+z unit sphere at 0",
        DVec3::ZERO,
        1.0,
        far,
        Vec3::Z,
        999_999.133_974_596,
    );
    met("far: o=(0,0.999,-1e5)", DVec3::ZERO, 1.0, edge, Vec3::Z, 99_999.955_289_822_2);
    let (earth, eye, down) = (6_371_000.0, Vec3::new(0.0, 1.8, 0.0), Vec3::new(1.0, -0.001, 0.0));
    let at = "huge: R=6371000 centred (0,-6371000,0), o=(0,1.8,0), d=(1,-0.001,0)";
    met(at, v(0.0, -earth, 0.0), earth, eye, down, 2_169.329_885_772_4);
}

fn g02(readings: &mut Readings) {
    let at = |(x, y)| v(x, y, 1.0);
    let big = [(1.0, 0.0), (0.0, 1.0), (-1.0, -1.0)].map(at);
    let tiny = [(0.0, 0.0), (1e-4, 0.0), (0.0, 1e-4)].map(at);
    readings.exact("octant", solid_angle(DVec3::X, DVec3::Y, DVec3::Z), PI / 2.0);
    readings.exact("big", solid_angle(big[0], big[1], big[2]), PI / 3.0);
    readings.exact("tiny", solid_angle(tiny[0], tiny[1], tiny[2]), 4.999_999_98e-9);
}

/// Pixels that are not the same in both.
pub fn differing(a: &Image, b: &Image) -> usize {
    a.pixels().iter().zip(b.pixels()).filter(|(a, b)| a != b).count()
}

fn mean(image: &Image) -> f64 {
    let sum: f64 = image.pixels().iter().map(|p| f64::from(p[0])).sum();
    sum / image.pixels().len() as f64
}

/// An assortment of shapes with a lamp.
fn lit_assortment() -> SceneDescription {
    let mut scene = assortment();
    let (position, intensity) = (v(2.0, -3.0, 5.0), Rgb::splat(30.0));
    light(&mut scene, Light::Point { position, intensity });
    scene
}

/// Acne: what the eye sees, a light at the eye reaches; with shadows and without, the picture is the same.
fn acne(scale: f64) -> usize {
    let scene = moved(&with_light_at_the_eye(assortment()), scale, DVec3::ZERO);
    let unshadowed = SceneDescription { shadows: Shadows::Off, ..scene.clone() };
    differing(&picture(&scene).image, &picture(&unshadowed).image)
}

/// Leaks: lights around a closed box that reach anything in it.
fn leaks(scale: f64) -> usize {
    let mut scene = assortment();
    add(&mut scene, Shape::Block(Block { min: v(-8.0, -8.0, -1.0), max: v(8.0, 8.0, 6.0) }));
    for position in [v(0.0, 0.0, 6.1), v(8.01, 0.0, 2.0), v(0.0, -9.0, 1.0), v(3.0, 3.0, -1.001)] {
        light(&mut scene, Light::Point { position, intensity: Rgb::splat(1000.0) });
    }
    let image = picture(&moved(&scene, scale, DVec3::ZERO)).image;
    image.pixels().iter().filter(|pixel| pixel[0] != 0.0).count()
}

fn g03(readings: &mut Readings) {
    let scene = lit_assortment();
    let reference = mean(&picture(&scene).image);
    for exponent in -6..=6 {
        let scale = 10_f64.powi(exponent);
        let here = mean(&picture(&moved(&scene, scale, DVec3::ZERO)).image);
        let difference = (here / reference - 1.0).abs();
        readings.at_most(format!("k={exponent}, mean off by"), difference, 1e-3);
        readings.exact(format!("k={exponent}, acne pixels"), acne(scale) as f64, 0.0);
        readings.exact(format!("k={exponent}, leak pixels"), leaks(scale) as f64, 0.0);
    }
}

fn g04(readings: &mut Readings) {
    let scene = lit_assortment();
    let reference = mean(&picture(&scene).image);
    for (distance, bound) in [(1e3, 1e-3), (1e4, 1e-2), (1e5, 0.1), (1e6, f64::INFINITY)] {
        let image = picture(&moved(&scene, 1.0, v(distance, -distance, 0.5 * distance))).image;
        if bound.is_finite() {
            let difference = (mean(&image) / reference - 1.0).abs();
            readings.at_most(format!("{distance} m, mean off by"), difference, bound);
        }
        let broken = image.pixels().iter().flatten().filter(|value| !value.is_finite()).count();
        readings.exact(format!("{distance} m, values that are no number"), broken as f64, 0.0);
    }
}

/// Somewhere, turned and sheared.
fn skewed(random: &mut Random) -> DAffine3 {
    let axes = DMat3::from_cols(random.point(), random.point(), random.point());
    DAffine3::from_mat3_translation(axes, 10.0 * random.point())
}

/// Sends so many rays from inside closed meshes, a third of them exactly at vertices and at points of edges. Returns how
/// many escaped.
pub fn escaped(rays: usize) -> usize {
    let far = DAffine3::from_translation(v(148_376.0, 1_234.0, -223_423.0));
    let meshes = [icosphere(5), bumpy_sphere(40), menger_sponge()].map(Arc::new);
    let mut escaped = 0;
    for (number, mesh) in meshes.iter().enumerate() {
        let mut random = Random::new(number as u64);
        // The sponge's middle is hollow and seen through its holes; its first corner cube is solid.
        let inside = if number == 2 { DVec3::splat(-0.9) } else { DVec3::splat(0.01) };
        for (map, copies) in [(DAffine3::IDENTITY, 1), (skewed(&mut random), 2), (far, 1)] {
            let scene = closed(mesh, map, copies);
            for _ in 0..(rays / 9).div_ceil(4096) {
                let ray = |n| leaving(mesh, map, inside, n, &mut random);
                let mut batch: Vec<Ray> = (0..4096).map(ray).collect();
                // Half of them in an order that lets rays go together.
                batch[..2048].sort_by_key(|ray| {
                    let d = ray.direction;
                    (d.is_negative_bitmask(), d.abs().max_position())
                });
                let mut hits = Vec::new();
                scene.closest_hits(&batch, &mut hits);
                escaped += hits.iter().filter(|hit| !hit.is_some()).count();
            }
        }
    }
    escaped
}

/// A mesh in the world; two copies make it one that is brought to its rays.
fn closed(mesh: &Arc<Mesh>, map: DAffine3, copies: usize) -> Scene {
    let mut scene = scene_of(Rgb::ONE);
    scene.meshes.push(Arc::clone(mesh));
    for copy in 0..copies {
        add(&mut scene, Shape::Mesh(0));
        let aside = DAffine3::from_translation(1e3 * copy as f64 * DVec3::X);
        scene.surfaces[copy].transform = aside * map;
    }
    Scene::build(&scene)
}

fn leaving(mesh: &Mesh, map: DAffine3, inside: DVec3, n: usize, random: &mut Random) -> Ray {
    let origin = map.transform_point3(inside + 0.05 * random.point()).as_vec3();
    let corners = mesh.triangles[random.below(mesh.triangles.len())]
        .map(|index| map.transform_point3(mesh.positions[index as usize].as_dvec3()).as_vec3());
    let target = match n % 6 {
        0 => corners[0],
        1 => corners[0].lerp(corners[1], random.unit() as f32),
        _ => return Ray::new(origin, random.direction().as_vec3()),
    };
    Ray::new(origin, (target - origin).normalize())
}

fn g05(readings: &mut Readings) {
    readings.exact("", escaped(1_000_000) as f64, 0.0);
}

/// A convex shape whose coordinates have magnitudes of 10⁻⁸ to 10⁸ of their own.
fn random_scene(kind: usize, random: &mut Random) -> SceneDescription {
    let wide = |random: &mut Random| 10_f64.powf(16.0 * random.unit() - 8.0);
    let place = |random: &mut Random| wide(random) * random.point();
    let (a, b, c, r) = (place(random), place(random), place(random), wide(random));
    let mut scene = scene_of(Rgb::ONE);
    match kind {
        0 => {
            let positions = [a, b, c].map(DVec3::as_vec3).to_vec();
            add_mesh(&mut scene, Mesh { positions, triangles: vec![[0, 1, 2]], ..Mesh::default() });
        }
        1 => add(&mut scene, ball(a, r)),
        2 => add(&mut scene, quad(a, b, c)),
        _ => {
            let (base, top) = (DVec3::ZERO, DVec3::Z);
            add(&mut scene, Shape::Cylinder(Cylinder { base, top, radius: 1.0, capped: true }));
            let axes = DMat3::from_cols(random.point(), random.point(), random.point());
            scene.surfaces[0].transform = DAffine3::from_mat3_translation(axes * r, a);
        }
    }
    scene
}

/// A point of the surface, by a ray of a camera that shows all of it.
fn hit_somewhere(
    description: &SceneDescription,
    scene: &Scene,
    random: &mut Random,
) -> Option<(Ray, Hit)> {
    let view = crate::scene::frame(description, random.direction(), random.direction());
    let camera = crate::camera::Camera::new(&view, 64, 64);
    let film = 64.0 * Vec2::new(random.unit() as f32, random.unit() as f32);
    let (ray, mut hit) = (camera.ray(film, Vec2::ZERO, 0.5), Vec::new());
    scene.closest_hits(&[ray], &mut hit);
    hit[0].is_some().then_some((ray, hit[0]))
}

/// Sends rays away from points of so many shapes. Returns how many left, and how many met their surface again: every
/// shape is convex and seen from outside, so that whatever is met is what was left.
pub fn reintersections(shapes: usize, rays: usize) -> (usize, usize) {
    let mut random = Random::new(6);
    let (mut left, mut met) = (0, 0);
    for number in 0..shapes {
        let description = random_scene(number % 4, &mut random);
        let scene = Scene::build(&description);
        let mut hits = (0..20).map(|_| hit_somewhere(&description, &scene, &mut random));
        let Some((seen_along, hit)) = hits.find_map(|hit| hit) else { continue };
        let surface = scene.interaction(&seen_along, &hit);
        let away = |d: Vec3| if d.dot(surface.geometric_normal) < 0.0 { -d } else { d };
        let leaving: Vec<Ray> = (0..rays)
            .map(|_| Ray::new(surface.ray_origin(), away(random.direction().as_vec3())))
            .collect();
        let mut occluded = Vec::new();
        scene.occluded(&leaving, &mut occluded);
        left += rays;
        met += occluded.iter().filter(|occluded| **occluded).count();
    }
    (left, met)
}

fn g06(readings: &mut Readings) {
    let (left, met) = reintersections(2000, 1000);
    readings.exact("", met as f64, 0.0);
    readings.at_most("shapes that no ray left", 2000.0 - left as f64 / 1000.0, 1500.0);
}

/// A round wall of `n` flat facets with the normals of a cylinder of radius 1 around z.
fn facets(n: u32) -> Mesh {
    let mut mesh = Mesh::default();
    for i in 0..n {
        let (sin, cos) = (TAU * f64::from(i) / f64::from(n)).sin_cos();
        for z in [-1.0, 1.0] {
            mesh.positions.push(v(cos, sin, z).as_vec3());
            mesh.normals.push(v(cos, sin, 0.0).as_vec3());
        }
        let (a, b) = (2 * i, 2 * ((i + 1) % n));
        mesh.triangles.extend([[a, b, a + 1], [a + 1, b, b + 1]]);
    }
    mesh
}

/// The share of the smoothly lit half of an n-gon that is black, and the mean over it relative to a cylinder's.
pub fn terminator(n: u32, shadows: Shadows) -> (f64, f64) {
    let mut scene = SceneDescription { shadows, ..scene_of(Rgb::splat(0.5)) };
    add_mesh(&mut scene, facets(n));
    let (mut lit, mut black, mut sum, mut expected) = (0.0, 0.0, 0.0, 0.0);
    for step in 0..16 {
        let angle = TAU * f64::from(step) / 16.0 / f64::from(n);
        let direction = -v(angle.cos(), angle.sin(), 0.0);
        scene.lights.clear();
        light(&mut scene, Light::Directional { direction, irradiance: Rgb::ONE });
        let built = Scene::build(&scene);
        for i in 0..2000 {
            let phi = TAU * (f64::from(i) + 0.5) / 2000.0;
            let outward = v(phi.cos(), phi.sin(), 0.0);
            let ray = Ray::new((3.0 * outward).as_vec3(), -outward.as_vec3());
            let cos = -outward.dot(direction);
            // The normals of an n-gon are within 1 % of the angle of the cylinder's between its corners.
            if cos > 0.02 {
                let radiance = f64::from(built.trace(&ray, 0.0, f32::INFINITY).x);
                lit += 1.0;
                black += f64::from(u8::from(radiance == 0.0));
                sum += radiance;
                expected += 0.5 / PI * cos;
            }
        }
    }
    (black / lit, sum / expected)
}

fn g07(readings: &mut Readings) {
    for n in [10, 14, 30, 64] {
        let (black, mean) = terminator(n, Shadows::Robust);
        readings.exact(format!("n={n}, black"), black, 0.0);
        readings.at_most(format!("n={n}, mean off by"), (mean - 1.0).abs(), 0.05);
    }
}
