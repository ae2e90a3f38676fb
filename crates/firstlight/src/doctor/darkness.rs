//! Why what is seen is dark: which lights there are, and what stands in their way.

use super::lights::is_off;
use super::probes::Witness;
use super::tally::{Ask, Tally};
use super::{Doctor, named, percent};
use crate::color::Rgb;
use crate::scene::description::{
    EnvironmentDescription, Integrator, Light, LightDescription, Projection, Shape, Surface,
};
use crate::scene::light_middle;
use crate::units::{self, Dimension, Measure};
use std::f64::consts::PI;

/// Lights that are asked.
const LIGHTS: usize = 32;
/// The part of light that might as well be none.
const NOTHING: f32 = 1e-4;

impl Doctor<'_> {
    /// Why these points are dark, to be added to a sentence that says that they are; and what helps.
    pub(super) fn why_dark(&self, points: &[&Witness]) -> (String, String) {
        let lights = &self.description.lights;
        if let Some(off) =
            lights.iter().find(|light| is_off(light)).filter(|_| lights.iter().all(is_off))
        {
            let name = named("light", &off.name);
            return (
                format!("; {name} gives nothing"),
                "give it more than 0, or add a light".into(),
            );
        }
        if let Some(light) = lights.iter().find(|light| self.too_wide(light).is_some()) {
            let name = named("light", &light.name);
            return (
                format!("; it is inside of the sphere of {name}, where that gives nothing"),
                "make its radius smaller".into(),
            );
        }
        if let Integrator::Path { bounces: Some(0) } = self.description.integrator {
            return (
                ": the integrator path has 0 bounces, and shows nothing but what shines itself"
                    .into(),
                "give it more, or leave the number out: it is followed as far as it counts".into(),
            );
        }
        if let Some(light) =
            lights.iter().find(|_| lights.iter().all(LightDescription::is_near_ambient))
        {
            let name = named("light", &light.name);
            return (
                format!(
                    "; surfaces all around are nearer than the reach of ambient {name}, and keep it out"
                ),
                "give it a smaller reach: it is ambient light for corners to be dark, not rooms"
                    .into(),
            );
        }
        let enclosed = |light: &LightDescription| self.enclosed(light).is_some();
        if let Some(light) = lights.iter().find(|_| lights.iter().all(enclosed)) {
            let name = named("light", &light.name);
            return (
                format!("; {name} is inside of something"),
                "move it outside, or take its shadows".into(),
            );
        }
        let tally = self.reached(points);
        self.blocked(&tally).unwrap_or_else(|| self.say(&tally, points))
    }

    /// What stands in the way of most of the light to these points, as [`Doctor::why_dark`] has it.
    pub(super) fn in_the_way(&self, points: &[&Witness]) -> Option<(String, String)> {
        self.blocked(&self.reached(points))
    }

    /// Which lights reach these points.
    pub(super) fn reached(&self, points: &[&Witness]) -> Tally {
        let points: Vec<Witness> = points.iter().map(|point| **point).collect();
        let lights = &self.description.lights;
        let mut tally = Tally::default();
        for light in lights.iter().filter_map(|l| light_middle(l, self.scene.camera())).take(LIGHTS)
        {
            let ask: &Ask<'_> = &|witness, _| Self::ask_light(&light, witness);
            tally.add(&self.tally(ask, &points));
        }
        tally
    }

    fn blocked(&self, tally: &Tally) -> Option<(String, String)> {
        let (surface, count) = tally.blocked.iter().max_by_key(|(_, count)| **count)?;
        (4 * *count >= tally.points() && *count > tally.lit).then(|| {
            let part = match f64::from(*count) / f64::from(tally.points()) {
                1.0 => "every shadow ray hits".into(),
                part => format!("{} of the shadow rays hit", percent(part)),
            };
            let name = self.quoted(*surface);
            if self.is_looked_through(*surface) {
                return (
                    format!(": {part} {name}, through whose back the camera looks in"),
                    format!("use light that comes with the camera: {}", self.light_at_the_eye()),
                );
            }
            (
                format!(": {part} {name}"),
                format!("move {name} or the lights, or let light through it"),
            )
        })
    }

    fn say(&self, tally: &Tally, points: &[&Witness]) -> (String, String) {
        let first = points.first().copied();
        let asked = f64::from(tally.points().max(1));
        match first {
            _ if tally.points() == 0 => {
                (String::new(), "add a light, or move the lights there are".into())
            }
            Some(first) if self.is_lost_in_fog(first) => (
                ": medium lets next to none of it through".into(),
                "give medium a smaller extinction: it is what is lost per metre".into(),
            ),
            Some(first) if self.interior(first).is_some() => {
                let name = self.interior(first).unwrap_or_default();
                (
                    format!(": {name} lets next to none of it through"),
                    "give it a smaller absorption, or less depth: it is what is lost per metre"
                        .into(),
                )
            }
            Some(first) if 2 * tally.lit >= tally.points() => {
                let material = self.description.surfaces[first.surface as usize].material;
                let name = named("material", &self.description.materials[material].name);
                (
                    format!(": light arrives, and {name} sends next to none of it to the camera"),
                    "give it a brighter color; in metal and glass only what stands around is seen"
                        .into(),
                )
            }
            _ if tally.averted >= tally.outside => {
                let part = percent(f64::from(tally.averted) / asked);
                (
                    format!(": {part} of what is dark faces away from the lights"),
                    self.the_other_side(),
                )
            }
            _ => {
                let part = percent(f64::from(tally.outside) / asked);
                let is_spot = |l: &LightDescription| matches!(l.light, Light::Spot { .. });
                let wider = match self.description.lights.iter().any(is_spot) {
                    true => ", or widen their outer_angle",
                    false => "",
                };
                (
                    format!(": {part} of what is dark is outside of where the lights shine"),
                    format!("aim the lights at it{wider}"),
                )
            }
        }
    }

    /// Whether next to nothing of the light of any lamp gets through the medium to a point, and on to the camera.
    fn is_lost_in_fog(&self, point: &Witness) -> bool {
        let Some(medium) = self.description.medium else { return false };
        let to_camera = self.probes.rays[point.probe].hit.t;
        let lights = self.description.lights.iter();
        let lights = lights.filter(|light| !matches!(light.light, Light::Ambient { .. }));
        let from_light = lights.map(|described| match described.light {
            Light::Camera { .. } => to_camera,
            ref light => {
                light.position().map_or(f32::INFINITY, |at| at.distance(point.position) as f32)
            }
        });
        let nearest = from_light.reduce(f32::min).unwrap_or(0.0);
        medium.transmittance(to_camera + nearest).max_element() < NOTHING
    }

    /// The material of what is seen, if light is lost behind it.
    fn interior(&self, point: &Witness) -> Option<String> {
        let material = self.description.surfaces[point.surface as usize].material;
        let material = &self.description.materials[material];
        let interior = material.interior.filter(|interior| interior.absorption != Rgb::ZERO)?;
        (material.only_bounds() || interior.scattering == Rgb::ZERO)
            .then(|| named("material", &material.name))
    }

    /// The plane without end on whose back most of these points are, if there is one.
    pub(super) fn plane_before(&self, points: &[&Witness]) -> Option<u32> {
        let is_plane = |point: &&&Witness| {
            let shape = &self.description.surfaces[point.surface as usize].shape;
            matches!(shape, Shape::Plane(_)) && !point.front
        };
        let behind: Vec<_> = points.iter().filter(is_plane).collect();
        behind.first().filter(|_| 2 * behind.len() >= points.len()).map(|point| point.surface)
    }

    /// What lights whatever the camera sees.
    fn light_at_the_eye(&self) -> &'static str {
        match self.description.ground {
            Some(_) => "--headlight 1, or --look clarity",
            None => "-D lights.head.camera.irradiance=3, or --look clarity",
        }
    }

    fn the_other_side(&self) -> String {
        let parallel = self
            .description
            .cameras
            .first()
            .is_some_and(|camera| matches!(camera.projection, Projection::Orthographic { .. }));
        let light = if parallel {
            "another"
        } else {
            "one at the camera, -D lights.head.camera.irradiance=3"
        };
        format!("move the lights to where the camera is, or add {light}")
    }

    /// How much the strongest light gives, in both measures, for those who have mistaken one for the other. A surface that
    /// shines is as bright as a white one under π times its radiance.
    pub(super) fn strongest(&self) -> String {
        let Self { description, .. } = self;
        let of_light = |described: &LightDescription| {
            let (mut dimension, mut value) = described.light.quantity();
            if described.light.kind() == "point" {
                (dimension, value) = (Dimension::Power, value * (4.0 * PI) as f32);
            }
            (
                described.light.quantity().1.max_element(),
                named("light", &described.name),
                dimension,
                value,
            )
        };
        let of_surface = |surface: &Surface| {
            let material = &description.materials[surface.material];
            let [r, g, b, _] = material.emission.factor;
            let radiance = Rgb::new(r, g, b);
            let name = named("material", &material.name);
            (PI as f32 * radiance.max_element(), name, Dimension::Radiance, radiance)
        };
        let of_sky = |sky: &EnvironmentDescription| {
            let name = "the environment, by its strength,".to_owned();
            (PI as f32 * sky.factor.max_element(), name, Dimension::Radiance, sky.factor)
        };
        let all = description.lights.iter().map(of_light);
        let shines = |surface: &&Surface| description.materials[surface.material].is_light();
        let all = all.chain(description.surfaces.iter().filter(shines).map(of_surface));
        let all = all.chain(description.environment.iter().map(of_sky));
        let strongest =
            all.max_by(|a, b| a.0.total_cmp(&b.0)).filter(|strongest| strongest.0 > 0.0);
        let Some((_, name, dimension, value)) = strongest else { return String::new() };
        let seen = units::photometric(value, description.luminous_efficacy.0);
        let energy =
            units::format(value.max_element().into(), units::unit(dimension, Measure::Radiometric));
        let seen = units::format(seen, units::unit(dimension, Measure::Photometric));
        format!(" ({name} gives {energy}, which is seen as {seen})")
    }
}
