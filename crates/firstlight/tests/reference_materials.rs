//! Reference cases of materials, by the path integrator: furnaces in which what loses no light cannot be seen.

mod common;

use common::*;
use firstlight::scene::description::*;
use firstlight::verify::white::{glass, pane, principled};
use firstlight::{Meter, Ray, Scene, SceneDescription};
use glam::{DQuat, DVec3, Vec2, Vec3};

/// A scene for paths of any length in light of radiance 1 from everywhere; `materials` have the indices from 0.
fn furnace(materials: Vec<Material>) -> SceneDescription {
    let mut scene = SceneDescription { materials, ..SceneDescription::default() };
    scene.integrator = Integrator::Path { bounces: None };
    let (rotation, factor) = (DQuat::IDENTITY, Vec3::ONE);
    let environment = EnvironmentDescription { sky: Sky::Uniform, factor, rotation, visible: true };
    scene.environment = Some(environment);
    scene
}

/// Radiance along a ray, by enough samples that it is known to `error`.
#[track_caller]
fn radiance(scene: &Scene, ray: &Ray, error: f64) -> Vec3 {
    let mut tries = (8..=18).step_by(2).map(|k| Meter::new(scene).samples(1 << k).radiance(ray));
    let known = tries.find(|m| f64::from(m.standard_error.max_element()) <= error);
    known.expect("the standard error falls").value
}

fn toward(origin: DVec3, target: DVec3) -> Ray {
    Ray::new(origin.as_vec3(), (target - origin).normalize().as_vec3())
}

/// M16 through the tracer: what is absorbed on the way through a solid of the index of air.
#[test]
fn solids_absorb_as_beer_and_lambert_say() {
    let mut clear = glass(1.0, 0.0);
    clear.interior.as_mut().expect("it is solid").absorption = Vec3::new(0.7, 0.0, 10.0);
    let mut scene = furnace(vec![clear]);
    add_with(&mut scene, cube(DVec3::ZERO, 2.0), 0);
    let seen = radiance(&Scene::build(&scene), &toward(v(0.0, -5.0, 0.0), DVec3::ZERO), 1e-9);
    close(seen.x, 0.246596964, 1e-5);
    close(seen.y, 1.0, 1e-6);
    close(seen.z, (-20.0_f64).exp(), 1e-4);
}

/// PA4: under a white sky a sheet of white metal is white, or what its facets scatter once if that alone is asked for.
#[test]
fn rough_metal_may_be_left_with_what_it_scatters_once() {
    let (angle, once) = (60_f64.to_radians(), [(0.3_f32, 0.821711053), (1.0, 0.450693847)]);
    let ray = toward(v(angle.tan(), 0.0, 1.0), DVec3::ZERO);
    for ((alpha, once), several) in once.into_iter().flat_map(|o| [(o, false), (o, true)]) {
        let mut facets = Facets::of(Scalar::constant(alpha.sqrt()));
        facets.multiple_scattering = several;
        let scattering = Scattering::Conductor { index: None, facets };
        let metal = Material { scattering, ..Material::matte("metal", Vec3::ONE) };
        let mut scene = furnace(vec![metal]);
        add(&mut scene, floor());
        let seen = radiance(&Scene::build(&scene), &ray, 1e-3).x;
        close(seen, if several { 1.0 } else { once }, 5e-3);
    }
}

/// What is unlit is a colour for the eye, on the way there by mirrors and clear glass as well; it is no lamp.
#[test]
fn unlit_surfaces_are_seen_and_light_nothing() {
    let panel = |x| {
        let (corner, edge_u) = (v(x, 1.0, 0.0), v(0.0, 0.0, 2.0));
        Shape::Quad(Quad { corner, edge_u, edge_v: v(2.0, 0.0, 0.0) })
    };
    let emission = Texture::constant(Vec3::new(0.2, 0.4, 3.0));
    for (unlit, integrator) in [
        (true, Integrator::Path { bounces: None }),
        (true, Integrator::Direct),
        (false, Integrator::Path { bounces: None }),
    ] {
        let sign =
            Material { unlit, emission: emission.clone(), ..Material::matte("sign", Vec3::ZERO) };
        let floor_of = Material::matte("floor", Vec3::ONE);
        let mut scene =
            furnace(vec![sign, floor_of, Material::mirror("mirror", Vec3::ONE), pane(1.0)]);
        (scene.environment, scene.integrator) = (None, integrator);
        light(&mut scene, point_light(v(0.0, 0.0, 50.0), Vec3::ZERO));
        add_with(&mut scene, panel(-1.0), 0);
        add_with(&mut scene, floor(), 1);
        let wall = Quad {
            corner: v(-5.0, -5.0, 0.0),
            edge_u: v(10.0, 0.0, 0.0),
            edge_v: v(0.0, 0.0, 9.0),
        };
        add_with(&mut scene, Shape::Quad(wall), 2);
        let glass = Disk { center: v(0.0, 0.5, 1.0), normal: DVec3::Y, radius: 0.4 };
        add_with(&mut scene, Shape::Disk(glass), 3);
        let seen = Scene::build(&scene);
        let through = radiance(&seen, &toward(v(0.0, 0.0, 1.0), v(0.0, 1.0, 1.0)), 1e-6);
        close(through.z, 3.0, 1e-6);
        if integrator != Integrator::Direct {
            let mirrored = radiance(&seen, &toward(v(0.7, 0.9, 1.0), v(0.7, -5.0, 1.0)), 1e-6);
            close(mirrored.y, 0.4, 1e-6);
        }
        let before = seen.irradiance(v(0.0, 0.0, 0.0), DVec3::Z).value;
        assert_eq!(before == Vec3::ZERO, unlit, "{before}");
        let ground = radiance(&seen, &toward(v(0.0, 0.0, 0.5), v(0.5, 0.3, 0.0)), 1e-2);
        assert_eq!(ground == Vec3::ZERO, unlit, "{ground}");
    }
}

