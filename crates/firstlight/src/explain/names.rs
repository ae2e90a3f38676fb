//! What things are called.

use crate::integrator::Source;
use crate::scene::description::{Light, SceneDescription};

/// The names that the description gives.
pub(super) struct Names<'a>(&'a SceneDescription);

impl<'a> Names<'a> {
    pub(super) fn new(description: &'a SceneDescription) -> Self {
        Self(description)
    }

    pub(super) fn surface(&self, surface: u32) -> String {
        let name = &self.0.surfaces[surface as usize].name;
        if name.is_empty() { format!("surface {surface}") } else { name.clone() }
    }

    pub(super) fn material(&self, surface: u32) -> String {
        self.0.materials[self.0.surfaces[surface as usize].material].name.clone()
    }

    /// The name of what light comes from.
    pub(super) fn source(&self, source: Source) -> String {
        match source {
            Source::Light(light) => {
                let name = &self.0.lights[light as usize].name;
                if name.is_empty() { format!("light {light}") } else { name.clone() }
            }
            Source::Surface(surface) => self.surface(surface),
            Source::Environment => "environment".into(),
            Source::Ambient => self.ambient(),
            Source::Background => "background".into(),
        }
    }

    /// What kind of thing it is.
    pub(super) fn kind(&self, source: Source) -> &'static str {
        let Source::Light(light) = source else {
            return match source {
                Source::Surface(_) => "surface",
                Source::Environment => "environment",
                Source::Ambient => "ambient",
                _ => "background",
            };
        };
        match self.0.lights[light as usize].light {
            Light::Point { .. } => "point",
            Light::Spot { .. } => "spot",
            Light::Photometric { .. } => "photometric",
            Light::Directional { .. } => "directional",
            Light::Sun { .. } => "sun",
            Light::Ambient { .. } => "ambient",
            Light::Camera { .. } => "camera",
        }
    }

    /// The only ambient light, or all of them.
    fn ambient(&self) -> String {
        let is_ambient = |light: &&crate::scene::description::LightDescription| {
            matches!(light.light, Light::Ambient { .. })
        };
        let mut all = self.0.lights.iter().filter(is_ambient);
        match (all.next(), all.next()) {
            (Some(only), None) if !only.name.is_empty() => only.name.clone(),
            _ => "ambient".into(),
        }
    }
}
