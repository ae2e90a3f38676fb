//! Points where paths are scattered, in blocks: loops over a block work on several at a time.

use super::walk::Walk;
use crate::color::Rgb;
use crate::geometry::Ray;
use crate::integrator::media::Media;
use crate::math::{BLOCK, Columns};
use crate::scene::Scene;
use crate::shading::bsdf::{Bsdf, BsdfSample, Frame, Kind, Lobe, Matte};
use crate::shading::light::area::AreaLight;
use crate::shading::volume::HenyeyGreenstein;
use glam::{DAffine3, Vec2, Vec3};

/// A point where a path is scattered.
#[derive(Clone, Copy)]
pub(super) struct Vertex<'a> {
    /// What leads there.
    pub walk: &'a Walk,
    /// Where it is, m.
    pub position: Vec3,
    /// Where rays leave it on the side that the path came from.
    pub start: Vec3,
    /// The surface there, if it is matte and nothing else; otherwise it means nothing.
    pub matte: Matte,
    /// What scatters light there otherwise, and its lobes.
    pub other: Option<(&'a Scattering, &'a [Lobe])>,
}

/// How anything scatters light.
pub(super) struct Scattering {
    /// The frame of the surface.
    pub frame: Frame,
    /// Unit vector to where the path came from.
    pub outgoing: Vec3,
    /// The first of its lobes among all, and the one after the last.
    pub lobes: [u32; 2],
    /// Where rays leave it on the other side.
    pub behind: Vec3,
    /// The solids on the other side.
    pub beyond: Media,
    /// The part of ambient light that its surface's occlusion map lets come to it.
    pub openness: f32,
}

impl<'a> Vertex<'a> {
    /// One at a position between the particles of a medium.
    pub(super) fn floating(
        walk: &'a Walk,
        position: Vec3,
        how: &'a Scattering,
        lobes: &'a [Lobe],
    ) -> Self {
        let matte = Matte { normal: Vec3::ZERO, reflectance: Rgb::ZERO };
        Self { walk, position, start: position, matte, other: Some((how, lobes)) }
    }
}

impl Vertex<'_> {
    /// What is scattered where in all, with one of the lobes picked by `choice`, see [`Bsdf::sample`].
    #[inline(always)]
    pub(super) fn sample(&self, choice: f32, u: Vec2) -> Option<BsdfSample> {
        match self.other {
            None => BsdfSample::of_matte(self.matte.reflectance, self.matte.sample(u)),
            Some((scattering, lobes)) => scattering.bsdf(lobes).sample(choice, u),
        }
    }

    /// BSDF × cosine for light from `incoming`, with the density of that direction, and where rays that way start;
    /// `None` if nothing is scattered.
    #[inline(always)]
    pub(super) fn scattered(&self, incoming: Vec3) -> Option<(Rgb, f32, Vec3)> {
        let (value, pdf) = match self.other {
            None => self.matte.eval(incoming),
            Some((scattering, lobes)) => scattering.bsdf(lobes).eval(incoming),
        };
        (value != Rgb::ZERO).then(|| (value, pdf, self.start_of(self.passes(incoming))))
    }

    /// See [`Bsdf::horizon`].
    #[inline(always)]
    pub(super) fn horizon(&self) -> Vec3 {
        match self.other {
            None => self.matte.normal,
            Some((scattering, lobes)) => scattering.bsdf(lobes).horizon(),
        }
    }

    /// Where rays start on this side or on the other.
    #[inline(always)]
    pub(super) fn start_of(&self, through: bool) -> Vec3 {
        match self.other {
            Some((scattering, _)) if through => scattering.behind,
            _ => self.start,
        }
    }

    /// The solids on this side or on the other.
    #[inline(always)]
    pub(super) fn media_of(&self, through: bool) -> &Media {
        match self.other {
            Some((scattering, _)) if through => &scattering.beyond,
            _ => &self.walk.media,
        }
    }

    /// Whether light from `incoming` comes from the other side.
    #[inline(always)]
    pub(super) fn passes(&self, incoming: Vec3) -> bool {
        match self.other {
            None => false,
            Some((scattering, _)) => incoming.dot(scattering.frame.normal()) < 0.0,
        }
    }

    /// One on a surface; nothing for those between the particles of a medium, for which local lights are asked elsewhere, see `airlight.rs`.
    #[inline(always)]
    pub(super) fn on_surface(&self) -> Option<&Self> {
        match self.other {
            Some((_, [Lobe { kind: Kind::Phase(_), .. }])) => None,
            _ => Some(self),
        }
    }

    /// The part of ambient light that comes to it.
    pub(super) fn openness(&self) -> f32 {
        match self.other {
            None => 1.0,
            Some((scattering, _)) => scattering.openness,
        }
    }

    /// Where a light has moved to, if it does.
    #[inline(always)]
    pub(super) fn moved(&self, scene: &Scene, light: &AreaLight) -> Option<DAffine3> {
        scene.world.moved(light.surface, self.walk.time)
    }
}

