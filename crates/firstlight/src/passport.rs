//! Every light with its units: what its file says, what that is in watts and in lumens, and what arrives in the middle of
//! the scene.

use crate::color::Rgb;
use crate::geometry::Ray;
use crate::math::hash;
use crate::scene::description::{
    CameraLightAmount, EnvironmentDescription, Light as Described, LightDescription, Material,
    SceneDescription, Sky, SpotFalloff, Surface,
};
use crate::scene::{Scene, Solid, StopsLight, bounds, light_middle};
use crate::shading::light::Light;
use crate::shading::light::area::AreaLight;
use crate::shading::light::environment::Environment;
use crate::units;
use glam::{DVec2, DVec3, Vec3};
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};

/// Points of emitting surfaces, and directions of the environment, from which light is added up.
const SAMPLES: u32 = 4096;
/// Unit of radiance.
const RADIANCE: &str = "W/(sr m²)";

/// All lights of a scene.
#[derive(Debug, Clone)]
pub struct Passport {
    /// Where light is reckoned, m: in the middle of everything that has an end (the origin if nothing has), or where the
    /// camera sees what is before that.
    pub middle: DVec3,
    /// The surface that is there, if it is not in the open.
    pub surface: Option<String>,
    /// Lumens per watt, by which one becomes the other.
    pub luminous_efficacy: f64,
    /// The lights: those of the file in its order, the environment, then surfaces that emit.
    pub lights: Vec<Entry>,
}

/// One light. Quantities are per colour channel and in SI units of energy; those that do not apply are `None`.
#[derive(Debug, Clone)]
pub struct Entry {
    /// Its name, or that of the surface.
    pub name: String,
    /// What it is: `point`, `environment`, `surface` …
    pub kind: &'static str,
    /// Its quantity as its file has it; empty if that is not known.
    pub written: String,
    /// All that it gives, W.
    pub power: Option<Rgb>,
    /// What it gives in its brightest direction, W·sr⁻¹.
    pub intensity: Option<Rgb>,
    /// What its surface gives per area and direction, on average, W·sr⁻¹·m⁻².
    pub radiance: Option<Rgb>,
    /// Irradiance that it would cause in that middle if nothing stood in between, W·m⁻²: of a surface that faces it; of a
    /// horizontal one, if it is all around.
    pub irradiance: Rgb,
    /// The part of that which is kept off, 0..1, and by which surface most.
    pub blocked: Option<(f64, String)>,
}

/// Light that arrives from one direction: unit vector to where it comes from, what it adds to the irradiance of a surface
/// that faces that way, and the ray that anything in its way would meet.
struct Arrival {
    toward: Vec3,
    irradiance: Rgb,
    ray: Ray,
}

impl Passport {
    /// Of `scene`, which was built from `description`.
    pub fn new(description: &SceneDescription, scene: &Scene) -> Self {
        let ends = bounds(description);
        let middle = ends.map_or(DVec3::ZERO, |[lo, hi]| 0.5 * (lo + hi));
        let (middle, surface) = in_sight(scene, middle);
        let surface = surface.map(|number| description.surfaces[number as usize].name.clone());
        let maker = Maker { description, scene, middle };
        let mut lights: Vec<_> = description.lights.iter().map(|l| maker.light(l)).collect();
        lights.extend(scene.environment.as_ref().map(|(sky, _)| maker.environment(sky)));
        lights.extend(maker.surfaces());
        Self { middle, surface, luminous_efficacy: description.luminous_efficacy.0, lights }
    }
}

/// A point, or the one before it, and on which surface, if the camera does not see it: in the inside of things it is always dark.
fn in_sight(scene: &Scene, point: DVec3) -> (DVec3, Option<u32>) {
    let (ray, mut hits) = (scene.camera().ray_to(point), Vec::new());
    scene.world.closest_hits(&[ray], &Solid(scene), &mut hits);
    match hits.first().filter(|hit| hit.is_some()) {
        Some(hit) => {
            let start = scene.interaction(&ray, hit).ray_origin();
            (start.as_dvec3(), Some(hit.surface))
        }
        None => (point, None),
    }
}

struct Maker<'a> {
    description: &'a SceneDescription,
    scene: &'a Scene,
    middle: DVec3,
}

