//! The pictures that model files name: opened once each, with a stand-in for those that cannot be used.

use super::text::quoted;
use super::{FileAccess, Warnings, pixels};
use crate::diagnostic::{Diagnostic, Place, Result};
use crate::scene::description::{Pattern, Pixels, Sampling, Texels, Texture, UvTransform, Wrap};
use std::collections::HashMap;
use std::sync::Arc;

/// The doctor's code for pictures that cannot be used.
pub(super) const MISSING: &str = "texture-missing";

/// The pictures of one model.
pub(super) struct Pictures<'a> {
    access: &'a FileAccess,
    known: HashMap<String, Option<usize>>,
    /// Those that could be read, as [`Pattern::Image`] numbers them.
    pub(super) images: Vec<Arc<Pixels>>,
}

impl<'a> Pictures<'a> {
    /// Opens pictures with `access`.
    pub(super) fn new(access: &'a FileAccess) -> Self {
        Self { access, known: HashMap::new(), images: Vec::new() }
    }

    /// The picture `file`, named at `place`, over the first set of texture coordinates, times `factor`.
    ///
    /// If it cannot be used, a warning says so and a checker of magenta and black is in its place.
    pub(super) fn texture(
        &mut self,
        file: &str,
        factor: [f32; 4],
        (transform, wrap): (UvTransform, Wrap),
        place: Place,
        warnings: &mut Warnings,
    ) -> Texture {
        let Some(image) = self.number(file, place, warnings) else {
            return Texture::stand_in();
        };
        let wrap = [wrap, wrap];
        let sampling = Sampling::default();
        let pattern = Pattern::Image { image, uv_set: 0, transform, wrap, sampling };
        Texture { factor, pattern, vertex_colors: false }
    }

    /// Whether the picture that `texture` shows is transparent anywhere.
    pub(super) fn is_transparent(&self, texture: &Texture) -> bool {
        let Pattern::Image { image, .. } = texture.pattern else { return false };
        self.images.get(image).is_some_and(|pixels| match &pixels.texels {
            Texels::Srgb8(texels) => texels.iter().any(|texel| texel[3] < u8::MAX),
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
            Texels::Linear(texels) => texels.iter().any(|[r, g, b, _]| r != g || g != b),
        })
    }

    fn number(&mut self, file: &str, place: Place, warnings: &mut Warnings) -> Option<usize> {
        if let Some(&number) = self.known.get(file) {
            return number;
        }
        let number = match self.open(file) {
            Ok(pixels) => {
                self.images.push(Arc::new(pixels));
                Some(self.images.len() - 1)
            }
            Err(error) => {
                let message = format!(
                    "cannot use the picture {}: {}",
                    quoted(file.as_bytes()),
                    error.message
                );
                let help = Some("magenta and black squares stand in for it".into());
                let code = MISSING;
                warnings.push(Diagnostic { message, place, help, code });
                None
            }
        };
        self.known.insert(file.to_owned(), number);
        number
    }

    /// Reads `file`, or if it is not there, a file of that name beside the model.
    fn open(&self, file: &str) -> Result<Pixels> {
        let bytes = self.access.read(file).or_else(|error| {
            let beside = file.rsplit(['/', '\\']).next().filter(|beside| *beside != file);
            beside.and_then(|beside| self.access.read(beside).ok()).ok_or(error)
        })?;
        pixels::decode(&bytes, file, &self.access.limits)
    }
}
