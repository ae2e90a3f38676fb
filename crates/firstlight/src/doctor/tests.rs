//! For each finding a scene that has it, and a neighbour that does not.

use super::{CODES, Care, Doctor, Shown};
use crate::color::Rgb;
use crate::diagnostic::Diagnostic;
use crate::io::{FileAccess, Warnings, scene_file};
use crate::render::{Crop, RenderOptions, render};
use crate::scene::Studio;
use crate::scene::description::*;
use crate::{Scene, SceneDescription};
use glam::{Vec2, Vec3};
use std::collections::BTreeSet;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Arc;

/// A ball on a floor under a lamp.
const SCENE: &str = "
    film = { resolution = [48, 32], samples = 4 }
    [camera.perspective]
    position = [0, -6, 3]
    target = [0, 0, 0.5]
    fov = 40
    [materials.paint.lambert]
    reflectance = 0.5
    [surfaces.ball]
    sphere = { center = [0, 0, 1], radius = 1 }
    material = 'paint'
    [surfaces.floor]
    disk = { radius = 20 }
    [lights.lamp.point]
    position = [2, -4, 5]
    power = '1 kW'
";

fn read(text: &str) -> SceneDescription {
    let access = FileAccess::beside(Path::new("scene.toml"), &[]);
    scene_file::read(text, "scene.toml", &[], &access, &mut Warnings::new())
        .unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// The scene with `from` replaced by `to`, and `more` at its end.
fn changed(from: &str, to: &str, more: &str) -> String {
    assert!(SCENE.contains(from), "{from}");
    SCENE.replace(from, to) + more
}

/// Everything that is found in a scene and its picture.
fn findings(scene: &SceneDescription) -> Vec<Diagnostic> {
    scene.check().unwrap();
    let built = Scene::build(scene);
    let doctor = Doctor::new(scene, &built);
    let rendered = render(&built, &RenderOptions::default(), &|_| ControlFlow::Continue(()));
    let exposure_ev = if let Exposure::Ev(ev) = scene.film.exposure { ev } else { 0.0 };
    let noise = rendered.noise;
    let shown =
        Shown { rendered: &rendered, exposure_ev, auto_exposure: false, developed: true, noise };
    let mut found = doctor.examine(Care::Thorough);
    // What is found quickly is found with care as well.
    let all: BTreeSet<_> = found.iter().map(|finding| finding.code).collect();
    for quick in doctor.examine(Care::Quick) {
        assert!(all.contains(quick.code), "{quick}");
    }
    found.extend(doctor.judge(&shown));
    found
}

/// That `sick` has this finding with all of the `words` in it, and `healthy` does not.
#[track_caller]
fn told_apart(
    code: &'static str,
    words: &[&str],
    sick: &SceneDescription,
    healthy: &SceneDescription,
) {
    let found = findings(sick);
    let texts: Vec<_> = found.iter().map(|f| format!("[{}] {f}", f.code)).collect();
    let finding = found.iter().find(|finding| finding.code == code);
    let finding = finding.unwrap_or_else(|| panic!("no {code} in {texts:#?}"));
    for word in words {
        assert!(finding.to_string().contains(word), "{word:?} is not in {finding}");
    }
    assert!(CODES.iter().any(|(known, _)| *known == code));
    let found = findings(healthy);
    assert!(!found.iter().any(|finding| finding.code == code), "{found:#?}");
}

#[track_caller]
fn texts_told_apart(code: &'static str, words: &[&str], sick: &str, healthy: &str) {
    told_apart(code, words, &read(sick), &read(healthy));
}

#[test]
fn a_healthy_scene_has_no_findings() {
    assert_eq!(findings(&read(SCENE)), []);
    let path = format!("integrator = 'path'\n{SCENE}").replace("samples = 4", "samples = 64");
    assert_eq!(findings(&read(&path)), []);
}

/// A model as the command line shows it, without the light at the camera.
fn in_studio(text: &str) -> SceneDescription {
    let mut scene = read(&format!("film = {{ resolution = [48, 32], samples = 4 }}\n{text}"));
    Studio { headlight: None, ..Studio::default() }.dress(&mut scene);
    scene
}

/// A house of one-sided walls whose fronts face out: the camera looks in through some of their backs, and they keep the
/// light off all the same.
fn house(half: f32, wind: impl Fn([u32; 3]) -> [u32; 3]) -> String {
    let corner = |i: u32| [i & 1, i >> 1 & 1, i >> 2].map(|bit| (2.0 * bit as f32 - 1.0) * half);
    let vertices: Vec<_> = (0..8).map(corner).collect();
    let squares =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let halves = squares.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]);
    let triangles: Vec<_> = halves.map(wind).collect();
    format!(
        "[surfaces.house]\nmaterial = 'wall'\nmesh = {{ vertices = {vertices:?}, triangles = {triangles:?} }}
        [materials.wall.lambert]\nreflectance = 0.5\ndouble_sided = false\n"
    )
}

/// The studio's ground is no part of what is to be shown: it may be seen while the model is not.
#[test]
fn the_ground_of_the_studio_hides_nothing() {
    let (whole, turned) = (|t| t, |[a, b, c]: [u32; 3]| [a, c, b]);
    let healthy = in_studio(&house(1.0, whole));
    assert_eq!(findings(&healthy), []);
    let words = ["\"house\", through whose back the camera looks in", "--headlight 1"];
    told_apart("picture-black", &words, &in_studio(&house(1.0, turned)), &healthy);
    let black = house(1.0, whole).replace("reflectance = 0.5", "reflectance = 0");
    let words = ["of what is seen of the model is black", "material \"wall\""];
    told_apart("picture-black", &words, &in_studio(&black), &healthy);
    let away = "camera.perspective = { position = [0, -5, 0], target = [0, -9, 0] }\n";
    let away = in_studio(&format!("{away}{}", house(1.0, whole)));
    told_apart("camera-sees-nothing", &["nothing of the model"], &away, &healthy);
    let gone = house(1.0, whole).replace("reflectance = 0.5", "opacity = 0");
    let found: Vec<_> = findings(&in_studio(&gone)).iter().map(|found| found.code).collect();
    assert!(found.contains(&"material-invisible"), "{found:?}");
    assert!(!found.contains(&"camera-sees-nothing"), "{found:?}");
}

