//! Values over a surface: constants, pictures, squares.

use crate::scene::description::{Pattern, Pixels, Sampling, Texels, Texture, Wrap};
use glam::{Vec2, Vec4};
use std::sync::{Arc, LazyLock};

/// What the numbers of a picture are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Role {
    /// Colours, which 8-bit pictures encode by sRGB.
    Color,
    /// Plain numbers.
    Data,
}

/// RGBA of `texture` where texture coordinates are `uv` (of the set that the texture uses); colours are linear.
pub(crate) fn evaluate(
    texture: &Texture,
    images: &[Arc<Pixels>],
    uv: Vec2,
    color: [f32; 4],
    role: Role,
) -> Vec4 {
    let pattern = match &texture.pattern {
        Pattern::Constant => Vec4::ONE,
        Pattern::Checker { colors, size } => {
            let cell = (uv / *size).floor();
            let odd = (cell.x + cell.y).rem_euclid(2.0) >= 1.0;
            Vec4::from_array(colors[usize::from(odd)])
        }
        Pattern::Image { image, transform, wrap, sampling, .. } => {
            look_up(&images[*image], transform.transform_point2(uv), *wrap, *sampling, role)
        }
    };
    let vertex = if texture.vertex_colors { Vec4::from_array(color) } else { Vec4::ONE };
    Vec4::from_array(texture.factor) * pattern * vertex
}

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
    match sampling {
        Sampling::Nearest => texel(pixels, place.floor(), wrap, role),
        Sampling::Bilinear => {
            let (corner, part) = ((place - 0.5).floor(), (place - 0.5) - (place - 0.5).floor());
            let at = |x, y| texel(pixels, corner + Vec2::new(x, y), wrap, role);
            let (upper, lower) =
                (at(0.0, 0.0).lerp(at(1.0, 0.0), part.x), at(0.0, 1.0).lerp(at(1.0, 1.0), part.x));
            upper.lerp(lower, part.y)
        }
    }
}

/// The texel at whole-numbered `place`, wrapped into the picture.
pub(crate) fn texel(pixels: &Pixels, place: Vec2, wrap: [Wrap; 2], role: Role) -> Vec4 {
    let x = wrapped(place.x, pixels.width, wrap[0]);
    let y = wrapped(place.y, pixels.height, wrap[1]);
    let index = y * pixels.width as usize + x;
    match &pixels.texels {
        Texels::Srgb8(texels) if role == Role::Data => {
            Vec4::from_array(texels[index].map(f32::from)) / 255.0
        }
        Texels::Srgb8(texels) => {
            let [r, g, b, a] = texels[index].map(usize::from);
            Vec4::new(DECODED[r], DECODED[g], DECODED[b], a as f32 / 255.0)
        }
        Texels::Linear(texels) => Vec4::from_array(texels[index]),
    }
}

fn wrapped(place: f32, size: u32, wrap: Wrap) -> usize {
    let (place, size) = (place as i64, i64::from(size));
    let index = match wrap {
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
        let row = |wrap| (-5..9).map(|i| wrapped(i as f32, 4, wrap)).collect::<Vec<_>>();
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

    #[test]
    fn checkers_alternate_across_the_origin() {
        let pattern = Pattern::Checker { colors: [[1.0; 4], [0.0; 4]], size: Vec2::splat(0.5) };
        let texture = Texture { factor: [1.0; 4], pattern, vertex_colors: false };
        let at = |u, v| evaluate(&texture, &[], Vec2::new(u, v), [1.0; 4], Role::Color).x;
        assert_eq!(
            [at(0.1, 0.1), at(0.6, 0.1), at(-0.1, 0.1), at(-0.1, -0.1)],
            [1.0, 0.0, 0.0, 1.0]
        );
    }
}
