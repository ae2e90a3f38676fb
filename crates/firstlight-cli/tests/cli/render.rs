//! `firstlight render`: pictures, where they go and what is said about them.

use super::{Folder, SCENE, decode};
use std::fs;

fn codes(folder: &Folder, name: &str) -> (u32, u32, Vec<u8>) {
    decode(&fs::read(folder.path(name)).expect("a picture"))
}

#[test]
fn the_picture_has_the_scenes_name_in_the_current_folder() {
    let folder = Folder::new();
    let ran = folder.run("render scene.toml").done();
    assert_eq!(folder.names(), ["scene.png", "scene.toml"]);
    let (width, height, codes) = codes(&folder, "scene.png");
    assert_eq!((width, height), (48, 32));
    assert!(codes.iter().any(|code| *code > 100));
    assert!(ran.stderr.starts_with("wrote scene.png: 48×32, 4 spp, "), "{}", ran.stderr);
    assert!(ran.stderr.trim_end().ends_with("rays/s") && ran.stderr.lines().count() == 1);
    assert!(ran.stdout.is_empty());
}

#[test]
fn quiet_says_nothing() {
    let ran = Folder::new().run("render scene.toml -q").done();
    assert_eq!((ran.stderr.as_str(), ran.stdout.len()), ("", 0));
}

#[test]
fn the_same_bytes_go_to_standard_output() {
    let folder = Folder::new();
    let ran = folder.run("render scene.toml -o -").done();
    assert_eq!(folder.names(), ["scene.toml"]);
    assert_eq!(decode(&ran.stdout).0, 48);
    let exr = folder.run("render scene.toml -o - --format exr-half").done();
    assert_eq!(exr.stdout[..4], [0x76, 0x2F, 0x31, 0x01]);
    folder.run("render scene.toml -o - --json").fails(2, &["cannot both go to standard output"]);
}

#[test]
fn a_scene_may_come_from_standard_input() {
    let folder = Folder::new();
    folder.run_with("render - -o a.png", SCENE.as_bytes()).done();
    folder.run("render scene.toml -o b.png").done();
    assert_eq!(codes(&folder, "a.png"), codes(&folder, "b.png"));
    folder.run_with("render -", b"nonsense").fails(2, &["error: standard input:1:"]);
    folder.run_with("render -", b"\xFF\xFE").fails(2, &["this is not UTF-8 text"]);
}

#[test]
fn the_extension_or_format_says_how_it_is_written() {
    let folder = Folder::new();
    let starts = |name: &str, start: &[u8]| {
        assert!(fs::read(folder.path(name)).expect("a picture").starts_with(start), "{name}");
    };
    for (name, start) in
        [("a.exr", [0x76, 0x2F].as_slice()), ("a.hdr", b"#?RAD"), ("a.pfm", b"PF\n")]
    {
        folder.run(&format!("render scene.toml -q -o {name}")).done();
        starts(name, start);
    }
    folder.run("render scene.toml --format hdr").done();
    starts("scene.hdr", b"#?RAD");
    folder.run("render scene.toml --format png16 -o picture").done();
    assert_eq!(codes(&folder, "picture").2.len(), 48 * 32 * 6);
    folder.run("render scene.toml --format exr -o a.png").fails(2, &["a.png: --format says .exr"]);
}

#[test]
fn flags_and_overrides_change_the_film() {
    let folder = Folder::new();
    let ran = folder.run("render scene.toml -r 20,10 --spp 2 --seed 7 --json").done();
    let json = ran.json();
    let film = ["width", "height", "samples", "seed"].map(|key| json[key].as_u64().unwrap());
    assert_eq!(film, [20, 10, 2, 7]);
    folder.run("render scene.toml -D film.resolution=[8,4] -D lights.lamp.point.power=0").done();
    let (width, height, codes) = codes(&folder, "scene.png");
    assert_eq!((width, height), (8, 4));
    assert!(codes.iter().all(|code| *code == 0));
}

