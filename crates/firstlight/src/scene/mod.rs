//! The scene: plain data with names, built once into something that can be asked what a ray hits.

pub mod description;
