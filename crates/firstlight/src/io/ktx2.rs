//! KTX 2.0 with Basis Universal's compression, as glTF's KHR_texture_basisu has it.

use super::pixels::Input;
use crate::diagnostic::Result;
use crate::scene::description::Pixels;
use basisu::{DecodeFlags, TargetFormat, Transcoder};

/// Bytes of a block of 4 × 4 texels, before they are compressed once more.
const BLOCK: u64 = 16;

/// The largest picture of the file; smaller ones are made from it.
pub(super) fn decode(input: &Input) -> Result<Pixels> {
    let damaged = |cause: basisu::Error| {
        let message = format!("this KTX2 picture cannot be read: {cause:?}");
        input
            .fail(message)
            .help("ETC1S and UASTC of Basis Universal are known, with or without zstd")
    };
    let number = |at: usize| {
        let bytes = input.bytes.get(at..).and_then(|rest| rest.first_chunk());
        bytes.map_or(0, |bytes| u32::from_le_bytes(*bytes))
    };
    let [width, height] = [number(20), number(24)];
    input.room_for(width.into(), height.into(), 4)?;
    let blocks = u64::from(width.div_ceil(4)) * u64::from(height.div_ceil(4));
    let unpacked = u64::from(number(96)) | u64::from(number(100)) << 32;
    if unpacked > blocks * BLOCK {
        return Err(input.fail("this KTX2 picture says it holds more than its size allows").into());
    }
    let transcoder = Transcoder::new(input.bytes).map_err(damaged)?;
    let bytes =
        transcoder.transcode(0, TargetFormat::Rgba32, DecodeFlags::NONE).map_err(damaged)?;
    Ok(input.srgb(width, height, bytes.as_chunks().0.to_vec()))
}

#[cfg(test)]
mod tests {
    use crate::io::Limits;
    use crate::io::pixels::decode;
    use crate::scene::description::Texels;

    /// A picture of 4 × 4 texels of one colour: a single block of UASTC's mode 8.
    fn one_block(color: [u8; 4], unpacked: u64) -> Vec<u8> {
        let mut file = b"\xABKTX 20\xBB\r\n\x1A\n".to_vec();
        let (dfd, data) = (104_u32, 148_u32);
        for word in [0, 1, 4, 4, 0, 0, 1, 1, 0, dfd, 44, 0, 0] {
            file.extend(u32::to_le_bytes(word));
        }
        for long in [0, 0, u64::from(data), 16, unpacked] {
            file.extend(u64::to_le_bytes(long));
        }
        // Colour model UASTC, Rec. 709, sRGB; blocks of 4 × 4 texels in 16 bytes; one sample of 128 bits, RGBA.
        file.extend(u32::to_le_bytes(44));
        for word in [
            0,
            40 << 16 | 2,
            2 << 16 | 1 << 8 | 166,
            0x0303,
            16,
            0,
            127 << 16 | 3 << 24,
            0,
            0,
            u32::MAX,
        ] {
            file.extend(u32::to_le_bytes(word));
        }
        let block = 0b10111 | u128::from(u32::from_le_bytes(color)) << 5;
        file.extend(block.to_le_bytes());
        file
    }

    #[test]
    fn a_block_of_one_colour_comes_out_as_it_is() {
        let color = [200, 100, 50, 255];
        let pixels = decode(&one_block(color, 16), "x.ktx2", &Limits::default()).unwrap();
        assert_eq!((pixels.width, pixels.height), (4, 4));
        let Texels::Srgb8(texels) = pixels.texels else { panic!("{:?}", pixels.texels) };
        assert!(texels.iter().all(|texel| *texel == color), "{texels:?}");
    }

    #[test]
    fn damaged_files_are_refused() {
        let whole = one_block([1, 2, 3, 4], 16);
        for length in 0..whole.len() {
            let error = decode(&whole[..length], "x.ktx2", &Limits::default());
            assert!(error.is_err(), "{length}");
        }
        for byte in 12..whole.len() {
            let mut file = whole.clone();
            file[byte] ^= 0xFF;
            let _ = decode(&file, "x.ktx2", &Limits::default());
        }
        let bomb = one_block([0; 4], 1 << 40);
        assert!(decode(&bomb, "x", &Limits::default()).unwrap_err().message.contains("more than"));
    }
}
