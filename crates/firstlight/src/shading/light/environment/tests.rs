//! The environment against closed forms, and its directions against their density.

use super::*;
use crate::geometry::{Hit, Ray};
use crate::scene::description::{Pixels, Sampling, Texels};
use crate::simd::Level;
use crate::testing::{Random, chi_squared_z};
use glam::{DVec2, DVec3, Vec4};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

fn picture(width: u32, height: u32, texel: impl Fn(u32, u32) -> f32) -> Arc<Pixels> {
    let at = |i: u32| Vec4::splat(texel(i % width, i / width)).to_array();
    let texels = Texels::Linear((0..width * height).map(at).collect());
    Arc::new(Pixels { name: "sky".into(), width, height, texels })
}

/// A picture with bright, dim and black places.
fn varied(width: u32, height: u32) -> Arc<Pixels> {
    let random = |x: u32, y: u32| crate::math::hash(u64::from(y) << 32 | u64::from(x)) % 1000;
    picture(width, height, |x, y| match random(x, y) {
        n @ 0..600 => n as f32 * 1e-3,
        600..950 => 0.0,
        n => n as f32 * 0.1,
    })
}

fn turned() -> Mat3 {
    Mat3::from_euler(glam::EulerRot::ZXY, 0.7, -0.4, 1.9)
}

fn skies() -> Vec<(&'static str, Sky)> {
    let gradient = Sky::Gradient {
        zenith: Rgb::new(0.2, 0.5, 1.0),
        horizon: Rgb::splat(1.5),
        nadir: Rgb::new(0.3, 0.2, 0.1),
    };
    let of = |sampling, pixels| Sky::Picture { pixels, sampling };
    vec![
        ("uniform", Sky::Uniform),
        ("gradient", gradient),
        ("nearest", of(Sampling::Nearest, varied(16, 8))),
        ("bilinear", of(Sampling::Bilinear, varied(16, 8))),
        ("narrow", of(Sampling::Bilinear, varied(1, 2))),
        ("wide", of(Sampling::Nearest, varied(37, 1))),
    ]
}

/// Counts of samples over a lat-long grid in the world against the density's integral over its cells.
fn check(environment: &Environment, what: &str) {
    let (columns, rows, parts) = (48, 24, 40);
    let toward = |st: DVec2| {
        let z = 1.0 - 2.0 * st.y;
        (DVec2::from_angle(TAU * st.x) * (1.0 - z * z).sqrt()).extend(z).as_vec3()
    };
    let mut shares = vec![0.0; columns * rows];
    for (i, j) in (0..columns * parts).flat_map(|i| (0..rows * parts).map(move |j| (i, j))) {
        let (width, height) = ((columns * parts) as f64, (rows * parts) as f64);
        let st = DVec2::new((i as f64 + 0.5) / width, (j as f64 + 0.5) / height);
        let share = f64::from(environment.pdf(toward(st))) * 4.0 * PI / (width * height);
        shares[j / parts * columns + i / parts] += share;
    }
    let total: f64 = shares.iter().sum();
    assert!((total - 1.0).abs() < 2e-3, "{what}: the density's integral is {total}");
    let (mut counts, mut random) = (vec![0; columns * rows], Random::new(2));
    let mut on_borders = 0;
    for _ in 0..100_000 {
        let u = Vec2::new(random.unit() as f32, random.unit() as f32);
        let sample = environment.sample(u).expect("there is light");
        let pdf = environment.pdf(sample.incoming);
        on_borders += u32::from((pdf / sample.pdf - 1.0).abs() > 1e-4);
        let from = sample.incoming;
        let around = (f64::from(from.y.atan2(from.x)) / TAU).rem_euclid(1.0);
        let cell = |x: f64, count: usize| ((x * count as f64) as usize).min(count - 1);
        let row = cell(0.5 - 0.5 * f64::from(from.z), rows);
        counts[row * columns + cell(around, columns)] += 1;
    }
    assert!(on_borders < 100, "{what}: {on_borders} samples do not know their density");
    let z = chi_squared_z(&counts, &shares);
    assert!(z < 4.5, "{what}: {z} standard deviations from the density");
}

#[test]
fn every_sky_is_sampled_by_its_density() {
    for (name, sky) in skies() {
        for aim in [Aim::Alone, Aim::Compensated] {
            let environment = Environment::new(&sky, Rgb::ONE, turned(), aim);
            let uniform = matches!(sky, Sky::Uniform);
            assert_eq!(environment.table.is_none(), uniform && aim == Aim::Compensated, "{name}");
            if environment.table.is_some() {
                check(&environment, &format!("{name}, {aim:?}"));
            }
        }
    }
}

