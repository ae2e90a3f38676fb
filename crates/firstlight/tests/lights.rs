//! Lights of every kind against closed forms: many at once, spheres in place of points, measured luminaires, skies; and
//! the integrators that gather from them.

mod common;

use common::*;
use firstlight::scene::description::*;
use firstlight::{Meter, Ray, Scene, SceneDescription};
use glam::{DQuat, DVec3, Vec3};
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

fn by_paths(reflectance: f32) -> SceneDescription {
    let mut scene = scene_of(Vec3::splat(reflectance));
    scene.integrator = Integrator::Path { bounces: None };
    scene
}

#[track_caller]
fn expect_irradiance(scene: &SceneDescription, at: DVec3, normal: DVec3, expected: f64) {
    scene.check().expect("the scene is sound");
    let scene = Scene::build(scene);
    expect(|samples| Meter::new(&scene).samples(samples).irradiance(at, normal), expected);
}

#[track_caller]
fn expect_seen(scene: &SceneDescription, origin: DVec3, target: DVec3, expected: f64) {
    let ray = Ray::new(origin.as_vec3(), (target - origin).normalize().as_vec3());
    let scene = Scene::build(scene);
    expect(|samples| Meter::new(&scene).samples(samples).radiance(&ray), expected);
}

fn quad(corner: DVec3, edge_u: DVec3, edge_v: DVec3) -> Shape {
    Shape::Quad(Quad { corner, edge_u, edge_v })
}

fn add_with(scene: &mut SceneDescription, shape: Shape, material: Material) {
    add(scene, shape);
    scene.surfaces.last_mut().expect("just added").material = scene.materials.len();
    scene.materials.push(material);
}

/// Emits 1 to its front and reflects nothing.
fn emitter() -> Material {
    let emission = Texture::constant(Vec3::ONE);
    Material { emission, emits_behind: false, ..Material::matte("emitter", Vec3::ZERO) }
}

fn black() -> Material {
    Material::matte("black", Vec3::ZERO)
}

/// A round light of intensity 1.
fn round(scene: &mut SceneDescription, light: Light, radius: f64) {
    scene.lights.push(LightDescription { radius, ..LightDescription::new("round", light) });
}

fn point(position: DVec3) -> Light {
    Light::Point { position, intensity: Vec3::ONE }
}

fn hard_spot(position: DVec3, direction: DVec3, degrees: f64) -> Light {
    let outer_angle = f64::to_radians(degrees);
    let inner_angle = outer_angle - 1e-9;
    let (falloff, intensity) = (SpotFalloff::Gltf, Vec3::ONE);
    Light::Spot { position, direction, intensity, inner_angle, outer_angle, falloff }
}

/// What a point of intensity 1 gives to the origin, which faces up.
fn given(position: DVec3) -> f64 {
    position.z.max(0.0) / position.length().powi(3)
}

/// Points, spots, spheres and a quad in 1024 pieces: one of all is asked, and stands for their sum.
#[test]
fn one_of_many_lights_stands_for_all() {
    let mut scene = by_paths(0.5);
    let mut expected = 0.752274688; // A01: a unit square 1 m above.
    for i in 0..1024 {
        let at = |i: i32| f64::from(i) / 32.0 - 0.5;
        let corner = v(at(i % 32), at(i / 32), 1.0);
        add_with(&mut scene, quad(corner, DVec3::Y / 32.0, DVec3::X / 32.0), emitter());
    }
    scene.surfaces.iter_mut().for_each(|surface| surface.material = 1);
    for i in 0..60 {
        let angle = f64::from(i);
        let place = v(3.0 * angle.cos(), 3.0 * angle.sin(), 0.05 * angle - 1.0);
        expected += given(place);
        light(&mut scene, point(place));
        // Every other of these shines past the receiver.
        let aim = if i % 2 == 0 { -place.normalize() } else { v(0.0, 0.0, 1.0) };
        let place = 1.3 * place;
        expected += if i % 2 == 0 { given(place) } else { 0.0 };
        light(&mut scene, hard_spot(place, aim, 20.0));
        // High enough that all of the sphere is above the horizon.
        let place = place.with_z(0.6 + 0.03 * angle);
        expected += given(place);
        round(&mut scene, point(place), 0.5);
    }
    for integrator in [Integrator::Path { bounces: None }, Integrator::Direct] {
        scene.integrator = integrator;
        expect_irradiance(&scene, DVec3::ZERO, DVec3::Z, expected);
    }
}

