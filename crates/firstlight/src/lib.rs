//! firstlight: scene in, radiance out.

mod bvh;
mod camera;
pub mod color;
pub mod diagnostic;
mod film;
mod geometry;
mod image;
mod integrator;
pub mod io;
mod kernels;
mod math;
pub mod render;
mod sampler;
pub mod scene;
mod shading;
mod simd;
mod suggest;
#[cfg(test)]
mod testing;
pub mod units;

pub use camera::Camera;
pub use film::auto_exposure;
pub use geometry::{Ray, solid_angle};
pub use image::Image;
pub use integrator::RayCounts;
pub use scene::Scene;
pub use scene::description::SceneDescription;
pub use simd::Level;
