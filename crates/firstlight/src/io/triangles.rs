//! Polygons into triangles, and triangles into scenes: what the readers of model files share.

use super::Warnings;
use super::text::{Parsed, Tally, counted};
use crate::color::Rgb;
use crate::diagnostic::{Diagnostic, Place, Result};
use crate::scene::description::{Material, Mesh, SceneDescription, Shape, Surface};
use glam::{DAffine3, DVec2, DVec3, Vec3};
use indexmap::IndexSet;
use std::sync::Arc;

/// Faces with more corners than this are refused.
const MOST_CORNERS: usize = 1 << 16;

/// How much work `earcutr` may be given for one file, in corners of a polygon cubed: its worst case, which
/// takes 0.1 to 0.2 ns each. It is enough for 30 polygons of 1000 corners or a million of 30.
const MOST_EAR_WORK: u64 = 30_000_000_000;

/// Different corners, numbered as they come.
///
/// The hash has a seed of its own in each run, so that no file can be made to collide, but takes a fraction of the time
/// of the standard library's.
pub(super) type Distinct<T> = IndexSet<T, foldhash::fast::RandomState>;

/// Splits the polygons of a file into triangles, and counts those that make trouble.
#[derive(Debug, Default)]
pub(super) struct Triangulator {
    corners: Vec<DVec3>,
    triangles: Vec<[usize; 3]>,
    ear_work: u64,
    dropped: Tally,
    guessed: Tally,
}

impl Triangulator {
    /// The triangles of the polygon `corners`, as numbers of corners, in its own direction.
    ///
    /// Those without area are left out; a polygon with a corner that is not finite has none.
    pub(super) fn split(
        &mut self,
        corners: &[Vec3],
        place: impl FnOnce() -> Place,
    ) -> &[[usize; 3]] {
        self.triangles.clear();
        let mut guessed = false;
        if let &[a, b, c] = corners {
            self.triangles.extend(has_area([a, b, c]).then_some([0, 1, 2]));
        } else if corners.iter().all(|corner| corner.is_finite()) {
            self.corners.clear();
            self.corners.extend(corners.iter().map(|corner| corner.as_dvec3()));
            guessed = !self.cut();
            let points = &self.corners;
            self.triangles.retain(|&triangle| area_vector(points, triangle) != DVec3::ZERO);
        }
        if self.triangles.is_empty() {
            self.dropped.add(place);
        } else if guessed {
            self.guessed.add(place);
        }
        &self.triangles
    }

    /// Says how many polygons were left out or may be wrong; `empty`: whether the file has no triangles at all.
    ///
    /// # Errors
    /// If it has none because all polygons were left out.
    pub(super) fn finish(&mut self, empty: bool, warnings: &mut Warnings) -> Result<()> {
        let dropped = std::mem::take(&mut self.dropped);
        if empty {
            return dropped.refuse(|count| {
                let which =
                    if count == 1 { "the only face is" } else { &format!("all {count} faces are") };
                format!("no triangles in this file: {which} without area or not finite")
            });
        }
        dropped.warn(warnings, |count| {
            let faces = counted(count, "face");
            format!("{faces} without area or with corners that are not finite left out")
        });
        std::mem::take(&mut self.guessed).warn(warnings, |count| {
            let faces = counted(count, "face");
            format!("{faces} with so many corners that they were split as if convex")
        });
        Ok(())
    }

    /// A fan from the first or second corner if that stays inside (so for every simple quad), else ears.
    /// Tells whether the triangles are known to be right.
    fn cut(&mut self) -> bool {
        let count = self.corners.len();
        let normal: DVec3 = fan(0, count).map(|t| area_vector(&self.corners, t)).sum();
        let stays_inside = |&apex: &usize| {
            fan(apex, count).all(|t| area_vector(&self.corners, t).dot(normal) >= 0.0)
        };
        let apex = [0, 1].into_iter().find(stays_inside);
        let right = apex.is_some() || self.cut_ears(normal);
        if self.triangles.is_empty() {
            self.triangles.extend(fan(apex.unwrap_or(0), count));
        }
        right
    }

