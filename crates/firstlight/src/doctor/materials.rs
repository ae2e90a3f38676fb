//! Materials that reflect more than they get, or that are not there.

use super::{Care, finding, named};
use crate::diagnostic::Diagnostic;
use crate::scene::description::{
    Alpha, Material, Pattern, Scattering, SceneDescription, Texels, Texture,
};
use std::collections::BTreeSet;

/// Of what is less opaque, nothing is seen.
const HARDLY: f32 = 0.02;
/// Rounding of colours that were converted.
const ROUNDING: f32 = 1e-3;

/// Everything that is odd about the materials that surfaces have.
pub(super) fn examine(scene: &SceneDescription, care: Care) -> Vec<Diagnostic> {
    let bright = used(scene).into_iter().filter_map(|material| too_bright(scene, material, care));
    bright.chain(gone(scene, care)).collect()
}

/// Those that are nowhere there.
pub(super) fn gone(scene: &SceneDescription, care: Care) -> impl Iterator<Item = Diagnostic> {
    used(scene).into_iter().filter_map(move |material| invisible(scene, material, care))
}

/// The materials that surfaces have.
fn used(scene: &SceneDescription) -> Vec<&Material> {
    let numbers: BTreeSet<usize> = scene.surfaces.iter().map(|surface| surface.material).collect();
    numbers.into_iter().map(|number| &scene.materials[number]).collect()
}

fn too_bright(scene: &SceneDescription, material: &Material, care: Care) -> Option<Diagnostic> {
    let mirrored = match &material.scattering {
        Scattering::Mirror { mirrored } => Some(mirrored),
        _ => None,
    };
    let textures = [Some(&material.reflectance), mirrored];
    let most = |texture: &Texture| brightest(scene, texture, care);
    let value = textures.into_iter().flatten().map(most).fold(0.0, f32::max);
    (value > 1.0 + ROUNDING).then(|| {
        let message =
            format!("reflects {value:.2} times the light it gets; no surface reflects more than 1");
        let help = "use colors of 0 to 1, such as \"#c0392b\"; to shine, it needs an emission";
        finding("reflectance-above-one", named("material", &material.name), message).help(help)
    })
}

/// The largest value of a texture's channels; those of pictures only if there is time.
fn brightest(scene: &SceneDescription, texture: &Texture, care: Care) -> f32 {
    let [r, g, b, _] = texture.factor;
    let pattern = match &texture.pattern {
        Pattern::Constant => 1.0,
        Pattern::Checker { colors, .. }
        | Pattern::Gradient { colors, .. }
        | Pattern::Noise { colors, .. } => {
            colors.iter().flat_map(|color| &color[..3]).copied().fold(0.0, f32::max)
        }
        Pattern::Image { image, .. } => match &scene.images[*image].texels {
            Texels::Linear(texels) if care == Care::Thorough => {
                texels.iter().flat_map(|texel| &texel[..3]).copied().fold(0.0, f32::max)
            }
            _ => 1.0,
        },
    };
    r.max(g).max(b) * pattern
}

fn invisible(scene: &SceneDescription, material: &Material, care: Care) -> Option<Diagnostic> {
    let opacity = most_opaque(scene, &material.reflectance, care);
    let (gone, why) = match material.alpha {
        Alpha::Opaque => (false, String::new()),
        Alpha::Blend if opacity > 0.0 => (
            opacity < HARDLY,
            format!("its alpha is at most {opacity}, from 0 (not there) to 1 (solid)"),
        ),
        Alpha::Blend => (true, "its alpha is 0 everywhere".into()),
        Alpha::Mask { cutoff } => (
            opacity < cutoff,
            format!("its alpha is at most {opacity:.2}, below the cutoff {cutoff:.2}"),
        ),
    };
    (gone && !passes_anyway(material)).then(|| {
        finding(
            "material-invisible",
            named("material", &material.name),
            format!(
                "is {} there: {why}",
                if opacity > 0.0 && material.alpha == Alpha::Blend { "hardly" } else { "nowhere" }
            ),
        )
        .help("set its opacity, the alpha of its color, or a lower alpha_cutoff")
    })
}

/// Glass is there even if its colour is not.
fn passes_anyway(material: &Material) -> bool {
    material.interior.is_some() || material.is_pane()
}

/// The largest alpha of a texture; of pictures only if there is time.
fn most_opaque(scene: &SceneDescription, texture: &Texture, care: Care) -> f32 {
    let pattern = match &texture.pattern {
        Pattern::Image { image, .. } if care == Care::Thorough => {
            match &scene.images[*image].texels {
                Texels::Srgb8(texels) => {
                    texels.iter().map(|texel| f32::from(texel[3]) / 255.0).fold(0.0, f32::max)
                }
                Texels::Srgb16(texels) => {
                    texels.iter().map(|texel| f32::from(texel[3]) / 65535.0).fold(0.0, f32::max)
                }
                Texels::Linear(texels) => texels.iter().map(|texel| texel[3]).fold(0.0, f32::max),
            }
        }
        Pattern::Checker { colors: [a, b], .. }
        | Pattern::Gradient { colors: [a, b], .. }
        | Pattern::Noise { colors: [a, b], .. } => a[3].max(b[3]),
        _ => 1.0,
    };
    texture.factor[3] * pattern
}
