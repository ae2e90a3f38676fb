//! The pictures that model files name: opened once each, with a stand-in for those that cannot be used.

use super::text::{Tally, counted, quoted};
use super::{FileAccess, Limits, Warnings, pixels};
use crate::diagnostic::{Diagnostic, Place, Result};
use crate::scene::description::{Pattern, Pixels, Sampling, Texels, Texture, UvTransform, Wrap};
use crate::shading::texture::{Role, texel};
use glam::Vec4;
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

/// What is shown of a picture, and not a stand-in, whose colours are no numbers.
pub(super) fn only_picture(texture: Texture) -> Option<Texture> {
    matches!(texture.pattern, Pattern::Image { .. }).then_some(texture)
}

/// Values of a picture, RGBA, times `gain`, plus `base`, as far as they stay from 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Range {
    /// What its values are.
    pub(super) role: Role,
    pub(super) gain: Vec4,
    pub(super) base: Vec4,
    /// The channel that stands for all of them, if one does.
    pub(super) channel: Option<usize>,
}

impl Range {
    fn apply(self, pixels: &Pixels) -> Pixels {
        let changed = |index| {
            let texel = texel(pixels, index, self.role);
            let texel = self.channel.map_or(texel, |channel| Vec4::splat(texel[channel]));
            (self.base + self.gain * texel).clamp(Vec4::ZERO, Vec4::ONE).to_array()
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
    /// Pictures by their number, with changed values, if there was room for them.
    ranges: Vec<(usize, Range, Option<usize>)>,
    /// Bytes for more of them.
    left: u64,
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
            // Four of the largest size allowed, or many of the usual ones.
            left: access.limits.decoded_bytes.saturating_mul(4),
            images: Vec::new(),
            moved: Tally::default(),
            example: String::new(),
        }
    }

    /// Those that could be read, as [`Pattern::Image`] numbers them.
    pub(super) fn finish(self, warnings: &mut Warnings) -> Vec<Arc<Pixels>> {
        self.moved.warn(warnings, |count| match count {
            1 => format!("a picture cannot be opened where the model says: {}", self.example),
            _ => format!(
                "{} cannot be opened where the model says, such as {}",
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
        let image = self.number(&named, warnings);
        let image = image.and_then(|image| self.ranged(image, &named, warnings));
        let Some(image) = image else { return Texture::stand_in() };
        let Named { factor, transform, wrap, .. } = named;
        let (wrap, sampling) = ([wrap, wrap], Sampling::default());
        let pattern = Pattern::Image { image, uv_set: 0, transform, wrap, sampling };
        Texture { factor, pattern, vertex_colors: false }
    }

    /// The number of a picture with its values changed, if they are.
    fn ranged(
        &mut self,
        image: usize,
        named: &Named<'_>,
        warnings: &mut Warnings,
    ) -> Option<usize> {
        let Some(range) = named.range else { return Some(image) };
        let known = self.ranges.iter().find(|(from, by, _)| (*from, *by) == (image, range));
        if let Some((.., number)) = known {
            return *number;
        }
        let changed = self.changed(image, range);
        let number = self.add(changed, named, warnings);
        self.ranges.push((image, range, number));
        number
    }

    /// A copy of a picture with changed values, of 16 bytes a pixel.
    fn changed(&mut self, image: usize, range: Range) -> Result<Pixels> {
        let pixels = &self.images[image];
        let limits = Limits { decoded_bytes: self.access.limits.decoded_bytes.min(self.left) };
        let input = pixels::Input { bytes: &[], name: &pixels.name, limits: &limits };
        let count = input.room_for(pixels.width.into(), pixels.height.into(), 16)?;
        self.left -= 16 * count as u64;
        Ok(range.apply(pixels))
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
        if let Some(&number) = self.known.get(named.file) {
            return number;
        }
        let opened = self.open(named.file, &named.place);
        let number = self.add(opened, named, warnings);
        self.known.insert(named.file.to_owned(), number);
        number
    }

    /// The number of a new picture; if there is none, a warning says why.
    fn add(
        &mut self,
        pixels: Result<Pixels>,
        named: &Named<'_>,
        warnings: &mut Warnings,
    ) -> Option<usize> {
        match pixels {
            Ok(pixels) => {
                self.images.push(Arc::new(pixels));
                Some(self.images.len() - 1)
            }
            Err(error) => {
                let Named { file, otherwise, .. } = named;
                let name = quoted(file.as_bytes());
                let message = format!("cannot use the picture {name}: {}", error.message);
                let advice = error.help.map(|help| help + "; ").unwrap_or_default();
                let (help, place) = (Some(advice + otherwise), named.place.clone());
                warnings.push(Diagnostic { message, place, help, code: MISSING });
                None
            }
        }
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