#[test]
fn models_as_large_as_towns_or_with_stray_triangles() {
    let whole = |t| t;
    // Only where the unit makes a difference: mountains of stone may be as large as they are.
    let words = ["10 km", "10 m", "--unit mm"];
    let glass = "dielectric]\nattenuation_color = 'green'\nattenuation_distance = 3";
    let of_glass = house(5000.0, whole).replace("lambert]\nreflectance = 0.5", glass);
    let (stone, small) = (house(5000.0, whole), of_glass.replace("5000.0", "5.0"));
    told_apart("size-millimetres", &words, &in_studio(&of_glass), &in_studio(&stone));
    not_in(&in_studio(&small), "size-millimetres");
    let stray = |x: f32| {
        let corners = format!("[[{x}, 0, 0], [{x}, 1, 0], [{x}, 0, 1]]");
        let stray = format!("mesh = {{ vertices = {corners}, triangles = [[0, 1, 2]] }}");
        in_studio(&format!("{}{}[surfaces.stray]\n{stray}\n", house(1.0, whole), more_of_it()))
    };
    told_apart("camera-far", &["a few stray ones", "delete"], &stray(5000.0), &stray(5.0));
    not_in(&stray(5000.0), "camera-sees-nothing");
}

/// Two more of the house, of which three vertices are a small part.
fn more_of_it() -> &'static str {
    "[instances.more]\nof = 'house'\ntransform = [{ scale = 0.5 }]
    [instances.again]\nof = 'house'\ntransform = [{ scale = 0.4 }]\n"
}

/// That a scene does not have this finding.
#[track_caller]
fn not_in(scene: &SceneDescription, code: &str) {
    let found = findings(scene);
    assert!(!found.iter().any(|finding| finding.code == code), "{found:#?}");
}

#[test]
fn scenes_without_anything() {
    let unlit = SCENE.split("[lights").next().unwrap();
    texts_told_apart("no-lights", &["all surfaces are black"], unlit, SCENE);
    texts_told_apart("no-surfaces", &["background"], "[lights.a.ambient]\nradiance = 1", SCENE);
}

#[track_caller]
fn not_told(code: &str, text: &str) {
    not_in(&read(text), code);
}

#[test]
fn clarity_needs_no_lights() {
    let unlit = SCENE.split("[lights").next().unwrap();
    not_told("no-lights", &format!("look = 'clarity'\n{unlit}"));
}

/// One whose cone ends on one surface, aside of what is seen, is in nothing.
#[test]
fn spots_that_shine_past_are_inside_of_nothing() {
    let spot = SCENE
        .replace("lamp.point", "lamp.spot")
        .replace("power = '1 kW'", "intensity = 80\ndirection = [0, 0, -1]\nouter_angle = 5");
    let past = spot.replace("[2, -4, 5]", "[15, -4, 5]");
    let seen = spot.replace("[2, -4, 5]", "[0, -2, 5]");
    texts_told_apart("light-averted", &["aim it at what is seen"], &past, &seen);
    not_told("light-inside", &past);
}

/// A beam that shows in fog, whatever it meets.
#[test]
fn lights_that_are_seen_in_fog_are_of_use() {
    let past = "[lights.beam.spot]\nposition = [-9, 9, 3]\ndirection = [1, 0, 0]\nintensity = 80\nouter_angle = 5\n";
    let clear = format!("integrator = 'path'\n{SCENE}{past}");
    let fog = clear.replace("film =", "medium = { extinction = 0.1, albedo = 0.9 }\nfilm =");
    texts_told_apart("light-averted", &["light \"beam\""], &clear, &fog);
}

/// Things that light gets through hide nothing, so it does not matter which of two is seen.
#[test]
fn what_is_not_opaque_may_lie_in_another() {
    let globe = |material: &str| {
        format!(
            "integrator = 'path'\n{SCENE}[surfaces.globe]\nsphere = {{ center = [0, 0, 1], radius = 1 }}
            material = 'it'\n[materials.it.{material}]\n"
        )
    };
    for material in ["thin_glass]\n[x", "medium]\nscattering = 0.3\nabsorption = 0.1\n[x"] {
        let text = globe(material).replace("\n[x]", "");
        not_told("duplicate-surfaces", &text);
        not_told("surfaces-coincide", &text);
    }
    texts_told_apart("duplicate-surfaces", &["globe"], &globe("lambert"), SCENE);
}

/// One looks into it through the walls on this side, as into a doll's house.
#[test]
fn rooms_may_be_looked_into() {
    let room = |more: &str| {
        format!(
            "film = {{ resolution = [48, 32], samples = 4 }}
            camera.perspective = {{ position = [0, -6, 2], target = [0, 0, 1], fov = 25 }}
            materials.wall.lambert = {{ double_sided = false }}
            [surfaces.room]
            material = 'wall'
            mesh.vertices = [[-2,-2,0],[2,-2,0],[2,2,0],[-2,2,0],[-2,-2,2.5],[2,-2,2.5],[2,2,2.5],[-2,2,2.5]]
            mesh.triangles = [[0,1,2],[0,2,3],[4,6,5],[4,7,6],[0,4,5],[0,5,1],[1,5,6],[1,6,2],[2,6,7],[2,7,3],[3,7,4],[3,4,0]]
            [lights.lamp.point]
            power = '300 W'\n{more}"
        )
    };
    let words = ["surface \"room\"", "wound clockwise"];
    let outside = room("position = [0, -7, 2]");
    texts_told_apart("seen-from-behind", &words, &outside, &room("position = [0, 0, 2]"));
    let furnished = outside + "\n[surfaces.ball]\nsphere = { center = [0, 0, 1], radius = 0.4 }\n";
    not_told("seen-from-behind", &furnished);
}

#[test]
fn fog_and_bounces_make_things_dark() {
    let path = |bounces: &str| format!("integrator.path = {{ {bounces} }}\n{SCENE}");
    let words = ["has 0 bounces", "leave the number out"];
    texts_told_apart("picture-black", &words, &path("bounces = 0"), &path("bounces = 1"));
    let fog = |extinction: f32| {
        format!("medium = {{ extinction = {extinction}, albedo = 0 }}\n{}", path(""))
    };
    let words = ["medium lets next to none of it through", "smaller extinction"];
    texts_told_apart("picture-black", &words, &fog(20.0), &fog(0.01));
    // A sun is infinitely far, behind infinitely much of it.
    let sun = |extinction: f32| {
        fog(extinction).replace("lamp.point", "lamp.directional").replace(
            "position = [2, -4, 5]\n    power = '1 kW'",
            "direction = [0, 1, -1]\nirradiance = 3",
        )
    };
    texts_told_apart("picture-black", &words, &sun(0.01), &sun(0.0));
    let smoke = |absorption: f32| {
        let smoke =
            "[surfaces.s]\nbox = { min = [-4, -8, -1], max = [4, 4, 4] }\nmaterial = 'smoke'\n";
        format!("{}{smoke}[materials.smoke.medium]\nabsorption = {absorption}\n", path(""))
    };
    let words = ["material \"smoke\" lets next to none of it through", "smaller absorption"];
    texts_told_apart("picture-black", &words, &smoke(50.0), &smoke(0.05));
}