/// Of 1024 points the lecture asks every one; of 2048 that give the same, it asks one, and gets as much.
#[test]
fn of_very_many_points_one_is_asked() {
    let lit_by = |count: u32| {
        let mut scene = scene_of(Vec3::splat(0.5));
        add(&mut scene, quad(DVec3::new(-1.0, -1.0, 0.0), 2.0 * DVec3::X, 2.0 * DVec3::Y));
        for i in 0..count {
            let (sin, cos) = (2.399_963 * f64::from(i)).sin_cos();
            let across = 2.0 * (f64::from(i) / f64::from(count)).sqrt();
            let position = DVec3::new(across * cos, across * sin, 1.0);
            let intensity = Vec3::splat(1.0 / count as f32);
            let light = Light::Point { position, intensity };
            scene.lights.push(LightDescription::new("point", light));
        }
        let view = Projection::Orthographic { height: 1.0 };
        scene.cameras.push(camera(DVec3::new(0.0, 0.0, 2.0), DVec3::ZERO, view));
        scene.film = FilmDescription { width: 16, height: 16, samples: 256, ..scene.film };
        let picture = picture(&scene);
        let sum: f64 = picture.image.pixels().iter().map(|pixel| f64::from(pixel[0])).sum();
        (sum / 256.0, picture.rays)
    };
    let ((all, every), (picked, one)) = (lit_by(1024), lit_by(2048));
    assert_eq!(every.shadow, 1024 * every.camera);
    assert_eq!(one.shadow, one.camera);
    assert!((picked / all - 1.0).abs() < 2e-3, "{picked} is not {all}");
}

#[test]
fn spheres_give_what_points_give_until_something_cuts_them() {
    for radius in [1e-3, 0.2, 1.0] {
        let mut scene = by_paths(0.5);
        let above = v(0.3, -0.4, 2.0);
        round(&mut scene, point(above), radius);
        expect_irradiance(&scene, DVec3::ZERO, DVec3::Z, given(above));
        scene.lights.clear();
        round(&mut scene, point(2.0 * DVec3::Z), radius);
        // The edge of a half plane right below cuts it in two.
        add_with(&mut scene, quad(v(0.0, -9.0, 0.5), 9.0 * DVec3::X, 18.0 * DVec3::Y), black());
        expect_irradiance(&scene, DVec3::ZERO, DVec3::Z, 0.125);
        let lit = Scene::build(&scene).irradiance(v(2.0, 0.0, 0.0), DVec3::Z).value;
        assert_eq!(lit, Vec3::ZERO);
        // Without shadows, its middle is as good.
        scene.lights[0].shadows = false;
        expect_irradiance(&scene, DVec3::ZERO, DVec3::Z, 0.25);
    }
}

#[test]
fn round_spots_keep_their_intensity_and_blur_their_rim() {
    let mut scene = by_paths(0.5);
    round(&mut scene, hard_spot(50.0 * DVec3::Z, -DVec3::Z, 30.0), 0.5);
    expect_irradiance(&scene, DVec3::ZERO, DVec3::Z, 1.0 / 2500.0);
    let rim = 50.0 * f64::to_radians(30.0).tan();
    let built = Scene::build(&scene);
    let at = |x: f64| f64::from(built.irradiance(v(x, 0.0, 0.0), DVec3::Z).value.x);
    let full = |x: f64| given(v(x, 0.0, 50.0));
    close(at(0.95 * rim), full(0.95 * rim), 2e-3);
    assert_eq!(at(1.05 * rim), 0.0);
    close(at(rim), 0.5 * full(rim), 0.05);
}

#[test]
fn what_is_inside_a_sphere_of_light_gets_none() {
    let mut scene = by_paths(0.5);
    round(&mut scene, point(DVec3::ZERO), 1.0);
    let inside = Scene::build(&scene).irradiance(v(0.1, 0.2, 0.3), DVec3::Z).value;
    assert_eq!(inside, Vec3::ZERO);
}

/// A luminaire of 100 cd · cos γ, measured every degree.
fn lambertian() -> Arc<PhotometricWeb> {
    let vertical: Vec<f64> = (0..=90).map(|degrees| f64::from(degrees).to_radians()).collect();
    let intensities = vertical.iter().map(|angle| (100.0 * angle.cos()) as f32).collect();
    let (name, goniometer) = ("lamp.ies".into(), Goniometer::C);
    let horizontal = vec![0.0];
    Arc::new(PhotometricWeb {
        name,
        goniometer,
        horizontal,
        vertical,
        intensities,
        lamp_flux: None,
    })
}

