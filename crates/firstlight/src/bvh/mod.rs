//! Building the trees and asking them: what does a ray hit first, is anything between two points?

mod build;
mod collapse;
mod reference;
#[cfg(test)]
mod tests;
mod wide;
mod world;

pub(crate) use world::{MeshPart, Part, World};
