//! Rays through Embree: one by one or in packets of 8 and 16.

use super::abi::{Arguments, COHERENT, Hits, INVALID, OnlyRays, Rays, RaysAndHits, TRIANGLES};
use super::{FlushDenormals, Scene};
use crate::race::{Answers, Query, Tracer};
use firstlight::Ray;
use glam::{Mat4, Vec4};
use std::array::from_fn;
use std::ptr::null_mut;

/// How many rays a call takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Width {
    /// `rtcIntersect1`, `rtcOccluded1`.
    One,
    /// `rtcIntersect8`, `rtcOccluded8`.
    Eight,
    /// `rtcIntersect16`, `rtcOccluded16`.
    Sixteen,
}

/// A scene with one way of asking it.
pub(crate) struct Mode<'a> {
    /// What is traced.
    pub(crate) scene: &'a Scene<'a>,
    /// Rays per call.
    pub(crate) width: Width,
    /// Whether Embree is told that rays lie close to each other.
    pub(crate) coherent: bool,
}

impl Tracer for Mode<'_> {
    fn trace(&self, query: Query, rays: &[Ray], answers: &mut Answers) {
        let _flush = FlushDenormals::start();
        answers.t.resize(rays.len(), 0.0);
        match query {
            Query::Closest => self.closest(rays, &mut answers.t),
            Query::Any => self.any(rays, &mut answers.t),
        }
    }

    fn distances(&self, _: Query, answers: &Answers) -> Vec<f32> {
        answers.t.clone()
    }
}

/// One flag per ray of a packet, aligned as Embree reads them.
#[repr(C, align(64))]
struct TakesPart([i32; 16]);

/// Every ray does.
static ALL: TakesPart = TakesPart([-1; 16]);

impl Mode<'_> {
    /// What to call it.
    pub(crate) fn name(&self) -> String {
        let rays = match self.width {
            Width::One => "1",
            Width::Eight => "8",
            Width::Sixteen => "16",
        };
        let coherent = if self.coherent { " coherent" } else { "" };
        let bits = if self.scene.setup.simd256 { ", simd256" } else { "" };
        format!("{rays}{coherent}{bits}")
    }

    fn arguments(&self) -> Arguments {
        Arguments {
            flags: if self.coherent { COHERENT } else { 0 },
            features: TRIANGLES,
            context: null_mut(),
            filter: null_mut(),
            callback: null_mut(),
        }
    }

    fn closest(&self, rays: &[Ray], t: &mut [f32]) {
        let (f, scene, mut arguments) =
            (&self.scene.embree.functions, self.scene.scene, self.arguments());
        let (all, arguments) = (ALL.0.as_ptr(), &raw mut arguments);
        // SAFETY: the scene is committed; packets and `ALL` have Embree's layout and alignment.
        unsafe {
            match self.width {
                Width::One => closest::<1>(rays, t, |p| (f.intersect1)(scene, p, arguments)),
                Width::Eight => closest::<8>(rays, t, |p| (f.intersect8)(all, scene, p, arguments)),
                Width::Sixteen => {
                    closest::<16>(rays, t, |p| (f.intersect16)(all, scene, p, arguments))
                }
            }
        }
    }

    fn any(&self, rays: &[Ray], t: &mut [f32]) {
        let (f, scene, mut arguments) =
            (&self.scene.embree.functions, self.scene.scene, self.arguments());
        let (all, arguments) = (ALL.0.as_ptr(), &raw mut arguments);
        // SAFETY: as in `closest`.
        unsafe {
            match self.width {
                Width::One => any::<1>(rays, t, |p| (f.occluded1)(scene, p, arguments)),
                Width::Eight => any::<8>(rays, t, |p| (f.occluded8)(all, scene, p, arguments)),
                Width::Sixteen => any::<16>(rays, t, |p| (f.occluded16)(all, scene, p, arguments)),
            }
        }
    }
}

/// Has rays traced N at a time and takes the distances out; infinite where nothing is hit.
#[inline(always)]
fn closest<const N: usize>(rays: &[Ray], t: &mut [f32], trace: impl Fn(*mut RaysAndHits<N>)) {
    let mut packet = RaysAndHits { rays: Rays::new(), hits: Hits::new() };
    for (rays, t) in rays.chunks(N).zip(t.chunks_mut(N)) {
        packet.rays.load(rays);
        packet.hits.geometry = [INVALID; N];
        packet.hits.instance = [INVALID; N];
        trace(&raw mut packet);
        for (i, t) in t.iter_mut().enumerate() {
            let hit = packet.hits.geometry[i] != INVALID;
            *t = if hit { packet.rays.t_far[i] } else { f32::INFINITY };
        }
    }
}

