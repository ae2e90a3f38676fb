//! A ray tracer: scene in, radiance out. Physically right, deterministic, no GPU and no display.
//!
//! The founding lecture (*Ray Tracing: Shading*, Cornell CS 4620) ends in a loop, and so does this page:
//!
//! ```
//! use firstlight::{FileAccess, Image, Scene, load};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let folder = tempfile::tempdir()?;
//! # let path = folder.path().join("ball.toml");
//! # std::fs::write(&path, "
//! #     film.resolution = [32, 18]
//! #     [camera.perspective]
//! #     position = [0, -6, 2]
//! #     [surfaces.ball.sphere]
//! #     [lights.key.point]
//! #     position = [2, -4, 5]
//! #     power = '1.5 kW'
//! # ")?;
//! let description = load(&path, &[], &FileAccess::beside(&path, &[]), &mut Vec::new())?;
//! let scene = Scene::build(&description);
//! let camera = scene.camera();
//! let mut image = Image::new(camera.width(), camera.height());
//!
//! for iy in 0..image.height() {
//!     for ix in 0..image.width() {
//!         let ray = camera.get_ray(ix, iy);
//!         let c = scene.trace(&ray, 0.0, f32::INFINITY);
//!         image.set(ix, iy, c);
//!     }
//! }
//! # assert!(image.get(16, 9).x > 0.1, "the ball is lit");
//! # assert_eq!(image.get(0, 0).x, 0.0, "the background is black");
//! # Ok(())
//! # }
//! ```
//!
//! [`render::render`] runs the same code with many samples per pixel, over all cores; [`io::save`] makes a picture file
//! of the result. A [`SceneDescription`] can also be made in code: it is plain data.

mod bvh;
mod camera;
pub mod color;
pub mod compare;
pub mod diagnostic;
pub mod doctor;
pub mod explain;
pub mod false_color;
mod film;
mod geometry;
mod image;
mod integrator;
pub mod io;
mod kernels;
pub mod layers;
mod look;
mod math;
pub mod passport;
pub mod render;
mod sampler;
pub mod scene;
mod shading;
mod simd;
mod suggest;
#[cfg(test)]
mod testing;
pub mod units;
pub mod verify;

pub use bvh::BuildQuality;
pub use camera::Camera;
pub use film::{Film, Noise, Spread, auto_exposure};
pub use geometry::{Hit, Ray, solid_angle};
pub use image::Image;
pub use integrator::{Measurement, Meter, RayCounts};
pub use io::{FileAccess, load};
pub use look::Look;
pub use scene::Scene;
pub use scene::description::SceneDescription;
pub use simd::Level;
