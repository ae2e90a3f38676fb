//! Files ↔ [`SceneDescription`](crate::scene::description::SceneDescription) and [`Image`](crate::Image).
//!
//! [`load`] reads any scene or model file. The shared pieces: which files may be opened ([`FileAccess`]) and how
//! complaints that do not stop the loading are collected ([`Warnings`]).

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
mod load;
pub mod model;
pub mod scene_file;

// merged later: the readers of other formats replace these.
macro_rules! merged_later {
    ($($format:ident)*) => {$(
        pub(crate) mod $format {
            use crate::diagnostic::{Diagnostic, Result};
            use crate::scene::description::SceneDescription;
            pub(crate) fn read(
                _: &[u8],
                name: &str,
                _: &super::FileAccess,
                _: &mut super::Warnings,
            ) -> Result<SceneDescription> {
                let message = concat!(stringify!($format), " files cannot be read yet");
                Err(Box::new(Diagnostic::new(name, message)))
            }
        }
    )*};
}
merged_later! { gltf obj ply stl }

pub use load::{is_scene_file, load, model_override};

use crate::diagnostic::Diagnostic;

/// Complaints that do not stop the loading, in the order they came up.
pub type Warnings = Vec<Diagnostic>;