/// A roof over everything but the rim of a floor that goes on.
#[test]
fn what_is_all_but_in_the_dark_is_told_why() {
    let roof = |z: f32| {
        let floor = changed("disk = { radius = 20 }", "plane = {}", "");
        let roof = "{ corner = [-90, -90, Z], edge_u = [180, 0, 0], edge_v = [0, 180, 0] }";
        let roof = roof.replace('Z', &z.to_string());
        format!("{floor}[surfaces.roof]\nquad = {roof}\n")
            .replace("[2, -4, 5]", "[0, 0, 20]")
            .replace("[0, 0, 0.5]", "[0, 0, 2.5]")
    };
    let words = ["so dim that it comes out black", "of the shadow rays hit \"roof\""];
    texts_told_apart("picture-black", &words, &roof(8.0), &roof(22.0));
}

/// A black sheet before a bright sky is no black picture as long as the sky is seen through it.
#[test]
fn what_is_seen_through_is_not_black() {
    let sheet = |opacity: f32, samples: u32| {
        format!(
            "integrator = 'path'
            film = {{ resolution = [24, 16], samples = {samples} }}
            environment.uniform.radiance = 1
            camera.perspective = {{ position = [0, -4, 0], target = [0, 0, 0] }}
            materials.black.lambert = {{ reflectance = 0, opacity = {opacity} }}
            surfaces.sheet = {{ quad = {{ corner = [-9, 0, -9], edge_u = [18, 0, 0], edge_v = [0, 0, 18] }}, material = 'black' }}
            "
        )
    };
    let words = ["what it sees is all black"];
    texts_told_apart("picture-black", &words, &sheet(1.0, 16), &sheet(0.4, 16));
    not_told("picture-black", &sheet(0.7, 4));
}

/// Of a part of the picture it is not known what its rays met, only whether anything shows.
#[test]
fn a_black_part_of_a_picture_is_told() {
    let crop = Some(Crop { x: 4, y: 4, width: 4, height: 4 });
    let is_told = |opacity: f32| {
        let scene = read(&format!(
            "film = {{ resolution = [24, 16], samples = 16 }}
            background = 1
            camera.perspective = {{ position = [0, -4, 0], target = [0, 0, 0] }}
            materials.black.lambert = {{ reflectance = 0, opacity = {opacity} }}
            surfaces.sheet = {{ quad = {{ corner = [-9, 0, -9], edge_u = [18, 0, 0], edge_v = [0, 0, 18] }}, material = 'black' }}
            lights.lamp.point = {{ position = [0, -4, 1], power = '100 W' }}"
        ));
        let built = Scene::build(&scene);
        let options = RenderOptions { crop, ..RenderOptions::default() };
        let rendered = render(&built, &options, &|_| ControlFlow::Continue(()));
        let (exposure_ev, auto_exposure, developed, noise) = (0.0, false, true, None);
        let shown = Shown { rendered: &rendered, exposure_ev, auto_exposure, developed, noise };
        let found = Doctor::new(&scene, &built).judge(&shown);
        found.iter().any(|finding| finding.code == "picture-black")
    };
    assert_eq!([0.999_999, 0.4].map(is_told), [true, false]);
}

/// A small window that few of so few paths have found.
#[test]
fn what_was_not_found_is_noise() {
    let room = |edge: f32| {
        format!(
            "integrator = 'path'
            film = {{ resolution = [48, 32], samples = 1 }}
            camera.perspective = {{ position = [0, -3.9, 1.5], target = [0, 0, 1.5] }}
            environment.uniform.radiance = 5
            surfaces.floor.quad = {{ corner = [-4, -4, 0], edge_u = [8, 0, 0], edge_v = [0, 8, 0] }}
            surfaces.back.quad = {{ corner = [-4, 4, 0], edge_u = [8, 0, 0], edge_v = [0, 0, 3] }}
            surfaces.front.quad = {{ corner = [-4, -4, 0], edge_u = [8, 0, 0], edge_v = [0, 0, 3] }}
            surfaces.left.quad = {{ corner = [-4, -4, 0], edge_u = [0, 8, 0], edge_v = [0, 0, 3] }}
            surfaces.right.quad = {{ corner = [4, -4, 0], edge_u = [0, 8, 0], edge_v = [0, 0, 3] }}
            surfaces.roof.quad = {{ corner = [-4, -4, 3], edge_u = [8, 0, 0], edge_v = [0, {edge}, 0] }}
            "
        )
    };
    let words = ["have not found the environment", "--spp"];
    texts_told_apart("noise", &words, &room(7.9), &room(4.0));
    not_told("picture-black", &room(7.9));
}

#[test]
fn lights_inside_of_things() {
    let inside = |x: f32| changed("[2, -4, 5]", &format!("[{x}, 0, 1]"), "");
    let words = ["light \"lamp\"", "inside of surface \"ball\", 50", "lights.lamp.point"];
    texts_told_apart("light-inside", &words, &inside(0.5), &inside(1.5));
}

/// What comes along a surface does not fall on it.
#[test]
fn lights_that_lie_in_surfaces() {
    let lamp = |z: &str| changed("[2, -4, 5]", &format!("[2, -4, {z}]"), "");
    let words = ["light \"lamp\"", "lies in surface \"floor\""];
    texts_told_apart("light-in-surface", &words, &lamp("0"), &lamp("0.1"));
}

#[test]
fn lights_behind_things() {
    let roof = |z: f32| {
        format!("{SCENE}[surfaces.roof]\ndisk = {{ center = [0, 0, {z}], radius = 30 }}\n")
    };
    let words = ["light \"lamp\"", "surface \"roof\" is in its way"];
    texts_told_apart("light-blocked", &words, &roof(4.0), &roof(6.0));
    let dome = |inside: &str| {
        format!("integrator = 'path'\n{SCENE}[surfaces.sky_dome]\nsphere = {{ radius = 50 }}\n")
            .replace("[lights.lamp.point]\n    position = [2, -4, 5]\n    power = '1 kW'", inside)
    };
    let sky = "[environment.uniform]\nradiance = 1\n";
    let open =
        SCENE.replace("[lights.lamp.point]\n    position = [2, -4, 5]\n    power = '1 kW'", sky);
    let words = ["environment", "at \"sky_dome\""];
    texts_told_apart("light-blocked", &words, &dome(sky), &open);
}

