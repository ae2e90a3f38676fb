//! `verify`: the reference table.

use super::Folder;

#[test]
fn a_case_is_run_by_its_name() {
    let json = Folder::new().run("verify --case L01-point-onaxis --json").done().json();
    let [case] = &json["cases"].as_array().unwrap()[..] else { panic!("{json}") };
    assert_eq!(
        (case["id"].as_str(), case["pass"].as_bool()),
        (Some("L01-point-onaxis"), Some(true))
    );
    assert_eq!(case["group"], "delta-light");
    assert!(
        (case["expected"].as_f64().unwrap() / case["measured"].as_f64().unwrap() - 1.0).abs()
            < 1e-5
    );
    assert!(case["error"].as_f64().unwrap() < 1e-5 && case["z"].as_f64().unwrap().abs() < 4.0);
    assert_eq!(case["points"].as_array().unwrap().len(), 2);
}

#[test]
fn a_group_is_a_table() {
    let text = Folder::new().run("verify --group image").done().text();
    for words in ["K04-srgb-oetf", "K05-luminance", "0.40734", "all 3 cases pass"] {
        assert!(text.contains(words), "{words:?} is not in\n{text}");
    }
}

#[test]
fn names_that_do_not_exist_are_refused() {
    let folder = Folder::new();
    folder.run("verify --group area").fails(2, &["area-light"]);
    folder.run("verify --case L01-point").fails(2, &["L01-point-onaxis"]);
}
