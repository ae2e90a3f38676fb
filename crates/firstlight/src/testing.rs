//! Shapes and numbers that several tests use.

pub(crate) use crate::verify::shapes::{bumpy_sphere, icosphere};
pub(crate) use crate::verify::{Random, chi_squared_z};
