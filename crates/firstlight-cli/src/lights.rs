//! `firstlight lights`: every light with its units, and what arrives in the middle of the scene.

use crate::args::LightsArgs;
use crate::output::{print, print_json};
use crate::{Exit, Outcome, report};
use firstlight::color::{Rgb, luminance};
use firstlight::diagnostic::visible;
use firstlight::io::Warnings;
use firstlight::passport::{Entry, Passport};
use firstlight::render::with_threads;
use firstlight::units::{self, Dimension, Measure};
use firstlight::{BuildQuality, Scene};
use serde_json::{Value, json};

pub(crate) fn run(args: &LightsArgs) -> Outcome {
    let mut warnings = Warnings::new();
    let scene = args.picture.prepare(&args.picture.input.access(), &mut warnings)?;
    report::warnings(&warnings);
    let level = args.picture.level();
    let passport = with_threads(args.picture.threads(), || {
        Passport::new(&scene, &Scene::build_with(&scene, level, BuildQuality::Preview))
    });
    if args.json {
        print_json(&as_json(args, &passport, &warnings))?;
    } else {
        print(as_text(args, &passport).as_bytes())?;
    }
    Ok(Exit::Done)
}

/// The columns of the table; the first three are texts.
const COLUMNS: [&str; 10] = [
    "light",
    "kind",
    "written as",
    "power",
    "flux",
    "intensity",
    "luminance",
    "irradiance",
    "illuminance",
    "kept off",
];

fn as_text(args: &LightsArgs, passport: &Passport) -> String {
    let mut rows = vec![COLUMNS.map(String::from)];
    rows.extend(passport.lights.iter().map(|light| row(light, passport.luminous_efficacy)));
    let widths: Vec<_> = (0..COLUMNS.len())
        .map(|column| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0))
        .collect();
    let line = |row: &[String; 10]| {
        let cells = row.iter().zip(&widths).enumerate();
        let cells = cells.map(|(column, (cell, &width))| match column {
            0..3 | 9 => format!("{cell:<width$}"),
            _ => format!("{cell:>width$}"),
        });
        cells.collect::<Vec<_>>().join("  ").trim_end().to_owned() + "\n"
    };
    let [x, y, z] = passport.middle.to_array().map(|x| units::format(x, "m"));
    let efficacy = units::format(passport.luminous_efficacy, "lm/W");
    let on = passport.surface.as_deref().map_or(String::new(), |surface| {
        format!("on \"{}\", where the camera looks at ", visible(surface))
    });
    let head = format!(
        "{}: {efficacy}; irradiance and illuminance are those {}the middle of the scene, ({x}, {y}, {z}), with nothing in between\n",
        visible(&args.picture.input.name()),
        if on.is_empty() { "in " } else { &on }
    );
    let lights: String = rows.iter().map(line).collect();
    let none = if passport.lights.is_empty() { "there are no lights\n" } else { "" };
    head + &lights + none
}

/// A light's quantities in both measures, those that apply.
fn row(light: &Entry, efficacy: f64) -> [String; 10] {
    let seen = |value: Option<Rgb>, dimension| {
        let unit = units::unit(dimension, Measure::Photometric);
        value.map_or("–".into(), |v| units::format(units::photometric(v, efficacy), unit))
    };
    let energy = |value: Option<Rgb>, dimension| {
        let unit = units::unit(dimension, Measure::Radiometric);
        value.map_or("–".into(), |value| units::format(luminance(value).into(), unit))
    };
    let written = if light.written.is_empty() { "–".into() } else { light.written.clone() };
    let blocked = match &light.blocked {
        None => "nothing".into(),
        Some((part, name)) => format!("{:.0} %, by {:?}", 100.0 * part, visible(name)),
    };
    [
        visible(&light.name).into(),
        light.kind.into(),
        visible(&written).into(),
        energy(light.power, Dimension::Power),
        seen(light.power, Dimension::Power),
        seen(light.intensity, Dimension::Intensity),
        seen(light.radiance, Dimension::Radiance),
        energy(Some(light.irradiance), Dimension::Irradiance),
        seen(Some(light.irradiance), Dimension::Irradiance),
        blocked,
    ]
}

fn as_json(args: &LightsArgs, passport: &Passport, warnings: &Warnings) -> Value {
    let efficacy = passport.luminous_efficacy;
    let channels = |value: Option<Rgb>| value.map(|value| value.to_array());
    let seen = |value: Option<Rgb>| value.map(|value| units::photometric(value, efficacy));
    let light = |light: &Entry| {
        json!({
            "name": light.name,
            "kind": light.kind,
            "written": Some(&light.written).filter(|written| !written.is_empty()),
            "power_w": channels(light.power),
            "flux_lm": seen(light.power),
            "intensity_w_per_sr": channels(light.intensity),
            "intensity_cd": seen(light.intensity),
            "radiance_w_per_sr_m2": channels(light.radiance),
            "luminance_nit": seen(light.radiance),
            "irradiance_w_per_m2": light.irradiance.to_array(),
            "illuminance_lx": units::photometric(light.irradiance, efficacy),
            "blocked": light.blocked.as_ref().map_or(0.0, |(part, _)| *part),
            "blocked_by": light.blocked.as_ref().map(|(_, name)| name),
        })
    };
    json!({
        "scene": args.picture.input.name(),
        "luminous_efficacy": efficacy,
        "middle_m": passport.middle.to_array(),
        "surface": passport.surface,
        "lights": passport.lights.iter().map(light).collect::<Value>(),
        "warnings": report::as_json(warnings),
    })
}
