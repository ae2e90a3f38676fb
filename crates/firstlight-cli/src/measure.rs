//! `firstlight measure`: irradiance and radiance at points of a scene.

use crate::args::MeasureArgs;
use crate::input::{STDIN, choose_camera, read_stdin};
use crate::output::print_all;
use crate::rows::{self, Kind, Query};
use crate::{Exit, Outcome, report};
use clap::{Arg, ArgAction, ArgMatches, Command, FromArgMatches};
use firstlight::diagnostic::Diagnostic;
use firstlight::doctor;
use firstlight::io::Warnings;
use firstlight::{Measurement, Ray, Scene, units};
use glam::DVec3;
use serde_json::{Value, json};
use std::fmt::Write;
use std::io::IsTerminal;

pub(crate) fn run(args: &MeasureArgs) -> Outcome {
    let queries = args.queries()?;
    if queries.is_empty() {
        let error = Diagnostic::new(STDIN, "no points given");
        return Err(error.help("write rows of kind and six numbers; see --help").into());
    }
    let mut warnings = Warnings::new();
    let mut scene = args.input.load(&mut warnings)?;
    choose_camera(&mut scene, args.camera.as_deref())?;
    warnings.extend(doctor::no_lights(&scene));
    report::warnings(&warnings);
    let scene = Scene::build(&scene);
    let readings = queries.iter().map(|query| Reading::take(&scene, query));
    if args.json {
        print_all(json_list(readings.map(|reading| reading.json())))?;
    } else {
        print_all(readings.map(|reading| reading.text()))?;
    }
    Ok(Exit::Done)
}

/// A JSON list, one element a line. It is never in memory as a whole.
fn json_list(values: impl Iterator<Item = Value>) -> impl Iterator<Item = String> {
    let line = |(index, value)| format!("{}\n  {value}", if index == 0 { "[" } else { "," });
    let mut lines = values.enumerate().map(line).peekable();
    let start = lines.peek().is_none().then(|| "[".to_owned());
    start.into_iter().chain(lines).chain(["\n]\n".to_owned()])
}

impl MeasureArgs {
    /// What to measure, in the order of the command line, with the rows of standard input in their place.
    fn queries(&self) -> Outcome<Vec<Query>> {
        let Requests(requests) = &self.requests;
        let from_stdin = |request: &&Request| matches!(request, Request::Table(_));
        let tables = requests.iter().filter(from_stdin).count();
        let uses = tables + usize::from(self.input.is_stdin()) + usize::from(requests.is_empty());
        if uses > 1 {
            let error =
                Diagnostic::new(STDIN, "can be read only once, for the scene or for points");
            return Err(error.help("give the scene as a file").into());
        }
        if requests.is_empty() {
            return read_table(None);
        }
        let mut queries = Vec::new();
        for request in requests {
            match request {
                Request::Point(query) => queries.push(*query),
                Request::Table(kind) => queries.extend(read_table(Some(*kind))?),
            }
        }
        Ok(queries)
    }
}

fn read_table(kind: Option<Kind>) -> Outcome<Vec<Query>> {
    if kind.is_none() && std::io::stdin().is_terminal() {
        let error = Diagnostic::new("", "there is nothing to measure");
        return Err(error.help("give --irradiance or --radiance; see --help").into());
    }
    Ok(rows::read(&read_stdin()?, kind)?)
}

/// `--irradiance` and `--radiance`, in the order in which they were given.
#[derive(Debug, Default)]
pub(crate) struct Requests(Vec<Request>);

#[derive(Debug, Clone, Copy)]
enum Request {
    Point(Query),
    /// Rows of this kind on standard input.
    Table(Kind),
}

