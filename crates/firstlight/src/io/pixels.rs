//! Pictures in: the bytes of a file in one of the formats that [`decode`] knows → [`Pixels`] or an [`Image`].

use super::{Limits, decoders, exr, hdr, ktx2, pfm, png};
use crate::Image;
use crate::color::{srgb_linear8, srgb_linear16};
use crate::diagnostic::{Diagnostic, Result};
use crate::scene::description::{Pixels, Texels};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Decodes a picture; the format is recognised by its first bytes, not by the name.
///
/// PNG, JPEG, WebP, KTX2, TGA, BMP, TIFF and GIF are taken as sRGB-encoded whatever colour profile they carry, as glTF
/// demands. HDR, EXR, PFM and TIFF of RGB floats are linear and may not hold NaN or
/// infinities. Of an EXR file the first layer with colour (R, G, B or one grey channel) is read, its data window being
/// the picture; of TIFF and GIF the first picture.
///
/// # Errors
/// If the format is unknown, the data is broken or cut off, or it would unpack to more than `limits` allow;
/// that is found out from the header, before memory is asked for.
pub fn decode(bytes: &[u8], name: &str, limits: &Limits) -> Result<Pixels> {
    let input = Input { bytes, name, limits };
    let read: fn(&Input) -> Result<Pixels> = match bytes {
        [0x89, b'P', b'N', b'G', ..] => png::decode,
        [0xFF, 0xD8, 0xFF, ..] => decoders::jpeg,
        [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => decoders::webp,
        [0xAB, b'K', b'T', b'X', b' ', b'2', b'0', ..] => ktx2::decode,
        [b'#', b'?', ..] => hdr::decode,
        [0x76, 0x2F, 0x31, 0x01, ..] => exr::decode,
        [b'P', b'F' | b'f', b'\n' | b'\r' | b' ' | b'\t', ..] => pfm::decode,
        [b'B', b'M', ..] => decoders::bmp,
        [b'G', b'I', b'F', b'8', ..] => decoders::gif,
        [b'I', b'I', 42 | 43, 0, ..] | [b'M', b'M', 0, 42 | 43, ..] => decoders::tiff,
        [] => return Err(input.fail("this picture file is empty").into()),
        _ if decoders::is_tga(bytes) => decoders::tga,
        _ => return Err(input.fail("this is not a picture in a known format").help(KNOWN).into()),
    };
    guarded(&input, || read(&input))
}

/// The decoders of other projects are careful, yet now and then one of them panics on a broken file.
pub(super) fn guarded<T>(input: &Input, read: impl FnOnce() -> Result<T>) -> Result<T> {
    catch_unwind(AssertUnwindSafe(read)).unwrap_or_else(|_| Err(gave_up(input)))
}

fn gave_up(input: &Input) -> Box<Diagnostic> {
    input.fail("the decoder gave up on this picture: it is damaged").into()
}

const KNOWN: &str = "PNG, JPEG, WebP, KTX2, TGA, BMP, TIFF, GIF, HDR, EXR and PFM can be read";

/// Reads a picture file as linear radiance.
///
/// # Errors
/// As [`decode`].
pub fn load_image(bytes: &[u8], name: &str, limits: &Limits) -> Result<Image> {
    let Pixels { width, height, texels, .. } = decode(bytes, name, limits)?;
    let _ = Input { bytes, name, limits }.room_for(width.into(), height.into(), 16)?;
    let pixels = match texels {
        Texels::Linear(texels) => texels,
        Texels::Srgb8(texels) => texels.into_iter().map(linear).collect(),
        Texels::Srgb16(texels) => texels.into_iter().map(deep_linear).collect(),
    };
    Ok(Image::from_pixels(width, height, pixels))
}

fn linear([r, g, b, a]: [u8; 4]) -> [f32; 4] {
    [srgb_linear8(r), srgb_linear8(g), srgb_linear8(b), f32::from(a) / 255.0]
}

fn deep_linear([r, g, b, a]: [u16; 4]) -> [f32; 4] {
    [srgb_linear16(r), srgb_linear16(g), srgb_linear16(b), f32::from(a) / f32::from(u16::MAX)]
}

/// A picture file to be read.
pub(super) struct Input<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) name: &'a str,
    pub(super) limits: &'a Limits,
}

