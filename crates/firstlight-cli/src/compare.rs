//! `firstlight compare`: whether two pictures are the same, and `render --reference`.

use crate::args::CompareArgs;
use crate::output::{Output, print, print_json};
use crate::{Exit, Outcome, report};
use firstlight::Image;
use firstlight::color::ColorMap;
use firstlight::compare::{Comparison, Measured, Region, compare};
use firstlight::diagnostic::{Diagnostic, Result, visible};
use firstlight::io::{Develop, Limits, Metadata, load_measured, load_variance, save};
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::Path;

/// Regions that are listed one by one.
const MOST_REGIONS: usize = 10;

pub(crate) fn run(args: &CompareArgs) -> Outcome {
    let map = args.output.path.is_some();
    let output = map.then(|| Output::plan(&args.output, "difference".as_ref(), args.json));
    let output = output.transpose()?;
    let a = read(&args.a, args.variance_a.as_deref(), None)?;
    let b = read(&args.b, args.variance_b.as_deref(), args.reference_noise)?;
    check_size(&b, &args.b, size(&a))?;
    let comparison = compare(&a, &b, args.threshold);
    if let Some(output) = output {
        let image = difference(&comparison, &b.image);
        let bytes = save(&image, output.format, Develop::default(), &Metadata::default())?;
        output.write(&bytes)?;
    }
    let names = [&args.a, &args.b].map(|path| path.display().to_string());
    match args.json {
        true => print_json(&as_json(&names, &comparison))?,
        false => print(as_text(&names, &comparison).as_bytes())?,
    }
    Ok(if comparison.same { Exit::Done } else { Exit::Differs })
}

/// A picture with its noise: its own, that of a picture of variances, or what it is said to be.
fn read(path: &Path, variance: Option<&Path>, noise: Option<f64>) -> Result<Measured> {
    let limits = Limits::default();
    let mut picture = load_measured(path, &limits)?;
    if let Some(variance) = variance {
        let values = load_variance(variance, &limits)?;
        if values.len() != picture.image.pixels().len() {
            let message = "has another number of pixels than its picture";
            return Err(Box::new(Diagnostic::new(variance.display().to_string(), message)));
        }
        picture.variance = Some(values);
    }
    Ok(noise.map_or(picture.clone(), |noise| picture.with_noise(noise)))
}

/// The size of a picture.
fn size(picture: &Measured) -> [u32; 2] {
    [picture.image.width(), picture.image.height()]
}

/// Whether the reference at `path` has the size of what is compared with it.
fn check_size(reference: &Measured, path: &Path, [w, h]: [u32; 2]) -> Result<()> {
    let [x, y] = size(reference);
    if [x, y] == [w, h] {
        return Ok(());
    }
    let message =
        format!("is {x} × {y} pixels, not {w} × {h}: only pictures of one size can be compared");
    Err(Box::new(Diagnostic::new(path.display().to_string(), message)))
}

/// What a picture of that size is to be held to once it is rendered.
pub(crate) struct Reference<'a> {
    path: &'a Path,
    picture: Measured,
}

impl<'a> Reference<'a> {
    pub(crate) fn load(path: &'a Path, size: [u32; 2]) -> Result<Self> {
        let picture = load_measured(path, &Limits::default())?;
        check_size(&picture, path, size)?;
        Ok(Self { path, picture })
    }

    /// Compares the picture with it; says how it went.
    pub(crate) fn compare(
        &self,
        picture: &Measured,
        threshold: Option<f64>,
    ) -> (Comparison, Value) {
        let comparison = compare(picture, &self.picture, threshold);
        let names = ["the picture".to_owned(), self.path.display().to_string()];
        let json = as_json(&names, &comparison);
        if !comparison.same {
            report::line(as_text(&names, &comparison).trim_end());
        }
        (comparison, json)
    }
}

/// What differs, bright on the dark reference.
fn difference(comparison: &Comparison, reference: &Image) -> Image {
    let pixel = |value: &f32| {
        let color = ColorMap::Magma.color(*value);
        [color.x, color.y, color.z, 1.0]
    };
    let pixels = comparison.map.iter().map(pixel).collect();
    Image::from_pixels(reference.width(), reference.height(), pixels)
}

fn as_text([a, b]: &[String; 2], comparison: &Comparison) -> String {
    let Comparison { flip, relative_mse, means, .. } = comparison;
    let verdict = match (comparison.identical, comparison.same, comparison.test) {
        (true, ..) => "are the same, bit for bit",
        (_, true, Some(_)) => "are the same within noise",
        (_, true, None) => "look the same",
        (_, false, _) => "differ",
    };
    let test = comparison.test.map_or(String::new(), |t| {
        format!(
            "; greatest |z| {:.2} of {:.2} that chance allows",
            t.greatest.max(t.of_means.abs()),
            t.allowed
        )
    });
    let mut text = format!(
        "{} and {} {verdict}{test}; mean FLIP {flip:.4}, relMSE {relative_mse:.2e}, mean luminance {:.4} and {:.4}\n",
        visible(a),
        visible(b),
        means[0],
        means[1]
    );
    for Region { x, y, width, height, means } in comparison.regions.iter().take(MOST_REGIONS) {
        let change = 100.0 * (means[0] / means[1] - 1.0);
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "  {width}×{height} pixels at ({x}, {y}): mean luminance {:.4} and {:.4} ({change:+.1} %)",
            means[0], means[1]
        );
    }
    if let more @ 1.. = comparison.regions.len().saturating_sub(MOST_REGIONS) {
        let _ = writeln!(text, "  … and {more} more; --json lists them all");
    }
    text
}

fn as_json([a, b]: &[String; 2], comparison: &Comparison) -> Value {
    let region = |r: &Region| {
        json!({
            "x": r.x, "y": r.y, "width": r.width, "height": r.height, "mean_luminance": r.means,
        })
    };
    json!({
        "a": a,
        "b": b,
        "identical": comparison.identical,
        "same": comparison.same,
        "mean_flip": comparison.flip,
        "relative_mse": comparison.relative_mse,
        "mean_luminance": comparison.means,
        "test": comparison.test.map(|t| json!({
            "greatest_z": t.greatest, "z_of_means": t.of_means, "allowed_z": t.allowed,
        })),
        "regions": comparison.regions.iter().map(region).collect::<Value>(),
    })
}
