//! Lights that give nothing, or nothing to anything that is seen.

use super::probes::Witness;
use super::tally::{Ask, Tally, turned};
use super::{Care, Doctor, finding, named, percent};
use crate::color::Rgb;
use crate::diagnostic::Diagnostic;
use crate::geometry::Ray;
use crate::scene::description::{
    EnvironmentDescription, Integrator, Light as Described, LightDescription, Material, Medium,
    SceneDescription, Sky, Texels,
};
use crate::scene::light_middle;
use crate::shading::light::area::AreaLight;
use crate::units::{self, Dimension};
use glam::DVec3;
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};

/// Lights of a scene that are looked at before every render.
const FIRST_LIGHTS: usize = 64;
/// Ten suns, about: what no parallel light gives, lx.
const BRIGHTEST: f64 = 1e6;
/// Directions in which a light is asked what is around it.
const AROUND: u32 = 64;
/// The part of them that has to meet one surface for that to be around it.
const MOST: f64 = 0.9;
/// Sine of the angle under which light comes along a surface, and points of one that say so.
const GRAZING: f64 = 1e-6;
const MANY: u32 = 8;
/// The part of what is seen that may lie inside of a light's sphere.
const INSIDE: f64 = 0.1;

/// A word if no light and no emission can reach anything there is.
pub fn none(scene: &SceneDescription) -> Option<Diagnostic> {
    let dark = scene.lights.is_empty()
        && scene.environment.is_none()
        && !brings_light(&scene.integrator)
        && !scene.surfaces.iter().any(|surface| scene.materials[surface.material].emits());
    (dark && !scene.surfaces.is_empty()).then(|| {
        let message = "there are no lights, and nothing emits light: all surfaces are black";
        let help =
            "add a light, such as -D 'lights.head.camera.irradiance=3' for one at the camera";
        Diagnostic::new("", message).help(help).code("no-lights")
    })
}

/// Whether an integrator shows surfaces by a light of its own.
fn brings_light(integrator: &Integrator) -> bool {
    matches!(integrator, Integrator::AmbientOcclusion { .. } | Integrator::Clarity { .. })
}

/// Why nothing gets a light's light.
struct Reason {
    code: &'static str,
    why: String,
    /// What helps.
    help: &'static str,
}

impl Reason {
    fn message(&self) -> String {
        format!("nothing that the camera sees gets any of its light: {}", self.why)
    }
}

