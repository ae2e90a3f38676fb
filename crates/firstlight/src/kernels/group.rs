//! Some rays, as many as vectors for rays have lanes, structure of arrays, prepared for boxes and triangles.

use super::layout::{Axis, EntryPlanes, Node, TriangleBlock};
use super::traverse::{Answer, FLATTENED, PAD, SMALLEST, Slabs};
use super::triangles::{Shear, axes};
use crate::geometry::{Hit, NOTHING, Ray};
use crate::simd::{LANES, Lanes, MOST, Mask, Simd, Vectors};

/// Three rows. (Not a closure: those are compiled without the level's instructions.)
#[inline(always)]
pub(super) fn load<V: Vectors>(simd: V, rows: &[V::Row; 3]) -> [V::F; 3] {
    [simd.load(&rows[0]), simd.load(&rows[1]), simd.load(&rows[2])]
}

/// One number of a row.
#[inline(always)]
pub(super) fn at<V: Vectors>(row: &V::Row, lane: usize) -> f32 {
    row.as_ref()[lane % V::COUNT]
}

/// All lanes, as bits.
#[inline(always)]
pub(super) fn all<V: Vectors>() -> u32 {
    (1 << V::COUNT) - 1
}

/// Whether all lanes agree.
#[inline(always)]
fn uniform<V: Vectors>(bits: u32) -> bool {
    bits == 0 || bits == all::<V>()
}

/// Three rows, one for each axis, so that the axis along which a ray goes furthest (x, else y, else z) comes last.
#[inline(always)]
fn turned<F: Lanes>((along_x, along_y): (F::Mask, F::Mask), [x, y, z]: [F; 3]) -> [F; 3] {
    [
        y.select(along_x, z.select(along_y, x)),
        z.select(along_x, x.select(along_y, y)),
        x.select(along_x, y.select(along_y, z)),
    ]
}

/// One lane of three rows, in every lane.
#[inline(always)]
fn splat<S: Simd>(simd: S, rows: &[<S::Rays as Vectors>::Row; 3], lane: usize) -> [S::F; 3] {
    let [x, y, z] = rows;
    [
        simd.splat(at::<S::Rays>(x, lane)),
        simd.splat(at::<S::Rays>(y, lane)),
        simd.splat(at::<S::Rays>(z, lane)),
    ]
}

/// Some rays.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub(super) struct Group<V: Vectors> {
    pub origin: [V::Row; 3],
    pub direction: [V::Row; 3],
    /// Per axis and ray: `t = plane · scale + offset`, padded away from the box.
    pub scale: [V::Row; 3],
    near: [V::Row; 3],
    far: [V::Row; 3],
    pub t_min: V::Row,
    /// How far each ray still looks, to its hit at last; −∞ if it has its answer.
    pub t: V::Row,
    /// What else there is to know of their hits; surfaces and primitives as bits.
    u: V::Row,
    v: V::Row,
    surface: V::Row,
    primitive: V::Row,
    /// The axis along which each ray goes furthest, the first of equals: its number, as bits.
    along: V::Row,
    /// For triangles: shear along the two other axes, and the origin with these first.
    shear: [V::Row; 2],
    turned: [V::Row; 3],
    /// Whether all rays go furthest along the same axis.
    one_way: bool,
    /// The signs of the directions, per axis, as bits.
    signs: [u32; 3],
    /// The largest coordinate of the origins.
    pub magnitude: f32,
}

impl<V: Vectors> Group<V> {
    /// Nothing yet.
    pub(super) const EMPTY: Self = Self {
        origin: [V::ZERO; 3],
        direction: [V::ZERO; 3],
        scale: [V::ZERO; 3],
        near: [V::ZERO; 3],
        far: [V::ZERO; 3],
        t_min: V::ZERO,
        t: V::ZERO,
        u: V::ZERO,
        v: V::ZERO,
        surface: V::ZERO,
        primitive: V::ZERO,
        along: V::ZERO,
        shear: [V::ZERO; 2],
        turned: [V::ZERO; 3],
        one_way: false,
        signs: [0; 3],
        magnitude: 0.0,
    };

    /// Takes up rays, of which the lanes left over repeat the last, with their answer known; they are still to be
    /// [prepared](Self::prepare).
    #[inline(always)]
    pub(super) fn load<S: Simd<Rays = V>>(&mut self, simd: S, rays: &[&Ray]) {
        let mut rows = [[0.0; LANES]; MOST];
        for (lane, row) in rows.iter_mut().enumerate().take(V::COUNT) {
            *row = *rays[lane.min(rays.len() - 1)].numbers();
        }
        let [ox, oy, oz, dx, dy, dz, t_min, t_max] = simd.columns(&rows);
        self.origin = [ox.to_array(), oy.to_array(), oz.to_array()];
        self.direction = [dx.to_array(), dy.to_array(), dz.to_array()];
        (self.t_min, self.t) = (t_min.to_array(), t_max.to_array());
        self.signs = [dx.signs(), dy.signs(), dz.signs()];
        if rays.len() < V::COUNT {
            self.t.as_mut()[rays.len()..].fill(f32::NEG_INFINITY);
        }
    }

