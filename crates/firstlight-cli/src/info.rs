//! `firstlight info`: what is in a scene or model.

use crate::args::InfoArgs;
use crate::check::triangles;
use crate::output::{print, print_json};
use crate::{Exit, Outcome, report};
use firstlight::SceneDescription;
use firstlight::diagnostic::visible;
use firstlight::io::Warnings;
use firstlight::scene::bounds;
use firstlight::scene::description::*;
use firstlight::units::{self, Dimension, Measure};
use glam::DVec3;
use indicatif::HumanCount;
use serde_json::{Value, json};
use std::collections::BTreeMap;

pub(crate) fn run(args: &InfoArgs) -> Outcome {
    let mut warnings = Warnings::new();
    let scene = args.input.load(&mut warnings)?;
    report::warnings(&warnings);
    if args.json {
        let mut json = as_json(&scene);
        json["scene"] = args.input.name().into();
        json["warnings"] = report::as_json(&warnings);
        print_json(&json)?;
    } else {
        print(as_text(&args.input.name(), &scene).as_bytes())?;
    }
    Ok(Exit::Done)
}

/// How many surfaces there are of each kind.
fn kinds(scene: &SceneDescription) -> BTreeMap<&'static str, usize> {
    let mut kinds = BTreeMap::new();
    for surface in &scene.surfaces {
        *kinds.entry(kind(&surface.shape)).or_default() += 1;
    }
    kinds
}

fn kind(shape: &Shape) -> &'static str {
    match shape {
        Shape::Sphere(_) => "sphere",
        Shape::Plane(_) => "plane",
        Shape::Disk(_) => "disk",
        Shape::Quad(_) => "quad",
        Shape::Block(_) => "box",
        Shape::Cylinder(_) => "cylinder",
        Shape::Cone(_) => "cone",
        Shape::Mesh(_) => "mesh",
    }
}

/// Mesh surfaces that share their triangles with one before them.
fn instances(scene: &SceneDescription) -> usize {
    let mut uses = vec![0_usize; scene.meshes.len()];
    for surface in &scene.surfaces {
        if let Shape::Mesh(mesh) = surface.shape {
            uses[mesh] += 1;
        }
    }
    uses.into_iter().map(|count| count.saturating_sub(1)).sum()
}

fn name_of(dimension: Dimension) -> &'static str {
    match dimension {
        Dimension::Intensity => "intensity",
        Dimension::Irradiance => "irradiance",
        _ => "radiance",
    }
}

fn projection(camera: &CameraDescription) -> (&'static str, Option<f64>) {
    match camera.projection {
        Projection::Perspective { vertical_fov } => ("perspective", Some(vertical_fov)),
        Projection::ThinLens { vertical_fov, .. } => ("thin_lens", Some(vertical_fov)),
        Projection::Orthographic { .. } => ("orthographic", None),
    }
}

fn as_json(scene: &SceneDescription) -> Value {
    let bounds = bounds(scene);
    let film = &scene.film;
    json!({
        "scene": null,
        "bounds_m": bounds.map(|[lower, upper]| json!({
            "min": lower.to_array(), "max": upper.to_array(), "size": (upper - lower).to_array(),
        })),
        "surfaces": { "total": scene.surfaces.len(), "by_kind": kinds(scene) },
        "meshes": scene.meshes.len(),
        "instances": instances(scene),
        "triangles": triangles(scene),
        "lights": scene.lights.iter().map(|l| light_json(l, scene)).collect::<Value>(),
        "materials": scene.materials.iter().map(|m| m.name.as_str()).collect::<Value>(),
        "textures": scene.images.iter().map(|image| json!({
            "name": image.name, "width": image.width, "height": image.height,
        })).collect::<Value>(),
        "cameras": scene.cameras.iter().map(camera_json).collect::<Value>(),
        "film": {
            "width": film.width, "height": film.height, "samples": film.samples, "seed": film.seed,
            "exposure_ev": match film.exposure {
                Exposure::Ev(ev) => json!(ev),
                Exposure::Auto => json!("auto"),
                Exposure::Camera(_) => json!(film.exposure.stops(scene.luminous_efficacy)),
            },
            "transparent": film.transparent,
        },
        "background": scene.background.to_array(),
        "environment": scene.environment.as_ref().map(environment_text),
        "integrator": integrator_text(scene.integrator),
        "luminous_efficacy": scene.luminous_efficacy.0,
        "warnings": null,
    })
}

