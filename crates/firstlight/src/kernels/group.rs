//! Eight rays, structure of arrays, prepared for boxes and triangles.

use super::layout::{Axis, EntryPlanes, Node, TriangleBlock};
use super::traverse::{PAD, SMALLEST, Slabs};
use super::triangles::{Shear, axes};
use crate::geometry::{Hit, Ray};
use crate::simd::{LANES, Lanes, Mask, Simd};

/// All lanes, as bits.
pub(super) const ALL: u32 = (1 << LANES) - 1;

/// Eight numbers, aligned.
#[derive(Clone, Copy)]
#[repr(C, align(32))]
pub(super) struct Row(pub [f32; LANES]);

impl Row {
    /// Zeros.
    pub(super) const ZERO: Self = Self([0.0; LANES]);
}

/// Eight numbers to memory.
#[inline(always)]
pub(super) fn row<F: Lanes>(x: F) -> Row {
    Row(x.to_array())
}

/// Three rows. (Not a closure: those are compiled without the level's instructions.)
#[inline(always)]
pub(super) fn load<S: Simd>(simd: S, rows: &[Row; 3]) -> [S::F; 3] {
    [simd.load(&rows[0].0), simd.load(&rows[1].0), simd.load(&rows[2].0)]
}

/// Whether all lanes agree.
#[inline(always)]
fn uniform(bits: u32) -> bool {
    bits == 0 || bits == ALL
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
fn splat<S: Simd>(simd: S, rows: &[Row; 3], lane: usize) -> [S::F; 3] {
    [simd.splat(rows[0].0[lane]), simd.splat(rows[1].0[lane]), simd.splat(rows[2].0[lane])]
}

/// Eight rays.
#[derive(Clone, Copy)]
pub(super) struct Group {
    pub origin: [Row; 3],
    pub direction: [Row; 3],
    /// Per axis and ray: `t = plane · scale + offset`, padded away from the box.
    pub scale: [Row; 3],
    near: [Row; 3],
    far: [Row; 3],
    pub t_min: Row,
    /// How far each ray still looks; −∞ if it has its answer.
    pub t: Row,
    /// The axis along which each ray goes furthest, the first of equals: its number, as bits.
    along: Row,
    /// Whether that is the same for all rays.
    one_way: bool,
    /// For triangles: shear along the two other axes, and the origin with these first.
    shear: [Row; 2],
    turned: [Row; 3],
    /// The signs of the directions, per axis, as bits.
    signs: [u32; 3],
    /// The largest coordinate of the origins.
    pub magnitude: f32,
}

impl Group {
    /// Nothing yet.
    pub(super) const EMPTY: Self = Self {
        origin: [Row::ZERO; 3],
        direction: [Row::ZERO; 3],
        scale: [Row::ZERO; 3],
        near: [Row::ZERO; 3],
        far: [Row::ZERO; 3],
        t_min: Row::ZERO,
        t: Row::ZERO,
        along: Row::ZERO,
        one_way: false,
        shear: [Row::ZERO; 2],
        turned: [Row::ZERO; 3],
        signs: [0; 3],
        magnitude: 0.0,
    };

    /// Takes up eight rays; they are still to be [prepared](Self::prepare).
    #[inline(always)]
    pub(super) fn load<S: Simd>(&mut self, simd: S, rays: [&Ray; LANES]) {
        let mut rows = [simd.splat(0.0); LANES];
        for (row, ray) in rows.iter_mut().zip(rays) {
            let (o, d) = (ray.origin, ray.direction);
            *row = simd.load(&[o.x, o.y, o.z, d.x, d.y, d.z, ray.t_min, ray.t_max]);
        }
        let [ox, oy, oz, dx, dy, dz, t_min, t_max] = simd.transpose(rows);
        self.origin = [row(ox), row(oy), row(oz)];
        self.direction = [row(dx), row(dy), row(dz)];
        (self.t_min, self.t) = (row(t_min), row(t_max));
        self.signs = [dx.signs(), dy.signs(), dz.signs()];
    }

    /// Prepares its rays for a tree with coordinates up to `reach`.
    #[inline(always)]
    pub(super) fn prepare<S: Simd>(&mut self, simd: S, reach: f32) {
        self.prepare_slabs(simd, reach);
        self.prepare_shear(simd);
    }

    /// Takes up fewer rays than eight; the lanes left over have their answer.
    #[inline(always)]
    pub(super) fn load_some<S: Simd>(&mut self, simd: S, rays: &[Ray]) {
        let padded = std::array::from_fn(|lane| &rays[lane.min(rays.len() - 1)]);
        self.load(simd, padded);
        self.t.0[rays.len()..].fill(f32::NEG_INFINITY);
    }

    /// Leaves out rays that have their answer, and looks no further than known hits.
    #[inline(always)]
    pub(super) fn know<const ANY: bool>(&mut self, hits: &[Hit]) {
        for (t, hit) in self.t.0.iter_mut().zip(hits) {
            *t = if ANY && hit.is_some() { f32::NEG_INFINITY } else { hit.t };
        }
    }

    #[inline(always)]
    fn prepare_slabs<S: Simd>(&mut self, simd: S, reach: f32) {
        let (zero, one) = (simd.splat(0.0), simd.splat(1.0));
        let [x, y, z] = load(simd, &self.origin);
        let magnitude = x.abs().max(y.abs()).max(z.abs());
        let pad = (magnitude + simd.splat(reach)) * simd.splat(PAD);
        self.magnitude = magnitude.largest();
        for axis in 0..3 {
            let (o, d) = (simd.load(&self.origin[axis].0), simd.load(&self.direction[axis].0));
            let scale = one / d.abs().max(simd.splat(SMALLEST)).copysign(d);
            let pad = pad.copysign(scale);
            self.scale[axis] = row(scale);
            self.near[axis] = row(zero - (o + pad) * scale);
            self.far[axis] = row(zero - (o - pad) * scale);
        }
    }

    #[inline(always)]
    fn prepare_shear<S: Simd>(&mut self, simd: S) {
        let [dx, dy, dz] = load(simd, &self.direction);
        let [x, y, z] = [dx.abs(), dy.abs(), dz.abs()];
        let along = (y.le(x) & z.le(x), z.le(y));
        self.one_way = uniform(along.0.bits()) && uniform(along.1.bits() & !along.0.bits());
        let [first, second, largest] = turned(along, [dx, dy, dz]);
        self.shear = [row(first / largest), row(second / largest)];
        let [first, second, third] = turned(along, load(simd, &self.origin));
        self.turned = [row(first), row(second), row(third)];
        let [x, y, z] = [0, 1, 2].map(f32::from_bits);
        let [_, _, number] = turned(along, [simd.splat(x), simd.splat(y), simd.splat(z)]);
        self.along = row(number);
    }

    /// The signs of the directions as bits, if all rays agree in them.
    #[inline(always)]
    pub(super) fn octant(&self) -> Option<u32> {
        let [x, y, z] = self.signs;
        (uniform(x) && uniform(y) && uniform(z)).then_some(x & 1 | y & 2 | z & 4)
    }

    /// Which rays have no answer yet.
    #[inline(always)]
    pub(super) fn looking<S: Simd>(&self, simd: S) -> u32 {
        simd.splat(f32::NEG_INFINITY).lt(simd.load(&self.t.0)).bits()
    }

    /// Whether all rays, which are prepared, agree in their largest axis.
    #[inline(always)]
    pub(super) fn goes_one_way(&self) -> bool {
        self.one_way
    }

    /// The order of the axes for a ray.
    #[inline(always)]
    fn axes(&self, lane: usize) -> [Axis; 3] {
        axes(self.along.0[lane].to_bits() as usize)
    }

    /// Where its rays end along one axis.
    #[inline(always)]
    pub(super) fn end<S: Simd>(&self, simd: S, axis: usize) -> S::F {
        let (o, d) = (simd.load(&self.origin[axis].0), simd.load(&self.direction[axis].0));
        d.mul_add(simd.load(&self.t.0), o)
    }

    /// Its rays, which agree in their largest axis, prepared for triangles.
    #[inline(always)]
    pub(super) fn shear<S: Simd>(&self, simd: S) -> Shear<S> {
        Shear {
            axes: self.axes(0),
            shear: [simd.load(&self.shear[0].0), simd.load(&self.shear[1].0)],
            origin: load(simd, &self.turned),
        }
    }

    /// One of its rays, prepared for triangles.
    #[inline(always)]
    pub(super) fn shear_of<S: Simd>(&self, simd: S, lane: usize) -> Shear<S> {
        Shear {
            axes: self.axes(lane),
            shear: [simd.splat(self.shear[0].0[lane]), simd.splat(self.shear[1].0[lane])],
            origin: splat(simd, &self.turned, lane),
        }
    }

    /// One of its rays, prepared for boxes.
    #[inline(always)]
    pub(super) fn slabs_of<S: Simd>(&self, simd: S, lane: usize) -> Slabs<S> {
        Slabs {
            scale: splat(simd, &self.scale, lane),
            near: splat(simd, &self.near, lane),
            far: splat(simd, &self.far, lane),
            t_min: simd.splat(self.t_min.0[lane]),
            simd,
        }
    }

    /// Which of its rays meet one box of a node before their hit.
    #[inline(always)]
    pub(super) fn meet_box<S: Simd>(
        &self,
        simd: S,
        node: &Node,
        slot: usize,
        entry: &EntryPlanes,
    ) -> u32 {
        let (mut enter, mut leave) = (simd.load(&self.t_min.0), simd.load(&self.t.0));
        for axis in 0..3 {
            let near = simd.splat(node.row(entry.near[axis])[slot]);
            let far = simd.splat(node.row(entry.far[axis])[slot]);
            let scale = simd.load(&self.scale[axis].0);
            enter = enter.max(near.mul_add(scale, simd.load(&self.near[axis].0)));
            leave = leave.min(far.mul_add(scale, simd.load(&self.far[axis].0)));
        }
        enter.le(leave).bits()
    }

    /// The vertices of a block across its rays, which agree in their largest axis.
    #[inline(always)]
    pub(super) fn across<S: Simd>(&self, simd: S, block: &TriangleBlock) -> [(S::F, S::F); LANES] {
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
