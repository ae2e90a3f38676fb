//! `[environment.type]` and `integrator`: light from far away, and how light is gathered.

use super::color::{Color, Reflectance};
use super::document::{At, Document, Span};
use super::light::{Amount, Irradiance, Lighting, Radiance, angular_radius};
use super::pictures::Pictures;
use super::sun::SunPlaceKeys;
use crate::color::Rgb;
use crate::diagnostic::{Diagnostic, Result};
use crate::io::Warnings;
use crate::io::model::{UpAxis, upright};
use crate::scene::description::{
    EnvironmentDescription, Integrator, Light, LightDescription, Pixels, Sampling, Sky,
};
use crate::shading::light::environment::{TURBIDITIES, sunlight};
use crate::units::written::{Angle, Checked, Number, Size, Written, written};
use glam::{DQuat, DVec3};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde::de::{Deserializer, Error, MapAccess, Visitor, value::MapAccessDeserializer};
use std::borrow::Cow;
use std::f64::consts::PI;
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
    /// A clear or hazy sky with its sun.
    Sky(At<SkyKeys>),
    /// One of the CIE's general skies (ISO 15469).
    Cie(At<CieKeys>),
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

/// A clear or hazy sky with its sun (Preetham, Shirley, Smits 1999).
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct SkyKeys {
    /// Where the sun stands. Default: 45 degrees high in the south.
    sun: Option<At<SunPlaceKeys>>,
    /// How hazy, 1.7 to 10: 2 is clear, 6 hazy. Default 3.
    turbidity: Option<At<Number>>,
    /// Whether the sun itself shines too. Default true.
    sunlight: Option<bool>,
    /// Fraction of light that the ground below the horizon reflects. Default 0.2.
    ground: Option<Reflectance>,
    /// Anticlockwise turn, seen from above. Default 0.
    rotation: Option<Angle>,
    /// Multiplies sky and sun. Default 1.
    strength: Option<Strength>,
    /// Whether the camera sees it, or the background. Default true.
    visible: Option<bool>,
}

/// One of the CIE's general skies: exactly one of `zenith_radiance` and `horizontal_irradiance`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct CieKeys {
    /// Which of them: 1 to 6 overcast to partly cloudy, 7 to 11 partly cloudy, 12 to 15 clear; 5 is uniform.
    #[serde(rename = "type")]
    #[schemars(range(min = 1, max = 15))]
    number: At<u8>,
    /// What comes from straight above: W/(sr m²) or nit.
    zenith_radiance: Option<At<Amount<Radiance>>>,
    /// What falls on the ground from the sky without the sun: W/m² or lx.
    horizontal_irradiance: Option<At<Amount<Irradiance>>>,
    /// Where the sun stands. Default: 45 degrees high in the south.
    sun: Option<At<SunPlaceKeys>>,
    /// What falls from the sun itself on a surface that faces it: W/m² or lx. Default 0.
    sunlight: Option<At<Amount<Irradiance>>>,
    /// Its colour. Default white.
    color: Option<Color>,
    /// Fraction of light that the ground below the horizon reflects. Default 0.2.
    ground: Option<Reflectance>,
    /// Anticlockwise turn, seen from above. Default 0.
    rotation: Option<Angle>,
    /// Whether the camera sees it, or the background. Default true.
    visible: Option<bool>,
}

/// A factor of 0 or more.
#[derive(Debug, Clone, Copy)]
pub(super) struct Strength(pub(super) f32);

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

/// An environment on its way into a scene, with its sun if it has one.
pub(super) struct NewEnvironment {
    pub(super) sky: EnvironmentDescription,
    pub(super) sun: Option<LightDescription>,
}

/// What an environment needs to know of the scene.
pub(super) struct Surroundings<'a, 'b> {
    pub(super) lighting: &'a Lighting<'a>,
    pub(super) pictures: &'a mut Pictures<'b>,
    pub(super) up: UpAxis,
    pub(super) warnings: &'a mut Warnings,
}

impl EnvironmentKeys {
    /// The environment as plain data.
    pub(super) fn describe(self, around: &mut Surroundings<'_, '_>) -> Result<NewEnvironment> {
        let lighting = around.lighting;
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
                let image = around.pictures.open(&value.file)?;
                let pixels = Arc::clone(&around.pictures.images[image]);
                around.warnings.extend(misshapen(&pixels, &value.file.span, lighting.document));
                let sky = Sky::Picture { pixels, sampling: value.sampling };
                (sky, factor(value.strength, value.color), value.rotation, value.visible)
            }
            Self::Sky(At { span, value }) => return value.describe(&span, around),
            Self::Cie(At { span, value }) => return value.describe(&span, around),
        };
        let (rotation, visible) = (turned(angle, around.up), visible.unwrap_or(true));
        let sky = EnvironmentDescription { sky, factor, rotation, visible };
        Ok(NewEnvironment { sky, sun: None })
    }
}

