//! What a pixel is the sum of, over all its samples.

use crate::color::luminance;
use crate::geometry::{Hit, Ray};
use crate::integrator::{Asked, Followed, Source};
use crate::render::Replayed;
use crate::scene::description::SceneDescription;
use crate::scene::{Scene, StopsLight};
use glam::{DVec3, Vec3};
use serde::Serialize;
use std::collections::BTreeMap;

/// One addend of a pixel: light from one source after so many reflections.
#[derive(Debug, Clone, Serialize)]
pub struct Term {
    /// The light, emitting surface or whatever else it comes from.
    pub source: String,
    /// What that is: point, spot, surface, environment, ambient, background …
    pub kind: &'static str,
    /// Scatterings between there and the eye: 0 for what is seen itself, 1 for direct light.
    pub reflections: u32,
    /// What it adds, W·sr⁻¹·m⁻².
    pub radiance: [f64; 3],
    /// Its part of the pixel's luminance, 0..1.
    pub share: f64,
    /// Its part of all the terms' variance from sample to sample: where the noise comes from, 0..1.
    pub noise_share: f64,
    #[serde(skip)]
    pub(super) key: (Source, u32),
}

/// Shadow rays to one light from the surface that most samples met.
#[derive(Debug, Clone, Serialize)]
pub struct Shadow {
    /// The light or emitting surface.
    pub source: String,
    /// Shadow rays to it.
    pub rays: u32,
    /// Those that something stopped.
    pub blocked: u32,
    /// What stopped most of them.
    pub blocker: Option<String>,
    /// How far from the surface that was on average, m.
    pub distance: Option<f64>,
    /// The luminance that the pixel would have in addition if nothing had, as a multiple of what it has.
    pub lost: f64,
    /// The same, W·sr⁻¹·m⁻² weighted as luminance.
    #[serde(skip)]
    pub(super) lost_radiance: f64,
}

#[derive(Default)]
struct Sum {
    radiance: DVec3,
    luminance: f64,
    squares: f64,
}

/// Shadow rays of samples that met the same surface.
#[derive(Default)]
struct Rays {
    count: u32,
    lost: f64,
    /// For each blocker, how often and how far away in all.
    blockers: BTreeMap<u32, (u32, f64)>,
}

/// The samples that met one surface first.
#[derive(Default)]
struct First {
    count: u32,
    /// The one nearest to the middle of the pixel, and how far from it, m.
    nearest: (u32, f32),
    rays: BTreeMap<Source, Rays>,
}

/// Adds up the samples of a pixel.
pub(super) struct Sums<'a> {
    scene: &'a Scene,
    /// Through the middle of the pixel.
    middle: Ray,
    terms: BTreeMap<(Source, u32), Sum>,
    /// Samples that count, and those of them that are covered.
    count: f64,
    covered: f64,
    /// By surface; the background is the last.
    firsts: BTreeMap<u32, First>,
}

impl<'a> Sums<'a> {
    pub(super) fn new(scene: &'a Scene, [x, y]: [u32; 2]) -> Self {
        Self {
            scene,
            middle: scene.camera().get_ray(x, y),
            terms: BTreeMap::new(),
            count: 0.0,
            covered: 0.0,
            firsts: BTreeMap::new(),
        }
    }

    /// Adds the samples of a pass.
    pub(super) fn add(&mut self, pass: &Replayed<'_>) {
        let weight = |sample: u32| f64::from(pass.weights[sample as usize]);
        let mut of_samples = BTreeMap::<_, DVec3>::new();
        for gain in &pass.record.gains {
            let radiance = weight(gain.sample) * gain.radiance.as_dvec3();
            *of_samples.entry((gain.source, gain.reflections, gain.sample)).or_default() +=
                radiance;
        }
        for ((source, reflections, _), radiance) in of_samples {
            let term = self.terms.entry((source, reflections)).or_default();
            let seen = radiance.dot(DVec3::new(0.2126, 0.7152, 0.0722));
            term.radiance += radiance;
            term.luminance += seen;
            term.squares += seen * seen;
        }
        for first in pass.record.followed.iter().filter(|followed| followed.bounce == 0) {
            let weight = weight(first.sample);
            self.count += weight;
            let seen_through = self.scene.film().transparent && !first.hit.is_some();
            self.covered += if seen_through { 0.0 } else { weight };
            self.meet(pass.samples.start + first.sample, first);
        }
        self.add_shadows(pass);
    }

