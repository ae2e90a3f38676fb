//! How much surfaces reflect and let through.

use super::scenes::*;
use super::white::pane;
use super::{Case, Readings, Tolerance};
use crate::color::Rgb;
use crate::scene::Scene;
use crate::scene::description::*;
use crate::shading::bsdf::{Fresnel, dielectric};
use glam::DVec3;

pub(super) const CASES: &[Case] = &[
    Case::exact("M01-fresnel-dielectric", "air to glass of index 1.5", "Fresnel", m01)
        .within(Tolerance::Absolute(1e-6)),
    Case::exact("M02-fresnel-internal", "glass of index 1.5 to air", "Fresnel", m02)
        .within(Tolerance::Absolute(1e-6)),
    Case::exact("M03-brewster", "at Brewster's angle of index 1.5", "Fresnel", m03)
        .within(Tolerance::Absolute(1e-6)),
    Case::exact("M05-fresnel-diffuse", "even light on index 1.5", "2 ∫ F cos", m05)
        .within(Tolerance::Absolute(1e-5)),
    Case::exact(
        "M06-fresnel-gold",
        "polished gold under a uniform sky, at three wavelengths",
        "Fresnel; Johnson & Christy 1972",
        m06,
    )
    .within(Tolerance::Absolute(1e-5)),
    Case::exact("M08-schlick", "glTF's gloss of 4 %", "Schlick 1994; glTF 2.0, appendix B", m08)
        .within(Tolerance::Absolute(1e-6)),
    Case::exact(
        "M09-slab-transmittance",
        "a sun through a pane of index 1.52",
        "(1 - F) / (1 + F), unpolarised",
        m09,
    )
    .within(Tolerance::Absolute(1e-4)),
];

fn reflected(degrees: f64, eta: f64) -> f64 {
    dielectric(degrees.to_radians().cos(), eta).0
}

fn m01(readings: &mut Readings) {
    for (degrees, expected) in [
        (0.0, 0.04),
        (15.0, 0.0400807672),
        (30.0, 0.041522626),
        (45.0, 0.050239911),
        (60.0, 0.0891867128),
        (75.0, 0.253060563),
        (80.0, 0.387704355),
        (85.0, 0.612799645),
        (89.0, 0.90418495),
    ] {
        readings.exact(degrees, reflected(degrees, 1.5), expected);
    }
}

fn m02(readings: &mut Readings) {
    for (degrees, expected) in [
        (0.0, 0.04),
        (10.0, 0.0400829592),
        (30.0, 0.0551901673),
        (40.0, 0.245291204),
        (41.5, 0.541619992),
        (42.0, 1.0),
        (60.0, 1.0),
    ] {
        readings.exact(degrees, reflected(degrees, 1.0 / 1.5), expected);
    }
}

fn m03(readings: &mut Readings) {
    readings.exact("R", dielectric(1.5_f64.atan().cos(), 1.5).0, 0.073964497);
}

fn m05(readings: &mut Readings) {
    let mean = |eta: f64| {
        const STEPS: u32 = 100_000;
        let cosines = (0..STEPS).map(|i| (f64::from(i) + 0.5) / f64::from(STEPS));
        cosines.map(|cos| 2.0 * cos * dielectric(cos, eta).0).sum::<f64>() / f64::from(STEPS)
    };
    readings.exact("external", mean(1.5), 0.0917779593);
    readings.exact("internal", mean(1.0 / 1.5), 0.59634576);
}

/// The first channel of a mirror that fills the view under a sky of 1.
fn shine(material: Material, degrees: f64) -> f32 {
    let mut scene = scene_for_paths(0.0);
    scene.environment = uniform(1.0);
    scene.materials[0] = material;
    add(&mut scene, floor());
    let (sin, cos) = degrees.to_radians().sin_cos();
    look(&scene, v(sin, 0.0, cos), DVec3::ZERO).x
}

fn m06(readings: &mut Readings) {
    for (at, n, k, expected) in [
        ("451nm", 1.502125, 1.875875, [0.385604831, 0.392871487, 0.41711123, 0.603420192]),
        ("551nm", 0.3455, 2.730625, [0.850863574, 0.848340607, 0.846511783, 0.892278579]),
        ("653nm", 0.166, 3.15, [0.941145479, 0.9393521, 0.936437596, 0.950059921]),
    ] {
        let index = Some(ComplexIndex { n: Rgb::splat(n), k: Rgb::splat(k) });
        let facets = Facets::of(Scalar::constant(0.0));
        let scattering = Scattering::Conductor { index, facets };
        let gold = Material { scattering, ..Material::matte("gold", Rgb::ONE) };
        for (degrees, expected) in [0.0, 45.0, 60.0, 80.0].into_iter().zip(expected) {
            readings.exact(format!("{at}, {degrees}"), shine(gold.clone(), degrees), expected);
        }
    }
}

fn m08(readings: &mut Readings) {
    let fresnel = Fresnel::Schlick { normal: Rgb::splat(0.04), grazing: 1.0 };
    let expected = [0.04, 0.0420692731, 0.07, 0.254729884, 0.648491718];
    for (degrees, expected) in [0.0_f64, 45.0, 60.0, 75.0, 85.0].into_iter().zip(expected) {
        readings.exact(degrees, fresnel.at(degrees.to_radians().cos() as f32).x, expected);
    }
}

fn m09(readings: &mut Readings) {
    for (degrees, expected) in [
        (0.0_f64, 0.918318028),
        (10.0, 0.918288683),
        (20.0, 0.917814187),
        (30.0, 0.915445528),
        (40.0, 0.907576688),
        (50.0, 0.88573749),
        (60.0, 0.830692596),
        (70.0, 0.702545113),
        (75.0, 0.591450263),
        (80.0, 0.437866348),
    ] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let mut scene = scene_for_paths(0.0);
        scene.materials[0] = pane(1.52);
        add(&mut scene, floor());
        let irradiance = Rgb::splat((1.0 / cos) as f32);
        light(&mut scene, Light::Directional { direction: v(-sin, 0.0, -cos), irradiance });
        let below = Scene::build(&scene).irradiance(v(0.0, 0.0, -1.0), DVec3::Z);
        readings.exact(degrees, below.value.x, expected);
    }
}
