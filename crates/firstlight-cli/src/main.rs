//! The `firstlight` command: parse → run → exit code.

mod args;
mod check;
mod compare;
mod denoise;
mod drawing;
mod explain;
mod false_color;
mod info;
mod input;
mod layers;
mod lights;
mod machine;
mod measure;
mod merge;
mod output;
mod picture;
mod relight;
mod render;
mod report;
mod rows;
mod schema;
mod studio;
mod verdict;
mod verify;

use args::{Arguments, Command};
use clap::Parser;
use firstlight::diagnostic::Diagnostic;
use std::process::ExitCode;

fn main() -> ExitCode {
    let result = match Arguments::parse().command {
        Command::Render(args) => render::run(*args),
        Command::Explain(args) => explain::run(&args),
        Command::Check(args) => check::run(&args),
        Command::Info(args) => info::run(&args),
        Command::Compare(args) => compare::run(&args),
        Command::Lights(args) => lights::run(&args),
        Command::Schema => schema::run(),
        Command::Measure(args) => measure::run(&args),
        Command::Merge(args) => merge::run(&args),
        Command::Relight(args) => relight::run(&args),
        Command::Verify(args) => verify::run(&args),
    };
    let exit = result.unwrap_or_else(|failure| {
        report::error(&failure.error);
        failure.exit
    });
    ExitCode::from(exit as u8)
}

/// What the exit code says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Exit {
    Done = 0,
    Failed = 1,
    Usage = 2,
    Strict = 3,
    Differs = 4,
    Interrupt = 130,
    Terminate = 143,
}

/// Why a command cannot go on.
struct Failure {
    exit: Exit,
    error: Box<Diagnostic>,
}

type Outcome<T = Exit> = Result<T, Failure>;

/// Wrong usage or bad input, unless said otherwise.
impl From<Box<Diagnostic>> for Failure {
    fn from(error: Box<Diagnostic>) -> Self {
        Self { exit: Exit::Usage, error }
    }
}

impl From<Diagnostic> for Failure {
    fn from(error: Diagnostic) -> Self {
        Box::new(error).into()
    }
}
