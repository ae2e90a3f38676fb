//! Writing files so that they are whole or absent.

use super::access::{cause, shown};
use crate::diagnostic::{Diagnostic, Result};
use std::fs::{File, Metadata, Permissions};
use std::io::{Error, ErrorKind, Write};
use std::path::{Path, PathBuf};

/// Writes a file so that its name shows either all of `bytes` or what was there before, even if the program is
/// killed or the power fails: under another name beside it, flushed to the disk, then renamed.
///
/// A new file gets the usual permissions; one that is replaced passes its own on. Symbolic links are followed
/// and stay. What is not a regular file (`/dev/null`, a pipe) is written to directly. A killed program may leave
/// the other name behind: `.firstlight-*.part`.
///
/// # Errors
/// If the path is a folder or a write-protected file, its folder is missing or may not be written to, or the
/// disk is full. A file that was there before is then untouched.
pub fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    if path.file_name().is_none() || shown(path).ends_with(std::path::is_separator) {
        return Err(is_folder(path));
    }
    let existing = std::fs::metadata(path).ok();
    match &existing {
        Some(found) if found.is_dir() => Err(is_folder(path)),
        Some(found) if !found.is_file() => {
            write_directly(path, bytes).map_err(|e| failure(path, &e))
        }
        Some(found) if found.permissions().readonly() => Err(write_protected(path)),
        _ => {
            let target = follow_links(path).map_err(|e| failure(path, &e))?;
            replace(&target, bytes, existing.as_ref()).map_err(|e| failure(path, &e))
        }
    }
}

fn write_directly(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let mut file = File::options().write(true).open(path)?;
    file.write_all(bytes)?;
    file.flush()
}

/// Where a path leads in the end, also if there is no file yet.
fn follow_links(path: &Path) -> std::io::Result<PathBuf> {
    /// As many as Linux follows.
    const LINKS: usize = 40;
    let mut target = path.to_owned();
    for _ in 0..LINKS {
        if !target.is_symlink() {
            return Ok(target);
        }
        target = folder_of(&target).join(std::fs::read_link(&target)?);
    }
    Err(Error::other("too many symbolic links, one after the other"))
}

fn replace(target: &Path, bytes: &[u8], existing: Option<&Metadata>) -> std::io::Result<()> {
    let mut file = new_file(folder_of(target))?;
    file.write_all(bytes)?;
    if let Some(existing) = existing {
        file.as_file().set_permissions(existing.permissions())?;
    }
    file.as_file().sync_all()?;
    file.persist(target)?;
    // Makes the new name last as well. Not every system can do that, and the file is in place already.
    let _ = File::open(folder_of(target)).and_then(|folder| folder.sync_all());
    Ok(())
}

/// A file of a name not in use, removed again unless it is renamed.
fn new_file(folder: &Path) -> std::io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".firstlight-").suffix(".part");
    if let Some(permissions) = usual_permissions() {
        builder.permissions(permissions);
    }
    builder.tempfile_in(folder)
}

/// What programs ask for when they make a file; the system takes away what the umask forbids.
#[cfg(unix)]
fn usual_permissions() -> Option<Permissions> {
    use std::os::unix::fs::PermissionsExt;
    Some(Permissions::from_mode(0o666))
}

