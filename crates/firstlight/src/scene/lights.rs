//! Lights that have an extent: which surfaces emit, and what.

use super::Scene;
use super::description::{Alpha, EnvironmentDescription, Material, SceneDescription, Surface};
use crate::bvh::{MeshPart, Part, World};
use crate::color::Rgb;
use crate::geometry::{Hit, Ray};
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::light::area::{AreaLight, AreaLights, shapes};
use crate::shading::light::environment::{Aim, Environment};
use crate::shading::light::shape::{LightShape, ShapeSample, Triangle};
use glam::{DMat3, Vec3, Vec4Swizzles};

/// The lights that the surfaces are.
pub(super) fn area_lights(
    world: &World,
    material_of: &[u32],
    materials: &[Material],
) -> AreaLights {
    let mut lights = AreaLights::default();
    for (part, &material) in world.parts().iter().zip(material_of) {
        let material = &materials[material as usize];
        let (shapes, error) = match part {
            _ if !emits(material) => (Vec::new(), 0.0),
            Part::Analytic(shape, _) => (shapes(shape), shape.error()),
            Part::Mesh(part) => (triangles(part), part.error()),
        };
        lights.push(shapes, material.double_sided && material.emits_behind, error);
    }
    lights
}

fn emits(material: &Material) -> bool {
    let [r, g, b, _] = material.emission.factor;
    r.max(g).max(b) > 0.0
}

/// Triangles in the world, their fronts where the file has them.
fn triangles(part: &MeshPart) -> Vec<Option<LightShape>> {
    let turned = part.to_world.matrix3.determinant() < 0.0;
    let triangle = |primitive| {
        let in_world = |corner: Vec3| match part.instanced {
            true => part.to_world.transform_point3(corner.as_dvec3()),
            false => corner.as_dvec3(),
        };
        let [a, b, c] = part.corners(primitive).map(in_world);
        Some(LightShape::Triangle(Triangle::new(if turned { [a, c, b] } else { [a, b, c] })))
    };
    (0..part.mesh.triangles.len() as u32).map(triangle).collect()
}

impl SceneDescription {
    /// Area of a surface, one side, m²; `None` if it has no end, or is a part of a cone.
    pub(crate) fn emitting_area(&self, surface: &Surface) -> Option<f64> {
        let shapes = match super::build::part(self, surface, &|_| false) {
            Part::Analytic(shape, _) => shapes(&shape),
            Part::Mesh(part) => triangles(&part),
        };
        shapes.iter().map(|shape| shape.as_ref().map(LightShape::area)).sum()
    }
}

/// The environment, ready to be sampled where other techniques look for it too.
pub(super) fn environment(described: &EnvironmentDescription) -> Environment {
    let to_sky = DMat3::from_quat(described.rotation).transpose().as_mat3();
    Environment::new(described.sky.clone(), described.factor, to_sky, Aim::Compensated)
}

impl Scene {
    /// Radiance that a surface emits towards where it is seen from, W·sr⁻¹·m⁻².
    #[inline(always)]
    pub(crate) fn emitted(&self, material: &Material, surface: &SurfaceInteraction) -> Rgb {
        if !emits(material) || !(surface.front || material.double_sided && material.emits_behind) {
            return Rgb::ZERO;
        }
        self.evaluate(&material.emission, surface).xyz()
    }

    /// Radiance that a light emits from a sampled point along `incoming` reversed, W·sr⁻¹·m⁻²; less where it is partly
    /// transparent.
    #[inline(always)]
    pub(crate) fn emitted_by(&self, light: &AreaLight, sample: &ShapeSample) -> Rgb {
        let material = &self.materials[self.material_of[light.surface as usize] as usize];
        let constant = material.emission.is_constant() && material.alpha == Alpha::Opaque;
        if constant {
            return Vec3::from_slice(&material.emission.factor);
        }
        let surface = self.at_sample(light, sample);
        let alpha = || self.evaluate(&material.reflectance, &surface).w;
        let there = match material.alpha {
            Alpha::Opaque => 1.0,
            Alpha::Mask { cutoff } => f32::from(alpha() >= cutoff),
            Alpha::Blend => alpha().clamp(0.0, 1.0),
        };
        there * self.emitted(material, &surface)
    }

    /// The sampled point as if a ray had met it.
    fn at_sample(&self, light: &AreaLight, sample: &ShapeSample) -> SurfaceInteraction {
        let origin = (sample.position - sample.distance * sample.incoming).as_vec3();
        let [u, v] = self.barycentrics(light, sample);
        let AreaLight { surface, primitive, .. } = *light;
        let hit = Hit { t: sample.distance as f32, u, v, surface, primitive };
        self.interaction(&Ray::new(origin, sample.incoming.as_vec3()), &hit)
    }

    /// Weights of the second and third corner of a mesh's triangle at a sampled point.
    fn barycentrics(&self, light: &AreaLight, sample: &ShapeSample) -> [f32; 2] {
        let Part::Mesh(part) = &self.world.parts()[light.surface as usize] else { return [0.0; 2] };
        let local = match part.instanced {
            true => part.to_object.transform_point3(sample.position),
            false => sample.position,
        };
        let [a, b, c] = part.corners(light.primitive).map(Vec3::as_dvec3);
        let (along, normal) = (local - a, (b - a).cross(c - a));
        let share = |edge: glam::DVec3| (edge.dot(normal) / normal.length_squared()) as f32;
        [share(along.cross(c - a)), share((b - a).cross(along))]
    }
}
