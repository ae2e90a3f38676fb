//! The picture, judged by what was measured.

use super::probes::Witness;
use super::{Care, Doctor, materials, percent};
use crate::color::{Rgb, View, srgb_code8};
use crate::diagnostic::Diagnostic;
use crate::film::{Noise, auto_exposure};
use crate::render::Rendered;
use crate::scene::description::{Alpha, FilmDescription, Material};

/// The part of a picture that may be cut off at white without a word.
const CLIPPED: f64 = 0.05;
/// Display values from here on are not just white but brighter.
const WHITE: f32 = 1.01;
/// The part of what the camera sees that may be black without a word.
const BLACK: f64 = 0.9;
/// The same of a model in the studio, where nobody has chosen the light.
const BLACK_IN_STUDIO: f64 = 0.5;
/// Stops by which a picture may be too dark without a word.
const STOPS: f64 = 5.0;
/// Relative noise from which on more samples are recommended.
const NOISY: f64 = 0.5;

/// A picture, and how it is shown.
#[derive(Debug, Clone, Copy)]
pub struct Shown<'a> {
    /// What was rendered.
    pub rendered: &'a Rendered,
    /// Stops of exposure.
    pub exposure_ev: f64,
    /// Whether they were found from the picture.
    pub auto_exposure: bool,
    /// Whether the file holds what is shown, as opposed to radiance.
    pub developed: bool,
    /// How noisy it is, if that is to be judged.
    pub noise: Option<Noise>,
}

impl Shown<'_> {
    /// Whether a radiance comes out as the darkest code.
    fn is_black(&self, radiance: Rgb, view: View) -> bool {
        match self.developed {
            true => {
                let shown = view.display(self.exposure_ev.exp2() as f32 * radiance);
                shown.to_array().iter().all(|channel| srgb_code8(*channel) == 0)
            }
            false => radiance.max_element() <= 0.0,
        }
    }

    /// How many pixels come out as the darkest code.
    fn black_pixels(&self, view: View) -> usize {
        let pixels = self.rendered.image.pixels().iter();
        pixels.filter(|p| self.is_black(Rgb::new(p[0], p[1], p[2]), view)).count()
    }
}

