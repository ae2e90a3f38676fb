//! `[materials.name.lambert]` and the pictures that materials use.

use super::color::{CheckerKeys, Color, ImageKeys, OneOrTwo, Reflectance, TextureKeys};
use super::document::{At, Document};
use super::film::Fraction;
use crate::color::Rgb;
use crate::diagnostic::Result;
use crate::io::{FileAccess, pixels};
use crate::scene::description::{Alpha, Material, Pattern, Pixels, Texture};
use crate::units::written::{Angle, Number, Pair, Size};
use glam::{Affine2, Vec2};
use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

/// A material of one kind.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(super) enum MaterialKeys {
    /// Matte: reflects the same to every side.
    Lambert(Box<LambertKeys>),
    /// A perfect mirror.
    Mirror(MirrorKeys),
}

/// A matte material.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct LambertKeys {
    /// The fraction of light reflected, 0 to 1. Default 0.5.
    reflectance: Option<TextureKeys<Reflectance>>,
    /// The fraction of ambient light reflected, 0 to 1. Default: `reflectance`.
    ambient_reflectance: Option<TextureKeys<Reflectance>>,
    /// The fraction of light mirrored, 0 to 1; with `reflectance` at most 1. Default 0.
    mirror: Option<At<TextureKeys<Reflectance>>>,
    /// Radiance added to what leaves the surface (1 is white). Default 0.
    emission: Option<TextureKeys<Color>>,
    /// Alpha of `reflectance` below which the surface is not there, 0 to 1. Default: it is always there.
    alpha_cutoff: Option<Fraction>,
    /// Whether the back can be seen. Default true.
    double_sided: Option<bool>,
}

/// A perfect mirror.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct MirrorKeys {
    /// The fraction of light mirrored, 0 to 1. Default 1.
    reflectance: Option<TextureKeys<Reflectance>>,
    /// Whether the back can be seen. Default true.
    double_sided: Option<bool>,
}

/// Decoded pictures, each file once.
pub(super) struct Pictures<'a> {
    pub(super) document: &'a Document<'a>,
    pub(super) access: &'a FileAccess,
    pub(super) images: Vec<Arc<Pixels>>,
    pub(super) by_file: HashMap<PathBuf, usize>,
}

impl MaterialKeys {
    /// The material as plain data; its pictures are added to `pictures`.
    pub(super) fn describe(self, name: &str, pictures: &mut Pictures<'_>) -> Result<Material> {
        let matte = Material::matte(name, Rgb::splat(0.5));
        let keys = match self {
            Self::Lambert(keys) => keys,
            Self::Mirror(keys) => {
                let mirrored = pictures.texture(keys.reflectance)?;
                return Ok(Material {
                    reflectance: Texture::constant(Rgb::ZERO),
                    mirrored: mirrored.unwrap_or(Texture::constant(Rgb::ONE)),
                    double_sided: keys.double_sided.unwrap_or(true),
                    ..matte
                });
            }
        };
        let reflectance = pictures.texture(keys.reflectance)?;
        let reflectance = reflectance.unwrap_or(matte.reflectance.clone());
        Ok(Material {
            mirrored: match keys.mirror {
                Some(mirror) => pictures.mirror(mirror, &reflectance)?,
                None => matte.mirrored.clone(),
            },
            reflectance,
            ambient_reflectance: pictures.texture(keys.ambient_reflectance)?,
            emission: pictures.texture(keys.emission)?.unwrap_or(matte.emission.clone()),
            alpha: match keys.alpha_cutoff {
                Some(Fraction(cutoff)) => Alpha::Mask { cutoff: cutoff as f32 },
                None => Alpha::Opaque,
            },
            double_sided: keys.double_sided.unwrap_or(true),
            ..matte
        })
    }
}

impl Pictures<'_> {
    fn texture<C: Into<[f32; 4]>>(
        &mut self,
        keys: Option<TextureKeys<C>>,
    ) -> Result<Option<Texture>> {
        let Some(keys) = keys else { return Ok(None) };
        let (factor, pattern) = match keys {
            TextureKeys::Constant(color) => (color.into(), Pattern::Constant),
            TextureKeys::Image(keys) => ([1.0; 4], self.image_pattern(keys)?),
            TextureKeys::Checker(keys) => ([1.0; 4], checker(keys)),
        };
        Ok(Some(Texture { factor, pattern, vertex_colors: false }))
    }

    /// The mirror over a matte ground, which together may not reflect more than all.
    fn mirror(&mut self, keys: At<TextureKeys<Reflectance>>, ground: &Texture) -> Result<Texture> {
        let At { span, value } = keys;
        let mirror = self.texture(Some(value))?.unwrap_or(Texture::constant(Rgb::ZERO));
        let all = Rgb::from_slice(&mirror.factor) + Rgb::from_slice(&ground.factor);
        if mirror.is_constant() && ground.is_constant() && all.max_element() > 1.0 + 1e-6 {
            let message = "reflects more than all, together with the reflectance";
            return Err(self.document.error(&span, message));
        }
        Ok(mirror)
    }

    fn image_pattern(&mut self, keys: ImageKeys) -> Result<Pattern> {
        let image = self.open(&keys.file)?;
        let OneOrTwo([u, v]) = keys.scale.unwrap_or(OneOrTwo([Number(1.0); 2]));
        let offset = keys.offset.map_or(Vec2::ZERO, |Pair(offset)| offset.as_vec2());
        let Angle(angle) = keys.rotate.unwrap_or(Angle(0.0));
        let scale = Vec2::new(u.0 as f32, v.0 as f32);
        let transform = Affine2::from_scale_angle_translation(scale, angle as f32, offset);
        if !transform.is_finite() {
            let message = "is placed by numbers that are too large";
            return Err(self.document.error(&keys.file.span, message));
        }
        Ok(Pattern::Image {
            image,
            uv_set: 0,
            transform,
            wrap: keys.wrap.0,
            sampling: keys.sampling,
        })
    }

    /// The index of the picture in `images`.
    pub(super) fn open(&mut self, file: &At<String>) -> Result<usize> {
        let (name, span) = (&file.value, &file.span);
        let path = self.document.open(span, self.access.resolve(name))?;
        // One picture under two names is decoded once.
        let real = path.canonicalize().unwrap_or(path);
        if let Some(&image) = self.by_file.get(&real) {
            return Ok(image);
        }
        let bytes = self.document.open(span, self.access.read(name))?;
        let pixels = self.document.open(span, pixels::decode(&bytes, name, &self.access.limits))?;
        self.images.push(Arc::new(pixels));
        self.by_file.insert(real, self.images.len() - 1);
        Ok(self.images.len() - 1)
    }
}

fn checker<C: Into<[f32; 4]>>(keys: CheckerKeys<C>) -> Pattern {
    let OneOrTwo([u, v]) = keys.size.unwrap_or(OneOrTwo([Size(1.0); 2]));
    let size = Vec2::new(u.0 as f32, v.0 as f32);
    Pattern::Checker { colors: keys.colors.0.map(Into::into), size }
}
