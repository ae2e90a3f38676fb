//! The reference table: scenes whose light is known from a formula, measured the way users measure and render.
//!
//! Each group of cases is a file that ends in a list. To add a case, write a function that builds its scenes, measures
//! them and says what is expected, and put it into the list of its group; `firstlight verify` and `cargo test` run it
//! from then on.

mod area_light;
mod camera;
mod cavity;
mod cie171;
mod closed_forms;
mod delta_light;
mod environment;
mod form_factor;
mod furnace;
mod geometry;
mod global_illumination;
mod image;
mod material;
mod microfacet;
mod readings;
mod refraction;
mod sampling;
pub mod scenes;
pub mod shapes;
mod statistics;
mod volume;
pub mod white;

pub use geometry::{differing, escaped, reintersections, terminator};
pub use readings::{Reading, Readings};
pub use statistics::{Random, chi_squared_z, greatest_z};

/// One line of the table.
#[derive(Debug, Clone, Copy)]
pub struct Case {
    /// Its name in the table.
    pub id: &'static str,
    /// What is measured, in one sentence.
    pub setup: &'static str,
    /// Where the expected values come from.
    pub source: &'static str,
    /// How far off a value may be.
    pub tolerance: Tolerance,
    /// Whether it belongs to the set that is done in about a minute.
    pub quick: bool,
    measure: fn(&mut Readings),
}

/// How far a measured value may be from what is expected.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tolerance {
    /// So large a fraction of what is expected.
    Relative(f64),
    /// So much.
    Absolute(f64),
}

/// A group of cases and its name.
pub type Group = (&'static str, &'static [Case]);

/// All groups of the table.
pub const GROUPS: &[Group] = &[
    ("delta-light", delta_light::CASES),
    ("area-light", area_light::CASES),
    ("form-factor", form_factor::CASES),
    ("environment", environment::CASES),
    ("furnace", furnace::CASES),
    ("cavity", cavity::CASES),
    ("global-illumination", global_illumination::CASES),
    ("volume", volume::CASES),
    ("cie171", cie171::CASES),
    ("geometry", geometry::CASES),
    ("material", material::CASES),
    ("microfacet", microfacet::CASES),
    ("refraction", refraction::CASES),
    ("camera", camera::CASES),
    ("image", image::CASES),
    ("sampling", sampling::CASES),
];

impl Case {
    /// A case that leaves nothing to chance: only rounding, to a hundred-thousandth.
    const fn exact(
        id: &'static str,
        setup: &'static str,
        source: &'static str,
        measure: fn(&mut Readings),
    ) -> Self {
        let tolerance = Tolerance::Relative(1e-5);
        Self { id, setup, source, tolerance, quick: true, measure }
    }

    /// A case that is sampled: to 0.2 %, with a standard error of at most half of that.
    const fn sampled(
        id: &'static str,
        setup: &'static str,
        source: &'static str,
        measure: fn(&mut Readings),
    ) -> Self {
        Self { tolerance: Tolerance::Relative(2e-3), ..Self::exact(id, setup, source, measure) }
    }

    const fn within(self, tolerance: Tolerance) -> Self {
        Self { tolerance, ..self }
    }

    /// It takes too long for the quick set.
    const fn slow(self) -> Self {
        Self { quick: false, ..self }
    }

    /// Measures all of its points.
    pub fn run(&self) -> Vec<Reading> {
        self.run_with_gain(1.0)
    }

    /// Measures all of its points with an error planted: everything is multiplied by `gain`. That shows how small an
    /// error would be found.
    pub fn run_with_gain(&self, gain: f64) -> Vec<Reading> {
        let mut readings = Readings::new(self.tolerance, gain);
        (self.measure)(&mut readings);
        readings.into_inner()
    }
}

impl Tolerance {
    /// How far a value may be from `expected`.
    pub fn of(self, expected: f64) -> f64 {
        match self {
            Self::Relative(part) => part * expected.abs(),
            Self::Absolute(value) => value,
        }
    }
}