/// ∫ L cos θ dω above a horizontal receiver by the environment's own samples, with the standard error.
fn irradiance(environment: &Environment) -> (f64, f64) {
    let (rows, mut random) = (500, Random::new(5));
    let (mut sum, mut squares) = (0.0, 0.0);
    for i in 0..rows * rows {
        let jitter = Vec2::new(random.unit() as f32, random.unit() as f32);
        let u = (Vec2::new((i % rows) as f32, (i / rows) as f32) + jitter) / rows as f32;
        let sample = environment.sample(u.min(Vec2::splat(1.0 - f32::EPSILON))).expect("light");
        let value = f64::from(sample.radiance.x * sample.incoming.z.max(0.0) / sample.pdf);
        sum += value;
        squares += value * value;
    }
    let n = (rows * rows) as f64;
    (sum / n, ((squares / n - (sum / n).powi(2)) / n).sqrt())
}

#[track_caller]
fn expect(sky: Sky, expected: f64) {
    let environment = Environment::new(&sky, Rgb::ONE, Mat3::IDENTITY, Aim::Alone);
    let (value, error) = irradiance(&environment);
    assert!(
        (value - expected).abs() < 4.0 * error + 1e-6 * expected,
        "{value} ± {error}: {expected}"
    );
    assert!(error < 5e-3 * expected);
}

/// Names as in the reference table.
#[test]
fn irradiances_match_closed_forms() {
    // E01: a uniform sky.
    expect(Sky::Uniform, PI);
    // E10: the traditional overcast sky, (1 + 2 sin γ) / 3.
    let (horizon, zenith) = (Rgb::splat(1.0 / 3.0), Rgb::ONE);
    expect(Sky::Gradient { zenith, horizon, nadir: Rgb::ZERO }, 7.0 * PI / 9.0);
    // E12: one texel is bright, and constant all over.
    let hot = |sampling| Sky::Picture {
        pixels: picture(64, 32, |x, y| if (x, y) == (9, 5) { 1000.0 } else { 0.0 }),
        sampling,
    };
    expect(hot(Sampling::Nearest), 4.24328049);
    // The same with straight lines to its neighbours, by quadrature over the tent.
    let parts = 4000;
    let tent = |k: u32| {
        let theta = (5.5 + 2.0 * (f64::from(k) + 0.5) / f64::from(parts) - 1.0) * PI / 32.0;
        let weight = 1.0 - (2.0 * (f64::from(k) + 0.5) / f64::from(parts) - 1.0).abs();
        weight * theta.sin() * theta.cos() * (2.0 / f64::from(parts)) * PI / 32.0
    };
    expect(hot(Sampling::Bilinear), 1000.0 * TAU / 64.0 * (0..parts).map(tent).sum::<f64>());
}

#[test]
fn pictures_hang_with_the_zenith_on_top_and_north_in_the_middle() {
    let at = |x, y| {
        let pixels = picture(8, 4, |column, row| f32::from((column, row) == (x, y)));
        let sky = Sky::Picture { pixels, sampling: Sampling::Nearest };
        Environment::new(&sky, Rgb::splat(2.0), Mat3::IDENTITY, Aim::Alone)
    };
    let bright = |x, y, direction: Vec3| {
        assert_eq!(at(x, y).radiance(direction.normalize()), Rgb::splat(2.0), "{direction}");
    };
    bright(4, 2, Vec3::new(0.1, 1.0, -0.1));
    bright(3, 1, Vec3::new(-0.1, 1.0, 0.1));
    bright(6, 2, Vec3::new(1.0, -0.1, -0.1));
    bright(2, 2, Vec3::new(-1.0, 0.1, -0.1));
    bright(0, 0, Vec3::new(-0.1, -1.0, 9.0));
    bright(7, 3, Vec3::new(0.1, -1.0, -9.0));
}

/// Compensated samples and uniform ones, weighted by the balance heuristic, add up to the same light.
#[test]
fn compensated_samples_and_others_together_miss_nothing() {
    for (name, sky) in skies() {
        let of = |aim| Environment::new(&sky, Rgb::ONE, turned(), aim);
        let (alone, compensated) = (of(Aim::Alone), of(Aim::Compensated));
        let (expected, error) = irradiance(&alone);
        let (mut random, uniform_pdf) = (Random::new(9), 0.25 / PI);
        let weigh = |incoming: Vec3| {
            let pdf = uniform_pdf + f64::from(compensated.pdf(incoming));
            f64::from(alone.radiance(incoming).x * incoming.z.max(0.0)) / pdf
        };
        let (mut sum, mut squares, n) = (0.0, 0.0, 300_000);
        for _ in 0..n {
            let u = Vec2::new(random.unit() as f32, random.unit() as f32);
            let light = compensated.sample(u).map_or(0.0, |sample| weigh(sample.incoming));
            let value = light + weigh(random.direction().as_vec3());
            sum += value;
            squares += value * value;
        }
        let mean = sum / f64::from(n);
        let error = error.hypot(((squares / f64::from(n) - mean * mean) / f64::from(n)).sqrt());
        assert!(
            (mean - expected).abs() < 4.0 * error,
            "{name}: {mean} is not {expected} ± {error}"
        );
    }
}

