//! Models in the studio.

use super::{Folder, decode};
use std::fs;

/// A tetrahedron that is taller along y than along z.
const MODEL: &str = "v 0 0 0\nv 1 0 0\nv 0 3 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

/// A triangle under a lamp of its own, seen by a camera of its own, without any other file.
const WITH_LIGHT: &str = r#"{
  "asset": { "version": "2.0" }, "scene": 0,
  "extensionsUsed": ["KHR_lights_punctual"],
  "extensions": { "KHR_lights_punctual": { "lights": [{ "type": "point", "intensity": 100, "name": "lamp" }] } },
  "scenes": [{ "nodes": [0, 1, 2] }],
  "nodes": [
    { "mesh": 0 },
    { "translation": [0.3, 0.3, 2], "extensions": { "KHR_lights_punctual": { "light": 0 } } },
    { "translation": [0.3, 0.3, 3], "camera": 0, "name": "front" }
  ],
  "cameras": [{ "type": "perspective", "perspective": { "yfov": 0.6, "znear": 0.1 } }],
  "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 } }] }],
  "accessors": [{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0] }],
  "bufferViews": [{ "buffer": 0, "byteLength": 36 }],
  "buffers": [{ "byteLength": 36, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA" }]
}"#;

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("my model.obj", MODEL);
    folder.write("m.obj", MODEL);
    folder.write("lit.gltf", WITH_LIGHT);
    folder
}

fn picture(folder: &Folder, line: &str) -> Vec<u8> {
    folder.run(&format!("render {line} -q -r 40x30 --spp 2 -o out.png")).done();
    decode(&fs::read(folder.path("out.png")).expect("a picture")).2
}

#[test]
fn a_model_is_shown_in_a_studio() {
    let folder = folder();
    let ran = folder.run("render m.obj -r 40x30 --spp 2 --strict").done();
    assert!(ran.stderr.starts_with("wrote m.png: 40×30, 2 spp"), "{}", ran.stderr);
    let usual = picture(&folder, "m.obj");
    for flags in [
        "--azimuth 100",
        "--elevation -5",
        "--key off",
        "--headlight off",
        "--ground off",
        "--up z",
        "--ground off --background navy",
    ] {
        assert!(picture(&folder, &format!("m.obj {flags}")) != usual, "{flags}");
    }
    // Millimetres change the size but, framed anew, hardly the picture.
    let json = folder.run("render m.obj --json -r 40x30 --unit mm").done().json();
    assert_eq!((json["triangles"].as_u64(), json["lights"].as_u64()), (Some(4), Some(2)));
}

/// Nothing is left out of a picture unless asked, and then the report says how much that is.
#[test]
fn a_model_is_clamped_when_asked() {
    let folder = folder();
    folder.write("s.obj", &format!("mtllib s.mtl\nusemtl s\n{MODEL}"));
    folder.write("s.mtl", "newmtl s\nPm 1\nPr 0.1\n");
    let clamped = |flags: &str| {
        let line = format!("render s.obj {flags} -r 40x30 --spp 2 -o s.png --json");
        folder.run(&line).done().json()["clamped"].clone()
    };
    assert!(clamped("").is_null());
    assert!(clamped("--clamp 0.001").as_f64() > clamped("--clamp 0.1").as_f64());
    assert!(clamped("-D film.clamp=0.001").is_number());
    assert!(clamped("-D film.clamp=0.001 --clamp off").is_null());
}

/// The studio and the looks choose for themselves only what was not chosen.
#[test]
fn what_is_set_stays_as_it_is_set() {
    let folder = folder();
    let shiny = format!("mtllib s.mtl\nusemtl s\n{MODEL}");
    folder.write("s.obj", &shiny);
    folder.write("s.mtl", "newmtl s\nKd 0.5 0.5 0.5\nKs 0.5 0.5 0.5\nNs 200\n");
    let usual = picture(&folder, "s.obj");
    for set in ["integrator=direct", "integrator.path.bounces=0"] {
        assert!(picture(&folder, &format!("s.obj -D {set}")) != usual, "{set}");
    }
    let set = picture(&folder, "s.obj --ground off -D background=navy");
    assert!(set == picture(&folder, "s.obj --ground off --background navy"));
    let clear = picture(&folder, "s.obj --look clarity");
    assert!(clear[..3] == [255; 3] && usual[..3] != [255; 3], "drawings are on white paper");
    for set in ["film.exposure=-1", "film.view=raw"] {
        assert!(picture(&folder, &format!("s.obj --look clarity -D {set}")) != clear, "{set}");
    }
    folder.write("a.toml", "look = \"real\"\nmodels.m.file = \"s.obj\"\n");
    for line in ["s.obj --look real", "a.toml"] {
        let ran = folder.run(&format!("render {line} -D integrator=direct"));
        ran.fails(2, &["-D integrator=direct: the look chooses the integrator"]);
    }
}

