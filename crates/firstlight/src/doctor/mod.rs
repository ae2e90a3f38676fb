//! The scene doctor: what makes pictures black, white, noisy or wrong, said in words: what, where, why, and what mends it.
//!
//! [`Doctor::examine`] looks at a scene before it is rendered, with a few hundred rays of the camera and from what they meet;
//! [`Doctor::judge`] looks at the picture that came of it. Each finding is a [`Diagnostic`] with a code out of [`CODES`].
//! A healthy scene has none: what may be meant as it is, is not told, or only where it does harm.

mod camera;
mod coincidence;
mod darkness;
mod environment;
mod geometry;
mod lights;
mod materials;
mod picture;
mod probes;
mod shadows;
mod sizes;
mod tally;
#[cfg(test)]
mod tests;
mod textures;

pub use geometry::degenerate_triangles;
pub use lights::none as no_lights;
pub use picture::Shown;

use crate::bvh::Part;
use crate::diagnostic::Diagnostic;
use crate::geometry::Bounds;
use crate::scene::Scene;
use crate::scene::description::{Mesh, SceneDescription, Shape, Surface};
use glam::DVec3;
use probes::Probes;
use std::sync::Arc;

/// How closely to look.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Care {
    /// What takes next to no time, before every render.
    Quick,
    /// Everything: all triangles and all texels.
    Thorough,
}

/// Every code that a finding may have, with what it means.
pub const CODES: &[(&str, &str)] = &[
    ("bounces-few", "light is followed too shortly for glass or mirrors"),
    ("camera-behind", "the camera is behind a plane without end, the lights before it"),
    ("camera-far", "all surfaces together are a dot in the picture"),
    ("camera-focus", "nothing that the camera sees is sharp"),
    ("camera-fov", "the field of view is that of a telescope or turns everything inside out"),
    ("camera-inside", "the camera is inside of something"),
    ("camera-near", "a parallel camera sees a speck of the scene"),
    ("camera-sees-nothing", "all is background"),
    ("duplicate-surfaces", "the same surface stands twice in the same place"),
    ("emitter-off", "a surface is said to be a light, and gives none"),
    ("environment-black", "nothing comes from the environment"),
    ("environment-clipped", "the picture of the surroundings is cut off at white"),
    ("environment-negative", "the picture of the surroundings has less than no light"),
    ("exposure-low", "the picture is far too dark for its exposure"),
    ("glass-dark", "what is transparent lets nothing through"),
    ("glass-inside-out", "the surface of something transparent faces inwards"),
    ("glass-open", "what is transparent is not closed"),
    ("light-averted", "a light shines away from all that is seen"),
    ("light-blocked", "something stands between a light and all that is seen"),
    ("light-factor", "two lights differ by exactly 683 or 4π"),
    ("light-in-surface", "a light lies in a surface that is seen"),
    ("light-inside", "a light is inside of something"),
    ("light-off", "a light gives nothing"),
    ("light-radius", "what is seen is inside of the sphere of a light"),
    ("light-units", "a light is many times brighter than the sun"),
    ("material-invisible", "a material is nowhere there"),
    ("no-lights", "there is no light at all"),
    ("no-surfaces", "there is nothing to be seen"),
    ("noise", "the picture is mostly noise"),
    ("normals-far", "shading normals are far from those of the triangles"),
    ("normals-zero", "vertex normals are zero or no numbers"),
    ("origin-far", "the scene is too far from the origin for single precision"),
    ("picture-black", "what the camera sees is black"),
    ("picture-clipped", "much of the picture is brighter than white"),
    ("reflectance-above-one", "a material reflects more than it gets"),
    ("samples-dropped", "samples were no finite numbers"),
    ("seen-from-behind", "the camera looks through the backs of one-sided surfaces"),
    ("shadows-epsilon", "a cure for acne takes shadows away"),
    ("size-millimetres", "the scene is as large as if millimetres were taken for metres"),
    ("size-mixed", "one model is a thousand times as large as the others"),
    ("surfaces-coincide", "two surfaces lie in each other"),
    ("texture-curve", "numbers were encoded or decoded like colours"),
    ("texture-flat", "a picture has one colour"),
    ("texture-missing", "a model names a picture that cannot be used"),
    ("texture-normals", "a picture of something else is used as a map of normals"),
    ("texture-role", "one picture is read as colours and as numbers"),
    ("texture-uvs", "a picture has no texture coordinates to lie on"),
    ("triangles-degenerate", "many triangles have no area"),
];

/// Cameras that are where they cannot be meant to be, and what they find of lights that may be right.
const MISPLACED: &[&str] = &["camera-behind", "camera-inside"];
const FROM_THERE: &[&str] = &["light-averted", "light-blocked", "light-inside"];

/// Examines one scene.
pub struct Doctor<'a> {
    description: &'a SceneDescription,
    scene: &'a Scene,
    probes: Probes,
    /// A box around each surface; `None` for those without end, or with nothing in them.
    boxes: Vec<Option<[DVec3; 2]>>,
}

impl<'a> Doctor<'a> {
    /// For `scene`, which was built from `description`. Sends out a few hundred rays.
    pub fn new(description: &'a SceneDescription, scene: &'a Scene) -> Self {
        Self {
            description,
            scene,
            probes: Probes::send(scene, description.ground.map(|ground| ground as u32)),
            boxes: boxes(description, scene),
        }
    }

