//! `[surfaces.name]`: shapes with a material and a transform.

use super::color::Color;
use super::document::{At, Document, Span};
use super::light::SurfaceLightKeys;
use super::motion::MotionKeys;
use super::transform::Step;
use crate::diagnostic::Result;
use crate::scene::description::{Block, Cone, Cylinder, Disk, Mesh, Plane, Quad, Shape, Sphere};
use crate::units::written::{Direction, Pair, Point};
use glam::{DVec3, Vec3};
use schemars::JsonSchema;
use serde::Deserialize;

/// A surface: exactly one shape.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub(super) struct SurfaceKeys {
    sphere: Option<At<Sphere>>,
    plane: Option<At<Plane>>,
    disk: Option<At<Disk>>,
    quad: Option<At<Quad>>,
    #[serde(rename = "box")]
    block: Option<At<Block>>,
    cylinder: Option<At<Cylinder>>,
    cone: Option<At<Cone>>,
    mesh: Option<At<MeshKeys>>,
    /// Name of its material. Default: a grey that reflects 0.5; black if it is a light.
    pub(super) material: Option<At<String>>,
    /// What it emits. Default: what its material says.
    pub(super) light: Option<At<SurfaceLightKeys>>,
    /// Steps from its own space to the world, the first applied first.
    pub(super) transform: Option<At<Vec<Step>>>,
    /// What it does after that while the scene's time runs. Default: nothing.
    pub(super) motion: Option<At<MotionKeys>>,
}

/// Triangles written out.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct MeshKeys {
    /// Positions, m.
    vertices: At<Vec<Point>>,
    /// Three vertices each, from 0, anticlockwise seen from the front.
    triangles: At<Vec<At<Vec<u32>>>>,
    /// One direction for each vertex, for smooth shading. Default: flat.
    normals: Option<At<Vec<Direction>>>,
    /// Texture coordinates [u, v] for each vertex.
    uvs: Option<At<Vec<Pair>>>,
    /// A colour for each vertex; it multiplies the material's reflectance.
    colors: Option<At<Vec<Color>>>,
}

/// A shape on its way into a scene: meshes still want a place in the list of meshes.
pub(super) enum NewShape {
    Ready(Shape),
    Mesh(Mesh),
}

impl SurfaceKeys {
    /// The one shape that is given, checked.
    pub(super) fn shape(
        &self,
        name: &str,
        surface: &Span,
        document: &Document<'_>,
    ) -> Result<NewShape> {
        let given = [
            self.sphere.as_ref().map(|at| (&at.span, Ok(Shape::Sphere(at.value.clone())))),
            self.plane.as_ref().map(|at| (&at.span, Ok(Shape::Plane(at.value.clone())))),
            self.disk.as_ref().map(|at| (&at.span, Ok(Shape::Disk(at.value.clone())))),
            self.quad.as_ref().map(|at| (&at.span, quad(&at.value))),
            self.block.as_ref().map(|at| (&at.span, block(&at.value))),
            self.cylinder.as_ref().map(|at| (&at.span, cylinder(&at.value))),
            self.cone.as_ref().map(|at| (&at.span, cone(&at.value))),
        ];
        let mut given = given.into_iter().flatten();
        match (given.next(), given.next(), &self.mesh) {
            (Some((span, shape)), None, None) => {
                let shape = shape.map_err(|predicate| document.error(span, predicate))?;
                Ok(NewShape::Ready(shape))
            }
            (None, _, Some(mesh)) => mesh.value.describe(name, document).map(NewShape::Mesh),
            (None, _, None) => {
                let known = "sphere, plane, disk, quad, box, cylinder, cone or mesh";
                Err(document.error(surface, format!("needs a shape: {known}")))
            }
            (Some(_), Some((second, _)), _) => Err(document.error(second, ONE_SHAPE)),
            (Some(_), None, Some(second)) => Err(document.error(&second.span, ONE_SHAPE)),
        }
    }
}

