//! Surfaces with a formula: each is a unit shape under an affine map, intersected in double precision.
//!
//! Double precision answers what single precision gets wrong at grazing angles, far away and on huge radii
//! (Haines, Günther, Akenine-Möller, *Precision Improvements for Ray/Sphere Intersection*, Ray Tracing Gems
//! ch. 7): the textbook discriminant keeps its digits. What is made of squares is traced as triangles instead, which are
//! met many rays at a time.

use super::{Bounds, DOUBLE_ERROR, Ray};
use crate::math::tangents;
use crate::scene::description::{Block, Cone, Cylinder, Disk, Mesh, Plane, Quad, Sphere};
use glam::{DAffine3, DMat3, DVec2, DVec3, Vec3};
use std::f64::consts::TAU;

/// A unit shape and where it is.
#[derive(Debug, Clone)]
pub(crate) struct Analytic {
    kind: Kind,
    to_world: DAffine3,
    to_object: DAffine3,
    /// The third row of `to_object`, which alone decides where a flat shape is crossed, and the unit normal.
    height: DVec3,
    height_at_origin: f64,
    flat_normal: DVec3,
    error: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    /// x² + y² + z² = 1.
    Sphere,
    /// z = 0.
    Plane,
    /// z = 0, x² + y² ≤ 1.
    Disk,
    /// z = 0, x and y in 0..1.
    Quad,
    /// x, y, z in 0..1. Parts 0..6: faces −x, +x, −y, +y, −z, +z.
    Cube,
    /// x² + y² = 1, z in 0..1. Parts: 0 side, 1 bottom, 2 top.
    Cylinder { capped: bool },
    /// x² + y² = (1 − z)², z in 0..1. Parts: 0 side, 1 bottom.
    Cone { capped: bool },
}

/// Unit shapes that the surfaces of analytic shapes are made of, up to an affine map.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Piece {
    /// x² + y² + z² = 1.
    Sphere,
    /// z = 0, x² + y² ≤ 1, its front up.
    Disk,
    /// z = 0, x and y in 0..1, its front up.
    Square,
    /// x² + y² = 1, z in 0..1, its front out.
    CylinderSide,
}

/// Up to three crossings of a line with a shape, nearest first: (distance, part).
type Crossings = [Option<(f64, u32)>; 3];

/// A point of an analytic surface in world space.
#[derive(Debug, Clone, Copy)]
pub(crate) struct AnalyticPoint {
    /// Where, m; on the surface to double precision.
    pub position: DVec3,
    /// Outward unit normal.
    pub normal: DVec3,
    /// Texture coordinates.
    pub uv: DVec2,
}

impl Analytic {
    fn new(kind: Kind, shape_to_object: DAffine3, transform: &DAffine3) -> Self {
        let to_world = *transform * shape_to_object;
        let to_object = to_world.inverse();
        let height = to_object.matrix3.row(2);
        let m = to_world.matrix3;
        let stretch = (m.x_axis.abs() + m.y_axis.abs() + m.z_axis.abs()).max_element();
        let magnitude = to_world.translation.abs().max_element() + stretch;
        let analytic = Self {
            kind,
            to_world,
            to_object,
            height,
            height_at_origin: to_object.translation.z,
            flat_normal: height.normalize(),
            error: DOUBLE_ERROR * magnitude,
        };
        Self { error: analytic.error + analytic.unevenness(), ..analytic }
    }

    /// A sphere under `transform`.
    pub(crate) fn sphere(s: &Sphere, transform: &DAffine3) -> Self {
        let scale = DMat3::from_diagonal(DVec3::splat(s.radius));
        Self::new(Kind::Sphere, DAffine3::from_mat3_translation(scale, s.center), transform)
    }

    /// A plane under `transform`.
    pub(crate) fn plane(p: &Plane, transform: &DAffine3) -> Self {
        Self::new(Kind::Plane, frame(p.point, p.normal, 1.0, 1.0), transform)
    }

    /// A disk under `transform`.
    pub(crate) fn disk(d: &Disk, transform: &DAffine3) -> Self {
        Self::new(Kind::Disk, frame(d.center, d.normal, d.radius, 1.0), transform)
    }

