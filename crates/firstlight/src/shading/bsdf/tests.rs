//! Furnaces, densities, reciprocity, hostile numbers and reference values of all lobes.

use super::fresnel::{conductor, dielectric, schlick_weight};
use super::*;
use crate::testing::{Random, chi_squared_z};
use std::f64::consts::TAU;

const COSINES: [f32; 7] = [1.0, 0.9, 0.6, 0.3, 0.1, 0.03, 0.01];
const ROUGHNESSES: [f32; 8] = [0.0, 0.05, 0.1, 0.25, 0.5, 0.7, 0.85, 1.0];

fn at_cosine(cos: f32) -> Vec3 {
    let across = (1.0 - cos * cos).max(0.0).sqrt();
    Vec3::new(0.8 * across, 0.6 * across, cos)
}

fn alpha(roughness: f32) -> Vec2 {
    Vec2::splat(roughness * roughness)
}

fn lobes(outgoing: Vec3, add: impl Fn(&mut Layers<'_>)) -> Vec<Lobe> {
    let mut list = Vec::new();
    let mut layers = Layers::new(&mut list, outgoing);
    add(&mut layers);
    layers.finish();
    list
}

fn principled_lobes(outgoing: Vec3, point: &PrincipledPoint) -> Vec<Lobe> {
    lobes(outgoing, |layers| principled(layers, point))
}

fn bsdf(outgoing: Vec3, lobes: &[Lobe]) -> Bsdf<'_> {
    let frame = Frame { tangent: Vec3::X, normal: Vec3::Z, relief: None };
    Bsdf { frame, outgoing, lobes }
}

/// Every kind of surface, by its roughness, that scatters all light it gets.
fn white(kind: usize, roughness: f32, outgoing: Vec3) -> Vec<Lobe> {
    let white = PrincipledPoint { alpha: alpha(roughness), ..PrincipledPoint::default() };
    let plastic = PrincipledPoint { metallic: 0.0, ..white };
    let glass = PrincipledPoint { transmission: 1.0, ..plastic };
    let solid = |eta: f32, inside| Wall::Solid { eta, inside };
    let half = PrincipledPoint { metallic: 0.5, transmission: 0.4, ..white };
    let points = [
        white,
        plastic,
        PrincipledPoint { ior: 1.0, ..plastic },
        PrincipledPoint { ior: 2.4, specular_color: Rgb::splat(2.0), ..plastic },
        PrincipledPoint { clearcoat: 1.0, clearcoat_roughness: 0.3, ..white },
        PrincipledPoint { clearcoat: 0.5, clearcoat_roughness: roughness, ..plastic },
        PrincipledPoint { sheen_color: Rgb::ONE, sheen_roughness: 0.5, ..plastic },
        PrincipledPoint { sheen_color: Rgb::splat(0.5), sheen_roughness: roughness, ..plastic },
        PrincipledPoint { diffuse_transmission: 0.3, ..plastic },
        glass,
        PrincipledPoint { wall: solid(1.5, false), ..glass },
        PrincipledPoint { wall: solid(1.0 / 1.5, true), ..glass },
        half,
        PrincipledPoint { wall: solid(1.33, false), ..half },
        PrincipledPoint { clearcoat: 1.0, sheen_color: Rgb::ONE, sheen_roughness: 0.3, ..half },
    ];
    match kind {
        0 => lobes(outgoing, |l| l.matte(Rgb::ONE, roughness)),
        1 => lobes(outgoing, |l| l.window(1.5, Rgb::ONE)),
        2..9 => {
            let eta = [1.05, 1.33, 1.5, 2.4, 1.0 / 1.33, 1.0 / 1.5, 1.0 / 2.4][kind - 2];
            lobes(outgoing, |l| l.glass(eta, alpha(roughness), Rgb::ONE))
        }
        _ => principled_lobes(outgoing, &points[kind - 9]),
    }
}

const WHITES: usize = 9 + 15;

