//! What lights give: the irradiance they cause at a point, and from which direction.

pub(crate) mod area;
pub(crate) mod environment;
mod round;
pub(crate) mod shape;
pub(crate) mod tree;
mod web;

use crate::color::Rgb;
use crate::geometry::{Bounds, Ray};
use crate::math::{BLOCK, Columns};
pub(crate) use round::RoundLight;

use crate::scene::description::{PhotometricWeb, SpotFalloff};
use glam::{DMat3, DVec3, Vec3};
use std::sync::Arc;
use tree::{EmissionCone, LightBounds};

/// A light that reaches a point from one direction.
#[derive(Debug, Clone)]
pub(crate) struct Light {
    /// Where the light comes from.
    pub source: Source,
    /// Whether surfaces in between stop it.
    pub shadows: bool,
}

/// Where light comes from.
#[derive(Debug, Clone)]
pub(crate) enum Source {
    /// A point; `intensity` in W·sr⁻¹.
    Point { position: DVec3, intensity: Rgb },
    /// A point that shines into a cone; `intensity` in W·sr⁻¹ on its axis.
    Spot { position: DVec3, intensity: Rgb, cone: Cone },
    /// A point that gives what was measured; `factor` in W·sr⁻¹·cd⁻¹.
    Photometric { position: DVec3, to_luminaire: DMat3, web: Arc<PhotometricWeb>, factor: Rgb },
    /// Infinitely far away, in the unit direction `toward`; `irradiance` in W·m⁻².
    Directional { toward: Vec3, irradiance: Rgb },
    /// At a point, but of the same strength at any distance; `irradiance` in W·m⁻².
    Headlight { position: DVec3, irradiance: Rgb },
}

/// A light as one point receives it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LightSample {
    /// Unit vector to the light.
    pub incoming: Vec3,
    /// Distance to the light, m; infinite if it has none.
    pub distance: f32,
    /// Irradiance of a surface that faces the light, W·m⁻².
    pub irradiance: Rgb,
}

/// What a block of points receives of a light; see [`LightSample`].
#[derive(Debug, Clone)]
pub(crate) struct LightSamples {
    incoming: Columns<f32>,
    distance: [f32; BLOCK],
    irradiance: Columns<f32>,
}

impl Default for LightSamples {
    fn default() -> Self {
        let (incoming, irradiance) = (Columns::default(), Columns::default());
        Self { incoming, distance: [0.0; BLOCK], irradiance }
    }
}

impl LightSamples {
    /// What point `k` receives; where that is nothing, it is black.
    #[inline(always)]
    pub(crate) fn get(&self, k: usize) -> LightSample {
        LightSample {
            incoming: self.incoming.get(k),
            distance: self.distance[k],
            irradiance: self.irradiance.get(k),
        }
    }

    #[inline(always)]
    fn set(&mut self, k: usize, sample: Option<LightSample>) {
        let sample = sample.unwrap_or(LightSample::NOTHING);
        self.incoming.set(k, sample.incoming);
        self.distance[k] = sample.distance;
        self.irradiance.set(k, sample.irradiance);
    }
}

impl Light {
    /// What reaches the first `count` of `points`, as [`Light::sample`] says.
    #[inline(always)]
    pub(crate) fn sample_all(&self, points: &Columns<f64>, count: usize, into: &mut LightSamples) {
        if let Source::Point { position, intensity } = self.source {
            for k in 0..BLOCK {
                into.set(k, from_point(position, intensity, points.get(k)));
            }
        } else {
            for k in 0..count {
                into.set(k, self.sample(points.get(k)));
            }
        }
    }

    /// Where it is and how much it gives; `None` if it is everywhere alike.
    pub(crate) fn bounds(&self) -> Option<LightBounds> {
        let everywhere = EmissionCone::EVERYWHERE;
        let (position, intensity, cone) = match &self.source {
            Source::Point { position, intensity } => (position, *intensity, everywhere),
            Source::Spot { position, intensity, cone } => (position, *intensity, cone.emission()),
            Source::Photometric { position, web, factor, .. } => {
                (position, *factor * web.brightest(), everywhere)
            }
            Source::Directional { .. } | Source::Headlight { .. } => return None,
        };
        let bounds = Bounds::around([position.as_vec3()]);
        Some(LightBounds { bounds, cone, intensity: intensity.element_sum() / 3.0 })
    }

    /// What reaches `point`; `None` if nothing does. In double precision, since near the rim of a spot a rounding
    /// error of the place would show.
    #[inline(always)]
    pub(crate) fn sample(&self, point: DVec3) -> Option<LightSample> {
        match &self.source {
            Source::Point { position, .. }
            | Source::Spot { position, .. }
            | Source::Photometric { position, .. } => {
                let intensity = self.source.intensity(point - position);
                (intensity != Rgb::ZERO).then(|| from_point(*position, intensity, point))?
            }
            Source::Directional { toward, irradiance } => Some(LightSample {
                incoming: *toward,
                distance: f32::INFINITY,
                irradiance: *irradiance,
            }),
            Source::Headlight { position, irradiance } => {
                let sample = from_point(*position, *irradiance, point)?;
                Some(LightSample { irradiance: *irradiance, ..sample })
            }
        }
    }
}

