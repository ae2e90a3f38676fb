//! Primitives → triangle meshes.

use super::accessor::{Accessor, Component};
use super::data::Data;
use super::document::Primitive;
use super::draco::Unpacked;
use super::notes::Notes;
use crate::diagnostic::Result;
use crate::scene::description::Mesh;
use glam::{Vec2, Vec3};

/// How far beyond 1 colours may be that were converted.
const ROUNDING: f32 = 1e-3;

/// How corners make triangles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Mode {
    List,
    Strip,
    Fan,
}

impl Mode {
    fn triangles(self, corners: &[u32]) -> Vec<[u32; 3]> {
        match self {
            Self::List => corners.as_chunks().0.to_vec(),
            Self::Strip => strip(corners),
            Self::Fan => fan(corners),
        }
    }
}

/// Every second triangle of a strip is turned; those that only join two strips are left out.
fn strip(corners: &[u32]) -> Vec<[u32; 3]> {
    let turned = |(i, corners): (usize, &[u32])| match *corners {
        [a, b, c] if i % 2 == 0 => Some([a, b, c]),
        [a, b, c] => Some([a, c, b]),
        _ => None,
    };
    let proper = |[a, b, c]: &[u32; 3]| a != b && b != c && c != a;
    corners.windows(3).enumerate().filter_map(turned).filter(proper).collect()
}

fn fan(corners: &[u32]) -> Vec<[u32; 3]> {
    let Some((&first, rest)) = corners.split_first() else { return Vec::new() };
    let triangle = |pair: &[u32]| match *pair {
        [a, b] => Some([a, b, first]),
        _ => None,
    };
    rest.windows(2).filter_map(triangle).collect()
}

/// Reads the primitive at `part`; `None`, with a note, if it has no triangles.
///
/// # Errors
/// If an accessor or an index is broken.
pub(super) fn read(
    data: &Data,
    primitive: &Primitive,
    name: &str,
    part: &str,
    notes: &mut Notes,
) -> Result<Option<Mesh>> {
    let mode = match primitive.mode.unwrap_or(4) {
        4 => Mode::List,
        5 => Mode::Strip,
        6 => Mode::Fan,
        0..4 => {
            notes.add(part, "points and lines are not drawn; this primitive is left out");
            return Ok(None);
        }
        other => {
            let cause = format!("{other} is no primitive mode; 0 to 6 are");
            return Err(data.error(format!("{part}.mode"), cause));
        }
    };
    if primitive.targets.is_some() {
        notes.add(part, "morph targets are ignored; the base mesh is shown");
    }
    let streams = Streams::open(data, primitive, part)?;
    let Some(positions) = streams.attribute("POSITION", &["VEC3"])? else {
        notes.add(part, "this primitive has no POSITION and is left out");
        return Ok(None);
    };
    let corners = streams.corners(positions.count)?;
    if mode == Mode::List && !corners.len().is_multiple_of(3) {
        notes.add(part, "the last corners do not make a whole triangle and are left out");
    }
    let (kept, corners) = compact(corners, positions.count);
    let mut mesh =
        Mesh { triangles: mode.triangles(&corners), ..streams.vertices(&positions, kept)? };
    mesh.name = name.to_owned();
    tidy(&mut mesh, part, notes);
    if mesh.triangles.is_empty() {
        notes.add(part, "this primitive has no triangles and is left out");
        return Ok(None);
    }
    Ok(Some(mesh))
}

/// Where a primitive's indices and attributes come from.
struct Streams<'a> {
    data: &'a Data<'a>,
    primitive: &'a Primitive,
    part: &'a str,
    draco: Option<Unpacked<'a>>,
}

impl<'a> Streams<'a> {
    fn open(data: &'a Data, primitive: &'a Primitive, part: &'a str) -> Result<Self> {
        let packed = primitive.extensions.as_ref().and_then(|e| e.draco.as_ref());
        let draco = match packed {
            Some(packed) => Some(Unpacked::decode(data, packed, part)?),
            None => None,
        };
        Ok(Self { data, primitive, part, draco })
    }

