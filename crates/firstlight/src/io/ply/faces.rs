//! The rows of a PLY file's faces and triangle strips.

use super::header::{Element, Property};
use super::values::Values;
use crate::diagnostic::{Diagnostic, Result};
use crate::io::text::{Parsed, part_of};
use crate::io::triangles::{
    Distinct, Triangulator, check_corners, has_area, pick_vertices, vertex_number,
};
use crate::scene::description::Mesh;
use glam::Vec2;

/// Adds triangles to a mesh that has its vertices.
pub(super) struct Faces<'a> {
    name: &'a str,
    pub(super) mesh: Mesh,
    /// Texture coordinates of each triangle's corners, if the faces have their own.
    corner_uvs: Vec<[Vec2; 3]>,
    pub(super) triangulator: Triangulator,
}

/// What a property of a row is for.
enum Column<'a> {
    Indices(&'a Property),
    Uvs(&'a Property),
    Other(&'a Property),
}

impl<'a> Column<'a> {
    fn of(property: &'a Property) -> Self {
        match property {
            property if is_indices(property) => Self::Indices(property),
            property if is_uvs(property) => Self::Uvs(property),
            property => Self::Other(property),
        }
    }
}

/// One row: the corners of a face and their texture coordinates, one number after the other.
#[derive(Default)]
struct Face {
    corners: Vec<u32>,
    uvs: Vec<f32>,
}

impl<'a> Faces<'a> {
    pub(super) fn new(name: &'a str, mesh: Mesh) -> Self {
        let triangulator = Triangulator::default();
        Self { name, mesh, corner_uvs: Vec::new(), triangulator }
    }

    /// Reads the polygons of `element`.
    pub(super) fn read_polygons<V: Values>(
        &mut self,
        values: &mut V,
        element: &Element,
    ) -> Result<()> {
        self.check_indices(element)?;
        let with_uvs = self.mesh.uvs.is_empty() && element.properties.iter().any(is_uvs);
        let columns: Vec<Column> = element.properties.iter().map(Column::of).collect();
        let (mut face, mut points) = (Face::default(), Vec::new());
        for number in 0..element.count {
            self.read_row(values, &columns, &mut face).map_err(|cause| {
                values.complain(self.name, format!("face {number} of {}: {cause}", element.count))
            })?;
            values.end_row(self.name);
            points.clear();
            points.extend(face.corners.iter().filter_map(|&i| self.mesh.positions.get(i as usize)));
            let place = || part_of(self.name, format!("face {number}"));
            let triangles = self.triangulator.split(&points, place);
            for &triangle in triangles {
                self.mesh.triangles.push(triangle.map(|corner| face.corner(corner)));
                if with_uvs {
                    self.corner_uvs.push(triangle.map(|corner| face.uv(corner)));
                }
            }
        }
        Ok(())
    }

    fn check_indices(&self, element: &Element) -> Result<()> {
        if element.properties.iter().any(is_indices) {
            return Ok(());
        }
        let cause = format!("no list \"vertex_indices\" in the rows of \"{}\"", element.name);
        Err(Box::new(Diagnostic::new(self.name, cause).at_line(element.line)))
    }

    fn read_row<V: Values>(
        &self,
        values: &mut V,
        columns: &[Column<'_>],
        face: &mut Face,
    ) -> Parsed<()> {
        face.corners.clear();
        face.uvs.clear();
        for column in columns {
            match column {
                Column::Indices(property) => {
                    for _ in 0..values.length(property)? {
                        let index = values.next(property.value)?;
                        face.corners.push(self.vertex(index)?);
                        check_corners(face.corners.len())?;
                    }
                }
                Column::Uvs(property) => {
                    for _ in 0..values.length(property)? {
                        face.uvs.push(values.next(property.value)? as f32);
                    }
                }
                Column::Other(property) => values.skip(property)?,
            }
        }
        Ok(())
    }

    /// The number of a vertex, checked.
    #[inline]
    fn vertex(&self, index: f64) -> Parsed<u32> {
        let (count, number) = (self.mesh.positions.len(), index as u32);
        if f64::from(number) == index && (number as usize) < count {
            return Ok(number);
        }
        Err(match count.checked_sub(1) {
            Some(last) => format!("vertex {index} does not exist, only vertices 0 to {last}"),
            None => format!("vertex {index} does not exist: there are no vertices"),
        })
    }

    /// Reads the triangle strips of `element`, each ended by a negative number.
    ///
    /// Their triangles without area are no mistake: they join strips.
    pub(super) fn read_strips<V: Values>(
        &mut self,
        values: &mut V,
        element: &Element,
    ) -> Result<()> {
        self.check_indices(element)?;
        for number in 0..element.count {
            for property in &element.properties {
                let read = if is_indices(property) {
                    self.read_strip(values, property)
                } else {
                    values.skip(property)
                };
                read.map_err(|cause| {
                    values.complain(self.name, format!("triangle strip {number}: {cause}"))
                })?;
            }
            values.end_row(self.name);
        }
        Ok(())
    }

    fn read_strip<V: Values>(&mut self, values: &mut V, property: &Property) -> Parsed<()> {
        let (mut before, mut odd) = ([None, None], false);
        let length = values.length(property)?;
        self.mesh.triangles.reserve(length);
        for _ in 0..length {
            let index = values.next(property.value)?;
            if index < 0.0 {
                (before, odd) = ([None, None], false);
                continue;
            }
            let c = self.vertex(index)?;
            if let [Some(a), Some(b)] = before {
                self.add_triangle(if odd { [b, a, c] } else { [a, b, c] });
                odd = !odd;
            }
            before = [before[1], Some(c)];
        }
        Ok(())
    }

    fn add_triangle(&mut self, triangle: [u32; 3]) {
        let corner = |i: u32| self.mesh.positions.get(i as usize).copied().unwrap_or_default();
        if has_area(triangle.map(corner)) {
            self.mesh.triangles.push(triangle);
        }
    }

    /// The mesh, with a vertex for every pair of position and texture coordinates that faces use.
    pub(super) fn finish(mut self) -> Result<Mesh> {
        let mesh = self.mesh;
        if self.corner_uvs.is_empty() {
            return Ok(mesh);
        }
        self.corner_uvs.resize(mesh.triangles.len(), [Vec2::ZERO; 3]);
        let mut used = Distinct::default();
        let mut triangles = Vec::with_capacity(mesh.triangles.len());
        for (triangle, uvs) in mesh.triangles.iter().zip(&self.corner_uvs) {
            let mut corners = [0; 3];
            for ((corner, &vertex), uv) in corners.iter_mut().zip(triangle).zip(uvs) {
                let key = (vertex, uv.to_array().map(f32::to_bits));
                *corner = vertex_number(used.insert_full(key).0, self.name)?;
            }
            triangles.push(corners);
        }
        let picked: Vec<u32> = used.iter().map(|(vertex, _)| *vertex).collect();
        let uvs = used.iter().map(|(_, uv)| Vec2::from(uv.map(f32::from_bits))).collect();
        Ok(Mesh { triangles, uvs: vec![uvs], ..pick_vertices(&mesh, &picked) })
    }
}

impl Face {
    fn corner(&self, corner: usize) -> u32 {
        self.corners.get(corner).copied().unwrap_or_default()
    }

    /// Texture coordinates of a corner; 0 if they are missing or not finite.
    fn uv(&self, corner: usize) -> Vec2 {
        let uv = self.uvs.as_chunks().0.get(corner).copied().map(Vec2::from_array);
        uv.filter(|uv| uv.is_finite()).unwrap_or_default()
    }
}

fn is_indices(property: &Property) -> bool {
    property.length.is_some() && matches!(property.name.as_str(), "vertex_indices" | "vertex_index")
}

fn is_uvs(property: &Property) -> bool {
    property.length.is_some() && property.name == "texcoord"
}
