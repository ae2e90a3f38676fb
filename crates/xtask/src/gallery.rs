//! The pictures of the documentation, each made by one command from a scene in the repository.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Renders every scene file below `scenes/` to `docs/images/`, in folders of the same names.
pub(crate) fn render_all() -> Result<(), String> {
    super::cargo(&["build", "--release", "--package", "firstlight-cli"])?;
    let scenes = scenes(Path::new("scenes")).map_err(|error| format!("scenes: {error}"))?;
    for scene in scenes {
        let below = scene.strip_prefix("scenes").unwrap_or(&scene);
        let picture = Path::new("docs/images").join(below).with_extension("png");
        let folder = picture.parent().unwrap_or(Path::new("."));
        fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
        if !below.starts_with("looks") {
            render(&scene, &picture, &[])?;
            continue;
        }
        for look in ["clarity", "balanced", "real"] {
            let name = format!("{}-{look}.png", scene.file_stem().unwrap_or_default().display());
            render(&scene, &picture.with_file_name(name), &["--look", look])?;
        }
    }
    Ok(())
}

fn render(scene: &Path, picture: &Path, more: &[&str]) -> Result<(), String> {
    let program = Path::new("target/release/firstlight");
    super::run(Command::new(program).arg("render").arg(scene).arg("-o").arg(picture).args(more))
}

/// All scene files below a folder, in the order of their names.
fn scenes(folder: &Path) -> std::io::Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            found.extend(scenes(&path)?);
        } else if path.extension().is_some_and(|extension| extension == "toml") {
            found.push(path);
        }
    }
    found.sort();
    Ok(found)
}