impl Doctor<'_> {
    /// Everything that is odd about the picture of the scene.
    pub fn judge(&self, shown: &Shown<'_>) -> Vec<Diagnostic> {
        let findings =
            [dropped(shown.rendered), self.dark(shown), self.clipped(shown), self.noisy(shown)];
        findings.into_iter().flatten().collect()
    }

    fn dark(&self, shown: &Shown<'_>) -> Option<Diagnostic> {
        let rendered = shown.rendered;
        let told =
            self.description.surfaces.is_empty() || super::lights::none(self.description).is_some();
        if rendered.samples == 0 || told {
            return None;
        }
        let camera = self.description.cameras.first();
        let is_misplaced =
            |camera| self.is_inside(camera).or_else(|| self.is_behind(camera)).is_some();
        if camera.is_some_and(is_misplaced) {
            return None;
        }
        let in_studio = self.description.ground.is_some();
        if rendered.surface_rays == 0 || (in_studio && !self.probes.any_seen(self.scene)) {
            // From where all is a dot, that has been told.
            let far = camera.is_some_and(|camera| self.is_far(camera).is_some());
            return (!far).then(|| self.sees_nothing());
        }
        let black = |message: String| Diagnostic::new("", message).code("picture-black");
        let brightest = Rgb::new(rendered.brightest, 0.0, 0.0);
        let is_dark = shown.is_black(brightest, self.description.film.view);
        if is_dark && self.is_seen_through(shown) {
            return None;
        }
        if rendered.brightest <= 0.0 {
            let (why, help) = self.why_dark(&self.probes.seen().collect::<Vec<_>>());
            let message = format!("no light reaches the camera: what it sees is all black{why}");
            return Some(black(message).help(help));
        }
        if is_dark {
            let dim = "what the camera sees is so dim that it comes out black";
            if let Some((why, help)) = self.in_the_way(&self.probes.seen().collect::<Vec<_>>()) {
                return Some(black(format!("{dim}{why}")).help(help));
            }
            let error = black(dim.into());
            let auto = if shown.auto_exposure { "" } else { "try --exposure auto, or " };
            return Some(error.help(format!("{auto}use stronger lights{}", self.strongest())));
        }
        self.partly_black(shown).or_else(|| self.underexposed(shown))
    }

    /// Nothing is in front of the camera; where everything is instead, if it is anywhere.
    fn sees_nothing(&self) -> Diagnostic {
        if let Some(gone) = materials::gone(self.description, Care::Thorough).next() {
            return gone;
        }
        let message = match self.description.ground {
            None => "nothing is in front of the camera: all is background",
            Some(_) => {
                "nothing of the model is in front of the camera: all is ground and background"
            }
        };
        let error = Diagnostic::new("", message).code("camera-sees-nothing");
        let camera = self.description.cameras.first().zip(self.bounds());
        let angle = camera.and_then(|(camera, [lo, hi])| {
            let middle = (0.5 * (lo + hi) - camera.position).try_normalize()?;
            let forward = (camera.target - camera.position).try_normalize()?;
            Some(forward.angle_between(middle).to_degrees().round())
        });
        let angle = angle.filter(|angle| *angle >= 1.0);
        let aside = angle
            .map_or(String::new(), |a| format!("; it looks {a}° past the middle of the scene"));
        error.help(format!("try --camera frame, which shows everything{aside}"))
    }

    /// Whether surfaces that are only partly there are all that is black: the picture shows what is behind them.
    fn is_seen_through(&self, shown: &Shown<'_>) -> bool {
        let view = self.description.film.view;
        let partly_there = |material: &Material| material.alpha != Alpha::Opaque;
        let mostly = match self.black(shown) {
            Some(black) => black.is_empty() || 2 * black.len() < self.probes.seen().count(),
            None => shown.black_pixels(view) < shown.rendered.image.pixels().len(),
        };
        self.description.materials.iter().any(partly_there) && mostly
    }

    /// What the camera sees that is black in the picture; `None` if it is not known where the rays of the picture went.
    fn black(&self, shown: &Shown<'_>) -> Option<Vec<&Witness>> {
        let (image, camera) = (&shown.rendered.image, self.scene.camera());
        let whole = [image.width(), image.height()] == [camera.width(), camera.height()];
        let is_black = |witness: &&Witness| {
            let film = self.probes.rays[witness.probe].film;
            let [x, y] = [film.x * image.width() as f32, film.y * image.height() as f32];
            let (x, y) = (x as u32, y as u32);
            let pixel = image.get(x.min(image.width() - 1), y.min(image.height() - 1));
            shown.is_black(pixel, self.description.film.view)
        };
        whole.then(|| self.probes.seen().filter(is_black).collect())
    }

    /// Most of what the camera sees is black, if not all.
    fn partly_black(&self, shown: &Shown<'_>) -> Option<Diagnostic> {
        let view = self.description.film.view;
        let black = self.black(shown)?;
        let part = black.len() as f64 / self.probes.seen().count().max(1) as f64;
        let allowed = if self.description.ground.is_some() { BLACK_IN_STUDIO } else { BLACK };
        if part < allowed {
            return None;
        }
        let count = shown.rendered.image.pixels().len() as f64;
        let dark = match self.description.ground {
            None => {
                format!("{} of the pixels are", percent(shown.black_pixels(view) as f64 / count))
            }
            Some(_) => format!("{} of what is seen of the model is", percent(part)),
        };
        let sky = self.scene.environment.is_some() && self.probes.escaped > 0;
        if sky && self.description.lights.is_empty() {
            let samples = shown.rendered.samples;
            let message = format!(
                "{dark} black: after {samples} samples, they have not found the environment"
            );
            let help = "take more: --spp, or --noise 5%, which stops when it is there";
            return Some(Diagnostic::new("", message).help(help).code("noise"));
        }
        let (why, help) = self.why_dark(&black);
        let message = format!("{dark} black{why}");
        Some(Diagnostic::new("", message).code("picture-black").help(help))
    }

    fn underexposed(&self, shown: &Shown<'_>) -> Option<Diagnostic> {
        let suits = auto_exposure(&shown.rendered.image);
        let short = suits - shown.exposure_ev;
        (shown.developed && !shown.auto_exposure && short > STOPS).then(|| {
            let message = format!(
                "the picture is {short:.1} stops too dark: its brightest parts are nearly black"
            );
            let help = format!("try --exposure {suits:.2}, or auto{}", self.strongest());
            Diagnostic::new("", message).code("exposure-low").help(help)
        })
    }

    fn clipped(&self, shown: &Shown<'_>) -> Option<Diagnostic> {
        let gain = shown.exposure_ev.exp2() as f32;
        let covered = shown.rendered.image.pixels().iter().filter(|pixel| pixel[3] > 0.0);
        let mut levels: Vec<f32> = covered.map(|&[r, g, b, _]| r.max(g).max(b)).collect();
        let too_bright = levels.iter().filter(|&&level| gain * level > WHITE).count();
        let part = too_bright as f64 / levels.len().max(1) as f64;
        let cuts = matches!(self.description.film.view, View::Srgb | View::Raw);
        let warn = shown.developed && cuts && part > CLIPPED;
        warn.then(|| {
            let message = format!("{:.0} % of the picture is brighter than white", 100.0 * part);
            let help = match unclipped(&mut levels) {
                Some(ev) if shown.exposure_ev - ev > STOPS => {
                    format!("try --exposure {ev:.2} or --view neutral{}", self.strongest())
                }
                Some(ev) => format!("try --exposure {ev:.2} or --view neutral"),
                None => "use weaker lights".into(),
            };
            Diagnostic::new("", message).help(help).code("picture-clipped")
        })
    }

    fn noisy(&self, shown: &Shown<'_>) -> Option<Diagnostic> {
        let noise = shown.noise.filter(|noise| noise.relative > NOISY)?;
        let samples = shown.rendered.samples.max(1);
        // Errors fall with the square root of the number of samples.
        let needed = f64::from(samples) * (noise.relative / (0.2 * NOISY)).powi(2);
        let needed = (needed as u32).clamp(1, FilmDescription::MOST_SAMPLES).next_power_of_two();
        let message = format!(
            "the picture is noisy: after {samples} samples, pixels are off by about {:.0} % of their brightness",
            100.0 * noise.relative
        );
        let help =
            format!("--spp {needed} brings it to some 10 %; --noise 5% stops when it is there");
        Some(Diagnostic::new("", message).code("noise").help(help))
    }
}

fn dropped(rendered: &Rendered) -> Option<Diagnostic> {
    let [x, y] = rendered.first_dropped?;
    let message = format!("{} samples were not finite and were dropped", rendered.dropped);
    let error = Diagnostic::new("", message).at_part(format!("pixel ({x}, {y})"));
    Some(
        error.help("look for lights and materials with very large numbers").code("samples-dropped"),
    )
}

/// The greatest exposure at which no more than [`CLIPPED`] of the levels are brighter than white, if there is one.
fn unclipped(levels: &mut [f32]) -> Option<f64> {
    let rank = ((1.0 - CLIPPED) * levels.len() as f64).ceil() as usize;
    let (_, level, _) = levels.select_nth_unstable_by(rank.checked_sub(1)?, f32::total_cmp);
    let ev = (-100.0 * f64::from(*level).log2()).floor() / 100.0;
    (ev.abs() <= FilmDescription::MOST_STOPS).then_some(ev)
}
