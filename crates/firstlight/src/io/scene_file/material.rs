//! `[materials.name.kind]`.

use super::color::{Color, Reflectance, TextureKeys};
use super::document::At;
use super::film::Fraction;
use super::medium::MediumKeys;
use super::pictures::Pictures;
use super::substance::{Abbe, Index, Metal};
use crate::color::Rgb;
use crate::diagnostic::Result;
use crate::scene::description::{
    Alpha, ComplexIndex, Facets, Interior, Material, Medium, NormalMap, Principled, Scalar,
    Scattering, Texture,
};
use crate::units::written::{Angle, Length, Number, Size};
use schemars::JsonSchema;
use serde::Deserialize;

/// A material of one kind.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(super) enum MaterialKeys {
    /// Matte: reflects the same to every side.
    #[serde(alias = "diffuse")]
    Lambert(Box<LambertKeys>),
    /// A perfect mirror.
    Mirror(Box<MirrorKeys>),
    /// A metal, polished or rough.
    Conductor(Box<ConductorKeys>),
    /// Glass, water and the like: a closed surface is a solid.
    Dielectric(Box<DielectricKeys>),
    /// A pane of glass without thickness, as of windows: a surface that need not be closed.
    ThinGlass(Box<ThinGlassKeys>),
    /// glTF's metallic-roughness material with its extensions.
    Principled(Box<PrincipledKeys>),
    /// A colour for the eye alone: no light changes it, and it lights nothing.
    Unlit(Box<UnlitKeys>),
    /// Two other materials at once.
    Mix(Box<MixKeys>),
    /// Fog, smoke: a closed surface that is filled with it and is not there itself.
    Medium(Box<MediumKeys>),
}