    /// A parallelogram under `transform`.
    pub(crate) fn quad(q: &Quad, transform: &DAffine3) -> Self {
        let normal = q.edge_u.cross(q.edge_v).normalize();
        let axes = DMat3::from_cols(q.edge_u, q.edge_v, normal);
        Self::new(Kind::Quad, DAffine3::from_mat3_translation(axes, q.corner), transform)
    }

    /// A box under `transform`.
    pub(crate) fn block(b: &Block, transform: &DAffine3) -> Self {
        let scale = DMat3::from_diagonal(b.max - b.min);
        Self::new(Kind::Cube, DAffine3::from_mat3_translation(scale, b.min), transform)
    }

    /// A cylinder under `transform`.
    pub(crate) fn cylinder(c: &Cylinder, transform: &DAffine3) -> Self {
        let axis = c.top - c.base;
        let placed = frame(c.base, axis, c.radius, axis.length());
        Self::new(Kind::Cylinder { capped: c.capped }, placed, transform)
    }

    /// A cone under `transform`.
    pub(crate) fn cone(c: &Cone, transform: &DAffine3) -> Self {
        let axis = c.apex - c.base;
        let placed = frame(c.base, axis, c.radius, axis.length());
        Self::new(Kind::Cone { capped: c.capped }, placed, transform)
    }

    /// A box around the surface in world space; `None` if it has no end.
    pub(crate) fn bounds(&self) -> Option<Bounds> {
        let (lo, hi) = match self.kind {
            Kind::Plane => return None,
            Kind::Sphere => return Some(self.sphere_bounds()),
            Kind::Disk => (DVec3::new(-1.0, -1.0, 0.0), DVec3::new(1.0, 1.0, 0.0)),
            Kind::Quad => (DVec3::ZERO, DVec3::new(1.0, 1.0, 0.0)),
            Kind::Cube => (DVec3::ZERO, DVec3::ONE),
            Kind::Cylinder { .. } | Kind::Cone { .. } => (DVec3::new(-1.0, -1.0, 0.0), DVec3::ONE),
        };
        Some(Bounds::of_mapped(lo, hi, &self.to_world))
    }

    /// The tight box of an ellipsoid: half the extent along an axis is the length of the map's row.
    fn sphere_bounds(&self) -> Bounds {
        let rows = self.to_world.matrix3.transpose();
        let extent = DVec3::new(rows.x_axis.length(), rows.y_axis.length(), rows.z_axis.length());
        let at_center = DAffine3::from_translation(self.to_world.translation);
        Bounds::of_mapped(-extent, extent, &at_center)
    }

    /// The parts of its surface by their numbers, each with the map from its unit shape to the world; `None` for what
    /// is no such shape: planes without end and the sides of cones.
    pub(crate) fn pieces(&self) -> Vec<Option<(Piece, DAffine3)>> {
        let bottom = DAffine3::from_scale(DVec3::new(1.0, 1.0, -1.0));
        let bottom = |capped: bool| capped.then_some((Piece::Disk, bottom));
        let top = (Piece::Disk, DAffine3::from_translation(DVec3::Z));
        let whole = |piece| vec![Some((piece, DAffine3::IDENTITY))];
        let mut pieces = match self.kind {
            Kind::Plane => vec![None],
            Kind::Sphere => whole(Piece::Sphere),
            Kind::Disk => whole(Piece::Disk),
            Kind::Quad => whole(Piece::Square),
            Kind::Cube => (0..6).map(|face| Some((Piece::Square, cube_face(face)))).collect(),
            Kind::Cylinder { capped: false } => whole(Piece::CylinderSide),
            Kind::Cylinder { capped: true } => {
                vec![Some((Piece::CylinderSide, DAffine3::IDENTITY)), bottom(true), Some(top)]
            }
            Kind::Cone { capped } => vec![None, bottom(capped)],
        };
        pieces.iter_mut().flatten().for_each(|(_, map)| *map = self.to_world * *map);
        pieces
    }

