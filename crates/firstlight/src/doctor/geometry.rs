//! Surfaces that are in each other, inside out, or made of triangles that cannot be right.

use super::probes::{Probe, Witness};
use super::{Care, Doctor, finding, named, percent, quoted};
use crate::color::Rgb;
use crate::diagnostic::Diagnostic;
use crate::geometry::Bounds;
use crate::scene::description::{
    Cone, Cylinder, Integrator, Mesh, Scattering, SceneDescription, Shape, Surface,
};
use crate::units;
use glam::{DVec3, Vec3};
use std::collections::{BTreeMap, HashMap, HashSet};

/// Triangles that are looked at before every render, in all.
const FEW_TRIANGLES: usize = 1 << 14;
/// The part of a mesh's triangles that may have no area (as at the poles of spheres), of its corners that may have no
/// normals, and odd ones.
const FLAT_PART: f64 = 0.25;
const ODD_PART: f64 = 0.02;
const FAR_PART: f64 = 0.1;
/// Cosine between a corner's normal and its triangle's from which on they do not belong together: 75°.
const FAR: f32 = 0.26;
/// The part of what the camera might see that it may look through from behind, into nothing.
const FROM_BEHIND: f64 = 0.2;
/// Surfaces that are looked at before every render.
const FEW_SURFACES: usize = 4096;
/// The part of the size of something transparent that is its skin, and the optical depth of that from which on it is black:
/// coffee in a cup has a hundredth of that.
const SKIN: f64 = 0.01;
const BLACK_DEPTH: f64 = 7.0;
/// Edges with one triangle, as a part of all, that a closed mesh may have.
const OPEN: f64 = 0.01;

