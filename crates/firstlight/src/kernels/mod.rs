//! Every loop that is compiled once per SIMD level.

mod layout;
mod packet;
mod traverse;

pub(crate) use layout::{Child, Node, ONE_SIDED, PARTLY_THERE, Tree, TriangleBlock};
pub(crate) use traverse::{FLATTENED, HitFilter, Others, Search, Stack, search};
