//! `[film]`: resolution, samples, filter, exposure.

use crate::color::View;
use crate::scene::description::{Exposure, FilmDescription, Filter};
use crate::suggest::quoted;
use crate::units::written::{Checked, Number, Written, list, schema, written};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde::de::{Deserializer, Error, MapAccess, Visitor, value::MapAccessDeserializer};
use std::borrow::Cow;
use std::fmt;

const LARGEST_SIDE: u32 = FilmDescription::LARGEST_SIDE;
const MOST_PIXELS: u64 = FilmDescription::MOST_PIXELS;
const MOST_SAMPLES: u32 = FilmDescription::MOST_SAMPLES;
const MOST_STOPS: f64 = FilmDescription::MOST_STOPS;
/// Radius of a filter in pixels, at most: each sample is spread over the square of it.
const LARGEST_RADIUS: f64 = 16.0;

/// What the film records and how it is developed.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub(super) struct FilmKeys {
    /// Width and height in pixels, each 1 to 65536, together at most 2^30 pixels. Default [1280, 720].
    resolution: Resolution,
    /// Samples per pixel, 1 to 16777216. Default 16.
    samples: Whole<MOST_SAMPLES>,
    /// The reconstruction filter, by name or with settings. Default "gaussian".
    filter: FilterKeys,
    /// Stops: display = radiance × 2^exposure; 0 makes radiance 1 white. Or "auto", or a camera's settings such as
    /// "1/125 f/8 ISO 100". Default 0.
    exposure: ExposureKeys,
    /// How bright light is brought into what screens show. Default "srgb": as it is, cut off at white.
    view: ViewKeys,
    /// Whether the background becomes transparent. Default false.
    transparent: bool,
    /// The most radiance that light scattered more than once may bring along one path, W·sr⁻¹·m⁻²: darker, with less noise.
    /// What it removes is reported. Default none.
    clamp: Option<Bound>,
    /// Seed of every random number, 0 to 2^63 - 1. Default 0.
    seed: u64,
}

impl Default for FilmKeys {
    fn default() -> Self {
        let film = FilmDescription::default();
        Self {
            resolution: Resolution([film.width, film.height]),
            samples: Whole(film.samples),
            filter: FilterKeys(film.filter),
            exposure: ExposureKeys(film.exposure),
            view: ViewKeys(film.view),
            transparent: film.transparent,
            clamp: film.clamp.map(Bound),
            seed: film.seed,
        }
    }
}

impl FilmKeys {
    pub(super) fn describe(self) -> FilmDescription {
        let Resolution([width, height]) = self.resolution;
        FilmDescription {
            width,
            height,
            samples: self.samples.0,
            filter: self.filter.0,
            exposure: self.exposure.0,
            view: self.view.0,
            transparent: self.transparent,
            clamp: self.clamp.map(|Bound(most)| most),
            seed: self.seed,
        }
    }
}

#[derive(Debug)]
struct Resolution([u32; 2]);

impl<'de> Deserialize<'de> for Resolution {
    fn deserialize<D: Deserializer<'de>>(source: D) -> Result<Self, D::Error> {
        let [width, height] = list::<Whole<LARGEST_SIDE>, 2, D>(source)?.map(|Whole(side)| side);
        if u64::from(width) * u64::from(height) > MOST_PIXELS {
            let message = format!("must be at most {MOST_PIXELS} pixels, not {width} × {height}");
            return Err(D::Error::custom(message));
        }
        Ok(Self([width, height]))
    }
}

/// A whole number from 1 to `MOST`.
#[derive(Debug)]
struct Whole<const MOST: u32>(u32);

impl<'de, const MOST: u32> Deserialize<'de> for Whole<MOST> {
    fn deserialize<D: Deserializer<'de>>(source: D) -> Result<Self, D::Error> {
        let number = i64::deserialize(source)?;
        let fits = u32::try_from(number).ok().filter(|n| (1..=MOST).contains(n));
        let message = || format!("must be a whole number from 1 to {MOST}, not {number}");
        fits.map(Self).ok_or_else(|| D::Error::custom(message()))
    }
}