#[test]
fn measured_luminaires_give_what_was_measured() {
    let web = lambertian();
    let factor = Vec3::splat(0.5);
    let hanging = Light::Photometric {
        position: 2.0 * DVec3::Z,
        rotation: DQuat::IDENTITY,
        web: Arc::clone(&web),
        factor,
    };
    for integrator in [Integrator::Path { bounces: None }, Integrator::Direct] {
        let mut scene = by_paths(0.5);
        scene.integrator = integrator;
        light(&mut scene, hanging.clone());
        for (x, tolerance) in [(0.0, 1e-5), (1.0, 1e-4), (3.0, 1e-3)] {
            let cos = 2.0 / f64::hypot(x, 2.0);
            let expected = 50.0 * cos * cos / (x * x + 4.0);
            let built = Scene::build(&scene);
            let found = built.irradiance(v(x, 0.0, 0.0), DVec3::Z).value.x;
            close(found, expected, tolerance);
        }
        let above = Scene::build(&scene).irradiance(v(0.0, 0.0, 4.0), -DVec3::Z).value;
        assert_eq!(above, Vec3::ZERO);
        // Turned on its side it shines along y.
        let Light::Photometric { rotation, .. } = &mut scene.lights[0].light else { panic!() };
        *rotation = DQuat::from_rotation_x(FRAC_PI_2);
        let built = Scene::build(&scene);
        close(built.irradiance(v(0.0, 5.0, 2.0), -DVec3::Y).value.x, 50.0 / 25.0, 1e-5);
        assert_eq!(built.irradiance(DVec3::ZERO, DVec3::Z).value.x, 0.0);
    }
    // With a radius, and as one of many.
    let mut scene = by_paths(0.5);
    for _ in 0..40 {
        scene.lights.push(LightDescription {
            radius: 0.1,
            ..LightDescription::new("lamp", hanging.clone())
        });
    }
    // ∫ cos² over the cone that a sphere of 0.1 m fills 2 m away, over the disk's area.
    let expected = 40.0 * 50.0 * 2.0 * (1.0 - (1.0 - 0.05_f64.powi(2)).powf(1.5)) / (3.0 * 0.01);
    expect_irradiance(&scene, DVec3::ZERO, DVec3::Z, expected);
}

/// All light that a luminaire sends out arrives on a sphere around it.
#[test]
fn the_flux_of_a_luminaire_arrives() {
    let web = lambertian();
    close(web.flux(), 100.0 * PI, 1e-4);
    let mut scene = by_paths(0.0);
    let (position, rotation) = (DVec3::ZERO, DQuat::from_rotation_y(1.0));
    light(&mut scene, Light::Photometric { position, rotation, web, factor: Vec3::ONE });
    let (built, rows, mut sum) = (Scene::build(&scene), 100, 0.0);
    for cell in 0..2 * rows * rows {
        let z = (f64::from(cell % rows) + 0.5) / f64::from(rows) * 2.0 - 1.0;
        let phi = f64::from(cell / rows) / f64::from(rows) * PI;
        let outward = v((1.0 - z * z).sqrt() * phi.cos(), (1.0 - z * z).sqrt() * phi.sin(), z);
        let meter = Meter::new(&built).samples(1);
        sum += f64::from(meter.irradiance(2.0 * outward, -outward).value.x);
    }
    close(sum / f64::from(2 * rows * rows) * 16.0 * PI, 100.0 * PI, 2e-3);
}

/// The sum over lights with an extent is that of the path integrator's first reflection, and no more.
#[test]
fn direct_light_comes_from_every_light_and_does_not_bounce() {
    let mut scene = scene_of(Vec3::splat(0.5));
    let above = quad(v(-0.5, -0.5, 1.0), DVec3::Y, DVec3::X);
    add_with(&mut scene, above, emitter());
    expect_irradiance(&scene, DVec3::ZERO, DVec3::Z, 0.752274688);
    // White walls all around, and ambient light, which is reflected once.
    add(&mut scene, cube(DVec3::ZERO, 8.0));
    add(&mut scene, floor());
    light(&mut scene, point(0.5 * DVec3::Z));
    light(&mut scene, Light::Ambient { radiance: Vec3::splat(0.25), reach: f64::INFINITY });
    expect_irradiance(&scene, DVec3::ZERO, DVec3::Z, 0.752274688 + 4.0 + 0.25 * PI);
    expect_seen(&scene, v(0.3, 0.1, 0.4), DVec3::ZERO, 0.5 * (4.752274688 / PI + 0.25));
    // Under a sky with a sun.
    let mut scene = scene_of(Vec3::splat(0.5));
    let (sky, factor, rotation) = (Sky::Uniform, Vec3::splat(2.0), DQuat::IDENTITY);
    scene.environment = Some(EnvironmentDescription { sky, factor, rotation, visible: true });
    let (direction, irradiance) = (-DVec3::Z, Vec3::splat(3.0));
    light(&mut scene, Light::Sun { direction, irradiance, angular_radius: 0.2 });
    expect_irradiance(&scene, DVec3::ZERO, DVec3::Z, 2.0 * PI + 3.0);
    add(&mut scene, floor());
    expect_seen(&scene, v(0.3, 0.1, 0.4), DVec3::ZERO, 0.5 * (2.0 + 3.0 / PI));
    assert_eq!(look(&scene, DVec3::Z, v(1.0, 0.0, 2.0)), Vec3::splat(2.0));
}

