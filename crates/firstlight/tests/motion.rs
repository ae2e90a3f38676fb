//! What moves while the shutter is open: pictures, shadows and lights against their closed forms.

mod common;

use common::*;
use firstlight::io::scene_file;
use firstlight::render::{RenderOptions, render};
use firstlight::{FileAccess, Image, Meter, Scene, SceneDescription};
use glam::DVec3;
use std::f64::consts::{FRAC_2_PI, PI, TAU};
use std::ops::ControlFlow;
use std::path::Path;

fn scene(text: &str) -> SceneDescription {
    read(Path::new("scene.toml"), text, &[])
}

fn picture_of(scene: &SceneDescription, threads: usize) -> Image {
    let options = RenderOptions { threads, ..RenderOptions::default() };
    render(&Scene::build(scene), &options, &|_| ControlFlow::Continue(())).image
}

fn picture(text: &str) -> Image {
    picture_of(&scene(text), 1)
}

/// The mean of `f` over `from..to`.
fn mean(f: impl Fn(f64) -> f64, from: f64, to: f64) -> f64 {
    const STEPS: u32 = 2000;
    let at = |i: u32| f(from + (to - from) * (f64::from(i) + 0.5) / f64::from(STEPS));
    (0..STEPS).map(at).sum::<f64>() / f64::from(STEPS)
}

#[track_caller]
fn expect_irradiance(text: &str, expected: f64) {
    let scene = Scene::build(&scene(text));
    expect(
        |samples| Meter::new(&scene).samples(samples).irradiance(DVec3::ZERO, DVec3::Z),
        expected,
    );
}

/// Looks straight down on 16 × 4 pixels of 0.25 m; the left edge is x = −2.
const FROM_ABOVE: &str = "
    film = { resolution = [16, 4], samples = 1024, filter = { box = { radius = 0.5 } } }
    [camera.orthographic]
    position = [0, 0, 10]
    height = 1
    up = [0, 1, 0]
";

/// A luminous square 0.6 m wide goes 1.5 m to the right: each place is covered for as long as it takes to pass by.
#[test]
fn a_moving_square_fades_in_and_out() {
    for (shutter, opens, closes) in [("", 0.0, 1.0), ("shutter = [0.25, 0.75]", 0.25, 0.75)] {
        let image = picture(&format!(
            "{FROM_ABOVE}{shutter}
            [surfaces.bar]
            quad = {{ corner = [-1.1, -5, 0], edge_u = [0.6, 0, 0], edge_v = [0, 10, 0] }}
            light = {{ radiance = 1 }}
            motion = {{ translate = [1.5, 0, 0] }}"
        ));
        let covered = |x: f64| {
            let [from, to] = [x + 0.5, x + 1.1].map(|shift| (shift / 1.5).clamp(opens, closes));
            (to - from) / (closes - opens)
        };
        let mut squares = 0.0;
        for ix in 0..16 {
            let left = -2.0 + 0.25 * f64::from(ix);
            let expected = mean(covered, left, left + 0.25);
            let deviation = (expected * (1.0 - expected) / 1024.0).sqrt();
            for iy in 0..4 {
                let off = f64::from(image.get(ix, iy).x) - expected;
                assert!(off.abs() <= 4.0 * deviation + 1e-6, "{ix}: {off} of {expected}");
                squares += (off / deviation.max(1e-6)).powi(2);
            }
        }
        assert!(squares < 64.0, "{squares}");
    }
}

