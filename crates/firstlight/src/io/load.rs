//! Any file that holds a scene.

use super::access::{read_file, shown};
use super::scene_file::{self, Override};
use super::{FileAccess, Warnings};
use crate::diagnostic::{Diagnostic, Result};
use crate::scene::description::SceneDescription;
use std::path::Path;

/// Reads the scene file (`.toml`) or model file at `path`, with `overrides` laid over it.
///
/// A model is read as a scene that holds nothing else: upright, z up, under the file's name without extension.
/// `access` decides what else may be opened; [`FileAccess::beside`]`(path, ..)` is the usual one.
///
/// # Errors
/// If the file cannot be read or anything in it or in the overrides is wrong; the place says where.
pub fn load(
    path: &Path,
    overrides: &[Override],
    access: &FileAccess,
    warnings: &mut Warnings,
) -> Result<SceneDescription> {
    let name = shown(path);
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml")) {
        let text = scene_file::text(read_file(path)?, &name)?;
        return scene_file::read(&text, &name, overrides, access, warnings);
    }
    let text = scene_around(path).ok_or_else(|| Diagnostic::new(&name, "this is not a file"))?;
    scene_file::read(&text, &name, overrides, access, warnings)
}

/// The text of a scene that holds one model.
fn scene_around(model: &Path) -> Option<String> {
    let toml = |text: &std::ffi::OsStr| text.to_str().map(|t| toml::Value::from(t).to_string());
    let (name, file) = (toml(model.file_stem()?)?, toml(model.file_name()?)?);
    Some(format!("models.{name}.file = {file}\n"))
}
