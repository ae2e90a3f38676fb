//! Placing one description inside another.

use super::description::{Pattern, SceneDescription, Shape, Texture};
use glam::DAffine3;

impl SceneDescription {
    /// Adds everything of `model` under `transform`, its own cameras and lights included. `material` replaces the
    /// materials of all its surfaces by one of this scene's. Returns the indices of the surfaces that were added.
    pub fn place(
        &mut self,
        model: &SceneDescription,
        transform: &DAffine3,
        material: Option<usize>,
    ) -> std::ops::Range<usize> {
        let (images, materials) = (self.images.len(), self.materials.len());
        let (meshes, surfaces) = (self.meshes.len(), self.surfaces.len());
        self.images.extend(model.images.iter().cloned());
        self.meshes.extend(model.meshes.iter().cloned());
        self.materials.extend(model.materials.iter().cloned().map(|mut m| {
            shift(&mut m.reflectance, images);
            shift(&mut m.emission, images);
            m.ambient_reflectance.iter_mut().for_each(|t| shift(t, images));
            m
        }));
        self.surfaces.extend(model.surfaces.iter().cloned().map(|mut s| {
            s.transform = *transform * s.transform;
            s.material = material.unwrap_or(s.material + materials);
            if let Shape::Mesh(mesh) = &mut s.shape {
                *mesh += meshes;
            }
            s
        }));
        self.cameras.extend(model.cameras.iter().map(|c| c.transformed(transform)));
        self.lights.extend(model.lights.iter().map(|l| l.transformed(transform)));
        surfaces..self.surfaces.len()
    }
}

fn shift(texture: &mut Texture, images: usize) {
    if let Pattern::Image { image, .. } = &mut texture.pattern {
        *image += images;
    }
}
