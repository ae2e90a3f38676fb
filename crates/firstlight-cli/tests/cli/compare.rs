//! `compare`, `render --reference` and `render --false-color`.

use super::{Folder, SCENE, decode};
use std::fs;

/// The scene with light left to chance: a lamp with soft shadows.
fn soft(folder: &Folder) {
    let lamp = "power = \"100 W\"\nradius = 0.8\n";
    folder.write("soft.toml", &SCENE.replace("power = \"100 W\"\n", lamp));
}

#[test]
fn the_same_samples_make_the_same_picture() {
    let folder = Folder::new();
    folder.run("render scene.toml -o a.png").done();
    folder.run("render scene.toml -o b.png").done();
    let text = folder.run("compare a.png b.png").done().text();
    assert!(text.starts_with("a.png and b.png are the same, bit for bit"), "{text}");
    folder.run("render scene.toml -o b.png -r 24x16").done();
    folder.run("compare a.png b.png").fails(2, &["b.png: is 24 × 16 pixels, not 48 × 32"]);
    folder.run("compare a.png c.png").fails(2, &["c.png"]);
}

#[test]
fn noise_is_told_from_change() {
    let folder = Folder::new();
    soft(&folder);
    let part = |name: &str, more: &str| {
        folder.run(&format!("render soft.toml --samples 0..16 --spp 16 -o {name} {more}")).done();
    };
    part("a.exr", "--seed 1");
    part("b.exr", "--seed 2");
    part("c.exr", "--seed 3 -D lights.lamp.point.power=103");
    let same = folder.run("compare a.exr b.exr --json").done().json();
    assert_eq!((&same["same"], &same["identical"]), (&true.into(), &false.into()));
    assert!(same["test"]["greatest_z"].as_f64().unwrap() > 0.0, "{same}");
    let differs = folder.run("compare c.exr a.exr");
    assert_eq!(differs.code, Some(4), "{}", differs.text());
    assert!(differs.text().contains("differ; greatest |z|"), "{}", differs.text());
    assert!(differs.text().contains("+3."), "{}", differs.text());
}

#[test]
fn what_looks_different_is_told_with_its_place() {
    let folder = Folder::new();
    folder.run("render scene.toml -o a.png -r 96x64").done();
    folder
        .run("render scene.toml -o b.png -r 96x64 -D surfaces.ball.sphere.center=[2.3,0,1]")
        .done();
    let ran = folder.run("compare b.png a.png -o d.png");
    assert_eq!(ran.code, Some(4), "{}", ran.text());
    assert!(ran.text().contains("pixels at ("), "{}", ran.text());
    assert_eq!(decode(&fs::read(folder.path("d.png")).unwrap()).0, 96);
    folder.run("compare b.png a.png --threshold 0.9").done();
    folder.run("render scene.toml -o c.png -r 96x64 -D lights.lamp.point.power=101").done();
    let noise = folder.run("compare c.png a.png --reference-noise 20%").done().text();
    assert!(noise.contains("the same within noise"), "{noise}");
}

#[test]
fn a_render_is_held_to_a_reference() {
    let folder = Folder::new();
    folder.run("render scene.toml -o a.exr").done();
    let line = "render scene.toml -o b.png --reference a.exr";
    let json = folder.run(&format!("{line} --json")).done().json();
    assert_eq!(json["reference"]["identical"], true);
    let ran = folder.run(&format!("{line} -D lights.lamp.point.power=120"));
    ran.fails(4, &["the picture and a.exr differ"]);
    assert!(folder.path("b.png").exists(), "the picture is written nevertheless");
    folder.run("render scene.toml --threshold 0.1").fails(2, &["--reference"]);
}

/// The reference is what is shown: so is the picture that is held to it, with the exposure and the view that it has.
#[test]
fn a_render_is_held_to_what_is_shown() {
    let folder = Folder::new();
    for look in ["", "--exposure 2", "--exposure auto", "--view agx --exposure 1"] {
        folder.run(&format!("render scene.toml -o a.png {look}")).done();
        let line = format!("render scene.toml -o b.png --threshold 0.02 --reference a.png {look}");
        folder.run(&line).done();
        folder
            .run(&format!("{line} -D surfaces.ball.sphere.center=[-2,0,1]"))
            .fails(4, &["differ"]);
    }
    folder.run("render scene.toml -o a.exr --exposure 2").done();
    folder.run("render scene.toml -o a.png --exposure 2").done();
    folder.run("compare a.exr a.png").done();
    folder.run("compare a.png a.exr").done();
    folder.run("render scene.toml -o c.png --reference none.exr").fails(2, &["none.exr"]);
    folder.run("render scene.toml -o c.png -r 8x8 --reference a.png").fails(2, &["48 × 32"]);
    assert!(!folder.path("c.png").exists(), "it is told before the render");
}

#[test]
fn maps_of_light_have_a_legend() {
    let folder = Folder::new();
    for quantity in ["luminance", "illuminance"] {
        let line =
            format!("render scene.toml -r 240x160 -o {quantity}.png --false-color {quantity}");
        folder.run(&line).done();
        let (width, _, codes) = decode(&fs::read(folder.path(&format!("{quantity}.png"))).unwrap());
        // The upper end of the bar has the last colours of the scale.
        let is_last = |p: &[u8]| p[0] >= 0xF0 && p[1] >= 0xDF && p[2] <= 0x30;
        let lit = codes.chunks(codes.len() / (width as usize * 160)).any(is_last);
        assert!(lit && width > 240, "{quantity}");
    }
    // 100 W at 4 m above: 100 / (4π 16) W/m² right below the lamp.
    let line = "render scene.toml -r 8x8 --camera top -o lux.png --false-color illuminance";
    folder.run(&format!("{line} --false-color-range 0..400")).done();
    folder.run(&format!("{line} --false-color-range 400..0")).fails(2, &["the first smaller"]);
    folder.run("render scene.toml --false-color luminance -o a.exr").fails(2, &[".png file"]);
}
