//! The rays of a recipe: from the camera, from what they hit to a light, and into the hemisphere around it.
//!
//! Everything is computed in single precision and in a fixed order, so that every program gets the same rays.

use crate::recipe::{Recipe, View};
use firstlight::scene::description::Mesh;
use firstlight::{Ray, Scene};
use glam::Vec3;
use std::f32::consts::{PI, TAU};

/// Pixels along a side of the picture.
const SIDE: u32 = 1024;
/// Pixels along a side of a tile.
const TILE: u32 = 8;
/// How far from the surface rays start, relative to the diagonal of the mesh's box.
const LIFT: f32 = 1e-4;
/// Where shadow rays end, of their way to the light.
const SHADOW_END: f32 = 0.9999;

/// All rays of a recipe, neighbours in the picture beside each other.
pub(crate) struct Rays {
    /// One per pixel.
    pub(crate) camera: Vec<Ray>,
    /// From each hit of a camera ray to the light; the direction is not of unit length, the light is at t = 1.
    pub(crate) shadow: Vec<Ray>,
    /// From each hit of a camera ray in a direction distributed as the cosine with the normal.
    pub(crate) bounce: Vec<Ray>,
}

impl Rays {
    /// The rays of `recipe`, of which `scene` is built.
    pub(crate) fn of(recipe: &Recipe, scene: &Scene) -> Self {
        let (mesh, view) = (&recipe.mesh, &recipe.view);
        let pixels = tile_order();
        let camera = camera_rays(view, &pixels);
        let mut hits = Vec::new();
        scene.closest_hits(&camera, &mut hits);
        let lift = LIFT * diagonal(mesh);
        let (mut shadow, mut bounce) = (Vec::new(), Vec::new());
        for ((ray, hit), [x, y]) in camera.iter().zip(&hits).zip(pixels) {
            if hit.is_some() {
                let normal = normal_towards(ray, mesh.triangles[hit.primitive as usize], mesh);
                let start = ray.origin + ray.direction * hit.t + normal * lift;
                let light = Ray::new(start, view.light - start);
                shadow.push(Ray { t_max: SHADOW_END, ..light });
                bounce.push(Ray::new(start, cosine_direction(normal, y * SIDE + x)));
            }
        }
        Self { camera, shadow, bounce }
    }
}

/// Columns and rows of all pixels: tiles row by row, the pixels of a tile along Morton's curve.
fn tile_order() -> Vec<[u32; 2]> {
    let tiles = SIDE / TILE;
    let even_bits = |i: u32| i & 1 | i >> 1 & 2 | i >> 2 & 4;
    let pixel = |tile: u32, i: u32| {
        [TILE * (tile % tiles) + even_bits(i), TILE * (tile / tiles) + even_bits(i >> 1)]
    };
    let in_tile = |tile| (0..TILE * TILE).map(move |i| pixel(tile, i));
    (0..tiles * tiles).flat_map(in_tile).collect()
}

/// A pinhole's rays through the middle of each pixel.
fn camera_rays(view: &View, pixels: &[[u32; 2]]) -> Vec<Ray> {
    let forward = unit(view.target - view.eye);
    let right = unit(forward.cross(view.up));
    let up = right.cross(forward);
    let tan = (view.vertical_fov * 0.5 * PI / 180.0).tan();
    let across = |pixel: u32| 2.0 * (pixel as f32 + 0.5) / SIDE as f32 - 1.0;
    let ray = |&[x, y]: &[u32; 2]| {
        let (px, py) = (across(x) * tan, -across(y) * tan);
        Ray::new(view.eye, unit(forward + right * px + up * py))
    };
    pixels.iter().map(ray).collect()
}

fn unit(v: Vec3) -> Vec3 {
    v * (1.0 / v.dot(v).sqrt())
}

fn diagonal(mesh: &Mesh) -> f32 {
    let lower = mesh.positions.iter().fold(Vec3::INFINITY, |a, b| a.min(*b));
    let upper = mesh.positions.iter().fold(Vec3::NEG_INFINITY, |a, b| a.max(*b));
    (upper - lower).length()
}

/// The unit normal of a triangle on the side that a ray comes from.
fn normal_towards(ray: &Ray, triangle: [u32; 3], mesh: &Mesh) -> Vec3 {
    let [a, b, c] = triangle.map(|index| mesh.positions[index as usize]);
    let normal = unit((b - a).cross(c - a));
    if normal.dot(ray.direction) > 0.0 { -normal } else { normal }
}

/// A direction distributed as the cosine with `normal`, the same for a pixel whatever the mesh: Malley's method, in
/// the frame of Duff et al., *Building an Orthonormal Basis, Revisited*, JCGT 2017.
fn cosine_direction(normal: Vec3, pixel: u32) -> Vec3 {
    let uniform = |seed: u32| (pcg(seed) >> 8) as f32 * (1.0 / 16_777_216.0);
    let (u1, u2) = (uniform(2 * pixel), uniform(2 * pixel + 1));
    let (radius, phi) = (u1.sqrt(), TAU * u2);
    let sign = 1_f32.copysign(normal.z);
    let a = -1.0 / (sign + normal.z);
    let b = normal.x * normal.y * a;
    let tangent = Vec3::new(1.0 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x);
    let bitangent = Vec3::new(b, sign + normal.y * normal.y * a, -normal.y);
    let across = tangent * (radius * phi.cos()) + bitangent * (radius * phi.sin());
    across + normal * (1.0 - u1).max(0.0).sqrt()
}

/// Jarzynski and Olano, *Hash Functions for GPU Rendering*, JCGT 2020.
fn pcg(seed: u32) -> u32 {
    let state = seed.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = (state >> ((state >> 28) + 4) ^ state).wrapping_mul(277_803_737);
    word >> 22 ^ word
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pixel_comes_once_and_tiles_stay_together() {
        let pixels = tile_order();
        let mut seen = vec![false; (SIDE * SIDE) as usize];
        for (i, [x, y]) in pixels.iter().enumerate() {
            seen[(y * SIDE + x) as usize] = true;
            let tile = (y / TILE * (SIDE / TILE) + x / TILE) as usize;
            assert_eq!(tile, i / (TILE * TILE) as usize);
        }
        assert!(seen.into_iter().all(|seen| seen));
        assert_eq!(pixels[..5], [[0, 0], [1, 0], [0, 1], [1, 1], [2, 0]]);
    }

    #[test]
    fn bounces_are_distributed_as_the_cosine() {
        let normal = unit(Vec3::new(0.3, -0.8, -0.5));
        let directions: Vec<_> = (0..1 << 16).map(|i| cosine_direction(normal, i)).collect();
        let mean = |f: &dyn Fn(Vec3) -> f32| {
            directions.iter().map(|d| f64::from(f(*d))).sum::<f64>() / directions.len() as f64
        };
        assert!(directions.iter().all(|d| (d.length() - 1.0).abs() < 1e-5));
        // ∫cos²/π dω = 2/3, ∫cos³/π dω = 1/2; deviations of the means are below 0.001.
        assert!((mean(&|d| d.dot(normal)) - 2.0 / 3.0).abs() < 0.005);
        assert!((mean(&|d| d.dot(normal).powi(2)) - 0.5).abs() < 0.005);
        assert!(mean(&|d| d.dot(normal.any_orthonormal_vector())).abs() < 0.01);
    }
}
