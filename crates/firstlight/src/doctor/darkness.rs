//! Why what is seen is dark: which lights there are, and what stands in their way.

use super::lights::is_off;
use super::probes::Witness;
use super::tally::{Ask, Tally};
use super::{Doctor, named, percent};
use crate::scene::description::{Integrator, LightDescription, Projection};
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
        if let Integrator::Path { bounces: Some(0) } = self.description.integrator {
            return (
                ": the integrator path has 0 bounces, and shows nothing but what shines itself"
                    .into(),
                "give it more, or leave the number out: it is followed as far as it counts".into(),
            );
        }
        let tally = self.reached(points);
        self.blocked(&tally).unwrap_or_else(|| self.say(&tally, points.first().copied()))
    }

    /// What stands in the way of most of the light to these points, as [`Doctor::why_dark`] has it.
    pub(super) fn in_the_way(&self, points: &[&Witness]) -> Option<(String, String)> {
        self.blocked(&self.reached(points))
    }

    /// Which lights reach these points.
    fn reached(&self, points: &[&Witness]) -> Tally {
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

    fn say(&self, tally: &Tally, first: Option<&Witness>) -> (String, String) {
        let asked = f64::from(tally.points().max(1));
        match first {
            _ if tally.points() == 0 => {
                (String::new(), "add a light, or move the lights there are".into())
            }
            Some(first) if self.is_lost_in_fog(first) => (
                ": light arrives, and medium lets next to none of it through to the camera".into(),
                "give medium a smaller extinction: it is what is lost per metre".into(),
            ),
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
                (
                    format!(": {part} of what is dark is outside of where the lights shine"),
                    "aim the lights at it, or widen their outer_angle".into(),
                )
            }
        }
    }

    /// Whether next to nothing of the light from a point gets through to the camera.
    fn is_lost_in_fog(&self, point: &Witness) -> bool {
        let length = self.probes.rays[point.probe].hit.t;
        let passes = self.description.medium.map(|medium| medium.transmittance(length));
        passes.is_some_and(|passes| passes.max_element() < NOTHING)
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

    /// How much the strongest light gives, in both measures, for those who have mistaken one for the other.
    pub(super) fn strongest(&self) -> String {
        let lights = self.description.lights.iter();
        let strength = |light: &&LightDescription| light.light.quantity().1.max_element();
        let Some(light) = lights.max_by(|a, b| strength(a).total_cmp(&strength(b))) else {
            return String::new();
        };
        let (mut dimension, mut value) = light.light.quantity();
        if light.light.kind() == "point" {
            (dimension, value) = (Dimension::Power, value * (4.0 * PI) as f32);
        }
        let seen = units::photometric(value, self.description.luminous_efficacy.0);
        let energy =
            units::format(value.max_element().into(), units::unit(dimension, Measure::Radiometric));
        let seen = units::format(seen, units::unit(dimension, Measure::Photometric));
        format!(" ({} gives {energy}, which is seen as {seen})", named("light", &light.name))
    }
}
