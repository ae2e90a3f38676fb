//! Filters: what decoded vertex streams stand for (appendix B of the extension).

/// Applies a filter in place.
pub(super) fn apply(name: &str, bytes: &mut [u8], stride: usize) -> Result<(), String> {
    match (name, stride) {
        ("NONE", _) => Ok(()),
        ("OCTAHEDRAL", 4) => each8(bytes, |v| octahedral(v.map(|n| f32::from(n as i8)), 127.0)),
        ("OCTAHEDRAL", 8) => each16(bytes, |v| octahedral(v.map(|n| f32::from(n as i16)), 32767.0)),
        ("QUATERNION", 8) => each16(bytes, |v| quaternion(v.map(|n| n as i16))),
        ("EXPONENTIAL", _) if stride.is_multiple_of(4) => exponential(bytes),
        ("COLOR", 4) => each8(bytes, |[y, o, g, a]| {
            color([y.into(), i32::from(o as i8), i32::from(g as i8), a.into()], 255)
        }),
        ("COLOR", 8) => each16(bytes, |[y, o, g, a]| {
            color([y.into(), i32::from(o as i16), i32::from(g as i16), a.into()], 65535)
        }),
        _ => Err(format!("filter {name:?} with byteStride {stride} is unknown")),
    }
}

fn each8(bytes: &mut [u8], map: impl Fn([u8; 4]) -> [Option<i32>; 4]) -> Result<(), String> {
    for vector in bytes.as_chunks_mut::<4>().0 {
        let mapped = map(*vector);
        for (old, new) in vector.iter_mut().zip(mapped) {
            *old = new.map_or(*old, |new| new as u8);
        }
    }
    Ok(())
}

fn each16(bytes: &mut [u8], map: impl Fn([u16; 4]) -> [Option<i32>; 4]) -> Result<(), String> {
    for vector in bytes.as_chunks_mut::<8>().0 {
        let [a, b, c, d, e, f, g, h] = *vector;
        let mapped = map([[a, b], [c, d], [e, f], [g, h]].map(u16::from_le_bytes));
        for (old, new) in vector.as_chunks_mut::<2>().0.iter_mut().zip(mapped) {
            *old = new.map_or(*old, |new| (new as u16).to_le_bytes());
        }
    }
    Ok(())
}

/// A unit vector from its place on an octahedron; `z` holds the number that stands for 1, the fourth is kept.
fn octahedral([x, y, one, _]: [f32; 4], max: f32) -> [Option<i32>; 4] {
    let z = one - x.abs() - y.abs();
    let fold = z.min(0.0);
    let [x, y] = [x, y].map(|n| if n >= 0.0 { n + fold } else { n - fold });
    let scale = max / (x * x + y * y + z * z).sqrt();
    [Some(round(x * scale)), Some(round(y * scale)), Some(round(z * scale)), None]
}

/// A unit quaternion from its three smaller components; the fourth number holds the scale and, in its lowest
/// two bits, which one is missing.
fn quaternion([x, y, z, info]: [i16; 4]) -> [Option<i32>; 4] {
    let scale = std::f32::consts::FRAC_1_SQRT_2 / f32::from(info | 3);
    let [x, y, z] = [x, y, z].map(|n| f32::from(n) * scale);
    let w = (1.0 - x * x - y * y - z * z).max(0.0).sqrt();
    let mut rotated = [w, x, y, z].map(|n| Some(round(n * 32767.0)));
    rotated.rotate_right((info & 3) as usize);
    rotated
}

/// Floats from 24-bit mantissas and 8-bit exponents.
fn exponential(bytes: &mut [u8]) -> Result<(), String> {
    for word in bytes.as_chunks_mut::<4>().0 {
        let stored = i32::from_le_bytes(*word);
        let (mantissa, exponent) = ((stored << 8) >> 8, stored >> 24);
        *word = ((f64::from(mantissa) * f64::from(exponent).exp2()) as f32).to_le_bytes();
    }
    Ok(())
}

/// RGBA from luma, two chroma numbers and an alpha whose highest bit tells the scale.
fn color([y, o, g, a]: [i32; 4], max: i32) -> [Option<i32>; 4] {
    let full = if a == 0 { 0 } else { (2 << a.ilog2()) - 1 };
    let alpha = ((a << 1) & full) | (a & 1);
    [y + o - g, y + g, y - o - g, alpha].map(|n| Some(round(n as f32 * max as f32 / full as f32)))
}

fn round(number: f32) -> i32 {
    number.round() as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn filtered(name: &str, mut bytes: Vec<u8>, stride: usize) -> Vec<u8> {
        apply(name, &mut bytes, stride).unwrap();
        bytes
    }

    #[test]
    fn octahedral_vectors_become_unit_vectors() {
        assert_eq!(filtered("OCTAHEDRAL", vec![0, 0, 127, 5], 4), [0, 0, 127, 5]);
        // The corner of the octahedron's square is the pole below.
        assert_eq!(filtered("OCTAHEDRAL", vec![127, 127, 127, 0], 4), [0, 0, 129, 0]);
    }

    #[test]
    fn quaternions_get_their_largest_component_back() {
        // Three zeros, scale 1, the missing one has place 1.
        let bytes = [0_i16, 0, 0, 0x7ffc | 1].map(i16::to_le_bytes).concat();
        let wanted = [0_i16, 32767, 0, 0].map(i16::to_le_bytes).concat();
        assert_eq!(filtered("QUATERNION", bytes, 8), wanted);
    }

    #[test]
    fn exponentials_become_floats() {
        let word = (-3_i32 & 0xff_ffff) | (-1 << 24);
        let bytes = filtered("EXPONENTIAL", word.to_le_bytes().to_vec(), 4);
        assert_eq!(bytes, (-1.5_f32).to_le_bytes());
    }

    #[test]
    fn colours_come_back() {
        // White, opaque: luma 255, no chroma, alpha 127 of seven bits with the marker above.
        assert_eq!(filtered("COLOR", vec![255, 0, 0, 0xff], 4), [255, 255, 255, 255]);
        assert_eq!(filtered("COLOR", vec![127, 127, 0, 0xff], 4), [254, 127, 0, 255]);
    }

    #[test]
    fn unknown_filters_are_refused() {
        assert!(apply("QUATERNION", &mut [0; 4], 4).unwrap_err().contains("QUATERNION"));
    }
}
