//! Surfaces that lie in each other: which one is seen is up to rounding, or they shade each other.

use super::probes::{Probe, Witness};
use super::{Care, Doctor, finding, percent};
use crate::bvh::Part;
use crate::diagnostic::Diagnostic;
use crate::geometry::Ray;
use crate::scene::description::{Mesh, Shape, Surface};
use crate::scene::{SeenByCamera, StopsLight};
use glam::{DVec3, Vec3};
use std::collections::BTreeMap;
use std::iter::repeat_n;

/// Shapes with a formula that are looked at.
const FEW_SHAPES: usize = 64;
/// Triangles that are compared with what is seen: before every render, and if there is time.
const FEW_COMPARISONS: usize = 1 << 20;
const MANY_COMPARISONS: usize = 1 << 27;
/// Rays that must find two surfaces in each other before it is told.
const COINCIDENT_RAYS: u32 = 3;
/// Surfaces at distances that differ by less than this part are taken to be in the same place.
const SAME_PLACE: f32 = 4e-6;

impl Doctor<'_> {
    /// Surfaces of different materials in one place: which one is seen is up to rounding. Those of one material that are all
    /// but in one place shade each other.
    pub(super) fn coincident(&self, care: Care) -> Option<Diagnostic> {
        let seen: Vec<_> = self.probes.rays.iter().filter(|probe| probe.hit.is_some()).collect();
        let mut pairs = counted(self.just_behind(&seen).into_iter().chain(self.at_once(&seen)));
        for (pair, count) in counted(self.in_meshes(&seen, care).into_iter()) {
            let entry = pairs.entry(pair).or_default();
            *entry = count.max(*entry);
        }
        let material = |surface: u32| self.description.surfaces[surface as usize].material;
        let is_opaque = |surface: u32| self.description.materials[material(surface)].is_opaque();
        pairs.retain(|[a, b], _| material(*a) != material(*b));
        pairs.extend(counted(self.shading_each_other().into_iter()));
        pairs.retain(|[a, b], _| is_opaque(*a) && is_opaque(*b));
        let ([a, b], count) = pairs.into_iter().max_by_key(|(_, count)| *count)?;
        (count >= COINCIDENT_RAYS).then(|| {
            let part = percent((f64::from(count) / seen.len() as f64).min(1.0));
            let message = format!(
                "lies in surface {} on {part} of what is seen: {}",
                self.quoted(b),
                match material(a) == material(b) {
                    true => "they are so close that they shade each other",
                    false => "which of the two shows is up to rounding",
                }
            );
            finding("surfaces-coincide", self.surface(a), message)
                .help("move one of them by a hair, or leave it out")
        })
    }

    /// Pairs of surfaces of which a ray meets one within a rounding error behind the other.
    fn just_behind(&self, seen: &[&Probe]) -> Vec<[u32; 2]> {
        let beyond = |Probe { ray, hit, .. }: &&Probe| Ray {
            t_min: hit.t,
            t_max: hit.t * (1.0 + SAME_PLACE),
            ..*ray
        };
        let (rays, mut hits) = (seen.iter().map(beyond).collect::<Vec<_>>(), Vec::new());
        self.scene.world.closest_hits(&rays, &SeenByCamera(self.scene, 0), &mut hits);
        let both = seen.iter().zip(&rays).zip(&hits).filter(|(_, hit)| hit.is_some());
        let both = both.filter(|((probe, ray), hit)| {
            let behind = self.scene.interaction(ray, hit).geometric_normal;
            is_parallel(self.normal(probe), behind)
        });
        both.map(|((probe, _), hit)| [probe.hit.surface, hit.surface]).collect()
    }

    /// Pairs of surfaces of which one is seen, and the other lies before it where light would leave it.
    fn shading_each_other(&self) -> Vec<[u32; 2]> {
        let seen: Vec<_> = self.probes.seen().collect();
        let near = |witness: &&Witness| SAME_PLACE * self.probes.rays[witness.probe].hit.t;
        let leaving = |w: &&Witness| Ray { t_max: near(w), ..Ray::new(w.start, w.normal) };
        let (rays, mut hits) = (seen.iter().map(leaving).collect::<Vec<_>>(), Vec::new());
        self.scene.world.closest_hits(&rays, &StopsLight(self.scene, 0), &mut hits);
        let both = seen.iter().zip(&hits).filter(|(_, hit)| hit.is_some());
        let both = both.map(|(witness, hit)| [witness.surface, hit.surface]);
        both.filter(|[a, b]| a != b).collect()
    }

    /// The normal of what a ray has met.
    fn normal(&self, Probe { ray, hit, .. }: &Probe) -> Vec3 {
        self.scene.interaction(ray, hit).geometric_normal
    }

    /// Pairs of surfaces that a ray meets at the very same distance, one of which has a formula to ask.
    fn at_once(&self, seen: &[&Probe]) -> Vec<[u32; 2]> {
        let parts = (0..).zip(self.scene.world.parts());
        let analytic = parts.filter_map(|(number, part)| match part {
            // What moves lies in others for a moment at most.
            Part::Analytic(shape, _) if self.scene.world.motion(number).is_none() => {
                Some((number, shape))
            }
            _ => None,
        });
        let mut pairs = Vec::new();
        for (number, shape) in analytic.take(FEW_SHAPES) {
            for probe in seen.iter().filter(|probe| probe.hit.surface != number) {
                let Probe { ray, hit, .. } = probe;
                let (point, near) = met(probe);
                let normal = self.normal(probe);
                let crossed = || {
                    shape.crossings(ray).any(|(t, part)| {
                        let other = || shape.point(ray, t, part).normal.as_vec3();
                        t as f32 == hit.t && is_parallel(normal, other())
                    })
                };
                let mut triangles = (0..shape.triangle_count()).map(|i| shape.triangle(i));
                let in_triangle = |triangle: [Vec3; 3]| {
                    let [a, b, c] = triangle;
                    is_parallel(normal, (b - a).cross(c - a).normalize_or_zero())
                        && contains(&triangle, point, near)
                };
                if crossed() || triangles.any(in_triangle) {
                    pairs.push([hit.surface, number]);
                }
            }
        }
        pairs
    }

    /// Pairs of surfaces of which one is seen, and the other is a mesh with a triangle just there. A ray that meets both at
    /// the very same distance is told of one.
    fn in_meshes(&self, seen: &[&Probe], care: Care) -> Vec<[u32; 2]> {
        let surfaces = (0..).zip(&self.description.surfaces);
        let meshes = surfaces.filter_map(|(number, surface)| match surface.shape {
            Shape::Mesh(mesh) if surface.motion.is_none() => {
                Some((number, surface, &*self.description.meshes[mesh]))
            }
            _ => None,
        });
        let mut left = if care == Care::Quick { FEW_COMPARISONS } else { MANY_COMPARISONS };
        let mut pairs = Vec::new();
        for (number, surface, mesh) in meshes {
            let near = self.in_the_box_of(number, seen);
            let most = left / mesh.triangles.len().max(1);
            if most < COINCIDENT_RAYS as usize {
                continue;
            }
            // What there is no time for is taken to be as what there is.
            let step = near.len().div_ceil(most).max(1);
            let near: Vec<_> = near.into_iter().step_by(step).collect();
            left -= near.len() * mesh.triangles.len();
            let found = self.in_mesh(number, surface, mesh, &near);
            pairs.extend(found.into_iter().flat_map(|pair| repeat_n(pair, step)));
        }
        pairs
    }

    /// Rays that end on another surface of another material, in the box around a surface.
    fn in_the_box_of<'a>(&self, number: u32, seen: &[&'a Probe]) -> Vec<&'a Probe> {
        let Some([lo, hi]) = self.boxes[number as usize] else { return Vec::new() };
        let material = |surface: u32| self.description.surfaces[surface as usize].material;
        let is_in = |probe: &Probe| {
            let (point, near) = met(probe);
            point.cmpge(lo - near).all() && point.cmple(hi + near).all()
        };
        let others = seen.iter().filter(|probe| material(probe.hit.surface) != material(number));
        others.filter(|probe| is_in(probe)).copied().collect()
    }

    /// Pairs with this mesh, of which a triangle that can be seen lies where a ray ends.
    fn in_mesh(
        &self,
        number: u32,
        surface: &Surface,
        mesh: &Mesh,
        near: &[&Probe],
    ) -> Vec<[u32; 2]> {
        let seen: Vec<_> = near
            .iter()
            .map(|probe| (probe.hit.surface, probe.ray.direction, self.normal(probe), met(probe)))
            .collect();
        let one_sided = !self.description.materials[surface.material].double_sided;
        let outwards = surface.transform.matrix3.determinant().signum() as f32;
        let mut pairs = Vec::new();
        for triangle in &mesh.triangles {
            let place = |i: u32| mesh.positions[i as usize].as_dvec3();
            let world = triangle.map(|i| surface.transform.transform_point3(place(i)).as_vec3());
            let normal = outwards * (world[1] - world[0]).cross(world[2] - world[0]);
            let normal = normal.normalize_or_zero();
            for (other, direction, seen, (point, distance)) in &seen {
                let hidden = one_sided && normal.dot(*direction) > 0.0;
                if !hidden && is_parallel(normal, *seen) && contains(&world, *point, *distance) {
                    pairs.push([*other, number]);
                }
            }
        }
        pairs
    }
}

