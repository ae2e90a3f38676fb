//! Parameters of materials that vary over a surface, where it is known what must come out.

mod common;

use common::*;
use firstlight::render::{RenderOptions, render};
use firstlight::{Image, Scene};
use std::f64::consts::PI;
use std::ops::ControlFlow;
use std::path::Path;

fn picture(text: &str) -> Image {
    let scene = Scene::build(&read(Path::new("scene.toml"), text, &[]));
    render(&scene, &RenderOptions::default(), &|_| ControlFlow::Continue(())).image
}

/// A square metre seen from above, 2 × 2 pixels, of the material `paint`.
const SQUARE: &str = "
    film = { resolution = [2, 2], samples = 256, filter = { box = { radius = 0.5 } } }
    [camera.orthographic]
    position = [0, 0, 5]
    height = 1
    up = [0, 1, 0]
    [surfaces.square]
    quad = {}
    material = 'paint'
";

fn square(first: &str, material: &str, rest: &str) -> Image {
    picture(&format!("{first}\n{SQUARE}\n[materials.paint.lambert]\n{material}\n{rest}"))
}

/// An occlusion map takes its part of ambient light: 1 + strength · (map − 1) is left, and of no other light anything.
#[test]
fn occlusion_maps_darken_ambient_light_alone() {
    let material = |occlusion| format!("reflectance = 0.5\n{occlusion}");
    let creased = material("occlusion_map = 0.25\nocclusion_strength = 0.5");
    let left = 1.0 + 0.5 * (0.25 - 1.0);
    let ambient = "[lights.fill.ambient]\nradiance = 0.8";
    let nearby = "[lights.fill.ambient]\nradiance = 0.8\nreach = 1";
    let sun = format!("[lights.sun.directional]\ndirection = [0, 0, -1]\nirradiance = {PI}");
    for integrator in ["integrator = 'direct'", "integrator = 'path'"] {
        for light in [ambient, nearby] {
            let seen = square(integrator, &creased, light).get(0, 0).x;
            close(seen, 0.5 * 0.8 * left, 1e-5);
            let seen = square(integrator, &creased, &format!("{light}\n{sun}")).get(0, 0).x;
            close(seen, 0.5 + 0.5 * 0.8 * left, 1e-5);
            let glossy = format!("mirror = 0.25\n{creased}");
            let seen = square(integrator, &glossy, light).get(0, 0).x;
            close(seen, 0.75 * 0.8 * left, 1e-5);
        }
        close(square(integrator, &creased, &sun).get(0, 0).x, 0.5, 1e-5);
    }
    let sky = square("integrator = 'path'\nenvironment.uniform.radiance = 1", &creased, "");
    close(sky.get(0, 0).x, 0.5, 1e-5);
    // The look that shows shapes: four tenths of a colour are always there, the rest where it is open.
    let wide = "quad = { corner = [-9, -9, 0], edge_u = [18, 0, 0], edge_v = [0, 18, 0] }";
    let square = SQUARE.replace("quad = {}", wide);
    let shown =
        picture(&format!("look = 'clarity'\n{square}\n[materials.paint.lambert]\n{creased}"));
    close(shown.get(1, 1).x, 0.5 * (0.4 + 0.6 * left), 1e-5);
}

/// By halves: where the map is 1 everything comes, where it is 0 nothing.
#[test]
fn occlusion_maps_are_looked_up_where_they_are() {
    let map = "reflectance = 1\nocclusion_map = { checker = { colors = [1, 0], size = [0.5, 9] } }";
    let scene =
        format!("{SQUARE}\n[materials.paint.lambert]\n{map}\n[lights.fill.ambient]\nradiance = 1");
    let image = picture(&scene.replace("[2, 2]", "[16, 16]"));
    // Rays stand for a little of what is beside them.
    assert!(image.get(4, 0).x > 0.9999 && image.get(12, 0).x < 1e-4);
}

/// Of what is behind, 1 − opacity shows.
#[test]
fn opacity_varies_over_a_surface() {
    let opacity = "opacity = { checker = { colors = [1, 0.25], size = [0.5, 9] } }";
    let image = square("background = 1", &format!("reflectance = 0\n{opacity}"), "");
    assert_eq!(image.get(0, 0).x, 0.0);
    let deviation = (0.25 * 0.75 / 256.0_f64).sqrt();
    for iy in 0..2 {
        assert!((f64::from(image.get(1, iy).x) - 0.75).abs() < 4.0 * deviation);
    }
    let constant = square("background = 1", "reflectance = 0\nopacity = 0.25", "");
    let mapped = "reflectance = 0\nopacity = { checker = { colors = [0.25, 0.25] } }";
    assert_eq!(constant.pixels(), square("background = 1", mapped, "").pixels());
}

/// A map of 0, 0.5 and 1 is the thinnest film, the middle and the thickest.
#[test]
fn films_are_as_thick_as_their_map_says() {
    let film = |thickness: &str| {
        let text = format!(
            "integrator = 'path'\n{SQUARE}
            [materials.paint.principled]
            base_color = 0.6
            metallic = 1
            roughness = 0.2
            iridescence = 1
            {thickness}
            [environment.uniform]
            radiance = 1"
        );
        picture(&text).get(0, 0)
    };
    let colors = [200, 350, 500].map(|nm| film(&format!("iridescence_thickness = '{nm} nm'")));
    assert!(colors[0].distance(colors[1]) > 0.02 && colors[1].distance(colors[2]) > 0.02);
    for (part, color) in [0.0, 0.5, 1.0].into_iter().zip(colors) {
        let mapped = film(&format!(
            "iridescence_thickness = '500 nm'
            iridescence_thickness_min = '200 nm'
            iridescence_thickness_map = {{ checker = {{ colors = [{part}, {part}] }} }}"
        ));
        assert!(mapped.distance(color) < 1e-4, "{part}: {mapped} is not {color}");
    }
}