#[test]
fn lights_that_shine_elsewhere() {
    let spot = |direction: &str| {
        SCENE
            .replace("lamp.point", "lamp.spot")
            .replace("power = '1 kW'", &format!("intensity = 80\ndirection = {direction}"))
    };
    let words = ["shines past", "turn it around: direction = [-1, 1, -1]"];
    texts_told_apart("light-averted", &words, &spot("[1, -1, 1]"), &spot("[-2, 4, -4]"));
    let sun = |direction: &str| {
        let lamp = "point]\n    position = [2, -4, 5]\n    power = '1 kW'";
        changed(lamp, &format!("directional]\ndirection = {direction}\nirradiance = 3"), "")
    };
    let words = ["all of it faces away", "turn it around: direction = [0, -0.2, -1]"];
    texts_told_apart("light-averted", &words, &sun("[0, 0.2, 1]"), &sun("[0, -0.2, -1]"));
    let panel = |edges: &str| {
        let panel = "[surfaces.panel]\nlight = { radiance = 5 }\nquad = { corner = [-1, -1, 5]";
        format!("{SCENE}{panel}, {edges} }}\n")
    };
    let (up, down) =
        ("edge_u = [2, 0, 0], edge_v = [0, 2, 0]", "edge_u = [0, 2, 0], edge_v = [2, 0, 0]");
    let words = ["surface \"panel\"", "two_sided"];
    texts_told_apart("light-averted", &words, &panel(up), &panel(down));
}

#[test]
fn lights_that_are_off_or_too_bright() {
    let power = |power: &str| changed("'1 kW'", power, "");
    texts_told_apart("light-off", &["light \"lamp\""], &power("0"), SCENE);
    let panel = |radiance: f32| {
        format!(
            "{SCENE}[surfaces.panel]\nlight = {{ radiance = {radiance} }}\nquad = {{ corner = [-1, -1, 5], edge_u = [0, 2, 0], edge_v = [2, 0, 0] }}\n"
        )
    };
    texts_told_apart("emitter-off", &["surface \"panel\""], &panel(0.0), &panel(1.0));
    let sun = |irradiance: &str| {
        format!(
            "{SCENE}[lights.sun.directional]\ndirection = [0, 1, -1]\nirradiance = {irradiance}\n"
        )
    };
    let words = ["light \"sun\"", "100000 W/m²", "irradiance = \"100000 lx\""];
    texts_told_apart("light-units", &words, &sun("100000"), &sun("'100000 lx'"));
    let second = |power: &str| {
        format!("{SCENE}[lights.second.point]\nposition = [-2, -4, 5]\npower = {power}\n")
    };
    texts_told_apart("light-factor", &["683"], &second("683000"), &second("683500"));
    texts_told_apart("light-factor", &["4π"], &second("12566.370614"), &second("12500"));
    let radius = |radius: f32| SCENE.to_owned() + &format!("radius = {radius}");
    texts_told_apart("light-radius", &["radius 30 m"], &radius(30.0), &radius(0.5));
}

#[test]
fn environments_that_are_black() {
    let sky = |radiance: f32| format!("{SCENE}[environment.uniform]\nradiance = {radiance}\n");
    texts_told_apart("environment-black", &["all of it is black"], &sky(0.0), &sky(0.01));
    let picture = |value: f32| {
        let mut scene = read(&sky(1.0));
        let texels = Texels::Linear(vec![[value, value, value, 1.0]; 2]);
        let pixels = Arc::new(Pixels { name: "sky".into(), width: 2, height: 1, texels });
        let sky = Sky::Picture { pixels, sampling: Sampling::Bilinear };
        scene.environment.as_mut().unwrap().sky = sky;
        scene
    };
    told_apart("environment-black", &["environment"], &picture(0.0), &picture(0.5));
}

/// The scene under a picture of 64 × 32 texels.
fn under(texels: Texels) -> SceneDescription {
    let mut scene = read(&format!("{SCENE}[environment.uniform]\nradiance = 1\n"));
    let pixels = Pixels { name: "sky.png".into(), width: 64, height: 32, texels };
    let sky = Sky::Picture { pixels: Arc::new(pixels), sampling: Sampling::Bilinear };
    scene.environment.as_mut().unwrap().sky = sky;
    scene
}

#[test]
fn pictures_of_skies_that_lack_light() {
    let sky = |sun: u8| {
        let texel = |i: u32| if i == 700 { [sun, sun, sun, 255] } else { [90, 120, 200, 255] };
        under(Texels::Srgb8((0..2048).map(texel).collect()))
    };
    let words = ["\"sky.png\" ends at white", "1 of its pixels", "[lights.sun.sun]"];
    told_apart("environment-clipped", &words, &sky(255), &sky(254));
    not_in(&under(Texels::Srgb8(vec![[255; 4]; 2048])), "environment-clipped");
    let numbers = |sun: f32| {
        let texel = |i: u32| if i == 700 { [sun, 0.1, 0.1, 1.0] } else { [0.2, 0.3, 0.9, 1.0] };
        under(Texels::Linear((0..2048).map(texel).collect()))
    };
    told_apart("environment-clipped", &["\"sky.png\""], &numbers(1.0), &numbers(50.0));
    let words = ["1 pixels", "less than 0, down to -0.5"];
    told_apart("environment-negative", &words, &numbers(-0.5), &numbers(0.0));
}

/// The lecture's cures, with an epsilon that is larger than the ball.
#[test]
fn cures_that_take_shadows_away() {
    let cured = |name: &str, epsilon: &str| {
        format!("shadows = {{ {name} = {{ epsilon = '{epsilon}' }} }}\n{SCENE}")
    };
    for name in ["t_range", "moved_start"] {
        let words = [name, "10 m", "\"robust\""];
        texts_told_apart("shadows-epsilon", &words, &cured(name, "10 m"), &cured(name, "1 mm"));
    }
    // Where nothing casts a shadow, none is lost.
    let flat = cured("t_range", "10 m")
        .replace("center = [0, 0, 1], radius = 1", "center = [0, 90, 1], radius = 1");
    not_told("shadows-epsilon", &flat);
}

#[test]
fn cameras_that_see_nothing() {
    let target = |target: &str| changed("[0, 0, 0.5]", target, "");
    let words = ["nothing is in front of the camera", "--camera frame"];
    texts_told_apart("camera-sees-nothing", &words, &target("[0, -6, 9]"), SCENE);
    let inside = |at: &str| changed("[0, -6, 3]", at, "");
    texts_told_apart("camera-inside", &["surface \"ball\""], &inside("[0, -0.3, 1.2]"), SCENE);
    let fov = |fov: &str| changed("fov = 40", &format!("fov = {fov}"), "");
    let words = ["0.700° is a telescope's", "fov = \"0.7000 rad\""];
    texts_told_apart("camera-fov", &words, &fov("0.7"), &fov("'0.7 rad'"));
    not_told("camera-far", &fov("179.9"));
    let small = |y: f32| {
        let floor = "[surfaces.floor]\n    disk = { radius = 20 }";
        changed(floor, "", "").replace("[0, -6, 3]", &format!("[0, {y}, 3]"))
    };
    texts_told_apart("camera-far", &["picture's height"], &small(-2000.0), &small(-20.0));
    let lens = |focus: f32| {
        changed("perspective", "thin_lens", "")
            .replace("fov = 40", &format!("fov = 40\naperture = 0.5\nfocus_distance = {focus}"))
    };
    let wide =
        |aperture: f32| lens(6.0).replace("aperture = 0.5", &format!("aperture = {aperture}"));
    texts_told_apart("camera-focus", &["25 m wide", "\"25 mm\""], &wide(25.0), &wide(0.025));
    let far =
        |aperture: &str| lens(12.0).replace("aperture = 0.5", &format!("aperture = {aperture}"));
    texts_told_apart("camera-focus", &["20 m wide", "is fog"], &far("20"), &far("'20 mm'"));
    let parallel = |height: f32| {
        changed("perspective", "orthographic", "")
            .replace("fov = 40", &format!("height = {height}"))
    };
    let words = ["sees 1 mm of a scene", "--camera frame"];
    texts_told_apart("camera-near", &words, &parallel(0.001), &parallel(6.0));
    // An edge in the middle of it is worth a look.
    let edge = parallel(0.001).replace("target = [0, 0, 0.5]", "target = [0, 0, 2]");
    not_told("camera-near", &edge.replace("[0, -6, 3]", "[0, -6, 2]"));
    texts_told_apart(
        "camera-focus",
        &["sharp at 500 mm", "focus_distance"],
        &lens(0.5),
        &lens(6.0),
    );
}

