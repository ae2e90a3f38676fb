//! Everything that can be hit: one tree over the world, one per mesh that stands in it more than once.

use super::BuildQuality;
use super::reference::{Item, Reference, Triangles};
use super::runs::{Run, Runs};
use super::wide;
use crate::geometry::{Analytic, Bounds, DOUBLE_ERROR, Hit, Ray};
use crate::kernels::{Answer, HitFilter, Others, Search, Stack, Tree, forget, search};
use crate::scene::description::{Mesh, Motion};
use crate::simd::{Kernel, Level, Simd};
use glam::{DAffine3, Vec3};
use rayon::prelude::*;
use std::borrow::Cow;
use std::collections::HashMap;
use std::slice::from_mut;
use std::sync::Arc;

/// A mesh standing in the world.
#[derive(Debug, Clone)]
pub(crate) struct MeshPart {
    /// The triangles, in the mesh's own space.
    pub mesh: Arc<Mesh>,
    /// From the mesh's space to the world.
    pub to_world: DAffine3,
    /// Its inverse.
    pub to_object: DAffine3,
    /// Whether the winding of its triangles in the tree is the reverse of the file's.
    pub mirrored: bool,
    /// Whether rays are brought into the mesh's space (`true`) or its triangles into the world.
    pub instanced: bool,
    /// Flags of its triangles, see `kernels::layout`.
    pub flags: u32,
    /// Whether the tree has the positions as they are in the mesh.
    stays: bool,
    /// The largest absolute coordinate of the mesh in its own space.
    reach: f64,
    error: f64,
}

impl MeshPart {
    /// A mesh under `to_world`, with flags of `kernels::layout` on its triangles.
    pub(crate) fn new(mesh: Arc<Mesh>, to_world: DAffine3, instanced: bool, flags: u32) -> Self {
        let stays = instanced || to_world == DAffine3::IDENTITY;
        let mirrored = !instanced && to_world.matrix3.determinant() < 0.0;
        let reach = f64::from(Bounds::around(mesh.positions.iter().copied()).reach());
        Self {
            mesh,
            to_world,
            to_object: to_world.inverse(),
            mirrored,
            instanced,
            flags,
            stays,
            reach,
            error: error(&to_world, reach),
        }
    }

    /// The same, moved once more; it must be instanced.
    fn moved(&self, by: &DAffine3) -> Self {
        let to_world = *by * self.to_world;
        let error = error(&to_world, self.reach);
        Self {
            mesh: Arc::clone(&self.mesh),
            to_world,
            to_object: to_world.inverse(),
            error,
            ..*self
        }
    }

    /// How far its positions may be off for having been computed in double precision, m.
    pub(crate) fn error(&self) -> f64 {
        self.error
    }

    /// A corner as the tree of this part has it: in the mesh's space if instanced, else in the world.
    #[inline(always)]
    pub(crate) fn corner(&self, index: u32) -> Vec3 {
        let p = self.mesh.positions[index as usize];
        if self.stays { p } else { self.to_world.transform_point3(p.as_dvec3()).as_vec3() }
    }

    /// The corners of a triangle, as [`MeshPart::corner`].
    #[inline(always)]
    pub(crate) fn corners(&self, triangle: u32) -> [Vec3; 3] {
        let [a, b, c] = self.mesh.triangles[triangle as usize];
        [self.corner(a), self.corner(b), self.corner(c)]
    }
}

/// How far positions may be off that `to_world` was applied to, m; they were at most `reach` from the origin.
fn error(to_world: &DAffine3, reach: f64) -> f64 {
    let m = to_world.matrix3;
    let stretch = (m.x_axis.abs() + m.y_axis.abs() + m.z_axis.abs()).max_element();
    DOUBLE_ERROR * (to_world.translation.abs().max_element() + stretch * reach)
}

/// The shape of one surface of the world.
#[derive(Debug, Clone)]
pub(crate) enum Part {
    /// Triangles.
    Mesh(MeshPart),
    /// A formula, and the flags of its material.
    Analytic(Analytic, u32),
}

impl Part {
    /// The same as something that can move: what is traced as triangles becomes a mesh with a tree of its own.
    pub(crate) fn on_its_own(self) -> Self {
        match self {
            Self::Analytic(shape, flags) if shape.triangle_count() > 0 => {
                let mesh = Arc::new(shape.mesh());
                Self::Mesh(MeshPart::new(mesh, DAffine3::IDENTITY, true, flags))
            }
            other => other,
        }
    }

