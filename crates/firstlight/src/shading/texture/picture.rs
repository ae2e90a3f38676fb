//! Pictures on surfaces, and smaller ones of them for surfaces that are far away.
//!
//! Williams, *Pyramidal Parametrics*, 1983; along the longer axis of what a ray's cone covers, several places are looked
//! at, as McCormack et al., *Feline: Fast Elliptical Lines for Anisotropic Texture Mapping*, 1999, do.

use super::{Role, Spot, look_up, texel};
use crate::color::srgb_code8;
use crate::scene::description::{Pixels, Sampling, Texels, Wrap};
use glam::{Vec2, Vec4};
use std::sync::{Arc, OnceLock};

/// Places that are looked at in a spot, at most.
const MOST_PLACES: f32 = 8.0;

/// A picture, and each half as large as the one before it: as colours and as numbers, made when first asked for.
#[derive(Debug, Clone)]
pub(crate) struct Picture {
    pixels: Arc<Pixels>,
    smaller: [OnceLock<Vec<Pixels>>; 2],
}

impl Picture {
    pub(crate) fn new(pixels: Arc<Pixels>) -> Self {
        Self { pixels, smaller: Default::default() }
    }

    /// Texels along its longer side.
    pub(crate) fn texels_across(&self) -> u32 {
        self.pixels.width.max(self.pixels.height)
    }

    /// RGBA of the picture over a spot.
    #[inline(always)]
    pub(crate) fn look_up(
        &self,
        spot: Spot,
        wrap: [Wrap; 2],
        sampling: Sampling,
        role: Role,
    ) -> Vec4 {
        let size = Vec2::new(self.pixels.width as f32, self.pixels.height as f32);
        let [a, b] = spot.extent.map(|axis| (axis * size).length());
        if a.max(b).partial_cmp(&1.0).is_none_or(|order| order.is_le()) {
            return look_up(&self.pixels, spot.uv, wrap, sampling, role);
        }
        let longer = spot.extent[usize::from(b > a)];
        self.average(spot.uv, (longer, a.max(b), a.min(b)), (wrap, sampling), role)
    }

    /// The mean along an axis of so many texels, across which there are `across`.
    #[inline(never)]
    fn average(
        &self,
        uv: Vec2,
        (axis, along, across): (Vec2, f32, f32),
        (wrap, sampling): ([Wrap; 2], Sampling),
        role: Role,
    ) -> Vec4 {
        let places = (along / across.max(1.0)).ceil().min(MOST_PLACES);
        let level = (along / places).log2().max(0.0);
        let at = |level: usize, uv| look_up(self.level(level, role), uv, wrap, sampling, role);
        let mean = |i: u32| {
            let place = uv + ((i as f32 + 0.5) / places - 0.5) * axis;
            let fine = at(level as usize, place);
            if level.fract() == 0.0 {
                fine
            } else {
                fine.lerp(at(level as usize + 1, place), level.fract())
            }
        };
        (0..places as u32).map(mean).sum::<Vec4>() / places
    }

    /// The picture after so many halvings; the smallest that there is, if they are too many.
    fn level(&self, level: usize, role: Role) -> &Pixels {
        let smaller = self.smaller[usize::from(role == Role::Data)].get_or_init(|| {
            let next = |pixels: &Pixels| {
                (pixels.width.max(pixels.height) > 1).then(|| halved(pixels, role))
            };
            std::iter::successors(next(&self.pixels), next).collect()
        });
        match level.min(smaller.len()) {
            0 => &self.pixels,
            level => &smaller[level - 1],
        }
    }
}