    fn meet(&mut self, sample: u32, first: &Followed) {
        let distance = self.off_middle(first);
        let met = self.firsts.entry(first.hit.surface).or_default();
        if met.count == 0 || distance < met.nearest.1 {
            met.nearest = (sample, distance);
        }
        met.count += 1;
    }

    /// How far what a ray met, or where it goes, is from the middle of the pixel.
    fn off_middle(&self, Followed { ray, hit, .. }: &Followed) -> f32 {
        let t = if hit.is_some() { hit.t } else { 1.0 };
        self.middle.at(t).distance(ray.at(t))
    }

    fn add_shadows(&mut self, pass: &Replayed<'_>) {
        let surface_of: BTreeMap<u32, u32> = pass
            .record
            .followed
            .iter()
            .filter(|followed| followed.bounce == 0)
            .map(|followed| (followed.sample, followed.hit.surface))
            .collect();
        let at_first = |asked: &&Asked| asked.gain.bounce == 0 && asked.after.is_none();
        for asked in pass.record.asked.iter().filter(at_first) {
            let Some(ray) = asked.ray else { continue };
            let Some(first) = self.firsts.get_mut(&surface_of[&asked.gain.sample]) else {
                continue;
            };
            let rays = first.rays.entry(asked.gain.source).or_default();
            rays.count += 1;
            if let Some((blocker, distance)) = stopped_by(self.scene, asked, &ray) {
                let weight = f64::from(pass.weights[asked.gain.sample as usize]);
                rays.lost += weight * f64::from(luminance(asked.gain.radiance));
                let (count, distances) = rays.blockers.entry(blocker).or_default();
                *count += 1;
                *distances += f64::from(distance);
            }
        }
    }

    /// What the pixel is the sum of, the largest first.
    pub(super) fn terms(&self, description: &SceneDescription) -> Vec<Term> {
        let whole: f64 = self.terms.values().map(|sum| sum.luminance).sum();
        let variances: f64 = self.terms.values().map(|sum| self.variance(sum)).sum();
        let part = |value: f64, of: f64| if of > 0.0 { value / of } else { 0.0 };
        let term = |(&(source, reflections), sum): (&(Source, u32), &Sum)| Term {
            source: source.name(description),
            kind: source.kind(description),
            reflections,
            radiance: (sum.radiance / self.covered).to_array(),
            share: part(sum.luminance, whole),
            noise_share: part(self.variance(sum), variances),
            key: (source, reflections),
        };
        let mut terms: Vec<_> = self.terms.iter().map(term).collect();
        terms.sort_by(|a, b| b.share.total_cmp(&a.share));
        terms
    }

    fn variance(&self, sum: &Sum) -> f64 {
        (sum.squares / self.count - (sum.luminance / self.count).powi(2)).max(0.0)
    }

    fn most_met(&self) -> Option<&First> {
        self.firsts.values().max_by_key(|first| first.count)
    }

    /// The number of the sample to be shown.
    pub(super) fn typical(&self) -> u32 {
        self.most_met().map_or(0, |first| first.nearest.0)
    }

    /// What became of shadow rays, the darkest first.
    pub(super) fn shadows(&self, description: &SceneDescription) -> Vec<Shadow> {
        let Some(first) = self.most_met() else { return Vec::new() };
        let whole: f64 = self.terms.values().map(|sum| sum.luminance).sum();
        let shadow = |(&source, rays): (&Source, &Rays)| {
            let most = rays.blockers.iter().max_by_key(|(_, (count, _))| *count);
            Shadow {
                source: source.name(description),
                rays: rays.count,
                blocked: rays.blockers.values().map(|(count, _)| count).sum(),
                blocker: most.map(|(surface, _)| Source::Surface(*surface).name(description)),
                distance: most.map(|(_, (count, sum))| sum / f64::from(*count)),
                lost: if whole > 0.0 { rays.lost / whole } else { 0.0 },
                lost_radiance: rays.lost / self.covered,
            }
        };
        let mut shadows: Vec<_> = first.rays.iter().map(shadow).collect();
        shadows.sort_by(|a, b| b.lost_radiance.total_cmp(&a.lost_radiance));
        shadows
    }
}

/// The surface that stops a light that was asked, and how far along its shadow ray.
pub(super) fn stopped_by(scene: &Scene, asked: &Asked, ray: &Ray) -> Option<(u32, f32)> {
    if asked.passed != Vec3::ZERO {
        return None;
    }
    let mut hits = Vec::<Hit>::new();
    scene.world.closest_hits(&[*ray], &StopsLight(scene, 0), &mut hits);
    hits.first().filter(|hit| hit.is_some()).map(|hit| (hit.surface, hit.t))
}
