//! All that is said to people, on standard error.

use firstlight::diagnostic::{Diagnostic, visible};
use firstlight::render::Progress;
use firstlight::units;
use firstlight::{Noise, SceneDescription, Spread};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::{Value, json};
use std::fmt::Display;
use std::io::{IsTerminal, Write, stderr};

/// Warnings that are printed one by one.
const MOST_WARNINGS: usize = 20;

/// Says why a command ends.
pub(crate) fn error(error: &Diagnostic) {
    complaint("error", RED, error);
}

/// Says what is odd but does not keep anything from going on.
pub(crate) fn warnings(warnings: &[Diagnostic]) {
    warnings.iter().take(MOST_WARNINGS).for_each(|warning| complaint("warning", YELLOW, warning));
    if let more @ 1.. = warnings.len().saturating_sub(MOST_WARNINGS) {
        line(format_args!("… and {more} more warnings; --json lists them all"));
    }
}

/// Says one thing.
pub(crate) fn line(text: impl Display) {
    // If nobody listens there is nobody to tell.
    let _ = writeln!(stderr(), "{text}");
}

/// The warnings for a report: what, where, and what helps.
pub(crate) fn as_json(warnings: &[Diagnostic]) -> Value {
    let one = |warning: &Diagnostic| {
        let place = warning.place.to_string();
        let place = if place.is_empty() { Value::Null } else { place.into() };
        let code = if warning.code.is_empty() { Value::Null } else { warning.code.into() };
        json!({ "code": code, "place": place, "message": warning.message, "help": warning.help })
    };
    warnings.iter().map(one).collect()
}

fn complaint(kind: &str, color: &str, what: &Diagnostic) {
    let mut message = Diagnostic { help: None, ..what.clone() };
    if !what.code.is_empty() {
        message.message += &format!(" [{}]", what.code);
    }
    line(format_args!("{} {message}", painted(&format!("{kind}:"), color)));
    if let Some(help) = &what.help {
        line(format_args!(" {} {}", painted("help:", CYAN), visible(help)));
    }
}

const RED: &str = "1;31";
const YELLOW: &str = "1;33";
const CYAN: &str = "1;36";

/// The text in colour, if it goes to a terminal and the user likes colours (<https://no-color.org>).
fn painted(text: &str, color: &str) -> String {
    let unwanted = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    if unwanted || !stderr().is_terminal() {
        return text.to_owned();
    }
    format!("\u{1b}[{color}m{text}\u{1b}[0m")
}

/// A bar that shows how far a render has come, on a terminal.
pub(crate) struct Bar(ProgressBar);

impl Bar {
    const STEPS: u64 = 10_000;

    /// A bar, unless nobody wants to see one.
    pub(crate) fn new(wanted: bool) -> Self {
        if !wanted || !stderr().is_terminal() {
            return Self(ProgressBar::hidden());
        }
        let bar = ProgressBar::with_draw_target(Some(Self::STEPS), ProgressDrawTarget::stderr());
        let template = "{bar:40} {percent:>3} %  {eta} left  {msg}";
        Self(bar.with_style(
            ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar()),
        ))
    }

    /// Shows how far it has come: `done` is in 0..1.
    pub(crate) fn show(&self, progress: Progress, done: f64) {
        if self.0.is_hidden() {
            return;
        }
        let rays = progress.rays.total() as f64;
        let seconds = self.0.elapsed().as_secs_f64();
        self.0.set_message(format!("{:.1} Mrays/s", rays / seconds.max(1e-6) / 1e6));
        self.0.set_position((done * Self::STEPS as f64) as u64);
    }

    /// Takes it away.
    pub(crate) fn finish(&self) {
        self.0.finish_and_clear();
    }
}

/// A line that names the step a long task is at, on a terminal.
pub(crate) struct Steps(ProgressBar);

impl Steps {
    /// A line, unless nobody wants to see one.
    pub(crate) fn new(wanted: bool) -> Self {
        let hidden = !wanted || !stderr().is_terminal();
        Self(if hidden { ProgressBar::hidden() } else { ProgressBar::new_spinner() })
    }

