//! Pictures with layers: what `render --aov` writes.

use crate::args::{Layers, RenderArgs};
use crate::machine::{self, Signal};
use crate::output::Output;
use crate::render::Picture;
use crate::{Exit, Failure, Outcome};
use firstlight::diagnostic::{Diagnostic, Result};
use firstlight::io::{Develop, EFFICACY, Format, Metadata, save_layers};
use firstlight::layers::{Channel, CryptoNames, Layer, LightLayers, data_layers};
use firstlight::render::with_threads;
use firstlight::{Scene, SceneDescription};

/// Bytes of a pixel's data, and of its channels on their way to the file.
const DATA_BYTES: u64 = 512;

/// Refuses formats without room for layers.
pub(crate) fn check_format(args: &RenderArgs, output: &Output) -> Outcome<()> {
    if args.aov.is_none() || matches!(output.format, Format::Exr { .. }) {
        return Ok(());
    }
    let error = Diagnostic::new(output.name(), "this format has no room for layers");
    Err(error.help("name an .exr file with -o").into())
}

/// Whether the layers fit into the memory there is.
pub(crate) fn check_size(args: &RenderArgs, scene: &Scene) -> Result<()> {
    let (film, Some(available)) = (scene.film(), machine::available_memory()) else {
        return Ok(());
    };
    let [width, height] = args.crop.map_or([film.width, film.height], |c| [c.width, c.height]);
    let each = LightLayers::bytes_per_pixel(scene) + DATA_BYTES;
    let needed = u64::from(width) * u64::from(height) * each;
    if args.aov.is_none() || needed <= available {
        return Ok(());
    }
    let message = format!(
        "the layers of {width} × {height} pixels need {} MiB of memory; {} MiB are available",
        needed >> 20,
        available >> 20
    );
    let help = "use a smaller -r, or render it in parts with --crop";
    Err(Box::new(Diagnostic::new("--aov", message).help(help)))
}

/// A scene as it was read and as it is traced, by so many threads until there is a signal.
pub(crate) struct Scenes<'a> {
    pub description: &'a SceneDescription,
    pub built: &'a Scene,
    pub threads: usize,
    pub signal: &'a Signal,
}

impl Scenes<'_> {
    /// Layers of data for a picture, with as many samples as it has where light has to be measured.
    pub(crate) fn data(&self, picture: &Picture, wanted: &[Layer]) -> Vec<Channel> {
        let Self { description, built, threads, signal } = *self;
        let film = &picture.rendered.film;
        let (place, samples) = ([film.origin(), film.size()], picture.rendered.samples);
        with_threads(threads, || {
            data_layers(built, description, place, wanted, samples, &|| signal.asked())
        })
    }
}

/// The file of a picture with its layers.
pub(crate) fn encode(
    Layers(wanted): &Layers,
    scenes: &Scenes<'_>,
    picture: &Picture,
    lights: &LightLayers,
    metadata: &Metadata,
) -> Outcome<Vec<u8>> {
    let description = scenes.description;
    let mut channels = lights.channels(description, wanted);
    channels.extend(scenes.data(picture, wanted));
    let names = wanted.contains(&Layer::Cryptomatte).then(|| CryptoNames::new(description));
    let mut attributes = names.map_or(Vec::new(), |names| names.attributes());
    attributes.push((EFFICACY.into(), description.luminous_efficacy.0.to_string()));
    let (exposure_ev, view) = (picture.exposure_ev as f32, picture.view);
    let develop = Develop { exposure_ev, view, dither: false };
    save_layers(&picture.rendered.image, channels, attributes, develop, metadata)
        .map_err(|error| Failure { exit: Exit::Failed, error })
}
