//! Radiance HDR: three 8-bit mantissas with a shared exponent, run-length encoded (Ward, Graphics Gems II.5).

use super::pixels::Input;
use super::save::{Metadata, premultiplied};
use crate::Image;
use crate::diagnostic::{Diagnostic, Result};
use crate::scene::description::Pixels;
use std::ops::RangeInclusive;

/// Red, green, blue mantissa and exponent.
type Rgbe = [u8; 4];

/// The widths for which scanlines are stored as four run-length encoded planes.
const PLANAR_WIDTHS: RangeInclusive<usize> = 8..=32_767;

pub(super) fn decode(input: &Input) -> Result<Pixels> {
    let mut rest = input.bytes;
    let header = read_header(input, &mut rest)?;
    let (width, height) = (header.width as usize, header.height as usize);
    let count = input.room_for(header.width.into(), header.height.into(), 16)?;
    let behind_header = input.bytes.len() - rest.len();
    input.at_least((behind_header + 4 * height) as u64)?;
    // The usual planes expand at most sixteenfold; the old format's longer runs may grow it.
    let mut texels = Vec::with_capacity(count.min(16 * rest.len()));
    for y in 0..height {
        let row = read_row(&mut rest, width).ok_or_else(|| broken_row(input, rest, y))?;
        let scale = 1.0 / header.exposure;
        texels.extend(row.into_iter().map(|pixel| decode_pixel(pixel, scale)));
    }
    if header.from_bottom {
        texels = texels.rchunks_exact(width).flatten().copied().collect();
    }
    if header.from_right {
        texels.chunks_exact_mut(width).for_each(<[_]>::reverse);
    }
    input.linear(header.width, header.height, texels)
}

fn broken_row(input: &Input, rest: &[u8], y: usize) -> Diagnostic {
    let byte = input.bytes.len() - rest.len();
    let cause = if rest.is_empty() { "the file is cut off" } else { "the data is damaged" };
    input.fail(format!("{cause} in row {y} of this HDR picture")).at_part(format!("byte {byte}"))
}

struct Header {
    width: u32,
    height: u32,
    from_bottom: bool,
    from_right: bool,
    /// What the file's numbers were multiplied by.
    exposure: f32,
}

/// Reads `NAME=value` lines up to an empty one, then the line with the size.
fn read_header(input: &Input, rest: &mut &[u8]) -> Result<Header> {
    let cut_off = || input.fail("the header of this HDR picture is cut off");
    let mut exposure = 1.0;
    loop {
        let line = read_line(rest).ok_or_else(cut_off)?;
        if line.is_empty() {
            break;
        }
        let Some((name, value)) = line.split_once('=') else { continue };
        match (name.trim(), value.trim()) {
            ("FORMAT", "32-bit_rle_rgbe") => {}
            ("FORMAT", other) => {
                let message = format!("HDR pictures of format \"{other}\" cannot be read");
                return Err(input.fail(message).help("save it as 32-bit_rle_rgbe").into());
            }
            ("EXPOSURE", value) => exposure *= value.parse().unwrap_or(f32::NAN),
            _ => {}
        }
    }
    if !(exposure.is_normal() && exposure > 0.0) {
        return Err(input.fail("the EXPOSURE of this HDR picture is not a positive number").into());
    }
    let line = read_line(rest).ok_or_else(cut_off)?;
    read_size(&line, exposure).ok_or_else(|| {
        let message = format!("expected a size such as \"-Y 512 +X 1024\", found \"{line}\"");
        input.fail(message).at_part("header").into()
    })
}

/// Reads `-Y height +X width`; the signs tell the corner where the first pixel is.
fn read_size(line: &str, exposure: f32) -> Option<Header> {
    let mut words = line.split_ascii_whitespace();
    let mut word = || words.next();
    let (y_axis, height, x_axis, width) = (word()?, word()?, word()?, word()?);
    let from_bottom = ["-Y", "+Y"].iter().position(|axis| *axis == y_axis)? == 1;
    let from_right = ["+X", "-X"].iter().position(|axis| *axis == x_axis)? == 1;
    let (width, height) = (width.parse().ok()?, height.parse().ok()?);
    Some(Header { width, height, from_bottom, from_right, exposure })
}