    /// The attribute of this name, from the packed stream or an accessor.
    fn attribute(&self, name: &str, kinds: &[&str]) -> Result<Option<Accessor<'a>>> {
        let part = format!("{}.attributes.{name}", self.part);
        let Some(&index) = self.primitive.attributes.get(name) else { return Ok(None) };
        let unpacked = match &self.draco {
            Some(draco) => draco.attribute(name).map_err(|cause| self.data.error(&part, cause))?,
            None => None,
        };
        match unpacked {
            Some(values) => self.data.unpacked(values, index, kinds, &part).map(Some),
            None => self.data.accessor(index, kinds, &part).map(Some),
        }
    }

    /// An attribute of which there must be `count`.
    fn beside(&self, name: &str, kinds: &[&str], count: usize) -> Result<Option<Accessor<'a>>> {
        let Some(accessor) = self.attribute(name, kinds)? else { return Ok(None) };
        if accessor.count == count {
            return Ok(Some(accessor));
        }
        let cause = format!("has {} elements, but POSITION has {count}", accessor.count);
        Err(self.data.error(format!("{}.attributes.{name}", self.part), cause))
    }

    /// The vertices at the corners, each less than `count`.
    fn corners(&self, count: usize) -> Result<Vec<u32>> {
        let part = format!("{}.indices", self.part);
        let corners = match (&self.draco, self.primitive.indices) {
            (Some(unpacked), _) => unpacked.indices(),
            (None, Some(index)) => self.indices(index, &part)?,
            (None, None) => {
                self.data.charge(4 * count as u64, self.part)?;
                (0..count as u32).collect()
            }
        };
        match corners.iter().enumerate().find(|&(_, &corner)| corner as usize >= count) {
            None => Ok(corners),
            Some((at, corner)) => {
                let cause = format!("index {at} is {corner}, but there are {count} vertices");
                Err(self.data.error(part, cause))
            }
        }
    }

    fn indices(&self, index: u32, part: &str) -> Result<Vec<u32>> {
        let accessor = self.data.accessor(index, &["SCALAR"], part)?;
        let unsigned = [Component::U8, Component::U16, Component::U32];
        if !unsigned.contains(&accessor.component) {
            let cause = format!("accessor {index} must have unsigned integers");
            return Err(self.data.error(part, cause));
        }
        self.data.charge(4 * accessor.count as u64, part)?;
        Ok((0..accessor.count).map(|i| accessor.index(i)).collect())
    }

    /// The vertices in `kept`, or all.
    fn vertices(&self, positions: &Accessor, kept: Option<Vec<u32>>) -> Result<Mesh> {
        let all = positions.count;
        let normals = self.beside("NORMAL", &["VEC3"], all)?;
        let uvs = self.uv_sets(all)?;
        let colors = self.beside("COLOR_0", &["VEC3", "VEC4"], all)?.map(Accessor::with_fractions);
        let count = kept.as_ref().map_or(all, Vec::len);
        self.data.charge((48 + 8 * uvs.len() as u64) * count as u64, self.part)?;
        let chosen = Chosen { kept, count };
        Ok(Mesh {
            positions: chosen.read(positions, Vec3::from_array),
            normals: normals.map_or_else(Vec::new, |n| chosen.read(&n, Vec3::from_array)),
            // glTF's v points down.
            uvs: uvs.iter().map(|set| chosen.read(set, |[u, v]| Vec2::new(u, 1.0 - v))).collect(),
            colors: colors.map_or_else(Vec::new, |c| {
                let opaque = c.components == 3;
                chosen.read(&c, |[r, g, b, a]| [r, g, b, if opaque { 1.0 } else { a }])
            }),
            ..Mesh::default()
        })
    }

    /// TEXCOORD_0, TEXCOORD_1 and so on up to the first that is missing.
    fn uv_sets(&self, count: usize) -> Result<Vec<Accessor<'a>>> {
        let mut sets = Vec::new();
        while let Some(set) = self.beside(&format!("TEXCOORD_{}", sets.len()), &["VEC2"], count)? {
            sets.push(set);
        }
        Ok(sets)
    }
}

/// The vertices that are read of an accessor.
struct Chosen {
    kept: Option<Vec<u32>>,
    count: usize,
}

