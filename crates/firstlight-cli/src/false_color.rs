//! Maps of luminance and illuminance: what `render --false-color` writes.

use crate::args::{FalseColorName, RenderArgs};
use crate::layers::Scenes;
use crate::output::Output;
use crate::render::Picture;
use crate::{Exit, Failure, Outcome};
use firstlight::Image;
use firstlight::color::{Rgb, View};
use firstlight::diagnostic::Diagnostic;
use firstlight::false_color::{Scale, false_color};
use firstlight::io::{Develop, Format, Metadata, save};
use firstlight::layers::{Layer, Plane};
use firstlight::units;

/// Refuses formats that hold light instead of colours.
pub(crate) fn check_format(args: &RenderArgs, output: &Output) -> Outcome<()> {
    if args.false_color.is_none() || matches!(output.format, Format::Png { .. }) {
        return Ok(());
    }
    let error = Diagnostic::new(output.name(), "false colours are for pictures to be looked at");
    Err(error.help("name a .png file with -o; for numbers, --aov illuminance -o layers.exr").into())
}

/// The file of a map.
pub(crate) fn encode(
    name: FalseColorName,
    range: Option<[f64; 2]>,
    scenes: &Scenes<'_>,
    picture: &Picture,
    format: Format,
    metadata: &Metadata,
) -> Outcome<Vec<u8>> {
    let (values, unit) = match name {
        FalseColorName::Luminance => (nits(scenes, &picture.rendered.image), "nit"),
        FalseColorName::Illuminance => (lux(scenes, picture), "lx"),
    };
    let scale = match range {
        Some(ends) => Scale { ends, unit: unit.into() },
        None => Scale::around(&values, unit),
    };
    let image = false_color(&values, picture.rendered.film.size(), &scale);
    let develop = Develop { exposure_ev: 0.0, view: View::Srgb, dither: false };
    save(&image, format, develop, metadata).map_err(|error| Failure { exit: Exit::Failed, error })
}

/// Luminance of each pixel.
fn nits(scenes: &Scenes<'_>, image: &Image) -> Vec<f64> {
    let efficacy = scenes.description.luminous_efficacy.0;
    let of = |&[r, g, b, a]: &[f32; 4]| units::photometric(a * Rgb::new(r, g, b), efficacy);
    image.pixels().iter().map(of).collect()
}

/// Illuminance of the surface in the middle of each pixel.
fn lux(scenes: &Scenes<'_>, picture: &Picture) -> Vec<f64> {
    let layers = scenes.data(picture, &[Layer::Illuminance]);
    let numbers = layers.into_iter().find_map(|channel| match channel.plane {
        Plane::Numbers(values) => Some(values),
        Plane::Whole(_) => None,
    });
    numbers.unwrap_or_default().into_iter().map(f64::from).collect()
}