#[test]
fn a_camera_in_a_room_is_well() {
    let room = "
        film = { resolution = [48, 32], samples = 16 }
        integrator = 'path'
        [camera.perspective]
        position = [0, -1.5, 1.5]
        target = [0, 2, 1]
        [surfaces.room]
        box = { min = [-2, -2, 0], max = [2, 2, 3] }
        [surfaces.table]
        box = { min = [-0.5, 0.5, 0], max = [0.5, 1, 0.7] }
        [lights.lamp.point]
        position = [0, 0, 2.5]
        power = 80
    ";
    assert_eq!(findings(&read(room)), []);
    // A bare one, in a garden.
    let bare = room.replace(
        "[surfaces.table]\n        box = { min = [-0.5, 0.5, 0], max = [0.5, 1, 0.7] }",
        "",
    );
    assert_eq!(findings(&read(&(bare + "[surfaces.garden]\nplane.point = [0, 0, -0.1]"))), []);
}

#[test]
fn pictures_that_are_black_or_too_bright() {
    let words = ["what it sees is all black: 96 % of the shadow rays hit \"roof\""];
    let roof = |z: f32| {
        format!("{SCENE}[surfaces.roof]\ndisk = {{ center = [0, 0, {z}], radius = 30 }}\n")
    };
    texts_told_apart("picture-black", &words, &roof(4.0), &roof(6.0));
    let torch = roof(4.0)
        + "[lights.torch.spot]\nposition = [0, -3, 3]\ntarget = [1, -2, 0]\nintensity = 9\nouter_angle = 6\n";
    let words = ["% of the pixels are black", "of the shadow rays hit \"roof\""];
    texts_told_apart("picture-black", &words, &torch, &torch.replace("angle = 6", "angle = 60"));
    let power = |power: &str| changed("'1 kW'", power, "");
    let words = ["stops too dark", "--exposure", "800 lm"];
    texts_told_apart("exposure-low", &words, &power("'800 lm'"), &power("'300000 lm'"));
    texts_told_apart("picture-clipped", &["brighter than white"], &power("'1 MW'"), SCENE);
    let hot = changed(
        "power = '1 kW'",
        "intensity = 1e38\n[lights.second.point]\nposition = [0, -2, 0.2]\nintensity = 3e38",
        "",
    );
    texts_told_apart("samples-dropped", &["pixel ("], &hot, SCENE);
}

#[test]
fn ambient_light_that_reaches_nothing() {
    let within = |reach: &str| {
        let unlit = SCENE.split("[lights").next().unwrap();
        let room = "[surfaces.room]\nbox = { min = [-30, -30, -1], max = [30, 30, 20] }\n";
        format!("{unlit}{room}[lights.sky.ambient]\nradiance = 0.5\nreach = '{reach}'\n")
    };
    let words = ["reach of ambient light \"sky\"", "smaller reach"];
    texts_told_apart("picture-black", &words, &within("1 km"), &within("1 m"));
}

#[test]
fn pictures_that_are_noisy() {
    // A lamp in clear glass is found by chance alone; a bare one is asked.
    let room = |samples: u32, glass: &str| {
        format!(
            "integrator = 'path'
            film = {{ resolution = [48, 32], samples = {samples} }}
            [camera.perspective]
            position = [0, -1.9, 1.5]
            target = [0, 2, 1]
            [surfaces.room]
            box = {{ min = [-2, -2, 0], max = [2, 2, 3] }}
            [surfaces.lamp]
            sphere = {{ center = [0, 0, 2.8], radius = 0.05 }}
            light = {{ power = '60 W' }}
            {glass}"
        )
    };
    let shade = "[surfaces.shade]\nmaterial = 'glass'\nsphere = { center = [0, 0, 2.8], radius = 0.1 }\n[materials.glass.dielectric]\n";
    texts_told_apart("noise", &["--spp", "--noise"], &room(16, shade), &room(64, ""));
}

#[test]
fn surfaces_in_each_other() {
    let table = |z: f32| {
        format!(
            "{SCENE}[surfaces.table]\nquad = {{ corner = [-3, -3, {z}], edge_u = [6, 0, 0], edge_v = [1, 7, 0] }}\nmaterial = 'paint'\n"
        )
    };
    texts_told_apart("surfaces-coincide", &["up to rounding"], &table(0.0), &table(0.01));
    // Of one material as well, if they are not in the very same place.
    let second = |z: &str| {
        table(0.0)
            .replace("-3, 0]", &format!("-3, {z}]"))
            .replace("disk =", "material = 'paint'\n    disk =")
    };
    let words = ["surface \"floor\"", "shade each other"];
    texts_told_apart("surfaces-coincide", &words, &second("1e-7"), &second("0.0"));
    // Walls that meet in the diagonals of the picture, where probes hit their edges.
    let corner = "
        film.resolution = [64, 64]
        camera.perspective = { position = [0, -3.8, 1], target = [0, 0, 1], fov = 40 }
        materials.red.lambert.reflectance = 0.6
        surfaces.ceiling.quad = { corner = [-1, -1, 2], edge_u = [2, 0, 0], edge_v = [0, 2, 0] }
        surfaces.left.quad = { corner = [-1, -1, 0], edge_u = [0, 2, 0], edge_v = [0, 0, 2] }
        surfaces.left.material = 'red'
        lights.lamp.point = { position = [0, 0, 1], power = 100 }
    ";
    texts_told_apart("surfaces-coincide", &["up to rounding"], &table(0.0), corner);
    // Meshes as well, whether all of them or a part.
    let carpet = |place: [f32; 2], triangle: &str, more: &str| {
        let [size, z] = place;
        let mesh = |size: f32, z: f32, triangle: &str| {
            format!(
                "mesh = {{ vertices = [[{size}, -3, {z}], [-{size}, -3, {z}], [0, 5, {z}]], triangles = [{triangle}] }}\n"
            )
        };
        let first = mesh(3.0, 0.5, "[1, 0, 2]");
        format!(
            "{SCENE}[surfaces.parquet]\n{first}[surfaces.carpet]\nmaterial = 'wool'\n{}[materials.wool.lambert]\nreflectance = 0.2\n{more}",
            mesh(size, z, triangle)
        )
    };
    let words = ["\"parquet\"", "\"carpet\"", "up to rounding"];
    let apart = carpet([3.0, 0.51], "[1, 0, 2]", "");
    for size in [3.0, 1.5] {
        for triangle in ["[1, 0, 2]", "[0, 1, 2]"] {
            let coinciding = carpet([size, 0.5], triangle, "");
            texts_told_apart("surfaces-coincide", &words, &coinciding, &apart);
        }
    }
    // The other side of a wall is not seen from this one.
    not_told("surfaces-coincide", &carpet([3.0, 0.5], "[0, 1, 2]", "double_sided = false\n"));
    let twice = |x: f32| {
        format!(
            "{SCENE}[instances.copy]\nof = 'ball'\ntransform = [{{ translate = [{x}, 0, 0] }}]\n"
        )
    };
    let words = ["surface \"copy\"", "surface \"ball\""];
    texts_told_apart("duplicate-surfaces", &words, &twice(0.0), &twice(2.5));
}