    /// A box around all surfaces that have an end.
    fn bounds(&self) -> Option<[DVec3; 2]> {
        self.boxes.iter().flatten().copied().reduce(|[a, b], [lo, hi]| [a.min(lo), b.max(hi)])
    }

    /// Whether there is an infinite plane besides a studio's ground.
    fn is_endless(&self) -> bool {
        let surfaces = self.description.surfaces.iter().enumerate();
        let mut own = surfaces.filter(|(number, _)| Some(*number) != self.description.ground);
        own.any(|(_, surface)| matches!(surface.shape, Shape::Plane(_)))
    }

    /// Whether a light, or a surface that is one, is in the box around a surface.
    fn holds_light(&self, surface: u32) -> bool {
        let Some([lo, hi]) = self.boxes[surface as usize] else { return false };
        let is_in = |at: DVec3| at.cmpge(lo).all() && at.cmple(hi).all();
        let mut lights = self.description.lights.iter().filter_map(|light| light.light.position());
        let area_lights = || self.scene.area_lights.iter().map(|light| light.surface);
        lights.any(is_in) || area_lights().any(|light| self.holds(surface, light))
    }

    /// Whether another surface is all in the box around a surface.
    fn holds(&self, surface: u32, other: u32) -> bool {
        let around = self.boxes[surface as usize].zip(self.boxes[other as usize]);
        around.is_some_and(|([lo, hi], [a, b])| {
            surface != other && a.cmpge(lo).all() && b.cmple(hi).all()
        })
    }

    /// Everything that is odd about the scene, as far as that shows before it is rendered.
    pub fn examine(&self, care: Care) -> Vec<Diagnostic> {
        let description = self.description;
        if description.surfaces.is_empty() {
            let message = "the scene has no surfaces: the picture is background";
            return vec![Diagnostic::new("", message).code("no-surfaces")];
        }
        let mut found = Vec::new();
        found.extend(lights::none(description));
        let camera = self.camera();
        let is_wrong = |finding: &Diagnostic| MISPLACED.contains(&finding.code);
        let misplaced = camera.iter().any(is_wrong);
        found.extend(camera);
        // From there, all lights seem to be in the wrong place.
        let follows = |found: &Diagnostic| misplaced && FROM_THERE.contains(&found.code);
        found.extend(self.lights(care).into_iter().filter(|finding| !follows(finding)));
        found.extend(environment::examine(description));
        found.extend(self.lost_shadows());
        found.extend(self.surfaces(care));
        found.extend(self.sizes());
        found.extend(materials::examine(description, care));
        found.extend(textures::examine(description, care));
        found
    }

    /// A surface as it is called in findings.
    fn surface(&self, surface: u32) -> String {
        named("surface", &self.description.surfaces[surface as usize].name)
    }

    /// The name of a surface in quotation marks.
    fn quoted(&self, surface: u32) -> String {
        quoted(&self.description.surfaces[surface as usize].name)
    }
}

/// A box around each surface, wherever it comes to: around the corners of its mesh's own box, so that copies cost next to
/// nothing.
fn boxes(description: &SceneDescription, scene: &Scene) -> Vec<Option<[DVec3; 2]>> {
    let around = |mesh: &Arc<Mesh>| Bounds::around(mesh.positions.iter().copied());
    let meshes: Vec<Bounds> = description.meshes.iter().map(around).collect();
    let of = |(surface, part): (&Surface, &Part)| {
        let bounds = match (&surface.shape, part) {
            (Shape::Mesh(mesh), _) => Some(meshes[*mesh])
                .filter(|bounds| !bounds.is_empty())
                .map(|b| Bounds::of_mapped(b.lo.as_dvec3(), b.hi.as_dvec3(), &surface.transform)),
            (_, Part::Analytic(shape, _)) => shape.bounds(),
            (_, Part::Mesh(part)) => Some(Bounds::around(part.mesh.positions.iter().copied())),
        };
        let bounds = bounds.map(|bounds| bounds.moving(surface.motion.as_ref()));
        bounds.map(|bounds| [bounds.lo.as_dvec3(), bounds.hi.as_dvec3()])
    };
    description.surfaces.iter().zip(scene.world.parts()).map(of).collect()
}

/// A thing as it is called in findings: `light "key"`.
fn named(kind: &str, name: &str) -> String {
    format!("{kind} {}", quoted(name))
}

fn quoted(name: &str) -> String {
    format!("\"{name}\"")
}

/// A finding about a part of the scene.
fn finding(code: &'static str, part: String, message: impl Into<String>) -> Diagnostic {
    Diagnostic::new("", message).at_part(part).code(code)
}

/// A part as a percentage of three digits at most.
fn percent(part: f64) -> String {
    let percent = 100.0 * part;
    match percent {
        0.0 | 100.0 => format!("{percent} %"),
        0.05..99.95 => format!("{} %", format!("{percent:.1}").trim_end_matches(".0")),
        ..0.05 => "less than 0.1 %".into(),
        _ => "more than 99.9 %".into(),
    }
}
