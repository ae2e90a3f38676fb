//! Values over a surface: constants, pictures, squares, clouds.

mod picture;

pub(crate) use picture::Picture;

use crate::color::srgb_linear16;
use crate::math::hash;
use crate::scene::description::{Pattern, Pixels, Sampling, Texels, Texture, Wrap};
use glam::{Vec2, Vec4};
use std::f32::consts::{SQRT_2, TAU};
use std::sync::LazyLock;

/// What the numbers of a picture are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Role {
    /// Colours, which 8-bit pictures encode by sRGB.
    Color,
    /// Plain numbers.
    Data,
}

/// Where a texture is looked at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Spot {
    /// Texture coordinates.
    pub uv: Vec2,
    /// The two axes of what the ray's cone covers there, from end to end, in texture coordinates; zero: a point.
    pub extent: [Vec2; 2],
}

impl Spot {
    /// A point.
    pub(crate) fn at(uv: Vec2) -> Self {
        Self { uv, extent: [Vec2::ZERO; 2] }
    }

    /// The box around it.
    fn size(&self) -> Vec2 {
        self.extent[0].abs() + self.extent[1].abs()
    }
}

/// RGBA of `texture` at a spot (of the coordinates that the texture uses); colours are linear.
#[inline(always)]
pub(crate) fn evaluate(
    texture: &Texture,
    pictures: &[Picture],
    spot: Spot,
    color: [f32; 4],
    role: Role,
) -> Vec4 {
    let pattern = match texture.pattern {
        Pattern::Constant => Vec4::ONE,
        _ => patterned(texture, pictures, spot, role),
    };
    let vertex = if texture.vertex_colors { Vec4::from_array(color) } else { Vec4::ONE };
    Vec4::from_array(texture.factor) * pattern * vertex
}

/// What varies over the surface.
#[inline(never)]
fn patterned(texture: &Texture, pictures: &[Picture], spot: Spot, role: Role) -> Vec4 {
    match &texture.pattern {
        Pattern::Constant => Vec4::ONE,
        Pattern::Checker { colors, size } => mix(colors, odd_squares(spot, *size)),
        Pattern::Gradient { colors, from, to } => {
            let way = *to - *from;
            mix(colors, ((spot.uv - *from).dot(way) / way.length_squared()).clamp(0.0, 1.0))
        }
        Pattern::Noise { colors, size, octaves } => mix(colors, noise(spot, *size, *octaves)),
        Pattern::Image { image, transform, wrap, sampling, .. } => {
            let placed = Spot {
                uv: transform.transform_point2(spot.uv),
                extent: spot.extent.map(|axis| transform.transform_vector2(axis)),
            };
            pictures[*image].look_up(placed, *wrap, *sampling, role)
        }
    }
}

fn mix(colors: &[[f32; 4]; 2], part: f32) -> Vec4 {
    let [first, second] = colors.map(Vec4::from_array);
    if part == 0.0 { first } else { first.lerp(second, part) }
}

/// The part of a spot that every other square of a checker board covers.
fn odd_squares(spot: Spot, side: Vec2) -> f32 {
    let (place, size) = (spot.uv / side, spot.size() / side);
    0.5 - 0.5 * stripes(place.x, size.x) * stripes(place.y, size.y)
}

/// The mean of stripes of 1 (from 0 to 1) and −1 (from 1 to 2, and so on) over so wide a window.
fn stripes(middle: f32, width: f32) -> f32 {
    const POINT: f32 = 1e-4;
    if width < POINT {
        return if middle.floor().rem_euclid(2.0) < 1.0 { 1.0 } else { -1.0 };
    }
    // Their integral goes up and down between 0 and 1.
    let integral = |x: f32| 1.0 - (x.rem_euclid(2.0) - 1.0).abs();
    (integral(middle + 0.5 * width) - integral(middle - 0.5 * width)) / width
}

/// Clouds, 0..1: noise of cells of `size`, and finer ones of half the size and half the strength. What is finer than the
/// spot is left out.
fn noise(spot: Spot, size: Vec2, octaves: u32) -> f32 {
    let (mut sum, mut most, mut strength) = (0.0, 0.0, 1.0);
    let (mut place, mut width) = (spot.uv / size, (spot.size() / size).max_element());
    for octave in 0..octaves {
        let seen = (2.0 - 2.0 * width).clamp(0.0, 1.0);
        sum += seen * strength * waves(place, u64::from(octave));
        most += strength;
        (place, width, strength) = (2.0 * place, 2.0 * width, 0.5 * strength);
    }
    (0.5 + 0.5 * sum / most).clamp(0.0, 1.0)
}

