//! What can be written on the command line.

use crate::measure::Requests;
use clap::{Args, Parser, Subcommand, ValueEnum};
use firstlight::color::{Rgb, View};
use firstlight::doctor::CODES;
use firstlight::io::scene_file::Override;
use firstlight::io::{BitDepth, Format, Precision};
use firstlight::layers::Layer;
use firstlight::render::Crop;
use firstlight::scene::description::{Exposure, FilmDescription, Section};
use firstlight::units::{Dimension, Measure, Quantity};
use firstlight::verify::GROUPS;
use firstlight::{BuildQuality, Level, Look};
use glam::DVec3;
use std::path::PathBuf;
use std::time::Duration;

/// From a model or scene file to a correctly lit picture.
#[derive(Debug, Parser)]
#[command(name = "firstlight", version, max_term_width = 100, after_help = EXIT_CODES)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub command: Command,
}

const EXIT_CODES: &str = "\
Examples:
  firstlight render scene.toml -o picture.png
  firstlight render chair.glb --azimuth 60 -r 1920x1080
  firstlight explain scene.toml --pixel 320,180
  firstlight measure scene.toml --irradiance 0,0,0,0,0,1
  firstlight verify

Exit codes: 0 done, 1 failed, 2 wrong usage or bad input, 3 a strict check failed, 4 a comparison differs, 130 or 143 interrupted.";

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Render a picture of a scene or model
    Render(Box<RenderArgs>),
    /// Say why a pixel has the colour it has
    Explain(Box<ExplainArgs>),
    /// Look for what would make the picture of a scene black, white, noisy or wrong; writes nothing
    Check(Box<CheckArgs>),
    /// Show what is in a scene or model
    Info(InfoArgs),
    /// Show every light with its units, and what of it arrives in the middle of the scene
    Lights(Box<LightsArgs>),
    /// Say whether two pictures are the same, within their noise or to the eye
    Compare(CompareArgs),
    /// Print the JSON Schema of scene files, for editors
    Schema,
    /// Measure irradiance and radiance at points of a scene
    Measure(MeasureArgs),
    /// Make one picture of the parts that render --samples has written
    Merge(MergeArgs),
    /// Mix the lights of a picture again that render --aov light has written
    Relight(RelightArgs),
    /// Measure scenes whose light is known from a formula, and say whether it is right
    Verify(VerifyArgs),
}

/// Which scene, and what is laid over it.
#[derive(Debug, Args)]
pub(crate) struct InputArgs {
    /// A scene (.toml) or model (.gltf .glb .obj .ply .stl); - reads a scene from standard input
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,
    /// Set a value of the scene, such as lights.key.point.power="60 W"; may be repeated
    #[arg(short = 'D', value_name = "KEY=VALUE")]
    pub define: Vec<Override>,
    /// A folder besides the scene's own that files may be read from; may be repeated
    #[arg(long, value_name = "DIR")]
    pub allow_path: Vec<PathBuf>,
}

/// What a picture shows, and with what it is made.
#[derive(Debug, Args)]
pub(crate) struct PictureArgs {
    #[command(flatten)]
    pub input: InputArgs,
    /// Size of the picture in pixels
    #[arg(short, long, value_name = "WxH", value_parser = resolution, allow_hyphen_values = true)]
    pub resolution: Option<[u32; 2]>,
    /// Samples per pixel
    #[arg(long, value_name = "N", value_parser = samples(), allow_negative_numbers = true)]
    pub spp: Option<u32>,
    /// The camera to use; frame: one that shows everything [default: the scene's first]
    #[arg(long, value_name = "NAME")]
    pub camera: Option<String>,
    /// Stops of exposure (0: radiance 1 is white), auto, or a camera's settings: "1/125 f/8 ISO 100"
    #[arg(long, value_name = "EV|auto", value_parser = exposure, allow_hyphen_values = true)]
    pub exposure: Option<Exposure>,
    /// How bright light is brought into what screens show [default: srgb, cut off at white]
    #[arg(long, value_name = "srgb|neutral|agx|aces|filmic|raw", value_parser = view)]
    pub view: Option<View>,
    /// What the picture is for: clarity (shape, CAD), balanced (games), real (every way of light) [default: as the scene
    /// says]
    #[arg(long, value_name = "clarity|balanced|real", value_parser = look)]
    pub look: Option<Look>,
    /// For --look clarity: cut away what lies before the plane through a point, on the side of its normal
    #[arg(long, value_name = "X,Y,Z,NX,NY,NZ", value_parser = section, requires = "look")]
    #[arg(allow_hyphen_values = true)]
    pub section: Option<Section>,
    /// Make the background transparent
    #[arg(long)]
    pub transparent: bool,
    /// Leave out what light scattered more than once brings beyond this radiance, or nothing by "off"; the report says how
    /// much that was
    #[arg(long, value_name = "RADIANCE", value_parser = clamp, allow_hyphen_values = true)]
    pub clamp: Option<Switch<f64>>,
    /// Seed of every random number
    #[arg(long, value_name = "N", value_parser = seed)]
    #[arg(allow_negative_numbers = true)]
    pub seed: Option<u64>,
    /// Worker threads [default: one per processor]; the picture does not depend on it
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    #[arg(allow_negative_numbers = true)]
    pub threads: Option<u32>,
    /// Instructions to trace with: auto or a set that this processor has
    #[arg(long, value_name = "SET", value_parser = simd, default_value = "auto")]
    pub simd: Simd,
    #[command(flatten)]
    pub studio: StudioArgs,
}