impl<const MOST: u32> JsonSchema for Whole<MOST> {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        format!("Whole{MOST}").into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": "integer", "minimum": 1, "maximum": MOST })
    }
}

schema!(Resolution: {
    "type": "array", "minItems": 2, "maxItems": 2, "examples": [[1280, 720]],
    "items": { "type": "integer", "minimum": 1, "maximum": LARGEST_SIDE }
});

#[derive(Debug)]
struct ExposureKeys(Exposure);

impl Written for ExposureKeys {
    const EXPECTED: &'static str =
        "a number of stops, \"auto\" or a camera's settings such as \"1/125 f/8 ISO 100\"";
    fn from_number(stops: f64) -> Checked<Self> {
        if stops.abs() > MOST_STOPS {
            return Err(format!("must be between -{MOST_STOPS} and {MOST_STOPS}, not {stops}"));
        }
        Ok(Self(Exposure::Ev(stops)))
    }
    fn from_text(text: &str) -> Checked<Self> {
        match text {
            "auto" => Ok(Self(Exposure::Auto)),
            _ => match text.parse() {
                Ok(settings) => Ok(Self(Exposure::Camera(settings))),
                Err(_) => Err(format!("needs {}, not {}", Self::EXPECTED, quoted(text))),
            },
        }
    }
}

#[derive(Debug)]
struct ViewKeys(View);

impl Written for ViewKeys {
    const EXPECTED: &'static str = "one of srgb, neutral, agx, aces, filmic and raw";
    fn from_number(number: f64) -> Checked<Self> {
        Err(format!("needs {}, not {number}", Self::EXPECTED))
    }
    fn from_text(text: &str) -> Checked<Self> {
        let known = View::NAMES.iter().find(|(name, _)| *name == text);
        let wrong = || format!("needs {}, not {}", Self::EXPECTED, quoted(text));
        known.map(|(_, view)| Self(*view)).ok_or_else(wrong)
    }
}

written! {
    ViewKeys: { "enum": View::NAMES.iter().map(|(name, _)| *name).collect::<Vec<_>>() }
    ExposureKeys: { "anyOf": [{ "type": "number", "minimum": -100, "maximum": 100 }, { "const": "auto" }, { "type": "string", "examples": ["1/125 f/8 ISO 100"] }] }
}

/// A filter by name, or a table with exactly one filter and its settings.
#[derive(Debug)]
struct FilterKeys(Filter);

#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct FilterTable {
    /// The average over a square: { radius = 0.5 }.
    #[serde(rename = "box")]
    average: Option<RadiusKeys>,
    /// Falls linearly to the sides: { radius = 1 }.
    tent: Option<RadiusKeys>,
    /// A bell: { radius = 1.5, sigma = 0.5 }.
    gaussian: Option<GaussianKeys>,
    /// Mitchell and Netravali's cubic: { radius = 2, b = 0.333, c = 0.333 }.
    mitchell: Option<MitchellKeys>,
}

#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct RadiusKeys {
    /// Pixels, at most 16.
    radius: Option<Pixels>,
}

#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct GaussianKeys {
    /// Where it is cut, pixels, at most 16.
    radius: Option<Pixels>,
    /// Its standard deviation, pixels.
    sigma: Option<Pixels>,
}

#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct MitchellKeys {
    /// Where it reaches zero, pixels, at most 16.
    radius: Option<Pixels>,
    /// Its blur parameter, 0 to 1.
    b: Option<Fraction>,
    /// Its ringing parameter, 0 to 1.
    c: Option<Fraction>,
}

/// A filter size in pixels.
#[derive(Debug, Clone, Copy)]
struct Pixels(f64);

impl Written for Pixels {
    const EXPECTED: &'static str = "a number of pixels";
    fn from_number(number: f64) -> Checked<Self> {
        if number > 0.01 && number <= LARGEST_RADIUS {
            return Ok(Self(number));
        }
        Err(format!("must be more than 0.01 and at most {LARGEST_RADIUS} pixels, not {number}"))
    }
    fn from_text(text: &str) -> Checked<Self> {
        Number::from_text(text).and_then(|Number(number)| Self::from_number(number))
    }
}

