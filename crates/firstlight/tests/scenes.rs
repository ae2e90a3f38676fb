//! Scene files, from their text to the light they describe.

mod common;

use firstlight::{Ray, Scene, SceneDescription};
use glam::{DVec3, Vec3};
use std::path::Path;

fn read(text: &str) -> SceneDescription {
    common::read(Path::new("scene.toml"), text, &[])
}

fn seen(text: &str, from: Vec3, to: Vec3) -> Vec3 {
    let ray = Ray::new(from, (to - from).normalize());
    Scene::build(&read(text)).trace(&ray, 0.0, f32::INFINITY)
}

#[test]
fn vertex_colours_of_a_mesh_multiply_its_material() {
    let text = "
        [materials.half.lambert]
        reflectance = 0.5
        [surfaces.triangle]
        mesh.vertices = [[-1, -1, 0], [1, -1, 0], [0, 1, 0]]
        mesh.triangles = [[0, 1, 2]]
        mesh.colors = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
        material = 'half'
        [surfaces.plain]
        sphere = { center = [5, 0, 0] }
        material = 'half'
        [lights.around.ambient]
        radiance = 1
    ";
    let near_a_corner = seen(text, Vec3::Z, Vec3::new(-0.98, -0.99, 0.0));
    assert!(
        (near_a_corner - Vec3::new(0.5, 0.0, 0.0)).abs().max_element() < 0.02,
        "{near_a_corner}"
    );
    assert_eq!(seen(text, Vec3::new(5.0, 0.0, 3.0), Vec3::X * 5.0), Vec3::splat(0.5));
}

/// Without a camera, one is chosen that stands upright in the scene's own sense of up.
#[test]
fn a_chosen_camera_stands_upright() {
    for (up, above) in [("y", DVec3::Y), ("z", DVec3::Z)] {
        let (x, y, z) = (above.x, above.y, above.z);
        let text = format!(
            "up = '{up}'
             film.resolution = [64, 64]
             [surfaces.low]
             sphere = {{ radius = 1 }}
             [surfaces.high]
             sphere = {{ center = [{}, {}, {}], radius = 0.3 }}
             material = 'bright'
             [materials.bright.lambert]
             emission = 1",
            3.0 * x,
            3.0 * y,
            3.0 * z
        );
        let scene = Scene::build(&read(&text));
        let bright = |row: std::ops::Range<u32>| {
            let rays = row.flat_map(|iy| (0..64).map(move |ix| (ix, iy)));
            rays.filter(|&(ix, iy)| {
                scene.trace(&scene.camera().get_ray(ix, iy), 0.0, f32::INFINITY).x >= 1.0
            })
            .count()
        };
        assert!(bright(0..32) > 0, "up = {up}: the small ball is in the upper half");
        assert_eq!(bright(32..64), 0, "up = {up}");
    }
}

/// The meter's and the eye's answers in the units that were written.
#[test]
fn lumens_and_lux_come_out_as_they_went_in() {
    let text = "
        [surfaces.floor.plane]
        [lights.lamp.point]
        position = [0, 0, 2]
        power = '800 lm'
        color = 'orange'
    ";
    let scene = Scene::build(&read(text));
    let irradiance = scene.irradiance(DVec3::ZERO, DVec3::Z).value;
    let lux = firstlight::units::photometric(irradiance, scene.luminous_efficacy().0);
    let expected = 800.0 / (16.0 * std::f64::consts::PI);
    assert!((lux / expected - 1.0).abs() < 1e-6, "{lux} lx is not {expected} lx");
}