/// Index beyond over index here of a kind of [`white`] that refracts.
fn eta_of(lobes: &[Lobe]) -> f32 {
    let eta = lobes.iter().find_map(|lobe| match lobe.kind {
        Kind::Glass { glass, .. } => Some(glass.eta),
        Kind::Refraction { eta, .. } => Some(eta),
        _ => None,
    });
    eta.unwrap_or(1.0)
}

/// The fraction of power that is scattered, by samples: refracted radiance is brought back to power by η².
fn albedo(lobes: &[Lobe], outgoing: Vec3, samples: u32) -> f64 {
    let (bsdf, eta) = (bsdf(outgoing, lobes), eta_of(lobes));
    let mut sum = 0.0;
    for i in 0..samples {
        let spread = |step: f64| ((f64::from(i) + 0.5) * step).fract() as f32;
        let u = Vec2::new(spread(0.754_877_666_246_692_7), spread(0.569_840_290_998_053_3));
        let choice = (i as f32 + 0.5) / samples as f32;
        let Some(sample) = bsdf.sample(choice, u) else { continue };
        let refracted = sample.through
            && lobes.iter().any(|l| matches!(l.kind, Kind::Glass { .. } | Kind::Refraction { .. }));
        let power = if refracted { eta * eta } else { 1.0 };
        sum += f64::from(sample.weight.x * power);
    }
    sum / f64::from(samples)
}

/// M25, C18 and the furnace of every material: within 0.5 % at all roughnesses and angles, inside and outside of glass.
#[test]
fn white_surfaces_are_invisible_in_a_furnace() {
    let mut worst = vec![(0.0, 0.0, 0.0); WHITES];
    for (kind, worst) in worst.iter_mut().enumerate() {
        for (roughness, cos) in ROUGHNESSES.into_iter().flat_map(|r| COSINES.map(|c| (r, c))) {
            let outgoing = at_cosine(cos);
            let lobes = white(kind, roughness, outgoing);
            let off = albedo(&lobes, outgoing, 1 << 14) - 1.0;
            if off.abs() > f64::abs(worst.0) {
                *worst = (off, roughness, cos);
            }
        }
    }
    let off: Vec<_> = worst.iter().enumerate().filter(|(_, w)| w.0.abs() > 0.005).collect();
    assert!(off.is_empty(), "{off:?}");
}

/// Directions, and those in cells of the sphere, are as likely as the density says.
#[test]
fn every_lobe_is_sampled_by_its_density() {
    const ROWS: usize = 24;
    const COLUMNS: usize = 16;
    let mut random = Random::new(9);
    // Glass that hardly refracts scatters into less than the cells of this test.
    for kind in (0..WHITES).filter(|kind| !matches!(kind, 2 | 3)) {
        for (roughness, cos) in [(0.5, 0.2), (0.8, 0.6), (1.0, 0.1)] {
            let outgoing = at_cosine(cos);
            let lobes = white(kind, roughness, outgoing);
            let bsdf = bsdf(outgoing, &lobes);
            let sharp: f32 = lobes
                .iter()
                .filter(|l| l.only_direction(outgoing).is_some())
                .map(|l| l.share)
                .sum();
            let mut counts = vec![0; ROWS * COLUMNS + 1];
            let cell = |d: Vec3| {
                let around = (f64::from(d.y).atan2(f64::from(d.x)) / TAU).rem_euclid(1.0);
                let row = ((0.5 * (1.0 - d.z) * ROWS as f32) as usize).min(ROWS - 1);
                row * COLUMNS + ((around * COLUMNS as f64) as usize).min(COLUMNS - 1)
            };
            let n = 60_000;
            let mut lost = 0;
            for _ in 0..n {
                let mut unit = || random.unit() as f32;
                match bsdf.sample(unit(), Vec2::new(unit(), unit())) {
                    Some(sample) if sample.pdf.is_infinite() => {}
                    Some(sample) => counts[cell(sample.incoming)] += 1,
                    None => lost += 1,
                }
            }
            counts[ROWS * COLUMNS] = lost;
            // The density over each cell, by points in it.
            let (rows, columns) = (16 * ROWS, 64 * COLUMNS);
            let mut shares = vec![0.0; ROWS * COLUMNS + 1];
            for (row, column) in (0..rows).flat_map(|r| (0..columns).map(move |c| (r, c))) {
                let z = 1.0 - 2.0 * (row as f64 + 0.5) / rows as f64;
                let (sin, cos) = (TAU * (column as f64 + 0.5) / columns as f64).sin_cos();
                let across = (1.0 - z * z).sqrt();
                let d = Vec3::new((across * cos) as f32, (across * sin) as f32, z as f32);
                let share = f64::from(bsdf.eval(d).1) * 2.0 * TAU / (rows * columns) as f64;
                shares[row / 16 * COLUMNS + column / 64] += share;
            }
            let sum: f64 = shares.iter().sum();
            shares[ROWS * COLUMNS] = (1.0 - f64::from(sharp) - sum).max(0.0);
            let total: f64 = shares.iter().sum();
            shares.iter_mut().for_each(|share| *share /= total);
            let z = if f64::from(sharp) > 0.9999 { 0.0 } else { chi_squared_z(&counts, &shares) };
            assert!(
                z < 4.5,
                "{kind} {roughness} {cos}: {z} standard deviations; {lost} lost, density {sum}"
            );
        }
    }
}