/// The scene with a mesh in the place of the ball: a tetrahedron, changed.
fn with_mesh(change: impl Fn(&mut Mesh, &mut Material)) -> SceneDescription {
    let mut scene = read(SCENE);
    let corners = [[-1.0, -1.0, 0.1], [1.0, -1.0, 0.1], [0.0, 1.0, 0.1], [0.0, 0.0, 2.0]];
    let positions: Vec<Vec3> = corners.map(Vec3::from).to_vec();
    let middle = positions.iter().sum::<Vec3>() / 4.0;
    // Each face has corners of its own.
    let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    let mut mesh = Mesh { name: "body".into(), ..Mesh::default() };
    for (number, face) in (0..).zip(faces) {
        let [a, b, c] = face.map(|i: usize| positions[i]);
        let normal = (b - a).cross(c - a).normalize();
        assert!(normal.dot(a - middle) > 0.0);
        mesh.positions.extend([a, b, c]);
        mesh.normals.extend([normal; 3]);
        mesh.triangles.push([3 * number, 3 * number + 1, 3 * number + 2]);
    }
    change(&mut mesh, &mut scene.materials[0]);
    scene.meshes.push(Arc::new(mesh));
    scene.surfaces[0].shape = Shape::Mesh(0);
    scene
}

#[test]
fn meshes_that_cannot_be_right() {
    let whole = with_mesh(|_, _| {});
    assert_eq!(findings(&whole), []);
    let flat = with_mesh(|mesh, _| mesh.triangles.extend([[0, 0, 1], [2, 2, 2]]));
    told_apart("triangles-degenerate", &["33.3 % of its triangles (2)"], &flat, &whole);
    let zero = with_mesh(|mesh, _| mesh.normals[4] = Vec3::NAN);
    told_apart("normals-zero", &["8.3 % of its vertex normals"], &zero, &whole);
    let far = with_mesh(|mesh, _| {
        mesh.normals.iter_mut().for_each(|n| *n = n.any_orthonormal_vector());
    });
    told_apart("normals-far", &["100 % of its vertex normals"], &far, &whole);
}

#[test]
fn backs_that_are_seen() {
    let turned = |one_sided: bool| {
        with_mesh(move |mesh, material| {
            mesh.triangles.iter_mut().for_each(|triangle| triangle.swap(0, 1));
            material.double_sided = !one_sided;
        })
    };
    let words = ["surface \"ball\"", "inside out"];
    let close = |mut scene: SceneDescription| {
        scene.cameras[0].projection = Projection::Perspective { vertical_fov: 0.4 };
        scene
    };
    told_apart("seen-from-behind", &words, &close(turned(true)), &close(turned(false)));
    let floor = |double_sided: bool| {
        let text = "[camera.perspective]\nposition = [0, 0, -3]\ntarget = [0, 1, 0]\n[surfaces.floor]\nmaterial = 'tiles'\nquad = {}\n[lights.l.ambient]\nradiance = 0.5\n[materials.tiles.lambert]\n";
        format!("film.resolution = [48, 32]\n{text}double_sided = {double_sided}\n")
    };
    texts_told_apart(
        "seen-from-behind",
        &["surface \"floor\"", "double_sided = true"],
        &floor(false),
        &floor(true),
    );
}

#[test]
fn glass_that_is_open_or_inside_out() {
    let pane = |kind: &str| {
        let pane = "[surfaces.pane]\nquad = { corner = [-1, -3, 0.2], edge_u = [2, 0, 0], edge_v = [0, 0, 2] }\nmaterial = 'glass'\n";
        format!("integrator = 'path'\n{SCENE}{pane}[materials.glass.{kind}]\n")
    };
    texts_told_apart("glass-open", &["thin_glass"], &pane("dielectric"), &pane("thin_glass"));
    let tube = |capped: bool| {
        let tube =
            format!("[surfaces.tube]\ncylinder = {{ capped = {capped} }}\nmaterial = 'glass'\n");
        format!("integrator = 'path'\n{SCENE}{tube}[materials.glass.dielectric]\n")
    };
    texts_told_apart("glass-open", &["open where it has no caps"], &tube(false), &tube(true));
    let glass = |change: fn(&mut Mesh)| {
        with_mesh(move |mesh, material| {
            change(mesh);
            let facets = Facets::of(Scalar::constant(0.0));
            material.scattering = Scattering::Dielectric { facets };
            material.interior = Some(Interior::clear(1.5));
        })
    };
    let whole = glass(|_| {});
    let open = glass(|mesh| mesh.triangles.truncate(3));
    told_apart("glass-open", &["50 % of its edges are open"], &open, &whole);
    let turned = glass(|mesh| mesh.triangles.iter_mut().for_each(|t| t.swap(0, 1)));
    told_apart("glass-inside-out", &["faces inwards"], &turned, &whole);
}

