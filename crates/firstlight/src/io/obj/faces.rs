//! `f` lines of an OBJ file, gathered by material.

use super::vertices::{Vertices, complaint};
use crate::diagnostic::{Place, Result};
use crate::io::Warnings;
use crate::io::text::{Line, Lines, Parsed, Tally, counted, quoted, whole};
use crate::io::triangles::{
    Distinct, Triangulator, add_surface, check_corners, unit_normal, weighted_normals,
};
use crate::scene::description::{Mesh, SceneDescription};
use glam::Vec3;
use indexmap::IndexMap;
use std::collections::HashMap;

/// More materials than this in one file are refused.
pub(super) const MOST_MATERIALS: usize = 1 << 14;

/// Stands for texture coordinates or a normal that a corner does not have.
const NONE: u32 = u32::MAX;

/// Words that start lines without meaning for the picture.
const SILENT: [&[u8]; 11] =
    [b"o", b"g", b"mg", b"lod", b"bevel", b"c_interp", b"d_interp", b"vp", b"v", b"vt", b"vn"];
/// A corner of a face: numbers of its position, texture coordinates and normal, from 0.
type Corner = [u32; 3];

/// The faces of a file, as they are read.
pub(super) struct Faces<'a> {
    name: &'a str,
    vertices: Vertices,
    /// Lines of each kind so far, which negative numbers count back from.
    so_far: [usize; 3],
    /// Material files, and where each is first named.
    pub(super) libraries: IndexMap<String, Place>,
    /// Materials, and where each is first named. The first has no name: faces before any `usemtl`.
    materials: IndexMap<String, Place>,
    material: usize,
    /// The smoothing group; 0 is none.
    group: u32,
    made: MadeNormals,
    /// By material, and whether it is smooth.
    parts: IndexMap<(usize, bool), Part>,
    triangulator: Triangulator,
    corners: Vec<Corner>,
    points: Vec<Vec3>,
    tallies: Tallies,
}

#[derive(Default)]
struct Tallies {
    odd_normals: Tally,
    lines: Tally,
    unknown: Tally,
}

/// Normals for the positions in smoothing groups, as sums over the faces around them.
#[derive(Default)]
struct MadeNormals {
    numbers: HashMap<(u32, u32), u32, foldhash::fast::RandomState>,
    sums: Vec<Vec3>,
    /// The number of the first: the file's own normals come before.
    first: usize,
}

/// The triangles of one mesh and the different corners they have.
#[derive(Debug, Default)]
struct Part {
    corners: Distinct<Corner>,
    triangles: Vec<[u32; 3]>,
}

impl<'a> Faces<'a> {
    /// Reads the face lines of the file called `name`.
    pub(super) fn read(
        bytes: &[u8],
        name: &'a str,
        vertices: Vertices,
        warnings: &mut Warnings,
    ) -> Result<Self> {
        let mut faces = Self::new(name, vertices);
        for line in Lines::joined(bytes) {
            faces.read_line(&line).map_err(|cause| complaint(&line, name, cause))?;
        }
        faces.vertices.normals.extend(faces.made.sums.iter().map(|&sum| unit_normal(sum)));
        faces.made = MadeNormals::default();
        faces.triangulator.finish(faces.parts.is_empty(), warnings)?;
        std::mem::take(&mut faces.tallies).warn(warnings);
        Ok(faces)
    }

    fn new(name: &'a str, vertices: Vertices) -> Self {
        Self {
            name,
            so_far: [0; 3],
            libraries: IndexMap::new(),
            materials: IndexMap::from([(String::new(), Place::default())]),
            material: 0,
            group: 0,
            made: MadeNormals { first: vertices.normals.len(), ..MadeNormals::default() },
            vertices,
            parts: IndexMap::new(),
            triangulator: Triangulator::default(),
            corners: Vec::new(),
            points: Vec::new(),
            tallies: Tallies::default(),
        }
    }