/// f(a, b) = f(b, a), and for refraction f(a, b) η_a⁻² = f(b, a) η_b⁻², before several scatterings are made up for.
#[test]
fn single_scattering_is_reciprocal() {
    let mut random = Random::new(4);
    for _ in 0..20_000 {
        let up = |v: glam::DVec3| v.as_vec3().with_z(v.z.abs().max(0.02) as f32).normalize();
        let (a, b) = (up(random.direction()), up(random.direction()));
        let (r, s) = (0.15 + 0.85 * random.unit() as f32, 0.15 + 0.85 * random.unit() as f32);
        let facets = Ggx { alpha: Vec2::new(r * r, s * s) };
        let fresnel = Fresnel::Schlick { normal: Rgb::splat(0.3), grazing: 1.0 };
        let kinds = [
            Kind::Lambert,
            Kind::LambertThrough,
            Kind::Eon(Eon { color: Rgb::new(0.2, 0.5, 0.9), roughness: r }),
            Kind::Sheen(Sheen { alpha: r * r }),
            Kind::Facets { facets, fresnel, through: false },
            Kind::Facets { facets, fresnel, through: true },
        ];
        for (i, kind) in kinds.into_iter().enumerate() {
            let b = if matches!(i, 1 | 5) { -b } else { b };
            let lobe = Lobe { kind, weight: Rgb::ONE, share: 1.0 };
            // From below, a thin surface is seen upside down.
            let (flip_a, flip_b) =
                if b.z < 0.0 { (a.with_z(-a.z), b.with_z(-b.z)) } else { (a, b) };
            let there = lobe.eval(a, b).0 / b.z.abs();
            let back = lobe.eval(flip_b, flip_a).0 / a.z.abs();
            let off = (there - back).abs().max_element() / there.max_element().max(1e-3);
            assert!(off < 1e-5, "{kind:?}: {there} and {back}");
        }
        // Where the two directions nearly cancel, single precision keeps fewer digits, more so of narrow facets.
        let facets = Ggx { alpha: facets.alpha.max(Vec2::splat(0.2)) };
        let eta = 1.1 + random.unit() as f32;
        let (outside, inside) = (Glass { facets, eta }, Glass { facets, eta: 1.0 / eta });
        let there = outside.eval(a, -b).0 / b.z * eta * eta;
        let back = inside.eval(b, -a).0 / a.z;
        assert!((there - back).abs() < 1e-5 * there.max(1.0), "glass: {there} and {back}");
    }
}

