//! Light from directions that hit nothing: what comes from where, and where it pays to look.

mod sun;
mod table;
#[cfg(test)]
mod tests;

pub(crate) use sun::Sun;
pub(crate) use table::Aim;

use crate::color::{Rgb, luminance};
use crate::scene::description::{Pixels, Sampling, Sky, Wrap};
use crate::shading::texture::{Role, look_up, texel};
use glam::{DVec3, Mat3, Vec2, Vec3, Vec4Swizzles};
use std::f32::consts::FRAC_1_PI;
use table::DirectionTable;

/// An infinitely large sphere of light around everything.
#[derive(Debug, Clone)]
pub(crate) struct Environment {
    sky: Sky,
    /// Multiplies what comes from the sky.
    factor: Rgb,
    /// From the world to the sky's own space: x east, y north, z up.
    to_sky: Mat3,
    /// Where to look; `None` where every direction is as good as another.
    table: Option<DirectionTable>,
}

/// A direction of the environment that chance picked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct EnvironmentSample {
    /// Unit vector to where the light comes from.
    pub incoming: Vec3,
    /// What comes from there, W·sr⁻¹·m⁻².
    pub radiance: Rgb,
    /// Density of `incoming`, sr⁻¹.
    pub pdf: f32,
}

impl Environment {
    /// `to_sky` turns the world into the sky's own space; `factor` multiplies its radiance.
    pub(crate) fn new(sky: Sky, factor: Rgb, to_sky: Mat3, aim: Aim) -> Self {
        let table = table_of(&sky, aim);
        Self { sky, factor, to_sky, table }
    }

    /// What comes from the unit direction `incoming`, W·sr⁻¹·m⁻².
    pub(crate) fn radiance(&self, incoming: Vec3) -> Rgb {
        self.factor * radiance(&self.sky, self.to_sky * incoming)
    }

    /// A direction picked by two numbers in 0..1, bright ones more often; `None` if no direction is to be preferred.
    pub(crate) fn sample(&self, u: Vec2) -> Option<EnvironmentSample> {
        let (own, pdf) = self.table.as_ref()?.sample(u.as_dvec2());
        let incoming = self.to_sky.transpose() * own.as_vec3();
        let radiance = self.factor * radiance(&self.sky, own.as_vec3());
        Some(EnvironmentSample { incoming, radiance, pdf: pdf as f32 })
    }

    /// Density with which [`Environment::sample`] picks the unit direction `incoming`, sr⁻¹; 0 where it never looks.
    pub(crate) fn pdf(&self, incoming: Vec3) -> f32 {
        let own = (self.to_sky * incoming).as_dvec3();
        self.table.as_ref().map_or(0.0, |table| table.pdf(own) as f32)
    }
}

/// What comes from the unit direction `from` in the sky's own space.
fn radiance(sky: &Sky, from: Vec3) -> Rgb {
    match sky {
        Sky::Uniform => Rgb::ONE,
        Sky::Gradient { zenith, horizon, nadir } => {
            horizon.lerp(if from.z > 0.0 { *zenith } else { *nadir }, from.z.abs())
        }
        Sky::Picture { pixels, sampling } => {
            let wrap = [Wrap::Repeat, Wrap::Clamp];
            look_up(pixels, on_picture(from), wrap, *sampling, Role::Color).xyz()
        }
    }
}

/// Where to look for light.
fn table_of(sky: &Sky, aim: Aim) -> Option<DirectionTable> {
    let brightness = |from: DVec3| f64::from(luminance(radiance(sky, from.as_vec3())));
    match sky {
        Sky::Uniform => DirectionTable::new(1, 1, aim, |_, _| 1.0),
        Sky::Gradient { .. } => DirectionTable::of(1, 64, aim, brightness),
        Sky::Picture { pixels, sampling } => of_picture(pixels, *sampling, aim),
    }
}

/// The table with a cell for each texel, as bright as the picture is there on average.
fn of_picture(pixels: &Pixels, sampling: Sampling, aim: Aim) -> Option<DirectionTable> {
    let (width, height) = (pixels.width as usize, pixels.height as usize);
    let place = |i: usize| Vec2::new((i % width) as f32, (i / width) as f32);
    let brightness =
        |i| luminance(texel(pixels, place(i), [Wrap::Clamp; 2], Role::Color).xyz()).max(0.0);
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
