//! `firstlight explain`, layers and `relight`.

use super::{Folder, decode};
use std::f64::consts::PI;

/// The camera `top` sees x and y in the middle 6 m: 32 pixels.
const TOP: &str = "explain scene.toml --camera top --spp 1";

#[test]
fn an_explanation_can_be_reckoned_by_hand() {
    let folder = Folder::new();
    let told = folder.run(&format!("{TOP} --pixel 24,8 --json")).done().json();
    let met = &told["path"][0]["met"];
    assert_eq!((met["surface"].as_str(), met["front"].as_bool()), (Some("floor"), Some(true)));
    let [x, y] = [0, 1].map(|axis| met["position"][axis].as_f64().unwrap());
    let squared = 16.0 + x * x + y * y;
    let irradiance = 100.0 / (4.0 * PI) * 4.0 / squared.powf(1.5);
    let light = &told["path"][0]["lights"][0];
    let near = |value: &serde_json::Value, expected: f64| {
        let value = value.as_f64().unwrap();
        assert!((value / expected - 1.0).abs() < 1e-5, "{value} is not {expected}");
    };
    near(&light["geometry_factor"], 1.0 / squared);
    near(&light["irradiance"][0], irradiance);
    near(&light["illuminance"], 683.0 * irradiance);
    near(&told["radiance"][0], 0.5 / PI * irradiance);
    assert_eq!(light["verdict"]["is"], "lit");
}

#[test]
fn the_text_says_what_is_in_the_way() {
    let folder = Folder::new();
    let text = folder.run(&format!("{TOP} --pixel 39,16")).done().text();
    let last = text.lines().last().unwrap();
    assert!(text.contains("'ball'"), "{text}");
    assert!(
        last.starts_with("dark because light 'lamp' is blocked by 'ball'")
            || last.contains("'lamp'"),
        "{text}"
    );
    let text = folder.run(&format!("{TOP} --pixel 24,16 --why-not lamp")).done().text();
    assert!(text.contains("'lamp' makes 100 % of the pixel"), "{text}");
    let text = folder.run(&format!("{TOP} --pixel 24,16 --compare 24,8 --noise")).done().text();
    assert!(text.contains("'lamp' direct: 100 % of the difference"), "{text}");
    folder.run(&format!("{TOP} --pixel 24,16 --svg rays.svg -q")).fails(2, &["-q"]);
    folder.run(&format!("{TOP} --pixel 24,16 --svg rays.svg")).done();
    let drawing = std::fs::read_to_string(folder.path("rays.svg")).unwrap();
    assert!(drawing.starts_with("<svg ") && drawing.contains(">lamp</text>"), "{drawing}");
}

#[test]
fn pixels_outside_are_refused() {
    let folder = Folder::new();
    folder.run(&format!("{TOP} --pixel 48,0")).fails(2, &["48 × 32", "47,31"]);
    folder.run(&format!("{TOP} --pixel 1")).fails(2, &["two whole numbers"]);
    folder.run(&format!("{TOP} --pixel 1,1 --why-not sun")).fails(2, &["\"sun\"", "lamp"]);
}

/// In front of nothing there is no surface at which a light could be asked.
#[test]
fn lamps_are_found_in_the_air() {
    let folder = Folder::new();
    folder.write(
        "fog.toml",
        r#"
        camera.perspective = { position = [0, -4, 1], target = [0, 0, 1], fov = 40 }
        film = { resolution = [8, 8], samples = 4 }
        medium = { extinction = 0.1, albedo = 0.9 }
        lights.lamp.point = { position = [0.5, 0, 1], intensity = 10 }
        "#,
    );
    let text = folder.run("explain fog.toml --pixel 4,4 --why-not lamp").done().text();
    assert!(text.contains("asked for all of the way in fog"), "{text}");
    assert!(text.contains("light 'lamp' makes 100 % of the pixel"), "{text}");
}

/// Without a question, it is told how many of the pixel's shadow rays were stopped.
#[test]
fn blocked_rays_are_counted() {
    let folder = Folder::new();
    let text = folder.run("explain scene.toml --camera top --spp 16 --pixel 44,16").done().text();
    let told = text.lines().find(|line| line.contains(" of 16 shadow rays")).unwrap_or(&text);
    assert!(told.contains("blocked, mostly by 'ball', on average after"), "{text}");
    let text = folder.run("explain scene.toml --camera top --spp 16 --pixel 24,8").done().text();
    assert!(!text.contains("shadow rays"), "{text}");
}

/// An environment is all around: no surface faces away from it.
#[test]
fn samples_below_the_horizon_are_told_as_such() {
    let folder = Folder::new();
    let line =
        "--camera top --spp 4 -D environment.uniform.radiance=1 -D lights.lamp.point.power=0";
    let all: Vec<_> = (0..16)
        .map(|x| folder.run(&format!("explain scene.toml {line} --pixel {x},4")).done().text())
        .collect();
    let below = |text: &&String| text.contains("looks for it below the surface's horizon");
    assert!(all.iter().any(|text| below(&text)), "{}", all[0]);
    assert!(!all.iter().any(|text| text.contains("'environment' (environment): behind")));
}

