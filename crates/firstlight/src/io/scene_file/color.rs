//! Colours and textures as they are written.

use super::document::At;
use super::film::Fraction;
use crate::color::{self, Rgb};
use crate::scene::description::{Sampling, Wrap};
use crate::units::written::{
    Angle, Checked, Number, Pair, Size, Written, WrittenVisitor, list, written,
};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Deserializer, Error, IntoDeserializer, MapAccess, SeqAccess, Visitor};
use std::borrow::Cow;
use std::fmt;
use std::marker::PhantomData;

/// A colour without an upper bound: of light, of a background.
#[derive(Debug, Clone, Copy)]
pub(super) struct Color(pub(super) Rgb);

impl Written for Color {
    const EXPECTED: &'static str =
        "a colour such as \"#c0392b\", \"tomato\", 0.5 or [0.5, 0.2, 0.1]";
    fn from_number(grey: f64) -> Checked<Self> {
        Self::from_triple([grey; 3])
    }
    fn from_text(text: &str) -> Checked<Self> {
        match color::parse(text)? {
            [r, g, b, 1.0] => Ok(Self(Rgb::new(r, g, b))),
            _ => Err("needs a colour without alpha".into()),
        }
    }
    fn from_triple(channels: [f64; 3]) -> Checked<Self> {
        let fits = |channel: &f64| *channel >= 0.0 && (*channel as f32).is_finite();
        match channels.iter().find(|channel| !fits(channel)) {
            Some(wrong) => Err(format!("needs colour channels of 0 or more, not {wrong}")),
            None => Ok(Self(Rgb::from_array(channels.map(|channel| channel as f32)))),
        }
    }
}

/// The fraction of light that a surface reflects, each channel 0..1, with alpha.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reflectance([f32; 4]);

impl Reflectance {
    /// Without alpha.
    pub(super) fn rgb(self) -> Rgb {
        Rgb::from_slice(&self.0)
    }
}

/// Numbers up to 255 as they are written in hex.
fn hex(codes: [f64; 3]) -> String {
    let digits = codes.map(|code| format!("{:02x}", code as u8));
    format!("#{}", digits.concat())
}

impl Written for Reflectance {
    const EXPECTED: &'static str = "a reflectance such as \"#c0392b\", \"tomato\", 0.5, [0.5, 0.2, 0.1] or { image = { file = \"wood.png\" } }";
    fn from_number(grey: f64) -> Checked<Self> {
        Self::from_triple([grey; 3])
    }
    fn from_text(text: &str) -> Checked<Self> {
        color::parse(text).map(Self)
    }
    fn from_triple(channels: [f64; 3]) -> Checked<Self> {
        if let Some(wrong) = channels.iter().find(|channel| !(0.0..=1.0).contains(*channel)) {
            let is_code = |x: &f64| (0.0..256.0).contains(x) && x.fract() == 0.0;
            let codes = match channels.iter().all(is_code) {
                true => format!(" (numbers up to 255 are written \"{}\")", hex(channels)),
                false => String::new(),
            };
            return Err(format!(
                "must be from 0 to 1, not {wrong}: no surface reflects more than it gets{codes}"
            ));
        }
        let [r, g, b] = channels.map(|channel| channel as f32);
        Ok(Self([r, g, b, 1.0]))
    }
}

written! {
    Color: {
        "description": "A CSS name or code (sRGB), a grey (linear) or a list of three (linear), 0 or more",
        "anyOf": [
            { "type": "string" },
            { "type": "number", "minimum": 0 },
            { "type": "array", "items": { "type": "number", "minimum": 0 }, "minItems": 3, "maxItems": 3 }
        ],
        "examples": ["#fff4e0", "tomato", 0.5, [1, 0.9, 0.8]]
    }
    Reflectance: {
        "description": "A CSS name or code (sRGB), a grey (linear) or a list of three (linear), each 0 to 1",
        "anyOf": [
            { "type": "string" },
            { "type": "number", "minimum": 0, "maximum": 1 },
            {
                "type": "array", "minItems": 3, "maxItems": 3,
                "items": { "type": "number", "minimum": 0, "maximum": 1 }
            }
        ],
        "examples": ["#c0392b", "tomato", 0.5, [0.5, 0.2, 0.1]]
    }
}