    /// Cuts ears off the polygon seen along its normal; tells whether it was worth the work.
    fn cut_ears(&mut self, normal: DVec3) -> bool {
        let work = (self.corners.len() as u64).saturating_pow(3).saturating_add(self.ear_work);
        if work > MOST_EAR_WORK {
            return false;
        }
        self.ear_work = work;
        let (right, up) = normal.normalize_or(DVec3::Z).any_orthonormal_pair();
        let flat = |p: &DVec3| DVec2::new(p.dot(right), p.dot(up));
        let low = self.corners.iter().map(flat).fold(DVec2::INFINITY, DVec2::min);
        let plane: Vec<f64> =
            self.corners.iter().flat_map(|p| (flat(p) - low).to_array()).collect();
        let ears = earcutr::earcut(&plane, &[], 2).unwrap_or_default();
        self.triangles.extend(ears.as_chunks().0);
        let points = &self.corners;
        for triangle in &mut self.triangles {
            if area_vector(points, *triangle).dot(normal) < 0.0 {
                triangle.swap(1, 2);
            }
        }
        true
    }
}

/// Whether a triangle is finite and has an area.
pub(super) fn has_area(corners: [Vec3; 3]) -> bool {
    let points = corners.map(|corner| corner.as_dvec3());
    let area = area_vector(&points, [0, 1, 2]);
    area.is_finite() && area != DVec3::ZERO
}

/// The triangles of a fan from corner `apex` of a polygon with `count` corners.
fn fan(apex: usize, count: usize) -> impl Iterator<Item = [usize; 3]> {
    (1..count.saturating_sub(1)).map(move |i| [apex, (apex + i) % count, (apex + i + 1) % count])
}

/// Twice the area of a triangle, as a vector along its normal.
fn area_vector(points: &[DVec3], [a, b, c]: [usize; 3]) -> DVec3 {
    match (points.get(a), points.get(b), points.get(c)) {
        (Some(a), Some(b), Some(c)) => (b - a).cross(c - a),
        _ => DVec3::ZERO,
    }
}

/// Refuses a face with too many corners.
pub(super) fn check_corners(count: usize) -> Parsed<()> {
    if count <= MOST_CORNERS {
        Ok(())
    } else {
        Err(format!("a face with more than {MOST_CORNERS} corners"))
    }
}

/// A mesh of the vertices of `mesh` numbered `picked`, in that order, without triangles.
pub(super) fn pick_vertices(mesh: &Mesh, picked: &[u32]) -> Mesh {
    Mesh {
        name: mesh.name.clone(),
        positions: pick(&mesh.positions, picked),
        triangles: Vec::new(),
        normals: pick(&mesh.normals, picked),
        uvs: mesh.uvs.iter().map(|set| pick(set, picked)).collect(),
        colors: pick(&mesh.colors, picked),
    }
}

fn pick<T: Copy>(from: &[T], picked: &[u32]) -> Vec<T> {
    picked.iter().filter_map(|&i| from.get(i as usize)).copied().collect()
}

/// The same mesh without the vertices that no triangle uses: they may be anywhere, even not finite.
pub(super) fn without_unused(mesh: Mesh, name: &str) -> Result<Mesh> {
    let mut used = vec![false; mesh.positions.len()];
    for &index in mesh.triangles.as_flattened() {
        used.get_mut(index as usize).into_iter().for_each(|used| *used = true);
    }
    if used.iter().all(|&used| used) {
        return Ok(mesh);
    }
    let mut numbers = vec![0; used.len()];
    let mut picked = Vec::new();
    for (index, number) in
        numbers.iter_mut().enumerate().filter(|(index, _)| used.get(*index) == Some(&true))
    {
        *number = vertex_number(picked.len(), name)?;
        picked.push(vertex_number(index, name)?);
    }
    let renumber = |index: &u32| numbers.get(*index as usize).copied().unwrap_or_default();
    let triangles =
        mesh.triangles.iter().map(|triangle| triangle.each_ref().map(renumber)).collect();
    Ok(Mesh { triangles, ..pick_vertices(&mesh, &picked) })
}