#[test]
fn hostile_numbers_give_no_nonsense() {
    let mut random = Random::new(2);
    let extremes = [0.0, 1e-30, 1e-7, 1e-3, 0.3, 0.999_999, 1.0];
    let pick = |random: &mut Random| extremes[random.below(extremes.len())];
    for _ in 0..60_000 {
        let point = PrincipledPoint {
            base_color: Rgb::splat(pick(&mut random)),
            metallic: pick(&mut random),
            alpha: Vec2::new(pick(&mut random), pick(&mut random)),
            ior: [1.0, 1.000_001, 1.5, 1e3, f32::INFINITY][random.below(5)],
            specular: pick(&mut random),
            specular_color: Rgb::splat(pick(&mut random) * 1e3),
            transmission: pick(&mut random),
            diffuse_transmission: pick(&mut random),
            clearcoat: pick(&mut random),
            clearcoat_roughness: pick(&mut random),
            sheen_color: Rgb::splat(pick(&mut random)),
            sheen_roughness: pick(&mut random),
            iridescence: pick(&mut random),
            iridescence_ior: [1.0, 1.3, 1e3][random.below(3)],
            iridescence_thickness: [0.0, 1e-5, 400.0, 1e9][random.below(4)],
            wall: match random.below(3) {
                0 => Wall::Thin,
                1 => Wall::Solid { eta: [1.0, 1.00011, 1.5, 1e3][random.below(4)], inside: false },
                _ => Wall::Solid { eta: [1.0, 0.9999, 0.5, 1e-3][random.below(4)], inside: true },
            },
            ..PrincipledPoint::default()
        };
        let mut direction = || {
            let d = random.direction().as_vec3();
            let z = [d.z, 1e-9, 0.0, 1.0, -1e-3][random.below(5)];
            (d.with_z(z)).normalize()
        };
        let (outgoing, incoming) = (above(direction()), direction());
        let lobes = principled_lobes(outgoing, &point);
        let bsdf = bsdf(outgoing, &lobes);
        let (value, pdf) = bsdf.eval(incoming);
        let sound = |v: Rgb| v.is_finite() && v.min_element() >= 0.0;
        assert!(
            sound(value) && pdf.is_finite() && pdf >= 0.0,
            "{value} {pdf}: {point:?} {outgoing} {incoming}"
        );
        let u = Vec2::new(random.unit() as f32, random.unit() as f32);
        let Some(sample) = bsdf.sample(random.unit() as f32, u) else { continue };
        let unit = (sample.incoming.length() - 1.0).abs() < 1e-4;
        assert!(
            sound(sample.weight) && sample.pdf > 0.0 && unit,
            "{sample:?}: {point:?} {outgoing}"
        );
    }
}

#[track_caller]
fn near(value: impl Into<f64>, expected: f64, tolerance: f64) {
    let value = value.into();
    assert!((value - expected).abs() <= tolerance, "{value} is not {expected}");
}

fn cos_of(degrees: f64) -> f32 {
    degrees.to_radians().cos() as f32
}