#[derive(Debug, Args)]
#[command(after_help = RENDER_EXAMPLES)]
pub(crate) struct RenderArgs {
    #[command(flatten)]
    pub picture: PictureArgs,
    #[command(flatten)]
    pub output: OutputArgs,
    /// Stop after so long, such as 30s or 5min, when all pixels have as many samples; without --spp, take as many as fit
    #[arg(long, value_name = "TIME", value_parser = duration, allow_hyphen_values = true)]
    pub time: Option<Duration>,
    /// Stop when the standard error of pixels is this part of them, such as 2%
    #[arg(long, value_name = "PERCENT", value_parser = noise, allow_hyphen_values = true)]
    pub noise: Option<f64>,
    /// Take only these of all samples per pixel, from A up to, not including, B, and write a part (.exr) for merge
    #[arg(long, value_name = "A..B", value_parser = sample_range, allow_hyphen_values = true)]
    #[arg(conflicts_with = "noise")]
    pub samples: Option<[u32; 2]>,
    /// Work that goes into the scene's trees: preview starts sooner, final traces faster
    #[arg(long, value_enum, value_name = "QUALITY", default_value = "final")]
    pub build: BuildName,
    /// Render only this part of the picture, in pixels from its upper left corner
    #[arg(long, value_name = "X,Y,W,H", value_parser = crop, allow_hyphen_values = true)]
    pub crop: Option<Crop>,
    /// Layers to write beside the colour into an .exr file, such as depth,normal,light, or all; see docs/layers.md
    #[arg(long, value_name = "LAYERS", value_parser = layers, conflicts_with = "samples")]
    pub aov: Option<Layers>,
    /// Write a copy without noise beside the picture, by Open Image Denoise: picture.denoised.png; with --samples, put into
    /// the part what merge --denoise needs
    #[arg(long)]
    pub denoise: bool,
    /// Print a report as JSON on standard output
    #[arg(long)]
    pub json: bool,
    /// Print nothing but errors and warnings
    #[arg(short, long)]
    pub quiet: bool,
    /// Write a map of a quantity in colours, with a legend, instead of the picture
    #[arg(long, value_enum, value_name = "QUANTITY", conflicts_with_all = ["samples", "aov"])]
    pub false_color: Option<FalseColorName>,
    /// What the first and last colour stand for, such as 1..1000 (logarithmic) or 0..500 [default: as the picture needs]
    #[arg(long, value_name = "A..B", value_parser = range, requires = "false_color")]
    pub false_color_range: Option<[f64; 2]>,
    /// Compare the picture with this one, and end with exit code 4 if it differs
    #[arg(long, value_name = "FILE", conflicts_with_all = ["samples", "crop"])]
    pub reference: Option<PathBuf>,
    /// Mean FLIP up to which they are the same [default: their noise, else 0.01]
    #[arg(long, value_name = "FLIP", value_parser = flip, requires = "reference")]
    pub threshold: Option<f64>,
    #[command(flatten)]
    pub findings: FindingArgs,
}

/// What becomes of warnings.
#[derive(Debug, Args)]
pub(crate) struct FindingArgs {
    /// End with exit code 3 if there is any warning; what was asked for is done nevertheless
    #[arg(long)]
    pub strict: bool,
    /// Say nothing of findings with this code, such as light-off; may be repeated
    #[arg(long, value_name = "CODE", value_parser = codes(), hide_possible_values = true)]
    pub ignore: Vec<String>,
}

