//! Which files a scene may open, and how much it may unpack.

use crate::diagnostic::{Diagnostic, Result};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

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
///
/// It remembers what it opened, together with its clones and what comes of [`FileAccess::within`].
#[derive(Debug, Clone)]
pub struct FileAccess {
    folder: PathBuf,
    /// The folder of the file itself, if the scene is a link to a file elsewhere.
    target: Option<PathBuf>,
    allowed: Vec<PathBuf>,
    opened: Arc<Mutex<BTreeSet<PathBuf>>>,
    /// What is in the folders that were looked through: names by their small letters.
    listings: Arc<Mutex<BTreeMap<PathBuf, BTreeMap<String, String>>>>,
    /// Limits for what is decoded.
    pub limits: Limits,
}

impl FileAccess {
    /// Access for the scene or model file `path`: its folder, and the folders in `allowed`. If `path` is a link,
    /// also the folder of the file that it leads to: who names the link means that file.
    pub fn beside(path: &Path, allowed: &[PathBuf]) -> Self {
        let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let target = path.is_symlink().then(|| path.canonicalize().ok()).flatten();
        Self {
            folder: folder.to_owned(),
            target: target.map(|target| folder_of(&target)),
            allowed: allowed.to_vec(),
            opened: Arc::default(),
            listings: Arc::default(),
            limits: Limits::default(),
        }
    }

    /// The same permissions for a file in another folder that was itself allowed.
    #[must_use]
    pub fn within(&self, path: &Path) -> Self {
        let mut inner = Self::beside(path, &self.allowed);
        inner.allowed.push(self.folder.clone());
        inner.limits = self.limits;
        inner.opened = Arc::clone(&self.opened);
        inner.listings = Arc::clone(&self.listings);
        inner
    }