/// Noise about 0 with cells of side 1, −1..1 (Perlin, *Improving Noise*, 2002; in the plane).
fn waves(place: Vec2, seed: u64) -> f32 {
    let (cell, part) = (place.floor(), place - place.floor());
    let fade = part * part * part * (part * (part * 6.0 - 15.0) + 10.0);
    let hashed = |hash_so_far: u64, c: f32| hash(hash_so_far ^ c as i64 as u64);
    let first = hash(seed);
    let columns = [hashed(first, cell.x), hashed(first, cell.x + 1.0)];
    let corner = |x: usize, y: f32| {
        let way = WAYS[(hashed(columns[x], cell.y + y) >> 56) as usize];
        way.dot(part - Vec2::new(x as f32, y))
    };
    let row = |y| corner(0, y) + fade.x * (corner(1, y) - corner(0, y));
    // At most √½ in the middle of a cell.
    SQRT_2 * (row(0.0) + fade.y * (row(1.0) - row(0.0)))
}

/// Which ways the noise can rise at a corner: all around.
static WAYS: LazyLock<[Vec2; 256]> =
    LazyLock::new(|| std::array::from_fn(|way| Vec2::from_angle(TAU * way as f32 / 256.0)));

/// Which set of texture coordinates a texture uses.
pub(crate) fn uv_set(texture: &Texture) -> usize {
    match texture.pattern {
        Pattern::Image { uv_set, .. } => uv_set,
        _ => 0,
    }
}

/// RGBA of a picture at texture coordinates, v up.
pub(crate) fn look_up(
    pixels: &Pixels,
    uv: Vec2,
    wrap: [Wrap; 2],
    sampling: Sampling,
    role: Role,
) -> Vec4 {
    let place = Vec2::new(uv.x, 1.0 - uv.y) * Vec2::new(pixels.width as f32, pixels.height as f32);
    let width = pixels.width as usize;
    match sampling {
        Sampling::Nearest => {
            let [column, row] = wrapped(pixels, place.floor(), wrap);
            texel(pixels, row * width + column, role)
        }
        Sampling::Bilinear => {
            let (corner, part) = ((place - 0.5).floor(), (place - 0.5) - (place - 0.5).floor());
            let [left, top] = wrapped(pixels, corner, wrap);
            let [right, bottom] = wrapped(pixels, corner + 1.0, wrap);
            let at = |row: usize, column: usize| texel(pixels, row * width + column, role);
            let row = |row| at(row, left).lerp(at(row, right), part.x);
            row(top).lerp(row(bottom), part.y)
        }
    }
}

/// The texel with this number, counted row by row.
#[inline(always)]
pub(crate) fn texel(pixels: &Pixels, index: usize, role: Role) -> Vec4 {
    match &pixels.texels {
        Texels::Srgb8(texels) if role == Role::Data => {
            Vec4::from_array(texels[index].map(f32::from)) / 255.0
        }
        Texels::Srgb8(texels) => {
            let [r, g, b, a] = texels[index].map(usize::from);
            Vec4::new(DECODED[r], DECODED[g], DECODED[b], a as f32 / 255.0)
        }
        Texels::Srgb16(texels) => deep_texel(texels[index], role),
        Texels::Linear(texels) => Vec4::from_array(texels[index]),
    }
}

#[inline(never)]
fn deep_texel(codes: [u16; 4], role: Role) -> Vec4 {
    let plain = Vec4::from_array(codes.map(f32::from)) / f32::from(u16::MAX);
    let [r, g, b, _] = codes;
    match role {
        Role::Data => plain,
        Role::Color => Vec4::new(srgb_linear16(r), srgb_linear16(g), srgb_linear16(b), plain.w),
    }
}

/// Column and row of a whole-numbered place, wrapped into the picture.
#[inline(always)]
fn wrapped(pixels: &Pixels, place: Vec2, wrap: [Wrap; 2]) -> [usize; 2] {
    [wrapped_one(place.x, pixels.width, wrap[0]), wrapped_one(place.y, pixels.height, wrap[1])]
}

#[inline(always)]
fn wrapped_one(place: f32, size: u32, wrap: Wrap) -> usize {
    let (place, size) = (place as i64, i64::from(size));
    let index = match wrap {
        // Most are; the division is saved.
        _ if (0..size).contains(&place) => place,
        Wrap::Repeat => place.rem_euclid(size),
        Wrap::Clamp => place.clamp(0, size - 1),
        Wrap::Mirror => {
            let twice = place.rem_euclid(2 * size);
            twice.min(2 * size - 1 - twice)
        }
    };
    index as usize
}

