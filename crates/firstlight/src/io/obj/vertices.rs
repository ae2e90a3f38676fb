//! What the faces of an OBJ file refer to: `v`, `vt` and `vn` lines.

use crate::diagnostic::{Diagnostic, Result};
use crate::io::Warnings;
use crate::io::text::{Line, Lines, Parsed, Tally, counted, float, floats, quoted};
use glam::{Vec2, Vec3};

/// All positions, texture coordinates and normals of a file, in its order.
#[derive(Debug, Default)]
pub(super) struct Vertices {
    pub(super) positions: Vec<Vec3>,
    /// Linear RGBA; empty, or one per position.
    pub(super) colors: Vec<[f32; 4]>,
    pub(super) uvs: Vec<Vec2>,
    /// Unit vectors, or 0 for what has no direction.
    pub(super) normals: Vec<Vec3>,
}

impl Vertices {
    /// Reads the vertex lines of the file called `name` and skips all others.
    pub(super) fn read(bytes: &[u8], name: &str, warnings: &mut Warnings) -> Result<Self> {
        let mut vertices = Self::default();
        let (mut odd_uvs, mut odd_colors) = (Tally::default(), Tally::default());
        for line in Lines::joined(bytes) {
            let mut words = line.words();
            let fail = |cause: String| complaint(&line, name, cause);
            match words.next() {
                Some(b"v") => {
                    let sound = vertices.add_position(&mut words).map_err(fail)?;
                    odd_colors.add_line_if(!sound, name, &line);
                }
                Some(b"vt") => {
                    let sound = vertices.add_uv(&mut words).map_err(fail)?;
                    odd_uvs.add_line_if(!sound, name, &line);
                }
                Some(b"vn") => {
                    let normal = floats(&mut words).map_err(fail)?;
                    vertices.normals.push(Vec3::from(normal).normalize_or_zero());
                }
                _ => {}
            }
        }
        odd_uvs.warn(warnings, |count| {
            format!("{} not finite, taken as 0", counted(count, "texture coordinate"))
        });
        odd_colors.warn(warnings, |count| {
            format!("{} outside 0..1, clamped", counted(count, "vertex color"))
        });
        Ok(vertices)
    }

    /// `x y z`, then nothing, a weight, `r g b` or `r g b a`; tells whether the colour was within 0..1.
    fn add_position<'a>(&mut self, words: &mut impl Iterator<Item = &'a [u8]>) -> Parsed<bool> {
        self.positions.push(Vec3::from(floats(words)?));
        let mut color = [1.0; 4];
        let mut found = 0;
        for (value, word) in color.iter_mut().zip(words) {
            *value = number(word)?;
            found += 1;
        }
        if found < 3 {
            if !self.colors.is_empty() {
                self.colors.push([1.0; 4]);
            }
            return Ok(true);
        }
        self.colors.resize(self.positions.len() - 1, [1.0; 4]);
        self.colors.push(color.map(|value| value.clamp(0.0, 1.0).max(0.0)));
        Ok(color.iter().all(|value| (0.0..=1.0).contains(value)))
    }

    /// `u`, `v` (0 if missing) and a third number of no use; tells whether they were finite.
    fn add_uv<'a>(&mut self, words: &mut impl Iterator<Item = &'a [u8]>) -> Parsed<bool> {
        let [u] = floats(words)?;
        let uv = Vec2::new(u, words.next().map_or(Ok(0.0), number)?);
        let sound = uv.is_finite();
        self.uvs.push(if sound { uv } else { Vec2::ZERO });
        Ok(sound)
    }
}

fn number(word: &[u8]) -> Parsed<f32> {
    float(word).ok_or_else(|| format!("cannot read {} as a number", quoted(word)))
}

/// An error on `line`; numbers with a comma get a hint.
pub(super) fn complaint(line: &Line<'_>, name: &str, cause: String) -> Box<Diagnostic> {
    let comma = line.words().any(|word| word.contains(&b','));
    let error = line.complain(name, cause);
    Box::new(if comma { error.help("write a point in numbers, no comma") } else { error })
}
