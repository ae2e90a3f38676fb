//! Pictures on surfaces: without coordinates to lie on, read with the wrong curve, or of one colour.

use super::{Care, finding, named, percent, quoted};
use crate::diagnostic::Diagnostic;
use crate::scene::description::{
    Material, Pattern, Pixels, SceneDescription, Shape, Texels, Texture,
};
use std::collections::{BTreeMap, BTreeSet};

/// Surfaces that are looked at before every render.
const FEW_SURFACES: usize = 4096;
/// Texels of a picture that are looked at, about.
const TEXELS: usize = 1 << 16;
/// How far the mean of normals may be from what it is compared with.
const NEAR: f32 = 0.04;
/// What 0.5 becomes if it is taken for an sRGB code, and what it becomes as one.
const DECODED: f32 = 0.214;
const ENCODED: f32 = 0.735;
/// How far the length of a normal may be from 1.
const UNLIKE: f32 = 0.25;
/// Pictures smaller than this stand for a constant.
const SMALL: u32 = 16;

/// Everything that is odd about pictures.
pub(super) fn examine(scene: &SceneDescription, care: Care) -> Vec<Diagnostic> {
    let count = if care == Care::Quick { FEW_SURFACES } else { usize::MAX };
    let mut found: Vec<_> = without_coordinates(scene, count).into_iter().collect();
    if care == Care::Thorough {
        found.extend(scene.materials.iter().filter_map(|material| normals(scene, material)));
        found.extend(scene.materials.iter().find_map(|material| no_normals(scene, material)));
        let mut roles = Roles::of(scene);
        found.extend(roles.mixed(scene));
        found.extend(roles.flat(scene));
        found.extend(roles.normals_as_colors(scene));
    }
    found
}

fn image_of(texture: &Texture) -> Option<(usize, usize)> {
    match texture.pattern {
        Pattern::Image { image, uv_set, .. } => Some((image, uv_set)),
        _ => None,
    }
}

/// The first mesh with a picture on it and no coordinates for it.
fn without_coordinates(scene: &SceneDescription, count: usize) -> Option<Diagnostic> {
    let mut lost = scene.surfaces.iter().take(count).filter_map(|surface| {
        let Shape::Mesh(mesh) = surface.shape else { return None };
        let mesh = &scene.meshes[mesh];
        let material = &scene.materials[surface.material];
        let has = |set: usize| mesh.uvs.get(set).is_some_and(|uvs| !uvs.is_empty());
        let missing =
            material.textures().into_iter().filter_map(image_of).find(|(_, set)| !has(*set));
        missing.map(|(image, set)| (surface, image, set))
    });
    let (surface, image, set) = lost.next()?;
    let more = match lost.count() {
        0 => String::new(),
        more => format!(" (and so on {more} more surfaces)"),
    };
    let message = format!(
        "has no texture coordinates (set {set}) for picture {}: one texel of it covers everything{more}",
        quoted(&scene.images[image].name)
    );
    let help =
        "unwrap the mesh in the program it was made with, or give it a material without pictures";
    Some(finding("texture-uvs", named("surface", &surface.name), message).help(help))
}

/// A normal map whose numbers went through the sRGB curve: flat ground is 0.5, and there it is not.
fn normals(scene: &SceneDescription, material: &Material) -> Option<Diagnostic> {
    let map = material.normal.as_ref()?;
    let (image, _) = image_of(&map.texture)?;
    let pixels = &scene.images[image];
    let [r, g, b, _] = mean(pixels);
    let both = |value: f32| (r - value).abs() < NEAR && (g - value).abs() < NEAR;
    let message = match () {
        () if b < 0.5 => return None,
        () if both(DECODED) => {
            "was decoded like a colour: its flat ground is (0.21, 0.21) instead of (0.5, 0.5)"
        }
        () if both(ENCODED) => {
            "was encoded like a colour: its flat ground is (0.73, 0.73) instead of (0.5, 0.5)"
        }
        () => return None,
    };
    let message = format!("normal map {} {message}", quoted(&pixels.name));
    let help = "export it as plain numbers (\"non-color\", \"raw\" or \"linear\")";
    Some(finding("texture-curve", named("material", &material.name), message).help(help))
}

/// A normal map that holds something else: most of its texels are no unit vectors that point out of the surface.
fn no_normals(scene: &SceneDescription, material: &Material) -> Option<Diagnostic> {
    let (image, _) = image_of(&material.normal.as_ref()?.texture)?;
    if normals(scene, material).is_some() {
        return None;
    }
    let pixels = &scene.images[image];
    let samples = samples(pixels);
    let may_be = |s: &&[f32; 4]| s[2] > 0.5 && (length(s) - 1.0).abs() < UNLIKE;
    let part = samples.iter().filter(may_be).count() as f64 / samples.len().max(1) as f64;
    (part < 0.5).then(|| {
        let grey = samples.iter().all(|[r, g, b, _]| r == g && g == b);
        let (what, help) = match grey {
            true => ("heights", "use it as bump, or make normals of it (\"height to normal\")"),
            false => ("colours", "use the picture that is blue all over (\"normal\", \"nrm\"), and this one as a color"),
        };
        let message = format!(
            "uses {} as a map of normals, and it looks like {what}: {} of it are no directions out of the surface",
            quoted(&pixels.name),
            percent(1.0 - part)
        );
        finding("texture-normals", named("material", &material.name), message).help(help)
    })
}

