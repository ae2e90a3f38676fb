//! Lights that have an extent: which surfaces emit, and what.

use super::Scene;
use super::description::{
    Alpha, EnvironmentDescription, Material, Pattern, Pixels, Scattering, SceneDescription,
    Surface, Texture,
};
use crate::bvh::{MeshPart, Part, World};
use crate::color::Rgb;
use crate::geometry::{Hit, Ray};
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::light::area::{AreaLight, AreaLights, shapes};
use crate::shading::light::environment::{Aim, Environment};
use crate::shading::light::shape::{LightShape, ShapeSample, Triangle};
use crate::shading::light::tree::{LightTree, Reach};
use crate::shading::light::{Light, RoundLight};
use crate::shading::texture::{Role, texel};
use crate::simd::Level;
use glam::{DMat3, DVec4, Vec3, Vec4, Vec4Swizzles};
use std::sync::Arc;

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
            _ if !material.is_light() => (Vec::new(), 0.0),
            Part::Analytic(shape, _) => (shapes(shape), shape.error()),
            Part::Mesh(part) => (triangles(part), part.error()),
        };
        lights.push(shapes, material.double_sided && material.emits_behind, error);
    }
    lights
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

/// Radiance that a material emits on average over its picture, and over the channels, W·sr⁻¹·m⁻².
pub(super) fn mean_emission(material: &Material, images: &[Arc<Pixels>]) -> f32 {
    if !material.is_light() {
        return 0.0;
    }
    let Texture { factor, pattern, .. } = &material.emission;
    let pattern = match pattern {
        Pattern::Constant => Vec4::ONE,
        Pattern::Checker { colors: [a, b], .. }
        | Pattern::Gradient { colors: [a, b], .. }
        | Pattern::Noise { colors: [a, b], .. } => {
            0.5 * (Vec4::from_array(*a) + Vec4::from_array(*b))
        }
        Pattern::Image { image, .. } => mean(&images[*image]),
    };
    (Vec4::from_array(*factor) * pattern).xyz().element_sum() / 3.0
}

/// Mean linear RGBA of a picture.
fn mean(pixels: &Pixels) -> Vec4 {
    let count = pixels.width as usize * pixels.height as usize;
    let texels = (0..count).map(|i| texel(pixels, i, Role::Color).as_dvec4());
    (texels.sum::<DVec4>() / count as f64).as_vec4()
}

/// Lights that are somewhere, as opposed to everywhere or infinitely far away: those without extent in the order of
/// the scene's, then round ones, then those that surfaces are.
#[derive(Debug, Clone)]
pub(crate) struct LocalLights {
    /// Places of the lights without extent in [`Scene::lights`].
    pub(crate) points: Vec<u32>,
    /// Places of the others there, which are everywhere alike or infinitely far away.
    pub(crate) elsewhere: Vec<u32>,
    /// How many round lights there are.
    round: u32,
    count: u32,
    tree: LightTree,
}

/// One of [`LocalLights`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum LocalLight {
    /// Place in [`Scene::lights`].
    Point(u32),
    /// Place in [`Scene::round_lights`].
    Round(u32),
    /// Place in [`Scene::area_lights`].
    Area(u32),
}

impl LocalLights {
    /// `mean_emission` is that of a surface.
    pub(super) fn new(
        lights: &[Light],
        round_lights: &[RoundLight],
        area_lights: &AreaLights,
        level: Level,
        mean_emission: impl Fn(u32) -> f32,
        world: &World,
    ) -> Self {
        let is_somewhere = |place: &u32| lights[*place as usize].bounds().is_some();
        let (points, elsewhere) = (0..lights.len() as u32).partition::<Vec<_>, _>(is_somewhere);
        let mut bounds: Vec<_> = lights.iter().filter_map(Light::bounds).collect();
        bounds.extend(round_lights.iter().map(RoundLight::bounds));
        bounds.extend(
            area_lights.iter().map(|light| {
                light.bounds(mean_emission(light.surface), world.motion(light.surface))
            }),
        );
        let round = round_lights.len() as u32;
        Self {
            points,
            elsewhere,
            round,
            count: bounds.len() as u32,
            tree: LightTree::build(&bounds, level),
        }
    }

    /// How many there are.
    pub(crate) fn len(&self) -> u32 {
        self.count
    }

    /// One that may give light to a surface at `point` with the unit normal `normal`, picked by a number in 0..1, with
    /// the probability of that; `None` if none does.
    #[inline(always)]
    pub(crate) fn pick(&self, point: Vec3, normal: Vec3, u: f64) -> Option<(LocalLight, f32)> {
        let (number, probability) = self.tree.pick(point, normal, u)?;
        Some((self.light(number), probability))
    }

    /// The number of one that may give light to a medium along a ray, picked by a number in 0..1, with the probability of that.
    #[inline(always)]
    pub(crate) fn pick_along(&self, ray: &Ray, u: f64) -> Option<(u32, f32)> {
        self.tree.pick_along(ray, u)
    }