#[test]
fn a_crop_is_that_part_of_the_whole_picture() {
    let folder = Folder::new();
    folder.run("render scene.toml -q -o whole.pfm").done();
    folder.run("render scene.toml -q -o part.pfm --crop 10,5,16,8").done();
    let pixels = |name: &str, bytes: usize| {
        let file = fs::read(folder.path(name)).expect("a picture");
        file[file.len() - bytes..].to_vec()
    };
    let (whole, part) = (pixels("whole.pfm", 48 * 32 * 12), pixels("part.pfm", 16 * 8 * 12));
    // Rows of a PFM go from the bottom to the top.
    for row in 0..8 {
        let start = ((32 - 5 - 8 + row) * 48 + 10) * 12;
        assert_eq!(part[row * 16 * 12..][..16 * 12], whole[start..][..16 * 12], "row {row}");
    }
    let beyond = folder.run("render scene.toml --crop 40,0,9,1");
    beyond.fails(2, &["--crop: 40,0,9,1 reaches beyond the picture of 48 × 32"]);
    folder.run("render scene.toml --crop 4294967295,0,4294967295,1").fails(2, &["reaches beyond"]);
}

#[test]
fn threads_and_instructions_do_not_change_the_picture() {
    let folder = Folder::new();
    folder.run("render scene.toml -q -o a.pfm -t 1 --simd portable").done();
    folder.run("render scene.toml -q -o b.pfm -t 3").done();
    let read = |name: &str| fs::read(folder.path(name)).expect("a picture");
    assert!(read("a.pfm") == read("b.pfm"));
}

#[test]
fn the_camera_is_chosen_by_name() {
    let folder = Folder::new();
    for (camera, name) in [("camera", "a.pfm"), ("top", "b.pfm"), ("frame", "c.pfm")] {
        folder.run(&format!("render scene.toml -q --camera {camera} -o {name}")).done();
    }
    let read = |name: &str| fs::read(folder.path(name)).expect("a picture");
    assert!(read("a.pfm") != read("b.pfm") && read("b.pfm") != read("c.pfm"));
    let ran = folder.run("render scene.toml --camera tpo");
    ran.fails(2, &["there is no camera \"tpo\"; did you mean \"top\"?", "help: its cameras are"]);
}

#[test]
fn an_exposure_found_from_the_picture_is_reported() {
    let folder = Folder::new();
    let ran = folder.run("render scene.toml --exposure auto").done();
    assert!(ran.stderr.contains(" EV (auto), "), "{}", ran.stderr);
    let ev = folder.run("render scene.toml --exposure auto --json").done().json();
    let ev = ev["exposure_ev"].as_f64().unwrap();
    // Half the light needs one stop more.
    let dim = folder.run("render scene.toml --exposure auto --json -D lights.lamp.point.power=50");
    assert!((dim.json()["exposure_ev"].as_f64().unwrap() - ev - 1.0).abs() < 0.011);
    folder.run("render scene.toml -q --exposure -2.5").done();
}

#[test]
fn the_background_can_be_transparent() {
    let folder = Folder::new();
    folder.run("render scene.toml -q --camera top --transparent -D surfaces.floor.plane.normal=[0,1,0]").done();
    let (_, _, codes) = codes(&folder, "scene.png");
    assert_eq!(codes.len(), 48 * 32 * 4);
    assert!(
        codes.chunks(4).any(|pixel| pixel[3] == 0) && codes.chunks(4).any(|pixel| pixel[3] == 255)
    );
}

#[test]
fn a_format_without_alpha_is_told() {
    let folder = Folder::new();
    for (name, words) in [("a.hdr", 1), ("a.pfm", 1), ("a.exr", 0), ("a.png", 0)] {
        let ran = folder.run(&format!("render scene.toml --transparent -o {name}")).done();
        assert_eq!(ran.stderr.matches("this format has no alpha").count(), words, "{name}");
    }
}