/// Half of a disk shines. After a whole turn every point has shone half of the time; halfway through a quarter turn, the
/// shining half has come to the next quarter for half of the time.
#[test]
fn a_turning_disk_becomes_its_mean() {
    let image = |angle: f64| {
        picture(&format!(
            "{FROM_ABOVE}
            [surfaces.disk]
            disk = {{ radius = 3 }}
            material = 'half'
            motion = {{ rotate_z = {angle} }}
            [materials.half.lambert]
            reflectance = 0
            emission = {{ checker = {{ colors = [1, 0], size = [0.5, 9] }} }}"
        ))
    };
    // The texture begins somewhere; what is opposite is always the other half.
    let whole = image(360.0);
    for (ix, iy) in (0..16).flat_map(|ix| (0..4).map(move |iy| (ix, iy))) {
        let value = f64::from(whole.get(ix, iy).x);
        assert!((value - 0.5).abs() < 4.0 * 0.5 / 32.0, "{ix} {iy}: {value}");
    }
    let still = image(0.0);
    let turned = image(180.0);
    for (ix, iy) in [(1, 0), (14, 3), (2, 3), (13, 0)] {
        let angle = (1.5 - f64::from(iy)).atan2(f64::from(ix) - 7.5);
        let ahead = |turn: f64| ((angle - turn).rem_euclid(TAU) / PI).floor() == 0.0;
        let expected = mean(|turn| f64::from(ahead(turn)), 0.0, PI);
        let shines = f64::from(still.get(ix, iy).x) > 0.5;
        // By the side of the line between the halves along x that the texture starts with.
        let expected = if shines == ahead(0.0) { expected } else { 1.0 - expected };
        let value = f64::from(turned.get(ix, iy).x);
        assert!((value - expected).abs() < 0.05, "{ix} {iy}: {value} {expected}");
    }
}

/// Things that several pictures are taken of.
const THINGS: &str = "
    LIGHT
    film = { resolution = [48, 32], samples = 8 }
    [surfaces.ball]
    sphere = { center = [0.4, 0, 0.2], radius = 0.5 }
    MOTION
    [surfaces.block]
    box = { min = [-1, -0.5, -0.5], max = [-0.4, 0.5, 0.2] }
    MOTION
    [surfaces.sheet]
    mesh = { vertices = [[-1, 1, -1], [1, 1, -1], [0.2, 1, 1.2]], triangles = [[0, 1, 2]] }
    MOTION
    [lights.key.directional]
    direction = [0, 1, 0]
    irradiance = 2
    [camera.perspective]
    position = [0, -4, 0]
    target = [0, 0, 0]
    CAMERA
";

/// Every way that light takes, and the lecture's sum, which leaves nothing to chance but the time.
const BY_PATHS: &str = "integrator = 'path'\nenvironment.uniform.radiance = 0.5";
const BY_SUM: &str = "integrator = 'direct'";

fn things(light: &str, motion: &str, camera: &str) -> String {
    THINGS.replace("LIGHT", light).replace("MOTION", motion).replace("CAMERA", camera)
}

/// The part of all pixels that differ by more than rounding may.
fn part_that_differs(a: &Image, b: &Image) -> f64 {
    let differs = |(a, b): (&[f32; 4], &[f32; 4])| (0..3).any(|i| (a[i] - b[i]).abs() > 2e-3);
    let count = a.pixels().iter().zip(b.pixels()).filter(|pair| differs(*pair)).count();
    count as f64 / a.pixels().len() as f64
}

/// Whether the camera goes one way or everything else the other is the same, sample by sample. (The light comes along the axis
/// of the turn. Paths pick directions in the world, which does not turn, so that they are the same only if nothing turns.)
#[test]
fn a_moving_camera_is_a_moving_world() {
    let goes = (
        "motion = { translate = [0.6, 0, -0.3] }",
        "motion = { position = [-0.6, -4, 0.3], target = [-0.6, 0, 0.3] }",
    );
    let turns = (
        "motion = { rotate_y = -80, about = [0, 0, 0] }",
        "motion = { up = [0.984807753, 0, 0.173648178] }",
    );
    for (light, (world, camera)) in [(BY_PATHS, goes), (BY_SUM, goes), (BY_SUM, turns)] {
        let [still, world, camera] =
            [("", ""), (world, ""), ("", camera)].map(|(w, c)| picture(&things(light, w, c)));
        assert!(part_that_differs(&world, &still) > 0.1, "something moves");
        let off = part_that_differs(&world, &camera);
        assert!(off < 0.01, "{off} of the pixels differ by {light}");
    }
}