    /// Names step `number` of `count`, from 0.
    pub(crate) fn show(&self, name: &str, number: usize, count: usize) {
        self.0.set_message(format!("{} of {count}: {name}", number + 1));
        self.0.tick();
    }

    /// Takes it away.
    pub(crate) fn finish(&self) {
        self.0.finish_and_clear();
    }
}

/// How many samples pixels have: `64 spp`, or `64 spp (24 to 312)`.
pub(crate) fn samples(samples: u32, Spread { fewest, most, .. }: Spread) -> String {
    if fewest == most {
        return format!("{samples} spp");
    }
    format!("{samples} spp ({fewest} to {most})")
}

/// What there is to say about the noise of a picture, after a comma. The halves of one net of samples tell only how much
/// it is `at_most`.
pub(crate) fn noise(noise: Option<Noise>, at_most: bool) -> String {
    let bound = if at_most { "at most " } else { "" };
    match noise.map(|noise| 100.0 * noise.relative) {
        None => String::new(),
        Some(0.0) => ", no noise".into(),
        Some(percent) if percent < 0.01 => format!(", noise {bound}0.01 %"),
        Some(percent) if percent < 1.0 => format!(", noise {bound}{percent:.2} %"),
        Some(percent) => format!(", noise {bound}{percent:.1} %"),
    }
}

/// What clamping has removed, after a comma, if it has.
pub(crate) fn clamped(scene: &SceneDescription, part: f64) -> String {
    match scene.film.clamp {
        Some(bound) if part > 0.0 => {
            format!(", {:.2} % of all light removed by clamping at {bound}", 100.0 * part)
        }
        _ => String::new(),
    }
}

/// The same for a report.
pub(crate) fn noise_json(noise: Option<Noise>, at_most: bool) -> Value {
    let Some(Noise { relative, mean, standard_error }) = noise else { return Value::Null };
    json!({
        "relative_standard_error": relative,
        "upper_bound": at_most,
        "mean_luminance": mean,
        "mean_standard_error": standard_error,
    })
}

/// A time span: `12 ms`, `1.2 s`, `2 min 5 s`, `3 h 20 min`.
pub(crate) fn span(seconds: f64) -> String {
    let whole = seconds.round() as u64;
    match whole {
        0..1 => format!("{:.0} ms", seconds * 1e3),
        1..60 => format!("{seconds:.1} s"),
        60..3600 => format!("{} min {} s", whole / 60, whole % 60),
        _ => format!("{} h {} min", whole / 3600, whole / 60 % 60),
    }
}

/// Rays per second with two or three digits: `23.1 Mrays/s`.
pub(crate) fn rate(rays_per_second: f64) -> String {
    let digits = rays_per_second.max(1.0).log10().floor();
    let unit = 10_f64.powf(digits - 2.0);
    units::format((rays_per_second / unit).round() * unit, "rays/s")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_are_short() {
        assert_eq!(span(0.0123), "12 ms");
        assert_eq!(span(1.24), "1.2 s");
        assert_eq!(span(125.2), "2 min 5 s");
        assert_eq!(span(12_000.0), "3 h 20 min");
    }

    #[test]
    fn samples_are_said_once_if_all_pixels_have_as_many() {
        let of = |fewest, most| samples(64, Spread { fewest, mean: 64.2, most });
        assert_eq!(of(64, 64), "64 spp");
        assert_eq!(of(24, 312), "64 spp (24 to 312)");
    }

    #[test]
    fn noise_is_a_percentage() {
        let of = |relative| Some(Noise { relative, mean: 1.0, standard_error: 0.1 });
        assert_eq!(noise(of(0.0312), true), ", noise at most 3.1 %");
        assert_eq!(noise(of(0.004_99), false), ", noise 0.50 %");
        assert_eq!(noise(of(0.0), true), ", no noise");
        assert_eq!(noise(None, true), "");
    }

    #[test]
    fn rates_have_three_digits() {
        assert_eq!(rate(23_123_456.0), "23.1 Mrays/s");
        assert_eq!(rate(0.0), "0 rays/s");
    }
}