    /// Crossings of the ray's line inside the ray's range, nearest first, as (distance, part); none for what is traced
    /// as triangles.
    pub(crate) fn crossings(&self, ray: &Ray) -> impl Iterator<Item = (f64, u32)> + use<> {
        // At infinity there is no surface: parallels of a plane do not meet it there.
        let (t_min, t_max) = (f64::from(ray.t_min), f64::from(ray.t_max.min(f32::MAX)));
        let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let crossings = if matches!(self.kind, Kind::Plane | Kind::Disk) {
            let t = -(self.height.dot(origin) + self.height_at_origin) / self.height.dot(direction);
            let within = t > t_min && t <= t_max && self.covers(origin + t * direction);
            [within.then_some((t, 0)), None, None]
        } else {
            let origin = self.to_object.transform_point3(origin);
            self.kind.crossings(origin, self.to_object.transform_vector3(direction))
        };
        crossings.into_iter().flatten().filter(move |&(t, _)| t > t_min && t <= t_max)
    }

    /// Whether a point of a disk's or plane's plane belongs to it.
    fn covers(&self, point: DVec3) -> bool {
        let from_center = || self.to_object.transform_point3(point).truncate();
        self.kind == Kind::Plane || from_center().length_squared() <= 1.0
    }

    /// The point of `part` nearest to where the ray is at `t`, put back onto the surface.
    #[inline(always)]
    pub(crate) fn point(&self, ray: &Ray, t: f64, part: u32) -> AnalyticPoint {
        let along = ray.origin.as_dvec3() + t * ray.direction.as_dvec3();
        let (local, normal, uv) = self.kind.point(self.to_object.transform_point3(along), part);
        let normal = if self.kind.is_flat() {
            self.flat_normal
        } else {
            (self.to_object.matrix3.transpose() * normal).normalize()
        };
        AnalyticPoint { position: self.to_world.transform_point3(local), normal, uv }
    }

    /// The directions in which u and v grow at a point on the surface, of any length.
    pub(crate) fn growing(&self, position: DVec3, part: u32) -> [Vec3; 2] {
        let axes = self.kind.growing(self.to_object.transform_point3(position), part);
        axes.map(|axis| self.to_world.transform_vector3(axis).normalize_or_zero().as_vec3())
    }

    /// How the texture coordinates grow at a point near one of its parts, in the world, m⁻¹.
    pub(crate) fn gradients(&self, position: DVec3, part: u32) -> [Vec3; 2] {
        let uv = |p: DVec3| self.kind.point(self.to_object.transform_point3(p), part).2;
        let step = 1e-6 * self.to_world.matrix3.x_axis.length();
        let growth = |axis: DVec3| {
            let growth = uv(position + step * axis) - uv(position - step * axis);
            // Around the axis, 1 is followed by 0.
            DVec2::new(if growth.x.abs() > 0.5 { 0.0 } else { growth.x }, growth.y) / (2.0 * step)
        };
        let [x, y, z] = DVec3::AXES.map(growth);
        [DVec3::new(x.x, y.x, z.x), DVec3::new(x.y, y.y, z.y)].map(|g| g.as_vec3())
    }

    /// The same, moved once more.
    pub(crate) fn moved(&self, by: &DAffine3) -> Self {
        Self::new(self.kind, self.to_world, by)
    }

    /// The squares that it is made of as a mesh in the world; empty if it is made of others.
    pub(crate) fn mesh(&self) -> Mesh {
        let mut mesh = Mesh { uvs: vec![Vec::new()], ..Mesh::default() };
        for number in 0..self.triangle_count() {
            for corner in self.triangle(number) {
                let local = self.to_object.transform_point3(corner.as_dvec3());
                mesh.positions.push(corner);
                mesh.uvs[0].push(self.kind.point(local, number / 2).2.as_vec2());
            }
            mesh.triangles.push([0, 1, 2].map(|corner| 3 * number + corner));
        }
        mesh
    }

    /// How many triangles it can be traced as: two for each square it is made of, none if it is made of others.
    pub(crate) fn triangle_count(&self) -> u32 {
        match self.kind {
            Kind::Quad => 2,
            Kind::Cube => 12,
            _ => 0,
        }
    }

