//! What tests have in common.
#![allow(dead_code, unused_imports, reason = "each test file uses its part")]

pub(crate) use firstlight::verify::scenes::*;
pub(crate) use firstlight::verify::{Random, differing, escaped, reintersections, terminator};

use firstlight::io::scene_file;
use firstlight::{FileAccess, Measurement, SceneDescription};
use std::path::Path;

#[track_caller]
pub(crate) fn close(value: impl Into<f64>, expected: f64, relative: f64) {
    let value = value.into();
    let error = if expected == 0.0 { value.abs() } else { (value / expected - 1.0).abs() };
    assert!(error <= relative, "{value} is not {expected} within {relative}: off by {error:e}");
}

/// Takes samples until the standard error is at most 0.1 %, then asks whether the value is right.
#[track_caller]
pub(crate) fn expect(measure: impl Fn(u32) -> Measurement, expected: f64) {
    let known = |m: &Measurement| f64::from(m.standard_error.x) <= 1e-3 * expected;
    let mut tries = (12..=24).step_by(2).map(|k| measure(1 << k)).filter(known);
    let measured = tries.next().expect("the standard error falls to 0.1 %");
    let (value, error) = (f64::from(measured.value.x), f64::from(measured.standard_error.x));
    let off = (value - expected).abs();
    assert!(off <= 4.0 * error + 3e-5 * expected, "{value} ± {error} is not {expected}");
}

/// The scene of a text in a file of that name, with some values set.
pub(crate) fn read(path: &Path, text: &str, set: &[&str]) -> SceneDescription {
    let set: Vec<_> = set.iter().map(|set| set.parse().expect("a value is set")).collect();
    let access = FileAccess::beside(path, &[]);
    let scene = scene_file::read(text, "scene.toml", &set, &access, &mut Vec::new());
    let scene = scene.unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    scene.check().expect("what was read is sound");
    scene
}

/// Small pictures of all scenes of the project, with their names.
pub(crate) fn small_scenes() -> Vec<(String, SceneDescription)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let (mut folders, mut scenes) = (vec![root], Vec::new());
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).expect("the folder can be read") {
            let path = entry.expect("the folder can be read").path();
            match path.extension() {
                None => folders.push(path),
                Some(extension) if extension == "toml" => scenes.push(small(&path)),
                Some(_) => {}
            }
        }
    }
    scenes
}

fn small(path: &Path) -> (String, SceneDescription) {
    let text = std::fs::read_to_string(path).expect("the scene can be read");
    let scene = read(path, &text, &["film.resolution=[24, 16]", "film.samples=6"]);
    (path.display().to_string(), scene)
}
