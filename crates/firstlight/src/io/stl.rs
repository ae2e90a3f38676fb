//! STL, text and binary: triangles without materials.
//!
//! Own code, because stl_io 0.11 names neither line nor byte in its errors.

use super::text::{Line, Lines, Tally, counted, floats, part_of, quoted, without_mark};
use super::triangles::{
    Distinct, Triangulator, add_surface, default_material, not_empty, vertex_number,
};
use super::{FileAccess, Warnings};
use crate::diagnostic::{Diagnostic, Place, Result};
use crate::scene::description::{Mesh, SceneDescription};
use glam::Vec3;

/// Bytes before the facets of a binary file: 80 of free text and their number.
const HEADER: usize = 84;
/// Bytes of a binary facet: normal, three corners, two bytes that mean nothing.
const FACET: usize = 50;

/// More solids than this in one file are joined.
const MOST_SOLIDS: usize = 1 << 14;

/// Reads an STL file: one flat shaded surface per solid, corners at the same position joined.
///
/// Coordinates stay as in the file; `name` is its name for messages. Normals and colours in the file are
/// ignored: the order of a facet's corners decides what is its front.
///
/// # Errors
/// If the file is cut off, a line of a text file cannot be read, or there are no triangles.
pub fn read(
    bytes: &[u8],
    name: &str,
    _access: &FileAccess,
    warnings: &mut Warnings,
) -> Result<SceneDescription> {
    let mut solids = Solids::new(name);
    if is_text(bytes) {
        read_text(bytes, &mut solids, warnings)?;
    } else {
        read_binary(bytes, &mut solids, warnings)?;
    }
    solids.finish(warnings)
}

/// Whether this is a text file. Binary files may start with `solid` as well, but their length fits their count.
fn is_text(bytes: &[u8]) -> bool {
    let fits = facet_count(bytes).is_some_and(|count| facets_end(count) == bytes.len() as u64);
    let start = without_mark(bytes).trim_ascii_start();
    let solid = start.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    solid && !fits && !start.iter().take(512).any(|&byte| byte == 0)
}

fn facet_count(bytes: &[u8]) -> Option<u32> {
    bytes.get(80..)?.first_chunk().map(|count| u32::from_le_bytes(*count))
}

fn facets_end(count: u32) -> u64 {
    HEADER as u64 + FACET as u64 * u64::from(count)
}

fn read_binary(bytes: &[u8], solids: &mut Solids<'_>, warnings: &mut Warnings) -> Result<()> {
    let name = solids.file;
    let Some(promised) = facet_count(bytes) else {
        let cause = format!("this is no STL file: it has only {}", counted(bytes.len(), "byte"));
        return Err(Box::new(Diagnostic::new(name, cause)));
    };
    let (facets, rest) = bytes.get(HEADER..).unwrap_or_default().as_chunks::<FACET>();
    let Some((facets, more)) = facets.split_at_checked(promised as usize) else {
        let promised = counted(promised as usize, "facet");
        let cause = format!("the file promises {promised}, but holds {}", facets.len());
        let error = Diagnostic::new(name, cause).at_part("byte 80");
        return Err(Box::new(
            error.help("it was cut off or damaged on its way, or is no STL file"),
        ));
    };
    for (number, facet) in facets.iter().enumerate() {
        solids.add(corners_of(facet), || part_of(name, format!("facet {}", number + 1)))?;
    }
    let extra = more.len() * FACET + rest.len();
    if extra > 0 {
        let message = format!("{} after the last facet ignored", counted(extra, "byte"));
        warnings.push(Diagnostic::new(name, message));
    }
    Ok(())
}

/// The three corners of a binary facet, after its normal.
fn corners_of(facet: &[u8; FACET]) -> [Vec3; 3] {
    let numbers = facet.as_chunks::<4>().0;
    let number = |i: usize| numbers.get(i).map_or(f32::NAN, |bytes| f32::from_le_bytes(*bytes));
    [3, 6, 9].map(|first| Vec3::new(number(first), number(first + 1), number(first + 2)))
}

