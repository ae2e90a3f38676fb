//! What light comes from where, for each kind of sky.

use super::cie::CieSky;
use super::preetham::{self, PreethamSky};
use super::table::{Aim, DirectionTable};
use crate::color::{Rgb, luminance};
use crate::scene::description::{Pixels, Sampling, Sky, Wrap};
use crate::shading::texture::{Role, look_up, texel};
use glam::{DVec3, Vec2, Vec3, Vec4Swizzles};
use std::f32::consts::FRAC_1_PI;
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
    pub(super) fn from(&self, from: Vec3) -> Rgb {
        match self {
            Self::Uniform => Rgb::ONE,
            Self::Gradient { zenith, horizon, nadir } => {
                horizon.lerp(if from.z > 0.0 { *zenith } else { *nadir }, from.z.abs())
            }
            Self::Picture { pixels, sampling } => {
                let wrap = [Wrap::Repeat, Wrap::Clamp];
                look_up(pixels, on_picture(from), wrap, *sampling, Role::Color).xyz()
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

/// Texture coordinates of a direction in the sky's own space, v up.
fn on_picture(from: Vec3) -> Vec2 {
    let across = from.truncate().length();
    Vec2::new(0.5 + 0.5 * FRAC_1_PI * from.x.atan2(from.y), 0.5 + FRAC_1_PI * from.z.atan2(across))
}
