//! `firstlight render`: a picture of a scene or model.

use crate::args::{FormatName, OutputArgs, RenderArgs};
use crate::check::triangles;
use crate::compare::Reference;
use crate::denoise::{self, Copy, Written};
use crate::layers::{self, Scenes};
use crate::machine::{self, Signal};
use crate::output::{Output, print_json};
use crate::report::{self, Bar};
use crate::{Exit, Failure, Outcome, false_color, verdict};
use firstlight::color::View;
use firstlight::compare::Measured;
use firstlight::diagnostic::{Diagnostic, Result, visible};
use firstlight::doctor::{Care, Doctor};
use firstlight::io::{Develop, Format, Metadata, PartInfo, Warnings, save, save_part};
use firstlight::layers::{Guides, LightLayers};
use firstlight::render::{
    Crop, PASS as SAMPLES_PER_PASS, Progress, RenderOptions, Rendered, Stop, render, render_guides,
    render_layers, with_threads,
};
use firstlight::{Image, Scene, SceneDescription, auto_exposure};
use serde_json::{Value, json};
use std::ops::ControlFlow;
use std::time::Instant;

/// Bytes of memory per pixel: the film's sums and the picture that becomes of them.
const PIXEL_BYTES: u64 = 96;
/// The same where the sums are kept in two halves.
const HALVED_PIXEL_BYTES: u64 = 176;
/// Bytes of memory per pixel of a part: the sums three times over, on their way to the file.
const PART_PIXEL_BYTES: u64 = 352;
/// Bytes more where it is to be denoised: the guides, and framed copies of them and of the picture.
const DENOISED_PIXEL_BYTES: u64 = 112;

/// A picture with what it takes to show it.
pub(crate) struct Picture {
    pub rendered: Rendered,
    pub exposure_ev: f64,
    pub auto_exposure: bool,
    pub view: View,
    pub format: Format,
}

pub(crate) fn run(args: RenderArgs) -> Outcome {
    let mut clock = Clock::start();
    let output = plan(&args)?;
    layers::check_format(&args, &output)?;
    false_color::check_format(&args, &output)?;
    let threads = args.picture.threads();
    let copies = args.denoise && args.samples.is_none();
    let copy = copies.then(|| Copy::plan(&output, threads)).transpose()?;
    let mut warnings = Warnings::new();
    let access = args.picture.input.access();
    let scene = with_threads(threads, || args.picture.prepare(&access, &mut warnings))?;
    output.spare(&access.opened())?;
    copy.iter().try_for_each(|copy| copy.spare(&access.opened()))?;
    denoise::check(&args, &scene)?;
    check_size(&scene, &args)?;
    check_samples(&scene, args.samples)?;
    let size = args.crop.map_or([scene.film.width, scene.film.height], |c| [c.width, c.height]);
    let reference =
        args.reference.as_deref().map(|path| Reference::load(path, size)).transpose()?;
    warnings.extend(verdict::opaque(&scene, output.format));
    clock.lap("load");
    let level = args.picture.level();
    let built = with_threads(threads, || Scene::build_with(&scene, level, args.build.into()));
    layers::check_size(&args, &built)?;
    clock.lap("build");
    let doctor = Doctor::new(&scene, &built);
    warnings.extend(doctor.examine(Care::Quick));
    let mut warnings = args.findings.heeded(warnings);
    report::warnings(&warnings);
    clock.lap("check");
    let signal = Signal::listen();
    let guides = args.denoise.then(|| {
        let guides = render_guides(&built, threads, args.crop);
        clock.lap("guides");
        guides
    });
    let (picture, lights) = draw(&args, threads, &built, output.format, &signal);
    clock.lap("render");
    let shown = verdict::shown(&picture, picture.rendered.noise);
    let doubts = args.findings.heeded(doctor.judge(&shown));
    report::warnings(&doubts);
    warnings.extend(doubts);
    let scenes = Scenes { description: &scene, built: &built, threads, signal: &signal };
    match (&args.aov, lights) {
        (Some(wanted), Some(lights)) => {
            let metadata = metadata(&info(&args, &scene, &picture), &picture);
            output.write(&layers::encode(wanted, &scenes, &picture, &lights, &metadata)?)?;
        }
        _ => write(&args, &scenes, &picture, guides.as_ref(), &output)?,
    }
    clock.lap("write");
    let denoised = copy.zip(guides).map(|(copy, guides)| {
        let metadata = metadata(&info(&args, &scene, &picture), &picture);
        let written = copy.write(&picture, &guides, metadata, !args.output.no_dither);
        clock.lap("denoise");
        written
    });
    let reference = reference.map(|reference| {
        let (film, exposure_ev) = (&picture.rendered.film, picture.exposure_ev as f32);
        let measured = Measured::of_film(film, Some(exposure_ev), picture.view);
        reference.compare(&measured, args.threshold)
    });
    let differs = reference.as_ref().is_some_and(|(comparison, _)| !comparison.same);
    let reference = reference.map(|(_, json)| json);
    let done = Done {
        args: &args,
        scene,
        built,
        picture,
        output,
        denoised,
        threads,
        warnings,
        clock,
        reference,
    };
    done.report()?;
    // The picture is reported in any case.
    done.denoised.transpose()?;
    Ok(signal.exit().unwrap_or(match args.findings.strict && !done.warnings.is_empty() {
        true => Exit::Strict,
        false if differs => Exit::Differs,
        false => Exit::Done,
    }))
}

