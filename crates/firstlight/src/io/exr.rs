//! OpenEXR: linear pictures in and out.

use super::pixels::{Input, unreadable};
use super::save::{Develop, Metadata, Precision, premultiplied};
use crate::Image;
use crate::diagnostic::{Diagnostic, Result};
use crate::scene::description::Pixels;
use exr::meta::attribute::Chromaticities;
use exr::meta::header::Header;
use exr::prelude::Compression::{PIZ, PXR24, RLE, Uncompressed, ZIP1, ZIP16};
use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Encoding, FlatSamples, Layer, LayerAttributes,
    MetaData, ReadChannels, ReadLayers, ReadSpecificChannel, Text, Vec2, WritableImage, f16, read,
};
use std::io::Cursor;

pub(super) fn decode(input: &Input) -> Result<Pixels> {
    let meta =
        MetaData::read_from_buffered(input.bytes, false).map_err(|e| unreadable(input, &e))?;
    for header in &meta.headers {
        check_blocks(input, header)?;
    }
    let found = meta.headers.iter().find_map(|header| Some((header, color(header)?)));
    let (header, color) = found.ok_or_else(|| no_color(input, &meta))?;
    let Vec2(width, height) = header.layer_size;
    let _ = input.room_for(width as u64, height as u64, 16)?;
    let canvas = match color {
        Color::Rgb => read_rgb(input.bytes),
        Color::Grey(channel) => read_grey(input.bytes, channel),
    };
    let canvas = canvas.map_err(|e| unreadable(input, &e))?;
    // `room_for` has made sure that the size fits.
    input.linear(width as u32, height as u32, canvas.texels)
}

/// The channels of a layer that hold its colour.
enum Color {
    Rgb,
    Grey(Text),
}

fn color(header: &Header) -> Option<Color> {
    let channels = &header.channels.list;
    let has = |name: &str| channels.iter().any(|channel| channel.name == *name);
    if ["R", "G", "B"].into_iter().all(has) {
        return Some(Color::Rgb);
    }
    let mut opaque = channels.iter().filter(|channel| channel.name != *"A");
    match (opaque.next(), opaque.next()) {
        (Some(only), None) => Some(Color::Grey(only.name.clone())),
        _ => has("Y").then(|| Color::Grey(Text::from("Y"))),
    }
}

/// Refuses a layer whose table of blocks is longer than the file, or one of whose blocks passes the limit.
/// Of the ways to compress, the decoder trusts lengths in DWA and panics on sums in B44.
pub(super) fn check_blocks(input: &Input, header: &Header) -> Result<()> {
    if !matches!(header.compression, Uncompressed | RLE | ZIP1 | ZIP16 | PIZ | PXR24) {
        let message = format!("EXR files with {} cannot be read", header.compression);
        return Err(input.fail(message).help("save it with ZIP or PIZ compression").into());
    }
    input.at_least((header.chunk_count as u64).saturating_mul(8))?;
    let Vec2(width, height) = header.max_block_pixel_size();
    let pixel_bytes = header.channels.bytes_per_pixel.max(1);
    input.room_for(width as u64, height as u64, pixel_bytes as u64).map(|_| ())
}

fn no_color(input: &Input, meta: &MetaData) -> Diagnostic {
    let channels = meta.headers.iter().flat_map(|header| &header.channels.list);
    let names: Vec<String> = channels.take(20).map(|c| format!("\"{}\"", c.name)).collect();
    let message = format!(
        "no channels R, G, B or Y and no single one in this EXR file; it has {}",
        names.join(", ")
    );
    input.fail(message).help("export the colour as a plain RGB or RGBA EXR file")
}

/// Where the decoder puts its pixels.
struct Canvas {
    width: usize,
    texels: Vec<[f32; 4]>,
}

impl Canvas {
    fn new(Vec2(width, height): Vec2<usize>) -> Self {
        Self { width, texels: vec![[0.0; 4]; width * height] }
    }

    /// OpenEXR multiplies colour by alpha; we do not. Where alpha is 0 the colour is what the pixel emits.
    fn set(&mut self, Vec2(x, y): Vec2<usize>, rgb: [f32; 3], alpha: f32) {
        let alpha = alpha.clamp(0.0, 1.0);
        let divisor = if alpha > 0.0 { alpha } else { 1.0 };
        let [r, g, b] = rgb.map(|value| value / divisor);
        if let Some(texel) = self.texels.get_mut(y * self.width + x) {
            *texel = [r, g, b, alpha];
        }
    }
}

