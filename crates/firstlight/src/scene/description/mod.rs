//! A scene as plain data, fully loaded: what every reader produces and `Scene` is built from.
//!
//! Lengths are metres, angles radians, light is radiometric SI per colour channel (linear Rec. 709), whatever
//! the file said. World space is right-handed. References between parts are indices into the vectors of
//! [`SceneDescription`]; whoever makes one keeps them in range and every value finite ([`SceneDescription::check`]).

mod environment;
mod fingerprint;
mod light;
mod material;
mod medium;
mod mesh;
mod motion;
mod photometry;
mod place;
mod shape;
mod view;

pub use environment::{EnvironmentDescription, Sky};
pub use light::{CameraLightAmount, Light, LightDescription, SpotFalloff};
pub use material::{
    Alpha, BumpAmount, BumpMap, ComplexIndex, Facets, Interior, Material, NormalMap, OcclusionMap,
    Pattern, Pixels, Principled, Sampling, Scalar, Scattering, Texels, Texture, UvTransform, Wrap,
};
pub use medium::Medium;
pub use mesh::Mesh;
pub use motion::Motion;
pub use photometry::{Goniometer, PhotometricWeb};
pub use place::Part;
pub use shape::{Block, Cone, Cylinder, Disk, Plane, Quad, Shape, Sphere, Surface};
pub use view::{
    CameraDescription, CameraPose, CameraSettings, Exposure, FilmDescription, Filter, Integrator,
    Projection, Section, Shadows,
};

use crate::color::Rgb;
use glam::DVec3;
use std::sync::Arc;

/// A whole scene, loaded and in SI units. Models are scenes too: see [`SceneDescription::place`].
#[derive(Debug, Clone, Default)]
pub struct SceneDescription {
    /// What is up, for a camera that has to be chosen.
    pub up: Up,
    /// The cameras, the one to use first. Empty: a camera is chosen that frames everything.
    pub cameras: Vec<CameraDescription>,
    /// Resolution, samples, filter, exposure.
    pub film: FilmDescription,
    /// How light is gathered.
    pub integrator: Integrator,
    /// How shadow rays are kept from hitting the surface they leave.
    pub shadows: Shadows,
    /// Radiance of directions that hit nothing, W·sr⁻¹·m⁻². It lights nothing.
    pub background: Rgb,
    /// Light from directions that hit nothing.
    pub environment: Option<EnvironmentDescription>,
    /// What is everywhere where no solid is; `None`: nothing.
    pub medium: Option<Medium>,
    /// Lumens per watt used to convert between photometric and radiometric units.
    pub luminous_efficacy: LuminousEfficacy,
    /// Decoded pictures that textures refer to.
    pub images: Vec<Arc<Pixels>>,
    /// Materials that surfaces refer to.
    pub materials: Vec<Material>,
    /// Triangle meshes that surfaces refer to; one used by several surfaces is stored once.
    pub meshes: Vec<Arc<Mesh>>,
    /// Everything that can be hit.
    pub surfaces: Vec<Surface>,
    /// Everything that gives light.
    pub lights: Vec<LightDescription>,
    /// The surface that was laid under what is to be shown, and is no part of it: a studio's ground.
    pub ground: Option<usize>,
}

/// The unit vector that points up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Up(pub DVec3);

impl Default for Up {
    /// z.
    fn default() -> Self {
        Self(DVec3::Z)
    }
}

/// Lumens per watt, the one number that ties photometric to radiometric units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LuminousEfficacy(pub f64);

impl Default for LuminousEfficacy {
    /// 683 lm/W, the constant K_cd of the SI definition of the candela.
    fn default() -> Self {
        Self(683.0)
    }
}