/// A picture of half the width and height, rounded down: each texel is the mean of what it covers.
fn halved(pixels: &Pixels, role: Role) -> Pixels {
    let (width, height) = ((pixels.width / 2).max(1), (pixels.height / 2).max(1));
    let columns: Vec<_> = (0..width).map(|x| covered(x, pixels.width, width)).collect();
    let mut means = Vec::with_capacity(width as usize * height as usize);
    for y in 0..height {
        let (top, rows) = covered(y, pixels.height, height);
        for (left, columns) in &columns {
            let mut sum = Vec4::ZERO;
            for (dy, row) in (0_u32..).zip(rows).filter(|(_, part)| *part > 0.0) {
                for (dx, &column) in (0_u32..).zip(columns).filter(|(_, part)| **part > 0.0) {
                    let [x, y] =
                        [(left + dx).min(pixels.width - 1), (top + dy).min(pixels.height - 1)];
                    let index = y as usize * pixels.width as usize + x as usize;
                    sum += row * column * texel(pixels, index, role);
                }
            }
            means.push(sum);
        }
    }
    let texels = match pixels.texels {
        Texels::Srgb8(_) => {
            Texels::Srgb8(means.into_iter().map(|mean| codes(mean, role)).collect())
        }
        Texels::Srgb16(_) | Texels::Linear(_) => {
            Texels::Linear(means.into_iter().map(|mean| mean.to_array()).collect())
        }
    };
    Pixels { name: pixels.name.clone(), width, height, texels }
}

/// The first of up to three texels of `from` that one of `to` covers, and their parts of it.
fn covered(index: u32, from: u32, to: u32) -> (u32, [f32; 3]) {
    let scale = f64::from(from) / f64::from(to);
    let (start, end) = (f64::from(index) * scale, f64::from(index + 1) * scale);
    let first = start as u32;
    let part = |i: u32| {
        let (low, high) = (f64::from(first + i), f64::from(first + i + 1));
        ((high.min(end) - low.max(start)).max(0.0) / scale) as f32
    };
    (first, [part(0), part(1), part(2)])
}

fn codes(mean: Vec4, role: Role) -> [u8; 4] {
    let plain = |value: f32| (255.0 * value).round() as u8;
    let [r, g, b, a] = mean.to_array();
    let color = if role == Role::Color { [r, g, b].map(srgb_code8) } else { [r, g, b].map(plain) };
    [color[0], color[1], color[2], plain(a)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Black and white columns, in an odd number.
    fn columns(width: u32, height: u32) -> Picture {
        let white = |i: u32| [255 * ((i % width % 2) as u8); 4];
        let texels = Texels::Srgb8((0..width * height).map(white).collect());
        Picture::new(Arc::new(Pixels { name: String::new(), width, height, texels }))
    }

    fn seen(picture: &Picture, extent: [Vec2; 2], role: Role) -> f32 {
        let spot = Spot { uv: Vec2::new(0.41, 0.3), extent };
        picture.look_up(spot, [Wrap::Repeat; 2], Sampling::Bilinear, role).x
    }

    /// Far away, a picture is its mean: in linear light if it is of colours, of the plain numbers if it is not.
    #[test]
    fn far_pictures_are_their_mean() {
        let far = [Vec2::X, Vec2::Y];
        for (width, height, mean) in [(64, 16, 0.5), (63, 5, 31.0 / 63.0), (1, 1, 0.0)] {
            let picture = columns(width, height);
            for role in [Role::Color, Role::Data] {
                let value = seen(&picture, far, role);
                assert!((value - mean).abs() < 0.01, "{width} × {height}, {role:?}: {value}");
            }
        }
    }

    /// Seen along the columns they stay sharp; across them they fade.
    #[test]
    fn long_spots_blur_along_their_length() {
        let picture = columns(64, 64);
        let point = seen(&picture, [Vec2::ZERO; 2], Role::Data);
        let along = seen(&picture, [Vec2::Y * 0.1, Vec2::X * 1e-3], Role::Data);
        let across = seen(&picture, [Vec2::Y * 1e-3, Vec2::X * 0.5], Role::Data);
        assert!((along - point).abs() < 1e-3, "{along} is not {point}");
        assert!((across - 0.5).abs() < 0.02, "{across}");
    }
}
