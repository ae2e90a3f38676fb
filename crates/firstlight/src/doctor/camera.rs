//! Cameras that see nothing, or not what they should.

use super::{Doctor, finding, named, percent};
use crate::diagnostic::Diagnostic;
use crate::geometry::Hit;
use crate::scene::description::{CameraDescription, Projection, Shape};
use crate::units;
use glam::DVec3;
use std::collections::BTreeSet;

/// Fields of view outside of these are hardly meant, degrees.
const FIELDS: [f64; 2] = [1.5, 160.0];
/// The part of the picture's height that all surfaces together should fill.
const SMALLEST: f64 = 0.01;
/// The part of a scene that a parallel camera should see.
const SPECK: f64 = 0.005;
/// The part of all vertices that are most of them.
const MOST: f64 = 0.85;
/// Vertices that are looked at.
const FEW_VERTICES: usize = 1 << 14;
/// Lenses wider than so many times the distance that they are sharp at are hardly meant.
const WIDEST: f64 = 2.0;
/// The part of the picture's height over which a point may be spread by the lens.
const BLURRED: f64 = 0.05;
/// The part over which most of what is seen is spread if all is fog, and how much most is.
const FOG: f64 = 0.5;
const NEARLY_ALL: f64 = 0.75;

impl Doctor<'_> {
    /// Everything that is odd about the camera in use, if the scene has one.
    pub(super) fn camera(&self) -> Vec<Diagnostic> {
        let Some(camera) = self.description.cameras.first() else { return Vec::new() };
        let findings = [
            field(camera),
            self.is_inside(camera),
            self.is_behind(camera),
            self.is_far(camera),
            self.is_near(camera),
            self.is_blurred(camera),
        ];
        findings.into_iter().flatten().collect()
    }

    /// A camera behind a plane without end that fills most of what it sees, while all lights are before it.
    pub(super) fn is_behind(&self, camera: &CameraDescription) -> Option<Diagnostic> {
        let seen: Vec<_> = self.probes.seen().collect();
        let plane = self.plane_before(&seen)?;
        let tally = self.reached(&seen);
        (tally.lit == 0 && tally.averted > 0).then(|| {
            let message = format!(
                "is behind plane {}, which has no end, and the lights are before it",
                self.quoted(plane)
            );
            let help = "move the camera to the side of the lights";
            finding("camera-behind", named("camera", &camera.name), message).help(help)
        })
    }

    /// A parallel camera that sees so little that all of it is one surface.
    fn is_near(&self, camera: &CameraDescription) -> Option<Diagnostic> {
        let Projection::Orthographic { height } = camera.projection else { return None };
        let [lo, hi] = self.bounds()?;
        let size = (hi - lo).length();
        let first = self.probes.rays.first()?;
        let flat =
            |hit: &Hit| (hit.surface, hit.primitive) == (first.hit.surface, first.hit.primitive);
        let one = self.probes.rays.iter().all(|probe| flat(&probe.hit));
        (one && height < SPECK * size).then(|| {
            let [height, size] = [height, size].map(|length| units::format(length, "m"));
            let message =
                format!("sees {height} of a scene that is {size} across: all of one colour");
            let help = "height is that of what is seen; --camera frame shows everything";
            finding("camera-near", named("camera", &camera.name), message).help(help)
        })
    }

    /// A camera that sees the inside of one surface that is no lit room, and nothing of what is outside of it.
    pub(super) fn is_inside(&self, camera: &CameraDescription) -> Option<Diagnostic> {
        let surface = self.probes.rays.first().map(|probe| probe.hit.surface)?;
        let rays = &self.probes.rays;
        let around = rays.iter().all(|probe| probe.hit.is_some() && probe.hit.surface == surface);
        let behind = self.probes.seen().all(|witness| !witness.front);
        let met: BTreeSet<_> =
            self.probes.witnesses.iter().map(|witness| witness.surface).collect();
        let alone = around && behind && met.len() <= 1;
        if !alone || self.holds_light(surface) || !self.something_outside(surface) {
            return None;
        }
        let message = format!(
            "is inside of surface {}: it sees nothing else, though there is more outside",
            self.quoted(surface)
        );
        let help = "move it outside, or try --camera frame, which shows everything";
        Some(finding("camera-inside", named("camera", &camera.name), message).help(help))
    }

    /// Whether any other surface reaches beyond the box around this one.
    fn something_outside(&self, surface: u32) -> bool {
        let Some([lo, hi]) = self.boxes[surface as usize] else { return false };
        let beyond = |[a, b]: &[DVec3; 2]| a.cmplt(lo).any() || b.cmpgt(hi).any();
        self.is_endless() || self.boxes.iter().flatten().any(beyond)
    }

    /// A camera from which all surfaces together, or nearly all triangles, are a dot.
    pub(super) fn is_far(&self, camera: &CameraDescription) -> Option<Diagnostic> {
        if field(camera).is_some() {
            return None;
        }
        let all = self.bounds().filter(|_| !self.is_endless())?;
        let place = || named("camera", &camera.name);
        if let Some(dot) = dot(camera, all) {
            let message = format!("all surfaces together are {dot}");
            // The camera that frames everything is as near as cameras get.
            let help = match self.description.ground.is_some() && camera.name == "frame" {
                true => {
                    "were the model's lengths meant in a larger unit? Say so: --unit m, or unit = \"m\""
                }
                false => {
                    "are the lengths of camera and models in the same unit? --camera frame shows everything"
                }
            };
            return Some(finding("camera-far", place(), message).help(help));
        }
        let dot = dot(camera, self.most_vertices()?)?;
        let [lo, hi] = all;
        let size = units::format((hi - lo).length(), "m");
        let message = format!(
            "most triangles together are {dot}; a few stray ones make the scene {size} across"
        );
        Some(finding("camera-far", place(), message)
            .help("delete the stray ones in the program it was made with, or bring the camera near the others"))
    }

    /// A box around most of the vertices of meshes: those nearest to the one in the middle, of some of them.
    fn most_vertices(&self) -> Option<[DVec3; 2]> {
        let surfaces = self.description.surfaces.iter();
        let meshes = surfaces.filter_map(|surface| match surface.shape {
            Shape::Mesh(mesh) => Some((&self.description.meshes[mesh], surface.transform)),
            _ => None,
        });
        let count: usize = meshes.clone().map(|(mesh, _)| mesh.positions.len()).sum();
        let vertices: Vec<DVec3> = meshes
            .flat_map(|(mesh, to_world)| {
                mesh.positions.iter().map(move |p| to_world.transform_point3(p.as_dvec3()))
            })
            .step_by(count.div_ceil(FEW_VERTICES).max(1))
            .collect();
        let middle = DVec3::from_array([0, 1, 2].map(|axis: usize| {
            let mut along: Vec<f64> = vertices.iter().map(|vertex| vertex[axis]).collect();
            along.sort_unstable_by(f64::total_cmp);
            along.get(along.len() / 2).copied().unwrap_or(0.0)
        }));
        let mut away: Vec<f64> = vertices.iter().map(|vertex| vertex.distance(middle)).collect();
        away.sort_unstable_by(f64::total_cmp);
        let radius = DVec3::splat(*away.get((MOST * away.len() as f64) as usize)?);
        Some([middle - radius, middle + radius])
    }

    /// A lens that is set to a distance at which there is nothing.
    fn is_blurred(&self, camera: &CameraDescription) -> Option<Diagnostic> {
        let Projection::ThinLens { vertical_fov, aperture, focus_distance } = camera.projection
        else {
            return None;
        };
        if aperture > WIDEST * focus_distance {
            let [lens, focus, small] =
                [aperture, focus_distance, 1e-3 * aperture].map(|d| units::format(d, "m"));
            let message =
                format!("its lens is {lens} wide and sharp at {focus} alone: all else is fog");
            let help = format!(
                "aperture is its diameter; if it was meant in millimetres, write \"{small}\""
            );
            return Some(
                finding("camera-focus", named("camera", &camera.name), message).help(help),
            );
        }
        let forward = (camera.target - camera.position).normalize_or(DVec3::Y);
        let depth = |at: DVec3| (at - camera.position).dot(forward);
        let mut depths: Vec<f64> = self.probes.seen().map(|w| depth(w.position)).collect();
        depths.sort_by(f64::total_cmp);
        // Similar triangles: a lens of this diameter spreads a point at `depth` over that part of the picture.
        let height = 2.0 * (0.5 * vertical_fov).tan();
        let spread = |depth: f64| aperture * (1.0 / depth - 1.0 / focus_distance).abs() / height;
        let sharpest = depths.iter().map(|d| spread(*d)).fold(f64::INFINITY, f64::min);
        let middle = *depths.get(depths.len() / 2)?;
        let foggy = depths.iter().filter(|d| spread(**d) > FOG).count();
        if sharpest <= BLURRED && foggy as f64 > NEARLY_ALL * depths.len() as f64 {
            let [lens, focus] = [aperture, focus_distance].map(|d| units::format(d, "m"));
            let part = percent(foggy as f64 / depths.len() as f64);
            let message = format!(
                "its lens is {lens} wide: {part} of what it sees is fog, all but what is just {focus} away"
            );
            let help = "aperture is its diameter: that of a camera is some \"10 mm\"";
            return Some(
                finding("camera-focus", named("camera", &camera.name), message).help(help),
            );
        }
        (sharpest > BLURRED).then(|| {
            let [nearest, furthest, focus] =
                [depths[0], depths[depths.len() - 1], focus_distance].map(|d| units::format(d, "m"));
            let message = format!(
                "is sharp at {focus}; what it sees is {nearest} to {furthest} away, and all of it is blurred"
            );
            finding("camera-focus", named("camera", &camera.name), message)
                .help(format!("set focus_distance = {:.3}, or a smaller aperture", middle))
        })
    }
}

