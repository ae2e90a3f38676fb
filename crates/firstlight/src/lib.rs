//! firstlight: scene in, radiance out.

pub mod color;
pub mod diagnostic;
mod image;
pub mod io;
pub mod scene;

pub use image::Image;
