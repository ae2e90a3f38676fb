//! Vertex streams: blocks of up to 256 vertices; in a block the bytes of each place in a vertex lie together,
//! as differences to the vertex before, in groups of sixteen with 0 to 8 bits each.

use super::Cursor;

/// Vertices whose same-place bytes share the widths in a header.
const GROUP: usize = 16;

/// Decodes `count` vertices of `stride` bytes.
pub(super) fn decode(bytes: &[u8], count: usize, stride: usize) -> Result<Vec<u8>, String> {
    if stride == 0 || !stride.is_multiple_of(4) || stride > 256 {
        return Err(format!("byteStride is {stride}; it must be a multiple of 4 up to 256"));
    }
    let mut data = Cursor(bytes);
    let version = data.version(0xa0)?;
    let (tail, least) = if version == 0 { (stride, 32) } else { (stride + stride / 4, 24) };
    let padded = data.take_tail(tail.max(least))?;
    let (first, channels) = padded.split_at(padded.len() - tail).1.split_at(stride);
    let channels = if version == 0 { None } else { Some(channels) };

    let block = (8192 / stride / GROUP * GROUP).min(256);
    let mut last = first.to_vec();
    let mut vertices = Vec::new();
    for start in (0..count).step_by(block) {
        let size = block.min(count - start);
        vertices.extend(decode_block(&mut data, size, channels, &mut last)?);
    }
    data.finish()?;
    Ok(vertices)
}

/// Decodes `size` vertices; `last` is the vertex before them and becomes the last of them.
fn decode_block(
    data: &mut Cursor,
    size: usize,
    channels: Option<&[u8]>,
    last: &mut [u8],
) -> Result<Vec<u8>, String> {
    let stride = last.len();
    let control = if channels.is_some() { data.take(stride / 4)? } else { &[] };
    let mut vertices = vec![0; size * stride];
    for (word, last) in last.chunks_exact_mut(4).enumerate() {
        let control = control.get(word).copied();
        let channel = channels.and_then(|all| all.get(word)).copied().unwrap_or_default();
        let mut planes = [const { Vec::new() }; 4];
        for (byte, plane) in planes.iter_mut().enumerate() {
            *plane = decode_plane(data, size, control.map(|code| code >> (2 * byte) & 3))?;
        }
        let places = vertices.chunks_exact_mut(stride).map(|vertex| &mut vertex[4 * word..][..4]);
        add_up(&planes, places, channel, last)?;
    }
    Ok(vertices)
}

/// The bytes of one place in a vertex, for `size` vertices. Without a code the stream is of version 0.
fn decode_plane(data: &mut Cursor, size: usize, code: Option<u8>) -> Result<Vec<u8>, String> {
    let widths = match code {
        None => [0, 2, 4, 8],
        Some(0) => [0, 1, 2, 4],
        Some(1) => [1, 2, 4, 8],
        Some(2) => return Ok(vec![0; size]),
        Some(_) => return data.take(size).map(<[u8]>::to_vec),
    };
    let groups = size.div_ceil(GROUP);
    let header = data.take(groups.div_ceil(4))?;
    let mut plane = Vec::with_capacity(groups * GROUP);
    for group in 0..groups {
        let byte = header.get(group / 4).copied().unwrap_or_default();
        let width = widths[usize::from(byte >> (group % 4 * 2) & 3)];
        plane.extend(decode_group(data, width)?);
    }
    Ok(plane)
}

/// Sixteen numbers of `bits` bits each; all ones means that the number follows as a byte of its own.
fn decode_group(data: &mut Cursor, bits: usize) -> Result<[u8; GROUP], String> {
    let packed = data.take(2 * bits)?;
    let mut group = [0; GROUP];
    if bits == 8 {
        group.copy_from_slice(packed);
        return Ok(group);
    }
    let escape = ((1_u16 << bits) - 1) as u8;
    for (i, number) in group.iter_mut().enumerate().filter(|_| bits > 0) {
        let byte = packed.get(i * bits / 8).copied().unwrap_or_default();
        // Single bits are stored from the lowest on, wider numbers from the highest.
        let shift = if bits == 1 { i % 8 } else { 8 - bits - i * bits % 8 };
        let stored = byte >> shift & escape;
        *number = if stored == escape { data.byte()? } else { stored };
    }
    Ok(group)
}

