//! Wrong usage and bad input: exit code 2 and a word about what is wrong.

use super::{Folder, SCENE};

#[test]
fn bad_numbers_are_refused() {
    let folder = Folder::new();
    let cases = [
        ("-r 0x5", "1 to 65536"),
        ("-r -1x5", "needs width and height"),
        ("-r 4294967296x1", "needs width and height"),
        ("-r 65536x65536", "pixels"),
        ("--spp 0", "not in 1..=16777216"),
        ("--spp -1", "not in 1..=16777216"),
        ("--spp 9223372036854775808", "--spp"),
        ("-t 0", "not in 1..=1024"),
        ("-t 1000000000", "not in 1..=1024"),
        ("--seed -1", "must be a whole number from 0 to"),
        ("--crop 0,0,0,1", "four whole numbers"),
        ("--exposure nan", "must be from"),
        ("--exposure bright", "needs a number; or auto"),
        ("--simd sse9", "this processor has auto, portable"),
        ("--format jpg", "possible values"),
        ("-D film.samples", "this sets no value"),
    ];
    for (arguments, words) in cases {
        folder.run(&format!("render scene.toml {arguments}")).fails(2, &["error: ", words]);
    }
    assert_eq!(folder.names(), ["scene.toml"]);
}

#[test]
fn the_output_is_checked_before_rendering() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("sub")).unwrap();
    let cases = [
        ("sub", "this is a folder"),
        (".", "this is a folder"),
        ("new/", "this is a folder"),
        ("no/a.png", "there is no folder no"),
        ("scene.toml/a.png", "there is no folder scene.toml"),
        ("a.pgn", "did you mean \".png\"?"),
        ("a.jpg", "pictures cannot be written as \".jpg\""),
        ("a", "needs an extension"),
    ];
    for (output, words) in cases {
        // So many samples that the test would never end if it were not checked before.
        let ran = folder.run(&format!("render scene.toml --spp 16777216 -o {output}"));
        ran.fails(2, &[&format!("error: {output}: "), words]);
    }
}

#[test]
fn no_input_is_overwritten() {
    let folder = Folder::new();
    folder.run("render scene.toml -q -r 4x4 -o sky.png").done();
    std::fs::copy(folder.path("sky.png"), folder.path("far.png")).unwrap();
    folder.write("m.obj", "mtllib m.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n");
    folder.write("m.mtl", "newmtl a\nmap_Kd sky.png\n");
    let models = "[models.m]\nfile = \"m.obj\"\n";
    let floor = "[materials.a.lambert]\nreflectance = { image = { file = \"far.png\" } }\n";
    folder.write("far.toml", &format!("{SCENE}{models}{floor}"));
    // So many samples that the test would never end if it were not checked before.
    let render = "render far.toml --spp 16777216 --format png";
    for output in ["", "-o sky.png", "-o ./far.png", "-o far.toml", "-o m.mtl", "-o m.obj"] {
        let ran = folder.run(&format!("{render} {output}"));
        ran.fails(2, &["the picture would overwrite this file", "help: name another file with -o"]);
    }
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("sky.png", folder.path("link.png")).unwrap();
        folder.run(&format!("{render} -o link.png")).fails(2, &["link.png: the picture would"]);
    }
    folder.run("render far.toml -q -r 4x4 -o new.png").done();
}

#[cfg(target_os = "linux")]
#[test]
fn memory_is_asked_for_before_it_is_used() {
    let folder = Folder::new();
    // 64 GiB.
    let Some(available) = available_mebibytes().filter(|mebibytes| *mebibytes < 65_536) else {
        return;
    };
    let ran = folder.run("render scene.toml -r 32768x32768");
    ran.fails(2, &["needs 98304 MiB of memory;", "MiB are available", "--crop"]);
    assert!(available > 0);
    // A part of it is no problem.
    folder.run("render scene.toml -q -r 32768x32768 --crop 16000,16000,4,4").done();
}

#[cfg(target_os = "linux")]
fn available_mebibytes() -> Option<u64> {
    let table = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = table.lines().find(|line| line.starts_with("MemAvailable:"))?;
    line.split_whitespace().nth(1)?.parse::<u64>().ok().map(|kibibytes| kibibytes / 1024)
}

