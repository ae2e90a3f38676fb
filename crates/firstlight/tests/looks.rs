//! The three purposes of shading, and ambient light that near surfaces keep out.

mod common;

use common::{close, read};
use firstlight::render::{RenderOptions, Rendered, render};
use firstlight::{Ray, Scene, SceneDescription};
use glam::{DVec3, Vec3};
use std::f64::consts::PI;
use std::ops::ControlFlow;
use std::path::Path;

fn scene(text: &str, more: &[&str]) -> SceneDescription {
    read(Path::new("scene.toml"), text, more)
}

fn picture(description: &SceneDescription) -> Rendered {
    let options = RenderOptions::default();
    render(&Scene::build(description), &options, &|_| ControlFlow::Continue(()))
}

/// A slab under a ball, seen from above.
const ABOVE: &str = "
    look = 'clarity'
    film = { resolution = [40, 40], samples = 8 }
    camera.orthographic = { position = [0, 0, 9], target = [0, 0, 0], height = 8, up = [0, 1, 0] }
    surfaces.slab.box = { min = [-3, -3, -1], max = [3, 3, 0] }
    surfaces.slab.material = 'green'
    surfaces.ball.sphere = { center = [0, 0, 1], radius = 1 }
    lights.low.point = { position = [-9, 0, 1], intensity = 1e5 }
    materials.green.lambert.reflectance = [0.1, 0.6, 0.2]
";

#[test]
fn clarity_shows_colours_as_they_are_and_no_shadows() {
    let rendered = picture(&scene(ABOVE, &[]));
    // Far from ball and edges, on the side where the ball's shadow would be and on the other.
    for (x, y) in [7, 8, 31, 32].into_iter().flat_map(|x| (8..32).map(move |y| (x, y))) {
        let color = rendered.image.get(x, y);
        assert!(color.abs_diff_eq(Vec3::new(0.1, 0.6, 0.2), 0.01), "{color} at {x}, {y}");
    }
}

#[test]
fn clarity_draws_lines_where_surfaces_end() {
    let of = |more: &[&str]| picture(&scene(ABOVE, more)).image;
    let image = of(&[]);
    // The slab ends 3 m from the middle: 15 of 20 pixels.
    let (inside, edge) = (image.get(8, 30), image.get(5, 30).min(image.get(4, 30)));
    assert!(edge.y < 0.6 * inside.y, "{edge} on the edge, {inside} beside it");
    assert_eq!(image.get(1, 1), Vec3::ONE, "the background is paper");
}

#[test]
fn narrow_places_are_darker() {
    let image = picture(&scene(ABOVE, &["surfaces.ball.sphere.center=[0, 0, 1.3]"])).image;
    let (near, far) = (image.get(25, 20), image.get(33, 20));
    assert!(near.y < 0.97 * far.y, "{near} beside the ball, {far} away from it");
}

#[test]
fn sections_open_what_lies_before_them() {
    let cut = "section={point=[0, 0, 0.5], normal=[0, 0, 1]}";
    let (whole, open) = (picture(&scene(ABOVE, &[])).image, picture(&scene(ABOVE, &[cut])).image);
    // Of the ball of 0.5, its lower half is left, and its inside is seen: flat and darker.
    close(open.get(20, 20).y, 0.5 * 0.6, 1e-5);
    assert!(whole.get(20, 20).y > 0.45);
    let error = firstlight::io::scene_file::read(
        &ABOVE.replace("'clarity'", "'real'"),
        "scene.toml",
        &[cut.parse().unwrap()],
        &firstlight::FileAccess::beside(Path::new("scene.toml"), &[]),
        &mut Vec::new(),
    );
    assert!(error.unwrap_err().message.contains("is for the look \"clarity\""));
}