/// Panes tint the light of point lights and suns, and do not stop it.
#[test]
fn lights_shine_through_panes() {
    for integrator in [Integrator::Direct, Integrator::Path { bounces: Some(1) }] {
        let mut scene = furnace(vec![Material::matte("floor", Vec3::ONE), pane(1.5)]);
        (scene.environment, scene.integrator) = (None, integrator);
        add_with(&mut scene, floor(), 0);
        let without = {
            light(&mut scene, point_light(v(0.0, 0.0, 4.0), Vec3::splat(100.0)));
            look(&scene, v(0.0, -3.0, 1.0), DVec3::ZERO)
        };
        let normal = DVec3::Z;
        add_with(
            &mut scene,
            Shape::Disk(Disk { center: v(0.0, 0.0, 2.0), normal, radius: 0.5 }),
            1,
        );
        let with = look(&scene, v(0.0, -3.0, 1.0), DVec3::ZERO);
        // 4 % at each side, all reflections between them: (1 − 0.04) / (1 + 0.04).
        close(with.x / without.x, 0.96 / 1.04, 1e-5);
    }
}

/// Half of a white surface over black, by mixing, is grey; so is half of one that is only half there.
#[test]
fn mixes_and_opacity_are_shares() {
    let amount = Scalar::constant(0.25);
    let mix = Scattering::Mix { materials: [0, 1], amount };
    let mut half_there = Material { alpha: Alpha::Blend, ..Material::matte("veil", Vec3::ZERO) };
    half_there.reflectance.factor[3] = 0.25;
    let mut scene = furnace(vec![
        Material::matte("white", Vec3::ONE),
        Material::matte("black", Vec3::ZERO),
        Material { scattering: mix, ..Material::matte("mix", Vec3::ONE) },
        half_there,
    ]);
    let quad =
        |x: f64| Shape::Quad(Quad { corner: v(x, 0.0, 0.0), edge_u: DVec3::X, edge_v: DVec3::Y });
    add_with(&mut scene, quad(0.0), 2);
    add_with(&mut scene, quad(2.0), 3);
    scene.check().expect("the scene is sound");
    let scene = Scene::build(&scene);
    let seen = radiance(&scene, &toward(v(0.5, 0.5, 3.0), v(0.6, 0.5, 0.0)), 2e-3).x;
    assert!((seen - 0.75).abs() < 8e-3, "{seen}");
    // Whether a ray meets something that is half there is decided once for the ray.
    let passes = |i: i32| {
        let target = v(2.1 + 1e-4 * f64::from(i), 0.5, 0.0);
        scene.trace(&toward(v(2.5, 0.5, 3.0), target), 0.0, f32::INFINITY).x
    };
    let mean = (0..8000).map(passes).sum::<f32>() / 8000.0;
    assert!((mean - 0.75).abs() < 0.02, "{mean}");
}

/// A closed body of what absorbs and scatters, without a boundary.
fn cloud(absorption: f32, scattering: f32, anisotropy: f32) -> Material {
    let mut cloud = glass(1.0, 0.0);
    let inside = cloud.interior.as_mut().expect("it is solid");
    inside.absorption = Vec3::splat(absorption);
    (inside.scattering, inside.anisotropy) = (Vec3::splat(scattering), anisotropy);
    cloud
}

