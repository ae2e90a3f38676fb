//! Files ↔ [`SceneDescription`](crate::scene::description::SceneDescription) and [`Image`](crate::Image).
//!
//! The shared pieces: which files may be opened ([`FileAccess`]) and how complaints that do not stop the
//! loading are collected ([`Warnings`]).

mod access;
pub mod gltf;
pub mod pixels;

pub use access::{FileAccess, Limits};

use crate::diagnostic::Diagnostic;

/// Complaints that do not stop the loading, in the order they came up.
pub type Warnings = Vec<Diagnostic>;
