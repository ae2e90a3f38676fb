//! PLY, text and binary: one mesh with whatever its vertices carry.
//!
//! Own code, because serde-ply 0.2 names neither line nor byte in its errors.

mod faces;
mod header;
#[cfg(test)]
mod tests;
mod values;
mod vertices;

use super::pictures::{Named, Pictures, SQUARES};
use super::text::{counted, quoted};
use super::triangles::{add_surface, default_material, fill_normals, not_empty, without_unused};
use super::{FileAccess, Warnings};
use crate::color::Rgb;
use crate::diagnostic::{Diagnostic, Place, Result};
use crate::scene::description::{Alpha, Material, Mesh, SceneDescription, UvTransform, Wrap};
use faces::Faces;
use header::{Element, Format, Header};
use values::{Binary, Values, Words};

/// Reads a PLY file: one surface with the file's normals (flat without), texture coordinates and colours.
///
/// Coordinates stay as in the file; `name` is its name for messages. Whole-numbered vertex colours are taken
/// as sRGB-encoded, others as linear. A picture named by `comment TextureFile` is opened with `access`.
///
/// # Errors
/// If the file is cut off or promises more than it holds, a value cannot be read, a face names a vertex that
/// does not exist, or there are no faces.
pub fn read(
    bytes: &[u8],
    name: &str,
    access: &FileAccess,
    warnings: &mut Warnings,
) -> Result<SceneDescription> {
    let header = Header::read(bytes, name)?;
    let length = bytes.len();
    let mesh = match header.format {
        Format::Ascii => read_body(Words::new(&header), &header, name, warnings),
        Format::LittleEndian => {
            read_body(Binary::<false>::new(&header, length), &header, name, warnings)
        }
        Format::BigEndian => {
            read_body(Binary::<true>::new(&header, length), &header, name, warnings)
        }
    }?;
    let mut scene = SceneDescription::default();
    if !mesh.triangles.is_empty() {
        let mut pictures = Pictures::new(access);
        scene.materials.push(material(&header, &mesh, name, &mut pictures, warnings));
        scene.images = pictures.finish(warnings);
        add_surface(&mut scene, mesh, 0);
    }
    not_empty(scene, name)
}

fn read_body<V: Values>(
    mut values: V,
    header: &Header<'_>,
    name: &str,
    warnings: &mut Warnings,
) -> Result<Mesh> {
    check_elements(header, name)?;
    let mut faces = Faces::new(name, Mesh::default());
    for element in &header.elements {
        check_room(&values, element, name)?;
        match element.name.as_str() {
            "vertex" => faces.mesh = vertices::read(&mut values, element, name, warnings)?,
            "face" => faces.read_polygons(&mut values, element)?,
            "tristrips" => faces.read_strips(&mut values, element)?,
            _ => skip(&mut values, element, name)?,
        }
    }
    values.warn(warnings);
    faces.triangulator.finish(faces.mesh.triangles.is_empty(), warnings)?;
    let mut mesh = without_unused(faces.finish()?, name)?;
    fill_normals(&mut mesh, name, warnings);
    Ok(mesh)
}

/// Refuses files without vertices or without anything that joins them.
fn check_elements(header: &Header<'_>, name: &str) -> Result<()> {
    let position = |wanted: &str| header.elements.iter().position(|e| e.name == wanted);
    let joined = |e: &Element| matches!(e.name.as_str(), "face" | "tristrips") && e.count > 0;
    let Some(vertices) = position("vertex") else {
        return Err(Box::new(Diagnostic::new(name, "this file has no vertices")));
    };
    match header.elements.iter().position(joined) {
        Some(faces) if faces > vertices => Ok(()),
        Some(_) => {
            let error = Diagnostic::new(name, "the faces come before the vertices");
            Err(Box::new(error.help("write the file with element vertex first")))
        }
        None => {
            let error = Diagnostic::new(name, "this is a cloud of points: it has no faces");
            Err(Box::new(error.help("make a surface of it first, for example with MeshLab")))
        }
    }
}

/// Refuses an element that promises more rows than the bytes that are left can hold.
fn check_room<V: Values>(values: &V, element: &Element, name: &str) -> Result<()> {
    let row: u64 = element.properties.iter().map(V::least_size_of).sum();
    if element.count.checked_mul(row).is_some_and(|bytes| bytes <= values.left()) {
        return Ok(());
    }
    let (what, count) = (quoted(element.name.as_bytes()), element.count);
    let left = values.left();
    let rows = format!("{what} promises {count} rows of at least {row} bytes");
    let error = Diagnostic::new(name, format!("{rows}, but only {left} bytes are left"));
    Err(Box::new(error.at_line(element.line).help("the file was cut off or damaged on its way")))
}

/// Reads over rows of no use.
fn skip<V: Values>(values: &mut V, element: &Element, name: &str) -> Result<()> {
    let rows = if element.properties.is_empty() { 0 } else { element.count };
    for number in 0..rows {
        for property in &element.properties {
            values.skip(property).map_err(|cause| {
                values.complain(
                    name,
                    format!("row {number} of {}: {cause}", quoted(element.name.as_bytes())),
                )
            })?;
        }
        values.end_row(name);
    }
    Ok(())
}

/// The picture if there is one, else the vertex colours, else the default.
fn material(
    header: &Header<'_>,
    mesh: &Mesh,
    name: &str,
    pictures: &mut Pictures<'_>,
    warnings: &mut Warnings,
) -> Material {
    let mut material = default_material();
    if let Some(file) = header.textures.first()
        && !mesh.uvs.is_empty()
    {
        let place = Place { file: name.into(), ..Place::default() };
        let named = Named {
            file,
            factor: [1.0; 4],
            transform: UvTransform::IDENTITY,
            wrap: Wrap::Repeat,
            range: None,
            place,
            otherwise: SQUARES,
        };
        material.reflectance = pictures.texture(named, warnings);
        if header.textures.len() > 1 {
            let count = counted(header.textures.len(), "picture");
            let message = format!("of {count} only the first is used, {}", quoted(file.as_bytes()));
            warnings.push(Diagnostic::new(name, message));
        }
    } else if !mesh.colors.is_empty() {
        material = Material::matte("default", Rgb::ONE);
        material.reflectance.vertex_colors = true;
        material.alpha = alpha_of(&mesh.colors);
    }
    material
}

/// Some programs write alpha 0 everywhere and mean nothing by it.
fn alpha_of(colors: &[[f32; 4]]) -> Alpha {
    let some = colors.iter().any(|color| color[3] > 0.0);
    let part = colors.iter().any(|color| color[3] < 1.0);
    if some && part { Alpha::Blend } else { Alpha::Opaque }
}
