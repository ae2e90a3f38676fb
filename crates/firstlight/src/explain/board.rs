//! One sample from the camera to its end, with every number that one would write on the board.

use super::sums::{Term, stopped_by};
use crate::color::luminance;
use crate::geometry::{Hit, Ray};
use crate::integrator::{Asked, Followed, Gain, Record, Source, Way};
use crate::render::{PASS, replay};
use crate::scene::description::{Integrator, SceneDescription};
use crate::scene::{Everything, Scene};
use crate::shading::interaction::SurfaceInteraction;
use crate::units::photometric;
use glam::{DVec2, Vec3};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use std::f32::consts::PI;

/// Surfaces along the camera ray that are named besides the one it met.
const MOST_IGNORED: usize = 8;
/// Lights that are told apart at one point.
const MOST_LIGHTS: usize = 64;

/// A ray, what it met, and the light there.
#[derive(Debug, Clone, Serialize)]
pub struct Step {
    /// Where the ray starts.
    pub origin: [f32; 3],
    /// Unit vector along it.
    pub direction: [f32; 3],
    /// The range in which it looks, m: from, exclusive, and to; nothing if there is no end.
    pub t_range: (f32, Option<f32>),
    /// What light from its end is multiplied by on its way to the eye.
    pub throughput: [f32; 3],
    /// What it met; nothing if it left the scene, or was scattered on its way.
    pub met: Option<Met>,
    /// After what distance fog scattered it, m; nothing if it did not.
    pub scattered_after: Option<f32>,
    /// What came along it from there: emission, environment, background, ambient light, each with its source.
    pub gained: Vec<(String, [f32; 3])>,
    /// The lights there, the strongest first.
    pub lights: Vec<Lighting>,
    /// The lights that were asked on the way there, in fog, the strongest first.
    pub air: Vec<Lighting>,
}

/// A point of a surface.
#[derive(Debug, Clone, Serialize)]
pub struct Met {
    /// The surface.
    pub surface: String,
    /// Its material.
    pub material: String,
    /// Which of its triangles or parts.
    pub primitive: u32,
    /// How far along the ray, m.
    pub distance: f32,
    /// Where, m.
    pub position: [f32; 3],
    /// Texture coordinates.
    pub uv: [f32; 2],
    /// Whether it is its front that was met.
    pub front: bool,
    /// Unit normal of the surface as it is, on the side that was met.
    pub geometric_normal: [f32; 3],
    /// Unit normal that light is reckoned with, after smoothing and normal maps.
    pub shading_normal: [f32; 3],
    /// The material's parameters here, textures looked up.
    pub values: Vec<Value>,
    /// What else is on the way of the camera's ray, and was not met.
    pub ignored: Vec<Ignored>,
}

/// A parameter of a material.
#[derive(Debug, Clone, Serialize)]
pub struct Value {
    /// Its name.
    pub name: &'static str,
    /// One number, or one per channel.
    pub value: Vec<f32>,
}

/// A surface on the way of a ray that it did not meet.
#[derive(Debug, Clone, Serialize)]
pub struct Ignored {
    /// The surface.
    pub surface: String,
    /// How far along the ray, m.
    pub distance: f32,
    /// Why it was not met.
    pub why: &'static str,
}