    fn moved(&self, by: &DAffine3) -> Self {
        match self {
            Self::Mesh(part) => Self::Mesh(part.moved(by)),
            Self::Analytic(shape, flags) => Self::Analytic(shape.moved(by), *flags),
        }
    }
}

/// All surfaces and their trees.
#[derive(Debug)]
pub(crate) struct World {
    parts: Vec<Part>,
    top: Tree,
    /// Whose triangles are in `top`.
    runs: Runs,
    /// Trees of instanced meshes.
    trees: Vec<Tree>,
    /// For each part, its tree in `trees`.
    tree_of: Vec<Option<usize>>,
    /// Parts without end, which no tree can hold.
    endless: Vec<u32>,
    /// For each part, how it moves; empty if none does.
    motions: Vec<Option<Motion>>,
    level: Level,
}

impl World {
    /// Builds the trees over `parts`, which move as `motions` say, one for each; surfaces are numbered in this order.
    /// What moves is [on its own](Part::on_its_own).
    pub(crate) fn build(
        parts: Vec<Part>,
        mut motions: Vec<Option<Motion>>,
        level: Level,
        quality: BuildQuality,
    ) -> Self {
        let (trees, tree_of) = instanced_trees(&parts, quality);
        let mut builder = TopBuilder::default();
        for (surface, (part, motion)) in parts.iter().zip(&motions).enumerate() {
            let tree = tree_of[surface].map(|i: usize| &trees[i]);
            builder.add(surface as u32, part, tree, motion.as_ref());
        }
        if motions.iter().all(Option::is_none) {
            motions.clear();
        }
        let runs = Runs::new(builder.runs, builder.triangles);
        let triangles = OwnTriangles { parts: &parts, runs: &runs };
        let top = wide::tree(builder.references, &triangles, quality);
        Self { parts, top, runs, trees, tree_of, endless: builder.endless, motions, level }
    }

    /// All surfaces, where they are at time 0.
    pub(crate) fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// A surface where it is at a time, 0..1.
    pub(crate) fn part(&self, surface: u32, time: f32) -> Cow<'_, Part> {
        let part = &self.parts[surface as usize];
        match self.moved(surface, time) {
            Some(moved) => Cow::Owned(part.moved(&moved)),
            None => Cow::Borrowed(part),
        }
    }

    /// How a surface moves; `None`: it stands still.
    #[inline(always)]
    pub(crate) fn motion(&self, surface: u32) -> Option<&Motion> {
        self.motions.get(surface as usize)?.as_ref()
    }

    /// Where a surface has moved to at a time, 0..1; `None`: it stands still.
    #[inline(always)]
    pub(crate) fn moved(&self, surface: u32, time: f32) -> Option<DAffine3> {
        self.motion(surface).map(|motion| motion.at(time.into()))
    }

    /// Whether anything moves.
    pub(crate) fn moves(&self) -> bool {
        !self.motions.is_empty()
    }

    /// Bytes the trees take.
    pub(crate) fn memory(&self) -> usize {
        self.top.memory() + self.trees.iter().map(Tree::memory).sum::<usize>()
    }

    /// The instructions that rays are traced with.
    pub(crate) fn level(&self) -> Level {
        self.level
    }

    /// The same world, traced with other instructions.
    #[cfg(test)]
    pub(crate) fn at_level(self, level: Level) -> Self {
        Self { level, ..self }
    }

    /// What each ray hits first, in its range.
    pub(crate) fn closest_hits(&self, rays: &[Ray], filter: &dyn HitFilter, hits: &mut Vec<Hit>) {
        hits.resize(rays.len(), Hit::none(0.0));
        self.search(rays, filter, hits);
    }

    /// Whether each ray hits anything in its range.
    pub(crate) fn occluded(&self, rays: &[Ray], filter: &dyn HitFilter, occluded: &mut Vec<bool>) {
        occluded.resize(rays.len(), false);
        self.search(rays, filter, occluded);
    }

    fn search<A: Answer<ANY>, const ANY: bool>(
        &self,
        rays: &[Ray],
        filter: &dyn HitFilter,
        answers: &mut [A],
    ) {
        let filter = Named { runs: &self.runs, filter };
        let known = !self.endless.is_empty();
        if known {
            forget(rays, answers);
        }
        for &surface in &self.endless {
            for (ray, answer) in rays.iter().zip(&mut *answers) {
                let mut hit = answer.hit(ray.t_max);
                self.cross(ray, surface, &filter, &mut hit);
                *answer = A::of(&hit);
            }
        }
        search(self.level, &self.top, self, &filter, (rays, answers, known));
    }

    /// Meets an analytic surface. Returns whether `hit` was replaced.
    fn cross(&self, ray: &Ray, surface: u32, filter: &dyn HitFilter, hit: &mut Hit) -> bool {
        match (&self.parts[surface as usize], self.motion(surface)) {
            (Part::Mesh(_), _) => false,
            (part, None) => self.cross_part(ray, surface, part, filter, hit),
            _ => {
                let part = self.part(surface, ray.time);
                self.cross_part(ray, surface, &part, filter, hit)
            }
        }
    }

    #[inline(always)]
    fn cross_part(
        &self,
        ray: &Ray,
        surface: u32,
        part: &Part,
        filter: &dyn HitFilter,
        hit: &mut Hit,
    ) -> bool {
        let Part::Analytic(shape, flags) = part else { return false };
        for (t, primitive) in shape.crossings(ray) {
            let candidate = Hit { t: t as f32, u: 0.0, v: 0.0, surface, primitive };
            let in_range = candidate.t > ray.t_min && candidate.t <= ray.t_max;
            if !in_range || (hit.is_some() && !candidate.is_before(hit)) {
                continue;
            }
            let behind =
                || shape.point(ray, t, primitive).normal.dot(ray.direction.as_dvec3()) > 0.0;
            if flags & filter.flags() == 0 || filter.accepts(ray, &candidate, behind()) {
                *hit = candidate;
                return true;
            }
        }
        false
    }
}