#[test]
fn materials_that_cannot_be() {
    let with = |change: fn(&mut Material)| with_mesh(move |_, material| change(material));
    let bright = with(|material| material.reflectance = Texture::constant(Rgb::new(0.2, 1.5, 0.2)));
    let white = with(|material| material.reflectance = Texture::constant(Rgb::ONE));
    told_apart("reflectance-above-one", &["material \"paint\"", "1.50 times"], &bright, &white);
    let masked = |cutoff: f32| {
        let mut scene = with_mesh(|_, material| material.reflectance.factor[3] = 0.4);
        scene.materials[0].alpha = Alpha::Mask { cutoff };
        scene
    };
    let words = ["alpha is at most 0.40, below the cutoff 0.50"];
    told_apart("material-invisible", &words, &masked(0.5), &masked(0.3));
    let blended = |alpha: f32| {
        let mut scene = with_mesh(|_, material| material.alpha = Alpha::Blend);
        scene.materials[0].reflectance.factor[3] = alpha;
        scene
    };
    told_apart("material-invisible", &["alpha is 0"], &blended(0.0), &blended(0.5));
    let words = ["hardly there", "at most 0.01"];
    told_apart("material-invisible", &words, &blended(0.01), &blended(0.05));
}

/// The scene with a ball of glass or the like, and paths.
fn with_ball_of(kind: &str, integrator: &str) -> String {
    let scene = changed("lambert]\n    reflectance = 0.5", kind, "");
    format!("{integrator}\n{scene}")
}

#[test]
fn glass_and_mirrors_that_stay_dark() {
    let glass = |distance: &str| {
        let kind =
            format!("dielectric]\nattenuation_color = 'green'\nattenuation_distance = {distance}");
        with_ball_of(&kind, "integrator = 'path'")
    };
    let words = ["material \"paint\"", "through 20 mm of itself", "attenuation_distance"];
    texts_told_apart("glass-dark", &words, &glass("1e-6"), &glass("0.01"));
    let after = |kind: &str, bounces: u32| {
        with_ball_of(kind, &format!("integrator.path.bounces = {bounces}"))
    };
    for (kind, needed) in [("dielectric]", 3), ("mirror]", 2)] {
        let words = [&*format!("{needed} bounces"), "they have 1"];
        texts_told_apart("bounces-few", &words, &after(kind, 1), &after(kind, needed));
    }
}

/// The scene with a picture on its mesh, whose texels are given by place.
fn with_picture(
    side: u32,
    texel: fn(u32) -> [u8; 4],
    use_it: fn(&mut Material, Texture),
) -> SceneDescription {
    let mut scene = with_mesh(|mesh, _| mesh.uvs = vec![vec![Vec2::splat(0.5); 12]]);
    let texels = Texels::Srgb8((0..side * side).map(texel).collect());
    scene.images.push(Arc::new(Pixels {
        name: "it.png".into(),
        width: side,
        height: side,
        texels,
    }));
    let pattern = Pattern::Image {
        image: 0,
        uv_set: 0,
        transform: UvTransform::IDENTITY,
        wrap: [Wrap::Repeat; 2],
        sampling: Sampling::Bilinear,
    };
    use_it(&mut scene.materials[0], Texture { pattern, ..Texture::constant(Rgb::ONE) });
    scene
}

fn colored(material: &mut Material, texture: Texture) {
    material.reflectance = texture;
}

fn bent(material: &mut Material, texture: Texture) {
    material.normal = Some(NormalMap { texture, scale: 1.0 });
}

#[test]
fn pictures_on_surfaces() {
    let stripes = |i: u32| [(i % 200) as u8, 90, 40, 255];
    let whole = with_picture(16, stripes, colored);
    assert_eq!(findings(&whole), []);
    let mut lost = whole.clone();
    Arc::make_mut(&mut lost.meshes[0]).uvs.clear();
    told_apart("texture-uvs", &["surface \"ball\"", "it.png"], &lost, &whole);
    let flat = with_picture(16, |_| [10, 20, 30, 255], colored);
    told_apart("texture-flat", &["it.png"], &flat, &whole);
    let bumps = |i: u32| [if i.is_multiple_of(2) { 108 } else { 148 }, 128, 252, 255];
    let words = ["looks like a map of normals"];
    told_apart("texture-curve", &words, &with_picture(16, bumps, colored), &whole);
    let decoded = with_picture(16, |i| [50 + (i % 9) as u8, 55, 250, 255], bent);
    told_apart("texture-curve", &["was decoded"], &decoded, &with_picture(16, bumps, bent));
    let encoded = with_picture(16, |i| [184 + (i % 9) as u8, 188, 254, 255], bent);
    told_apart("texture-curve", &["was encoded"], &encoded, &with_picture(16, bumps, bent));
    let words = ["\"it.png\" as a map of normals", "like colours", "as a color"];
    let bent_bumps = with_picture(16, bumps, bent);
    told_apart("texture-normals", &words, &with_picture(16, stripes, bent), &bent_bumps);
    let heights = with_picture(
        16,
        |i| [90, 90, 90, 255].map(|c: u8| c + (i % 60) as u8 * u8::from(c == 90)),
        bent,
    );
    told_apart("texture-normals", &["like heights", "as bump"], &heights, &bent_bumps);
    let both = with_picture(16, stripes, |material, texture| {
        let roughness = Scalar { texture: texture.clone(), channel: 1, complement: false };
        material.reflectance = texture;
        material.scattering = Scattering::Matte { roughness };
    });
    told_apart("texture-role", &["as numbers"], &both, &whole);
    // Greys are how much there is of anything, in 16 bits as well.
    let deep = |texel: fn(u16) -> [u16; 4]| {
        let mut scene = both.clone();
        let texels = Texels::Srgb16((0..256).map(texel).collect());
        scene.images[0] = Arc::new(Pixels { texels, ..(*scene.images[0]).clone() });
        scene
    };
    let (color, grey) = (deep(|i| [200 * i, 90, 40, !0]), deep(|i| [200 * i; 4]));
    told_apart("texture-role", &["as numbers"], &color, &grey);
    // All that are colours, and what is packed into their alpha.
    let colors = with_picture(16, stripes, |material, texture| {
        let sheen_roughness = Scalar { texture: texture.clone(), channel: 3, complement: false };
        material.scattering = Scattering::Principled(Box::new(Principled {
            sheen_color: texture.clone(),
            specular_color: texture.clone(),
            sheen_roughness,
            ..Principled::default()
        }));
        material.ambient_reflectance = Some(texture.clone());
        material.reflectance = texture;
    });
    assert!(!findings(&colors).iter().any(|finding| finding.code == "texture-role"));
}

/// Coordinates of maps are too large for single precision.
#[test]
fn scenes_far_from_the_origin() {
    let at = |far: f64| {
        let mut scene = read(SCENE);
        let shift = glam::DVec3::new(far, 0.0, 0.0);
        for surface in &mut scene.surfaces {
            surface.transform = glam::DAffine3::from_translation(shift) * surface.transform;
        }
        let camera = &mut scene.cameras[0];
        (camera.position, camera.target) = (camera.position + shift, camera.target + shift);
        if let Light::Point { position, .. } = &mut scene.lights[0].light {
            *position += shift;
        }
        scene
    };
    let words = ["4.5 Mm away", "536.4 mm", "move it to the origin"];
    told_apart("origin-far", &words, &at(4.5e6 - 20.0), &at(2e3));
}

