//! Points that are given an extent: a sphere of the same intensity, for soft shadows.

use super::tree::LightBounds;
use super::{Light, LightSample, Source};
use crate::geometry::Bounds;
use crate::shading::light::shape::Ellipsoid;
use glam::{DAffine3, DVec2, DVec3, Vec3};
use std::f64::consts::PI;

/// A sphere around a point light, spot or measured luminaire. From each of its points light goes in every direction as from
/// the middle, spread over the disk that is seen from there: from afar, nothing tells it from the point.
#[derive(Debug, Clone)]
pub(crate) struct RoundLight {
    source: Source,
    bounds: LightBounds,
    sphere: Ellipsoid,
    /// Area of the disk that is seen from afar, m².
    disk: f64,
}

impl RoundLight {
    /// A sphere of `radius` (m, more than 0) around `light`; `None` if that is nowhere in particular.
    pub(crate) fn new(light: &Light, radius: f64) -> Option<Self> {
        let at = light.bounds()?;
        let reach = Vec3::splat(radius as f32);
        let bounds = Bounds { lo: at.bounds.lo - reach, hi: at.bounds.hi + reach };
        let map = DAffine3::from_scale(DVec3::splat(radius));
        let to_world = DAffine3 { translation: light.source.position()?, ..map };
        Some(Self {
            source: light.source.clone(),
            bounds: LightBounds { bounds, ..at },
            sphere: Ellipsoid::new(&to_world),
            disk: PI * radius * radius,
        })
    }

    /// Where it is and how much it gives.
    pub(crate) fn bounds(&self) -> LightBounds {
        self.bounds
    }

    /// A point of the sphere that `point` sees, picked by two numbers in 0..1, with the irradiance that stands for the whole
    /// sphere's; `None` if nothing comes from there.
    #[inline(always)]
    pub(crate) fn sample(&self, point: DVec3, u: DVec2) -> Option<LightSample> {
        let seen = self.sphere.sample(point, u)?;
        let irradiance = self.source.intensity(-seen.incoming) / (self.disk * seen.pdf) as f32;
        let outside = seen.normal.dot(seen.incoming) < 0.0;
        let (incoming, distance) = (seen.incoming.as_vec3(), seen.distance as f32);
        outside.then_some(LightSample { incoming, distance, irradiance })
    }
}