fn read_line(rest: &mut &[u8]) -> Option<String> {
    let end = rest.iter().position(|&byte| byte == b'\n')?;
    let (line, behind) = rest.split_at_checked(end)?;
    *rest = behind.get(1..)?;
    Some(String::from_utf8_lossy(line).trim_end().to_owned())
}

fn read_row(rest: &mut &[u8], width: usize) -> Option<Vec<Rgbe>> {
    match **rest {
        [2, 2, high @ 0..128, low, ..] if PLANAR_WIDTHS.contains(&width) => {
            *rest = rest.get(4..)?;
            let stored = usize::from(u16::from_be_bytes([high, low]));
            if stored == width { read_planes(rest, width) } else { None }
        }
        _ => read_pixels(rest, width),
    }
}

/// One plane of mantissas after the other, then the exponents.
fn read_planes(rest: &mut &[u8], width: usize) -> Option<Vec<Rgbe>> {
    let mut row = vec![Rgbe::default(); width];
    for channel in 0..4 {
        let mut x = 0;
        while x < width {
            let length = usize::from(take_byte(rest)?);
            // Above 128: a run of one value. Otherwise: as many values as they are.
            let is_run = length > 128;
            let length = if is_run { length - 128 } else { length };
            let pixels = row.get_mut(x..x + length).filter(|pixels| !pixels.is_empty())?;
            let step = if is_run { 0 } else { 1 };
            let stored = if is_run { 1 } else { length };
            let (values, behind) = rest.split_at_checked(stored)?;
            for (i, pixel) in pixels.iter_mut().enumerate() {
                pixel[channel] = values[i * step];
            }
            *rest = behind;
            x += length;
        }
    }
    Some(row)
}

/// Pixels one by one, the old way: mantissas of 1, 1, 1 repeat the pixel before, and several such in a row are
/// the digits of one count to the base 256, the lowest first.
fn read_pixels(rest: &mut &[u8], width: usize) -> Option<Vec<Rgbe>> {
    let mut row = Vec::new();
    let mut digit = 1_usize;
    while row.len() < width {
        let (pixel, behind) = rest.split_first_chunk()?;
        *rest = behind;
        if let [1, 1, 1, count] = *pixel {
            let count = usize::from(count).checked_mul(digit)?;
            let last = *row.last()?;
            let length = row.len().checked_add(count).filter(|length| *length <= width)?;
            row.resize(length, last);
            digit = digit.saturating_mul(256);
        } else {
            row.push(*pixel);
            digit = 1;
        }
    }
    Some(row)
}

fn take_byte(rest: &mut &[u8]) -> Option<u8> {
    let (byte, behind) = rest.split_first()?;
    *rest = behind;
    Some(*byte)
}

fn decode_pixel([r, g, b, exponent]: Rgbe, scale: f32) -> [f32; 4] {
    // Exponent 0 means black; 2^(e − 136) reaches down into the subnormal numbers, hence in double precision.
    let unit = if exponent == 0 { 0.0 } else { f64::from(i32::from(exponent) - 136).exp2() };
    let value = |mantissa: u8| (f64::from(mantissa) * unit * f64::from(scale)) as f32;
    [value(r), value(g), value(b), 1.0]
}

pub(super) fn encode(image: &Image, metadata: &Metadata) -> Vec<u8> {
    let mut file = header(image, metadata).into_bytes();
    for row in image.pixels().chunks_exact(image.width() as usize) {
        let row: Vec<Rgbe> = row.iter().map(|&pixel| encode_pixel(premultiplied(pixel))).collect();
        if PLANAR_WIDTHS.contains(&row.len()) {
            write_planes(&mut file, &row);
        } else {
            file.extend(row.as_flattened());
        }
    }
    file
}

