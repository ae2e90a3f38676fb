//! The scene format: TOML with a table for each thing, `[kind.name.type]`. See docs/scene-format.md.
//!
//! What is written is deserialised into the `...Keys` structs of the submodules, which check every value as it is
//! read, so that each error has its place; `build` then turns names into indices. The JSON schema comes from the
//! same structs.

mod build;
mod camera;
mod color;
mod complaint;
mod document;
mod environment;
mod film;
mod light;
mod look;
mod luminaire;
mod material;
mod medium;
mod motion;
mod overrides;
mod pictures;
mod substance;
mod sun;
mod surface;
#[cfg(test)]
mod tests;
mod transform;

pub use look::apply_look;
pub use overrides::Override;

use self::color::Color;
use crate::color::Rgb;
use crate::diagnostic::{Diagnostic, Result};
use crate::io::gltf::LightUnits;
use crate::io::model::UpAxis;
use crate::io::{FileAccess, Warnings};
use crate::scene::description::{LuminousEfficacy, SceneDescription, Shadows};
use crate::suggest::quoted;
use crate::units::written::{Checked, Size, WITH_UNIT, Written, quantity, written};
use crate::units::{Dimension, Quantity};
use camera::CameraKeys;
use document::{At, Document, Named};
use environment::{EnvironmentKeys, IntegratorKeys};
use film::FilmKeys;
use light::LightKeys;
use look::{LookName, SectionKeys};
use material::MaterialKeys;
use medium::MediumKeys;
use motion::MotionKeys;
use schemars::JsonSchema;
use serde::Deserialize;
use surface::SurfaceKeys;
use transform::Step;

/// Bytes of memory that reading `text` needs at most.
///
/// Measured on texts made to need much: lists of short numbers, and tables with one key each. Every table of a
/// text that holds something has a dot or an equals sign of its own.
fn memory(text: &str) -> u64 {
    const A_BYTE: u64 = 90;
    const A_TABLE: u64 = 1200;
    let tables = text.bytes().filter(|byte| matches!(byte, b'.' | b'=')).count();
    A_BYTE * text.len() as u64 + A_TABLE * tables as u64
}

/// Reads a scene from its text; `name` is the file as the user named it.
///
/// `overrides` are laid over the text, later ones over earlier ones. Models and pictures are opened through `access`.
///
/// # Errors
/// At the first thing that is wrong: more text than fits in `access.limits.decoded_bytes` when unpacked, syntax, an
/// unknown or missing key, a value out of range, a name that nothing has, a file that cannot be read. The place is a line of the text, an override, or the file that failed.
pub fn read(
    text: &str,
    name: &str,
    overrides: &[Override],
    access: &FileAccess,
    warnings: &mut Warnings,
) -> Result<SceneDescription> {
    read_document(&Document { name, text, overrides, generated: false }, access, warnings)
}

/// As [`read`], of a text that was made for the model `name`: what is wrong with it is told without the text.
pub(super) fn read_around(
    text: &str,
    name: &str,
    overrides: &[Override],
    access: &FileAccess,
    warnings: &mut Warnings,
) -> Result<SceneDescription> {
    read_document(&Document { name, text, overrides, generated: true }, access, warnings)
}

fn read_document(
    document: &Document<'_>,
    access: &FileAccess,
    warnings: &mut Warnings,
) -> Result<SceneDescription> {
    let (needed, limit) = (memory(document.text) >> 20, access.limits.decoded_bytes >> 20);
    if needed > limit {
        let message = format!("this text may take {needed} MiB to read; {limit} MiB are allowed");
        let error = Diagnostic::new(document.name, message);
        return Err(Box::new(error.help("keep large meshes in model files")));
    }
    build::build(document.read()?, document, access, warnings)
}

/// The text of a scene file from its bytes, without a byte order mark.
///
/// # Errors
/// If it is not UTF-8; names the line and the byte.
pub fn text(bytes: Vec<u8>, name: &str) -> Result<String> {
    let mut text = String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let lines = error.as_bytes().iter().take(valid).filter(|byte| **byte == b'\n').count();
        Diagnostic::new(name, "this is not UTF-8 text")
            .at_line(lines + 1)
            .at_part(format!("byte {valid}"))
            .help("save the scene as UTF-8")
    })?;
    if text.starts_with('\u{feff}') {
        text.drain(..'\u{feff}'.len_utf8());
    }
    Ok(text)
}

/// The JSON schema of the scene format, for editors: every key with its description, units and limits.
pub fn schema() -> serde_json::Value {
    let mut schema = schemars::schema_for!(SceneKeys);
    schema.insert("title".into(), "firstlight scene".into());
    schema.into()
}

