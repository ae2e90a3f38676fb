//! `check` and the findings before and after a render, and `lights`.

use super::{Folder, SCENE};

#[test]
fn findings_have_codes_that_can_be_ignored() {
    let folder = Folder::new();
    let line = "check scene.toml --strict -D lights.lamp.point.position=[2,0,1.2]";
    let ran = folder.run(line);
    let words = ["warning: light \"lamp\": is inside of surface \"ball\"", "[light-inside]"];
    ran.fails(3, &words);
    assert!(ran.stderr.contains("-D lights.lamp.point.shadows=false"), "{}", ran.stderr);
    folder.run(&format!("{line} --ignore light-inside --ignore picture-black")).done();
    folder.run("check scene.toml --ignore light-insid").fails(2, &["light-inside"]);
    let json = folder.run(&format!("{line} --json")).json();
    let codes: Vec<_> = json["warnings"].as_array().unwrap().iter().map(|w| &w["code"]).collect();
    assert_eq!(codes, ["light-inside", "picture-black"]);
}

#[test]
fn a_render_says_before_and_after_what_is_wrong_each_once() {
    let folder = Folder::new();
    let line =
        "render scene.toml --strict -o a.png -D surfaces.roof.disk={center=[0,0,3.5],radius=";
    let ran = folder.run(&format!("{line}30}}"));
    ran.fails(
        3,
        &["light \"lamp\": nothing", "what it sees is all black", "shadow rays hit \"roof\""],
    );
    assert_eq!(ran.stderr.matches("[light-blocked]").count(), 1, "{}", ran.stderr);
    assert!(folder.path("a.png").exists());
    folder.run(&format!("{line}0.3}} --spp 16")).done();
}

#[test]
fn lights_are_shown_in_all_units() {
    let folder = Folder::new();
    let scene =
        SCENE.replace("surfaces.floor]\nplane = {}", "surfaces.floor]\ndisk = { radius = 4 }");
    folder.write("lights.toml", &scene.replace("power = \"100 W\"", "power = \"800 lm\""));
    let text = folder.run("lights lights.toml").done().text();
    for words in ["683 lm/W", "lamp", "point", "800 lm", "1.171 W", "63.66 cd"] {
        assert!(text.contains(words), "{words:?} is not in\n{text}");
    }
    let json = folder.run("lights lights.toml --json -D luminous_efficacy=179").done().json();
    let lamp = &json["lights"][0];
    assert!((lamp["flux_lm"].as_f64().unwrap() - 800.0).abs() < 1e-3, "{lamp}");
    assert!((lamp["power_w"][0].as_f64().unwrap() - 800.0 / 179.0).abs() < 1e-5, "{lamp}");
    // 3 m below the lamp, which is 4 m high; the middle is 1 m high.
    let expected = 800.0 / (4.0 * std::f64::consts::PI * 9.0);
    assert!((lamp["illuminance_lx"].as_f64().unwrap() / expected - 1.0).abs() < 1e-5, "{lamp}");
    assert_eq!((&lamp["written"], &lamp["blocked"]), (&"800 lm".into(), &0.0.into()));
}

/// Where nothing is lost, paths do not end; what is wrong is told all the same, and soon.
#[test]
fn light_that_is_trapped_does_not_hold_up_a_check() {
    let folder = Folder::new();
    let text = "
        integrator = 'path'
        camera.perspective = { position = [0.5, 0, 0], target = [-1, 0, 0] }
        surfaces.room = { box = { min = [-1, -1, -1], max = [1, 1, 1] }, material = 'white' }
        materials.white.lambert.reflectance = 1
        lights.lamp.point = { position = [0, 0, 0.5], power = 100 }
    ";
    folder.write("trap.toml", text);
    folder.run("check trap.toml").done();
}
