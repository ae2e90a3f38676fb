//! Images: decoded once each and only if a material shows them.

use super::data::Data;
use super::document::{Image, Texture};
use super::notes::Notes;
use super::uri::Uri;
use crate::diagnostic::Result;
use crate::io::pixels;
use crate::scene::description::{Pixels, Texels};
use std::sync::Arc;

/// The pictures read so far.
pub(super) struct Pictures {
    /// They go into the scene.
    pub(super) images: Vec<Arc<Pixels>>,
    /// For each image of the document, once it was asked for: its place in `images` or, if broken, `None`.
    places: Vec<Option<Option<usize>>>,
    left: u64,
}

impl Pictures {
    pub(super) fn new(data: &Data) -> Self {
        // Four pictures of the largest size allowed, or many of the usual ones.
        let left = data.access.limits.decoded_bytes.saturating_mul(4);
        Self { images: Vec::new(), places: vec![None; data.document.images.len()], left }
    }

    /// The picture of a texture, as its place in `images`; `None`, with a note that says what is shown `otherwise`, if it
    /// cannot be shown.
    ///
    /// # Errors
    /// If the texture or its image does not exist.
    pub(super) fn of_texture(
        &mut self,
        data: &Data,
        texture: &Texture,
        part: &str,
        otherwise: &str,
        notes: &mut Notes,
    ) -> Result<Option<usize>> {
        let extensions = texture.extensions.as_ref();
        let webp = extensions.and_then(|e| e.webp.as_ref()).map(|webp| webp.source);
        let basisu = extensions.and_then(|e| e.basisu.as_ref()).map(|basisu| basisu.source);
        // Where there is another, it was compressed less.
        let Some(index) = webp.or(texture.source).or(basisu) else {
            let other = extensions.is_some_and(|e| e.avif.is_some() || e.dds.is_some());
            let cause = match other {
                true => "this picture is only there in a format that cannot be read (AVIF or DDS)",
                false => "this texture has no picture",
            };
            notes.add_missing(part, format!("{cause}; {otherwise}"), None);
            return Ok(None);
        };
        let image = data.at(&data.document.images, index, "image", &format!("{part}.source"))?;
        let known = self.places.get(index as usize).copied().flatten();
        if let Some(place) = known {
            return Ok(place);
        }
        let place = self.read(data, image, index, otherwise, notes);
        if let Some(slot) = self.places.get_mut(index as usize) {
            *slot = Some(place);
        }
        Ok(place)
    }

    fn read(
        &mut self,
        data: &Data,
        image: &Image,
        index: u32,
        otherwise: &str,
        notes: &mut Notes,
    ) -> Option<usize> {
        let part = format!("images[{index}]");
        match self.decode(data, image, &part, notes) {
            Ok(picture) => {
                self.images.push(Arc::new(picture));
                Some(self.images.len() - 1)
            }
            Err(cause) => {
                let message = match shown_name(image) {
                    Some(name) => format!("{name}: {}; {otherwise}", cause.message),
                    None => format!("{}; {otherwise}", cause.message),
                };
                notes.add_missing(part, message, cause.help);
                None
            }
        }
    }

    fn decode(
        &mut self,
        data: &Data,
        image: &Image,
        part: &str,
        notes: &mut Notes,
    ) -> Result<Pixels> {
        let file: Vec<u8>;
        let bytes = match (&image.uri, image.buffer_view) {
            (Some(uri), _) => {
                file = match Uri::parse(uri).map_err(|cause| data.error(part, cause))? {
                    Uri::Data(bytes) => bytes,
                    Uri::File(name) => {
                        let (bytes, meant) = data.access.read_meant(&name)?;
                        if let Some(meant) = meant {
                            notes.add(
                                part,
                                format!("{name} cannot be opened here; {meant} is taken"),
                            );
                        }
                        bytes
                    }
                };
                &file
            }
            (None, Some(view)) => data.view(view, &format!("{part}.bufferView"))?.0,
            (None, None) => return Err(data.error(part, "has neither uri nor bufferView")),
        };
        let name = shown_name(image).map_or_else(|| part.to_owned(), str::to_owned);
        let mut limits = data.access.limits;
        limits.decoded_bytes = limits.decoded_bytes.min(self.left);
        let decoded = pixels::decode(bytes, &name, &limits);
        // A broken picture may have taken as long as a good one.
        let spent = decoded.as_ref().map_or(data.access.limits.decoded_bytes / 16, bytes_of);
        self.left = self.left.saturating_sub(spent);
        decoded
    }
}

/// What a person would call this image; not the whole of a data URI.
fn shown_name(image: &Image) -> Option<&str> {
    let uri = image.uri.as_deref().filter(|uri| !uri.starts_with("data:"));
    uri.or(image.name.as_deref())
}

fn bytes_of(picture: &Pixels) -> u64 {
    match &picture.texels {
        Texels::Srgb8(texels) => 4 * texels.len() as u64,
        Texels::Srgb16(texels) => 8 * texels.len() as u64,
        Texels::Linear(texels) => 16 * texels.len() as u64,
    }
}
