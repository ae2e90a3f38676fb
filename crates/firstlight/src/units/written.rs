//! Numbers with units as scene files spell them: each type checks its own range as it is read.
//!
//! A bare number is in SI units (angles: degrees), text carries a unit. Errors are predicates without their
//! subject ("needs a length, not lm"); whoever knows the place puts it in front.

use super::{Dimension, Measure, Quantity, unit};
use crate::suggest::quoted;
use glam::{DVec2, DVec3};
use serde::de::{Deserialize, Deserializer, Error, IgnoredAny, SeqAccess, Visitor};
use std::fmt;
use std::marker::PhantomData;

/// Lengths and coordinates reach this far, m; a tenth of a light year.
pub(crate) const LONGEST: f64 = 1e15;
/// Sizes, radii and scales are at least this.
pub(crate) const SMALLEST: f64 = 1e-15;

/// A checked value, or a predicate that says what is wrong with it.
pub(crate) type Checked<T> = std::result::Result<T, String>;

/// A value that a file gives as a number, as text, or (some) as a list of three numbers.
pub(crate) trait Written: Sized {
    /// What belongs here, for messages: "a length such as ...".
    const EXPECTED: &'static str;
    /// From a bare number, which is finite.
    fn from_number(number: f64) -> Checked<Self>;
    /// From text.
    fn from_text(text: &str) -> Checked<Self>;
    /// From three finite numbers.
    fn from_triple(_: [f64; 3]) -> Checked<Self> {
        Err(format!("needs {}, not a list", Self::EXPECTED))
    }
}

/// Reads a [`Written`] value.
pub(crate) struct WrittenVisitor<T>(pub(crate) PhantomData<T>);

impl<'de, T: Written> Visitor<'de> for WrittenVisitor<T> {
    type Value = T;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(T::EXPECTED)
    }

    fn visit_f64<E: Error>(self, number: f64) -> Result<T, E> {
        finite(number).and_then(T::from_number).map_err(E::custom)
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<T, E> {
        self.visit_f64(number as f64)
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<T, E> {
        T::from_text(text).map_err(E::custom)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<T, A::Error> {
        let mut triple = [0.0; 3];
        for (i, slot) in triple.iter_mut().enumerate() {
            let Number(value) =
                list.next_element()?.ok_or_else(|| A::Error::invalid_length(i, &T::EXPECTED))?;
            *slot = value;
        }
        let mut count = triple.len();
        while list.next_element::<IgnoredAny>()?.is_some() {
            count += 1;
        }
        if count > triple.len() {
            return Err(A::Error::invalid_length(count, &T::EXPECTED));
        }
        T::from_triple(triple).map_err(A::Error::custom)
    }
}

/// Gives [`Written`] types their `Deserialize` and their place in the JSON schema.
macro_rules! written {
    ($($(#[$doc:meta])* $type:ident: $schema:tt)*) => {$(
        impl<'de> serde::Deserialize<'de> for $type {
            fn deserialize<D: serde::Deserializer<'de>>(
                source: D,
            ) -> std::result::Result<Self, D::Error> {
                let visitor = $crate::units::written::WrittenVisitor(std::marker::PhantomData);
                source.deserialize_any(visitor)
            }
        }
        $crate::units::written::schema!($type: $schema);
    )*};
}

/// Implements `JsonSchema` with a literal schema.
macro_rules! schema {
    ($type:ident: $schema:tt) => {
        impl schemars::JsonSchema for $type {
            fn schema_name() -> std::borrow::Cow<'static, str> {
                stringify!($type).into()
            }
            fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
                schemars::json_schema!($schema)
            }
        }
    };
}
pub(crate) use {schema, written};

/// The pattern of a number with a unit, for the JSON schema.
pub(crate) const WITH_UNIT: &str = r"^\s*[+-]?[0-9]*\.?[0-9]+([eE][+-]?[0-9]+)?\s*[^0-9\s].*$";

/// A finite number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Number(pub(crate) f64);

impl Written for Number {
    const EXPECTED: &'static str = "a number";
    fn from_number(number: f64) -> Checked<Self> {
        Ok(Self(number))
    }
    fn from_text(text: &str) -> Checked<Self> {
        Err(format!("needs a number, not the text {}", quoted(text)))
    }
}