impl Doctor<'_> {
    /// Everything that is odd about the lights.
    pub(super) fn lights(&self, care: Care) -> Vec<Diagnostic> {
        let count = if care == Care::Quick { FIRST_LIGHTS } else { usize::MAX };
        let lights = &self.description.lights;
        let shining = || lights.iter().filter(|light| !is_off(light)).take(count);
        let mut found: Vec<_> = shining().filter_map(|light| self.too_bright(light)).collect();
        found.extend(shining().filter_map(|light| self.too_wide(light)));
        found.extend(shining().filter_map(|light| self.lies_in(light)));
        if care == Care::Thorough {
            found.extend(lights.iter().filter(|light| is_off(light)).map(off));
            found.extend(factor(lights));
        }
        if brings_light(&self.description.integrator) {
            return found;
        }
        let unreached: Vec<_> = shining().filter_map(|light| self.unreached(light)).collect();
        let some_reach = unreached.len() < shining().count();
        found.extend(unreached);
        found.extend(self.emitters(some_reach, count));
        found.extend(self.environment(some_reach && care == Care::Quick));
        found
    }

    fn too_bright(&self, described: &LightDescription) -> Option<Diagnostic> {
        let (dimension, value) = described.light.quantity();
        let lux = units::photometric(value, self.description.luminous_efficacy.0);
        let bright = dimension == Dimension::Irradiance && lux > BRIGHTEST;
        bright.then(|| {
            let number = value.max_element();
            let lux = units::format(lux, "lx");
            let message = format!("{number} W/m² are {lux}; the sun gives 0.1 Mlx");
            light_finding("light-units", described, message)
                .help(format!("if it was meant as seen, write irradiance = \"{number} lx\""))
        })
    }

    /// A lamp that lies in the plane of a surface that is seen: light that grazes gives nothing.
    fn lies_in(&self, described: &LightDescription) -> Option<Diagnostic> {
        let position = described.light.position()?;
        let grazes = |witness: &Witness| {
            let to_light = position - witness.position;
            to_light.dot(witness.normal.as_dvec3()).abs() < GRAZING * to_light.length()
        };
        let mut counts = BTreeMap::<u32, [u32; 2]>::new();
        for witness in self.probes.seen() {
            let [all, grazed] = counts.entry(witness.surface).or_default();
            *all += 1;
            *grazed += u32::from(grazes(witness));
        }
        let (surface, _) =
            counts.into_iter().find(|(_, [all, grazed])| all == grazed && *all >= MANY)?;
        let message = format!(
            "lies in surface {}, and gives it nothing: its light goes along it",
            self.quoted(surface)
        );
        Some(
            light_finding("light-in-surface", described, message)
                .help("move it off the surface by as much as a lamp is high"),
        )
    }

    pub(super) fn too_wide(&self, described: &LightDescription) -> Option<Diagnostic> {
        let position = described.light.position().filter(|_| described.radius > 0.0)?;
        let inside = |at: DVec3| at.distance(position) < described.radius;
        let inside = self.probes.seen().filter(|witness| inside(witness.position)).count();
        let part = inside as f64 / self.probes.seen().count().max(1) as f64;
        (part > INSIDE).then(|| {
            let (part, radius) = (percent(part), units::format(described.radius, "m"));
            let message = format!(
                "{part} of what the camera sees is inside of its sphere of radius {radius}, where it gives nothing"
            );
            let help = format!("make it smaller{}", change(described, "radius=\"5 cm\""));
            light_finding("light-radius", described, message).help(help)
        })
    }

    /// What keeps a light from everything that is seen.
    fn unreached(&self, described: &LightDescription) -> Option<Diagnostic> {
        let light = light_middle(described, self.scene.camera())?;
        let witnesses = &self.probes.witnesses;
        let ask: &Ask<'_> = &|witness, _| Self::ask_light(&light, witness);
        let tally = self.reach(ask, witnesses);
        if tally.lit > 0 || witnesses.is_empty() {
            return None;
        }
        let enclosed = self.enclosed(described);
        enclosed.or_else(|| (!self.has_fog()).then(|| self.kept_off(described, &tally)))
    }

    /// Whether light may be seen on its way, whatever it reaches.
    fn has_fog(&self) -> bool {
        let scatters = |medium: Medium| medium.scattering != Rgb::ZERO;
        let materials = &self.description.materials;
        self.description.medium.is_some_and(scatters) || materials.iter().any(Material::is_cloudy)
    }

    /// A light that one surface is all around of.
    pub(super) fn enclosed(&self, described: &LightDescription) -> Option<Diagnostic> {
        let position = described.light.position().filter(|_| described.shadows)?;
        let hits = self.stops(&around(position).collect::<Vec<_>>());
        let mut counts = BTreeMap::new();
        for hit in hits.iter().filter(|hit| hit.is_some()) {
            let (count, nearest) = counts.entry(hit.surface).or_insert((0, f32::INFINITY));
            (*count, *nearest) = (*count + 1, nearest.min(hit.t));
        }
        let (surface, (count, nearest)) =
            counts.into_iter().max_by_key(|(_, (count, _))| *count)?;
        let enclosed = hits.iter().all(|hit| hit.is_some());
        (enclosed && f64::from(count) >= MOST * f64::from(AROUND)).then(|| {
            let message = format!(
                "is inside of surface {}, {} from it: nothing that the camera sees gets any of its light",
                self.quoted(surface),
                units::format(nearest.into(), "m")
            );
            let help = format!(
                "move it outside, or let it shine through{}",
                change(described, "shadows=false")
            );
            light_finding("light-inside", described, message).help(help)
        })
    }

    /// A light that is kept off by what is in the way, or by where it shines.
    fn kept_off(&self, described: &LightDescription, tally: &Tally) -> Diagnostic {
        let why = self.reason(tally);
        light_finding(why.code, described, why.message()).help(self.remedy(described, &why))
    }

    /// Why nothing gets a light's light.
    fn reason(&self, tally: &Tally) -> Reason {
        let (code, why, help) = match tally.outside > tally.averted {
            _ if 2 * tally.stopped() >= tally.points() => (
                "light-blocked",
                format!("{} in its way", self.blockers(tally)),
                "move it, or what is in its way",
            ),
            true => (
                "light-averted",
                "it shines past all of it".into(),
                "aim it at what is seen, or widen its beam",
            ),
            false => (
                "light-averted",
                "all of it faces away from the light".into(),
                "move it to the side that the camera sees",
            ),
        };
        Reason { code, why, help }
    }

    /// What blocks most, by name: `surface "roof" is`.
    fn blockers(&self, tally: &Tally) -> String {
        let mut blockers: Vec<_> = tally.blocked.iter().collect();
        blockers.sort_by_key(|&(surface, count)| (std::cmp::Reverse(*count), *surface));
        let names: Vec<_> = blockers.iter().take(2).map(|(s, _)| self.quoted(**s)).collect();
        let nearly_all =
            blockers.first().is_some_and(|(_, count)| 10 * **count >= 9 * tally.stopped());
        match (&names[..if nearly_all { 1 } else { names.len() }], blockers.len()) {
            ([one], _) => format!("surface {one} is"),
            (names, 2) => format!("surfaces {} are", names.join(" and ")),
            (names, more) => format!("surfaces {} and {} more are", names.join(", "), more - 2),
        }
    }

    /// What helps a light that is kept off for this reason.
    fn remedy(&self, described: &LightDescription, why: &Reason) -> String {
        let around = turned(described).filter(|turned| {
            let light = light_middle(turned, self.scene.camera());
            light.is_some_and(|light| {
                let ask: &Ask<'_> = &|witness, _| Self::ask_light(&light, witness);
                self.reach(ask, &self.probes.witnesses).lit > 0
            })
        });
        match around.map(|turned| turned.light) {
            Some(
                Described::Spot { direction, .. }
                | Described::Directional { direction, .. }
                | Described::Sun { direction, .. },
            ) => {
                let direction = direction / direction.abs().max_element();
                let [x, y, z] = direction.to_array().map(|x| (x * 1e3).round() / 1e3 + 0.0);
                format!("turn it around: direction = [{x}, {y}, {z}]")
            }
            _ if why.code == "light-blocked" => {
                format!("{}{}", why.help, change(described, "shadows=false"))
            }
            _ => why.help.into(),
        }
    }

    /// Surfaces that are lights: declared ones that light nothing; others only if nothing else does.
    fn emitters(&self, others_reach: bool, count: usize) -> Vec<Diagnostic> {
        let description = self.description;
        let off = description.surfaces.iter().filter(|surface| {
            let material = &description.materials[surface.material];
            !material.emits_behind && !material.emits()
        });
        let off = off.map(|surface| {
            let message = "is said to be a light, and gives none";
            finding("emitter-off", named("surface", &surface.name), message)
                .help("give it a power, exitance or radiance above 0, or leave out its light")
        });
        let mut found: Vec<_> = off.collect();
        let mut parts: BTreeMap<u32, Vec<&AreaLight>> = BTreeMap::new();
        for light in self.scene.area_lights.iter() {
            parts.entry(light.surface).or_default().push(light);
        }
        let dark: Vec<_> =
            parts.iter().take(count).filter_map(|(s, p)| self.unlit(*s, p)).collect();
        let none_reach = !others_reach && dark.len() == parts.len();
        let declared = |(surface, _): &(u32, Diagnostic)| {
            let surface = &description.surfaces[*surface as usize];
            !description.materials[surface.material].emits_behind
        };
        let told = dark.into_iter().filter(|dark| none_reach || declared(dark));
        found.extend(told.map(|(_, diagnostic)| diagnostic));
        found
    }

    /// What keeps the light of a surface from everything that is seen, the surface itself included.
    fn unlit(&self, surface: u32, parts: &[&AreaLight]) -> Option<(u32, Diagnostic)> {
        let shows =
            |witness: &Witness| witness.surface == surface && (witness.front || parts[0].two_sided);
        let witnesses = &self.probes.witnesses;
        if witnesses.is_empty() || witnesses.iter().any(shows) || self.has_fog() {
            return None;
        }
        let ask: &Ask<'_> = &|witness, number| Self::ask_emitter(parts, witness, number);
        let tally = self.reach(ask, witnesses);
        if tally.lit > 0 {
            return None;
        }
        let why = self.reason(&tally);
        let help = match why.code == "light-averted" && !parts[0].two_sided {
            true => "its front alone gives light: turn it, or set two_sided = true in its light",
            false => why.help,
        };
        Some((surface, finding(why.code, self.surface(surface), why.message()).help(help)))
    }

    /// An environment that is black, or that nothing sees.
    fn environment(&self, others_reach: bool) -> Option<Diagnostic> {
        let environment = self.description.environment.as_ref()?;
        if is_black(environment) {
            let message = "gives nothing: all of it is black";
            let help = "give it a strength above 0, or another picture";
            return Some(finding("environment-black", "environment".into(), message).help(help));
        }
        let blocked = !self.probes.witnesses.is_empty() && self.probes.escaped == 0;
        (blocked && !others_reach).then(|| {
            let message = format!(
                "nothing that the camera sees gets any of its light: all {} rays to it end at surfaces, most at {}",
                self.probes.witnesses.len(),
                self.most_met()
            );
            let help = "open what encloses the scene, take it away, or put lights inside";
            finding("light-blocked", "environment".into(), message).help(help)
        })
    }

    /// The surface that most witnesses are on.
    fn most_met(&self) -> String {
        let mut counts = BTreeMap::<u32, u32>::new();
        for witness in &self.probes.witnesses {
            *counts.entry(witness.surface).or_default() += 1;
        }
        let most = counts.into_iter().max_by_key(|(_, count)| *count);
        most.map_or(String::new(), |(surface, _)| self.quoted(surface))
    }
}

