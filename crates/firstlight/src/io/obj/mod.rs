//! OBJ with its MTL material files: one mesh per material.
//!
//! Own code, because tobj 4.0 names no line in its errors.

mod faces;
mod material;
mod mtl;
#[cfg(test)]
mod tests;
mod vertices;

use super::triangles::not_empty;
use super::{FileAccess, Warnings};
use crate::diagnostic::Result;
use crate::scene::description::SceneDescription;
use faces::Faces;
use mtl::Library;
use vertices::Vertices;

/// Reads an OBJ file: one surface per material, or two if only some of its faces are smooth.
///
/// Coordinates stay as in the file; `name` is its name for messages. Material files and pictures are opened
/// with `access`; those that cannot be used are replaced, with a warning. Faces without normals are flat,
/// unless they are in a smoothing group. Vertex colours (after the position) are linear.
///
/// # Errors
/// If a line cannot be read, a face names a vertex that does not exist, or there are no triangles.
pub fn read(
    bytes: &[u8],
    name: &str,
    access: &FileAccess,
    warnings: &mut Warnings,
) -> Result<SceneDescription> {
    let vertices = Vertices::read(bytes, name, warnings)?;
    let colored = !vertices.colors.is_empty();
    let faces = Faces::read(bytes, name, vertices, warnings)?;
    let library = Library::open(&faces.libraries, access, warnings)?;
    let mut scene = SceneDescription::default();
    let used = faces.add_surfaces(&mut scene);
    material::add_materials(&mut scene, &used, &library, colored, access, warnings);
    not_empty(scene, name)
}
