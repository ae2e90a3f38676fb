//! Model files of any format.

use super::access::{read_file, shown};
use super::gltf::LightUnits;
use super::{FileAccess, Warnings, gltf, obj, ply, stl};
use crate::diagnostic::{Diagnostic, Result};
use crate::scene::description::{LuminousEfficacy, SceneDescription};
use glam::{DAffine3, DVec3};
use schemars::JsonSchema;
use serde::Deserialize;
use std::f64::consts::FRAC_PI_2;
use std::path::Path;

/// Which axis points up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum UpAxis {
    /// As in glTF.
    Y,
    /// As in drawings of land and buildings, and here unless a scene says otherwise.
    #[default]
    Z,
}

impl UpAxis {
    /// The unit vector that points up.
    pub fn direction(self) -> DVec3 {
        match self {
            Self::Y => DVec3::Y,
            Self::Z => DVec3::Z,
        }
    }

    /// The unit vector that is up in a picture seen from straight above, as north is on a map.
    pub fn north(self) -> DVec3 {
        match self {
            Self::Y => DVec3::NEG_Z,
            Self::Z => DVec3::Y,
        }
    }
}

/// The turn about x that stands a model with `model` up upright in a world with `world` up.
pub fn upright(model: UpAxis, world: UpAxis) -> DAffine3 {
    match (model, world) {
        (UpAxis::Y, UpAxis::Z) => DAffine3::from_rotation_x(FRAC_PI_2),
        (UpAxis::Z, UpAxis::Y) => DAffine3::from_rotation_x(-FRAC_PI_2),
        _ => DAffine3::IDENTITY,
    }
}

/// The model formats that can be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// glTF 2.0, text or binary (GLB).
    Gltf,
    /// Wavefront OBJ with MTL.
    Obj,
    /// Stanford polygons.
    Ply,
    /// Stereolithography, text or binary.
    Stl,
}

impl Format {
    /// The format of a file by its extension or, if that says nothing, by how it begins.
    pub fn of(path: &Path, bytes: &[u8]) -> Option<Self> {
        Self::of_extension(path).or_else(|| Self::of_content(bytes))
    }

    fn of_extension(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "gltf" | "glb" => Some(Self::Gltf),
            "obj" => Some(Self::Obj),
            "ply" => Some(Self::Ply),
            "stl" => Some(Self::Stl),
            _ => None,
        }
    }

    fn of_content(bytes: &[u8]) -> Option<Self> {
        if bytes.starts_with(b"glTF") || bytes.trim_ascii_start().starts_with(b"{") {
            Some(Self::Gltf)
        } else if bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r") {
            Some(Self::Ply)
        } else if bytes.trim_ascii_start().starts_with(b"solid") || is_binary_stl(bytes) {
            Some(Self::Stl)
        } else {
            None
        }
    }

    /// Which axis is up in files of this format, by its standard or by custom.
    pub fn up(self) -> UpAxis {
        match self {
            Self::Gltf | Self::Obj | Self::Ply => UpAxis::Y,
            Self::Stl => UpAxis::Z,
        }
    }
}

/// Whether the length is what the facet count behind the 80-byte header asks for.
fn is_binary_stl(bytes: &[u8]) -> bool {
    let count = bytes.get(80..84).and_then(|count| count.try_into().ok()).map(u32::from_le_bytes);
    count.is_some_and(|count| bytes.len() as u64 == 84 + 50 * u64::from(count))
}

/// Reads the model file at `path`, in the coordinates it has there.
///
/// Files that it names in turn (materials, pictures, buffers) are opened through `access`.
///
/// # Errors
/// If the file cannot be read, its format is unknown or its content broken.
pub fn read(path: &Path, access: &FileAccess, warnings: &mut Warnings) -> Result<SceneDescription> {
    read_with_format(path, Options::default(), access, warnings).map(|(model, _)| model)
}

/// How a model file is to be read.
#[derive(Debug, Clone, Copy, Default)]
pub struct Options<'a> {
    /// Which of the looks of a glTF file is shown (KHR_materials_variants); `None`: the one that it has without.
    pub variant: Option<&'a str>,
    /// In which units the lights of a glTF file are; `None`: as its generator is known to write them.
    pub lights: Option<LightUnits>,
    /// Lumens per watt, for lights in photometric units.
    pub luminous_efficacy: LuminousEfficacy,
}

/// As [`read`], with the format that was found.
///
/// # Errors
/// As [`read`]; or if there is no such variant.
pub fn read_with_format(
    path: &Path,
    options: Options<'_>,
    access: &FileAccess,
    warnings: &mut Warnings,
) -> Result<(SceneDescription, Format)> {
    let (bytes, name) = (read_file(path)?, shown(path));
    let format = Format::of(path, &bytes).ok_or_else(|| {
        Diagnostic::new(&name, "this is no model file that can be read")
            .help("models are .gltf, .glb, .obj, .ply or .stl")
    })?;
    let model = match (format, options.variant) {
        (Format::Gltf, _) => gltf::read(&bytes, &name, options, access, warnings),
        (_, Some(_)) => {
            let cause = "this model has no variants: only glTF files have some";
            Err(Box::new(Diagnostic::new(&name, cause)))
        }
        (Format::Obj, None) => obj::read(&bytes, &name, access, warnings),
        (Format::Ply, None) => ply::read(&bytes, &name, access, warnings),
        (Format::Stl, None) => stl::read(&bytes, &name, access, warnings),
    };
    Ok((model?, format))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_extension_decides_and_the_content_helps_out() {
        let of = |name: &str, bytes: &[u8]| Format::of(Path::new(name), bytes);
        assert_eq!(of("a.PLY", b"solid"), Some(Format::Ply));
        assert_eq!(of("a", b"glTF\x02\0\0\0"), Some(Format::Gltf));
        assert_eq!(of("a.json", b" \n{\"asset\": {}}"), Some(Format::Gltf));
        assert_eq!(of("a", b"ply\r\nformat"), Some(Format::Ply));
        assert_eq!(of("a.txt", b"solid cube\n"), Some(Format::Stl));
        assert_eq!(of("a", &[0; 84]), Some(Format::Stl));
        assert_eq!(of("a", &[0; 85]), None);
        assert_eq!(of("a", b""), None);
    }

    #[test]
    fn upright_turns_the_models_up_to_the_worlds() {
        for model in [UpAxis::Y, UpAxis::Z] {
            for world in [UpAxis::Y, UpAxis::Z] {
                let up = upright(model, world).transform_vector3(model.direction());
                assert!(up.abs_diff_eq(world.direction(), 1e-15));
            }
        }
    }
}
