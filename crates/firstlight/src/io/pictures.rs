//! The pictures that model files name: opened once each, with a stand-in for those that cannot be used.

use super::text::{Tally, counted, quoted};
use super::{FileAccess, Warnings, pixels};
use crate::diagnostic::{Diagnostic, Place, Result};
use crate::scene::description::{Pattern, Pixels, Sampling, Texels, Texture, UvTransform, Wrap};
use crate::shading::texture::{Role, texel};
use std::collections::HashMap;
use std::sync::Arc;

/// The doctor's code for pictures that cannot be used.
pub(super) const MISSING: &str = "texture-missing";

/// A picture as a model names it.
pub(super) struct Named<'a> {
    pub(super) file: &'a str,
    /// What multiplies it, RGBA.
    pub(super) factor: [f32; 4],
    pub(super) transform: UvTransform,
    pub(super) wrap: Wrap,
    /// How its values are changed before, if they are.
    pub(super) range: Option<Range>,
    /// Where it is named.
    pub(super) place: Place,
    /// What is shown if it cannot be used.
    pub(super) otherwise: &'static str,
}

/// What is shown of colours whose picture cannot be used.
pub(super) const SQUARES: &str = "magenta and black squares stand in for it";

/// Values of a picture, times `gain`, plus `base`, as far as they stay from 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Range {
    /// What its values are.
    pub(super) role: Role,
    pub(super) gain: f32,
    pub(super) base: f32,
}

impl Range {
    fn apply(self, pixels: &Pixels) -> Pixels {
        let changed = |index| {
            let [rgb @ .., a] = texel(pixels, index, self.role).to_array();
            let [r, g, b] = rgb.map(|value| (self.base + self.gain * value).clamp(0.0, 1.0));
            [r, g, b, a]
        };
        let count = pixels.width as usize * pixels.height as usize;
        let texels = Texels::Linear((0..count).map(changed).collect());
        Pixels { name: pixels.name.clone(), texels, ..*pixels }
    }
}

/// The pictures of one model.
pub(super) struct Pictures<'a> {
    access: &'a FileAccess,
    known: HashMap<String, Option<usize>>,
    /// Pictures by their number, with changed values.
    ranges: Vec<(usize, Range, usize)>,
    images: Vec<Arc<Pixels>>,
    /// Those that are not where the model says.
    moved: Tally,
    /// The first of them, as it is named and as it was found.
    example: String,
}

impl<'a> Pictures<'a> {
    /// Opens pictures with `access`.
    pub(super) fn new(access: &'a FileAccess) -> Self {
        Self {
            access,
            known: HashMap::new(),
            ranges: Vec::new(),
            images: Vec::new(),
            moved: Tally::default(),
            example: String::new(),
        }
    }

    /// Those that could be read, as [`Pattern::Image`] numbers them.
    pub(super) fn finish(self, warnings: &mut Warnings) -> Vec<Arc<Pixels>> {
        self.moved.warn(warnings, |count| match count {
            1 => format!("a picture is not where the model says: {}", self.example),
            _ => format!(
                "{} are not where the model says, such as {}",
                counted(count, "picture"),
                self.example
            ),
        });
        self.images
    }

    /// The picture `named`, over the first set of texture coordinates.
    ///
    /// If it cannot be used, a warning says so and a checker of magenta and black is in its place.
    pub(super) fn texture(&mut self, named: Named<'_>, warnings: &mut Warnings) -> Texture {
        let Some(image) = self.number(&named, warnings) else {
            return Texture::stand_in();
        };
        let image = named.range.map_or(image, |range| self.ranged(image, range));
        let Named { factor, transform, wrap, .. } = named;
        let (wrap, sampling) = ([wrap, wrap], Sampling::default());
        let pattern = Pattern::Image { image, uv_set: 0, transform, wrap, sampling };
        Texture { factor, pattern, vertex_colors: false }
    }

    /// The number of a picture with changed values.
    fn ranged(&mut self, image: usize, range: Range) -> usize {
        let known = self.ranges.iter().find(|(from, by, _)| (*from, *by) == (image, range));
        if let Some((.., number)) = known {
            return *number;
        }
        self.images.push(Arc::new(range.apply(&self.images[image])));
        self.ranges.push((image, range, self.images.len() - 1));
        self.images.len() - 1
    }

    /// Whether the picture that `texture` shows is transparent anywhere.
    pub(super) fn is_transparent(&self, texture: &Texture) -> bool {
        let Pattern::Image { image, .. } = texture.pattern else { return false };
        self.images.get(image).is_some_and(|pixels| match &pixels.texels {
            Texels::Srgb8(texels) => texels.iter().any(|texel| texel[3] < u8::MAX),
            Texels::Srgb16(texels) => texels.iter().any(|texel| texel[3] < u16::MAX),
            Texels::Linear(texels) => texels.iter().any(|texel| texel[3] < 1.0),
        })
    }

    /// Whether the picture that `texture` shows has colours, and not only greys.
    pub(super) fn is_colored(&self, texture: &Texture) -> bool {
        let Pattern::Image { image, .. } = texture.pattern else { return false };
        // JPEG's greys are a little off.
        let differ = |[r, g, b, _]: [u8; 4]| r.abs_diff(g).max(g.abs_diff(b)) > 12;
        self.images.get(image).is_some_and(|pixels| match &pixels.texels {
            Texels::Srgb8(texels) => texels.iter().any(|&texel| differ(texel)),
            Texels::Srgb16(texels) => texels.iter().any(|[r, g, b, _]| r != g || g != b),
            Texels::Linear(texels) => texels.iter().any(|[r, g, b, _]| r != g || g != b),
        })
    }

    fn number(&mut self, named: &Named<'_>, warnings: &mut Warnings) -> Option<usize> {
        let Named { file, place, otherwise, .. } = named;
        if let Some(&number) = self.known.get(*file) {
            return number;
        }
        let number = match self.open(file, place) {
            Ok(pixels) => {
                self.images.push(Arc::new(pixels));
                Some(self.images.len() - 1)
            }
            Err(error) => {
                let name = quoted(file.as_bytes());
                let message = format!("cannot use the picture {name}: {}", error.message);
                let advice = error.help.map(|help| help + "; ").unwrap_or_default();
                let help = Some(advice + otherwise);
                warnings.push(Diagnostic { message, place: place.clone(), help, code: MISSING });
                None
            }
        };
        self.known.insert((*file).to_owned(), number);
        number
    }

    /// Reads `file`, or what it must have meant.
    fn open(&mut self, file: &str, place: &Place) -> Result<Pixels> {
        let (bytes, meant) = self.access.read_meant(file)?;
        if let Some(meant) = meant {
            if self.example.is_empty() {
                let [file, meant] = [file, &meant].map(|name| quoted(name.as_bytes()));
                self.example = format!("{file}, for which {meant} is taken");
            }
            self.moved.add(|| place.clone());
        }
        pixels::decode(&bytes, file, &self.access.limits)
    }
}
