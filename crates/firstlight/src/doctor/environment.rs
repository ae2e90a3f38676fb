//! Pictures of the surroundings that lack light, or have less than none.

use super::finding;
use crate::diagnostic::Diagnostic;
use crate::scene::description::{EnvironmentDescription, Pixels, SceneDescription, Sky, Texels};

/// The part of a picture's texels that may be cut off at white, or negative, without a word.
const FEW: f64 = 1e-5;

/// Everything that is odd about the picture of an environment, if there is one.
pub(super) fn examine(scene: &SceneDescription) -> Option<Diagnostic> {
    let EnvironmentDescription { sky: Sky::Picture { pixels, .. }, .. } =
        scene.environment.as_ref()?
    else {
        return None;
    };
    negative(pixels).or_else(|| clipped(pixels))
}

/// A picture whose brightest parts are cut off at white: a sun in it gives a hundred-thousandth of its light.
fn clipped(pixels: &Pixels) -> Option<Diagnostic> {
    let all = pixels.width as usize * pixels.height as usize;
    let white = match &pixels.texels {
        Texels::Srgb8(texels) => texels.iter().filter(|t| t[..3].contains(&u8::MAX)).count(),
        Texels::Srgb16(texels) => texels.iter().filter(|t| t[..3].contains(&u16::MAX)).count(),
        Texels::Linear(texels) if texels.iter().all(|t| t[..3].iter().all(|x| *x <= 1.0)) => {
            texels.iter().filter(|t| t[..3].contains(&1.0)).count()
        }
        Texels::Linear(_) => 0,
    };
    let few = (FEW * all as f64) as usize;
    // One colour everywhere is meant as it is.
    (white > few && white < all).then(|| {
        let message = format!(
            "picture \"{}\" ends at white, and {white} of its pixels are just that: the light that a sun or lamps in it had is lost",
            pixels.name
        );
        let help = "use an .hdr or .exr of it, or add the sun as a light of its own, [lights.sun.sun]";
        finding("environment-clipped", "environment".into(), message).help(help)
    })
}

/// A picture that takes light away.
fn negative(pixels: &Pixels) -> Option<Diagnostic> {
    let Texels::Linear(texels) = &pixels.texels else { return None };
    let least = |texel: &[f32; 4]| texel[..3].iter().copied().fold(0.0, f32::min);
    let count = texels.iter().filter(|texel| least(texel) < 0.0).count();
    (count as f64 > FEW * texels.len() as f64).then(|| {
        let lowest = texels.iter().map(least).fold(0.0, f32::min);
        let message = format!(
            "{count} pixels of picture \"{}\" are less than 0, down to {lowest}: there is no such light",
            pixels.name
        );
        let help = "raise them to 0 in the program it was made with; sharpening and changes of gamut make such numbers";
        finding("environment-negative", "environment".into(), message).help(help)
    })
}
