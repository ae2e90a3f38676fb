//! glTF 2.0: `.gltf` documents with their files, and `.glb` containers.
//!
//! What comes out is a scene in glTF's own axes (Y up, metres), lit as the file says. The parts:
//! `container` splits a GLB, `document` is the JSON, `data` and `accessor` are the numbers in its buffers
//! (`draco` and `meshopt` unpack them), `geometry`, `material`, `picture`, `nodes` and `view` are what they mean.
//!
//! Source: Khronos, glTF 2.0 specification, <https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html>.

mod accessor;
mod container;
mod data;
mod document;
mod draco;
mod extension;
mod geometry;
mod instances;
mod material;
mod meshes;
mod meshopt;
mod nodes;
mod notes;
mod picture;
#[cfg(test)]
mod tests;
mod units;
mod uri;
mod variants;
mod view;

pub use units::LightUnits;

use crate::diagnostic::{Diagnostic, Result};
use crate::io::model::Options;
use crate::io::{FileAccess, Warnings};
use crate::scene::description::{SceneDescription, Shape, Surface};
use data::Data;
use document::Document;
use glam::DAffine3;
use material::Materials;
use meshes::{Meshes, Part};
use nodes::Placed;
use notes::Notes;

/// Reads a glTF 2.0 document or a GLB (told apart by its first bytes); `name` is for messages.
///
/// Each primitive becomes one mesh, shared by all nodes that show it, and each node's primitive one surface with
/// the node's name. Axes stay glTF's: Y up, metres. Buffers and pictures beside the document are opened through
/// `access`. Lights are converted to radiometric units with the luminous efficacy of `options`.
///
/// # Errors
/// If the document, a buffer or a reference in it is broken, or it requires an extension that is not supported.
/// Pictures that cannot be read and looks that cannot be shown only make `warnings`.
pub fn read(
    bytes: &[u8],
    name: &str,
    options: Options<'_>,
    access: &FileAccess,
    warnings: &mut Warnings,
) -> Result<SceneDescription> {
    let contents = container::split(bytes, name)?;
    let document = Document::parse(contents.json, name)?;
    let mut notes = Notes::new(name);
    extension::check(&document, name, &mut notes)?;
    let data = Data::load(&document, contents.binary, name, access)?;
    let variant = options.variant.map(|variant| variants::find(&data, variant)).transpose()?;
    let lights = LightUnits::choose(options.lights, &data, &mut notes);
    let mut builder = Builder::new(&data, variant, lights, &mut notes);
    builder.scene.luminous_efficacy = options.luminous_efficacy;
    let scene = builder.build()?;
    notes.finish(warnings);
    Ok(scene)
}

/// Puts the scene together, node by node.
struct Builder<'a, 'n, 'f> {
    data: &'a Data<'a>,
    notes: &'n mut Notes<'f>,
    meshes: Meshes<'a>,
    materials: Materials,
    lights: LightUnits,
    scene: SceneDescription,
    /// Bytes that surfaces may still take.
    left: u64,
}

impl<'a, 'n, 'f> Builder<'a, 'n, 'f> {
    fn new(
        data: &'a Data<'a>,
        variant: Option<u32>,
        lights: LightUnits,
        notes: &'n mut Notes<'f>,
    ) -> Self {
        let (meshes, materials) = (Meshes::new(data, variant), Materials::new(data));
        let left = data.access.limits.decoded_bytes;
        let scene = SceneDescription::default();
        Self { data, notes, meshes, materials, lights, scene, left }
    }

    fn build(mut self) -> Result<SceneDescription> {
        for placed in nodes::place(self.data)? {
            self.surfaces(&placed)?;
            self.camera(&placed)?;
            self.light(&placed)?;
        }
        let (materials, images) = self.materials.finish();
        let meshes = self.meshes.list;
        Ok(SceneDescription { materials, images, meshes, ..self.scene })
    }

    fn surfaces(&mut self, placed: &Placed) -> Result<()> {
        let Some(mesh) = placed.node.mesh else { return Ok(()) };
        if placed.node.skin.is_some() {
            let part = format!("nodes[{}].skin", placed.index);
            self.notes.add(part, "skins are ignored; the mesh is shown in its bind pose");
        }
        let part = format!("nodes[{}].mesh", placed.index);
        let parts = self.meshes.parts(mesh, &part, &mut self.materials, self.notes)?;
        let name = match &placed.node.name {
            Some(name) => name.clone(),
            None => self.meshes.name(mesh, &part)?,
        };
        for transform in instances::transforms(self.data, placed)? {
            if !is_invertible(transform) {
                let cause = "is scaled to nothing, or beyond what can be computed; it is left out";
                self.notes.add(&part, cause);
                continue;
            }
            for &part in parts.iter() {
                self.surface(&name, part, transform)?;
            }
        }
        Ok(())
    }

    fn surface(&mut self, name: &str, part: Part, transform: DAffine3) -> Result<()> {
        // Twice its size, because a list that grows is copied.
        let size = 2 * size_of::<Surface>() + name.len();
        let Some(left) = self.left.checked_sub(size as u64) else {
            let count = self.scene.surfaces.len();
            let cause = format!("the scene has more than {count} surfaces, which is the limit");
            return Err(self.data.error("nodes", cause));
        };
        self.left = left;
        let (shape, material) = (Shape::Mesh(part.mesh), part.material);
        let name = name.to_owned();
        self.scene.surfaces.push(Surface { name, shape, material, transform, motion: None });
        Ok(())
    }

    fn camera(&mut self, placed: &Placed) -> Result<()> {
        let Some(index) = placed.node.camera else { return Ok(()) };
        self.scene.cameras.extend(view::camera(self.data, placed, index, self.notes)?);
        Ok(())
    }

    fn light(&mut self, placed: &Placed) -> Result<()> {
        let light = placed.node.extensions.as_ref().and_then(|e| e.light.as_ref());
        let Some(light) = light else { return Ok(()) };
        let efficacy = self.scene.luminous_efficacy.0;
        let units = (self.lights, efficacy);
        let light = view::light(self.data, placed, light.light, units, self.notes)?;
        self.scene.lights.extend(light);
        Ok(())
    }
}

fn is_invertible(transform: DAffine3) -> bool {
    let determinant = transform.matrix3.determinant();
    determinant.is_normal() && transform.is_finite() && transform.inverse().is_finite()
}

/// A complaint about `part` of the file `name`.
fn error(name: &str, part: impl Into<String>, cause: impl Into<String>) -> Box<Diagnostic> {
    Box::new(Diagnostic::new(name, cause).at_part(part))
}

/// The item of `list` that `part` refers to by `index`.
fn at<'a, T>(list: &'a [T], index: u32, kind: &str, part: &str, name: &str) -> Result<&'a T> {
    list.get(index as usize).ok_or_else(|| {
        let there = match list.len() {
            0 => "there are none".to_owned(),
            1 => "there is 1".to_owned(),
            many => format!("there are {many}"),
        };
        error(name, part, format!("{kind} {index} does not exist; {there}"))
    })
}