/// Tells a filter which surface a triangle of the world's own tree belongs to.
struct Named<'a> {
    runs: &'a Runs,
    filter: &'a dyn HitFilter,
}

impl HitFilter for Named<'_> {
    fn flags(&self) -> u32 {
        self.filter.flags()
    }

    fn accepts(&self, ray: &Ray, hit: &Hit, from_behind: bool) -> bool {
        let mut named = *hit;
        self.runs.name(from_mut(&mut named));
        self.filter.accepts(ray, &named, from_behind)
    }
}

impl Others for World {
    fn visit<const ANY: bool>(
        &self,
        search: &Search<()>,
        surface: u32,
        hit: &mut Hit,
        stack: &mut Stack,
    ) -> bool {
        match (&self.parts[surface as usize], self.tree_of[surface as usize]) {
            (Part::Mesh(part), Some(tree)) => {
                let ray = match self.motion(surface) {
                    None => into_object(search.ray, &part.to_object),
                    Some(motion) => into_moving(search.ray, motion, &part.to_object),
                };
                let (tree, ray) = (&self.trees[tree], &ray);
                let inside = Inside::<ANY> { search, tree, ray, surface, hit, stack };
                self.level.of_eight().run(inside)
            }
            _ => self.cross(search.ray, surface, search.filter, hit),
        }
    }

    #[inline(always)]
    fn name(&self, hits: &mut [Hit]) {
        self.runs.name(hits);
    }
}

/// A ray, brought into the space of an instance, looks through its tree.
struct Inside<'a, const ANY: bool> {
    search: &'a Search<'a, ()>,
    tree: &'a Tree,
    ray: &'a Ray,
    surface: u32,
    hit: &'a mut Hit,
    stack: &'a mut Stack,
}

impl<const ANY: bool> Kernel for Inside<'_, ANY> {
    type Output = bool;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> bool {
        let Self { search, tree, ray, surface, hit, stack } = self;
        search.with(simd).walk::<_, ANY>(tree, ray, surface, &NoOthers, hit, stack)
    }
}

/// A tree of nothing but triangles.
struct NoOthers;

impl Others for NoOthers {
    #[inline(always)]
    fn visit<const ANY: bool>(&self, _: &Search<()>, _: u32, _: &mut Hit, _: &mut Stack) -> bool {
        false
    }

    /// Whose tree it is knows.
    fn name(&self, _: &mut [Hit]) {}
}

/// The ray in an instance's space: rounded once from double precision, distances as in the world.
fn into_object(ray: &Ray, to_object: &DAffine3) -> Ray {
    Ray {
        origin: to_object.transform_point3(ray.origin.as_dvec3()).as_vec3(),
        direction: to_object.transform_vector3(ray.direction.as_dvec3()).as_vec3(),
        ..*ray
    }
}

