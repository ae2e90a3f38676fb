//! Unit symbols: products and quotients of symbols with prefixes and exponents.

use super::{Dimension, Measure};
use crate::suggest::{did_you_mean, quoted};

/// A unit: how many coherent SI units it is, and of what.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Unit {
    pub(super) factor: f64,
    pub(super) dimension: Dimension,
    pub(super) measure: Measure,
}

/// Exponents of the base units.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
struct Exponents {
    watt: i32,
    lumen: i32,
    metre: i32,
    steradian: i32,
    radian: i32,
}

const WATT: Exponents = Exponents { watt: 1, lumen: 0, metre: 0, steradian: 0, radian: 0 };
const LUMEN: Exponents = Exponents { lumen: 1, watt: 0, ..WATT };
const METRE: Exponents = Exponents { metre: 1, watt: 0, ..WATT };
const STERADIAN: Exponents = Exponents { steradian: 1, watt: 0, ..WATT };
const RADIAN: Exponents = Exponents { radian: 1, watt: 0, ..WATT };
const CANDELA: Exponents = Exponents { steradian: -1, ..LUMEN };
const LUX: Exponents = Exponents { metre: -2, ..LUMEN };
const NIT: Exponents = Exponents { metre: -2, ..CANDELA };

const INCH: f64 = 0.0254;
const FOOT: f64 = 0.3048;
const DEGREE: f64 = std::f64::consts::PI / 180.0;

/// Symbol, size in coherent SI units, exponents.
const SYMBOLS: [(&str, f64, Exponents); 20] = [
    ("W", 1.0, WATT),
    ("lm", 1.0, LUMEN),
    ("cd", 1.0, CANDELA),
    ("lx", 1.0, LUX),
    ("lux", 1.0, LUX),
    ("fc", 1.0 / (FOOT * FOOT), LUX),
    ("nit", 1.0, NIT),
    ("nits", 1.0, NIT),
    ("m", 1.0, METRE),
    ("in", INCH, METRE),
    ("ft", FOOT, METRE),
    ("sr", 1.0, STERADIAN),
    ("rad", 1.0, RADIAN),
    ("deg", DEGREE, RADIAN),
    ("°", DEGREE, RADIAN),
    ("watt", 1.0, WATT),
    ("watts", 1.0, WATT),
    ("lumen", 1.0, LUMEN),
    ("lumens", 1.0, LUMEN),
    ("candela", 1.0, CANDELA),
];

const PREFIXES: [(char, f64); 10] = [
    ('p', 1e-12),
    ('n', 1e-9),
    ('u', 1e-6),
    ('µ', 1e-6),
    ('μ', 1e-6),
    ('m', 1e-3),
    ('c', 1e-2),
    ('k', 1e3),
    ('M', 1e6),
    ('G', 1e9),
];

/// Reads a unit without a number in front.
pub(super) fn parse(text: &str) -> Result<Unit, String> {
    let unknown = |e: Mistake| match e {
        Mistake::Symbol(symbol) => {
            let hint = did_you_mean(&symbol, SYMBOLS.iter().map(|(name, ..)| *name));
            format!("has an unknown unit {}{hint}", quoted(&symbol))
        }
        Mistake::Grammar => format!("has a unit that cannot be read: {}", quoted(text)),
    };
    let (factor, exponents) = product(text).map_err(unknown)?;
    let (dimension, measure) = exponents
        .dimension()
        .ok_or_else(|| format!("has a unit that measures nothing known here: {}", quoted(text)))?;
    Ok(Unit { factor, dimension, measure })
}

enum Mistake {
    Symbol(String),
    Grammar,
}