impl From<Color> for [f32; 4] {
    fn from(Color(color): Color) -> Self {
        color.extend(1.0).to_array()
    }
}

impl From<Reflectance> for [f32; 4] {
    fn from(Reflectance(rgba): Reflectance) -> Self {
        rgba
    }
}

impl From<Fraction> for [f32; 4] {
    fn from(Fraction(number): Fraction) -> Self {
        [number as f32; 4]
    }
}

/// A colour, a picture or a pattern.
#[derive(Debug)]
pub(super) enum TextureKeys<C> {
    Constant(C),
    Image(ImageKeys),
    Checker(CheckerKeys<C>),
    Gradient(GradientKeys<C>),
    Noise(NoiseKeys<C>),
}

/// A texture that is not one colour: exactly one of these.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct PatternKeys<C> {
    /// A picture.
    image: Option<ImageKeys>,
    /// Squares of two colours.
    checker: Option<CheckerKeys<C>>,
    /// From one colour to another.
    gradient: Option<GradientKeys<C>>,
    /// Clouds between two colours.
    noise: Option<NoiseKeys<C>>,
}

/// A picture over a surface.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ImageKeys {
    /// PNG, JPEG, WebP or HDR file, relative to the scene's folder.
    pub(super) file: At<String>,
    /// What it does outside 0..1, along both axes or [u, v]. Default "repeat".
    #[serde(default)]
    pub(super) wrap: OneOrTwo<Wrap>,
    /// How pixels are joined. Default "bilinear".
    #[serde(default)]
    pub(super) sampling: Sampling,
    /// How often it fits in 0..1, along both axes or [u, v]. Default 1.
    pub(super) scale: Option<OneOrTwo<Number>>,
    /// Shift of the texture coordinates [u, v], after scale and rotation. Default [0, 0].
    pub(super) offset: Option<Pair>,
    /// Anticlockwise turn of the texture coordinates, after the scale. Default 0.
    pub(super) rotate: Option<Angle>,
    /// For numbers: where in the picture they are. Default "r".
    pub(super) channel: Option<At<Channel>>,
}

/// One of the four numbers of a pixel.
#[derive(Debug, Clone, Copy, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(super) enum Channel {
    /// Red.
    R,
    /// Green.
    G,
    /// Blue.
    B,
    /// Alpha.
    A,
}

/// A checker board.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct CheckerKeys<C> {
    /// The two colours.
    pub(super) colors: Two<C>,
    /// Side of a square in texture coordinates (metres on a plane), along both axes or [u, v]. Default 1.
    pub(super) size: Option<OneOrTwo<Size>>,
}

/// From one colour to another along a line, and the same beyond its ends.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct GradientKeys<C> {
    /// The two colours.
    pub(super) colors: Two<C>,
    /// Texture coordinates [u, v] of the first. Default [0, 0].
    pub(super) from: Option<Pair>,
    /// Texture coordinates [u, v] of the second, elsewhere. Default [0, 1].
    pub(super) to: Option<At<Pair>>,
}

/// Clouds between two colours.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct NoiseKeys<C> {
    /// The two colours.
    pub(super) colors: Two<C>,
    /// Size of the largest clouds in texture coordinates (metres on a plane), along both axes or [u, v]. Default 1.
    pub(super) size: Option<OneOrTwo<Size>>,
    /// How many sizes of clouds there are, 1 to 16, each half of the one before. Default 4.
    pub(super) octaves: Option<At<u32>>,
}

/// Exactly two values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Two<T>(pub(super) [T; 2]);

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Two<T> {
    fn deserialize<D: Deserializer<'de>>(source: D) -> Result<Self, D::Error> {
        list(source).map(Self)
    }
}