const ONE_SHAPE: &str = "is one too many: a surface has one shape";

fn quad(quad: &Quad) -> std::result::Result<Shape, &'static str> {
    let side = |edge: DVec3| edge.try_normalize();
    let spans = match (side(quad.edge_u), side(quad.edge_v)) {
        (Some(u), Some(v)) => u.cross(v).length() > 1e-12,
        _ => false,
    };
    spans.then(|| Shape::Quad(quad.clone())).ok_or("needs two edges in different directions")
}

fn block(block: &Block) -> std::result::Result<Shape, &'static str> {
    let solid = block.min.cmplt(block.max).all();
    solid.then(|| Shape::Block(block.clone())).ok_or("needs a min below its max on each axis")
}

fn cylinder(cylinder: &Cylinder) -> std::result::Result<Shape, &'static str> {
    let tall = (cylinder.top - cylinder.base).try_normalize().is_some();
    tall.then(|| Shape::Cylinder(cylinder.clone())).ok_or("needs a top away from its base")
}

fn cone(cone: &Cone) -> std::result::Result<Shape, &'static str> {
    let tall = (cone.apex - cone.base).try_normalize().is_some();
    tall.then(|| Shape::Cone(cone.clone())).ok_or("needs an apex away from its base")
}

impl MeshKeys {
    fn describe(&self, name: &str, document: &Document<'_>) -> Result<Mesh> {
        let vertices = &self.vertices.value;
        let same_length = |span: &Span, length: usize| {
            let message =
                format!("needs one entry for each of {} vertices, not {length}", vertices.len());
            if length == vertices.len() { Ok(()) } else { Err(document.error(span, message)) }
        };
        let mut mesh = Mesh { name: name.into(), ..Mesh::default() };
        mesh.positions = vertices.iter().map(|Point(point)| point.as_vec3()).collect();
        mesh.triangles = self.triangles(document)?;
        if let Some(At { span, value }) = &self.normals {
            same_length(span, value.len())?;
            mesh.normals = value.iter().map(|Direction(normal)| normal.as_vec3()).collect();
        }
        if let Some(At { span, value }) = &self.uvs {
            same_length(span, value.len())?;
            mesh.uvs = vec![value.iter().map(|Pair(uv)| uv.as_vec2()).collect()];
        }
        if let Some(At { span, value }) = &self.colors {
            same_length(span, value.len())?;
            mesh.colors = value.iter().map(|&color| color.into()).collect();
            if mesh.colors.as_flattened().iter().any(|channel| *channel > 1.0) {
                return Err(document.error(span, "needs colors of 0 to 1"));
            }
        }
        if !mesh.uvs.iter().flatten().all(|uv| uv.is_finite()) {
            return Err(document.error(&self.vertices.span, "has texture coordinates out of range"));
        }
        debug_assert!(mesh.positions.iter().all(|p: &Vec3| p.is_finite()));
        Ok(mesh)
    }

    fn triangles(&self, document: &Document<'_>) -> Result<Vec<[u32; 3]>> {
        if self.triangles.value.is_empty() {
            return Err(document.error(&self.triangles.span, "needs at least one triangle"));
        }
        let count = self.vertices.value.len();
        let corner_in_range = |corner: &u32| (*corner as usize) < count;
        let corners = |triangle: &At<Vec<u32>>| {
            let corners: [u32; 3] = triangle.value.as_slice().try_into().map_err(|_| {
                let found = triangle.value.len();
                document.error(&triangle.span, format!("needs three vertices, not {found}"))
            })?;
            match corners.iter().find(|corner| !corner_in_range(corner)) {
                None => Ok(corners),
                Some(wrong) => {
                    let message = format!(
                        "names vertex {wrong}, but the last of {count} is {}",
                        count.saturating_sub(1)
                    );
                    Err(document.error(&triangle.span, message))
                }
            }
        };
        self.triangles.value.iter().map(corners).collect()
    }
}
