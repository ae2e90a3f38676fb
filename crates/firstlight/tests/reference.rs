//! Closed-form cases of delta lights, cameras and pictures, through the path that renders pictures.
//! The names are those of the project's table of reference values.

mod common;

use common::*;
use firstlight::Scene;
use firstlight::scene::description::*;
use glam::{DVec3, Vec3};
use std::f64::consts::PI;

const EXACT: f64 = 1e-5;

/// L01: E = P / (4π r²), L = R_d/π · E; both by the meter and by a ray that sees the floor.
#[test]
fn l01_point_light_on_the_axis() {
    let mut scene = scene_of(Vec3::splat(0.5));
    add(&mut scene, floor());
    light(&mut scene, point_light(v(0.0, 0.0, 2.0), Vec3::splat(100.0)));
    close(Scene::build(&scene).irradiance(DVec3::ZERO, DVec3::Z).value.x, 1.98943679, EXACT);
    close(look(&scene, v(0.5, 0.7, 1.0), DVec3::ZERO).x, 0.316628699, EXACT);
}

/// L02: E = P h / (4π (h² + x²)^1.5).
#[test]
fn l02_point_light_off_the_axis() {
    let mut scene = scene_of(Vec3::splat(0.5));
    add(&mut scene, floor());
    light(&mut scene, point_light(v(0.0, 0.0, 2.0), Vec3::splat(100.0)));
    let built = Scene::build(&scene);
    let cases = [
        (0.0, 1.98943679),
        (0.5, 1.81650558),
        (1.0, 1.42352509),
        (1.5, 1.01859164),
        (2.0, 0.703372122),
        (4.0, 0.177940636),
    ];
    for (x, expected) in cases {
        close(built.irradiance(v(x, 0.0, 0.0), DVec3::Z).value.x, expected, EXACT);
        let seen = look(&scene, v(x + 0.3, 0.2, 0.9), v(x, 0.0, 0.0)).x;
        close(seen, 0.5 / PI * expected, EXACT);
    }
}

/// L04: Lambert's cosine law.
#[test]
fn l04_lamberts_cosine_law() {
    let mut scene = scene_of(Vec3::splat(0.5));
    light(&mut scene, point_light(v(0.0, 0.0, 2.0), Vec3::splat(100.0)));
    let built = Scene::build(&scene);
    for (degrees, expected) in [
        (0.0, 1.98943679),
        (30.0, 1.7229028),
        (45.0, 1.40674424),
        (60.0, 0.994718394),
        (75.0, 0.51490413),
        (89.0, 0.0347204594),
    ] {
        let (sin, cos) = f64::to_radians(degrees).sin_cos();
        close(built.irradiance(DVec3::ZERO, v(sin, 0.0, cos)).value.x, expected, EXACT);
        let mut tilted = scene.clone();
        add(&mut tilted, Shape::Plane(Plane { point: DVec3::ZERO, normal: v(sin, 0.0, cos) }));
        let seen = look(&tilted, v(0.6, 0.2, 1.4), DVec3::ZERO).x;
        close(seen, 0.5 / PI * expected, EXACT);
    }
}

#[test]
fn l05_two_coloured_lights() {
    let mut scene = scene_of(Vec3::new(0.8, 0.5, 0.2));
    add(&mut scene, floor());
    light(&mut scene, point_light(v(1.0, 0.0, 1.0), Vec3::new(10.0, 0.0, 0.0)));
    light(&mut scene, point_light(v(-1.0, 0.0, 2.0), Vec3::new(0.0, 20.0, 5.0)));
    let seen = look(&scene, v(0.1, -1.0, 1.0), DVec3::ZERO);
    close(seen.x, 0.071644896, EXACT);
    close(seen.y, 0.0453122108, EXACT);
    close(seen.z, 0.00453122108, EXACT);
}

/// L06: L = R_a L_a + R_d/π · E, also with R_a unlike R_d.
#[test]
fn l06_ambient_plus_direct() {
    let mut scene = scene_of(Vec3::splat(0.5));
    add(&mut scene, floor());
    light(&mut scene, point_light(v(0.0, 0.0, 2.0), Vec3::splat(100.0)));
    light(&mut scene, Light::Ambient { radiance: Vec3::splat(0.1) });
    close(look(&scene, v(0.1, -1.0, 1.0), DVec3::ZERO).x, 0.366628699, EXACT);
    scene.materials[0].ambient_reflectance = Some(Texture::constant(Vec3::splat(0.2)));
    close(look(&scene, v(0.1, -1.0, 1.0), DVec3::ZERO).x, 0.336628699, EXACT);
}

