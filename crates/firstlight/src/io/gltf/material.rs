//! Materials: what of glTF's metallic-roughness model a matte surface can show.

use super::data::Data;
use super::document::{self, MaterialExtensions, Sampler, TextureInfo, plain};
use super::notes::Notes;
use super::picture::Pictures;
use crate::color::Rgb;
use crate::diagnostic::Result;
use crate::scene::description::{
    Alpha, Material, Pattern, Pixels, Sampling, Texture, UvTransform, Wrap,
};
use glam::{Affine2, Mat2, Vec2};
use std::sync::Arc;

/// The materials read so far.
pub(super) struct Materials {
    pub(super) list: Vec<Material>,
    pictures: Pictures,
    /// For each of `list`: whether a mesh with vertex colours has it.
    colored: Vec<bool>,
    /// For each material of the document: its place in `list`, once it was read.
    places: Vec<Option<usize>>,
    default: Option<usize>,
}

impl Materials {
    pub(super) fn new(data: &Data) -> Self {
        let places = vec![None; data.document.materials.len()];
        let pictures = Pictures::new(data);
        Self { list: Vec::new(), pictures, colored: Vec::new(), places, default: None }
    }

    /// The material that `part` refers to by `index`, as its place in `list`.
    ///
    /// # Errors
    /// If it, or something it refers to, does not exist or makes no sense.
    pub(super) fn place(
        &mut self,
        data: &Data,
        index: Option<u32>,
        part: &str,
        notes: &mut Notes,
    ) -> Result<usize> {
        let Some(index) = index else { return Ok(self.default_place()) };
        let material = data.at(&data.document.materials, index, "material", part)?;
        if let Some(place) = self.places.get(index as usize).copied().flatten() {
            return Ok(place);
        }
        let part = format!("materials[{index}]");
        let mut reader = Reader { data, pictures: &mut self.pictures, notes, part: &part };
        let material = reader.material(material, index)?;
        let place = self.add(material);
        if let Some(slot) = self.places.get_mut(index as usize) {
            *slot = Some(place);
        }
        Ok(place)
    }

    /// glTF's default material: white.
    fn default_place(&mut self) -> usize {
        if let Some(place) = self.default {
            return place;
        }
        let mut white = Material { double_sided: false, ..Material::matte("default", Rgb::ONE) };
        white.reflectance.vertex_colors = true;
        let place = self.add(white);
        self.default = Some(place);
        place
    }

    fn add(&mut self, material: Material) -> usize {
        self.list.push(material);
        self.colored.push(false);
        self.list.len() - 1
    }

    /// Says that a mesh with vertex colours has this material.
    pub(super) fn use_vertex_colors(&mut self, place: usize) {
        if let Some(colored) = self.colored.get_mut(place) {
            *colored = true;
        }
    }

    /// The materials; those without coloured meshes ask for no vertex colours.
    pub(super) fn finish(mut self) -> (Vec<Material>, Vec<Arc<Pixels>>) {
        for (material, colored) in self.list.iter_mut().zip(self.colored) {
            material.reflectance.vertex_colors &= colored;
            material.emission.vertex_colors &= colored;
        }
        (self.list, self.pictures.images)
    }
}

/// Reads one material.
struct Reader<'a, 'n, 'f> {
    data: &'a Data<'a>,
    pictures: &'a mut Pictures,
    notes: &'n mut Notes<'f>,
    part: &'a str,
}

