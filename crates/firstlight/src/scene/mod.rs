//! The scene: plain data with names, built once into something that can be asked what a ray hits.

mod build;
mod check;
mod choose;
pub mod description;
mod filter;
mod framing;
mod interaction;
mod lights;
mod material;
mod studio;
mod values;

pub(crate) use build::light_middle;
pub(crate) use filter::{Everything, Meets, OnlyPanes, SeenByCamera, Solid, StopsLight};
pub(crate) use framing::middle;
pub use framing::{bounds, frame};
pub(crate) use interaction::{LookAt, Points};
pub(crate) use lights::{LocalLight, LocalLights};
pub(crate) use material::{Boundary, Plain};
pub use studio::Studio;

use crate::bvh::World;
use crate::camera::Camera;
use crate::color::Rgb;
use crate::geometry::Cone;
use crate::shading::light::area::AreaLights;
use crate::shading::light::environment::{Environment, Sun};
use crate::shading::light::{Light, RoundLight};
use crate::shading::texture::Picture;
use crate::simd::Level;
use description::{FilmDescription, Integrator, LuminousEfficacy, Material, Medium, Shadows};

/// A scene ready to be traced. Made by [`Scene::build`]; nothing about it can fail from then on.
#[derive(Debug)]
pub struct Scene {
    pub(crate) world: World,
    /// Material of each surface.
    pub(crate) material_of: Vec<u32>,
    pub(crate) materials: Vec<Material>,
    /// What there is to know of each surface that is plain.
    plain: Vec<Option<Plain>>,
    /// Whether any of them lets shadow rays pass.
    pub(crate) has_panes: bool,
    /// Whether chance decides if any of them is there.
    pub(crate) has_blends: bool,
    /// Whether any of them encloses what light can be in.
    pub(crate) has_solids: bool,
    /// What is everywhere where no solid is.
    pub(crate) medium: Option<Medium>,
    pub(crate) pictures: Vec<Picture>,
    /// What a ray from the camera stands for.
    pub(crate) cone: Cone,
    /// All lights that come from one direction, in the file's order.
    pub(crate) lights: Vec<Light>,
    /// Spheres that shine in place of points.
    pub(crate) round_lights: Vec<RoundLight>,
    /// The surfaces that emit.
    pub(crate) area_lights: AreaLights,
    /// The lights of these three kinds that are somewhere.
    pub(crate) local_lights: LocalLights,
    /// Round lights infinitely far away.
    pub(crate) suns: Vec<Sun>,
    /// Of the lights, round lights and suns, their places in the description.
    pub(crate) light_numbers: Vec<u32>,
    pub(crate) round_numbers: Vec<u32>,
    pub(crate) sun_numbers: Vec<u32>,
    /// Light from directions that hit nothing, and whether the camera sees it.
    pub(crate) environment: Option<(Environment, bool)>,
    /// Whether nothing shines but points and what is as good as a point, and nothing mirrors: what the lecture has.
    pub(crate) is_lecture: bool,
    /// Sum of the ambient lights' radiance, W·sr⁻¹·m⁻².
    pub(crate) ambient: Rgb,
    /// Ambient lights that near surfaces keep out.
    pub(crate) near_ambient: Vec<NearAmbient>,
    pub(crate) background: Rgb,
    pub(crate) shadows: Shadows,
    pub(crate) integrator: Integrator,
    camera: Camera,
    film: FilmDescription,
    luminous_efficacy: LuminousEfficacy,
}

/// Ambient light that surfaces nearer than its reach keep out.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NearAmbient {
    /// Radiance from every open direction, W·sr⁻¹·m⁻².
    pub radiance: Rgb,
    /// m
    pub reach: f32,
    /// Its place in the description.
    pub number: u32,
}

impl Scene {
    /// The camera of the scene: the first of its description, or one that frames everything.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Resolution, samples, filter, exposure.
    pub fn film(&self) -> &FilmDescription {
        &self.film
    }

    /// Lumens per watt used to convert between photometric and radiometric units.
    pub fn luminous_efficacy(&self) -> LuminousEfficacy {
        self.luminous_efficacy
    }

    /// Whether anything moves, or the camera.
    pub fn moves(&self) -> bool {
        self.world.moves() || self.camera.moves()
    }

    /// Bytes that the trees over its surfaces take.
    pub fn tree_memory(&self) -> usize {
        self.world.memory()
    }

    /// The instructions that rays are traced with.
    pub fn level(&self) -> Level {
        self.world.level()
    }
}