#[cfg(not(unix))]
fn usual_permissions() -> Option<Permissions> {
    None
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

fn is_folder(path: &Path) -> Box<Diagnostic> {
    let error = Diagnostic::new(shown(path), "this names no file but a folder, or nothing");
    Box::new(error.help("end it with the name of a file"))
}

fn write_protected(path: &Path) -> Box<Diagnostic> {
    let error = Diagnostic::new(shown(path), "this file is write-protected and was left as it is");
    Box::new(error.help("choose another name, or allow writing to it"))
}

fn failure(path: &Path, error: &Error) -> Box<Diagnostic> {
    let folder = shown(folder_of(path));
    let (message, help) = match error.kind() {
        ErrorKind::NotFound => {
            (format!("the folder {folder} does not exist"), "create it first, or choose another")
        }
        ErrorKind::PermissionDenied => {
            (format!("no permission to write in {folder}"), "choose a folder that you may write to")
        }
        ErrorKind::ReadOnlyFilesystem => {
            (format!("{folder} is on a read-only disk"), "choose a folder on another disk")
        }
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => {
            ("the disk is full".to_owned(), "make room, or choose a folder on another disk")
        }
        ErrorKind::NotADirectory => {
            (format!("{folder} is not a folder"), "choose a file name inside a folder")
        }
        _ => (format!("cannot write this file: {}", cause(error)), "choose another name or folder"),
    };
    Box::new(Diagnostic::new(shown(path), message).help(help))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn folder() -> tempfile::TempDir {
        tempfile::tempdir().unwrap()
    }

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    }

    #[test]
    fn writes_and_replaces_leaving_nothing_else() {
        let folder = folder();
        let path = folder.path().join("out.png");
        for bytes in [b"first".as_slice(), b"", b"second"] {
            write(&path, bytes).unwrap();
            assert_eq!(fs::read(&path).unwrap(), bytes);
            assert_eq!(names(folder.path()), ["out.png"]);
        }
    }

    #[test]
    fn an_interrupted_write_leaves_the_old_file() {
        let folder = folder();
        let path = folder.path().join("out.png");
        write(&path, b"old").unwrap();
        // What `replace` does, interrupted before the renaming; here the new file is dropped, not killed.
        let mut unfinished = new_file(folder.path()).unwrap();
        unfinished.write_all(b"ne").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"old");
        drop(unfinished);
        assert_eq!(names(folder.path()), ["out.png"]);
    }

    #[test]
    fn refuses_folders_and_missing_folders_with_help() {
        let folder = folder();
        for path in [folder.path(), &folder.path().join("new/"), Path::new(""), Path::new("..")] {
            let error = write(path, b"x").unwrap_err();
            assert!(error.message.contains("names no file"), "{error}");
        }
        let error = write(&folder.path().join("no/out.png"), b"x").unwrap_err();
        assert!(error.message.contains("no does not exist"), "{error}");
        assert!(error.help.is_some());
        fs::write(folder.path().join("file"), b"").unwrap();
        let error = write(&folder.path().join("file/out.png"), b"x").unwrap_err();
        assert!(error.message.contains("is not a folder"), "{error}");
    }

    #[test]
    fn leaves_a_write_protected_file_alone() {
        let folder = folder();
        let path = folder.path().join("out.png");
        write(&path, b"old").unwrap();
        let mut permissions = fs::metadata(&path).unwrap().permissions();
        permissions.set_readonly(true);
        fs::set_permissions(&path, permissions).unwrap();
        let error = write(&path, b"new").unwrap_err();
        assert!(error.message.contains("write-protected"), "{error}");
        assert_eq!(fs::read(&path).unwrap(), b"old");
    }

    #[cfg(unix)]
    mod unix {
        use super::*;
        use std::os::unix::fs::{PermissionsExt, symlink};

        fn mode(path: &Path) -> u32 {
            fs::metadata(path).unwrap().permissions().mode()
        }

        #[test]
        fn permissions_are_those_of_any_new_file_or_of_the_one_replaced() {
            let folder = folder();
            let (ours, theirs) = (folder.path().join("ours"), folder.path().join("theirs"));
            write(&ours, b"x").unwrap();
            fs::write(&theirs, b"x").unwrap();
            assert_eq!(mode(&ours), mode(&theirs));
            fs::set_permissions(&ours, Permissions::from_mode(0o640)).unwrap();
            write(&ours, b"y").unwrap();
            assert_eq!(mode(&ours) & 0o777, 0o640);
        }

        #[test]
        fn links_are_followed_and_stay() {
            let folder = folder();
            fs::create_dir(folder.path().join("sub")).unwrap();
            let (link, target) = (folder.path().join("link"), folder.path().join("sub/out.png"));
            symlink("sub/out.png", &link).unwrap();
            for bytes in [b"new", b"old"] {
                write(&link, bytes).unwrap();
                assert!(link.is_symlink());
                assert_eq!(fs::read(&target).unwrap(), bytes);
            }
            let circle = folder.path().join("circle");
            symlink("circle", &circle).unwrap();
            assert!(write(&circle, b"x").unwrap_err().message.contains("symbolic links"));
        }

        #[test]
        fn devices_are_written_to_directly() {
            write(Path::new("/dev/null"), b"x").unwrap();
            assert!(!fs::metadata("/dev/null").unwrap().is_file());
        }

        #[cfg(target_os = "linux")]
        #[test]
        fn a_full_disk_is_called_that() {
            let error = write(Path::new("/dev/full"), b"x").unwrap_err();
            assert_eq!(error.message, "the disk is full");
        }
    }
}
