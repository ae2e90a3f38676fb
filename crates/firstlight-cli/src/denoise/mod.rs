//! `--denoise`: a copy of the picture without its noise, beside it and never in its place.

#[cfg(not(feature = "denoise"))]
mod without;

use crate::args::RenderArgs;
use crate::output::Output;
use crate::render::{Picture, write_picture};
use crate::{Exit, Failure, Outcome, report};
use firstlight::color::Rgb;
use firstlight::diagnostic::Diagnostic;
use firstlight::io::Metadata;
use firstlight::layers::Guides;
use firstlight::scene::description::Integrator;
use firstlight::{Image, SceneDescription};
#[cfg(feature = "denoise")]
use firstlight_denoise::Denoiser;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::path::PathBuf;
#[cfg(not(feature = "denoise"))]
use without::Denoiser;

const FLAG: &str = "--denoise";

/// What helps where the library is not found.
const INSTALL: &str = "pip install pyoidn brings it; or unpack a release from openimagedenoise.org, and let OIDN_DIR name its folder";

/// Refuses what is not to be denoised.
pub(crate) fn check(args: &RenderArgs, scene: &SceneDescription) -> Outcome<()> {
    if !args.denoise {
        return Ok(());
    }
    let reason = match scene.integrator {
        _ if args.false_color.is_some() => "a map is a measurement, and no measurement is denoised",
        Integrator::Clarity { .. } => "the look clarity shows colours as they are, without noise",
        _ => return Ok(()),
    };
    Err(Diagnostic::new(FLAG, reason).help("leave out --denoise").into())
}

/// A copy that is to be made.
pub(crate) struct Copy {
    output: Output,
    denoiser: Result<Denoiser, String>,
}

impl Copy {
    /// Of the picture that goes to `output`, made by so many threads. If the library is not found, that is told now, and
    /// the picture will be made nevertheless.
    pub(crate) fn plan(output: &Output, threads: usize) -> Outcome<Self> {
        let copy = Self { output: output.beside("denoised")?, denoiser: Denoiser::open(threads) };
        if let Err(reason) = &copy.denoiser {
            if !cfg!(feature = "denoise") {
                let help =
                    "build it with cargo install --path crates/firstlight-cli --features denoise";
                return Err(Diagnostic::new(FLAG, reason).help(help).into());
            }
            let message = format!("the picture will not be denoised: {reason}");
            report::warnings(&[Diagnostic::new(FLAG, message).help(INSTALL)]);
        }
        Ok(copy)
    }

    /// As [`Output::spare`].
    pub(crate) fn spare(&self, inputs: &BTreeSet<PathBuf>) -> Outcome<()> {
        self.output.spare(inputs)
    }

    /// Writes the copy of a picture that was made as `metadata` says.
    pub(crate) fn write(
        &self,
        picture: &Picture,
        guides: &Guides,
        mut metadata: Metadata,
        dither: bool,
    ) -> Outcome<Written> {
        let copied = self.denoiser.as_ref().map_err(String::clone).and_then(|denoiser| {
            Ok((denoised(&picture.rendered.image, guides, denoiser)?, denoiser.name()))
        });
        let (image, by) = copied.map_err(|reason| Failure {
            exit: Exit::Failed,
            error: Diagnostic::new(FLAG, format!("the picture was not denoised: {reason}")).into(),
        })?;
        metadata.entries.push(("Denoised".into(), format!("by {by}; an estimate, not unbiased")));
        write_picture(&image, picture, &metadata, dither, &self.output)?;
        Ok(Written { output: self.output.name(), by })
    }
}

/// A copy that was made.
pub(crate) struct Written {
    output: String,
    by: String,
}

impl Written {
    /// `wrote out.denoised.png: denoised by Open Image Denoise 2.5.1 on the CPU`.
    pub(crate) fn line(&self) -> String {
        format!("wrote {}: denoised by {}", self.output, self.by)
    }

    /// The same for a report.
    pub(crate) fn json(&self) -> Value {
        json!({ "output": self.output, "by": self.by })
    }
}

/// A picture without its noise. What is denoised is light as it arrives, colour times alpha; alpha stays as it is.
fn denoised(image: &Image, guides: &Guides, denoiser: &Denoiser) -> Result<Image, String> {
    let (width, height) = (image.width(), image.height());
    let light: Vec<_> = image.pixels().iter().map(|&[r, g, b, a]| [r * a, g * a, b * a]).collect();
    let guides = [guides.albedo.as_slice(), guides.normal.as_slice()];
    let light = denoiser.denoise(&light, guides, [width as usize, height as usize])?;
    let pixel = |([_, _, _, alpha], light): (&[f32; 4], [f32; 3])| {
        let color = if *alpha > 0.0 { Rgb::from(light) / *alpha } else { Rgb::ZERO };
        color.extend(*alpha).to_array()
    };
    Ok(Image::from_pixels(width, height, image.pixels().iter().zip(light).map(pixel).collect()))
}
