//! The scene that a command is about.

use crate::args::InputArgs;
use crate::{Exit, Failure, Outcome};
use firstlight::SceneDescription;
use firstlight::diagnostic::{Diagnostic, Result};
use firstlight::io::scene_file::{self, Override};
use firstlight::io::{FileAccess, Warnings, is_scene_file, load};
use std::ffi::OsStr;
use std::io::Read;
use std::path::Path;

/// What standard input is called in messages.
pub(crate) const STDIN: &str = "standard input";
/// Bytes read from standard input, at most: it may never end.
const MOST_BYTES: u64 = 256 << 20;

impl InputArgs {
    /// Whether the scene comes from standard input.
    pub(crate) fn is_stdin(&self) -> bool {
        self.scene == Path::new("-")
    }

    /// Whether it is a model, not a scene file.
    pub(crate) fn is_model(&self) -> bool {
        !self.is_stdin() && !is_scene_file(&self.scene)
    }

    /// Whether the user has set what stands under these keys, or a part of it, with `-D`.
    pub(crate) fn sets(&self, keys: &[&str]) -> bool {
        self.define.iter().any(|set| set.sets(keys))
    }

    /// The scene as it is called in messages and reports.
    pub(crate) fn name(&self) -> String {
        if self.is_stdin() { "-".into() } else { self.scene.display().to_string() }
    }

    /// The name that its pictures have if they are given none.
    pub(crate) fn stem(&self) -> &OsStr {
        self.scene.file_stem().filter(|_| !self.is_stdin()).unwrap_or(OsStr::new("scene"))
    }

    /// Access to the files of the scene.
    pub(crate) fn access(&self) -> FileAccess {
        FileAccess::beside(&self.scene, &self.allow_path)
    }

    /// Reads the scene. The result is sound.
    pub(crate) fn load(&self, warnings: &mut Warnings) -> Outcome<SceneDescription> {
        self.load_with(Vec::new(), &self.access(), warnings)
    }

    /// Reads the scene through `access`, with `more` laid over it before the user's own overrides.
    pub(crate) fn load_with(
        &self,
        more: Vec<Override>,
        access: &FileAccess,
        warnings: &mut Warnings,
    ) -> Outcome<SceneDescription> {
        let overrides = [more, self.define.clone()].concat();
        let scene = if self.is_stdin() {
            let text = read_stdin()?;
            scene_file::read(&text, STDIN, &overrides, access, warnings)?
        } else {
            load(&self.scene, &overrides, access, warnings)?
        };
        scene.check().map_err(|error| self.named(error))?;
        Ok(scene)
    }

    /// A complaint about the whole scene with the name of its file.
    fn named(&self, mut error: Box<Diagnostic>) -> Box<Diagnostic> {
        if error.place.file.is_empty() {
            error.place.file = self.name();
        }
        error
    }
}

/// Makes the camera of that name the one in use. `frame` takes them all away, so that everything is framed.
pub(crate) fn choose_camera(scene: &mut SceneDescription, name: Option<&str>) -> Result<()> {
    match name {
        None => Ok(()),
        Some("frame") => {
            scene.cameras.clear();
            Ok(())
        }
        Some(name) => scene.choose_camera(name).map_err(|mut error| {
            error.place.file = "--camera".into();
            error
        }),
    }
}

/// All of standard input as text.
pub(crate) fn read_stdin() -> Outcome<String> {
    let mut bytes = Vec::new();
    let read = std::io::stdin().lock().take(MOST_BYTES + 1).read_to_end(&mut bytes);
    read.map_err(|e| Failure {
        exit: Exit::Failed,
        error: Box::new(Diagnostic::new(STDIN, format!("cannot be read: {e}"))),
    })?;
    if bytes.len() as u64 > MOST_BYTES {
        let message = format!("more than {} MiB are not read", MOST_BYTES >> 20);
        return Err(Diagnostic::new(STDIN, message).help("use a file").into());
    }
    Ok(scene_file::text(bytes, STDIN)?)
}
