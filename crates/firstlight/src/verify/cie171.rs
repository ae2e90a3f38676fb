//! CIE 171:2006, *Test cases to assess the accuracy of lighting computer programs*: rooms with one lamp or one opening.
//! The geometry is the report's; the expected values are those of the formulas, which its tables round. Radiance stands
//! for luminance: nothing here depends on the luminous efficacy.

mod daylight;
mod standard;

use super::closed_forms::{polygon, rectangle};
use super::scenes::*;
use super::{Case, Random, Readings, Tolerance};
use crate::color::Rgb;
use crate::integrator::Meter;
use crate::scene::Scene;
use crate::scene::description::*;
use glam::DVec3;
use std::f64::consts::PI;

/// A roof under one of the CIE's skies, by its number.
macro_rules! roof {
    ($sky:literal) => {
        daylight::case(
            concat!("Q59-cie-roof-sky", $sky),
            concat!(
                "5.9: a black room with a hole in its roof, and without a roof, under CIE sky ",
                $sky
            ),
            |readings| daylight::roof(readings, $sky, &[1.0, 4.0]),
        )
        .slow()
    };
}

/// A facade before one of the CIE's skies, by its number.
macro_rules! facade {
    ($sky:literal) => {
        daylight::case(
            concat!("Q511-facade-sky", $sky),
            concat!(
                "5.11: an opening of 2 m × 1 m, and a whole wall, to CIE sky ",
                $sky,
                " and the ground"
            ),
            |readings| daylight::facade(readings, $sky, &[[2.0, 1.0], [4.0, 3.0]]),
        )
        .slow()
    };
}

pub(super) const CASES: &[Case] = &[
    Case::exact(
        "Q52-cie-point-diffuse",
        "5.2: a lamp of 1000 cd · cos θ, 3 m above a floor",
        "E = I h² / d⁴",
        q52,
    )
    .within(Tolerance::Relative(5e-4)),
    Case::sampled(
        "Q53-cie-area-diffuse",
        "5.3: a square metre of light in a black room",
        "Lambert 1760",
        q53,
    )
    .within(Tolerance::Relative(3e-3)),
    Case::sampled(
        "Q54-cie-flux",
        "5.4: all the light of a lamp arrives on the walls",
        "conservation of flux",
        q54,
    )
    .within(Tolerance::Absolute(5e-4)),
    Case::sampled(
        "Q56-cie-diffuse-reflection",
        "5.6: what a lit floor reflects onto walls",
        "Lambert 1760",
        q56,
    )
    .within(Tolerance::Relative(3e-3)),
    Case::sampled(
        "Q57-cie-obstruction",
        "5.7: what a lit wall reflects past a black box",
        "Lambert 1760",
        q57,
    )
    .within(Tolerance::Relative(3e-3)),
    Case::sampled(
        "Q58-cie-internal-reflection",
        "5.8: what the walls of a cubic room reflect to each other, in the mean",
        "E = R Φ / (S (1 - R))",
        q58,
    )
    .within(Tolerance::Relative(3e-3))
    .slow(),
    daylight::case(
        "Q59-cie-roof-1x1-sky1",
        "5.9: a black room with a hole of 1 m × 1 m in its roof under CIE sky 1",
        |readings| daylight::roof(readings, 1, &[1.0]),
    )
    .slow(),
    daylight::case(
        "Q59-cie-roof-4x4-sky1",
        "5.9: a black room without a roof under CIE sky 1",
        |readings| daylight::roof(readings, 1, &[4.0]),
    ),
    daylight::case(
        "Q59-cie-roof-4x4-sky5",
        "5.9: a black room without a roof under a uniform sky",
        |readings| daylight::roof(readings, 5, &[4.0]),
    ),
    daylight::case(
        "Q59-cie-roof-1x1-sky5",
        "5.9: a black room with a hole of 1 m × 1 m in its roof under a uniform sky",
        |readings| daylight::roof(readings, 5, &[1.0]),
    )
    .slow(),
    daylight::case(
        "Q59-cie-roof-4x4-sky12",
        "5.9: a black room without a roof under CIE sky 12",
        |readings| daylight::roof(readings, 12, &[4.0]),
    )
    .slow(),
    daylight::case(
        "Q59-cie-roof-1x1-sky12",
        "5.9: a black room with a hole of 1 m × 1 m in its roof under CIE sky 12",
        |readings| daylight::roof(readings, 12, &[1.0]),
    )
    .slow(),
    roof!(2),
    roof!(3),
    roof!(4),
    roof!(6),
    roof!(7),
    roof!(8),
    roof!(9),
    roof!(10),
    roof!(11),
    roof!(13),
    roof!(14),
    roof!(15),
    daylight::case(
        "Q510-roof-glass-1x1",
        "5.10: the hole of 1 m × 1 m under a uniform sky, with a pane in it",
        daylight::glazed_roof,
    )
    .slow(),
    daylight::case(
        "Q511-facade-2x1-sky5",
        "5.11: a black room with an opening of 2 m × 1 m to a uniform sky and a ground that reflects 0.3",
        |readings| daylight::facade(readings, 5, &[[2.0, 1.0]]),
    ),
    daylight::case("Q511-facade-4x3-sky5", "5.11: the same with a whole wall open", |readings| {
        daylight::facade(readings, 5, &[[4.0, 3.0]])
    }),
    facade!(1),
    facade!(2),
    facade!(3),
    facade!(4),
    facade!(6),
    facade!(7),
    facade!(8),
    facade!(9),
    facade!(10),
    facade!(11),
    facade!(12),
    facade!(13),
    facade!(14),
    facade!(15),
];

