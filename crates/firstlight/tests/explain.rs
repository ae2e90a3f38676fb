//! An explanation adds up to its pixel, and says what one would reckon by hand.

mod common;

use common::{read, small_scenes};
use firstlight::explain::{Explanation, Verdict, explain};
use firstlight::render::{RenderOptions, render};
use firstlight::{Look, Scene, SceneDescription};
use std::f64::consts::PI;
use std::ops::ControlFlow;
use std::path::Path;

/// The same as a picture and pixel by pixel.
fn assert_adds_up(name: &str, description: &SceneDescription) {
    let scene = Scene::build(description);
    let picture = render(&scene, &RenderOptions::default(), &|_| ControlFlow::Continue(())).image;
    for (index, pixel) in picture.pixels().iter().enumerate() {
        let place = [index as u32 % picture.width(), index as u32 / picture.width()];
        let explanation = explain(&scene, description, place, 0.0);
        let [r, g, b, alpha] = *pixel;
        let told = (explanation.radiance, explanation.alpha);
        assert_eq!(told, ([r, g, b], alpha), "{name}: {place:?} is rendered as {pixel:?}");
        let largest = f64::from(r.max(g).max(b));
        for (channel, seen) in [r, g, b].into_iter().enumerate() {
            let sum: f64 = explanation.terms.iter().map(|term| term.radiance[channel]).sum();
            let difference = (sum - f64::from(seen)).abs();
            assert!(difference <= 1e-6 * largest, "{name}: {place:?} adds up to {sum}, not {seen}");
        }
    }
}

#[test]
fn the_terms_of_every_pixel_add_up() {
    let scenes = small_scenes();
    assert!(scenes.len() > 15, "{} scenes", scenes.len());
    for (name, mut description) in scenes {
        description.film.transparent |= name.ends_with("first.toml");
        assert_adds_up(&name, &description);
    }
}

#[test]
fn the_terms_of_every_look_add_up() {
    for (name, description) in small_scenes().into_iter().filter(|(name, _)| name.contains("three"))
    {
        for (look_name, look) in Look::NAMES {
            let mut description = description.clone();
            look.apply(&mut description, None);
            assert_adds_up(&format!("{name} for {look_name}"), &description);
        }
    }
}

const BOARD: &str = "
    film = { resolution = [9, 9], samples = 1 }
    camera.orthographic = { position = [0, 0, 4], target = [0, 0, 0], height = 0.1, up = [0, 1, 0] }
    surfaces.floor.quad = { corner = [-2, -2, 0], edge_u = [4, 0, 0], edge_v = [0, 4, 0] }
    surfaces.floor.material = 'grey'
    materials.grey.lambert = { reflectance = 0.5 }
    lights.key.point = { position = [0, 3, 4], intensity = 100 }
    lights.spot.spot = { position = [1.5, 0, 1], target = [1.9, 0, 0], intensity = 10, outer_angle = '20 deg' }
    lights.below.directional = { direction = [0, 0, 1], irradiance = 1 }
";

fn middle(text: &str, more: &[&str]) -> Explanation {
    let description = read(Path::new("scene.toml"), text, more);
    explain(&Scene::build(&description), &description, [4, 4], 0.0)
}

/// E = I cos θ / r², L = R/π E, reckoned from where the ray met the floor.
#[test]
fn a_light_does_what_the_lecture_says() {
    let explanation = middle(BOARD, &[]);
    let step = &explanation.path[0];
    let met = step.met.as_ref().unwrap();
    assert_eq!((met.surface.as_str(), met.material.as_str()), ("floor", "grey"));
    let [x, y, z] = met.position.map(f64::from);
    assert!(z.abs() < 1e-6 && x.abs() < 0.01 && y.abs() < 0.01, "{met:?}");
    let key = step.lights.iter().find(|light| light.source == "key").unwrap();
    let squared = x * x + (3.0 - y) * (3.0 - y) + 16.0;
    let (cos, irradiance) = (4.0 / squared.sqrt(), 100.0 / squared * 4.0 / squared.sqrt());
    let near = |a: f32, b: f64| assert!((f64::from(a) / b - 1.0).abs() < 1e-5, "{a} is not {b}");
    near(key.distance.unwrap(), squared.sqrt());
    near(key.geometry_factor.unwrap(), 1.0 / squared);
    near(key.cos.unwrap(), cos);
    near(key.irradiance[1], irradiance);
    near(key.illuminance as f32, 683.0 * irradiance);
    near(key.bsdf[1], 0.5 / PI);
    near(key.radiance[1], 0.5 / PI * irradiance);
    assert_eq!(key.verdict, Verdict::Lit);
    assert!((key.share - 1.0).abs() < 1e-12, "{}", key.share);
}

/// What became of a light's light in the middle of [`BOARD`], with some values set, and the cause in words.
fn verdict(name: &str, more: &[&str]) -> (Verdict, String) {
    let explanation = middle(BOARD, more);
    let light = explanation.path[0].lights.iter().find(|light| light.source == name);
    (light.unwrap().verdict.clone(), explanation.cause.text)
}