#[test]
fn a_motion_that_goes_nowhere_is_none() {
    let nowhere = "motion = { translate = [0, 0, 0], rotate_x = 0, scale = 1 }";
    let camera = "motion = { position = [0, -4, 0], target = [0, 0, 0] }";
    for light in [BY_PATHS, BY_SUM] {
        let still = picture(&things(light, "", ""));
        assert_eq!(still.pixels(), picture(&things(light, nowhere, camera)).pixels());
        let shutter = picture(&things(light, "", "shutter = [0.2, 0.3]"));
        assert_eq!(still.pixels(), shutter.pixels());
    }
}

#[test]
fn threads_make_no_difference_to_what_moves() {
    let motion = "motion = { rotate_x = 400, scale = 1.5 }";
    let scene = scene(&things(BY_PATHS, motion, "motion = { position = [1, -3, 0] }"));
    assert_eq!(picture_of(&scene, 1).pixels(), picture_of(&scene, 3).pixels());
}

/// A point light 2 m above the meter; something passes in between at half the height, and is in the way for a quarter of the
/// time, by whatever integrator.
#[test]
fn what_passes_a_light_dims_it_for_as_long_as_it_takes() {
    let blockers = [
        "quad = { corner = [-1.25, -5, 1], edge_u = [0.5, 0, 0], edge_v = [0, 10, 0] }",
        "sphere = { center = [-1, 0, 1], radius = 0.25 }",
        "mesh = { vertices = [[-1.25, -9, 1], [-0.75, -9, 1], [-1.25, 9, 1], [-0.75, 9, 1]], triangles = [[0, 1, 2], [1, 3, 2]] }",
    ];
    for integrator in ["'direct'", "'path'"] {
        for blocker in blockers {
            let text = format!(
                "integrator = {integrator}
                [lights.lamp.point]
                position = [0, 0, 2]
                intensity = 8
                [surfaces.shade]
                {blocker}
                material = 'black'
                motion = {{ translate = [2, 0, 0] }}
                [materials.black.lambert]
                reflectance = 0"
            );
            expect_irradiance(&text, 0.75 * 8.0 / 4.0);
        }
    }
}

/// A luminous ball gives π r² L / d², wherever it is and however large; a small disk that turns over and over gives A L cos θ / d².
#[test]
fn moving_lights_give_their_mean() {
    let ball = |place: &str, motion: &str| {
        format!(
            "integrator = 'path'
            [surfaces.ball]
            sphere = {{ center = [0, 0, {place}], radius = 0.5 }}
            light = {{ radiance = 2 }}
            motion = {{ {motion} }}"
        )
    };
    let given = |radius: f64, distance: f64| 2.0 * PI * (radius / distance).powi(2);
    expect_irradiance(&ball("2", "translate = [0, 0, 1]"), given(0.5, 1.0) / 6.0);
    expect_irradiance(&ball("4", "scale = 2"), given(0.5, 4.0) * 7.0 / 3.0);
    let round = ball("2", "rotate_x = 60, about = [0, 0, 0]");
    let sixty = 60_f64.to_radians();
    expect_irradiance(&round, given(0.5, 2.0) * sixty.sin() / sixty);
    let shapes = [
        ("disk = { center = [0, 0, 1], normal = [0, 0, -1], radius = 0.01 }", PI * 1e-4),
        (
            "quad = { corner = [-0.01, -0.01, 1], edge_u = [0, 0.02, 0], edge_v = [0.02, 0, 0] }",
            4e-4,
        ),
    ];
    for (shape, area) in shapes {
        let text = format!(
            "integrator = 'path'
            [surfaces.light]
            {shape}
            light = {{ radiance = 5 }}
            motion = {{ rotate_x = 720 }}"
        );
        expect_irradiance(&text, 5.0 * area / PI);
    }
}

