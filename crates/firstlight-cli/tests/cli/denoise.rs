//! `--denoise`: a copy without noise beside the picture, which stays what it is.

use super::Folder;
use firstlight::Image;
use firstlight::io::{Limits, load_image, load_part};

/// Few samples of light from all around, which are noisy.
const NOISY: &str = "-D integrator=path -D lights.lamp.point.power=0 -D environment.uniform.radiance=1 -D film.samples=8";

fn image(folder: &Folder, name: &str) -> Image {
    let bytes = std::fs::read(folder.path(name)).expect("a picture");
    load_image(&bytes, name, &Limits::default()).expect("a picture")
}

#[test]
fn parts_keep_what_denoising_goes_by() {
    let folder = Folder::new();
    folder.run(&format!("render scene.toml {NOISY} --samples 0..4 -o a.exr -q")).done();
    folder.run(&format!("render scene.toml {NOISY} --samples 4..8 --denoise -o b.exr -q")).done();
    folder.run(&format!("render scene.toml {NOISY} -o whole.exr -q")).done();
    let guides = |name: &str| load_part(&folder.path(name), &Limits::default()).unwrap().guides;
    assert!(guides("a.exr").is_none());
    let albedo = guides("b.exr").expect("guides").albedo;
    assert!(albedo.len() == 48 * 32 && albedo.iter().flatten().any(|value| *value > 0.1));
    folder.run("merge a.exr b.exr -o merged.exr -q").done();
    assert_eq!(image(&folder, "merged.exr"), image(&folder, "whole.exr"));
}

#[test]
fn what_cannot_be_denoised_is_refused() {
    let folder = Folder::new();
    for (options, words) in [
        ("--false-color luminance", "no measurement is denoised"),
        ("--look clarity", "the look clarity"),
        ("-o - --format png", "no place beside it"),
    ] {
        let ran = folder.run(&format!("render scene.toml --spp 16777216 --denoise {options}"));
        ran.fails(2, &["error: ", "help: "]);
        assert!(!cfg!(feature = "denoise") || ran.stderr.contains(words), "{}", ran.stderr);
    }
    assert_eq!(folder.names(), ["scene.toml"]);
}

#[cfg(not(feature = "denoise"))]
mod without {
    use super::*;

    #[test]
    fn it_tells_how_to_get_it() {
        let folder = Folder::new();
        folder.run("render scene.toml --samples 0..4 --denoise -o part.exr -q").done();
        for line in
            ["render scene.toml --denoise -o out.png", "merge part.exr --denoise -o out.png"]
        {
            let words = ["built without Open Image Denoise", "help: ", "--features denoise"];
            folder.run(line).fails(2, &words);
        }
        assert_eq!(folder.names(), ["part.exr", "scene.toml"]);
    }
}

#[cfg(feature = "denoise")]
mod with {
    use super::super::{SCENE, decode};
    use super::*;

    /// Whether the library is here; where `OIDN_DIR` promises it, it has to be.
    fn is_here() -> bool {
        let ran = Folder::new().run("render scene.toml -r 4x4 --denoise");
        let missing = ran.code == Some(1) && ran.stderr.contains("is not to be had");
        assert!(!missing || std::env::var_os("OIDN_DIR").is_none(), "{}", ran.stderr);
        if missing {
            eprintln!("not tested: {}", ran.stderr);
        }
        !missing
    }

    #[test]
    fn without_the_library_the_picture_is_made_nevertheless() {
        let folder = Folder::new();
        let output = folder
            .command("render scene.toml --denoise --json")
            .env("OIDN_DIR", "/nowhere")
            .output();
        let output = output.unwrap();
        assert_eq!(output.status.code(), Some(1));
        let said = String::from_utf8(output.stderr).unwrap();
        for words in [
            "warning: --denoise: the picture will not be denoised: ",
            "/nowhere/",
            "help: pip install pyoidn",
            "error: --denoise: the picture was not denoised: ",
        ] {
            assert!(said.contains(words), "{said}");
        }
        let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!((&json["output"], &json["denoised"]), (&"scene.png".into(), &().into()));
        assert_eq!(folder.names(), ["scene.png", "scene.toml"]);
        assert_eq!(decode(&std::fs::read(folder.path("scene.png")).unwrap()).0, 48);
    }

    #[test]
    fn the_copy_is_checked_before_rendering() {
        let folder = Folder::new();
        std::fs::create_dir(folder.path("out.denoised.png")).unwrap();
        let render = "render scene.toml --spp 16777216 --denoise";
        folder
            .run(&format!("{render} -o out.png"))
            .fails(2, &["out.denoised.png: this is a folder"]);
        folder.run("render scene.toml -q -r 4x4 -o sky.denoised.png").done();
        let sky = "[materials.a.lambert]\nreflectance.image.file = \"sky.denoised.png\"\n";
        folder.write("far.toml", &format!("{SCENE}{sky}"));
        let ran = folder.run("render far.toml --spp 16777216 --denoise -o sky.png");
        ran.fails(2, &["sky.denoised.png: the picture would overwrite this file"]);
    }