impl Doctor<'_> {
    /// Everything that is odd about surfaces.
    pub(super) fn surfaces(&self, care: Care) -> Vec<Diagnostic> {
        let count = if care == Care::Quick { FEW_SURFACES } else { usize::MAX };
        let mut found: Vec<_> = duplicates(self.description, count).into_iter().collect();
        found.extend(self.coincident(care));
        found.extend(self.seen_from_behind(care));
        found.extend(meshes(self.description, care));
        found.extend(self.glass(care, count));
        found.extend(self.dark_glass());
        found.extend(self.few_bounces());
        found
    }

    /// One-sided surfaces that the camera sees from behind, with nothing beyond, or that are inside out.
    fn seen_from_behind(&self, care: Care) -> Option<Diagnostic> {
        let mut counts = BTreeMap::<u32, [u32; 2]>::new();
        let there = self.probes.rays.iter().filter(|probe| self.probes.counts(&probe.first));
        let mut all = 0;
        for probe in there {
            let [through, into_nothing] = counts.entry(probe.first.surface).or_default();
            let passed = self.passes(probe);
            *through += u32::from(passed);
            *into_nothing += u32::from(passed && !self.probes.counts(&probe.hit));
            all += 1;
        }
        let lost: u32 = counts.values().map(|[_, lost]| lost).sum();
        let passed = |[through, lost]: [u32; 2], surface: u32| {
            let part = |count: u32| f64::from(count) > FROM_BEHIND * f64::from(all);
            (part(lost) && lost > 0, part(through) && self.is_inside_out(surface, care))
        };
        let most = counts.iter().max_by_key(|(_, counts)| counts[0])?;
        let (surface, counts) = (*most.0, *most.1);
        let (into_nothing, inside_out) = passed([counts[0], lost], surface);
        if !into_nothing && !inside_out {
            return None;
        }
        let part = percent(f64::from(counts[0]) / f64::from(all));
        let why = if inside_out {
            ", which is inside out: its triangles are wound clockwise"
        } else {
            ""
        };
        let message = format!(
            "the camera looks through the back of this one-sided surface on {part} of what is there{why}"
        );
        let help = match inside_out {
            true => {
                "turn its triangles around in the program it was made with, or make its material double-sided"
            }
            false => {
                "make its material double-sided (double_sided = true), or look from the other side"
            }
        };
        Some(finding("seen-from-behind", self.surface(surface), message).help(help))
    }

    /// Whether the camera looks through the back of the first surface that a ray comes to.
    fn passes(&self, probe: &Probe) -> bool {
        probe.first != probe.hit && self.scene.material(&probe.first).visible
    }

    /// Whether the camera looks through the back of a surface.
    pub(super) fn is_looked_through(&self, surface: u32) -> bool {
        self.probes.rays.iter().any(|probe| probe.first.surface == surface && self.passes(probe))
    }

    /// Whether a closed mesh faces inwards, and is no room that one looks into.
    fn is_inside_out(&self, surface: u32, care: Care) -> bool {
        let Surface { shape, transform, .. } = &self.description.surfaces[surface as usize];
        let Shape::Mesh(mesh) = shape else { return false };
        let mesh = &self.description.meshes[*mesh];
        let mirrored = transform.matrix3.determinant() < 0.0;
        // glTF: a mirrored node turns the winding of its triangles around, so that fronts stay fronts.
        let faces_inwards = Solid::of(mesh, stride(mesh.triangles.len(), care)).is_inside_out();
        let others = 0..self.boxes.len() as u32;
        let is_room = || self.holds_light(surface) || { others }.any(|s| self.holds(surface, s));
        faces_inwards && !mirrored && !is_room()
    }

    /// Boundaries of solids that have no inside.
    fn glass(&self, care: Care, count: usize) -> Vec<Diagnostic> {
        let transparent =
            |surface: &&Surface| self.description.materials[surface.material].interior.is_some();
        let surfaces = self.description.surfaces.iter().take(count).filter(transparent);
        // Copies of a mesh are as open as the first.
        let mut known = HashSet::new();
        let new = |surface: &&Surface| match surface.shape {
            Shape::Mesh(mesh) => known.insert(mesh),
            _ => true,
        };
        surfaces
            .filter(new)
            .filter_map(|surface| self.broken_glass(surface, care))
            .take(3)
            .collect()
    }

    /// Something transparent that takes all light within a hundredth of its own size.
    fn dark_glass(&self) -> Option<Diagnostic> {
        let surfaces = self.description.surfaces.iter().zip(&self.boxes);
        let mut lost = surfaces.filter_map(|(surface, around)| {
            let material = &self.description.materials[surface.material];
            let interior = material.interior.filter(|i| i.scattering == Rgb::ZERO)?;
            let size = around.map(|[lo, hi]| (hi - lo).max_element())?;
            let depth = f64::from(interior.absorption.min_element()) * SKIN * size;
            (depth > BLACK_DEPTH).then_some((material, size))
        });
        let (material, size) = lost.next()?;
        let [skin, size] = [SKIN * size, size].map(|length| units::format(length, "m"));
        let message = format!(
            "lets next to no light through {skin} of itself, and stands there {size} across: it is black"
        );
        let help = "attenuation_distance is how far light goes until it has attenuation_color, in metres: give it the size of things";
        Some(finding("glass-dark", named("material", &material.name), message).help(help))
    }

    /// Glass or mirrors, and paths that end on them: light goes into glass, out of it, and to what is behind.
    fn few_bounces(&self) -> Option<Diagnostic> {
        let Integrator::Path { bounces: Some(bounces @ 1..) } = self.description.integrator else {
            return None;
        };
        let needs = |witness: &Witness| {
            let material = &self.description.materials
                [self.description.surfaces[witness.surface as usize].material];
            let needs = match material.scattering {
                Scattering::Dielectric { .. } if !material.only_bounds() => 3,
                Scattering::Mirror { .. } => 2,
                _ => 0,
            };
            (needs, material)
        };
        let (needs, material) = self.probes.seen().map(needs).max_by_key(|(needs, _)| *needs)?;
        (bounces < needs).then(|| {
            let message = format!(
                "needs paths of {needs} bounces to show what is behind or around it, and they have {bounces}: it stays dark"
            );
            let help = "give the integrator more bounces, or leave the number out: light is followed as far as it counts";
            finding("bounces-few", named("material", &material.name), message).help(help)
        })
    }

    fn broken_glass(&self, surface: &Surface, care: Care) -> Option<Diagnostic> {
        let open =
            "light goes into it and never comes out: use a closed shape, or thin_glass for panes";
        let place = || named("surface", &surface.name);
        match surface.shape {
            Shape::Quad(_) | Shape::Disk(_) => {
                let message = "is flat, and its material is that of a solid";
                Some(finding("glass-open", place(), message).help(open))
            }
            Shape::Cylinder(Cylinder { capped: false, .. })
            | Shape::Cone(Cone { capped: false, .. }) => {
                let message = "is open where it has no caps, and its material is that of a solid";
                Some(finding("glass-open", place(), message).help(open))
            }
            Shape::Mesh(mesh) => {
                let mesh = &self.description.meshes[mesh];
                let solid = Solid::of(mesh, stride(mesh.triangles.len(), care));
                if solid.is_inside_out() && surface.transform.matrix3.determinant() > 0.0 {
                    let message = "faces inwards: what is outside of it counts as inside";
                    let help = "turn its triangles around in the program it was made with";
                    return Some(finding("glass-inside-out", place(), message).help(help));
                }
                let part = (care == Care::Thorough).then(|| open_edges(mesh))?;
                (part > OPEN).then(|| {
                    let message = format!(
                        "{} of its edges are open, and its material is that of a solid",
                        percent(part)
                    );
                    finding("glass-open", place(), message).help(open)
                })
            }
            _ => None,
        }
    }
}

