//! Pictures in the formats whose decoders the crate `image` brings: JPEG, WebP, TGA, BMP, TIFF, GIF.

use super::pixels::{Input, rgba, unreadable};
use crate::diagnostic::{Diagnostic, Result};
use crate::scene::description::Pixels;
use image::codecs::{
    bmp::BmpDecoder, gif::GifDecoder, jpeg::JpegDecoder, tga::TgaDecoder, tiff::TiffDecoder,
    webp::WebPDecoder,
};
use image::{ColorType, ImageDecoder, ImageError};
use std::io::Cursor;

/// More pixels than any of these formats puts into a byte of file; but WebP, in which one colour everywhere takes nothing.
const PACKED: u64 = 1 << 14;

pub(super) fn jpeg(input: &Input) -> Result<Pixels> {
    // The decoder would fill what is missing with grey. A block of 8 × 8 pixels takes at least a bit.
    if !jpeg_is_whole(input.bytes) {
        let help = "copy or download it again, or save it anew in a picture editor";
        return Err(input.fail("this JPEG is cut off: it has no end marker").help(help).into());
    }
    opened(input, 512, JpegDecoder::new(Cursor::new(input.bytes)))
}

/// Whether the segments of a JPEG lead to its end marker, as opposed to that of an embedded preview.
fn jpeg_is_whole(mut rest: &[u8]) -> bool {
    let is_marker =
        |pair: &[u8]| pair[0] == 0xFF && !matches!(pair[1], 0x00 | 0x01 | 0xD0..=0xD8 | 0xFF);
    while let Some(at) = rest.windows(2).position(is_marker) {
        match rest[at + 1..] {
            [0xD9, ..] => return true,
            [_, high, low, ..] => {
                let length = usize::from(u16::from_be_bytes([high, low]));
                rest = rest.get(at + 2 + length..).unwrap_or_default();
            }
            _ => return false,
        }
    }
    false
}

pub(super) fn webp(input: &Input) -> Result<Pixels> {
    opened(input, u64::MAX, WebPDecoder::new(Cursor::new(input.bytes)))
}

/// Whether these are the first bytes of a TGA: the format has no mark, so its header has to make sense as one.
pub(super) fn is_tga(bytes: &[u8]) -> bool {
    let Some(header) = bytes.first_chunk::<18>() else { return false };
    let [_, palette, kind, ..] = *header;
    let sized = header[12..14] != [0; 2] && header[14..16] != [0; 2];
    let kind_is_known = match kind {
        1 | 9 => palette == 1,
        2 | 3 | 10 | 11 => palette <= 1,
        _ => false,
    };
    sized && kind_is_known && matches!(header[16], 8 | 15 | 16 | 24 | 32)
}

pub(super) fn tga(input: &Input) -> Result<Pixels> {
    opened(input, 128, TgaDecoder::new(Cursor::new(input.bytes)))
}

pub(super) fn bmp(input: &Input) -> Result<Pixels> {
    opened(input, PACKED, BmpDecoder::new(Cursor::new(input.bytes)))
}

/// The first picture of the file.
pub(super) fn tiff(input: &Input) -> Result<Pixels> {
    opened(input, PACKED, TiffDecoder::new(Cursor::new(input.bytes)))
}

/// The first picture of the file, if it moves.
pub(super) fn gif(input: &Input) -> Result<Pixels> {
    opened(input, PACKED, GifDecoder::new(Cursor::new(input.bytes)))
}

/// Reads a picture whose header a decoder has understood; a byte of file holds at most `packed` of its pixels.
fn opened(
    input: &Input,
    packed: u64,
    decoder: std::result::Result<impl ImageDecoder, ImageError>,
) -> Result<Pixels> {
    let mut decoder = decoder.map_err(|e| refused(input, &e))?;
    let (width, height) = decoder.dimensions();
    let color = decoder.color_type();
    let sample_bytes = color.bytes_per_pixel() / color.channel_count();
    let count = input.room_for(width.into(), height.into(), 4 * u64::from(sample_bytes))?;
    input.at_least(count as u64 / packed)?;
    let mut limits = image::Limits::no_limits();
    // What is unpacked, and as much again on the way.
    limits.max_alloc = Some(2 * input.limits.decoded_bytes);
    decoder.set_limits(limits).map_err(|e| unreadable(input, &e))?;
    let channels = usize::from(color.channel_count());
    let mut bytes = vec![0; count * usize::from(color.bytes_per_pixel())];
    decoder.read_image(&mut bytes).map_err(|e| refused(input, &e))?;
    match color {
        ColorType::L8 | ColorType::La8 | ColorType::Rgb8 | ColorType::Rgba8 => {
            Ok(input.srgb(width, height, rgba(&bytes, channels, u8::MAX)))
        }
        ColorType::L16 | ColorType::La16 | ColorType::Rgb16 | ColorType::Rgba16 => {
            let samples: Vec<u16> =
                bytes.as_chunks().0.iter().map(|&b| u16::from_ne_bytes(b)).collect();
            Ok(input.deep(width, height, rgba(&samples, channels, u16::MAX)))
        }
        ColorType::Rgb32F | ColorType::Rgba32F => {
            let samples: Vec<f32> =
                bytes.as_chunks().0.iter().map(|&b| f32::from_ne_bytes(b)).collect();
            input.linear(width, height, rgba(&samples, channels, 1.0))
        }
        other => {
            Err(input.fail(format!("pictures of {other:?} cannot be read")).help(INSTEAD).into())
        }
    }
}

/// What to do with the many kinds of picture that a format may hold and its decoder does not know.
const INSTEAD: &str = "save it as PNG or EXR";

/// Passes on what a decoder says, with help if the file is of a kind it does not know.
fn refused(input: &Input, error: &ImageError) -> Diagnostic {
    let complaint = unreadable(input, error);
    match error {
        ImageError::Unsupported(_) => complaint.help(INSTEAD),
        _ => complaint,
    }
}