/// At all levels, in blocks that are full and not, beside rays that hit something: the bits of one by one.
#[test]
fn many_directions_get_what_each_gets_alone() {
    let mut random = Random::new(6);
    for (name, sky) in skies() {
        let environment =
            Environment::new(&sky, Rgb::new(1.0, 2.0, 3.0), turned(), Aim::Compensated);
        for (level, count) in Level::all().into_iter().flat_map(|l| [0, 1, 64, 200].map(|n| (l, n)))
        {
            let pairs: Vec<_> =
                (0..count).map(|_| Vec2::new(random.unit() as f32, random.unit() as f32)).collect();
            let mut samples = Vec::new();
            level.run(Ask { environment: &environment, pairs: &pairs, samples: &mut samples });
            let alone: Vec<_> = pairs.iter().filter_map(|&u| environment.sample(u)).collect();
            assert_eq!(samples, alone, "{name}, {}: {count}", level.name());
            let ray = |_| Ray::new(Vec3::ZERO, random.direction().as_vec3());
            let rays: Vec<_> = (0..count).map(ray).collect();
            let hit =
                |i| if i % 3 == 0 { Hit { surface: 7, ..Hit::none(1.0) } } else { Hit::none(1.0) };
            let hits: Vec<_> = (0..count).map(hit).collect();
            let mut met = Vec::new();
            level.run(Meet { environment: &environment, rays: &rays, hits: &hits, met: &mut met });
            let free = rays.iter().zip(&hits).filter(|(_, hit)| !hit.is_some());
            let one =
                |ray: &Ray| (environment.radiance(ray.direction), environment.pdf(ray.direction));
            let alone: Vec<_> = free.map(|(ray, _)| one(ray)).collect();
            assert_eq!(met, alone, "{name}, {}: {count}", level.name());
        }
    }
}

#[test]
fn a_black_sky_is_not_looked_at() {
    let sky = Sky::Picture { pixels: picture(8, 4, |_, _| 0.0), sampling: Sampling::Bilinear };
    let environment = Environment::new(&sky, Rgb::ONE, Mat3::IDENTITY, Aim::Alone);
    assert_eq!(environment.sample(Vec2::ZERO), None);
    assert_eq!(environment.pdf(Vec3::Z), 0.0);
}

#[test]
fn suns_of_any_size_give_their_irradiance() {
    let toward = DVec3::new(0.3, -0.5, 0.7).normalize();
    let mut random = Random::new(4);
    for degrees in [1e-3, 0.265, 5.0, 60.0, 90.0] {
        let radius = f64::to_radians(degrees);
        let sun = Sun::new(toward, radius, Rgb::new(3.0, 2.0, 1.0));
        let (mut sum, mut counts, n) = (0.0, vec![0; 256], 100_000);
        for _ in 0..n {
            let u = Vec2::new(random.unit() as f32, random.unit() as f32);
            let sample = sun.sample(u);
            let from = sample.incoming.as_dvec3();
            sum += f64::from(sample.radiance.x / sample.pdf) * from.dot(toward);
            let ring = 0.5 * from.distance_squared(toward) / (2.0 * (0.5 * radius).sin().powi(2));
            let (tangent, bitangent) = crate::math::tangents(toward);
            let around = DVec2::new(from.dot(tangent), from.dot(bitangent)).to_angle() / TAU;
            let cell = |x: f64| ((x.rem_euclid(1.0) * 16.0) as usize).min(15);
            counts[cell(ring.min(0.999_999)) * 16 + cell(around)] += 1;
            // On the very rim, rounding decides.
            let known = sun.pdf(sample.incoming) == sample.pdf
                && sun.radiance(sample.incoming) == sample.radiance;
            assert!(known || ring > 1.0 - 1e-2, "{degrees}: {ring}");
        }
        let mean = sum / f64::from(n);
        assert!((mean / 3.0 - 1.0).abs() < 3e-3, "{degrees}: {mean}");
        let z = chi_squared_z(&counts, &[1.0 / 256.0; 256]);
        assert!(z < 4.5, "{degrees}: {z} standard deviations from the density");
        assert_eq!(sun.pdf(-toward.as_vec3()), 0.0);
    }
}
