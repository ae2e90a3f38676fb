//! What may be wrong with a picture: never black without a word.

use crate::render::Picture;
use firstlight::SceneDescription;
use firstlight::color::{View, srgb_code8};
use firstlight::diagnostic::Diagnostic;
use firstlight::io::{Develop, Format};
use firstlight::scene::description::{FilmDescription, Integrator};

/// The part of a picture that may be cut off at white without a word.
const CLIPPED: f64 = 0.05;
/// Display values from here on are not just white but brighter.
const WHITE: f32 = 1.01;

/// What is odd about a scene that a picture is to be made of, as far as that shows before.
pub(crate) fn foresee(scene: &SceneDescription) -> Option<Diagnostic> {
    let empty = scene.surfaces.is_empty();
    empty
        .then(|| Diagnostic::new("", "the scene has no surfaces: the picture is background"))
        .or_else(|| unlit(scene))
}

/// A warning if a background is to be transparent in a format that is not.
pub(crate) fn opaque(scene: &SceneDescription, format: Format) -> Option<Diagnostic> {
    let opaque = scene.film.transparent && matches!(format, Format::Hdr | Format::Pfm);
    opaque.then(|| {
        Diagnostic::new("", "this format has no alpha: the transparent background will be black")
            .help("write a .png or .exr")
    })
}

/// A warning if no light and no emission can reach anything there is.
pub(crate) fn unlit(scene: &SceneDescription) -> Option<Diagnostic> {
    let emits = |material: usize| {
        let emission = scene.materials.get(material).map(|material| material.emission.factor);
        emission.is_some_and(|[r, g, b, _]| r.max(g).max(b) > 0.0)
    };
    let dark = scene.lights.is_empty()
        && scene.environment.is_none()
        && !matches!(scene.integrator, Integrator::AmbientOcclusion { .. })
        && !scene.surfaces.iter().any(|s| emits(s.material));
    (dark && !scene.surfaces.is_empty()).then(|| {
        Diagnostic::new("", "there are no lights, and nothing emits light: all surfaces are black")
            .help("add a light, such as -D 'lights.head.camera.irradiance=3' for one at the camera")
    })
}

/// Everything that is odd about a picture.
pub(crate) fn judge(scene: &SceneDescription, picture: &Picture) -> Vec<Diagnostic> {
    let warnings = [dropped(picture), dark(scene, picture), clipped(scene, picture)];
    warnings.into_iter().flatten().collect()
}

fn dropped(Picture { rendered, .. }: &Picture) -> Option<Diagnostic> {
    let [x, y] = rendered.first_dropped?;
    let message = format!("{} samples were not finite and were dropped", rendered.dropped);
    let error = Diagnostic::new("", message).at_part(format!("pixel ({x}, {y})"));
    Some(error.help("look for lights and materials with very large numbers"))
}

fn dark(scene: &SceneDescription, picture: &Picture) -> Option<Diagnostic> {
    let rendered = &picture.rendered;
    if rendered.samples == 0 || foresee(scene).is_some() {
        return None;
    }
    if rendered.surface_rays == 0 {
        let error = Diagnostic::new("", "nothing is in front of the camera: all is background");
        return Some(error.help("try --camera frame, which shows everything"));
    }
    if rendered.brightest <= 0.0 {
        let error = Diagnostic::new("", "no light reaches what the camera sees: it is all black");
        return Some(error.help("add a light, or move the lights there are"));
    }
    let (exposure_ev, view) = (picture.exposure_ev as f32, scene.film.view);
    let develop = Develop { exposure_ev, view, dither: false };
    let [shown, ..] = develop.display([rendered.brightest, 0.0, 0.0, 1.0]);
    let black = is_developed(picture.format) && srgb_code8(shown) == 0;
    black.then(|| {
        Diagnostic::new("", "what the camera sees is so dim that it comes out black").help(
            match picture.auto_exposure {
                true => "use stronger lights",
                false => "try --exposure auto, or stronger lights",
            },
        )
    })
}

fn clipped(scene: &SceneDescription, picture: &Picture) -> Option<Diagnostic> {
    let gain = picture.exposure_ev.exp2() as f32;
    let covered = picture.rendered.image.pixels().iter().filter(|pixel| pixel[3] > 0.0);
    let mut levels: Vec<f32> = covered.map(|&[r, g, b, _]| r.max(g).max(b)).collect();
    let too_bright = levels.iter().filter(|&&level| gain * level > WHITE).count();
    let part = too_bright as f64 / levels.len().max(1) as f64;
    let cuts = matches!(scene.film.view, View::Srgb | View::Raw);
    let warn = is_developed(picture.format) && cuts && part > CLIPPED;
    warn.then(|| {
        let message = format!("{:.0} % of the picture is brighter than white", 100.0 * part);
        let help = match unclipped(&mut levels) {
            Some(ev) => format!("try --exposure {ev:.2} or --view neutral"),
            None => "use weaker lights".into(),
        };
        Diagnostic::new("", message).help(help)
    })
}

/// The greatest exposure at which no more than [`CLIPPED`] of the levels are brighter than white, if there is one.
fn unclipped(levels: &mut [f32]) -> Option<f64> {
    let rank = ((1.0 - CLIPPED) * levels.len() as f64).ceil() as usize;
    let (_, level, _) = levels.select_nth_unstable_by(rank.checked_sub(1)?, f32::total_cmp);
    let ev = (-100.0 * f64::from(*level).log2()).floor() / 100.0;
    (ev.abs() <= FilmDescription::MOST_STOPS).then_some(ev)
}

/// Whether the exposure is part of the file.
fn is_developed(format: Format) -> bool {
    matches!(format, Format::Png { .. })
}
