//! When a render is good enough, or has taken long enough.

use super::Folder;
use std::time::Instant;

const PATH: &str =
    "-D integrator=path -D lights.lamp.point.power=0 -D environment.uniform.radiance=1";

#[test]
fn time_ends_a_render_at_a_whole_pass() {
    let folder = Folder::new();
    let start = Instant::now();
    let json = folder.run("render scene.toml --time 1s -o a.png --json").done().json();
    assert!(start.elapsed().as_secs_f64() < 10.0);
    let spread = &json["samples_per_pixel"];
    let [fewest, mean, most] = ["min", "mean", "max"].map(|key| spread[key].as_f64().unwrap());
    assert!(fewest > 16.0 && fewest <= mean && mean <= most, "{spread}");
    assert_eq!((fewest % 4.0, most % 4.0), (0.0, 0.0), "{spread}");
    assert_eq!(json["samples"].as_f64(), Some(mean.round()));
    assert_eq!(json["rays"]["camera"].as_f64(), Some(48.0 * 32.0 * mean));
    assert_eq!(json["interrupted"], false);
    assert_eq!(json["noise"]["upper_bound"], false);
    // With a number of samples, it is that picture unless the time is over.
    folder.run("render scene.toml --time 1h --spp 8 -o b.exr -q").done();
    folder.run("render scene.toml --spp 8 -o c.exr -q").done();
    let pixels = |name: &str| {
        let bytes = std::fs::read(folder.path(name)).unwrap();
        firstlight::io::load_image(&bytes, name, &firstlight::io::Limits::default()).unwrap()
    };
    assert_eq!(pixels("b.exr"), pixels("c.exr"));
}

#[test]
fn noise_ends_a_render_when_it_is_low_enough() {
    let folder = Folder::new();
    let mut last = 0;
    for (asked, most) in [("5%", 0.05), ("2%", 0.02)] {
        let line = format!("render scene.toml --noise {asked} {PATH} -o a.png --json");
        let json = folder.run(&line).done().json();
        let noise = json["noise"]["relative_standard_error"].as_f64().unwrap();
        assert!(noise <= most && noise > 0.4 * most, "{noise}");
        let samples = json["samples"].as_u64().unwrap();
        assert!(samples > last, "{samples}");
        last = samples;
    }
    // Whichever comes first; samples are counted in the mean, at the end of a pass.
    let line = format!("render scene.toml --noise 0.01% --spp 32 {PATH} -o a.png --json");
    let samples = folder.run(&line).done().json()["samples"].as_u64().unwrap();
    assert!((32..40).contains(&samples), "{samples}");
    folder.run("render scene.toml --noise 1% --samples 0..4 -o a.exr").fails(2, &["--noise"]);
}

#[test]
fn what_clamping_removes_is_reported() {
    let folder = Folder::new();
    let line = format!("render scene.toml --clamp 0.01 {PATH} -o a.png");
    let clamped = folder.run(&format!("{line} --json")).done().json()["clamped"].as_f64().unwrap();
    assert!(clamped > 0.0 && clamped < 1.0, "{clamped}");
    let told = folder.run(&line).done().stderr;
    assert!(told.contains(" % of all light removed by clamping at 0.01"), "{told}");
    let free = folder.run(&format!("render scene.toml {PATH} -o b.png --json")).done().json();
    assert!(free["clamped"].is_null());
    folder.run("render scene.toml --clamp 0 -o a.png").fails(2, &["--clamp", "greater than 0"]);
    folder.run("render scene.toml -D film.clamp=-1 -o a.png").fails(2, &["greater than 0"]);
}