/// The light of a pixel in fog, by its terms: f · E, what passes to there, and what from there to the eye.
#[test]
fn what_fog_takes_is_told() {
    let folder = Folder::new();
    let fog = "-D medium.extinction=0.1 -D medium.albedo=0";
    let told = folder.run(&format!("{TOP} --pixel 24,8 --json {fog}")).done().json();
    let step = &told["path"][0];
    let light = &step["lights"][0];
    let number = |value: &serde_json::Value| value.as_f64().unwrap();
    let passed = number(&light["verdict"]["passed"][0]);
    let product = number(&light["bsdf"][0]) * number(&light["irradiance"][0]) * passed;
    let product = product * number(&step["throughput"][0]);
    assert!((product / number(&light["radiance"][0]) - 1.0).abs() < 1e-5, "{told}");
    let left = (-0.1 * number(&step["met"]["distance"])).exp();
    assert!((number(&step["throughput"][0]) / left - 1.0).abs() < 1e-5, "{told}");
    let text = folder.run(&format!("{TOP} --pixel 24,8 {fog}")).done().text();
    assert!(text.contains("on the way to the eye") && text.contains("or fog"), "{text}");
}

#[test]
fn lights_are_mixed_again() {
    let folder = Folder::new();
    let more = "-D lights.fill.ambient.radiance=0.2";
    folder.run(&format!("render scene.toml {more} --aov light,depth -o all.exr -q")).done();
    folder.run("relight all.exr -o same.exr -q").done();
    folder.run(&format!("render scene.toml {more} -o plain.exr -q")).done();
    let read = |name: &str| {
        let bytes = std::fs::read(folder.path(name)).unwrap();
        let limits = firstlight::io::Limits::default();
        firstlight::io::load_image(&bytes, name, &limits).unwrap()
    };
    let (same, plain) = (read("same.exr"), read("plain.exr"));
    for (a, b) in same.pixels().iter().zip(plain.pixels()) {
        assert!(
            a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-6 * b.abs().max(1e-3)),
            "{a:?} {b:?}"
        );
    }
    folder.run("relight all.exr --light lamp=off -o ambient.exr -q").done();
    folder.run("relight all.exr --only fill -o only.exr -q").done();
    assert_eq!(read("ambient.exr"), read("only.exr"));
    folder.run("render scene.toml -D luminous_efficacy=179 --aov light -o dim.exr -q").done();
    let refused = folder.run("relight all.exr --light lamp=-1 -o x.exr");
    refused.fails(2, &["lamp=-1", "not negative", "off takes"]);
    let ran =
        folder.command("relight dim.exr -o a.png --exposure").arg("1/125 f/8 ISO 100").output();
    let told = String::from_utf8(ran.unwrap().stderr).unwrap();
    assert!(told.contains("exposure -5.7"), "{told}");
    folder.run("relight all.exr --light lmap=2 -o x.exr").fails(2, &["lmap", "fill, lamp"]);
    folder.run("relight plain.exr -o x.exr").fails(2, &["no layers of light", "--aov light"]);
    folder.run("render scene.toml --aov light -o x.png").fails(2, &["no room for layers", ".exr"]);
    folder.run("render scene.toml --aov dept -o x.exr").fails(2, &["dept", "depth"]);
}

/// Without a wish for another one, what is mixed again has the exposure and the view that it was rendered with.
#[test]
fn what_is_mixed_again_looks_as_it_was_rendered() {
    let folder = Folder::new();
    let codes = |name: &str| decode(&std::fs::read(folder.path(name)).unwrap()).2;
    for (view, _) in firstlight::color::View::NAMES {
        let line = format!("render scene.toml --view {view} --exposure 1.5 -q");
        folder.run(&format!("{line} --aov light -o layers.exr")).done();
        folder.run(&format!("{line} -o plain.png")).done();
        folder.run("relight layers.exr -o mixed.png -q").done();
        assert!(codes("mixed.png") == codes("plain.png"), "{view}");
        folder.run("compare layers.exr plain.png").done();
        folder.run("compare plain.png layers.exr").done();
    }
    // As in a render, an exposure is set, not added; the last line says what it was.
    let told = folder.run("relight layers.exr --exposure +1 -o mixed.png").done().stderr;
    assert!(told.contains("exposure +1 EV in place of +1.5"), "{told}");
    folder
        .run(&format!("render scene.toml --view {} --exposure 1 -o plain.png -q", last_view()))
        .done();
    assert!(codes("mixed.png") == codes("plain.png"));
}

fn last_view() -> &'static str {
    firstlight::color::View::NAMES[firstlight::color::View::NAMES.len() - 1].0
}

/// Where nothing differs, a sentence says so.
#[test]
fn pixels_that_do_not_differ_say_so() {
    let folder = Folder::new();
    let dark = "-D lights.lamp.point.power=0";
    let text = folder.run(&format!("{TOP} --pixel 1,1 --compare 2,2 {dark}")).done().text();
    assert!(text.contains("nothing differs: no light comes from either"), "{text}");
    let text = folder.run(&format!("{TOP} --pixel 24,8 --compare 24,8")).done().text();
    assert!(text.contains("nothing differs: the same light comes from both"), "{text}");
    assert!(!text.contains("has more"), "{text}");
}