/// Clouds that only scatter cannot be seen in a furnace, with and without a wall of glass; inside they are n² brighter.
#[test]
fn white_clouds_are_invisible_in_a_furnace() {
    for (index, g) in [(1.0, 0.0), (1.0, 0.8), (1.0, -0.5), (1.5, 0.3)] {
        let mut cloud = cloud(0.0, 3.0, g);
        cloud.interior.as_mut().expect("it is solid").index = index;
        let mut scene = furnace(vec![cloud, Material::matte("white", Vec3::ONE)]);
        add_with(&mut scene, ball(DVec3::ZERO, 1.0), 0);
        add_with(&mut scene, ball(v(0.2, 0.0, 0.1), 0.4), 1);
        let scene = Scene::build(&scene);
        for (from, expected) in [(v(0.0, -5.0, 0.0), 1.0), (v(0.0, -0.6, 0.0), index * index)] {
            for target in [v(0.1, 0.0, 0.0), v(0.7, 0.0, 0.1)] {
                let seen = radiance(&scene, &toward(from, target), 2e-3 * f64::from(index)).x;
                assert!(
                    (seen / expected - 1.0).abs() < 8e-3,
                    "{index} {g} {from} {target}: {seen}"
                );
            }
        }
    }
}

/// Light on its way through fog, through clouds that it meets, and seen from inside of one.
#[test]
fn fog_weakens_what_is_seen_and_what_gives_light() {
    let mut scene = furnace(vec![Material::matte("floor", Vec3::ONE), cloud(0.7, 0.0, 0.0)]);
    scene.environment = None;
    light(&mut scene, point_light(v(0.0, 0.0, 4.0), Vec3::splat(100.0)));
    let clear = Scene::build(&scene).irradiance(DVec3::ZERO, DVec3::Z).value.x;
    add_with(&mut scene, cube(v(0.0, 0.0, 2.0), 2.0), 1);
    for integrator in [Integrator::Direct, Integrator::Path { bounces: None }] {
        scene.integrator = integrator;
        let through = Scene::build(&scene).irradiance(DVec3::ZERO, DVec3::Z).value.x;
        close(through / clear, 0.246596964, 1e-5);
        let (absorption, scattering) = (Vec3::splat(0.3), Vec3::ZERO);
        let fog = Some(Medium { absorption, scattering, anisotropy: 0.0 });
        let everywhere = SceneDescription { medium: fog, ..scene.clone() };
        let both = Scene::build(&everywhere).irradiance(DVec3::ZERO, DVec3::Z).value.x;
        close(both / clear, (-2.0_f64 * 0.3 - 1.4).exp(), 1e-5);
    }
    // What is not left by the ray has to be known: a cloud around the eye and around what it sees.
    let mut inside = furnace(vec![cloud(0.7, 1e-6, 0.0), emitter(1.0)]);
    inside.environment = None;
    add_with(&mut inside, ball(DVec3::ZERO, 10.0), 0);
    add_with(&mut inside, cube(v(0.0, 2.5, 0.0), 1.0), 1);
    let seen = radiance(&Scene::build(&inside), &toward(DVec3::ZERO, v(0.0, 1.0, 0.0)), 1e-4).x;
    close(seen, 0.246596964, 1e-3);
}

fn emitter(radiance: f32) -> Material {
    let emission = Texture::constant(Vec3::splat(radiance));
    Material { emission, ..Material::matte("emitter", Vec3::ZERO) }
}

/// `direct` shows light that was scattered once: of a half space ω E / 8π, straight on.
#[test]
fn direct_light_is_scattered_once_by_fog() {
    let mut scene = furnace(vec![cloud(0.1, 0.9, 0.0)]);
    (scene.environment, scene.integrator) = (None, Integrator::Direct);
    add_with(&mut scene, floor(), 0);
    light(&mut scene, Light::Directional { direction: -DVec3::Z, irradiance: Vec3::ONE });
    let seen = radiance(&Scene::build(&scene), &toward(DVec3::Z, DVec3::ZERO), 3e-5).x;
    close(seen, 0.9 / (8.0 * std::f64::consts::PI), 3e-3);
}

/// A light that is picked for many, in fog and behind a sheet that light passes: as much as if all were one.
#[test]
fn lights_are_picked_on_all_sides_where_light_passes() {
    let paper = principled("paper", |p| p.diffuse_transmission = Scalar::constant(1.0));
    for (material, shape) in [
        (cloud(0.0, 0.5, 0.3), cube(DVec3::ZERO, 2.0)),
        (paper, Shape::Disk(Disk { center: DVec3::ZERO, normal: DVec3::Y, radius: 1.0 })),
    ] {
        let mut scene = furnace(vec![material]);
        scene.environment = None;
        add_with(&mut scene, shape, 0);
        let mut seen = |lights: u32| {
            scene.lights.clear();
            for i in 0..lights {
                let place = v(0.3 * f64::from(i % 2), 2.0, 0.1 * f64::from(i % 3));
                light(&mut scene, point_light(place, Vec3::splat(120.0 / lights as f32)));
            }
            let meter = Scene::build(&scene);
            let ray = toward(v(0.0, -5.0, 0.5), v(0.0, 0.0, 0.3));
            let found = Meter::new(&meter).samples(1 << 18).radiance(&ray);
            (f64::from(found.value.x), f64::from(found.standard_error.x))
        };
        let ((few, few_error), (many, many_error)) = (seen(6), seen(60));
        let z = (few - many) / few_error.hypot(many_error).max(1e-6 * few);
        assert!(few > 0.1 && z.abs() < 4.5, "{few} ± {few_error}, {many} ± {many_error}");
    }
}