fn read_rgb(bytes: &[u8]) -> exr::error::Result<Canvas> {
    let channels = read().no_deep_data().largest_resolution_level().specific_channels();
    let image = channels
        .required("R")
        .required("G")
        .required("B")
        .optional("A", 1.0_f32)
        .collect_pixels(
            |size, _| Canvas::new(size),
            |canvas, at, (r, g, b, a): (f32, f32, f32, f32)| canvas.set(at, [r, g, b], a),
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))?;
    Ok(image.layer_data.channel_data.pixels)
}

fn read_grey(bytes: &[u8], channel: Text) -> exr::error::Result<Canvas> {
    let channels = read().no_deep_data().largest_resolution_level().specific_channels();
    let image = channels
        .required(channel)
        .optional("A", 1.0_f32)
        .collect_pixels(
            |size, _| Canvas::new(size),
            |canvas, at, (grey, a): (f32, f32)| canvas.set(at, [grey; 3], a),
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))?;
    Ok(image.layer_data.channel_data.pixels)
}

/// All channels of the first layer of a file.
pub(super) fn first_layer(bytes: &[u8]) -> exr::error::Result<Layer<AnyChannels<FlatSamples>>> {
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))?;
    Ok(image.layer_data)
}

/// ITU-R BT.709 with D65 white.
const REC_709: Chromaticities = Chromaticities {
    red: Vec2(0.64, 0.33),
    green: Vec2(0.3, 0.6),
    blue: Vec2(0.15, 0.06),
    white: Vec2(0.3127, 0.329),
};

pub(super) fn encode(
    image: &Image,
    precision: Precision,
    develop: Develop,
    metadata: &Metadata,
) -> exr::error::Result<Vec<u8>> {
    let size = (image.width() as usize, image.height() as usize);
    let channels = ["R", "G", "B", "A"].into_iter().enumerate();
    let channels = channels.map(|(i, name)| AnyChannel::new(name, plane(image, i, precision)));
    to_file(size, attributes(develop, metadata), channels.collect())
}

/// The bytes of a file of one layer, losslessly compressed.
pub(super) fn to_file(
    size: (usize, usize),
    attributes: LayerAttributes,
    channels: Vec<AnyChannel<FlatSamples>>,
) -> exr::error::Result<Vec<u8>> {
    let channels = AnyChannels::sort(channels.into());
    let layer = Layer::new(size, attributes, Encoding::SMALL_LOSSLESS, channels);
    let mut picture = exr::image::Image::from_layer(layer);
    picture.attributes.chromaticities = Some(REC_709);
    let mut file = Cursor::new(Vec::new());
    picture.write().non_parallel().to_buffered(&mut file)?;
    let mut bytes = file.into_inner();
    sort_attributes(&mut bytes);
    Ok(bytes)
}

/// Puts the attributes of a file of one part in the order of their names: they come out of a hash map, and the same
/// picture is to be the same file.
fn sort_attributes(file: &mut [u8]) {
    const START: usize = 8;
    let (mut attributes, mut at) = (Vec::new(), START);
    while let Some(length) = attribute_length(&file[at..]) {
        attributes.push(file[at..at + length].to_vec());
        at += length;
    }
    attributes.sort();
    let sorted = attributes.concat();
    file[START..START + sorted.len()].copy_from_slice(&sorted);
}

/// Bytes of the attribute at the start: name, type, size of the value, value; `None` after the last.
fn attribute_length(bytes: &[u8]) -> Option<usize> {
    let text =
        |from: usize| Some(from + bytes.get(from..)?.iter().position(|byte| *byte == 0)? + 1);
    let size_at = text(text(0).filter(|end| *end > 1)?)?;
    let size = bytes.get(size_at..size_at + 4)?.try_into().ok()?;
    Some(size_at + 4 + u32::from_le_bytes(size) as usize)
}

pub(super) fn plane(image: &Image, channel: usize, precision: Precision) -> FlatSamples {
    let values = image.pixels().iter().map(|&pixel| premultiplied(pixel)[channel]);
    match precision {
        Precision::Float => FlatSamples::F32(values.collect()),
        Precision::Half => FlatSamples::F16(values.map(half).collect()),
    }
}

fn half(value: f32) -> f16 {
    f16::from_f32(value.clamp(f16::MIN.to_f32(), f16::MAX.to_f32()))
}

