//! Shadows without acne, leaks or facets at every scale and place, and the settings that show the blunder.

mod common;

use common::*;
use firstlight::render::{RenderOptions, Stop, render};
use firstlight::scene::description::*;
use firstlight::{BuildQuality, Image, Level, Scene, SceneDescription};
use glam::{DVec3, Vec3};
use std::ops::ControlFlow;

/// The test of case G03 sees the lecture's blunder, and what its cures with a fixed length do at the wrong scale.
#[test]
fn the_naive_setting_fails_the_same_test() {
    let acne = |shadows: Shadows, exponent: i32| {
        let scene = with_light_at_the_eye(SceneDescription { shadows, ..assortment() });
        let scene = moved(&scene, 10_f64.powi(exponent), DVec3::ZERO);
        let unshadowed = SceneDescription { shadows: Shadows::Off, ..scene.clone() };
        differing(&picture(&scene).image, &picture(&unshadowed).image)
    };
    assert!(acne(Shadows::Naive, 0) > 500);
    for cure in [Shadows::TRange { epsilon: 1e-3 }, Shadows::MovedStart { epsilon: 1e-3 }] {
        assert!(acne(cure, 0) < 5, "{cure:?} cures a scene of metres, all but specks");
        assert!(acne(cure, 6) > 500, "{cure:?} is too short for a scene of 1000 km");
    }
}

/// Without the cure of case G07, 1/(2n) of the lit half of an n-gon is black, less the sliver that the test leaves out.
#[test]
fn shadows_without_the_cure_have_terminator_steps() {
    for n in [10, 14, 30, 64] {
        let (black, _) = terminator(n, Shadows::TRange { epsilon: 1e-4 });
        assert!((black - 0.5 / f64::from(n)).abs() < 0.01, "{n} facets: {black}");
        assert!(black > 0.0);
    }
}

/// The bits of the linear picture (FNV-1a).
fn hash(image: &Image) -> u64 {
    let bytes = image.pixels().iter().flatten().flat_map(|x| x.to_bits().to_le_bytes());
    bytes.fold(0xcbf2_9ce4_8422_2325, |h, b| (h ^ u64::from(b)).wrapping_mul(0x100_0000_01b3))
}

#[test]
fn any_number_of_threads_and_any_level_give_the_same_bits() {
    let mut scene = assortment();
    light(&mut scene, Light::Point { position: v(2.0, -3.0, 5.0), intensity: Vec3::splat(30.0) });
    scene.film.samples = 6;
    let rendered = |threads: usize, level: Level| {
        let options = RenderOptions { threads, ..RenderOptions::default() };
        let scene = Scene::build_with(&scene, level, BuildQuality::Final);
        hash(&render(&scene, &options, &|_| ControlFlow::Continue(())).image)
    };
    let expected = rendered(1, Level::detect());
    for threads in [2, 3, 7] {
        assert_eq!(rendered(threads, Level::detect()), expected, "{threads} threads");
    }
    for level in Level::all() {
        assert_eq!(rendered(2, level), expected, "{level:?}");
    }
}

/// A crop is the same rectangle of the whole picture, bit for bit.
#[test]
fn a_crop_is_a_part_of_the_picture() {
    use firstlight::render::Crop;
    let mut scene = with_light_at_the_eye(assortment());
    scene.film.samples = 5;
    let scene = Scene::build(&scene);
    let crop = Crop { x: 17, y: 9, width: 50, height: 41 };
    let options = RenderOptions { crop: Some(crop), ..RenderOptions::default() };
    let part = render(&scene, &options, &|_| ControlFlow::Continue(())).image;
    let whole = render(&scene, &RenderOptions::default(), &|_| ControlFlow::Continue(())).image;
    for y in 0..crop.height {
        for x in 0..crop.width {
            assert_eq!(part.get(x, y), whole.get(x + crop.x, y + crop.y));
        }
    }
}

/// Breaking off leaves the tiles that were done, and says so.
#[test]
fn an_interrupted_render_keeps_what_was_done() {
    let scene = Scene::build(&with_light_at_the_eye(assortment()));
    let options = RenderOptions { threads: 1, ..RenderOptions::default() };
    let stopped = render(&scene, &options, &|_| ControlFlow::Break(Stop::Now));
    assert!(stopped.interrupted && stopped.samples == 0);
    let done = stopped.image.pixels().iter().filter(|p| p[3] == 1.0).count();
    assert!(done > 0 && done < 96 * 72, "one tile of {done} pixels");
}
