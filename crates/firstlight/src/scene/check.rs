//! Is a description sound?

use super::description::{
    Material, Mesh, Pattern, Scattering, SceneDescription, Shape, Surface, Texture,
};
use crate::bvh::Part;
use crate::diagnostic::{Diagnostic, Result};
use crate::geometry::Bounds;
use glam::{DVec3, Vec3};
use std::sync::Arc;

/// Coordinates in the world are at most this far from its origin, m: squares and cubes of lengths stay numbers.
const FURTHEST: f32 = 1e15;

impl SceneDescription {
    /// Levels of mixes of mixes, at most; each doubles what has to be evaluated.
    pub(crate) const MOST_MIXING: usize = 4;

    /// Leaves out triangles with a corner that is not finite or too far away to compute with, in their own space.
    /// Returns a complaint about `file` for each mesh that lost some.
    pub fn leave_out_far_triangles(&mut self, file: &str) -> Vec<Diagnostic> {
        let mut complaints = Vec::new();
        for mesh in self.meshes.iter_mut().filter(|mesh| !mesh.positions.iter().all(is_near)) {
            let mesh = Arc::make_mut(mesh);
            let (positions, before) = (&mut mesh.positions, mesh.triangles.len());
            mesh.triangles
                .retain(|corners| corners.iter().all(|&i| is_near(&positions[i as usize])));
            positions.iter_mut().filter(|p| !is_near(p)).for_each(|p| *p = Vec3::ZERO);
            let lost = before - mesh.triangles.len();
            let message = format!(
                "{lost} of {before} triangles left out: a corner is further than {FURTHEST:e} m away"
            );
            complaints
                .push(Diagnostic::new(file, message).at_part(format!("mesh \"{}\"", mesh.name)));
        }
        complaints
    }

    /// Whether everything that is referred to exists, every number is finite and nothing is too far away: what
    /// [`Scene::build`] relies on. Who makes a description in code can call it too.
    ///
    /// # Errors
    /// The first part that is not sound, with its index.
    ///
    /// [`Scene::build`]: crate::Scene::build
    pub fn check(&self) -> Result<()> {
        self.meshes.iter().enumerate().try_for_each(|(i, mesh)| check_mesh(i, mesh))?;
        self.materials.iter().enumerate().try_for_each(|(i, m)| self.check_material(i, m))?;
        let reach = |mesh: &Arc<Mesh>| Bounds::around(mesh.positions.iter().copied()).reach();
        let reaches: Vec<f32> = self.meshes.iter().map(reach).collect();
        let mut surfaces = self.surfaces.iter().enumerate();
        surfaces.try_for_each(|(i, surface)| self.check_surface(i, surface, &reaches))?;
        let triangles: usize = self.surfaces.iter().map(|s| self.triangles_of(&s.shape)).sum();
        ensure(triangles < 1 << 30, || "scene".into(), "more than 2^30 triangles")?;
        ensure(self.surfaces.len() < 1 << 30, || "scene".into(), "more than 2^30 surfaces")
    }

    /// `reaches`: the largest absolute coordinate of each mesh.
    fn check_surface(&self, i: usize, surface: &Surface, reaches: &[f32]) -> Result<()> {
        let place = || format!("surface {i} \"{}\"", surface.name);
        ensure(surface.material < self.materials.len(), place, "its material does not exist")?;
        let determinant = surface.transform.matrix3.determinant();
        let sound = surface.transform.is_finite() && determinant.is_finite() && determinant != 0.0;
        ensure(sound, place, "its transform flattens it or is not finite")?;
        let end = match surface.shape {
            Shape::Mesh(mesh) => {
                ensure(mesh < reaches.len(), place, "its mesh does not exist")?;
                let half = DVec3::splat(reaches[mesh].into());
                Bounds::of_mapped(-half, half, &surface.transform)
            }
            _ => match super::build::part(self, surface, &|_| false) {
                Part::Analytic(shape, _) => shape.bounds().unwrap_or(Bounds::EMPTY),
                Part::Mesh(_) => Bounds::EMPTY,
            },
        };
        let sound = surface.motion.is_none_or(|motion| {
            motion.growth > 0.0 && motion.at(1.0).is_finite() && motion.axis.is_normalized()
        });
        ensure(sound, place, "its motion is not finite, or shrinks it to nothing")?;
        let end = if end.is_empty() { 0.0 } else { end.moving(surface.motion.as_ref()).reach() };
        ensure(end <= FURTHEST, place, "it reaches further than 1e15 m from the origin")
    }

