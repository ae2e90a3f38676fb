//! Materials: glTF's metallic-roughness model, with the ratified extensions.

use super::data::Data;
use super::document::{
    self, MaterialExtensions, Real, Sampler, SpecularGlossiness, TextureInfo, plain,
};
use super::notes::Notes;
use super::picture::Pictures;
use crate::color::Rgb;
use crate::diagnostic::Result;
use crate::io::pictures::only_picture;
use crate::scene::description::{
    Alpha, Facets, Interior, Material, NormalMap, OcclusionMap, Pattern, Pixels, Principled,
    Sampling, Scalar, Scattering, Texture, UvTransform, Wrap,
};
use glam::{Affine2, Mat2, Vec2};
use std::sync::Arc;

/// Channels of textures.
const RED: usize = 0;
const GREEN: usize = 1;
const BLUE: usize = 2;
const ALPHA: usize = 3;

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
        let scattering = Scattering::Principled(Box::default());
        let matte = Material::matte("default", Rgb::ONE);
        let mut white = Material { double_sided: false, scattering, ..matte };
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
        let matte = Material::matte(self.name(material, index), Rgb::ZERO);
        let [.., alpha] = base.factor;
        let (reflectance, emission) = if unlit {
            (Texture { factor: [0.0, 0.0, 0.0, alpha], ..base.clone() }, base)
        } else {
            (base, self.emission(material, extensions)?)
        };
        let scattering = match (&extensions.specular_glossiness, unlit) {
            (_, true) => matte.scattering.clone(),
            (Some(old), _) => self.specular_glossiness(old)?,
            (None, _) => self.scattering(material, extensions)?,
        };
        Ok(Material {
            reflectance,
            emission,
            unlit,
            normal: match unlit {
                true => None,
                false => self.normal(material.normal_texture.as_deref(), "normalTexture")?,
            },
            occlusion: if unlit { None } else { self.occlusion(material)? },
            interior: interior(extensions).filter(|_| scattering.lets_in()),
            alpha: self.alpha(material)?,
            double_sided: material.double_sided,
            scattering,
            ..matte
        })
    }

    fn name(&self, material: &document::Material, index: u32) -> String {
        material.name.clone().unwrap_or_else(|| format!("material {index}"))
    }

    fn normal(&mut self, info: Option<&TextureInfo>, field: &str) -> Result<Option<NormalMap>> {
        let Some(info) = info else { return Ok(None) };
        let texture = self.texture([1.0; 4], Some(info), field)?;
        let scale = info.scale.map_or(1.0, |scale| scale.0);
        Ok(only_picture(texture).map(|texture| NormalMap { texture, scale }))
    }

    fn occlusion(&mut self, material: &document::Material) -> Result<Option<OcclusionMap>> {
        let Some(info) = material.occlusion_texture.as_deref() else { return Ok(None) };
        let texture = self.texture([1.0; 4], Some(info), "occlusionTexture")?;
        let strength = info.strength.map_or(1.0, |strength| strength.0.clamp(0.0, 1.0));
        let open = only_picture(texture).map(|texture| Scalar {
            texture,
            channel: RED,
            complement: false,
        });
        Ok(open.map(|open| OcclusionMap { open, strength }))
    }

    /// The metallic-roughness surface and its extensions.
    fn scattering(
        &mut self,
        material: &document::Material,
        extensions: &MaterialExtensions,
    ) -> Result<Scattering> {
        let mut p = Principled::default();
        if let Some(pbr) = &material.pbr_metallic_roughness {
            let (info, field) = (
                pbr.metallic_roughness_texture.as_ref(),
                "pbrMetallicRoughness.metallicRoughnessTexture",
            );
            p.metallic = self.scalar(pbr.metallic_factor, 1.0, info, BLUE, field)?;
            p.facets.roughness = self.scalar(pbr.roughness_factor, 1.0, info, GREEN, field)?;
        }
        p.ior = extensions.ior.as_ref().and_then(|e| e.ior).map_or(1.5, |ior| ior.0);
        if p.ior != 0.0 && p.ior < 1.0 {
            self.notes.add(
                self.part,
                format!("has an index of refraction of {}, below 1; 1 is taken", p.ior),
            );
            p.ior = 1.0;
        }
        self.add_reflection(&mut p, extensions)?;
        self.add_transmission(&mut p, extensions)?;
        self.add_layers(&mut p, extensions)?;
        Ok(Scattering::Principled(Box::new(p)))
    }

    fn add_reflection(
        &mut self,
        p: &mut Principled,
        extensions: &MaterialExtensions,
    ) -> Result<()> {
        if let Some(e) = &extensions.specular {
            p.specular = self.scalar(
                e.specular_factor,
                1.0,
                e.specular_texture.as_ref(),
                ALPHA,
                "specularTexture",
            )?;
            let (factor, info) = (e.specular_color_factor, e.specular_color_texture.as_ref());
            p.specular_color = self.color(factor, [1.0; 3], info, "specularColorTexture")?;
        }
        if let Some(e) = &extensions.anisotropy {
            let info = e.anisotropy_texture.as_ref();
            p.facets.anisotropy =
                self.scalar(e.anisotropy_strength, 0.0, info, BLUE, "anisotropyTexture")?;
            p.facets.rotation = e.anisotropy_rotation.map_or(0.0, |angle| angle.0);
            p.facets.direction = match info {
                Some(_) => Some(self.texture([1.0; 4], info, "anisotropyTexture")?),
                None => None,
            };
        }
        if let Some(e) = &extensions.iridescence {
            let info = e.iridescence_texture.as_ref();
            p.iridescence =
                self.scalar(e.iridescence_factor, 0.0, info, RED, "iridescenceTexture")?;
            p.iridescence_ior = e.iridescence_ior.map_or(1.3, |ior| ior.0.max(1.0));
            let info = e.iridescence_thickness_texture.as_ref();
            p.iridescence_thickness =
                self.scalar(None, 1.0, info, GREEN, "iridescenceThicknessTexture")?;
            p.iridescence_thickness_range = [
                e.iridescence_thickness_minimum.map_or(100.0, |nm| nm.0.max(0.0)),
                e.iridescence_thickness_maximum.map_or(400.0, |nm| nm.0.max(0.0)),
            ];
        }
        Ok(())
    }

    fn add_transmission(
        &mut self,
        p: &mut Principled,
        extensions: &MaterialExtensions,
    ) -> Result<()> {
        if let Some(e) = &extensions.transmission {
            let info = e.transmission_texture.as_ref();
            p.transmission =
                self.scalar(e.transmission_factor, 0.0, info, RED, "transmissionTexture")?;
        }
        if let Some(e) = &extensions.diffuse_transmission {
            let info = e.diffuse_transmission_texture.as_ref();
            let factor = e.diffuse_transmission_factor;
            p.diffuse_transmission =
                self.scalar(factor, 0.0, info, ALPHA, "diffuseTransmissionTexture")?;
            let (factor, info) = (
                e.diffuse_transmission_color_factor,
                e.diffuse_transmission_color_texture.as_ref(),
            );
            p.diffuse_transmission_color =
                self.color(factor, [1.0; 3], info, "diffuseTransmissionColorTexture")?;
        }
        Ok(())
    }

    fn add_layers(&mut self, p: &mut Principled, extensions: &MaterialExtensions) -> Result<()> {
        if let Some(e) = &extensions.clearcoat {
            p.clearcoat = self.scalar(
                e.clearcoat_factor,
                0.0,
                e.clearcoat_texture.as_ref(),
                RED,
                "clearcoatTexture",
            )?;
            let (factor, info) =
                (e.clearcoat_roughness_factor, e.clearcoat_roughness_texture.as_ref());
            p.clearcoat_roughness =
                self.scalar(factor, 0.0, info, GREEN, "clearcoatRoughnessTexture")?;
            let info = e.clearcoat_normal_texture.as_ref();
            p.clearcoat_normal = self.normal(info, "clearcoatNormalTexture")?;
        }
        if let Some(e) = &extensions.sheen {
            let (factor, info) = (e.sheen_color_factor, e.sheen_color_texture.as_ref());
            p.sheen_color = self.color(factor, [0.0; 3], info, "sheenColorTexture")?;
            let (factor, info) = (e.sheen_roughness_factor, e.sheen_roughness_texture.as_ref());
            p.sheen_roughness = self.scalar(factor, 0.0, info, ALPHA, "sheenRoughnessTexture")?;
        }
        Ok(())
    }

    /// KHR_materials_pbrSpecularGlossiness, which is no longer recommended: a dielectric of its gloss.
    fn specular_glossiness(&mut self, old: &SpecularGlossiness) -> Result<Scattering> {
        let (info, field) = (
            old.specular_glossiness_texture.as_ref(),
            "extensions.KHR_materials_pbrSpecularGlossiness.specularGlossinessTexture",
        );
        let glossiness = self.scalar(old.glossiness_factor, 1.0, info, ALPHA, field)?;
        let specular = self.color(old.specular_factor, [1.0; 3], info, field)?;
        Ok(Scattering::Principled(Box::new(Principled {
            metallic: Scalar::constant(0.0),
            facets: Facets::of(Scalar { complement: true, ..glossiness }),
            // A surface that reflects all, of which the colour leaves what it says.
            ior: 0.0,
            specular_color: specular,
            ..Principled::default()
        })))
    }

    /// One channel of a texture of numbers; a factor outside 0..1 is clamped.
    fn scalar(
        &mut self,
        factor: Option<Real>,
        default: f32,
        info: Option<&TextureInfo>,
        channel: usize,
        field: &str,
    ) -> Result<Scalar> {
        let factor = factor.map_or(default, |factor| factor.0.clamp(0.0, 1.0));
        let info = info.filter(|_| factor != 0.0);
        let texture = self.texture([factor; 4], info, field)?;
        Ok(Scalar { texture, channel, complement: false })
    }

    fn color(
        &mut self,
        factor: Option<[Real; 3]>,
        default: [f32; 3],
        info: Option<&TextureInfo>,
        field: &str,
    ) -> Result<Texture> {
        let [r, g, b] = factor.map_or(default, plain).map(|channel| channel.max(0.0));
        let info = info.filter(|_| [r, g, b] != [0.0; 3]);
        self.texture([r, g, b, 1.0], info, field)
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
        if strength == 0.0 && [r, g, b] != [0.0; 3] {
            let part = format!("{}.extensions.KHR_materials_emissive_strength", self.part);
            self.notes.add(part, "its emissiveStrength is 0: it emits nothing");
        }
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
        let found = self.pictures.of_texture(data, texture, &part, stands_in(field), self.notes)?;
        let Some(image) = found else {
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

/// What is shown where the picture of a field is missing.
fn stands_in(field: &str) -> &'static str {
    match field {
        _ if field.ends_with("ormalTexture") => "no relief is shown",
        "occlusionTexture" => "no ambient light is kept out",
        _ => "a checkerboard is shown",
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

/// KHR_materials_volume: what is inside, if the surface has one that light gets into.
fn interior(extensions: &MaterialExtensions) -> Option<Interior> {
    let volume = extensions.volume.as_ref()?;
    volume.thickness_factor.filter(|thickness| thickness.0 > 0.0)?;
    let ior = extensions.ior.as_ref().and_then(|e| e.ior).map_or(1.5, |ior| ior.0);
    let color = Rgb::from_array(volume.attenuation_color.map_or([1.0; 3], plain));
    let distance = volume.attenuation_distance.map_or(f32::INFINITY, |distance| distance.0);
    let dispersion = extensions.dispersion.as_ref().and_then(|e| e.dispersion);
    Some(Interior {
        // The extension's number is 20 over the Abbe number.
        dispersion: dispersion.map_or(0.0, |dispersion| dispersion.0.max(0.0) / 20.0),
        absorption: Interior::absorption(color, distance.max(f32::MIN_POSITIVE)),
        ..Interior::clear(ior.max(1.0))
    })
}