/// A struct with the keys that all materials have.
macro_rules! material_keys {
    ($(#[$doc:meta])* $name:ident { $($(#[$key_doc:meta])* $key:ident: $type:ty,)* }) => {
        $(#[$doc])*
        #[derive(Debug, Deserialize, JsonSchema)]
        #[serde(deny_unknown_fields)]
        pub(super) struct $name {
            $($(#[$key_doc])* $key: $type,)*
            /// Radiance added to what leaves the surface (1 is white). Default 0.
            emission: Option<TextureKeys<Color>>,
            /// The fraction of light that the surface stops at all, 0 to 1, times the alpha of its colour's picture.
            /// Default: it is solid.
            opacity: Option<TextureKeys<Fraction>>,
            /// Alpha of its colour below which the surface is not there, 0 to 1. Default: it is always there.
            alpha_cutoff: Option<Fraction>,
            /// Whether the back can be seen. Default true.
            double_sided: Option<bool>,
            /// A picture of normals that bend those of the surface: red along u, green along v, blue out of it.
            normal_map: Option<TextureKeys<Reflectance>>,
            /// How much they bend. Default 1.
            normal_scale: Option<Number>,
            /// Heights, 0 to 1, that raise the surface for the eye: a picture or a pattern.
            bump: Option<TextureKeys<Fraction>>,
            /// What a height of 1 is; below 0 hills are valleys. Default "1 mm".
            bump_height: Option<Length>,
            /// The part of ambient light that comes to each point, 0 to 1; other light finds its own way. Default: all.
            occlusion_map: Option<TextureKeys<Fraction>>,
            /// How much of what that keeps out is kept out. Default 1.
            occlusion_strength: Option<Fraction>,
        }

        impl $name {
            /// The material of these keys; `color` is its reflectance.
            fn finish(
                self,
                name: &str,
                color: Texture,
                scattering: Scattering,
                pictures: &mut Pictures<'_>,
            ) -> Result<Material> {
                let alpha = match (&self.opacity, self.alpha_cutoff) {
                    (_, Some(Fraction(cutoff))) => Alpha::Mask { cutoff: cutoff as f32 },
                    (Some(_), None) => Alpha::Blend,
                    (None, None) => Alpha::Opaque,
                };
                let opacity = self.opacity.map(|keys| pictures.scalar(Some(keys), 1.0)).transpose()?;
                let mut reflectance = color;
                // What is the same everywhere is in the colour's alpha.
                if let Some(opacity) = opacity.as_ref().filter(|o| o.texture.is_constant()) {
                    reflectance.factor[3] *= opacity.texture.factor[opacity.channel];
                }
                let scale = self.normal_scale.map_or(1.0, |Number(scale)| scale as f32);
                let normal_map = self.normal_map.map(|keys| pictures.texture(Some(keys), Rgb::ONE));
                Ok(Material {
                    opacity: opacity.filter(|opacity| !opacity.texture.is_constant()),
                    occlusion: pictures.occlusion(self.occlusion_map, self.occlusion_strength)?,
                    reflectance,
                    scattering,
                    normal: normal_map.transpose()?.map(|texture| NormalMap { texture, scale }),
                    bump: pictures.bump(self.bump, self.bump_height)?,
                    emission: pictures.texture(self.emission, Rgb::ZERO)?,
                    alpha,
                    double_sided: self.double_sided.unwrap_or(true),
                    ..Material::matte(name, Rgb::ZERO)
                })
            }
        }
    };
}

material_keys! {
/// A matte material.
LambertKeys {
    /// The fraction of light reflected, 0 to 1. Default 0.5.
    reflectance: Option<TextureKeys<Reflectance>>,
    /// How rough the ground is, 0 to 1: rough ones look flatter, as the moon does. Default 0.
    roughness: Option<TextureKeys<Fraction>>,
    /// The fraction of ambient light reflected, 0 to 1. Default: `reflectance`.
    ambient_reflectance: Option<TextureKeys<Reflectance>>,
    /// The fraction of light mirrored, 0 to 1; with `reflectance` at most 1. Default 0.
    mirror: Option<At<TextureKeys<Reflectance>>>,
}
}

material_keys! {
/// A perfect mirror.
MirrorKeys {
    /// The fraction of light mirrored, 0 to 1. Default 1.
    reflectance: Option<TextureKeys<Reflectance>>,
}
}

material_keys! {
/// A metal: `metal`, `n` and `k`, or `color`.
ConductorKeys {
    /// Its name, such as "gold". Default "aluminium", unless `n` and `k` or `color` are given.
    metal: Option<Metal>,
    /// Real part of its index of refraction, per channel.
    n: Option<At<Color>>,
    /// Imaginary part of its index of refraction, per channel.
    k: Option<Color>,
    /// What it reflects of light that comes straight down, 0 to 1. Beside `metal` or `n` and `k`: what they are
    /// multiplied by.
    color: Option<TextureKeys<Reflectance>>,
    /// 0 (polished) to 1. Default 0.
    roughness: Option<TextureKeys<Fraction>>,
    /// How much rougher it is along than across, 0 to 1, as brushed metal. Default 0.
    anisotropy: Option<TextureKeys<Fraction>>,
    /// Direction of `anisotropy`, anticlockwise from that of growing u. Default 0.
    anisotropy_rotation: Option<Angle>,
    /// Whether light that meets several facets on its way out is counted: off, rough surfaces lose it, as in renderers
    /// that do not compensate for it. Default true.
    #[serde(alias = "energy_compensation")]
    multiple_scattering: Option<bool>,
}
}

material_keys! {
/// A transparent solid.
DielectricKeys {
    /// Index of refraction, 1 to 10, or a name such as "water". Default "glass", 1.5168.
    index: Option<Index>,
    /// Abbe number: how little the index depends on the colour; 64 for window glass, 25 for dense flint. Default: not
    /// at all.
    abbe: Option<Abbe>,
    /// 0 (polished) to 1 (frosted). Default 0.
    roughness: Option<TextureKeys<Fraction>>,
    /// Whether light that meets several facets on its way out is counted: off, rough surfaces lose it, as in renderers
    /// that do not compensate for it. Default true.
    #[serde(alias = "energy_compensation")]
    multiple_scattering: Option<bool>,
    /// Colour that its surface gives to what passes. Default white.
    color: Option<TextureKeys<Reflectance>>,
    /// Colour that light has after `attenuation_distance` inside. Default white.
    attenuation_color: Option<Color>,
    /// How far light goes until it has `attenuation_color`. Default 1 m.
    attenuation_distance: Option<Size>,
    /// What else is inside and scatters light, such as fog in a bulb, milk in water. Default: nothing.
    medium: Option<MediumKeys>,
    /// Where solids overlap, the highest counts, such as glass over the liquid in it. Default 0.
    priority: Option<i32>,
}
}

material_keys! {
/// A pane of glass.
ThinGlassKeys {
    /// Index of refraction, 1 to 10, or a name such as "acrylic". Default "glass", 1.5168.
    index: Option<Index>,
    /// Colour of what passes. Default white.
    color: Option<TextureKeys<Reflectance>>,
}
}

material_keys! {
/// The parameters of glTF 2.0 and KHR_materials_*, each 0 to 1 unless it says otherwise.
PrincipledKeys {
    /// What its matte ground reflects; of metal, what is mirrored straight on. Default 0.5.
    base_color: Option<TextureKeys<Reflectance>>,
    /// Whether it is metal. Default 0.
    metallic: Option<TextureKeys<Fraction>>,
    /// 0 (polished) to 1. Default 0.5.
    roughness: Option<TextureKeys<Fraction>>,
    /// How much rougher it is along than across. Default 0.
    anisotropy: Option<TextureKeys<Fraction>>,
    /// Direction of `anisotropy`, anticlockwise from that of growing u. Default 0.
    anisotropy_rotation: Option<Angle>,
    /// Whether light that meets several facets on its way out is counted: off, rough surfaces lose it, as in renderers
    /// that do not compensate for it. Default true.
    #[serde(alias = "energy_compensation")]
    multiple_scattering: Option<bool>,
    /// Index of refraction, 1 to 10, or a name. Default 1.5.
    ior: Option<Index>,
    /// Strength of the gloss of what is not metal. Default 1.
    specular: Option<TextureKeys<Fraction>>,
    /// Colour of the gloss of what is not metal, straight on; may be more than 1. Default white.
    specular_color: Option<TextureKeys<Color>>,
    /// The part that is clear instead of matte. Default 0.
    transmission: Option<TextureKeys<Fraction>>,
    /// Whether the surface is that of a solid instead of a thin sheet, if light passes it. Default false, unless one of the
    /// next four is given.
    solid: Option<bool>,
    /// Colour that light has after `attenuation_distance` inside. Default white.
    attenuation_color: Option<Color>,
    /// How far light goes until it has `attenuation_color`. Default 1 m.
    attenuation_distance: Option<Size>,
    /// Abbe number: how little the index depends on the colour. Default: not at all.
    abbe: Option<Abbe>,
    /// Where solids overlap, the highest counts. Default 0.
    priority: Option<i32>,
    /// The part of matte light that leaves on the other side, as of leaves and paper. Default 0.
    diffuse_transmission: Option<TextureKeys<Fraction>>,
    /// Its colour. Default white.
    diffuse_transmission_color: Option<TextureKeys<Reflectance>>,
    /// How much is covered by varnish. Default 0.
    clearcoat: Option<TextureKeys<Fraction>>,
    /// Roughness of the varnish. Default 0.
    clearcoat_roughness: Option<TextureKeys<Fraction>>,
    /// A picture of normals for the varnish, as `normal_map`. Default: smooth, whatever is below it.
    clearcoat_normal_map: Option<TextureKeys<Reflectance>>,
    /// Colour of the rim of cloth. Default 0.
    sheen_color: Option<TextureKeys<Reflectance>>,
    /// Roughness of the rim of cloth. Default 0.3.
    sheen_roughness: Option<TextureKeys<Fraction>>,
    /// How much is covered by a thin film, as of soap. Default 0.
    iridescence: Option<TextureKeys<Fraction>>,
    /// Index of refraction of the film. Default 1.3.
    iridescence_ior: Option<Index>,
    /// Thickness of the film, at the most. Default "400 nm".
    iridescence_thickness: Option<Size>,
    /// Its thickness at the least, where `iridescence_thickness_map` is 0. Default "100 nm".
    iridescence_thickness_min: Option<Size>,
    /// How thick it is from the least to the most, 0 to 1. Default 1.
    iridescence_thickness_map: Option<TextureKeys<Fraction>>,
}
}

material_keys! {
/// A colour for the eye alone.
UnlitKeys {
    /// The colour, which may be more than 1. Default white.
    color: Option<At<TextureKeys<Color>>>,
}
}

material_keys! {
/// Two materials at once.
MixKeys {
    /// Names of the two.
    materials: At<super::color::Two<String>>,
    /// The part of the second, 0 to 1. Default 0.5.
    amount: Option<TextureKeys<Fraction>>,
}
}

/// Takes optional keys that describe a solid.
macro_rules! interior {
    ($keys:expr, $index:expr) => {
        interior(
            $index,
            $keys.abbe.take(),
            $keys.attenuation_color.take(),
            $keys.attenuation_distance.take(),
            $keys.priority.take(),
        )
    };
}

impl MaterialKeys {
    /// The names of materials that have to be described before this one.
    pub(super) fn parts(&self) -> Option<&At<super::color::Two<String>>> {
        if let Self::Mix(keys) = self { Some(&keys.materials) } else { None }
    }

    /// The material as plain data; its pictures are added to `pictures`. `parts`: places of the materials that it
    /// mixes, and what is inside of one of them.
    pub(super) fn describe(
        self,
        name: &str,
        parts: ([usize; 2], Option<Interior>),
        pictures: &mut Pictures<'_>,
    ) -> Result<Material> {
        match self {
            Self::Lambert(keys) => keys.describe(name, pictures),
            Self::Mirror(mut keys) => {
                let mirrored = pictures.texture(keys.reflectance.take(), Rgb::ONE)?;
                let black = Texture::constant(Rgb::ZERO);
                keys.finish(name, black, Scattering::Mirror { mirrored }, pictures)
            }
            Self::Conductor(keys) => keys.describe(name, pictures),
            Self::Dielectric(mut keys) => {
                let color = pictures.texture(keys.color.take(), Rgb::ONE)?;
                let facets = Facets {
                    multiple_scattering: keys.multiple_scattering.unwrap_or(true),
                    ..Facets::of(pictures.scalar(keys.roughness.take(), 0.0)?)
                };
                let index = keys.index.take().unwrap_or(Index::GLASS);
                let mut interior = interior!(keys, index);
                if let Some(medium) = keys.medium.take() {
                    let Medium { absorption, scattering, anisotropy } =
                        medium.describe(pictures.document)?;
                    interior.absorption += absorption;
                    (interior.scattering, interior.anisotropy) = (scattering, anisotropy);
                }
                let interior = Some(interior);
                let glass = Scattering::Dielectric { facets };
                Ok(Material { interior, ..keys.finish(name, color, glass, pictures)? })
            }
            Self::ThinGlass(mut keys) => {
                let color = pictures.texture(keys.color.take(), Rgb::ONE)?;
                let Index(index) = keys.index.take().unwrap_or(Index::GLASS);
                keys.finish(name, color, Scattering::ThinGlass { index }, pictures)
            }
            Self::Principled(keys) => keys.describe(name, pictures),
            Self::Unlit(keys) => keys.describe(name, pictures),
            Self::Medium(keys) => keys.material(name, pictures.document),
            Self::Mix(mut keys) => {
                let ((materials, interior), white) = (parts, Texture::constant(Rgb::ONE));
                let amount = pictures.scalar(keys.amount.take(), 0.5)?;
                let mix = Scattering::Mix { materials, amount };
                Ok(Material { interior, ..keys.finish(name, white, mix, pictures)? })
            }
        }
    }
}

impl LambertKeys {
    fn describe(mut self, name: &str, pictures: &mut Pictures<'_>) -> Result<Material> {
        let reflectance = pictures.texture(self.reflectance.take(), Rgb::splat(0.5))?;
        let roughness = pictures.scalar(self.roughness.take(), 0.0)?;
        let ambient = self.ambient_reflectance.take();
        let ambient_reflectance =
            ambient.map(|keys| pictures.texture(Some(keys), Rgb::ZERO)).transpose()?;
        let scattering = match self.mirror.take() {
            Some(keys) => Scattering::Mirror { mirrored: pictures.mirror(keys, &reflectance)? },
            None => Scattering::Matte { roughness },
        };
        let material = self.finish(name, reflectance, scattering, pictures)?;
        Ok(Material { ambient_reflectance, ..material })
    }
}

impl UnlitKeys {
    fn describe(mut self, name: &str, pictures: &mut Pictures<'_>) -> Result<Material> {
        let emission = self.emission.take().map(|keys| pictures.texture(Some(keys), Rgb::ZERO));
        let emission = match (self.color.take(), emission.transpose()?) {
            (Some(At { span, .. }), Some(_)) => {
                let message = "color and emission are the same thing here: keep one";
                return Err(pictures.document.error(&span, message));
            }
            (Some(color), None) => pictures.texture(Some(color.value), Rgb::ONE)?,
            (None, emission) => emission.unwrap_or(Texture::constant(Rgb::ONE)),
        };
        // It reflects nothing, and its picture's alpha counts.
        let black = Texture { factor: [0.0, 0.0, 0.0, emission.factor[3]], ..emission.clone() };
        let matte = Scattering::Matte { roughness: Scalar::constant(0.0) };
        Ok(Material { emission, unlit: true, ..self.finish(name, black, matte, pictures)? })
    }
}

impl ConductorKeys {
    fn describe(mut self, name: &str, pictures: &mut Pictures<'_>) -> Result<Material> {
        let index = match (self.metal.take(), self.n.take(), self.k.take()) {
            (None, Some(At { value: Color(n), .. }), Some(Color(k))) => Some(ComplexIndex { n, k }),
            (Some(Metal(index)), None, None) => Some(index),
            (None, None, None) if self.color.is_some() => None,
            (None, None, None) => Some(Metal::ALUMINIUM),
            (_, Some(At { span, .. }), _) => {
                let message = "needs k beside it, and no metal";
                return Err(pictures.document.error(&span, message));
            }
            (metal, None, _) => metal.map(|Metal(index)| index),
        };
        let color = pictures.texture(self.color.take(), Rgb::ONE)?;
        let facets = Facets {
            anisotropy: pictures.scalar(self.anisotropy.take(), 0.0)?,
            rotation: self.anisotropy_rotation.take().map_or(0.0, |Angle(angle)| angle as f32),
            multiple_scattering: self.multiple_scattering.unwrap_or(true),
            ..Facets::of(pictures.scalar(self.roughness.take(), 0.0)?)
        };
        self.finish(name, color, Scattering::Conductor { index, facets }, pictures)
    }
}

impl PrincipledKeys {
    fn describe(mut self, name: &str, pictures: &mut Pictures<'_>) -> Result<Material> {
        let base_color = pictures.texture(self.base_color.take(), Rgb::splat(0.5))?;
        let ior = self.ior.take().unwrap_or(Index(1.5));
        let filled = self.attenuation_color.is_some() || self.attenuation_distance.is_some();
        let filled = filled || self.abbe.is_some() || self.priority.is_some();
        let solid = self.solid.unwrap_or(filled);
        let interior = interior!(self, ior);
        let scattering = Scattering::Principled(Box::new(self.parameters(ior, pictures)?));
        let material = self.finish(name, base_color, scattering, pictures)?;
        let solid = solid && material.scattering.lets_in();
        Ok(Material { interior: solid.then_some(interior), ..material })
    }

    fn parameters(&mut self, Index(ior): Index, pictures: &mut Pictures<'_>) -> Result<Principled> {
        let coat_normal = self.clearcoat_normal_map.take();
        let coat_normal = coat_normal.map(|keys| pictures.texture(Some(keys), Rgb::ONE));
        let coat_normal = coat_normal.transpose()?.map(|texture| NormalMap { texture, scale: 1.0 });
        let mut number = |keys: &mut Option<TextureKeys<Fraction>>,
                          default: f32|
         -> Result<Scalar> { pictures.scalar(keys.take(), default) };
        let Size(thickness) = self.iridescence_thickness.take().unwrap_or(Size(400e-9));
        let thinnest = self.iridescence_thickness_min.take().unwrap_or(Size(100e-9));
        let varies = self.iridescence_thickness_map.is_some();
        let Size(thinnest) = if varies { thinnest } else { Size(thickness) };
        let Index(iridescence_ior) = self.iridescence_ior.take().unwrap_or(Index(1.3));
        Ok(Principled {
            metallic: number(&mut self.metallic, 0.0)?,
            facets: Facets {
                anisotropy: number(&mut self.anisotropy, 0.0)?,
                rotation: self.anisotropy_rotation.take().map_or(0.0, |Angle(angle)| angle as f32),
                multiple_scattering: self.multiple_scattering.unwrap_or(true),
                ..Facets::of(number(&mut self.roughness, 0.5)?)
            },
            ior,
            specular: number(&mut self.specular, 1.0)?,
            transmission: number(&mut self.transmission, 0.0)?,
            diffuse_transmission: number(&mut self.diffuse_transmission, 0.0)?,
            clearcoat: number(&mut self.clearcoat, 0.0)?,
            clearcoat_roughness: number(&mut self.clearcoat_roughness, 0.0)?,
            sheen_roughness: number(&mut self.sheen_roughness, 0.3)?,
            iridescence: number(&mut self.iridescence, 0.0)?,
            iridescence_ior,
            iridescence_thickness: pictures.scalar(self.iridescence_thickness_map.take(), 1.0)?,
            clearcoat_normal: coat_normal,
            iridescence_thickness_range: [thinnest, thickness].map(|metres| (1e9 * metres) as f32),
            specular_color: pictures.texture(self.specular_color.take(), Rgb::ONE)?,
            sheen_color: pictures.texture(self.sheen_color.take(), Rgb::ZERO)?,
            diffuse_transmission_color: pictures
                .texture(self.diffuse_transmission_color.take(), Rgb::ONE)?,
        })
    }
}

fn interior(
    Index(index): Index,
    abbe: Option<Abbe>,
    color: Option<Color>,
    distance: Option<Size>,
    priority: Option<i32>,
) -> Interior {
    let (Color(color), Size(distance)) =
        (color.unwrap_or(Color(Rgb::ONE)), distance.unwrap_or(Size(1.0)));
    Interior {
        dispersion: abbe.map_or(0.0, |Abbe(abbe)| 1.0 / abbe),
        absorption: Interior::absorption(color, distance as f32),
        priority: priority.unwrap_or(0),
        ..Interior::clear(index)
    }
}
