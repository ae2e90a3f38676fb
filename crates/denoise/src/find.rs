//! Where Open Image Denoise is on this machine.

use std::env::{consts, var_os};
use std::path::{Path, PathBuf};
use std::process::Command;

/// The variable that names the folder it was unpacked into.
const FOLDER: &str = "OIDN_DIR";

/// Prints the folder of the Python package that brings it. The folder that we are in is not looked into: it may be
/// anybody's.
const ASK_PYTHON: &str = "import sys; sys.path = [p for p in sys.path if p]; import importlib.util as u; \
    print(u.find_spec('pyoidn').submodule_search_locations[0])";

/// The files to try, the likeliest first: only that of `OIDN_DIR` if that is set, else what the system knows by its name,
/// and that of the Python package.
pub(super) fn candidates() -> Vec<PathBuf> {
    if let Some(folder) = var_os(FOLDER) {
        return vec![library_in(Path::new(&folder))];
    }
    // Elsewhere a bare name would be looked for in the folder that we are in as well.
    let known = (consts::OS == "linux").then(|| PathBuf::from("libOpenImageDenoise.so.2"));
    known.into_iter().chain(in_python().map(|package| library_in(&package.join("oidn")))).collect()
}

/// The library in the folder of a release.
fn library_in(release: &Path) -> PathBuf {
    let folder = if consts::OS == "windows" { "bin" } else { "lib" };
    let name = format!("{}OpenImageDenoise{}", consts::DLL_PREFIX, consts::DLL_SUFFIX);
    release.join(folder).join(name)
}

/// The folder of the package `pyoidn` of the `python3` that is on the path.
fn in_python() -> Option<PathBuf> {
    let asked = Command::new("python3").args(["-c", ASK_PYTHON]).output().ok()?;
    let folder = String::from_utf8(asked.stdout).ok()?;
    Some(PathBuf::from(folder.trim_end())).filter(|folder| folder.is_absolute())
}
