//! How light is gathered along rays.

mod direct;
mod meter;
mod trace;

pub use direct::RayCounts;
pub(crate) use direct::{Direct, Scratch};
pub use meter::Measurement;
