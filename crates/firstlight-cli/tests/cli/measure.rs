//! `firstlight measure` against closed forms.

use super::{Folder, Ran};
use serde_json::Value;
use std::f64::consts::PI;

#[track_caller]
fn close(value: &Value, expected: f64) {
    let value = value.as_f64().expect("a number");
    assert!((value / expected - 1.0).abs() < 1e-6, "{value} is not {expected}");
}

fn readings(ran: Ran) -> Vec<Value> {
    ran.done().json().as_array().expect("a list").clone()
}

#[test]
fn a_point_light_gives_its_power_over_the_sphere() {
    let folder = Folder::new();
    // E = P / (4π r²), and times the cosine of 60°, and P h / (4π (h² + x²)^1.5).
    let arguments = "--irradiance 0,0,2,0,0,1 --irradiance 0,0,2,0,1.7320508075688772,1 --irradiance -3,0,0,0,0,7";
    let found = readings(folder.run(&format!("measure scene.toml --json {arguments}")));
    let full = 100.0 / (4.0 * PI * 4.0);
    let expected = [full, 0.5 * full, 100.0 * 4.0 / (4.0 * PI * 125.0)];
    for (reading, expected) in found.iter().zip(expected) {
        assert_eq!(reading["kind"], "irradiance");
        for channel in 0..3 {
            close(&reading["value"][channel], expected);
            assert_eq!(reading["standard_error"][channel], 0.0);
        }
        close(&reading["photometric"], 683.0 * expected);
        assert_eq!(
            (reading["unit"].as_str(), reading["photometric_unit"].as_str()),
            (Some("W/m²"), Some("lx"))
        );
        assert_eq!(reading["samples"], 1);
        assert_eq!(reading.as_object().unwrap().len(), 7);
    }
    assert_eq!(found.len(), 3);
}

#[test]
fn radiance_of_a_matte_floor_is_its_reflectance_over_pi() {
    let folder = Folder::new();
    let line = "measure scene.toml --json --radiance -1,0,2,0,0,-3 -D luminous_efficacy=100";
    let found = readings(folder.run(line));
    let irradiance = 100.0 * 4.0 / (4.0 * PI * 17_f64.powf(1.5));
    close(&found[0]["value"][0], 0.5 / PI * irradiance);
    close(&found[0]["photometric"], 100.0 * 0.5 / PI * irradiance);
    assert_eq!(found[0]["unit"], "W/(sr·m²)");
    assert_eq!(found[0]["photometric_unit"], "cd/m²");
}

#[test]
fn a_shadow_is_dark() {
    let found = readings(Folder::new().run("measure scene.toml --json --irradiance 2.9,0,0,0,0,1"));
    assert_eq!(found[0]["value"], serde_json::json!([0.0, 0.0, 0.0]));
}

#[test]
fn the_order_is_that_of_the_command_line() {
    let folder = Folder::new();
    let line =
        "measure scene.toml --json --radiance 0,0,2,0,0,-1 --irradiance - --radiance 0,0,3,0,0,-1";
    let ran = folder.run_with(line, b"x,y,z,nx,ny,nz\n0,0,0,0,0,1\n# end\n\n0,0,1,0,0,1\n");
    let found = readings(ran);
    let kinds: Vec<_> = found.iter().map(|r| r["kind"].as_str().unwrap()).collect();
    assert_eq!(kinds, ["radiance", "irradiance", "irradiance", "radiance"]);
    close(&found[2]["value"][0], 100.0 / (4.0 * PI * 9.0));
}

#[test]
fn no_rows_are_an_error() {
    for rows in ["", "# nothing\n"] {
        for line in ["measure scene.toml --json", "measure scene.toml --irradiance -"] {
            let ran = Folder::new().run_with(line, rows.as_bytes());
            ran.fails(2, &["error: standard input: no points given"]);
        }
    }
}

#[test]
fn rows_may_say_their_kind() {
    let ran = Folder::new()
        .run_with("measure scene.toml --json", b"irradiance,0,0,2,0,0,1\nradiance,0,0,2,0,0,-1\n");
    let kinds: Vec<_> =
        readings(ran).iter().map(|r| r["kind"].as_str().unwrap().to_owned()).collect();
    assert_eq!(kinds, ["irradiance", "radiance"]);
}

#[test]
fn bad_points_are_named() {
    let folder = Folder::new();
    folder.run("measure scene.toml --irradiance 0,0,0,0,0,0").fails(2, &["has no length"]);
    folder.run("measure scene.toml --irradiance 0,0,0").fails(2, &["needs six numbers"]);
    let ran = folder.run_with("measure scene.toml --irradiance -", b"0,0,0,0,0,1\n0,0,0,0,x,1\n");
    ran.fails(2, &["standard input: row 2: needs six numbers", "\"x\""]);
    folder
        .run_with("measure scene.toml", b"0,0,0,0,0,1\n")
        .fails(2, &["row 1", "irradiance or radiance"]);
    folder.run("measure - --irradiance -").fails(2, &["can be read only once"]);
    folder.run("measure scene.toml --irradiance - --radiance -").fails(2, &["only once"]);
}

#[test]
fn text_has_nine_digits_and_units() {
    let text = Folder::new().run("measure scene.toml --irradiance 0,0,2,0,0,1").done().text();
    let value = text.split_whitespace().skip_while(|word| *word != "r").nth(1).unwrap();
    let value: f64 = value.parse().unwrap();
    assert!((value - 100.0 / (16.0 * PI)).abs() < 1e-6, "{text}");
    assert!(text.contains("W/m²") && text.contains(" lx\n") && text.contains("± 0"), "{text}");
}

#[test]
fn lights_at_the_camera_follow_the_chosen_one() {
    let folder = Folder::new();
    let line =
        "measure scene.toml --json --irradiance 0,0,0,0,0,1 -D lights.lamp={camera={intensity=2}}";
    let found = readings(folder.run(&format!("{line} --camera top")));
    // The camera from above is infinitely far away: its intensity counts as irradiance.
    close(&found[0]["value"][0], 2.0);
    let found = readings(folder.run(line));
    close(&found[0]["value"][0], 2.0 * 3.0 / 45_f64.powf(1.5));
}