/// Reference cases M01, M02, M03, M05.
#[test]
fn glass_reflects_as_fresnel_says() {
    for (degrees, expected) in [
        (0.0_f64, 0.04),
        (15.0, 0.0400807672),
        (30.0, 0.041522626),
        (45.0, 0.050239911),
        (60.0, 0.0891867128),
        (75.0, 0.253060563),
        (80.0, 0.387704355),
        (85.0, 0.612799645),
        (89.0, 0.90418495),
    ] {
        near(dielectric(degrees.to_radians().cos(), 1.5).0, expected, 1e-6);
    }
    let inside: [(f64, f64); 7] = [
        (0.0, 0.04),
        (10.0, 0.0400829592),
        (30.0, 0.0551901673),
        (40.0, 0.245291204),
        (41.5, 0.541619992),
        (42.0, 1.0),
        (60.0, 1.0),
    ];
    for (degrees, expected) in inside {
        near(dielectric(degrees.to_radians().cos(), 1.0 / 1.5).0, expected, 1e-6);
    }
    near(dielectric(1.5_f64.atan().cos(), 1.5).0, 0.073964497, 1e-6);
    let mean = |eta: f64| {
        let n = 100_000;
        let term = |i: i32| {
            let cos = (f64::from(i) + 0.5) / f64::from(n);
            2.0 * cos * dielectric(cos, eta).0
        };
        (0..n).map(term).sum::<f64>() / f64::from(n)
    };
    near(mean(1.5), 0.0917779593, 1e-5);
    near(mean(1.0 / 1.5), 0.59634576, 1e-5);
}

/// Reference case M06.
#[test]
fn gold_reflects_as_its_complex_index_says() {
    let cases = [
        (1.502125, 1.875875, [0.385604831, 0.392871487, 0.41711123, 0.603420192]),
        (0.3455, 2.730625, [0.850863574, 0.848340607, 0.846511783, 0.892278579]),
        (0.166, 3.15, [0.941145479, 0.9393521, 0.936437596, 0.950059921]),
    ];
    for (n, k, expected) in cases {
        for (degrees, expected) in [0.0, 45.0, 60.0, 80.0].into_iter().zip(expected) {
            near(conductor(cos_of(degrees), n, k), expected, 1e-5);
        }
    }
}

/// Reference case M08.
#[test]
fn schlick_rises_to_all_at_grazing_angles() {
    let expected = [0.04, 0.0420692731, 0.07, 0.254729884, 0.648491718];
    for (degrees, expected) in [0.0, 45.0, 60.0, 75.0, 85.0].into_iter().zip(expected) {
        let fresnel = Fresnel::Schlick { normal: Rgb::splat(0.04), grazing: 1.0 };
        near(fresnel.at(cos_of(degrees)).x, expected, 1e-6);
        near(0.04 + 0.96 * schlick_weight(cos_of(degrees)), expected, 1e-6);
    }
}

/// Reference case M09, (b): a pane with all reflections between its sides, unpolarised.
#[test]
fn windows_let_through_what_their_two_sides_do() {
    let expected = [
        (0.0, 0.918318028),
        (10.0, 0.918288683),
        (30.0, 0.915445528),
        (50.0, 0.88573749),
        (60.0, 0.830692596),
        (70.0, 0.702545113),
        (80.0, 0.437866348),
    ];
    for (degrees, expected) in expected {
        let outgoing = at_cosine(cos_of(degrees));
        let lobes = lobes(outgoing, |l| l.window(1.52, Rgb::ONE));
        near(bsdf(outgoing, &lobes).straight().x, expected, 1e-4);
    }
}