    /// The corners of one of its triangles, rounded, with the front outward. It belongs to part `number / 2`.
    pub(crate) fn triangle(&self, number: u32) -> [Vec3; 3] {
        let corners = self.square(number / 2).map(DVec3::as_vec3);
        let mirrored = (self.to_world * self.face(number / 2)).matrix3.determinant() < 0.0;
        let [a, b, c] = if number.is_multiple_of(2) { [0, 1, 2] } else { [0, 2, 3] };
        if mirrored { [a, c, b] } else { [a, b, c] }.map(|i: usize| corners[i])
    }

    /// How far its triangles may lie off the surface itself, m.
    fn unevenness(&self) -> f64 {
        let squares = (0..self.triangle_count() / 2).map(|part| self.square(part));
        let off = |[a, b, _, d]: [DVec3; 4]| {
            let normal = (b - a).cross(d - a).normalize_or_zero();
            let corners = [a, b, b + (d - a), d].into_iter();
            let off = corners.map(|p| normal.dot(p.as_vec3().as_dvec3() - p).abs());
            off.fold(0.0, f64::max)
        };
        squares.map(off).fold(0.0, f64::max)
    }

    /// From the unit square to one of the squares it is made of, in its own space.
    fn face(&self, part: u32) -> DAffine3 {
        if self.kind == Kind::Cube { cube_face(part as usize) } else { DAffine3::IDENTITY }
    }

    /// The corners of one of the squares it is made of, around it.
    fn square(&self, part: u32) -> [DVec3; 4] {
        let face = self.face(part);
        let corners = [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y];
        corners.map(|p| self.to_world.transform_point3(face.transform_point3(p)))
    }

    /// How far its positions in double precision may be from where rays meet it, m.
    pub(crate) fn error(&self) -> f64 {
        self.error
    }
}

/// From a unit shape around +z to one at `origin` whose z axis is `axis`, scaled across and along it.
fn frame(origin: DVec3, axis: DVec3, across: f64, along: f64) -> DAffine3 {
    let normal = axis.normalize();
    let (tangent, bitangent) = tangents(normal);
    let axes = DMat3::from_cols(tangent * across, bitangent * across, normal * along);
    DAffine3::from_mat3_translation(axes, origin)
}

impl Kind {
    /// Whether it lies in z = 0.
    fn is_flat(self) -> bool {
        matches!(self, Self::Plane | Self::Disk | Self::Quad)
    }

    /// Crossings of a line with a round shape.
    fn crossings(self, o: DVec3, d: DVec3) -> Crossings {
        match self {
            Self::Sphere => both(quadratic(d.length_squared(), o.dot(d), sphere_c(o, d)), |_| true),
            Self::Plane | Self::Disk | Self::Quad | Self::Cube => [None; 3],
            Self::Cylinder { capped: true } => capped_cylinder(o, d),
            Self::Cylinder { capped: false } => {
                both(cylinder_side(o, d), |t| (0.0..=1.0).contains(&(o.z + t * d.z)))
            }
            Self::Cone { capped } => cone(o, d, capped),
        }
    }

    /// Where u and v grow at a point of `part`, perhaps out of the surface.
    fn growing(self, p: DVec3, part: u32) -> [DVec3; 2] {
        let axis = |number: u32| DMat3::IDENTITY.col(number as usize % 3);
        let around = DVec3::new(-p.y, p.x, 0.0);
        match (self, part) {
            (Self::Plane | Self::Quad, _) => [DVec3::X, DVec3::Y],
            (Self::Cube, face) => [axis(face / 2 + 1), axis(face / 2 + 2)],
            (Self::Sphere | Self::Cylinder { .. } | Self::Cone { .. }, 0) => [around, DVec3::Z],
            _ => [around, p.with_z(0.0)],
        }
    }