    fn read_line(&mut self, line: &Line<'_>) -> Parsed<()> {
        let mut words = line.words();
        let Some(keyword) = words.next() else { return Ok(()) };
        let [positions, uvs, normals] = &mut self.so_far;
        match keyword {
            b"v" => *positions += 1,
            b"vt" => *uvs += 1,
            b"vn" => *normals += 1,
            b"f" | b"fo" => self.read_face(words, line)?,
            b"usemtl" => self.use_material(line)?,
            b"mtllib" => {
                let library = self.libraries.entry(line.after_keyword());
                library.or_insert_with(|| line.place(self.name));
            }
            b"s" => self.group = smoothing_group(words.next()),
            b"l" | b"p" => self.tallies.lines.add(|| line.place(self.name)),
            keyword if SILENT.contains(&keyword) => {}
            _ => self.tallies.unknown.add(|| line.place(self.name)),
        }
        Ok(())
    }

    fn use_material(&mut self, line: &Line<'_>) -> Parsed<()> {
        let entry = self.materials.entry(line.after_keyword());
        self.material = entry.index();
        entry.or_insert_with(|| line.place(self.name));
        let many = self.materials.len() > MOST_MATERIALS;
        if many { Err(format!("more than {MOST_MATERIALS} materials")) } else { Ok(()) }
    }

    fn read_face<'w>(
        &mut self,
        words: impl Iterator<Item = &'w [u8]>,
        line: &Line<'_>,
    ) -> Parsed<()> {
        self.corners.clear();
        self.points.clear();
        for word in words {
            let corner @ [position, ..] = self.corner(word)?;
            self.corners.push(corner);
            self.points.extend(self.vertices.positions.get(position as usize));
            check_corners(self.corners.len())?;
        }
        let own_normals = self.check_normals(line);
        let smooth = own_normals || self.group > 0;
        let triangles = self.triangulator.split(&self.points, || line.place(self.name));
        for triangle in triangles {
            let mut corners = triangle.map(|i| self.corners.get(i).copied().unwrap_or_default());
            if !own_normals && smooth {
                let points = triangle.map(|i| self.points.get(i).copied().unwrap_or_default());
                self.made.add(&mut corners, self.group, points)?;
            }
            self.parts.entry((self.material, smooth)).or_default().add(corners)?;
        }
        Ok(())
    }

    /// Whether all corners of the face have a normal with a direction; otherwise they lose those they have.
    fn check_normals(&mut self, line: &Line<'_>) -> bool {
        let normal = |&[_, _, n]: &Corner| self.vertices.normals.get(n as usize).copied();
        let named = self.corners.iter().all(|corner| normal(corner).is_some());
        let sound = named && self.corners.iter().all(|corner| normal(corner) != Some(Vec3::ZERO));
        self.tallies.odd_normals.add_line_if(named && !sound, self.name, line);
        if !sound {
            self.corners.iter_mut().for_each(|[_, _, normal]| *normal = NONE);
        }
        sound
    }

    /// Reads `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    fn corner(&self, word: &[u8]) -> Parsed<Corner> {
        let totals = [self.vertices.positions.len(), self.vertices.uvs.len(), self.made.first];
        let mut corner = [NONE; 3];
        let mut texts = word.split(|&byte| byte == b'/');
        for (kind, number) in corner.iter_mut().enumerate() {
            let text = texts.next().unwrap_or_default();
            if kind == 0 || !text.is_empty() {
                let counts = (totals.get(kind).copied(), self.so_far.get(kind).copied());
                *number = index(text, kind, counts.0.unwrap_or(0), counts.1.unwrap_or(0))?;
            }
        }
        match texts.next() {
            None => Ok(corner),
            Some(_) => Err(format!("{} has more than two slashes", quoted(word))),
        }
    }

    /// Adds the surfaces to `scene`, and returns the materials they number, each with its first place.
    pub(super) fn add_surfaces(self, scene: &mut SceneDescription) -> IndexMap<String, Place> {
        let mut used = IndexMap::new();
        for ((material, smooth), part) in self.parts {
            let Some((name, place)) = self.materials.get_index(material) else { continue };
            let entry = used.entry(name.clone());
            let number = entry.index();
            entry.or_insert_with(|| place.clone());
            add_surface(scene, part.into_mesh(name, smooth, &self.vertices), number);
        }
        used
    }
}

