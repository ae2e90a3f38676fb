//! Short ways to say scenes, for cases and tests.

use crate::color::Rgb;
use crate::geometry::Ray;
use crate::render::{RenderOptions, Rendered, render};
use crate::scene::Scene;
use crate::scene::description::*;
use glam::{DAffine3, DMat3, DQuat, DVec3, Vec3};
use std::f64::consts::PI;
use std::ops::ControlFlow;

/// A vector.
pub fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

/// A scene with one material of the given reflectance, and nothing in it.
pub fn scene_of(reflectance: Rgb) -> SceneDescription {
    let materials = vec![Material::matte("only", reflectance)];
    SceneDescription { materials, ..SceneDescription::default() }
}

/// A scene for paths of any length. Material 0 reflects `reflectance`, material 1 emits 1 to its front and reflects
/// nothing, material 2 is black.
pub fn scene_for_paths(reflectance: f32) -> SceneDescription {
    let mut scene = scene_of(Rgb::splat(reflectance));
    scene.integrator = Integrator::Path { bounces: None };
    scene.materials.push(emitter(1.0, 0.0));
    scene.materials.push(Material::matte("black", Rgb::ZERO));
    scene
}

/// A material that emits to its front and reflects.
pub fn emitter(radiance: f32, reflectance: f32) -> Material {
    let emission = Texture::constant(Rgb::splat(radiance));
    let matte = Material::matte("emitter", Rgb::splat(reflectance));
    Material { emission, emits_behind: false, ..matte }
}

/// A material whose sides both emit and reflect.
pub fn glowing(radiance: f32, reflectance: f32) -> Material {
    Material { emits_behind: true, ..emitter(radiance, reflectance) }
}

/// A perfect mirror that loses a part of the light.
pub fn mirror(mirrored: f32) -> Material {
    Material::mirror("mirror", Rgb::splat(mirrored))
}

/// Glass that does not bend light: a sheet so thin that it leaves in line with where it entered.
pub fn pane(index: f32) -> Material {
    Material { scattering: Scattering::ThinGlass { index }, ..Material::matte("pane", Rgb::ONE) }
}

/// Clear glass, or anything solid and smooth of that index and absorption per channel, m⁻¹.
pub fn clear(index: f32, absorption: Rgb) -> Material {
    let interior = Some(Interior { absorption, ..Interior::clear(index) });
    let facets = Facets::of(Scalar::constant(0.0));
    let scattering = Scattering::Dielectric { facets };
    Material { scattering, interior, ..Material::matte("clear", Rgb::ONE) }
}

/// Adds a surface of material 0.
pub fn add(scene: &mut SceneDescription, shape: Shape) {
    add_with(scene, shape, 0);
}

/// Adds a surface of any material.
pub fn add_with(scene: &mut SceneDescription, shape: Shape, material: usize) {
    let transform = DAffine3::IDENTITY;
    let name = "surface".into();
    scene.surfaces.push(Surface { name, shape, material, transform, motion: None });
}

/// Adds a mesh of material 0.
pub fn add_mesh(scene: &mut SceneDescription, mesh: Mesh) {
    scene.meshes.push(mesh.into());
    let shape = Shape::Mesh(scene.meshes.len() - 1);
    add(scene, shape);
}

/// Adds a light.
pub fn light(scene: &mut SceneDescription, light: Light) {
    scene.lights.push(LightDescription::new("light", light));
}

/// An isotropic point light by its power per channel, W.
pub fn point_light(position: DVec3, power: Rgb) -> Light {
    let intensity = (power.as_dvec3() / (4.0 * PI)).as_vec3();
    Light::Point { position, intensity }
}

/// The plane z = 0.
pub fn floor() -> Shape {
    Shape::Plane(Plane { point: DVec3::ZERO, normal: DVec3::Z })
}

/// A closed cube as a block.
pub fn cube(center: DVec3, side: f64) -> Shape {
    Shape::Block(Block { min: center - side / 2.0, max: center + side / 2.0 })
}

/// A rectangle from a corner; its front is where u × v points.
pub fn quad(corner: DVec3, edge_u: DVec3, edge_v: DVec3) -> Shape {
    Shape::Quad(Quad { corner, edge_u, edge_v })
}

/// A horizontal rectangle around `center` that faces down.
pub fn panel(center: DVec3, width: f64, depth: f64) -> Shape {
    quad(center - v(width / 2.0, depth / 2.0, 0.0), v(0.0, depth, 0.0), v(width, 0.0, 0.0))
}

/// A sphere.
pub fn ball(center: DVec3, radius: f64) -> Shape {
    Shape::Sphere(Sphere { center, radius })
}

/// The same radiance from everywhere.
pub fn uniform(radiance: f32) -> Option<EnvironmentDescription> {
    under(Sky::Uniform, radiance)
}