/// What one light does at a point.
#[derive(Debug, Clone, Serialize)]
pub struct Lighting {
    /// The light or emitting surface.
    pub source: String,
    /// What it is: point, spot, surface, environment …
    pub kind: &'static str,
    /// How far along the ray it was asked, in fog, where it stands for all of the way, m; nothing at the ray's end.
    pub after: Option<f32>,
    /// How far it is, m; nothing if infinitely far.
    pub distance: Option<f32>,
    /// The lecture's geometry factor 1/r², m⁻².
    pub geometry_factor: Option<f32>,
    /// Unit vector to it.
    pub incoming: Option<[f32; 3]>,
    /// cos θ between that and the shading normal.
    pub cos: Option<f32>,
    /// Irradiance that it would cause on the surface, were nothing in the way, W·m⁻²: I cos θ / r², or L cos θ Ω of a
    /// light with an extent, if all of it were as it is where it was sampled.
    pub irradiance: [f32; 3],
    /// The same in lux.
    pub illuminance: f64,
    /// What of it arrives, weakened by panes and fog or stopped by what is in the way, W·m⁻².
    pub arriving_irradiance: [f32; 3],
    /// The same in lux.
    pub arriving: f64,
    /// Whether this is what one sample stands for: of a light with an extent, or of one picked for many.
    pub sampled: bool,
    /// Ω, the solid angle that the sample stands for, sr; nothing of a light without extent.
    pub solid_angle: Option<f32>,
    /// The part of its light that is asked for; rays that meet the light by chance bring the rest.
    pub weight: f32,
    /// The chance with which it was picked to stand for all lights; what it gives is divided by that.
    pub chance: f32,
    /// What the shadow ray says.
    pub verdict: Verdict,
    /// Value of the BSDF, sr⁻¹.
    pub bsdf: [f32; 3],
    /// What it adds to the sample, W·sr⁻¹·m⁻².
    pub radiance: [f32; 3],
    /// The part of the pixel's luminance that comes from it after so many reflections, over all samples.
    pub share: f64,
}

/// What becomes of a light's light on its way to a point.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", tag = "is")]
pub enum Verdict {
    /// It arrives.
    Lit,
    /// It arrives, weakened by panes or fog.
    Tinted {
        /// What is left of it.
        passed: [f32; 3],
    },
    /// It casts no shadows, and arrives.
    Unshadowed,
    /// Something is in the way.
    Blocked {
        /// The surface.
        by: String,
        /// How far from the point, m.
        distance: f32,
        /// Where, m.
        at: [f32; 3],
    },
    /// The light is below the horizon of the surface.
    FacesAway,
    /// The light does not shine in this direction.
    OutsideBeam,
    /// The point is inside of the sphere that the light is, where it gives nothing.
    InsideOfIt,
    /// It arrives, and nothing of it is scattered towards the eye.
    NotScattered,
    /// Another light was asked for all.
    NotAsked,
}

/// Follows one sample of a pixel.
pub(super) fn follow(
    scene: &Scene,
    description: &SceneDescription,
    pixel: [u32; 2],
    sample: u32,
    terms: &[Term],
) -> Vec<Step> {
    let (first, mut steps) = (sample / PASS * PASS, Vec::new());
    let samples = first..scene.film().samples.min(first + PASS);
    replay(scene, pixel, samples, |pass| {
        let place = sample - pass.samples.start;
        let board = Board { scene, description, record: pass.record, terms, place };
        steps = board.steps();
    });
    steps
}

/// The record of one sample.
struct Board<'a> {
    scene: &'a Scene,
    description: &'a SceneDescription,
    record: &'a Record,
    terms: &'a [Term],
    /// The sample's place in its batch.
    place: u32,
}

