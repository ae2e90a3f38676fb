//! Rays that leave a surface do not meet it again.

use super::Scene;
use super::description::*;
use super::filter::StopsLight;
use crate::color::Rgb;
use crate::geometry::{Hit, Ray};
use crate::testing::Random;
use glam::{DAffine3, DMat3, DVec3};

fn scene(shape: Shape, meshes: Vec<Mesh>, transform: DAffine3) -> Scene {
    let surface = Surface { name: "surface".into(), shape, material: 0, transform };
    Scene::build(&SceneDescription {
        materials: vec![Material::matte("matte", Rgb::ONE)],
        meshes: meshes.into_iter().map(Into::into).collect(),
        surfaces: vec![surface],
        ..SceneDescription::default()
    })
}

/// A shape whose coordinates have magnitudes of 10⁻⁸ to 10⁸ of their own.
fn random_scene(kind: usize, random: &mut Random) -> Scene {
    let wide = |random: &mut Random| 10_f64.powf(16.0 * random.unit() - 8.0);
    let place = |random: &mut Random| wide(random) * random.point();
    let (a, b, c, r) = (place(random), place(random), place(random), wide(random));
    match kind {
        0 => {
            let positions = [a, b, c].map(DVec3::as_vec3).to_vec();
            let mesh = Mesh { positions, triangles: vec![[0, 1, 2]], ..Mesh::default() };
            scene(Shape::Mesh(0), vec![mesh], DAffine3::IDENTITY)
        }
        1 => {
            let sphere = Shape::Sphere(Sphere { center: a, radius: r });
            scene(sphere, vec![], DAffine3::IDENTITY)
        }
        2 => {
            let quad = Shape::Quad(Quad { corner: a, edge_u: b, edge_v: c });
            scene(quad, vec![], DAffine3::IDENTITY)
        }
        _ => {
            let unit = Shape::Cylinder(Cylinder {
                base: DVec3::ZERO,
                top: DVec3::Z,
                radius: 1.0,
                capped: true,
            });
            let axes = DMat3::from_cols(random.point(), random.point(), random.point());
            scene(unit, vec![], DAffine3::from_mat3_translation(axes * r, a))
        }
    }
}

/// A point of the surface, by a ray aimed at it.
fn hit_somewhere(scene: &Scene, random: &mut Random) -> Option<(Ray, Hit)> {
    let view = super::frame(&describe_bounds(scene)?, random.direction(), random.direction());
    let camera = crate::Camera::new(&view, 64, 64);
    let ray = camera
        .ray(64.0 * glam::DVec2::new(random.unit(), random.unit()).as_vec2(), glam::Vec2::ZERO);
    let mut hit = Vec::new();
    scene.world.closest_hits(&[ray], &StopsLight(scene, 0), &mut hit);
    hit[0].is_some().then_some((ray, hit[0]))
}

/// A description with a box as large as the scene, to be framed.
fn describe_bounds(scene: &Scene) -> Option<SceneDescription> {
    let bounds = scene.world.bounds();
    let block = Block { min: bounds.lo.as_dvec3(), max: bounds.hi.as_dvec3() };
    let surface = Surface {
        name: String::new(),
        shape: Shape::Block(block),
        material: 0,
        transform: DAffine3::IDENTITY,
    };
    Some(SceneDescription {
        materials: vec![Material::matte("matte", Rgb::ONE)],
        surfaces: vec![surface],
        ..SceneDescription::default()
    })
}

/// Reference case G06. Returns (rays that left, rays that met their surface again).
fn reintersections(shapes: usize, rays: usize) -> (usize, usize) {
    let mut random = Random::new(6);
    let (mut left, mut met) = (0, 0);
    for n in 0..shapes {
        let scene = random_scene(n % 4, &mut random);
        let Some((seen_along, hit)) = (0..20).find_map(|_| hit_somewhere(&scene, &mut random))
        else {
            continue;
        };
        let surface = scene.interaction(&seen_along, &hit);
        let leaving: Vec<Ray> = (0..rays)
            .map(|_| random.direction().as_vec3())
            .map(|d| if d.dot(surface.geometric_normal) < 0.0 { -d } else { d })
            .map(|d| Ray::new(surface.ray_origin(), d))
            .collect();
        let mut occluded = Vec::new();
        // Every shape is convex and seen from outside, so that whatever is met is the surface that was left.
        scene.world.occluded(&leaving, &StopsLight(&scene, 0), &mut occluded);
        left += rays;
        met += occluded.iter().filter(|o| **o).count();
    }
    (left, met)
}

#[test]
fn rays_that_leave_a_surface_do_not_meet_it_again() {
    let (left, met) = reintersections(2000, 200);
    assert!(left > 100_000, "{left} rays left");
    assert_eq!(met, 0);
}

#[test]
#[ignore = "the slow set: 10^7 rays"]
fn ten_million_rays_that_leave_a_surface_do_not_meet_it_again() {
    let (left, met) = reintersections(20_000, 1000);
    assert!(left > 8_000_000, "{left} rays left");
    assert_eq!(met, 0);
}
