//! Surfaces as plain data.

use glam::{DAffine3, DVec3};

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
#[derive(Debug, Clone, PartialEq)]
pub struct Sphere {
    /// Its centre, m.
    pub center: DVec3,
    /// Its radius, m.
    pub radius: f64,
}

/// An infinite plane. (u, v) are metres along two axes of the plane.
#[derive(Debug, Clone, PartialEq)]
pub struct Plane {
    /// A point of it, m; the origin of (u, v).
    pub point: DVec3,
    /// The direction of its front.
    pub normal: DVec3,
}

/// A flat disk. u runs around the normal, v from the centre to the rim.
#[derive(Debug, Clone, PartialEq)]
pub struct Disk {
    /// Its centre, m.
    pub center: DVec3,
    /// The direction of its front.
    pub normal: DVec3,
    /// Its radius, m.
    pub radius: f64,
}

/// A parallelogram; its front is where `edge_u` × `edge_v` points. (u, v) run 0..1 along the edges.
#[derive(Debug, Clone, PartialEq)]
pub struct Quad {
    /// The corner where u = v = 0, m.
    pub corner: DVec3,
    /// From the corner along u, m.
    pub edge_u: DVec3,
    /// From the corner along v, m.
    pub edge_v: DVec3,
}

/// A box with edges along the axes (TOML key `box`). (u, v) run 0..1 on each face.
#[derive(Debug, Clone, PartialEq)]
pub struct Block {
    /// The corner with the smallest coordinates, m.
    pub min: DVec3,
    /// The corner with the largest coordinates, m.
    pub max: DVec3,
}

/// A cylinder from `base` to `top`. u runs around, v from base to top.
#[derive(Debug, Clone, PartialEq)]
pub struct Cylinder {
    /// Centre of one end, m.
    pub base: DVec3,
    /// Centre of the other end, m.
    pub top: DVec3,
    /// Its radius, m.
    pub radius: f64,
    /// Whether both ends are closed by disks.
    pub capped: bool,
}

/// A cone from its round base to its apex. u runs around, v from base to apex.
#[derive(Debug, Clone, PartialEq)]
pub struct Cone {
    /// Centre of the base, m.
    pub base: DVec3,
    /// The tip, m.
    pub apex: DVec3,
    /// Radius of the base, m.
    pub radius: f64,
    /// Whether the base is closed by a disk.
    pub capped: bool,
}
