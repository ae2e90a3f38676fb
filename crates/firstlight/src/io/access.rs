//! Which files a scene may open, and how much it may unpack.

use crate::diagnostic::{Diagnostic, Result};
use std::path::{Path, PathBuf};

/// How much memory a decoder may ask for.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Bytes of one decoded picture or buffer.
    pub decoded_bytes: u64,
}

impl Default for Limits {
    /// 1 GiB a picture.
    fn default() -> Self {
        Self { decoded_bytes: 1 << 30 }
    }
}

/// Opens files on behalf of a scene or model: only inside its own folder, unless more is allowed.
#[derive(Debug, Clone)]
pub struct FileAccess {
    folder: PathBuf,
    allowed: Vec<PathBuf>,
    /// Limits for what is decoded.
    pub limits: Limits,
}

impl FileAccess {
    /// Access for the scene or model file `path`: its folder, and the folders in `allowed`.
    pub fn beside(path: &Path, allowed: &[PathBuf]) -> Self {
        let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        Self { folder: folder.to_owned(), allowed: allowed.to_vec(), limits: Limits::default() }
    }

    /// The same permissions for a file in another folder that was itself allowed.
    #[must_use]
    pub fn within(&self, path: &Path) -> Self {
        let mut inner = Self::beside(path, &self.allowed);
        inner.allowed.push(self.folder.clone());
        inner.limits = self.limits;
        inner
    }

    /// The real path of `name`, relative to the scene's folder, if it may be opened.
    ///
    /// # Errors
    /// If the name is a network address, the file does not exist, or (links followed) lies elsewhere.
    pub fn resolve(&self, name: &str) -> Result<PathBuf> {
        if name.contains("://") || name.starts_with("\\\\") || name.starts_with("//") {
            let error = Diagnostic::new(name, "network addresses are not opened");
            return Err(Box::new(error.help("download the file and place it beside the scene")));
        }
        let path = self.folder.join(name);
        let real = path.canonicalize().map_err(|e| Diagnostic::new(shown(&path), cause(&e)))?;
        let roots = std::iter::once(&self.folder).chain(&self.allowed);
        let inside = roots.filter_map(|r| r.canonicalize().ok()).any(|root| real.starts_with(root));
        if inside {
            return Ok(path);
        }
        let error =
            Diagnostic::new(name, "this file is outside the scene's folder and is not opened");
        Err(Box::new(
            error.help(format!("allow it with --allow-path {}", shown(&folder_of(&real)))),
        ))
    }

    /// The bytes of `name`, under the rules of [`FileAccess::resolve`].
    ///
    /// # Errors
    /// As [`FileAccess::resolve`], and if reading fails.
    pub fn read(&self, name: &str) -> Result<Vec<u8>> {
        read_file(&self.resolve(name)?)
    }
}

/// The bytes of the file at `path`, which must be a regular file.
///
/// # Errors
/// As [`check_file`], and if it cannot be read.
pub(crate) fn read_file(path: &Path) -> Result<Vec<u8>> {
    check_file(path)?;
    std::fs::read(path).map_err(|e| Box::new(Diagnostic::new(shown(path), cause(&e))))
}

/// Whether there is a regular file at `path`: a device or a pipe may never end.
///
/// # Errors
/// If it does not exist, is a folder, a device or a pipe.
pub(crate) fn check_file(path: &Path) -> Result<()> {
    let found = std::fs::metadata(path).map_err(|e| Diagnostic::new(shown(path), cause(&e)))?;
    let message = match found {
        found if found.is_file() => return Ok(()),
        found if found.is_dir() => "this is a folder, not a file",
        _ => "this is a device or a pipe, not a file",
    };
    Err(Box::new(Diagnostic::new(shown(path), message)))
}

/// A path as text for messages.
pub(crate) fn shown(path: &Path) -> String {
    path.display().to_string()
}

/// An operating system error in plain words.
pub(crate) fn cause(error: &std::io::Error) -> String {
    match error.kind() {
        std::io::ErrorKind::NotFound => "no such file".into(),
        std::io::ErrorKind::PermissionDenied => "permission denied".into(),
        _ => error.to_string(),
    }
}

fn folder_of(path: &Path) -> PathBuf {
    path.parent().unwrap_or(path).to_owned()
}
