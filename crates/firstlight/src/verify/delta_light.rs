//! Lights without size: the founding lecture's sums, exact but for rounding.

use super::scenes::*;
use super::statistics::mean_over_sphere;
use super::{Case, Readings, Tolerance};
use crate::color::Rgb;
use crate::scene::Scene;
use crate::scene::description::*;
use glam::DVec3;
use std::f64::consts::PI;

const LECTURE: &str =
    "Ray Tracing: Shading (Cornell CS 4620): irradiance of a point source, Lambert's law, R_d/π";

pub(super) const CASES: &[Case] = &[
    Case::exact(
        "L01-point-onaxis",
        "a point light of 100 W, 2 m above a floor of reflectance 0.5",
        LECTURE,
        l01,
    ),
    Case::exact("L02-point-offaxis", "the same light, x beside the point below it", LECTURE, l02),
    Case::exact("L04-lambert-cosine", "the same light, on surfaces that are tilted", LECTURE, l04),
    Case::exact(
        "L05-two-coloured-lights",
        "a red and a blue-green light on a coloured floor",
        LECTURE,
        l05,
    ),
    Case::exact(
        "L06-ambient-plus-direct",
        "ambient light of radiance 0.1 beside the point light",
        LECTURE,
        l06,
    ),
    Case::exact("L07-shadowed", "a cube between floor and light: exactly nothing", LECTURE, l07)
        .within(Tolerance::Absolute(0.0)),
    Case::exact(
        "L08-shadow-ray-not-beyond-light",
        "a cube behind the light casts no shadow",
        LECTURE,
        l08,
    ),
    Case::exact(
        "L09-directional",
        "a directional light of 10 W/m² from several angles",
        LECTURE,
        l09,
    ),
    Case::exact(
        "L10-spot-gltf",
        "a spot of 100 cd with glTF's falloff, 20° to 40°",
        "Khronos KHR_lights_punctual",
        l10,
    ),
    Case::exact(
        "L11-spot-pbrt",
        "a spot of 100 W/sr with a smooth step, 20° to 40°",
        "pbrt-v4 SpotLight",
        l11,
    ),
    Case::exact(
        "L15-point-in-sphere-flux",
        "a light of 100 W off the middle of a black sphere: what arrives on all of it",
        "conservation of flux",
        l15,
    )
    .within(Tolerance::Relative(2e-3)),
    Case::exact(
        "L16-sphere-shadow-umbra",
        "the umbra of a sphere on a floor, in a picture",
        "projective geometry",
        l16,
    )
    .within(Tolerance::Relative(1e-3)),
];

/// P h / (4π (h² + x²)^1.5) for 100 W at a height of 2 m.
fn below_lamp(x: f64) -> f64 {
    100.0 * 2.0 / (4.0 * PI * (4.0_f64 + x * x).powf(1.5))
}

/// The light over a floor of reflectance 0.5.
fn lamp() -> SceneDescription {
    let mut scene = scene_of(Rgb::splat(0.5));
    add(&mut scene, floor());
    light(&mut scene, point_light(v(0.0, 0.0, 2.0), Rgb::splat(100.0)));
    scene
}

fn l01(readings: &mut Readings) {
    let scene = lamp();
    let built = Scene::build(&scene);
    readings.irradiance("E", &built, DVec3::ZERO, DVec3::Z, below_lamp(0.0));
    readings.radiance("L", &built, v(0.5, 0.7, 1.0), DVec3::ZERO, 0.5 / PI * below_lamp(0.0));
}

fn l02(readings: &mut Readings) {
    let scene = Scene::build(&lamp());
    for x in [0.0, 0.5, 1.0, 1.5, 2.0, 4.0] {
        let (place, expected) = (v(x, 0.0, 0.0), below_lamp(x));
        readings.irradiance(format!("x={x}"), &scene, place, DVec3::Z, expected);
        let seen = format!("x={x}, L");
        readings.radiance(seen, &scene, v(x + 0.3, 0.2, 0.9), place, 0.5 / PI * expected);
    }
}

fn l04(readings: &mut Readings) {
    let mut scene = lamp();
    for degrees in [0.0, 30.0, 45.0, 60.0, 75.0, 89.0] {
        let (sin, cos) = f64::to_radians(degrees).sin_cos();
        let normal = v(sin, 0.0, cos);
        scene.surfaces.clear();
        let at = format!("t={degrees}");
        readings.irradiance(&at, &Scene::build(&scene), DVec3::ZERO, normal, below_lamp(0.0) * cos);
        add(&mut scene, Shape::Plane(Plane { point: DVec3::ZERO, normal }));
        let expected = 0.5 / PI * below_lamp(0.0) * cos;
        readings.radiance(
            at + ", L",
            &Scene::build(&scene),
            v(0.6, 0.2, 1.4),
            DVec3::ZERO,
            expected,
        );
    }
}

fn l05(readings: &mut Readings) {
    let reflectance = Rgb::new(0.8, 0.5, 0.2);
    let lights = [
        (v(1.0, 0.0, 1.0), Rgb::new(10.0, 0.0, 0.0)),
        (v(-1.0, 0.0, 2.0), Rgb::new(0.0, 20.0, 5.0)),
    ];
    let (mut scene, mut expected) = (scene_of(reflectance), DVec3::ZERO);
    add(&mut scene, floor());
    for (position, power) in lights {
        light(&mut scene, point_light(position, power));
        let irradiance = position.z / (4.0 * PI * position.length().powi(3));
        expected += (reflectance * power).as_dvec3() / PI * irradiance;
    }
    let seen = look(&scene, v(0.1, -1.0, 1.0), DVec3::ZERO);
    for (channel, name) in ["R", "G", "B"].into_iter().enumerate() {
        readings.exact(name, seen[channel], expected[channel]);
    }
}

