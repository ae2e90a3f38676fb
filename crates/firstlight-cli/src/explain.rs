//! `firstlight explain`: why a pixel has the colour it has.

use crate::args::ExplainArgs;
use crate::output::{print, print_json};
use crate::{Exit, Failure, Outcome, drawing, report};
use firstlight::diagnostic::{Diagnostic, visible};
use firstlight::explain::{
    Explanation, Lighting, Met, Shadow, Shown, Step, Term, Verdict, differences, explain,
    light_names,
};
use firstlight::io::{self, Warnings};
use firstlight::render::{RenderOptions, render, with_threads};
use firstlight::units;
use firstlight::{BuildQuality, Scene, SceneDescription, auto_exposure};
use serde_json::json;
use std::collections::BTreeSet;
use std::fmt::{self, Display, Formatter, Write};
use std::ops::ControlFlow;

pub(crate) fn run(args: &ExplainArgs) -> Outcome {
    let mut warnings = Warnings::new();
    let threads = args.picture.threads();
    let description = args.picture.prepare(&args.picture.input.access(), &mut warnings)?;
    report::warnings(&warnings);
    for pixel in [Some(args.pixel), args.compare].into_iter().flatten() {
        check_pixel(&description, pixel)?;
    }
    let level = args.picture.level();
    let scene =
        with_threads(threads, || Scene::build_with(&description, level, BuildQuality::Final));
    if let Some(name) = &args.why_not {
        check_light(&light_names(&scene, &description), name)?;
    }
    let exposure = exposure(&scene, threads);
    let explanation = explain(&scene, &description, args.pixel, exposure);
    let other = args.compare.map(|pixel| explain(&scene, &description, pixel, exposure));
    if let Some(path) = &args.svg {
        let drawn = drawing::svg(&explanation);
        io::write(path, drawn.as_bytes()).map_err(|error| Failure { exit: Exit::Failed, error })?;
    }
    match (args.json, &other) {
        (true, None) => print_json(&json!(explanation))?,
        (true, Some(other)) => print_json(&json!({
            "first": explanation,
            "second": other,
            "differences": differences(&explanation, other),
        }))?,
        (false, None) => print(Text { args, explanation: &explanation }.to_string().as_bytes())?,
        (false, Some(other)) => print(comparison(&explanation, other).as_bytes())?,
    }
    Ok(Exit::Done)
}

fn check_pixel(scene: &SceneDescription, [x, y]: [u32; 2]) -> Outcome<()> {
    let (width, height) = (scene.film.width, scene.film.height);
    if x < width && y < height {
        return Ok(());
    }
    let message = format!("{x},{y} is outside of the picture of {width} × {height}");
    let help = format!("the lower right corner is {},{}", width - 1, height - 1);
    Err(Diagnostic::new("--pixel", message).help(help).into())
}

/// Whether there is a light of that name.
fn check_light(known: &BTreeSet<String>, name: &str) -> Outcome<()> {
    if known.contains(name) {
        return Ok(());
    }
    let error = Diagnostic::new("--why-not", format!("there is no light \"{name}\""));
    let known = known.iter().map(String::as_str).collect::<Vec<_>>().join(", ");
    Err(error.help(format!("there are {known}")).into())
}

/// The exposure of the picture; to find it automatically, all of it has to be rendered.
fn exposure(scene: &Scene, threads: usize) -> f64 {
    scene.film().exposure.stops(scene.luminous_efficacy()).unwrap_or_else(|| {
        let options = RenderOptions { threads, ..RenderOptions::default() };
        auto_exposure(&render(scene, &options, &|_| ControlFlow::Continue(())).image)
    })
}

/// An explanation in words.
struct Text<'a> {
    args: &'a ExplainArgs,
    explanation: &'a Explanation,
}