impl Board<'_> {
    fn steps(&self) -> Vec<Step> {
        let own = self.record.followed.iter().filter(|followed| followed.sample == self.place);
        own.map(|followed| self.step(followed)).collect()
    }

    fn step(&self, followed: &Followed) -> Step {
        let Followed { bounce, ray, hit, throughput, .. } = followed;
        let point = hit.is_some().then(|| Point::new(self.scene, followed));
        let met = point.as_ref().map(|point| self.met(point, *bounce, ray));
        let ended_in_fog = !hit.is_some() && ray.t_max.is_finite();
        let air = self.asked(None, *bounce, |asked| asked.after.is_some());
        let lights = match ended_in_fog || point.is_some() {
            true => self.lights(point.as_ref(), ray.at(hit.t), *bounce),
            false => Vec::new(),
        };
        let of_step = |gain: &&Gain| gain.sample == self.place && gain.bounce == *bounce;
        let gained = self.record.gains.iter().filter(of_step).filter(|gain| !gain.asked);
        let name = |gain: &Gain| (gain.source.name(self.description), gain.radiance.to_array());
        Step {
            origin: ray.origin.to_array(),
            direction: ray.direction.to_array(),
            t_range: (ray.t_min, ray.t_max.is_finite().then_some(ray.t_max)),
            throughput: throughput.to_array(),
            met,
            scattered_after: ended_in_fog.then_some(ray.t_max),
            gained: gained.map(name).collect(),
            lights,
            air,
        }
    }

    fn met(&self, point: &Point, bounce: u32, ray: &Ray) -> Met {
        let Point { at, normal } = point;
        let material = self.scene.material(&at.hit);
        let values = self.scene.values(material, at).into_iter();
        Met {
            surface: Source::Surface(at.hit.surface).name(self.description),
            material: material.name.clone(),
            primitive: at.hit.primitive,
            distance: at.hit.t,
            position: at.position.to_array(),
            uv: at.uv.to_array(),
            front: at.front,
            geometric_normal: at.geometric_normal.to_array(),
            shading_normal: normal.to_array(),
            values: values.map(|(name, value)| Value { name, value }).collect(),
            ignored: if bounce == 0 { self.ignored(ray, &at.hit) } else { Vec::new() },
        }
    }

    /// What is on the way of a ray besides what it met.
    fn ignored(&self, ray: &Ray, met: &Hit) -> Vec<Ignored> {
        let (mut ray, mut hits, mut ignored) = (Ray { t_min: 0.0, ..*ray }, Vec::new(), Vec::new());
        let t_min = ray.t_min;
        while ignored.len() < MOST_IGNORED {
            self.scene.world.closest_hits(&[ray], &Everything, &mut hits);
            let Some(hit) = hits.first().filter(|hit| hit.is_some()) else { break };
            let why = match hit.t {
                t if t <= t_min => "nearer than the ray's range",
                t if t < met.t => "not seen from this side, a hole, or hidden from the camera",
                _ => "behind it",
            };
            if (hit.surface, hit.primitive) != (met.surface, met.primitive) {
                let surface = Source::Surface(hit.surface).name(self.description);
                ignored.push(Ignored { surface, distance: hit.t, why });
            }
            ray.t_min = hit.t;
        }
        ignored
    }

    /// The lights that were asked for a bounce where `there` says so; the strongest first.
    fn asked(
        &self,
        point: Option<&Point>,
        bounce: u32,
        there: impl Fn(&Asked) -> bool,
    ) -> Vec<Lighting> {
        let mut asked_of = BTreeMap::<Source, Vec<&Asked>>::new();
        for asked in self.record.asked.iter().filter(|asked| there(asked)) {
            if (asked.gain.sample, asked.gain.bounce) == (self.place, bounce) {
                asked_of.entry(asked.gain.source).or_default().push(asked);
            }
        }
        let mut lights: Vec<_> =
            asked_of.iter().map(|(source, all)| self.lighting(point, *source, all)).collect();
        let strength = |light: &Lighting| luminance(light.radiance.into());
        lights.sort_by(|a, b| strength(b).total_cmp(&strength(a)));
        lights
    }

    /// All lights at a place in fog, but those that are asked on the way there, or, if there is a `point`, on a surface; the strongest
    /// first.
    fn lights(&self, point: Option<&Point>, place: Vec3, bounce: u32) -> Vec<Lighting> {
        let at_end = |asked: &Asked| asked.after.is_none();
        let mut lights = self.asked(point, bounce, at_end);
        let told = |asked: &&Asked| {
            let own = (asked.gain.sample, asked.gain.bounce) == (self.place, bounce);
            own && (at_end(asked) || point.is_none())
        };
        let told: BTreeSet<_> =
            self.record.asked.iter().filter(told).map(|asked| asked.gain.source).collect();
        let silent = self.sources().into_iter().filter(|source| !told.contains(source));
        lights.extend(silent.map(|source| self.silent(point, place, source, bounce)));
        lights.truncate(MOST_LIGHTS);
        lights
    }

    /// Everything that may be asked for light.
    fn sources(&self) -> Vec<Source> {
        let Scene { light_numbers, round_numbers, sun_numbers, .. } = self.scene;
        let numbers = light_numbers.iter().chain(round_numbers).chain(sun_numbers);
        let mut sources: Vec<_> = numbers.map(|number| Source::Light(*number)).collect();
        let surfaces = self.scene.area_lights.iter().map(|light| Source::Surface(light.surface));
        sources.extend(surfaces);
        sources.extend(self.scene.environment.as_ref().map(|_| Source::Environment));
        sources.sort();
        sources.dedup();
        sources
    }

    /// A light that was asked once, or part by part.
    fn lighting(&self, point: Option<&Point>, source: Source, asked: &[&Asked]) -> Lighting {
        let gives = |asked: &&&Asked| luminance(asked.gain.radiance * asked.passed);
        let may_give = |asked: &&&Asked| luminance(asked.gain.radiance);
        let order = |a: &&&Asked, b: &&&Asked| {
            gives(a).total_cmp(&gives(b)).then(may_give(a).total_cmp(&may_give(b)))
        };
        let strongest = asked.iter().max_by(order).map_or(asked[0], |asked| asked);
        // What comes from everywhere is a mean over all directions; fog faces all ways.
        let everywhere = self.is_everywhere(source);
        let cos =
            |asked: &Asked| point.filter(|_| !everywhere).map(|point| point.cos(asked.incoming));
        let part = |asked: &Asked| cos(asked).map_or(if everywhere { PI } else { 1.0 }, f32::abs);
        let on_surface = |asked: &Asked| asked.irradiance * part(asked);
        let by_hand = |asked: &Asked| on_surface(asked) * asked.draw.chance / asked.draw.weight;
        let weighted: Vec3 = asked.iter().map(|asked| on_surface(asked)).sum();
        let irradiance: Vec3 = asked.iter().map(|asked| by_hand(asked)).sum();
        let arriving: Vec3 = asked.iter().map(|asked| by_hand(asked) * asked.passed).sum();
        let solid_angle: f32 = asked.iter().map(|asked| asked.draw.solid_angle).sum();
        let chance = strongest.draw.chance;
        let weight = chance * luminance(weighted) / luminance(irradiance);
        let radiance: Vec3 = asked.iter().map(|asked| asked.gain.radiance * asked.passed).sum();
        let distance = strongest.ray.filter(|_| !everywhere).map(|ray| ray.t_max);
        let distance = distance.filter(|distance| distance.is_finite());
        Lighting {
            source: source.name(self.description),
            kind: source.kind(self.description),
            after: strongest.after,
            distance,
            geometry_factor: distance.map(|distance| distance.powi(-2)),
            incoming: Some(strongest.incoming.to_array()),
            cos: cos(strongest),
            irradiance: irradiance.to_array(),
            illuminance: self.lux(irradiance),
            arriving_irradiance: arriving.to_array(),
            arriving: self.lux(arriving),
            sampled: self.is_sampled(source, strongest.gain.bounce),
            solid_angle: (solid_angle > 0.0).then_some(solid_angle),
            weight: if weight.is_finite() { weight } else { 1.0 },
            chance,
            verdict: self.verdict(strongest),
            bsdf: (strongest.scattered / part(strongest).max(f32::MIN_POSITIVE)).to_array(),
            radiance: radiance.to_array(),
            share: self.share((source, strongest.gain.reflections)),
        }
    }

    /// Whether a light is asked at one place for all of it, or at all for others.
    fn is_sampled(&self, source: Source, bounce: u32) -> bool {
        let has_extent = match source {
            Source::Surface(_) | Source::Environment => true,
            Source::Light(number) => {
                let Scene { round_numbers, sun_numbers, .. } = self.scene;
                round_numbers.contains(&number) || sun_numbers.contains(&number)
            }
            _ => false,
        };
        has_extent || !Way::of(self.scene, false).asks_all(bounce)
    }

    fn lux(&self, irradiance: Vec3) -> f64 {
        photometric(irradiance, self.scene.luminous_efficacy().0)
    }

    /// Whether a light has no place and no direction, but a sky of its own that near surfaces hide.
    fn is_everywhere(&self, source: Source) -> bool {
        let is_occlusion = matches!(self.scene.integrator, Integrator::AmbientOcclusion { .. });
        is_occlusion || ["ambient", "look"].contains(&source.kind(self.description))
    }

    fn verdict(&self, asked: &Asked) -> Verdict {
        if asked.irradiance == Vec3::ZERO {
            return Verdict::OutsideBeam;
        }
        let Some(ray) = asked.ray else { return Verdict::Unshadowed };
        match stopped_by(self.scene, asked, &ray) {
            Some((surface, distance)) => {
                let (by, at) = (Source::Surface(surface).name(self.description), ray.at(distance));
                Verdict::Blocked { by, distance, at: at.to_array() }
            }
            None if asked.passed == Vec3::ONE => Verdict::Lit,
            None => Verdict::Tinted { passed: asked.passed.to_array() },
        }
    }

    /// The direction of a part of an emitting surface that shines to a place; `None` if none does.
    fn toward(&self, surface: u32, place: Vec3) -> Option<Vec3> {
        let mut parts = self.scene.area_lights.iter().filter(|light| light.surface == surface);
        let sample =
            parts.find_map(|light| light.sample(place.as_dvec3(), DVec2::splat(0.5), None))?;
        Some(sample.incoming.as_vec3())
    }

    /// Whether a place is in the sphere of a light that has a radius.
    fn is_inside(&self, source: Source, place: Vec3) -> bool {
        let Source::Light(number) = source else { return false };
        let described = &self.description.lights[number as usize];
        let at = described.light.position();
        at.is_some_and(|at| at.distance(place.as_dvec3()) < described.radius)
    }

    fn share(&self, key: (Source, u32)) -> f64 {
        self.terms.iter().find(|term| term.key == key).map_or(0.0, |term| term.share)
    }

    /// A light that gave nothing.
    fn silent(&self, point: Option<&Point>, place: Vec3, source: Source, bounce: u32) -> Lighting {
        let sample = match source {
            Source::Light(wanted) => {
                let mut numbers = self.scene.light_numbers.iter();
                let found = numbers.position(|number| *number == wanted);
                found.map(|i| self.scene.lights[i].sample(place.as_dvec3()))
            }
            _ => None,
        };
        let toward = match (source, sample) {
            (Source::Surface(surface), _) => Some(self.toward(surface, place)),
            (_, sample) => sample.map(|sample| sample.map(|sample| sample.incoming)),
        };
        let all_asked = Way::of(self.scene, false).asks_all(bounce);
        let cos = |incoming: Vec3| point.map(|point| point.cos(incoming));
        let verdict = match toward {
            _ if self.is_inside(source, place) => Verdict::InsideOfIt,
            Some(None) => Verdict::OutsideBeam,
            Some(Some(incoming)) if cos(incoming).is_some_and(|cos| cos <= 0.0) => {
                Verdict::FacesAway
            }
            Some(_) if all_asked => Verdict::NotScattered,
            None if all_asked => Verdict::FacesAway,
            _ => Verdict::NotAsked,
        };
        let sample = sample.flatten();
        let cos = sample.and_then(|sample| cos(sample.incoming));
        let distance = sample.map(|s| s.distance).filter(|distance| distance.is_finite());
        let irradiance =
            sample.map_or(Vec3::ZERO, |sample| sample.irradiance * cos.unwrap_or(0.0).max(0.0));
        Lighting {
            source: source.name(self.description),
            kind: source.kind(self.description),
            after: None,
            distance,
            geometry_factor: distance.map(|distance| distance.powi(-2)),
            incoming: sample.map(|sample| sample.incoming.to_array()),
            cos,
            irradiance: irradiance.to_array(),
            illuminance: self.lux(irradiance),
            arriving_irradiance: [0.0; 3],
            arriving: 0.0,
            sampled: false,
            solid_angle: None,
            weight: 1.0,
            chance: 1.0,
            verdict,
            bsdf: [0.0; 3],
            radiance: [0.0; 3],
            share: 0.0,
        }
    }
}

/// A point with the normal that light is reckoned with.
struct Point {
    at: SurfaceInteraction,
    normal: Vec3,
}

impl Point {
    fn new(scene: &Scene, Followed { ray, hit, width, .. }: &Followed) -> Self {
        let (mut at, material) = (scene.interaction(ray, hit), scene.material(hit));
        // Textures are read as the render reads them: filtered over what the ray stands for.
        at.seen_width = *width;
        let boundary = scene.boundary_from_air(material, &at);
        let (frame, _) = scene.add_lobes(material, &at, -ray.direction, boundary, &mut Vec::new());
        Self { at, normal: frame.normal() }
    }

    fn cos(&self, direction: Vec3) -> f32 {
        self.normal.dot(direction)
    }
}
