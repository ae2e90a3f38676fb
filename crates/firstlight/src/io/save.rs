//! Pictures out: an [`Image`] → the bytes of a PNG, EXR, HDR or PFM file.

use super::access::shown;
use super::{exr, hdr, pfm, png};
use crate::Image;
use crate::color::{Rgb, View};
use crate::diagnostic::{Diagnostic, Result};
use crate::suggest::nearest;
use std::path::Path;

/// A file format for pictures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Developed and sRGB-encoded, for screens. Alpha is straight; there is none if every pixel is opaque.
    Png {
        /// Bits of each channel.
        bits: BitDepth,
    },
    /// Linear RGBA radiance without loss, ZIP-compressed. Colour is multiplied by alpha, as OpenEXR demands.
    Exr {
        /// The numbers it is stored in.
        precision: Precision,
    },
    /// Linear radiance with a shared exponent, to about 1 %. There is no alpha: colour is multiplied by it.
    Hdr,
    /// Linear RGB radiance as plain `f32`. There is no alpha: colour is multiplied by it.
    Pfm,
}

/// Bits of each channel of a PNG.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum BitDepth {
    /// 256 steps.
    #[default]
    Eight,
    /// 65536 steps.
    Sixteen,
}

/// The numbers an EXR file is stored in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Precision {
    /// 16-bit floats: 11 significant bits, up to 65504; what is brighter is cut off there.
    Half,
    /// 32-bit floats.
    #[default]
    Float,
}

impl Format {
    /// The extensions of the formats that can be written.
    pub const EXTENSIONS: [&str; 4] = ["png", "exr", "hdr", "pfm"];

    /// The format that a path's extension names: 8-bit PNG, 32-bit EXR, HDR or PFM.
    ///
    /// # Errors
    /// If there is no extension or it is not one of [`Format::EXTENSIONS`].
    pub fn from_path(path: &Path) -> Result<Self> {
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        match extension.as_str() {
            "png" => Ok(Self::Png { bits: BitDepth::default() }),
            "exr" => Ok(Self::Exr { precision: Precision::default() }),
            "hdr" => Ok(Self::Hdr),
            "pfm" => Ok(Self::Pfm),
            _ => Err(Box::new(unknown_extension(path, &extension))),
        }
    }
}

fn unknown_extension(path: &Path, extension: &str) -> Diagnostic {
    let near = nearest(extension, Format::EXTENSIONS);
    let message = match (extension, near) {
        ("", _) => "the name of a picture needs an extension that says its format".to_owned(),
        (_, Some(near)) => {
            format!("unknown picture format \".{extension}\"; did you mean \".{near}\"?")
        }
        (_, None) => format!("pictures cannot be written as \".{extension}\""),
    };
    let known = "known are .png (for screens), .exr, .hdr and .pfm (linear radiance)";
    Diagnostic::new(shown(path), message).help(known)
}

/// How radiance becomes display values: radiance × 2^EV, seen by a view.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Develop {
    /// Stops of exposure. 0: radiance 1 is display white.
    pub exposure_ev: f32,
    /// What is made of light that is brighter than white.
    pub view: View,
    /// Whether values between two steps of 8 bits become a pattern of both, so that soft shades show no bands. What a
    /// step holds exactly stays what it is.
    pub dither: bool,
}

impl Develop {
    /// Linear display values 0..1 of a pixel; its alpha is kept. NaN becomes 0.
    pub fn display(self, [r, g, b, a]: [f32; 4]) -> [f32; 4] {
        let shown = self.view.display(self.exposure_ev.exp2() * Rgb::new(r, g, b));
        shown.extend(if a > 0.0 { a.min(1.0) } else { 0.0 }).to_array()
    }
}

/// How a picture was made, stored inside it where the format has a place for that (all but PFM).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Metadata {
    /// The program and its version.
    pub software: String,
    /// Names and texts: scene, resolution, samples, seed, exposure, command …
    pub entries: Vec<(String, String)>,
}

impl Default for Metadata {
    /// This library and its version, no entries.
    fn default() -> Self {
        let software = concat!("firstlight ", env!("CARGO_PKG_VERSION")).into();
        Self { software, entries: Vec::new() }
    }
}

impl Metadata {
    /// Everything as key and text, the software first.
    pub(super) fn all(&self) -> impl Iterator<Item = (&str, &str)> {
        let entries = self.entries.iter().map(|(key, text)| (key.as_str(), text.as_str()));
        std::iter::once(("Software", self.software.as_str())).chain(entries)
    }
}