/// A length or coordinate, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Length(pub(crate) f64);

impl Written for Length {
    const EXPECTED: &'static str = "a length such as 2 (metres) or \"20 cm\"";
    fn from_number(metres: f64) -> Checked<Self> {
        if metres.abs() > LONGEST {
            return Err(format!("must be at most {LONGEST:e} m, not {metres}"));
        }
        Ok(Self(metres))
    }
    fn from_text(text: &str) -> Checked<Self> {
        Self::from_number(quantity(text, Dimension::Length)?.value)
    }
}

/// A length greater than zero, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Size(pub(crate) f64);

impl Written for Size {
    const EXPECTED: &'static str = Length::EXPECTED;
    fn from_number(metres: f64) -> Checked<Self> {
        if metres <= 0.0 {
            return Err(format!("must be greater than 0, not {metres}"));
        }
        if metres < SMALLEST {
            return Err(format!("must be at least {SMALLEST:e} m, not {metres:e}"));
        }
        Length::from_number(metres).map(|Length(metres)| Self(metres))
    }
    fn from_text(text: &str) -> Checked<Self> {
        Self::from_number(quantity(text, Dimension::Length)?.value)
    }
}

/// An angle, rad. Bare numbers are degrees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Angle(pub(crate) f64);

impl Written for Angle {
    const EXPECTED: &'static str = "an angle such as 40 (degrees) or \"0.7 rad\"";
    fn from_number(degrees: f64) -> Checked<Self> {
        Ok(Self(degrees.to_radians()))
    }
    fn from_text(text: &str) -> Checked<Self> {
        Ok(Self(quantity(text, Dimension::Angle)?.value))
    }
}

written! {
    Number: { "type": "number" }
    Length: { "type": ["number", "string"], "pattern": WITH_UNIT, "examples": [2, "20 cm", "5 mm", "1 ft"] }
    Size: {
        "type": ["number", "string"], "exclusiveMinimum": 0, "pattern": WITH_UNIT,
        "examples": [0.5, "20 cm", "5 mm", "1 ft"]
    }
    Angle: { "type": ["number", "string"], "pattern": WITH_UNIT, "examples": [40, "40°", "0.7 rad"] }
}

/// A point or shift, m.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Point(pub(crate) DVec3);

impl<'de> Deserialize<'de> for Point {
    fn deserialize<D: Deserializer<'de>>(source: D) -> Result<Self, D::Error> {
        let [Length(x), Length(y), Length(z)] = list(source)?;
        Ok(Self(DVec3::new(x, y, z)))
    }
}

/// A unit vector, from a list of any length but zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Direction(pub(crate) DVec3);

impl<'de> Deserialize<'de> for Direction {
    fn deserialize<D: Deserializer<'de>>(source: D) -> Result<Self, D::Error> {
        let [Number(x), Number(y), Number(z)] = list(source)?;
        let vector = DVec3::new(x, y, z);
        // Scaled first, so that no square overflows or vanishes.
        let scaled = vector / vector.abs().max_element();
        if !scaled.is_finite() {
            return Err(D::Error::custom("must not be [0, 0, 0]: it has no direction"));
        }
        Ok(Self(scaled.normalize()))
    }
}

/// Two numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pair(pub(crate) DVec2);

impl<'de> Deserialize<'de> for Pair {
    fn deserialize<D: Deserializer<'de>>(source: D) -> Result<Self, D::Error> {
        let [Number(u), Number(v)] = list(source)?;
        Ok(Self(DVec2::new(u, v)))
    }
}

/// A list of exactly `N` values.
pub(crate) fn list<'de, T: Deserialize<'de>, const N: usize, D: Deserializer<'de>>(
    source: D,
) -> Result<[T; N], D::Error> {
    let values = Vec::<T>::deserialize(source)?;
    values.try_into().map_err(|values: Vec<T>| {
        D::Error::custom(format!("needs a list of {N} values, not {}", values.len()))
    })
}