/// Replaces normals of length 0 by the mean of the normals around them.
pub(super) fn fill_normals(mesh: &mut Mesh, name: &str, warnings: &mut Warnings) {
    let missing = mesh.normals.iter().filter(|normal| **normal == Vec3::ZERO).count();
    if missing == 0 {
        return;
    }
    let mut sums = vec![Vec3::ZERO; mesh.positions.len()];
    for &triangle in &mesh.triangles {
        let corners = triangle.map(|i| mesh.positions.get(i as usize).copied().unwrap_or_default());
        for (index, normal) in triangle.into_iter().zip(weighted_normals(corners)) {
            sums.get_mut(index as usize).into_iter().for_each(|sum| *sum += normal);
        }
    }
    for (normal, sum) in
        mesh.normals.iter_mut().zip(sums).filter(|(normal, _)| **normal == Vec3::ZERO)
    {
        *normal = unit_normal(sum);
    }
    let normals = counted(missing, "vertex normal");
    let message = format!("{normals} without direction replaced by the mean of the faces around");
    warnings.push(Diagnostic::new(name, message));
}

/// The unit normal of a triangle times the angle at each corner, to be summed over triangles.
pub(super) fn weighted_normals(corners: [Vec3; 3]) -> [Vec3; 3] {
    let [a, b, c] = corners.map(|corner| corner.as_dvec3());
    let normal = (b - a).cross(c - a).normalize_or_zero();
    let weighted = |one: DVec3, other: DVec3| (normal * one.angle_between(other)).as_vec3();
    [weighted(b - a, c - a), weighted(c - b, a - b), weighted(a - c, b - c)]
}

/// The direction of a sum of normals; where they cancel out no direction is right, so any will do.
pub(super) fn unit_normal(sum: Vec3) -> Vec3 {
    sum.normalize_or(Vec3::Z)
}

/// The number of a vertex as meshes store it.
pub(super) fn vertex_number(index: usize, name: &str) -> Result<u32> {
    let cause = "more vertices than the 4294967295 that one mesh can have";
    u32::try_from(index).map_err(|_| Box::new(Diagnostic::new(name, cause)))
}

/// Adds `mesh` to the scene as one surface of its name.
pub(super) fn add_surface(scene: &mut SceneDescription, mesh: Mesh, material: usize) {
    let (name, shape) = (mesh.name.clone(), Shape::Mesh(scene.meshes.len()));
    scene.meshes.push(Arc::new(mesh));
    let transform = DAffine3::IDENTITY;
    scene.surfaces.push(Surface { name, shape, material, transform, motion: None });
}

/// Refuses a scene without surfaces.
pub(super) fn not_empty(scene: SceneDescription, name: &str) -> Result<SceneDescription> {
    if scene.surfaces.is_empty() {
        let error = Diagnostic::new(name, "no triangles in this file");
        return Err(Box::new(error.help("points and lines are not drawn: export faces")));
    }
    Ok(scene)
}