/// Rays in evenly spread directions (a Fibonacci spiral).
fn around(from: DVec3) -> impl Iterator<Item = Ray> {
    let golden = TAU * (1.0 - 1.0 / ((1.0 + 5_f64.sqrt()) / 2.0));
    (0..AROUND).map(move |i| {
        let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(AROUND);
        let (sin, cos) = (golden * f64::from(i)).sin_cos();
        let ring = (1.0 - z * z).sqrt();
        Ray::new(from.as_vec3(), DVec3::new(ring * cos, ring * sin, z).as_vec3())
    })
}

/// Whether a light gives nothing.
pub(super) fn is_off(described: &LightDescription) -> bool {
    described.light.quantity().1.max_element() <= 0.0
}

fn off(described: &LightDescription) -> Diagnostic {
    let message = "gives nothing: its strength or its color is 0";
    light_finding("light-off", described, message).help("give it more than 0, or leave it out")
}

/// Two lights that differ by just the factor that is forgotten or taken twice: 683 lm/W, 4π sr, or both.
fn factor(lights: &[LightDescription]) -> Option<Diagnostic> {
    let factors = [
        (683.0, "683, the lumens of a watt"),
        (4.0 * PI, "4π, the steradians of a sphere"),
        (683.0 / (4.0 * PI), "683/4π, the candela of a watt that shines everywhere"),
    ];
    let lights = &lights[..lights.len().min(FIRST_LIGHTS)];
    let pairs = lights
        .iter()
        .enumerate()
        .flat_map(|(i, a)| lights.iter().take(i).flat_map(move |b| [(a, b), (b, a)]));
    let found = pairs.filter_map(|(more, less)| {
        let ((dimension, a), (other, b)) = (more.light.quantity(), less.light.quantity());
        let ratio = f64::from(a.max_element()) / f64::from(b.max_element());
        let is_near = |factor: f64| (ratio / factor - 1.0).abs() < 2e-6;
        let (_, name) = factors.iter().find(|(f, _)| dimension == other && is_near(*f))?;
        Some((more, less, name))
    });
    let (more, less, name) = { found }.next()?;
    let message = format!("gives {:?} times {name}", less.name);
    Some(
        light_finding("light-factor", more, message)
            .help("write both with their units, such as power = \"60 W\" or \"800 lm\""),
    )
}

