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
    refuse_others(input)?;
    let [width, height] = [20, 24].map(|at| number(input, at));
    input.room_for(width.into(), height.into(), 4)?;
    let [begin, length, unpacked] = [80, 88, 96].map(|at| long(input, at));
    input.at_least(begin.saturating_add(length))?;
    let blocks = u64::from(width.div_ceil(4)) * u64::from(height.div_ceil(4));
    if unpacked > blocks * BLOCK {
        return Err(input.fail("this KTX2 picture says it holds more than its size allows").into());
    }
    let transcoder = Transcoder::new(input.bytes).map_err(damaged)?;
    let bytes =
        transcoder.transcode(0, TargetFormat::Rgba32, DecodeFlags::NONE).map_err(damaged)?;
    Ok(input.srgb(width, height, bytes.as_chunks().0.to_vec()))
}

/// Refuses what else such files may hold, of which a part would be shown as if it were all.
fn refuse_others(input: &Input) -> Result<()> {
    // The header, and what says where the largest picture is.
    input.at_least(104)?;
    let [format, height, depth, layers, faces, scheme] =
        [12, 24, 28, 32, 36, 44].map(|at| number(input, at));
    let one = "save each of its pictures as a file of its own";
    let basis =
        "save it with Basis Universal's compression (toktx --encode uastc), or as PNG or EXR";
    let (what, help) = match () {
        () if faces > 1 => ("a cube map".into(), "save it as one lat-long picture"),
        () if layers > 1 => (format!("an array of {layers} pictures"), one),
        () if depth > 0 => ("a volume".into(), one),
        () if height == 0 => ("a single row of texels".into(), "save it with a height of 1"),
        () if scheme == 3 => ("texels that zlib has compressed".into(), basis),
        () if (1..157).contains(&format) => (format!("texels of Vulkan's format {format}"), basis),
        () => return Ok(()),
    };
    Err(input.fail(format!("this KTX2 file holds {what}, which cannot be read")).help(help).into())
}

/// The 32-bit number at a place of the file; 0 behind its end.
fn number(input: &Input, at: usize) -> u32 {
    let bytes = input.bytes.get(at..).and_then(|rest| rest.first_chunk());
    bytes.map_or(0, |bytes| u32::from_le_bytes(*bytes))
}

/// The 64-bit number there.
fn long(input: &Input, at: usize) -> u64 {
    u64::from(number(input, at)) | u64::from(number(input, at + 4)) << 32
}

#[cfg(test)]
mod tests {
    use crate::io::Limits;
    use crate::io::pixels::decode;
    use crate::scene::description::Texels;

    /// A file of UASTC to be written.
    struct File {
        /// Vulkan's format, size of a type, width, height, depth, layers, faces, levels, scheme.
        header: [u32; 9],
        /// The data of each level, the largest first, and how long they say they are when unpacked.
        levels: Vec<(Vec<u8>, u64)>,
    }

    impl File {
        /// A picture whose levels have blocks of these colours.
        fn new(width: u32, height: u32, levels: &[&[[u8; 4]]]) -> Self {
            let level = |colors: &&[[u8; 4]]| {
                let data = colors.iter().flat_map(|color| block(*color)).collect::<Vec<_>>();
                let unpacked = data.len() as u64;
                (data, unpacked)
            };
            Self {
                header: [0, 1, width, height, 0, 0, 1, levels.len() as u32, 0],
                levels: levels.iter().map(level).collect(),
            }
        }

        /// The file; smaller levels come first.
        fn bytes(&self) -> Vec<u8> {
            let mut file = b"\xABKTX 20\xBB\r\n\x1A\n".to_vec();
            let descriptor = 80 + 24 * self.levels.len() as u32;
            for word in self.header.into_iter().chain([descriptor, 44, 0, 0, 0, 0, 0, 0]) {
                file.extend(u32::to_le_bytes(word));
            }
            let data = u64::from(descriptor) + 44;
            for (i, (level, unpacked)) in self.levels.iter().enumerate() {
                let before = self.levels[i + 1..].iter().map(|(level, _)| level.len() as u64);
                for long in [data + before.sum::<u64>(), level.len() as u64, *unpacked] {
                    file.extend(u64::to_le_bytes(long));
                }
            }
            // Colour model UASTC, Rec. 709, sRGB; blocks of 4 × 4 texels in 16 bytes; one sample of 128 bits, RGBA.
            let (model, sample) = (2 << 16 | 1 << 8 | 166, 127 << 16 | 3 << 24);
            for word in [44, 0, 40 << 16 | 2, model, 0x0303, 16, 0, sample, 0, 0, u32::MAX] {
                file.extend(u32::to_le_bytes(word));
            }
            self.levels.iter().rev().for_each(|(level, _)| file.extend(level));
            file
        }
    }