/// Where the picture or the part of it goes.
fn plan(args: &RenderArgs) -> Outcome<Output> {
    let stem = args.picture.input.stem();
    let Some([from, to]) = args.samples else {
        let OutputArgs { path, format, no_dither } = &args.output;
        let format =
            format.or(args.aov.as_ref().map(|_| FormatName::Exr).filter(|_| path.is_none()));
        let output = OutputArgs { path: path.clone(), format, no_dither: *no_dither };
        return Output::plan(&output, stem, args.json);
    };
    let mut stem = stem.to_owned();
    stem.push(format!(".{from}-{to}"));
    Output::plan_part(&args.output, &stem, args.json)
}

/// Whether the picture has the samples that are asked for.
fn check_samples(scene: &SceneDescription, samples: Option<[u32; 2]>) -> Result<()> {
    let all = scene.film.samples;
    let Some([from, to]) = samples.filter(|[_, to]| *to > all) else { return Ok(()) };
    let message = format!("{from}..{to} reaches beyond the {all} samples per pixel of the picture");
    let help =
        format!("say with --spp, in every part, how many there are in all, such as --spp {to}");
    Err(Box::new(Diagnostic::new("--samples", message).help(help)))
}

/// Whether the crop lies inside the picture, and the picture inside the memory there is.
fn check_size(scene: &SceneDescription, args: &RenderArgs) -> Result<()> {
    let (width, height) = (scene.film.width, scene.film.height);
    let crop = args.crop.unwrap_or(Crop { x: 0, y: 0, width, height });
    let inside =
        |start: u32, length: u32, end: u32| u64::from(start) + u64::from(length) <= end.into();
    if !inside(crop.x, crop.width, width) || !inside(crop.y, crop.height, height) {
        let Crop { x, y, width: w, height: h } = crop;
        let message = format!("{x},{y},{w},{h} reaches beyond the picture of {width} × {height}");
        return Err(Box::new(Diagnostic::new("--crop", message)));
    }
    let pixel_bytes = match args.samples {
        Some(_) => PART_PIXEL_BYTES,
        None if args.is_endless() => HALVED_PIXEL_BYTES,
        None => PIXEL_BYTES,
    } + if args.denoise { DENOISED_PIXEL_BYTES } else { 0 };
    let needed = u64::from(crop.width) * u64::from(crop.height) * pixel_bytes;
    match machine::available_memory() {
        Some(available) if needed > available => Err(too_large(crop, needed, available)),
        _ => Ok(()),
    }
}

