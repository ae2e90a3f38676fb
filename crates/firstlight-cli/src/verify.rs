//! `firstlight verify`: the reference table, measured on the user's machine.

use crate::args::VerifyArgs;
use crate::output::{print, print_json};
use crate::{Exit, Outcome, machine, report};
use firstlight::Level;
use firstlight::render::with_threads;
use firstlight::verify::{Case, GROUPS, Reading, Tolerance, greatest_z};
use serde_json::{Value, json};
use std::fmt::Write;
use std::time::Instant;

pub(crate) fn run(args: &VerifyArgs) -> Outcome {
    let threads = args.threads.map_or_else(machine::processors, |threads| threads as usize);
    let start = Instant::now();
    let progress = report::Steps::new(!args.json);
    let done: Vec<Done> = with_threads(threads, || {
        let chosen = chosen(args);
        let count = chosen.len();
        let run = |(number, (group, case)): (usize, (&'static str, &'static Case))| {
            progress.show(case.id, number, count);
            Done::run(group, case)
        };
        chosen.into_iter().enumerate().map(run).collect()
    });
    progress.finish();
    let table = Table::new(done, start.elapsed().as_secs_f64(), threads);
    if args.json {
        print_json(&table.json())?
    } else {
        print(table.text().as_bytes())?
    }
    Ok(if table.failed() == 0 { Exit::Done } else { Exit::Failed })
}

/// The cases that were asked for, in the order of the table.
fn chosen(args: &VerifyArgs) -> Vec<(&'static str, &'static Case)> {
    let wanted = |group: &str, case: &Case| {
        let named = args.case.iter().any(|id| id == case.id);
        let in_group = args.group.iter().any(|name| name == group);
        let any = args.group.is_empty() && args.case.is_empty();
        named || (in_group || any) && (args.all || case.quick)
    };
    let all = GROUPS.iter().flat_map(|(group, cases)| cases.iter().map(move |case| (*group, case)));
    all.filter(|(group, case)| wanted(group, case)).collect()
}

/// A case that was run.
struct Done {
    group: &'static str,
    case: &'static Case,
    readings: Vec<Reading>,
    seconds: f64,
}

impl Done {
    fn run(group: &'static str, case: &'static Case) -> Self {
        let start = Instant::now();
        let readings = case.run();
        Self { group, case, readings, seconds: start.elapsed().as_secs_f64() }
    }

    /// The reading that says most about the case: one that fails, or the one that uses up most of its tolerance.
    fn worst(&self, greatest_z: f64) -> Option<&Reading> {
        let used = |reading: &Reading| match reading.difference {
            0.0 => 0.0,
            difference => difference.abs() / reading.allowed,
        };
        let badness = |reading: &Reading| (!reading.passes(greatest_z), used(reading));
        self.readings.iter().max_by(|a, b| {
            let (a, b) = (badness(a), badness(b));
            a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
        })
    }

    fn passes(&self, greatest_z: f64) -> bool {
        self.readings.iter().all(|reading| reading.passes(greatest_z))
    }

    fn json(&self, greatest_z: f64) -> Value {
        let Case { id, setup, source, tolerance, quick, .. } = self.case;
        let (kind, tolerance) = match tolerance {
            Tolerance::Relative(part) => ("relative", part),
            Tolerance::Absolute(value) => ("absolute", value),
        };
        let mut object = json!({ "id": id, "group": self.group, "setup": setup });
        let worst = self.worst(greatest_z).map(|reading| reading_json(reading, greatest_z));
        let rest = json!({
            "pass": self.passes(greatest_z),
            "tolerance": { "kind": kind, "value": tolerance },
            "source": source,
            "quick": quick,
            "seconds": self.seconds,
            "points": self.readings.iter().map(|r| reading_json(r, greatest_z)).collect::<Vec<_>>(),
        });
        for part in worst.into_iter().chain([rest]) {
            if let (Value::Object(object), Value::Object(part)) = (&mut object, part) {
                object.extend(part);
            }
        }
        object
    }