/// What surfaces are made of when their file does not say: matte, half of the light reflected.
pub(super) fn default_material() -> Material {
    Material::matte("default", Rgb::splat(0.5))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The letter L, turned into space.
    fn letter() -> Vec<Vec3> {
        let flat = [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (1.0, 3.0), (0.0, 3.0)];
        let mut corners: Vec<Vec3> = flat.map(|(x, y)| Vec3::new(x, y, x + y)).to_vec();
        corners.rotate_left(4);
        corners
    }

    /// The sum of the triangles' area vectors, and the sum of their areas.
    fn areas(corners: &[Vec3], triangles: &[[usize; 3]]) -> (DVec3, f64) {
        let points: Vec<DVec3> = corners.iter().map(|corner| corner.as_dvec3()).collect();
        let areas = triangles.iter().map(|&triangle| area_vector(&points, triangle) / 2.0);
        (areas.clone().sum(), areas.map(DVec3::length).sum())
    }

    #[test]
    fn concave_polygons_are_covered_once() {
        for turns in 0..6 {
            let mut corners = letter();
            corners.rotate_left(turns);
            let mut triangulator = Triangulator::default();
            let triangles = triangulator.split(&corners, Place::default).to_vec();
            let (sum, total) = areas(&corners, &triangles);
            assert!((sum - DVec3::new(-4.0, -4.0, 4.0)).length() < 1e-9, "{sum}");
            assert!((total - sum.length()).abs() < 1e-9, "{turns} turns: {total}");
        }
    }

    #[test]
    fn work_for_one_file_is_limited() {
        let mut triangulator = Triangulator { ear_work: MOST_EAR_WORK, ..Triangulator::default() };
        assert_eq!(triangulator.split(&letter(), Place::default).len(), 4);
        let mut warnings = Warnings::new();
        triangulator.finish(false, &mut warnings).unwrap();
        assert!(warnings[0].message.starts_with("1 face with so many corners"), "{warnings:?}");
    }

    #[test]
    fn polygons_without_area_are_counted() {
        let mut triangulator = Triangulator::default();
        for corners in [
            vec![],
            vec![Vec3::ZERO, Vec3::X],
            vec![Vec3::ZERO, Vec3::X, 2.0 * Vec3::X],
            vec![Vec3::ZERO, Vec3::X, Vec3::INFINITY, Vec3::Y],
        ] {
            assert!(triangulator.split(&corners, Place::default).is_empty(), "{corners:?}");
        }
        let tiny = [Vec3::ZERO, Vec3::X * 1e-30, Vec3::Y * 1e-30];
        assert_eq!(triangulator.split(&tiny, Place::default), [[0, 1, 2]]);
        let mut warnings = Warnings::new();
        triangulator.finish(false, &mut warnings).unwrap();
        assert!(warnings[0].message.starts_with("4 faces without area"), "{warnings:?}");
    }

    #[test]
    fn where_all_polygons_are_left_out_the_error_says_so() {
        let refused = |polygons: usize| {
            let mut triangulator = Triangulator::default();
            for number in 0..polygons {
                let place = || Place { line: Some(4 + number), ..Place::default() };
                assert!(triangulator.split(&[Vec3::NAN; 3], place).is_empty());
            }
            triangulator.finish(true, &mut Warnings::new()).map_err(|error| error.to_string())
        };
        let reason = "without area or not finite";
        assert_eq!(refused(0), Ok(()));
        assert_eq!(
            refused(1),
            Err(format!(":4: no triangles in this file: the only face is {reason}"))
        );
        assert_eq!(
            refused(3),
            Err(format!(":4: no triangles in this file: all 3 faces are {reason}, first here"))
        );
    }

    #[test]
    fn vertices_without_triangles_go() {
        let mesh = Mesh {
            positions: vec![Vec3::NAN, Vec3::ZERO, Vec3::X, Vec3::NAN, Vec3::Y],
            triangles: vec![[4, 1, 2]],
            normals: vec![Vec3::X, Vec3::Y, Vec3::Z, Vec3::X, Vec3::ZERO],
            ..Mesh::default()
        };
        let mut mesh = without_unused(mesh, "x").unwrap();
        assert_eq!(mesh.positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
        assert_eq!(mesh.triangles, [[2, 0, 1]]);
        let mut warnings = Warnings::new();
        fill_normals(&mut mesh, "x", &mut warnings);
        assert_eq!(mesh.normals, [Vec3::Y, Vec3::Z, Vec3::Z]);
        assert_eq!(warnings.len(), 1);
    }
}