/// How long the vector is that a texel of a normal map stands for.
fn length(s: &[f32; 4]) -> f32 {
    let [x, y, z] = [s[0], s[1], s[2]].map(|value| 2.0 * value - 1.0);
    (x * x + y * y + z * z).sqrt()
}

/// Which materials read which picture, as colours and as numbers.
struct Roles {
    colors: BTreeMap<usize, String>,
    numbers: BTreeMap<usize, String>,
}

impl Roles {
    fn of(scene: &SceneDescription) -> Self {
        let used: BTreeSet<usize> = scene.surfaces.iter().map(|s| s.material).collect();
        let (mut colors, mut numbers) = (BTreeMap::new(), BTreeMap::new());
        for material in used.iter().map(|&i| &scene.materials[i]) {
            let all = material.color_textures();
            let is_color =
                |texture: &Texture| all.iter().any(|color| std::ptr::eq(*color, texture));
            for texture in material.textures() {
                let Some((image, _)) = image_of(texture) else { continue };
                let roles = if is_color(texture) { &mut colors } else { &mut numbers };
                roles.entry(image).or_insert_with(|| material.name.clone());
            }
        }
        Self { colors, numbers }
    }

    /// Normals that are shown as colours: most are (0.5, 0.5, 1), and all have length 1.
    fn normals_as_colors(&mut self, scene: &SceneDescription) -> Option<Diagnostic> {
        let (image, material) =
            self.colors.iter().find(|(image, _)| looks_like_normals(&scene.images[**image]))?;
        let message = format!(
            "reads {} as colours, and it looks like a map of normals",
            quoted(&scene.images[*image].name)
        );
        let help = "use it as normal_map (glTF: normalTexture), and a picture of colours instead";
        Some(finding("texture-curve", named("material", material), message).help(help))
    }

    /// A picture that is both.
    fn mixed(&self, scene: &SceneDescription) -> Option<Diagnostic> {
        let colored = |image: &usize| match &scene.images[*image].texels {
            Texels::Srgb8(texels) => !is_grey(texels),
            Texels::Srgb16(texels) => !is_grey(texels),
            Texels::Linear(_) => true,
        };
        let (image, material) = self
            .colors
            .iter()
            .find(|(image, _)| self.numbers.contains_key(image) && colored(image))?;
        let message = format!(
            "reads {} as colours, and material {} reads it as numbers",
            quoted(&scene.images[*image].name),
            quoted(&self.numbers[image])
        );
        let help = "sRGB pictures are one or the other: use a picture of its own for each";
        Some(finding("texture-role", named("material", material), message).help(help))
    }

    /// A picture of colours that has one.
    fn flat(&self, scene: &SceneDescription) -> Option<Diagnostic> {
        let is_flat = |image: &usize| {
            let pixels = &scene.images[*image];
            let large = pixels.width.min(pixels.height) >= SMALL;
            large
                && match &pixels.texels {
                    Texels::Srgb8(texels) => texels.iter().all(|texel| *texel == texels[0]),
                    Texels::Srgb16(texels) => texels.iter().all(|texel| *texel == texels[0]),
                    Texels::Linear(texels) => texels.iter().all(|texel| *texel == texels[0]),
                }
        };
        let (image, material) = self.colors.iter().find(|(image, _)| is_flat(image))?;
        let pixels = &scene.images[*image];
        let [r, g, b, _] = mean(pixels);
        let message = format!(
            "picture {} has one colour everywhere, ({r:.2}, {g:.2}, {b:.2})",
            quoted(&pixels.name)
        );
        let help = "is it the right file? A colour needs no picture";
        Some(finding("texture-flat", named("material", material), message).help(help))
    }
}

fn is_grey<T: PartialEq>(texels: &[[T; 4]]) -> bool {
    texels.iter().step_by(texels.len() / TEXELS + 1).all(|[r, g, b, _]| r == g && g == b)
}

/// Numbers of some texels, codes taken as they are.
fn samples(pixels: &Pixels) -> Vec<[f32; 4]> {
    let step = pixels.width as usize * pixels.height as usize / TEXELS + 1;
    match &pixels.texels {
        Texels::Srgb8(texels) => texels
            .iter()
            .step_by(step)
            .map(|texel| texel.map(|code| f32::from(code) / 255.0))
            .collect(),
        Texels::Srgb16(texels) => texels
            .iter()
            .step_by(step)
            .map(|texel| texel.map(|code| f32::from(code) / 65535.0))
            .collect(),
        Texels::Linear(texels) => texels.iter().step_by(step).copied().collect(),
    }
}

fn mean(pixels: &Pixels) -> [f32; 4] {
    let samples = samples(pixels);
    let sum = |channel: usize| samples.iter().map(|s| f64::from(s[channel])).sum::<f64>();
    [0, 1, 2, 3].map(|channel| (sum(channel) / samples.len().max(1) as f64) as f32)
}

fn looks_like_normals(pixels: &Pixels) -> bool {
    let samples = samples(pixels);
    let [r, g, b, _] = mean(pixels);
    let middle = (r - 0.5).abs() < NEAR && (g - 0.5).abs() < NEAR && b > 0.8;
    let is_unit = |s: &&[f32; 4]| (length(s) - 1.0).abs() < 0.06;
    let bent = samples.iter().any(|s| (s[0] - 0.5).abs() > 0.05 || (s[1] - 0.5).abs() > 0.05);
    middle && bent && samples.iter().filter(is_unit).count() * 20 > samples.len() * 19
}