#[test]
fn lights_that_give_nothing_say_why() {
    assert_eq!(verdict("spot", &[]).0, Verdict::OutsideBeam);
    assert_eq!(verdict("below", &[]).0, Verdict::FacesAway);
    let shade = "surfaces.shade.sphere={center=[0, 1.5, 2], radius=0.5}";
    let (blocked, cause) = verdict("key", &[shade]);
    let Verdict::Blocked { by, distance, .. } = blocked else { panic!("{blocked:?}") };
    assert_eq!(by, "shade");
    assert!((distance - 2.0).abs() < 0.02, "the sphere begins 2 m away, not {distance}");
    assert!(cause.contains("light 'key' is blocked by 'shade' 2"), "{cause}");
    let (lit, _) = verdict("key", &[shade, "lights.key.point.shadows=false"]);
    assert_eq!(lit, Verdict::Unshadowed);
}

/// What is said to arrive is what fog leaves, e^(−σ r) of it.
#[test]
fn fog_takes_from_what_arrives() {
    let explanation = middle(BOARD, &["integrator=path", "medium={extinction=0.2, albedo=0}"]);
    let key = explanation.path[0].lights.iter().find(|light| light.source == "key").unwrap();
    let left = (-0.2 * f64::from(key.distance.unwrap())).exp();
    assert!((key.arriving / (left * key.illuminance) - 1.0).abs() < 1e-5, "{key:?}");
    assert!(!key.sampled);
}

/// E of a light with an extent is L cos θ Ω, wherever the sample is; what multiple importance sampling leaves to chance stands
/// beside it.
#[test]
fn light_from_a_panel_can_be_reckoned_by_hand() {
    let panel = "surfaces.panel={quad={corner=[-0.1, 2.9, 4], edge_u=[0, 0.2, 0], edge_v=[0.2, 0, 0]}, light={radiance=50}}";
    let off = "lights.key.point.intensity=0";
    for integrator in ["integrator=path", "integrator=direct"] {
        let explanation = middle(BOARD, &[panel, off, integrator]);
        let panel = explanation.path[0].lights.iter().find(|light| light.source == "panel");
        let panel = panel.unwrap();
        // 0.04 m² about 5 m away, both cosines about 4/5.
        let distance = f64::from(panel.distance.unwrap());
        let (cos, solid_angle) = (4.0 / distance, 0.04 * 4.0 / distance.powi(3));
        let near = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 2e-3, "{a} is not {b}");
        assert!((distance - 5.0).abs() < 0.2);
        near(panel.solid_angle.unwrap().into(), solid_angle);
        near(panel.irradiance[0].into(), 50.0 * cos * solid_angle);
        near(panel.arriving, 683.0 * 50.0 * cos * solid_angle);
        // The floor picks directions with cos θ/π.
        let density = 1.0 / solid_angle;
        near((1.0 - panel.weight).into(), cos / PI / (cos / PI + density));
        let given = f64::from(panel.irradiance[0] * panel.bsdf[0] * panel.weight);
        assert!((f64::from(panel.radiance[0]) / given - 1.0).abs() < 1e-4, "{panel:?}");
        assert_eq!(panel.chance, 1.0);
    }
}

/// A light that was picked for all is told as it is, with the chance that it had.
#[test]
fn lights_picked_for_all_say_with_what_chance() {
    let lamps = (0..40).map(|i| format!("lights.l{i}.point={{position=[{i}, 0, 3], intensity=2}}"));
    let lamps: Vec<_> = lamps.collect();
    let lamps: Vec<_> = lamps.iter().map(String::as_str).chain(["integrator=path"]).collect();
    let explanation = middle(BOARD, &lamps);
    let picked = explanation.path[0].lights.iter().find(|light| light.radiance[0] > 0.0).unwrap();
    let squared = f64::from(picked.distance.unwrap()).powi(2);
    let intensity = if picked.source == "key" { 100.0 } else { 2.0 };
    let by_hand = intensity * f64::from(picked.cos.unwrap()) / squared;
    assert!((f64::from(picked.irradiance[0]) / by_hand - 1.0).abs() < 1e-4, "{picked:?}");
    assert!(picked.chance < 1.0);
    let given = picked.irradiance[0] * picked.bsdf[0] / picked.chance;
    assert!((picked.radiance[0] / given - 1.0).abs() < 1e-4, "{picked:?}");
}

/// The last line speaks of all samples: light that came by a mirror, and from all around, is not told as none.
#[test]
fn little_light_is_told_as_what_leaves() {
    let sky = ["integrator=path", "environment.uniform.radiance=0.01", "film.samples=64"];
    let off = [
        "lights.key.point.intensity=0",
        "lights.spot.spot.intensity=0",
        "lights.below.directional.irradiance=0",
    ];
    let explanation = middle(BOARD, &[&sky[..], &off].concat());
    // L = R times the sky's radiance.
    let nit = explanation.luminance;
    assert!((nit / (683.0 * 0.5 * 0.01) - 1.0).abs() < 0.05, "{nit}");
    let text = explanation.cause.text;
    let told: String = text.split("here, ").nth(1).unwrap().chars().take(3).collect();
    assert!((told.parse::<f64>().unwrap() / nit - 1.0).abs() < 0.05, "{text}");
}