#[test]
fn lengths_in_another_unit() {
    let large = |unit: f64| {
        let mut scene = read(&changed("'1 kW'", "'800 lm'", ""));
        for surface in &mut scene.surfaces {
            surface.transform = glam::DAffine3::from_scale(glam::DVec3::splat(unit));
        }
        let camera = &mut scene.cameras[0];
        (camera.position, camera.target) = (unit * camera.position, unit * camera.target);
        if let Light::Point { position, .. } = &mut scene.lights[0].light {
            *position *= unit;
        }
        scene
    };
    told_apart(
        "size-millimetres",
        &["40 km across", "40 m", "--unit mm"],
        &large(1000.0),
        &large(1.0),
    );
    let models = |scale: f32| {
        let mut scene = with_mesh(|_, _| {});
        scene.surfaces[0].name = "chair/body".into();
        scene.surfaces.push(Surface { name: "table/body".into(), ..scene.surfaces[0].clone() });
        let transform = glam::DAffine3::from_scale(glam::DVec3::splat(scale.into()));
        scene.surfaces[2].transform =
            glam::DAffine3::from_translation(glam::DVec3::Y * 3.0) * transform;
        scene
    };
    told_apart("size-mixed", &["model \"table\"", "same unit"], &models(1000.0), &models(2.0));
}

/// The codes of what is said about a scene with a model.
fn codes_of_model(file: &Path) -> Vec<&'static str> {
    let text = format!("{SCENE}\n[models.it]\nfile = '{}'", file.display());
    let (access, mut warnings) = (FileAccess::beside(file, &[]), Warnings::new());
    scene_file::read(&text, "scene.toml", &[], &access, &mut warnings).unwrap();
    warnings.iter().map(|warning| warning.code).collect()
}

/// Models are shown without pictures that they name and that are not there.
#[test]
fn pictures_that_are_missing_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    let pixel = image::RgbaImage::from_pixel(1, 1, image::Rgba([9, 9, 9, 255]));
    pixel.save(file("there.png")).unwrap();
    std::fs::write(
        file("corners.bin"),
        [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].map(f32::to_le_bytes).as_flattened(),
    )
    .unwrap();
    for (picture, codes) in
        [("gone.png", vec!["texture-missing", "texture-missing"]), ("there.png", vec![])]
    {
        std::fs::write(file("it.mtl"), format!("newmtl a\nKd 1 1 1\nmap_Kd {picture}\n")).unwrap();
        let corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n";
        let obj = format!("mtllib it.mtl\n{corners}usemtl a\nf 1/1 2/2 3/3\n");
        std::fs::write(file("it.obj"), obj).unwrap();
        let gltf = serde_json::json!({
            "asset": { "version": "2.0" },
            "buffers": [{ "uri": "corners.bin", "byteLength": 36 }],
            "bufferViews": [{ "buffer": 0, "byteLength": 36 }],
            "accessors": [{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" }],
            "images": [{ "uri": picture }],
            "textures": [{ "source": 0 }],
            "materials": [{ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }],
            "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "material": 0 }] }],
            "nodes": [{ "mesh": 0 }],
        });
        std::fs::write(file("it.gltf"), gltf.to_string()).unwrap();
        let found: Vec<_> = ["it.obj", "it.gltf"].map(|name| codes_of_model(&file(name))).concat();
        let found: Vec<_> = found.into_iter().filter(|code| !code.is_empty()).collect();
        assert_eq!(found, codes, "{picture}");
    }
}

/// What follows from a finding is not told as if it were another, and what helps is what is wrong.
#[test]
fn causes_come_before_what_follows_from_them() {
    let text = |scene: &str, code: &str| {
        let found = findings(&read(scene));
        let finding = found.iter().find(|finding| finding.code == code);
        finding.unwrap_or_else(|| panic!("no {code} in {found:#?}")).to_string()
    };
    let within = text(&changed("[2, -4, 5]", "[0, 0, 1]", ""), "picture-black");
    assert!(within.contains("light \"lamp\" is inside of something"), "{within}");
    let roof = "[surfaces.roof]\nquad = { corner = [-30, -30, 6], edge_u = [0, 60, 0], edge_v = [60, 0, 0] }\n";
    let panel = "[surfaces.lamp]\nquad = { corner = [-1, -1, 6.1], edge_u = [0, 2, 0], edge_v = [2, 0, 0] }\nlight.radiance = 20\n";
    let unlit = SCENE.split("[lights").next().unwrap();
    let above = text(&format!("integrator = 'path'\n{unlit}{roof}{panel}"), "light-blocked");
    assert!(
        above.contains("move it, or what is in its way") && !above.contains("two_sided"),
        "{above}"
    );
    let wide = format!("{SCENE}radius = 30\n");
    let black = text(&wide, "picture-black");
    assert!(
        black.contains("inside of the sphere of light \"lamp\"") && black.contains("radius"),
        "{black}"
    );
    let below =
        changed("disk = { radius = 20 }", "plane = {}", "").replace("[0, -6, 3]", "[0, -6, -3]");
    let codes: Vec<_> = findings(&read(&below)).iter().map(|finding| finding.code).collect();
    assert_eq!(codes, ["camera-behind"]);
    let words = ["behind plane \"floor\"", "move the camera"];
    texts_told_apart("camera-behind", &words, &below, &below.replace("-6, -3]", "-6, 3]"));
    // A lamp down there as well: it is a cellar.
    let cellar = format!("{below}[lights.low.point]\nposition = [1, -4, -3]\npower = 300\n");
    not_told("camera-behind", &cellar);
    let tree = "[surfaces.tree]\nbox = { min = [-0.2, -6.2, 2.8], max = [0.2, -5.8, 3.2] }\n";
    let codes: Vec<_> = findings(&read(&format!("{SCENE}{tree}"))).iter().map(|f| f.code).collect();
    assert_eq!(codes, ["camera-inside"]);
    let bright = changed("reflectance = 0.5", "emission = 300", "");
    let clipped = text(&bright.replace("-6, 3]", "-3, 1.5]"), "picture-clipped");
    assert!(clipped.contains("material \"paint\" gives 300"), "{clipped}");
}

/// No finding without a scene that has it: each code is in a test above.
#[test]
fn every_code_is_tested() {
    let (tests, list) = (include_str!("tests.rs"), CODES.iter().map(|(code, _)| code));
    let untested: Vec<_> = list.filter(|code| !tests.contains(&format!("\"{code}\","))).collect();
    assert!(untested.is_empty(), "{untested:?}");
    assert!(CODES.is_sorted(), "in the order of the alphabet");
    let page = include_str!("../../../../docs/black-picture.md");
    let untold: Vec<_> =
        CODES.iter().filter(|(code, _)| !page.contains(&format!("`{code}`"))).collect();
    assert!(untold.is_empty(), "{untold:?}");
}
