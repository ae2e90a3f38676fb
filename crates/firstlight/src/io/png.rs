//! PNG: pictures for textures in, developed pictures out.

use super::pixels::{Input, rgba, unreadable};
use super::save::{BitDepth, Develop, Metadata};
use crate::Image;
use crate::color::{srgb_code8, srgb_code16, srgb_dithered8};
use crate::diagnostic::Result;
use crate::scene::description::Pixels;
use png::{
    BitDepth as PngDepth, ColorType, Compression, DecodeOptions, Decoder, Encoder, Transformations,
};
use rayon::prelude::*;
use std::io::Cursor;

/// How much data deflate can put into a byte of file, rounded up.
const DEFLATE_RATIO: u64 = 1033;

pub(super) fn decode(input: &Input) -> Result<Pixels> {
    let mut options = DecodeOptions::default();
    options.set_ignore_text_chunk(true);
    options.set_ignore_iccp_chunk(true);
    let mut decoder = Decoder::new_with_options(Cursor::new(input.bytes), options);
    decoder.set_transformations(Transformations::EXPAND);
    let info = decoder.read_header_info().map_err(|e| unreadable(input, &e))?;
    let (width, height) = info.size();
    let deep = info.bit_depth == PngDepth::Sixteen;
    let count = input.room_for(width.into(), height.into(), if deep { 8 } else { 4 })?;
    input.at_least(info.bits_per_pixel() as u64 * count as u64 / 8 / DEFLATE_RATIO)?;
    let mut reader = decoder.read_info().map_err(|e| unreadable(input, &e))?;
    let palette = reader.info().palette.as_deref().unwrap_or_default();
    if !palette.len().is_multiple_of(3) {
        // The decoder panics on it.
        return Err(input.fail("the palette of this PNG ends within a colour").into());
    }
    let channels = reader.output_color_type().0.samples();
    let mut data = vec![0; count * channels * if deep { 2 } else { 1 }];
    reader.next_frame(&mut data).map_err(|e| unreadable(input, &e))?;
    if deep {
        return Ok(input.deep(width, height, deep_texels(&data, channels)));
    }
    Ok(input.srgb(width, height, rgba(&data, channels, u8::MAX)))
}

fn deep_texels(data: &[u8], channels: usize) -> Vec<[u16; 4]> {
    let samples: Vec<u16> =
        data.as_chunks().0.iter().map(|&bytes| u16::from_be_bytes(bytes)).collect();
    rgba(&samples, channels, u16::MAX)
}

/// A developed, sRGB-encoded PNG; it has an alpha channel if any pixel is not opaque.
pub(super) fn encode(
    image: &Image,
    bits: BitDepth,
    develop: Develop,
    metadata: &Metadata,
) -> std::result::Result<Vec<u8>, png::EncodingError> {
    let alpha = image.pixels().iter().any(|pixel| pixel[3] < 1.0);
    let channels = if alpha { 4 } else { 3 };
    let mut file = Vec::new();
    let mut encoder = Encoder::new(&mut file, image.width(), image.height());
    encoder.set_color(if alpha { ColorType::Rgba } else { ColorType::Rgb });
    encoder.set_source_srgb(png::SrgbRenderingIntent::RelativeColorimetric);
    let (depth, data) = match bits {
        BitDepth::Eight => (PngDepth::Eight, codes8(image, channels, develop)),
        BitDepth::Sixteen => (PngDepth::Sixteen, codes16(image, channels, develop)),
    };
    encoder.set_depth(depth);
    // Somewhat larger files in a quarter of the time, which else would exceed that of many a render.
    encoder.set_compression(Compression::Fast);
    for (key, text) in metadata.all() {
        add_text(&mut encoder, key, text)?;
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&data)?;
    writer.finish()?;
    Ok(file)
}

fn codes8(image: &Image, channels: usize, develop: Develop) -> Vec<u8> {
    let width = image.width() as usize;
    codes(image, channels, |index, pixel| {
        let [r, g, b, a] = develop.display(pixel);
        let alpha = (a * f32::from(u8::MAX)).round() as u8;
        if !develop.dither {
            return [srgb_code8(r), srgb_code8(g), srgb_code8(b), alpha];
        }
        let threshold = threshold(index % width, index / width);
        let code = |linear| srgb_dithered8(linear, threshold);
        [code(r), code(g), code(b), alpha]
    })
}

fn codes16(image: &Image, channels: usize, develop: Develop) -> Vec<u8> {
    let codes = codes(image, channels, |_, pixel| {
        let [r, g, b, a] = develop.display(pixel);
        let alpha = (a * f32::from(u16::MAX)).round() as u16;
        [srgb_code16(r), srgb_code16(g), srgb_code16(b), alpha].map(u16::to_be_bytes)
    });
    codes.into_flattened()
}

/// 1/128 to 127/128, spread evenly over any few neighbours: Jimenez, *Next Generation Post Processing in Call of Duty:
/// Advanced Warfare*, SIGGRAPH 2014. All channels have the same one, so grey stays grey; the ends are left out, so what a
/// step holds but for rounding stays what it is.
fn threshold(x: usize, y: usize) -> f32 {
    let place = fraction(0.067_110_56 * x as f64 + 0.005_837_15 * y as f64);
    let noise = fraction(52.982_918_9 * place);
    (f32::from((noise * 64.0) as u8) + 0.5) / 64.0
}

/// What a number in 0..2³² has after its point. (`fract` is a call where the processor might be the oldest there is.)
fn fraction(x: f64) -> f64 {
    x - f64::from(x as u32)
}

/// The first `channels` codes of every pixel, of its place in the picture and itself; many pixels at the same time.
fn codes<T: Copy + Default + Send>(
    image: &Image,
    channels: usize,
    code: impl Fn(usize, [f32; 4]) -> [T; 4] + Sync,
) -> Vec<T> {
    const PIXELS: usize = 4096;
    let mut codes = vec![T::default(); image.pixels().len() * channels];
    let parts = codes.par_chunks_mut(PIXELS * channels).zip(image.pixels().par_chunks(PIXELS));
    parts.enumerate().for_each(|(part, (codes, pixels))| {
        let numbered = (part * PIXELS..).zip(pixels);
        for (own, (index, &pixel)) in codes.chunks_exact_mut(channels).zip(numbered) {
            own.copy_from_slice(&code(index, pixel)[..channels]);
        }
    });
    codes
}

/// Plain ASCII as tEXt, which every program reads; the rest as iTXt, which holds UTF-8.
fn add_text(
    encoder: &mut Encoder<&mut Vec<u8>>,
    key: &str,
    text: &str,
) -> std::result::Result<(), png::EncodingError> {
    let key: String = key.chars().filter(|c| *c == ' ' || c.is_ascii_graphic()).take(79).collect();
    let key = if key.trim().is_empty() { "Comment" } else { key.trim() }.to_owned();
    let text = text.replace('\0', "");
    if text.is_ascii() {
        encoder.add_text_chunk(key, text)
    } else {
        encoder.add_itxt_chunk(key, text)
    }
}