#[derive(Debug, Args)]
#[command(after_help = EXPLAIN_EXAMPLES)]
pub(crate) struct ExplainArgs {
    #[command(flatten)]
    pub picture: PictureArgs,
    /// The pixel, from the upper left corner of the picture, which is 0,0
    #[arg(long, value_name = "X,Y", value_parser = pixel, allow_hyphen_values = true)]
    pub pixel: [u32; 2],
    /// Another pixel: say what differs and by how much
    #[arg(long, value_name = "X,Y", value_parser = pixel, allow_hyphen_values = true)]
    pub compare: Option<[u32; 2]>,
    /// Say what this light does here, and if nothing, why not
    #[arg(long, value_name = "LIGHT")]
    pub why_not: Option<String>,
    /// Say which light and which reflection the noise comes from
    #[arg(long)]
    pub noise: bool,
    /// Draw the rays into this file
    #[arg(long, value_name = "FILE")]
    pub svg: Option<PathBuf>,
    /// Print it all as JSON
    #[arg(long)]
    pub json: bool,
}

const EXPLAIN_EXAMPLES: &str = "\
The pixel is made again as render makes it, with the same options; the sum of the explanation is its colour.

Examples:
  firstlight explain scene.toml --pixel 320,180
  firstlight explain scene.toml --pixel 320,180 --why-not key
  firstlight explain scene.toml --pixel 320,180 --compare 400,180
  firstlight explain chair.glb -r 640x360 --pixel 100,40 --svg rays.svg";

/// Where a picture goes.
#[derive(Debug, Args)]
pub(crate) struct OutputArgs {
    /// The picture; its extension says the format; - is standard output [default: named after what is read, with .png; of
    /// compare: none]
    #[arg(short = 'o', long = "output", value_name = "FILE")]
    pub path: Option<PathBuf>,
    /// File format, if the extension does not say it (- is written as png)
    #[arg(long, value_enum)]
    pub format: Option<FormatName>,
    /// Round to the nearest of the 256 steps of a PNG, which shows bands in soft shades
    #[arg(long)]
    pub no_dither: bool,
}

#[derive(Debug, Args)]
#[command(after_help = MERGE_EXAMPLES)]
pub(crate) struct MergeArgs {
    /// Parts that render --samples A..B has written, in any order
    #[arg(required = true, value_name = "PART")]
    pub parts: Vec<PathBuf>,
    #[command(flatten)]
    pub output: OutputArgs,
    /// Stops of exposure (0: radiance 1 is white), or auto [default: as the parts were to be shown]
    #[arg(long, value_name = "EV|auto", value_parser = exposure, allow_hyphen_values = true)]
    pub exposure: Option<Exposure>,
    /// How bright light is shown [default: as the parts were to be shown]
    #[arg(long, value_name = "srgb|neutral|agx|aces|filmic|raw", value_parser = view)]
    pub view: Option<View>,
    /// Make a picture even if there are samples missing
    #[arg(long)]
    pub partial: bool,
    /// Write a copy without noise beside the picture, by Open Image Denoise; a part rendered with --denoise is needed
    #[arg(long)]
    pub denoise: bool,
    /// Print a report as JSON on standard output
    #[arg(long)]
    pub json: bool,
    /// Print nothing but errors and warnings
    #[arg(short, long)]
    pub quiet: bool,
}

const MERGE_EXAMPLES: &str = "\
The picture is the same, bit for bit, as that of one run with all the samples.

Examples:
  firstlight render scene.toml --spp 64 --samples 0..32 -o a.exr
  firstlight render scene.toml --spp 64 --samples 32..64 -o b.exr
  firstlight merge a.exr b.exr -o picture.png";

#[derive(Debug, Args)]
#[command(after_help = RELIGHT_EXAMPLES)]
pub(crate) struct RelightArgs {
    /// A picture with layers of light (.exr), from render --aov light
    #[arg(value_name = "LAYERS")]
    pub layers: PathBuf,
    #[command(flatten)]
    pub output: OutputArgs,
    /// A light and what its light is multiplied by: a number, a colour, or off; may be repeated
    #[arg(long, value_name = "NAME=FACTOR", value_parser = relit)]
    pub light: Vec<(String, Rgb)>,
    /// Keep only these lights; may be repeated
    #[arg(long, value_name = "NAME", conflicts_with = "light")]
    pub only: Vec<String>,
    /// Stops of exposure, or auto, in place of those that the picture was rendered with
    /// [default: as it was rendered]
    #[arg(long, value_name = "EV|auto", value_parser = exposure, allow_hyphen_values = true)]
    pub exposure: Option<Exposure>,
    /// How bright light is shown [default: as the picture was to be shown]
    #[arg(long, value_name = "srgb|neutral|agx|aces|filmic|raw", value_parser = view)]
    pub view: Option<View>,
    /// Print nothing but errors and warnings
    #[arg(short, long)]
    pub quiet: bool,
}

const RELIGHT_EXAMPLES: &str = "\
Nothing is rendered: light adds up, and so do its layers.

