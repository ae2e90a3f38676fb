//! What light comes from where, for each kind of sky.

use super::cie::CieSky;
use super::preetham::{self, PreethamSky};
use super::table::{Aim, DirectionTable, place};
use crate::color::{Rgb, luminance};
use crate::scene::description::{Pixels, Sampling, Sky};
use crate::shading::texture::{Role, texel};
use glam::{DVec2, DVec3, Vec2, Vec3, Vec4Swizzles};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// A [`Sky`], ready to be asked.
#[derive(Debug, Clone)]
pub(super) enum Radiance {
    /// 1 from everywhere.
    Uniform,
    /// Straight from one colour to the next with the sine of the elevation.
    Gradient { zenith: Rgb, horizon: Rgb, nadir: Rgb },
    /// A lat-long picture.
    Picture { pixels: Arc<Pixels>, sampling: Sampling },
    /// A sky of the CIE, over a ground of one radiance.
    Cie { sky: CieSky, ground: Rgb },
    /// A clear sky, over a ground of one radiance.
    Clear { sky: PreethamSky, ground: Rgb },
}

impl Radiance {
    pub(super) fn new(sky: &Sky) -> Self {
        match sky {
            Sky::Uniform => Self::Uniform,
            &Sky::Gradient { zenith, horizon, nadir } => Self::Gradient { zenith, horizon, nadir },
            Sky::Picture { pixels, sampling } => {
                Self::Picture { pixels: Arc::clone(pixels), sampling: *sampling }
            }
            &Sky::Cie { number, sun, ground } => {
                Self::Cie { sky: CieSky::new(number, sun), ground }
            }
            &Sky::Clear { turbidity, sun, ground } => {
                Self::Clear { sky: PreethamSky::new(turbidity, sun), ground }
            }
        }
    }

    /// What comes from the unit direction `from` in the sky's own space.
    fn from(&self, from: Vec3) -> Rgb {
        self.at(from, &self.spot(place(from.as_dvec3())))
    }

    /// Where to look in the picture, if it is one, for a direction with this [`place`].
    #[inline(always)]
    pub(super) fn spot(&self, place: DVec2) -> Spot {
        match self {
            Self::Picture { pixels, sampling } => Spot::new(pixels, *sampling, place),
            _ => Spot::default(),
        }
    }

    /// What comes from the unit direction `from`, which has this spot.
    #[inline(always)]
    pub(super) fn at(&self, from: Vec3, spot: &Spot) -> Rgb {
        match self {
            Self::Picture { pixels, .. } => spot.look_up(pixels),
            _ => self.by_formula(from),
        }
    }

    /// The same in the other skies.
    fn by_formula(&self, from: Vec3) -> Rgb {
        match self {
            Self::Uniform | Self::Picture { .. } => Rgb::ONE,
            Self::Gradient { zenith, horizon, nadir } => {
                horizon.lerp(if from.z > 0.0 { *zenith } else { *nadir }, from.z.abs())
            }
            Self::Cie { ground, .. } | Self::Clear { ground, .. } if from.z <= 0.0 => *ground,
            Self::Cie { sky, .. } => Rgb::splat(sky.relative(from.as_dvec3()) as f32),
            Self::Clear { sky, .. } => sky.luminance(from.as_dvec3()).as_vec3(),
        }
    }

    /// Where to look for light.
    pub(super) fn table(&self, aim: Aim) -> Option<DirectionTable> {
        let brightness = |from: DVec3| f64::from(luminance(self.from(from.as_vec3())));
        match self {
            Self::Uniform => DirectionTable::new(1, 1, aim, |_, _| 1.0),
            Self::Gradient { .. } => DirectionTable::of(1, 64, aim, brightness),
            Self::Picture { pixels, sampling } => of_picture(pixels, *sampling, aim),
            Self::Cie { .. } | Self::Clear { .. } => DirectionTable::of(128, 64, aim, brightness),
        }
    }
}

impl Sky {
    /// Irradiance of the ground under it, before the environment's factor.
    pub(crate) fn horizontal_irradiance(&self) -> DVec3 {
        let radiance = Radiance::new(self);
        horizontal(|from| radiance.from(from.as_vec3()).as_dvec3())
    }
}

