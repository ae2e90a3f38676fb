//! MTL materials as glTF's: by their PBR keys, or by what Phong's meant.

use super::mtl::{Library, Map, Mtl};
use crate::color::Rgb;
use crate::diagnostic::{Diagnostic, Place};
use crate::io::pictures::{Named, Pictures, Range, SQUARES, only_picture};
use crate::io::text::{Tally, counted, did_you_mean, quoted};
use crate::io::triangles::default_material;
use crate::io::{FileAccess, Warnings};
use crate::scene::description::{
    Alpha, BumpAmount, BumpMap, Facets, Interior, Material, NormalMap, Principled, Scalar,
    Scattering, SceneDescription, Texture,
};
use crate::shading::texture::Role;
use glam::{Vec3, Vec4};
use indexmap::IndexMap;
use std::f32::consts::TAU;

/// What is shown where pictures of relief and of cut-outs cannot be used.
const NO_RELIEF: &str = "no relief is shown";
const UNCUT: &str = "nothing is cut out";

/// The channel of a picture that says where it is transparent.
const ALPHA: usize = 3;

/// Adds the materials `used` (by name, with their first place) to `scene`, in their order.
///
/// `colored`: the vertices have colours, which multiply the reflectance.
pub(super) fn add_materials(
    scene: &mut SceneDescription,
    used: &IndexMap<String, Place>,
    library: &Library,
    colored: bool,
    access: &FileAccess,
    warnings: &mut Warnings,
) {
    let mut maker =
        Maker { pictures: Pictures::new(access), warnings, tallies: Tallies::default() };
    for name in used.keys() {
        let mut material = match library.materials.get(name) {
            Some(mtl) => maker.material(name, mtl),
            None if colored => Material { name: name.clone(), ..Material::matte("", Rgb::ONE) },
            None => Material { name: name.clone(), ..default_material() },
        };
        if name.is_empty() {
            material.name = default_material().name;
        }
        material.reflectance.vertex_colors = colored;
        scene.materials.push(material);
    }
    let Maker { pictures, warnings, tallies } = maker;
    scene.images = pictures.finish(warnings);
    tallies.warn(warnings);
    warn_undescribed(used, library, warnings);
}

/// The index of refraction, if the illumination model is one of glass.
fn glass(mtl: &Mtl) -> Option<f32> {
    let refracts = [4.0, 6.0, 7.0, 9.0].contains(&mtl.illumination?);
    mtl.index.filter(|&index| refracts && index > 1.0)
}

/// Pr, or the roughness whose highlights are as wide as Phong's with the exponent Ns (Walter et al. 2007).
fn roughness(mtl: &Mtl, default: f32) -> f32 {
    let from_phong = |exponent: f32| (2.0 / (exponent.max(0.0) + 2.0)).sqrt().sqrt();
    let default = if mtl.roughness_map.is_some() { 1.0 } else { default };
    let written =
        mtl.roughness.or(mtl.shininess.filter(|_| mtl.roughness_map.is_none()).map(from_phong));
    written.unwrap_or(default).clamp(0.0, 1.0)
}

/// What has to multiply the 0.04 that index 1.5 reflects. Where the illumination model mirrors, Ks is what is mirrored;
/// otherwise it is a matter of taste, and 0.5 means the usual gloss, as in Blender.
fn specular_color(mtl: &Mtl, specular: Rgb) -> Rgb {
    let mirrors = mtl.illumination.is_some_and(|model| [3.0, 5.0, 8.0].contains(&model));
    let specular = specular.clamp(Rgb::ZERO, Rgb::ONE);
    if mirrors { specular / 0.04 } else { specular / 0.5 }
}

fn fraction(value: Option<f32>, default: f32) -> f32 {
    value.unwrap_or(default).clamp(0.0, 1.0)
}

/// One warning for all materials that no material file describes.
fn warn_undescribed(used: &IndexMap<String, Place>, library: &Library, warnings: &mut Warnings) {
    let known = |name: &String| name.is_empty() || library.materials.contains_key(name);
    let mut unknown = used.iter().filter(|(name, _)| !known(name));
    let Some((first, place)) = unknown.next() else { return };
    let more = match unknown.count() {
        0 => String::new(),
        more => format!(" and {} more", counted(more, "material")),
    };
    let message = format!(
        "no material file describes {}{more}: shown in matte grey",
        quoted(first.as_bytes())
    );
    let help = did_you_mean(first, library.materials.keys().map(String::as_str));
    warnings.push(Diagnostic { message, place: place.clone(), help, ..Diagnostic::default() });
}