fn l06(readings: &mut Readings) {
    let mut scene = lamp();
    light(&mut scene, Light::Ambient { radiance: Rgb::splat(0.1), reach: f64::INFINITY });
    let direct = 0.5 / PI * below_lamp(0.0);
    let eye = v(0.1, -1.0, 1.0);
    readings.radiance("", &Scene::build(&scene), eye, DVec3::ZERO, 0.05 + direct);
    scene.materials[0].ambient_reflectance = Some(Texture::constant(Rgb::splat(0.2)));
    readings.radiance("R_a=0.2", &Scene::build(&scene), eye, DVec3::ZERO, 0.02 + direct);
}

fn l07(readings: &mut Readings) {
    let mut scene = lamp();
    add(&mut scene, cube(v(0.0, 0.0, 1.0), 0.1));
    let scene = Scene::build(&scene);
    readings.radiance("L", &scene, v(0.5, -1.0, 1.0), DVec3::ZERO, 0.0);
    readings.irradiance("E", &scene, DVec3::ZERO, DVec3::Z, 0.0);
}

fn l08(readings: &mut Readings) {
    let mut scene = lamp();
    add(&mut scene, cube(v(0.0, 0.0, 2.5), 0.1));
    let (scene, expected) = (Scene::build(&scene), below_lamp(0.0));
    readings.irradiance("E", &scene, DVec3::ZERO, DVec3::Z, expected);
    readings.radiance("L", &scene, v(0.5, -1.0, 1.0), DVec3::ZERO, 0.5 / PI * expected);
}

fn l09(readings: &mut Readings) {
    for degrees in [0.0, 45.0, 60.0, 85.0] {
        let mut scene = scene_of(Rgb::splat(0.5));
        add(&mut scene, floor());
        let (sin, cos) = f64::to_radians(degrees).sin_cos();
        let direction = v(sin, 0.0, -cos);
        light(&mut scene, Light::Directional { direction, irradiance: Rgb::splat(10.0) });
        let scene = Scene::build(&scene);
        let at = format!("t={degrees}");
        readings.irradiance(at.clone() + ", E", &scene, DVec3::ZERO, DVec3::Z, 10.0 * cos);
        readings.radiance(at + ", L", &scene, v(0.2, 0.3, 1.0), DVec3::ZERO, 5.0 / PI * cos);
    }
}

/// Irradiance 1 m from a spot of 100 W/sr, off its axis by an angle, on a surface that faces it.
fn spot(readings: &mut Readings, falloff: SpotFalloff, part: impl Fn(f64) -> f64) {
    let (inner_angle, outer_angle) = (20_f64.to_radians(), 40_f64.to_radians());
    let (position, direction, intensity) = (DVec3::ZERO, DVec3::X, Rgb::splat(100.0));
    let mut scene = scene_of(Rgb::splat(0.5));
    light(
        &mut scene,
        Light::Spot { position, direction, intensity, inner_angle, outer_angle, falloff },
    );
    let scene = Scene::build(&scene);
    for degrees in [0.0, 15.0, 20.0, 25.0, 30.0, 35.0, 39.9, 40.0, 50.0] {
        let (sin, cos) = f64::to_radians(degrees).sin_cos();
        let place = v(cos, sin, 0.0);
        let step = (cos - outer_angle.cos()) / (inner_angle.cos() - outer_angle.cos());
        let expected = 100.0 * part(step.clamp(0.0, 1.0));
        if degrees == 40.0 {
            // At the edge itself, rounding decides between nothing and next to nothing.
            let there = scene.irradiance(place, -place).value.x;
            readings.at_most("t=40", there.into(), 1e-9);
            continue;
        }
        readings.irradiance(format!("t={degrees}"), &scene, place, -place, expected);
    }
}

fn l10(readings: &mut Readings) {
    spot(readings, SpotFalloff::Gltf, |x| x * x);
}

fn l11(readings: &mut Readings) {
    spot(readings, SpotFalloff::Smoothstep, |x| x * x * (3.0 - 2.0 * x));
}

fn l15(readings: &mut Readings) {
    let mut scene = scene_of(Rgb::ZERO);
    add(&mut scene, ball(DVec3::ZERO, 1.0));
    light(&mut scene, point_light(v(0.3, 0.2, -0.1), Rgb::splat(100.0)));
    let scene = Scene::build(&scene);
    let measure = |seed| {
        let inward = |outward: DVec3| scene.irradiance(outward, -outward).value.x;
        4.0 * PI * mean_over_sphere(50, seed, |outward| inward(outward).into())
    };
    readings.repeated("", measure, 100.0);
}

/// Seen from below the sphere in a picture of 10 m × 10 m.
fn l16(readings: &mut Readings) {
    let mut scene = lamp();
    scene.lights.clear();
    light(&mut scene, point_light(v(0.0, 0.0, 4.0), Rgb::splat(100.0)));
    add(&mut scene, ball(v(0.0, 0.0, 2.0), 1.0));
    let view = Projection::Orthographic { height: 10.0 };
    scene.cameras.push(camera(v(0.0, 0.0, 0.5), DVec3::ZERO, view));
    scene.film = FilmDescription { width: 400, height: 400, samples: 1, ..scene.film };
    let radius = 4.0 * (1.0_f64 / 2.0).asin().tan();
    let dark = |seed| {
        let mut scene = scene.clone();
        scene.film.seed = seed;
        let image = picture(&scene).image;
        image.pixels().iter().filter(|p| p[0] == 0.0).count() as f64 / 160_000.0
    };
    readings.repeated("fraction", dark, PI * radius * radius / 100.0);
    readings.repeated("radius", |seed| (dark(seed) * 100.0 / PI).sqrt(), radius);
}