#[test]
fn l07_what_is_in_shadow_gets_exactly_nothing() {
    let mut scene = scene_of(Vec3::splat(0.5));
    add(&mut scene, floor());
    add(&mut scene, cube(v(0.0, 0.0, 1.0), 0.1));
    light(&mut scene, point_light(v(0.0, 0.0, 2.0), Vec3::splat(100.0)));
    assert_eq!(look(&scene, v(0.5, -1.0, 1.0), DVec3::ZERO), Vec3::ZERO);
    assert_eq!(Scene::build(&scene).irradiance(DVec3::ZERO, DVec3::Z).value, Vec3::ZERO);
}

/// The meter honours the scene's shadow setting, as the render does.
#[test]
fn without_shadows_the_meter_sees_every_light() {
    let mut scene = scene_of(Vec3::splat(0.5));
    scene.shadows = Shadows::Off;
    add(&mut scene, cube(v(0.0, 0.0, 1.0), 0.1));
    light(&mut scene, point_light(v(0.0, 0.0, 2.0), Vec3::splat(100.0)));
    close(Scene::build(&scene).irradiance(DVec3::ZERO, DVec3::Z).value.x, 1.98943679, EXACT);
}

/// A sheet of alpha 0.4 stops 40 % of the light and of the view; chance decides, and the meter says how well it knows.
#[test]
fn partly_transparent_surfaces_are_measured_with_their_error() {
    let mut scene = scene_of(Vec3::splat(0.2));
    scene.materials[0].alpha = Alpha::Blend;
    scene.materials[0].reflectance.factor[3] = 0.4;
    scene.background = Vec3::ONE;
    let ambient = 0.5;
    light(&mut scene, Light::Ambient { radiance: Vec3::splat(ambient) });
    light(&mut scene, Light::Directional { direction: -DVec3::Z, irradiance: Vec3::ONE });
    add(&mut scene, floor());
    let scene = Scene::build(&scene);
    let through = firstlight::Ray::new(Vec3::new(0.0, 0.0, 1.0), -Vec3::Z);
    let lit = 0.2 * (f64::from(ambient) + 1.0 / PI);
    for (measured, expected) in [
        (scene.radiance(&through), 0.4 * lit + 0.6),
        (scene.irradiance(v(0.0, 0.0, -1.0), DVec3::Z), PI * f64::from(ambient) + 0.6),
    ] {
        let (value, error) = (f64::from(measured.value.x), f64::from(measured.standard_error.x));
        assert!(error > 0.0 && error < 0.02 && measured.samples > 1, "{measured:?}");
        assert!((value - expected).abs() < 4.0 * error, "{measured:?} is not {expected}");
    }
}

#[test]
fn l08_what_is_behind_the_light_casts_no_shadow() {
    let mut scene = scene_of(Vec3::splat(0.5));
    add(&mut scene, floor());
    add(&mut scene, cube(v(0.0, 0.0, 2.5), 0.1));
    light(&mut scene, point_light(v(0.0, 0.0, 2.0), Vec3::splat(100.0)));
    close(Scene::build(&scene).irradiance(DVec3::ZERO, DVec3::Z).value.x, 1.98943679, EXACT);
    close(look(&scene, v(0.5, -1.0, 1.0), DVec3::ZERO).x, 0.316628699, EXACT);
}

#[test]
fn l09_directional_light() {
    for (degrees, irradiance, radiance) in [
        (0.0, 10.0, 1.59154943),
        (45.0, 7.07106781, 1.1253954),
        (60.0, 5.0, 0.795774715),
        (85.0, 0.871557427, 0.138712673),
    ] {
        let mut scene = scene_of(Vec3::splat(0.5));
        add(&mut scene, floor());
        let (sin, cos) = f64::to_radians(degrees).sin_cos();
        let direction = v(sin, 0.0, -cos);
        light(&mut scene, Light::Directional { direction, irradiance: Vec3::splat(10.0) });
        close(Scene::build(&scene).irradiance(DVec3::ZERO, DVec3::Z).value.x, irradiance, EXACT);
        close(look(&scene, v(0.2, 0.3, 1.0), DVec3::ZERO).x, radiance, EXACT);
    }
}