fn header(image: &Image, metadata: &Metadata) -> String {
    let mut header = String::from("#?RADIANCE\n");
    for (key, text) in metadata.all() {
        // As comments, because readers give some names a meaning.
        let line = format!("# {key}: {text}").replace(['\n', '\r', '\0'], " ");
        header.push_str(&line);
        header.push('\n');
    }
    let (width, height) = (image.width(), image.height());
    header + &format!("FORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n")
}

/// Rounds to the nearest mantissas; negative values become 0, and so does what is below 2⁻¹²⁶.
fn encode_pixel([r, g, b, _]: [f32; 4]) -> Rgbe {
    // The largest number that 255 · 2^(255 − 136) can hold.
    let largest = 255.0 * 119_f32.exp2();
    let [r, g, b] = [r, g, b].map(|value| value.clamp(0.0, largest));
    let brightest = r.max(g).max(b);
    if !brightest.is_normal() {
        return [0; 4];
    }
    // Of the brightest = m · 2^e with ½ ≤ m < 1; m may round up to 1.
    let mut exponent = (brightest.to_bits() >> 23) as i32 - 126;
    if f64::from(brightest) * mantissas_per_unit(exponent) >= 255.5 {
        exponent += 1;
    }
    let mantissa = |value: f32| (f64::from(value) * mantissas_per_unit(exponent)).round() as u8;
    [mantissa(r), mantissa(g), mantissa(b), (exponent + 128) as u8]
}

fn mantissas_per_unit(exponent: i32) -> f64 {
    f64::from(8 - exponent).exp2()
}

fn write_planes(file: &mut Vec<u8>, row: &[Rgbe]) {
    let [high, low] = (row.len() as u16).to_be_bytes();
    file.extend([2, 2, high, low]);
    for channel in 0..4 {
        let plane: Vec<u8> = row.iter().map(|pixel| pixel[channel]).collect();
        write_runs(file, &plane);
    }
}

/// Runs of at least four as a count above 128 and the value, everything between as a count and the values.
fn write_runs(file: &mut Vec<u8>, plane: &[u8]) {
    let mut literal: Vec<u8> = Vec::new();
    for run in plane.chunk_by(|a, b| a == b) {
        if run.len() < 4 {
            literal.extend(run);
            continue;
        }
        write_literal(file, &mut literal);
        for part in run.chunks(127) {
            file.extend([128 + part.len() as u8, part[0]]);
        }
    }
    write_literal(file, &mut literal);
}