/// Turns differences into values: bytes, 16-bit words, or 32-bit words rotated and xor-ed.
fn add_up<'v>(
    planes: &[Vec<u8>; 4],
    places: impl Iterator<Item = &'v mut [u8]>,
    channel: u8,
    last: &mut [u8],
) -> Result<(), String> {
    let [p0, p1, p2, p3] = planes;
    let mut before: [u8; 4] = last.try_into().map_err(|_| "a vertex is not made of words")?;
    let differences = p0.iter().zip(p1).zip(p2).zip(p3).map(|(((a, b), c), d)| [*a, *b, *c, *d]);
    for (place, difference) in places.zip(differences) {
        before = match channel & 3 {
            0 => std::array::from_fn(|i| before[i].wrapping_add(unzigzag8(difference[i]))),
            1 => add16(before, difference),
            2 => xor32(before, difference, channel >> 4),
            other => return Err(format!("channel type {other} is unknown")),
        };
        place.copy_from_slice(&before);
    }
    last.copy_from_slice(&before);
    Ok(())
}

fn unzigzag8(code: u8) -> u8 {
    (code >> 1) ^ (code & 1).wrapping_neg()
}

fn add16([a, b, c, d]: [u8; 4], [e, f, g, h]: [u8; 4]) -> [u8; 4] {
    let add = |before: [u8; 2], code: [u8; 2]| {
        let code = u16::from_le_bytes(code);
        let difference = (code >> 1) ^ (code & 1).wrapping_neg();
        u16::from_le_bytes(before).wrapping_add(difference).to_le_bytes()
    };
    let ([a, b], [c, d]) = (add([a, b], [e, f]), add([c, d], [g, h]));
    [a, b, c, d]
}

fn xor32(before: [u8; 4], code: [u8; 4], rotation: u8) -> [u8; 4] {
    let code = u32::from_le_bytes(code).rotate_right(rotation.into());
    (u32::from_le_bytes(before) ^ code).to_le_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A version 0 stream of four-byte vertices in which only the first byte changes.
    fn version_0(first: [u8; 4], plane: &[u8]) -> Vec<u8> {
        let tail = [[0; 28].as_slice(), &first].concat();
        [&[0xa0], plane, &[0], &[0], &[0], &tail].concat()
    }

    #[test]
    fn bytes_are_differences_to_the_vertex_before() {
        // Two-bit numbers: 2, escape with 9 after the group, 1; the rest 0.
        let bytes = version_0([7, 1, 2, 3], &[0b01, 0b10_11_01_00, 0, 0, 0, 9]);
        let vertices = decode(&bytes, 3, 4).unwrap();
        assert_eq!(vertices, [8, 1, 2, 3, 3, 1, 2, 3, 2, 1, 2, 3]);
    }

    #[test]
    fn version_1_has_literal_and_empty_planes_and_words() {
        // Channel 1: 16-bit differences; planes literal, empty, literal, empty.
        let tail = [[0; 19].as_slice(), &[0xff, 0, 1, 0], &[1]].concat();
        let bytes = [[0xa1, 0b10_11_10_11].as_slice(), &[2, 0], &[1, 4], &tail].concat();
        assert_eq!(decode(&bytes, 2, 4).unwrap(), [0, 1, 0, 0, 0, 1, 2, 0]);
    }

    #[test]
    fn single_bits_start_at_the_lowest() {
        let mut data = Cursor(&[0b0000_0010, 0, 77]);
        let group = decode_group(&mut data, 1).unwrap();
        assert_eq!(group[..3], [0, 77, 0]);
    }

    #[test]
    fn words_are_rotated_and_xor_ed() {
        assert_eq!(xor32([1, 0, 0, 0], [0, 2, 0, 0], 8), [3, 0, 0, 0]);
    }

    #[test]
    fn lies_are_refused() {
        assert!(decode(&[0xa0; 64], usize::MAX, 4).unwrap_err().contains("too early"));
        assert!(decode(&[0xa0; 64], 3, 3).unwrap_err().contains("byteStride is 3"));
        assert!(decode(&[0xa0; 8], 3, 4).unwrap_err().contains("too early"));
        assert!(decode(&version_0([0; 4], &[0, 0]), 3, 4).unwrap_err().contains("left over"));
    }
}