/// L10 and L11: irradiance 1 m from a spot, off its axis by an angle, on a surface that faces it.
fn spot(falloff: SpotFalloff, cases: &[(f64, f64)]) {
    let mut scene = scene_of(Vec3::splat(0.5));
    let (inner_angle, outer_angle) = (20_f64.to_radians(), 40_f64.to_radians());
    let (position, direction, intensity) = (DVec3::ZERO, DVec3::X, Vec3::splat(100.0));
    light(
        &mut scene,
        Light::Spot { position, direction, intensity, inner_angle, outer_angle, falloff },
    );
    let scene = Scene::build(&scene);
    for &(degrees, expected) in cases {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let place = v(cos, sin, 0.0);
        close(scene.irradiance(place, -place).value.x, expected, EXACT);
    }
}

#[test]
fn l10_spot_with_the_falloff_of_gltf() {
    spot(
        SpotFalloff::Gltf,
        &[
            (0.0, 100.0),
            (15.0, 100.0),
            (20.0, 100.0),
            (25.0, 65.2451024),
            (30.0, 33.1508105),
            (35.0, 9.35347329),
            (39.9, 0.00416528789),
            (40.0, 0.0),
            (50.0, 0.0),
        ],
    );
}

#[test]
fn l11_spot_with_the_falloff_of_pbrt() {
    spot(
        SpotFalloff::Smoothstep,
        &[
            (0.0, 100.0),
            (15.0, 100.0),
            (20.0, 100.0),
            (25.0, 90.3325743),
            (30.0, 61.2781192),
            (35.0, 22.3391905),
            (39.9, 0.0124420989),
            (40.0, 0.0),
            (50.0, 0.0),
        ],
    );
}

/// L15: all the power of a light arrives on the sphere around it. Midpoints of equal areas stand in for a random
/// choice: at a smooth integrand they leave no error to speak of.
#[test]
fn l15_flux_through_a_sphere_around_the_light() {
    let mut scene = scene_of(Vec3::ZERO);
    add(&mut scene, Shape::Sphere(Sphere { center: DVec3::ZERO, radius: 1.0 }));
    light(&mut scene, point_light(v(0.3, 0.2, -0.1), Vec3::splat(100.0)));
    let scene = Scene::build(&scene);
    let (rows, columns) = (200, 400);
    let mut sum = 0.0;
    for row in 0..rows {
        for column in 0..columns {
            let z = (f64::from(row) + 0.5) / f64::from(rows) * 2.0 - 1.0;
            let phi = (f64::from(column) + 0.5) / f64::from(columns) * 2.0 * PI;
            let r = (1.0 - z * z).sqrt();
            let outward = v(r * phi.cos(), r * phi.sin(), z);
            sum += f64::from(scene.irradiance(outward, -outward).value.x);
        }
    }
    close(sum / f64::from(rows * columns) * 4.0 * PI, 100.0, 2e-3);
}

/// L16: the umbra of a sphere, seen from below the sphere in a picture of 10 m × 10 m.
#[test]
fn l16_umbra_of_a_sphere() {
    let mut scene = scene_of(Vec3::splat(0.5));
    add(&mut scene, floor());
    add(&mut scene, Shape::Sphere(Sphere { center: v(0.0, 0.0, 2.0), radius: 1.0 }));
    light(&mut scene, point_light(v(0.0, 0.0, 4.0), Vec3::splat(100.0)));
    let view = Projection::Orthographic { height: 10.0 };
    scene.cameras.push(camera(v(0.0, 0.0, 0.5), DVec3::ZERO, view));
    scene.film.width = 1000;
    scene.film.height = 1000;
    scene.film.samples = 1;
    let image = picture(&scene).image;
    let dark = image.pixels().iter().filter(|p| p[0] == 0.0).count() as f64;
    close(dark / 1e6, 0.167551608, 1e-3);
    close((dark / 1e6 * 100.0 / PI).sqrt(), 2.30940108, 1e-3);
}

