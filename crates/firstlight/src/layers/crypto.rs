//! Cryptomatte (Friedman & Jones 2015, specification 1.2): which part of a pixel each surface and each material covers,
//! under numbers made of their names.

use super::Channel;
use crate::scene::description::SceneDescription;
use std::collections::BTreeMap;

/// Surfaces that are told apart in one pixel.
const RANKS: usize = 6;

/// How much of a pixel each surface covers; without a surface, how much is background.
#[derive(Debug, Clone, Default)]
pub(super) struct Coverage(Vec<(Option<u32>, f32)>);

impl Coverage {
    pub(super) fn add(&mut self, surface: Option<u32>, weight: f32) {
        match self.0.iter_mut().find(|(known, _)| *known == surface) {
            Some((_, sum)) => *sum += weight,
            None => self.0.push((surface, weight)),
        }
    }

    /// The covered part under the number of each name, the largest first.
    fn ranks(&self, number: impl Fn(u32) -> f32) -> Vec<(f32, f32)> {
        let whole: f32 = self.0.iter().map(|(_, weight)| weight).sum();
        let mut of = BTreeMap::<u32, f32>::new();
        for (surface, weight) in &self.0 {
            let Some(surface) = surface else { continue };
            *of.entry(number(*surface).to_bits()).or_default() += weight / whole;
        }
        let mut ranks: Vec<_> =
            of.into_iter().map(|(bits, part)| (f32::from_bits(bits), part)).collect();
        ranks.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.total_cmp(&b.0)));
        ranks.truncate(RANKS);
        ranks
    }
}

/// The names that stand behind the numbers.
#[derive(Debug)]
pub struct CryptoNames {
    /// Of each surface.
    objects: Vec<String>,
    materials: Vec<String>,
}

impl CryptoNames {
    /// Of the surfaces and materials of a scene.
    pub fn new(description: &SceneDescription) -> Self {
        let material = |surface: &crate::scene::description::Surface| {
            description.materials[surface.material].name.clone()
        };
        Self {
            objects: description.surfaces.iter().map(|surface| surface.name.clone()).collect(),
            materials: description.surfaces.iter().map(material).collect(),
        }
    }

    fn kinds(&self) -> [(&'static str, &[String]); 2] {
        [("CryptoObject", &self.objects), ("CryptoMaterial", &self.materials)]
    }

    pub(super) fn channels(&self, pixels: &[&Coverage]) -> Vec<Channel> {
        self.kinds().into_iter().flat_map(|(kind, names)| channels(kind, names, pixels)).collect()
    }

    /// What a file has to say about them: names and texts of attributes.
    pub fn attributes(&self) -> Vec<(String, String)> {
        self.kinds().into_iter().flat_map(|(kind, names)| attributes(kind, names)).collect()
    }
}

/// Pairs of number and coverage, two in each RGBA layer.
fn channels(kind: &str, names: &[String], pixels: &[&Coverage]) -> Vec<Channel> {
    let numbers: Vec<f32> = names.iter().map(|name| number(name)).collect();
    let ranks: Vec<_> = pixels.iter().map(|p| p.ranks(|s| numbers[s as usize])).collect();
    let channel = |rank: usize, letter: char, coverage: bool| {
        let of = move |ranks: &Vec<(f32, f32)>| {
            ranks.get(rank).map_or(0.0, |(number, part)| if coverage { *part } else { *number })
        };
        Channel::numbers(format!("{kind}{:02}.{letter}", rank / 2), ranks.iter().map(of))
    };
    let pair = |rank: usize| {
        let [number, coverage] = if rank.is_multiple_of(2) { ['R', 'G'] } else { ['B', 'A'] };
        [channel(rank, number, false), channel(rank, coverage, true)]
    };
    (0..RANKS).flat_map(pair).collect()
}

fn attributes(kind: &str, names: &[String]) -> Vec<(String, String)> {
    let id = &format!("{:08x}", hash(kind))[..7];
    let known: BTreeMap<&String, String> =
        names.iter().map(|name| (name, format!("{:08x}", number(name).to_bits()))).collect();
    let entries = [
        ("name", kind.to_owned()),
        ("hash", "MurmurHash3_32".to_owned()),
        ("conversion", "uint32_to_float32".to_owned()),
        ("manifest", serde_json::json!(known).to_string()),
    ];
    entries.map(|(key, text)| (format!("cryptomatte/{id}/{key}"), text)).to_vec()
}

fn hash(name: &str) -> u32 {
    // Reading from memory cannot fail.
    murmur3::murmur3_32(&mut name.as_bytes(), 0).unwrap_or_default()
}

/// The number of a name, as a float that is neither infinite, not a number, nor denormal.
fn number(name: &str) -> f32 {
    let bits = hash(name);
    let exponent = bits >> 23 & 0xff;
    f32::from_bits(if exponent == 0 || exponent == 0xff { bits ^ 1 << 23 } else { bits })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The published value of MurmurHash3 (x86, 32 bit) of "hello" with seed 0.
    #[test]
    fn names_have_their_numbers() {
        assert_eq!(hash("hello"), 0x248b_fa47);
        assert_eq!(number("hello").to_bits(), 0x248b_fa47);
        assert!((0..100_000).all(|i| number(&i.to_string()).is_normal()));
    }

    #[test]
    fn surfaces_of_one_name_count_together() {
        let mut coverage = Coverage::default();
        for (surface, weight) in [(Some(0), 1.0), (None, 2.0), (Some(1), 1.0), (Some(2), 4.0)] {
            coverage.add(surface, weight);
        }
        let ranks = coverage.ranks(|surface| if surface == 2 { 7.0 } else { 5.0 });
        assert_eq!(ranks, [(7.0, 0.5), (5.0, 0.25)]);
    }
}