/// The reflectance that is printed is the one that was used, where textures are filtered: f = R/π.
#[test]
fn values_are_those_that_were_used() {
    let checker = "materials.grey.lambert.reflectance={checker={colors=[0.9, 0.1], size=0.004}}";
    let explanation = middle(BOARD, &[checker]);
    let step = &explanation.path[0];
    let key = step.lights.iter().find(|light| light.source == "key").unwrap();
    let told = &step.met.as_ref().unwrap().values[0].value;
    for (told, used) in told.iter().zip(key.bsdf) {
        assert!((f64::from(*told) / (PI * f64::from(used)) - 1.0).abs() < 1e-4, "{told} {used}");
    }
}

/// The same after a mirror, where what is seen is wider than at first.
#[test]
fn values_behind_mirrors_are_those_that_were_used() {
    let more = [
        "integrator=path",
        "surfaces.ceiling.quad={corner=[-9, -9, 8], edge_u=[18, 0, 0], edge_v=[0, 18, 0]}",
        "surfaces.ceiling.material=tiles",
        "materials.tiles.lambert.reflectance={checker={colors=[0.9, 0.1], size=0.001}}",
    ];
    let mirror = BOARD.replace("lambert = { reflectance = 0.5 }", "mirror = {}");
    let explanation = middle(&mirror, &more);
    let step = &explanation.path[1];
    let key = step.lights.iter().find(|light| light.source == "key").unwrap();
    let told = step.met.as_ref().unwrap().values[0].value[0];
    let used = PI * f64::from(key.bsdf[0]);
    assert!((f64::from(told) / used - 1.0).abs() < 1e-4, "{told} {used}");
    assert!(told > 0.11 && told < 0.89, "{told} is not filtered");
}

/// Lights with an extent that shine elsewhere: they are above the horizon.
#[test]
fn lights_of_some_size_that_shine_elsewhere_say_so() {
    let dark = ["lights.key.point.intensity=0", "lights.below.directional.irradiance=0"];
    let round = [dark[0], dark[1], "lights.spot.spot.radius=0.01"];
    assert_eq!(verdict("spot", &round).0, Verdict::OutsideBeam);
    let panel = "surfaces.panel={quad={corner=[1, -1, 2], edge_u=[2, 0, 0], edge_v=[0, 2, 0]}, light={radiance=1}}";
    assert_eq!(verdict("panel", &[panel]).0, Verdict::OutsideBeam);
    let below = panel.replace("2], edge_u", "-2], edge_u");
    assert_eq!(verdict("panel", &[&below]).0, Verdict::FacesAway);
}

/// What comes from everywhere has no place: E = π L, and f is the BSDF's mean.
#[test]
fn ambient_light_with_a_reach_is_no_lamp_nearby() {
    let explanation = middle(BOARD, &["lights.sky.ambient={radiance=0.5, reach=0.4}"]);
    let light = explanation.path[0].lights.iter().find(|light| light.source == "sky").unwrap();
    assert_eq!((light.distance, light.geometry_factor, light.cos), (None, None, None));
    let near = |a: f32, b: f64| assert!((f64::from(a) / b - 1.0).abs() < 1e-5, "{a} is not {b}");
    near(light.irradiance[0], 0.5 * PI);
    near(light.bsdf[0], 0.5 / PI);
    near(light.radiance[0], 0.25);
}

#[test]
fn dark_pixels_have_causes() {
    let cause = |more: &[&str]| middle(BOARD, more).cause;
    let cases = [
        (vec!["materials.grey.lambert.reflectance=0.01"], "black_surface"),
        (vec!["lights.key.point.intensity=0.001"], "weak_light"),
        (vec!["lights.key.point.intensity=5000"], "too_bright"),
        (
            vec![
                "lights.key.point.radius=9",
                "lights.spot.spot.intensity=0",
                "lights.below.directional.irradiance=0",
            ],
            "inside_light",
        ),
        (vec!["integrator=path", "medium={extinction=40, albedo=0}"], "medium"),
        (
            vec!["lights.key.point.position=[0, 0, -4]", "lights.spot.spot.intensity=0"],
            "faces_away",
        ),
        (vec!["surfaces.floor.quad.corner=[5, 5, 0]"], "background"),
        (
            vec!["materials.grey.lambert.emission=0.4", "lights.key.point.intensity=0.01"],
            "emission",
        ),
        (vec![], "lit"),
    ];
    for (more, kind) in cases {
        let found = cause(&more);
        assert_eq!(found.kind, kind, "{more:?}: {}", found.text);
    }
}