/// A number from 0 to 1.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fraction(pub(super) f64);

impl Written for Fraction {
    const EXPECTED: &'static str = "a number from 0 to 1";
    fn from_number(number: f64) -> Checked<Self> {
        if (0.0..=1.0).contains(&number) {
            return Ok(Self(number));
        }
        Err(format!("must be from 0 to 1, not {number}"))
    }
    fn from_text(text: &str) -> Checked<Self> {
        Number::from_text(text).and_then(|Number(number)| Self::from_number(number))
    }
}

/// A radiance greater than 0.
#[derive(Debug, Clone, Copy)]
struct Bound(f64);

impl Written for Bound {
    const EXPECTED: &'static str = "a radiance greater than 0";
    fn from_number(number: f64) -> Checked<Self> {
        if number > 0.0 {
            return Ok(Self(number));
        }
        Err(format!("must be greater than 0, not {number}"))
    }
    fn from_text(text: &str) -> Checked<Self> {
        Number::from_text(text).and_then(|Number(number)| Self::from_number(number))
    }
}

written! {
    Bound: { "type": "number", "exclusiveMinimum": 0 }
    Pixels: { "type": "number", "exclusiveMinimum": 0.01, "maximum": LARGEST_RADIUS }
    Fraction: { "type": "number", "minimum": 0, "maximum": 1 }
}

const FILTERS: [&str; 4] = ["box", "tent", "gaussian", "mitchell"];

impl FilterTable {
    /// The one filter that is given.
    fn filter(self) -> Option<Filter> {
        let or = |size: Option<Pixels>, default| size.map_or(default, |Pixels(size)| size);
        let third = |part: Option<Fraction>| part.map_or(1.0 / 3.0, |Fraction(part)| part);
        match (self.average, self.tent, self.gaussian, self.mitchell) {
            (Some(keys), None, None, None) => Some(Filter::Box { radius: or(keys.radius, 0.5) }),
            (None, Some(keys), None, None) => Some(Filter::Tent { radius: or(keys.radius, 1.0) }),
            (None, None, Some(keys), None) => {
                Some(Filter::Gaussian { radius: or(keys.radius, 1.5), sigma: or(keys.sigma, 0.5) })
            }
            (None, None, None, Some(keys)) => Some(Filter::Mitchell {
                radius: or(keys.radius, 2.0),
                b: third(keys.b),
                c: third(keys.c),
            }),
            _ => None,
        }
    }
}

impl<'de> Deserialize<'de> for FilterKeys {
    fn deserialize<D: Deserializer<'de>>(source: D) -> Result<Self, D::Error> {
        source.deserialize_any(FilterVisitor)
    }
}

struct FilterVisitor;

impl<'de> Visitor<'de> for FilterVisitor {
    type Value = FilterKeys;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a filter such as \"gaussian\" or { gaussian = { radius = 1.5 } }")
    }

    fn visit_str<E: Error>(self, name: &str) -> Result<FilterKeys, E> {
        let mut table = FilterTable::default();
        match name {
            "box" => table.average = Some(RadiusKeys::default()),
            "tent" => table.tent = Some(RadiusKeys::default()),
            "gaussian" => table.gaussian = Some(GaussianKeys::default()),
            "mitchell" => table.mitchell = Some(MitchellKeys::default()),
            _ => return Err(E::unknown_variant(name, &FILTERS)),
        }
        table.filter().map(FilterKeys).ok_or_else(|| E::unknown_variant(name, &FILTERS))
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<FilterKeys, A::Error> {
        let table = FilterTable::deserialize(MapAccessDeserializer::new(map))?;
        let message = "needs exactly one of box, tent, gaussian, mitchell";
        table.filter().map(FilterKeys).ok_or_else(|| A::Error::custom(message))
    }
}

impl JsonSchema for FilterKeys {
    fn schema_name() -> Cow<'static, str> {
        "Filter".into()
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let table = generator.subschema_for::<FilterTable>();
        json_schema!({ "anyOf": [{ "enum": FILTERS }, table] })
    }
}