/// Encodes a picture. Only PNG is developed; the other formats keep linear radiance, and EXR notes the exposure
/// and the view in its attributes `exposureEV` and `viewTransform`. NaN is never written, it becomes 0; infinities become the largest number.
///
/// # Errors
/// If the picture has no pixels or is too large for the format.
pub fn save(
    image: &Image,
    format: Format,
    develop: Develop,
    metadata: &Metadata,
) -> Result<Vec<u8>> {
    let (width, height) = (image.width(), image.height());
    if width == 0 || height == 0 {
        let message = format!("a picture of {width} × {height} pixels cannot be saved");
        return Err(Box::new(Diagnostic::new("", message)));
    }
    let refused = |cause: &dyn std::error::Error| {
        let size = format!("the picture of {width} × {height} pixels");
        Box::new(Diagnostic::new("", format!("{size} cannot be encoded: {cause}")))
    };
    match format {
        Format::Png { bits } => {
            png::encode(image, bits, develop, metadata).map_err(|e| refused(&e))
        }
        Format::Exr { precision } => {
            exr::encode(image, precision, develop, metadata).map_err(|e| refused(&e))
        }
        Format::Hdr => Ok(hdr::encode(image, metadata)),
        Format::Pfm => Ok(pfm::encode(image)),
    }
}

/// A pixel for formats of linear numbers: colour multiplied by alpha, everything finite.
pub(super) fn premultiplied([r, g, b, a]: [f32; 4]) -> [f32; 4] {
    let alpha = finite(a).clamp(0.0, 1.0);
    let [r, g, b] = [r, g, b].map(|value| finite(value) * alpha);
    [r, g, b, alpha]
}