/// A white board turns from facing the sun to being edge-on; the mean of cos θ over that is 2/π.
#[test]
fn normals_turn_along() {
    let boards = [
        "quad = { corner = [-5, -5, 0], edge_u = [10, 0, 0], edge_v = [0, 10, 0] }",
        "disk = { radius = 5 }",
        "mesh = { vertices = [[-9, -9, 0], [9, -9, 0], [0, 9, 0]], triangles = [[0, 1, 2]], normals = [[0, 0, 1], [0, 0, 1], [0, 0, 1]] }",
    ];
    for board in boards {
        let image = picture(&format!(
            "film = {{ resolution = [2, 2], samples = 4096 }}
            [camera.orthographic]
            position = [0, 0, 10]
            height = 0.001
            [surfaces.board]
            {board}
            material = 'white'
            motion = {{ rotate_x = 90, about = [0, 0, 0] }}
            [materials.white.lambert]
            reflectance = 1
            [lights.sun.directional]
            direction = [0, 0, -1]
            irradiance = {PI}"
        ));
        close(image.get(0, 0).x, FRAC_2_PI, 2e-3);
    }
}

/// A white thing in a white world is invisible, however it moves.
#[test]
fn furnaces_stay_white_around_what_moves() {
    let image = picture(
        "integrator = 'path'
        film = { resolution = [24, 24], samples = 16 }
        environment.uniform.radiance = 1
        [camera.perspective]
        position = [0, -4, 1]
        motion = { position = [0.5, -4, 0], up = [0.3, 0, 1] }
        [surfaces.ball]
        sphere = {}
        material = 'white'
        motion = { translate = [0.3, 0.2, 0], rotate_x = 100, scale = 0.5 }
        [surfaces.block]
        box = { min = [-1, -1, -1], max = [0.5, 0, 0] }
        material = 'white'
        motion = { rotate = { axis = [1, 2, 3], angle = 500 } }
        [materials.white.lambert]
        reflectance = 1",
    );
    for pixel in image.pixels() {
        assert!((pixel[1] - 1.0).abs() < 1e-3, "{pixel:?}");
    }
}

/// What is said of a scene that cannot be.
fn complaint(text: &str) -> String {
    let access = FileAccess::beside(Path::new("scene.toml"), &[]);
    let read = scene_file::read(text, "scene.toml", &[], &access, &mut Vec::new());
    read.expect_err("it is refused").to_string()
}

#[test]
fn what_cannot_move_is_refused_with_its_place() {
    let ball = |motion: &str| format!("[surfaces.ball]\nsphere = {{}}\nmotion = {{ {motion} }}");
    let camera = |keys: &str| format!("[camera.perspective]\nposition = [0, -4, 0]\n{keys}");
    let cases = [
        (ball("rotate_x = 3, rotate_y = 4"), "scene.toml:3", "one turn too many"),
        (ball("scale = 0"), "scene.toml:3", "must be between 1e-6 and 1e6, not 0"),
        (ball("scale = -1"), "scene.toml:3", "must be between"),
        (ball("rotate_w = 3"), "scene.toml:3", "unknown"),
        (ball("translate = [1, 2]"), "scene.toml:3", "needs a list of 3 values"),
        (camera("shutter = [0.5, 0.2]"), "scene.toml:3", "[opens, closes]"),
        (camera("shutter = [0, 2]"), "scene.toml:3", "from 0 to 1"),
        (camera("motion = { position = [0, 0, 0] }"), "scene.toml:3", "away from its position"),
        (camera("motion = { up = [0, 1, 0] }"), "scene.toml:3", "along the view direction"),
    ];
    for (text, place, words) in cases {
        let complaint = complaint(&text);
        assert!(complaint.contains(place) && complaint.contains(words), "{complaint}");
    }
}

#[test]
fn a_lamp_that_a_moving_camera_leaves_behind_is_told() {
    let told = |motion: &str| {
        let text = format!(
            "[camera.perspective]\nposition = [0, -4, 0]\n{motion}
            [surfaces.ball.sphere]
            [lights.head.camera]
            irradiance = 1"
        );
        let (access, mut warnings) = (FileAccess::beside(Path::new("a.toml"), &[]), Vec::new());
        scene_file::read(&text, "a.toml", &[], &access, &mut warnings).expect("it is sound");
        warnings.iter().any(|warning| warning.to_string().contains("light \"head\""))
    };
    assert!(told("motion = { position = [1, -4, 0] }") && !told(""));
}
