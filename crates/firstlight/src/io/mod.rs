//! Files ↔ [`SceneDescription`](crate::scene::description::SceneDescription) and [`Image`](crate::Image).
//!
//! [`load()`] reads any scene or model file. The shared pieces: which files may be opened ([`FileAccess`]) and how
//! complaints that do not stop the loading are collected ([`Warnings`]).

mod access;
mod atomic;
mod decoders;
mod exr;
pub mod gltf;
mod hdr;
mod ktx2;
mod layers;
mod load;
pub mod luminaire;
mod measured;
pub mod model;
pub mod obj;
mod part;
mod pfm;
mod pictures;
pub mod pixels;
pub mod ply;
mod png;
mod save;
pub mod scene_file;
pub mod stl;
mod text;
mod triangles;

pub use access::{FileAccess, Limits};
pub use atomic::write;
pub use layers::{EFFICACY, LayerFile, load_layers, save_layers};
pub use load::{is_scene_file, load, model_override};
pub use measured::{load_measured, load_variance};
pub use part::{Part, PartInfo, load_part, merge_parts, save_part};
pub use pixels::load_image;
pub use save::{BitDepth, Develop, Format, Metadata, Precision, save};

use crate::diagnostic::Diagnostic;

/// Complaints that do not stop the loading, in the order they came up.
pub type Warnings = Vec<Diagnostic>;
