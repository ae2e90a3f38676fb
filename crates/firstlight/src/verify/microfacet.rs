//! Rough surfaces: facets by the distribution of Trowbridge & Reitz (GGX), with height-correlated masking.

use super::scenes::*;
use super::statistics::Random;
use super::white::metal;
use super::{Case, Readings, Tolerance};
use crate::color::Rgb;
use crate::scene::Scene;
use crate::shading::bsdf::{
    Bsdf, Frame, Fresnel, Ggx, Glass, Kind, Lobe, dielectric, mirrored, refracted,
};
use glam::{DVec3, Vec2, Vec3};
use std::f64::consts::TAU;

pub(super) const CASES: &[Case] = &[
    Case::exact(
        "M18-ggx-D-G",
        "density of facets, and the fraction that is seen",
        "Walter 2007; Heitz 2014",
        m18,
    ),
    Case::exact("M19-ggx-normalisation", "all facets, projected", "∫ D cos = 1", m19)
        .within(Tolerance::Absolute(1e-4)),
    Case::exact("M20-ggx-brdf-values", "D G / 4 cos cos of width 0.3", "Heitz 2014", m20),
    Case::sampled(
        "M22-ggx-albedo-conductor",
        "what facets that reflect all scatter once",
        "quadrature; Kulla & Conty 2017",
        m22,
    )
    .within(Tolerance::Absolute(5e-4)),
    Case::sampled("M24-ggx-avg-albedo", "the same under a uniform sky", "2 ∫ E cos", m24)
        .within(Tolerance::Absolute(1e-3)),
    Case::sampled(
        "M25-multiscatter-furnace",
        "balls of rough metal that loses nothing under a uniform sky",
        "L = 1",
        m25,
    )
    .within(Tolerance::Absolute(5e-3)),
    Case::sampled(
        "M26-rough-dielectric-albedo",
        "what rough glass of index 1.5 scatters once, to either side",
        "quadrature; Walter 2007",
        m26,
    )
    .within(Tolerance::Absolute(1e-3)),
];

fn facets(alpha: f32) -> Ggx {
    Ggx { alpha: Vec2::splat(alpha) }
}

/// A direction by its angles from the normal and around it, rad.
fn direction(theta: f64, phi: f64) -> Vec3 {
    let across = DVec3::new(phi.cos(), phi.sin(), 0.0) * theta.sin();
    across.with_z(theta.cos()).as_vec3()
}

fn tilted(degrees: f64) -> Vec3 {
    direction(degrees.to_radians(), 0.0)
}

fn m18(readings: &mut Readings) {
    for (alpha, expected) in [
        (0.1, [31.8309886, 0.0480060154, 0.992610434, 0.794059259]),
        (0.5, [1.27323954, 0.415751688, 0.861001748, 0.294037426]),
    ] {
        let facets = facets(alpha);
        let measured = [
            ("D0", facets.density(Vec3::Z)),
            ("D30", facets.density(tilted(30.0))),
            ("G1_60", facets.visible(tilted(60.0))),
            ("G1_85", facets.visible(tilted(85.0))),
        ];
        for ((name, measured), expected) in measured.into_iter().zip(expected) {
            readings.exact(format!("{alpha}, {name}"), measured, expected);
        }
    }
}

fn m19(readings: &mut Readings) {
    const STEPS: u32 = 2000;
    for alpha in [0.02, 0.1, 0.5, 1.0] {
        let term = |i: u32| {
            // sin² spread as its fourth power, since narrow facets are all near the normal.
            let part = (f64::from(i) + 0.5) / f64::from(STEPS);
            let density = facets(alpha).density(direction(part.powi(4).sqrt().asin(), 0.0));
            f64::from(density) * 4.0 * part.powi(3) * 0.5 * TAU / f64::from(STEPS)
        };
        readings.exact(alpha, (0..STEPS).map(term).sum::<f64>(), 1.0);
    }
}

