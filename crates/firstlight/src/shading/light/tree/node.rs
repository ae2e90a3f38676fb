//! Eight children of the tree, and how much each may give to a point.

use super::{LightBounds, Place, Reach};
use crate::geometry::Ray;
use crate::simd::{LANES, Lanes, Simd};
use glam::Vec3;
use std::f32::consts::FRAC_2_PI;

/// Children of a node.
pub(super) const CHILDREN: usize = LANES;

/// All lights below a place of the tree, child by child.
#[derive(Debug, Clone)]
pub(super) struct Node {
    pub children: [Child; CHILDREN],
    /// Where the node itself stands; the root nowhere.
    pub parent: Option<Place>,
    /// Middle of the box, m.
    center: [[f32; CHILDREN]; 3],
    /// Square of half its diagonal, m².
    radius2: [f32; CHILDREN],
    /// W·sr⁻¹; 0 where there is no child.
    intensity: [f32; CHILDREN],
    axis: [[f32; CHILDREN]; 3],
    /// Of the angle around the axis that holds all axes.
    cos_spread: [f32; CHILDREN],
    sin_spread: [f32; CHILDREN],
    /// Cosine from which on it is dark.
    cos_falloff: [f32; CHILDREN],
    /// 1, or −1 where the back is dark.
    behind: [f32; CHILDREN],
}

/// What stands at a place of the tree.
#[derive(Debug, Clone, Copy)]
pub(super) enum Child {
    /// A node, by its place.
    Node(u32),
    /// One light, by its number.
    Light(u32),
}

/// What rounding hides would be lost for good: cosines are taken for this much larger, half a degree or more.
const SLACK: f32 = 0.01;
/// The largest importance, so that eight can be added.
const MOST: f32 = 1e37;

impl Node {
    /// Over at most eight children.
    pub(super) fn new(lights: &[LightBounds], parent: Option<Place>) -> Self {
        let empty = [0.0; CHILDREN];
        let mut node = Self {
            children: [Child::Light(0); CHILDREN],
            parent,
            center: [empty; 3],
            radius2: empty,
            intensity: empty,
            axis: [empty; 3],
            cos_spread: empty,
            sin_spread: empty,
            cos_falloff: empty,
            behind: empty,
        };
        lights.iter().enumerate().for_each(|(child, lights)| node.set(child, lights));
        node
    }

    fn set(&mut self, child: usize, lights: &LightBounds) {
        let half = 0.5 * (lights.bounds.hi - lights.bounds.lo);
        let (center, cone) = (lights.bounds.lo + half, lights.cone);
        for axis in 0..3 {
            self.center[axis][child] = center[axis];
            self.axis[axis][child] = cone.axis[axis];
        }
        self.radius2[child] = half.length_squared();
        self.intensity[child] = lights.intensity;
        (self.sin_spread[child], self.cos_spread[child]) = cone.spread.sin_cos();
        self.cos_falloff[child] = cone.falloff.cos();
        self.behind[child] = if cone.two_sided { 1.0 } else { -1.0 };
    }

    /// How much the lights of each child may give to a surface at `point` that faces `normal`, or to a medium if that is 0, at most: their intensity over
    /// the square of the distance, with the largest cosines that are possible. 0 only where they give nothing.
    #[inline(always)]
    pub(super) fn importances<S: Simd>(
        &self,
        simd: S,
        point: Vec3,
        normal: Vec3,
    ) -> [f32; CHILDREN] {
        let (zero, one, slack) = (simd.splat(0.0), simd.splat(1.0), simd.splat(SLACK));
        let to_lights = difference(load(simd, &self.center), splat(simd, point));
        let (distance2, radius2) = (dot(to_lights, to_lights), simd.load(&self.radius2));
        let to_unit = one / distance2.sqrt();
        // The ball around them, as seen from the point.
        let sin2 = radius2 / distance2;
        let ball = Angle { cos: (one - sin2).max(zero).sqrt(), sin: sin2.sqrt() };
        // Where there is no surface, light may come from anywhere.
        let floating = simd.splat(f32::from(u8::from(normal == Vec3::ZERO)));
        let cos = dot(splat(simd, normal), to_lights) * to_unit + floating;
        let at_surface = Angle::of_cos(simd, cos).less(simd, ball);
        let along = dot(load(simd, &self.axis), to_lights) * to_unit;
        let cos = (zero - along).max(simd.load(&self.behind) * along);
        let spread = Angle { cos: simd.load(&self.cos_spread), sin: simd.load(&self.sin_spread) };
        let off_axis = Angle::of_cos(simd, cos).less(simd, spread);
        let at_light = Angle::of_cos(simd, off_axis).less(simd, ball);
        let dark_from = simd.load(&self.cos_falloff) - slack;
        let lit = (zero - slack).lt(at_surface) & dark_from.lt(at_light);
        let seen = at_light.max(slack) * at_surface.max(slack) / distance2;
        // Inside the ball, every cosine is possible.
        let inside = distance2.le(radius2);
        let intensity = simd.load(&self.intensity);
        let share = (one / radius2).select(inside, seen);
        let most = (intensity * share).max(simd.splat(f32::MIN_POSITIVE)).min(simd.splat(MOST));
        most.select((inside | lit) & zero.lt(intensity), zero).to_array()
    }