impl clap::Args for Requests {
    fn augment_args(command: Command) -> Command {
        let request = |kind: Kind, names: &'static str, help: &'static str| {
            Arg::new(kind.name())
                .long(kind.name())
                .value_name(names)
                .help(help)
                .action(ArgAction::Append)
                .allow_hyphen_values(true)
                .value_parser(move |text: &str| match text {
                    "-" => Ok(Request::Table(kind)),
                    _ => Query::parse(kind, text).map(Request::Point),
                })
        };
        let irradiance =
            "Irradiance at a point of a surface with this normal; - reads rows; may be repeated";
        let radiance = "Radiance along a ray from its origin; - reads rows; may be repeated";
        command.arg(request(Kind::Irradiance, "X,Y,Z,NX,NY,NZ", irradiance)).arg(request(
            Kind::Radiance,
            "OX,OY,OZ,DX,DY,DZ",
            radiance,
        ))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for Requests {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let mut requests = Self::default();
        requests.update_from_arg_matches(matches)?;
        Ok(requests)
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        let given = |kind: Kind| {
            let places = matches.indices_of(kind.name()).into_iter().flatten();
            places.zip(matches.get_many::<Request>(kind.name()).into_iter().flatten())
        };
        let mut requests: Vec<_> = Kind::ALL.into_iter().flat_map(given).collect();
        requests.sort_by_key(|(place, _)| *place);
        self.0 = requests.into_iter().map(|(_, request)| *request).collect();
        Ok(())
    }
}

/// One answer.
struct Reading<'a> {
    query: &'a Query,
    measured: Measurement,
    photometric: f64,
}

impl<'a> Reading<'a> {
    fn take(scene: &Scene, query: &'a Query) -> Self {
        let Query { kind, point, direction } = *query;
        let measured = match kind {
            Kind::Irradiance => scene.irradiance(point, direction),
            Kind::Radiance => {
                let ray = Ray::new(point.as_vec3(), direction.as_vec3());
                scene.radiance(&ray)
            }
        };
        let photometric = units::photometric(measured.value, scene.luminous_efficacy().0);
        Self { query, measured, photometric }
    }

    fn units(&self) -> [&'static str; 2] {
        match self.query.kind {
            Kind::Irradiance => ["W/m²", "lx"],
            Kind::Radiance => ["W/(sr·m²)", "cd/m²"],
        }
    }

    fn json(&self) -> Value {
        let [unit, photometric_unit] = self.units();
        json!({
            "kind": self.query.kind.name(),
            "value": self.measured.value.to_array(),
            "unit": unit,
            "photometric": self.photometric,
            "photometric_unit": photometric_unit,
            "standard_error": self.measured.standard_error.to_array(),
            "samples": self.measured.samples,
        })
    }

    /// The standard error in words; lights without size and ambient light are summed exactly.
    fn error(&self) -> String {
        let Measurement { standard_error, samples, .. } = self.measured;
        if samples == 1 {
            return "0 (exact)".into();
        }
        format!("{} ({samples} samples)", digits(standard_error.max_element().into()))
    }

    /// Two lines of an aligned table under a heading.
    fn text(&self) -> String {
        let Query { kind, point, direction } = self.query;
        let verb = if *kind == Kind::Irradiance { "facing" } else { "along" };
        let [unit, photometric_unit] = self.units();
        let [r, g, b] = self.measured.value.to_array().map(|channel| digits(channel.into()));
        let seen = digits(self.photometric);
        let mut text =
            format!("{} at {} {verb} {}\n", kind.name(), triple(*point), triple(*direction));
        // Writing to a string cannot fail.
        let error = self.error();
        let _ = writeln!(text, "  r {r:<16} g {g:<16} b {b:<16} {unit}   ± {error}");
        let _ = writeln!(text, "  = {seen} {photometric_unit}");
        text
    }
}

fn triple(v: DVec3) -> String {
    format!("({}, {}, {})", digits(v.x), digits(v.y), digits(v.z))
}

/// A number with nine significant digits, enough for every `f32`.
fn digits(value: f64) -> String {
    let rounded: f64 = format!("{value:.8e}").parse().unwrap_or(value);
    match rounded.abs() {
        0.0 => "0".into(),
        1e-4..1e9 => rounded.to_string(),
        _ => format!("{rounded:e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_nine_digits() {
        assert_eq!(digits(1.989_436_788_6), "1.98943679");
        assert_eq!(digits(-0.0), "0");
        assert_eq!(digits(1.5e-7), "1.5e-7");
        assert_eq!(digits(123_456_789_123.0), "1.23456789e11");
        for value in [0.1_f32, 1.0 / 3.0, 16_777_217.0, f32::MIN_POSITIVE, f32::MAX] {
            assert_eq!(digits(value.into()).parse(), Ok(value));
        }
    }
}