#[test]
fn ambient_occlusion_is_the_part_of_the_sky_that_is_seen() {
    let openness = |scene: &SceneDescription, target: DVec3, expected: f64| {
        expect_seen(scene, target + v(0.3, 0.1, 0.2), target, expected);
    };
    let of = |distance: f64| {
        let mut scene = scene_of(Vec3::splat(0.2));
        scene.integrator = Integrator::AmbientOcclusion { distance };
        add(&mut scene, floor());
        scene
    };
    let mut scene = of(f64::INFINITY);
    openness(&scene, DVec3::ZERO, 1.0);
    expect_irradiance(&scene, v(0.0, 0.0, 1e-3), DVec3::Z, PI);
    add(&mut scene, Shape::Plane(Plane { point: v(-1e-4, 0.0, 0.0), normal: DVec3::X }));
    openness(&scene, DVec3::ZERO, 0.5);
    add(&mut scene, cube(DVec3::ZERO, 4.0));
    let closed = Scene::build(&scene).radiance(&Ray::new(Vec3::new(0.5, 0.5, 0.5), -Vec3::Z));
    assert_eq!(closed.value, Vec3::ZERO);
    // A ceiling at 2 m is met within 4 m in all directions up to 60° from the normal: sin² 60°.
    let mut scene = of(4.0);
    add(&mut scene, Shape::Plane(Plane { point: 2.0 * DVec3::Z, normal: -DVec3::Z }));
    openness(&scene, DVec3::ZERO, 0.25);
    scene.integrator = Integrator::AmbientOcclusion { distance: 1.9 };
    openness(&scene, DVec3::ZERO, 1.0);
    // What is not there is background.
    scene.background = Vec3::splat(0.3);
    scene.surfaces.truncate(1);
    assert_eq!(look(&scene, DVec3::Z, v(1.0, 0.0, 2.0)), Vec3::splat(0.3));
}

/// A black room of 4 × 4 × 3 m with one wall or the roof left out but for a hole, under a sky.
fn room(sky: Sky, walls: &[Shape]) -> SceneDescription {
    let mut scene = scene_of(Vec3::ZERO);
    scene.integrator = Integrator::Path { bounces: None };
    let (factor, rotation) = (Vec3::ONE, DQuat::IDENTITY);
    scene.environment = Some(EnvironmentDescription { sky, factor, rotation, visible: true });
    let (x, y, z) = (4.0 * DVec3::X, 4.0 * DVec3::Y, 3.0 * DVec3::Z);
    let sides = [quad(DVec3::ZERO, y, z), quad(x, y, z), quad(y, x, z), quad(DVec3::ZERO, x, y)];
    sides.into_iter().chain(walls.iter().cloned()).for_each(|shape| add(&mut scene, shape));
    scene
}

/// Irradiance of the ground under the sky alone, with a standard error that does not matter.
fn under(sky: &Sky) -> f64 {
    let scene = room(sky.clone(), &[]);
    let open = SceneDescription { surfaces: Vec::new(), ..scene };
    let meter = Scene::build(&open);
    f64::from(Meter::new(&meter).samples(1 << 20).irradiance(DVec3::ZERO, DVec3::Z).value.x)
}

fn cie(number: u8, azimuth: DVec3, ground: f32) -> Sky {
    let sun = (0.5 * azimuth + 0.75_f64.sqrt() * DVec3::Z).normalize();
    Sky::Cie { number, sun, ground: Vec3::splat(ground) }
}

