//! `firstlight check`: reads everything, draws nothing.

use crate::args::CheckArgs;
use crate::output::{print, print_json};
use crate::{Exit, Outcome, report, verdict};
use firstlight::SceneDescription;
use firstlight::diagnostic::visible;
use firstlight::io::Warnings;
use serde_json::json;

pub(crate) fn run(args: &CheckArgs) -> Outcome {
    let mut warnings = Warnings::new();
    let scene = args.input.load(&mut warnings)?;
    // A model is lit by the studio if it has no lights.
    if !args.input.is_model() {
        warnings.extend(verdict::foresee(&scene));
    }
    report::warnings(&warnings);
    if args.json {
        print_json(&json(args, &scene, &warnings))?;
    } else {
        print(summary(args, &scene, warnings.len()).as_bytes())?;
    }
    Ok(if args.strict && !warnings.is_empty() { Exit::Strict } else { Exit::Done })
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
    let parts = [
        counted(scene.surfaces.len(), "surface"),
        counted(triangles(scene), "triangle"),
        counted(scene.lights.len(), "light"),
        counted(scene.cameras.len(), "camera"),
        counted(warnings, "warning"),
    ];
    format!("{}: {}\n", visible(&args.input.name()), parts.join(", "))
}

fn json(args: &CheckArgs, scene: &SceneDescription, warnings: &Warnings) -> serde_json::Value {
    json!({
        "scene": args.input.name(),
        "surfaces": scene.surfaces.len(),
        "triangles": triangles(scene),
        "lights": scene.lights.len(),
        "cameras": scene.cameras.len(),
        "materials": scene.materials.len(),
        "textures": scene.images.len(),
        "warnings": report::as_json(warnings),
    })
}