    /// The same for all that is along a ray, wherever the lights shine to: about ∫ dt/r² = θ/D, with θ the angle under which the ray
    /// is seen from the middle and D the distance from there.
    #[inline(always)]
    pub(super) fn importances_along<S: Simd>(&self, simd: S, ray: &Ray) -> [f32; CHILDREN] {
        let (zero, one) = (simd.splat(0.0), simd.splat(1.0));
        let direction = splat(simd, ray.direction);
        let to_lights = difference(load(simd, &self.center), splat(simd, ray.origin));
        let nearest = dot(to_lights, direction).max(zero).min(simd.splat(ray.t_max));
        let apart = difference(to_lights, direction.map(|d| d * nearest));
        let distance2 = dot(apart, apart) + simd.load(&self.radius2);
        let distance = distance2.max(simd.splat(f32::MIN_POSITIVE)).sqrt();
        // atan x is about 1 / (1 / x + 2 / π).
        let angle = one / (distance / simd.splat(ray.t_max) + simd.splat(FRAC_2_PI));
        let intensity = simd.load(&self.intensity);
        let most = (intensity * angle / distance).max(simd.splat(f32::MIN_POSITIVE));
        most.min(simd.splat(MOST)).select(zero.lt(intensity), zero).to_array()
    }

    /// Where the lights of a child are and where they shine to.
    pub(super) fn reach(&self, child: usize) -> Reach {
        let place = |of: &[[f32; CHILDREN]; 3]| Vec3::from_array(of.map(|axis| axis[child]));
        let spread = self.sin_spread[child].atan2(self.cos_spread[child]);
        let dark_from = spread.abs() + self.cos_falloff[child].acos();
        let two_sided = self.behind[child] > 0.0;
        Reach::new(
            place(&self.center),
            self.radius2[child],
            (place(&self.axis), dark_from),
            two_sided,
        )
    }
}

/// An angle by its cosine and sine, 0..π, of each child.
#[derive(Clone, Copy)]
struct Angle<F> {
    cos: F,
    sin: F,
}

impl<F> Angle<F> {
    #[inline(always)]
    fn of_cos<S: Simd<F = F>>(simd: S, cos: F) -> Self
    where
        F: Lanes<Mask = S::M, D = S::D>,
    {
        let sin2 = simd.splat(1.0) - cos * cos;
        Self { cos, sin: sin2.max(simd.splat(0.0)).sqrt() }
    }

    /// Cosine of this angle less `other`, or of 0 if that is larger.
    #[inline(always)]
    fn less<S: Simd<F = F>>(self, simd: S, other: Self) -> F
    where
        F: Lanes<Mask = S::M, D = S::D>,
    {
        let cos = self.cos * other.cos + self.sin * other.sin;
        simd.splat(1.0).select(other.cos.lt(self.cos), cos)
    }
}

#[inline(always)]
fn splat<S: Simd>(simd: S, v: Vec3) -> [S::F; 3] {
    [simd.splat(v.x), simd.splat(v.y), simd.splat(v.z)]
}

#[inline(always)]
fn load<S: Simd>(simd: S, [x, y, z]: &[[f32; CHILDREN]; 3]) -> [S::F; 3] {
    [simd.load(x), simd.load(y), simd.load(z)]
}

#[inline(always)]
fn difference<F: Lanes>(a: [F; 3], b: [F; 3]) -> [F; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
fn dot<F: Lanes>(a: [F; 3], b: [F; 3]) -> F {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