fn read_text(bytes: &[u8], solids: &mut Solids<'_>, warnings: &mut Warnings) -> Result<()> {
    let name = solids.file;
    let mut corners = Vec::new();
    let mut last = Line { number: 1, text: &[] };
    let mut ended = false;
    for line in Lines::new(bytes) {
        let mut words = line.words();
        let Some(keyword) = words.next() else { continue };
        let fail = |cause: String| Box::new(line.complain(name, cause));
        ended = false;
        match keyword.to_ascii_lowercase().as_slice() {
            b"vertex" if corners.len() < 3 => {
                corners.push(Vec3::from(floats(&mut words).map_err(fail)?));
            }
            b"vertex" => return Err(fail("a facet has three corners; this is the fourth".into())),
            b"endloop" => {
                let Ok(facet) = <[Vec3; 3]>::try_from(corners.as_slice()) else {
                    let found = counted(corners.len(), "corner");
                    return Err(fail(format!("a facet has three corners, this one has {found}")));
                };
                solids.add(facet, || line.place(name))?;
                corners.clear();
            }
            b"solid" => solids.start(line.after_keyword(), || line.place(name)),
            b"endsolid" => ended = true,
            b"facet" | b"outer" | b"endfacet" => {}
            _ => return Err(fail(format!("{} is no word of the STL format", quoted(keyword)))),
        }
        last = line;
    }
    if !corners.is_empty() {
        return Err(Box::new(last.complain(name, "the file ends inside a facet")));
    }
    if !ended {
        let cause = "the file ends without \"endsolid\": it may have been cut off";
        warnings.push(last.complain(name, cause));
    }
    Ok(())
}

/// The solids of a file as they grow.
struct Solids<'a> {
    file: &'a str,
    triangulator: Triangulator,
    joined: Tally,
    scene: SceneDescription,
    current: Solid,
}

/// One solid: its different corners, as the bits of their coordinates, and its triangles.
#[derive(Default)]
struct Solid {
    name: String,
    corners: Distinct<[u32; 3]>,
    triangles: Vec<[u32; 3]>,
}

impl<'a> Solids<'a> {
    fn new(file: &'a str) -> Self {
        Self {
            file,
            triangulator: Triangulator::default(),
            joined: Tally::default(),
            scene: SceneDescription::default(),
            current: Solid::default(),
        }
    }

    /// What follows belongs to a solid called `name`.
    fn start(&mut self, name: String, place: impl FnOnce() -> Place) {
        if self.scene.surfaces.len() == MOST_SOLIDS {
            self.joined.add(place);
            return;
        }
        self.end(name);
    }

    /// Adds the current solid to the scene if it has triangles; the next is called `name`.
    fn end(&mut self, name: String) {
        let solid = std::mem::replace(&mut self.current, Solid { name, ..Solid::default() });
        if !solid.triangles.is_empty() {
            add_surface(&mut self.scene, solid.into_mesh(), 0);
        }
    }

    /// Adds a facet to the current solid if it has an area.
    fn add(&mut self, corners: [Vec3; 3], place: impl FnOnce() -> Place) -> Result<()> {
        if self.triangulator.split(&corners, place).is_empty() {
            return Ok(());
        }
        let mut triangle = [0; 3];
        for (index, corner) in triangle.iter_mut().zip(corners) {
            // Adding 0 makes -0 the same as 0.
            let bits = (corner + Vec3::ZERO).to_array().map(f32::to_bits);
            *index = vertex_number(self.current.corners.insert_full(bits).0, self.file)?;
        }
        self.current.triangles.push(triangle);
        Ok(())
    }

    fn finish(mut self, warnings: &mut Warnings) -> Result<SceneDescription> {
        self.end(String::new());
        self.triangulator.finish(self.scene.surfaces.is_empty(), warnings)?;
        self.joined.warn(warnings, |count| {
            format!("{} after the first {MOST_SOLIDS} joined into one", counted(count, "solid"))
        });
        self.scene.materials.push(default_material());
        not_empty(self.scene, self.file)
    }
}