    /// A row of the table; a case that fails shows all of its points that do.
    fn text(&self, greatest_z: f64) -> String {
        let failed = self.readings.iter().filter(|reading| !reading.passes(greatest_z));
        let shown: Vec<_> = match self.passes(greatest_z) {
            true => self.worst(greatest_z).into_iter().collect(),
            false => failed.collect(),
        };
        let mut text = String::new();
        for reading in shown {
            let verdict = if reading.passes(greatest_z) { "ok" } else { "FAIL" };
            let Reading { at, measured, expected, z, .. } = reading;
            let error = short(reading.error());
            // Writing to a string cannot fail.
            let _ = writeln!(
                text,
                "{verdict:<4} {:<32} {:>13} {:>13} {error:>9} {z:>6.2}  {at}",
                self.case.id,
                nine(*measured),
                nine(*expected)
            );
        }
        text
    }
}

fn reading_json(reading: &Reading, greatest_z: f64) -> Value {
    json!({
        "at": reading.at,
        "measured": reading.measured,
        "expected": reading.expected,
        "error": reading.error(),
        "standard_error": reading.standard_error,
        "z": reading.z,
        "pass": reading.passes(greatest_z),
    })
}

/// All that was run.
struct Table {
    done: Vec<Done>,
    greatest_z: f64,
    seconds: f64,
    threads: usize,
}

impl Table {
    fn new(done: Vec<Done>, seconds: f64, threads: usize) -> Self {
        let greatest_z = greatest_z(done.iter().map(|done| done.readings.len()).sum());
        Self { done, greatest_z, seconds, threads }
    }

    fn failed(&self) -> usize {
        self.done.iter().filter(|done| !done.passes(self.greatest_z)).count()
    }

    fn readings(&self) -> usize {
        self.done.iter().map(|done| done.readings.len()).sum()
    }

    fn json(&self) -> Value {
        json!({
            "version": env!("CARGO_PKG_VERSION"),
            "passed": self.done.len() - self.failed(),
            "failed": self.failed(),
            "readings": self.readings(),
            "greatest_z": self.greatest_z,
            "seconds": self.seconds,
            "threads": self.threads,
            "simd": Level::detect().name(),
            "conventions": {
                "axes": "right-handed, z up, metres, W unless a photometric unit is named",
                "depth": "counts reflections: 0 shows only what emits",
                "environment": "lat-long, zenith in the first row; nearest or bilinear look-up as the case says",
                "error": "relative to what is expected, absolute where nothing is",
                "z": "standard deviations of a normal distribution; rounding counts as 2.5e-6 of what is expected",
            },
            "cases": self.done.iter().map(|done| done.json(self.greatest_z)).collect::<Vec<_>>(),
        })
    }

    fn text(&self) -> String {
        let mut text = String::from("worst point of each case");
        let _ = writeln!(text, "{:>27} {:>13} {:>9} {:>6}", "measured", "expected", "error", "z");
        let mut group = "";
        for done in &self.done {
            if done.group != group {
                group = done.group;
                let _ = writeln!(text, "{group}");
            }
            text += &done.text(self.greatest_z);
        }
        let (failed, count) = (self.failed(), self.done.len());
        let verdict = match failed {
            0 => format!("all {count} cases pass"),
            _ => format!("{failed} of {count} cases fail"),
        };
        let (readings, z) = (self.readings(), self.greatest_z);
        let time = report::span(self.seconds);
        let _ = writeln!(text, "{verdict}: {readings} readings, |z| up to {z:.2} allowed, {time}");
        text
    }
}

/// A number with nine significant digits.
fn nine(value: f64) -> String {
    match value.abs() {
        0.0 => "0".into(),
        1e-3..1e6 => {
            let digits = (8.0 - value.abs().log10().floor()).clamp(0.0, 11.0) as usize;
            let text = format!("{value:.digits$}");
            let short = text.trim_end_matches('0').trim_end_matches('.');
            if text.contains('.') { short.into() } else { text.clone() }
        }
        _ => format!("{value:.5e}"),
    }
}

/// An error as a percentage, or as a power of ten if it is tiny.
fn short(error: f64) -> String {
    match error {
        0.0 => "0".into(),
        1e-5.. => format!("{:.3} %", 100.0 * error),
        _ => format!("{error:.0e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        assert_eq!(nine(1.989_436_788_6), "1.98943679");
        assert_eq!(nine(100.0), "100");
        assert_eq!(nine(-0.5), "-0.5");
        assert_eq!(nine(0.0), "0");
        assert_eq!(nine(4.999_99e-9), "4.99999e-9");
        assert_eq!(short(0.001_234), "0.123 %");
        assert_eq!(short(2e-8), "2e-8");
    }
}