Examples:
  firstlight render scene.toml --aov light -o layers.exr
  firstlight relight layers.exr --light key=0.5 --light fill=off --exposure 1 -o dusk.png
  firstlight relight layers.exr --light key=#ffd9a0 -o warm.png";

const RENDER_EXAMPLES: &str = "\
Examples:
  firstlight render scene.toml
  firstlight render scene.toml -o out.exr --spp 64 -D film.filter=mitchell
  firstlight render chair.glb --azimuth 60 --elevation 15 --ground off --transparent
  firstlight render part.stl --unit mm --key '10 klx' --headlight off
  firstlight render part.stl --look clarity --section 0,0,0,1,0,0
  firstlight render scene.toml --time 30s
  firstlight render scene.toml --noise 2% --spp 4096
  firstlight render scene.toml --spp 64 --denoise -o picture.png
  firstlight render scene.toml -o - --crop 100,80,64,64 > crop.png";

/// The studio around a model file; a scene file says these things itself.
#[derive(Debug, Default, Args)]
#[command(next_help_heading = "Studio (model files only)")]
pub(crate) struct StudioArgs {
    /// Direction of the camera: anticlockwise around the model from its front [default: 30]
    #[arg(long, value_name = "DEG", value_parser = angle, allow_hyphen_values = true)]
    pub azimuth: Option<f64>,
    /// Direction of the camera: above the horizon [default: 20]
    #[arg(long, value_name = "DEG", value_parser = elevation, allow_hyphen_values = true)]
    pub elevation: Option<f64>,
    /// Irradiance of the key light, such as 2.8 (W/m²), "10 klx" or off [default: 2.8, off with lights of the model]
    #[arg(long, value_name = "AMOUNT|off", value_parser = irradiance, allow_hyphen_values = true)]
    pub key: Option<Switch<Quantity>>,
    /// Irradiance of the light at the camera [default: 0.8, off with lights of the model]. A model that is not all
    /// matte stands under a soft sky instead, with light that bounces, unless --key or --headlight is given
    #[arg(long, value_name = "AMOUNT|off", value_parser = irradiance, allow_hyphen_values = true)]
    pub headlight: Option<Switch<Quantity>>,
    /// Colour of the ground [default: a light grey; off with lights of the model or --transparent]
    #[arg(long, value_name = "COLOR|off", value_parser = ground)]
    pub ground: Option<Switch<[f32; 4]>>,
    /// Colour of the background, where there is no ground [default: that of the ground]
    #[arg(long, value_name = "COLOR", value_parser = firstlight::color::parse)]
    pub background: Option<[f32; 4]>,
    /// Which axis of the file points up [default: z for STL, else y]
    #[arg(long, value_enum, value_name = "AXIS")]
    pub up: Option<Axis>,
    /// Which look of a glTF file with variants is shown
    #[arg(long, value_name = "NAME")]
    pub variant: Option<String>,
    /// In which units a glTF file's lights are [default: as its generator is known to write them, else spec]
    #[arg(long, value_enum, value_name = "UNITS")]
    pub gltf_lights: Option<LightUnitsName>,
    /// Length of 1 in the file, such as mm or "2.5 cm" [default: 1 m]
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    pub unit: Option<String>,
}

#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  firstlight check scene.toml --strict\n  firstlight check - < scene.toml"
)]
pub(crate) struct CheckArgs {
    #[command(flatten)]
    pub picture: PictureArgs,
    /// Print a report as JSON on standard output
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub findings: FindingArgs,
}