/// Illuminance of each channel from the sun alone on what faces it, lx, through an atmosphere of this turbidity.
pub(crate) fn sunlight(turbidity: f64, sun: DVec3) -> DVec3 {
    preetham::sunlight(turbidity, sun.z)
}

/// ∫ L cos over the upper half, by midpoints of equal parts of the projected hemisphere.
fn horizontal(radiance: impl Fn(DVec3) -> DVec3) -> DVec3 {
    const PARTS: u32 = 200;
    let middle = |i: u32| (f64::from(i) + 0.5) / f64::from(PARTS);
    let part = |i: u32| {
        let (sin2, (sin_phi, cos_phi)) = (middle(i % PARTS), (TAU * middle(i / PARTS)).sin_cos());
        let sin = sin2.sqrt();
        radiance(DVec3::new(sin * cos_phi, sin * sin_phi, (1.0 - sin2).sqrt()))
    };
    PI * (0..PARTS * PARTS).map(part).sum::<DVec3>() / f64::from(PARTS * PARTS)
}

/// The table with a cell for each texel, as bright as the picture is there on average.
fn of_picture(pixels: &Pixels, sampling: Sampling, aim: Aim) -> Option<DirectionTable> {
    let (width, height) = (pixels.width as usize, pixels.height as usize);
    let brightness = |i| luminance(texel(pixels, i, Role::Color).xyz()).max(0.0);
    let brightness: Vec<f32> = (0..width * height).map(brightness).collect();
    // The mean of straight lines between the centres of three cells, over the cell in the middle.
    let [side, middle] = if sampling == Sampling::Bilinear { [0.125, 0.75] } else { [0.0, 1.0] };
    let mix = |before: f32, here: f32, after: f32| middle * here + side * (before + after);
    DirectionTable::new(width, height, aim, |x, y| {
        let (left, right) = ((x + width - 1) % width, (x + 1) % width);
        let row = |y: usize| {
            let row = &brightness[y * width..][..width];
            mix(row[left], row[x], row[right])
        };
        f64::from(mix(row(y.saturating_sub(1)), row(y), row((y + 1).min(height - 1))))
    })
}

/// Four texels of a lat-long picture, and how far it is from the first ones to the others.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Spot {
    /// Top left, top right, bottom left, bottom right.
    texels: [usize; 4],
    part: Vec2,
}

impl Spot {
    /// The texels around a [`place`]; four times the same one if it is the nearest that counts. The picture goes on from its
    /// right border at its left.
    #[inline(always)]
    fn new(pixels: &Pixels, sampling: Sampling, place: DVec2) -> Self {
        let [width, height] = [pixels.width as i32, pixels.height as i32];
        let on_picture = place * DVec2::new(f64::from(width), f64::from(height));
        if sampling == Sampling::Nearest {
            let (x, y) = (on_picture.x as i32, on_picture.y as i32);
            let nearest = y.min(height - 1) as usize * width as usize + x.min(width - 1) as usize;
            return Self { texels: [nearest; 4], part: Vec2::ZERO };
        }
        // Texels' centres are whole numbers from 1 on.
        let from_centers = on_picture + 0.5;
        let (x, y) = (from_centers.x as i32, from_centers.y as i32);
        let part = (from_centers - DVec2::new(f64::from(x), f64::from(y))).as_vec2();
        let left = if x == 0 { width - 1 } else { x - 1 } as usize;
        let right = if x < width { x } else { 0 } as usize;
        let top = (y - 1).max(0) as usize * width as usize;
        let bottom = y.min(height - 1) as usize * width as usize;
        Self { texels: [top + left, top + right, bottom + left, bottom + right], part }
    }

    /// RGB there.
    #[inline(always)]
    fn look_up(&self, pixels: &Pixels) -> Rgb {
        let [top_left, top_right, bottom_left, bottom_right] = self.texels;
        let top_left = texel(pixels, top_left, Role::Color);
        let top = top_left.lerp(texel(pixels, top_right, Role::Color), self.part.x);
        let bottom_left = texel(pixels, bottom_left, Role::Color);
        let bottom = bottom_left.lerp(texel(pixels, bottom_right, Role::Color), self.part.x);
        top.lerp(bottom, self.part.y).xyz()
    }
}
