//! `firstlight relight`: the lights of a picture mixed again.

use crate::args::RelightArgs;
use crate::output::Output;
use crate::{Exit, Failure, Outcome, machine, report};
use firstlight::color::Rgb;
use firstlight::diagnostic::{Diagnostic, visible};
use firstlight::io::{Develop, LayerFile, Limits, Metadata, load_layers, save};
use firstlight::layers::layer_name;
use firstlight::scene::description::LuminousEfficacy;
use firstlight::{Image, auto_exposure};
use std::collections::BTreeSet;

/// What layers of light are called in a file.
const PREFIX: &str = "light.";

pub(crate) fn run(args: &RelightArgs) -> Outcome {
    let stem = args.layers.file_stem().unwrap_or_default();
    let output = Output::plan(&args.output, stem, false)?;
    output.spare(&args.layers.canonicalize().into_iter().collect::<BTreeSet<_>>())?;
    let decoded_bytes = machine::available_memory().unwrap_or(Limits::default().decoded_bytes);
    let file = load_layers(&args.layers, &Limits { decoded_bytes })?;
    let image = args.mix(&file)?;
    let efficacy = file.luminous_efficacy.map_or_else(LuminousEfficacy::default, LuminousEfficacy);
    let exposure_ev = match args.exposure.map(|e| e.stops(efficacy)) {
        None => file.exposure_ev.unwrap_or(0.0),
        Some(stops) => stops.unwrap_or_else(|| auto_exposure(&image)) as f32,
    };
    let (view, dither) = (args.view.or(file.view).unwrap_or_default(), !args.output.no_dither);
    let develop = Develop { exposure_ev, view, dither };
    let bytes = save(&image, output.format, develop, &Metadata::default())
        .map_err(|error| Failure { exit: Exit::Failed, error })?;
    output.write(&bytes)?;
    if !args.quiet {
        let (name, width, height) = (output.name(), image.width(), image.height());
        let before = file.exposure_ev.filter(|_| args.exposure.is_some());
        let before = before.map_or(String::new(), |ev| format!(" in place of {ev:+}"));
        let line = format!("wrote {name}: {width}×{height}, exposure {exposure_ev:+} EV{before}");
        report::line(visible(&line));
    }
    Ok(Exit::Done)
}

impl RelightArgs {
    /// The sum of all layers of light, each multiplied as wanted.
    fn mix(&self, file: &LayerFile) -> Outcome<Image> {
        let known = file.layers(PREFIX);
        let wanted = self.light.iter().map(|(name, _)| name).chain(&self.only);
        if known.is_empty() {
            let error = Diagnostic::new(
                self.layers.display().to_string(),
                "there are no layers of light in it",
            );
            return Err(error
                .help("write them with firstlight render --aov light -o layers.exr")
                .into());
        }
        for name in wanted {
            if !known.contains(&layer_name(name).as_str()) {
                let error = Diagnostic::new("--light", format!("there is no light \"{name}\""));
                return Err(error.help(format!("there are {}", known.join(", "))).into());
            }
        }
        let mut sum = vec![Rgb::ZERO; file.width as usize * file.height as usize];
        for name in &known {
            let (factor, layer) = (self.factor(name), file.rgb(&format!("{PREFIX}{name}")));
            let layer = layer.ok_or_else(|| {
                let message = format!("light \"{name}\" lacks one of its channels R, G and B");
                Diagnostic::new(self.layers.display().to_string(), message)
            })?;
            for (sum, value) in sum.iter_mut().zip(layer) {
                *sum += factor * Rgb::from(value);
            }
        }
        let alpha = file.numbers("A").map_or_else(|| vec![1.0; sum.len()], <[f32]>::to_vec);
        let pixel = |(sum, alpha): (Rgb, f32)| {
            let sum = if alpha > 0.0 { sum / alpha } else { sum };
            sum.extend(alpha).to_array()
        };
        let pixels = sum.into_iter().zip(alpha).map(pixel).collect();
        Ok(Image::from_pixels(file.width, file.height, pixels))
    }

    fn factor(&self, name: &str) -> Rgb {
        if !self.only.is_empty() {
            let is_wanted = self.only.iter().any(|only| layer_name(only) == name);
            return if is_wanted { Rgb::ONE } else { Rgb::ZERO };
        }
        let given = self.light.iter().rev().find(|(light, _)| layer_name(light) == name);
        given.map_or(Rgb::ONE, |(_, factor)| *factor)
    }
}
