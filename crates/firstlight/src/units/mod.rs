//! Physical quantities with units: read, convert, print.
//!
//! A [`Quantity`] is read from text such as `"800 lm"`, `"10 klx"`, `"1200 cd"`, `"0.3 W/(sr m²)"`, `"5 mm"` or
//! `"0.7 rad"` and kept in coherent SI units. Photometric quantities become radiometric ones, and back, with a
//! luminous efficacy in lumens per watt:
//!
//! ```
//! use firstlight::units::{Dimension, Quantity};
//!
//! let lamp = Quantity::parse("800 lm")?;
//! assert_eq!(lamp.dimension, Dimension::Power);
//! assert_eq!(lamp.to_radiometric(683.0).to_string(), "1.171 W");
//! # Ok::<(), String>(())
//! ```

mod symbol;
pub(crate) mod written;

use crate::color::{Rgb, luminance};
use crate::suggest::quoted;
use std::fmt;

/// What a quantity measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dimension {
    /// Metres.
    Length,
    /// Radians.
    Angle,
    /// Watt or lumen.
    Power,
    /// Watt or lumen per steradian; candela.
    Intensity,
    /// Watt or lumen per square metre; lux.
    Irradiance,
    /// Watt or lumen per steradian and square metre; nit.
    Radiance,
    /// Lumens per watt.
    Efficacy,
}

/// Whether light is measured by its energy or as the eye sees it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// By energy, in watts. Also lengths and angles.
    Radiometric,
    /// Weighted by the eye, in lumens.
    Photometric,
}

/// A number in coherent SI units and what it measures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantity {
    /// The number, in the [`unit()`] of its dimension and measure.
    pub value: f64,
    /// What it measures.
    pub dimension: Dimension,
    /// By energy or as seen.
    pub measure: Measure,
}

impl Quantity {
    /// Reads a number and a unit, with or without a space: `"60 W"`, `"10klx"`, `"1.2e3 cd/m²"`.
    ///
    /// Units are products and quotients of W, lm, cd, lx (lux), nit, fc, m, in, ft, sr, rad, deg (°) with
    /// exponents (`m²`, `m^2`, `m2`, `m⁻²`) and the prefixes p n u µ m c k M G; a `/` divides by the next factor
    /// or bracket only.
    ///
    /// # Errors
    /// A sentence about what cannot be read.
    pub fn parse(text: &str) -> Result<Self, String> {
        let (number, unit) = split_number(text.trim());
        let Ok(number) = number.parse::<f64>() else {
            return Err(format!("needs a number and a unit, not {}", quoted(text)));
        };
        if unit.is_empty() {
            return Err(format!("needs a unit after the number in {}", quoted(text)));
        }
        let unit = symbol::parse(unit)?;
        let value = number * unit.factor;
        if !value.is_finite() {
            return Err(format!("needs a finite number, not {}", quoted(text)));
        }
        Ok(Self { value, dimension: unit.dimension, measure: unit.measure })
    }

    /// The same light by its energy, with `efficacy` in lumens per watt.
    #[must_use]
    pub fn to_radiometric(self, efficacy: f64) -> Self {
        match self.measure {
            Measure::Radiometric => self,
            Measure::Photometric => {
                Self { value: self.value / efficacy, measure: Measure::Radiometric, ..self }
            }
        }
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&format(self.value, unit(self.dimension, self.measure)))
    }
}

/// The coherent SI unit of a dimension, as it is printed.
pub fn unit(dimension: Dimension, measure: Measure) -> &'static str {
    match (dimension, measure) {
        (Dimension::Length, _) => "m",
        (Dimension::Angle, _) => "rad",
        (Dimension::Efficacy, _) => "lm/W",
        (Dimension::Power, Measure::Radiometric) => "W",
        (Dimension::Power, Measure::Photometric) => "lm",
        (Dimension::Intensity, Measure::Radiometric) => "W/sr",
        (Dimension::Intensity, Measure::Photometric) => "cd",
        (Dimension::Irradiance, Measure::Radiometric) => "W/m²",
        (Dimension::Irradiance, Measure::Photometric) => "lx",
        (Dimension::Radiance, Measure::Radiometric) => "W/(sr m²)",
        (Dimension::Radiance, Measure::Photometric) => "nit",
    }
}

/// The photometric twin of a radiometric quantity: `efficacy` (lm/W) × luminance.
///
/// Watts become lumens, W/sr candela, W/m² lux, W/(sr m²) nits.
pub fn photometric(radiometric: Rgb, efficacy: f64) -> f64 {
    efficacy * f64::from(luminance(radiometric))
}