/// Every how many triangles of a mesh are looked at.
fn stride(triangles: usize, care: Care) -> usize {
    match care {
        Care::Quick => triangles.div_ceil(FEW_TRIANGLES).max(1),
        Care::Thorough => 1,
    }
}

/// The first two surfaces that are the same in the same place.
fn duplicates(scene: &SceneDescription, count: usize) -> Option<Diagnostic> {
    let mut known = HashMap::new();
    // Panes, leaves and bounds of fog may be doubled.
    let is_opaque = |surface: &&Surface| scene.materials[surface.material].is_opaque();
    let surfaces = scene.surfaces.iter().take(count).filter(is_opaque);
    let mut twice = surfaces.filter_map(|surface| {
        let bits = surface.transform.to_cols_array().map(f64::to_bits);
        let shape = match &surface.shape {
            Shape::Mesh(mesh) => mesh.to_string(),
            shape => format!("{shape:?}"),
        };
        let motion = surface.motion.map(|motion| format!("{motion:?}"));
        known.insert((bits, shape, motion), &surface.name).map(|first| (surface, first))
    });
    let (surface, first) = twice.next()?;
    let more = match twice.count() {
        0 => String::new(),
        more => format!("; so do {more} more"),
    };
    let message = format!("stands where surface {} stands, and is the same{more}", quoted(first));
    let place = named("surface", &surface.name);
    Some(finding("duplicate-surfaces", place, message).help("leave one of them out"))
}

/// What is wrong with the triangles of meshes that are used.
fn meshes(scene: &SceneDescription, care: Care) -> Vec<Diagnostic> {
    let mut users = vec![None; scene.meshes.len()];
    for surface in scene.surfaces.iter().rev() {
        if let Shape::Mesh(mesh) = surface.shape {
            users[mesh] = Some(surface);
        }
    }
    let total: usize = scene.meshes.iter().map(|mesh| mesh.triangles.len()).sum();
    let mut worst: BTreeMap<&'static str, (Diagnostic, usize)> = BTreeMap::new();
    for (mesh, surface) in scene.meshes.iter().zip(users) {
        let Some(surface) = surface else { continue };
        for oddity in
            Census::of(mesh, stride(total, care)).oddities(&named("surface", &surface.name))
        {
            let entry = worst.entry(oddity.code).or_insert((oddity, 0));
            entry.1 += 1;
        }
    }
    let told = worst.into_values().map(|(mut oddity, count)| {
        if count > 1 {
            oddity.message += &format!(" (and so in {} more meshes)", count - 1);
        }
        oddity
    });
    told.collect()
}

/// What a mesh's triangles are like.
#[derive(Default)]
pub(super) struct Census {
    triangles: usize,
    degenerate: usize,
    zero_normals: usize,
    far_normals: usize,
    has_normals: bool,
}

impl Census {
    /// Of every `stride`th triangle.
    fn of(mesh: &Mesh, stride: usize) -> Self {
        let mut census = Self { has_normals: !mesh.normals.is_empty(), ..Self::default() };
        for triangle in mesh.triangles.iter().step_by(stride) {
            census.count(mesh, triangle);
        }
        census
    }