/// How often each pair is found, whichever of the two comes first.
fn counted(found: impl Iterator<Item = [u32; 2]>) -> BTreeMap<[u32; 2], u32> {
    let mut pairs = BTreeMap::new();
    for [a, b] in found {
        *pairs.entry([a.min(b), a.max(b)]).or_default() += 1;
    }
    pairs
}

/// Where a ray ends, and how far another surface may be from there to be in the same place, m.
fn met(Probe { ray, hit, .. }: &Probe) -> (DVec3, f64) {
    let point = ray.origin.as_dvec3() + f64::from(hit.t) * ray.direction.as_dvec3();
    (point, f64::from(SAME_PLACE * hit.t))
}

/// Whether two unit normals are those of planes that lie in each other: surfaces that meet at an edge do not.
fn is_parallel(a: Vec3, b: Vec3) -> bool {
    a.dot(b).abs() > 0.999
}

/// Whether a point lies in a triangle, or off its plane by no more than `near`, m.
fn contains(triangle: &[Vec3; 3], point: DVec3, near: f64) -> bool {
    let [a, b, c] = triangle.map(|corner| corner.as_dvec3());
    let normal = (b - a).cross(c - a);
    let inside = |from: DVec3, to: DVec3| (to - from).cross(point - from).dot(normal) >= 0.0;
    let off = (point - a).dot(normal).abs() / normal.length();
    off <= near && inside(a, b) && inside(b, c) && inside(c, a)
}
