//! Light by where it came from, summed with the picture's own samples.

use super::crypto::{Coverage, CryptoNames};
use super::{Channel, Layer};
use crate::color::{Rgb, luminance};
use crate::film::{Half, Sample, Tile};
use crate::integrator::{Gain, Record, Source};
use crate::scene::Scene;
use crate::scene::description::{Integrator, SceneDescription};
use glam::DVec3;
use std::collections::BTreeMap;

/// A sample that was taken: which pixel of the tile it belongs to, and its weight under the filter.
pub(crate) struct Taken {
    pub pixel: usize,
    pub weight: f32,
    pub sample: Sample,
}

/// Which part of a picture light belongs to, besides its source.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Part {
    Emission,
    Direct,
    Indirect,
    Ambient,
}

impl Part {
    const ALL: [(Self, Layer, &'static str); 4] = [
        (Self::Emission, Layer::Emission, "emission"),
        (Self::Direct, Layer::Direct, "direct"),
        (Self::Indirect, Layer::Indirect, "indirect"),
        (Self::Ambient, Layer::Ambient, "ambient"),
    ];

    fn of(gain: &Gain) -> Self {
        match (gain.source, gain.reflections) {
            (Source::Ambient, _) => Self::Ambient,
            (_, 0) => Self::Emission,
            (_, 1) => Self::Direct,
            _ => Self::Indirect,
        }
    }
}

/// The sums of one pixel, weighted by the filter.
#[derive(Debug, Clone, Default)]
struct Sums {
    parts: [DVec3; 4],
    sources: Vec<DVec3>,
    /// Luminance of direct light that was asked for, and of what of it arrived.
    asked: f64,
    arrived: f64,
    squares: DVec3,
    radiance: DVec3,
    /// Of the mean, once halves are joined.
    joined_variance: Option<DVec3>,
    weight: f64,
    rays: u32,
    count: u32,
    surfaces: Coverage,
}

/// What one worker sums up.
#[derive(Debug)]
pub(crate) struct LightTile {
    /// The place of each source among a pixel's.
    places: BTreeMap<Source, usize>,
    empty: Vec<Sums>,
    /// Of the halves of a picture that are kept apart; else the second has none.
    halves: [Vec<Sums>; 2],
}

impl LightTile {
    pub(crate) fn new(scene: &Scene, pixels: usize) -> Self {
        let places: BTreeMap<_, _> = sources(scene).into_iter().zip(0..).collect();
        let empty = Sums { sources: vec![DVec3::ZERO; places.len()], ..Sums::default() };
        let empty = vec![empty; pixels];
        Self { places, halves: [empty.clone(), Vec::new()], empty }
    }

    /// Adds a batch of samples of one half.
    pub(crate) fn add(&mut self, samples: &[Taken], half: Half, record: &Record) {
        let pixels = &mut self.halves[usize::from(half == Half::Second)];
        if pixels.is_empty() {
            pixels.clone_from(&self.empty);
        }
        for taken in samples {
            let sums = &mut pixels[taken.pixel];
            let (weight, radiance) = (f64::from(taken.weight), taken.sample.radiance.as_dvec3());
            sums.count += 1;
            if weight != 0.0 {
                sums.weight += weight;
                sums.radiance += weight * radiance;
                sums.squares += radiance * radiance;
            }
        }
        for gain in &record.gains {
            let taken = &samples[gain.sample as usize];
            // Dropped samples have no weight, and may have no finite light either.
            if taken.weight == 0.0 {
                continue;
            }
            let radiance = f64::from(taken.weight) * gain.radiance.as_dvec3();
            let sums = &mut pixels[taken.pixel];
            sums.parts[Part::of(gain) as usize] += radiance;
            sums.sources[self.places[&gain.source]] += radiance;
        }
        for asked in &record.asked {
            let taken = &samples[asked.gain.sample as usize];
            let sums = &mut pixels[taken.pixel];
            sums.rays += u32::from(asked.ray.is_some());
            if asked.gain.reflections == 1 && taken.weight != 0.0 {
                let weight = f64::from(taken.weight);
                sums.asked += weight * f64::from(luminance(asked.gain.radiance));
                sums.arrived += weight * f64::from(luminance(asked.gain.radiance * asked.passed));
            }
        }
        for followed in &record.followed {
            let taken = &samples[followed.sample as usize];
            let sums = &mut pixels[taken.pixel];
            sums.rays += 1;
            if followed.bounce == 0 {
                sums.surfaces
                    .add(followed.hit.is_some().then_some(followed.hit.surface), taken.weight);
            }
        }
    }
}

impl LightTile {
    /// Both halves together, which count the same, however many samples they have.
    fn joined(self) -> Vec<Sums> {
        let [first, second] = self.halves;
        let mut second = second.into_iter();
        first.into_iter().map(|sums| sums.joined(second.next())).collect()
    }
}

/// Everything that light can come from in a scene.
fn sources(scene: &Scene) -> Vec<Source> {
    let Scene { light_numbers, round_numbers, sun_numbers, .. } = scene;
    let numbers = light_numbers.iter().chain(round_numbers).chain(sun_numbers);
    let lights = numbers.map(|number| Source::Light(*number));
    // What emits may be seen even where it is no light to be asked, such as the side of a cone.
    let emits = |surface: &u32| {
        let material = scene.material_of[*surface as usize] as usize;
        scene.materials[material].emission.factor[..3].iter().any(|channel| *channel > 0.0)
    };
    let surfaces = (0..scene.material_of.len() as u32).filter(emits).map(Source::Surface);
    let sky = scene.environment.is_some()
        || matches!(scene.integrator, Integrator::AmbientOcclusion { .. });
    let rest = [
        (Source::Environment, sky),
        (Source::Ambient, scene.ambient != Rgb::ZERO),
        (Source::Background, scene.background != Rgb::ZERO),
        (Source::Look, matches!(scene.integrator, Integrator::Clarity { .. })),
    ];
    let ambient = scene.near_ambient.iter().map(|light| Source::Light(light.number));
    let rest = rest.into_iter().filter(|(_, there)| *there).map(|(source, _)| source);
    lights.chain(surfaces).chain(ambient).chain(rest).collect()
}

/// The layers of a picture that are made of its own samples.
#[derive(Debug)]
pub struct LightLayers {
    sources: Vec<Source>,
    /// Row by row.
    pixels: Vec<Sums>,
}

impl LightLayers {
    pub(crate) fn new(
        scene: &Scene,
        origin: [u32; 2],
        size: [u32; 2],
        tiles: Vec<LightTile>,
    ) -> Self {
        let mut pixels = vec![Sums::default(); size[0] as usize * size[1] as usize];
        for (place, sums) in Tile::cut(origin, size).iter().zip(tiles) {
            for (index, sums) in sums.joined().into_iter().enumerate() {
                let [x, y] = place.place(index);
                let row = (y - origin[1]) as usize * size[0] as usize;
                pixels[row + (x - origin[0]) as usize] = sums;
            }
        }
        let mut sources = sources(scene);
        sources.sort();
        Self { sources, pixels }
    }

