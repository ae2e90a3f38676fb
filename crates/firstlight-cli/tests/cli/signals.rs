//! Signals: the render stops, and a valid picture of what was done is left.

use super::{Folder, decode};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// A render that would take days.
fn endless(folder: &Folder) -> Child {
    let mut command = folder.command("render scene.toml --spp 16777216 --json -o out.png");
    command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("started")
}

fn send(signal: &str, child: &Child) {
    let id = child.id().to_string();
    assert!(Command::new("kill").args([signal, &id]).status().expect("kill").success());
}

fn stops_with(signal: &str, code: i32) {
    let folder = Folder::new();
    let child = endless(&folder);
    std::thread::sleep(Duration::from_millis(700));
    let asked = Instant::now();
    send(signal, &child);
    let output = child.wait_with_output().expect("ended");
    assert!(asked.elapsed() < Duration::from_secs(10));
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{stderr}");
    let (width, height, codes) = decode(&std::fs::read(folder.path("out.png")).expect("a picture"));
    assert_eq!((width, height), (48, 32));
    assert!(codes.iter().any(|code| *code > 100));
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("a report");
    assert_eq!(json["interrupted"], true);
    assert!(json["samples"].as_u64().unwrap() > 0);
    assert_eq!(folder.names(), ["out.png", "scene.toml"]);
}

#[test]
fn sigint_leaves_a_valid_picture() {
    stops_with("-INT", 130);
}

#[test]
fn sigterm_leaves_a_valid_picture() {
    stops_with("-TERM", 143);
}