impl Reader<'_, '_, '_> {
    fn material(&mut self, material: &document::Material, index: u32) -> Result<Material> {
        let none = MaterialExtensions::default();
        let extensions = material.extensions.as_deref().unwrap_or(&none);
        let base = self.base_color(material, extensions)?;
        let unlit = extensions.unlit.is_some();
        if !unlit && is_more_than_matte(material, extensions) {
            self.notes.add(self.part, "uses metal, gloss or transmission; it is shown matte");
        }
        let [.., alpha] = base.factor;
        let (reflectance, emission) = if unlit {
            (Texture { factor: [0.0, 0.0, 0.0, alpha], ..base.clone() }, base)
        } else {
            (base, self.emission(material, extensions)?)
        };
        let name = material.name.clone().unwrap_or_else(|| format!("material {index}"));
        Ok(Material {
            reflectance,
            emission,
            alpha: self.alpha(material)?,
            double_sided: material.double_sided,
            ..Material::matte(name, Rgb::ZERO)
        })
    }

    fn base_color(
        &mut self,
        material: &document::Material,
        extensions: &MaterialExtensions,
    ) -> Result<Texture> {
        let (factor, info, field) =
            match (&extensions.specular_glossiness, &material.pbr_metallic_roughness) {
                (Some(old), _) => (
                    old.diffuse_factor,
                    old.diffuse_texture.as_ref(),
                    "extensions.KHR_materials_pbrSpecularGlossiness.diffuse",
                ),
                (None, Some(pbr)) => (
                    pbr.base_color_factor,
                    pbr.base_color_texture.as_ref(),
                    "pbrMetallicRoughness.baseColor",
                ),
                (None, None) => (None, None, ""),
            };
        let factor = factor.map_or([1.0; 4], plain);
        if factor.iter().any(|channel| !(0.0..=1.0).contains(channel)) {
            let part = format!("{}.{field}Factor", self.part);
            self.notes.add(part, "is not within 0 to 1 and was clamped");
        }
        let factor = factor.map(|channel| channel.clamp(0.0, 1.0));
        let texture = self.texture(factor, info, &format!("{field}Texture"))?;
        Ok(Texture { vertex_colors: true, ..texture })
    }

    fn emission(
        &mut self,
        material: &document::Material,
        extensions: &MaterialExtensions,
    ) -> Result<Texture> {
        let strength = extensions.emissive_strength.as_ref().and_then(|e| e.emissive_strength);
        let strength = strength.map_or(1.0, |strength| strength.0);
        let [r, g, b] = material.emissive_factor.map_or([0.0; 3], plain);
        let factor = [r, g, b].map(|channel| channel * strength);
        if factor.iter().any(|channel| !(0.0..f32::INFINITY).contains(channel)) {
            let cause = format!("emits {factor:?}; each channel must be at least 0 and finite");
            return Err(self.data.error(format!("{}.emissiveFactor", self.part), cause));
        }
        let info = material.emissive_texture.as_deref().filter(|_| factor != [0.0; 3]);
        let [r, g, b] = factor;
        self.texture([r, g, b, 1.0], info, "emissiveTexture")
    }

    fn alpha(&self, material: &document::Material) -> Result<Alpha> {
        match material.alpha_mode.as_deref().unwrap_or("OPAQUE") {
            "OPAQUE" => Ok(Alpha::Opaque),
            "BLEND" => Ok(Alpha::Blend),
            "MASK" => Ok(Alpha::Mask { cutoff: material.alpha_cutoff.map_or(0.5, |c| c.0) }),
            other => {
                let cause = format!("{other:?} is unknown; OPAQUE, MASK and BLEND are known");
                Err(self.data.error(format!("{}.alphaMode", self.part), cause))
            }
        }
    }

    fn texture(
        &mut self,
        factor: [f32; 4],
        info: Option<&TextureInfo>,
        field: &str,
    ) -> Result<Texture> {
        let Some(info) = info else {
            return Ok(Texture { factor, pattern: Pattern::Constant, vertex_colors: false });
        };
        let data = self.data;
        let part = format!("{}.{field}.index", self.part);
        let texture = data.at(&data.document.textures, info.index, "texture", &part)?;
        let part = format!("textures[{}]", info.index);
        let Some(image) = self.pictures.of_texture(data, texture, &part, self.notes)? else {
            let [.., alpha] = factor;
            let factor = [1.0, 1.0, 1.0, alpha];
            return Ok(Texture { factor, ..Texture::stand_in() });
        };
        let (wrap, sampling) = match texture.sampler {
            Some(index) => {
                let part = format!("{part}.sampler");
                let sampler = data.at(&data.document.samplers, index, "sampler", &part)?;
                (self.wrap(sampler, index), sampling(sampler))
            }
            None => Default::default(),
        };
        let over = info.extensions.transform.as_ref().and_then(|transform| transform.tex_coord);
        let uv_set = over.unwrap_or(info.tex_coord) as usize;
        let transform = uv_transform(info);
        let pattern = Pattern::Image { image, uv_set, transform, wrap, sampling };
        Ok(Texture { factor, pattern, vertex_colors: false })
    }

    fn wrap(&mut self, sampler: &Sampler, index: u32) -> [Wrap; 2] {
        [sampler.wrap_s, sampler.wrap_t].map(|mode| match mode {
            None | Some(10497) => Wrap::Repeat,
            Some(33648) => Wrap::Mirror,
            Some(33071) => Wrap::Clamp,
            Some(other) => {
                let message = format!("wrap mode {other} is unknown; the picture repeats");
                self.notes.add(format!("samplers[{index}]"), message);
                Wrap::Repeat
            }
        })
    }
}

fn sampling(sampler: &Sampler) -> Sampling {
    const NEAREST: u32 = 9728;
    if sampler.mag_filter == Some(NEAREST) { Sampling::Nearest } else { Sampling::Bilinear }
}

/// KHR_texture_transform for coordinates whose v points up.
///
/// The extension scales, rotates and shifts coordinates whose v points down, where its counter-clockwise (as
/// seen) has the opposite sign. Turning v over before and after gives the map for v up.
fn uv_transform(info: &TextureInfo) -> UvTransform {
    let Some(transform) = &info.extensions.transform else { return UvTransform::IDENTITY };
    let offset = transform.offset.map_or([0.0; 2], plain);
    let scale = transform.scale.map_or([1.0; 2], plain);
    let angle = transform.rotation.map_or(0.0, |angle| angle.0);
    let down = Affine2::from_scale_angle_translation(scale.into(), -angle, offset.into());
    let flip = Affine2::from_mat2_translation(Mat2::from_diagonal(Vec2::new(1.0, -1.0)), Vec2::Y);
    flip * down * flip
}

/// Whether the file asks for a look that a matte surface does not have.
fn is_more_than_matte(material: &document::Material, extensions: &MaterialExtensions) -> bool {
    let e = extensions;
    let metal = material.pbr_metallic_roughness.as_ref().and_then(|pbr| pbr.metallic_factor);
    let layers = [
        &e.anisotropy,
        &e.clearcoat,
        &e.diffuse_transmission,
        &e.iridescence,
        &e.sheen,
        &e.specular,
        &e.transmission,
        &e.volume,
    ];
    e.specular_glossiness.is_some()
        || metal.is_none_or(|factor| factor.0 > 0.0)
        || layers.iter().any(|layer| layer.is_some())
}
