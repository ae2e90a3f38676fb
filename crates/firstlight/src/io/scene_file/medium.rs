//! `[medium]` and `[materials.name.medium]`: fog, smoke, milk.

use super::color::{Color, Reflectance};
use super::document::{At, Document};
use crate::color::Rgb;
use crate::diagnostic::Diagnostic;
use crate::diagnostic::Result;
use crate::scene::description::{
    Facets, Integrator, Interior, Light, Material, Medium, Scalar, Scattering, SceneDescription,
};
use crate::units::written::{Checked, Number, Written, written};
use schemars::JsonSchema;
use serde::Deserialize;

/// What fills space, alike everywhere: `absorption` and `scattering`, or `extinction` and `albedo`; per channel, 1/m.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub(super) struct MediumKeys {
    /// What is absorbed per metre. Default 0.
    #[serde(alias = "sigma_a")]
    absorption: Option<At<Color>>,
    /// What is scattered per metre. Default 0.
    #[serde(alias = "sigma_s")]
    scattering: Option<At<Color>>,
    /// What is lost per metre, absorbed and scattered. Default 0.
    #[serde(alias = "sigma_t", alias = "density")]
    extinction: Option<At<Color>>,
    /// The part of `extinction` that is scattered, 0 to 1. Default 1.
    albedo: Option<At<Reflectance>>,
    /// Where it is scattered to, -1 (back) to 1 (straight on), both excluded; 0: everywhere alike. Default 0.
    #[serde(alias = "anisotropy")]
    g: Option<Asymmetry>,
}

/// Mean cosine of the angle of scattering.
#[derive(Debug, Clone, Copy)]
struct Asymmetry(f64);

impl Asymmetry {
    /// Beyond that, nothing is scattered to where light could be looked for.
    const MOST: f64 = 0.999;
}

impl Written for Asymmetry {
    const EXPECTED: &'static str = "a mean cosine between -1 and 1";
    fn from_number(number: f64) -> Checked<Self> {
        if number.abs() <= Self::MOST {
            return Ok(Self(number));
        }
        Err(format!("must be from -{most} to {most}, not {number}", most = Self::MOST))
    }
    fn from_text(text: &str) -> Checked<Self> {
        Number::from_text(text).and_then(|Number(number)| Self::from_number(number))
    }
}

written! {
    Asymmetry: { "type": "number", "minimum": -Asymmetry::MOST, "maximum": Asymmetry::MOST }
}

impl MediumKeys {
    pub(super) fn describe(self, document: &Document<'_>) -> Result<Medium> {
        let Self { absorption, scattering, extinction, albedo, g } = self;
        let color = |key: Option<At<Color>>| match key {
            Some(At { value: Color(color), span }) if color.max_element() > Interior::DENSEST => {
                let message = format!("must be at most {:e} per metre", Interior::DENSEST);
                Err(document.error(&span, message))
            }
            key => Ok(key.map_or(Rgb::ZERO, |At { value: Color(color), .. }| color)),
        };
        let anisotropy = g.map_or(0.0, |Asymmetry(g)| g as f32);
        let whole =
            extinction.as_ref().map(|key| &key.span).or(albedo.as_ref().map(|key| &key.span));
        let Some(span) = whole else {
            let (absorption, scattering) = (color(absorption)?, color(scattering)?);
            return Ok(Medium { absorption, scattering, anisotropy });
        };
        if absorption.is_some() || scattering.is_some() {
            let message = "says again what absorption and scattering say";
            let help = "give absorption and scattering, or extinction and albedo";
            return Err(document.error(span, message).help(help).into());
        }
        if extinction.is_none() {
            let message = "is a part of the extinction, and there is none";
            return Err(document
                .error(span, message)
                .help("add extinction: what is lost per metre")
                .into());
        }
        let albedo = albedo.map_or(Rgb::ONE, |At { value, .. }| value.rgb());
        let extinction = color(extinction)?;
        let scattering = extinction * albedo;
        Ok(Medium { absorption: extinction - scattering, scattering, anisotropy })
    }

    /// A closed surface that is not there, filled with it.
    pub(super) fn material(self, name: &str, document: &Document<'_>) -> Result<Material> {
        let Medium { absorption, scattering, anisotropy } = self.describe(document)?;
        let interior =
            Some(Interior { absorption, scattering, anisotropy, ..Interior::clear(1.0) });
        let nothing = Scattering::Dielectric { facets: Facets::of(Scalar::constant(0.0)) };
        Ok(Material { interior, scattering: nothing, ..Material::matte(name, Rgb::ONE) })
    }
}

/// Words about media that will not do what one may expect of them.
pub(super) fn doubts(scene: &SceneDescription, name: &str) -> Option<Diagnostic> {
    let cloudy = scene.medium.is_some() || scene.materials.iter().any(Material::is_cloudy);
    let blind = matches!(
        scene.integrator,
        Integrator::AmbientOcclusion { .. } | Integrator::Clarity { .. }
    );
    if cloudy && blind {
        let message = "this integrator looks at surfaces alone: media are left out";
        return Some(Diagnostic::new(name, message).help("write integrator = \"path\""));
    }
    let medium = scene.medium?;
    let afar = |light: &Light| matches!(light, Light::Directional { .. } | Light::Sun { .. });
    let from_afar = scene.environment.is_some() || scene.lights.iter().any(|l| afar(&l.light));
    (from_afar && medium.absorption + medium.scattering != Rgb::ZERO).then(|| {
        let message = "medium reaches to infinity, so no light of suns and skies comes through it";
        let help = "fill a closed surface with it: a material of the kind medium";
        Diagnostic::new(name, message).help(help)
    })
}