impl Maker<'_> {
    fn light(&self, described: &LightDescription) -> Entry {
        let arrival = match described.light {
            Described::Ambient { .. } => None,
            _ => light_middle(described, self.scene.camera()).and_then(|l| self.arrival(&l)),
        };
        let ambient = match described.light {
            Described::Ambient { radiance, .. } => PI as f32 * radiance,
            _ => Rgb::ZERO,
        };
        let shadows = described.shadows && !matches!(described.light, Described::Camera { .. });
        let (power, intensity) = flux(&described.light);
        let (irradiance, blocked) = self.sum(arrival.as_slice(), Vec3::ZERO);
        Entry {
            name: described.name.clone(),
            kind: described.light.kind(),
            written: described.written.clone(),
            power,
            intensity,
            radiance: match described.light {
                Described::Ambient { radiance, .. } => Some(radiance),
                Described::Sun { irradiance, angular_radius, .. } => {
                    Some(irradiance / (PI * angular_radius.sin().powi(2)) as f32)
                }
                _ => None,
            },
            irradiance: irradiance + ambient,
            blocked: blocked.filter(|_| shadows),
        }
    }

    fn arrival(&self, light: &Light) -> Option<Arrival> {
        let sample = light.sample(self.middle)?;
        let middle = self.middle.as_vec3();
        let ray = sample.ray_from(middle, middle, 0.0);
        Some(Arrival { toward: sample.incoming, irradiance: sample.irradiance, ray })
    }

    /// Irradiance of a surface with the unit normal `facing` (zero: that faces where most comes from), and what of it is
    /// kept off by which surface.
    fn sum(&self, arrivals: &[Arrival], facing: Vec3) -> (Rgb, Option<(f64, String)>) {
        let vector = |a: &Arrival| a.irradiance.element_sum() * a.toward;
        let most: Vec3 = arrivals.iter().map(vector).sum();
        let normal = if facing == Vec3::ZERO { most.normalize_or_zero() } else { facing };
        let on_it = |a: &Arrival| a.irradiance * a.toward.dot(normal).max(0.0);
        let whole: Rgb = arrivals.iter().map(on_it).sum();
        let rays: Vec<Ray> = arrivals.iter().map(|arrival| arrival.ray).collect();
        let mut hits = Vec::new();
        self.scene.world.closest_hits(&rays, &StopsLight(self.scene, 0), &mut hits);
        let mut lost = BTreeMap::<u32, f64>::new();
        for (arrival, hit) in arrivals.iter().zip(&hits).filter(|(_, hit)| hit.is_some()) {
            *lost.entry(hit.surface).or_default() += f64::from(on_it(arrival).element_sum());
        }
        let part = lost.values().sum::<f64>() / f64::from(whole.element_sum());
        let most = lost.into_iter().max_by(|a, b| a.1.total_cmp(&b.1));
        let name =
            |(surface, _): (u32, f64)| self.description.surfaces[surface as usize].name.clone();
        (whole, most.map(|most| (part.min(1.0), name(most))).filter(|(part, _)| *part > 0.0))
    }

    fn environment(&self, sky: &Environment) -> Entry {
        let up = self.description.up.0.as_vec3();
        let solid_angle = (2.0 * TAU / f64::from(SAMPLES)) as f32;
        let middle = self.middle.as_vec3();
        let arrivals: Vec<_> = directions(SAMPLES)
            .map(|toward| Arrival {
                toward,
                irradiance: solid_angle * sky.radiance(toward),
                ray: Ray::new(middle, toward),
            })
            .collect();
        let (irradiance, blocked) = self.sum(&arrivals, up);
        let mean = arrivals.iter().map(|a| a.irradiance).sum::<Rgb>() / (2.0 * TAU) as f32;
        Entry {
            name: "environment".into(),
            kind: "environment",
            written: self.description.environment.as_ref().map_or(String::new(), written_sky),
            power: None,
            intensity: None,
            radiance: Some(mean),
            irradiance,
            blocked,
        }
    }

    fn surfaces(&self) -> Vec<Entry> {
        let mut parts = BTreeMap::<u32, Vec<&AreaLight>>::new();
        for light in self.scene.area_lights.iter() {
            parts.entry(light.surface).or_default().push(light);
        }
        parts.into_iter().map(|(surface, parts)| self.surface(surface, &parts)).collect()
    }

    fn surface(&self, surface: u32, parts: &[&AreaLight]) -> Entry {
        let area: f64 = parts.iter().map(|part| part.shape.area()).sum();
        let (mut mean, mut arrivals) = (Rgb::ZERO, Vec::new());
        // Each part gets samples, however many there are; a single one many.
        let each = (SAMPLES / parts.len() as u32).clamp(1, SAMPLES / 4);
        for (number, light) in (0..).zip(parts) {
            let share = (light.shape.area() / area / f64::from(each)) as f32;
            for index in 0..each {
                let u = point(number, index);
                if let Some(sample) = light.sample(self.middle, u, None) {
                    let radiance = self.scene.emitted_by(light, sample, 0.0);
                    let ray = sample.shadow_ray(self.middle.as_vec3(), 0.0, light.error);
                    let irradiance = radiance / (sample.pdf * f64::from(each)) as f32;
                    let toward = sample.incoming.as_vec3();
                    arrivals.push(Arrival { toward, irradiance, ray });
                }
                mean += share * self.radiance(light, u);
            }
        }
        let (irradiance, blocked) = self.sum(&arrivals, Vec3::ZERO);
        let sides = if parts[0].two_sided { 2.0 } else { 1.0 };
        let Surface { name, material, .. } = &self.description.surfaces[surface as usize];
        Entry {
            name: name.clone(),
            kind: "surface",
            written: written_emission(&self.description.materials[*material]),
            power: Some(mean * (sides * PI * area) as f32),
            intensity: None,
            radiance: Some(mean),
            irradiance,
            blocked,
        }
    }

    /// Radiance somewhere on the front of a light.
    fn radiance(&self, light: &AreaLight, u: DVec2) -> Rgb {
        let (bounds, _) = light.shape.extent(light.two_sided);
        let (lo, hi) = (bounds.lo.as_dvec3(), bounds.hi.as_dvec3());
        let away = (hi - lo).length() + 1e-3;
        // From four sides, one of which sees the front.
        let corners = [
            DVec3::new(1.0, 1.0, 1.0),
            DVec3::new(-1.0, -1.0, 1.0),
            DVec3::new(-1.0, 1.0, -1.0),
            DVec3::new(1.0, -1.0, -1.0),
        ];
        let seen =
            corners.iter().find_map(|side| light.sample(0.5 * (lo + hi) + away * *side, u, None));
        seen.map_or(Rgb::ZERO, |sample| self.scene.emitted_by(light, sample, 0.0))
    }
}

