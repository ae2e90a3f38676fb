//! From film points to rays.

use crate::geometry::Ray;
use crate::math::tangents;
use crate::scene::description::{CameraDescription, Projection};
use glam::{DVec3, Vec2, Vec3};
use std::f64::consts::TAU;

/// A camera with its film: turns points of the picture into rays.
#[derive(Debug, Clone)]
pub struct Camera {
    width: u32,
    height: u32,
    position: DVec3,
    forward: DVec3,
    /// Half the picture's height in the plane at distance 1 (or in metres, if orthographic), as a vector up.
    half_up: DVec3,
    /// The same for its width, to the right.
    half_right: DVec3,
    lens: Lens,
}

#[derive(Debug, Clone, Copy)]
enum Lens {
    Parallel,
    Pinhole,
    Thin { radius: f64, focus: f64 },
}

impl Camera {
    /// The camera `description` for a picture of `width × height` pixels.
    pub fn new(description: &CameraDescription, width: u32, height: u32) -> Self {
        let forward = (description.target - description.position).normalize_or(DVec3::Y);
        let right = forward.cross(description.up).try_normalize();
        let right = right.unwrap_or_else(|| tangents(forward).0);
        let up = right.cross(forward);
        let (half_height, lens) = match description.projection {
            Projection::Orthographic { height } => (0.5 * height, Lens::Parallel),
            Projection::Perspective { vertical_fov } => ((0.5 * vertical_fov).tan(), Lens::Pinhole),
            Projection::ThinLens { vertical_fov, aperture, focus_distance } => {
                let lens = Lens::Thin { radius: 0.5 * aperture, focus: focus_distance };
                ((0.5 * vertical_fov).tan(), lens)
            }
        };
        let half_width = half_height * f64::from(width) / f64::from(height);
        let (half_up, half_right) = (up * half_height, right * half_width);
        Self { width, height, position: description.position, forward, half_up, half_right, lens }
    }

    /// Pixels per row.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The lecture's `camera.getRay(ix, iy)`: through the centre of the pixel in column `ix`, row `iy` from the top,
    /// and the centre of the lens.
    pub fn get_ray(&self, ix: u32, iy: u32) -> Ray {
        self.ray(Vec2::new(ix as f32 + 0.5, iy as f32 + 0.5), Vec2::ZERO)
    }

    /// The ray through a point of the film, in pixels from its upper left corner, and a point of the lens: two
    /// numbers in 0..1 that are spread evenly over its area.
    pub fn ray(&self, film: Vec2, lens: Vec2) -> Ray {
        let x = 2.0 * f64::from(film.x) / f64::from(self.width) - 1.0;
        let y = 1.0 - 2.0 * f64::from(film.y) / f64::from(self.height);
        let across = x * self.half_right + y * self.half_up;
        let (origin, direction) = match self.lens {
            Lens::Parallel => (self.position + across, self.forward),
            Lens::Pinhole => (self.position, self.forward + across),
            Lens::Thin { radius, focus } => {
                let shift = radius * self.on_lens(lens);
                (self.position + shift, (self.forward + across) * focus - shift)
            }
        };
        Ray::new(origin.as_vec3(), direction.normalize().as_vec3())
    }

    /// Where the light at the camera is, m; `None` if the camera is infinitely far away.
    pub(crate) fn eye(&self) -> Option<DVec3> {
        let parallel = matches!(self.lens, Lens::Parallel);
        (!parallel).then_some(self.position)
    }

    /// The unit direction in which the camera looks.
    pub(crate) fn forward(&self) -> Vec3 {
        self.forward.as_vec3()
    }

    /// A point of the unit disk across the view, from two numbers in 0..1.
    fn on_lens(&self, sample: Vec2) -> DVec3 {
        let (sin, cos) = (TAU * f64::from(sample.y)).sin_cos();
        let (right, up) = (self.half_right.normalize(), self.half_up.normalize());
        f64::from(sample.x).sqrt() * (cos * right + sin * up)
    }
}