    /// A point near `part` → the point on it, its outward normal (any length), (u, v).
    #[inline(always)]
    fn point(self, p: DVec3, part: u32) -> (DVec3, DVec3, DVec2) {
        let around = || p.y.atan2(p.x).rem_euclid(TAU) / TAU;
        match (self, part) {
            (Self::Sphere, _) => {
                let n = p.normalize();
                (n, n, DVec2::new(around(), 0.5 + n.z.clamp(-1.0, 1.0).asin() * (2.0 / TAU)))
            }
            (Self::Plane | Self::Quad, _) => (p.with_z(0.0), DVec3::Z, p.truncate()),
            (Self::Disk, _) => {
                (p.with_z(0.0), DVec3::Z, DVec2::new(around(), p.truncate().length()))
            }
            (Self::Cube, face) => cube_point(p, face),
            (Self::Cylinder { .. }, 0) => {
                let side = p.truncate().normalize();
                (side.extend(p.z), side.extend(0.0), DVec2::new(around(), p.z))
            }
            (Self::Cone { .. }, 0) => {
                let side = p.truncate().try_normalize().unwrap_or(DVec2::X);
                ((side * (1.0 - p.z)).extend(p.z), side.extend(1.0), DVec2::new(around(), p.z))
            }
            (_, cap) => {
                let (z, normal) = if cap == 1 { (0.0, -DVec3::Z) } else { (1.0, DVec3::Z) };
                (p.with_z(z), normal, DVec2::new(around(), p.truncate().length()))
            }
        }
    }
}

/// Roots of a·t² + 2·b·t + c, nearest first, without cancellation.
///
/// `discriminant` is b² − a·c, given by the caller who may know a better way to compute it.
fn roots(a: f64, b: f64, c: f64, discriminant: f64) -> Option<[f64; 2]> {
    if !(discriminant >= 0.0 && a != 0.0) {
        return None;
    }
    let q = -(b + discriminant.sqrt().copysign(b));
    let (first, second) = (q / a, if q == 0.0 { 0.0 } else { c / q });
    Some([first.min(second), first.max(second)])
}

/// Roots of the line `o + t·d` with a quadric; see [`roots`]. `c` is (constant term, discriminant).
fn quadratic(a: f64, b: f64, (c, discriminant): (f64, f64)) -> Option<[f64; 2]> {
    roots(a, b, c, discriminant)
}

/// Constant term and discriminant of the unit sphere: d²(1 − distance² of the line from the centre).
fn sphere_c(o: DVec3, d: DVec3) -> (f64, f64) {
    let d2 = d.length_squared();
    let nearest = o - d * (o.dot(d) / d2);
    (o.length_squared() - 1.0, d2 * (1.0 - nearest.length_squared()))
}

fn both(roots: Option<[f64; 2]>, inside: impl Fn(f64) -> bool) -> Crossings {
    let Some([near, far]) = roots else { return [None; 3] };
    let keep = |t: f64| inside(t).then_some((t, 0));
    [keep(near), keep(far), None]
}

fn cube_point(p: DVec3, face: u32) -> (DVec3, DVec3, DVec2) {
    let axis = (face / 2) as usize % 3;
    let side = f64::from(face % 2);
    let (mut point, mut normal) = (p.clamp(DVec3::ZERO, DVec3::ONE), DVec3::ZERO);
    point[axis] = side;
    normal[axis] = 2.0 * side - 1.0;
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    (point, normal, DVec2::new(point[u], point[v]))
}

/// From the unit square to a face of the unit cube, +z outward.
fn cube_face(face: usize) -> DAffine3 {
    let (axis, side) = (face / 2, (face % 2) as f64);
    let unit = |axis: usize| DMat3::IDENTITY.col(axis % 3);
    let axes = DMat3::from_cols(unit(axis + 1), unit(axis + 2), (2.0 * side - 1.0) * unit(axis));
    DAffine3::from_mat3_translation(axes, side * unit(axis))
}

fn cylinder_side(o: DVec3, d: DVec3) -> Option<[f64; 2]> {
    let (o, d) = (o.truncate(), d.truncate());
    let (a, cross) = (d.length_squared(), o.perp_dot(d));
    roots(a, o.dot(d), o.length_squared() - 1.0, a - cross * cross)
}

