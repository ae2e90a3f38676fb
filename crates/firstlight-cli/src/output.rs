//! Where pictures and data go.

use crate::args::OutputArgs;
use crate::{Exit, Failure, Outcome};
use firstlight::diagnostic::Diagnostic;
use firstlight::io::{self, Format};
use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::io::{BufWriter, ErrorKind, IsTerminal, Write};
use std::path::{Path, PathBuf};

/// A picture to be written; that it can be is checked before it is rendered.
#[derive(Debug)]
pub(crate) struct Output {
    /// No path: standard output.
    path: Option<PathBuf>,
    /// What it is written as.
    pub format: Format,
}

impl Output {
    /// Where the picture that `args` ask for goes: by default, to a file called `stem`, as a PNG. With `json`, standard
    /// output is taken.
    pub(crate) fn plan(args: &OutputArgs, stem: &OsStr, json: bool) -> Outcome<Self> {
        let format = args.format.map(crate::args::FormatName::format);
        let path = args.path.clone().unwrap_or_else(|| default_path(stem, format));
        if path == Path::new("-") {
            check_stdout(json)?;
            return Ok(Self { path: None, format: format.unwrap_or(PNG) });
        }
        check_path(&path)?;
        let format = choose_format(&path, format)?;
        Ok(Self { path: Some(path), format })
    }

    /// Where a part goes: to a file in the format of parts.
    pub(crate) fn plan_part(args: &OutputArgs, stem: &OsStr, json: bool) -> Outcome<Self> {
        let default = Some(default_path(stem, Some(PART)));
        let path = args.path.clone().or(default.filter(|_| args.format.is_none()));
        let output = Self::plan(&OutputArgs { path, ..*args }, stem, json)?;
        let is_part = output.format == PART && output.path.is_some();
        let error =
            || Diagnostic::new(output.name(), "the samples of --samples are a part, not a picture");
        is_part.then_some(()).ok_or_else(|| error().help("name an .exr file with -o"))?;
        Ok(output)
    }

    /// A file beside it, called the same but for `word` before the extension.
    pub(crate) fn beside(&self, word: &str) -> Outcome<Self> {
        let Some(path) = &self.path else {
            let message = format!("there is no place beside it for the {word} copy");
            return Err(Diagnostic::new("-o -", message).help("name a file with -o").into());
        };
        let mut name = path.file_stem().unwrap_or_default().to_owned();
        name.push(format!(".{word}"));
        if let Some(extension) = path.extension() {
            name.push(".");
            name.push(extension);
        }
        let path = path.with_file_name(name);
        check_path(&path)?;
        Ok(Self { path: Some(path), format: self.format })
    }

    /// The file as the user named it, or `-`.
    pub(crate) fn name(&self) -> String {
        self.path.as_ref().map_or("-".into(), |path| path.display().to_string())
    }

    /// Refuses to write over any of `inputs`, the real paths of what the picture is made of.
    pub(crate) fn spare(&self, inputs: &BTreeSet<PathBuf>) -> Outcome<()> {
        let real = self.path.as_ref().and_then(|path| path.canonicalize().ok());
        if real.is_none_or(|real| !inputs.contains(&real)) {
            return Ok(());
        }
        let message = "the picture would overwrite this file, which the scene is read from";
        let error = Diagnostic::new(self.name(), message);
        Err(error.help("name another file with -o").into())
    }

    /// Writes the file. If that fails, the bytes are saved in the folder for temporary files, so that the
    /// rendering was not in vain.
    pub(crate) fn write(&self, bytes: &[u8]) -> Outcome<()> {
        let Some(path) = &self.path else { return print(bytes) };
        io::write(path, bytes).map_err(|mut error| {
            if let Some(rescued) = rescue(self.format, bytes) {
                error.help = Some(format!("the picture was saved as {}", rescued.display()));
            }
            Failure { exit: Exit::Failed, error }
        })
    }
}

const PNG: Format = Format::Png { bits: io::BitDepth::Eight };

/// What parts are written as.
const PART: Format = Format::Exr { precision: io::Precision::Float };

/// A name in the current folder.
fn default_path(stem: &OsStr, format: Option<Format>) -> PathBuf {
    let mut name = stem.to_owned();
    name.push(".");
    name.push(extension(format.unwrap_or(PNG)));
    name.into()
}

fn extension(format: Format) -> &'static str {
    match format {
        Format::Png { .. } => "png",
        Format::Exr { .. } => "exr",
        Format::Hdr => "hdr",
        Format::Pfm => "pfm",
    }
}

/// The format asked for, unless the extension says another one.
fn choose_format(path: &Path, asked: Option<Format>) -> Outcome<Format> {
    match (asked, Format::from_path(path)) {
        (None, named) => Ok(named?),
        (Some(asked), Ok(named)) if extension(asked) != extension(named) => {
            let message = format!("--format says .{}", extension(asked));
            let error = Diagnostic::new(path.display().to_string(), message);
            Err(error.help("let the name and --format say the same").into())
        }
        (Some(asked), _) => Ok(asked),
    }
}

fn check_stdout(json: bool) -> Outcome<()> {
    if json {
        let message = "the picture and the --json report cannot both go to standard output";
        return Err(Diagnostic::new("-o -", message).help("name a file with -o").into());
    }
    if std::io::stdout().is_terminal() {
        let message = "a picture is not for the terminal";
        let help = "name a file with -o, or send it on: … -o - > picture.png";
        return Err(Diagnostic::new("-o -", message).help(help).into());
    }
    Ok(())
}

/// Whether a file of this name can be written, as far as that shows before.
fn check_path(path: &Path) -> Outcome<()> {
    let complain = |message: String, help: &str| {
        Err(Diagnostic::new(path.display().to_string(), message).help(help).into())
    };
    if path.is_dir() || path.to_string_lossy().ends_with(std::path::is_separator) {
        return complain("this is a folder, not a file".into(), "end it with the name of a file");
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new("."));
    if !folder.is_dir() {
        let message = format!("there is no folder {}", folder.display());
        return complain(message, "create it first, or choose another");
    }
    let protected = path.metadata().is_ok_and(|found| found.permissions().readonly());
    if protected {
        let help = "choose another name, or allow writing to it";
        return complain("this file is write-protected".into(), help);
    }
    Ok(())
}

/// The bytes in a new file of the folder for temporary files.
fn rescue(format: Format, bytes: &[u8]) -> Option<PathBuf> {
    let suffix = format!(".{}", extension(format));
    let mut file =
        tempfile::Builder::new().prefix("firstlight-").suffix(&suffix).tempfile().ok()?;
    file.write_all(bytes).ok()?;
    file.keep().ok().map(|(_, path)| path)
}

/// Sends data to standard output.
pub(crate) fn print(bytes: &[u8]) -> Outcome<()> {
    print_all(std::iter::once(bytes))
}

/// Sends data to standard output, piece by piece as it comes. That its reader went away is no failure.
pub(crate) fn print_all<T: AsRef<[u8]>>(pieces: impl IntoIterator<Item = T>) -> Outcome<()> {
    let mut stdout = BufWriter::new(std::io::stdout().lock());
    let mut pieces = pieces.into_iter();
    let written = pieces.try_for_each(|piece| stdout.write_all(piece.as_ref()));
    match written.and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(Failure {
            exit: Exit::Failed,
            error: Box::new(Diagnostic::new("standard output", format!("cannot write: {error}"))),
        }),
        _ => Ok(()),
    }
}

/// Prints JSON over several lines.
pub(crate) fn print_json(value: &serde_json::Value) -> Outcome<()> {
    print(format!("{value:#}\n").as_bytes())
}
