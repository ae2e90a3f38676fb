//! Short ways to say scenes in tests.
#![allow(dead_code, reason = "each test file uses its part")]

use firstlight::render::{RenderOptions, Rendered, render};
use firstlight::scene::description::*;
use firstlight::{Ray, Scene, SceneDescription};
use glam::{DAffine3, DVec3, Vec3};
use std::ops::ControlFlow;

pub(crate) fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

/// A scene with one material of the given reflectance, and nothing in it.
pub(crate) fn scene_of(reflectance: Vec3) -> SceneDescription {
    let materials = vec![Material::matte("only", reflectance)];
    SceneDescription { materials, ..SceneDescription::default() }
}

pub(crate) fn add(scene: &mut SceneDescription, shape: Shape) {
    let transform = DAffine3::IDENTITY;
    scene.surfaces.push(Surface { name: "surface".into(), shape, material: 0, transform });
}

pub(crate) fn add_mesh(scene: &mut SceneDescription, mesh: Mesh) {
    scene.meshes.push(mesh.into());
    let shape = Shape::Mesh(scene.meshes.len() - 1);
    add(scene, shape);
}

pub(crate) fn light(scene: &mut SceneDescription, light: Light) {
    scene.lights.push(LightDescription::new("light", light));
}

/// An isotropic point light by its power per channel, W.
pub(crate) fn point_light(position: DVec3, power: Vec3) -> Light {
    let intensity = (power.as_dvec3() / (4.0 * std::f64::consts::PI)).as_vec3();
    Light::Point { position, intensity }
}

pub(crate) fn floor() -> Shape {
    Shape::Plane(Plane { point: DVec3::ZERO, normal: DVec3::Z })
}

/// A closed cube as a block.
pub(crate) fn cube(center: DVec3, side: f64) -> Shape {
    Shape::Block(Block { min: center - side / 2.0, max: center + side / 2.0 })
}

pub(crate) fn camera(position: DVec3, target: DVec3, projection: Projection) -> CameraDescription {
    let along_z = (target - position).normalize().z.abs() > 0.99;
    let up = if along_z { DVec3::Y } else { DVec3::Z };
    CameraDescription { name: "camera".into(), position, target, up, projection }
}

/// Radiance from `origin` towards `target`.
pub(crate) fn look(scene: &SceneDescription, origin: DVec3, target: DVec3) -> Vec3 {
    let ray = Ray::new(origin.as_vec3(), (target - origin).normalize().as_vec3());
    Scene::build(scene).trace(&ray, 0.0, f32::INFINITY)
}

pub(crate) fn picture(scene: &SceneDescription) -> Rendered {
    scene.check().expect("the scene is sound");
    render(&Scene::build(scene), &RenderOptions::default(), &|_| ControlFlow::Continue(()))
}

#[track_caller]
pub(crate) fn close(value: impl Into<f64>, expected: f64, relative: f64) {
    let value = value.into();
    let error = if expected == 0.0 { value.abs() } else { (value / expected - 1.0).abs() };
    assert!(error <= relative, "{value} is not {expected} within {relative}: off by {error:e}");
}