/// Reference cases M18, M19, M20.
#[test]
fn facets_are_those_of_walter_and_heitz() {
    let cases = [
        (0.1, [31.8309886, 0.0480060154, 0.992610434, 0.794059259]),
        (0.5, [1.27323954, 0.415751688, 0.861001748, 0.294037426]),
    ];
    for (alpha, [d0, d30, g60, g85]) in cases {
        let facets = Ggx { alpha: Vec2::splat(alpha) };
        near(facets.density(Vec3::Z), d0, 1e-5 * d0);
        near(facets.density(at_cosine(cos_of(30.0))), d30, 1e-5 * d30);
        near(facets.visible(at_cosine(cos_of(60.0))), g60, 1e-5 * g60);
        near(facets.visible(at_cosine(cos_of(85.0))), g85, 1e-5 * g85);
    }
    for (x, y) in [(0.02, 0.02), (0.1, 0.1), (0.5, 0.5), (1.0, 1.0), (0.1, 0.6)] {
        let (facets, n) = (Ggx { alpha: Vec2::new(x, y) }, 2000);
        let mut sum = 0.0;
        for (i, j) in (0..n).flat_map(|i| (0..100).map(move |j| (i, j))) {
            // sin² spread as its fourth power.
            let part = (f64::from(i) + 0.5) / f64::from(n);
            let (sin2, turn) = (part.powi(4), TAU * (f64::from(j) + 0.5) / 100.0);
            let m = glam::DVec3::new(
                sin2.sqrt() * turn.cos(),
                sin2.sqrt() * turn.sin(),
                (1.0 - sin2).sqrt(),
            );
            let cell = 4.0 * part.powi(3) / f64::from(n) * TAU / 200.0;
            sum += f64::from(facets.density(m.as_vec3())) * cell;
        }
        near(sum, 1.0, 1e-4);
    }
    let facets = Ggx { alpha: Vec2::splat(0.3) };
    for ((theta_i, theta_o, turn), expected) in [
        ((30.0, 30.0, 180.0), 1.16162982),
        ((30.0, 50.0, 180.0), 0.898301331),
        ((60.0, 60.0, 180.0), 3.13838166),
        ((0.0, 45.0, 0.0), 0.198812387),
        ((70.0, 20.0, 90.0), 0.102636404),
    ] {
        let around = |theta: f64, phi: f64| {
            let ((sin, cos), (sp, cp)) = (theta.to_radians().sin_cos(), phi.to_radians().sin_cos());
            glam::DVec3::new(sin * cp, sin * sp, cos).as_vec3()
        };
        let (incoming, outgoing) = (around(theta_i, turn), around(theta_o, 0.0));
        let white = Fresnel::Schlick { normal: Rgb::ONE, grazing: 1.0 };
        let value = reflect(facets, white, outgoing, incoming).0.x / incoming.z;
        near(value, expected, 1e-5 * expected);
    }
}

/// Reference cases M22 and M24: what the tables hold.
#[test]
fn facets_lose_what_was_scattered_twice() {
    let cases = [
        (0.1, [0.883456016, 0.921621731, 0.969205886, 0.983150679, 0.988313888], 0.972113352),
        (0.3, [0.888803598, 0.825467834, 0.821711053, 0.850576416, 0.87735903], 0.846871395),
        (0.5, [0.860105031, 0.765203303, 0.698250707, 0.682083179, 0.687848718], 0.700240455),
        (0.8, [0.800495301, 0.663211922, 0.540134713, 0.470603649, 0.427002123], 0.507866344),
        (1.0, [0.760210395, 0.597640512, 0.450693847, 0.364526587, 0.306852868], 0.409137053),
    ];
    for (alpha, expected, mean) in cases {
        for (cos, expected) in [0.1, 0.25, 0.5, 0.75, 1.0].into_iter().zip(expected) {
            near(super::albedo::facets(at_cosine(cos), Vec2::splat(alpha)).0, expected, 1e-3);
        }
        let n = 1000;
        let term = |i: i32| {
            let cos = (i as f32 + 0.5) / n as f32;
            2.0 * f64::from(cos * super::albedo::facets(at_cosine(cos), Vec2::splat(alpha)).0)
        };
        near((0..n).map(term).sum::<f64>() / f64::from(n), mean, 1e-3);
    }
}