    /// The one with this number.
    #[inline(always)]
    pub(crate) fn light(&self, number: u32) -> LocalLight {
        let behind_points = number.wrapping_sub(self.points.len() as u32);
        match self.points.get(number as usize) {
            Some(&place) => LocalLight::Point(place),
            None if behind_points < self.round => LocalLight::Round(behind_points),
            None => LocalLight::Area(behind_points - self.round),
        }
    }

    /// Where the one with this number is and where it shines to.
    pub(crate) fn reach(&self, number: u32) -> Reach {
        self.tree.reach(number)
    }

    /// Probability with which [`LocalLights::pick`] picks an area light.
    #[inline(always)]
    pub(crate) fn probability(&self, point: Vec3, normal: Vec3, area_light: u32) -> f32 {
        let before = self.points.len() as u32 + self.round;
        self.tree.probability(point, normal, before + area_light)
    }
}

/// So many points the lecture sums. It takes a shadow ray for each, at every point; of more, one picked for all brings the
/// same light in a fraction of the time, if with noise.
const MOST_SUMMED: usize = 1024;

impl SceneDescription {
    /// Whether nothing shines but points and what is as good as a point, and not too many of them, nothing mirrors or moves,
    /// and the air is clear: what the lecture has.
    pub(crate) fn is_lecture(&self) -> bool {
        let plain = |surface: &Surface| {
            let material = &self.materials[surface.material];
            let cloudy = material.is_cloudy() || material.passes_light() && !material.is_pane();
            let mirrors = matches!(material.scattering, Scattering::Mirror { .. });
            !mirrors && !material.is_light() && !cloudy
        };
        let somewhere = self.lights.iter().filter(|light| light.light.position().is_some());
        somewhere.count() <= MOST_SUMMED
            && self.environment.is_none()
            && self.medium.is_none()
            && !self.lights.iter().any(|light| light.has_extent() || light.is_near_ambient())
            && !self.surfaces.iter().any(|surface| surface.motion.is_some())
            && self.surfaces.iter().all(plain)
    }

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
    Environment::new(&described.sky, described.factor, to_sky, Aim::Compensated)
}

impl Scene {
    /// Radiance that a surface emits along the unit vector `outgoing`, from the side that is seen, W·sr⁻¹·m⁻².
    #[inline(always)]
    pub(crate) fn emitted(
        &self,
        material: &Material,
        surface: &SurfaceInteraction,
        outgoing: Vec3,
    ) -> Rgb {
        let sides = surface.front || material.double_sided && material.emits_behind;
        if !material.emits() || !sides {
            return Rgb::ZERO;
        }
        self.through_coat(material, surface, outgoing)
            * self.evaluate(&material.emission, surface).xyz()
    }

    /// Radiance that a light emits from a sampled point along `incoming` reversed at a time, W·sr⁻¹·m⁻²; less where it is
    /// partly transparent.
    #[inline(always)]
    pub(crate) fn emitted_by(&self, light: &AreaLight, sample: ShapeSample, time: f32) -> Rgb {
        let even = self.even_emission(light);
        even.unwrap_or_else(|| self.emitted_there(light, sample, time))
    }

    /// The same, if it is alike from everywhere and to everywhere.
    #[inline(always)]
    pub(crate) fn even_emission(&self, light: &AreaLight) -> Option<Rgb> {
        let material = &self.materials[self.material_of[light.surface as usize] as usize];
        let constant = material.emission.is_constant() && material.alpha == Alpha::Opaque;
        let even = constant && material.coat().is_none();
        even.then(|| Vec3::from_slice(&material.emission.factor))
    }

    /// The same where it is not alike everywhere.
    #[inline(never)]
    fn emitted_there(&self, light: &AreaLight, sample: ShapeSample, time: f32) -> Rgb {
        let material = &self.materials[self.material_of[light.surface as usize] as usize];
        let surface = self.at_sample(light, &sample, time);
        let alpha = || self.alpha(material, &surface);
        let there = match material.alpha {
            Alpha::Opaque => 1.0,
            Alpha::Mask { cutoff } => f32::from(alpha() >= cutoff),
            Alpha::Blend => alpha().clamp(0.0, 1.0),
        };
        there * self.emitted(material, &surface, -sample.incoming.as_vec3())
    }

    /// The sampled point as if a ray had met it.
    fn at_sample(&self, light: &AreaLight, sample: &ShapeSample, time: f32) -> SurfaceInteraction {
        let origin = (sample.position - sample.distance * sample.incoming).as_vec3();
        let [u, v] = self.barycentrics(light, sample, time);
        let AreaLight { surface, primitive, .. } = *light;
        let hit = Hit { t: sample.distance as f32, u, v, surface, primitive };
        self.interaction(&Ray { time, ..Ray::new(origin, sample.incoming.as_vec3()) }, &hit)
    }

    /// Weights of the second and third corner of a mesh's triangle at a sampled point.
    fn barycentrics(&self, light: &AreaLight, sample: &ShapeSample, time: f32) -> [f32; 2] {
        let part = self.world.part(light.surface, time);
        let Part::Mesh(part) = &*part else { return [0.0; 2] };
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
