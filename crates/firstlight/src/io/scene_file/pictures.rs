//! The textures of a scene file, and the pictures that they use.

use super::color::{
    CheckerKeys, GradientKeys, ImageKeys, NoiseKeys, OneOrTwo, Reflectance, TextureKeys,
};
use super::document::{At, Document};
use super::film::Fraction;
use crate::color::Rgb;
use crate::diagnostic::Result;
use crate::io::{FileAccess, pixels};
use crate::scene::description::{
    BumpAmount, BumpMap, OcclusionMap, Pattern, Pixels, Scalar, Texture,
};
use crate::units::written::{Angle, Length, Number, Pair, Size};
use glam::{Affine2, Vec2};
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

/// Decoded pictures, each file once.
pub(super) struct Pictures<'a> {
    pub(super) document: &'a Document<'a>,
    pub(super) access: &'a FileAccess,
    pub(super) images: Vec<Arc<Pixels>>,
    pub(super) by_file: HashMap<PathBuf, usize>,
}

impl Pictures<'_> {
    /// A texture of colours; `default` if nothing is written.
    pub(super) fn texture<C: Into<[f32; 4]>>(
        &mut self,
        keys: Option<TextureKeys<C>>,
        default: Rgb,
    ) -> Result<Texture> {
        match keys {
            None => Ok(Texture::constant(default)),
            Some(TextureKeys::Image(ImageKeys { channel: Some(channel), .. })) => {
                Err(self.document.error(&channel.span, "is for numbers; a colour has all channels"))
            }
            Some(keys) => self.any(keys),
        }
    }

    /// A number over a surface; `default` if nothing is written.
    pub(super) fn scalar(
        &mut self,
        keys: Option<TextureKeys<Fraction>>,
        default: f32,
    ) -> Result<Scalar> {
        let Some(keys) = keys else { return Ok(Scalar::constant(default)) };
        let channel = match &keys {
            TextureKeys::Image(ImageKeys { channel: Some(channel), .. }) => channel.value as usize,
            _ => 0,
        };
        Ok(Scalar { texture: self.any(keys)?, channel, complement: false })
    }

    fn any<C: Into<[f32; 4]>>(&mut self, keys: TextureKeys<C>) -> Result<Texture> {
        let (factor, pattern) = match keys {
            TextureKeys::Constant(color) => (color.into(), Pattern::Constant),
            TextureKeys::Image(keys) => ([1.0; 4], self.image_pattern(keys)?),
            TextureKeys::Checker(keys) => ([1.0; 4], checker(keys)),
            TextureKeys::Gradient(keys) => ([1.0; 4], self.gradient(keys)?),
            TextureKeys::Noise(keys) => ([1.0; 4], self.noise(keys)?),
        };
        Ok(Texture { factor, pattern, vertex_colors: false })
    }

    fn gradient<C: Into<[f32; 4]>>(&self, keys: GradientKeys<C>) -> Result<Pattern> {
        let from = keys.from.map_or(Vec2::ZERO, |Pair(from)| from.as_vec2());
        let to = keys.to.as_ref().map_or(Vec2::Y, |to| to.value.0.as_vec2());
        let length2 = (to - from).length_squared();
        if let Some(At { span, .. }) = keys.to.filter(|_| length2 == 0.0 || !length2.is_finite()) {
            return Err(self
                .document
                .error(&span, "needs a place other than that of from, nearby"));
        }
        Ok(Pattern::Gradient { colors: keys.colors.0.map(Into::into), from, to })
    }

    fn noise<C: Into<[f32; 4]>>(&self, keys: NoiseKeys<C>) -> Result<Pattern> {
        let octaves = keys.octaves.as_ref().map_or(4, |octaves| octaves.value);
        if let Some(At { span, .. }) = keys.octaves.filter(|_| !(1..=16).contains(&octaves)) {
            return Err(self.document.error(&span, format!("must be from 1 to 16, not {octaves}")));
        }
        let size = sizes(keys.size);
        Ok(Pattern::Noise { colors: keys.colors.0.map(Into::into), size, octaves })
    }

    /// Heights over a surface; a height of 1 is `height`.
    pub(super) fn bump(
        &mut self,
        keys: Option<TextureKeys<Fraction>>,
        height: Option<Length>,
    ) -> Result<Option<BumpMap>> {
        let Some(keys) = keys else { return Ok(None) };
        let Length(metres) = height.unwrap_or(Length(0.001));
        let amount = BumpAmount::Metres(metres as f32);
        Ok(Some(BumpMap { height: self.scalar(Some(keys), 0.0)?, amount }))
    }

    /// What keeps ambient light out.
    pub(super) fn occlusion(
        &mut self,
        keys: Option<TextureKeys<Fraction>>,
        strength: Option<Fraction>,
    ) -> Result<Option<OcclusionMap>> {
        let Some(keys) = keys else { return Ok(None) };
        let strength = strength.map_or(1.0, |Fraction(strength)| strength as f32);
        Ok(Some(OcclusionMap { open: self.scalar(Some(keys), 1.0)?, strength }))
    }

    /// The mirror over a matte ground, which together may not reflect more than all.
    pub(super) fn mirror(
        &mut self,
        keys: At<TextureKeys<Reflectance>>,
        ground: &Texture,
    ) -> Result<Texture> {
        let At { span, value } = keys;
        let mirror = self.texture(Some(value), Rgb::ZERO)?;
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
    let size = sizes(keys.size);
    Pattern::Checker { colors: keys.colors.0.map(Into::into), size }
}

fn sizes(size: Option<OneOrTwo<Size>>) -> Vec2 {
    let OneOrTwo([u, v]) = size.unwrap_or(OneOrTwo([Size(1.0); 2]));
    Vec2::new(u.0 as f32, v.0 as f32)
}
