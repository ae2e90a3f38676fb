//! Decodes every picture below the folder that the environment variable FIRSTLIGHT_MODELS names; skipped without it.

use firstlight::io::{Limits, pixels};
use std::path::{Path, PathBuf};

#[test]
fn every_picture_can_be_read() {
    let Some(folder) = std::env::var_os("FIRSTLIGHT_MODELS") else {
        eprintln!("skipped: FIRSTLIGHT_MODELS names no folder of models");
        return;
    };
    let files = pictures(Path::new(&folder));
    assert!(!files.is_empty(), "no pictures below {}", folder.display());
    let complaints: Vec<_> = files.iter().filter_map(|file| complaint(file)).collect();
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}

fn complaint(file: &Path) -> Option<String> {
    let bytes = std::fs::read(file).unwrap();
    let decoded = pixels::decode(&bytes, &file.display().to_string(), &Limits::default());
    decoded.err().map(|error| error.to_string())
}

fn pictures(folder: &Path) -> Vec<PathBuf> {
    let paths = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let inside = paths.flat_map(|path| if path.is_dir() { pictures(&path) } else { vec![path] });
    inside.filter(|path| is_picture(path)).collect()
}

fn is_picture(path: &Path) -> bool {
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    ["png", "jpg", "jpeg", "webp", "tga", "bmp", "tif", "tiff", "gif", "hdr", "exr", "pfm"]
        .contains(&extension.as_str())
}
