//! Surfaces as plain data.

use super::Motion;
use crate::units::written::{self, Direction, Point, Size};
use glam::{DAffine3, DVec3};
use schemars::JsonSchema;
use serde::Deserialize;

/// Something that can be hit.
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    /// The name it has in its file.
    pub name: String,
    /// Its shape in its own space.
    pub shape: Shape,
    /// Index into [`SceneDescription::materials`](super::SceneDescription::materials).
    pub material: usize,
    /// From its own space to the world: any invertible affine map.
    pub transform: DAffine3,
    /// What it does in the world while the scene's time runs; `None`: it stands still.
    pub motion: Option<Motion>,
}

/// The shapes a surface can have, each with outward geometric normals.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// A sphere.
    Sphere(Sphere),
    /// An infinite plane.
    Plane(Plane),
    /// A flat round disk.
    Disk(Disk),
    /// A parallelogram.
    Quad(Quad),
    /// An axis-aligned box.
    Block(Block),
    /// A cylinder.
    Cylinder(Cylinder),
    /// A cone.
    Cone(Cone),
    /// Triangles: index into [`SceneDescription::meshes`](super::SceneDescription::meshes).
    Mesh(usize),
}

/// A sphere. u runs around z, v from the south to the north pole.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Sphere {
    /// Its centre, m.
    #[serde(deserialize_with = "written::point")]
    #[schemars(with = "Point")]
    pub center: DVec3,
    /// Its radius, m.
    #[serde(deserialize_with = "written::size")]
    #[schemars(with = "Size")]
    pub radius: f64,
}

impl Default for Sphere {
    /// The unit sphere around the origin.
    fn default() -> Self {
        Self { center: DVec3::ZERO, radius: 1.0 }
    }
}

/// An infinite plane. (u, v) are metres along two axes of the plane.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Plane {
    /// A point of it, m; the origin of (u, v).
    #[serde(deserialize_with = "written::point")]
    #[schemars(with = "Point")]
    pub point: DVec3,
    /// The direction of its front.
    #[serde(deserialize_with = "written::direction")]
    #[schemars(with = "Direction")]
    pub normal: DVec3,
}

impl Default for Plane {
    /// The plane z = 0, its front up.
    fn default() -> Self {
        Self { point: DVec3::ZERO, normal: DVec3::Z }
    }
}

/// A flat disk. u runs around the normal, v from the centre to the rim.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Disk {
    /// Its centre, m.
    #[serde(deserialize_with = "written::point")]
    #[schemars(with = "Point")]
    pub center: DVec3,
    /// The direction of its front.
    #[serde(deserialize_with = "written::direction")]
    #[schemars(with = "Direction")]
    pub normal: DVec3,
    /// Its radius, m.
    #[serde(deserialize_with = "written::size")]
    #[schemars(with = "Size")]
    pub radius: f64,
}

impl Default for Disk {
    /// The unit disk around the origin in z = 0, its front up.
    fn default() -> Self {
        Self { center: DVec3::ZERO, normal: DVec3::Z, radius: 1.0 }
    }
}

/// A parallelogram; its front is where `edge_u` × `edge_v` points. (u, v) run 0..1 along the edges.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Quad {
    /// The corner where u = v = 0, m.
    #[serde(deserialize_with = "written::point")]
    #[schemars(with = "Point")]
    pub corner: DVec3,
    /// From the corner along u, m.
    #[serde(deserialize_with = "written::point")]
    #[schemars(with = "Point")]
    pub edge_u: DVec3,
    /// From the corner along v, m.
    #[serde(deserialize_with = "written::point")]
    #[schemars(with = "Point")]
    pub edge_v: DVec3,
}

impl Default for Quad {
    /// The unit square around the origin in z = 0, its front up.
    fn default() -> Self {
        Self { corner: DVec3::new(-0.5, -0.5, 0.0), edge_u: DVec3::X, edge_v: DVec3::Y }
    }
}

/// A box with edges along the axes (TOML key `box`). (u, v) run 0..1 on each face.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Block {
    /// The corner with the smallest coordinates, m.
    #[serde(deserialize_with = "written::point")]
    #[schemars(with = "Point")]
    pub min: DVec3,
    /// The corner with the largest coordinates, m.
    #[serde(deserialize_with = "written::point")]
    #[schemars(with = "Point")]
    pub max: DVec3,
}

impl Default for Block {
    /// The unit cube around the origin.
    fn default() -> Self {
        Self { min: DVec3::splat(-0.5), max: DVec3::splat(0.5) }
    }
}

/// A cylinder from `base` to `top`. u runs around, v from base to top.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Cylinder {
    /// Centre of one end, m.
    #[serde(deserialize_with = "written::point")]
    #[schemars(with = "Point")]
    pub base: DVec3,
    /// Centre of the other end, m.
    #[serde(deserialize_with = "written::point")]
    #[schemars(with = "Point")]
    pub top: DVec3,
    /// Its radius, m.
    #[serde(deserialize_with = "written::size")]
    #[schemars(with = "Size")]
    pub radius: f64,
    /// Whether both ends are closed by disks.
    pub capped: bool,
}

impl Default for Cylinder {
    /// One metre high and wide, standing on the origin, closed.
    fn default() -> Self {
        Self { base: DVec3::ZERO, top: DVec3::Z, radius: 0.5, capped: true }
    }
}

/// A cone from its round base to its apex. u runs around, v from base to apex.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Cone {
    /// Centre of the base, m.
    #[serde(deserialize_with = "written::point")]
    #[schemars(with = "Point")]
    pub base: DVec3,
    /// The tip, m.
    #[serde(deserialize_with = "written::point")]
    #[schemars(with = "Point")]
    pub apex: DVec3,
    /// Radius of the base, m.
    #[serde(deserialize_with = "written::size")]
    #[schemars(with = "Size")]
    pub radius: f64,
    /// Whether the base is closed by a disk.
    pub capped: bool,
}

impl Default for Cone {
    /// One metre high and wide, standing on the origin, closed.
    fn default() -> Self {
        Self { base: DVec3::ZERO, apex: DVec3::Z, radius: 0.5, capped: true }
    }
}