/// The solid cylinder is where the line is inside both the round side and the slab between the caps, so no
/// ray slips through the rim.
fn capped_cylinder(o: DVec3, d: DVec3) -> Crossings {
    let side = match cylinder_side(o, d) {
        Some([near, far]) => Interval { near: (near, 0), far: (far, 0) },
        None if d.truncate() == DVec2::ZERO && o.truncate().length_squared() <= 1.0 => {
            Interval::EVERYTHING
        }
        None => return [None; 3],
    };
    side.clip_slab(o.z, d.z, 1).ends()
}

fn cone(o: DVec3, d: DVec3, capped: bool) -> Crossings {
    let h = 1.0 - o.z;
    let a = d.truncate().length_squared() - d.z * d.z;
    let b = o.truncate().dot(d.truncate()) + h * d.z;
    let c = o.truncate().length_squared() - h * h;
    let on_side = |t: &f64| (0.0..=1.0).contains(&(o.z + t * d.z));
    let linear = || (a == 0.0 && b != 0.0).then(|| [-c / (2.0 * b), f64::NAN]);
    let side = roots(a, b, c, b * b - a * c).or_else(linear).unwrap_or([f64::NAN; 2]);
    let at_base = -o.z / d.z;
    let on_base = (o + at_base * d).truncate().length_squared() <= 1.0;
    let mut found = [(capped && on_base).then_some((at_base, 1)), None, None];
    for (slot, t) in found[1..].iter_mut().zip(side) {
        *slot = Some(t).filter(on_side).map(|t| (t, 0));
    }
    found.sort_by(|a, b| order(*a).total_cmp(&order(*b)));
    found
}

fn order(crossing: Option<(f64, u32)>) -> f64 {
    crossing.map_or(f64::INFINITY, |(t, _)| t)
}

/// The part of a line inside a convex solid, with the parts of the surface at both ends.
#[derive(Clone, Copy)]
struct Interval {
    near: (f64, u32),
    far: (f64, u32),
}

impl Interval {
    const EVERYTHING: Self = Self { near: (f64::NEG_INFINITY, 0), far: (f64::INFINITY, 0) };

    /// Keeps what lies between 0 and 1 along one axis; the surface at 0 is `part`, at 1 `part + 1`.
    fn clip_slab(self, o: f64, d: f64, part: u32) -> Self {
        if d == 0.0 {
            let nowhere = Self { near: (f64::INFINITY, part), far: (f64::NEG_INFINITY, part) };
            return if (0.0..=1.0).contains(&o) { self } else { nowhere };
        }
        let (at_0, at_1) = ((-o / d, part), ((1.0 - o) / d, part + 1));
        let (near, far) = if d > 0.0 { (at_0, at_1) } else { (at_1, at_0) };
        Self {
            near: if near.0 > self.near.0 { near } else { self.near },
            far: if far.0 < self.far.0 { far } else { self.far },
        }
    }