/// A sky whose radiance is multiplied by `factor`.
pub fn under(sky: Sky, factor: f32) -> Option<EnvironmentDescription> {
    let (rotation, factor) = (DQuat::IDENTITY, Rgb::splat(factor));
    Some(EnvironmentDescription { sky, factor, rotation, visible: true })
}

/// A camera that looks at `target`, upright.
pub fn camera(position: DVec3, target: DVec3, projection: Projection) -> CameraDescription {
    let along_z = (target - position).normalize().z.abs() > 0.99;
    let up = if along_z { DVec3::Y } else { DVec3::Z };
    let (shutter, motion) = (CameraDescription::OPEN, None);
    CameraDescription { name: "camera".into(), position, target, up, projection, shutter, motion }
}

/// Radiance from `target` towards `origin`, by one sample.
pub fn look(scene: &SceneDescription, origin: DVec3, target: DVec3) -> Rgb {
    let ray = Ray::new(origin.as_vec3(), (target - origin).normalize().as_vec3());
    Scene::build(scene).trace(&ray, 0.0, f32::INFINITY)
}

/// The picture that the scene asks for.
///
/// # Panics
/// If the scene is not sound.
pub fn picture(scene: &SceneDescription) -> Rendered {
    scene.check().expect("the scene is sound");
    render(&Scene::build(scene), &RenderOptions::default(), &|_| ControlFlow::Continue(()))
}

/// The mean of the first channel of the picture that the scene asks for, with another seed.
pub fn mean_of_picture(scene: &SceneDescription, seed: u64) -> f64 {
    let mut scene = scene.clone();
    scene.film.seed = seed;
    let image = picture(&scene).image;
    let sum: f64 = image.pixels().iter().map(|pixel| f64::from(pixel[0])).sum();
    sum / image.pixels().len() as f64
}

/// A tilted slab of triangles, as an instance or not.
fn slab() -> Mesh {
    let corner = |x: f32, y: f32| Vec3::new(x, y, 0.2 * x + 0.1 * y);
    Mesh {
        positions: vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    }
}

/// One of every shape on a floor, flat-shaded, in a picture of 96 × 72.
pub fn assortment() -> SceneDescription {
    let mut scene = scene_of(Rgb::splat(0.5));
    add(&mut scene, floor());
    add(&mut scene, Shape::Sphere(Sphere { center: v(-1.5, 0.0, 0.7), radius: 0.7 }));
    add(&mut scene, cube(v(0.0, 0.5, 0.5), 1.0));
    let (base, top) = (v(1.3, 0.0, 0.0), v(1.3, 0.1, 1.1));
    add(&mut scene, Shape::Cylinder(Cylinder { base, top, radius: 0.4, capped: true }));
    let (base, apex) = (v(0.0, -1.2, 0.0), v(0.0, -1.2, 0.8));
    add(&mut scene, Shape::Cone(Cone { base, apex, radius: 0.4, capped: true }));
    let disk = Disk { center: v(-1.0, -1.0, 0.4), normal: v(0.3, -1.0, 0.8), radius: 0.3 };
    add(&mut scene, Shape::Disk(disk));
    add_mesh(&mut scene, slab());
    let turned = DMat3::from_rotation_x(1.1) * DMat3::from_diagonal(v(0.5, -0.7, 0.3));
    scene.surfaces[6].transform = DAffine3::from_mat3_translation(turned, v(1.0, -1.0, 0.6));
    let view = Projection::Perspective { vertical_fov: 45_f64.to_radians() };
    scene.cameras.push(camera(v(0.7, -5.0, 2.5), v(0.0, 0.0, 0.4), view));
    scene.film = FilmDescription { width: 96, height: 72, samples: 4, ..scene.film };
    scene
}

/// The scene under a scale and a shift. Point lights keep the irradiance they cause.
pub fn moved(scene: &SceneDescription, scale: f64, shift: DVec3) -> SceneDescription {
    let map =
        DAffine3::from_scale_rotation_translation(DVec3::splat(scale), Default::default(), shift);
    let mut moved =
        SceneDescription { film: scene.film.clone(), shadows: scene.shadows, ..Default::default() };
    let part = moved.adopt(scene.clone());
    moved.place(&part, "moved", map, None);
    for light in &mut moved.lights {
        if let Light::Point { intensity, .. } = &mut light.light {
            *intensity *= (scale * scale) as f32;
        }
    }
    moved
}

/// With a light where the camera is.
pub fn with_light_at_the_eye(mut scene: SceneDescription) -> SceneDescription {
    let position = scene.cameras[0].position;
    let intensity = Rgb::splat(30.0);
    light(&mut scene, Light::Point { position, intensity });
    scene
}
