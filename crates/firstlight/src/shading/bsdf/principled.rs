//! glTF's metallic-roughness surface with its ratified extensions, at one point.

use super::Kind;
use super::fresnel::{Fresnel, Gloss, normal_reflectance, outside_cos, thin_film};
use super::layers::{Alpha, Layers};
use crate::color::Rgb;
use glam::{Vec2, Vec3};

/// The parameters after textures were looked up, named as in glTF 2.0 and KHR_materials_*.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PrincipledPoint {
    /// baseColor, 0..1.
    pub base_color: Rgb,
    /// metallic, 0..1.
    pub metallic: f32,
    /// Widths of the facets along the anisotropy's direction and across it.
    pub alpha: Alpha,
    /// Index of refraction, at least 1; infinite: reflects all, as KHR_materials_ior has it for 0.
    pub ior: f32,
    /// specular, 0..1.
    pub specular: f32,
    /// specularColor, 0 or more.
    pub specular_color: Rgb,
    /// transmission, 0..1.
    pub transmission: f32,
    /// diffuseTransmission, 0..1.
    pub diffuse_transmission: f32,
    /// diffuseTransmissionColor, 0..1.
    pub diffuse_transmission_color: Rgb,
    /// clearcoat, 0..1.
    pub clearcoat: f32,
    /// clearcoatRoughness, 0..1.
    pub clearcoat_roughness: f32,
    /// clearcoatNormal, in the frame of the surface; its third coordinate is positive.
    pub clearcoat_normal: Vec3,
    /// sheenColor, 0..1.
    pub sheen_color: Rgb,
    /// sheenRoughness, 0..1.
    pub sheen_roughness: f32,
    /// iridescence, 0..1.
    pub iridescence: f32,
    /// iridescenceIor, at least 1.
    pub iridescence_ior: f32,
    /// iridescenceThickness, nm.
    pub iridescence_thickness: f32,
    /// What the surface is to light that passes.
    pub wall: Wall,
}

/// What lies behind a surface that light passes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Wall {
    /// The same as before it.
    Thin,
    /// Another medium.
    Solid {
        /// Index beyond over index here.
        eta: f32,
        /// Whether the surface is seen from within its own solid.
        inside: bool,
    },
}

impl Default for PrincipledPoint {
    /// What glTF says where a file says nothing.
    fn default() -> Self {
        Self {
            base_color: Rgb::ONE,
            metallic: 1.0,
            alpha: Vec2::ONE,
            ior: 1.5,
            specular: 1.0,
            specular_color: Rgb::ONE,
            transmission: 0.0,
            diffuse_transmission: 0.0,
            diffuse_transmission_color: Rgb::ONE,
            clearcoat: 0.0,
            clearcoat_roughness: 0.0,
            clearcoat_normal: Vec3::Z,
            sheen_color: Rgb::ZERO,
            sheen_roughness: 0.0,
            iridescence: 0.0,
            iridescence_ior: 1.3,
            iridescence_thickness: 400.0,
            wall: Wall::Thin,
        }
    }
}

/// Adds the lobes of a point, from the top: coat, sheen, and a mix of metal and dielectric.
pub(crate) fn principled(layers: &mut Layers<'_>, p: &PrincipledPoint) {
    let inside = matches!(p.wall, Wall::Solid { inside: true, .. });
    if p.clearcoat > 0.0 && !inside {
        let alpha = Vec2::splat(p.clearcoat_roughness.powi(2));
        layers.coat(p.clearcoat, alpha, p.clearcoat_normal);
    }
    if p.sheen_color != Rgb::ZERO && !inside {
        layers.sheen(p.sheen_color, p.sheen_roughness.powi(2));
    }
    let left = layers.left;
    if p.metallic > 0.0 {
        layers.left = left * p.metallic;
        let normal = p.under_film(layers.outgoing.z, p.base_color);
        layers.facets(Fresnel::Schlick { normal, grazing: 1.0 }, p.alpha);
    }
    layers.left = left * (1.0 - p.metallic);
    p.add_dielectric(layers);
}

impl PrincipledPoint {
    /// What a surface that reflects `normal` at normal incidence reflects there under the thin film.
    fn under_film(&self, cos: f32, normal: Rgb) -> Rgb {
        if self.iridescence <= 0.0 {
            return normal;
        }
        let film = thin_film(cos, self.iridescence_ior, self.iridescence_thickness, normal);
        normal.lerp(film, self.iridescence)
    }

    /// What is not metal: light that passes, and light that does not.
    fn add_dielectric(&self, layers: &mut Layers<'_>) {
        let (left, alpha) = (layers.left, self.alpha);
        layers.left = left * self.transmission;
        match self.wall {
            _ if self.transmission <= 0.0 => {}
            Wall::Thin => layers.pane(self.reflection(layers.outgoing.z), alpha, self.base_color),
            Wall::Solid { eta, .. } => {
                let gloss = self.gloss(layers.outgoing.z, eta);
                layers.glass(eta, alpha, self.base_color, gloss);
            }
        }
        layers.left = left * (1.0 - self.transmission);
        if layers.left != Rgb::ZERO {
            let reflected = layers.facets(self.reflection(layers.outgoing.z), alpha);
            layers.left *= 1.0 - reflected.max_element().min(1.0);
            let stays = Rgb::splat(1.0 - self.diffuse_transmission);
            layers.add(Kind::Lambert, self.base_color * stays, Rgb::ONE);
            let passes = self.diffuse_transmission_color * self.diffuse_transmission;
            layers.add(Kind::LambertThrough, passes, Rgb::ONE);
        }
    }

    /// What the boundary of a solid reflects, if that is not what its index says; seen with a cosine from either side.
    fn gloss(&self, cos: f32, eta: f32) -> Option<Gloss> {
        let plain = self.specular == 1.0 && self.specular_color == Rgb::ONE;
        if plain && self.iridescence <= 0.0 {
            return None;
        }
        let outside = outside_cos(cos, eta).unwrap_or(0.0);
        Some(Gloss { normal: self.normal(outside), grazing: self.specular })
    }

    /// The dielectric's reflection: KHR_materials_ior, _specular, _iridescence.
    fn reflection(&self, cos: f32) -> Fresnel {
        Fresnel::Schlick { normal: self.normal(cos), grazing: self.specular }
    }

    /// The same at normal incidence.
    fn normal(&self, cos: f32) -> Rgb {
        let base = if self.ior.is_finite() { normal_reflectance(self.ior) } else { 1.0 };
        let normal = (base * self.specular_color).min(Rgb::ONE) * self.specular;
        self.under_film(cos, normal)
    }
}
