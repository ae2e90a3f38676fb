//! `[lights.name.kind]`: lights, their quantities and what colour means for them.

use super::color::Color;
use super::document::{At, Document, Span};
use super::luminaire::{Luminaires, PhotometricKeys};
use crate::color::{Rgb, luminance};
use crate::diagnostic::{Diagnostic, Result};
use crate::io::model::UpAxis;
use crate::scene::description::{CameraLightAmount, Light, LightDescription, SpotFalloff};
use crate::units::written::{
    Angle, Checked, Direction, Point, Size, WITH_UNIT, Written, WrittenVisitor, quantity, units_of,
};
use crate::units::{self, Dimension, Measure};
use glam::DVec3;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde::de::Deserializer;
use std::borrow::Cow;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};
use std::marker::PhantomData;

/// A light of one kind.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(super) enum LightKeys {
    /// A point that shines everywhere alike.
    Point(At<PointKeys>),
    /// A point that shines into a cone.
    Spot(At<SpotKeys>),
    /// A luminaire as it was measured.
    Photometric(At<PhotometricKeys>),
    /// Parallel light from far away, such as the sun's.
    Directional(At<DirectionalKeys>),
    /// A round light infinitely far away, with soft shadows.
    Sun(At<SunKeys>),
    /// Constant light from everywhere, without shadows.
    Ambient(At<AmbientKeys>),
    /// A light at the camera, without visible shadows.
    Camera(At<CameraLightKeys>),
}

/// A point light: exactly one of `power` and `intensity`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct PointKeys {
    /// Where it is, m.
    position: Point,
    /// All that it gives: W or lm.
    power: Option<At<Amount<Power>>>,
    /// What it gives per direction: W/sr or cd.
    intensity: Option<At<Amount<Intensity>>>,
    /// Radius of a sphere that shines in its place, m: its shadows become soft. Default: it is a point.
    radius: Option<Size>,
    /// Its colour. Default white.
    color: Option<Color>,
    /// Whether surfaces in between cast shadows. Default true.
    shadows: Option<bool>,
}

/// A spot light: exactly one of `target` and `direction`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct SpotKeys {
    /// Where it is, m.
    position: Point,
    /// The point it shines at, m.
    target: Option<At<Point>>,
    /// The direction it shines in.
    direction: Option<At<Direction>>,
    /// What it gives along its axis: W/sr or cd.
    intensity: At<Amount<Intensity>>,
    /// Half angle up to which it is bright; less than `outer_angle`. Default 0.
    inner_angle: Option<At<Angle>>,
    /// Half angle from which on it is dark, at most 90 degrees. Default 45.
    outer_angle: Option<At<Angle>>,
    /// How the light falls from the inner to the outer angle. Default "gltf".
    falloff: Option<SpotFalloff>,
    /// Radius of a sphere that shines in its place, m: its shadows become soft. Default: it is a point.
    radius: Option<Size>,
    /// Its colour. Default white.
    color: Option<Color>,
    /// Whether surfaces in between cast shadows. Default true.
    shadows: Option<bool>,
}

/// Parallel light.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct DirectionalKeys {
    /// The direction in which the light travels.
    direction: Direction,
    /// What falls on a surface that faces it: W/m² or lx.
    irradiance: At<Amount<Irradiance>>,
    /// Its colour. Default white.
    color: Option<Color>,
    /// Whether surfaces in between cast shadows. Default true.
    shadows: Option<bool>,
}

/// A round light infinitely far away.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct SunKeys {
    /// The direction in which the light travels.
    direction: Direction,
    /// What falls on a surface that faces it: W/m² or lx.
    irradiance: At<Amount<Irradiance>>,
    /// Angle across it, more than 0 and at most 180 degrees. Default 0.533, as the sun's.
    angular_size: Option<At<Angle>>,
    /// Its colour. Default white.
    color: Option<Color>,
    /// Whether surfaces in between cast shadows. Default true.
    shadows: Option<bool>,
}

/// Constant ambient light.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct AmbientKeys {
    /// What comes from every direction: W/(sr m²) or nit.
    radiance: At<Amount<Radiance>>,
    /// Its colour. Default white.
    color: Option<Color>,
    /// Surfaces nearer than this keep it out, m. Default: none does.
    reach: Option<Size>,
}