/// A word about a picture that shows no whole sky: 360° times 180° are twice as wide as high.
fn misshapen(pixels: &Pixels, file: &Span, document: &Document<'_>) -> Option<Diagnostic> {
    let Pixels { width, height, .. } = *pixels;
    let is_lat_long = width.abs_diff(2 * height) <= 1;
    (!is_lat_long && [width, height] != [1, 1]).then(|| {
        let message = format!(
            "names a picture of {width} × {height} pixels; all directions are twice as wide as high"
        );
        let help = "use a lat-long (equirectangular) picture: a photograph or a cube's faces are stretched";
        document.error(file, message).help(help)
    })
}

/// From the sky's own space (x east, y north, z up) to the world.
fn turned(angle: Option<Angle>, up: UpAxis) -> DQuat {
    let turn = DQuat::from_rotation_z(angle.map_or(0.0, |Angle(angle)| angle));
    DQuat::from_mat3(&upright(UpAxis::Z, up).matrix3) * turn
}

/// The sun of a sky.
struct SkySun {
    /// Unit vector to it in the sky's own space; on the horizon if it has set.
    toward: DVec3,
    angular_radius: f64,
    has_set: bool,
}

impl SkySun {
    fn new(
        keys: Option<At<SunPlaceKeys>>,
        rotation: DQuat,
        document: &Document<'_>,
        warnings: &mut Warnings,
    ) -> Result<Self> {
        let At { span, value: keys } =
            keys.unwrap_or(At { span: Span::default(), value: SunPlaceKeys::default() });
        let toward = keys.toward(&span, document, rotation)?;
        let has_set = toward.z <= 0.0;
        if has_set {
            let below = -toward.z.asin().to_degrees();
            let message = format!("has set, it is {below:.1}° below the horizon");
            let help = "the sky is shown as at sunset, without the sun";
            warnings.push(document.error(&span, message).help(help));
        }
        let toward = if has_set { toward.with_z(0.0).normalize_or(DVec3::Y) } else { toward };
        let angular_radius = angular_radius(keys.angular_size.as_ref(), document)?;
        Ok(Self { toward, angular_radius, has_set })
    }

    /// The light that it is, if it shines: `irradiance` on what faces it.
    fn light(&self, irradiance: Rgb, rotation: DQuat) -> Option<LightDescription> {
        let shines = !self.has_set && irradiance != Rgb::ZERO;
        let (direction, angular_radius) = (-(rotation * self.toward), self.angular_radius);
        let light = Light::Sun { direction, irradiance, angular_radius };
        shines.then(|| LightDescription::new("environment/sun", light))
    }

    /// What a ground of this reflectance sends back of light from sky and sun.
    fn reflected(&self, ground: Option<Reflectance>, sky: DVec3, sun: DVec3) -> Rgb {
        let reflectance = ground.map_or(Rgb::splat(0.2), |ground| ground.rgb());
        let irradiance = sky + if self.has_set { DVec3::ZERO } else { sun * self.toward.z };
        reflectance * (irradiance / PI).as_vec3()
    }
}

impl SkyKeys {
    fn describe(
        self,
        keys: &Span,
        Surroundings { lighting, up, warnings, .. }: &mut Surroundings<'_, '_>,
    ) -> Result<NewEnvironment> {
        let document = lighting.document;
        let rotation = turned(self.rotation, *up);
        let sun = SkySun::new(self.sun, rotation, document, warnings)?;
        let turbidity = self.turbidity.as_ref().map_or(3.0, |at| at.value.0);
        let [clearest, haziest] = TURBIDITIES;
        if !(clearest..=haziest).contains(&turbidity) {
            let span = self.turbidity.as_ref().map_or(keys, |at| &at.span);
            let message = format!("must be from {clearest} to {haziest}, not {turbidity}");
            return Err(document.error(span, message));
        }
        let sky = |ground| Sky::Clear { turbidity, sun: sun.toward, ground };
        let from_sky = sky(Rgb::ZERO).horizontal_irradiance();
        let from_sun = match self.sunlight {
            Some(false) => DVec3::ZERO,
            _ => sunlight(turbidity, sun.toward),
        };
        let sky = sky(sun.reflected(self.ground, from_sky, from_sun));
        let factor = factor(self.strength, None) / lighting.efficacy as f32;
        let visible = self.visible.unwrap_or(true);
        let sun = sun.light(factor * from_sun.as_vec3(), rotation);
        Ok(NewEnvironment { sky: EnvironmentDescription { sky, factor, rotation, visible }, sun })
    }
}