/// A surface that rises by a tenth of its length is lit by a light above it as one that leans so.
#[test]
fn bump_maps_lean_surfaces_as_their_heights_do() {
    let rise = |amount| {
        let pattern = Pattern::Gradient {
            colors: [[0.0; 4], [1.0; 4]],
            from: Vec2::new(-5.0, 0.0),
            to: Vec2::new(5.0, 0.0),
        };
        let texture = Texture { pattern, ..Texture::constant(Vec3::ONE) };
        let height = Scalar { texture, channel: 0, complement: false };
        let bump = Some(BumpMap { height, amount });
        let mut scene = scene_of(Vec3::ONE);
        scene.materials[0].bump = bump;
        add(&mut scene, floor());
        light(&mut scene, Light::Directional { direction: -DVec3::Z, irradiance: Vec3::ONE });
        look(&scene, v(0.0, 0.0, 3.0), DVec3::ZERO).x
    };
    let leaning = 1.0 / 1.01_f64.sqrt() / std::f64::consts::PI;
    close(rise(BumpAmount::Metres(1.0)), leaning, 1e-4);
    close(rise(BumpAmount::Metres(-1.0)), leaning, 1e-4);
    // The texture coordinates of a plane are metres, so a picture is 1 m wide.
    close(rise(BumpAmount::Relative(1.0)), leaning, 1e-4);
    close(rise(BumpAmount::Metres(0.0)), 1.0 / std::f64::consts::PI, 1e-6);
}

/// A checker board seen to the horizon by a single sample per pixel: its squares fade into their mean, whether it is a
/// pattern or a picture.
#[test]
fn far_squares_fade_instead_of_flickering() {
    let checker = [[1.0; 4], [0.0, 0.0, 0.0, 1.0]];
    let size = Vec2::ONE;
    let mut patterns = vec![(Vec::new(), Pattern::Checker { colors: checker, size })];
    let square = |i: usize| checker[usize::from((i % 16 < 8) != (i < 128))];
    let texels = Texels::Linear((0..256).map(square).collect());
    let picture = Pixels { name: "squares".into(), width: 16, height: 16, texels };
    let transform = UvTransform::from_scale(Vec2::splat(0.5));
    let pattern = Pattern::Image {
        image: 0,
        uv_set: 0,
        transform,
        wrap: [Wrap::Repeat; 2],
        sampling: Sampling::Bilinear,
    };
    patterns.push((vec![std::sync::Arc::new(picture)], pattern));
    for (images, pattern) in patterns {
        let mut scene = scene_of(Vec3::ONE);
        scene.images = images;
        scene.materials[0].reflectance = Texture { pattern, ..Texture::constant(Vec3::ONE) };
        add(&mut scene, floor());
        light(&mut scene, Light::Ambient { radiance: Vec3::ONE, reach: f64::INFINITY });
        let view = Projection::Perspective { vertical_fov: 0.2 };
        scene.cameras.push(camera(v(0.0, 0.0, 1.5), v(0.0, 60.0, 0.0), view));
        let filter = Filter::Box { radius: 0.5 };
        scene.film = FilmDescription { width: 64, height: 64, samples: 1, filter, ..scene.film };
        let image = common::picture(&scene).image;
        // The upper rows under the horizon are hundreds of squares away, the last one some ten.
        let row = |y: u32| (0..64).map(move |x| (x, y)).map(|(x, y)| image.get(x, y).x);
        let horizon = (0..64).find(|&y| row(y).all(|v| v > 0.0)).expect("there is a floor");
        for y in horizon..horizon + 4 {
            assert!(
                row(y).all(|v| (v - 0.5).abs() < 0.1),
                "row {y}: {:?}",
                row(y).collect::<Vec<_>>()
            );
        }
        let near: Vec<f32> = row(63).collect();
        let spread = near.iter().fold(0.0, |most: f32, v| most.max((v - 0.5).abs()));
        assert!(spread > 0.4, "near squares are sharp: {near:?}");
    }
}