schema!(Point: {
    "description": "[x, y, z], metres or text with a unit",
    "type": "array", "minItems": 3, "maxItems": 3,
    "items": { "type": ["number", "string"], "pattern": WITH_UNIT },
    "examples": [[0, 0, 1], ["20 cm", 0, "5 mm"]]
});
schema!(Direction: {
    "description": "[x, y, z], of any length but 0",
    "type": "array", "minItems": 3, "maxItems": 3, "items": { "type": "number" },
    "examples": [[0, 0, 1]]
});
schema!(Pair: { "type": "array", "minItems": 2, "maxItems": 2, "items": { "type": "number" } });

/// For `deserialize_with`: a [`Point`] as a vector.
pub(crate) fn point<'de, D: Deserializer<'de>>(source: D) -> Result<DVec3, D::Error> {
    Point::deserialize(source).map(|point| point.0)
}

/// For `deserialize_with`: a [`Direction`] as a unit vector.
pub(crate) fn direction<'de, D: Deserializer<'de>>(source: D) -> Result<DVec3, D::Error> {
    Direction::deserialize(source).map(|direction| direction.0)
}

/// For `deserialize_with`: a [`Size`] in metres.
pub(crate) fn size<'de, D: Deserializer<'de>>(source: D) -> Result<f64, D::Error> {
    Size::deserialize(source).map(|size| size.0)
}

/// Parses text that must be a quantity of one dimension.
pub(crate) fn quantity(text: &str, wanted: Dimension) -> Checked<Quantity> {
    let quantity = Quantity::parse(text)?;
    if quantity.dimension == wanted {
        return Ok(quantity);
    }
    let found = unit(quantity.dimension, quantity.measure);
    Err(format!("needs {}, not {found}", units_of(wanted)))
}

/// The units of a dimension in words: "W/m² or lx".
pub(crate) fn units_of(dimension: Dimension) -> String {
    match dimension {
        Dimension::Length => "a length in m, mm, cm, km, in or ft".into(),
        Dimension::Angle => "an angle in deg, ° or rad".into(),
        Dimension::Efficacy => "lm/W".into(),
        _ => {
            let [energy, seen] = [Measure::Radiometric, Measure::Photometric]
                .map(|measure| unit(dimension, measure));
            format!("{energy} or {seen}")
        }
    }
}

fn finite(number: f64) -> Checked<f64> {
    if number.is_finite() {
        Ok(number)
    } else {
        Err(format!("must be a finite number, not {number}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read<T: for<'de> Deserialize<'de>>(toml: &str) -> Result<T, String> {
        let value = toml::de::ValueDeserializer::parse(toml).map_err(|e| e.message().to_owned())?;
        T::deserialize(value).map_err(|e| e.message().to_owned())
    }

    #[test]
    fn bare_numbers_are_si_and_text_has_units() {
        assert_eq!(read("2"), Ok(Length(2.0)));
        assert_eq!(read("\"20 cm\""), Ok(Length(0.2)));
        assert_eq!(read("180"), Ok(Angle(std::f64::consts::PI)));
        assert_eq!(read("\"0.7 rad\""), Ok(Angle(0.7)));
        assert_eq!(read("[1, \"2 m\", 3.0]"), Ok(Point(DVec3::new(1.0, 2.0, 3.0))));
    }

    #[test]
    fn every_type_refuses_what_it_cannot_be() {
        assert_eq!(
            read::<Length>("\"3 lm\""),
            Err("needs a length in m, mm, cm, km, in or ft, not lm".into())
        );
        assert_eq!(read::<Size>("0"), Err("must be greater than 0, not 0".into()));
        assert_eq!(read::<Length>("nan"), Err("must be a finite number, not NaN".into()));
        assert!(read::<Length>("1e300").is_err());
        assert!(read::<Size>("1e-300").is_err());
        assert_eq!(read::<Point>("[1, 2]"), Err("needs a list of 3 values, not 2".into()));
        assert!(read::<Point>("[1, 2, 3, 4]").is_err());
    }

    #[test]
    fn directions_are_unit_vectors_even_at_the_ends_of_the_range() {
        for text in ["[0, 0, 3]", "[0, 0, 1e300]", "[0, 0, 1e-300]"] {
            assert_eq!(read(text), Ok(Direction(DVec3::Z)), "{text}");
        }
        assert!(read::<Direction>("[0, 0, 0]").is_err());
        assert!(read::<Direction>("[0, inf, 0]").is_err());
    }
}