/// What a material's file says that it emits.
fn written_emission(material: &Material) -> String {
    let [r, g, b, _] = material.emission.factor;
    match material.written.as_str() {
        "" => units::format(r.max(g).max(b).into(), RADIANCE),
        written => written.into(),
    }
}

/// What a scene says of its environment: radiance, or what a picture or sky is multiplied by.
fn written_sky(environment: &EnvironmentDescription) -> String {
    let factor = f64::from(environment.factor.max_element());
    match environment.sky {
        Sky::Uniform | Sky::Cie { .. } => units::format(factor, RADIANCE),
        Sky::Gradient { .. } => format!("gradient × {factor}"),
        Sky::Picture { .. } => format!("picture × {factor}"),
        Sky::Clear { .. } => format!("sky × {factor}"),
    }
}

/// Power (W) and greatest intensity (W·sr⁻¹) of a light that is somewhere.
fn flux(light: &Described) -> (Option<Rgb>, Option<Rgb>) {
    let whole = (4.0 * PI) as f32;
    match light {
        Described::Point { intensity, .. }
        | Described::Camera { amount: CameraLightAmount::Intensity(intensity) } => {
            (Some(whole * *intensity), Some(*intensity))
        }
        Described::Spot { intensity, inner_angle, outer_angle, falloff, .. } => {
            let angle = spot_solid_angle(*inner_angle, *outer_angle, *falloff);
            (Some(angle as f32 * *intensity), Some(*intensity))
        }
        Described::Photometric { web, factor, .. } => {
            (Some(web.flux() as f32 * *factor), Some(web.brightest() * *factor))
        }
        _ => (None, None),
    }
}

/// The solid angle that a spot would fill if it were as bright everywhere as on its axis, sr: 2π ∫ share d cos.
/// Between the angles, the ramp t from cos outer to cos inner is squared (∫ t² = 1/3) or smoothed (∫ 3t² − 2t³ = 1/2).
fn spot_solid_angle(inner: f64, outer: f64, falloff: SpotFalloff) -> f64 {
    let between = inner.cos() - outer.cos();
    let ramp = match falloff {
        SpotFalloff::Gltf => 1.0 / 3.0,
        SpotFalloff::Smoothstep => 0.5,
    };
    TAU * (1.0 - inner.cos() + ramp * between)
}

/// Evenly spread directions (a Fibonacci spiral).
fn directions(count: u32) -> impl Iterator<Item = Vec3> {
    let golden = PI * (3.0 - 5_f64.sqrt());
    (0..count).map(move |i| {
        let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(count);
        let (sin, cos) = (golden * f64::from(i)).sin_cos();
        let ring = (1.0 - z * z).sqrt();
        DVec3::new(ring * cos, ring * sin, z).as_vec3()
    })
}

/// Two numbers in 0..1: evenly spread with `index`, others for each `number`.
fn point(number: u64, index: u32) -> DVec2 {
    let shift = hash(number);
    let unit = |bits: u64| (bits & 0xFFFF_FFFF) as f64 / 4_294_967_296.0;
    let spread = crate::sampler::Sampler::unscrambled(index).as_dvec2();
    (spread + DVec2::new(unit(shift), unit(shift >> 32))).fract()
}