fn light_json(described: &LightDescription, scene: &SceneDescription) -> Value {
    let (kind, (dimension, value)) = (described.light.kind(), described.light.quantity());
    json!({
        "name": described.name,
        "kind": kind,
        "quantity": name_of(dimension),
        "value": value.to_array(),
        "unit": units::unit(dimension, Measure::Radiometric),
        "photometric": units::photometric(value, scene.luminous_efficacy.0),
        "photometric_unit": units::unit(dimension, Measure::Photometric),
        "shadows": described.shadows,
        "radius_m": described.radius,
    })
}

fn camera_json(camera: &CameraDescription) -> Value {
    let (kind, fov) = projection(camera);
    json!({
        "name": camera.name,
        "kind": kind,
        "position": camera.position.to_array(),
        "target": camera.target.to_array(),
        "vertical_fov_degrees": fov.map(f64::to_degrees),
    })
}

/// Lines of a label and what belongs to it.
#[derive(Default)]
struct Table(Vec<[String; 2]>);

impl Table {
    fn row(&mut self, label: &str, text: impl Into<String>) {
        self.0.push([label.into(), text.into()]);
    }

    /// A heading with a count, then a row for each of the first of `things`.
    fn list<'a, T: 'a>(
        &mut self,
        label: &str,
        things: &'a [T],
        row: impl Fn(&'a T) -> [String; 2],
    ) {
        const MOST_ROWS: usize = 20;
        self.row(label, count(things.len()));
        for thing in things.iter().take(MOST_ROWS) {
            let [name, text] = row(thing);
            self.row(&format!("  {name}"), text);
        }
        if things.len() > MOST_ROWS {
            self.row("  …", format!("{} more; --json lists them all", things.len() - MOST_ROWS));
        }
    }

    /// The texts, aligned.
    fn text(&self) -> String {
        let width = |[label, _]: &[String; 2]| label.chars().count();
        let widest = self.0.iter().map(width).max().unwrap_or(0).min(40);
        let line = |[label, text]: &[String; 2]| {
            format!("{label:<widest$}  {text}").trim_end().to_owned() + "\n"
        };
        self.0.iter().map(line).collect()
    }
}

/// A whole number, its thousands apart.
fn count(number: usize) -> String {
    HumanCount(number as u64).to_string()
}

/// Text from a file without control characters.
fn printable(text: &str) -> String {
    visible(text).chars().take(80).collect()
}

fn as_text(name: &str, scene: &SceneDescription) -> String {
    let mut table = Table::default();
    table.row("scene", printable(name));
    if let Some([lower, upper]) = bounds(scene) {
        let size = upper - lower;
        let [x, y, z] = size.to_array().map(|length| units::format(length, "m"));
        table.row("size", format!("{x} × {y} × {z}"));
        table.row("from", point(lower, size.max_element()));
        table.row("to", point(upper, size.max_element()));
    }
    table.row("surfaces", count(scene.surfaces.len()));
    for (kind, number) in kinds(scene) {
        table.row(&format!("  {kind}"), count(number));
    }
    table.row("triangles", count(triangles(scene)));
    table.row("instances", count(instances(scene)));
    table.list("lights", &scene.lights, |light| light_row(light, scene));
    table.row("environment", scene.environment.as_ref().map_or("none".into(), environment_text));
    table.row("integrator", integrator_text(scene.integrator));
    table.list("materials", &scene.materials, |material| {
        [printable(&material.name), material_text(material)]
    });
    table.list("textures", &scene.images, |image| {
        [printable(&image.name), format!("{} × {}", image.width, image.height)]
    });
    table.list("cameras", &scene.cameras, |camera| [printable(&camera.name), camera_text(camera)]);
    table.row("film", film_text(&scene.film));
    table.row("efficacy", units::format(scene.luminous_efficacy.0, "lm/W"));
    table.text()
}

/// A corner of a box of this size; what is only rounding is shown as 0.
fn point(corner: DVec3, size: f64) -> String {
    let shown = |value: f64| if value.abs() < 1e-6 * size { 0.0 } else { value };
    let [x, y, z] = corner.to_array().map(|value| units::format(shown(value), "m"));
    format!("({x}, {y}, {z})")
}

fn light_row(described: &LightDescription, scene: &SceneDescription) -> [String; 2] {
    let (kind, (dimension, value)) = (described.light.kind(), described.light.quantity());
    let unit = units::unit(dimension, Measure::Radiometric);
    let [r, g, b] = value.to_array().map(f64::from);
    let energy = match r == g && g == b {
        true => units::format(r, unit),
        false => format!("({r}, {g}, {b}) {unit}"),
    };
    let seen = units::photometric(value, scene.luminous_efficacy.0);
    let seen = units::format(seen, units::unit(dimension, Measure::Photometric));
    let shadows = if described.shadows { "" } else { ", no shadows" };
    let radius = match described.radius {
        0.0 => String::new(),
        radius => format!(", radius {}", units::format(radius, "m")),
    };
    let name = name_of(dimension);
    [printable(&described.name), format!("{kind}, {name} {energy} = {seen}{radius}{shadows}")]
}

fn environment_text(environment: &EnvironmentDescription) -> String {
    match &environment.sky {
        Sky::Uniform => "uniform".into(),
        Sky::Gradient { .. } => "a gradient".into(),
        Sky::Picture { pixels, .. } => {
            format!("{}, {} × {}", printable(&pixels.name), pixels.width, pixels.height)
        }
        Sky::Cie { number, sun, .. } => format!("CIE sky {number}, {}", sun_text(*sun)),
        Sky::Clear { turbidity, sun, .. } => {
            format!("clear sky of turbidity {turbidity}, {}", sun_text(*sun))
        }
    }
}

/// Where a sun stands in the sky's own space (x east, y north, z up).
fn sun_text(sun: DVec3) -> String {
    let azimuth = sun.x.atan2(sun.y).to_degrees().rem_euclid(360.0);
    format!("sun {:.1}° high, {azimuth:.1}° from north", sun.z.asin().to_degrees())
}

fn integrator_text(integrator: Integrator) -> String {
    match integrator {
        Integrator::Direct => "direct".into(),
        Integrator::Path { bounces: None } => "path".into(),
        Integrator::Path { bounces: Some(bounces) } => format!("path, at most {bounces} bounces"),
        Integrator::AmbientOcclusion { distance } if distance.is_finite() => {
            format!("ambient occlusion within {}", units::format(distance, "m"))
        }
        Integrator::AmbientOcclusion { .. } => "ambient occlusion".into(),
        Integrator::Clarity { .. } => "clarity".into(),
    }
}

fn material_text(material: &Material) -> String {
    let texture = |texture: &Texture| match texture.pattern {
        Pattern::Constant => {
            let [r, g, b, _] = texture.factor;
            format!("({r:.3}, {g:.3}, {b:.3})")
        }
        Pattern::Image { .. } => "a picture".into(),
        Pattern::Checker { .. } => "a checkerboard".into(),
        Pattern::Gradient { .. } => "a gradient".into(),
        Pattern::Noise { .. } => "noise".into(),
    };
    let [r, g, b, _] = material.emission.factor;
    let emission = match r.max(g).max(b) > 0.0 {
        true => format!(", emission {}", texture(&material.emission)),
        false => String::new(),
    };
    let sides = if material.double_sided { "" } else { ", one-sided" };
    let (kind, color) = match &material.scattering {
        Scattering::Matte { .. } if material.unlit => ("unlit", "reflectance"),
        Scattering::Matte { .. } => ("matte", "reflectance"),
        Scattering::Mirror { .. } => ("mirror", "ground"),
        Scattering::Conductor { .. } => ("metal", "color"),
        Scattering::Dielectric { .. } => ("glass", "tint"),
        Scattering::ThinGlass { .. } => ("pane of glass", "tint"),
        Scattering::Principled(_) => ("principled", "base color"),
        Scattering::Mix { .. } => ("mix", "color"),
    };
    format!("{kind}, {color} {}{emission}{sides}", texture(&material.reflectance))
}

fn camera_text(camera: &CameraDescription) -> String {
    match camera.projection {
        Projection::Perspective { vertical_fov } => {
            format!("perspective, {:.1}° high", vertical_fov.to_degrees())
        }
        Projection::ThinLens { vertical_fov, aperture, focus_distance } => format!(
            "thin lens, {:.1}° high, aperture {}, sharp at {}",
            vertical_fov.to_degrees(),
            units::format(aperture, "m"),
            units::format(focus_distance, "m")
        ),
        Projection::Orthographic { height } => {
            format!("orthographic, {} high", units::format(height, "m"))
        }
    }
}

fn film_text(film: &FilmDescription) -> String {
    let exposure = match film.exposure {
        Exposure::Ev(ev) => format!("exposure {ev:+} EV"),
        Exposure::Auto => "exposure auto".into(),
        Exposure::Camera(CameraSettings { shutter, f_number, iso }) => {
            format!("exposure {} f/{f_number} ISO {iso}", units::format(shutter, "s"))
        }
    };
    let transparent = if film.transparent { ", transparent" } else { "" };
    let FilmDescription { width, height, samples, seed, .. } = film;
    let view = film.view.name();
    format!(
        "{width} × {height}, {samples} samples, seed {seed}, {exposure}, view {view}{transparent}"
    )
}
