//! The quick set of the reference table, and what belongs beside it.

mod common;

use common::*;
use firstlight::scene::description::*;
use firstlight::verify::{Case, GROUPS, Reading, greatest_z};
use firstlight::{Meter, Scene, SceneDescription};
use glam::{DVec3, Vec3};
use std::f64::consts::PI;

/// Runs the quick cases, or all others.
fn passes(quick: bool) {
    let cases = GROUPS.iter().flat_map(|(_, cases)| *cases).filter(|case| case.quick == quick);
    let run = |case: &'static Case| case.run().into_iter().map(|reading| (case.id, reading));
    let readings: Vec<(&str, Reading)> = cases.flat_map(run).collect();
    let greatest_z = greatest_z(readings.len());
    let failed: Vec<_> = readings.iter().filter(|(_, r)| !r.passes(greatest_z)).collect();
    assert!(failed.is_empty(), "of {} readings, these fail: {failed:#?}", readings.len());
}

#[test]
fn the_quick_set_of_the_reference_table_passes() {
    passes(true);
}

#[test]
#[ignore = "the slow set: light of hundreds of reflections"]
fn the_rest_of_the_reference_table_passes() {
    passes(false);
}

/// Names are never given twice, nor are the points of a case.
#[test]
fn every_case_and_point_has_a_name_of_its_own() {
    let mut names: Vec<_> = GROUPS.iter().flat_map(|(_, cases)| *cases).map(|c| c.id).collect();
    names.sort_unstable();
    assert!(names.windows(2).all(|pair| pair[0] != pair[1]));
    for case in ["L02-point-offaxis", "G02-triangle-solid-angle", "K04-srgb-oetf"] {
        let mut cases = GROUPS.iter().flat_map(|(_, cases)| *cases);
        let case = cases.find(|c| c.id == case).expect("it is in the table");
        let mut points: Vec<_> = case.run().into_iter().map(|reading| reading.at).collect();
        points.sort_unstable();
        assert!(points.windows(2).all(|pair| pair[0] != pair[1]), "{points:?}");
    }
}

/// A renderer whose lights are all 0.1 % too bright is found out, by cases that are well within their tolerance.
#[test]
fn a_bias_of_a_thousandth_is_found() {
    for id in
        ["A01-square-above", "E01-uniform-sky", "C03-emissive-sphere", "C07-point-in-sphere-centre"]
    {
        let mut cases = GROUPS.iter().flat_map(|(_, cases)| *cases);
        let case = cases.find(|case| case.id == id).expect("it is in the table");
        let greatest_z = greatest_z(500);
        let right = case.run();
        assert!(right.iter().all(|reading| reading.passes(greatest_z)), "{right:?}");
        for reading in case.run_with_gain(1.001) {
            assert!(reading.difference.abs() <= reading.allowed, "{id}: within the tolerance");
            assert!(!reading.passes(greatest_z), "{id}: z is {}", reading.z);
        }
    }
}

#[test]
#[ignore = "the slow set: 10^8 rays take minutes"]
fn closed_meshes_are_watertight_for_ten_to_the_eighth_rays() {
    assert_eq!(escaped(100_000_000), 0);
}

#[test]
#[ignore = "the slow set: 10^7 rays"]
fn ten_million_rays_that_leave_a_surface_do_not_meet_it_again() {
    let (left, met) = reintersections(20_000, 1000);
    assert!(left > 8_000_000, "{left} rays left");
    assert_eq!(met, 0);
}

fn irradiance_is(scene: &SceneDescription, at: DVec3, expected: f64) {
    let measured = Meter::new(&Scene::build(scene)).irradiance(at, DVec3::Z);
    let error = f64::from(measured.standard_error.x);
    assert!(error <= 1e-3 * expected, "{measured:?}");
    let off = (f64::from(measured.value.x) - expected).abs();
    // Neither rounding nor what is found once in a million samples shows in the standard error.
    assert!(off <= 4.0 * error + 3e-5 * expected, "{measured:?} is not {expected}");
}

/// The meter honours the scene's shadow setting, as the render does.
#[test]
fn without_shadows_the_meter_sees_every_light() {
    let mut scene = scene_of(Vec3::splat(0.5));
    scene.shadows = Shadows::Off;
    add(&mut scene, cube(v(0.0, 0.0, 1.0), 0.1));
    light(&mut scene, point_light(v(0.0, 0.0, 2.0), Vec3::splat(100.0)));
    close(Scene::build(&scene).irradiance(DVec3::ZERO, DVec3::Z).value.x, 1.98943679, 1e-5);
}