#[test]
fn the_picture_tells_how_it_was_made() {
    let folder = Folder::new();
    folder.run("render scene.toml --seed 9 -o a.png").done();
    let file = fs::File::open(folder.path("a.png")).unwrap();
    let mut reader = png::Decoder::new(std::io::BufReader::new(file)).read_info().unwrap();
    reader.finish().unwrap();
    let texts = &reader.info().uncompressed_latin1_text;
    let text = |key: &str| texts.iter().find(|t| t.keyword == key).map(|t| t.text.as_str());
    assert_eq!(text("Seed"), Some("9"));
    assert_eq!(text("Camera"), Some("camera"));
    assert_eq!(text("Resolution"), Some("48x32"));
    assert_eq!(text("Command"), Some("firstlight render scene.toml --seed 9 -o a.png"));
}

#[test]
fn a_black_picture_never_comes_without_a_word() {
    let folder = Folder::new();
    let lines: Vec<_> = SCENE.lines().take_while(|line| !line.starts_with("[lights")).collect();
    folder.write("unlit.toml", &lines.join("\n"));
    folder
        .run("render unlit.toml")
        .fails(0, &["warning: there are no lights", "help: add a light"]);
    let away = folder.run("render scene.toml -D camera.perspective.target=[0,-6,9]");
    away.fails(0, &["warning: nothing is in front of the camera", "--camera frame"]);
    let off = folder.run("render scene.toml -D lights.lamp.point.power=0");
    off.fails(0, &["warning: no light reaches the camera"]);
    let dim = folder.run("render scene.toml -D lights.lamp.point.power=1mW");
    dim.fails(0, &["so dim that it comes out black", "--exposure auto"]);
    folder.write("empty.toml", "");
    folder.run("render empty.toml -r 8x8").fails(0, &["warning: the scene has no surfaces"]);
    for ran in [&off, &dim] {
        assert_eq!(ran.stderr.matches("warning").count(), 1, "{}", ran.stderr);
    }
}

#[test]
fn a_blown_out_picture_comes_with_a_hint() {
    let folder = Folder::new();
    let ran = folder.run("render scene.toml -D lights.lamp.point.power=100kW");
    ran.fails(0, &["% of the picture is brighter than white", "help: try --exposure -"]);
    // What it suggests is the end of it.
    let (_, suggested) = ran.stderr.split_once("help: try --exposure ").unwrap();
    let ev = suggested.split_whitespace().next().unwrap();
    let line = "render scene.toml --strict -D lights.lamp.point.power=100kW --exposure";
    folder.run(&format!("{line} {ev}")).done();
}

#[test]
fn samples_that_are_not_finite_are_told() {
    let folder = Folder::new();
    // Two lights that are each a number, and together none.
    let scene = SCENE.replace(
        "power = \"100 W\"",
        "intensity = 1e38\n[lights.second.point]\nposition = [0, 0, 0.2]\nintensity = 3e38",
    );
    folder.write("hot.toml", &scene);
    let ran = folder.run("render hot.toml --json").done();
    assert!(ran.stderr.contains("samples were not finite and were dropped"), "{}", ran.stderr);
    assert!(ran.stderr.contains("pixel ("), "{}", ran.stderr);
    assert!(ran.json()["dropped_samples"].as_u64().unwrap() > 0);
}

#[test]
fn strict_fails_after_writing() {
    let folder = Folder::new();
    folder.run("render scene.toml --strict").done();
    fs::remove_file(folder.path("scene.png")).unwrap();
    let ran = folder.run("render scene.toml --strict -D lights.lamp.point.power=0");
    ran.fails(3, &["warning:"]);
    assert_eq!(codes(&folder, "scene.png").0, 48);
}

#[cfg(target_os = "linux")]
#[test]
fn a_picture_that_cannot_be_written_is_saved_elsewhere() {
    let folder = Folder::new();
    let ran = folder.run("render scene.toml --format png -o /dev/full");
    ran.fails(1, &["error: /dev/full: the disk is full", "help: the picture was saved as"]);
    let [rescued, _] = &folder.names()[..] else { panic!("a second file") };
    assert_eq!(codes(&folder, rescued).0, 48);
}