/// K01: the part of the picture that a sphere fills.
#[test]
fn k01_coverage_of_a_sphere() {
    let mut scene = scene_of(Vec3::splat(0.5));
    add(&mut scene, Shape::Sphere(Sphere { center: DVec3::ZERO, radius: 1.0 }));
    let view = Projection::Perspective { vertical_fov: 40_f64.to_radians() };
    scene.cameras.push(camera(v(0.0, -5.0, 0.0), DVec3::ZERO, view));
    scene.film = FilmDescription { width: 256, height: 256, transparent: true, ..scene.film };
    let image = picture(&scene).image;
    let covered: f64 = image.pixels().iter().map(|p| f64::from(p[3])).sum();
    close(covered / (256.0 * 256.0), 0.24702841, 5e-4);
}

/// K03: a small sphere out of focus becomes a disk of diameter A |d − d_f| / d on the plane in focus. The diameter is
/// found from the second moment of the picture, D²/16 along each axis, less that of the sphere itself, r²/4.
#[test]
fn k03_circle_of_confusion_of_a_thin_lens() {
    for (depth, expected) in [(1.0, 0.1), (3.0, 0.0333333333), (10.0, 0.08)] {
        let (focus_distance, aperture) = (2.0, 0.1);
        let (window, radius) = (1.5 * expected, expected / 8.0);
        let mut scene = scene_of(Vec3::ZERO);
        let center = v(0.0, depth, 0.0);
        let sphere = Sphere { center, radius: radius * depth / focus_distance };
        add(&mut scene, Shape::Sphere(sphere));
        let vertical_fov = 2.0 * f64::atan(window / 2.0 / focus_distance);
        let view = Projection::ThinLens { vertical_fov, aperture, focus_distance };
        scene.cameras.push(camera(DVec3::ZERO, DVec3::Y, view));
        let filter = Filter::Box { radius: 0.5 };
        let (width, samples) = (128, 64);
        scene.film = FilmDescription {
            width,
            height: width,
            samples,
            filter,
            transparent: true,
            ..scene.film
        };
        let image = picture(&scene).image;
        let (mut weight, mut moment) = (0.0, 0.0);
        for (index, pixel) in image.pixels().iter().enumerate() {
            let column = (index % width as usize) as f64 + 0.5;
            let x = (column / f64::from(width) - 0.5) * window;
            weight += f64::from(pixel[3]);
            moment += f64::from(pixel[3]) * x * x;
        }
        close(4.0 * (moment / weight - radius * radius / 4.0).sqrt(), expected, 0.01);
    }
}

/// K06: an edge at 0.3 of a pixel, under the box filter.
#[test]
fn k06_box_filter_at_an_edge() {
    let mut scene = scene_of(Vec3::ZERO);
    scene.materials[0].emission = Texture::constant(Vec3::ONE);
    let quad =
        Quad { corner: v(-1.0, 0.0, -1.0), edge_u: v(0.8, 0.0, 0.0), edge_v: v(0.0, 0.0, 2.0) };
    add(&mut scene, Shape::Quad(quad));
    scene.cameras.push(camera(
        v(0.0, -1.0, 0.0),
        DVec3::ZERO,
        Projection::Orthographic { height: 1.0 },
    ));
    let filter = Filter::Box { radius: 0.5 };
    scene.film = FilmDescription { width: 1, height: 1, samples: 4096, filter, ..scene.film };
    close(picture(&scene).image.get(0, 0).x, 0.3, 0.002 / 0.3);
}

/// Every filter leaves a constant picture as it is, to the last bit.
#[test]
fn filters_keep_a_constant() {
    let mitchell = Filter::Mitchell { radius: 2.0, b: 1.0 / 3.0, c: 1.0 / 3.0 };
    let filters =
        [Filter::Box { radius: 0.5 }, Filter::Tent { radius: 1.0 }, Filter::default(), mitchell];
    for filter in filters {
        for samples in [1, 2, 5, 16, 33] {
            let mut scene = scene_of(Vec3::ZERO);
            scene.background = Vec3::new(0.25, 0.5, 0.75);
            scene.film = FilmDescription { width: 7, height: 5, samples, filter, ..scene.film };
            let image = picture(&scene).image;
            let flat = |p: &[f32; 4]| *p == [0.25, 0.5, 0.75, 1.0];
            assert!(image.pixels().iter().all(flat), "{filter:?} {samples}");
        }
    }
}