impl Exponents {
    /// What a product of base units measures; `None` if nothing that is used here.
    fn dimension(self) -> Option<(Dimension, Measure)> {
        use {Dimension::*, Measure::*};
        let Self { watt, lumen, metre, steradian, radian } = self;
        match (watt, lumen, metre, steradian, radian) {
            (0, 0, 1, 0, 0) => Some((Length, Radiometric)),
            (0, 0, 0, 0, 1) => Some((Angle, Radiometric)),
            (-1, 1, 0, 0, 0) => Some((Efficacy, Photometric)),
            (1, 0, ..) | (0, 1, ..) => {
                let measure = if watt == 1 { Radiometric } else { Photometric };
                let dimension = match (metre, steradian, radian) {
                    (0, 0, 0) => Power,
                    (0, -1, 0) => Intensity,
                    (-2, 0, 0) => Irradiance,
                    (-2, -1, 0) => Radiance,
                    _ => return None,
                };
                Some((dimension, measure))
            }
            _ => None,
        }
    }

    fn add(&mut self, other: Self, times: i32) {
        self.watt += other.watt * times;
        self.lumen += other.lumen * times;
        self.metre += other.metre * times;
        self.steradian += other.steradian * times;
        self.radian += other.radian * times;
    }
}

/// Factors joined by `/`, `·`, `*` or blanks. One level of brackets, after a `/`.
fn product(text: &str) -> Result<(f64, Exponents), Mistake> {
    let plain: String = text.chars().map(plain_digit).collect();
    let (mut size, mut exponents) = (1.0, Exponents::default());
    let (mut divide_next, mut inside_bracket) = (false, false);
    let mut rest = plain.trim();
    while let Some(c) = rest.chars().next() {
        let after = &rest[c.len_utf8()..];
        match c {
            '/' if !divide_next && !inside_bracket => divide_next = true,
            '(' if divide_next && !inside_bracket => inside_bracket = true,
            ')' if inside_bracket => (inside_bracket, divide_next) = (false, false),
            '·' | '⋅' | '*' | ' ' => {}
            _ => {
                let (factor, end) = factor(rest)?;
                let times = if divide_next { -factor.exponent } else { factor.exponent };
                size *= factor.size.powi(times);
                exponents.add(factor.base, times);
                divide_next &= inside_bracket;
                rest = end;
                continue;
            }
        }
        rest = after;
    }
    if divide_next || inside_bracket { Err(Mistake::Grammar) } else { Ok((size, exponents)) }
}

struct Factor {
    size: f64,
    base: Exponents,
    exponent: i32,
}

/// One symbol with its exponent, and what follows it.
fn factor(text: &str) -> Result<(Factor, &str), Mistake> {
    let letters = text.find(|c: char| !c.is_alphabetic() && c != '°').unwrap_or(text.len());
    let (symbol, rest) = text.split_at(letters);
    let (size, base) = lookup(symbol).ok_or_else(|| {
        if symbol.is_empty() { Mistake::Grammar } else { Mistake::Symbol(symbol.into()) }
    })?;
    let rest = rest.strip_prefix('^').unwrap_or(rest);
    let is_exponent = |c: char| c.is_ascii_digit() || c == '-';
    let end = rest.find(|c| !is_exponent(c)).unwrap_or(rest.len());
    let (digits, rest) = rest.split_at(end);
    let exponent = if digits.is_empty() { 1 } else { small(digits).ok_or(Mistake::Grammar)? };
    Ok((Factor { size, base, exponent }, rest))
}

/// An exponent of at most one digit: larger ones measure nothing.
fn small(digits: &str) -> Option<i32> {
    digits.parse().ok().filter(|exponent: &i32| exponent.abs() < 10)
}

/// Size and exponents of a symbol with or without a prefix. Whole symbols come first: `cd` is candela.
fn lookup(symbol: &str) -> Option<(f64, Exponents)> {
    let whole = |name: &str| SYMBOLS.iter().find(|(known, ..)| *known == name);
    if let Some((_, size, base)) = whole(symbol) {
        return Some((*size, *base));
    }
    let first = symbol.chars().next()?;
    let (_, scale) = PREFIXES.iter().find(|(prefix, _)| *prefix == first)?;
    let (_, size, base) = whole(&symbol[first.len_utf8()..])?;
    Some((scale * size, *base))
}

/// Superscripts as plain digits.
fn plain_digit(c: char) -> char {
    match c {
        '⁻' | '−' => '-',
        '¹' => '1',
        '²' => '2',
        '³' => '3',
        _ => c,
    }
}
