//! The heart: what a surface does with light, and what lights give.

pub(crate) mod airway;
pub(crate) mod bsdf;
pub(crate) mod interaction;
pub(crate) mod light;
pub(crate) mod texture;
pub(crate) mod volume;