/// All entries go into the one standard text attribute, which viewers show.
pub(super) fn attributes(develop: Develop, metadata: &Metadata) -> LayerAttributes {
    let entries = metadata.entries.iter().map(|(key, text)| format!("{key}: {text}"));
    let comments = entries.collect::<Vec<_>>().join("\n");
    let mut attributes = LayerAttributes {
        software_name: Some(utf8(&metadata.software)),
        comments: (!comments.is_empty()).then(|| utf8(&comments)),
        ..LayerAttributes::default()
    };
    let exposure = AttributeValue::F32(develop.exposure_ev);
    let view = AttributeValue::Text(utf8(develop.view.name()));
    attributes.other.extend([(utf8("exposureEV"), exposure), (utf8("viewTransform"), view)]);
    attributes
}

pub(super) fn utf8(text: &str) -> Text {
    Text::from_slice_unchecked(text.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::{Limits, load_image};
    use exr::prelude::Compression;

    fn load(file: &[u8]) -> Result<Image> {
        load_image(file, "sky.exr", &Limits::default())
    }

    /// A file of the given channels, all of them 0.5 in 3 × 2 pixels.
    fn picture(channels: &[&str], compression: Compression) -> Vec<u8> {
        let channel = |name| AnyChannel::new(name, FlatSamples::F32(vec![0.5; 6]));
        let channels = AnyChannels::sort(channels.iter().copied().map(channel).collect());
        let encoding = Encoding { compression, ..Encoding::SMALL_LOSSLESS };
        let layer = Layer::new((3, 2), LayerAttributes::default(), encoding, channels);
        let mut file = Cursor::new(Vec::new());
        exr::image::Image::from_layer(layer).write().to_buffered(&mut file).unwrap();
        file.into_inner()
    }

    /// The same file with another data window: left, top, right, bottom.
    fn with_window(mut file: Vec<u8>, window: [i32; 4]) -> Vec<u8> {
        let name = b"dataWindow\0box2i\0";
        let at = file.windows(name.len()).position(|bytes| bytes == name).unwrap();
        let at = at + name.len() + 4;
        file[at..at + 16].copy_from_slice(window.map(i32::to_le_bytes).as_flattened());
        file
    }

    #[test]
    fn reads_colour_or_a_single_grey_channel() {
        for compression in [Uncompressed, RLE, ZIP1, ZIP16, PIZ, PXR24] {
            for channels in [["B", "G", "R"].as_slice(), &["Y"], &["G"], &["RY", "Y", "Z"]] {
                let image = load(&picture(channels, compression)).unwrap();
                assert_eq!((image.width(), image.height()), (3, 2));
                assert!(image.pixels().iter().all(|pixel| *pixel == [0.5, 0.5, 0.5, 1.0]));
            }
        }
    }

    #[test]
    fn divides_colour_by_alpha() {
        for channels in [["A", "B", "G", "R"].as_slice(), &["A", "Y"]] {
            let image = load(&picture(channels, ZIP16)).unwrap();
            assert_eq!(image.pixels()[5], [1.0, 1.0, 1.0, 0.5]);
        }
    }

    #[test]
    fn names_the_channels_when_none_is_colour() {
        let error = load(&picture(&["Z", "normal.X"], ZIP16)).unwrap_err();
        assert!(error.message.ends_with(r#"it has "Z", "normal.X""#), "{error}");
    }

    #[test]
    fn refuses_compression_that_is_not_decoded_safely() {
        let error = load(&picture(&["Y"], Compression::B44)).unwrap_err();
        assert!(error.message.contains("b44"), "{error}");
    }

    #[test]
    fn refuses_enormous_windows_at_once() {
        let (min, max) = (i32::MIN, i32::MAX);
        let file = picture(&["R", "G", "B"], ZIP16);
        for window in [
            [min, min, max, max],
            [0, 0, max, max],
            [0, 0, max - 1, 1],
            [0, 0, 2, max - 1],
            [0, 0, 1 << 26, 1],
            [0, 0, 9_999, 9_999],
            [5, 5, 0, 0],
        ] {
            let error = load(&with_window(file.clone(), window)).unwrap_err();
            assert!(error.to_string().starts_with("sky.exr: "), "{error}");
            assert!(!error.message.contains("gave up"), "{window:?}: {error}");
        }
        let error = load(&with_window(file, [0, 0, 1 << 26, 1])).unwrap_err();
        assert!(error.message.contains("the limit is 1 GiB"), "{error}");
    }
}