/// The same for occlusion, which Embree tells by a negative end of the range: 0 where something is in the way.
#[inline(always)]
fn any<const N: usize>(rays: &[Ray], t: &mut [f32], trace: impl Fn(*mut OnlyRays<N>)) {
    let mut packet = OnlyRays { rays: Rays::new() };
    for (rays, t) in rays.chunks(N).zip(t.chunks_mut(N)) {
        packet.rays.load(rays);
        trace(&raw mut packet);
        for (i, t) in t.iter_mut().enumerate() {
            *t = if packet.rays.t_far[i] < 0.0 { 0.0 } else { f32::INFINITY };
        }
    }
}

impl<const N: usize> Rays<N> {
    /// N rays that all queries may find.
    fn new() -> Self {
        Self {
            origin: [[0.0; N]; 3],
            t_near: [0.0; N],
            direction: [[0.0; N]; 3],
            time: [0.0; N],
            t_far: [0.0; N],
            mask: [u32::MAX; N],
            id: [0; N],
            flags: [0; N],
        }
    }

    /// Puts `rays` in, component by component; the last one again and again where fewer than N are left.
    #[inline(always)]
    fn load(&mut self, rays: &[Ray]) {
        let rays: &[Ray; N] = match rays.try_into() {
            Ok(full) => full,
            Err(_) => &from_fn(|i| rays[i.min(rays.len() - 1)]),
        };
        let (fours, rest) = rays.as_chunks::<4>();
        fours.iter().enumerate().for_each(|(i, four)| self.load_four(4 * i, four));
        rest.iter().enumerate().for_each(|(i, ray)| self.load_one(i, ray));
    }

    #[inline(always)]
    fn load_one(&mut self, lane: usize, ray: &Ray) {
        for axis in 0..3 {
            self.origin[axis][lane] = ray.origin[axis];
            self.direction[axis][lane] = ray.direction[axis];
        }
        self.t_near[lane] = ray.t_min;
        self.t_far[lane] = ray.t_max;
    }

    /// Four at a time through transposed matrices, a third faster than one by one: packing shall not hold Embree up.
    #[inline(always)]
    fn load_four(&mut self, lane: usize, rays: &[Ray; 4]) {
        let first = |r: &Ray| Vec4::new(r.origin.x, r.origin.y, r.origin.z, r.direction.x);
        let last = |r: &Ray| Vec4::new(r.direction.y, r.direction.z, r.t_min, r.t_max);
        let transposed = |[a, b, c, d]: [Vec4; 4]| Mat4::from_cols(a, b, c, d).transpose();
        let (first, last) =
            (transposed(rays.each_ref().map(first)), transposed(rays.each_ref().map(last)));
        let ([origin_x, origin_y, origin_z], [x, y, z]) = (&mut self.origin, &mut self.direction);
        let places = [origin_x, origin_y, origin_z, x, y, z, &mut self.t_near, &mut self.t_far];
        for (row, place) in places.into_iter().enumerate() {
            let matrix = if row < 4 { &first } else { &last };
            matrix.col(row % 4).write_to_slice(&mut place[lane..]);
        }
    }
}

impl<const N: usize> Hits<N> {
    /// No hits.
    fn new() -> Self {
        Self {
            normal: [[0.0; N]; 3],
            uv: [[0.0; N]; 2],
            primitive: [INVALID; N],
            geometry: [INVALID; N],
            instance: [INVALID; N],
            instance_primitive: [INVALID; N],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn rays_find_their_places_in_packets() {
        let ray = |i: u32| {
            let v = |start: u32| Vec3::from_array([start, start + 1, start + 2].map(|n| n as f32));
            Ray {
                origin: v(8 * i),
                direction: v(8 * i + 3),
                t_min: 0.5 * i as f32,
                t_max: -(i as f32),
                time: 0.0,
            }
        };
        let rays: Vec<_> = (0..6).map(ray).collect();
        let mut packet = Rays::<8>::new();
        packet.load(&rays);
        for lane in 0..8 {
            let ray = rays[lane.min(5)];
            assert_eq!(packet.origin.map(|row| row[lane]), ray.origin.to_array());
            assert_eq!(packet.direction.map(|row| row[lane]), ray.direction.to_array());
            assert_eq!((packet.t_near[lane], packet.t_far[lane]), (ray.t_min, ray.t_max));
        }
    }
}
