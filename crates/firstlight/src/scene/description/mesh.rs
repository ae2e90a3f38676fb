//! Triangle meshes as plain data.

use glam::{Vec2, Vec3};

/// A triangle mesh. Per-vertex arrays are empty or as long as `positions`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mesh {
    /// The name it has in its file.
    pub name: String,
    /// Vertex positions in the mesh's own space.
    pub positions: Vec<Vec3>,
    /// Indices of each triangle's corners, anticlockwise seen from the front.
    pub triangles: Vec<[u32; 3]>,
    /// Unit vertex normals for smooth shading. Empty: flat.
    pub normals: Vec<Vec3>,
    /// Texture coordinate sets, v up.
    pub uvs: Vec<Vec<Vec2>>,
    /// Linear RGBA vertex colours.
    pub colors: Vec<[f32; 4]>,
}
