//! How light is gathered along rays.

mod dimensions;
mod direct;
mod gatherer;
mod media;
mod meter;
mod panes;
mod path;
mod points;
mod record;
mod shadows;
mod source;
mod trace;

pub(crate) use dimensions::{FILM, LENS, TIME};
pub use direct::RayCounts;
pub(crate) use gatherer::{Gatherer, Way};
pub use meter::{Measurement, Meter};
pub(crate) use record::{Asked, Followed, Gain, Record, Recorder};
pub(crate) use source::Source;
