//! firstlight: scene in, radiance out.

pub mod color;
pub mod diagnostic;
mod image;
pub mod io;
pub mod scene;
mod suggest;
pub mod units;

pub use image::Image;
