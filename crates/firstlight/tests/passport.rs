//! What the passport of a light says, against formulas.

use firstlight::io::scene_file;
use firstlight::passport::{Entry, Passport};
use firstlight::{FileAccess, Scene};
use glam::DVec3;
use std::f64::consts::PI;
use std::path::Path;

/// Two balls whose middle is the origin, and what is added to them.
fn passport(more: &str) -> Passport {
    let text = format!(
        "luminous_efficacy = 179
         surfaces.left.sphere = {{ center = [-5, 0, 0], radius = 1 }}
         surfaces.right.sphere = {{ center = [5, 0, 0], radius = 1 }}
         {more}"
    );
    let access = FileAccess::beside(Path::new("scene.toml"), &[]);
    let scene = scene_file::read(&text, "scene.toml", &[], &access, &mut Vec::new()).unwrap();
    let passport = Passport::new(&scene, &Scene::build(&scene));
    assert!(passport.middle.distance(DVec3::ZERO) < 1e-3, "{}", passport.middle);
    passport
}

fn only(more: &str) -> Entry {
    let [entry] = <[_; 1]>::try_from(passport(more).lights).unwrap();
    entry
}

#[track_caller]
fn near(value: f32, expected: f64) {
    assert!((f64::from(value) / expected - 1.0).abs() < 2e-3, "{value} is not {expected}");
}

/// The middle of a single model is inside of it: light is reckoned where the camera sees it.
#[test]
fn models_are_lit_from_outside() {
    let view = "camera.perspective = { position = [0, -9, 0], target = [0, 0, 0] }";
    let balls = |radius: f32, view: &str| {
        let lamp =
            |name, y| format!("lights.{name}.point = {{ position = [0, {y}, 0], power = 10 }}\n");
        let (near, far) = (lamp("near", -6), lamp("far", 6));
        let text = format!("surfaces.ball.sphere.radius = {radius}\n{view}\n{near}{far}");
        let access = FileAccess::beside(Path::new("scene.toml"), &[]);
        let scene = scene_file::read(&text, "scene.toml", &[], &access, &mut Vec::new()).unwrap();
        Passport::new(&scene, &Scene::build(&scene))
    };
    for view in [view, &view.replace("perspective = {", "orthographic = { height = 8,")] {
        let passport = balls(2.0, view);
        assert_eq!(passport.surface.as_deref(), Some("ball"));
        assert!(passport.middle.distance(DVec3::new(0.0, -2.0, 0.0)) < 1e-3, "{}", passport.middle);
        let [near_one, far_one] = &passport.lights[..] else { panic!() };
        assert_eq!((&near_one.blocked, &far_one.blocked), (&None, &Some((1.0, "ball".into()))));
        near(near_one.irradiance.x, 10.0 / (4.0 * PI) / 16.0);
    }
    // A camera in a room sees its middle.
    let inside = balls(20.0, view);
    assert_eq!((inside.middle, inside.surface), (DVec3::ZERO, None));
}

/// What the author wrote, or the same number where that is not kept.
#[test]
fn every_light_has_its_value() {
    let written = |more: &str| only(more).written;
    assert_eq!(
        written("lights.l.directional = { direction = [0, 0, -1], irradiance = '50 fc' }"),
        "50 fc"
    );
    assert_eq!(written("lights.l.point = { position = [0, 0, 2], power = 60 }"), "60 W");
    let panel =
        "surfaces.p = { quad = { corner = [-0.5, -0.5, 0] }, light = { power = '3000 lm' } }";
    assert_eq!(passport(panel).lights[0].written, "3000 lm");
    assert_eq!(written("environment.uniform.radiance = 0.5"), "500 mW/(sr m²)");
}

#[test]
fn lamps_and_spots() {
    let lamp = only("lights.l.point = { position = [0, 0, 2], power = '1790 lm' }");
    near(lamp.power.unwrap().x, 10.0);
    near(lamp.intensity.unwrap().x, 10.0 / (4.0 * PI));
    near(lamp.irradiance.x, 10.0 / (16.0 * PI));
    assert_eq!((lamp.written.as_str(), lamp.blocked), ("1790 lm", None));
    // A hard cone of 60° is a quarter of the sphere.
    let cone = "inner_angle = 59.999, outer_angle = 60";
    let spot = only(&format!(
        "lights.s.spot = {{ position = [0, 0, 3], target = [0, 0, 0], intensity = 9, {cone} }}"
    ));
    near(spot.power.unwrap().x, 9.0 * PI);
    near(spot.irradiance.x, 1.0);
}

#[test]
fn what_is_all_around_counts_for_a_horizontal_surface() {
    near(only("environment.uniform = { radiance = 2 }").irradiance.x, 2.0 * PI);
    near(only("lights.a.ambient = { radiance = 2 }").irradiance.x, 2.0 * PI);
    // The sine of the elevation from 0 to 1: π ∫ 2 s² ds.
    let gradient = only("environment.gradient = { zenith = 3, horizon = 0 }");
    near(gradient.irradiance.x, 2.0 * PI);
}

#[test]
fn surfaces_that_shine() {
    let panel = "surfaces.panel = { quad = { corner = [-0.1, -0.1, 4], edge_u = [0, 0.2, 0], edge_v = [0.2, 0, 0] }, light = { power = 5 } }";
    let panel = passport(&format!(
        "{panel}\nsurfaces.below.sphere = {{ center = [0, 0, -4], radius = 0.0001 }}"
    ))
    .lights;
    assert_eq!((panel.len(), panel[0].name.as_str()), (1, "panel"));
    near(panel[0].power.unwrap().x, 5.0);
    near(panel[0].radiance.unwrap().x, 5.0 / (0.04 * PI));
    // From afar, L A / r².
    near(panel[0].irradiance.x, 5.0 / PI / 16.0);
}

#[test]
fn what_stands_in_between_is_named() {
    let wall = "surfaces.wall.disk = { center = [0, 0, 0.5], radius = 0.5 }
        surfaces.under.disk = { center = [0, 0, -0.5], radius = 0.1 }";
    let lamp = only(&format!("{wall}\nlights.l.point = {{ position = [0, 0, 2], power = 10 }}"));
    assert_eq!(lamp.blocked, Some((1.0, "wall".into())));
    let beside = only(&format!("{wall}\nlights.l.point = {{ position = [0, 9, 2], power = 10 }}"));
    assert_eq!(beside.blocked, None);
    let unshadowed = only(&format!(
        "{wall}\nlights.l.point = {{ position = [0, 0, 2], power = 10, shadows = false }}"
    ));
    assert_eq!(unshadowed.blocked, None);
}
