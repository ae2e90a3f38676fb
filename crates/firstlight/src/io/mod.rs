//! Files ↔ [`SceneDescription`](crate::scene::description::SceneDescription) and [`Image`](crate::Image).
//!
//! The shared pieces: which files may be opened ([`FileAccess`]) and how complaints that do not stop the
//! loading are collected ([`Warnings`]).

mod access;
mod atomic;
mod exr;
mod hdr;
mod pfm;
pub mod pixels;
mod png;
mod save;

pub use access::{FileAccess, Limits};
pub use atomic::write;
pub use pixels::load_image;
pub use save::{BitDepth, Develop, Format, Metadata, Precision, save};

use crate::diagnostic::Diagnostic;

/// Complaints that do not stop the loading, in the order they came up.
pub type Warnings = Vec<Diagnostic>;
