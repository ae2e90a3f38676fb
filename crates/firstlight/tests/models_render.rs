//! Every model in a folder of yours: `FIRSTLIGHT_MODELS=folder cargo test`. Without the variable there is nothing to do.

use firstlight::render::{RenderOptions, render};
use firstlight::scene::Studio;
use firstlight::{FileAccess, Scene, load};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

const EXTENSIONS: [&str; 5] = ["gltf", "glb", "obj", "ply", "stl"];

fn models(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        if path.is_dir() {
            models(&path, found);
        } else if EXTENSIONS.contains(&extension.as_str()) {
            found.push(path);
        }
    }
}

/// Loads, dresses and renders a model in small; what went wrong in words.
fn problem(path: &Path) -> Option<String> {
    let mut scene = match load(path, &[], &FileAccess::beside(path, &[]), &mut Vec::new()) {
        Ok(scene) => scene,
        Err(refused) if refused.to_string().contains(&path.display().to_string()) => return None,
        Err(refused) => return Some(format!("a complaint without its file: {refused}")),
    };
    if let Err(unsound) = scene.check() {
        return Some(unsound.to_string());
    }
    (scene.film.width, scene.film.height, scene.film.samples) = (64, 36, 1);
    scene.lights.clear();
    Studio::default().dress(&mut scene);
    let done =
        render(&Scene::build(&scene), &RenderOptions::default(), &|_| ControlFlow::Continue(()));
    let lit = done.image.pixels().iter().any(|p| p[0] > 0.0 && p[0] != scene.background.x);
    let nothing = (!lit).then(|| "nothing to be seen".to_owned());
    nothing.or((done.dropped > 0).then(|| format!("{} samples dropped", done.dropped)))
}

#[test]
fn every_model_is_read_and_seen_or_refused_by_name() {
    let Some(folder) = std::env::var_os("FIRSTLIGHT_MODELS") else { return };
    let mut found = Vec::new();
    models(Path::new(&folder), &mut found);
    assert!(!found.is_empty(), "no models in FIRSTLIGHT_MODELS");
    let problems: Vec<String> = found
        .iter()
        .filter_map(|path| Some(format!("{}: {}", path.display(), problem(path)?)))
        .collect();
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}