#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  firstlight info chair.glb\n  firstlight info scene.toml --json"
)]
pub(crate) struct InfoArgs {
    #[command(flatten)]
    pub input: InputArgs,
    /// Print it as JSON
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  firstlight lights scene.toml\n  firstlight lights room.glb --json"
)]
pub(crate) struct LightsArgs {
    #[command(flatten)]
    pub picture: PictureArgs,
    /// Print it as JSON
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
#[command(after_help = COMPARE_EXAMPLES)]
pub(crate) struct CompareArgs {
    /// A picture (.exr .hdr .pfm .png .jpg .webp), or a part that render --samples has written
    #[arg(value_name = "A")]
    pub a: PathBuf,
    /// The picture it is compared with
    #[arg(value_name = "B")]
    pub b: PathBuf,
    /// Noise of B, if it does not tell it: its standard error as a part of each pixel, such as 1%
    #[arg(long, value_name = "PERCENT", value_parser = noise, allow_hyphen_values = true)]
    pub reference_noise: Option<f64>,
    /// A picture of the variances of A's pixels
    #[arg(long, value_name = "FILE")]
    pub variance_a: Option<PathBuf>,
    /// A picture of the variances of B's pixels
    #[arg(long, value_name = "FILE")]
    pub variance_b: Option<PathBuf>,
    /// Mean FLIP up to which they are the same, 0 to 1 [default: their noise, else 0.01]
    #[arg(long, value_name = "FLIP", value_parser = flip)]
    pub threshold: Option<f64>,
    /// Write a picture of what differs, with -o
    #[command(flatten)]
    pub output: OutputArgs,
    /// Print it as JSON
    #[arg(long)]
    pub json: bool,
}

const COMPARE_EXAMPLES: &str = "\
Where the noise is known (parts, EXR files with layers variance.R G B, --variance-a and -b, --reference-noise), squares of
16 × 16 pixels are tested, and one comparison in a hundred of equal pictures goes wrong. Elsewhere, what counts is how
different they look.

Examples:
  firstlight compare new.png old.png -o difference.png
  firstlight compare part.exr reference.exr --reference-noise 0.5%
  firstlight render scene.toml --reference old.png --threshold 0.02";

#[derive(Debug, Args)]
#[command(after_help = MEASURE_EXAMPLES)]
pub(crate) struct MeasureArgs {
    #[command(flatten)]
    pub input: InputArgs,
    #[command(flatten)]
    pub requests: Requests,
    /// The camera that lights at the camera follow; frame: one that shows everything
    #[arg(long, value_name = "NAME")]
    pub camera: Option<String>,
    /// Print a list as JSON
    #[arg(long)]
    pub json: bool,
}

const MEASURE_EXAMPLES: &str = "\
Without --irradiance and --radiance, rows of kind and six numbers are read from standard input.

Examples:
  firstlight measure scene.toml --irradiance 0,0,0,0,0,1
  firstlight measure scene.toml --radiance 0,-5,1,0,1,0 --json
  firstlight measure scene.toml --irradiance - < points.csv
  echo 'irradiance,0,0,0,0,0,1' | firstlight measure scene.toml";

#[derive(Debug, Args)]
#[command(after_help = VERIFY_EXAMPLES)]
pub(crate) struct VerifyArgs {
    /// Run the cases that take long, too
    #[arg(long)]
    pub all: bool,
    /// Run only this group of cases; may be repeated
    #[arg(long, value_name = "NAME", value_parser = group_names())]
    pub group: Vec<String>,
    /// Run this case, quick or not; may be repeated
    #[arg(long, value_name = "ID", value_parser = case_names(), hide_possible_values = true)]
    pub case: Vec<String>,
    /// Worker threads [default: one per processor]
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    #[arg(allow_negative_numbers = true)]
    pub threads: Option<u32>,
    /// Print a report as JSON on standard output
    #[arg(long)]
    pub json: bool,
}

const VERIFY_EXAMPLES: &str = "\
Without options, the quick cases are run; they take about a minute. The exit code is 1 if any case fails.

Examples:
  firstlight verify
  firstlight verify --all --json
  firstlight verify --group cie171
  firstlight verify --case A01-square-above";

fn codes() -> clap::builder::PossibleValuesParser {
    CODES.iter().map(|(code, _)| *code).collect::<Vec<_>>().into()
}

fn group_names() -> clap::builder::PossibleValuesParser {
    GROUPS.iter().map(|(name, _)| *name).collect::<Vec<_>>().into()
}

fn case_names() -> clap::builder::PossibleValuesParser {
    let cases = GROUPS.iter().flat_map(|(_, cases)| *cases);
    cases.map(|case| case.id).collect::<Vec<_>>().into()
}

/// A value, or nothing at all.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Switch<T> {
    Off,
    On(T),
}

impl<T> Switch<T> {
    pub(crate) fn on(self) -> Option<T> {
        if let Self::On(value) = self { Some(value) } else { None }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Axis {
    Y,
    Z,
}

/// A quantity that colours can stand for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum FalseColorName {
    /// What the camera sees, nit
    Luminance,
    /// What falls on the surfaces it sees, lx
    Illuminance,
}

/// The units of a glTF file's lights, as they are called on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum LightUnitsName {
    /// Candela and lux, as glTF says
    Spec,
    /// Watts, as old exports from Blender have them
    Blender,
    /// Watts per steradian, as Blender's "Unitless" exports have them
    Unitless,
}

impl LightUnitsName {
    /// Its name in scene files.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Spec => "spec",
            Self::Blender => "blender",
            Self::Unitless => "unitless",
        }
    }
}

/// A set of instructions; none: the best there is.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Simd(pub Option<Level>);

/// How much work goes into trees, as it is called on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum BuildName {
    /// Starts sooner
    Preview,
    /// Traces faster
    Final,
}

impl From<BuildName> for BuildQuality {
    fn from(name: BuildName) -> Self {
        match name {
            BuildName::Preview => Self::Preview,
            BuildName::Final => Self::Final,
        }
    }
}

