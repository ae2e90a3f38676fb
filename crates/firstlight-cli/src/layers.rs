//! Pictures with layers: what `render --aov` writes.

use crate::args::{Layers, RenderArgs};
use crate::output::Output;
use crate::render::Picture;
use crate::{Exit, Failure, Outcome, machine};
use firstlight::diagnostic::{Diagnostic, Result};
use firstlight::io::{Develop, Format, Metadata, save_layers};
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

/// A scene as it was read and as it is traced.
pub(crate) struct Scenes<'a> {
    pub description: &'a SceneDescription,
    pub built: &'a Scene,
}

/// The file of a picture with its layers.
pub(crate) fn encode(
    Layers(wanted): &Layers,
    scenes: &Scenes<'_>,
    threads: usize,
    picture: &Picture,
    lights: &LightLayers,
    metadata: &Metadata,
) -> Outcome<Vec<u8>> {
    let (film, Scenes { description, built }) = (&picture.rendered.film, scenes);
    let place = [film.origin(), film.size()];
    let data = with_threads(threads, || data_layers(built, description, place, wanted));
    let channels: Vec<Channel> =
        lights.channels(description, wanted).into_iter().chain(data).collect();
    let names = wanted.contains(&Layer::Cryptomatte).then(|| CryptoNames::new(description));
    let attributes = names.map_or(Vec::new(), |names| names.attributes());
    let (exposure_ev, view) = (picture.exposure_ev as f32, picture.view);
    let develop = Develop { exposure_ev, view, dither: false };
    save_layers(&picture.rendered.image, channels, attributes, develop, metadata)
        .map_err(|error| Failure { exit: Exit::Failed, error })
}