    /// Bytes of memory for each pixel of such layers of a scene.
    pub fn bytes_per_pixel(scene: &Scene) -> u64 {
        (size_of::<Sums>() + size_of::<DVec3>() * sources(scene).len()) as u64 + 64
    }

    /// The channels of those layers that are wanted; the scene was built from `description`.
    pub fn channels(&self, description: &SceneDescription, wanted: &[Layer]) -> Vec<Channel> {
        let wants = |layer| wanted.contains(&layer);
        let mut channels = Vec::new();
        for (part, _, name) in Part::ALL.into_iter().filter(|(_, layer, _)| wants(*layer)) {
            channels.extend(self.rgb(name, |sums| sums.parts[part as usize] / sums.weight));
        }
        if wants(Layer::Light) {
            for (place, name) in self.names(description).into_iter().enumerate() {
                let of = |sums: &Sums| sums.sources[place] / sums.weight;
                channels.extend(self.rgb(&format!("light.{name}"), of));
            }
        }
        if wants(Layer::Shadow) {
            let stopped = |sums: &Sums| match sums.asked {
                0.0 => 0.0,
                asked => (1.0 - sums.arrived / asked).clamp(0.0, 1.0) as f32,
            };
            channels.push(Channel::numbers("shadow", self.pixels.iter().map(stopped)));
        }
        if wants(Layer::Variance) {
            channels.extend(self.rgb("variance", Sums::variance));
        }
        let numbers = self.pixels.iter();
        if wants(Layer::SampleCount) {
            channels.push(Channel::whole("sample_count", numbers.clone().map(|sums| sums.count)));
        }
        if wants(Layer::Cost) {
            channels.push(Channel::whole("cost", numbers.clone().map(|sums| sums.rays)));
        }
        if wants(Layer::Cryptomatte) {
            let coverage: Vec<_> = numbers.map(|sums| &sums.surfaces).collect();
            channels.extend(CryptoNames::new(description).channels(&coverage));
        }
        channels
    }

    fn rgb(&self, name: &str, of: impl Fn(&Sums) -> DVec3) -> Vec<Channel> {
        let values: Vec<_> = self
            .pixels
            .iter()
            .map(|sums| if sums.weight > 0.0 { of(sums).as_vec3() } else { glam::Vec3::ZERO })
            .collect();
        let channel = |(index, letter)| {
            Channel::numbers(format!("{name}.{letter}"), values.iter().map(|value| value[index]))
        };
        ["R", "G", "B"].into_iter().enumerate().map(channel).collect()
    }

    /// The name of each source, no two the same.
    fn names(&self, description: &SceneDescription) -> Vec<String> {
        let mut names = Vec::<String>::new();
        for source in &self.sources {
            let name = source.name(description).replace('.', "_");
            let taken = |name: &String| names.contains(name);
            let other = (2..).map(|number| format!("{name}_{number}"));
            let free = std::iter::once(name.clone()).chain(other).find(|name| !taken(name));
            names.push(free.unwrap_or(name));
        }
        names
    }
}

impl Sums {
    /// With the other half, each as if of weight 1/2.
    fn joined(self, other: Option<Self>) -> Self {
        let Some(other) = other.filter(|other| other.weight > 0.0) else { return self };
        if self.weight <= 0.0 {
            return other;
        }
        let (own, its) = (0.5 / self.weight, 0.5 / other.weight);
        let mix = |a: DVec3, b: DVec3| own * a + its * b;
        let variance = 0.25 * (self.variance() + other.variance());
        Self {
            parts: std::array::from_fn(|part| mix(self.parts[part], other.parts[part])),
            sources: self.sources.iter().zip(&other.sources).map(|(a, b)| mix(*a, *b)).collect(),
            asked: own * self.asked + its * other.asked,
            arrived: own * self.arrived + its * other.arrived,
            joined_variance: Some(variance),
            weight: 1.0,
            rays: self.rays + other.rays,
            count: self.count + other.count,
            surfaces: self.surfaces.joined(other.surfaces),
            ..Self::default()
        }
    }

    /// Of the mean of as many independent samples.
    fn variance(&self) -> DVec3 {
        if let Some(variance) = self.joined_variance {
            return variance;
        }
        let count = self.weight;
        if count < 2.0 {
            return DVec3::ZERO;
        }
        let mean = self.radiance / count;
        (self.squares / count - mean * mean).max(DVec3::ZERO) / (count - 1.0)
    }
}