/// Reference case M26, with height-correlated masking: power reflected and transmitted by rough glass.
#[test]
fn rough_glass_loses_what_was_scattered_twice() {
    for (alpha, cos, reflected, transmitted) in [
        (0.1, 0.25, 0.201699463, 0.763871414),
        (0.1, 1.0, 0.0396384922, 0.959241927),
        (0.3, 0.25, 0.103960191, 0.804691103),
        (0.3, 0.5, 0.0609832034, 0.887522659),
        (0.6, 0.25, 0.059962823, 0.751832182),
        (0.6, 1.0, 0.0243103801, 0.931089789),
    ] {
        let outgoing = at_cosine(cos);
        let glass = Glass { facets: Ggx { alpha: Vec2::splat(alpha) }, eta: 1.5 };
        let kind = Kind::Glass { glass, tint: Rgb::ONE };
        let lobes = [Lobe { kind, weight: Rgb::ONE, share: 1.0 }];
        let bsdf = bsdf(outgoing, &lobes);
        let (n, mut sums) = (1 << 18, [0.0, 0.0]);
        let mut random = Random::new(1);
        for _ in 0..n {
            let mut unit = || random.unit() as f32;
            let Some(sample) = bsdf.sample(unit(), Vec2::new(unit(), unit())) else { continue };
            let power = if sample.through { 2.25 } else { 1.0 };
            sums[usize::from(sample.through)] += f64::from(sample.weight.x * power);
        }
        near(sums[0] / f64::from(n), reflected, 2e-3);
        near(sums[1] / f64::from(n), transmitted, 2e-3);
        near(
            super::albedo::glass(outgoing, Vec2::splat(alpha), 1.5),
            reflected + transmitted,
            1e-3,
        );
    }
}

/// Reference case M10: how far a slab of thickness 1 m shifts a ray sideways.
#[test]
fn slabs_shift_rays_sideways() {
    let expected = [
        (0.0, 0.0),
        (30.0, 0.193813782),
        (45.0, 0.329142308),
        (60.0, 0.512472013),
        (80.0_f64, 0.83366385),
    ];
    for (degrees, expected) in expected {
        let outgoing = Vec3::new(degrees.to_radians().sin() as f32, 0.0, cos_of(degrees));
        let lobes = lobes(outgoing, |l| l.glass(1.5, Vec2::ZERO, Rgb::ONE));
        let bent = lobes.iter().filter(|l| l.kind != Kind::Mirror);
        let inside = bent.map(|l| l.only_direction(outgoing)).next().flatten().unwrap();
        // Where the ray leaves the slab, seen across the ray that goes straight on.
        let exit = inside / -inside.z;
        let along = -outgoing;
        near((exit - exit.dot(along) * along).length(), expected, 1e-5);
        // It leaves in its old direction.
        let (_, beyond) = dielectric((-inside.z).into(), 1.0 / 1.5);
        let out = refracted(-inside, Vec3::Z, 1.0 / 1.5, beyond.unwrap() as f32);
        assert!((out - along).length() < 1e-5, "{out} is not {along}");
    }
}
/// Brushed metal too, whatever its two widths, from any side.
#[test]
fn brushed_white_metal_is_invisible_in_a_furnace() {
    let mut worst = (0.0, Vec2::ZERO, Vec3::ZERO);
    for (narrow, stretch) in [0.05_f32, 0.2, 0.35, 0.6, 0.85]
        .into_iter()
        .flat_map(|narrow| [0.1_f32, 0.3, 0.5, 0.77, 1.0].map(|stretch| (narrow * narrow, stretch)))
    {
        let wide = narrow + (1.0 - narrow) * stretch * stretch;
        for (cos, turn) in COSINES
            .into_iter()
            .flat_map(|cos| [0.0_f32, 0.4, 0.9, 1.3, 1.57].map(|turn| (cos, turn)))
        {
            let across = (1.0 - cos * cos).sqrt();
            let outgoing = Vec3::new(across * turn.cos(), across * turn.sin(), cos);
            for alpha in [Vec2::new(wide, narrow), Vec2::new(narrow, wide)] {
                let white = Fresnel::Schlick { normal: Rgb::ONE, grazing: 1.0 };
                let lobes = lobes(outgoing, |l| _ = l.facets(white, alpha));
                let off = albedo(&lobes, outgoing, 1 << 12) - 1.0;
                if off.abs() > f64::abs(worst.0) {
                    worst = (off, alpha, outgoing);
                }
            }
        }
    }
    assert!(worst.0.abs() < 0.005, "{worst:?}");
}