/// A light at the camera: exactly one of `irradiance`, `intensity` and `power`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct CameraLightKeys {
    /// What falls on a surface that faces the camera, at any distance: W/m² or lx.
    irradiance: Option<At<Amount<Irradiance>>>,
    /// What a point light at the camera gives per direction: W/sr or cd.
    intensity: Option<At<Amount<Intensity>>>,
    /// All that a point light at the camera gives: W or lm.
    power: Option<At<Amount<Power>>>,
    /// Its colour. Default white.
    color: Option<Color>,
}

/// What a surface emits: exactly one of `power`, `exitance` and `radiance`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct SurfaceLightKeys {
    /// All that it gives: W or lm.
    power: Option<At<Amount<Power>>>,
    /// What it gives per area of one side: W/m² or lm/m².
    exitance: Option<At<Amount<Irradiance>>>,
    /// What it gives per area and direction: W/(sr m²) or nit.
    radiance: Option<At<Amount<Radiance>>>,
    /// Its colour. Default white.
    color: Option<Color>,
    /// Whether its back gives the same as its front. Default false.
    pub(super) two_sided: Option<bool>,
    /// Whether the camera sees it. Default true.
    pub(super) visible: Option<bool>,
}

/// A dimension as a type, so that a key accepts only its own units.
pub(super) trait Dimensioned {
    const DIMENSION: Dimension;
    const EXPECTED: &'static str;
    const EXAMPLES: [&'static str; 2];
}

macro_rules! dimensions {
    ($($name:ident: $expected:literal, $examples:expr;)*) => {$(
        #[derive(Debug)]
        pub(super) struct $name;
        impl Dimensioned for $name {
            const DIMENSION: Dimension = Dimension::$name;
            const EXPECTED: &'static str = $expected;
            const EXAMPLES: [&'static str; 2] = $examples;
        }
    )*};
}

dimensions! {
    Power: "a power such as 60 (W), \"60 W\", \"800 lm\" or [60, 50, 40]", ["60 W", "800 lm"];
    Intensity: "an intensity such as 5 (W/sr), \"1200 cd\" or [5, 4, 3]", ["5 W/sr", "1200 cd"];
    Irradiance: "an irradiance such as 3 (W/m²), \"10 klx\" or [3, 2, 1]", ["3 W/m²", "10 klx"];
    Radiance: "a radiance such as 0.1 (W/(sr m²)), \"20 nit\" or [0.1, 0.2, 0.3]", ["0.1 W/(sr m²)", "20 nit"];
}

/// How much light, before its colour.
#[derive(Debug)]
pub(super) enum Amount<D> {
    /// SI units of energy, per channel.
    Energy(DVec3),
    /// SI units of light as seen, all channels together.
    Seen(f64, PhantomData<D>),
}

impl<D: Dimensioned> Written for Amount<D> {
    const EXPECTED: &'static str = D::EXPECTED;

    fn from_number(number: f64) -> Checked<Self> {
        Self::from_triple([number; 3])
    }

    fn from_text(text: &str) -> Checked<Self> {
        let quantity = quantity(text, D::DIMENSION)?;
        match quantity.measure {
            Measure::Radiometric => Self::from_number(quantity.value),
            Measure::Photometric => {
                Self::from_number(quantity.value).map(|_| Self::Seen(quantity.value, PhantomData))
            }
        }
    }

    fn from_triple(channels: [f64; 3]) -> Checked<Self> {
        match channels.iter().find(|channel| **channel < 0.0) {
            Some(negative) => {
                Err(format!("must not be negative: light is never less than none, not {negative}"))
            }
            None => Ok(Self::Energy(channels.into())),
        }
    }
}

impl<'de, D: Dimensioned> Deserialize<'de> for Amount<D> {
    fn deserialize<S: Deserializer<'de>>(source: S) -> std::result::Result<Self, S::Error> {
        source.deserialize_any(WrittenVisitor(PhantomData))
    }
}

impl<D: Dimensioned> JsonSchema for Amount<D> {
    fn schema_name() -> Cow<'static, str> {
        format!("{:?}", D::DIMENSION).into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "description": format!("A number or list of three (SI), or text in {}", units_of(D::DIMENSION)),
            "anyOf": [
                { "type": "number", "minimum": 0 },
                { "type": "string", "pattern": WITH_UNIT },
                { "type": "array", "items": { "type": "number", "minimum": 0 }, "minItems": 3, "maxItems": 3 }
            ],
            "examples": D::EXAMPLES
        })
    }
}

