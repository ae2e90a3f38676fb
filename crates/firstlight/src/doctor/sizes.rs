//! Lengths that are a thousand times too large: millimetres taken for metres.

use super::{Doctor, finding, quoted};
use crate::color::Rgb;
use crate::diagnostic::Diagnostic;
use crate::scene::description::{Interior, Surface};
use crate::scene::light_middle;
use crate::units;
use glam::DVec3;
use std::collections::BTreeMap;

/// What no room is: scenes of at least this size may be in millimetres, m.
const LARGE: f64 = 50.0;
/// Towns and landscapes as they are, but parts, rooms and houses in millimetres, m.
const HUGE: std::ops::Range<f64> = 500.0..100_000.0;
/// What tells lengths.
const UNIT: &str = "say in which unit the model is: --unit mm, or unit = \"mm\" in its [models.…]";
/// Illuminance below which lights do not suit the size of a scene, and the range in which they do, lx.
const DIM: f64 = 0.5;
const USUAL: std::ops::Range<f64> = 1.0..1e6;
/// The part of a scene's size from which on steps between numbers show.
const TORN: f64 = 2e-4;
/// How many times as large as the others a model is whose unit is another one.
const MIXED: std::ops::Range<f64> = 200.0..50_000.0;

impl Doctor<'_> {
    /// Everything that is odd about lengths.
    pub(super) fn sizes(&self) -> Vec<Diagnostic> {
        let huge = self.millimetres().or_else(|| self.huge());
        huge.into_iter().chain(self.mixed()).chain(self.far_off()).collect()
    }

    /// A scene so far from the origin that single precision tears it: as in the coordinates of maps.
    fn far_off(&self) -> Option<Diagnostic> {
        let [lo, hi] = self.bounds()?;
        let (size, away) = ((hi - lo).length(), lo.abs().max(hi.abs()).max_element());
        let step = f64::from(f32::EPSILON) * away;
        (step > TORN * size && size > 0.0).then(|| {
            let [size, away, step] = [size, away, step].map(|length| units::format(length, "m"));
            let message = format!(
                "the scene is {size} across and {away} away from the origin, where places are told apart by some {step} only: it is torn and jagged"
            );
            let help = "move it to the origin in the program it was made with: take the same large numbers off all coordinates";
            finding("origin-far", "lengths".into(), message).help(help)
        })
    }

    /// A model in a studio that is as large as a town, of something that looks different in another unit. Where nothing does,
    /// the picture is the same in metres and in millimetres, and mountains may be as large as they are.
    fn huge(&self) -> Option<Diagnostic> {
        self.description.ground.filter(|_| self.depends_on_lengths())?;
        let size = self.bounds().map(|[lo, hi]| (hi - lo).max_element())?;
        HUGE.contains(&size).then(|| {
            let (now, then) = (units::format(size, "m"), units::format(1e-3 * size, "m"));
            let message = format!(
                "the model is {now} across, and how deep light goes into its materials is said in metres; were its lengths millimetres, it would be {then}"
            );
            finding("size-millimetres", "lengths".into(), message).help(UNIT)
        })
    }

    /// Whether light is lost, or scattered, over lengths in any material.
    fn depends_on_lengths(&self) -> bool {
        let dims = |interior: Interior| {
            interior.absorption != Rgb::ZERO || interior.scattering != Rgb::ZERO
        };
        let materials = &self.description.materials;
        self.description.surfaces.iter().any(|s| materials[s.material].interior.is_some_and(dims))
    }

    /// A scene so large that its lights do nothing, which would suit it in millimetres.
    fn millimetres(&self) -> Option<Diagnostic> {
        let scene = self.description;
        let local = scene.lights.iter().all(|light| light.light.position().is_some());
        let size = self.bounds().map(|[lo, hi]| (hi - lo).max_element())?;
        if !local || scene.lights.is_empty() || scene.environment.is_some() || size < LARGE {
            return None;
        }
        let lights: Vec<_> =
            scene.lights.iter().filter_map(|l| light_middle(l, self.scene.camera())).collect();
        let at = |point: DVec3| -> Rgb {
            lights.iter().filter_map(|l| l.sample(point)).map(|s| s.irradiance).sum()
        };
        let brightest = self.probes.seen().map(|w| at(w.position)).reduce(Rgb::max)?;
        let lux = units::photometric(brightest, scene.luminous_efficacy.0);
        (lux > 0.0 && lux < DIM && USUAL.contains(&(1e6 * lux))).then(|| {
            let shown = |lux, metres| (units::format(lux, "lx"), units::format(metres, "m"));
            let ((now, large), (then, small)) = (shown(lux, size), shown(1e6 * lux, 1e-3 * size));
            let message = format!(
                "the scene is {large} across, and its lights give what is seen {now} at most; were its lengths millimetres, that would be {small} and {then}"
            );
            finding("size-millimetres", "lengths".into(), message).help(UNIT)
        })
    }

    /// One model that is as large beside all others as if it were in another unit.
    fn mixed(&self) -> Option<Diagnostic> {
        let mut sizes = self.model_sizes();
        sizes.sort_by(|a, b| b.1.total_cmp(&a.1));
        let [(name, size), rest @ ..] = &sizes[..] else { return None };
        let (_, second) = rest.first()?;
        let smaller = format!("{:?}", rest.first().map(|rest| &rest.0)?);
        (MIXED.contains(&(size / second))).then(|| {
            let (size, second) = (units::format(*size, "m"), units::format(*second, "m"));
            let message = format!(
                "is {size} across, and the next largest, {smaller}, {second}: are they in the same unit?"
            );
            finding("size-mixed", format!("model {}", quoted(name)), message)
                .help("say in which unit its file is: unit = \"mm\" in its [models.…]")
        })
    }

    /// The largest side of each model file's surfaces and of each single mesh. What shines, and what the camera
    /// is inside of, may be as large as it wants: skies are.
    fn model_sizes(&self) -> Vec<(String, f64)> {
        let scene = self.description;
        let inside = self.probes.seen().filter(|w| !w.front).map(|w| w.surface);
        let inside: std::collections::BTreeSet<_> = inside.collect();
        let model = |surface: &Surface| Some(surface.name.split_once('/')?.0.to_owned());
        let mut boxes = BTreeMap::<String, [DVec3; 2]>::new();
        for ((number, surface), around) in (0..).zip(&scene.surfaces).zip(&self.boxes) {
            let shines = scene.materials[surface.material].emits();
            let counts = !shines && !inside.contains(&number);
            if let (true, Some(name), Some([lo, hi])) = (counts, model(surface), around) {
                let entry = boxes.entry(name).or_insert([*lo, *hi]);
                *entry = [entry[0].min(*lo), entry[1].max(*hi)];
            }
        }
        let sizes = boxes.into_iter().map(|(name, [lo, hi])| (name, (hi - lo).max_element()));
        sizes.filter(|(_, size)| *size > 0.0).collect()
    }
}
