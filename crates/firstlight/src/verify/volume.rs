//! Media that absorb and scatter.

use super::scenes::*;
use super::{Case, Readings, Tolerance};
use crate::color::Rgb;
use crate::scene::Scene;
use crate::scene::description::*;
use glam::DVec3;
use std::f64::consts::PI;

pub(super) const CASES: &[Case] = &[
    Case::sampled(
        "M16-beer-lambert",
        "a uniform sky through 2 m of what absorbs 0.7 per metre, without a boundary",
        "Beer 1852: exp(-σ d)",
        m16,
    ),
    Case::sampled(
        "M17-eye-inside",
        "a wall 2 m away in what absorbs 0.7 per metre, and behind a slab of glass in glass, with the eye in there too",
        "Beer 1852: exp(-σ d); where the index does not change, nothing is reflected",
        m17,
    ),
    Case::sampled(
        "V01-semi-infinite-isotropic",
        "all that is below a plane scatters to all sides alike, with an albedo of 0.9",
        "Chandrasekhar 1950: H functions",
        v01,
    )
    .within(Tolerance::Relative(5e-3)),
];

fn m16(readings: &mut Readings) {
    let mut scene = scene_for_paths(0.0);
    scene.environment = uniform(1.0);
    scene.materials[0] = clear(1.0, Rgb::splat(0.7));
    add(&mut scene, cube(DVec3::ZERO, 2.0));
    let scene = Scene::build(&scene);
    readings.radiance("", &scene, v(0.0, -5.0, 0.0), DVec3::ZERO, (-1.4_f64).exp());
}

/// What a wall of radiance 1 sends to an eye that is with it in a solid, of which another one may be in between.
fn m17(readings: &mut Readings) {
    let around = |solid: Material| {
        let mut scene = scene_for_paths(0.0);
        scene.materials[0] = solid;
        add(&mut scene, cube(DVec3::ZERO, 8.0));
        add_with(&mut scene, quad(v(-1.0, 2.0, -1.0), 2.0 * DVec3::X, 2.0 * DVec3::Z), 1);
        scene
    };
    let smoke = around(clear(1.3, Rgb::splat(0.7)));
    let mut glass = around(clear(1.5, Rgb::ZERO));
    glass.materials.push(clear(1.5, Rgb::ZERO));
    add_with(&mut glass, cube(DVec3::Y, 0.5), 3);
    for (at, scene, expected) in [("smoke", smoke, (-1.4_f64).exp()), ("glass", glass, 1.0)] {
        readings.radiance(at, &Scene::build(&scene), DVec3::ZERO, DVec3::Y, expected);
    }
}

/// Chandrasekhar's H function of isotropic scattering, by its integral equation in the form that converges fast:
/// 1/H(μ) = √(1 − ω) + ω/2 ∫ μ' H(μ') / (μ + μ') dμ' (*Radiative Transfer*, 1950, ch. V).
fn h_function(albedo: f64) -> impl Fn(f64) -> f64 {
    const CELLS: usize = 1000;
    let at = |cell: usize| (cell as f64 + 0.5) / CELLS as f64;
    let once = move |h: &[f64], mu: f64| {
        let part = |(cell, h): (usize, &f64)| at(cell) * h / (mu + at(cell));
        let sum = h.iter().enumerate().map(part).sum::<f64>() / CELLS as f64;
        1.0 / ((1.0 - albedo).sqrt() + 0.5 * albedo * sum)
    };
    let mut h = vec![1.0; CELLS];
    for _ in 0..40 {
        h = (0..CELLS).map(|cell| once(&h, at(cell))).collect();
    }
    move |mu| once(&h, mu)
}

/// A half space of such a medium, without a boundary that one could see.
fn half_space(albedo: f32) -> SceneDescription {
    let mut scene = scene_for_paths(0.0);
    let mut below = clear(1.0, Rgb::splat(1.0 - albedo));
    below.interior.iter_mut().for_each(|interior| interior.scattering = Rgb::splat(albedo));
    scene.materials[0] = below;
    add(&mut scene, floor());
    scene
}

/// What a sky of radiance 1 makes it send out is its albedo for light from there: it does not matter which way light goes.
fn v01(readings: &mut Readings) {
    let h = h_function(0.9);
    let mut scene = half_space(0.9);
    scene.environment = uniform(1.0);
    let above = |mu: f64| v((1.0 - mu * mu).sqrt(), 0.0, mu);
    let built = Scene::build(&scene);
    for mu in [1.0, 0.5, 0.1] {
        let expected = 1.0 - h(mu) * 0.1_f64.sqrt();
        readings.radiance(format!("albedo {mu}"), &built, above(mu), DVec3::ZERO, expected);
    }
    scene.environment = None;
    for (at, mu) in [("brdf_0_0", 1.0), ("brdf_60_0", 0.5)] {
        let brdf = 0.9 / (4.0 * PI) * h(mu) * h(1.0) / (mu + 1.0);
        let irradiance = Rgb::splat(1.0 / mu as f32);
        scene.lights.clear();
        light(&mut scene, Light::Directional { direction: -above(mu), irradiance });
        readings.radiance(at, &Scene::build(&scene), DVec3::Z, DVec3::ZERO, brdf);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn h_functions_are_those_of_the_table() {
        let h = h_function(0.9);
        let albedo = |mu: f64| 1.0 - h(mu) * 0.1_f64.sqrt();
        for (mu, expected) in [(1.0, 0.414947479), (0.5, 0.507938907), (0.1, 0.629335821)] {
            assert!((albedo(mu) - expected).abs() < 1e-5, "{mu}: {}", albedo(mu));
        }
        let normal = 0.9 / (8.0 * PI) * h(1.0) * h(1.0);
        assert!((normal - 0.122572307).abs() < 1e-6, "{normal}");
    }
}