    #[test]
    fn the_copy_lies_beside_the_picture_and_says_what_it_is() {
        if !is_here() {
            return;
        }
        let folder = Folder::new();
        let ran = folder.run(&format!("render scene.toml {NOISY} --denoise -o out.png")).done();
        assert_eq!(folder.names(), ["out.denoised.png", "out.png", "scene.toml"]);
        let lines: Vec<_> = ran.stderr.lines().collect();
        assert!(lines[0].starts_with("wrote out.png: 48×32, 8 spp"), "{}", ran.stderr);
        let by = lines[1].strip_prefix("wrote out.denoised.png: denoised by ").expect("a line");
        assert!(by.starts_with("Open Image Denoise 2."), "{by}");
        let denoised = |name: &str| {
            let file = std::io::BufReader::new(std::fs::File::open(folder.path(name)).unwrap());
            let mut reader = png::Decoder::new(file).read_info().unwrap();
            reader.finish().unwrap();
            let mut texts = reader.info().uncompressed_latin1_text.iter();
            texts.find(|text| text.keyword == "Denoised").map(|text| text.text.clone())
        };
        assert_eq!(denoised("out.png"), None);
        assert_eq!(
            denoised("out.denoised.png"),
            Some(format!("by {by}; an estimate, not unbiased"))
        );
        let line = format!("render scene.toml {NOISY} --denoise --json -o out.exr --aov depth");
        let json = folder.run(&line).done().json();
        assert_eq!(json["denoised"], serde_json::json!({ "output": "out.denoised.exr", "by": by }));
        folder.run("render scene.toml --denoise --format hdr -o out -q").done();
        assert!(folder.path("out.denoised").exists());
    }

    /// A picture of many samples tells how much nearer the copy is.
    #[test]
    fn the_picture_stays_what_it_is_and_the_copy_is_nearer_to_the_truth() {
        if !is_here() {
            return;
        }
        let folder = Folder::new();
        let render = format!("render scene.toml {NOISY} -q --crop 4,2,40,28 --transparent");
        folder.run(&format!("{render} -o plain.pfm")).done();
        folder.run(&format!("{render} --denoise -o out.pfm")).done();
        let read = |name: &str| std::fs::read(folder.path(name)).unwrap();
        assert!(read("plain.pfm") == read("out.pfm"), "the picture is not the same");
        folder.run(&format!("{render} --spp 4096 -o truth.pfm")).done();
        let truth = image(&folder, "truth.pfm");
        let error = |name: &str| {
            let pixels = image(&folder, name);
            let pixels = pixels.pixels().iter().flatten().zip(truth.pixels().iter().flatten());
            pixels.map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>().sqrt()
        };
        let [noisy, denoised] = [error("out.pfm"), error("out.denoised.pfm")];
        assert!(denoised < 0.5 * noisy, "{denoised} {noisy}");
    }

    #[test]
    fn merged_parts_are_denoised_as_one_run_is() {
        if !is_here() {
            return;
        }
        let folder = Folder::new();
        let render = format!("render scene.toml {NOISY} -q");
        folder.run(&format!("{render} --samples 0..3 -o a.exr")).done();
        folder.run(&format!("{render} --samples 3..8 --denoise -o b.exr")).done();
        folder.run(&format!("{render} --denoise -o whole.exr")).done();
        let json = folder.run("merge a.exr b.exr --denoise -o merged.exr --json").done().json();
        assert_eq!(json["denoised"]["output"], "merged.denoised.exr");
        assert_eq!(image(&folder, "merged.denoised.exr"), image(&folder, "whole.denoised.exr"));
        let ran = folder.run("merge a.exr --partial --denoise -o x.png");
        ran.fails(2, &["no part has the albedo and normals", "with --denoise"]);
        assert!(!folder.path("x.png").exists());
    }

    #[cfg(unix)]
    #[test]
    fn what_was_broken_off_is_denoised_too() {
        if !is_here() {
            return;
        }
        let folder = Folder::new();
        let line = "render scene.toml --spp 16777216 --denoise -o out.png";
        let mut command = folder.command(line);
        let child = command.stderr(std::process::Stdio::piped()).spawn().expect("started");
        std::thread::sleep(std::time::Duration::from_millis(1500));
        let id = child.id().to_string();
        assert!(std::process::Command::new("kill").args(["-INT", &id]).status().unwrap().success());
        let output = child.wait_with_output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(130), "{said}");
        assert!(said.starts_with("stopped early and wrote out.png"), "{said}");
        assert_eq!(folder.names(), ["out.denoised.png", "out.png", "scene.toml"]);
    }
}