/// A scene for firstlight. Lengths are metres, angles degrees, light radiometric SI unless a unit is given.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
struct SceneKeys {
    /// Which axis points up. Default "z".
    up: UpAxis,
    /// Radiance of directions that hit nothing; 1 is white. It lights nothing. Default 0.
    background: Color,
    /// Light from directions that hit nothing. Default: none.
    environment: Option<At<EnvironmentKeys>>,
    /// What is everywhere where no solid is, such as fog. Default: nothing.
    medium: Option<MediumKeys>,
    /// How light is gathered. Default "direct".
    integrator: IntegratorKeys,
    /// What the picture is for: "clarity", "balanced" or "real". Default: as integrator and lights say.
    look: Option<At<LookName>>,
    /// For the look "clarity": a plane before which everything is cut away.
    section: Option<At<SectionKeys>>,
    /// Lumens per watt, to convert between light as seen and its energy. Default 683.
    luminous_efficacy: Efficacy,
    /// How shadow rays are kept from hitting the surface they leave. Default "robust".
    shadows: Shadows,
    /// The camera to use first. Default: one that frames everything.
    camera: Option<At<CameraKeys>>,
    /// Further cameras by name.
    cameras: Named<CameraKeys>,
    /// Resolution, samples, filter, exposure.
    film: FilmKeys,
    /// Materials by name.
    materials: Named<MaterialKeys>,
    /// Shapes by name.
    surfaces: Named<SurfaceKeys>,
    /// Model files by name.
    models: Named<ModelKeys>,
    /// Repetitions of surfaces and models, by name.
    instances: Named<InstanceKeys>,
    /// Lights by name.
    lights: Named<LightKeys>,
}

impl Default for SceneKeys {
    fn default() -> Self {
        Self {
            up: UpAxis::default(),
            background: Color(Rgb::ZERO),
            environment: None,
            medium: None,
            integrator: IntegratorKeys::default(),
            look: None,
            section: None,
            luminous_efficacy: Efficacy(LuminousEfficacy::default().0),
            shadows: Shadows::default(),
            camera: None,
            cameras: Named::new(),
            film: FilmKeys::default(),
            materials: Named::new(),
            surfaces: Named::new(),
            models: Named::new(),
            instances: Named::new(),
            lights: Named::new(),
        }
    }
}

/// A glTF, OBJ, PLY or STL file.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct ModelKeys {
    /// The file, relative to the scene's folder.
    file: At<String>,
    /// Name of a material that replaces its own.
    material: Option<At<String>>,
    /// Which of its looks is shown, if it is a glTF file with variants.
    variant: Option<At<String>>,
    /// In which units its lights are, if it is a glTF file. Default: as its generator is known to write them, else "spec".
    gltf_lights: Option<LightUnits>,
    /// Length of 1 in the file. Default 1 m.
    unit: Option<FileUnit>,
    /// Which axis of the file points up. Default: y for glTF, OBJ and PLY, z for STL.
    up: Option<UpAxis>,
    /// Steps to the world, the first applied first, after the model stands upright in metres.
    transform: Option<At<Vec<Step>>>,
    /// What it does after that while the scene's time runs. Its lights stand still. Default: nothing.
    motion: Option<At<MotionKeys>>,
}

impl ModelKeys {
    /// The length of 1 in the file, m.
    fn metres(&self) -> f64 {
        self.unit.map_or(1.0, |unit| unit.0)
    }
}

/// The surfaces of a surface or model once more (not its lights).
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct InstanceKeys {
    /// Name of the surface or model.
    of: At<String>,
    /// Name of a material that replaces the original's.
    material: Option<At<String>>,
    /// Steps applied after the original's own transform.
    transform: Option<At<Vec<Step>>>,
    /// What it does after that while the scene's time runs. Default: nothing, whatever the original does.
    motion: Option<At<MotionKeys>>,
}

/// Lumens per watt.
#[derive(Debug, Clone, Copy)]
struct Efficacy(f64);

impl Written for Efficacy {
    const EXPECTED: &'static str = "a luminous efficacy such as 683 or \"683 lm/W\"";
    fn from_number(number: f64) -> Checked<Self> {
        if (1e-3..=1e6).contains(&number) {
            return Ok(Self(number));
        }
        Err(format!("must be between 0.001 and 1000000 lm/W, not {number}"))
    }
    fn from_text(text: &str) -> Checked<Self> {
        Self::from_number(quantity(text, Dimension::Efficacy)?.value)
    }
}

/// A unit of length, `"mm"`, or any length, `"2.5 cm"`.
#[derive(Debug, Clone, Copy)]
struct FileUnit(f64);

impl Written for FileUnit {
    const EXPECTED: &'static str = "a unit of length such as \"mm\"";
    fn from_number(metres: f64) -> Checked<Self> {
        Size::from_number(metres).map(|Size(metres)| Self(metres))
    }
    fn from_text(text: &str) -> Checked<Self> {
        let length = Quantity::parse(text).or_else(|_| Quantity::parse(&format!("1 {text}")));
        match length {
            Ok(Quantity { value, dimension: Dimension::Length, .. }) => Self::from_number(value),
            _ => Err(format!("needs {}, not {}", Self::EXPECTED, quoted(text))),
        }
    }
}

written! {
    Efficacy: { "type": ["number", "string"], "pattern": WITH_UNIT, "examples": [683, "683 lm/W"] }
    FileUnit: { "type": ["string", "number"], "examples": ["mm", "cm", "m", "in", "2.5 cm"] }
}