impl<D: Dimensioned> Amount<D> {
    /// As it was written, in SI units.
    fn written(&self) -> String {
        let unit = |measure| units::unit(D::DIMENSION, measure);
        match self {
            Self::Seen(value, _) => units::format(*value, unit(Measure::Photometric)),
            Self::Energy(v) if v.x == v.y && v.y == v.z => {
                units::format(v.x, unit(Measure::Radiometric))
            }
            Self::Energy(v) => {
                format!("[{}, {}, {}] {}", v.x, v.y, v.z, unit(Measure::Radiometric))
            }
        }
    }
}

impl LightKeys {
    /// The light's quantity as it was written.
    fn written(&self, document: &Document<'_>) -> String {
        let first = |options: [Option<String>; 3]| options.into_iter().flatten().next();
        let written = match self {
            Self::Point(At { value: v, .. }) => first([
                text(v.power.as_ref(), document),
                text(v.intensity.as_ref(), document),
                None,
            ]),
            Self::Spot(At { value, .. }) => text(Some(&value.intensity), document),
            Self::Photometric(At { value, .. }) => {
                first([text(value.power.as_ref(), document), Some("as measured".into()), None])
            }
            Self::Directional(At { value, .. }) => text(Some(&value.irradiance), document),
            Self::Sun(At { value, .. }) => text(Some(&value.irradiance), document),
            Self::Ambient(At { value, .. }) => text(Some(&value.radiance), document),
            Self::Camera(At { value: v, .. }) => first([
                text(v.irradiance.as_ref(), document),
                text(v.intensity.as_ref(), document),
                text(v.power.as_ref(), document),
            ]),
        };
        written.unwrap_or_default()
    }
}

impl SurfaceLightKeys {
    /// The light's quantity as it was written.
    pub(super) fn written(&self, document: &Document<'_>) -> String {
        let power = text(self.power.as_ref(), document);
        let exitance = || text(self.exitance.as_ref(), document);
        let radiance = || text(self.radiance.as_ref(), document);
        power.or_else(exitance).or_else(radiance).unwrap_or_default()
    }
}

/// An amount in the author's own words; a bare number with its unit.
fn text<D: Dimensioned>(amount: Option<&At<Amount<D>>>, document: &Document<'_>) -> Option<String> {
    let At { span, value } = amount?;
    Some(document.quoted_text(span).map_or_else(|| value.written(), str::to_owned))
}

/// What turns written amounts into radiometric channels.
pub(super) struct Lighting<'a> {
    pub(super) document: &'a Document<'a>,
    /// Lumens per watt.
    pub(super) efficacy: f64,
    pub(super) up: UpAxis,
}

