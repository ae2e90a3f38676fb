//! Which extensions are understood.

use super::document::Document;
use super::error;
use super::notes::Notes;
use crate::diagnostic::{Diagnostic, Result};

/// Extensions that are read, and those that change nothing in a still picture.
const KNOWN: [&str; 28] = [
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "EXT_texture_webp",
    "KHR_animation_pointer",
    "KHR_draco_mesh_compression",
    "KHR_lights_punctual",
    "KHR_mesh_quantization",
    "KHR_meshopt_compression",
    "KHR_texture_basisu",
    "KHR_texture_transform",
    "KHR_xmp",
    "KHR_xmp_json_ld",
    // Without these a texture's other picture is shown; with them alone, a checkerboard and a warning.
    "EXT_texture_avif",
    "MSFT_texture_dds",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_variants",
    "KHR_materials_volume",
];

/// Textures in formats that cannot be decoded: a file may offer them, but not require them.
const UNREADABLE: [&str; 2] = ["EXT_texture_avif", "MSFT_texture_dds"];

/// Every KHR_materials extension can be shown matte; the materials say so where they are read.
fn is_known(name: &str) -> bool {
    KNOWN.contains(&name) || name.starts_with("KHR_materials_")
}

/// Notes extensions that are not understood.
///
/// # Errors
/// If the document cannot be shown without one of them.
pub(super) fn check(document: &Document, file: &str, notes: &mut Notes) -> Result<()> {
    for (i, name) in document.extensions_required.iter().enumerate() {
        if !is_known(name) || UNREADABLE.contains(&name.as_str()) {
            let cause = format!("the file requires the extension {name}, which is not supported");
            let complaint = error(file, format!("extensionsRequired[{i}]"), cause);
            let help = format!("export the model again without {name}");
            return Err(Box::new(Diagnostic { help: Some(help), ..*complaint }));
        }
    }
    for (i, name) in document.extensions_used.iter().enumerate().filter(|(_, n)| !is_known(n)) {
        let message = format!("the extension {name} is not supported and was ignored");
        notes.add(format!("extensionsUsed[{i}]"), message);
    }
    Ok(())
}