/// Reference cases Q59: through a roof that is not there; percent of what falls outside.
#[test]
fn q59_cie_skies_light_a_room_through_its_roof() {
    let front = quad(DVec3::ZERO, 4.0 * DVec3::X, 3.0 * DVec3::Z);
    for (number, [a, f, g, m]) in [
        (1, [35.8228502, 14.3601419, 31.8575248, 37.2774677]),
        (5, [45.1226036, 12.9673724, 26.7951875, 30.9387108]),
        (12, [67.278023, 24.1954735, 42.2831133, 22.5742575]),
        (13, [68.1528968, 27.0769707, 47.0132978, 22.3245407]),
    ] {
        let sky = cie(number, DVec3::Y, 0.0);
        let (scene, all) = (room(sky.clone(), std::slice::from_ref(&front)), under(&sky));
        let inside = |z: f64| (v(2.0, 1e-3, z), DVec3::Y);
        let (top, bottom) = (inside(2.75), inside(0.25));
        let on_floor = |y: f64| (v(2.0, y, 1e-3), DVec3::Z);
        for ((at, normal), expected) in
            [(top, a), (bottom, f), (on_floor(0.25), g), (on_floor(3.25), m)]
        {
            let built = Scene::build(&scene);
            let meter = Meter::new(&built).samples(1 << 16);
            let found = 100.0 * f64::from(meter.irradiance(at, normal).value.x) / all;
            close(found, expected, 5e-3);
        }
    }
}

/// Reference cases Q511: through a window of 2 × 1 m, with a ground outside that reflects 0.3.
#[test]
fn q511_cie_skies_and_ground_light_a_room_through_its_window() {
    let strip = |x: f64, z: f64, width: f64, height: f64| {
        quad(v(x, 0.0, z), width * DVec3::X, height * DVec3::Z)
    };
    let walls = [
        strip(0.0, 0.0, 4.0, 1.0),
        strip(0.0, 2.0, 4.0, 1.0),
        strip(0.0, 1.0, 1.0, 1.0),
        strip(3.0, 1.0, 1.0, 1.0),
        quad(3.0 * DVec3::Z, 4.0 * DVec3::X, 4.0 * DVec3::Y),
    ];
    for (number, [a, d, g, m]) in [
        (2, [0.950682247, 1.32977219, 0.916745232, 13.6548667]),
        (5, [0.950682247, 3.08843381, 1.265573, 7.99285306]),
        (10, [0.950682247, 4.10040905, 1.86501621, 13.7800383]),
    ] {
        let dark = cie(number, -DVec3::Y, 0.0);
        let all = under(&dark);
        let sky = cie(number, -DVec3::Y, (0.3 * all / PI) as f32);
        let built = Scene::build(&room(sky, &walls));
        let far = |z: f64| (v(2.0, 4.0 - 1e-3, z), -DVec3::Y);
        let on_floor = |y: f64| (v(2.0, y, 1e-3), DVec3::Z);
        for ((at, normal), expected) in
            [(far(2.75), a), (far(1.25), d), (on_floor(3.75), g), (on_floor(0.75), m)]
        {
            let meter = Meter::new(&built).samples(1 << 18);
            let found = 100.0 * f64::from(meter.irradiance(at, normal).value.x) / all;
            close(found, expected, 5e-3);
        }
    }
}

/// The table that says where to look knows the sky: light found by it and by chance is the sky's own integral.
#[test]
fn clear_skies_give_their_own_integral() {
    for (turbidity, height) in [(2.0, 1.0), (3.0, 0.3), (6.0, 0.7), (9.0, 0.02)] {
        let sun = v(0.4, -0.8, height).normalize();
        let sky = Sky::Clear { turbidity, sun, ground: Vec3::splat(500.0) };
        let scene = room(sky.clone(), &[]);
        let open = SceneDescription { surfaces: Vec::new(), ..scene };
        let built = Scene::build(&open);
        let radiance = |direction: DVec3| {
            let ray = Ray::new(Vec3::ZERO, direction.as_vec3());
            built.trace(&ray, 0.0, f32::INFINITY).x
        };
        let parts = 400;
        let at = |i: i32| (f64::from(i) + 0.5) / f64::from(parts);
        let part = |i: i32| {
            let (sin2, (sin_phi, cos_phi)) = (at(i % parts), (2.0 * PI * at(i / parts)).sin_cos());
            let sin = sin2.sqrt();
            f64::from(radiance(v(sin * cos_phi, sin * sin_phi, (1.0 - sin2).sqrt())))
        };
        let all = PI * (0..parts * parts).map(part).sum::<f64>() / f64::from(parts * parts);
        assert!(all > 100.0);
        expect(|n| Meter::new(&built).samples(n).irradiance(DVec3::ZERO, DVec3::Z), all);
        expect(|n| Meter::new(&built).samples(n).irradiance(DVec3::ZERO, -DVec3::Z), 500.0 * PI);
    }
}
