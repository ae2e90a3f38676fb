//! Every loop that is compiled once per SIMD level.

mod alone;
mod batch;
mod beams;
mod group;
mod layout;
mod order;
mod stream;
mod tile;
mod traverse;
mod triangles;

pub(crate) use batch::{forget, search};
pub(crate) use layout::{
    Child, Node, ONE_SIDED, PARTLY_THERE, Tree, TriangleBlock, Vertices, Word,
};
pub(crate) use order::slots_for;
pub(crate) use traverse::{Answer, FLATTENED, HitFilter, Others, Search, Stack};