impl Lighting<'_> {
    /// The light as plain data; measured luminaires are opened by `luminaires`.
    pub(super) fn describe(
        &self,
        name: &str,
        keys: LightKeys,
        luminaires: &mut Luminaires<'_>,
    ) -> Result<LightDescription> {
        let written = keys.written(self.document);
        let (light, shadows, radius) = match keys {
            LightKeys::Point(At { span, value }) => {
                let (shadows, radius) = (value.shadows, value.radius);
                (self.point(value, &span)?, shadows, radius)
            }
            LightKeys::Spot(At { span, value }) => {
                let (shadows, radius) = (value.shadows, value.radius);
                (self.spot(value, &span)?, shadows, radius)
            }
            LightKeys::Photometric(At { value, .. }) => {
                let (shadows, radius) = (value.shadows, value.radius);
                (self.photometric(value, luminaires)?, shadows, radius)
            }
            LightKeys::Directional(At { value, .. }) => {
                let irradiance = self.channels(&value.irradiance, value.color)?;
                let light = Light::Directional { direction: value.direction.0, irradiance };
                (light, value.shadows, None)
            }
            LightKeys::Sun(At { value, .. }) => {
                let shadows = value.shadows;
                (self.sun(value)?, shadows, None)
            }
            LightKeys::Ambient(At { value, .. }) => {
                let radiance = self.channels(&value.radiance, value.color)?;
                let reach = value.reach.map_or(f64::INFINITY, |Size(reach)| reach);
                (Light::Ambient { radiance, reach }, Some(false), None)
            }
            LightKeys::Camera(At { span, value }) => {
                (Light::Camera { amount: self.camera_light(value, &span)? }, Some(false), None)
            }
        };
        let (shadows, radius) = (shadows.unwrap_or(true), radius.map_or(0.0, |Size(r)| r));
        Ok(LightDescription { name: name.into(), light, shadows, radius, written })
    }

    fn point(&self, keys: PointKeys, light: &Span) -> Result<Light> {
        let intensity = match (&keys.power, &keys.intensity) {
            (Some(power), None) => self.channels(power, keys.color)? / (4.0 * PI) as f32,
            (None, Some(intensity)) => self.channels(intensity, keys.color)?,
            (Some(_), Some(second)) => return Err(self.one_of("power or intensity", &second.span)),
            (None, None) => {
                return Err(self.none_of("power (W, lm) or intensity (W/sr, cd)", light));
            }
        };
        Ok(Light::Point { position: keys.position.0, intensity })
    }

    fn sun(&self, keys: SunKeys) -> Result<Light> {
        let angular_radius = angular_radius(keys.angular_size.as_ref(), self.document)?;
        let irradiance = self.channels(&keys.irradiance, keys.color)?;
        Ok(Light::Sun { direction: keys.direction.0, irradiance, angular_radius })
    }

    /// Radiance of a surface of `area` (m², one side) that emits; `None`: its area is not known.
    pub(super) fn surface(
        &self,
        keys: &SurfaceLightKeys,
        light: &Span,
        area: Option<f64>,
    ) -> Result<Rgb> {
        let sides = if keys.two_sided.unwrap_or(false) { 2.0 } else { 1.0 };
        match (&keys.power, &keys.exitance, &keys.radiance) {
            (Some(power), None, None) => {
                let area = area.ok_or_else(|| {
                    let message =
                        "needs a radiance or exitance: this shape has no area to divide by";
                    self.document.error(&power.span, message)
                })?;
                Ok((self.channels(power, keys.color)?.as_dvec3() / (PI * sides * area)).as_vec3())
            }
            (None, Some(exitance), None) => Ok(self.channels(exitance, keys.color)? / PI as f32),
            (None, None, Some(radiance)) => self.channels(radiance, keys.color),
            (None, None, None) => Err(self
                .none_of("power (W, lm), exitance (W/m², lx) or radiance (W/(sr m²), nit)", light)),
            (_, Some(At { span, .. }), _) | (_, _, Some(At { span, .. })) => {
                Err(self.one_of("power, exitance or radiance", span))
            }
        }
    }

    fn spot(&self, keys: SpotKeys, light: &Span) -> Result<Light> {
        let Point(position) = keys.position;
        let aim = self.aim(position, keys.target.as_ref(), keys.direction.as_ref())?;
        let direction = aim.ok_or_else(|| self.none_of("target or direction", light))?;
        let (inner_angle, outer_angle) = self.cone(keys.inner_angle, keys.outer_angle)?;
        Ok(Light::Spot {
            position,
            direction,
            intensity: self.channels(&keys.intensity, keys.color)?,
            inner_angle,
            outer_angle,
            falloff: keys.falloff.unwrap_or_default(),
        })
    }

    /// Unit vector from a position to a target, or the direction; `None` if neither is given.
    pub(super) fn aim(
        &self,
        position: DVec3,
        target: Option<&At<Point>>,
        direction: Option<&At<Direction>>,
    ) -> Result<Option<DVec3>> {
        match (target, direction) {
            (Some(target), None) => {
                let toward = (target.value.0 - position).try_normalize();
                let same = || self.document.error(&target.span, "must differ from position");
                toward.ok_or_else(same).map(Some)
            }
            (None, direction) => Ok(direction.map(|direction| direction.value.0)),
            (Some(_), Some(second)) => Err(self.one_of("target or direction", &second.span)),
        }
    }

    /// 0 ≤ inner < outer ≤ 90°.
    fn cone(&self, inner: Option<At<Angle>>, outer: Option<At<Angle>>) -> Result<(f64, f64)> {
        let outer_angle = outer.as_ref().map_or(FRAC_PI_4, |at| at.value.0);
        let inner_angle = inner.as_ref().map_or(0.0, |at| at.value.0);
        // A hair of slack for 90 degrees written in radians.
        if let Some(outer) = &outer
            && !(outer_angle > 0.0 && outer_angle <= FRAC_PI_2 + 1e-6)
        {
            return Err(self.document.error(&outer.span, "must be more than 0° and at most 90°"));
        }
        if inner_angle < 0.0 || inner_angle >= outer_angle {
            let span = inner.or(outer).map(|at| at.span).unwrap_or_default();
            let degrees = outer_angle.to_degrees();
            let message = format!("must be at least 0° and less than the outer angle, {degrees}°");
            return Err(self.document.error(&span, message));
        }
        Ok((inner_angle, outer_angle.min(FRAC_PI_2)))
    }

    fn camera_light(&self, keys: CameraLightKeys, light: &Span) -> Result<CameraLightAmount> {
        let CameraLightKeys { irradiance, intensity, power, color } = keys;
        let choice = "irradiance (W/m², lx), intensity (W/sr, cd) or power (W, lm)";
        match (&irradiance, &intensity, &power) {
            (Some(amount), None, None) => {
                Ok(CameraLightAmount::Irradiance(self.channels(amount, color)?))
            }
            (None, Some(amount), None) => {
                Ok(CameraLightAmount::Intensity(self.channels(amount, color)?))
            }
            (None, None, Some(amount)) => {
                let power = self.channels(amount, color)?;
                Ok(CameraLightAmount::Intensity(power / (4.0 * PI) as f32))
            }
            (None, None, None) => Err(self.none_of(choice, light)),
            (_, Some(At { span, .. }), _) | (_, _, Some(At { span, .. })) => {
                Err(self.one_of("irradiance, intensity or power", span))
            }
        }
    }

    /// Radiometric channels. Colour multiplies energy; of light as seen it gives only the chromaticity.
    pub(super) fn channels<D>(&self, amount: &At<Amount<D>>, color: Option<Color>) -> Result<Rgb> {
        let color = color.map_or(Rgb::ONE, |Color(color)| color);
        let scale = match amount.value {
            Amount::Energy(channels) => channels,
            Amount::Seen(value, _) => {
                let seen = f64::from(luminance(color)) * self.efficacy;
                if seen <= 0.0 {
                    let message = "cannot be reached by black light; give it another color";
                    return Err(self.document.error(&amount.span, message));
                }
                DVec3::splat(value / seen)
            }
        };
        let channels = (color.as_dvec3() * scale).as_vec3();
        let overflow = || self.document.error(&amount.span, "is too bright to be a number");
        channels.is_finite().then_some(channels).ok_or_else(overflow)
    }

    /// The complaint that not exactly one of two was given: both, if the `second` has a place.
    pub(super) fn one_of_two(
        &self,
        choice: &str,
        second: Option<&Span>,
        keys: &Span,
    ) -> Box<Diagnostic> {
        second.map_or_else(|| self.none_of(choice, keys), |span| self.one_of(choice, span))
    }

    fn one_of(&self, choice: &str, second: &Span) -> Box<Diagnostic> {
        self.document.error(second, format!("is one too many: give {choice}, not both"))
    }

    fn none_of(&self, choice: &str, light: &Span) -> Box<Diagnostic> {
        self.document.error(light, format!("needs {choice}"))
    }
}

/// Half of the angle across a sun, rad; of ours if none is given.
pub(super) fn angular_radius(size: Option<&At<Angle>>, document: &Document<'_>) -> Result<f64> {
    const OURS: f64 = 0.533;
    let Some(At { span, value: Angle(size) }) = size else { return Ok(0.5 * OURS.to_radians()) };
    if *size > 1e-6 && *size <= PI + 1e-6 {
        return Ok((0.5 * size).min(FRAC_PI_2));
    }
    Err(document.error(span, "must be more than 0° and at most 180°"))
}
