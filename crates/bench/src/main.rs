//! Measures firstlight: `cargo xtask bench kernels`, `cargo xtask bench pictures`.

mod builds;
mod embree;
mod kernels;
mod meshes;
mod ours;
mod pictures;
mod plot;
mod race;
mod rays;
mod recipe;
mod report;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// Measures firstlight. Tables go to stdout, in Markdown.
#[derive(Debug, Parser)]
#[command(name = "cargo xtask bench")]
struct Arguments {
    #[command(subcommand)]
    what: What,
}

/// What can be measured.
#[derive(Debug, Subcommand)]
enum What {
    /// Building, and rays of every kind, beside Embree where it is installed.
    Kernels(kernels::Options),
    /// Whole pictures of a scene made on the spot, per level and number of threads.
    Pictures,
}

fn main() -> ExitCode {
    let done = match Arguments::parse().what {
        What::Kernels(options) => kernels::run(&options),
        What::Pictures => {
            pictures::run();
            Ok(())
        }
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::FAILURE
        }
    }
}