/// Linear values of the 256 sRGB codes.
static DECODED: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|code| crate::color::srgb_decode(code as f32 / 255.0)));

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrap_modes_continue_a_picture_of_four() {
        let row = |wrap| (-5..9).map(|i| wrapped_one(i as f32, 4, wrap)).collect::<Vec<_>>();
        assert_eq!(row(Wrap::Repeat), [3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0]);
        assert_eq!(row(Wrap::Clamp), [0, 0, 0, 0, 0, 0, 1, 2, 3, 3, 3, 3, 3, 3]);
        assert_eq!(row(Wrap::Mirror), [3, 3, 2, 1, 0, 0, 1, 2, 3, 3, 2, 1, 0, 0]);
    }

    #[test]
    fn pictures_stand_upright_and_are_joined_in_linear_light() {
        let texels = Texels::Srgb8(vec![[255, 0, 0, 255], [0; 4], [0; 4], [0, 255, 0, 255]]);
        let pixels = Pixels { name: String::new(), width: 2, height: 2, texels };
        let at = |u, v, sampling| {
            look_up(&pixels, Vec2::new(u, v), [Wrap::Clamp; 2], sampling, Role::Color)
        };
        assert_eq!(at(0.1, 0.9, Sampling::Nearest), Vec4::new(1.0, 0.0, 0.0, 1.0));
        assert_eq!(at(0.9, 0.1, Sampling::Nearest), Vec4::new(0.0, 1.0, 0.0, 1.0));
        assert_eq!(at(0.5, 0.5, Sampling::Bilinear), Vec4::new(0.25, 0.25, 0.0, 0.5));
    }

    /// Numbers are as they are written, whatever depth they have; colours are decoded.
    #[test]
    fn codes_are_decoded_for_colours_alone() {
        let pixels = |texels| Pixels { name: String::new(), width: 1, height: 1, texels };
        let shallow = pixels(Texels::Srgb8(vec![[51, 102, 255, 204]]));
        let deep = pixels(Texels::Srgb16(vec![[13_107, 26_214, 65_535, 52_428]]));
        let plain = Vec4::new(0.2, 0.4, 1.0, 0.8);
        let decoded = Vec4::new(0.033_104_77, 0.132_868_32, 1.0, 0.8);
        for pixels in [shallow, deep] {
            assert!(texel(&pixels, 0, Role::Data).abs_diff_eq(plain, 1e-6), "{:?}", pixels.texels);
            assert!(texel(&pixels, 0, Role::Color).abs_diff_eq(decoded, 1e-6));
        }
    }

    #[test]
    fn checkers_alternate_across_the_origin() {
        let pattern = Pattern::Checker { colors: [[1.0; 4], [0.0; 4]], size: Vec2::splat(0.5) };
        let texture = Texture { factor: [1.0; 4], pattern, vertex_colors: false };
        let at = |u, v| evaluate(&texture, &[], Spot::at(Vec2::new(u, v)), [1.0; 4], Role::Color).x;
        assert_eq!(
            [at(0.1, 0.1), at(0.6, 0.1), at(-0.1, 0.1), at(-0.1, -0.1)],
            [1.0, 0.0, 0.0, 1.0]
        );
    }

    /// The part of a spot that is covered, against its mean by points.
    #[test]
    fn squares_are_averaged_over_a_spot() {
        let side = Vec2::new(0.5, 0.25);
        for (uv, x, y) in [(0.1, 0.3, 0.2), (-0.4, 2.7, 0.0), (7.3, 0.02, 5.0)] {
            let uv = Vec2::new(uv, 0.6 * uv);
            let spot = Spot { uv, extent: [Vec2::new(x, 0.0), Vec2::new(0.0, y)] };
            let offsets = (0..400).map(|i| (i as f32 + 0.5) / 400.0 - 0.5);
            let points = offsets.clone().flat_map(|a| offsets.clone().map(move |b| (a, b)));
            let odd = |(a, b)| odd_squares(Spot::at(uv + Vec2::new(a * x, b * y)), side);
            let mean = points.map(odd).sum::<f32>() / 160_000.0;
            assert!((odd_squares(spot, side) - mean).abs() < 0.01, "{spot:?}: {mean}");
        }
    }

    #[test]
    fn clouds_are_around_the_middle_and_fade_with_distance() {
        let at = |i: u32, width: f32| {
            let uv = 0.37 * Vec2::new((i % 97) as f32, (i / 97) as f32);
            noise(Spot { uv, extent: [Vec2::X * width, Vec2::Y * width] }, Vec2::ONE, 5)
        };
        let values: Vec<f32> = (0..9409).map(|i| at(i, 0.0)).collect();
        let mean = values.iter().sum::<f32>() / 9409.0;
        assert!((mean - 0.5).abs() < 0.02 && values.iter().any(|&v| v > 0.7), "{mean}");
        assert!(values.iter().all(|v| (0.0..=1.0).contains(v)));
        assert!((0..100).all(|i| at(i, 3.0) == 0.5));
        // It is continuous over the borders of cells.
        let [left, right] = [1.0_f32.next_down(), 1.0].map(|x| waves(Vec2::new(x, 0.3), 1));
        assert!((left - right).abs() < 1e-5);
    }
}
