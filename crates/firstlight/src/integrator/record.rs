//! What can be told about a picture while it is made: where its light set out, and what stood in the way.
//!
//! A render runs with the recorder `()`, which is told nothing and costs nothing; an explanation runs the same stages
//! with a [`Record`].

use super::source::Source;
use crate::color::{Rgb, luminance};
use crate::film::Sample;
use crate::geometry::{Hit, Ray};
use crate::scene::Scene;
use glam::Vec3;

/// Light that a sample gained.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Gain {
    /// Place of the sample in its batch.
    pub sample: u32,
    /// Where it set out.
    pub source: Source,
    /// Number on its path of the point that it came to, from 0; where it was met, of what was met.
    pub bounce: u32,
    /// How often it was scattered between where it set out and the eye.
    pub reflections: u32,
    /// Whether a light was asked for it; otherwise a ray met it.
    pub asked: bool,
    /// Radiance at the eye, W·sr⁻¹·m⁻².
    pub radiance: Rgb,
}

/// A light asked at a point.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Asked {
    /// What it would give to which sample, were nothing in the way.
    pub gain: Gain,
    /// How far along the ray that leads to the point, m, if it is asked on the way there.
    pub after: Option<f32>,
    /// The ray that must not be stopped; `None` if nothing can.
    pub ray: Option<Ray>,
    /// Unit vector to the light.
    pub incoming: Vec3,
    /// BSDF × |cosine|, sr⁻¹.
    pub scattered: Rgb,
    /// Irradiance of a surface that faces the light, W·m⁻². Of a light with an extent, or one picked for many, what one
    /// sample stands for.
    pub irradiance: Rgb,
    /// How it came to be asked.
    pub draw: Draw,
    /// What of it passes: nothing behind a surface, a tint behind panes.
    pub passed: Rgb,
}

/// How a light came to be asked, and what of its irradiance is due to that.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Draw {
    /// The solid angle that the direction to it stands for, sr; 0 if it has no extent.
    pub solid_angle: f32,
    /// The chance with which it was picked, to stand for all.
    pub chance: f32,
    /// The part of its light that is asked for; rays that meet it by chance bring the rest.
    pub weight: f32,
}

impl Draw {
    /// Of a light without extent that had this chance of being asked.
    #[inline(always)]
    pub(crate) fn of_point(chance: f32) -> Self {
        Self { solid_angle: 0.0, chance, weight: 1.0 }
    }
}

/// A ray followed to what it meets.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Followed {
    /// Place of the sample in its batch.
    pub sample: u32,
    /// Number of what it meets on its path, from 0.
    pub bounce: u32,
    /// The ray.
    pub ray: Ray,
    /// What it meets; see [`Hit::is_some`].
    pub hit: Hit,
    /// What light from its end is multiplied by on its way to the eye.
    pub throughput: Rgb,
    /// Width of what it stands for at its end, m.
    pub width: f32,
}

/// Is told what happens to the samples of a batch.
pub(crate) trait Recorder {
    /// A sample gained light.
    fn gain(&mut self, gain: &Gain);

    /// A light was asked, and its shadow ray will be traced. Returns the number to answer to.
    fn ask(&mut self, asked: &Asked) -> u32;

    /// What passed of the light with this number.
    fn answer(&mut self, number: u32, passed: Rgb);

    /// A ray was followed.
    fn follow(&mut self, followed: &Followed);
}

/// Nobody listens.
impl Recorder for () {
    #[inline(always)]
    fn gain(&mut self, _: &Gain) {}

    #[inline(always)]
    fn ask(&mut self, _: &Asked) -> u32 {
        0
    }

    #[inline(always)]
    fn answer(&mut self, _: u32, _: Rgb) {}

    #[inline(always)]
    fn follow(&mut self, _: &Followed) {}
}

/// All that happened to the samples of a batch, in the order in which it did.
#[derive(Debug, Clone, Default)]
pub(crate) struct Record {
    /// What the samples are sums of.
    pub gains: Vec<Gain>,
    /// Every light that was asked.
    pub asked: Vec<Asked>,
    /// Every ray from the eye, and from surface to surface.
    pub followed: Vec<Followed>,
}

impl Record {
    /// Forgets everything.
    pub(crate) fn clear(&mut self) {
        self.gains.clear();
        self.asked.clear();
        self.followed.clear();
    }
}

impl Recorder for Record {
    fn gain(&mut self, gain: &Gain) {
        if gain.radiance != Rgb::ZERO {
            self.gains.push(*gain);
        }
    }

    fn ask(&mut self, asked: &Asked) -> u32 {
        self.asked.push(*asked);
        self.asked.len() as u32 - 1
    }

    fn answer(&mut self, number: u32, passed: Rgb) {
        self.asked[number as usize].passed = passed;
    }

    fn follow(&mut self, followed: &Followed) {
        self.followed.push(*followed);
    }
}

/// Adds light to its sample, and says so. Light that was scattered more than once is clamped if the scene's film wants that.
#[inline(always)]
pub(super) fn add(
    scene: &Scene,
    samples: &mut [Sample],
    recorder: &mut impl Recorder,
    mut gain: Gain,
) {
    let sample = &mut samples[gain.sample as usize];
    if let Some(most) = scene.film().clamp.filter(|_| gain.reflections > 1) {
        let whole = gain.radiance;
        gain.radiance *= (most as f32 / whole.max_element()).min(1.0);
        sample.clamped += luminance(whole - gain.radiance);
    }
    sample.radiance += gain.radiance;
    recorder.gain(&gain);
}