#[test]
fn complaints_name_the_place_and_what_was_meant() {
    let folder = Folder::new();
    folder.write("bad.toml", &SCENE.replace("power =", "powr ="));
    for command in ["render", "check", "info", "measure --irradiance 0,0,0,0,0,1"] {
        let ran = folder.run(&format!("{command} bad.toml"));
        ran.fails(
            2,
            &["error: bad.toml:17:1: ", "unknown field \"powr\"", "did you mean \"power\"?"],
        );
    }
    let ran = folder.run("render scene.toml -D lights.lamp.point.powr=3");
    ran.fails(2, &["-D lights.lamp.point.powr=3: ", "did you mean \"power\"?"]);
    folder.run("render missing.toml").fails(2, &["missing.toml: no such file"]);
    folder.run("render missing.glb").fails(2, &["missing.glb: no such file"]);
    folder.run("check .").fails(2, &["this is a folder"]);
    folder.run("rendr scene.toml").fails(2, &["'render'"]);
    folder.run("render scene.toml --sp 3").fails(2, &["'--spp'"]);
}

#[cfg(unix)]
#[test]
fn a_file_without_end_is_not_read() {
    let folder = Folder::new();
    folder.run("render /dev/zero").fails(2, &["/dev/zero: this is a device or a pipe"]);
    std::os::unix::fs::symlink("/dev/zero", folder.path("zero.toml")).unwrap();
    folder.run("check zero.toml").fails(2, &["this is a device or a pipe"]);
}

#[cfg(unix)]
#[test]
fn no_file_steers_the_terminal() {
    let folder = Folder::new();
    let name = "\u{1b}[2Jred\u{7}.toml";
    folder.write(name, SCENE);
    for line in ["check", "info", "render -r 4x4", "render -r 4x4 -o \u{1b}[1m.png"] {
        let output = folder.command(line).arg(name).output().unwrap();
        assert!(output.status.success(), "{line:?}");
        let said = String::from_utf8([output.stdout, output.stderr].concat()).unwrap();
        assert!(said.contains("\u{fffd}["), "{said:?}");
        assert!(!said.replace('\n', "").contains(char::is_control), "{said:?}");
    }
    folder.write(name, "film.samples = \"\u{9b}31m\"\n");
    let ran = folder.command("check").arg(name).output().unwrap();
    let said = String::from_utf8(ran.stderr).unwrap();
    assert!(!said.replace('\n', "").contains(char::is_control), "{said:?}");
}

#[test]
fn studio_flags_are_for_models() {
    let folder = Folder::new();
    let flags = [
        ("--azimuth 5", "[camera.perspective]"),
        ("--elevation -5", "[camera.perspective]"),
        ("--key off", "[lights.key.directional]"),
        ("--headlight 1", "[lights.head.camera]"),
        ("--ground tomato", "[surfaces.ground.plane]"),
        ("--background tomato", "-D background=…"),
        ("--up y", "-D models.NAME.up=y"),
        ("--unit mm", "-D models.NAME.unit=mm"),
    ];
    for (flag, words) in flags {
        let ran = folder.run(&format!("render scene.toml {flag}"));
        ran.fails(2, &["this is for model files", words]);
    }
}

#[test]
fn files_outside_the_folder_need_a_permission() {
    let (folder, other) = (Folder::new(), Folder::new());
    other.write("m.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n");
    let file = other.path("m.obj").display().to_string();
    folder.write("far.toml", &format!("{SCENE}[models.m]\nfile = {file:?}\n"));
    folder.run("check far.toml").fails(2, &["outside the scene's folder", "--allow-path"]);
    let allowed = other.path("").display().to_string();
    folder.run(&format!("check far.toml --allow-path {allowed}")).done();
}

#[test]
fn help_and_version_go_to_standard_output() {
    let folder = Folder::new();
    let help = folder.run("render --help").done().text();
    assert!(help.contains("Examples:") && help.contains("--azimuth"), "{help}");
    let version = folder.run("--version").done().text();
    assert_eq!(version.trim(), concat!("firstlight ", env!("CARGO_PKG_VERSION")));
    folder.run("").fails(2, &["Usage:"]);
}