impl CieKeys {
    fn describe(
        self,
        keys: &Span,
        Surroundings { lighting, up, warnings, .. }: &mut Surroundings<'_, '_>,
    ) -> Result<NewEnvironment> {
        let At { span, value: number } = self.number;
        if !(1..=15).contains(&number) {
            return Err(lighting
                .document
                .error(&span, format!("must be from 1 to 15, not {number}")));
        }
        let rotation = turned(self.rotation, *up);
        let sun = SkySun::new(self.sun, rotation, lighting.document, warnings)?;
        let sky = |ground| Sky::Cie { number, sun: sun.toward, ground };
        let from_sky = sky(Rgb::ZERO).horizontal_irradiance();
        let factor = match (&self.zenith_radiance, &self.horizontal_irradiance) {
            (Some(zenith), None) => lighting.channels(zenith, self.color)?,
            (None, Some(ground)) => lighting.channels(ground, self.color)? / from_sky.as_vec3(),
            (_, second) => {
                return Err(lighting.one_of_two(
                    "zenith_radiance (W/(sr m²), nit) or horizontal_irradiance (W/m², lx)",
                    second.as_ref().map(|at| &at.span),
                    keys,
                ));
            }
        };
        let from_sun = self.sunlight.map(|amount| lighting.channels(&amount, None)).transpose()?;
        let from_sun = from_sun.unwrap_or_default();
        // In units of the zenith's radiance, as the sky is.
        let relative = Rgb::select(factor.cmpgt(Rgb::ZERO), from_sun / factor, Rgb::ZERO);
        let sky = sky(sun.reflected(self.ground, from_sky, relative.as_dvec3()));
        let visible = self.visible.unwrap_or(true);
        let sun = sun.light(from_sun, rotation);
        Ok(NewEnvironment { sky: EnvironmentDescription { sky, factor, rotation, visible }, sun })
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
    path: Option<PathKeys>,
    /// How much of the sky each point sees.
    ambient_occlusion: Option<OcclusionKeys>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct PathKeys {
    /// How many surfaces may reflect light at most. Default: as many as it takes.
    bounces: Option<u32>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct OcclusionKeys {
    /// Surfaces further away than this do not count, m. Default: all do.
    distance: Option<Size>,
}

const INTEGRATORS: [&str; 3] = ["direct", "path", "ambient_occlusion"];

impl<'de> Deserialize<'de> for IntegratorKeys {
    fn deserialize<D: Deserializer<'de>>(source: D) -> std::result::Result<Self, D::Error> {
        source.deserialize_any(IntegratorVisitor)
    }
}

fn occlusion(distance: Option<Size>) -> IntegratorKeys {
    let distance = distance.map_or(f64::INFINITY, |Size(distance)| distance);
    IntegratorKeys(Integrator::AmbientOcclusion { distance })
}

struct IntegratorVisitor;

impl<'de> Visitor<'de> for IntegratorVisitor {
    type Value = IntegratorKeys;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("\"direct\", \"path\", \"ambient_occlusion\" or { path = { bounces = 8 } }")
    }

    fn visit_str<E: Error>(self, name: &str) -> std::result::Result<IntegratorKeys, E> {
        match name {
            "direct" => Ok(IntegratorKeys(Integrator::Direct)),
            "path" => Ok(IntegratorKeys(Integrator::Path { bounces: None })),
            "ambient_occlusion" => Ok(occlusion(None)),
            _ => Err(E::unknown_variant(name, &INTEGRATORS)),
        }
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> std::result::Result<IntegratorKeys, A::Error> {
        let table = IntegratorTable::deserialize(MapAccessDeserializer::new(map))?;
        match (table.path, table.ambient_occlusion) {
            (Some(PathKeys { bounces }), None) => Ok(IntegratorKeys(Integrator::Path { bounces })),
            (None, Some(OcclusionKeys { distance })) => Ok(occlusion(distance)),
            _ => Err(A::Error::custom("needs exactly one of path, ambient_occlusion")),
        }
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