fn too_large(Crop { width, height, .. }: Crop, needed: u64, available: u64) -> Box<Diagnostic> {
    let (needed, available) = (needed >> 20, available >> 20);
    let message = format!(
        "a picture of {width} × {height} needs {needed} MiB of memory; {available} MiB are available"
    );
    Box::new(
        Diagnostic::new("", message).help("use a smaller -r, or render it in parts with --crop"),
    )
}

/// Renders, showing progress, until done or told to stop.
fn draw(
    args: &RenderArgs,
    threads: usize,
    scene: &Scene,
    format: Format,
    signal: &Signal,
) -> (Picture, Option<LightLayers>) {
    let options = RenderOptions {
        threads,
        crop: args.crop,
        samples: args.samples,
        endless: args.is_endless(),
        // With a given number of samples, that is where it ends.
        noise: args.noise,
    };
    let bar = Bar::new(!args.quiet && !args.json);
    let limits = Limits { signal, start: Instant::now(), args };
    let observe = |progress: Progress| {
        bar.show(progress, limits.used(progress));
        limits.judge(progress)
    };
    let (mut rendered, lights) = match &args.aov {
        None => (render(scene, &options, &observe), None),
        Some(_) => {
            let (rendered, lights) = render_layers(scene, &options, &observe);
            (rendered, Some(lights))
        }
    };
    bar.finish();
    rendered.interrupted |= signal.asked();
    let film = scene.film();
    let stops = film.exposure.stops(scene.luminous_efficacy());
    (Picture::new(rendered, stops, film.view, format), lights)
}

impl RenderArgs {
    /// Whether the number of samples is not known from the start.
    fn is_endless(&self) -> bool {
        self.noise.is_some()
            || (self.time.is_some() && self.picture.spp.is_none() && self.samples.is_none())
    }
}

impl Picture {
    /// With the exposure that is asked for, or found from the picture.
    pub(crate) fn new(rendered: Rendered, stops: Option<f64>, view: View, format: Format) -> Self {
        let exposure_ev = stops.unwrap_or_else(|| auto_exposure(&rendered.image));
        Self { rendered, exposure_ev, auto_exposure: stops.is_none(), view, format }
    }
}

/// What may end a render early.
struct Limits<'a> {
    signal: &'a Signal,
    start: Instant,
    args: &'a RenderArgs,
}

impl Limits<'_> {
    /// Whether to go on. A part ends when all of its pixels have the same samples, so that the rest can be rendered later.
    fn judge(&self, progress: Progress) -> ControlFlow<Stop> {
        if self.signal.asked() {
            let part = self.args.samples.is_some();
            return ControlFlow::Break(if part { Stop::AfterPass } else { Stop::Now });
        }
        let too_many =
            self.args.is_endless() && self.args.picture.spp.is_some_and(|n| progress.samples >= n);
        if too_many || self.is_late(progress) {
            return ControlFlow::Break(Stop::AfterPass);
        }
        ControlFlow::Continue(())
    }

    /// Whether the time is over, or would be before half of another pass is done.
    fn is_late(&self, progress: Progress) -> bool {
        let Some(limit) = self.args.time else { return false };
        let elapsed = self.start.elapsed().as_secs_f64();
        let passes = f64::from(progress.samples.div_ceil(SAMPLES_PER_PASS).max(1));
        let soon = if progress.whole { 0.5 * elapsed / passes } else { 0.0 };
        elapsed + soon > limit.as_secs_f64()
    }

    /// The part of the work or of the time that is used up.
    fn used(&self, progress: Progress) -> f64 {
        let of = |part: f64, whole: f64| part / whole;
        let time = self
            .args
            .time
            .map_or(0.0, |limit| of(self.start.elapsed().as_secs_f64(), limit.as_secs_f64()));
        let samples =
            self.args.picture.spp.map_or(0.0, |spp| of(progress.samples.into(), spp.into()));
        progress.done.max(time).max(samples).min(1.0)
    }
}

