//! From film points to rays.

use crate::geometry::{Cone, Ray};
use crate::math::{BLOCK, Columns, tangents};
use crate::scene::description::{CameraDescription, CameraPose, Projection};
use glam::{DMat3, DQuat, DVec3, Vec2, Vec3};
use std::f32::consts::TAU;

/// A camera with its film: turns points of the picture into rays.
#[derive(Debug, Clone)]
pub struct Camera {
    width: u32,
    height: u32,
    position: DVec3,
    forward: Vec3,
    /// Unit vectors to the right and up in the picture.
    right: Vec3,
    up: Vec3,
    /// The film in the plane at distance 1 (in metres, if orthographic), relative to the middle of the view: its
    /// upper left corner, and one pixel to the right and down.
    corner: Vec3,
    pixel_right: Vec3,
    pixel_down: Vec3,
    lens: Lens,
    /// When the shutter opens, and for how long, as parts of the scene's time.
    opens: f32,
    open_for: f32,
    journey: Option<Journey>,
}

/// How a camera moves while the scene's time runs: straight on and evenly, and about one axis.
#[derive(Debug, Clone, Copy)]
struct Journey {
    /// How far it has gone at the end, m, and how it has turned.
    shift: DVec3,
    turn: DQuat,
}

#[derive(Debug, Clone, Copy)]
enum Lens {
    Parallel,
    Pinhole,
    Thin { radius: f32, focus: f32 },
}

impl Camera {
    /// The camera `description` for a picture of `width × height` pixels.
    pub fn new(description: &CameraDescription, width: u32, height: u32) -> Self {
        let CameraDescription { position, target, up, shutter: [opens, closes], .. } = *description;
        let first = axes(&CameraPose { position, target, up });
        let [right, up, forward] = [first.x_axis, first.y_axis, first.z_axis];
        let journey = description.motion.map(|last| Journey {
            shift: last.position - position,
            turn: DQuat::from_mat3(&(axes(&last) * first.transpose())),
        });
        let (half_height, lens) = film_and_lens(&description.projection);
        let half_width = half_height * f64::from(width) / f64::from(height);
        Self {
            width,
            height,
            position,
            forward: forward.as_vec3(),
            right: right.as_vec3(),
            up: up.as_vec3(),
            corner: (up * half_height - right * half_width).as_vec3(),
            pixel_right: (right * (2.0 * half_width / f64::from(width))).as_vec3(),
            pixel_down: (-up * (2.0 * half_height / f64::from(height))).as_vec3(),
            lens,
            opens: opens as f32,
            open_for: (closes - opens) as f32,
            journey,
        }
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
    /// and the centre of the lens, halfway between the shutter's opening and its closing.
    pub fn get_ray(&self, ix: u32, iy: u32) -> Ray {
        self.ray(Vec2::new(ix as f32 + 0.5, iy as f32 + 0.5), Vec2::ZERO, 0.5)
    }

    /// The ray through a point of the film, in pixels from its upper left corner, and a point of the lens: two
    /// numbers in 0..1 that are spread evenly over its area; `moment` in 0..1 between the shutter's opening and its closing.
    #[inline(always)]
    pub fn ray(&self, film: Vec2, lens: Vec2, moment: f32) -> Ray {
        let (origin, toward) = self.aim(film, lens);
        let ray = Ray { time: self.time(moment), ..Ray::new(origin, toward.normalize()) };
        if let Some(journey) = &self.journey { self.taken_along(journey, &ray) } else { ray }
    }

    /// The rays through points of the film, of the lens if that [matters](Camera::has_lens), and at the first of pairs of
    /// moments if [anything moves](crate::Scene::moves), as [`Camera::ray`] has them; replaces what is in `rays`.
    #[inline(always)]
    pub(crate) fn rays(&self, film: &[Vec2], lens: &[Vec2], moments: &[Vec2], rays: &mut Vec<Ray>) {
        rays.clear();
        let mut toward = Columns::<f32>::default();
        for (block, film) in film.chunks(BLOCK).enumerate() {
            let first = rays.len();
            for (k, &film) in film.iter().enumerate() {
                let lens = lens.get(block * BLOCK + k).copied().unwrap_or_default();
                let (origin, direction) = self.aim(film, lens);
                toward.set(k, direction);
                rays.push(Ray::new(origin, direction));
            }
            for k in 0..BLOCK {
                toward.set(k, toward.get(k).normalize());
            }
            for (k, ray) in rays[first..].iter_mut().enumerate() {
                ray.direction = toward.get(k);
            }
        }
        for (ray, moment) in rays.iter_mut().zip(moments) {
            ray.time = self.time(moment.x);
        }
        if let Some(journey) = &self.journey {
            rays.iter_mut().for_each(|ray| *ray = self.taken_along(journey, ray));
        }
    }

    /// The ray, at time 0, on which a point is seen from the middle of the lens; it ends there.
    pub(crate) fn ray_to(&self, point: DVec3) -> Ray {
        let forward = self.forward.as_dvec3();
        let origin = match self.lens {
            Lens::Parallel => point - (point - self.position).dot(forward).max(0.0) * forward,
            Lens::Pinhole | Lens::Thin { .. } => self.position,
        };
        let direction = (point - origin).normalize_or(forward).as_vec3();
        let t_max = point.distance(origin) as f32;
        Ray { t_max, ..Ray::new(origin.as_vec3(), direction) }
    }

    /// The part of the scene's time that has passed at a moment between the shutter's opening and its closing, 0..1.
    #[inline(always)]
    pub(crate) fn time(&self, moment: f32) -> f32 {
        self.opens + moment * self.open_for
    }

    /// Whether it moves.
    pub fn moves(&self) -> bool {
        self.journey.is_some()
    }

    /// A ray that the camera would have sent out at time 0, from where it is at the ray's time.
    fn taken_along(&self, journey: &Journey, ray: &Ray) -> Ray {
        let turn = journey.turn_at(ray.time);
        let origin = turn * (ray.origin.as_dvec3() - self.position)
            + self.position
            + f64::from(ray.time) * journey.shift;
        let direction = (turn * ray.direction.as_dvec3()).normalize().as_vec3();
        Ray { origin: origin.as_vec3(), direction, ..*ray }
    }

    /// Where the ray through a point of the film and one of the lens starts at time 0, and a direction of any length.
    #[inline(always)]
    fn aim(&self, film: Vec2, lens: Vec2) -> (Vec3, Vec3) {
        let across = self.corner + film.x * self.pixel_right + film.y * self.pixel_down;
        let position = self.position.as_vec3();
        match self.lens {
            Lens::Parallel => ((self.position + across.as_dvec3()).as_vec3(), self.forward),
            Lens::Pinhole => (position, self.forward + across),
            Lens::Thin { radius, focus } => {
                let shift = radius * self.on_lens(lens);
                (position + shift, (self.forward + across) * focus - shift)
            }
        }
    }

    /// A ray that leaves the camera near another one: so many pixels further to the right and down.
    #[inline(always)]
    pub(crate) fn beside(&self, ray: &Ray, by: Vec2) -> Ray {
        let turned = |v: Vec3| self.journey.map_or(v, |journey| journey.turned(v, ray.time));
        let shift = turned(by.x * self.pixel_right + by.y * self.pixel_down);
        match self.lens {
            Lens::Parallel => Ray { origin: ray.origin + shift, ..*ray },
            Lens::Pinhole | Lens::Thin { .. } => {
                let ahead = ray.direction.dot(turned(self.forward)).max(f32::MIN_POSITIVE);
                Ray { direction: (ray.direction / ahead + shift).normalize(), ..*ray }
            }
        }
    }

    /// What a ray of so many per pixel stands for: its share of the pixel, but not too little of it, since filters are
    /// wider than their samples.
    pub(crate) fn cone(&self, samples: u32) -> Cone {
        let share = (1.0 / samples as f32).sqrt().max(0.125);
        let width = share * self.pixel_right.length();
        match self.lens {
            Lens::Parallel => Cone { width, spread: 0.0 },
            _ => Cone { width: 0.0, spread: width },
        }
    }

    /// Whether rays depend on the point of the lens they go through.
    pub fn has_lens(&self) -> bool {
        matches!(self.lens, Lens::Thin { .. })
    }

    /// Where the light at the camera is, m; `None` if the camera is infinitely far away.
    pub(crate) fn eye(&self) -> Option<DVec3> {
        let parallel = matches!(self.lens, Lens::Parallel);
        (!parallel).then_some(self.position)
    }

    /// The unit direction in which the camera looks.
    pub(crate) fn forward(&self) -> Vec3 {
        self.forward
    }

    /// A point of the unit disk across the view, from two numbers in 0..1.
    fn on_lens(&self, sample: Vec2) -> Vec3 {
        let (sin, cos) = (TAU * sample.y).sin_cos();
        sample.x.sqrt() * (cos * self.right + sin * self.up)
    }
}

impl Journey {
    /// How the camera has turned at a time, 0..1.
    fn turn_at(&self, time: f32) -> DQuat {
        DQuat::IDENTITY.slerp(self.turn, time.into())
    }