    fn ends(self) -> Crossings {
        if self.near.0 <= self.far.0 { [Some(self.near), Some(self.far), None] } else { [None; 3] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn sphere(center: DVec3, radius: f64) -> Analytic {
        Analytic::sphere(&Sphere { center, radius }, &DAffine3::IDENTITY)
    }

    fn nearest(shape: &Analytic, ray: &Ray) -> f64 {
        shape.crossings(ray).next().expect("the ray hits").0
    }

    /// Reference case G01: expected values from 50-digit arithmetic.
    #[test]
    fn far_and_huge_spheres_keep_their_digits() {
        let unit = sphere(DVec3::ZERO, 1.0);
        let close = |t: f64, expected: f64| assert!((t / expected - 1.0).abs() < 1e-6, "{t}");
        let far = Ray::new(Vec3::new(0.0, 0.5, -1e6), Vec3::Z);
        close(nearest(&unit, &far), 999_999.133_974_596);
        assert!((nearest(&unit, &far) - 999_999.133_974_596).abs() < 1e-6);
        let edge = Ray::new(Vec3::new(0.0, 0.999, -1e5), Vec3::Z);
        assert!((nearest(&unit, &edge) - 99_999.955_289_822_2).abs() < 1e-6);
        let earth = sphere(DVec3::new(0.0, -6_371_000.0, 0.0), 6_371_000.0);
        let eye = Vec3::new(0.0, 1.8, 0.0);
        close(nearest(&earth, &Ray::new(eye, Vec3::new(1.0, -0.001, 0.0))), 2_169.329_885_772_4);
    }

    /// The blunder that G01 warns of: in single precision the textbook formula is off by 0.866 m.
    #[test]
    fn the_textbook_formula_in_single_precision_fails_the_same_case() {
        let (b, c) = (-1e6_f32, 1e12_f32 + 0.25 - 1.0);
        let t = -b - (b * b - c).max(0.0).sqrt();
        assert!((f64::from(t) - 999_999.133_974_596).abs() > 0.8);
    }

    fn every_shape(transform: &DAffine3) -> Vec<Analytic> {
        let (base, tip) = (DVec3::new(0.1, -0.2, 0.3), DVec3::new(0.4, 0.5, 1.7));
        let round = |capped| Cylinder { base, top: tip, radius: 0.7, capped };
        let pointed = |capped| Cone { base, apex: tip, radius: 0.7, capped };
        vec![
            Analytic::sphere(&Sphere { center: base, radius: 1.3 }, transform),
            Analytic::plane(&Plane { point: base, normal: tip }, transform),
            Analytic::disk(&Disk { center: base, normal: tip, radius: 1.4 }, transform),
            Analytic::quad(&Quad { corner: base, edge_u: DVec3::X, edge_v: tip }, transform),
            Analytic::block(&Block { min: base - DVec3::ONE, max: tip }, transform),
            Analytic::cylinder(&round(true), transform),
            Analytic::cylinder(&round(false), transform),
            Analytic::cone(&pointed(true), transform),
            Analytic::cone(&pointed(false), transform),
        ]
    }

    fn skewed() -> DAffine3 {
        let columns =
            [DVec3::new(1.2, 0.1, -0.3), DVec3::new(0.4, -0.8, 0.2), DVec3::new(0.1, 0.3, 2.1)];
        let matrix = DMat3::from_cols(columns[0], columns[1], columns[2]);
        DAffine3::from_mat3_translation(matrix, DVec3::new(3.0, -1.0, 0.5))
    }

    fn random_ray(i: u64) -> Ray {
        let r = |k: u64| (crate::math::hash(i * 6 + k) >> 40) as f32 / 8_388_608.0 - 1.0;
        let origin = Vec3::new(3.0 + 4.0 * r(0), 4.0 * r(1), 4.0 * r(2));
        Ray::new(origin, Vec3::new(r(3), r(4), r(5)).normalize())
    }

    #[test]
    fn crossings_are_ordered_on_the_surface_and_inside_its_bounds() {
        for transform in [DAffine3::IDENTITY, skewed()] {
            for shape in every_shape(&transform).iter().filter(|s| s.triangle_count() == 0) {
                let mut count = 0;
                for ray in (0..40_000).map(random_ray) {
                    let crossings: Vec<_> = shape.crossings(&ray).collect();
                    assert!(crossings.is_sorted_by(|a, b| a.0 <= b.0), "{:?}", shape.kind);
                    for (t, part) in crossings {
                        count += 1;
                        let point = shape.point(&ray, t, part);
                        let along = ray.origin.as_dvec3() + t * ray.direction.as_dvec3();
                        assert!((point.position - along).length() < 1e-9, "{:?}", shape.kind);
                        let inside = |b: Bounds| {
                            let p = point.position.as_vec3();
                            p.cmpge(b.lo).all() && p.cmple(b.hi).all()
                        };
                        assert!(shape.bounds().is_none_or(inside), "{:?}", shape.kind);
                    }
                }
                assert!(count > 100, "{:?} was hit {count} times", shape.kind);
            }
        }
    }

    /// A point of a piece is a point of the part that it stands for, with the normal on the same side.
    #[test]
    fn pieces_cover_the_parts() {
        for transform in
            [DAffine3::IDENTITY, skewed(), skewed() * DAffine3::from_scale(-DVec3::ONE)]
        {
            for shape in every_shape(&transform) {
                for (part, piece) in shape.pieces().into_iter().enumerate() {
                    let Some((piece, map)) = piece else { continue };
                    let (at, up) = match piece {
                        Piece::Sphere | Piece::CylinderSide => (DVec3::Y, DVec3::Y),
                        Piece::Disk | Piece::Square => (DVec3::new(0.1, 0.7, 0.0), DVec3::Z),
                    };
                    let (at, outward) =
                        (map.transform_point3(at), map.matrix3.inverse().transpose() * up);
                    let ray =
                        Ray::new((at + 1e-3 * outward).as_vec3(), -outward.normalize().as_vec3());
                    let t = if shape.triangle_count() == 0 {
                        let (t, met) = shape.crossings(&ray).next().expect("the piece is there");
                        assert_eq!(met as usize, part, "{:?}", shape.kind);
                        t
                    } else {
                        1e-3 * outward.length()
                    };
                    let point = shape.point(&ray, t, part as u32);
                    assert!(point.position.distance(at) < 1e-5, "{:?} {part}", shape.kind);
                    assert!(
                        point.normal.dot(outward.normalize()) > 0.999_999,
                        "{:?} {part}",
                        shape.kind
                    );
                }
            }
        }
    }

    #[test]
    fn triangles_lie_on_their_squares_and_face_outward() {
        let maps = [DAffine3::IDENTITY, skewed(), skewed() * DAffine3::from_scale(-DVec3::ONE)];
        for shape in maps.iter().flat_map(every_shape) {
            let mut area = [DVec3::ZERO; 6];
            for number in 0..shape.triangle_count() {
                let [a, b, c] = shape.triangle(number).map(|p| p.as_dvec3());
                let (middle, normal) = ((a + b + c) / 3.0, (b - a).cross(c - a));
                let ray = Ray::new(middle.as_vec3(), Vec3::Z);
                let point = shape.point(&ray, 0.0, number / 2);
                assert!(point.position.distance(middle) < 1e-6, "{:?} {number}", shape.kind);
                let along = point.normal.dot(normal.normalize());
                assert!(along > 1.0 - 1e-9, "{:?} {number}", shape.kind);
                area[number as usize / 2] += 0.5 * normal;
            }
            let squares = shape.pieces().into_iter().flatten().map(|(_, map)| map.matrix3);
            for (area, m) in area.iter().zip(squares).filter(|_| shape.triangle_count() > 0) {
                let whole = m.x_axis.cross(m.y_axis).length();
                assert!((area.length() - whole).abs() < 1e-6 * whole, "{:?}", shape.kind);
            }
        }
    }

    /// Parallels have no point in common, however large the quotient is: the sign of a zero decides about neither.
    #[test]
    fn parallels_of_a_plane_never_meet_it() {
        let plane = Plane { point: DVec3::ZERO, normal: DVec3::Z };
        let plane = Analytic::plane(&plane, &DAffine3::IDENTITY);
        for direction in [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y] {
            for z in [0.0, -0.0, 1e-40, -1e-40] {
                let ray = Ray::new(Vec3::Z, direction.with_z(z));
                assert_eq!(plane.crossings(&ray).next(), None, "{direction} {z}");
            }
        }
        assert!(nearest(&plane, &Ray::new(Vec3::Z, Vec3::new(1.0, 0.0, -1e-30))) > 9e29);
    }

    /// Closed shapes are entered as often as they are left, and their normals point out.
    #[test]
    fn closed_shapes_are_closed_and_their_normals_point_out() {
        for transform in [DAffine3::IDENTITY, skewed()] {
            let shapes = every_shape(&transform);
            for index in [0, 5, 7] {
                for ray in (0..20_000).map(random_ray) {
                    let mut ray = ray;
                    ray.origin -= 100.0 * ray.direction;
                    let crossings: Vec<_> = shapes[index].crossings(&ray).collect();
                    assert!(crossings.len() % 2 == 0, "{:?}", shapes[index].kind);
                    for (i, &(t, part)) in crossings.iter().enumerate() {
                        let cos =
                            shapes[index].point(&ray, t, part).normal.dot(ray.direction.as_dvec3());
                        let entering = i % 2 == 0;
                        assert!(if entering { cos <= 1e-6 } else { cos >= -1e-6 });
                    }
                }
            }
        }
    }
}
