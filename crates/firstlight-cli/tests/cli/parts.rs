//! Samples split over runs, and put together again.

use super::{Folder, decode};

const OPTIONS: &str = "render scene.toml -D integrator=path -D film.filter=mitchell --spp 37 -q";

/// The channels of an EXR file that hold its colour, bit for bit.
fn colour(folder: &Folder, name: &str) -> Vec<[u32; 4]> {
    let bytes = std::fs::read(folder.path(name)).expect("a picture");
    let limits = firstlight::io::Limits::default();
    let image = firstlight::io::load_image(&bytes, name, &limits).expect("an EXR file");
    image.pixels().iter().map(|pixel| pixel.map(f32::to_bits)).collect()
}

#[test]
fn parts_in_any_order_make_the_picture_of_one_run_bit_for_bit() {
    let folder = Folder::new();
    folder.run(&format!("{OPTIONS} -o whole.exr")).done();
    folder.run(&format!("{OPTIONS} -o whole.png")).done();
    let whole =
        (colour(&folder, "whole.exr"), decode(&std::fs::read(folder.path("whole.png")).unwrap()));
    let splits: [&[u32]; 3] = [&[0, 37], &[0, 16, 37], &[0, 1, 3, 17, 30, 37]];
    for (number, split) in splits.into_iter().enumerate() {
        let mut parts = Vec::new();
        for ends in split.windows(2) {
            let name = format!("{number}.{}.exr", ends[0]);
            let threads = 1 + ends[0] % 3;
            let line =
                format!("{OPTIONS} --samples {}..{} -t {threads} -o {name}", ends[0], ends[1]);
            folder.run(&line).done();
            parts.push(name);
        }
        for turned in [false, true] {
            parts.sort();
            if turned {
                parts.reverse();
            }
            let parts = parts.join(" ");
            folder.run(&format!("merge {parts} -o merged.exr -q")).done();
            folder.run(&format!("merge {parts} -o merged.png -q")).done();
            assert_eq!(colour(&folder, "merged.exr"), whole.0, "{parts}");
            assert_eq!(
                decode(&std::fs::read(folder.path("merged.png")).unwrap()),
                whole.1,
                "{parts}"
            );
        }
    }
}

#[test]
fn parts_that_do_not_belong_together_are_refused() {
    let folder = Folder::new();
    let part = |name: &str, options: &str| {
        folder.run(&format!("render scene.toml --spp 8 {options} -o {name} -q")).done();
    };
    part("a.exr", "--samples 0..4");
    part("b.exr", "--samples 4..8");
    for (options, words) in [
        ("--samples 4..8 --seed 3", "another seed"),
        ("--samples 4..8 -r 24x32", "another size"),
        ("--samples 4..8 --crop 0,0,8,8", "another crop"),
        ("--samples 4..8 --spp 16", "another number of samples"),
        ("--samples 4..8 -D surfaces.ball.sphere.radius=0.9", "another scene"),
        ("--samples 3..8", "samples 3..4 are in a.exr already"),
    ] {
        let options = options.replace("--spp 16", "");
        if words.contains("number") {
            folder.run("render scene.toml --spp 16 --samples 4..8 -o c.exr -q").done();
        } else {
            part("c.exr", &options);
        }
        folder.run("merge a.exr c.exr -o x.png").fails(2, &["c.exr: ", words, "help: "]);
    }
    folder.run("merge a.exr -o x.png").fails(2, &["samples 4..8 of 8 are missing", "--partial"]);
    folder.run("merge b.exr -o x.png").fails(2, &["samples 0..4 of 8 are missing"]);
    assert!(!folder.path("x.png").exists());
    let json = folder.run("merge b.exr --partial -o x.png --json").done().json();
    assert_eq!(
        (json["samples"].as_u64(), &json["missing"]),
        (Some(4), &serde_json::json!([[0, 4]]))
    );
    let json = folder.run("merge b.exr a.exr -o x.png --json").done().json();
    assert_eq!((json["samples"].as_u64(), &json["missing"]), (Some(8), &serde_json::json!([])));
}

#[test]
fn what_is_no_part_is_refused() {
    let folder = Folder::new();
    folder.run("render scene.toml -o whole.exr -q").done();
    folder.run("merge whole.exr -o x.png").fails(2, &["whole.exr: this is no part", "help: "]);
    folder.run("merge scene.toml -o x.png").fails(2, &["scene.toml: "]);
    folder.run("merge nothing.exr -o x.png").fails(2, &["nothing.exr: "]);
    folder.run("merge").fails(2, &["PART"]);
    folder.run("render scene.toml --samples 0..4 -o a.png").fails(2, &["a.png", ".exr"]);
    folder
        .run("render scene.toml --samples 0..5 -o a.exr")
        .fails(2, &["beyond the 4 samples", "--spp 5"]);
    folder.run("render scene.toml --samples 0..4 -q").done();
    assert!(folder.path("scene.0-4.exr").exists());
    let mut bytes = std::fs::read(folder.path("scene.0-4.exr")).unwrap();
    folder.run("merge scene.0-4.exr -o scene.0-4.exr").fails(2, &["would overwrite"]);
    let length = bytes.len();
    for cut in [length / 2, length - 10, 300] {
        bytes.truncate(cut);
        std::fs::write(folder.path("cut.exr"), &bytes).unwrap();
        folder.run("merge cut.exr -o x.png").fails(2, &["cut.exr: "]);
    }
    assert!(!folder.path("x.png").exists());
}
