//! What there is to know about a picture besides its colour, pixel by pixel: light by where it came from, and what the
//! camera saw.
//!
//! Light is gathered with the picture's own samples, so that its layers add up to the picture. Data (depth, normals,
//! numbers of surfaces) is that of the middle of each pixel, never a mean of several surfaces.

mod crypto;
mod data;
mod guides;
mod light;

pub use crypto::CryptoNames;
pub use data::data_layers;
pub(crate) use data::meet;
pub use guides::Guides;
pub use light::{LightLayers, layer_name};
pub(crate) use light::{LightTile, Taken, sources};

use std::str::FromStr;

/// One channel of a picture, row by row from the top.
#[derive(Debug, Clone, PartialEq)]
pub enum Plane {
    /// Numbers.
    Numbers(Vec<f32>),
    /// Whole numbers.
    Whole(Vec<u32>),
}

/// A channel with its name, such as `N.X`.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// Its name in a file: that of its layer, a dot, and that of the channel.
    pub name: String,
    /// Its values.
    pub plane: Plane,
}

impl Channel {
    fn numbers(name: impl Into<String>, values: impl Iterator<Item = f32>) -> Self {
        Self { name: name.into(), plane: Plane::Numbers(values.collect()) }
    }

    fn whole(name: impl Into<String>, values: impl Iterator<Item = u32>) -> Self {
        Self { name: name.into(), plane: Plane::Whole(values.collect()) }
    }
}

/// A layer that can be asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Layer {
    /// `Z`: distance along the camera's axis, m; infinite where nothing is.
    Depth,
    /// `distance`: along the ray, m; infinite where nothing is.
    Distance,
    /// `P.X P.Y P.Z`: place, m.
    Position,
    /// `N.X N.Y N.Z`: unit normal that light is reckoned with, on the side of the camera.
    Normal,
    /// `Ng.X Ng.Y Ng.Z`: unit normal of the surface as it is.
    GeoNormal,
    /// `uv.U uv.V`: texture coordinates.
    Uv,
    /// `albedo.R G B`: the fraction of light that is scattered.
    Albedo,
    /// `roughness`: perceptual, 0..1; 1 for matte surfaces.
    Roughness,
    /// `object`: number of the surface from 1; 0: none.
    Object,
    /// `material`: number of the material from 1; 0: none.
    Material,
    /// `primitive`: number of the triangle or part from 1; 0: none.
    Primitive,
    /// `instance`: number of the surface among those of the same mesh, from 1; 0: none.
    Instance,
    /// `facing`: cosine between the normal and the direction to the camera.
    Facing,
    /// `emission.R G B`: light that comes straight from what emits it, background and environment.
    Emission,
    /// `direct.R G B`: light that was scattered once.
    Direct,
    /// `indirect.R G B`: light that was scattered more often.
    Indirect,
    /// `ambient.R G B`: ambient light.
    Ambient,
    /// `light.<name>.R G B`: the light of each light, emitting surface, the environment, the background.
    Light,
    /// `shadow`: the fraction of direct light that something stops.
    Shadow,
    /// `ao`: the fraction of the sky that the surface sees, 0..1.
    Ao,
    /// `irradiance.R G B`: W·m⁻², on the side of the camera.
    Irradiance,
    /// `illuminance`: the same in lux.
    Illuminance,
    /// `variance.R G B`: of the pixel's mean, as if samples were independent.
    Variance,
    /// `sample_count`: samples of the pixel.
    SampleCount,
    /// `cost`: rays that were traced for the pixel.
    Cost,
    /// `CryptoObject…`, `CryptoMaterial…`: Cryptomatte of surfaces and of materials.
    Cryptomatte,
}

impl Layer {
    /// Their names, as users write them.
    pub const NAMES: [(&str, Self); 26] = [
        ("depth", Self::Depth),
        ("distance", Self::Distance),
        ("position", Self::Position),
        ("normal", Self::Normal),
        ("geo_normal", Self::GeoNormal),
        ("uv", Self::Uv),
        ("albedo", Self::Albedo),
        ("roughness", Self::Roughness),
        ("object", Self::Object),
        ("material", Self::Material),
        ("primitive", Self::Primitive),
        ("instance", Self::Instance),
        ("facing", Self::Facing),
        ("emission", Self::Emission),
        ("direct", Self::Direct),
        ("indirect", Self::Indirect),
        ("ambient", Self::Ambient),
        ("light", Self::Light),
        ("shadow", Self::Shadow),
        ("ao", Self::Ao),
        ("irradiance", Self::Irradiance),
        ("illuminance", Self::Illuminance),
        ("variance", Self::Variance),
        ("sample_count", Self::SampleCount),
        ("cost", Self::Cost),
        ("cryptomatte", Self::Cryptomatte),
    ];

    /// Whether it is made of the picture's own samples.
    pub fn is_of_samples(self) -> bool {
        use Layer::{Ambient, Cost, Cryptomatte, Direct, Emission, Indirect, Light};
        use Layer::{SampleCount, Shadow, Variance};
        matches!(
            self,
            Emission
                | Direct
                | Indirect
                | Ambient
                | Light
                | Shadow
                | Variance
                | SampleCount
                | Cost
                | Cryptomatte
        )
    }
}

impl FromStr for Layer {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = Self::NAMES.iter().find(|(name, _)| *name == text);
        found.map(|(_, layer)| *layer).ok_or_else(|| {
            let names: Vec<_> = Self::NAMES.iter().map(|(name, _)| *name).collect();
            format!("no layer is called \"{text}\"; there are {}", names.join(", "))
        })
    }
}
