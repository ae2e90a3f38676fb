//! Which points a light reaches, and what stops it where it does not.

use super::Doctor;
use super::probes::Witness;
use crate::geometry::{Hit, Ray};
use crate::math::hash;
use crate::scene::StopsLight;
use crate::scene::description::{Light as Described, LightDescription};
use crate::shading::light::Light;
use crate::shading::light::area::AreaLight;
use glam::DVec2;
use std::collections::BTreeMap;

/// Witnesses that are asked at a time; most lights reach one of the first.
const CHUNK: usize = 64;

/// What became of a light's rays to a number of points.
#[derive(Debug, Default)]
pub(super) struct Tally {
    /// Points that it reaches.
    pub lit: u32,
    /// Points that face away from it.
    pub averted: u32,
    /// Points to which it gives nothing: outside of its cone, or behind it.
    pub outside: u32,
    /// Points to which something is in the way, by what it is.
    pub blocked: BTreeMap<u32, u32>,
}

impl Tally {
    /// How many points to which something is in the way.
    pub(super) fn stopped(&self) -> u32 {
        self.blocked.values().sum()
    }

    /// All points that were asked.
    pub(super) fn points(&self) -> u32 {
        self.lit + self.averted + self.outside + self.stopped()
    }

    /// Adds another light's.
    pub(super) fn add(&mut self, other: &Self) {
        self.lit += other.lit;
        self.averted += other.averted;
        self.outside += other.outside;
        for (surface, count) in &other.blocked {
            *self.blocked.entry(*surface).or_default() += count;
        }
    }
}

/// What a light says to one point.
pub(super) enum Answer {
    /// It gives nothing there.
    Outside,
    /// The point faces away.
    Averted,
    /// Light comes if nothing is in the way of this ray.
    Ray(Ray),
}

/// Something that may reach a point: a ray, or why not.
pub(super) type Ask<'a> = dyn Fn(&Witness, usize) -> Answer + 'a;

impl Doctor<'_> {
    /// Asks a light for all witnesses, or until it reaches one.
    pub(super) fn reach(&self, ask: &Ask<'_>, witnesses: &[Witness]) -> Tally {
        let mut tally = Tally::default();
        for chunk in witnesses.chunks(CHUNK) {
            tally.add(&self.tally(ask, chunk));
            if tally.lit > 0 {
                break;
            }
        }
        tally
    }

    /// Asks a light for all of these witnesses.
    pub(super) fn tally(&self, ask: &Ask<'_>, witnesses: &[Witness]) -> Tally {
        let (mut tally, mut rays) = (Tally::default(), Vec::new());
        for (number, witness) in witnesses.iter().enumerate() {
            match ask(witness, number) {
                Answer::Outside => tally.outside += 1,
                Answer::Averted => tally.averted += 1,
                Answer::Ray(ray) => rays.push(ray),
            }
        }
        for hit in self.stops(&rays) {
            match hit.is_some() {
                true => *tally.blocked.entry(hit.surface).or_default() += 1,
                false => tally.lit += 1,
            }
        }
        tally
    }

    /// What stops light along each ray.
    pub(super) fn stops(&self, rays: &[Ray]) -> Vec<Hit> {
        let mut hits = Vec::new();
        self.scene.world.closest_hits(rays, &StopsLight(self.scene, 0), &mut hits);
        hits
    }

    /// Asks a light without extent, or the middle of one.
    pub(super) fn ask_light(light: &Light, witness: &Witness) -> Answer {
        let Some(sample) = light.sample(witness.position) else { return Answer::Outside };
        let cos = sample.incoming.dot(witness.normal);
        let start = match () {
            () if cos > 0.0 => witness.start,
            () if witness.passes_light && cos < 0.0 => witness.behind,
            () => return Answer::Averted,
        };
        let ray = sample.ray_from(witness.position.as_vec3(), start, 0.0);
        // Without shadows, nothing is in the way of a ray that has no length.
        Answer::Ray(if light.shadows { ray } else { Ray { t_max: 0.0, ..ray } })
    }

    /// Asks a surface that emits, made up of `parts`, at one of them.
    pub(super) fn ask_emitter(parts: &[&AreaLight], witness: &Witness, number: usize) -> Answer {
        let chance = hash(number as u64);
        let light = parts[(chance % parts.len() as u64) as usize];
        let unit = |bits: u64| (bits & 0xFFFF) as f64 / 65_536.0;
        let u = DVec2::new(unit(chance >> 16), unit(chance >> 32));
        let Some(sample) = light.sample(witness.position, u, None) else { return Answer::Outside };
        let cos = sample.incoming.as_vec3().dot(witness.normal);
        match () {
            () if cos > 0.0 => Answer::Ray(sample.shadow_ray(witness.start, 0.0, light.error)),
            () if witness.passes_light => {
                Answer::Ray(sample.shadow_ray(witness.behind, 0.0, light.error))
            }
            () => Answer::Averted,
        }
    }
}

/// The same light turned around.
pub(super) fn turned(described: &LightDescription) -> Option<LightDescription> {
    let mut turned = described.clone();
    match &mut turned.light {
        Described::Spot { direction, .. }
        | Described::Directional { direction, .. }
        | Described::Sun { direction, .. } => *direction = -*direction,
        _ => return None,
    }
    Some(turned)
}