    /// Prepares its rays for a tree with coordinates up to `reach`.
    #[inline(always)]
    pub(super) fn prepare(&mut self, simd: V, reach: f32) {
        self.prepare_slabs(simd, reach);
        self.prepare_shear(simd);
    }

    /// Starts with no hits.
    #[inline(always)]
    pub(super) fn forget(&mut self, simd: V) {
        (self.u, self.v, self.primitive) = (V::ZERO, V::ZERO, V::ZERO);
        self.surface = simd.splat(f32::from_bits(NOTHING)).to_array();
    }

    /// Starts with answers that are known. (Not inlined: where the processor can gather them from memory it does so slowly.)
    #[inline(never)]
    pub(super) fn know<A: Answer<ANY>, const ANY: bool>(&mut self, answers: &[A]) {
        for (lane, answer) in answers.iter().enumerate() {
            let hit = answer.hit(at::<V>(&self.t, lane));
            if hit.is_some() {
                self.found::<ANY>(lane, &hit);
            } else {
                self.set_hit(lane, &hit);
            }
        }
    }

    /// The hit of one of its rays.
    #[inline(always)]
    pub(super) fn hit(&self, lane: usize) -> Hit {
        Hit {
            t: at::<V>(&self.t, lane),
            u: at::<V>(&self.u, lane),
            v: at::<V>(&self.v, lane),
            surface: at::<V>(&self.surface, lane).to_bits(),
            primitive: at::<V>(&self.primitive, lane).to_bits(),
        }
    }

    /// Replaces the hit of one of its rays.
    #[inline(always)]
    fn set_hit(&mut self, lane: usize, hit: &Hit) {
        let lane = lane % V::COUNT;
        self.t.as_mut()[lane] = hit.t;
        self.u.as_mut()[lane] = hit.u;
        self.v.as_mut()[lane] = hit.v;
        self.surface.as_mut()[lane] = f32::from_bits(hit.surface);
        self.primitive.as_mut()[lane] = f32::from_bits(hit.primitive);
    }

    /// Notes that one of its rays has found a hit.
    #[inline(always)]
    pub(super) fn found<const ANY: bool>(&mut self, lane: usize, hit: &Hit) {
        let t = if ANY { f32::NEG_INFINITY } else { hit.t };
        self.set_hit(lane, &Hit { t, ..*hit });
    }

    /// Replaces the hits of some of its rays by those of one triangle at `t`; of any hit, it is enough that there is one.
    #[inline(always)]
    pub(super) fn take<const ANY: bool>(
        &mut self,
        simd: V,
        rays: V::M,
        (t, weights): (V::F, [V::F; 3]),
        primitive: u32,
    ) {
        let before = simd.load(&self.t);
        if ANY {
            self.t = simd.splat(f32::NEG_INFINITY).select(rays, before).to_array();
            return;
        }
        let scale = simd.splat(1.0) / (weights[0] + weights[1] + weights[2]);
        let [surface, primitive] =
            [FLATTENED, primitive].map(|bits| simd.splat(f32::from_bits(bits)));
        self.t = t.select(rays, before).to_array();
        self.u = (weights[1] * scale).select(rays, simd.load(&self.u)).to_array();
        self.v = (weights[2] * scale).select(rays, simd.load(&self.v)).to_array();
        self.surface = surface.select(rays, simd.load(&self.surface)).to_array();
        self.primitive = primitive.select(rays, simd.load(&self.primitive)).to_array();
    }

    /// The answers of its rays.
    #[inline(always)]
    pub(super) fn answer<A: Answer<ANY>, const ANY: bool>(&self, answers: &mut [A]) {
        let weights = self.u.as_ref().iter().zip(self.v.as_ref());
        let names = self.surface.as_ref().iter().zip(self.primitive.as_ref());
        let rows = self.t.as_ref().iter().zip(weights).zip(names);
        for (answer, ((&t, (&u, &v)), (surface, primitive))) in answers.iter_mut().zip(rows) {
            let any = if t == f32::NEG_INFINITY { FLATTENED } else { NOTHING };
            let surface = if ANY { any } else { surface.to_bits() };
            *answer = A::of(&Hit { t, u, v, surface, primitive: primitive.to_bits() });
        }
    }

    #[inline(always)]
    fn prepare_slabs(&mut self, simd: V, reach: f32) {
        let (zero, one) = (simd.splat(0.0), simd.splat(1.0));
        let [x, y, z] = load(simd, &self.origin);
        let magnitude = x.abs().max(y.abs()).max(z.abs());
        let pad = (magnitude + simd.splat(reach)) * simd.splat(PAD);
        self.magnitude = magnitude.largest();
        for axis in 0..3 {
            let (o, d) = (simd.load(&self.origin[axis]), simd.load(&self.direction[axis]));
            let scale = one / d.abs().max(simd.splat(SMALLEST)).copysign(d);
            let pad = pad.copysign(scale);
            self.scale[axis] = scale.to_array();
            self.near[axis] = (zero - (o + pad) * scale).to_array();
            self.far[axis] = (zero - (o - pad) * scale).to_array();
        }
    }