/// Every half metre from a quarter.
fn steps(count: u32) -> impl DoubleEndedIterator<Item = f64> + ExactSizeIterator {
    (0..count).map(|step| 0.25 + 0.5 * f64::from(step))
}

/// The points on the wall y = 0, from the top down: A to F.
fn on_wall() -> impl Iterator<Item = (char, DVec3)> {
    ('A'..='F').zip(steps(6).rev().map(|z| v(2.0, 0.0, z)))
}

/// A small Lambertian lamp is a disk far smaller than its distance: its own cosine, without a light that has one.
fn q52(readings: &mut Readings) {
    let radius: f64 = 1e-3;
    let radiance = 1000.0 / (PI * radius * radius);
    let mut scene = scene_for_paths(0.5);
    scene.materials[1] = emitter(radiance as f32, 0.0);
    let lamp = Disk { center: v(0.0, 0.0, 3.0), normal: -DVec3::Z, radius };
    add_with(&mut scene, Shape::Disk(lamp), 1);
    let scene = Scene::build(&scene);
    let places = [
        (0.0, 0.0),
        (0.5, 0.0),
        (1.0, 0.0),
        (1.5, 0.0),
        (0.5, 0.5),
        (1.0, 0.5),
        (1.5, 0.5),
        (1.0, 1.0),
        (1.5, 1.0),
        (1.5, 1.5),
    ];
    for (name, (x, y)) in ('A'..).zip(places) {
        let expected = 1000.0 * 9.0 / (x * x + y * y + 9.0_f64).powi(2);
        readings.irradiance(name, &scene, v(x, y, 0.0), DVec3::Z, expected);
    }
}

/// A black room of 4 m × 4 m × 3 m; its ceiling is a millimetre higher, behind what hangs there.
fn black_room() -> SceneDescription {
    let mut scene = scene_for_paths(0.0);
    add(&mut scene, Shape::Block(Block { min: DVec3::ZERO, max: v(4.0, 4.0, 3.001) }));
    scene
}

fn q53(readings: &mut Readings) {
    let mut scene = black_room();
    scene.materials[1] = emitter(1000.0, 0.0);
    add_with(&mut scene, panel(v(2.0, 2.0, 3.0), 1.0, 1.0), 1);
    let scene = Scene::build(&scene);
    let source = rectangle(v(1.5, 1.5, 3.0), DVec3::X, DVec3::Y);
    let on_floor = ('G'..='N').zip(steps(8).map(|y| v(2.0, y, 0.0)));
    let all = on_wall().map(|(name, place)| (name, place, DVec3::Y));
    for (name, place, normal) in all.chain(on_floor.map(|(name, place)| (name, place, DVec3::Z))) {
        let expected = 1000.0 * polygon(place, normal, &source);
        readings.irradiance(name, &scene, place, normal, expected);
    }
}

/// The mean over a rectangle of what `value` says of its points: one in each of `cells` × `cells` cells.
fn mean_over(
    cells: u32,
    [corner, edge_u, edge_v]: [DVec3; 3],
    random: &mut Random,
    value: impl Fn(DVec3) -> f64,
) -> f64 {
    let mut sum = 0.0;
    for cell in 0..cells * cells {
        let at =
            |index: u32, random: &mut Random| (f64::from(index) + random.unit()) / f64::from(cells);
        let (s, t) = (at(cell % cells, random), at(cell / cells, random));
        sum += value(corner + s * edge_u + t * edge_v);
    }
    sum / f64::from(cells * cells)
}

/// The inner sides of the walls of a room: a corner, two edges and the area; the normal is u × v.
fn walls(size: DVec3) -> [(DVec3, DVec3, DVec3); 6] {
    let [x, y, z] = [v(size.x, 0.0, 0.0), v(0.0, size.y, 0.0), v(0.0, 0.0, size.z)];
    [(DVec3::ZERO, x, y), (z, y, x), (DVec3::ZERO, y, z), (x, z, y), (DVec3::ZERO, z, x), (y, x, z)]
}

