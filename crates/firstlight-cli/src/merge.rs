//! `firstlight merge`: one picture of parts that were rendered apart.

use crate::args::MergeArgs;
use crate::denoise::{Copy, Written};
use crate::output::{Output, print_json};
use crate::render::{Picture, metadata, write_picture};
use crate::{Exit, Failure, Outcome, machine, report};
use firstlight::diagnostic::{Diagnostic, visible};
use firstlight::io::{Limits, Part, PartInfo, load_part, merge_parts};
use firstlight::render::Rendered;
use firstlight::scene::description::LuminousEfficacy;
use serde_json::json;
use std::ffi::OsStr;
use std::path::Path;

pub(crate) fn run(args: &MergeArgs) -> Outcome {
    let decoded_bytes = machine::available_memory().unwrap_or(Limits::default().decoded_bytes);
    let load = |path: &std::path::PathBuf| {
        let part = load_part(path, &Limits { decoded_bytes })?;
        Ok((path.display().to_string(), part))
    };
    let Part { info, film, guides } = merge_parts(args.parts.iter().map(load))?;
    check_missing(&info, args.partial)?;
    let stem = Path::new(&info.scene).file_stem().filter(|_| info.scene != "-");
    let output = Output::plan(&args.output, stem.unwrap_or(OsStr::new("scene")), args.json)?;
    let inputs = args.parts.iter().filter_map(|path| path.canonicalize().ok());
    let inputs = inputs.collect();
    output.spare(&inputs)?;
    let copy = args.denoise.then(|| Copy::plan(&output, machine::processors())).transpose()?;
    copy.iter().try_for_each(|copy| copy.spare(&inputs))?;
    if copy.is_some() && guides.is_none() {
        return Err(no_guides());
    }
    let asked = args.exposure.map(|exposure| exposure.stops(LuminousEfficacy::default()));
    let stops = asked.unwrap_or(info.exposure);
    let view = args.view.unwrap_or(info.view);
    let rendered = Rendered::of_film(film, info.count());
    let picture = Picture::new(rendered, stops, view, output.format);
    let (metadata, dither) = (metadata(&info, &picture), !args.output.no_dither);
    write_picture(&picture.rendered.image, &picture, &metadata, dither, &output)?;
    let denoised =
        copy.zip(guides).map(|(copy, guides)| copy.write(&picture, &guides, metadata, dither));
    // The picture is reported in any case.
    tell(args, &info, &picture, &output, denoised.as_ref().and_then(|copy| copy.as_ref().ok()))?;
    denoised.transpose()?;
    Ok(Exit::Done)
}

/// What there is to say if no part tells what is noise.
fn no_guides() -> Failure {
    let message = "no part has the albedo and normals that denoising goes by";
    let help = "render one of the parts with --denoise as well; or leave it out here";
    Diagnostic::new("--denoise", message).help(help).into()
}

/// Refuses to leave out samples unless that is wanted.
fn check_missing(info: &PartInfo, partial: bool) -> Outcome<()> {
    let missing: Vec<_> = info.missing().iter().map(|[from, to]| format!("{from}..{to}")).collect();
    if missing.is_empty() || partial {
        return Ok(());
    }
    let message = format!("samples {} of {} are missing", missing.join(", "), info.samples);
    let help = format!(
        "render them with --spp {} --samples {}, or make a picture of what there is with --partial",
        info.samples, missing[0]
    );
    Err(Diagnostic::new("", message).help(help).into())
}

fn tell(
    args: &MergeArgs,
    info: &PartInfo,
    picture: &Picture,
    output: &Output,
    denoised: Option<&Written>,
) -> Outcome<()> {
    let rendered = &picture.rendered;
    let (width, height) = (rendered.image.width(), rendered.image.height());
    if args.json {
        return print_json(&json!({
            "parts": args.parts.len(),
            "output": output.name(),
            "denoised": denoised.map(Written::json),
            "width": width,
            "height": height,
            "samples": info.count(),
            "missing": info.missing(),
            "noise": report::noise_json(rendered.noise, true),
            "seed": info.seed,
            "exposure_ev": picture.exposure_ev,
        }));
    }
    if !args.quiet {
        let (count, output, samples) = (args.parts.len(), output.name(), info.count());
        let parts = if count == 1 { "part" } else { "parts" };
        let noise = report::noise(rendered.noise, true);
        let line =
            format!("wrote {output}: {width}×{height}, {samples} spp of {count} {parts}{noise}");
        report::line(visible(&line));
        denoised.iter().for_each(|copy| report::line(visible(&copy.line())));
    }
    Ok(())
}