impl Input<'_> {
    /// A complaint about this file.
    pub(super) fn fail(&self, message: impl Into<String>) -> Diagnostic {
        Diagnostic::new(self.name, message)
    }

    /// The number of pixels, if there are any and they stay within the limit at so many bytes each.
    pub(super) fn room_for(&self, width: u64, height: u64, pixel_bytes: u64) -> Result<usize> {
        if width == 0 || height == 0 {
            return Err(self
                .fail(format!("this picture has no pixels: {width} × {height}"))
                .into());
        }
        let pixels = width.checked_mul(height);
        let bytes = pixels.and_then(|count| count.checked_mul(pixel_bytes));
        let fits = bytes.is_some_and(|bytes| bytes <= self.limits.decoded_bytes);
        let count = pixels.and_then(|count| usize::try_from(count).ok());
        count.filter(|_| fits && u32::try_from(width.max(height)).is_ok()).ok_or_else(|| {
            let size = bytes.map_or("more memory than there is".into(), shown_bytes);
            let limit = shown_bytes(self.limits.decoded_bytes);
            let message = format!(
                "this picture of {width} × {height} pixels would unpack to {size}; the limit is {limit}"
            );
            self.fail(message).help("use a smaller picture").into()
        })
    }

    /// Refuses a file that is shorter than any file that holds as much as this one says it does.
    pub(super) fn at_least(&self, bytes: u64) -> Result<()> {
        if self.bytes.len() as u64 >= bytes {
            return Ok(());
        }
        let length = self.bytes.len();
        Err(self
            .fail(format!("the file is cut off: {length} bytes, at least {bytes} needed"))
            .into())
    }

    /// Linear texels as a picture, if all are finite.
    pub(super) fn linear(&self, width: u32, height: u32, texels: Vec<[f32; 4]>) -> Result<Pixels> {
        if let Some(bad) = texels.iter().position(|texel| !texel.iter().all(|v| v.is_finite())) {
            let (x, y) = (bad % width as usize, bad / width as usize);
            let error = self.fail("this pixel is not a finite number (NaN or infinity)");
            return Err(error.at_part(format!("pixel ({x}, {y})")).into());
        }
        Ok(Pixels { name: self.name.into(), width, height, texels: Texels::Linear(texels) })
    }

    /// sRGB-encoded texels as a picture.
    pub(super) fn srgb(&self, width: u32, height: u32, texels: Vec<[u8; 4]>) -> Pixels {
        Pixels { name: self.name.into(), width, height, texels: Texels::Srgb8(texels) }
    }

    /// The same of 16 bits.
    pub(super) fn deep(&self, width: u32, height: u32, texels: Vec<[u16; 4]>) -> Pixels {
        Pixels { name: self.name.into(), width, height, texels: Texels::Srgb16(texels) }
    }
}

/// A number of bytes for people.
fn shown_bytes(bytes: u64) -> String {
    let (unit, size) = match bytes {
        0..0x400 => return format!("{bytes} bytes"),
        0x400..0x10_0000 => ("KiB", 0x400),
        0x10_0000..0x4000_0000 => ("MiB", 0x10_0000),
        _ => ("GiB", 0x4000_0000_u64),
    };
    let text = format!("{:.1}", bytes as f64 / size as f64);
    format!("{} {unit}", text.trim_end_matches(".0"))
}