/// A file format as it is called on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum FormatName {
    /// 8 bits a channel
    Png,
    /// 16 bits a channel
    Png16,
    /// Linear, 32-bit floats
    Exr,
    /// Linear, 16-bit floats
    ExrHalf,
    /// Linear, Radiance RGBE
    Hdr,
    /// Linear, plain floats
    Pfm,
}

impl FormatName {
    pub(crate) fn format(self) -> Format {
        match self {
            Self::Png => Format::Png { bits: BitDepth::Eight },
            Self::Png16 => Format::Png { bits: BitDepth::Sixteen },
            Self::Exr => Format::Exr { precision: Precision::Float },
            Self::ExrHalf => Format::Exr { precision: Precision::Half },
            Self::Hdr => Format::Hdr,
            Self::Pfm => Format::Pfm,
        }
    }
}

type Parsed<T> = Result<T, String>;

fn samples() -> clap::builder::RangedI64ValueParser<u32> {
    clap::value_parser!(u32).range(1..=i64::from(FilmDescription::MOST_SAMPLES))
}

fn seed(text: &str) -> Parsed<u64> {
    const LARGEST: u64 = i64::MAX as u64;
    let number = text.parse().ok().filter(|seed| *seed <= LARGEST);
    number.ok_or_else(|| format!("must be a whole number from 0 to {LARGEST}"))
}

/// A time span such as 30, 30s, 1.5min or 1h30min.
fn duration(text: &str) -> Parsed<Duration> {
    let wrong = || "needs a time such as 30s, 5min or 1h30min".to_owned();
    let (mut seconds, mut rest) = (0.0, text.trim());
    while !rest.is_empty() {
        let end = rest.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(rest.len());
        let number: f64 = rest[..end].parse().map_err(|_| wrong())?;
        let after = rest[end..].trim_start();
        let end = after.find(|c: char| c.is_ascii_digit()).unwrap_or(after.len());
        let unit = match after[..end].trim_end() {
            "ms" => 1e-3,
            "" | "s" => 1.0,
            "m" | "min" => 60.0,
            "h" => 3600.0,
            _ => return Err(wrong()),
        };
        seconds += number * unit;
        rest = &after[end..];
    }
    match seconds {
        1e-3..=1e9 => Ok(Duration::from_secs_f64(seconds)),
        _ => Err(wrong()),
    }
}

/// A part of one, 0.005 or 0.5%.
fn noise(text: &str) -> Parsed<f64> {
    let (number, unit) = match text.trim().strip_suffix('%') {
        Some(percent) => (percent.trim_end(), 0.01),
        None => (text.trim(), 1.0),
    };
    let value = number.parse().ok().map(|number: f64| number * unit);
    let value = value.filter(|value| (1e-6..=1.0).contains(value));
    value.ok_or_else(|| "needs a part of the picture's brightness, such as 2% or 0.02".into())
}

/// A mean FLIP, 0..1.
fn flip(text: &str) -> Parsed<f64> {
    let number = text.trim().parse().ok().filter(|number: &f64| (0.0..=1.0).contains(number));
    number.ok_or_else(|| "needs a number from 0 to 1, such as 0.02".into())
}

/// Two numbers from 0, the first smaller.
fn range(text: &str) -> Parsed<[f64; 2]> {
    let ends = text.split_once("..").map(|(from, to)| (from.trim().parse(), to.trim().parse()));
    match ends {
        Some((Ok(from), Ok(to))) if 0.0 <= from && from < to && to <= 1e15 => Ok([from, to]),
        _ => Err("needs two numbers, the first smaller, such as 1..1000".into()),
    }
}

fn clamp(text: &str) -> Parsed<Switch<f64>> {
    if text.trim() == "off" {
        return Ok(Switch::Off);
    }
    let bound = text.trim().parse().ok().filter(|bound: &f64| bound.is_finite() && *bound > 0.0);
    let needed = "needs a radiance greater than 0, in W/(sr m²), such as 10, or off";
    bound.map(Switch::On).ok_or_else(|| needed.into())
}

fn sample_range(text: &str) -> Parsed<[u32; 2]> {
    let ends = text.split_once("..").map(|(from, to)| (from.trim().parse(), to.trim().parse()));
    match ends {
        Some((Ok(from), Ok(to))) if from < to => Ok([from, to]),
        _ => Err("needs two whole numbers, the first smaller, such as 0..16".into()),
    }
}

