//! Real glTF files: skipped unless FIRSTLIGHT_MODELS names a folder of models.

use firstlight::io::{FileAccess, Warnings, gltf};
use firstlight::scene::description::SceneDescription;
use std::path::{Path, PathBuf};

fn find(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            find(&path, found);
        } else if path.extension().is_some_and(|e| e == "gltf" || e == "glb") {
            found.push(path);
        }
    }
}

fn read(path: &Path) -> SceneDescription {
    let bytes = std::fs::read(path).unwrap();
    let access = FileAccess::beside(path, &[]);
    let name = path.display().to_string();
    gltf::read(&bytes, &name, &access, &mut Warnings::new()).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn every_model_can_be_read_and_is_consistent() {
    let Ok(folder) = std::env::var("FIRSTLIGHT_MODELS") else {
        eprintln!("skipped: FIRSTLIGHT_MODELS is not set");
        return;
    };
    let mut paths = Vec::new();
    find(Path::new(&folder), &mut paths);
    for path in paths {
        let scene = read(&path);
        assert!(!scene.surfaces.is_empty(), "{}", path.display());
        for mesh in &scene.meshes {
            let count = mesh.positions.len();
            assert!(mesh.triangles.iter().flatten().all(|&corner| (corner as usize) < count));
            assert!(mesh.normals.iter().all(|normal| normal.is_normalized()));
        }
        assert!(scene.surfaces.iter().all(|surface| surface.material < scene.materials.len()));
    }
}
