//! One light out of many, picked by how much it may give to a point.
//!
//! Conty Estevez & Kulla, *Importance Sampling of Many Lights with Adaptive Tree Splitting*, 2018: a tree over boxes, cones
//! and intensities; at each node, chance goes to the child that may give more, in proportion. Eight children a node, so that
//! few steps lead to a light and the processor looks at eight at a time. Where a child can give nothing at all, chance never
//! goes, and all other lights can be reached from any point: nothing is left out.

mod bounds;
mod build;
mod node;
mod reach;
#[cfg(test)]
mod tests;

pub(crate) use bounds::{EmissionCone, LightBounds};
pub(crate) use reach::Reach;

use crate::geometry::Ray;
use crate::simd::{Kernel, Level, Simd};
use glam::Vec3;
use node::{CHILDREN, Child, Node};

/// A tree over lights.
#[derive(Debug, Clone)]
pub(crate) struct LightTree {
    /// The root comes first.
    nodes: Vec<Node>,
    /// For each light, where it stands.
    place_of: Vec<Place>,
    /// The instructions that nodes are looked at with.
    level: Level,
}

/// A child of a node.
#[derive(Debug, Clone, Copy, Default)]
struct Place {
    node: u32,
    child: u32,
}

impl LightTree {
    /// A light, by its number, that may give something to a surface at `point` with the unit normal `normal`, and the
    /// probability of having been picked by `u` in 0..1; `None` if none does.
    pub(crate) fn pick(&self, point: Vec3, normal: Vec3, u: f64) -> Option<(u32, f32)> {
        self.level.run(Pick { tree: self, receiver: At { point, normal }, u })
    }

    /// The same for all that is between the start of a ray and its end.
    pub(crate) fn pick_along(&self, ray: &Ray, u: f64) -> Option<(u32, f32)> {
        self.level.run(Pick { tree: self, receiver: Along(ray), u })
    }

    /// Where the light with this number is and where it shines to.
    pub(crate) fn reach(&self, light: u32) -> Reach {
        let Place { node, child } = self.place_of[light as usize];
        self.nodes[node as usize].reach(child as usize)
    }

    /// Probability with which [`LightTree::pick`] picks the light with this number.
    pub(crate) fn probability(&self, point: Vec3, normal: Vec3, light: u32) -> f32 {
        self.level.run(Probability { tree: self, point, normal, light })
    }
}

/// What lights may give something to.
trait Receiver {
    /// How much the lights of each child may give to it.
    fn importances<S: Simd>(&self, simd: S, node: &Node) -> [f32; CHILDREN];
}

/// See [`LightTree::pick`].
struct At {
    point: Vec3,
    normal: Vec3,
}

impl Receiver for At {
    #[inline(always)]
    fn importances<S: Simd>(&self, simd: S, node: &Node) -> [f32; CHILDREN] {
        node.importances(simd, self.point, self.normal)
    }
}

/// See [`LightTree::pick_along`].
struct Along<'a>(&'a Ray);

impl Receiver for Along<'_> {
    #[inline(always)]
    fn importances<S: Simd>(&self, simd: S, node: &Node) -> [f32; CHILDREN] {
        node.importances_along(simd, self.0)
    }
}

/// From the root down to a light.
struct Pick<'a, R> {
    tree: &'a LightTree,
    receiver: R,
    u: f64,
}

impl<R: Receiver> Kernel for Pick<'_, R> {
    type Output = Option<(u32, f32)>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let Self { tree, receiver, mut u } = self;
        let (mut node, mut probability) = (tree.nodes.first()?, 1.0);
        loop {
            let importances = receiver.importances(simd, node);
            let sum: f32 = importances.iter().sum();
            let child = pick_in_proportion(&importances, sum, &mut u)?;
            probability *= importances[child] / sum;
            match node.children[child] {
                Child::Light(light) => return Some((light, probability)),
                Child::Node(place) => node = &tree.nodes[place as usize],
            }
        }
    }
}

/// From a light up to the root.
struct Probability<'a> {
    tree: &'a LightTree,
    point: Vec3,
    normal: Vec3,
    light: u32,
}

impl Kernel for Probability<'_> {
    type Output = f32;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> f32 {
        let Self { tree, point, normal, light } = self;
        let (mut place, mut probability) = (Some(tree.place_of[light as usize]), 1.0);
        while let Some(Place { node, child }) = place {
            let node = &tree.nodes[node as usize];
            let importances = node.importances(simd, point, normal);
            let importance = importances[child as usize];
            if importance == 0.0 {
                return 0.0;
            }
            probability *= importance / importances.iter().sum::<f32>();
            place = node.parent;
        }
        probability
    }
}

/// The child that `u` in 0..1 falls on, which becomes the place within; `None` if all are 0.
#[inline(always)]
fn pick_in_proportion(importances: &[f32; CHILDREN], sum: f32, u: &mut f64) -> Option<usize> {
    let (target, mut before, mut picked) = (*u * f64::from(sum), 0.0, None);
    for (child, importance) in importances.iter().enumerate() {
        let share = f64::from(*importance);
        if share > 0.0 {
            *u = ((target - before) / share).clamp(0.0, 1.0 - f64::EPSILON);
            picked = Some(child);
        }
        before += share;
        if target < before {
            break;
        }
    }
    picked
}
