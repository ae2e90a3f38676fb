//! The developers' own commands: `cargo xtask test`, `cargo xtask gallery`, `cargo xtask bench`.

mod contact_sheet;
mod gallery;

use std::process::{Command, ExitCode};

/// The test that writes the tables.
const TABLES: &str = "write_the_tables";

const USAGE: &str = "\
Usage: cargo xtask COMMAND

  test      formatting, lints, all tests, documentation: what has to pass
  slow      the tests that take minutes
  tables    integrates the tables in crates/firstlight/data/ anew
  gallery   renders every scene in scenes/ into docs/images/
  contact-sheet FOLDER
            small pictures of every glTF model in a folder on one sheet
  bench     times tracing and building, beside Embree where it is installed; more with --help
  bench --peers
            times whole renders beside Mitsuba, Cycles, LuxCore and POV-Ray; more with --help
  bench --race
            how soon paths come to the same error as in Mitsuba and Cycles; more with --help";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let done = match arguments.first().map(String::as_str) {
        Some("test") => test(),
        Some("slow") => {
            cargo(&["test", "--workspace", "--release", "--", "--ignored", "--skip", TABLES])
        }
        Some("tables") => cargo(&[
            "test",
            "--package",
            "firstlight",
            "--lib",
            "--release",
            TABLES,
            "--",
            "--ignored",
        ]),
        Some("gallery") => gallery::render_all(),
        Some("contact-sheet") => contact_sheet::make(&arguments[1..]),
        Some("bench") => bench(&arguments[1..]),
        _ => Err(USAGE.into()),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}

/// Runs everything that has to pass, cheapest first.
fn test() -> Result<(), String> {
    cargo(&["fmt", "--all", "--check"])?;
    cargo(&["clippy", "--workspace", "--all-targets", "--", "--deny", "warnings"])?;
    cargo(&["test", "--workspace"])?;
    // The library that it calls need not be there: tests of what it does then say so.
    let denoise = ["--package", "firstlight-cli", "--features", "denoise"];
    cargo(&[&["clippy", "--all-targets"], &denoise[..], &["--", "--deny", "warnings"]].concat())?;
    cargo(&[&["test"], &denoise[..], &["denoise"]].concat())?;
    documentation()
}

/// Hands over to what measures: `--peers` compares whole renders, `--race` how soon renderers come to the same error, anything
/// else is for the crate `firstlight-bench`.
fn bench(arguments: &[String]) -> Result<(), String> {
    match arguments.split_first() {
        Some((first, options)) if first == "--peers" => script("run.py", options),
        Some((first, options)) if first == "--race" => script("race.py", options),
        _ => {
            let program = ["run", "--release", "--quiet", "--package", "firstlight-bench", "--"];
            let usual = arguments.is_empty().then_some("kernels");
            run(Command::new("cargo").args(program).args(usual).args(arguments))
        }
    }
}

/// Times renders beside other renderers, by scripts, since most of those are Python packages.
fn script(name: &str, options: &[String]) -> Result<(), String> {
    cargo(&["build", "--release", "--package", "firstlight-cli"])?;
    let script = format!("crates/bench/peers/{name}");
    let program = [script.as_str(), "--firstlight", "target/release/firstlight"];
    run(Command::new("python3").args(program).args(options))
}

/// Builds the documentation; a broken link is an error.
fn documentation() -> Result<(), String> {
    let arguments = ["doc", "--workspace", "--no-deps", "--document-private-items", "--quiet"];
    run(Command::new("cargo").args(arguments).env("RUSTDOCFLAGS", "--deny warnings"))
}

fn cargo(arguments: &[&str]) -> Result<(), String> {
    run(Command::new("cargo").args(arguments))
}

/// Runs a command to its end, with its output shown.
fn run(command: &mut Command) -> Result<(), String> {
    eprintln!("$ {}", shown(command));
    match command.status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(format!("`{}` failed: {status}", shown(command))),
        Err(error) => Err(format!("`{}` cannot be run: {error}", shown(command))),
    }
}

fn shown(command: &Command) -> String {
    let words = std::iter::once(command.get_program()).chain(command.get_args());
    words.map(|word| word.to_string_lossy().into_owned()).collect::<Vec<_>>().join(" ")
}