impl Scattering {
    /// At a position between the particles of a medium, to which a ray leads in that direction; its lobe is the first.
    pub(super) fn floating(
        walk: &Walk,
        position: Vec3,
        direction: Vec3,
        phase: HenyeyGreenstein,
    ) -> (Self, Lobe) {
        // No surface straightens out what rounding adds up over hundreds of scatterings.
        let outgoing = -direction.normalize();
        let (frame, behind, beyond) = (Frame::around(outgoing), position, walk.media);
        let other = Self { frame, outgoing, lobes: [0, 1], behind, beyond, openness: 1.0 };
        (other, Lobe::new(Kind::Phase(phase), Rgb::ONE))
    }

    #[inline(always)]
    fn bsdf<'a>(&self, lobes: &'a [Lobe]) -> Bsdf<'a> {
        Bsdf { frame: self.frame, outgoing: self.outgoing, lobes }
    }
}

/// Any number of vertices, each of a walk of its own, in the order of walks.
#[derive(Default)]
pub(super) struct Vertices {
    blocks: Vec<VertexBlock>,
    len: usize,
    /// How those scatter light that are not just matte, and all their lobes.
    others: Vec<Scattering>,
    pub(super) lobes: Vec<Lobe>,
}

/// A block of vertices.
pub(super) struct VertexBlock {
    /// Numbers of the walks.
    pub(super) walk: [u32; BLOCK],
    position: Columns<f32>,
    /// See [`Vertex::start`].
    pub(super) start: Columns<f32>,
    /// Of matte ones; of others they mean nothing.
    normal: Columns<f32>,
    reflectance: Columns<f32>,
    /// Places of those that are not just matte in [`Vertices::others`], or [`MATTE`].
    other: [u32; BLOCK],
}

/// Says that a vertex is matte.
const MATTE: u32 = u32::MAX;

impl Default for VertexBlock {
    fn default() -> Self {
        let columns = Columns::<f32>::default;
        Self {
            walk: [0; BLOCK],
            position: columns(),
            start: columns(),
            normal: columns(),
            reflectance: columns(),
            other: [MATTE; BLOCK],
        }
    }
}

impl VertexBlock {
    /// The surface of vertex `k`, if it is matte; otherwise it means nothing.
    #[inline(always)]
    pub(super) fn matte(&self, k: usize) -> Matte {
        Matte { normal: self.normal.get(k), reflectance: self.reflectance.get(k) }
    }
}

impl Vertices {
    /// Forgets all.
    pub(super) fn clear(&mut self) {
        self.len = 0;
        self.others.clear();
        self.lobes.clear();
    }

    /// How many there are.
    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// The blocks.
    #[inline(always)]
    pub(super) fn blocks(&self) -> &[VertexBlock] {
        &self.blocks[..self.len.div_ceil(BLOCK)]
    }

    /// The number of each vertex's walk.
    #[inline(always)]
    pub(super) fn walks(&self) -> impl ExactSizeIterator<Item = u32> {
        (0..self.len).map(|k| self.blocks[k / BLOCK].walk[k % BLOCK])
    }

    /// Vertex `k`; `walks` are all.
    #[inline(always)]
    pub(super) fn get<'a>(&'a self, k: usize, walks: &'a [Walk]) -> Vertex<'a> {
        let (block, k) = (&self.blocks[k / BLOCK], k % BLOCK);
        let other = self.others.get(block.other[k] as usize).map(|other| {
            let [first, end] = other.lobes;
            (other, &self.lobes[first as usize..end as usize])
        });
        let walk = &walks[block.walk[k] as usize];
        let (position, start) = (block.position.get(k), block.start.get(k));
        Vertex { walk, position, start, matte: block.matte(k), other }
    }

    /// Adds one on a matte surface.
    #[inline(always)]
    pub(super) fn push_matte(&mut self, walk: u32, [position, start]: [Vec3; 2], matte: Matte) {
        let (block, k) = self.push(walk, [position, start]);
        block.normal.set(k, matte.normal);
        block.reflectance.set(k, matte.reflectance);
        block.other[k] = MATTE;
    }

    /// Adds one on anything.
    pub(super) fn push_other(&mut self, walk: u32, places: [Vec3; 2], other: Scattering) {
        let place = self.others.len() as u32;
        let (block, k) = self.push(walk, places);
        block.other[k] = place;
        self.others.push(other);
    }

    #[inline(always)]
    fn push(&mut self, walk: u32, [position, start]: [Vec3; 2]) -> (&mut VertexBlock, usize) {
        let (block, k) = (self.len / BLOCK, self.len % BLOCK);
        if block == self.blocks.len() {
            self.blocks.push(VertexBlock::default());
        }
        self.len += 1;
        let block = &mut self.blocks[block];
        block.walk[k] = walk;
        block.position.set(k, position);
        block.start.set(k, start);
        (block, k)
    }

    /// Adds one at the end of `ray`, between the particles of a medium.
    pub(super) fn push_floating(
        &mut self,
        number: u32,
        walk: &Walk,
        ray: &Ray,
        phase: HenyeyGreenstein,
    ) {
        let position = ray.origin + ray.t_max * ray.direction;
        let (other, lobe) = Scattering::floating(walk, position, ray.direction, phase);
        let first = self.lobes.len() as u32;
        self.lobes.push(lobe);
        self.push_other(number, [position; 2], Scattering { lobes: [first, first + 1], ..other });
    }
}
