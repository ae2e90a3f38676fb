//! Where light comes from, and what that is called.

use crate::scene::description::{Light, LightDescription, SceneDescription};

/// Where light that reaches the eye set out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) enum Source {
    /// The light with this place in the description.
    Light(u32),
    /// The surface with this place in the description, which emits.
    Surface(u32),
    /// The environment, or the sky that ambient occlusion looks for.
    Environment,
    /// All ambient lights.
    Ambient,
    /// What lies behind everything and shines on nothing.
    Background,
    /// No light of the scene: what a look shows it by.
    Look,
}

impl Source {
    /// The name that the scene gives it.
    pub(crate) fn name(self, scene: &SceneDescription) -> String {
        let named = |name: &str, kind: &str, number: u32| match name {
            "" => format!("{kind} {number}"),
            name => name.to_owned(),
        };
        match self {
            Self::Light(light) => named(&scene.lights[light as usize].name, "light", light),
            Self::Surface(surface) => {
                named(&scene.surfaces[surface as usize].name, "surface", surface)
            }
            Self::Environment => "environment".into(),
            Self::Ambient => ambient(scene),
            Self::Background => "background".into(),
            Self::Look => "clarity".into(),
        }
    }

    /// What kind of thing it is.
    pub(crate) fn kind(self, scene: &SceneDescription) -> &'static str {
        match self {
            Self::Light(light) => match scene.lights[light as usize].light {
                Light::Point { .. } => "point",
                Light::Spot { .. } => "spot",
                Light::Photometric { .. } => "photometric",
                Light::Directional { .. } => "directional",
                Light::Sun { .. } => "sun",
                Light::Ambient { .. } => "ambient",
                Light::Camera { .. } => "camera",
            },
            Self::Surface(_) => "surface",
            Self::Environment => "environment",
            Self::Ambient => "ambient",
            Self::Background => "background",
            Self::Look => "look",
        }
    }
}

/// The name of the only ambient light, or what they are together.
fn ambient(scene: &SceneDescription) -> String {
    let is_ambient = |light: &&LightDescription| {
        matches!(light.light, Light::Ambient { reach: f64::INFINITY, .. })
    };
    let mut all = scene.lights.iter().filter(is_ambient);
    match (all.next(), all.next()) {
        (Some(only), None) if !only.name.is_empty() => only.name.clone(),
        _ => "ambient".into(),
    }
}