/// Makes materials and counts what cannot be shown.
struct Maker<'a> {
    pictures: Pictures<'a>,
    warnings: &'a mut Warnings,
    tallies: Tallies,
}

#[derive(Default)]
struct Tallies {
    bright: Tally,
    black: Tally,
    invisible: Tally,
    glowing: Tally,
}

impl Maker<'_> {
    fn material(&mut self, name: &str, mtl: &Mtl) -> Material {
        let opacity = self.opacity(mtl);
        let reflectance = self.reflectance(mtl, opacity);
        let cut_out = self.has_cut_outs(mtl, &reflectance);
        let mask = self.mask(mtl);
        let emission = mtl.emission.unwrap_or(match mtl.emission_map {
            Some(_) => Rgb::ONE,
            None => Rgb::ZERO,
        });
        let emission = emission.max(Rgb::ZERO);
        let map = mtl.emission_map.as_ref().filter(|_| emission != Rgb::ZERO);
        self.tallies.glowing.add_if(emission != Rgb::ZERO, || mtl.place.clone());
        let (heights, bent) = self.relief(mtl);
        let matte = Material {
            reflectance,
            normal: bent.and_then(|map| self.normal(map)),
            bump: heights.and_then(|map| self.bump(map)),
            emission: self.texture(emission, 1.0, map),
            alpha: match opacity < 1.0 || cut_out || mask.is_some() {
                true => Alpha::Blend,
                false => Alpha::Opaque,
            },
            opacity: mask,
            ..Material::matte(name, Rgb::ZERO)
        };
        match glass(mtl) {
            Some(index) => self.glass(matte, mtl, index),
            None => self.gloss(matte, mtl),
        }
    }

    /// Its maps of heights and of normals. Many programs write normals where heights belong; heights have no colour.
    fn relief<'m>(&mut self, mtl: &'m Mtl) -> (Option<&'m Map>, Option<&'m Map>) {
        let (heights, normals) = (mtl.bump_map.as_ref(), mtl.normal_map.as_ref());
        let colored = heights.filter(|map| map.channel.is_none()).is_some_and(|map| {
            let texture = self.picture([1.0; 4], map, None, NO_RELIEF);
            self.pictures.is_colored(&texture)
        });
        if colored { (None, normals.or(heights)) } else { (heights, normals) }
    }

    /// Heights; MTL does not say in which unit, so a height of 1 is a hundredth of the picture's width.
    fn bump(&mut self, map: &Map) -> Option<BumpMap> {
        // From which height on makes no difference, so of -mm the gain is enough.
        let texture = only_picture(self.picture([1.0; 4], map, None, NO_RELIEF))?;
        let height = Scalar { texture, channel: map.channel.unwrap_or(0), complement: false };
        let amount = BumpAmount::Relative(0.01 * map.strength * map.gain);
        Some(BumpMap { height, amount })
    }

    fn normal(&mut self, map: &Map) -> Option<NormalMap> {
        let texture = only_picture(self.numbers([1.0; 4], map, NO_RELIEF))?;
        Some(NormalMap { texture, scale: map.strength })
    }

    /// A solid that refracts; its colour is Tf, and d says nothing that Tf does not say better.
    fn glass(&mut self, matte: Material, mtl: &Mtl, ior: f32) -> Material {
        let tint = mtl.filter.unwrap_or(Rgb::ONE).clamp(Rgb::ZERO, Rgb::ONE);
        let principled = Principled {
            metallic: Scalar::constant(0.0),
            facets: Facets::of(Scalar::constant(roughness(mtl, 0.0))),
            ior,
            transmission: Scalar::constant(1.0),
            ..Principled::default()
        };
        Material {
            reflectance: Texture::constant(tint),
            scattering: Scattering::Principled(Box::new(principled)),
            interior: Some(Interior::clear(ior)),
            alpha: Alpha::Opaque,
            opacity: None,
            ..matte
        }
    }

    /// A matte ground under gloss, or metal, if the file knows of either.
    fn gloss(&mut self, matte: Material, mtl: &Mtl) -> Material {
        let physical = mtl.metallic.is_some() || mtl.roughness.is_some();
        let coated = mtl.clearcoat.is_some() || mtl.sheen.is_some() || mtl.anisotropy.is_some();
        let maps = [
            &mtl.metallic_map,
            &mtl.roughness_map,
            &mtl.clearcoat_map,
            &mtl.sheen_map,
            &mtl.anisotropy_map,
        ];
        let mapped = maps.into_iter().any(Option::is_some);
        let phong = mtl.specular.filter(|specular| *specular != Rgb::ZERO);
        if !(physical || mapped || coated || phong.is_some()) {
            return matte;
        }
        let specular = phong.map_or(Rgb::ONE, |specular| specular_color(mtl, specular));
        let principled = Principled {
            metallic: self.scalar(mtl.metallic, 0.0, mtl.metallic_map.as_ref()),
            facets: Facets {
                anisotropy: self.scalar(mtl.anisotropy, 0.0, mtl.anisotropy_map.as_ref()),
                rotation: mtl.anisotropy_rotation.unwrap_or(0.0) * TAU,
                ..Facets::of(self.scalar(
                    Some(roughness(mtl, 0.5)),
                    0.5,
                    mtl.roughness_map.as_ref(),
                ))
            },
            specular_color: self.texture(specular, 1.0, mtl.specular_map.as_ref()),
            clearcoat: self.scalar(mtl.clearcoat, 0.0, mtl.clearcoat_map.as_ref()),
            clearcoat_roughness: self.scalar(
                mtl.clearcoat_roughness,
                0.0,
                mtl.clearcoat_roughness_map.as_ref(),
            ),
            sheen_color: self.sheen(mtl),
            sheen_roughness: Scalar::constant(0.5),
            ..Principled::default()
        };
        Material { scattering: Scattering::Principled(Box::new(principled)), ..matte }
    }

    /// Ps, whose picture holds numbers where glTF has colours.
    fn sheen(&mut self, mtl: &Mtl) -> Texture {
        let sheen = fraction(mtl.sheen, if mtl.sheen_map.is_some() { 1.0 } else { 0.0 });
        let constant = Texture::constant(Rgb::splat(sheen));
        let Some(map) = mtl.sheen_map.as_ref().filter(|_| sheen != 0.0) else { return constant };
        let (gain, base) = (Vec4::splat(map.gain), Vec4::splat(map.base));
        let range = Range { role: Role::Data, gain, base, channel: Some(map.channel.unwrap_or(0)) };
        self.picture(constant.factor, map, Some(range), SQUARES)
    }

    /// A number, which multiplies its picture; with a picture alone, 1.
    fn scalar(&mut self, value: Option<f32>, default: f32, map: Option<&Map>) -> Scalar {
        let value = fraction(value, if map.is_some() { 1.0 } else { default });
        let Some(map) = map.filter(|_| value != 0.0) else { return Scalar::constant(value) };
        let texture = self.numbers([value; 4], map, SQUARES);
        Scalar { texture, channel: map.channel.unwrap_or(0), complement: false }
    }

    fn texture(&mut self, color: Rgb, alpha: f32, map: Option<&Map>) -> Texture {
        let factor = color.extend(alpha).to_array();
        let Some(map) = map else {
            return Texture { factor, ..Texture::constant(color) };
        };
        self.picture(factor, map, color_range(map, None), SQUARES)
    }

    /// Kd and its picture, whose alpha is as map_d has it if that names the same picture.
    fn reflectance(&mut self, mtl: &Mtl, opacity: f32) -> Texture {
        let color = self.diffuse(mtl);
        let Some(map) = &mtl.diffuse_map else { return self.texture(color, opacity, None) };
        let factor = color.extend(opacity).to_array();
        let as_it_is = self.picture(factor, map, None, SQUARES);
        let cut_out = masks_itself(mtl) && self.pictures.is_transparent(&as_it_is);
        let alpha = mtl.opacity_map.as_ref().filter(|_| cut_out);
        self.picture(factor, map, color_range(map, alpha), SQUARES)
    }

    /// A picture of numbers instead of colours.
    fn numbers(&mut self, factor: [f32; 4], map: &Map, otherwise: &'static str) -> Texture {
        let (gain, base) = (Vec4::splat(map.gain), Vec4::splat(map.base));
        self.picture(factor, map, range(Role::Data, gain, base), otherwise)
    }

    fn picture(
        &mut self,
        factor: [f32; 4],
        map: &Map,
        range: Option<Range>,
        otherwise: &'static str,
    ) -> Texture {
        let Map { file, transform, wrap, place, .. } = map;
        let (transform, wrap, place) = (*transform, *wrap, place.clone());
        let named = Named { file, factor, transform, wrap, range, place, otherwise };
        self.pictures.texture(named, self.warnings)
    }

    /// Kd; if it is not given, white under a picture and grey otherwise.
    fn diffuse(&mut self, mtl: &Mtl) -> Rgb {
        let with_map = mtl.diffuse_map.is_some();
        let color = mtl.diffuse.unwrap_or(Rgb::splat(if with_map { 1.0 } else { 0.5 }));
        self.tallies.bright.add_if(color.max_element() > 1.0, || mtl.place.clone());
        let hidden = with_map && color == Rgb::ZERO;
        self.tallies.black.add_if(hidden, || mtl.place.clone());
        if hidden { Rgb::ONE } else { color.clamp(Rgb::ZERO, Rgb::ONE) }
    }

    /// d, or 1 - Tr. Many programs write `Tr 1` for solid surfaces, so that alone hides nothing.
    fn opacity(&mut self, mtl: &Mtl) -> f32 {
        let invisible = mtl.opacity.is_none() && mtl.transparency == Some(1.0);
        self.tallies.invisible.add_if(invisible, || mtl.place.clone());
        match (mtl.opacity, mtl.transparency) {
            (Some(opacity), _) => opacity,
            (None, Some(transparency)) if !invisible => 1.0 - transparency,
            _ => 1.0,
        }
    }

    /// Whether map_d means the alpha of map_Kd, and that is transparent somewhere.
    fn has_cut_outs(&mut self, mtl: &Mtl, reflectance: &Texture) -> bool {
        masks_itself(mtl) && self.pictures.is_transparent(reflectance)
    }

    /// A map_d that is another picture than map_Kd, or one of its colours: its alpha if it has one, else how bright it is.
    fn mask(&mut self, mtl: &Mtl) -> Option<Scalar> {
        let map = mtl.opacity_map.as_ref().filter(|_| !masks_itself(mtl))?;
        let as_it_is = self.picture([1.0; 4], map, None, UNCUT);
        let alpha = self.pictures.is_transparent(&as_it_is).then_some(ALPHA);
        let texture = only_picture(self.numbers([1.0; 4], map, UNCUT))?;
        let channel = map.channel.or(alpha).unwrap_or(0);
        Some(Scalar { texture, channel, complement: false })
    }
}