fn q54(readings: &mut Readings) {
    let mut scene = SceneDescription { integrator: Integrator::Direct, ..black_room() };
    light(&mut scene, point_light(v(2.0, 2.0, 1.5), Rgb::splat(1e4)));
    let scene = Scene::build(&scene);
    let flux = |seed| {
        let mut random = Random::new(seed);
        let arriving = walls(v(4.0, 4.0, 3.0)).map(|(corner, u, w)| {
            let (area, normal) = (u.cross(w).length(), u.cross(w).normalize());
            let irradiance = |place| f64::from(scene.irradiance(place, normal).value.x);
            area * mean_over(64, [corner, u, w], &mut random, irradiance)
        });
        arriving.iter().sum::<f64>() / 1e4
    };
    readings.repeated("", flux, 1.0);
}

/// The floor is lit from straight above, so that what arrives on walls and ceiling has been reflected once; E_hz · R is
/// 100, which makes the irradiance the percentage asked for.
fn q56(readings: &mut Readings) {
    let reflectance = 0.3;
    let mut scene = scene_for_paths(reflectance);
    let (across, along) = (v(4.0, 0.0, 0.0), v(0.0, 4.0, 0.0));
    add(&mut scene, quad(DVec3::ZERO, across, along));
    let irradiance = Rgb::splat(100.0 / reflectance);
    light(&mut scene, Light::Directional { direction: -DVec3::Z, irradiance });
    let (scene, source) = (Scene::build(&scene), rectangle(DVec3::ZERO, across, along));
    let on_wall = ('B'..='F').zip(steps(6).skip(1).map(|z| (v(2.0, 0.0, z), DVec3::Y)));
    let on_ceiling = ('G'..='N').zip(steps(8).map(|y| (v(2.0, y, 3.0), -DVec3::Z)));
    for (name, (place, normal)) in on_wall.chain(on_ceiling) {
        let expected = 100.0 / PI * polygon(place, normal, &source);
        readings.irradiance(name, &scene, place, normal, expected);
    }
}

/// The part of the wall y = 4 that is seen from x = 2 over a box that is as wide as the room.
fn seen_over_box(from: DVec3) -> [DVec3; 4] {
    let slope = |y: f64| (1.0 - from.z) / (y - from.y);
    let lowest = from.z + slope(2.5).max(slope(2.7)) * (4.0 - from.y);
    let lowest = lowest.clamp(0.0, 3.0);
    rectangle(v(0.0, 4.0, lowest), v(4.0, 0.0, 0.0), v(0.0, 0.0, 3.0 - lowest))
}

/// The wall is lit by a light that casts no shadow; E_v · R is 100.
fn q57(readings: &mut Readings) {
    let reflectance = 0.6;
    let mut scene = scene_for_paths(reflectance);
    add(&mut scene, quad(v(0.0, 4.0, 0.0), v(4.0, 0.0, 0.0), v(0.0, 0.0, 3.0)));
    let obstruction = Block { min: v(0.0, 2.5, 0.0), max: v(4.0, 2.7, 1.0) };
    add_with(&mut scene, Shape::Block(obstruction), 2);
    let irradiance = Rgb::splat(100.0 / reflectance);
    light(&mut scene, Light::Directional { direction: DVec3::Y, irradiance });
    scene.lights[0].shadows = false;
    let scene = Scene::build(&scene);
    let on_floor = ('G'..='K').zip(steps(5).map(|y| v(2.0, y, 0.0)));
    let all = on_wall().map(|(name, place)| (name, place, DVec3::Y));
    for (name, place, normal) in all.chain(on_floor.map(|(name, place)| (name, place, DVec3::Z))) {
        let expected = 100.0 / PI * polygon(place, normal, &seen_over_box(place));
        readings.irradiance(name, &scene, place, normal, expected);
    }
}

/// All walls are alike, so one will do. What comes straight from the lamp is taken off.
fn q58(readings: &mut Readings) {
    let (lumens, side) = (1e4, 4.0);
    for reflectance in [0.0_f32, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95] {
        let mut scene = scene_for_paths(reflectance);
        add(&mut scene, cube(DVec3::splat(0.5 * side), side));
        light(&mut scene, point_light(DVec3::splat(0.5 * side), Rgb::splat(lumens)));
        let direct = SceneDescription { integrator: Integrator::Direct, ..scene.clone() };
        let direct = Scene::build(&direct);
        let mut indirect = |seed| {
            scene.film.seed = seed;
            let all = Scene::build(&scene);
            let meter = Meter::new(&all).samples(256);
            let (u, w) = (v(side, 0.0, 0.0), v(0.0, side, 0.0));
            mean_over(16, [DVec3::ZERO, u, w], &mut Random::new(seed), |place| {
                let [all, direct] =
                    [meter.irradiance(place, DVec3::Z), direct.irradiance(place, DVec3::Z)];
                f64::from(all.value.x) - f64::from(direct.value.x)
            })
        };
        if reflectance == 0.0 {
            // Nothing is left of two numbers of some 50 lx but their rounding, of which chance knows nothing.
            readings.at_most("0, lx", indirect(0).abs(), 1e-4);
            continue;
        }
        let rho = f64::from(reflectance);
        let expected = rho * f64::from(lumens) / (6.0 * side * side * (1.0 - rho));
        readings.repeated(reflectance, indirect, expected);
    }
}
