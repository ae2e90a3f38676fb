//! `firstlight check`: looks for what would make the picture black, white, noisy or wrong; writes nothing.

use crate::args::CheckArgs;
use crate::output::{print, print_json};
use crate::render::Picture;
use crate::{Exit, Outcome, report, verdict};
use firstlight::diagnostic::{Diagnostic, visible};
use firstlight::doctor::{Care, Doctor, degenerate_triangles};
use firstlight::io::{BitDepth, Format, Warnings};
use firstlight::render::{RenderOptions, render, with_threads};
use firstlight::scene::description::{FilmDescription, Integrator};
use firstlight::{BuildQuality, Level, Scene, SceneDescription};
use serde_json::json;
use std::ops::ControlFlow;

/// Reflections that the small picture follows, at most.
const MOST_BOUNCES: u32 = 64;

pub(crate) fn run(args: &CheckArgs) -> Outcome {
    let mut warnings = Warnings::new();
    let scene = args.picture.read(&args.picture.input.access(), &mut warnings)?;
    let mut shown = scene.clone();
    args.picture.complete(&mut shown)?;
    let (threads, level) = (args.picture.threads(), args.picture.level());
    warnings.extend(with_threads(threads, || findings(shown, level, threads)));
    let warnings = args.findings.heeded(warnings);
    report::warnings(&warnings);
    if args.json {
        print_json(&json(args, &scene, &warnings))?;
    } else {
        print(summary(args, &scene, warnings.len()).as_bytes())?;
    }
    let strict = args.findings.strict && !warnings.is_empty();
    Ok(if strict { Exit::Strict } else { Exit::Done })
}

/// All that the doctor finds in a scene and in a small picture of it.
fn findings(mut scene: SceneDescription, level: Level, threads: usize) -> Vec<Diagnostic> {
    make_small(&mut scene.film);
    if let Integrator::Path { bounces } = &mut scene.integrator {
        // Where light is trapped, paths are as good as endless.
        *bounces = Some(bounces.map_or(MOST_BOUNCES, |bounces| bounces.min(MOST_BOUNCES)));
    }
    let built = Scene::build_with(&scene, level, BuildQuality::Preview);
    let doctor = Doctor::new(&scene, &built);
    let options = RenderOptions { threads, ..RenderOptions::default() };
    let rendered = render(&built, &options, &|_| ControlFlow::Continue(()));
    let stops = scene.film.exposure.stops(scene.luminous_efficacy);
    let format = Format::Png { bits: BitDepth::Eight };
    let picture = Picture::new(rendered, stops, scene.film.view, format);
    // A few samples say nothing about the noise of the picture to come.
    let mut found = doctor.examine(Care::Thorough);
    let judged = doctor.judge(&verdict::shown(&picture, None));
    found.extend(judged.into_iter().filter(|finding| !found.contains(finding)).collect::<Vec<_>>());
    found
}

/// Makes the picture about 100 pixels wide, with a few samples.
fn make_small(film: &mut FilmDescription) {
    const SIDE: f64 = 96.0;
    let scale = (SIDE / f64::from(film.width.max(film.height))).min(1.0);
    let side = |pixels: u32| ((f64::from(pixels) * scale).round() as u32).max(1);
    (film.width, film.height) = (side(film.width), side(film.height));
    film.samples = film.samples.min(4);
}

/// Triangles of all surfaces, copies counted.
pub(crate) fn triangles(scene: &SceneDescription) -> usize {
    scene.surfaces.iter().map(|surface| scene.triangles_of(&surface.shape)).sum()
}

fn summary(args: &CheckArgs, scene: &SceneDescription, warnings: usize) -> String {
    let counted = |count: usize, thing: &str| match count {
        1 => format!("1 {thing}"),
        _ => format!("{count} {thing}s"),
    };
    let flat = match degenerate_triangles(scene) {
        0 => String::new(),
        count => format!(" ({count} without area)"),
    };
    let parts = [
        counted(scene.surfaces.len(), "surface"),
        counted(triangles(scene), "triangle") + &flat,
        counted(scene.lights.len(), "light"),
        counted(scene.cameras.len(), "camera"),
        counted(warnings, "warning"),
    ];
    format!("{}: {}\n", visible(&args.picture.input.name()), parts.join(", "))
}

fn json(args: &CheckArgs, scene: &SceneDescription, warnings: &Warnings) -> serde_json::Value {
    json!({
        "scene": args.picture.input.name(),
        "surfaces": scene.surfaces.len(),
        "triangles": triangles(scene),
        "degenerate_triangles": degenerate_triangles(scene),
        "lights": scene.lights.len(),
        "cameras": scene.cameras.len(),
        "materials": scene.materials.len(),
        "textures": scene.images.len(),
        "warnings": report::as_json(warnings),
    })
}
