//! KHR_draco_mesh_compression: a primitive's indices and attributes in one stream.

use super::accessor::Accessor;
use super::data::Data;
use super::document::Draco;
use crate::diagnostic;
use draco_core::{DecodeLimits, DecoderBuffer, Mesh, MeshDecoder};
use std::collections::BTreeMap;

/// A decoded primitive.
pub(super) struct Unpacked<'a> {
    mesh: Mesh,
    ids: &'a BTreeMap<String, u32>,
}

impl<'a> Unpacked<'a> {
    /// Decodes the stream of the primitive at `part`.
    ///
    /// # Errors
    /// If it cannot be decoded, or to more than the budget allows.
    pub(super) fn decode(data: &Data, packed: &'a Draco, part: &str) -> diagnostic::Result<Self> {
        let part = format!("{part}.extensions.KHR_draco_mesh_compression");
        let (bytes, _) = data.view(packed.buffer_view, &format!("{part}.bufferView"))?;
        let limits = DecodeLimits::default()
            .with_max_decoded_bytes(data.budget())
            .with_max_faces(data.budget() / 12);
        let mut mesh = Mesh::new();
        MeshDecoder::new()
            .decode(&mut DecoderBuffer::new(bytes).with_limits(limits), &mut mesh)
            .map_err(|cause| data.error(&part, format!("cannot be unpacked: {cause}")))?;
        data.charge(12 * mesh.num_faces() as u64 + 32 * mesh.num_points() as u64, &part)?;
        Ok(Self { mesh, ids: &packed.attributes })
    }

    /// The corners of its triangles.
    pub(super) fn indices(&self) -> Vec<u32> {
        self.mesh.faces().iter().flatten().map(|point| point.0).collect()
    }

    /// The attribute of this name; `None` if it is not in the stream by the file's own word.
    ///
    /// # Errors
    /// If the file says so, but it is not there.
    pub(super) fn attribute(&self, name: &str) -> Result<Option<Accessor<'static>>, String> {
        let Some(&id) = self.ids.get(name) else { return Ok(None) };
        let missing = || format!("the Draco stream has no attribute {id}");
        let attribute = self.mesh.attribute_by_unique_id(id).ok_or_else(missing)?;
        let components = usize::from(attribute.num_components()).clamp(1, 4);
        let numbers = attribute.read_f32s(self.mesh.num_points(), components);
        Ok(Some(Accessor::floats(&numbers, components)))
    }
}