fn finite(value: f32) -> f32 {
    if value.is_nan() { 0.0 } else { value.clamp(f32::MIN, f32::MAX) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::srgb_linear8;
    use crate::io::{Limits, load_image};

    const PNG: Format = Format::Png { bits: BitDepth::Eight };

    fn saved(image: &Image, format: Format) -> Vec<u8> {
        save(image, format, Develop::default(), &Metadata::default()).unwrap()
    }

    fn one_pixel(pixel: [f32; 4]) -> Image {
        Image::from_pixels(1, 1, vec![pixel])
    }

    fn png_codes(image: &Image, develop: Develop) -> (::png::ColorType, Vec<u8>) {
        let file = save(image, PNG, develop, &Metadata::default()).unwrap();
        let mut reader = ::png::Decoder::new(std::io::Cursor::new(file)).read_info().unwrap();
        let mut codes = vec![0; reader.output_buffer_size().unwrap()];
        let color = reader.next_frame(&mut codes).unwrap().color_type;
        (color, codes)
    }

    #[test]
    fn a_colour_comes_out_as_it_was_typed_in() {
        let hex = [0xFF, 0xF9, 0xBE];
        let [r, g, b] = hex.map(srgb_linear8);
        let (color, codes) = png_codes(&one_pixel([r, g, b, 1.0]), Develop::default());
        assert_eq!((color, codes.as_slice()), (::png::ColorType::Rgb, hex.as_slice()));
    }

    #[test]
    fn exposure_doubles_with_each_stop() {
        let image = one_pixel([0.25, 0.5, 4.0, 0.5]);
        let (color, codes) = png_codes(&image, Develop { exposure_ev: 1.0, ..Develop::default() });
        assert_eq!(color, ::png::ColorType::Rgba);
        assert_eq!(codes, [188, 255, 255, 128]);
        let (_, codes) = png_codes(&image, Develop { exposure_ev: -3.0, ..Develop::default() });
        assert_eq!(codes, [49, 71, 188, 128]);
    }

    #[test]
    fn nothing_but_numbers_is_written() {
        let image = one_pixel([f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::NAN]);
        for format in [PNG, Format::Exr { precision: Precision::Half }, Format::Hdr, Format::Pfm] {
            let back = load_image(&saved(&image, format), "x", &Limits::default()).unwrap();
            assert!(back.pixels().iter().flatten().all(|value| value.is_finite()), "{format:?}");
        }
        let opaque = one_pixel([f32::NAN, f32::INFINITY, 1e30, 1.0]);
        assert_eq!(png_codes(&opaque, Develop::default()).1, [0, 255, 255]);
    }

    #[test]
    fn alpha_survives_where_there_is_some() {
        let image = one_pixel([2.0, 1.0, 0.5, 0.25]);
        let exr = saved(&image, Format::Exr { precision: Precision::Float });
        assert_eq!(load_image(&exr, "x", &Limits::default()).unwrap(), image);
        let pfm = saved(&image, Format::Pfm);
        let over_black = one_pixel([0.5, 0.25, 0.125, 1.0]);
        assert_eq!(load_image(&pfm, "x", &Limits::default()).unwrap(), over_black);
    }

    #[test]
    fn linear_formats_ignore_the_exposure() {
        let image = one_pixel([0.5, 4.0, 0.25, 1.0]);
        for format in [Format::Exr { precision: Precision::Half }, Format::Hdr, Format::Pfm] {
            let bright = Develop { exposure_ev: 3.0, ..Develop::default() };
            let file = save(&image, format, bright, &Metadata::default()).unwrap();
            assert_eq!(load_image(&file, "x", &Limits::default()).unwrap(), image, "{format:?}");
        }
    }

    #[test]
    fn the_same_picture_gives_the_same_bytes() {
        let entries = vec![("Scene".into(), "a.toml".into()), ("Seed".into(), "7".into())];
        let metadata = Metadata { entries, ..Metadata::default() };
        let image = Image::new(20, 20);
        for extension in Format::EXTENSIONS {
            let format = Format::from_path(&Path::new("x").with_extension(extension)).unwrap();
            let write = || save(&image, format, Develop::default(), &metadata).unwrap();
            assert_eq!(write(), write(), "{extension}");
        }
    }

    #[test]
    fn png_tells_how_it_was_made() {
        let entries = [("Scene", "Küche.toml"), ("Command", "render"), ("Ümlaut", ""), ("", "x")];
        let entries = entries.map(|(key, text)| (key.to_owned(), text.to_owned())).to_vec();
        let metadata = Metadata { software: "firstlight".into(), entries };
        let file = save(&Image::new(1, 1), PNG, Develop::default(), &metadata).unwrap();
        let mut reader = ::png::Decoder::new(std::io::Cursor::new(file)).read_info().unwrap();
        reader.finish().unwrap();
        let info = reader.info();
        assert_eq!(info.srgb, Some(::png::SrgbRenderingIntent::RelativeColorimetric));
        let plain = &info.uncompressed_latin1_text;
        let texts: Vec<_> = plain.iter().map(|t| (t.keyword.as_str(), t.text.as_str())).collect();
        let expected = [("Software", "firstlight"), ("Command", "render"), ("mlaut", "")];
        assert_eq!(texts[..3], expected);
        assert_eq!(texts[3], ("Comment", "x"));
        assert_eq!(info.utf8_text[0].keyword, "Scene");
        assert_eq!(info.utf8_text[0].get_text().unwrap(), "Küche.toml");
    }

    #[test]
    fn exr_and_hdr_tell_how_they_were_made() {
        let entries = vec![("Scene".into(), "Küche.toml\n\n".into()), ("Seed".into(), "7".into())];
        let metadata = Metadata { software: "firstlight".into(), entries };
        let image = Image::new(1, 1);
        let develop = Develop { exposure_ev: 1.5, ..Develop::default() };
        let exr =
            save(&image, Format::Exr { precision: Precision::Half }, develop, &metadata).unwrap();
        let meta = ::exr::meta::MetaData::read_from_buffered(exr.as_slice(), true).unwrap();
        let attributes = &meta.headers[0].own_attributes;
        let comments = attributes.comments.as_ref().unwrap().as_slice();
        assert_eq!(comments, "Scene: Küche.toml\n\n\nSeed: 7".as_bytes());
        assert_eq!(attributes.software_name.as_ref().unwrap().to_string(), "firstlight");
        let mut others: Vec<_> = attributes.other.keys().map(ToString::to_string).collect();
        others.sort();
        assert_eq!(others, ["exposureEV", "viewTransform"]);
        assert!(meta.headers[0].shared_attributes.chromaticities.is_some());
        let hdr = save(&image, Format::Hdr, develop, &metadata).unwrap();
        let header = "#?RADIANCE\n# Software: firstlight\n# Scene: Küche.toml  \n# Seed: 7\nFORMAT";
        assert!(hdr.starts_with(header.as_bytes()));
    }

    #[test]
    fn formats_are_known_by_extension() {
        let format = |name: &str| Format::from_path(Path::new(name));
        assert_eq!(format("a/b.PNG").unwrap(), PNG);
        assert_eq!(format("b.exr").unwrap(), Format::Exr { precision: Precision::Float });
        assert_eq!(format("b.hdr").unwrap(), Format::Hdr);
        assert_eq!(format("b.x.pfm").unwrap(), Format::Pfm);
        let error = format("out.pgn").unwrap_err().to_string();
        assert!(
            error.starts_with("out.pgn: unknown picture format \".pgn\"; did you mean"),
            "{error}"
        );
        let error = format("out.jpg").unwrap_err().to_string();
        assert!(error.contains("help: known are .png (for screens), .exr, .hdr"), "{error}");
        assert!(format("out").unwrap_err().message.contains("needs an extension"));
    }

    #[test]
    fn a_picture_without_pixels_is_refused() {
        for extension in Format::EXTENSIONS {
            let format = Format::from_path(&Path::new("x").with_extension(extension)).unwrap();
            let empty = save(&Image::new(0, 3), format, Develop::default(), &Metadata::default());
            assert_eq!(empty.unwrap_err().message, "a picture of 0 × 3 pixels cannot be saved");
        }
    }
}
