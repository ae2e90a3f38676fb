//! How much of the light a smooth boundary reflects.

use crate::color::Rgb;
use glam::Vec3Swizzles as _;
use glam::{Mat3, Vec3};
use std::f32::consts::{PI, TAU};

/// Unpolarised reflectance of a boundary between two dielectrics, and the cosine of the refracted direction; `None` if
/// all is reflected. `cos`: of the incident direction, 0..1; `eta`: index beyond over index here.
///
/// In double precision: near the angle from which on all is reflected, the curve is steep.
pub(crate) fn dielectric(cos: f64, eta: f64) -> (f64, Option<f64>) {
    let sin2_beyond = (1.0 - cos * cos).max(0.0) / (eta * eta);
    if sin2_beyond >= 1.0 {
        return (1.0, None);
    }
    let beyond = (1.0 - sin2_beyond).sqrt();
    let s = (cos - eta * beyond) / (cos + eta * beyond);
    let p = (eta * cos - beyond) / (eta * cos + beyond);
    (0.5 * (s * s + p * p), Some(beyond))
}

/// The cosine outside of a solid of light that meets its boundary with a cosine from either side; `None` if all is reflected.
/// `eta`: index beyond over index here.
pub(crate) fn outside_cos(cos: f32, eta: f32) -> Option<f32> {
    if eta >= 1.0 {
        return Some(cos);
    }
    dielectric(cos.into(), eta.into()).1.map(|cos| cos as f32)
}

/// What a boundary reflects of light that arrives with a given cosine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Fresnel {
    /// From `normal` at normal incidence to `grazing` (Schlick 1994).
    Schlick {
        /// At normal incidence, 0..1.
        normal: Rgb,
        /// At grazing incidence, 0..1.
        grazing: f32,
    },
    /// A metal with a complex index n + ik per channel.
    Conductor {
        /// n
        n: Rgb,
        /// k
        k: Rgb,
    },
}

impl Fresnel {
    /// The fraction reflected, per channel.
    pub(crate) fn at(&self, cos: f32) -> Rgb {
        match *self {
            Self::Schlick { normal, grazing } => normal + (grazing - normal) * schlick_weight(cos),
            Self::Conductor { n, k } => {
                Rgb::from_array(std::array::from_fn(|c| conductor(cos, n[c], k[c])))
            }
        }
    }
}

/// What a boundary of a solid reflects from outside, if that is not what its index says (KHR_materials_specular,
/// _iridescence): by Schlick's formula.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Gloss {
    /// At normal incidence, 0..1.
    pub normal: Rgb,
    /// At grazing incidence, 0..1.
    pub grazing: f32,
}

impl Gloss {
    /// The fraction reflected of light that arrives with a cosine from either side; `eta`: index beyond over index here.
    pub(crate) fn at(self, cos: f32, eta: f32) -> Rgb {
        let Self { normal, grazing } = self;
        let outside = outside_cos(cos, eta);
        outside.map_or(Rgb::ONE, |cos| Fresnel::Schlick { normal, grazing }.at(cos))
    }
}

/// (1 − cos)⁵
pub(crate) fn schlick_weight(cos: f32) -> f32 {
    let m = (1.0 - cos).clamp(0.0, 1.0);
    let m2 = m * m;
    m2 * m2 * m
}

/// Unpolarised reflectance of a metal with index `n` + i`k` seen from air (Born & Wolf §14.2).
pub(crate) fn conductor(cos: f32, n: f32, k: f32) -> f32 {
    let (n, k, cos2) = (f64::from(n), f64::from(k), f64::from(cos * cos));
    let (cos, sin2) = (f64::from(cos), 1.0 - cos2);
    let t0 = n * n - k * k - sin2;
    let a2_plus_b2 = (t0 * t0 + 4.0 * n * n * k * k).sqrt();
    let a = (0.5 * (a2_plus_b2 + t0)).max(0.0).sqrt();
    let s = (a2_plus_b2 + cos2 - 2.0 * a * cos) / (a2_plus_b2 + cos2 + 2.0 * a * cos);
    let (even, odd) = (cos2 * a2_plus_b2 + sin2 * sin2, 2.0 * a * cos * sin2);
    let p = s * (even - odd) / (even + odd);
    (0.5 * (s + p)) as f32
}

