//! Surfaces that emit, as lights: their shapes, and which of them a ray has met.

use super::shape::{
    CylinderSide, Ellipsoid, EllipticDisk, LightShape, Parallelogram, ShapeSample, ShapeSamples,
};
use super::tree::{EmissionCone, LightBounds};
use crate::geometry::{Analytic, Piece, Ray};
use crate::math::{BLOCK, Columns};
use crate::scene::description::Motion;
use crate::shading::interaction::clearance;
use glam::{DAffine3, DVec2, DVec3, Vec2, Vec3};

/// One part of a surface that emits.
#[derive(Debug, Clone)]
pub(crate) struct AreaLight {
    /// Where it is.
    pub shape: LightShape,
    /// The surface it belongs to.
    pub surface: u32,
    /// Which part of it, or which triangle.
    pub primitive: u32,
    /// Whether its back emits as well.
    pub two_sided: bool,
    /// How far off its points may be from where rays meet it, m.
    pub error: f64,
}

impl AreaLight {
    /// Where it is and how much it gives, if it emits `radiance` on average (W·sr⁻¹·m⁻²) and moves like that, if it does.
    pub(crate) fn bounds(&self, radiance: f32, motion: Option<&Motion>) -> LightBounds {
        let (bounds, cone) = self.shape.extent(self.two_sided);
        let turns = motion.is_some_and(|motion| motion.angle != 0.0);
        let growth = motion.map_or(1.0, |motion| motion.growth.max(1.0));
        LightBounds {
            bounds: bounds.moving(motion),
            cone: if turns { EmissionCone::EVERYWHERE } else { cone },
            intensity: radiance * (self.shape.widest() * growth * growth) as f32,
        }
    }

    /// A point of the light that sends light to `from`, picked by two numbers in 0..1. `moved`: where the light has moved to,
    /// turned and grown evenly to all sides, if it does.
    pub(crate) fn sample(
        &self,
        from: DVec3,
        u: DVec2,
        moved: Option<DAffine3>,
    ) -> Option<ShapeSample> {
        let sample = self.shape.sample(as_before(from, moved), u)?;
        self.shining(sample, from, moved)
    }

    /// What the first `count` points of a block see of it, as [`AreaLight::sample`] says of one, if it stands still.
    #[inline(always)]
    pub(crate) fn sample_all(
        &self,
        from: &Columns<f64>,
        u: &[Vec2; BLOCK],
        count: usize,
        into: &mut ShapeSamples,
    ) {
        self.shape.sample_all(from, u, count, into);
        if !self.two_sided {
            into.hide_backs();
        }
    }

    /// A sample of the shape before it moved, as one of the light; `None` if it sends no light to `from`.
    #[inline(always)]
    fn shining(
        &self,
        sample: ShapeSample,
        from: DVec3,
        moved: Option<DAffine3>,
    ) -> Option<ShapeSample> {
        let sample = match moved {
            None => sample,
            Some(moved) => sample.moved(from, &moved),
        };
        (self.two_sided || sample.normal.dot(sample.incoming) < 0.0).then_some(sample)
    }

    /// See [`LightShape::pdf`]; `moved` as for [`AreaLight::sample`].
    #[inline(always)]
    pub(crate) fn pdf(&self, from: DVec3, position: DVec3, moved: Option<DAffine3>) -> f64 {
        self.shape.pdf(as_before(from, moved), as_before(position, moved))
    }
}

/// A point where it was before everything moved.
#[inline(always)]
fn as_before(point: DVec3, moved: Option<DAffine3>) -> DVec3 {
    moved.map_or(point, |moved| moved.inverse().transform_point3(point))
}

/// All area lights, found by what a ray has met.
#[derive(Debug, Clone, Default)]
pub(crate) struct AreaLights {
    lights: Vec<AreaLight>,
    /// For each surface, the place of its first part in `index_of`.
    first: Vec<Option<u32>>,
    /// For each part of an emitting surface, its light.
    index_of: Vec<Option<u32>>,
}

impl AreaLights {
    /// Adds the next surface. `shapes` are its parts by number, those that can be sampled; none if it does not emit.
    /// Rays may meet them up to `error` off, m.
    pub(crate) fn push(&mut self, shapes: Vec<Option<LightShape>>, two_sided: bool, error: f64) {
        let surface = self.first.len() as u32;
        self.first.push((!shapes.is_empty()).then_some(self.index_of.len() as u32));
        for (primitive, shape) in shapes.into_iter().enumerate() {
            self.index_of.push(shape.map(|_| self.lights.len() as u32));
            let primitive = primitive as u32;
            let light =
                shape.map(|shape| AreaLight { shape, surface, primitive, two_sided, error });
            self.lights.extend(light);
        }
    }

    /// All of them.
    pub(crate) fn iter(&self) -> std::slice::Iter<'_, AreaLight> {
        self.lights.iter()
    }

    /// The light with this number.
    #[inline(always)]
    pub(crate) fn get(&self, number: u32) -> &AreaLight {
        &self.lights[number as usize]
    }

    /// The number of the light that part `primitive` of `surface` is; `None` if it is none.
    #[inline(always)]
    pub(crate) fn find(&self, surface: u32, primitive: u32) -> Option<u32> {
        let first = self.first[surface as usize]?;
        self.index_of[(first + primitive) as usize]
    }
}

/// The parts of an analytic surface as shapes of lights; `None` for those that cannot be sampled.
pub(crate) fn shapes(surface: &Analytic) -> Vec<Option<LightShape>> {
    let shape = |(piece, map): (Piece, _)| match piece {
        Piece::Sphere => LightShape::Ellipsoid(Ellipsoid::new(&map)),
        Piece::Disk => LightShape::Disk(EllipticDisk::new(&map)),
        Piece::Square => LightShape::Parallelogram(Parallelogram::new(&map)),
        Piece::CylinderSide => LightShape::CylinderSide(CylinderSide::new(&map)),
    };
    surface.pieces().into_iter().map(|piece| piece.map(shape)).collect()
}

impl ShapeSample {
    /// The same after the light has moved. What moves together is seen under the same angles, so that densities stay what
    /// they are.
    fn moved(self, from: DVec3, by: &DAffine3) -> Self {
        let position = by.transform_point3(self.position);
        Self {
            position,
            normal: by.transform_vector3(self.normal).normalize(),
            incoming: by.transform_vector3(self.incoming).normalize(),
            distance: position.distance(from),
            ..self
        }
    }

    /// The shadow ray from `start` that ends just before the light, up to `error` off, on the side that is seen.
    #[inline(always)]
    pub(crate) fn shadow_ray(&self, start: Vec3, t_min: f32, error: f64) -> Ray {
        let toward = if self.normal.dot(self.incoming) < 0.0 { self.normal } else { -self.normal };
        let (normal, position) = (toward.as_vec3(), self.position.as_vec3());
        let end = position + clearance(normal, position.abs() + start.abs(), error) * normal;
        let distance = (end - start).length();
        let t_max = distance * (1.0 - 4.0 * f32::EPSILON);
        Ray { t_min, t_max, ..Ray::new(start, (end - start) / distance) }
    }
}
