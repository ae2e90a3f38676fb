//! The document's meshes, read when a node first shows them.

use super::data::Data;
use super::document::{Draco, Primitive};
use super::geometry;
use super::material::Materials;
use super::notes::Notes;
use super::variants;
use crate::diagnostic::Result;
use crate::scene::description::{Material, Mesh, Pattern};
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

/// The meshes read so far.
pub(super) struct Meshes<'a> {
    data: &'a Data<'a>,
    /// Which look is shown.
    variant: Option<u32>,
    /// They go into the scene.
    pub(super) list: Vec<Arc<Mesh>>,
    /// Primitives with the same data share a mesh.
    places: HashMap<Key<'a>, Option<usize>>,
    /// For each mesh of the document, its primitives, once it was read.
    read: HashMap<u32, Arc<[Part]>>,
}

/// What makes two primitives the same but for their material.
type Key<'a> = (&'a BTreeMap<String, u32>, Option<u32>, Option<u32>, Option<&'a Draco>);

/// A mesh and the material it is shown with, as places in their lists.
#[derive(Debug, Clone, Copy)]
pub(super) struct Part {
    pub(super) mesh: usize,
    pub(super) material: usize,
}

impl<'a> Meshes<'a> {
    pub(super) fn new(data: &'a Data<'a>, variant: Option<u32>) -> Self {
        Self { data, variant, list: Vec::new(), places: HashMap::new(), read: HashMap::new() }
    }

    /// The name of the mesh that `part` refers to by `index`.
    ///
    /// # Errors
    /// If it does not exist.
    pub(super) fn name(&self, index: u32, part: &str) -> Result<String> {
        let mesh = self.data.at(&self.data.document.meshes, index, "mesh", part)?;
        Ok(mesh.name.clone().unwrap_or_else(|| format!("mesh {index}")))
    }

    /// What the mesh that `part` refers to by `index` is made of.
    ///
    /// # Errors
    /// If it does not exist or anything it needs is broken.
    pub(super) fn parts(
        &mut self,
        index: u32,
        part: &str,
        materials: &mut Materials,
        notes: &mut Notes,
    ) -> Result<Arc<[Part]>> {
        if let Some(parts) = self.read.get(&index) {
            return Ok(Arc::clone(parts));
        }
        let name = self.name(index, part)?;
        let mesh = self.data.at(&self.data.document.meshes, index, "mesh", part)?;
        let mut parts = Vec::new();
        for (i, primitive) in mesh.primitives.iter().enumerate() {
            let part = format!("meshes[{index}].primitives[{i}]");
            parts.extend(self.part(primitive, &name, &part, materials, notes)?);
        }
        let parts: Arc<[Part]> = parts.into();
        self.read.insert(index, Arc::clone(&parts));
        Ok(parts)
    }

    fn part(
        &mut self,
        primitive: &'a Primitive,
        name: &str,
        part: &str,
        materials: &mut Materials,
        notes: &mut Notes,
    ) -> Result<Option<Part>> {
        let Some(place) = self.place(primitive, name, part, notes)? else { return Ok(None) };
        let field = format!("{part}.material");
        let material = materials.place(
            self.data,
            variants::material(primitive, self.variant),
            &field,
            notes,
        )?;
        let Some(mesh) = self.list.get(place) else { return Ok(None) };
        if !mesh.colors.is_empty() {
            materials.use_vertex_colors(material);
        }
        if materials.list.get(material).is_some_and(|material| needs_more_uvs(material, mesh)) {
            notes.add(part, "has not the texture coordinates that its material's pictures need");
        }
        Ok(Some(Part { mesh: place, material }))
    }

    fn place(
        &mut self,
        primitive: &'a Primitive,
        name: &str,
        part: &str,
        notes: &mut Notes,
    ) -> Result<Option<usize>> {
        let draco = primitive.extensions.as_ref().and_then(|e| e.draco.as_ref());
        let key = (&primitive.attributes, primitive.indices, primitive.mode, draco);
        if let Some(place) = self.places.get(&key) {
            return Ok(*place);
        }
        let mesh = geometry::read(self.data, primitive, name, part, notes)?;
        let place = mesh.map(|mesh| {
            self.list.push(Arc::new(mesh));
            self.list.len() - 1
        });
        self.places.insert(key, place);
        Ok(place)
    }
}

fn needs_more_uvs(material: &Material, mesh: &Mesh) -> bool {
    material.textures().into_iter().any(|texture| match texture.pattern {
        Pattern::Image { uv_set, .. } => uv_set >= mesh.uvs.len(),
        _ => false,
    })
}
