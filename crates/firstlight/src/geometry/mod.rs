//! Rays, boxes and the shapes rays can hit.

mod analytic;
mod bounds;
mod ray;
pub(crate) mod triangle;

pub(crate) use analytic::{Analytic, Piece};
pub(crate) use bounds::Bounds;
pub use ray::Hit;
pub use ray::Ray;
pub(crate) use ray::{Cone, NOTHING};
pub use triangle::solid_angle;

/// What double precision may be off in places computed from numbers of size 1: some forty roundings.
pub(crate) const DOUBLE_ERROR: f64 = 1e-14;
