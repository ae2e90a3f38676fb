//! What denoisers are told: albedo and normals as means over pixels.

mod common;

use common::{close, read};
use firstlight::Scene;
use firstlight::layers::Guides;
use firstlight::render::{Crop, render_guides};
use std::path::Path;

/// Pixels of 1 m. A red wall leaves the upper three rows and a quarter of the fourth free, and ends within the sixth column.
const WALL: &str = "
    film = { resolution = [8, 8], samples = 64, filter = 'box' }
    camera.orthographic = { position = [0, -5, 0], target = [0, 0, 0], height = 8 }
    surfaces.wall.quad = { corner = [-9, 0, -9], edge_u = [10.5, 0, 0], edge_v = [0, 0, 9.75] }
    surfaces.wall.material = 'red'
    materials.red.lambert.reflectance = [0.8, 0.2, 0.1]
    lights.key.point = { position = [0, -5, 0], power = 9 }
";

fn guides(text: &str, set: &[&str], threads: usize, crop: Option<Crop>) -> Guides {
    let scene = Scene::build(&read(Path::new("scene.toml"), text, set));
    render_guides(&scene, threads, crop)
}

#[test]
fn pixels_hold_the_part_of_a_surface_that_is_in_them() {
    let Guides { albedo, normal } = guides(WALL, &[], 1, None);
    for (x, y, part) in
        [(2, 6, 1.0), (2, 3, 0.75), (5, 6, 0.5), (5, 3, 0.375), (6, 6, 0.0), (2, 2, 0.0)]
    {
        let pixel = 8 * y + x;
        for (value, of_wall) in albedo[pixel].into_iter().zip([0.8, 0.2, 0.1]) {
            close(value, part * of_wall, 1e-6);
        }
        for (value, of_wall) in normal[pixel].into_iter().zip([0.0, -1.0, 0.0]) {
            close(value, part * of_wall, 1e-6);
        }
    }
}

#[test]
fn no_filter_and_no_material_leaves_the_range() {
    let bright = ["materials.red.lambert.reflectance=1.0", "film.filter='mitchell'"];
    let Guides { albedo, normal } = guides(WALL, &bright, 1, None);
    assert!(albedo.iter().flatten().all(|value| (0.0..=1.0).contains(value)));
    let length = |[x, y, z]: [f32; 3]| (x * x + y * y + z * z).sqrt();
    assert!(normal.into_iter().all(|normal| length(normal) <= 1.0 + 1e-6));
    assert_eq!(albedo[8 * 6 + 2], [1.0; 3]);
}

#[test]
fn threads_and_crops_change_nothing() {
    let text = WALL.replace("[8, 8]", "[40, 40]");
    let whole = guides(&text, &[], 1, None);
    assert_eq!(guides(&text, &[], 3, None), whole);
    let crop = guides(&text, &[], 2, Some(Crop { x: 15, y: 9, width: 20, height: 18 }));
    for (row, pixels) in crop.albedo.chunks(20).enumerate() {
        assert_eq!(pixels, &whole.albedo[40 * (9 + row) + 15..][..20], "row {row}");
    }
}