/// Reflectance at normal incidence between two indices whose ratio is `eta`.
pub(crate) fn normal_reflectance(eta: f32) -> f32 {
    let r = (eta - 1.0) / (eta + 1.0);
    r * r
}

/// Reflectance at normal incidence of a surface under a thin film, as Schlick's formula is to be given it so that it
/// has the right value at this `cos`. `index` of the film and `thickness` in nm; `below`: the surface's own.
///
/// Belcour & Barla, *A Practical Extension to Microfacet Theory for the Modeling of Varying Iridescence*, 2017, as
/// KHR_materials_iridescence prescribes it.
pub(crate) fn thin_film(cos: f32, index: f32, thickness: f32, below: Rgb) -> Rgb {
    let reflected = film_reflectance(cos, index, thickness, below);
    let weight = schlick_weight(cos).min(0.9999);
    ((reflected - weight) / (1.0 - weight)).clamp(Rgb::ZERO, Rgb::ONE)
}

fn film_reflectance(cos: f32, index: f32, thickness: f32, below: Rgb) -> Rgb {
    let fade = (thickness / 0.03).clamp(0.0, 1.0);
    let index = 1.0 + (index - 1.0) * fade * fade * (3.0 - 2.0 * fade);
    let sin2_film = (1.0 - cos * cos) / (index * index);
    if sin2_film >= 1.0 {
        return Rgb::ONE;
    }
    let cos_film = (1.0 - sin2_film).sqrt();
    let schlick = |normal: f32, cos: f32| normal + (1.0 - normal) * schlick_weight(cos);
    let r12 = schlick(normal_reflectance(index), cos);
    let t121 = 1.0 - r12;
    let phi21 = if index < 1.0 { 0.0 } else { PI };
    let root = below.clamp(Rgb::ZERO, Rgb::splat(0.9999)).map(f32::sqrt);
    let base_index = (1.0 + root) / (1.0 - root);
    let r23 = base_index.map(|base| schlick(normal_reflectance(base / index), cos_film));
    let phi = base_index.map(|base| phi21 + if base < index { PI } else { 0.0 });
    let path_difference = 2.0 * index * thickness * cos_film;
    let r123 = (r12 * r23).clamp(Rgb::ZERO, Rgb::splat(0.9999));
    let rs = t121 * t121 * r23 / (1.0 - r123);
    let mut sum = r12 + rs;
    let mut amplitude = rs - t121;
    for order in 1..=2 {
        let order = order as f32;
        amplitude *= r123.map(f32::sqrt);
        sum += amplitude * 2.0 * sensitivity(order * path_difference, order * phi);
    }
    sum.max(Rgb::ZERO)
}

/// Fourier transform of the eye's sensitivity, linear Rec. 709: Gaussians fitted to the CIE functions, for an optical
/// path difference in nm and a phase shift per channel.
fn sensitivity(path_difference: f32, shift: Rgb) -> Rgb {
    let phase = TAU * path_difference * 1e-9;
    let height = Vec3::new(5.4856e-13, 4.4201e-13, 5.2481e-13);
    let place = Vec3::new(1.6810e6, 1.7953e6, 2.2084e6);
    let spread = Vec3::new(4.3278e9, 9.3046e9, 6.6121e9);
    let wave = |height: f32, place: f32, spread: f32, shift: f32| {
        height
            * (TAU * spread).sqrt()
            * (place * phase + shift).cos()
            * (-spread * phase * phase).exp()
    };
    let mut xyz =
        Vec3::from_array(std::array::from_fn(|c| wave(height[c], place[c], spread[c], shift[c])));
    xyz.x += wave(9.7470e-14, 2.2399e6, 4.5282e9, shift.x);
    xyz_to_rec709() * (xyz / 1.0685e-7).xyz()
}

fn xyz_to_rec709() -> Mat3 {
    Mat3::from_cols_array(&[
        3.2404542, -0.969266, 0.0556434, -1.5371385, 1.8760108, -0.2040259, -0.4985314, 0.041556,
        1.0572252,
    ])
}
