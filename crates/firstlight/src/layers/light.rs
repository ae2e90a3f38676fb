//! Light by where it came from, summed with the picture's own samples.

use super::crypto::{Coverage, CryptoNames};
use super::{Channel, Layer};
use crate::color::{Rgb, luminance};
use crate::film::{Sample, in_rows};
use crate::geometry::Ray;
use crate::integrator::{Followed, Gain, Record, Source};
use crate::scene::description::{Integrator, SceneDescription};
use crate::scene::{Scene, Solid};
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

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

    /// Of light from an ambient light, or not.
    fn of(gain: &Gain, is_ambient: bool) -> Self {
        match gain.reflections {
            _ if is_ambient => Self::Ambient,
            0 => Self::Emission,
            1 => Self::Direct,
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
    /// Those of ambient light.
    ambient: BTreeSet<Source>,
    pixels: Vec<Sums>,
}

impl LightTile {
    pub(crate) fn new(scene: &Scene, pixels: usize) -> Self {
        let places: BTreeMap<_, _> = sources(scene).into_iter().zip(0..).collect();
        let empty = Sums { sources: vec![DVec3::ZERO; places.len()], ..Sums::default() };
        let near = scene.near_ambient.iter().map(|light| Source::Light(light.number));
        let ambient = near.chain([Source::Ambient]).collect();
        Self { places, ambient, pixels: vec![empty; pixels] }
    }

    /// Adds a batch of samples.
    pub(crate) fn add(&mut self, scene: &Scene, samples: &[Taken], record: &Record) {
        let Self { places, ambient, pixels } = self;
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
            let part = Part::of(gain, ambient.contains(&gain.source));
            sums.parts[part as usize] += radiance;
            sums.sources[places[&gain.source]] += radiance;
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
                sums.surfaces.add(solid(scene, followed), taken.weight);
            }
        }
    }
}

/// The surface that a camera's ray comes to, in fog or behind it.
fn solid(scene: &Scene, Followed { ray, hit, .. }: &Followed) -> Option<u32> {
    let in_fog = !hit.is_some() && ray.t_max.is_finite();
    let mut hits = vec![*hit];
    if in_fog || (hit.is_some() && scene.material(hit).only_bounds()) {
        let ray = Ray { t_max: f32::INFINITY, ..*ray };
        scene.world.closest_hits(&[ray], &Solid(scene), &mut hits);
    }
    hits.first().filter(|hit| hit.is_some()).map(|hit| hit.surface)
}

/// Everything that light can come from in a scene.
pub(crate) fn sources(scene: &Scene) -> Vec<Source> {
    let Scene { light_numbers, round_numbers, sun_numbers, .. } = scene;
    let numbers = light_numbers.iter().chain(round_numbers).chain(sun_numbers);
    let lights = numbers.map(|number| Source::Light(*number));
    // What emits may be seen even where it is no light to be asked, such as the side of a cone.
    let emits = |surface: &u32| {
        let material = scene.material_of[*surface as usize] as usize;
        scene.materials[material].emits()
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
        let pixels = in_rows(origin, size, tiles.into_iter().map(|tile| tile.pixels));
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
        let (mut taken, mut numbers) = (HashSet::new(), HashMap::new());
        let mut unique = |name: String| {
            let number = numbers.entry(name.clone()).or_insert(0);
            loop {
                *number += 1;
                let numbered = if *number == 1 { name.clone() } else { format!("{name}_{number}") };
                if taken.insert(numbered.clone()) {
                    return numbered;
                }
            }
        };
        self.sources.iter().map(|source| unique(layer_name(&source.name(description)))).collect()
    }
}

/// What the layer of something called `name` is called: a dot would begin the name of a channel, and formats have no room for
/// more than 255 bytes in all.
pub fn layer_name(name: &str) -> String {
    const BYTES: usize = 200;
    name[..name.floor_char_boundary(BYTES)].replace(['.', '\0'], "_")
}

impl Sums {
    /// Of the mean of as many independent samples.
    fn variance(&self) -> DVec3 {
        let count = self.weight;
        if count < 2.0 {
            return DVec3::ZERO;
        }
        let mean = self.radiance / count;
        (self.squares / count - mean * mean).max(DVec3::ZERO) / (count - 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::description::{Light, LightDescription};

    /// As many as a model may have, all of one name but a few that have the name that others would get.
    #[test]
    fn names_are_told_apart_in_no_time() {
        let light = |number: u32| {
            let name = if number % 1000 == 7 { format!("Lamp_{number}") } else { "Lamp".into() };
            let (position, intensity) = (glam::DVec3::ZERO, Rgb::ONE);
            LightDescription::new(name, Light::Point { position, intensity })
        };
        let lights = (0..20_000).map(light).collect();
        let description = SceneDescription { lights, ..SceneDescription::default() };
        let sources = (0..20_000).map(Source::Light).collect();
        let names = LightLayers { sources, pixels: Vec::new() }.names(&description);
        assert_eq!(names.iter().collect::<HashSet<_>>().len(), 20_000);
        assert_eq!(names[..3], ["Lamp", "Lamp_2", "Lamp_3"]);
    }
}