impl Solid {
    fn into_mesh(self) -> Mesh {
        let position = |bits: [u32; 3]| Vec3::from(bits.map(f32::from_bits));
        let positions = self.corners.into_iter().map(position).collect();
        Mesh { name: self.name, positions, triangles: self.triangles, ..Mesh::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::description::Shape;
    use std::path::Path;

    const TEXT: &str = "solid first part\n facet normal 0 0 1\n  outer loop\n\
        vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n\
        facet normal 0 0 1\nouter loop\nvertex 1 0 0\nVERTEX 1 1 0\nvertex -0 1 0\nendloop\nendfacet\n\
        endsolid first part\n";

    fn load(bytes: &[u8]) -> (Result<SceneDescription>, Warnings) {
        let mut warnings = Warnings::new();
        let access = FileAccess::beside(Path::new("x.stl"), &[]);
        let scene = read(bytes, "x.stl", &access, &mut warnings);
        (scene, warnings)
    }

    fn error(bytes: &[u8]) -> String {
        load(bytes).0.expect_err("must be refused").to_string()
    }

    fn binary(header: &str, count: u32, facets: &[[f32; 9]]) -> Vec<u8> {
        let mut bytes = header.as_bytes().to_vec();
        bytes.resize(80, 0);
        bytes.extend(count.to_le_bytes());
        for facet in facets {
            bytes.extend([0; 12]);
            bytes.extend(facet.iter().flat_map(|number| number.to_le_bytes()));
            bytes.extend([0; 2]);
        }
        bytes
    }

    const UPPER: [f32; 9] = [1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0];
    const LOWER: [f32; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, -0.0, 1.0, 0.0];

    #[test]
    fn text_and_binary_join_their_corners() {
        for bytes in [TEXT.as_bytes().to_vec(), binary("solid", 2, &[LOWER, UPPER])] {
            let (scene, warnings) = load(&bytes);
            let scene = scene.unwrap();
            assert_eq!(scene.meshes[0].triangles, [[0, 1, 2], [1, 3, 2]]);
            assert_eq!(scene.meshes[0].positions.len(), 4);
            assert_eq!(scene.materials[0].name, "default");
            assert!(warnings.is_empty(), "{warnings:?}");
        }
    }

    #[test]
    fn every_solid_is_a_surface() {
        let (scene, _) = load(format!("{TEXT}{}", TEXT.replace("first", "second")).as_bytes());
        let scene = scene.unwrap();
        assert_eq!(scene.surfaces[1].name, "second part");
        assert_eq!(scene.surfaces[1].shape, Shape::Mesh(1));
    }

    #[test]
    fn lying_counts_and_cut_files_are_refused() {
        let lie = error(&binary("", u32::MAX, &[]));
        assert!(lie.contains("promises 4294967295 facets, but holds 0"), "{lie}");
        let cut = error(binary("solid", 2, &[LOWER, UPPER]).split_last().unwrap().1);
        assert!(cut.contains("promises 2 facets, but holds 1"), "{cut}");
        assert!(error(b"").contains("0 bytes"));
        assert!(error(b"solid x\nendsolid").contains("no triangles"));
        assert!(error(b"solid x\nvertex 1 2 3\n").contains(":2: the file ends inside a facet"));
    }

    #[test]
    fn bad_lines_are_named() {
        let number = error(TEXT.replace("vertex 1 0 0", "vertex 1 zero 0").as_bytes());
        assert!(number.starts_with("x.stl:5: cannot read \"zero\" as a number"), "{number}");
        let short = error(TEXT.replacen("vertex 1 0 0\n", "", 1).as_bytes());
        assert!(short.contains("x.stl:6: a facet has three corners, this one has 2"), "{short}");
    }

    #[test]
    fn facets_without_area_are_left_out_with_one_warning() {
        let flat = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 2.0, 0.0, 0.0];
        let wild = [f32::NAN, 0.0, 0.0, 1.0, 0.0, 0.0, 2.0, 1.0, 0.0];
        let (scene, warnings) = load(&binary("", 3, &[flat, LOWER, wild]));
        assert_eq!(scene.unwrap().meshes[0].triangles.len(), 1);
        assert_eq!(warnings.len(), 1);
        assert!(warnings[0].to_string().starts_with("x.stl: facet 1: 2 faces"), "{}", warnings[0]);
    }

    #[test]
    fn bytes_after_the_facets_are_ignored_with_a_warning() {
        let mut bytes = binary("solid", 1, &[LOWER]);
        bytes.extend(b"more");
        let (scene, warnings) = load(&bytes);
        assert!(scene.is_ok());
        assert!(warnings[0].to_string().contains("4 bytes"), "{}", warnings[0]);
    }
}
