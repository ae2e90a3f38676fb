//! Rays, boxes and the shapes rays can hit.

mod analytic;
mod bounds;
mod ray;
pub(crate) mod triangle;

pub(crate) use analytic::{Analytic, Piece};
pub(crate) use bounds::Bounds;
pub use ray::Hit;
pub use ray::Ray;
pub use triangle::solid_angle;