fn write_literal(file: &mut Vec<u8>, literal: &mut Vec<u8>) {
    for part in literal.chunks(128) {
        file.push(part.len() as u8);
        file.extend(part);
    }
    literal.clear();
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::{Limits, load_image};

    fn load(bytes: &[u8]) -> Result<Image> {
        load_image(bytes, "sky.hdr", &Limits::default())
    }

    fn picture(header: &str, data: &[Rgbe]) -> Vec<u8> {
        [header.as_bytes(), data.as_flattened()].concat()
    }

    #[test]
    fn stores_mantissas_and_exponent() {
        assert_eq!(encode_pixel([1.0, 0.5, 0.0, 1.0]), [128, 64, 0, 129]);
        assert_eq!(decode_pixel([128, 64, 0, 129], 1.0), [1.0, 0.5, 0.0, 1.0]);
        assert_eq!(encode_pixel([0.0; 4]), [0; 4]);
        assert_eq!(encode_pixel([-1.0, 0.0, 1e-40, 1.0]), [0; 4]);
        assert_eq!(encode_pixel([f32::MAX, 0.0, 0.0, 1.0]), [255, 0, 0, 255]);
        // 0.999 · 256 rounds to 256, which is 128 with the next exponent.
        assert_eq!(encode_pixel([0.999, 0.0, 0.0, 1.0]), [128, 0, 0, 129]);
    }

    #[test]
    fn is_never_off_by_more_than_half_a_mantissa() {
        for step in -1200..1200 {
            let value = (step as f32 / 10.0).exp2() * 1.037;
            let [back, ..] = decode_pixel(encode_pixel([value, 0.0, 0.0, 1.0]), 1.0);
            assert!((back / value - 1.0).abs() <= 1.0 / 256.0, "{value} → {back}");
        }
    }

    #[test]
    fn every_code_survives() {
        for exponent in 3..=255 {
            for mantissa in 128..=255 {
                let code = [mantissa, mantissa / 2, 0, exponent];
                assert_eq!(encode_pixel(decode_pixel(code, 1.0)), code);
            }
        }
    }

    #[test]
    fn rows_of_every_width_and_long_runs_survive() {
        for width in [1, 2, 7, 8, 9, 127, 128, 129, 500, 40_000] {
            let color = |x: u32| if x % 300 < 150 { 0.5 } else { (x % 7) as f32 };
            let row = (0..width).map(|x| [color(x), color(x + 1), 0.25, 1.0]).collect::<Vec<_>>();
            let image = Image::from_pixels(width, 2, [row.clone(), row].concat());
            let file = encode(&image, &Metadata::default());
            let back = load(&file).unwrap();
            for (a, b) in back.pixels().iter().flatten().zip(image.pixels().iter().flatten()) {
                assert!((a - b).abs() <= 0.016, "{a} {b} {width}");
            }
        }
        let flat = encode(&Image::new(20_000, 1), &Metadata::default());
        assert!(flat.len() < 2_000, "{} bytes", flat.len());
    }

    #[test]
    fn reads_the_old_runs() {
        let one = [128, 128, 128, 129];
        let data = [one, [1, 1, 1, 2], [1, 1, 1, 1], [0; 4]];
        let image = load(&picture("#?RGBE\n\n-Y 1 +X 260\n", &data)).unwrap();
        assert_eq!(image.pixels()[258], [1.0; 4]);
        assert_eq!(image.pixels()[259], [0.0, 0.0, 0.0, 1.0]);
    }

    #[test]
    fn refuses_endless_and_homeless_runs() {
        for data in [vec![[1, 1, 1, 9]; 3], [vec![[9; 4]], vec![[1, 1, 1, 0]; 30]].concat()] {
            let error = load(&picture("#?RADIANCE\n\n-Y 1 +X 9\n", &data)).unwrap_err();
            assert!(error.to_string().starts_with("sky.hdr: byte "), "{error}");
        }
    }

    #[test]
    fn turns_pictures_that_start_at_another_corner() {
        let data = [[128, 0, 0, 129], [0, 128, 0, 129]];
        for (size, red) in [("-Y 1 +X 2", 0), ("-Y 1 -X 2", 1), ("-Y 2 +X 1", 0), ("+Y 2 +X 1", 1)]
        {
            let image = load(&picture(&format!("#?RADIANCE\n\n{size}\n"), &data)).unwrap();
            assert_eq!(image.pixels()[red], [1.0, 0.0, 0.0, 1.0], "{size}");
        }
        let error = load(b"#?RADIANCE\n\n+X 2 -Y 1\n").unwrap_err();
        assert!(error.message.contains("found \"+X 2 -Y 1\""), "{error}");
    }

    #[test]
    fn undoes_the_exposure() {
        let data = [[128, 64, 0, 129]];
        let header = "#?RADIANCE\nEXPOSURE=2.0\nEXPOSURE= 0.25\n\n-Y 1 +X 1\n";
        assert_eq!(load(&picture(header, &data)).unwrap().pixels()[0], [2.0, 1.0, 0.0, 1.0]);
        for exposure in ["0", "-1", "NaN", "inf", "1e99999", "bright", "1e-45"] {
            let header = format!("#?RADIANCE\nEXPOSURE={exposure}\n\n-Y 1 +X 1\n");
            assert!(load(&picture(&header, &data)).unwrap_err().message.contains("EXPOSURE"));
        }
    }

    #[test]
    fn refuses_other_colours() {
        let error = load(b"#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n").unwrap_err();
        assert!(error.message.contains("32-bit_rle_xyze"), "{error}");
    }
}