#[test]
fn up_and_unit_reach_a_model_of_any_name() {
    let folder = folder();
    let mut command = folder.command("render --up z --unit cm -r 8x8 -q -o a.png");
    assert!(command.arg("my model.obj").status().unwrap().success());
    let ran = folder.run("render m.obj --unit parsec");
    ran.fails(2, &["error: --unit parsec: needs a unit of length", "not \"parsec\""]);
    assert!(!ran.stderr.contains("models"), "{}", ran.stderr);
    folder.run("render m.obj --unit -3").fails(2, &["error: --unit -3: must be greater than 0"]);
}

#[cfg(unix)]
#[test]
fn a_link_to_a_model_elsewhere_is_read() {
    let (folder, other) = (folder(), folder());
    other.write("m.obj", &format!("mtllib m.mtl\n{MODEL}"));
    other.write("m.mtl", "newmtl a\n");
    std::os::unix::fs::symlink(other.path("m.obj"), folder.path("link.obj")).unwrap();
    let ran = folder.run("check link.obj --strict").done();
    assert!(ran.text().starts_with("link.obj: 1 surface, 4 triangles"), "{}", ran.text());
    other.write("m.obj", "f 1 2 3\n");
    let ran = folder.run("check link.obj");
    ran.fails(2, &["link.obj:1: vertex 1 does not exist"]);
    assert!(!ran.stderr.contains("models"), "{}", ran.stderr);
}

#[test]
fn a_file_that_is_no_model_is_told_where_it_is_named() {
    let folder = folder();
    for (file, words) in [(".", "folder"), ("", "folder"), ("scene.toml", "no model file")] {
        folder.write("a.toml", &format!("[models.m]\nfile = \"{file}\"\n"));
        let ran = folder.run("check a.toml");
        ran.fails(2, &["error: a.toml:2:8: models.m.file: ", words, "2 | file = "]);
    }
}

#[test]
fn a_model_without_triangles_is_refused() {
    let folder = folder();
    folder.write(
        "none.gltf",
        r#"{ "asset": { "version": "2.0" }, "nodes": [{}], "scenes": [{ "nodes": [0] }] }"#,
    );
    for command in ["render", "check", "info"] {
        let ran = folder.run(&format!("{command} none.gltf"));
        ran.fails(2, &["error: none.gltf: no triangles in this file"]);
    }
    let flat = WITH_LIGHT.replace("{ \"mesh\": 0 }", "{ \"mesh\": 0, \"scale\": [1, 0, 1] }");
    folder.write("flat.gltf", &flat);
    let words = ["no triangles in this file", "is scaled to nothing"];
    folder.run("check flat.gltf").fails(2, &words);
    folder.write("a.toml", "[models.m]\nfile = \"none.gltf\"\n");
    let ran = folder.run("check a.toml");
    ran.fails(0, &["warning: a.toml:2:8: models.m.file names a model without triangles"]);
    folder.write("flat.obj", "v 0 0 0\nv 1 0 0\nv nan 0 0\nf 1 2 2\nf 1 2 3\n");
    let reason = "all 2 faces are without area or not finite, first here";
    folder.run("check flat.obj").fails(2, &["flat.obj:4: no triangles in this file", reason]);
}

#[test]
fn a_model_without_ground_can_be_cut_out() {
    let folder = folder();
    let codes = picture(&folder, "m.obj --transparent");
    assert_eq!(codes.len(), 40 * 30 * 4);
    assert!(codes.chunks(4).any(|pixel| pixel[3] == 0));
}

#[test]
fn darkness_that_was_asked_for_is_still_told() {
    let ran = folder().run("render m.obj -r 8x8 --key off --headlight off");
    ran.fails(0, &["warning: there are no lights"]);
}

#[test]
fn a_models_own_light_and_camera_are_used_alone() {
    let folder = folder();
    let ran = folder.run("render lit.gltf -r 40x30 --json").done();
    let json = ran.json();
    assert_eq!((json["lights"].as_u64(), json["surfaces"].as_u64()), (Some(1), Some(1)));
    assert_ne!(json["exposure_ev"], 0.0);
    let fixed = folder.run("render lit.gltf -r 40x30 --json -D film.exposure=0").done().json();
    assert_eq!(fixed["exposure_ev"], 0.0);
    // A film without an exposure in it sets none.
    let film = |film: &str| {
        folder.run(&format!("render lit.gltf --json -D film={{{film}}}")).done().json()
    };
    assert_ne!(film("samples=4,resolution=[40,30]")["exposure_ev"], 0.0);
    assert_eq!(film("exposure=0,resolution=[40,30]")["exposure_ev"], 0.0);
    let fixed = folder.run("render lit.gltf -r 40x30 --json --exposure 1").done().json();
    assert_eq!(fixed["exposure_ev"], 1.0);
    let own = picture(&folder, "lit.gltf");
    assert!(own == picture(&folder, "lit.gltf --camera front"));
    assert!(own != picture(&folder, "lit.gltf --camera frame"));
    assert!(own != picture(&folder, "lit.gltf --azimuth 0"));
    let both = folder.run("render lit.gltf --json -r 8x8 --headlight 1").done().json();
    assert_eq!(both["lights"], 2);
    folder.run("render lit.gltf --camera fornt").fails(2, &["did you mean"]);
    folder.run("render lit.gltf --camera front --azimuth 3").fails(2, &["a direction of its own"]);
}