/// The same if the instance moves.
#[inline(never)]
fn into_moving(ray: &Ray, motion: &Motion, to_object: &DAffine3) -> Ray {
    into_object(ray, &(*to_object * motion.at(ray.time.into()).inverse()))
}

/// One tree per instanced mesh, and which part uses which.
fn instanced_trees(parts: &[Part], quality: BuildQuality) -> (Vec<Tree>, Vec<Option<usize>>) {
    let (mut users, mut known) = (Vec::new(), HashMap::new());
    let mut tree_of = |part: &MeshPart| {
        *known.entry((Arc::as_ptr(&part.mesh), part.flags)).or_insert_with(|| {
            users.push(part.clone());
            users.len() - 1
        })
    };
    let instanced = |part: &Part| match part {
        Part::Mesh(part) if part.instanced => Some(tree_of(part)),
        _ => None,
    };
    let tree_of_parts = parts.iter().map(instanced).collect();
    (users.par_iter().map(|part| mesh_tree(part, quality)).collect(), tree_of_parts)
}

fn mesh_tree(part: &MeshPart, quality: BuildQuality) -> Tree {
    wide::tree(triangle_references(part, 0).collect(), part, quality)
}

fn triangle_references(
    part: &MeshPart,
    first: u32,
) -> impl IndexedParallelIterator<Item = Reference> + '_ {
    (0..part.mesh.triangles.len() as u32).into_par_iter().map(move |triangle| {
        let bounds = Bounds::around(part.corners(triangle));
        Reference::new(bounds, Item::Triangle(first + triangle))
    })
}

impl Triangles for MeshPart {
    fn triangle(&self, number: u32) -> ([Vec3; 3], u32) {
        (self.corners(number), self.flags)
    }
}

/// The triangles of the world's own tree.
struct OwnTriangles<'a> {
    parts: &'a [Part],
    runs: &'a Runs,
}

impl Triangles for OwnTriangles<'_> {
    fn triangle(&self, number: u32) -> ([Vec3; 3], u32) {
        let Run { first, surface, .. } = self.runs.of(number);
        let triangle = number - first;
        match &self.parts[surface as usize] {
            Part::Mesh(part) => part.triangle(triangle),
            Part::Analytic(shape, flags) => (shape.triangle(triangle), *flags),
        }
    }
}

/// Collects what goes into the world's own tree.
#[derive(Default)]
struct TopBuilder {
    references: Vec<Reference>,
    runs: Vec<Run>,
    triangles: u32,
    endless: Vec<u32>,
}

impl TopBuilder {
    fn add(&mut self, surface: u32, part: &Part, tree: Option<&Tree>, motion: Option<&Motion>) {
        match (part, tree) {
            (Part::Mesh(part), None) => {
                self.runs.push(Run { first: self.triangles, surface, in_pairs: false });
                self.references.par_extend(triangle_references(part, self.triangles));
                self.triangles += part.mesh.triangles.len() as u32;
            }
            (Part::Mesh(part), Some(tree)) if !tree.bounds.is_empty() => {
                let (lo, hi) = (tree.bounds.lo.as_dvec3(), tree.bounds.hi.as_dvec3());
                self.other(surface, Bounds::of_moving(lo, hi, &part.to_world, motion));
            }
            (Part::Mesh(_), Some(_)) => {}
            (Part::Analytic(shape, _), _) => match (shape.triangle_count(), shape.bounds()) {
                (0, Some(bounds)) => self.other(surface, bounds.moving(motion)),
                (0, None) => self.endless.push(surface),
                (count, _) => self.squares(surface, shape, count),
            },
        }
    }

    /// What is made of squares goes in as `count` triangles.
    fn squares(&mut self, surface: u32, shape: &Analytic, count: u32) {
        self.runs.push(Run { first: self.triangles, surface, in_pairs: true });
        self.references.extend((0..count).map(|number| {
            let bounds = Bounds::around(shape.triangle(number));
            Reference::new(bounds, Item::Triangle(self.triangles + number))
        }));
        self.triangles += count;
    }

    fn other(&mut self, surface: u32, bounds: Bounds) {
        self.references.push(Reference::new(bounds, Item::Other(surface)));
    }
}