fn write(
    args: &RenderArgs,
    scenes: &Scenes<'_>,
    picture: &Picture,
    guides: Option<&Guides>,
    output: &Output,
) -> Outcome<()> {
    let info = info(args, scenes.description, picture);
    let metadata = metadata(&info, picture);
    if let Some(quantity) = args.false_color {
        let (range, format) = (args.false_color_range, output.format);
        let bytes = false_color::encode(quantity, range, scenes, picture, format, &metadata)?;
        return output.write(&bytes);
    }
    if args.samples.is_none() {
        let (image, dither) = (&picture.rendered.image, !args.output.no_dither);
        return write_picture(image, picture, &metadata, dither, output);
    }
    let saved = save_part(&info, &picture.rendered.film, guides);
    let bytes = saved.map_err(|error| Failure { exit: Exit::Failed, error })?;
    output.write(&bytes)
}

/// Writes an image as `picture` is to be shown, and how it was made.
pub(crate) fn write_picture(
    image: &Image,
    picture: &Picture,
    metadata: &Metadata,
    dither: bool,
    output: &Output,
) -> Outcome<()> {
    let develop = Develop { exposure_ev: picture.exposure_ev as f32, view: picture.view, dither };
    let bytes = save(image, output.format, develop, metadata)
        .map_err(|error| Failure { exit: Exit::Failed, error })?;
    output.write(&bytes)
}

/// What the picture shows, and which samples it has.
fn info(args: &RenderArgs, scene: &SceneDescription, picture: &Picture) -> PartInfo {
    let (film, rendered) = (&scene.film, &picture.rendered);
    let [from, _] = args.samples.unwrap_or_default();
    let ([x, y], [width, height]) = (rendered.film.origin(), rendered.film.size());
    PartInfo {
        software: Metadata::default().software,
        // Only those who have parts to compare need it.
        fingerprint: args.samples.map_or(String::new(), |_| scene.fingerprint()),
        scene: args.picture.input.name(),
        camera: camera_name(scene).to_owned(),
        resolution: [film.width, film.height],
        crop: [x, y, width, height],
        samples: film.samples,
        seed: film.seed,
        exposure: film.exposure.stops(scene.luminous_efficacy),
        view: film.view,
        ranges: vec![[from, from + rendered.samples]],
    }
}

/// How the picture was made.
pub(crate) fn metadata(info: &PartInfo, picture: &Picture) -> Metadata {
    let ([width, height], [x, y, w, h]) = (info.resolution, info.crop);
    let crop =
        if [w, h] == [width, height] { String::new() } else { format!(", crop {x},{y},{w},{h}") };
    let entries = [
        ("Scene", info.scene.clone()),
        ("Resolution", format!("{width}x{height}{crop}")),
        ("Samples", info.count().to_string()),
        ("Seed", info.seed.to_string()),
        ("Exposure", format!("{:+} EV", picture.exposure_ev)),
        ("View", picture.view.name().to_owned()),
        ("Camera", info.camera.clone()),
        ("Command", command_line()),
    ];
    let entries = entries.map(|(key, text)| (key.to_owned(), text)).to_vec();
    Metadata { entries, ..Metadata::default() }
}

/// The camera in use.
fn camera_name(scene: &SceneDescription) -> &str {
    scene.cameras.first().map_or("frame", |camera| &camera.name)
}

/// The command as it was typed, in quotation marks where a shell needs them.
fn command_line() -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_=+./,:@%".contains(c);
    let quoted = |text: String| match !text.is_empty() && text.chars().all(plain) {
        true => text,
        false => format!("'{}'", text.replace('\'', r"'\''")),
    };
    let words = std::env::args_os().skip(1).map(|word| quoted(word.to_string_lossy().into_owned()));
    std::iter::once("firstlight".into()).chain(words).collect::<Vec<_>>().join(" ")
}

/// Everything there is to report about a picture that was written.
struct Done<'a> {
    args: &'a RenderArgs,
    scene: SceneDescription,
    built: Scene,
    picture: Picture,
    output: Output,
    denoised: Option<Outcome<Written>>,
    threads: usize,
    warnings: Warnings,
    clock: Clock,
    /// How it compares with a reference.
    reference: Option<Value>,
}

