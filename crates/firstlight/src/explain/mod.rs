//! Why a pixel has the colour it has, as one would write it on the board.
//!
//! The samples of the pixel are taken again by the stages of a render, with a recorder that is told of every ray and
//! every light. What it was told is a sum whose value is the pixel.

mod board;
mod cause;
mod difference;
mod sums;

pub use board::{Ignored, Lighting, Met, Step, Value, Verdict};
pub use cause::Cause;
pub use difference::{Difference, differences};
pub use sums::{Shadow, Term};

use crate::color::{Rgb, View, srgb_code8};
use crate::layers::sources;
use crate::render::replay;
use crate::scene::Scene;
use crate::scene::description::SceneDescription;
use crate::units::photometric;
use serde::Serialize;
use std::collections::BTreeSet;
use sums::Sums;

/// All that makes a pixel. Lengths are in m, radiance in W·sr⁻¹·m⁻², per channel of linear Rec. 709.
#[derive(Debug, Clone, Serialize)]
pub struct Explanation {
    /// Column and row from the upper left corner, from 0.
    pub pixel: [u32; 2],
    /// How many samples it has.
    pub samples: u32,
    /// Its colour: the sum of the terms.
    pub radiance: [f32; 3],
    /// How much of it is covered; less than 1 only with a transparent background.
    pub alpha: f32,
    /// Its luminance, cd·m⁻².
    pub luminance: f64,
    /// What it is the sum of, the largest first.
    pub terms: Vec<Term>,
    /// What became of the shadow rays from the surface that most samples met.
    pub shadows: Vec<Shadow>,
    /// The number of the sample that is followed: of those that met what most samples met, the one nearest to the middle
    /// of the pixel.
    pub sample: u32,
    /// Its way from the camera to its end.
    pub path: Vec<Step>,
    /// What becomes of the radiance on the screen.
    pub shown: Shown,
    /// Why, in words.
    pub cause: Cause,
}

/// How a pixel comes to the screen.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Shown {
    /// Stops of exposure: radiance × 2^EV is what is seen.
    pub exposure_ev: f64,
    /// How bright light is brought into what screens show.
    pub view: View,
    /// Linear display values, 0..1.
    pub display: [f32; 3],
    /// The numbers in an 8-bit file.
    pub code: [u8; 3],
}

impl Shown {
    fn new(radiance: [f32; 3], exposure_ev: f64, view: View) -> Self {
        let display = view.display((exposure_ev as f32).exp2() * Rgb::from(radiance)).to_array();
        Self { exposure_ev, view, display, code: display.map(srgb_code8) }
    }
}

/// Luminance of linear Rec. 709 in double precision.
fn luminance_of([r, g, b]: [f64; 3]) -> f64 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

/// The names of all that light can come from in a scene, which was built from `description`.
pub fn light_names(scene: &Scene, description: &SceneDescription) -> BTreeSet<String> {
    sources(scene).into_iter().map(|source| source.name(description)).collect()
}

/// Explains the pixel in column `x`, row `y`, which must lie inside the picture. `scene` was built from `description`;
/// the picture is shown with so many stops of exposure.
pub fn explain(
    scene: &Scene,
    description: &SceneDescription,
    pixel: [u32; 2],
    exposure_ev: f64,
) -> Explanation {
    let mut sums = Sums::new(scene, pixel);
    let [r, g, b, alpha] =
        replay(scene, pixel, 0..scene.film().samples, |samples| sums.add(&samples));
    let radiance = [r, g, b];
    let (terms, sample) = (sums.terms(description), sums.typical());
    let path = board::follow(scene, description, pixel, sample, &terms);
    let shadows = sums.shadows(description);
    let shown = Shown::new(radiance, exposure_ev, scene.film().view);
    let luminance = photometric(radiance.into(), scene.luminous_efficacy().0);
    let cause = cause::cause(&cause::Evidence {
        terms: &terms,
        shadows: &shadows,
        path: &path,
        shown: &shown,
        luminance,
    });
    Explanation {
        pixel,
        samples: scene.film().samples,
        radiance,
        alpha,
        luminance,
        terms,
        shadows,
        sample,
        path,
        shown,
        cause,
    }
}