/// A floor at the foot of a wall without end: of all directions by their cosine, the wall takes one half.
const CORNER: &str = "
    camera.perspective = { position = [-3, 0, 3], target = [0, 0, 0] }
    surfaces.floor.plane = {}
    surfaces.wall.quad = { corner = [1, -1e5, 0], edge_u = [0, 2e5, 0], edge_v = [0, 0, 2e5] }
    lights.sky.ambient = { radiance = 2, reach = 1e4 }
    film.samples = 4096
";

fn on_floor(description: &SceneDescription) -> (f64, f64) {
    let scene = Scene::build(description);
    let measured = scene.irradiance(DVec3::ZERO, DVec3::Z);
    (f64::from(measured.value.y), f64::from(measured.standard_error.y))
}

#[test]
fn near_surfaces_keep_ambient_light_out() {
    let (measured, error) = on_floor(&scene(CORNER, &[]));
    let expected = 0.5 * 2.0 * PI;
    assert!(
        (measured - expected).abs() < 4.0 * error + 1e-4,
        "{measured} ± {error}, not {expected}"
    );
    let (all, _) = on_floor(&scene(CORNER, &["lights.sky.ambient.reach=0.9"]));
    close(all, 2.0 * PI, 1e-5);
    // What is seen of it: R · L · openness, with R = 0.5.
    let description = scene(CORNER, &["lights.sky.ambient.reach=0.9"]);
    let ray = Ray::new(Vec3::new(-3.0, 0.0, 3.0), Vec3::new(1.0, 0.0, -1.0).normalize());
    close(Scene::build(&description).radiance(&ray).value.y, 1.0, 1e-5);
}

/// A lamp that hangs about in the middle of a room counts as if it were 0.357 of half of the diagonal away.
#[test]
fn ambient_light_does_not_depend_on_who_is_in_the_middle() {
    use firstlight::scene::description::Light;
    let at = |height: f64| {
        let lamp = format!("lights.low.point.position=[0, 0, {height}]");
        let description =
            scene(ABOVE, &["look='balanced'", "lights.low.point.intensity=15", &lamp]);
        let Light::Ambient { radiance, .. } = description.lights[1].light else {
            panic!("ambient")
        };
        f64::from(radiance.y)
    };
    // From -3, -3, -1 to 3, 3, 2.
    let squared = 0.357 * 0.357 * 0.25 * (36.0 + 36.0 + 9.0);
    for (height, squared) in [(0.5, squared), (0.51, squared), (1.9, squared), (5.0, 4.5 * 4.5)] {
        close(at(height), 0.2 * 15.0 / PI / squared, 1e-6);
    }
}

/// Squares of 2 cm, far away: each ray sees their mean.
#[test]
fn clarity_filters_textures() {
    let squares = "
        look = 'clarity'
        film = { resolution = [16, 16], samples = 1 }
        camera.orthographic = { position = [0, 0, 9], target = [0, 0, 0], height = 8, up = [0, 1, 0] }
        surfaces.floor.quad = { corner = [-9, -9, 0], edge_u = [18, 0, 0], edge_v = [0, 18, 0] }
        surfaces.floor.material = 'squares'
        materials.squares.lambert.reflectance.checker = { colors = [0, 1], size = 0.001 }
    ";
    let image = picture(&scene(squares, &[])).image;
    for [r, ..] in image.pixels() {
        assert!((r - 0.5).abs() < 0.05, "{r} is one of the squares");
    }
}

#[test]
fn looks_are_what_they_say() {
    use firstlight::scene::description::{Integrator, Light};
    let integrator = |look: &str| scene(ABOVE, &[&format!("look='{look}'")]).integrator;
    assert_eq!(integrator("real"), Integrator::Path { bounces: None });
    assert_eq!(integrator("balanced"), Integrator::Direct);
    assert!(matches!(integrator("clarity"), Integrator::Clarity { section: None, .. }));
    let balanced = scene(ABOVE, &["look='balanced'"]);
    let Light::Ambient { radiance, reach } = balanced.lights[1].light else { panic!("ambient") };
    assert!(radiance.y > 0.0 && reach.is_finite());
}
