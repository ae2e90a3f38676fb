//! A camera that shows everything.

use super::description::{CameraDescription, Projection, SceneDescription, Shape, Surface};
use crate::bvh::Part;
use crate::geometry::Bounds;
use glam::{DVec2, DVec3};
use std::ops::Range;

/// Vertical field of view of framing cameras, rad.
const FIELD_OF_VIEW: f64 = 30.0 * std::f64::consts::PI / 180.0;
/// Part of the picture's width and height that is filled.
const FILLED: f64 = 0.86;

/// A perspective camera in the direction `toward_camera` from the scene, at just the distance from which every
/// surface that has an end is in the picture. Distances are exact for meshes and boxes for everything else.
pub fn frame(scene: &SceneDescription, toward_camera: DVec3, up: DVec3) -> CameraDescription {
    let back = toward_camera.normalize_or(DVec3::Y);
    let right = up.cross(back).try_normalize().unwrap_or_else(|| crate::math::tangents(back).0);
    let above = back.cross(right);
    let aspect = f64::from(scene.film.width) / f64::from(scene.film.height);
    let tan = DVec2::new(aspect, 1.0) * (0.5 * FIELD_OF_VIEW).tan() * FILLED;
    let mut extent = Extent::default();
    each_point(scene, |p| extent.add(DVec2::new(p.dot(right), p.dot(above)), p.dot(back), tan));
    let (center, distance) = extent.view(tan);
    let position = center.x * right + center.y * above + distance * back;
    CameraDescription {
        name: "frame".into(),
        position,
        target: position - back * (distance - extent.middle()).max(1e-3),
        up,
        projection: Projection::Perspective { vertical_fov: FIELD_OF_VIEW },
        shutter: CameraDescription::OPEN,
        motion: None,
    }
}

/// The planes of the tightest view pyramid around points: extremes of `across ± depth · tan` per picture axis.
struct Extent {
    lower: DVec2,
    upper: DVec2,
    near: f64,
    far: f64,
}

impl Default for Extent {
    fn default() -> Self {
        Self {
            lower: DVec2::INFINITY,
            upper: DVec2::NEG_INFINITY,
            near: f64::NEG_INFINITY,
            far: f64::INFINITY,
        }
    }
}

impl Extent {
    fn add(&mut self, across: DVec2, depth: f64, tan: DVec2) {
        self.lower = self.lower.min(across - depth * tan);
        self.upper = self.upper.max(across + depth * tan);
        self.near = self.near.max(depth);
        self.far = self.far.min(depth);
    }

    /// Where the axis of the pyramid is, and how far along `back` its tip; the unit view of nothing at all.
    fn view(&self, tan: DVec2) -> (DVec2, f64) {
        if self.near < self.far {
            return (DVec2::ZERO, 5.0);
        }
        let distance = ((self.upper - self.lower) / (2.0 * tan)).max_element();
        let smallest = self.near + 1e-3 * (self.near - self.far).max(1e-3);
        (0.5 * (self.lower + self.upper), distance.max(smallest))
    }

    fn middle(&self) -> f64 {
        if self.near < self.far { 0.0 } else { 0.5 * (self.near + self.far) }
    }
}

/// The smallest and largest coordinates (m) of every surface that has an end; `None` if there is none. Exact for
/// meshes, boxes for everything else.
pub fn bounds(scene: &SceneDescription) -> Option<[DVec3; 2]> {
    let (mut lower, mut upper) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    each_point(scene, |p| (lower, upper) = (lower.min(p), upper.max(p)));
    lower.cmple(upper).all().then_some([lower, upper])
}

/// The middle of the box around some surfaces, at time 0, m; of what has no end, where its own space has its origin.
pub(crate) fn middle(scene: &SceneDescription, surfaces: Range<usize>) -> DVec3 {
    let (mut lower, mut upper) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for surface in &scene.surfaces[surfaces.clone()] {
        each_point_at_rest(scene, surface, &mut |p| {
            (lower, upper) = (lower.min(p), upper.max(p));
        });
    }
    let first = || scene.surfaces[surfaces].first().map(|surface| surface.transform.translation);
    if lower.cmple(upper).all() { 0.5 * (lower + upper) } else { first().unwrap_or_default() }
}

/// The smallest coordinate along the unit vector `up` of every surface that has an end; 0 if there is none.
pub(super) fn lowest(scene: &SceneDescription, up: DVec3) -> f64 {
    let mut lowest = f64::INFINITY;
    each_point(scene, |p| lowest = lowest.min(p.dot(up)));
    if lowest.is_finite() { lowest } else { 0.0 }
}

/// The largest extent along an axis of every surface that has an end, m.
pub(super) fn size(scene: &SceneDescription) -> f64 {
    let (mut lo, mut hi) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    each_point(scene, |p| (lo, hi) = (lo.min(p), hi.max(p)));
    (hi - lo).max_element().max(0.0)
}

/// Calls `visit` with points whose convex hull holds every surface that has an end, wherever it comes to.
fn each_point(scene: &SceneDescription, mut visit: impl FnMut(DVec3)) {
    for surface in &scene.surfaces {
        if surface.motion.is_none() {
            each_point_at_rest(scene, surface, &mut visit);
            continue;
        }
        let mut bounds = Bounds::EMPTY;
        each_point_at_rest(scene, surface, &mut |p| {
            bounds = bounds.union(Bounds::around([p.as_vec3()]));
        });
        if !bounds.is_empty() {
            bounds.moving(surface.motion.as_ref()).corners().for_each(&mut visit);
        }
    }
}

/// Calls `visit` with points whose convex hull holds a surface at time 0, if it has an end.
fn each_point_at_rest(scene: &SceneDescription, surface: &Surface, visit: &mut impl FnMut(DVec3)) {
    if let Shape::Mesh(mesh) = surface.shape {
        let mesh = &scene.meshes[mesh];
        let used = mesh.triangles.iter().flatten().map(|&i| mesh.positions[i as usize]);
        used.for_each(|p| visit(surface.transform.transform_point3(p.as_dvec3())));
    } else if let Part::Analytic(shape, _) = super::build::part(scene, surface, &|_| false) {
        shape.bounds().into_iter().flat_map(Bounds::corners).for_each(visit);
    }
}