/// A lobe alone, seen from `outgoing`.
fn alone(kind: Kind, outgoing: Vec3, measure: impl FnOnce(&Bsdf<'_>)) {
    let lobes = [Lobe::new(kind, Rgb::ONE)];
    measure(&Bsdf { frame: Frame::along(Vec3::Z, Vec3::X), outgoing, lobes: &lobes });
}

fn white(alpha: f32) -> Kind {
    let fresnel = Fresnel::Schlick { normal: Rgb::ONE, grazing: 1.0 };
    Kind::Facets { facets: facets(alpha), fresnel, once: 1.0, through: false }
}

fn m20(readings: &mut Readings) {
    for ([theta_i, theta_o, turn], expected) in [
        ([30.0, 30.0, 180.0], 1.16162982),
        ([30.0, 50.0, 180.0], 0.898301331),
        ([60.0, 60.0, 180.0], 3.13838166),
        ([0.0, 45.0, 0.0], 0.198812387),
        ([70.0, 20.0, 90.0_f64], 0.102636404),
    ] {
        let incoming = direction(f64::to_radians(theta_i), turn.to_radians());
        alone(white(0.3), tilted(theta_o), |bsdf| {
            let value = bsdf.eval(incoming).0.x / incoming.z;
            readings.exact(format!("({theta_i}, {theta_o}, {turn})"), value, expected);
        });
    }
}

/// The power that a lobe scatters: back, and through a boundary to an index `eta` times as high; by so many facets,
/// each counted as often as it is seen.
fn power(bsdf: &Bsdf<'_>, facets: Ggx, eta: f32, samples: u32, seed: u64) -> [f64; 2] {
    let (mut random, mut sums, outgoing) = (Random::new(seed), [0.0, 0.0], bsdf.outgoing);
    let shift = [random.unit(), random.unit()];
    for i in 0..samples {
        // Roberts' sequence, moved by chance.
        let steps = [0.754_877_666_246_692_7, 0.569_840_290_998_053_3];
        let [x, y] = std::array::from_fn(|k| (shift[k] + f64::from(i) * steps[k]).fract() as f32);
        let m = facets.sample(outgoing, Vec2::new(x, y));
        let (cos, seen) = (outgoing.dot(m), facets.visible_density(outgoing, m));
        let value = |incoming| f64::from(bsdf.eval(incoming).0.x / seen);
        let back = mirrored(outgoing, m);
        sums[0] += if back.z > 0.0 { value(back) * f64::from(4.0 * cos) } else { 0.0 };
        if let (_, Some(beyond)) = dielectric(cos.into(), eta.into()) {
            let through = refracted(outgoing, m, eta, beyond as f32);
            let spread = (f64::from(cos / eta) - beyond).powi(2) / beyond;
            let power = value(through) * spread * f64::from(eta * eta);
            sums[1] += if through.z < 0.0 { power } else { 0.0 };
        }
    }
    sums.map(|sum| sum / f64::from(samples))
}

/// α, what is scattered from the cosines 0.1, 0.25, 0.5, 0.75, 1, and on average.
const ONCE: [(f32, [f64; 5], f64); 5] = [
    (0.1, [0.883456016, 0.921621731, 0.969205886, 0.983150679, 0.988313888], 0.972113352),
    (0.3, [0.888803598, 0.825467834, 0.821711053, 0.850576416, 0.87735903], 0.846871395),
    (0.5, [0.860105031, 0.765203303, 0.698250707, 0.682083179, 0.687848718], 0.700240455),
    (0.8, [0.800495301, 0.663211922, 0.540134713, 0.470603649, 0.427002123], 0.507866344),
    (1.0, [0.760210395, 0.597640512, 0.450693847, 0.364526587, 0.306852868], 0.409137053),
];

fn m22(readings: &mut Readings) {
    for (alpha, expected, _) in ONCE {
        for (cos, expected) in [0.1_f64, 0.25, 0.5, 0.75, 1.0].into_iter().zip(expected) {
            alone(white(alpha), direction(cos.acos(), 0.0), |bsdf| {
                let measure = |seed| power(bsdf, facets(alpha), 1.5, 1 << 14, seed)[0];
                readings.repeated(format!("{alpha}, {cos}"), measure, expected);
            });
        }
    }
}

fn m24(readings: &mut Readings) {
    for (alpha, _, expected) in ONCE {
        let measure = |seed| {
            const ANGLES: u32 = 64;
            let (mut random, mut sum) = (Random::new(seed), 0.0);
            for i in 0..ANGLES {
                let cos2 = (f64::from(i) + random.unit()) / f64::from(ANGLES);
                alone(white(alpha), direction(cos2.sqrt().acos(), 0.0), |bsdf| {
                    sum += power(bsdf, facets(alpha), 1.5, 1 << 10, seed << 8 | u64::from(i))[0];
                });
            }
            sum / f64::from(ANGLES)
        };
        readings.repeated(alpha, measure, expected);
    }
}

fn m25(readings: &mut Readings) {
    for alpha in [0.1_f32, 0.3, 0.5, 0.8, 1.0] {
        let mut scene = scene_for_paths(0.0);
        scene.environment = uniform(1.0);
        scene.materials[0] = metal(alpha.sqrt());
        add(&mut scene, ball(DVec3::ZERO, 1.0));
        let scene = Scene::build(&scene);
        for offset in [0.0, 0.5, 0.9, 0.99] {
            let (eye, target) = (v(0.0, -5.0, 0.0), v(offset, 0.0, 0.0));
            readings.radiance(format!("{alpha}, {offset}"), &scene, eye, target, 1.0);
        }
    }
}

fn m26(readings: &mut Readings) {
    for (alpha, cos, expected) in [
        (0.1, 0.25, [0.201699463, 0.763871414]),
        (0.1, 0.5, [0.0858817574, 0.906376581]),
        (0.1, 1.0, [0.0396384922, 0.959241927]),
        (0.3, 0.25, [0.103960191, 0.804691103]),
        (0.3, 0.5, [0.0609832034, 0.887522659]),
        (0.3, 1.0, [0.0355974027, 0.952814815]),
        (0.6, 0.25, [0.059962823, 0.751832182]),
        (0.6, 0.5, [0.0381467329, 0.823360715]),
        (0.6, 1.0_f64, [0.0243103801, 0.931089789]),
    ] {
        let glass = Glass { facets: facets(alpha), eta: 1.5, once: 1.0 };
        alone(
            Kind::Glass { glass, tint: Rgb::ONE, gloss: None },
            direction(cos.acos(), 0.0),
            |bsdf| {
                for (side, name) in ["R", "T"].into_iter().enumerate() {
                    let measure = |seed| power(bsdf, facets(alpha), 1.5, 1 << 13, seed)[side];
                    readings.repeated(format!("{alpha}, {cos}, {name}"), measure, expected[side]);
                    // The table's quadrature is right to 5e-5, which more samples find out.
                    readings.known_to_tolerance();
                }
            },
        );
    }
}
