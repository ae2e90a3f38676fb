//! Furnaces, densities, reciprocity, hostile numbers and reference values of all lobes.

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
            lobes(outgoing, |l| l.glass(eta, alpha(roughness), Rgb::ONE, None))
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

/// Without what is scattered several times, white facets and glass scatter E(μ), as quadrature has it (PA4, M22, M26).
#[test]
fn single_scattering_alone_loses_what_facets_hide() {
    let white = Fresnel::Schlick { normal: Rgb::ONE, grazing: 1.0 };
    for (several, eta, alpha, cos, once) in [
        (false, None, 0.3, 0.5, 0.821711053),
        (false, None, 0.8, 0.25, 0.663211922),
        (false, None, 1.0, 1.0, 0.306852868),
        (true, None, 1.0, 1.0, 1.0),
        (false, Some(1.5), 0.3, 0.25, 0.103960191 + 0.804691103),
        (false, Some(1.5), 0.6, 1.0, 0.0243103801 + 0.931089789),
        (true, Some(1.5), 0.6, 1.0, 1.0_f64),
    ] {
        let outgoing = at_cosine(cos);
        let lobes = lobes(outgoing, |layers| {
            layers.multiple_scattering = several;
            match eta {
                Some(eta) => layers.glass(eta, Vec2::splat(alpha), Rgb::ONE, None),
                None => _ = layers.facets(white, Vec2::splat(alpha)),
            }
        });
        let found = albedo(&lobes, outgoing, 1 << 14);
        assert!((found / once - 1.0).abs() < 5e-3, "{several} {eta:?} {alpha} {cos}: {found}");
    }
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
            let mut counts = vec![0; ROWS * COLUMNS];
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
            assert_eq!(lost, 0, "{kind} {roughness} {cos}");
            // The density over each cell, by points in it.
            let (rows, columns) = (16 * ROWS, 64 * COLUMNS);
            let mut shares = vec![0.0; ROWS * COLUMNS];
            for (row, column) in (0..rows).flat_map(|r| (0..columns).map(move |c| (r, c))) {
                let z = 1.0 - 2.0 * (row as f64 + 0.5) / rows as f64;
                let (sin, cos) = (TAU * (column as f64 + 0.5) / columns as f64).sin_cos();
                let across = (1.0 - z * z).sqrt();
                let d = Vec3::new((across * cos) as f32, (across * sin) as f32, z as f32);
                let share = f64::from(bsdf.eval(d).1) * 2.0 * TAU / (rows * columns) as f64;
                shares[row / 16 * COLUMNS + column / 64] += share;
            }
            // What facets scatter once is known from tables, to a percent where light grazes from within.
            let sum: f64 = shares.iter().sum();
            assert!((sum + f64::from(sharp) - 1.0).abs() < 1e-2, "{kind} {roughness} {cos}: {sum}");
            shares.iter_mut().for_each(|share| *share /= sum);
            let z = if f64::from(sharp) > 0.9999 { 0.0 } else { chi_squared_z(&counts, &shares) };
            assert!(z < 4.5, "{kind} {roughness} {cos}: {z} standard deviations");
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
            Kind::Facets { facets, fresnel, once: 1.0, through: false },
            Kind::Facets { facets, fresnel, once: 1.0, through: true },
        ];
        for (i, kind) in kinds.into_iter().enumerate() {
            let b = if matches!(i, 1 | 5) { -b } else { b };
            let lobe = Lobe::new(kind, Rgb::ONE);
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
        let (outside, inside) =
            (Glass { facets, eta, once: 1.0 }, Glass { facets, eta: 1.0 / eta, once: 1.0 });
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

/// Varnish whose normal is tilted: directions are as likely as said, and polished it mirrors at its own normal.
#[test]
fn tilted_coats_are_sampled_as_they_are() {
    let normal = Vec3::new(0.3, -0.2, 0.9).normalize();
    let coat = |roughness, outgoing| lobes(outgoing, |l| l.coat(1.0, alpha(roughness), normal));
    for cos in [0.9, 0.4] {
        let outgoing = at_cosine(cos);
        let (rough, n) = (coat(0.6, outgoing), 1 << 18);
        let bsdf = bsdf(outgoing, &rough);
        let mut random = Random::new(7);
        let (mut sampled, mut everywhere) = (0.0, 0.0);
        for _ in 0..n {
            let mut unit = || random.unit() as f32;
            let sample = bsdf.sample(unit(), Vec2::new(unit(), unit()));
            sampled += sample.map_or(0.0, |sample| f64::from(sample.weight.x));
            everywhere += f64::from(bsdf.eval(random.direction().as_vec3()).0.x) * 2.0 * TAU;
        }
        assert!((sampled / everywhere - 1.0).abs() < 0.01, "{cos}: {sampled} and {everywhere}");
        let polished = coat(0.0, outgoing);
        let mirrored = super::tests::bsdf(outgoing, &polished).sample(0.5, Vec2::ZERO).unwrap();
        assert!(
            (mirrored.incoming - (2.0 * outgoing.dot(normal) * normal - outgoing)).length() < 1e-5
        );
    }
}

/// However far its normal is bent, and from wherever it is seen.
#[test]
fn mirrors_with_bent_normals_send_nothing_into_their_ground() {
    let lobes = [Lobe::new(Kind::Mirror, Rgb::ONE)];
    for (step, cos) in (0..18_u8).flat_map(|step| COSINES.map(|cos| (step, cos))) {
        let (sin, bent) = (5.0 * f32::from(step)).to_radians().sin_cos();
        let normal = Vec3::new(sin, 0.0, bent);
        for side in [-1.0, 1.0] {
            let outgoing = at_cosine(cos) * Vec3::new(side, 1.0, 1.0);
            let frame = Frame::around(normal).bent_from(Vec3::Z);
            let bsdf = Bsdf { frame, outgoing, lobes: &lobes };
            let sample = bsdf.sample(0.5, Vec2::splat(0.5)).expect("mirrors lose nothing");
            assert!(sample.incoming.z >= 0.0, "{step} {cos} {side}: {}", sample.incoming);
            assert!((sample.incoming.length() - 1.0).abs() < 1e-5 && sample.weight == Rgb::ONE);
        }
    }
}
