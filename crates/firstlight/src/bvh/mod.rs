//! Building the trees and asking them: what does a ray hit first, is anything between two points?

mod build;
mod collapse;
mod reference;
mod reinsert;
mod runs;
#[cfg(test)]
mod tests;
mod wide;
mod world;

pub(crate) use world::{MeshPart, Part, World};

/// How much work goes into the trees. What rays hit does not depend on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum BuildQuality {
    /// Built soonest: for a look at a large scene, with few rays.
    Preview,
    /// Subtrees are moved to where they cost less.
    #[default]
    Final,
}