/// What a camera sees of a box, in words, if that is next to nothing of the picture.
fn dot(camera: &CameraDescription, [lo, hi]: [DVec3; 2]) -> Option<String> {
    let (size, distance) =
        ((hi - lo).length(), camera.position.distance(0.5 * (lo + hi)).max(1e-12));
    let height = match camera.projection {
        Projection::Orthographic { height } => height,
        Projection::Perspective { vertical_fov } | Projection::ThinLens { vertical_fov, .. } => {
            2.0 * distance * (0.5 * vertical_fov).tan()
        }
    };
    (size < SMALLEST * height && size > 0.0).then(|| {
        format!(
            "{} across, which is {} of the picture's height from {} away",
            units::format(size, "m"),
            percent(size / height),
            units::format(distance, "m")
        )
    })
}

/// A field of view that nobody wants.
fn field(camera: &CameraDescription) -> Option<Diagnostic> {
    let (Projection::Perspective { vertical_fov } | Projection::ThinLens { vertical_fov, .. }) =
        camera.projection
    else {
        return None;
    };
    let degrees = vertical_fov.to_degrees();
    (!(FIELDS[0]..=FIELDS[1]).contains(&degrees)).then(|| {
        let seen = if degrees < FIELDS[0] { "a telescope's" } else { "wider than any lens" };
        let message = format!("a field of view of {degrees:.3}° is {seen}");
        let help = match degrees < FIELDS[0] {
            // Cameras of models have the model's name before their own.
            true if camera.name.contains('/') => {
                "in glTF, yfov is in radians: 0.7 is usual. --camera frame shows everything".into()
            }
            true => format!("angles are in degrees; if it was meant in radians, write fov = \"{degrees:.4} rad\""),
            false => "fov is the angle from the lower to the upper edge; 40 is usual".into(),
        };
        finding("camera-fov", named("camera", &camera.name), message).help(help)
    })
}