impl Display for Text<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Explanation { pixel: [x, y], samples, sample, path, .. } = self.explanation;
        let name = self.args.picture.input.name();
        writeln!(
            f,
            "pixel {x},{y} of {}: sample {sample} of {samples}, from the camera",
            visible(&name)
        )?;
        if let Some(light) = &self.args.why_not {
            return self.why_not(f, light);
        }
        for (number, step) in path.iter().enumerate() {
            self.step(f, number, step)?;
        }
        self.sum(f)?;
        writeln!(f, "\n{}", self.explanation.cause.text)
    }
}

impl Text<'_> {
    fn step(&self, f: &mut Formatter<'_>, number: usize, step: &Step) -> fmt::Result {
        let what = if number == 0 { "camera ray".into() } else { format!("bounce {number}") };
        write!(f, "\n{what:<12} from {} along {}", triple(step.origin), triple(step.direction))?;
        let (from, to) = step.t_range;
        if from != 0.0 || to.is_some() {
            write!(f, ", between {from} m and {}", to.map_or("∞".into(), |to| format!("{to} m")))?;
        }
        writeln!(f)?;
        match &step.met {
            Some(met) => self.met(f, met)?,
            None => match step.scattered_after {
                Some(distance) => {
                    let away = units::format(distance.into(), "m");
                    writeln!(f, "{:<12} fog, which scatters it after {away}", "meets")?;
                }
                None => writeln!(f, "{:<12} nothing", "meets")?,
            },
        }
        if step.throughput != [1.0; 3] {
            writeln!(f, "{:<12} × {} on the way to the eye", "", triple(step.throughput))?;
        }
        for (source, radiance) in &step.gained {
            let gives = triple(*radiance);
            writeln!(f, "{:<12} {} gives {gives} W/(sr m²)", "", visible(source))?;
        }
        step.air.iter().try_for_each(|light| self.light(f, light))?;
        step.lights.iter().try_for_each(|light| {
            self.light(f, light)?;
            if number == 0 { self.rays_to(f, &light.source) } else { Ok(()) }
        })
    }

    /// What became of all shadow rays to a light from the surface that most samples met.
    fn rays_to(&self, f: &mut Formatter<'_>, light: &str) -> fmt::Result {
        let of_light = |shadow: &&Shadow| shadow.source == light && shadow.rays > 1;
        let Some(shadow) = self.explanation.shadows.iter().find(of_light) else { return Ok(()) };
        let Shadow { rays, blocked, blocker: Some(by), distance: Some(distance), .. } = shadow
        else {
            return Ok(());
        };
        let (by, away) = (visible(by), units::format(*distance, "m"));
        writeln!(
            f,
            "{:<12}   {blocked} of {rays} shadow rays of this pixel are blocked, mostly by '{by}', on average after {away}",
            ""
        )
    }

    fn met(&self, f: &mut Formatter<'_>, met: &Met) -> fmt::Result {
        let side = if met.front { "front" } else { "back" };
        let (surface, material) = (visible(&met.surface), visible(&met.material));
        let away = units::format(met.distance.into(), "m");
        writeln!(f, "{:<12} '{surface}' ({material}), its {side}, after {away}", "meets")?;
        let place = triple(met.position);
        let [u, v] = met.uv.map(digits);
        writeln!(f, "{:<12} at {place}, part {}, uv ({u}, {v})", "", met.primitive)?;
        let normal = triple(met.geometric_normal);
        match met.geometric_normal == met.shading_normal {
            true => writeln!(f, "{:<12} {normal}", "normal")?,
            false => writeln!(
                f,
                "{:<12} {normal}, for shading {}",
                "normal",
                triple(met.shading_normal)
            )?,
        }
        for value in &met.values {
            let numbers = value.value.iter().copied().map(digits).collect::<Vec<_>>().join(", ");
            writeln!(f, "{:<12} {numbers}", value.name)?;
        }
        for ignored in &met.ignored {
            let away = units::format(ignored.distance.into(), "m");
            writeln!(
                f,
                "{:<12} '{}' after {away}: {}",
                "not met",
                visible(&ignored.surface),
                ignored.why
            )?;
        }
        Ok(())
    }

    fn light(&self, f: &mut Formatter<'_>, light: &Lighting) -> fmt::Result {
        let Lighting { source, kind, .. } = light;
        write!(f, "{:<12} '{}' ({kind})", "light", visible(source))?;
        if let Some(after) = light.after {
            write!(
                f,
                ", asked for all of the way in fog after {}",
                units::format(after.into(), "m")
            )?;
        }
        if let (Some(distance), Some(factor)) = (light.distance, light.geometry_factor) {
            let (away, factor) = (units::format(distance.into(), "m"), digits(factor));
            write!(f, ", {away} away, 1/r² {factor} /m²")?;
        }
        if let Some(cos) = light.cos {
            write!(f, ", cos θ {}", digits(cos))?;
        }
        writeln!(f, ": {}", verdict(light))?;
        if light.irradiance != [0.0; 3] {
            irradiance(f, light)?;
        }
        if light.radiance != [0.0; 3] {
            let (bsdf, radiance) = (triple(light.bsdf), triple(light.radiance));
            let share = percent(light.share);
            writeln!(
                f,
                "{:<12}   f = {bsdf} /sr gives {radiance} W/(sr m²), in all {share} of the pixel",
                ""
            )?;
        }
        Ok(())
    }

    fn sum(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Explanation { radiance, terms, samples, luminance, shown, .. } = self.explanation;
        writeln!(f, "\nsum over {samples} samples, W/(sr m²)")?;
        for term in terms {
            let Term { source, share, .. } = term;
            let noise = match self.args.noise {
                true => format!(", {} of the noise", percent(term.noise_share)),
                false => String::new(),
            };
            let (rgb, way) = (triple(term.radiance.map(|x| x as f32)), way(term.reflections));
            writeln!(f, "  {rgb:<32} '{}' {way}: {}{noise}", visible(source), percent(*share))?;
        }
        writeln!(f, "= {} or {}", triple(*radiance), units::format(*luminance, "nit"))?;
        let Shown { exposure_ev, view, display, code: [r, g, b] } = shown;
        let view = view.name();
        writeln!(f, "× 2^{exposure_ev}, view {view}: {} or {r}, {g}, {b} of 255", triple(*display))
    }

    /// What one light does here, in the air before and on the surface.
    fn why_not(&self, f: &mut Formatter<'_>, name: &str) -> fmt::Result {
        let step = self.explanation.path.first();
        let lights = || step.into_iter().flat_map(|step| step.air.iter().chain(&step.lights));
        let asked: Vec<_> = lights().filter(|light| light.source == name).collect();
        let Some(last) = asked.last() else {
            let known: BTreeSet<_> = lights().map(|light| light.source.as_str()).collect();
            let known = known.into_iter().collect::<Vec<_>>().join(", ");
            let known = if known.is_empty() { "none".into() } else { visible(&known).to_string() };
            return writeln!(f, "no light '{}' is asked here; there are: {known}", visible(name));
        };
        asked.iter().try_for_each(|light| self.light(f, light))?;
        self.rays_to(f, name)?;
        let share = percent(last.share);
        writeln!(f, "\nlight '{}' makes {share} of the pixel: {}", visible(name), verdict(last))
    }
}

