//! Shadows without acne, leaks or facets at every scale and place, and the settings that show the blunder.

mod common;

use common::*;
use firstlight::render::{RenderOptions, render};
use firstlight::scene::description::*;
use firstlight::{BuildQuality, Image, Level, Scene, SceneDescription};
use glam::{DAffine3, DMat3, DVec3, Vec3};
use std::f64::consts::{PI, TAU};
use std::ops::ControlFlow;

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
fn assortment() -> SceneDescription {
    let mut scene = scene_of(Vec3::splat(0.5));
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
fn moved(scene: &SceneDescription, scale: f64, shift: DVec3) -> SceneDescription {
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

fn with_light_at_the_eye(mut scene: SceneDescription) -> SceneDescription {
    let position = scene.cameras[0].position;
    let intensity = Vec3::splat(30.0);
    light(&mut scene, Light::Point { position, intensity });
    scene
}

fn differing(a: &Image, b: &Image) -> usize {
    a.pixels().iter().zip(b.pixels()).filter(|(a, b)| a != b).count()
}

fn mean(image: &Image) -> f64 {
    let sum: f64 = image.pixels().iter().map(|p| f64::from(p[0])).sum();
    sum / image.pixels().len() as f64
}

/// Acne: what the eye sees, a light at the eye reaches; with shadows and without, the picture is the same. Leaks: a
/// light at the eye's mirror image behind the floor reaches nothing. At scales from 10⁻⁶ to 10⁶ (case G03).
#[test]
fn no_acne_and_no_leaks_at_any_scale() {
    for exponent in -6..=6 {
        let scene = moved(&with_light_at_the_eye(assortment()), 10_f64.powi(exponent), DVec3::ZERO);
        let unshadowed = SceneDescription { shadows: Shadows::Off, ..scene.clone() };
        let (with, without) = (picture(&scene).image, picture(&unshadowed).image);
        assert_eq!(differing(&with, &without), 0, "acne at scale 10^{exponent}");
        assert!(mean(&with) > 0.05, "the picture is not black");
    }
}

#[test]
fn no_light_leaks_into_a_closed_box_at_any_scale() {
    for exponent in -6..=6 {
        let mut scene = assortment();
        add(&mut scene, Shape::Block(Block { min: v(-8.0, -8.0, -1.0), max: v(8.0, 8.0, 6.0) }));
        for position in
            [v(0.0, 0.0, 6.1), v(8.01, 0.0, 2.0), v(0.0, -9.0, 1.0), v(3.0, 3.0, -1.001)]
        {
            light(&mut scene, Light::Point { position, intensity: Vec3::splat(1000.0) });
        }
        let image = picture(&moved(&scene, 10_f64.powi(exponent), DVec3::ZERO)).image;
        assert_eq!(
            image.pixels().iter().filter(|p| p[0] != 0.0).count(),
            0,
            "leaks at 10^{exponent}"
        );
    }
}

/// The same test sees the lecture's blunder, and what its cures with a fixed length do at the wrong scale.
#[test]
fn the_naive_setting_fails_the_same_test() {
    let acne = |shadows: Shadows, exponent: i32| {
        let scene = with_light_at_the_eye(SceneDescription { shadows, ..assortment() });
        let scene = moved(&scene, 10_f64.powi(exponent), DVec3::ZERO);
        let unshadowed = SceneDescription { shadows: Shadows::Off, ..scene.clone() };
        differing(&picture(&scene).image, &picture(&unshadowed).image)
    };
    assert!(acne(Shadows::Naive, 0) > 500);
    for cure in [Shadows::TRange { epsilon: 1e-3 }, Shadows::MovedStart { epsilon: 1e-3 }] {
        assert!(acne(cure, 0) < 5, "{cure:?} cures a scene of metres, all but specks");
        assert!(acne(cure, 6) > 500, "{cure:?} is too short for a scene of 1000 km");
    }
}

/// G03, G04: a picture does not depend on the unit of length, nor on where the scene is as long as coordinates can
/// tell its parts apart.
#[test]
fn pictures_do_not_depend_on_scale_and_place() {
    let mut scene = assortment();
    light(&mut scene, Light::Point { position: v(2.0, -3.0, 5.0), intensity: Vec3::splat(30.0) });
    let reference = mean(&picture(&scene).image);
    for exponent in -6..=6 {
        let image = picture(&moved(&scene, 10_f64.powi(exponent), DVec3::ZERO)).image;
        close(mean(&image), reference, 1e-3);
    }
    for (distance, tolerance) in [(1e3, 1e-3), (1e4, 1e-2), (1e5, 0.1), (1e6, f64::INFINITY)] {
        let image = picture(&moved(&scene, 1.0, v(distance, -distance, 0.5 * distance))).image;
        close(mean(&image), reference, tolerance);
        assert!(image.pixels().iter().flatten().all(|x| x.is_finite()));
    }
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

/// G07: the share of the smoothly lit half of an n-gon that is black, and the mean over it relative to a cylinder's.
fn terminator(n: u32, shadows: Shadows) -> (f64, f64) {
    let mut scene = SceneDescription { shadows, ..scene_of(Vec3::splat(0.5)) };
    add_mesh(&mut scene, facets(n));
    let (mut lit, mut black, mut sum, mut expected) = (0.0, 0.0, 0.0, 0.0);
    for step in 0..16 {
        let angle = TAU * f64::from(step) / 16.0 / f64::from(n);
        let direction = -v(angle.cos(), angle.sin(), 0.0);
        scene.lights.clear();
        light(&mut scene, Light::Directional { direction, irradiance: Vec3::ONE });
        let built = Scene::build(&scene);
        for i in 0..2000 {
            let phi = TAU * (f64::from(i) + 0.5) / 2000.0;
            let outward = v(phi.cos(), phi.sin(), 0.0);
            let ray = firstlight::Ray::new((3.0 * outward).as_vec3(), -outward.as_vec3());
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

#[test]
fn smooth_shading_has_no_terminator_steps() {
    for n in [10, 14, 30, 64] {
        let (black, mean) = terminator(n, Shadows::Robust);
        assert_eq!(black, 0.0, "{n} facets");
        close(mean, 1.0, 0.05);
        // Without the cure, 1/(2n) of the half is black, less the sliver that the test leaves out.
        let (black, _) = terminator(n, Shadows::TRange { epsilon: 1e-4 });
        assert!((black - 0.5 / f64::from(n)).abs() < 0.01, "{n} facets: {black}");
        assert!(black > 0.0);
    }
}

/// The bits of the linear picture (FNV-1a).
fn hash(image: &Image) -> u64 {
    let bytes = image.pixels().iter().flatten().flat_map(|x| x.to_bits().to_le_bytes());
    bytes.fold(0xcbf2_9ce4_8422_2325, |h, b| (h ^ u64::from(b)).wrapping_mul(0x100_0000_01b3))
}

#[test]
fn any_number_of_threads_and_any_level_give_the_same_bits() {
    let mut scene = assortment();
    light(&mut scene, Light::Point { position: v(2.0, -3.0, 5.0), intensity: Vec3::splat(30.0) });
    scene.film.samples = 6;
    let rendered = |threads: usize, level: Level| {
        let options = RenderOptions { threads, ..RenderOptions::default() };
        let scene = Scene::build_with(&scene, level, BuildQuality::Final);
        hash(&render(&scene, &options, &|_| ControlFlow::Continue(())).image)
    };
    let expected = rendered(1, Level::detect());
    for threads in [2, 3, 7] {
        assert_eq!(rendered(threads, Level::detect()), expected, "{threads} threads");
    }
    for level in Level::all() {
        assert_eq!(rendered(2, level), expected, "{level:?}");
    }
}

/// A crop is the same rectangle of the whole picture, bit for bit.
#[test]
fn a_crop_is_a_part_of_the_picture() {
    use firstlight::render::Crop;
    let mut scene = with_light_at_the_eye(assortment());
    scene.film.samples = 5;
    let scene = Scene::build(&scene);
    let crop = Crop { x: 17, y: 9, width: 50, height: 41 };
    let options = RenderOptions { crop: Some(crop), ..RenderOptions::default() };
    let part = render(&scene, &options, &|_| ControlFlow::Continue(())).image;
    let whole = render(&scene, &RenderOptions::default(), &|_| ControlFlow::Continue(())).image;
    for y in 0..crop.height {
        for x in 0..crop.width {
            assert_eq!(part.get(x, y), whole.get(x + crop.x, y + crop.y));
        }
    }
}

/// Breaking off leaves the tiles that were done, and says so.
#[test]
fn an_interrupted_render_keeps_what_was_done() {
    let scene = Scene::build(&with_light_at_the_eye(assortment()));
    let options = RenderOptions { threads: 1, ..RenderOptions::default() };
    let stopped = render(&scene, &options, &|_| ControlFlow::Break(()));
    assert!(stopped.interrupted && stopped.samples == 0);
    let done = stopped.image.pixels().iter().filter(|p| p[3] == 1.0).count();
    assert!(done > 0 && done < 96 * 72, "one tile of {done} pixels");
}