fn is_black(environment: &EnvironmentDescription) -> bool {
    let black = |color: &Rgb| color.max_element() <= 0.0;
    let sky = match &environment.sky {
        Sky::Gradient { zenith, horizon, nadir } => [zenith, horizon, nadir].into_iter().all(black),
        Sky::Picture { pixels, .. } => match &pixels.texels {
            Texels::Srgb8(texels) => texels.iter().all(|texel| texel[..3] == [0; 3]),
            Texels::Srgb16(texels) => texels.iter().all(|texel| texel[..3] == [0; 3]),
            Texels::Linear(texels) => {
                texels.iter().all(|texel| texel[..3].iter().all(|x| *x <= 0.0))
            }
        },
        Sky::Uniform | Sky::Cie { .. } | Sky::Clear { .. } => false,
    };
    sky || black(&environment.factor)
}

fn light_finding(
    code: &'static str,
    described: &LightDescription,
    message: impl Into<String>,
) -> Diagnostic {
    finding(code, named("light", &described.name), message)
}

/// How a light of the scene file is changed on the command line; nothing for those of models.
fn change(described: &LightDescription, set: &str) -> String {
    let LightDescription { name, light, .. } = described;
    let plain =
        !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-');
    match plain {
        true => format!(", such as by -D lights.{name}.{}.{set}", light.kind()),
        false => String::new(),
    }
}
