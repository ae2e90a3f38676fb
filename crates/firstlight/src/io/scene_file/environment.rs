//! `[environment.type]` and `integrator`: light from far away, and how light is gathered.

use super::color::Color;
use super::document::At;
use super::light::{Amount, Lighting, Radiance};
use super::pictures::Pictures;
use crate::color::Rgb;
use crate::diagnostic::Result;
use crate::io::model::{UpAxis, upright};
use crate::scene::description::{EnvironmentDescription, Integrator, Sampling, Sky};
use crate::units::written::{Angle, Checked, Number, Written, written};
use glam::DQuat;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde::de::{Deserializer, Error, MapAccess, Visitor, value::MapAccessDeserializer};
use std::borrow::Cow;
use std::fmt;
use std::sync::Arc;

/// Light from directions that hit nothing: exactly one kind.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(super) enum EnvironmentKeys {
    /// The same from everywhere.
    Uniform(At<UniformKeys>),
    /// From one colour to the next between zenith, horizon and nadir.
    Gradient(At<GradientKeys>),
    /// A lat-long picture.
    Image(At<ImageKeys>),
}

/// The same from everywhere.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct UniformKeys {
    /// What comes from every direction: W/(sr m²) or nit.
    radiance: At<Amount<Radiance>>,
    /// Its colour. Default white.
    color: Option<Color>,
    /// Whether the camera sees it, or the background. Default true.
    visible: Option<bool>,
}

/// Three radiances with straight lines between them, by the sine of the elevation.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct GradientKeys {
    /// From straight above; 1 is white.
    zenith: Color,
    /// From the horizon.
    horizon: Color,
    /// From straight below. Default 0.
    nadir: Option<Color>,
    /// Multiplies them. Default 1.
    strength: Option<Strength>,
    /// Whether the camera sees it, or the background. Default true.
    visible: Option<bool>,
}

/// A lat-long picture: zenith in the first row, north (y; -z where y is up) in the middle, east (x) to its right.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ImageKeys {
    /// HDR, EXR, PFM, PNG, JPEG or WebP file, relative to the scene's folder.
    file: At<String>,
    /// Anticlockwise turn, seen from above. Default 0.
    rotation: Option<Angle>,
    /// Multiplies the picture. Default 1.
    strength: Option<Strength>,
    /// Multiplies the picture. Default white.
    color: Option<Color>,
    /// How pixels are joined. Default "bilinear".
    #[serde(default)]
    sampling: Sampling,
    /// Whether the camera sees it, or the background. Default true.
    visible: Option<bool>,
}

/// A factor of 0 or more.
#[derive(Debug, Clone, Copy)]
pub(super) struct Strength(f32);

impl Written for Strength {
    const EXPECTED: &'static str = "a number of 0 or more";
    fn from_number(number: f64) -> Checked<Self> {
        if number >= 0.0 && (number as f32).is_finite() {
            return Ok(Self(number as f32));
        }
        Err(format!("needs {}, not {number}", Self::EXPECTED))
    }
    fn from_text(text: &str) -> Checked<Self> {
        Number::from_text(text).and_then(|Number(number)| Self::from_number(number))
    }
}

written! {
    Strength: { "type": "number", "minimum": 0 }
}

impl EnvironmentKeys {
    /// The environment as plain data; its picture is opened by `pictures`.
    pub(super) fn describe(
        self,
        lighting: &Lighting<'_>,
        pictures: &mut Pictures<'_>,
        up: UpAxis,
    ) -> Result<EnvironmentDescription> {
        let (sky, factor, angle, visible) = match self {
            Self::Uniform(At { value, .. }) => {
                let radiance = lighting.channels(&value.radiance, value.color)?;
                (Sky::Uniform, radiance, None, value.visible)
            }
            Self::Gradient(At { value, .. }) => {
                let nadir = value.nadir.map_or(Rgb::ZERO, |Color(color)| color);
                let (zenith, horizon) = (value.zenith.0, value.horizon.0);
                let sky = Sky::Gradient { zenith, horizon, nadir };
                (sky, factor(value.strength, None), None, value.visible)
            }
            Self::Image(At { value, .. }) => {
                let image = pictures.open(&value.file)?;
                let pixels = Arc::clone(&pictures.images[image]);
                let sky = Sky::Picture { pixels, sampling: value.sampling };
                (sky, factor(value.strength, value.color), value.rotation, value.visible)
            }
        };
        let turn = DQuat::from_rotation_z(angle.map_or(0.0, |Angle(angle)| angle));
        let rotation = DQuat::from_mat3(&upright(UpAxis::Z, up).matrix3) * turn;
        Ok(EnvironmentDescription { sky, factor, rotation, visible: visible.unwrap_or(true) })
    }
}

fn factor(strength: Option<Strength>, color: Option<Color>) -> Rgb {
    color.map_or(Rgb::ONE, |Color(color)| color) * strength.map_or(1.0, |Strength(factor)| factor)
}

/// How light is gathered: by name, or a table with settings.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct IntegratorKeys(pub(super) Integrator);

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct IntegratorTable {
    /// Every way light can take.
    path: PathKeys,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct PathKeys {
    /// How many surfaces may reflect light at most. Default: as many as it takes.
    bounces: Option<u32>,
}

const INTEGRATORS: [&str; 2] = ["direct", "path"];

impl<'de> Deserialize<'de> for IntegratorKeys {
    fn deserialize<D: Deserializer<'de>>(source: D) -> std::result::Result<Self, D::Error> {
        source.deserialize_any(IntegratorVisitor)
    }
}

struct IntegratorVisitor;

impl<'de> Visitor<'de> for IntegratorVisitor {
    type Value = IntegratorKeys;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("\"direct\", \"path\" or { path = { bounces = 8 } }")
    }

    fn visit_str<E: Error>(self, name: &str) -> std::result::Result<IntegratorKeys, E> {
        match name {
            "direct" => Ok(IntegratorKeys(Integrator::Direct)),
            "path" => Ok(IntegratorKeys(Integrator::Path { bounces: None })),
            _ => Err(E::unknown_variant(name, &INTEGRATORS)),
        }
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> std::result::Result<IntegratorKeys, A::Error> {
        let IntegratorTable { path } =
            IntegratorTable::deserialize(MapAccessDeserializer::new(map))?;
        Ok(IntegratorKeys(Integrator::Path { bounces: path.bounces }))
    }
}

impl JsonSchema for IntegratorKeys {
    fn schema_name() -> Cow<'static, str> {
        "Integrator".into()
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let table = generator.subschema_for::<IntegratorTable>();
        json_schema!({ "anyOf": [{ "enum": INTEGRATORS }, table] })
    }
}