    fn count(&mut self, mesh: &Mesh, triangle: &[u32; 3]) {
        self.triangles += 1;
        let [a, b, c] = triangle.map(|i| mesh.positions[i as usize].as_dvec3());
        let flat = (b - a).cross(c - a);
        let longest = (b - a).length_squared().max((c - a).length_squared());
        if flat.length() <= 1e-12 * longest || longest == 0.0 {
            self.degenerate += 1;
            return;
        }
        if !self.has_normals {
            return;
        }
        let normals = triangle.map(|i| mesh.normals[i as usize]);
        let lost = |n: &Vec3| !(n.length_squared() > 1e-12 && n.is_finite());
        self.zero_normals += normals.iter().filter(|n| lost(n)).count();
        let flat = flat.normalize().as_vec3();
        let far = |n: &Vec3| n.normalize_or_zero().dot(flat).abs() < FAR && !lost(n);
        self.far_normals += normals.iter().filter(|n| far(n)).count();
    }

    fn oddities(&self, place: &str) -> Vec<Diagnostic> {
        let part = |count: usize, of: usize| count as f64 / of.max(1) as f64;
        let corners = 3 * (self.triangles - self.degenerate);
        let flat = part(self.degenerate, self.triangles);
        let zero = part(self.zero_normals, corners);
        let far = part(self.far_normals, corners);
        let rows = [
            (
                flat > FLAT_PART,
                "triangles-degenerate",
                format!("{} of its triangles ({}) have no area", percent(flat), self.degenerate),
                "they are not drawn; was the mesh flattened, or its coordinates rounded?",
            ),
            (
                zero > ODD_PART,
                "normals-zero",
                format!(
                    "{} of its vertex normals are zero or no numbers: flat shading stands in there",
                    percent(zero)
                ),
                "compute its normals anew in the program it was made with, or leave them out",
            ),
            (
                far > FAR_PART,
                "normals-far",
                format!(
                    "{} of its vertex normals are more than 75° off those of its triangles: light falls on it from wrong sides",
                    percent(far)
                ),
                "compute its normals anew in the program it was made with, or leave them out",
            ),
        ];
        let told = rows.into_iter().filter(|row| row.0);
        told.map(|(_, code, message, help)| finding(code, place.to_owned(), message).help(help))
            .collect()
    }
}

/// How many triangles of a scene's meshes have no area.
pub fn degenerate_triangles(scene: &SceneDescription) -> usize {
    scene.meshes.iter().map(|mesh| Census::of(mesh, 1).degenerate).sum()
}

/// Volume and area of what a mesh encloses, from some of its triangles.
struct Solid {
    area: f64,
    /// Sum of all areas as vectors: 0 if it is closed.
    vector_area: DVec3,
    volume: f64,
}

impl Solid {
    fn of(mesh: &Mesh, stride: usize) -> Self {
        let mut solid = Self { area: 0.0, vector_area: DVec3::ZERO, volume: 0.0 };
        let around = Bounds::around(mesh.positions.iter().copied());
        let middle = 0.5 * (around.lo.as_dvec3() + around.hi.as_dvec3());
        for triangle in mesh.triangles.iter().step_by(stride) {
            let [a, b, c] = triangle.map(|i| mesh.positions[i as usize].as_dvec3() - middle);
            let area = 0.5 * (b - a).cross(c - a);
            solid.area += area.length();
            solid.vector_area += area;
            solid.volume += a.dot(b.cross(c)) / 6.0;
        }
        solid
    }

    /// Whether it is closed, and its triangles are wound clockwise seen from outside.
    fn is_inside_out(&self) -> bool {
        let closed = self.vector_area.length() < 0.02 * self.area;
        closed && self.volume < -0.002 * self.area.powf(1.5)
    }
}

/// The part of a mesh's edges that have one triangle. Corners in the same place are the same.
fn open_edges(mesh: &Mesh) -> f64 {
    let mut edges = HashMap::<[[u32; 3]; 2], u32>::new();
    let place = |i: u32| mesh.positions[i as usize].to_array().map(|x| (x + 0.0).to_bits());
    for [a, b, c] in &mesh.triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let mut edge = [place(*from), place(*to)];
            edge.sort_unstable();
            if edge[0] != edge[1] {
                *edges.entry(edge).or_default() += 1;
            }
        }
    }
    let open = edges.values().filter(|count| **count % 2 == 1).count();
    open as f64 / edges.len().max(1) as f64
}