    fn check_material(&self, i: usize, material: &Material) -> Result<()> {
        let place = || format!("material {i} \"{}\"", material.name);
        let textures = material.textures();
        let known = textures.into_iter().all(|texture| self.knows(texture));
        ensure(known, place, "a texture's picture does not exist")?;
        let sound = self.mixes_soundly(i, Self::MOST_MIXING);
        ensure(sound, place, "it mixes later materials, itself, or mixes of more than 4 levels")
    }

    /// Whether a material mixes earlier ones alone, in at most so many levels.
    fn mixes_soundly(&self, i: usize, levels: usize) -> bool {
        let Scattering::Mix { materials, .. } = self.materials[i].scattering else { return true };
        levels > 0 && materials.iter().all(|&part| part < i && self.mixes_soundly(part, levels - 1))
    }

    /// Number of triangles of a shape; 0 if it has a formula.
    pub fn triangles_of(&self, shape: &Shape) -> usize {
        if let Shape::Mesh(mesh) = shape { self.meshes[*mesh].triangles.len() } else { 0 }
    }

    fn knows(&self, texture: &Texture) -> bool {
        !matches!(texture.pattern, Pattern::Image { image, .. } if image >= self.images.len())
    }
}

fn check_mesh(i: usize, mesh: &Mesh) -> Result<()> {
    let place = || format!("mesh {i} \"{}\"", mesh.name);
    let far = mesh.positions.iter().any(|p| !is_near(p));
    ensure(!far, place, "a position is not finite or further than 1e15 m from the origin")?;
    let vertices = mesh.positions.len();
    let in_range = mesh.triangles.iter().flatten().all(|&v| (v as usize) < vertices);
    ensure(in_range, place, "a triangle refers to a vertex that does not exist")?;
    let fits = |length: usize| length == 0 || length == vertices;
    let uvs = mesh.uvs.iter().all(|uvs| fits(uvs.len()));
    let complete = uvs && fits(mesh.normals.len()) && fits(mesh.colors.len());
    ensure(complete, place, "a per-vertex array is not as long as the positions")
}

fn is_near(p: &Vec3) -> bool {
    p.abs().max_element() <= FURTHEST && p.is_finite()
}

fn ensure(holds: bool, place: impl Fn() -> String, message: &str) -> Result<()> {
    if holds {
        return Ok(());
    }
    Err(Box::new(Diagnostic::new("", message).at_part(place())))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;
    use glam::DAffine3;

    fn one_triangle(far: f32) -> SceneDescription {
        let positions = vec![Vec3::ZERO, Vec3::X * far, Vec3::Y];
        let mesh = Mesh { positions, triangles: vec![[0, 1, 2]], ..Mesh::default() };
        let (shape, transform) = (Shape::Mesh(0), DAffine3::IDENTITY);
        SceneDescription {
            materials: vec![Material::matte("only", Rgb::ONE)],
            meshes: vec![Arc::new(mesh)],
            surfaces: vec![Surface {
                name: "it".into(),
                shape,
                material: 0,
                transform,
                motion: None,
            }],
            ..SceneDescription::default()
        }
    }

    #[test]
    fn what_is_too_far_is_refused_or_left_out_with_a_word() {
        assert!(one_triangle(1e14).check().is_ok());
        for far in [1e20, f32::INFINITY, f32::NAN] {
            let mut scene = one_triangle(far);
            assert!(scene.check().is_err());
            assert_eq!(scene.leave_out_far_triangles("it").len(), 1);
            assert!(scene.check().is_ok() && scene.meshes[0].triangles.is_empty());
        }
        let mut scene = one_triangle(1.0);
        scene.surfaces[0].transform = DAffine3::from_scale(DVec3::splat(1e20));
        assert!(scene.check().unwrap_err().message.contains("1e15 m"));
        scene.surfaces[0].transform = DAffine3::from_translation(DVec3::splat(1e39));
        assert!(scene.check().is_err());
    }
}