    /// The real paths (links followed) of all files that were opened so far.
    pub fn opened(&self) -> BTreeSet<PathBuf> {
        self.opened.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Remembers that the file with this real path is opened.
    fn remember(&self, real: PathBuf) {
        self.opened.lock().unwrap_or_else(PoisonError::into_inner).insert(real);
    }

    /// The bytes of the scene file itself, which the user named.
    ///
    /// # Errors
    /// If it is no regular file or cannot be read.
    pub(crate) fn read_named(&self, path: &Path) -> Result<Vec<u8>> {
        let bytes = read_file(path)?;
        path.canonicalize().into_iter().for_each(|real| self.remember(real));
        Ok(bytes)
    }

    /// The real path of `name`, relative to the scene's folder, if it may be opened.
    ///
    /// # Errors
    /// If the name is a network address, the file does not exist, or (links followed) lies elsewhere.
    pub fn resolve(&self, name: &str) -> Result<PathBuf> {
        if name.get(..7).is_some_and(|start| start.eq_ignore_ascii_case("file://")) {
            let error = Diagnostic::new(name, "local file URLs are not opened");
            return Err(Box::new(error.help("write the path, such as pictures/wood.png")));
        }
        if name.contains("://") || name.starts_with("\\\\") || name.starts_with("//") {
            let error = Diagnostic::new(name, "network addresses are not opened");
            return Err(Box::new(error.help("download the file and place it beside the scene")));
        }
        let path = self.find(name);
        let real = path.canonicalize().map_err(|e| Diagnostic::new(shown(&path), cause(&e)))?;
        let roots = std::iter::once(&self.folder).chain(&self.target).chain(&self.allowed);
        let inside = roots.filter_map(|r| r.canonicalize().ok()).any(|root| real.starts_with(root));
        if inside {
            self.remember(real);
            return Ok(path);
        }
        let error =
            Diagnostic::new(name, "this file is outside the scene's folder and is not opened");
        Err(Box::new(
            error.help(format!("allow it with --allow-path {}", shown(&folder_of(&real)))),
        ))
    }

    /// The bytes of `name`; if it cannot be opened, of what it must have meant, and how that is called from the scene's folder.
    ///
    /// Models go from one machine to another, and keep the paths of the first: so ends of the path are looked for, from
    /// all of it down to the file name alone, in any case of letters; but never upwards.
    ///
    /// # Errors
    /// As [`FileAccess::read`] of `name`.
    pub(crate) fn read_meant(&self, name: &str) -> Result<(Vec<u8>, Option<String>)> {
        /// Folders that are kept of a path, at the most.
        const DEPTH: usize = 16;
        let error = match self.read(name) {
            Ok(bytes) => return Ok((bytes, None)),
            Err(error) => error,
        };
        let parts: Vec<&str> = name.split(['/', '\\']).collect();
        let ends = (parts.len().saturating_sub(DEPTH)..parts.len()).map(|start| &parts[start..]);
        let ends = ends.filter(|end| !end.contains(&".."));
        let roots = || std::iter::once(&self.folder).chain(&self.target);
        let meant =
            ends.flat_map(|end| roots().filter_map(move |root| self.in_any_case(root, end)));
        let mut found = meant.filter_map(|name| Some((self.read(&name).ok()?, Some(name))));
        found.next().ok_or(error)
    }

    /// The path of these folders and a file as it is written below `root`, if it is there but for the case of letters.
    fn in_any_case(&self, root: &Path, parts: &[&str]) -> Option<String> {
        let mut path = root.to_owned();
        let mut names = Vec::with_capacity(parts.len());
        for part in parts {
            let there = path.join(part).exists();
            let name = if there { (*part).into() } else { self.alike(&path, part)? };
            path.push(&name);
            names.push(name);
        }
        Some(names.join("/"))
    }

    /// The first name in `folder` that is `name` but for the case of letters.
    fn alike(&self, folder: &Path, name: &str) -> Option<String> {
        let mut listings = self.listings.lock().unwrap_or_else(PoisonError::into_inner);
        let names = listings.entry(folder.to_owned()).or_insert_with(|| listing(folder));
        names.get(&name.to_lowercase()).cloned()
    }

    /// `name` in the scene's folder or, if it is not there, beside the file that the scene is a link to.
    fn find(&self, name: &str) -> PathBuf {
        let path = self.folder.join(name);
        let beside_target = self.target.as_ref().map(|target| target.join(name));
        beside_target.filter(|other| !path.exists() && other.exists()).unwrap_or(path)
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

/// The names in `folder` by their small letters; of those that then are the same, the first.
fn listing(folder: &Path) -> BTreeMap<String, String> {
    let entries = std::fs::read_dir(folder).into_iter().flatten();
    let names = entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
    let mut names: Vec<String> = names.collect();
    names.sort_unstable_by(|a, b| b.cmp(a));
    names.into_iter().map(|name| (name.to_lowercase(), name)).collect()
}

fn folder_of(path: &Path) -> PathBuf {
    path.parent().unwrap_or(path).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_opened_is_remembered() {
        let folder = tempfile::tempdir().unwrap();
        let real = folder.path().canonicalize().unwrap();
        std::fs::create_dir(real.join("sub")).unwrap();
        for name in ["scene.toml", "sub/m.obj", "sub/m.mtl", "unused.png"] {
            std::fs::write(real.join(name), name).unwrap();
        }
        let scene = real.join("scene.toml");
        let access = FileAccess::beside(&scene, &[]);
        access.read_named(&scene).unwrap();
        let model = access.resolve("sub/m.obj").unwrap();
        access.within(&model).read("m.mtl").unwrap();
        let expected = ["scene.toml", "sub/m.mtl", "sub/m.obj"].map(|name| real.join(name));
        assert!(access.opened().into_iter().eq(expected), "{:?}", access.opened());
    }

    #[test]
    fn addresses_are_not_opened() {
        let access = FileAccess::beside(Path::new("scene.toml"), &[]);
        let complaint = |name: &str| access.resolve(name).unwrap_err().to_string();
        assert!(complaint("https://example.org/a.png").contains("network addresses"));
        assert!(complaint("File:///a.png").contains("local file URLs are not opened"));
    }

    #[test]
    fn paths_of_other_machines_are_found_by_their_ends() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("Tex")).unwrap();
        for name in ["Tex/Wood.PNG", "stone.png"] {
            std::fs::write(folder.path().join(name), name).unwrap();
        }
        let access = FileAccess::beside(&folder.path().join("m.obj"), &[]);
        for (name, found) in [
            ("Tex/Wood.PNG", None),
            ("tex/wood.png", Some("Tex/Wood.PNG")),
            ("C:\\Users\\me\\tex\\WOOD.png", Some("Tex/Wood.PNG")),
            ("/home/me/proj/Tex/Wood.PNG", Some("Tex/Wood.PNG")),
            ("../maps/Stone.png", Some("stone.png")),
            ("\\\\server\\share\\stone.png", Some("stone.png")),
        ] {
            let (bytes, meant) = access.read_meant(name).unwrap();
            assert_eq!(meant.as_deref(), found, "{name}");
            assert_eq!(bytes, found.unwrap_or(name).as_bytes());
        }
        let deep = "a/".repeat(100_000) + "wood.png";
        for gone in ["wood.png", "Tex", "", "tex/", &deep] {
            assert!(access.read_meant(gone).is_err(), "{gone}");
        }
        let outside = FileAccess::beside(&folder.path().join("Tex/m.obj"), &[]);
        assert!(outside.read_meant("../STONE.png").is_err());
        // With permission for the folder above, what is there is still not looked for by other names.
        let allowed = [folder.path().to_owned()];
        let above = FileAccess::beside(&folder.path().join("Tex/m.obj"), &allowed);
        assert!(
            above.read_meant("../stone.png").is_ok() && above.read_meant("../STONE.png").is_err()
        );
        std::fs::write(folder.path().join("Tex/Stone.png"), "here").unwrap();
        let found = FileAccess::beside(&folder.path().join("Tex/m.obj"), &[]);
        assert_eq!(found.read_meant("../stone.PNG").unwrap().1.as_deref(), Some("Stone.png"));
    }

    #[cfg(unix)]
    #[test]
    fn a_link_reaches_what_lies_beside_its_target() {
        let (here, there) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        for (folder, name) in
            [(&there, "m.obj"), (&there, "a.mtl"), (&there, "b.mtl"), (&here, "b.mtl")]
        {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        let link = here.path().join("link.obj");
        std::os::unix::fs::symlink(there.path().join("m.obj"), &link).unwrap();
        let access = FileAccess::beside(&link, &[]);
        assert_eq!(access.resolve("link.obj").unwrap(), link);
        assert_eq!(access.resolve("b.mtl").unwrap(), here.path().join("b.mtl"));
        let there = there.path().canonicalize().unwrap();
        assert_eq!(access.resolve("a.mtl").unwrap(), there.join("a.mtl"));
        let other = FileAccess::beside(&here.path().join("scene.toml"), &[]);
        assert!(other.resolve("link.obj").is_err());
    }
}
