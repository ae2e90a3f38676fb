//! The rows of a PLY file's vertices.

use super::header::{Element, Property, Scalar};
use super::values::Values;
use crate::color::srgb_decode;
use crate::diagnostic::{Diagnostic, Result};
use crate::io::Warnings;
use crate::io::text::{Parsed, Tally, counted, part_of};
use crate::scene::description::Mesh;
use glam::{Vec2, Vec3};

/// The places of a row, and the names that properties of it go by.
const SLOTS: [&[&str]; 12] = [
    &["x"],
    &["y"],
    &["z"],
    &["nx", "normal_x"],
    &["ny", "normal_y"],
    &["nz", "normal_z"],
    &["s", "u", "texture_u", "texture_s"],
    &["t", "v", "texture_v", "texture_t"],
    &["red", "r", "diffuse_red"],
    &["green", "g", "diffuse_green"],
    &["blue", "b", "diffuse_blue"],
    &["alpha", "a", "diffuse_alpha"],
];

/// Where the values of a row go; the last place is for what is of no use.
type Row = [f64; SLOTS.len() + 1];

/// What the rows of the vertices hold.
struct Layout<'a> {
    properties: Vec<(&'a Property, usize)>,
    kinds: [Option<Scalar>; SLOTS.len()],
    /// Linear values of sRGB-encoded bytes.
    decoded: Vec<f32>,
}

impl<'a> Layout<'a> {
    fn of(element: &'a Element) -> Self {
        let mut kinds = [None; SLOTS.len()];
        let mut properties = Vec::new();
        for property in &element.properties {
            let named = |names: &&[&str]| names.contains(&property.name.as_str());
            let slot = SLOTS.iter().position(named).filter(|_| property.length.is_none());
            let free = slot.and_then(|slot| kinds.get_mut(slot)).filter(|kind| kind.is_none());
            let slot = free.and_then(|kind| {
                *kind = Some(property.value);
                slot
            });
            properties.push((property, slot.unwrap_or(SLOTS.len())));
        }
        let decoded = (0..=u8::MAX).map(|byte| srgb_decode(f32::from(byte) / 255.0)).collect();
        Self { properties, kinds, decoded }
    }

    /// Whether a row holds all of these places.
    fn has(&self, slots: std::ops::Range<usize>) -> bool {
        self.kinds.get(slots).is_some_and(|kinds| kinds.iter().all(Option::is_some))
    }

    fn read_row(&self, values: &mut impl Values) -> Parsed<Row> {
        let mut row = Row::default();
        for &(property, slot) in &self.properties {
            if property.length.is_some() {
                values.skip(property)?;
            } else if let Some(place) = row.get_mut(slot) {
                *place = values.next(property.value)?;
            }
        }
        Ok(row)
    }

    /// The linear value of the colour in place `slot`.
    fn color(&self, value: f64, slot: usize) -> f32 {
        match self.kinds.get(slot).copied().flatten() {
            Some(Scalar::F32 | Scalar::F64) | None => value as f32,
            Some(Scalar::U16) => srgb_decode((value / 65535.0) as f32),
            Some(_) => self.decoded.get(value.clamp(0.0, 255.0) as usize).copied().unwrap_or(0.0),
        }
    }

    /// The alpha of a row; 1 if it has none.
    fn alpha(&self, value: f64) -> f32 {
        match self.kinds.last().copied().flatten() {
            None => 1.0,
            Some(Scalar::F32 | Scalar::F64) => value as f32,
            Some(Scalar::U16) => (value / 65535.0) as f32,
            Some(_) => (value / 255.0) as f32,
        }
    }
}

/// Reads the rows of `element` into a mesh without triangles. Normals without direction become 0.
pub(super) fn read<V: Values>(
    values: &mut V,
    element: &Element,
    name: &str,
    warnings: &mut Warnings,
) -> Result<Mesh> {
    let layout = Layout::of(element);
    if !layout.has(0..3) {
        let error = Diagnostic::new(name, "the vertices have no \"x\", \"y\" and \"z\"");
        return Err(Box::new(error.at_line(element.line)));
    }
    let (normals, uvs, colors) = (layout.has(3..6), layout.has(6..8), layout.has(8..11));
    let mut mesh = Mesh { uvs: if uvs { vec![vec![]] } else { vec![] }, ..Mesh::default() };
    let (mut odd_uvs, mut odd_colors) = (Tally::default(), Tally::default());
    for number in 0..element.count {
        let row = layout.read_row(values).map_err(|cause| {
            values.complain(name, format!("vertex {number} of {}: {cause}", element.count))
        })?;
        values.end_row(name);
        let place = || part_of(name, format!("vertex {number}"));
        let [x, y, z, nx, ny, nz, u, v, r, g, b, a, _] = row;
        mesh.positions.push(Vec3::new(x as f32, y as f32, z as f32));
        if normals {
            let normal = Vec3::new(nx as f32, ny as f32, nz as f32);
            mesh.normals.push(normal.normalize_or_zero());
        }
        if let Some(set) = mesh.uvs.first_mut() {
            let uv = Vec2::new(u as f32, v as f32);
            let sound = uv.is_finite();
            set.push(if sound { uv } else { Vec2::ZERO });
            odd_uvs.add_if(!sound, place);
        }
        if colors {
            let color =
                [layout.color(r, 8), layout.color(g, 9), layout.color(b, 10), layout.alpha(a)];
            let sound = color.iter().all(|value| (0.0..=1.0).contains(value));
            mesh.colors.push(color.map(|value| value.clamp(0.0, 1.0).max(0.0)));
            odd_colors.add_if(!sound, place);
        }
    }
    odd_uvs.warn(warnings, |count| {
        format!("{} not finite, taken as 0", counted(count, "texture coordinate"))
    });
    odd_colors.warn(warnings, |count| {
        format!("{} outside 0..1, clamped", counted(count, "vertex color"))
    });
    Ok(mesh)
}
