//! Reference cases of materials, by the path integrator: furnaces in which what loses no light cannot be seen.

mod common;

use common::*;
use firstlight::scene::description::*;
use firstlight::{Meter, Ray, Scene, SceneDescription};
use glam::{DAffine3, DQuat, DVec3, Vec3};

/// A scene for paths of any length in light of radiance 1 from everywhere; `materials` have the indices from 0.
fn furnace(materials: Vec<Material>) -> SceneDescription {
    let mut scene = SceneDescription { materials, ..SceneDescription::default() };
    scene.integrator = Integrator::Path { bounces: None };
    let (rotation, factor) = (DQuat::IDENTITY, Vec3::ONE);
    let environment = EnvironmentDescription { sky: Sky::Uniform, factor, rotation, visible: true };
    scene.environment = Some(environment);
    scene
}

fn ball(scene: &mut SceneDescription, center: DVec3, radius: f64, material: usize) {
    add_with(scene, Shape::Sphere(Sphere { center, radius }), material);
}

fn add_with(scene: &mut SceneDescription, shape: Shape, material: usize) {
    let (name, transform) = ("surface".into(), DAffine3::IDENTITY);
    scene.surfaces.push(Surface { name, shape, material, transform });
}

fn pane(index: f32) -> Material {
    Material { scattering: Scattering::ThinGlass { index }, ..Material::matte("pane", Vec3::ONE) }
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