    #[inline(always)]
    fn prepare_shear(&mut self, simd: V) {
        let [dx, dy, dz] = load(simd, &self.direction);
        let [x, y, z] = [dx.abs(), dy.abs(), dz.abs()];
        let along = (y.le(x) & z.le(x), z.le(y));
        self.one_way =
            uniform::<V>(along.0.bits()) && uniform::<V>(along.1.bits() & !along.0.bits());
        let [first, second, _] = turned(along, [dx, dy, dz]);
        let [_, _, scale] = turned(along, load(simd, &self.scale));
        self.shear = [(first * scale).to_array(), (second * scale).to_array()];
        let [first, second, third] = turned(along, load(simd, &self.origin));
        self.turned = [first.to_array(), second.to_array(), third.to_array()];
        let [x, y, z] = [0, 1, 2].map(f32::from_bits);
        let [_, _, number] = turned(along, [simd.splat(x), simd.splat(y), simd.splat(z)]);
        self.along = number.to_array();
    }

    /// The signs of the directions as bits, if all rays agree in them.
    #[inline(always)]
    pub(super) fn octant(&self) -> Option<u32> {
        let [x, y, z] = self.signs;
        (uniform::<V>(x) && uniform::<V>(y) && uniform::<V>(z)).then_some(x & 1 | y & 2 | z & 4)
    }

    /// Which rays have no answer yet.
    #[inline(always)]
    pub(super) fn looking(&self, simd: V) -> u32 {
        simd.splat(f32::NEG_INFINITY).lt(simd.load(&self.t)).bits()
    }

    /// Whether all rays, which are prepared, agree in their largest axis.
    #[inline(always)]
    pub(super) fn goes_one_way(&self) -> bool {
        self.one_way
    }

    /// The order of the axes for a ray.
    #[inline(always)]
    fn axes(&self, lane: usize) -> [Axis; 3] {
        axes(at::<V>(&self.along, lane).to_bits() as usize)
    }

    /// Where its rays end along one axis.
    #[inline(always)]
    pub(super) fn end(&self, simd: V, axis: usize) -> V::F {
        let (o, d) = (simd.load(&self.origin[axis]), simd.load(&self.direction[axis]));
        d.mul_add(simd.load(&self.t), o)
    }

    /// Its rays, which agree in their largest axis, prepared for triangles.
    #[inline(always)]
    pub(super) fn shear(&self, simd: V) -> Shear<V> {
        Shear {
            axes: self.axes(0),
            shear: [simd.load(&self.shear[0]), simd.load(&self.shear[1])],
            origin: load(simd, &self.turned),
        }
    }

    /// One of its rays, prepared for triangles.
    #[inline(always)]
    pub(super) fn shear_of<S: Simd<Rays = V>>(&self, simd: S, lane: usize) -> Shear<S> {
        Shear {
            axes: self.axes(lane),
            shear: [
                simd.splat(at::<V>(&self.shear[0], lane)),
                simd.splat(at::<V>(&self.shear[1], lane)),
            ],
            origin: splat(simd, &self.turned, lane),
        }
    }

    /// One of its rays, prepared for boxes.
    #[inline(always)]
    pub(super) fn slabs_of<S: Simd<Rays = V>>(&self, simd: S, lane: usize) -> Slabs<S> {
        Slabs {
            scale: splat(simd, &self.scale, lane),
            near: splat(simd, &self.near, lane),
            far: splat(simd, &self.far, lane),
            t_min: simd.splat(at::<V>(&self.t_min, lane)),
            simd,
        }
    }

    /// Which of its rays meet one box of a node before their hit.
    #[inline(always)]
    pub(super) fn meet_box(&self, simd: V, node: &Node, slot: usize, entry: &EntryPlanes) -> u32 {
        let (mut enter, mut leave) = (simd.load(&self.t_min), simd.load(&self.t));
        for axis in 0..3 {
            let near = simd.splat(node.row(entry.near[axis])[slot]);
            let far = simd.splat(node.row(entry.far[axis])[slot]);
            let scale = simd.load(&self.scale[axis]);
            enter = enter.max(near.mul_add(scale, simd.load(&self.near[axis])));
            leave = leave.min(far.mul_add(scale, simd.load(&self.far[axis])));
        }
        enter.le(leave).bits()
    }

    /// The vertices of a block across its rays, which agree in their largest axis.
    #[inline(always)]
    pub(super) fn across(&self, simd: V, block: &TriangleBlock) -> [(V::F, V::F); LANES] {
        let shear = self.shear(simd);
        let zero = simd.splat(0.0);
        let mut points = [(zero, zero); LANES];
        for (vertex, point) in points.iter_mut().enumerate().take(block.vertex_count()) {
            *point = shear.apply(
                simd.splat(block.row(shear.axes[0])[vertex]),
                simd.splat(block.row(shear.axes[1])[vertex]),
                simd.splat(block.row(shear.axes[2])[vertex]),
            );
        }
        points
    }
}