    /// 4 × 4 texels of one colour: UASTC's mode 8.
    fn block(color: [u8; 4]) -> [u8; 16] {
        (0b10111 | u128::from(u32::from_le_bytes(color)) << 5).to_le_bytes()
    }

    /// A frame of zstd (RFC 8878) with one block that is kept as it is.
    fn zstd(data: &[u8]) -> Vec<u8> {
        let length = u8::try_from(data.len()).unwrap();
        let header = u32::to_le_bytes(u32::from(length) << 3 | 1);
        let start = [&[0x28, 0xB5, 0x2F, 0xFD, 0x20, length], &header[..3]].concat();
        [&start, data].concat()
    }

    fn texels(file: &File) -> Vec<[u8; 4]> {
        let pixels = decode(&file.bytes(), "x.ktx2", &Limits::default()).unwrap();
        assert_eq!([pixels.width, pixels.height], [file.header[2], file.header[3]]);
        let Texels::Srgb8(texels) = pixels.texels else { panic!("{:?}", pixels.texels) };
        texels
    }

    fn refused(file: &[u8]) -> String {
        decode(file, "x.ktx2", &Limits::default()).unwrap_err().to_string()
    }

    const RED: [u8; 4] = [200, 100, 50, 255];
    const GREEN: [u8; 4] = [10, 220, 30, 128];
    const BLUE: [u8; 4] = [0, 1, 250, 0];

    #[test]
    fn blocks_stand_side_by_side_and_are_cut_at_the_border() {
        assert_eq!(texels(&File::new(4, 4, &[&[RED]])), [RED; 16]);
        let texels = texels(&File::new(5, 6, &[&[RED, GREEN, BLUE, RED]]));
        for (i, texel) in texels.into_iter().enumerate() {
            let expected = [[RED, GREEN], [BLUE, RED]][i / 5 / 4][i % 5 / 4];
            assert_eq!(texel, expected, "({}, {})", i % 5, i / 5);
        }
    }

    #[test]
    fn the_largest_of_several_levels_is_shown() {
        assert_eq!(texels(&File::new(4, 4, &[&[RED], &[GREEN], &[BLUE]])), [RED; 16]);
    }

    #[test]
    fn what_zstd_compressed_is_unpacked() {
        let mut file = File::new(8, 4, &[&[RED, GREEN], &[BLUE]]);
        file.header[8] = 2;
        file.levels.iter_mut().for_each(|(level, _)| *level = zstd(level));
        assert_eq!(texels(&file)[3..5], [RED, GREEN]);
        file.levels[0].0[0] ^= 1;
        assert!(refused(&file.bytes()).contains("cannot be read"));
    }

    /// Every field that makes it something else than a picture of Basis Universal.
    #[test]
    fn other_kinds_are_named() {
        let with = |field: usize, value| {
            let mut file = File::new(4, 4, &[&[RED]]);
            file.header[field] = value;
            refused(&file.bytes())
        };
        let expect = |message: String, what: &str| {
            assert!(message.contains(what) && message.contains("help: "), "{message}");
        };
        expect(with(6, 6), "a cube map");
        expect(with(5, 3), "an array of 3 pictures");
        expect(with(4, 2), "a volume");
        expect(with(3, 0), "a single row");
        expect(with(8, 3), "zlib");
        // BC7, sRGB.
        expect(with(0, 146), "Vulkan's format 146");
        assert!(with(2, 0).contains("no pixels"));
        // Array of one.
        let mut file = File::new(4, 4, &[&[RED]]);
        file.header[5] = 1;
        assert_eq!(texels(&file), [RED; 16]);
    }

    #[test]
    fn damaged_files_are_refused() {
        let whole = File::new(4, 4, &[&[[1, 2, 3, 4]]]).bytes();
        for length in 12..whole.len() {
            assert!(refused(&whole[..length]).contains("cut off"), "{length}");
        }
        for byte in 12..whole.len() {
            let mut file = whole.clone();
            file[byte] ^= 0xFF;
            let _ = decode(&file, "x.ktx2", &Limits::default());
        }
        let mut bomb = File::new(4, 4, &[&[RED]]);
        bomb.levels[0].1 = 1 << 40;
        assert!(refused(&bomb.bytes()).contains("more than"));
    }
}