/// A sheet of alpha 0.4 stops 40 % of the light and of the view; chance decides, and the meter says how well it knows.
#[test]
fn partly_transparent_surfaces_are_measured_with_their_error() {
    let mut scene = scene_of(Vec3::splat(0.2));
    scene.materials[0].alpha = Alpha::Blend;
    scene.materials[0].reflectance.factor[3] = 0.4;
    scene.background = Vec3::ONE;
    let ambient = 0.5;
    light(&mut scene, Light::Ambient { radiance: Vec3::splat(ambient), reach: f64::INFINITY });
    light(&mut scene, Light::Directional { direction: -DVec3::Z, irradiance: Vec3::ONE });
    add(&mut scene, floor());
    let scene = Scene::build(&scene);
    let through = firstlight::Ray::new(Vec3::new(0.0, 0.0, 1.0), -Vec3::Z);
    let lit = 0.2 * (f64::from(ambient) + 1.0 / PI);
    for (measured, expected) in [
        (scene.radiance(&through), 0.4 * lit + 0.6),
        (scene.irradiance(v(0.0, 0.0, -1.0), DVec3::Z), PI * f64::from(ambient) + 0.6),
    ] {
        let (value, error) = (f64::from(measured.value.x), f64::from(measured.standard_error.x));
        assert!(error > 0.0 && error < 0.02 && measured.samples > 1, "{measured:?}");
        assert!((value - expected).abs() < 4.0 * error, "{measured:?} is not {expected}");
    }
}

/// The same along paths, which the underside of the floor sends light back to as well.
#[test]
fn partly_transparent_surfaces_are_measured_along_paths() {
    let mut scene = scene_for_paths(0.2);
    scene.materials[0].alpha = Alpha::Blend;
    scene.materials[0].reflectance.factor[3] = 0.4;
    scene.background = Vec3::ONE;
    light(&mut scene, Light::Ambient { radiance: Vec3::splat(0.5), reach: f64::INFINITY });
    light(&mut scene, Light::Directional { direction: -DVec3::Z, irradiance: Vec3::ONE });
    add(&mut scene, floor());
    let scene = Scene::build(&scene);
    let through = firstlight::Ray::new(Vec3::new(0.0, 0.0, 1.0), -Vec3::Z);
    let lit = 0.2 * (0.5 + 1.0 / PI);
    for (measured, expected) in [
        (scene.radiance(&through), 0.4 * lit + 0.6),
        (scene.irradiance(v(0.0, 0.0, -1.0), DVec3::Z), PI * (0.5 + 0.4 * 0.2 * 0.5) + 0.6),
    ] {
        let (value, error) = (f64::from(measured.value.x), f64::from(measured.standard_error.x));
        assert!(error > 0.0 && error < 0.02, "{measured:?}");
        assert!((value - expected).abs() < 4.5 * error, "{measured:?} is not {expected}");
    }
}

/// Half of a sun of 60° is above the horizon; the edge of a half plane cuts another in two.
#[test]
fn suns_are_cut_by_horizons_and_edges() {
    let mut scene = scene_for_paths(0.5);
    let sun = |direction: DVec3, degrees: f64| Light::Sun {
        direction,
        irradiance: Vec3::splat(10.0),
        angular_radius: degrees.to_radians(),
    };
    light(&mut scene, sun(-DVec3::X, 30.0));
    // ∫ cos over half a cone around the horizon: as A12 at 90°, for sin 30° = 1/2.
    let (s, half) = (PI / 6.0, 0.5);
    let lit = (s - half * s.cos()) / (PI * half * half);
    irradiance_is(&scene, DVec3::ZERO, 10.0 * lit);
    scene.lights[0].light = sun(-DVec3::Z, 0.265);
    irradiance_is(&scene, DVec3::ZERO, 10.0);
    add_with(&mut scene, quad(v(0.0, -1e3, 2.0), v(1e3, 0.0, 0.0), v(0.0, 2e3, 0.0)), 2);
    irradiance_is(&scene, DVec3::ZERO, 5.0);
    let rim = 2.0 * 0.265_f64.to_radians().tan();
    irradiance_is(&scene, v(-1.01 * rim, 0.0, 0.0), 10.0);
    assert_eq!(
        Scene::build(&scene).irradiance(v(1.01 * rim, 0.0, 0.0), DVec3::Z).value,
        Vec3::ZERO
    );
}

/// Every filter leaves a constant picture as it is, to the last bit.
#[test]
fn filters_keep_a_constant() {
    let mitchell = Filter::Mitchell { radius: 2.0, b: 1.0 / 3.0, c: 1.0 / 3.0 };
    let filters =
        [Filter::Box { radius: 0.5 }, Filter::Tent { radius: 1.0 }, Filter::default(), mitchell];
    for filter in filters {
        for samples in [1, 2, 5, 16, 33] {
            let mut scene = scene_of(Vec3::ZERO);
            scene.background = Vec3::new(0.25, 0.5, 0.75);
            scene.film = FilmDescription { width: 7, height: 5, samples, filter, ..scene.film };
            let image = picture(&scene).image;
            let flat = |p: &[f32; 4]| *p == [0.25, 0.5, 0.75, 1.0];
            assert!(image.pixels().iter().all(flat), "{filter:?} {samples}");
        }
    }
}