impl Tallies {
    fn warn(self, warnings: &mut Warnings) {
        self.odd_normals.warn(warnings, |count| {
            format!("{} with normals without direction: shown flat", counted(count, "face"))
        });
        self.lines.warn(warnings, |count| {
            format!(
                "{} of lines or points skipped: only faces are shown",
                counted(count, "element")
            )
        });
        self.unknown.warn(warnings, |count| {
            format!("{} with an unknown keyword skipped", counted(count, "line"))
        });
    }
}

impl MadeNormals {
    /// Gives the corners of a triangle at `points` the normals of a group, and adds the triangle's to them.
    fn add(&mut self, corners: &mut [Corner; 3], group: u32, points: [Vec3; 3]) -> Parsed<()> {
        for ([position, _, normal], weighted) in corners.iter_mut().zip(weighted_normals(points)) {
            let next = small(self.first + self.sums.len())?;
            *normal = *self.numbers.entry((*position, group)).or_insert(next);
            if *normal == next {
                self.sums.push(Vec3::ZERO);
            }
            let sum = self.sums.get_mut(*normal as usize - self.first);
            sum.into_iter().for_each(|sum| *sum += weighted);
        }
        Ok(())
    }
}

impl Part {
    fn add(&mut self, corners: [Corner; 3]) -> Parsed<()> {
        let [a, b, c] = corners.map(|corner| small(self.corners.insert_full(corner).0));
        self.triangles.push([a?, b?, c?]);
        Ok(())
    }

    fn into_mesh(self, name: &str, smooth: bool, vertices: &Vertices) -> Mesh {
        let with_uvs = self.corners.iter().any(|corner| corner[1] != NONE);
        let uvs = with_uvs.then(|| self.pick(&vertices.uvs, 1));
        Mesh {
            name: name.into(),
            positions: self.pick(&vertices.positions, 0),
            normals: if smooth { self.pick(&vertices.normals, 2) } else { Vec::new() },
            uvs: uvs.into_iter().collect(),
            colors: if vertices.colors.is_empty() {
                vec![]
            } else {
                self.pick(&vertices.colors, 0)
            },
            triangles: self.triangles,
        }
    }

    /// The value of every corner, 0 where it has none. `kind`: which of a corner's numbers counts.
    fn pick<T: Copy + Default>(&self, values: &[T], kind: usize) -> Vec<T> {
        let numbers = self.corners.iter().filter_map(|corner| corner.get(kind));
        numbers.map(|&number| values.get(number as usize).copied().unwrap_or_default()).collect()
    }
}

/// A number as corners store it.
fn small(number: usize) -> Parsed<u32> {
    let number = u32::try_from(number).ok().filter(|&number| number != NONE);
    number.ok_or_else(|| "more vertices than 4294967294".into())
}

fn smoothing_group(word: Option<&[u8]>) -> u32 {
    let text = word.and_then(|word| str::from_utf8(word).ok()).unwrap_or_default();
    if text == "on" { 1 } else { text.parse().unwrap_or(0) }
}

/// The number from 0 that `text` stands for: from 1 up, or from -1 back through the `so_far` lines before.
fn index(text: &[u8], kind: usize, total: usize, so_far: usize) -> Parsed<u32> {
    let what = ["vertex", "texture coordinate", "normal"].get(kind).unwrap_or(&"vertex");
    let number = whole(text).ok_or_else(|| format!("cannot read {} as a {what}", quoted(text)))?;
    let base = if number < 0 { i64::try_from(so_far).unwrap_or(i64::MAX) } else { -1 };
    let found = number.checked_add(base).and_then(|index| usize::try_from(index).ok());
    match found.filter(|&index| index < total) {
        Some(index) => small(index),
        None if number == 0 => Err(format!("{what} 0 does not exist: numbers start at 1")),
        None if number < 0 => Err(format!("{what} {number} does not exist: only {so_far} before")),
        None if total == 0 => Err(format!("{what} {number} does not exist: the file has none")),
        None => Err(format!("{what} {number} does not exist, only 1 to {total}")),
    }
}
