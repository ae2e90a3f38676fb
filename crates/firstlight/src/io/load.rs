//! Any file that holds a scene.

use super::access::{check_file, shown};
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
    if is_scene_file(path) {
        let text = scene_file::text(access.read_named(path)?, &name)?;
        return scene_file::read(&text, &name, overrides, access, warnings);
    }
    check_file(path)?;
    let text = scene_around(path).ok_or_else(|| no_file(path))?;
    scene_file::read_around(&text, &name, overrides, access, warnings)
}

/// Whether `path` names a scene file, by its extension `.toml`; anything else is taken for a model.
pub fn is_scene_file(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml"))
}

/// What sets `key` (`up`, `unit`, …) of the model that [`load`] reads from `path`. In complaints it is called
/// `--key value`, as on the command line.
///
/// # Errors
/// If the path names no file.
pub fn model_override(path: &Path, key: &str, value: &str) -> Result<Override> {
    let name = path.file_stem().and_then(quoted_key).ok_or_else(|| no_file(path))?;
    let set: Override = format!("models.{name}.{key}={value}").parse()?;
    Ok(set.called(format!("--{key} {value}")))
}

fn no_file(path: &Path) -> Box<Diagnostic> {
    Box::new(Diagnostic::new(shown(path), "this is not a file"))
}

/// The text of a scene that holds one model.
fn scene_around(model: &Path) -> Option<String> {
    let (name, file) = (quoted_key(model.file_stem()?)?, quoted_key(model.file_name()?)?);
    Some(format!("models.{name}.file = {file}\n"))
}

/// A name in the quotation marks of TOML.
fn quoted_key(name: &std::ffi::OsStr) -> Option<String> {
    name.to_str().map(|name| toml::Value::from(name).to_string())
}