impl Done<'_> {
    fn report(&self) -> Outcome<()> {
        if self.args.json {
            let mut json = self.json();
            if let Some(reference) = &self.reference {
                json["reference"] = reference.clone();
            }
            return print_json(&json);
        }
        if !self.args.quiet {
            report::line(visible(&self.line()));
            self.copy().iter().for_each(|copy| report::line(visible(&copy.line())));
        }
        Ok(())
    }

    /// The denoised copy, if it was made.
    fn copy(&self) -> Option<&Written> {
        self.denoised.as_ref().and_then(|copy| copy.as_ref().ok())
    }

    fn rays_per_second(&self) -> f64 {
        let rays = self.picture.rendered.rays;
        rays.total() as f64 / self.clock.seconds("render").max(1e-9)
    }

    /// `wrote out.png: 1280×720, 16 spp, noise at most 3.2 %, 1.2 s, 23 Mrays/s`.
    fn line(&self) -> String {
        let rendered = &self.picture.rendered;
        let (width, height) = (rendered.image.width(), rendered.image.height());
        let what = if rendered.interrupted { "stopped early and wrote" } else { "wrote" };
        let exposure = match self.picture.auto_exposure {
            true => format!(", exposure {:+.2} EV (auto)", self.picture.exposure_ev),
            false => String::new(),
        };
        let (time, rate) = (report::span(self.clock.total()), report::rate(self.rays_per_second()));
        let output = self.output.name();
        let samples = report::samples(rendered.samples, rendered.spread);
        let noise = report::noise(rendered.noise, !self.args.is_endless());
        let clamped = report::clamped(&self.scene, rendered.clamped);
        format!(
            "{what} {output}: {width}×{height}, {samples}{noise}{clamped}{exposure}, {time}, {rate}"
        )
    }

    fn json(&self) -> Value {
        let (rendered, scene) = (&self.picture.rendered, &self.scene);
        json!({
            "scene": self.args.picture.input.name(),
            "output": self.output.name(),
            "denoised": self.copy().map(Written::json),
            "width": rendered.image.width(),
            "height": rendered.image.height(),
            "samples": rendered.samples,
            "samples_per_pixel": {
                "min": rendered.spread.fewest,
                "mean": rendered.spread.mean,
                "max": rendered.spread.most,
            },
            "interrupted": rendered.interrupted,
            "noise": report::noise_json(rendered.noise, !self.args.is_endless()),
            "clamped": scene.film.clamp.map(|_| rendered.clamped),
            "seconds": self.clock.json(),
            "rays": {
                "camera": rendered.rays.camera,
                "bounce": rendered.rays.bounce,
                "shadow": rendered.rays.shadow,
            },
            "rays_per_second": self.rays_per_second(),
            "memory": {
                "peak_bytes": machine::peak_memory(),
                "tree_bytes": self.built.tree_memory(),
            },
            "triangles": triangles(scene),
            "surfaces": scene.surfaces.len(),
            "lights": scene.lights.len(),
            "threads": self.threads,
            "simd": self.built.level().name(),
            "seed": scene.film.seed,
            "exposure_ev": self.picture.exposure_ev,
            "luminous_efficacy": scene.luminous_efficacy.0,
            "dropped_samples": rendered.dropped,
            "warnings": report::as_json(&self.warnings),
        })
    }
}

/// How long each stage took.
struct Clock {
    start: Instant,
    laps: Vec<(&'static str, f64)>,
}

impl Clock {
    fn start() -> Self {
        Self { start: Instant::now(), laps: Vec::new() }
    }

    fn total(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }

    /// Ends the stage `name`.
    fn lap(&mut self, name: &'static str) {
        let before: f64 = self.laps.iter().map(|(_, seconds)| seconds).sum();
        self.laps.push((name, self.total() - before));
    }

    fn seconds(&self, name: &str) -> f64 {
        self.laps.iter().find(|lap| lap.0 == name).map_or(0.0, |lap| lap.1)
    }

    fn json(&self) -> Value {
        let laps = self.laps.iter().map(|&(name, seconds)| (name.to_owned(), json!(seconds)));
        laps.chain([("total".to_owned(), json!(self.total()))]).collect()
    }
}
