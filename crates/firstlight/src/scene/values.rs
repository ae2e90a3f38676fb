//! What a material's textures say at one point, by name.

use super::Scene;
use super::description::{Facets, Interior, Material, Principled, Scalar, Scattering, Texture};
use crate::color::Rgb;
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::texture::Role;
use glam::Vec4Swizzles;

/// A parameter of a material as it is at a point: one number, or one per colour channel.
pub(crate) type Named = (&'static str, Vec<f32>);

/// Looks up parameters at a point.
struct Reader<'a> {
    scene: &'a Scene,
    at: &'a SurfaceInteraction,
    values: Vec<Named>,
}

impl Scene {
    /// The parameters of `material` at a point, textures looked up. Of those that add something, such as a coat, only
    /// the ones that do.
    pub(crate) fn values(&self, material: &Material, at: &SurfaceInteraction) -> Vec<Named> {
        let mut reader = Reader { scene: self, at, values: Vec::new() };
        reader.material(material);
        reader.values
    }
}

impl Scene {
    /// Perceptual roughness of `material` at a point, 0..1: 1 where it is matte, 0 where it mirrors.
    pub(crate) fn roughness(&self, material: &Material, at: &SurfaceInteraction) -> f32 {
        if material.is_matte() {
            return 1.0;
        }
        let values = self.values(material, at);
        values.iter().find(|(name, _)| *name == "roughness").map_or(0.0, |(_, value)| value[0])
    }
}

impl Reader<'_> {
    fn color(&mut self, name: &'static str, texture: &Texture) {
        let color = self.scene.evaluate(texture, self.at).xyz();
        self.values.push((name, color.to_array().to_vec()));
    }

    fn number(&mut self, name: &'static str, scalar: &Scalar) {
        let value = self.scene.look_up(&scalar.texture, self.at, Role::Data)[scalar.channel];
        self.values.push((name, vec![scalar.meant(value)]));
    }

    /// A part that is added to the rest, unless it is nowhere.
    fn addition(&mut self, name: &'static str, scalar: &Scalar) {
        if !scalar.is(0.0) {
            self.number(name, scalar);
        }
    }

    fn material(&mut self, material: &Material) {
        match &material.scattering {
            Scattering::Matte { roughness } => {
                self.color("reflectance", &material.reflectance);
                self.addition("roughness", roughness);
            }
            Scattering::Mirror { mirrored } => {
                self.color("mirrored", mirrored);
                self.color("reflectance", &material.reflectance);
            }
            Scattering::Conductor { index, facets } => {
                self.color("color", &material.reflectance);
                let index = index.map(|index| [("n", index.n), ("k", index.k)]);
                let named = |(name, value): (_, glam::Vec3)| (name, value.to_array().to_vec());
                self.values.extend(index.into_iter().flatten().map(named));
                self.facets(facets);
            }
            Scattering::Dielectric { facets } => {
                self.color("tint", &material.reflectance);
                self.facets(facets);
            }
            Scattering::ThinGlass { index } => {
                self.color("tint", &material.reflectance);
                self.values.push(("index", vec![*index]));
            }
            Scattering::Principled(principled) => {
                self.color("base_color", &material.reflectance);
                self.principled(principled);
            }
            Scattering::Mix { amount, .. } => self.number("amount", amount),
        }
        if let Some(map) = &material.occlusion {
            self.number("occlusion", &map.open);
        }
        if let Some(opacity) = &material.opacity {
            self.number("opacity", opacity);
        }
        self.interior(material.interior.as_ref());
        if material.emits() {
            self.color("emission", &material.emission);
        }
        if material.unlit {
            self.values.push(("unlit", vec![1.0]));
        }
    }

    fn facets(&mut self, facets: &Facets) {
        self.number("roughness", &facets.roughness);
        self.addition("anisotropy", &facets.anisotropy);
        if !facets.multiple_scattering {
            self.values.push(("multiple_scattering", vec![0.0]));
        }
    }

    fn principled(&mut self, p: &Principled) {
        self.number("metallic", &p.metallic);
        self.facets(&p.facets);
        self.values.push(("ior", vec![p.ior]));
        let additions = [
            ("transmission", &p.transmission),
            ("diffuse_transmission", &p.diffuse_transmission),
            ("clearcoat", &p.clearcoat),
            ("iridescence", &p.iridescence),
        ];
        additions.into_iter().for_each(|(name, scalar)| self.addition(name, scalar));
        if !p.iridescence.is(0.0) {
            let thickness = self.scene.film_thickness(p, self.at);
            self.values.push(("iridescence_thickness", vec![thickness]));
        }
        if p.sheen_color.factor[..3] != [0.0; 3] {
            self.color("sheen_color", &p.sheen_color);
        }
    }

    fn interior(&mut self, interior: Option<&Interior>) {
        let Some(interior) = interior else { return };
        self.values.push(("index", vec![interior.index]));
        self.values.push(("absorption", interior.absorption.to_array().to_vec()));
        if interior.scattering != Rgb::ZERO {
            self.values.push(("scattering", interior.scattering.to_array().to_vec()));
            self.values.push(("g", vec![interior.anisotropy]));
        }
    }
}