fn resolution(text: &str) -> Parsed<[u32; 2]> {
    const LARGEST: u32 = FilmDescription::LARGEST_SIDE;
    const MOST: u64 = FilmDescription::MOST_PIXELS;
    let sides: Vec<_> = text.split(['x', 'X', '×', ',']).map(|side| side.trim().parse()).collect();
    let [Ok(width), Ok(height)] = sides[..] else {
        return Err("needs width and height in pixels, such as 1280x720".into());
    };
    let in_range = |side| (1..=LARGEST).contains(&side);
    if !in_range(width) || !in_range(height) {
        return Err(format!("width and height must be 1 to {LARGEST}"));
    }
    if u64::from(width) * u64::from(height) > MOST {
        return Err(format!("must be at most {MOST} pixels"));
    }
    Ok([width, height])
}

fn crop(text: &str) -> Parsed<Crop> {
    let numbers: Vec<_> = text.split(',').map(|number| number.trim().parse::<u32>()).collect();
    let [Ok(x), Ok(y), Ok(width @ 1..), Ok(height @ 1..)] = numbers[..] else {
        return Err("needs four whole numbers x,y,width,height, such as 100,80,64,64".into());
    };
    Ok(Crop { x, y, width, height })
}

/// Layers that are wanted.
#[derive(Debug, Clone)]
pub(crate) struct Layers(pub Vec<Layer>);

fn layers(text: &str) -> Parsed<Layers> {
    if text == "all" {
        return Ok(Layers(Layer::NAMES.iter().map(|(_, layer)| *layer).collect()));
    }
    let mut layers = Vec::new();
    for name in text.split(',').map(str::trim).filter(|name| *name != "rgba") {
        let layer = name.parse()?;
        if !layers.contains(&layer) {
            layers.push(layer);
        }
    }
    Ok(Layers(layers))
}

fn relit(text: &str) -> Parsed<(String, Rgb)> {
    let Some((name, factor)) = text.rsplit_once('=') else {
        return Err("needs a light and a factor, such as key=0.5 or key=off".into());
    };
    let factor = match factor {
        "off" => Rgb::ZERO,
        "on" => Rgb::ONE,
        factor => match factor.parse::<f32>() {
            Ok(number) if number < 0.0 => {
                return Err("a factor is not negative; 0 or off takes the light away".into());
            }
            Ok(number) if number.is_finite() => Rgb::splat(number),
            _ => {
                let [r, g, b, _] = firstlight::color::parse(factor)
                    .map_err(|error| format!("{error}; or a number, or off"))?;
                Rgb::new(r, g, b)
            }
        },
    };
    Ok((name.to_owned(), factor))
}

fn look(text: &str) -> Parsed<Look> {
    let known = Look::NAMES.iter().find(|(name, _)| *name == text);
    known.map(|(_, look)| *look).ok_or_else(|| "must be clarity, balanced or real".into())
}

fn section(text: &str) -> Parsed<Section> {
    let numbers: Vec<_> = text.split(',').map(|number| number.trim().parse::<f64>()).collect();
    let [Ok(x), Ok(y), Ok(z), Ok(nx), Ok(ny), Ok(nz)] = numbers[..] else {
        return Err("needs six numbers: a point and a normal, such as 0,0,0,1,0,0".into());
    };
    let (point, normal) = (DVec3::new(x, y, z), DVec3::new(nx, ny, nz).try_normalize());
    let normal = normal.filter(|_| point.is_finite()).ok_or("needs a normal that is not 0")?;
    Ok(Section { point, normal })
}

fn pixel(text: &str) -> Parsed<[u32; 2]> {
    let numbers: Vec<_> = text.split(',').map(|number| number.trim().parse::<u32>()).collect();
    let [Ok(x), Ok(y)] = numbers[..] else {
        return Err("needs two whole numbers x,y, such as 320,180".into());
    };
    Ok([x, y])
}

fn number(text: &str, most: f64) -> Parsed<f64> {
    let number: f64 = text.trim().parse().map_err(|_| "needs a number".to_owned())?;
    if number.abs() <= most {
        return Ok(number);
    }
    Err(format!("must be from -{most} to {most}"))
}

fn exposure(text: &str) -> Parsed<Exposure> {
    if text == "auto" {
        return Ok(Exposure::Auto);
    }
    if text.contains('/') {
        return text.parse().map(Exposure::Camera);
    }
    let wrong = |error| format!("{error}; or auto, or a camera's \"1/125 f/8 ISO 100\"");
    number(text, FilmDescription::MOST_STOPS).map(Exposure::Ev).map_err(wrong)
}

fn view(text: &str) -> Parsed<View> {
    let wrong = || "known are srgb, neutral, agx, aces, filmic and raw".to_owned();
    View::from_name(text).ok_or_else(wrong)
}

/// Degrees as radians, within a full turn either way.
fn angle(text: &str) -> Parsed<f64> {
    number(text, 360.0).map(f64::to_radians)
}

