//! The lecture's two cures for acne, where they take away shadows.

use super::probes::Witness;
use super::tally::Answer;
use super::{Doctor, finding, percent};
use crate::diagnostic::Diagnostic;
use crate::geometry::Ray;
use crate::scene::description::{Integrator, Shadows};
use crate::scene::light_middle;
use crate::units;

/// Lights that are asked.
const LIGHTS: usize = 32;
/// The part of all shadows that may be lost without a word, and of how many.
const LOST: f64 = 0.1;
const ENOUGH: usize = 4;

impl Doctor<'_> {
    /// An epsilon that is larger than the distance between what casts shadows and what they fall on.
    pub(super) fn lost_shadows(&self) -> Option<Diagnostic> {
        let (name, epsilon) = match self.description.shadows {
            Shadows::TRange { epsilon } => ("t_range", epsilon),
            Shadows::MovedStart { epsilon } => ("moved_start", epsilon),
            _ => return None,
        };
        if self.description.integrator != Integrator::Direct {
            return None;
        }
        let robust = self.shadow_rays(|witness| *witness, 0.0);
        let cured = match name {
            "t_range" => self.shadow_rays(|witness| *witness, epsilon as f32),
            _ => self.shadow_rays(|witness| moved(witness, epsilon as f32), 0.0),
        };
        let (right, told) = (self.stops(&robust), self.stops(&cured));
        let shadows = right.iter().filter(|hit| hit.is_some()).count();
        let is_lost = right.iter().zip(&told).filter(|(a, b)| a.is_some() && !b.is_some());
        let part = is_lost.count() as f64 / shadows.max(1) as f64;
        (part > LOST && shadows >= ENOUGH).then(|| {
            let message = format!(
                "{} of the shadows that are seen are lost: the epsilon of {name}, {}, is further than to what casts them",
                percent(part),
                units::format(epsilon, "m")
            );
            let help = "\"robust\" needs none; otherwise, make it as small as \"1 mm\"";
            finding("shadows-epsilon", "shadows".into(), message).help(help)
        })
    }

    /// Shadow rays from what the camera sees, each from where `start` puts it, in ranges from `t_min`.
    fn shadow_rays(&self, start: impl Fn(&Witness) -> Witness, t_min: f32) -> Vec<Ray> {
        let lights = self.description.lights.iter();
        let lights: Vec<_> =
            lights.filter_map(|l| light_middle(l, self.scene.camera())).take(LIGHTS).collect();
        let to_all = |witness: &Witness| {
            let from = start(witness);
            let rays = lights.iter().map(move |light| match Self::ask_light(light, &from) {
                Answer::Ray(ray) => Some(Ray { t_min: t_min.min(ray.t_max), ..ray }),
                _ => None,
            });
            rays.collect::<Vec<_>>()
        };
        // One for each light and point, so that two ways of asking can be compared.
        let nowhere = |ray: Option<Ray>| ray.unwrap_or(NOWHERE);
        self.probes.seen().flat_map(to_all).map(nowhere).collect()
    }
}

/// A ray without length, where a light has nothing to say.
const NOWHERE: Ray =
    Ray { origin: glam::Vec3::ZERO, direction: glam::Vec3::Z, t_min: 0.0, t_max: 0.0, time: 0.0 };

/// The point with its shadow rays moved along the normal.
fn moved(witness: &Witness, epsilon: f32) -> Witness {
    Witness { start: witness.start + epsilon * witness.normal, ..*witness }
}