/// What arrives of a light, and by what chance that stands for more.
fn irradiance(f: &mut Formatter<'_>, light: &Lighting) -> fmt::Result {
    let Lighting { irradiance, illuminance, arriving_irradiance, arriving, .. } = light;
    let (lux, arriving) = (units::format(*illuminance, "lx"), units::format(*arriving, "lx"));
    let (e, lux, note) = match light.verdict {
        Verdict::Tinted { .. } => {
            (arriving_irradiance, arriving, format!(" on the surface, {lux} before panes and fog"))
        }
        Verdict::Blocked { .. } => (irradiance, lux, ", were nothing in the way".into()),
        _ => (irradiance, lux, " on the surface".into()),
    };
    let sampled = match light.solid_angle {
        Some(sr) => format!(", by this sample for {} sr", digits(sr)),
        None if light.sampled => ", by this sample".into(),
        None => String::new(),
    };
    writeln!(f, "{:<12}   E = {} W/m² = {lux}{note}{sampled}", "", triple(*e))?;
    if light.weight < 1.0 {
        let weight = digits(light.weight);
        writeln!(f, "{:<12}   × {weight}: the rest is left to rays that meet it by chance", "")?;
    }
    if light.chance < 1.0 {
        let (chance, times) = (percent(light.chance.into()), digits(light.chance.recip()));
        writeln!(f, "{:<12}   × {times}: it was asked for all, with a chance of {chance}", "")?;
    }
    Ok(())
}