impl Source {
    /// Where it is, m; `None` if it is infinitely far away or everywhere alike.
    fn position(&self) -> Option<DVec3> {
        match self {
            Self::Point { position, .. }
            | Self::Spot { position, .. }
            | Self::Photometric { position, .. } => Some(*position),
            Self::Directional { .. } | Self::Headlight { .. } => None,
        }
    }

    /// Radiant intensity in a direction of any length, W·sr⁻¹; none if it is infinitely far away.
    #[inline(always)]
    fn intensity(&self, direction: DVec3) -> Rgb {
        match self {
            Self::Point { intensity, .. } => *intensity,
            Self::Spot { intensity, cone, .. } => *intensity * cone.share(direction),
            Self::Photometric { to_luminaire, web, factor, .. } => {
                *factor * web.intensity(*to_luminaire * direction.normalize())
            }
            Self::Directional { .. } | Self::Headlight { .. } => Rgb::ZERO,
        }
    }
}

impl LightSample {
    /// No light, from nowhere.
    const NOTHING: Self = Self { incoming: Vec3::ZERO, distance: 0.0, irradiance: Rgb::ZERO };

    /// The shadow ray from `origin`, which is near `point`, that ends just before the light.
    #[inline(always)]
    pub(crate) fn ray_from(&self, point: Vec3, origin: Vec3, t_min: f32) -> Ray {
        let endless = self.distance == f32::INFINITY;
        let to_light = self.incoming * self.distance + (point - origin);
        let distance = to_light.length();
        let direction = to_light * distance.recip();
        let t_max = distance * (1.0 - 4.0 * f32::EPSILON);
        Ray {
            direction: if endless { self.incoming } else { direction },
            t_min,
            t_max: if endless { f32::INFINITY } else { t_max },
            ..Ray::new(origin, direction)
        }
    }
}

/// The lecture's E = I / r²: intensity × geometry factor. Places are subtracted in double precision.
#[inline(always)]
fn from_point(position: DVec3, intensity: Rgb, point: DVec3) -> Option<LightSample> {
    let to_light = (position - point).as_vec3();
    let distance = to_light.length();
    let nearness = distance.recip();
    let (incoming, irradiance) = (to_light * nearness, intensity * nearness * nearness);
    incoming.is_finite().then_some(LightSample { incoming, distance, irradiance })
}

/// The cone of a spot.
#[derive(Debug, Clone)]
pub(crate) struct Cone {
    axis: DVec3,
    cos_inner: f64,
    cos_outer: f64,
    falloff: SpotFalloff,
}

impl Cone {
    /// A cone along the unit vector `axis`, with half angles in rad.
    pub(crate) fn new(axis: DVec3, inner: f64, outer: f64, falloff: SpotFalloff) -> Self {
        Self { axis, cos_inner: inner.cos(), cos_outer: outer.cos(), falloff }
    }

    fn emission(&self) -> EmissionCone {
        let falloff = self.cos_outer.acos() as f32;
        EmissionCone { axis: self.axis.as_vec3(), spread: 0.0, falloff, two_sided: false }
    }

    /// The fraction of the axis's intensity that goes in `direction`, 0..1.
    fn share(&self, direction: DVec3) -> f32 {
        let cos = direction.dot(self.axis) / direction.length();
        let ramp = ((cos - self.cos_outer) / (self.cos_inner - self.cos_outer)).clamp(0.0, 1.0);
        let share = match self.falloff {
            _ if cos >= self.cos_inner => 1.0,
            SpotFalloff::Gltf => ramp * ramp,
            SpotFalloff::Smoothstep => ramp * ramp * (3.0 - 2.0 * ramp),
        };
        share as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spot(falloff: SpotFalloff) -> Light {
        let cone = Cone::new(DVec3::X, 20_f64.to_radians(), 40_f64.to_radians(), falloff);
        let source = Source::Spot { position: DVec3::ZERO, intensity: Rgb::splat(100.0), cone };
        Light { source, shadows: true }
    }

    fn irradiance_at(light: &Light, degrees: f64) -> f32 {
        let (sin, cos) = degrees.to_radians().sin_cos();
        light.sample(DVec3::new(cos, sin, 0.0)).map_or(0.0, |s| s.irradiance.x)
    }

    #[test]
    fn a_spot_with_equal_angles_has_a_hard_edge() {
        let cone = Cone::new(DVec3::X, 0.5, 0.5, SpotFalloff::Gltf);
        assert_eq!(cone.share(DVec3::new(0.49_f64.cos(), 0.49_f64.sin(), 0.0)), 1.0);
        assert_eq!(cone.share(DVec3::new(0.51_f64.cos(), 0.51_f64.sin(), 0.0)), 0.0);
    }

    #[test]
    fn spots_fall_off_monotonously_to_nothing() {
        for falloff in [SpotFalloff::Gltf, SpotFalloff::Smoothstep] {
            let light = spot(falloff);
            let values: Vec<_> = (0..60).map(|t| irradiance_at(&light, f64::from(t))).collect();
            assert!(values.is_sorted_by(|a, b| *a >= *b - 1e-4));
            assert_eq!((values[41], values[59]), (0.0, 0.0));
        }
    }

    #[test]
    fn a_light_at_the_point_itself_gives_nothing() {
        let source = Source::Point { position: DVec3::ONE, intensity: Rgb::ONE };
        assert_eq!(Light { source, shadows: true }.sample(DVec3::ONE), None);
    }
}
