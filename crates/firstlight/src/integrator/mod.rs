//! How light is gathered along rays.

mod dimensions;
mod direct;
mod gatherer;
mod media;
mod meter;
mod panes;
mod path;
mod trace;

pub(crate) use dimensions::{FILM, LENS};
pub use direct::RayCounts;
pub(crate) use gatherer::Gatherer;
pub use meter::{Measurement, Meter};