fn verdict(light: &Lighting) -> String {
    match &light.verdict {
        Verdict::Lit => "nothing is in the way".into(),
        Verdict::Tinted { passed } => {
            format!("passes through panes or fog that leave {}", triple(*passed))
        }
        Verdict::Unshadowed => "casts no shadows".into(),
        Verdict::Blocked { by, distance, at } => {
            let away = units::format((*distance).into(), "m");
            format!("blocked by '{}' after {away}, at {}", visible(by), triple(*at))
        }
        Verdict::FacesAway if light.kind == "environment" => {
            "this sample looks for it below the surface's horizon".into()
        }
        Verdict::FacesAway => "behind the surface, which faces away from it".into(),
        Verdict::InsideOfIt => "this is inside of its sphere, where it gives nothing".into(),
        Verdict::OutsideBeam => "does not shine this way".into(),
        Verdict::NotScattered => "nothing of it is scattered this way".into(),
        Verdict::NotAsked => "not asked: another one was, for all".into(),
    }
}

fn way(reflections: u32) -> String {
    match reflections {
        0 => "seen itself".into(),
        1 => "direct".into(),
        n => format!("after {n} reflections"),
    }
}

/// What differs between two pixels.
fn comparison(first: &Explanation, second: &Explanation) -> String {
    let mut text = String::new();
    let name = |e: &Explanation| {
        let [x, y] = e.pixel;
        let met = e.path.first().and_then(|step| step.met.as_ref());
        let on = met.map_or("background".into(), |met| format!("'{}'", visible(&met.surface)));
        let [r, g, b] = e.shown.code;
        format!("{x},{y} on {on}: {}, {r}, {g}, {b} of 255", units::format(e.luminance, "nit"))
    };
    let mut differences = differences(first, second);
    differences.retain(|difference| difference.radiance != [0.0; 3]);
    // Writing to a string cannot fail.
    let _ = writeln!(text, "{}\n{}\n", name(first), name(second));
    let _ = match (differences.is_empty(), first.terms.is_empty()) {
        (true, true) => writeln!(text, "nothing differs: no light comes from either"),
        (true, false) => writeln!(text, "nothing differs: the same light comes from both"),
        (false, _) => writeln!(text, "what the second has more, W/(sr m²)"),
    };
    for difference in differences {
        let rgb = triple(difference.radiance.map(|x| x as f32));
        let (source, way) = (visible(&difference.source), way(difference.reflections));
        let share = percent(difference.share);
        let _ = writeln!(text, "  {rgb:<32} '{source}' {way}: {share} of the difference");
    }
    let _ = writeln!(text, "\nfirst:  {}\nsecond: {}", first.cause.text, second.cause.text);
    text
}

fn percent(part: f64) -> String {
    match 100.0 * part {
        percent if percent.abs() >= 10.0 || percent == 0.0 => format!("{percent:.0} %"),
        percent => format!("{percent:.2} %"),
    }
}

fn triple([x, y, z]: [f32; 3]) -> String {
    format!("({}, {}, {})", digits(x), digits(y), digits(z))
}

/// A number to five significant digits.
fn digits(value: f32) -> String {
    let rounded: f32 = format!("{value:.4e}").parse().unwrap_or(value);
    match rounded.abs() {
        0.0 => "0".into(),
        1e-4..1e6 => rounded.to_string(),
        _ => format!("{rounded:e}"),
    }
}
