//! Where Embree is on this machine.

use super::Embree;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Prints the folder that Python packages are installed in, if `embreex` is one of them.
const ASK_PYTHON: &str = "import importlib.util as u, os; print(os.path.dirname(os.path.dirname(u.find_spec('embreex').origin)))";

impl Embree {
    /// Embree from the library file `named`, or else from the Python package `embreex`; `None` without both.
    ///
    /// # Errors
    /// If there is a library that cannot be used.
    pub(crate) fn find(named: Option<&Path>) -> Result<Option<Self>, String> {
        let found = named.map(Path::to_owned).or_else(in_python);
        found.map(|path| Self::open(&path)).transpose()
    }
}

/// The library inside the package `embreex` of the `python3` that is on the path.
fn in_python() -> Option<PathBuf> {
    let asked = Command::new("python3").args(["-c", ASK_PYTHON]).output().ok()?;
    let packages = String::from_utf8(asked.stdout).ok()?;
    let folder = Path::new(packages.trim_end()).join("embreex.libs");
    let mut files = fs::read_dir(folder).ok()?.filter_map(|entry| Some(entry.ok()?.path()));
    files.find(|file| file.file_name().is_some_and(|name| is_embree(&name.to_string_lossy())))
}

fn is_embree(name: &str) -> bool {
    name.starts_with("libembree4") || name.starts_with("embree4")
}
