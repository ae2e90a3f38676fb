//! Indices of refraction, by number or by name.

use crate::color::Rgb;
use crate::scene::description::ComplexIndex;
use crate::suggest::{did_you_mean, quoted};
use crate::units::written::{Checked, Number, Written, written};

/// The index of refraction of something transparent, 1 to 10.
#[derive(Debug, Clone, Copy)]
pub(super) struct Index(pub(super) f32);

impl Index {
    /// Borosilicate crown glass, N-BK7.
    pub(super) const GLASS: Self = Self(1.5168);
}

/// At 587.6 nm, 20 °C (refractiveindex.info).
const INDICES: &[(&str, f32)] = &[
    ("vacuum", 1.0),
    ("air", 1.000_277),
    ("ice", 1.309),
    ("water", 1.333),
    ("ethanol", 1.361),
    ("fused silica", 1.4585),
    ("acrylic", 1.4906),
    ("glass", 1.5168),
    ("polycarbonate", 1.5848),
    ("flint glass", 1.7847),
    ("sapphire", 1.768),
    ("diamond", 2.4175),
];

impl Written for Index {
    const EXPECTED: &'static str = "an index of refraction such as 1.5 or \"water\"";
    fn from_number(number: f64) -> Checked<Self> {
        if (1.0..=10.0).contains(&number) {
            return Ok(Self(number as f32));
        }
        Err(format!("must be from 1 to 10, not {number}"))
    }
    fn from_text(text: &str) -> Checked<Self> {
        if let Ok(Number(number)) = Number::from_text(text) {
            return Self::from_number(number);
        }
        find(text, INDICES).map(Self)
    }
}

/// n_d − 1 over n_F − n_C, 1 to 1000.
#[derive(Debug, Clone, Copy)]
pub(super) struct Abbe(pub(super) f32);

impl Written for Abbe {
    const EXPECTED: &'static str = "an Abbe number such as 64";
    fn from_number(number: f64) -> Checked<Self> {
        if (1.0..=1000.0).contains(&number) {
            return Ok(Self(number as f32));
        }
        Err(format!("must be from 1 to 1000, not {number}"))
    }
    fn from_text(text: &str) -> Checked<Self> {
        Number::from_text(text).and_then(|Number(number)| Self::from_number(number))
    }
}

/// A metal by its name.
#[derive(Debug, Clone, Copy)]
pub(super) struct Metal(pub(super) ComplexIndex);

impl Metal {
    /// What mirrors are made of.
    pub(super) const ALUMINIUM: ComplexIndex =
        metal([1.2464, 0.78941, 0.48922], [6.8523, 5.8519, 4.7783]);
}

/// n and k at 650, 550 and 450 nm (refractiveindex.info: McPeak 2015, Rakić 1998, Johnson & Christy 1972 and 1974,
/// Querry 1985, Werner 2009, Inagaki 1981).
const METALS: &[(&str, ComplexIndex)] = &[
    ("aluminium", Metal::ALUMINIUM),
    ("aluminum", Metal::ALUMINIUM),
    ("brass", metal([0.444, 0.527, 1.094], [3.695, 2.765, 1.829])),
    ("chromium", metal([3.1071, 3.1812, 2.323], [3.3314, 3.3291, 3.135])),
    ("copper", metal([0.27105, 0.67693, 1.3164], [3.6092, 2.6248, 2.2921])),
    ("gold", metal([0.18299, 0.42108, 1.3734], [3.4242, 2.3459, 1.7704])),
    ("iron", metal([2.9114, 2.9497, 2.5845], [3.0893, 2.9318, 2.767])),
    ("lead", metal([1.91, 1.83, 1.44], [3.51, 3.4, 3.18])),
    ("mercury", metal([2.0733, 1.5523, 1.0606], [5.3383, 4.651, 3.8628])),
    ("platinum", metal([2.3757, 2.0847, 1.8453], [4.2655, 3.7153, 3.1365])),
    ("silver", metal([0.15943, 0.14512, 0.13547], [3.9291, 3.19, 2.3808])),
    ("titanium", metal([2.7407, 2.5418, 2.237], [3.8143, 3.4345, 3.0385])),
];

const fn metal(n: [f32; 3], k: [f32; 3]) -> ComplexIndex {
    ComplexIndex { n: Rgb::from_array(n), k: Rgb::from_array(k) }
}

impl Written for Metal {
    const EXPECTED: &'static str = "the name of a metal such as \"gold\"";
    fn from_number(number: f64) -> Checked<Self> {
        Err(format!("needs {}, not {number}", Self::EXPECTED))
    }
    fn from_text(text: &str) -> Checked<Self> {
        find(text, METALS).map(Self)
    }
}

fn find<T: Copy>(name: &str, known: &[(&str, T)]) -> Checked<T> {
    if let Some((_, value)) = known.iter().find(|(known, _)| known.eq_ignore_ascii_case(name)) {
        return Ok(*value);
    }
    let names = || known.iter().map(|(name, _)| *name);
    let all = names().collect::<Vec<_>>().join(", ");
    let hint = did_you_mean(name, names());
    Err(format!("does not know {}, but {all}{hint}", quoted(name)))
}

written! {
    Index: {
        "anyOf": [
            { "type": "number", "minimum": 1, "maximum": 10 },
            { "enum": INDICES.iter().map(|(name, _)| *name).collect::<Vec<_>>() }
        ]
    }
    Abbe: { "type": "number", "minimum": 1, "maximum": 1000 }
    Metal: { "enum": METALS.iter().map(|(name, _)| *name).collect::<Vec<_>>() }
}
