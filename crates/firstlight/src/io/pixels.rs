//! Pictures for textures: PNG, JPEG, WebP, HDR bytes → [`Pixels`].

use super::Limits;
use crate::diagnostic::{Diagnostic, Result};
use crate::scene::description::{Pixels, Texels};

/// Decodes a picture; 8-bit formats are taken as sRGB-encoded colour.
///
/// # Errors
/// If the format is unknown, the data is broken, or it would unpack to more than `limits` allow.
pub fn decode(bytes: &[u8], name: &str, limits: &Limits) -> Result<Pixels> {
    let fail = |cause: String| Box::new(Diagnostic::new(name, cause));
    let mut reader = image::ImageReader::new(std::io::Cursor::new(bytes))
        .with_guessed_format()
        .map_err(|e| fail(e.to_string()))?;
    let mut bounds = image::Limits::default();
    bounds.max_alloc = Some(limits.decoded_bytes);
    reader.limits(bounds);
    let picture = reader.decode().map_err(|e| fail(format!("cannot read this picture: {e}")))?;
    let (width, height) = (picture.width(), picture.height());
    let texels = picture.into_rgba8().pixels().map(|p| p.0).collect();
    Ok(Pixels { name: name.into(), width, height, texels: Texels::Srgb8(texels) })
}
