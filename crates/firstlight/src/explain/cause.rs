//! The last line of an explanation: why, in plain words.

use super::board::{Lighting, Met, Step, Verdict};
use super::sums::{Shadow, Term};
use super::{Shown, luminance_of};
use crate::integrator::Source;
use crate::units;
use serde::Serialize;

/// Up to this number in an 8-bit file a pixel is called dark.
const DARK: u8 = 40;
/// A surface that reflects less than this is called dark itself.
const BLACK_REFLECTANCE: f32 = 0.03;
/// What stands in the way of this many times the light that arrives is the cause of the dark.
const MUCH: f64 = 1.0;
/// The part of light that might as well be none.
const NOTHING: f32 = 1e-4;
/// A blocker that is the surface itself and nearer than this part of the distance from the eye is no blocker but a
/// rounding error.
const ITSELF: f64 = 1e-4;

/// Why a pixel is as it is.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Cause {
    /// One word for it, for programs: background, emission, no_light, blocked, acne, faces_away, outside_beam, inside_light,
    /// black_surface, medium, weak_light, too_bright, lit.
    pub kind: &'static str,
    /// A sentence.
    pub text: String,
}

/// What is known about a pixel.
pub(super) struct Evidence<'a> {
    pub terms: &'a [Term],
    pub shadows: &'a [Shadow],
    pub path: &'a [Step],
    pub shown: &'a Shown,
    /// The pixel's luminance, cd·m⁻².
    pub luminance: f64,
}

pub(super) fn cause(evidence: &Evidence<'_>) -> Cause {
    let first = evidence.path.first();
    let in_fog = first.is_some_and(|step| step.scattered_after.is_some());
    let Some(met) = first.and_then(|step| step.met.as_ref()) else {
        return if in_fog { evidence.lit("lit") } else { evidence.nothing_met() };
    };
    let is_dark = evidence.shown.code.iter().all(|code| *code <= DARK);
    let is_cut_off = evidence.shown.display.iter().all(|value| *value >= 1.0);
    match () {
        () if is_dark => evidence.dark(met, &evidence.path[0].lights),
        () if is_cut_off => evidence.too_bright(),
        () => evidence.lit("lit"),
    }
}

