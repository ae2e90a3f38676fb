//! Is a description sound?

use super::description::{Pattern, SceneDescription, Shape, Texture};
use crate::diagnostic::{Diagnostic, Result};

impl SceneDescription {
    /// Whether everything that is referred to exists and every number is finite: what [`Scene::build`] relies on.
    /// Readers call it on what they made; who makes a description in code can call it too.
    ///
    /// # Errors
    /// The first part that is not sound, with its index.
    ///
    /// [`Scene::build`]: crate::Scene::build
    pub fn check(&self) -> Result<()> {
        for (i, surface) in self.surfaces.iter().enumerate() {
            let place = || format!("surface {i} \"{}\"", surface.name);
            ensure(surface.material < self.materials.len(), place, "its material does not exist")?;
            let mesh_exists =
                !matches!(surface.shape, Shape::Mesh(mesh) if mesh >= self.meshes.len());
            ensure(mesh_exists, place, "its mesh does not exist")?;
            let determinant = surface.transform.matrix3.determinant();
            let invertible = surface.transform.is_finite() && determinant != 0.0;
            ensure(
                invertible && determinant.is_finite(),
                place,
                "its transform flattens it or is not finite",
            )?;
        }
        for (i, mesh) in self.meshes.iter().enumerate() {
            let place = || format!("mesh {i} \"{}\"", mesh.name);
            ensure(
                mesh.positions.iter().all(|p| p.is_finite()),
                place,
                "a position is not finite",
            )?;
            let vertices = mesh.positions.len();
            let in_range = mesh.triangles.iter().flatten().all(|&v| (v as usize) < vertices);
            ensure(in_range, place, "a triangle refers to a vertex that does not exist")?;
            let fits = |length: usize| length == 0 || length == vertices;
            let uvs = mesh.uvs.iter().all(|uvs| fits(uvs.len()));
            let complete = uvs && fits(mesh.normals.len()) && fits(mesh.colors.len());
            ensure(complete, place, "a per-vertex array is not as long as the positions")?;
        }
        for (i, material) in self.materials.iter().enumerate() {
            let place = || format!("material {i} \"{}\"", material.name);
            let textures = [&material.reflectance, &material.emission];
            let known = textures.into_iter().chain(&material.ambient_reflectance);
            ensure(
                known.into_iter().all(|t| self.knows(t)),
                place,
                "a texture's picture does not exist",
            )?;
        }
        let triangles: usize = self.surfaces.iter().map(|s| self.triangles_of(&s.shape)).sum();
        ensure(triangles < 1 << 30, || "scene".into(), "more than 2^30 triangles")?;
        ensure(self.surfaces.len() < 1 << 30, || "scene".into(), "more than 2^30 surfaces")
    }

    /// Number of triangles of a shape; 0 if it has a formula.
    pub fn triangles_of(&self, shape: &Shape) -> usize {
        if let Shape::Mesh(mesh) = shape { self.meshes[*mesh].triangles.len() } else { 0 }
    }

    fn knows(&self, texture: &Texture) -> bool {
        !matches!(texture.pattern, Pattern::Image { image, .. } if image >= self.images.len())
    }
}

fn ensure(holds: bool, place: impl Fn() -> String, message: &str) -> Result<()> {
    if holds {
        return Ok(());
    }
    Err(Box::new(Diagnostic::new("", message).at_part(place())))
}