impl<T: JsonSchema> JsonSchema for Two<T> {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        format!("Two{}", T::schema_name()).into()
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let item = generator.subschema_for::<T>();
        json_schema!({ "type": "array", "items": item, "minItems": 2, "maxItems": 2 })
    }
}

/// One value for both axes, or a list of two.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct OneOrTwo<T>(pub(super) [T; 2]);

impl<'de, T: Deserialize<'de> + Copy> Deserialize<'de> for OneOrTwo<T> {
    fn deserialize<D: Deserializer<'de>>(source: D) -> Result<Self, D::Error> {
        source.deserialize_any(OneOrTwoVisitor(PhantomData))
    }
}

struct OneOrTwoVisitor<T>(PhantomData<T>);

impl<'de, T: Deserialize<'de> + Copy> Visitor<'de> for OneOrTwoVisitor<T> {
    type Value = OneOrTwo<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("one value, or a list of two")
    }

    fn visit_f64<E: Error>(self, number: f64) -> Result<Self::Value, E> {
        T::deserialize(number.into_deserializer()).map(|one| OneOrTwo([one; 2]))
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<Self::Value, E> {
        T::deserialize(number.into_deserializer()).map(|one| OneOrTwo([one; 2]))
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Self::Value, E> {
        T::deserialize(text.into_deserializer()).map(|one| OneOrTwo([one; 2]))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, values: A) -> Result<Self::Value, A::Error> {
        list(SeqAccessDeserializer::new(values)).map(OneOrTwo)
    }
}

impl<T: JsonSchema> JsonSchema for OneOrTwo<T> {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        format!("OneOrTwo{}", T::schema_name()).into()
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let (one, two) = (generator.subschema_for::<T>(), generator.subschema_for::<Two<T>>());
        json_schema!({ "anyOf": [one, two] })
    }
}

impl<'de, C: Written + Deserialize<'de>> Deserialize<'de> for TextureKeys<C> {
    fn deserialize<D: Deserializer<'de>>(source: D) -> Result<Self, D::Error> {
        source.deserialize_any(TextureVisitor(WrittenVisitor(PhantomData)))
    }
}

/// Tables are patterns; all else is a colour.
struct TextureVisitor<C>(WrittenVisitor<C>);

impl<'de, C: Written + Deserialize<'de>> Visitor<'de> for TextureVisitor<C> {
    type Value = TextureKeys<C>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.expecting(f)
    }

    fn visit_f64<E: Error>(self, number: f64) -> Result<Self::Value, E> {
        self.0.visit_f64(number).map(TextureKeys::Constant)
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<Self::Value, E> {
        self.0.visit_i64(number).map(TextureKeys::Constant)
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Self::Value, E> {
        self.0.visit_str(text).map(TextureKeys::Constant)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, channels: A) -> Result<Self::Value, A::Error> {
        self.0.visit_seq(channels).map(TextureKeys::Constant)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
        let keys = PatternKeys::<C>::deserialize(MapAccessDeserializer::new(map))?;
        match (keys.image, keys.checker, keys.gradient, keys.noise) {
            (Some(image), None, None, None) => Ok(TextureKeys::Image(image)),
            (None, Some(checker), None, None) => Ok(TextureKeys::Checker(checker)),
            (None, None, Some(gradient), None) => Ok(TextureKeys::Gradient(gradient)),
            (None, None, None, Some(noise)) => Ok(TextureKeys::Noise(noise)),
            _ => Err(A::Error::custom("needs exactly one of image, checker, gradient and noise")),
        }
    }
}

impl<C: JsonSchema> JsonSchema for TextureKeys<C> {
    fn schema_name() -> Cow<'static, str> {
        format!("{}Texture", C::schema_name()).into()
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let constant = generator.subschema_for::<C>();
        let pattern = generator.subschema_for::<PatternKeys<C>>();
        json_schema!({ "anyOf": [constant, pattern] })
    }
}