impl Chosen {
    fn read<const N: usize, T>(&self, accessor: &Accessor, map: impl Fn([f32; N]) -> T) -> Vec<T> {
        match &self.kept {
            Some(kept) => kept.iter().map(|&i| map(accessor.get(i as usize))).collect(),
            None => (0..self.count).map(|i| map(accessor.get(i))).collect(),
        }
    }
}

/// Many primitives may share one long list of vertices: each keeps only those it uses.
///
/// Returns the vertices to keep, if not all, and the corners as indices into them. Work and memory grow with the
/// corners alone.
fn compact(corners: Vec<u32>, count: usize) -> (Option<Vec<u32>>, Vec<u32>) {
    if corners.len() >= count {
        return (None, corners);
    }
    let mut kept = corners.clone();
    kept.sort_unstable();
    kept.dedup();
    let place = |corner: u32| kept.binary_search(&corner).unwrap_or_default() as u32;
    let corners = corners.into_iter().map(place).collect();
    (Some(kept), corners)
}

/// Makes every number finite, every normal a unit vector and every colour 0 to 1, as glTF wants them clamped.
fn tidy(mesh: &mut Mesh, part: &str, notes: &mut Notes) {
    drop_broken_triangles(mesh, part, notes);
    repair_normals(mesh, part, notes);
    let mut broken = 0;
    for uv in mesh.uvs.iter_mut().flatten().filter(|uv| !uv.is_finite()) {
        *uv = Vec2::ZERO;
        broken += 1;
    }
    notes.add_many(part, "texture coordinates are not finite numbers and were set to 0", broken);
    let (mut broken, mut bright) = (0, 0);
    for channel in mesh.colors.as_flattened_mut() {
        if !(channel.is_finite() && *channel >= 0.0) {
            *channel = 1.0;
            broken += 1;
        }
        bright += usize::from(*channel > 1.0 + ROUNDING);
        *channel = channel.min(1.0);
    }
    notes.add_many(part, "vertex colours are negative or not finite and were set to 1", broken);
    let message = "vertex colours are beyond 1, as of 0 to 255, and were set to 1";
    notes.add_many(part, message, bright);
}

fn drop_broken_triangles(mesh: &mut Mesh, part: &str, notes: &mut Notes) {
    if mesh.positions.iter().all(|position| position.is_finite()) {
        return;
    }
    let before = mesh.triangles.len();
    let positions = &mesh.positions;
    let finite = |&corner: &u32| positions.get(corner as usize).is_some_and(|p| p.is_finite());
    mesh.triangles.retain(|triangle| triangle.iter().all(finite));
    mesh.positions.iter_mut().filter(|p| !p.is_finite()).for_each(|p| *p = Vec3::ZERO);
    let dropped = before - mesh.triangles.len();
    notes.add_many(part, "triangles with corners that are not finite are left out", dropped);
}

/// Vertices without a usable normal get the mean of their triangles' normals.
fn repair_normals(mesh: &mut Mesh, part: &str, notes: &mut Notes) {
    let usable = |normal: &Vec3| normal.is_finite() && normal.try_normalize().is_some();
    let mut broken = 0;
    if !mesh.normals.iter().all(usable) {
        let mut sums = vec![Vec3::ZERO; mesh.positions.len()];
        for &triangle in &mesh.triangles {
            let at = |corner: u32| mesh.positions.get(corner as usize).copied().unwrap_or_default();
            let [a, b, c] = triangle.map(at);
            let normal = (b - a).cross(c - a).normalize_or_zero();
            for corner in triangle {
                sums.get_mut(corner as usize).into_iter().for_each(|sum| *sum += normal);
            }
        }
        for (normal, sum) in mesh.normals.iter_mut().zip(sums).filter(|(n, _)| !usable(n)) {
            *normal = sum.normalize_or(Vec3::Z);
            broken += 1;
        }
    }
    mesh.normals.iter_mut().for_each(|normal| *normal = normal.normalize_or(Vec3::Z));
    notes.add_many(part, "normals without a direction were replaced by the triangles'", broken);
}
