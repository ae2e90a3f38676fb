//! The lecture's first lesson: the goal of shading depends on the purpose. Three of them, each made of the same stages.

use crate::color::{Rgb, View};
use crate::scene::bounds;
use crate::scene::description::{
    CameraLightAmount, Exposure, Integrator, Light, LightDescription, SceneDescription, Section,
};
use glam::DVec3;
use std::f32::consts::PI;

/// A purpose.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Look {
    /// Visualization and CAD: shape above all. A light at the camera, darker narrow places, lines at edges, colours as they
    /// are, no cast shadows.
    Clarity,
    /// Animation and games: direct light with soft shadows, and ambient light that does not reach into corners.
    Balanced,
    /// Effects and advertising: every way that light takes.
    Real,
}

/// Near surfaces keep out the sky, as a part of the scene's size.
const REACH: f64 = 0.1;
/// Width of lines, pixels.
const LINES: f64 = 1.0;
/// Of the light that falls on the middle of the scene, what ambient light makes up for.
const AMBIENT: f32 = 0.2;
/// Lamps that hang nearer to the middle than this part of half of the scene's diagonal count as if they were so far from it. In a
/// cube whose walls reflect half, they give Φ/A in all directions by reflection (the integrating sphere): that is what [`AMBIENT`]
/// makes of √(8 · 0.2 / 4π).
const NEAREST: f64 = 0.357;

impl Look {
    /// Their names, as users write them.
    pub const NAMES: [(&str, Self); 3] =
        [("clarity", Self::Clarity), ("balanced", Self::Balanced), ("real", Self::Real)];

    /// Makes `scene` look so. For clarity, what lies before `section` is cut away.
    pub fn apply(self, scene: &mut SceneDescription, section: Option<Section>) {
        match self {
            Self::Clarity => clarity(scene, section),
            Self::Balanced => balanced(scene),
            Self::Real => scene.integrator = Integrator::Path { bounces: None },
        }
    }
}

fn clarity(scene: &mut SceneDescription, section: Option<Section>) {
    scene.integrator = Integrator::Clarity { distance: reach(scene), lines: LINES, section };
    scene.film.exposure = Exposure::Ev(0.0);
    scene.film.view = View::Srgb;
    if scene.background == Rgb::ZERO || scene.environment.is_some() {
        scene.background = Rgb::ONE;
    }
}

fn balanced(scene: &mut SceneDescription) {
    scene.integrator = Integrator::Direct;
    let is_ambient = |light: &LightDescription| matches!(light.light, Light::Ambient { .. });
    let radiance = AMBIENT / PI * irradiance_in_the_middle(scene);
    if !scene.lights.iter().any(is_ambient) && radiance != Rgb::ZERO {
        let light = Light::Ambient { radiance, reach: reach(scene) };
        scene.lights.push(LightDescription::new("ambient", light));
    }
}

/// How near surfaces have to be to keep out the sky, m.
fn reach(scene: &SceneDescription) -> f64 {
    match scene.integrator {
        Integrator::AmbientOcclusion { distance } if distance.is_finite() => distance,
        _ => bounds(scene).map_or(1.0, |[lo, hi]| REACH * (hi - lo).length().max(1e-6)),
    }
}

/// What the lights would give to surfaces that face them in the middle of the scene, were nothing in the way, W·m⁻².
fn irradiance_in_the_middle(scene: &SceneDescription) -> Rgb {
    let size = bounds(scene).map_or(1.0, |[lo, hi]| (0.5 * (hi - lo).length()).max(1e-6));
    let middle = bounds(scene).map_or(DVec3::ZERO, |[lo, hi]| 0.5 * (lo + hi));
    let near = |position: DVec3, intensity: Rgb| {
        intensity / position.distance_squared(middle).max((NEAREST * size).powi(2)) as f32
    };
    let of = |light: &LightDescription| match light.light {
        Light::Point { position, intensity } | Light::Spot { position, intensity, .. } => {
            near(position, intensity)
        }
        Light::Photometric { position, ref web, factor, .. } => {
            near(position, factor * web.brightest())
        }
        Light::Directional { irradiance, .. }
        | Light::Sun { irradiance, .. }
        | Light::Camera { amount: CameraLightAmount::Irradiance(irradiance) } => irradiance,
        Light::Camera { amount: CameraLightAmount::Intensity(_) } | Light::Ambient { .. } => {
            Rgb::ZERO
        }
    };
    let surfaces = scene.surfaces.iter().filter_map(|surface| {
        let material = &scene.materials[surface.material];
        let [r, g, b, _] = material.emission.factor;
        let radiance = Rgb::new(r, g, b);
        let area = material.is_light().then(|| scene.emitting_area(surface)).flatten()?;
        // Wherever it is, it is about that far away.
        Some(radiance * (area / (size * size)) as f32)
    });
    scene.lights.iter().map(of).chain(surfaces).sum()
}