/// RGBA texels from samples of 1 (grey), 2 (grey, alpha), 3 (RGB) or 4 (RGBA) interleaved channels.
pub(super) fn rgba<T: Copy>(samples: &[T], channels: usize, opaque: T) -> Vec<[T; 4]> {
    let texel = |samples: &[T]| match *samples {
        [r, g, b, a] => [r, g, b, a],
        [r, g, b] => [r, g, b, opaque],
        [grey, a] => [grey, grey, grey, a],
        [grey] => [grey, grey, grey, opaque],
        _ => [opaque; 4],
    };
    samples.chunks_exact(channels).map(texel).collect()
}

/// Passes on what a decoder says.
pub(super) fn unreadable(input: &Input, error: &dyn std::error::Error) -> Diagnostic {
    input.fail(format!("cannot read this picture: {error}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::{BitDepth, Develop, Format, Metadata, Precision, save};
    use image::{ExtendedColorType, ImageEncoder, ImageFormat};
    use std::io::Cursor;

    const FORMATS: [Format; 6] = [
        Format::Png { bits: BitDepth::Eight },
        Format::Png { bits: BitDepth::Sixteen },
        Format::Exr { precision: Precision::Half },
        Format::Exr { precision: Precision::Float },
        Format::Hdr,
        Format::Pfm,
    ];

    const OTHERS: [ImageFormat; 6] = [
        ImageFormat::Jpeg,
        ImageFormat::WebP,
        ImageFormat::Tga,
        ImageFormat::Bmp,
        ImageFormat::Tiff,
        ImageFormat::Gif,
    ];

    fn load(bytes: &[u8]) -> Result<Image> {
        load_image(bytes, "picture", &Limits::default())
    }

    fn saved(image: &Image, format: Format) -> Vec<u8> {
        save(image, format, Develop::default(), &Metadata::default()).unwrap()
    }

    /// A small picture that compresses badly.
    fn noise() -> Image {
        let mut state = 1_u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 24) as f32
        };
        Image::from_pixels(19, 11, (0..19 * 11).map(|_| [next(), next(), next(), 1.0]).collect())
    }

    fn samples() -> Vec<u8> {
        (0..16 * 8 * 3).map(|i| (i % 251) as u8).collect()
    }

    fn encoded(format: ImageFormat) -> Vec<u8> {
        let mut file = Cursor::new(Vec::new());
        image::write_buffer_with_format(
            &mut file,
            &samples(),
            16,
            8,
            ExtendedColorType::Rgb8,
            format,
        )
        .unwrap();
        file.into_inner()
    }

    fn complaint(bytes: &[u8], limits: &Limits) -> String {
        decode(bytes, "wood.png", limits).unwrap_err().to_string()
    }

    /// A PNG that consists of its header alone.
    fn png_header(width: u32, height: u32) -> Vec<u8> {
        let mut file = Vec::new();
        let mut encoder = ::png::Encoder::new(&mut file, width, height);
        encoder.set_color(::png::ColorType::Rgba);
        drop(encoder.write_header().unwrap());
        file
    }

    #[test]
    fn every_format_survives_saving_and_loading() {
        let image = noise();
        for format in FORMATS {
            let back = load(&saved(&image, format)).unwrap();
            assert_eq!((back.width(), back.height()), (19, 11), "{format:?}");
            let tolerance = match format {
                Format::Png { bits: BitDepth::Eight } | Format::Hdr => 5e-3,
                Format::Png { bits: BitDepth::Sixteen } => 2e-5,
                Format::Exr { precision: Precision::Half } => 3e-4,
                Format::Exr { precision: Precision::Float } | Format::Pfm => 0.0,
            };
            for (pixel, expected) in back.pixels().iter().zip(image.pixels()) {
                let close = pixel.iter().zip(expected).all(|(a, b)| (a - b).abs() <= tolerance);
                assert!(close, "{format:?}: {pixel:?}, expected {expected:?}");
            }
        }
    }

    #[test]
    fn every_cut_is_refused_with_the_name_of_the_file() {
        for format in FORMATS {
            let file = saved(&noise(), format);
            // The end of a PNG holds no pixels.
            let end =
                if matches!(format, Format::Png { .. }) { file.len() - 16 } else { file.len() };
            for length in 0..end {
                let error = complaint(&file[..length], &Limits::default());
                assert!(error.starts_with("wood.png"), "{format:?} cut at {length}: {error}");
            }
        }
        for format in OTHERS {
            let file = encoded(format);
            // The end of a GIF holds no pixels.
            let unused = if format == ImageFormat::Gif { 3 } else { 1 };
            for length in 0..file.len() - unused {
                assert!(decode(&file[..length], "cut", &Limits::default()).is_err(), "{length}");
            }
        }
    }

    #[test]
    fn damaged_files_are_no_trouble() {
        let limits = Limits { decoded_bytes: 1 << 20 };
        let files = FORMATS.map(|format| saved(&noise(), format)).into_iter();
        for file in files.chain(OTHERS.map(encoded)) {
            for at in 0..file.len() {
                for value in [0, 1, 0x7F, 0x80, 0xFF] {
                    let mut damaged = file.clone();
                    damaged[at] = value;
                    if let Err(error) = decode(&damaged, "damaged", &limits) {
                        assert!(error.to_string().starts_with("damaged: "), "{error}");
                    }
                }
            }
        }
    }

    #[test]
    fn eight_bit_pictures_keep_their_codes() {
        let codes: Vec<[u8; 4]> = (0..=255).map(|code| [code, 255 - code, code, code]).collect();
        let mut file = Vec::new();
        let encoder = image::codecs::png::PngEncoder::new(&mut file);
        encoder.write_image(codes.as_flattened(), 16, 16, ExtendedColorType::Rgba8).unwrap();
        let pixels = decode(&file, "codes", &Limits::default()).unwrap();
        assert_eq!(pixels.texels, Texels::Srgb8(codes.clone()));
        let again = saved(&load(&file).unwrap(), Format::Png { bits: BitDepth::Eight });
        let pixels = decode(&again, "codes", &Limits::default()).unwrap();
        assert_eq!(pixels.texels, Texels::Srgb8(codes));
    }

    #[test]
    fn grey_and_palette_pictures_become_rgba() {
        let mut file = Vec::new();
        let mut encoder = ::png::Encoder::new(&mut file, 2, 1);
        encoder.set_color(::png::ColorType::Indexed);
        encoder.set_depth(::png::BitDepth::One);
        encoder.set_palette([1, 2, 3, 4, 5, 6].as_slice());
        encoder.set_trns([7].as_slice());
        encoder.write_header().unwrap().write_image_data(&[0b0100_0000]).unwrap();
        let pixels = decode(&file, "palette", &Limits::default()).unwrap();
        assert_eq!(pixels.texels, Texels::Srgb8(vec![[1, 2, 3, 7], [4, 5, 6, 255]]));
        assert_eq!(rgba(&[9, 8], 1, 255), [[9, 9, 9, 255], [8, 8, 8, 255]]);
        assert_eq!(rgba(&[9, 8], 2, 255), [[9, 9, 9, 8]]);
    }

    #[test]
    fn a_palette_that_ends_within_a_colour_is_refused() {
        let mut file = Vec::new();
        let mut encoder = ::png::Encoder::new(&mut file, 1, 1);
        encoder.set_color(::png::ColorType::Indexed);
        encoder.set_palette([1, 2, 3, 4].as_slice());
        encoder.write_header().unwrap().write_image_data(&[0]).unwrap();
        assert!(complaint(&file, &Limits::default()).contains("palette"));
    }

    #[test]
    fn sixteen_bit_grey_is_linear_after_decoding() {
        let mut file = Vec::new();
        let mut encoder = ::png::Encoder::new(&mut file, 1, 1);
        encoder.set_color(::png::ColorType::Grayscale);
        encoder.set_depth(::png::BitDepth::Sixteen);
        encoder.write_header().unwrap().write_image_data(&[0x80, 0x00]).unwrap();
        let pixel = load(&file).unwrap().pixels()[0];
        let expected = crate::color::srgb_decode(32_768.0 / 65_535.0);
        assert_eq!(pixel, [expected, expected, expected, 1.0]);
    }

    #[test]
    fn pictures_of_other_formats_are_read() {
        let expected: Vec<[u8; 4]> = rgba(&samples(), 3, u8::MAX);
        for format in OTHERS {
            let pixels = decode(&encoded(format), "photo", &Limits::default()).unwrap();
            assert_eq!((pixels.width, pixels.height), (16, 8));
            let Texels::Srgb8(texels) = pixels.texels else { panic!("{format:?}") };
            match format {
                ImageFormat::Jpeg => assert_eq!(texels.len(), 128),
                _ => assert_eq!(texels, expected, "{format:?}"),
            }
        }
    }

    /// TIFF is what programs write that know more than eight bits.
    #[test]
    fn deep_tiffs_are_linear_after_decoding() {
        let tiff = |bytes: &[u8], color| {
            let mut file = Cursor::new(Vec::new());
            let format = ImageFormat::Tiff;
            image::write_buffer_with_format(&mut file, bytes, 1, 1, color, format).unwrap();
            load(&file.into_inner()).map(|image| image.pixels()[0])
        };
        let sixteen = tiff(&0x8000_u16.to_ne_bytes(), ExtendedColorType::L16).unwrap();
        let expected = crate::color::srgb_decode(32_768.0 / 65_535.0);
        assert_eq!(sixteen, [expected, expected, expected, 1.0]);
        let floats = |values: [f32; 3]| values.map(f32::to_ne_bytes).concat();
        let sky = tiff(&floats([0.5, 1.0, 70.0]), ExtendedColorType::Rgb32F).unwrap();
        assert_eq!(sky, [0.5, 1.0, 70.0, 1.0]);
        let error = tiff(&floats([0.5, f32::NAN, 1.0]), ExtendedColorType::Rgb32F).unwrap_err();
        assert!(error.to_string().contains("not a finite number"), "{error}");
    }

    /// Of what its decoder does not know, the user learns what to do.
    #[test]
    fn kinds_of_tiff_that_cannot_be_read_get_help() {
        let tag = |file: &mut Vec<u8>, number: u16, from: u16, to: u16| {
            let entry = [number, 3].map(u16::to_le_bytes).concat();
            let at = file.windows(4).position(|bytes| bytes == entry).expect("the tag") + 8;
            assert_eq!(file[at..at + 2], from.to_le_bytes());
            file[at..at + 2].copy_from_slice(&to.to_le_bytes());
        };
        let mut grey_float = Cursor::new(Vec::new());
        let (format, color) = (ImageFormat::Tiff, ExtendedColorType::L16);
        image::write_buffer_with_format(&mut grey_float, &[0; 4], 1, 2, color, format).unwrap();
        let mut grey_float = grey_float.into_inner();
        tag(&mut grey_float, 258, 16, 32);
        tag(&mut grey_float, 339, 1, 3);
        let mut luma = encoded(format);
        tag(&mut luma, 262, 2, 6);
        for file in [grey_float, luma] {
            let error = complaint(&file, &Limits::default());
            assert!(error.ends_with("help: save it as PNG or EXR"), "{error}");
        }
        let cut = complaint(&encoded(format)[..40], &Limits::default());
        assert!(!cut.contains("help"), "{cut}");
    }

    /// TGA has no mark of its own: its header must not be found in texts and in other files.
    #[test]
    fn what_is_no_tga_is_not_taken_for_one() {
        let tga = encoded(ImageFormat::Tga);
        assert!(decoders::is_tga(&tga));
        assert!(!decoders::is_tga(&tga[..17]));
        for (at, value) in [(1, 2), (2, 4), (12, 0), (16, 7)] {
            let mut other = tga.clone();
            other[at] = value;
            assert!(!decoders::is_tga(&other), "{at}");
        }
        assert!(!decoders::is_tga(b"<html><body>404 Not Found</body></html>"));
    }

    #[test]
    fn a_preview_does_not_hide_that_a_jpeg_is_cut_off() {
        let whole = encoded(ImageFormat::Jpeg);
        let mut file = whole[..2].to_vec();
        file.extend([0xFF, 0xE1, 0, 6, 0xFF, 0xD8, 0xFF, 0xD9]);
        file.extend(&whole[2..]);
        assert!(decode(&file, "photo", &Limits::default()).is_ok());
        let error = complaint(&file[..file.len() - 2], &Limits::default());
        assert!(error.contains("no end marker"), "{error}");
    }

    #[test]
    fn pictures_beyond_the_limit_are_refused_from_their_header() {
        let error = complaint(&png_header(100_000, 100_000), &Limits::default());
        assert!(error.contains("37.3 GiB; the limit is 1 GiB"), "{error}");
        let error = complaint(b"#?RADIANCE\n\n-Y 2147483648 +X 2147483648\n", &Limits::default());
        assert!(error.contains("limit is 1 GiB"), "{error}");
        let error = complaint(b"PF\n4294967295 4294967295\n-1.0\n", &Limits::default());
        assert!(error.contains("more memory than there is; the limit is 1 GiB"), "{error}");
        let small = Limits { decoded_bytes: 100 };
        for format in FORMATS {
            let error = complaint(&saved(&noise(), format), &small);
            assert!(error.contains("the limit is 100 bytes"), "{format:?}: {error}");
        }
        for format in OTHERS {
            let error = complaint(&encoded(format), &small);
            assert!(error.contains("the limit is 100 bytes"), "{format:?}: {error}");
        }
    }

    #[test]
    fn files_too_short_for_their_size_are_refused() {
        let error = complaint(&png_header(10_000, 10_000), &Limits::default());
        assert!(error.contains("the file is cut off"), "{error}");
        let error = complaint(b"#?RADIANCE\n\n-Y 8000 +X 8000\n", &Limits::default());
        assert!(error.contains("the file is cut off"), "{error}");
        let error = complaint(b"PF\n5000 5000\n-1.0\n", &Limits::default());
        assert!(error.contains("the file is cut off"), "{error}");
    }

    #[test]
    fn texts_that_unpack_to_a_gigabyte_are_not_unpacked() {
        let mut file = Vec::new();
        let mut encoder = ::png::Encoder::new(&mut file, 1, 1);
        encoder.add_ztxt_chunk("Comment".into(), "a".repeat(1 << 22)).unwrap();
        encoder.write_header().unwrap().write_image_data(&[200]).unwrap();
        let limits = Limits { decoded_bytes: 4 };
        assert_eq!(decode(&file, "bomb", &limits).unwrap().width, 1);
    }

    #[test]
    fn what_is_no_picture_says_so() {
        assert!(complaint(b"", &Limits::default()).contains("empty"));
        let error = complaint(b"<svg></svg>", &Limits::default());
        assert!(error.contains("not a picture in a known format"), "{error}");
        assert!(error.contains("help: PNG, JPEG, WebP, KTX2, TGA, BMP, TIFF, GIF,"), "{error}");
    }

    #[test]
    fn pixels_that_are_not_numbers_are_refused_with_their_place() {
        let mut file = saved(&Image::new(3, 2), Format::Pfm);
        // The first pixel of the upper row comes behind the lower row.
        let at = file.len() - 2 * 12;
        file[at..at + 4].copy_from_slice(&f32::NAN.to_le_bytes());
        let error = complaint(&file, &Limits::default());
        assert!(error.starts_with("wood.png: pixel (1, 0): "), "{error}");
    }
}