/// A number to four digits with a unit and the SI prefix that suits it: `1.5 kW`, `15 mW/sr`, `0 lx`.
pub fn format(value: f64, unit: &str) -> String {
    const PREFIXES: [(f64, &str); 6] =
        [(1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ")];
    let rounded = significant(value);
    // Beyond the prefixes, and for zero, the plain number says it best.
    if !(1e-6..1e12).contains(&rounded.abs()) {
        return format!("{rounded} {unit}");
    }
    let fits = |(size, _): &&(f64, &str)| rounded.abs() >= *size;
    let (size, prefix) = PREFIXES.iter().find(fits).copied().unwrap_or((1.0, ""));
    format!("{} {prefix}{unit}", significant(rounded / size))
}

/// The number rounded to four significant digits.
fn significant(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

/// Splits a text after its leading number; the rest is trimmed.
fn split_number(text: &str) -> (&str, &str) {
    let digits = |from: usize| {
        let rest = text.get(from..).unwrap_or("");
        from + rest.bytes().take_while(u8::is_ascii_digit).count()
    };
    let sign = |from: usize| from + usize::from(text[from..].starts_with(['+', '-']));
    let mut end = digits(sign(0));
    if text[end..].starts_with('.') {
        end = digits(end + 1);
    }
    if text[end..].starts_with(['e', 'E']) {
        let exponent = sign(end + 1);
        if digits(exponent) > exponent {
            end = digits(exponent);
        }
    }
    let (number, unit) = text.split_at(end);
    (number, unit.trim())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> (f64, Dimension, Measure) {
        let q = Quantity::parse(text).unwrap();
        (q.value, q.dimension, q.measure)
    }

    #[test]
    fn reads_numbers_and_units() {
        use {Dimension::*, Measure::*};
        assert_eq!(read("60 W"), (60.0, Power, Radiometric));
        assert_eq!(read("60W"), (60.0, Power, Radiometric));
        assert_eq!(read("800 lm"), (800.0, Power, Photometric));
        assert_eq!(read("1.2e3 cd"), (1200.0, Intensity, Photometric));
        assert_eq!(read("10 klx"), (10_000.0, Irradiance, Photometric));
        assert_eq!(read("20 nit"), (20.0, Radiance, Photometric));
        assert_eq!(read("683 lm/W"), (683.0, Efficacy, Photometric));
        assert_eq!(read("-5 mm"), (-0.005, Length, Radiometric));
        assert_eq!(read("180°").0, std::f64::consts::PI);
        assert_eq!(read("1 fc").0, 1.0 / (0.3048 * 0.3048));
    }

    #[test]
    fn a_unit_may_be_written_in_many_ways() {
        for same in [
            "W/(sr m²)",
            "W/sr/m²",
            "W/sr/m2",
            "W·sr⁻¹·m⁻²",
            "W sr^-1 m^-2",
            "W/(m^2 sr)",
            "W/m²/sr",
        ] {
            let radiance = (3.0, Dimension::Radiance, Measure::Radiometric);
            assert_eq!(read(&format!("3 {same}")), radiance, "{same}");
        }
        for same in ["cd/m²", "nits", "lm/(sr*m²)", "lx/sr"] {
            let radiance = (3.0, Dimension::Radiance, Measure::Photometric);
            assert_eq!(read(&format!("3 {same}")), radiance, "{same}");
        }
        assert_eq!(read("1 W/cm²").0, 1e4);
    }

    #[test]
    fn refuses_what_is_no_quantity() {
        for wrong in [
            "",
            "W",
            "12",
            "12 x",
            "1e99999 W",
            "inf W",
            "nan W",
            "1 W/",
            "1 (W",
            "1 W)",
            "1 W^99999999999",
        ] {
            assert!(Quantity::parse(wrong).is_err(), "{wrong}");
        }
        assert!(Quantity::parse("3 luxx").unwrap_err().contains("did you mean \"lux\""));
        assert!(Quantity::parse(&format!("1 {}", "(".repeat(100_000))).is_err());
    }

    #[test]
    fn prints_with_a_prefix() {
        assert_eq!(format(1500.0, "W"), "1.5 kW");
        assert_eq!(format(0.0153, "W/sr"), "15.3 mW/sr");
        assert_eq!(format(0.0, "lx"), "0 lx");
        assert_eq!(format(999.96, "W"), "1 kW");
        assert_eq!(format(-2e-6, "m"), "-2 µm");
        assert_eq!(format(1e15, "m"), "1000000000000000 m");
        let there_and_back = Quantity::parse(&Quantity::parse("12.5 klx").unwrap().to_string());
        assert_eq!(there_and_back, Quantity::parse("12.5 klx"));
    }

    #[test]
    fn the_photometric_twin_is_luminance_times_efficacy() {
        assert!((photometric(Rgb::splat(2.0), 683.0) - 1366.0).abs() < 1e-3);
        assert!((photometric(Rgb::X, 683.0) - 683.0 * 0.2126).abs() < 1e-4);
    }
}
