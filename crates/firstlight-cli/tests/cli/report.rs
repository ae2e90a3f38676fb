//! `--json`, `check`, `info` and `schema`.

use super::Folder;

#[test]
fn a_render_reports_everything() {
    let folder = Folder::new();
    let json = folder.run("render scene.toml --json -o a.png -t 2 --seed 3").done().json();
    let keys: Vec<_> = json.as_object().unwrap().keys().map(String::as_str).collect();
    let expected = "scene output denoised width height samples samples_per_pixel interrupted noise clamped seconds rays rays_per_second memory triangles \
        surfaces lights threads simd seed exposure_ev luminous_efficacy dropped_samples warnings";
    assert_eq!(keys, expected.split_whitespace().collect::<Vec<_>>());
    assert_eq!(
        (json["scene"].as_str(), json["output"].as_str()),
        (Some("scene.toml"), Some("a.png"))
    );
    assert_eq!((json["surfaces"].as_u64(), json["lights"].as_u64()), (Some(2), Some(1)));
    assert_eq!(json["rays"]["camera"], 48 * 32 * 4);
    assert_eq!(json["threads"], 2);
    assert_eq!(json["interrupted"], false);
    assert_eq!(json["luminous_efficacy"], 683.0);
    assert_eq!(json["warnings"], serde_json::json!([]));
    let seconds = json["seconds"].as_object().unwrap();
    let stages: Vec<_> = seconds.keys().map(String::as_str).collect();
    assert_eq!(stages, ["load", "build", "check", "render", "write", "total"]);
    let sum: f64 = stages[..5].iter().map(|stage| seconds[*stage].as_f64().unwrap()).sum();
    assert!(seconds["total"].as_f64().unwrap() >= sum - 1e-9);
    #[cfg(target_os = "linux")]
    assert!(json["memory"]["peak_bytes"].as_u64().unwrap() > 1 << 20);
}

#[test]
fn a_report_holds_the_warnings() {
    let json =
        Folder::new().run("render scene.toml --json -D lights.lamp.point.power=0").done().json();
    let [warning] = &json["warnings"].as_array().unwrap()[..] else { panic!("{json}") };
    assert!(warning["message"].as_str().unwrap().contains("no light reaches"));
    assert!(warning["help"].is_string() && warning["place"].is_null());
}

#[test]
fn check_draws_nothing() {
    let folder = Folder::new();
    let text = folder.run("check scene.toml").done().text();
    assert_eq!(text, "scene.toml: 2 surfaces, 0 triangles, 1 light, 2 cameras, 0 warnings\n");
    assert_eq!(folder.names(), ["scene.toml"]);
    folder.write("dark.toml", "[surfaces.ball]\nsphere = {}\n");
    folder.run("check dark.toml").fails(0, &["warning: there are no lights"]);
    folder.write("empty.toml", "");
    folder.run("check empty.toml").fails(0, &["warning: the scene has no surfaces"]);
    let strict = folder.run("check dark.toml --strict --json");
    strict.fails(3, &["warning: there are no lights"]);
    assert_eq!(strict.json()["warnings"].as_array().unwrap().len(), 1);
}

#[test]
fn info_shows_light_in_both_measures() {
    let folder = Folder::new();
    let text = folder.run("info scene.toml").done().text();
    for words in [
        "2 m × 2 m × 2 m",
        "point, intensity 7.958 W/sr = 5.435 kcd",
        "perspective, 40.0° high",
        "48 × 32",
    ] {
        assert!(text.contains(words), "{words:?} is not in\n{text}");
    }
    let json = folder.run("info scene.toml --json").done().json();
    let light = &json["lights"][0];
    assert_eq!(
        (light["unit"].as_str(), light["photometric_unit"].as_str()),
        (Some("W/sr"), Some("cd"))
    );
    let photometric = light["photometric"].as_f64().unwrap();
    assert!((photometric / (683.0 * 100.0 / (4.0 * std::f64::consts::PI)) - 1.0).abs() < 1e-6);
    assert_eq!(json["surfaces"]["by_kind"], serde_json::json!({ "plane": 1, "sphere": 1 }));
    assert_eq!(json["film"]["width"], 48);
    for (axis, expected) in [2.0, 2.0, 2.0].into_iter().enumerate() {
        let size = json["bounds_m"]["size"][axis].as_f64().unwrap();
        assert!((size - expected).abs() < 1e-5, "{size}");
    }
}

#[test]
fn the_schema_is_a_json_schema() {
    let json = Folder::new().run("schema").done().json();
    assert_eq!(json["title"], "firstlight scene");
    assert!(json["properties"]["lights"].is_object() && json["$schema"].is_string());
}

#[cfg(unix)]
#[test]
fn a_reader_that_goes_away_is_no_error() {
    let folder = Folder::new();
    for line in ["schema", "render scene.toml -q -o -", "info scene.toml"] {
        let mut command = folder.command(line);
        command.stdout(std::process::Stdio::piped()).stderr(std::process::Stdio::piped());
        let mut child = command.spawn().unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert_eq!((output.status.code(), output.stderr.len()), (Some(0), 0), "{line}");
    }
}