impl Evidence<'_> {
    fn nothing_met(&self) -> Cause {
        let text = match self.terms.first().map(|term| term.key.0) {
            Some(Source::Environment) => "this is the environment itself: no surface is here",
            Some(Source::Light(_)) => "this is a light itself: no surface is here",
            _ => "this is the background: no surface is here",
        };
        Cause { kind: "background", text: text.into() }
    }

    fn dark(&self, met: &Met, lights: &[Lighting]) -> Cause {
        let ambient = self.terms.iter().any(|term| term.key.0 == Source::Ambient);
        if lights.is_empty() && !ambient {
            let text = "dark because no light of the scene shines on surfaces".into();
            return Cause { kind: "no_light", text };
        }
        if let Some(shadow) = self.shadows.first().filter(|shadow| self.counts(shadow)) {
            return self.blocked(met, shadow);
        }
        let reflected = met.values.first().map_or(1.0, |value| most(&value.value));
        if reflected < BLACK_REFLECTANCE {
            let Met { surface, material, .. } = met;
            let percent = 100.0 * reflected;
            let text = format!(
                "dark because '{surface}' ({material}) reflects {percent:.1} % of light at most"
            );
            return Cause { kind: "black_surface", text };
        }
        self.unlit(lights).unwrap_or_else(|| self.weak(lights))
    }

    /// Whether a shadow takes more than arrives.
    fn counts(&self, shadow: &Shadow) -> bool {
        let arrives: f64 = self.terms.iter().map(|term| luminance_of(term.radiance)).sum();
        shadow.blocked > 0 && shadow.lost_radiance > MUCH * arrives
    }

    fn blocked(&self, met: &Met, shadow: &Shadow) -> Cause {
        let (blocker, distance) =
            (shadow.blocker.as_deref().unwrap_or_default(), shadow.distance.unwrap_or(0.0));
        let Shadow { source, .. } = shadow;
        let away = units::format(distance, "m");
        if blocker == met.surface && distance < ITSELF * f64::from(met.distance) {
            let text = format!(
                "dark because of a rounding error: '{blocker}' blocks light '{source}' from itself, {away} from the \
                 point; shadows = \"robust\" cures it"
            );
            return Cause { kind: "acne", text };
        }
        let by = if blocker == met.surface {
            format!("'{blocker}' itself")
        } else {
            format!("'{blocker}'")
        };
        let others = self.shadows[1..].iter().filter(|other| other.blocked > 0).count();
        let more = match others {
            0 => String::new(),
            1 => ", and so is one other".into(),
            n => format!(", and so are {n} others"),
        };
        let text = format!(
            "dark because light '{source}' is blocked by {by} {away} from the surface{more}"
        );
        Cause { kind: "blocked", text }
    }

    /// Dark for no other reason than where it faces.
    fn unlit(&self, lights: &[Lighting]) -> Option<Cause> {
        if !self.terms.iter().all(|term| luminance_of(term.radiance) <= 0.0) {
            return None;
        }
        let nearest = lights.first()?;
        let source = &nearest.source;
        let all = |verdict: Verdict| lights.iter().all(|light| light.verdict == verdict);
        let rest = if lights.len() > 1 { " and from all other lights" } else { "" };
        let gives_nothing = |light: &Lighting| {
            use Verdict::{FacesAway, InsideOfIt, OutsideBeam};
            matches!(light.verdict, FacesAway | OutsideBeam | InsideOfIt)
        };
        let around = lights.iter().find(|light| light.verdict == Verdict::InsideOfIt);
        if let Some(Lighting { source, .. }) = around.filter(|_| lights.iter().all(gives_nothing)) {
            let text = format!(
                "dark because it is inside of the sphere of light '{source}', where that gives nothing"
            );
            return Some(Cause { kind: "inside_light", text });
        }
        if all(Verdict::OutsideBeam) {
            let text = format!("dark because it is outside of the beam of light '{source}'");
            return Some(Cause { kind: "outside_beam", text });
        }
        let below = nearest.cos.map_or(String::new(), |cos| {
            format!(
                ": that is {:.0}° below its horizon",
                cos.clamp(-1.0, 1.0).acos().to_degrees() - 90.0
            )
        });
        lights.iter().all(gives_nothing).then(|| {
            let text = format!("dark because it faces away from light '{source}'{rest}{below}");
            Cause { kind: "faces_away", text }
        })
    }

    fn weak(&self, lights: &[Lighting]) -> Cause {
        let seen: f64 = self.terms.iter().map(|term| luminance_of(term.radiance)).sum();
        if seen > 0.0 {
            let (stops, leaves) = ((0.2 / seen).log2(), units::format(self.luminance, "nit"));
            let text = format!(
                "dark because little light comes from here, {leaves}; --exposure {stops:.1} would show it"
            );
            return Cause { kind: "weak_light", text };
        }
        self.eaten(lights).unwrap_or_else(|| {
            let text = "dark because nothing of the light that arrives is sent to the eye".into();
            Cause { kind: "weak_light", text }
        })
    }

    /// Dark because what fills the space takes the light, on its way from the lights or to the eye.
    fn eaten(&self, lights: &[Lighting]) -> Option<Cause> {
        let takes = |part: &[f32]| most(part) < NOTHING;
        let before = lights.iter().find_map(|light| match &light.verdict {
            Verdict::Tinted { passed } if takes(passed) => Some(&light.source),
            _ => None,
        });
        let to_the_eye = self.path.first().is_some_and(|step| takes(&step.throughput));
        let way = match before {
            _ if to_the_eye => "on its way to the eye".into(),
            source => format!("of '{}' on its way here", source?),
        };
        let text = format!("dark because panes, fog or smoke take all light {way}");
        Some(Cause { kind: "medium", text })
    }

    fn too_bright(&self) -> Cause {
        let Cause { text, .. } = self.lit("too_bright");
        let most = self.terms.iter().map(|term| luminance_of(term.radiance)).sum::<f64>();
        let stops = (0.8 / most.max(f64::MIN_POSITIVE)).log2();
        let text = format!(
            "white because it is brighter than the screen, {text}; --exposure {stops:.1} would show it"
        );
        Cause { kind: "too_bright", text }
    }

    /// Which term it mostly consists of.
    fn lit(&self, kind: &'static str) -> Cause {
        let Some(most) = self.terms.first() else {
            return Cause { kind, text: "no light comes from here".into() };
        };
        let percent = 100.0 * most.share;
        let Term { source, reflections, .. } = most;
        let text = match (most.key.0, reflections) {
            (Source::Surface(_), 0) => format!("it is '{source}' that emits ({percent:.0} %)"),
            (Source::Background | Source::Environment, 0) => {
                format!("mostly the {source} itself ({percent:.0} %)")
            }
            (Source::Ambient, _) => {
                format!("lit mostly by ambient light '{source}' ({percent:.0} %)")
            }
            (_, 0 | 1) => format!("lit mostly by '{source}' ({percent:.0} %)"),
            (_, n) => format!("lit mostly by '{source}' after {n} reflections ({percent:.0} %)"),
        };
        let kind = if kind == "lit" && *reflections == 0 { "emission" } else { kind };
        Cause { kind, text }
    }
}

fn most(values: &[f32]) -> f32 {
    values.iter().copied().fold(0.0, f32::max)
}
