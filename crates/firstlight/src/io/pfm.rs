//! PFM: plain `f32` pixels, rows from the bottom.

use super::pixels::{Input, rgba};
use super::save::premultiplied;
use crate::Image;
use crate::diagnostic::Result;
use crate::scene::description::Pixels;

/// Reads `PF` (RGB) and `Pf` (grey) files; a negative scale means little endian, its size is not applied.
pub(super) fn decode(input: &Input) -> Result<Pixels> {
    let header = Header::read(input.bytes).ok_or_else(|| {
        input.fail("the header of this PFM file is damaged: size and scale expected")
    })?;
    let Header { channels, width, height, little_endian, data } = header;
    let count = input.room_for(width.into(), height.into(), 16)?;
    let bytes = count * channels * size_of::<f32>();
    input.at_least((input.bytes.len() - data.len() + bytes) as u64)?;
    let number = if little_endian { f32::from_le_bytes } else { f32::from_be_bytes };
    let samples: Vec<f32> = data.as_chunks().0.iter().map(|&bytes| number(bytes)).collect();
    let rows = samples.chunks_exact(width as usize * channels).take(height as usize);
    let texels = rows.rev().flat_map(|row| rgba(row, channels, 1.0)).collect();
    input.linear(width, height, texels)
}

struct Header<'a> {
    channels: usize,
    width: u32,
    height: u32,
    little_endian: bool,
    data: &'a [u8],
}

impl<'a> Header<'a> {
    fn read(bytes: &'a [u8]) -> Option<Self> {
        let mut rest = bytes;
        let channels = if word(&mut rest)? == "PF" { 3 } else { 1 };
        let (width, height) = (word(&mut rest)?.parse().ok()?, word(&mut rest)?.parse().ok()?);
        let scale: f32 = word(&mut rest)?.parse().ok()?;
        let usable = scale.is_finite() && scale != 0.0;
        usable.then_some(Self { channels, width, height, little_endian: scale < 0.0, data: rest })
    }
}

/// The next word, taking it and the single white space behind it away.
fn word<'a>(rest: &mut &'a [u8]) -> Option<&'a str> {
    let text = rest.trim_ascii_start();
    let length = text.iter().position(u8::is_ascii_whitespace)?;
    let (word, behind) = text.split_at_checked(length)?;
    *rest = behind.get(1..)?;
    std::str::from_utf8(word).ok()
}

pub(super) fn encode(image: &Image) -> Vec<u8> {
    let (width, height) = (image.width(), image.height());
    let mut file = format!("PF\n{width} {height}\n-1.0\n").into_bytes();
    for row in image.pixels().chunks_exact(width as usize).rev() {
        for &pixel in row {
            let [r, g, b, _] = premultiplied(pixel);
            file.extend([r, g, b].into_iter().flat_map(f32::to_le_bytes));
        }
    }
    file
}

#[cfg(test)]
mod tests {
    use crate::io::{Limits, load_image};

    fn load(header: &str, numbers: &[[u8; 4]]) -> Option<Vec<[f32; 4]>> {
        let file = [header.as_bytes(), numbers.as_flattened()].concat();
        let image = load_image(&file, "a.pfm", &Limits::default()).ok()?;
        Some(image.pixels().to_vec())
    }

    #[test]
    fn reads_grey_and_both_byte_orders_from_the_bottom() {
        let expected = vec![[2.0, 2.0, 2.0, 1.0], [1.0, 1.0, 1.0, 1.0]];
        let little = [1.0, 2.0].map(f32::to_le_bytes);
        assert_eq!(load("Pf\n1 2\n-1.0\n", &little), Some(expected.clone()));
        let big = [1.0, 2.0].map(f32::to_be_bytes);
        assert_eq!(load("Pf 1\t2\r\n1\n", &big), Some(expected));
    }

    #[test]
    fn refuses_damaged_headers() {
        for header in ["Pf\n1", "Pf\n1 2 0\n", "Pf\n-1 2 1\n", "Pf\n1 2 NaN\n", "Pf\n0 0 1\n"] {
            assert_eq!(load(header, &[[0; 4]; 2]), None, "{header}");
        }
    }
}