/// Degrees as radians. Straight from above or below, what is up in the picture is left to the camera.
fn elevation(text: &str) -> Parsed<f64> {
    number(text, 90.0).map(f64::to_radians)
}

fn irradiance(text: &str) -> Parsed<Switch<Quantity>> {
    if text == "off" {
        return Ok(Switch::Off);
    }
    let bare = text.parse().map(|value| Quantity {
        value,
        dimension: Dimension::Irradiance,
        measure: Measure::Radiometric,
    });
    let quantity = bare.or_else(|_| Quantity::parse(text))?;
    if quantity.dimension != Dimension::Irradiance {
        return Err("needs an irradiance such as 2.6 (W/m²), \"10 klx\" or off".into());
    }
    if !(0.0..=1e15).contains(&quantity.value) {
        return Err("must be from 0 to 1e15".into());
    }
    Ok(Switch::On(quantity))
}

fn ground(text: &str) -> Parsed<Switch<[f32; 4]>> {
    if text == "off" {
        return Ok(Switch::Off);
    }
    firstlight::color::parse(text).map(Switch::On).map_err(|error| format!("{error}; or off"))
}

fn simd(text: &str) -> Parsed<Simd> {
    if text == "auto" {
        return Ok(Simd(None));
    }
    let levels = Level::all();
    let known = levels.iter().copied().find(|level| level.name() == text);
    let names = || levels.iter().map(|level| level.name()).collect::<Vec<_>>().join(", ");
    known
        .map(|level| Simd(Some(level)))
        .ok_or_else(|| format!("this processor has auto, {}", names()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn the_help_tells_the_defaults_of_the_studio() {
        let mut command = Arguments::command();
        let help = command.find_subcommand_mut("render").unwrap().render_long_help().to_string();
        let help: String = help.split_whitespace().collect::<Vec<_>>().join(" ");
        let usual = firstlight::scene::Studio::default();
        let (key, headlight) = (usual.key.unwrap(), usual.headlight.unwrap());
        for value in [usual.azimuth.to_degrees().round(), usual.elevation.to_degrees().round()] {
            assert!(help.contains(&format!("[default: {value}]")), "{value}");
        }
        for value in [key, headlight] {
            assert!(help.contains(&format!("[default: {value}, off")), "{value}");
        }
    }

    #[test]
    fn a_resolution_may_be_written_in_many_ways() {
        for text in ["1280x720", "1280,720", "1280X720", "1280×720", " 1280 , 720 "] {
            assert_eq!(resolution(text), Ok([1280, 720]), "{text}");
        }
        for text in
            ["", "1280", "0x5", "5x0", "-1x5", "4294967296x1", "65537x1", "65536x65536", "1x2x3"]
        {
            assert!(resolution(text).is_err(), "{text}");
        }
    }

    #[test]
    fn a_crop_is_four_whole_numbers() {
        assert_eq!(crop("1,2,3,4"), Ok(Crop { x: 1, y: 2, width: 3, height: 4 }));
        for text in ["1,2,3", "1,2,0,4", "1,2,3,0", "-1,2,3,4", "1,2,3,4,5", "a"] {
            assert!(crop(text).is_err(), "{text}");
        }
    }

    #[test]
    fn times_noise_and_ranges_are_read() {
        let seconds = |text: &str| duration(text).map(|time| time.as_secs_f64()).ok();
        assert_eq!(seconds("30"), Some(30.0));
        assert_eq!(seconds("1h 1.5min 2s"), Some(3692.0));
        assert_eq!(seconds("250ms"), Some(0.25));
        for text in ["", "s", "-3", "0", "3 days", "1..2s", "inf"] {
            assert!(duration(text).is_err(), "{text}");
        }
        assert_eq!((noise("0.5%"), noise("0.02")), (Ok(0.005), Ok(0.02)));
        for text in ["", "%", "0", "-1%", "200%", "nan"] {
            assert!(noise(text).is_err(), "{text}");
        }
        assert_eq!(sample_range("0..16"), Ok([0, 16]));
        for text in ["", "3", "3..3", "4..3", "-1..3", "..", "0..x"] {
            assert!(sample_range(text).is_err(), "{text}");
        }
    }

    #[test]
    fn amounts_carry_units() {
        let read = |text: &str| irradiance(text).map(|switch| switch.on().map(|q| q.value));
        assert_eq!(read("2.5"), Ok(Some(2.5)));
        assert_eq!(read("10 klx"), Ok(Some(1e4)));
        assert_eq!(read("off"), Ok(None));
        for text in ["5 W", "-1", "nan", "inf", "", "x"] {
            assert!(read(text).is_err(), "{text}");
        }
    }
}
