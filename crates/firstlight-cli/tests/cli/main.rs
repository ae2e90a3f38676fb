//! The command as its users run it, each time in a fresh folder.

mod compare;
mod denoise;
mod doctor;
mod explain;
mod measure;
mod models;
mod parts;
mod render;
mod report;
#[cfg(unix)]
mod signals;
mod stop;
mod usage;
mod verify;

use std::io::Write;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use tempfile::TempDir;

/// A ball on a floor under a lamp of 100 W at (0, 0, 4).
pub(crate) const SCENE: &str = r#"
film = { resolution = [48, 32], samples = 4 }
[camera.perspective]
position = [0, -6, 3]
target = [0, 0, 0.5]
fov = 40
[cameras.top.orthographic]
position = [0, 0, 9]
target = [0, 0, 0]
height = 6
[surfaces.ball]
sphere = { center = [2, 0, 1], radius = 1 }
[surfaces.floor]
plane = {}
[lights.lamp.point]
position = [0, 0, 4]
power = "100 W"
"#;

/// What a run of the command left.
pub(crate) struct Ran {
    pub code: Option<i32>,
    pub stdout: Vec<u8>,
    pub stderr: String,
}

impl Ran {
    pub(crate) fn text(&self) -> String {
        String::from_utf8(self.stdout.clone()).expect("text")
    }

    pub(crate) fn json(&self) -> serde_json::Value {
        serde_json::from_slice(&self.stdout).expect("standard output is JSON and nothing else")
    }

    #[track_caller]
    pub(crate) fn fails(&self, code: i32, words: &[&str]) {
        assert_eq!(self.code, Some(code), "{}", self.stderr);
        for word in words {
            assert!(self.stderr.contains(word), "{word:?} is not in\n{}", self.stderr);
        }
    }

    #[track_caller]
    pub(crate) fn done(self) -> Self {
        assert_eq!(self.code, Some(0), "{}", self.stderr);
        self
    }
}

/// A fresh folder that holds `scene.toml`.
pub(crate) struct Folder(TempDir);

impl Folder {
    pub(crate) fn new() -> Self {
        let folder = Self(tempfile::tempdir().expect("a folder"));
        folder.write("scene.toml", SCENE);
        folder
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, text: &str) {
        std::fs::write(self.path(name), text).expect("written");
    }

    /// The names of its files, in order.
    pub(crate) fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.0.path()).expect("a folder");
        let mut names: Vec<_> = entries
            .map(|entry| entry.expect("an entry").file_name().into_string().expect("text"))
            .collect();
        names.sort();
        names
    }

    /// The command in this folder, with the arguments in `line`, split at blanks.
    pub(crate) fn command(&self, line: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_firstlight"));
        command
            .args(line.split_whitespace())
            .current_dir(self.0.path())
            .env("TMPDIR", self.0.path());
        command
    }

    pub(crate) fn run(&self, line: &str) -> Ran {
        self.run_with(line, b"")
    }

    /// Runs it with `input` on standard input.
    pub(crate) fn run_with(&self, line: &str, input: &[u8]) -> Ran {
        let mut command = self.command(line);
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().expect("started");
        // A command that needs no input may be gone already.
        let _ = child.stdin.take().expect("piped").write_all(input);
        let output = child.wait_with_output().expect("ended");
        Ran {
            code: output.status.code(),
            stdout: output.stdout,
            stderr: String::from_utf8(output.stderr).expect("text"),
        }
    }
}

/// Width, height and 8-bit codes of a PNG, decoded to the end.
#[track_caller]
pub(crate) fn decode(bytes: &[u8]) -> (u32, u32, Vec<u8>) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().expect("a PNG");
    let mut codes = vec![0; reader.output_buffer_size().expect("a size")];
    let info = reader.next_frame(&mut codes).expect("pixels");
    reader.finish().expect("an end");
    (info.width, info.height, codes)
}
