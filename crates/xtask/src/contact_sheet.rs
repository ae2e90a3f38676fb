//! Small pictures of every model in a folder on one sheet, to see at a glance what is wrong with any of them.

use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Width and height of the picture of a model, pixels.
const SIDE: usize = 192;
/// Pictures in a row.
const COLUMNS: usize = 8;
/// What is rendered.
const KINDS: [&str; 2] = ["gltf", "glb"];
/// What stands where a model could not be rendered: red.
const MISSING: [u8; 3] = [160, 0, 0];

/// Makes the sheet of the arguments `FOLDER [-o FILE]`, and says what is where.
pub(crate) fn make(arguments: &[String]) -> Result<(), String> {
    let (folder, output) = match arguments {
        [folder] => (folder, "sheet.png"),
        [folder, flag, output] if flag == "-o" => (folder, output.as_str()),
        _ => return Err("usage: cargo xtask contact-sheet FOLDER [-o sheet.png]".into()),
    };
    super::cargo(&["build", "--package", "firstlight-cli"])?;
    let mut models = Vec::new();
    find(Path::new(folder), &mut models).map_err(|error| format!("{folder}: {error}"))?;
    models.sort();
    let sheet = Sheet::of(&models);
    sheet.save(Path::new(output)).map_err(|error| format!("{output}: {error}"))?;
    println!("wrote {output}: {} models", models.len());
    Ok(())
}

/// All models below a folder.
fn find(folder: &Path, models: &mut Vec<PathBuf>) -> std::io::Result<()> {
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            find(&path, models)?;
        } else if KINDS.iter().any(|kind| path.extension().is_some_and(|e| e == *kind)) {
            models.push(path);
        }
    }
    Ok(())
}

/// Pictures in rows, RGB.
struct Sheet {
    rows: usize,
    pixels: Vec<u8>,
}

impl Sheet {
    fn of(models: &[PathBuf]) -> Self {
        let rows = models.len().div_ceil(COLUMNS).max(1);
        let mut sheet = Self { rows, pixels: vec![0; rows * COLUMNS * SIDE * SIDE * 3] };
        for (index, model) in models.iter().enumerate() {
            let (row, column) = (index / COLUMNS, index % COLUMNS);
            println!("row {} column {}: {}", row + 1, column + 1, model.display());
            match picture(model) {
                Ok(pixels) => sheet
                    .place(row, column, |i| [pixels[3 * i], pixels[3 * i + 1], pixels[3 * i + 2]]),
                Err(error) => {
                    println!("  {error}");
                    sheet.place(row, column, |_| MISSING);
                }
            }
        }
        sheet
    }

    fn place(&mut self, row: usize, column: usize, color: impl Fn(usize) -> [u8; 3]) {
        for i in 0..SIDE * SIDE {
            let (x, y) = (column * SIDE + i % SIDE, row * SIDE + i / SIDE);
            let at = 3 * (y * COLUMNS * SIDE + x);
            self.pixels[at..at + 3].copy_from_slice(&color(i));
        }
    }

    fn save(&self, path: &Path) -> Result<(), png::EncodingError> {
        let (width, height) = (COLUMNS * SIDE, self.rows * SIDE);
        let mut encoder = png::Encoder::new(File::create(path)?, width as u32, height as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.write_header()?.write_image_data(&self.pixels)
    }
}

/// The RGB pixels of a model's picture.
fn picture(model: &Path) -> Result<Vec<u8>, String> {
    let file = Path::new("target/contact-sheet.png");
    let size = format!("{SIDE}x{SIDE}");
    let mut render = Command::new("target/debug/firstlight");
    render.arg("render").arg(model).arg("-o").arg(file);
    let done = render.args(["-r", &size, "--spp", "32", "-q"]).output();
    let done = done.map_err(|error| format!("cannot render: {error}"))?;
    if !done.status.success() {
        return Err(String::from_utf8_lossy(&done.stderr).trim().to_owned());
    }
    let reader = BufReader::new(File::open(file).map_err(|e| e.to_string())?);
    let mut reader = png::Decoder::new(reader).read_info().map_err(|e| e.to_string())?;
    let mut pixels = vec![0; reader.output_buffer_size().unwrap_or(0)];
    let info = reader.next_frame(&mut pixels).map_err(|e| e.to_string())?;
    let is_whole = info.color_type == png::ColorType::Rgb && pixels.len() == SIDE * SIDE * 3;
    is_whole.then_some(pixels).ok_or_else(|| "the picture is not as asked for".into())
}