/// How -mm changes a picture of colours, and its alpha that of `alpha`, if they do.
fn color_range(map: &Map, alpha: Option<&Map>) -> Option<Range> {
    let (gain, base) = alpha.map_or((1.0, 0.0), |map| (map.gain, map.base));
    let gain = Vec3::splat(map.gain).extend(gain);
    range(Role::Color, gain, Vec3::splat(map.base).extend(base))
}

fn range(role: Role, gain: Vec4, base: Vec4) -> Option<Range> {
    let changes = (gain, base) != (Vec4::ONE, Vec4::ZERO);
    changes.then_some(Range { role, gain, base, channel: None })
}

/// Whether map_d names the same picture as map_Kd, and none of its colours.
fn masks_itself(mtl: &Mtl) -> bool {
    let (Some(mask), Some(diffuse)) = (&mtl.opacity_map, &mtl.diffuse_map) else { return false };
    mask.file == diffuse.file && mask.channel.is_none_or(|channel| channel == ALPHA)
}

impl Tallies {
    fn warn(self, warnings: &mut Warnings) {
        let materials = |count| counted(count, "material");
        self.bright.warn(warnings, |count| {
            format!("{} with Kd above 1, clamped: nothing reflects more than all", materials(count))
        });
        self.black.warn(warnings, |count| {
            format!(
                "{} with a picture and black Kd, which would hide it: taken as white",
                materials(count)
            )
        });
        self.invisible.warn(warnings, |count| {
            format!("{} with Tr 1, taken as solid (d 0 makes them invisible)", materials(count))
        });
        self.glowing.warn(warnings, |count| {
            format!("{} with Ke: they light others only by the path integrator", materials(count))
        });
    }
}