    /// A vector that has turned with the camera.
    fn turned(&self, v: Vec3, time: f32) -> Vec3 {
        (self.turn_at(time) * v.as_dvec3()).as_vec3()
    }
}

/// Unit vectors to the right, up and forward of a camera.
fn axes(pose: &CameraPose) -> DMat3 {
    let forward = (pose.target - pose.position).normalize_or(DVec3::Y);
    let right = forward.cross(pose.up).try_normalize().unwrap_or_else(|| tangents(forward).0);
    DMat3::from_cols(right, right.cross(forward), forward)
}

/// Half the height of the film in the plane at distance 1 (in metres, if orthographic), and the lens before it.
fn film_and_lens(projection: &Projection) -> (f64, Lens) {
    match *projection {
        Projection::Orthographic { height } => (0.5 * height, Lens::Parallel),
        Projection::Perspective { vertical_fov } => ((0.5 * vertical_fov).tan(), Lens::Pinhole),
        Projection::ThinLens { vertical_fov, aperture, focus_distance } => {
            let (radius, focus) = (0.5 * aperture as f32, focus_distance as f32);
            ((0.5 * vertical_fov).tan(), Lens::Thin { radius, focus })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Any number of them, over the borders of blocks.
    #[test]
    fn many_rays_are_those_that_are_made_one_by_one() {
        let description = CameraDescription {
            name: String::new(),
            position: DVec3::new(1.0, -3.0, 2.0),
            target: DVec3::ZERO,
            up: DVec3::Z,
            projection: Projection::Perspective { vertical_fov: 1.0 },
            shutter: CameraDescription::OPEN,
            motion: None,
        };
        let camera = Camera::new(&description, 640, 480);
        let film: Vec<_> = (0..150).map(|i| Vec2::new(4.3 * i as f32, 3.1 * i as f32)).collect();
        let mut rays = Vec::new();
        camera.rays(&film, &[], &[], &mut rays);
        let alone: Vec<_> = film.iter().map(|&film| camera.ray(film, Vec2::ZERO, 0.0)).collect();
        assert_eq!(rays, alone);
    }
}
