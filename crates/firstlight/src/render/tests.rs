//! Samples that go where the noise is.

use super::*;
use crate::color::Rgb;
use crate::scene::description::{Alpha, Integrator, Projection, SceneDescription};
use crate::verify::scenes::*;
use glam::DVec3;

/// A picture of 2 × 2 tiles that is filled by a sheet of which one part in `rarity` is there, and so bright that its mean
/// is 1.
fn fireflies(rarity: f32) -> SceneDescription {
    let mut scene = scene_for_paths(0.0);
    scene.integrator = Integrator::Path { bounces: Some(0) };
    let mut sheet = emitter(rarity, 0.0);
    sheet.alpha = Alpha::Blend;
    sheet.reflectance.factor[3] = 1.0 / rarity;
    scene.materials[0] = sheet;
    add(&mut scene, panel(DVec3::Z, 4.0, 4.0));
    let view = Projection::Orthographic { height: 1.0 };
    scene.cameras.push(camera(DVec3::ZERO, DVec3::Z, view));
    scene.film = FilmDescription { width: 32, height: 32, ..scene.film };
    scene
}

/// The picture after so many passes.
fn after(scene: &Scene, passes: u32, threads: usize, judge: fn(Half) -> Half) -> Rendered {
    let options = RenderOptions { endless: true, ..RenderOptions::default() };
    let go_on = |_| ControlFlow::Continue(());
    let render = Render::new(scene, &options, &go_on);
    with_threads(threads, || Render { judge, samples: [0, passes * PASS], ..render }.run::<()>().0)
}

/// How many standard errors the mean of pictures of many seeds is from 1, where samples follow what `judge` has seen.
fn z_of_fireflies(judge: fn(Half) -> Half) -> f64 {
    const SEEDS: u32 = 250;
    let mut description = fireflies(2000.0);
    let means = (0..SEEDS).map(|seed| {
        description.film.seed = seed.into();
        let rendered = after(&Scene::build(&description), 24, 1, judge);
        rendered.noise.map_or(0.0, |noise| noise.mean)
    });
    let means: Vec<f64> = means.collect();
    let n = f64::from(SEEDS);
    let mean = means.iter().sum::<f64>() / n;
    let variance = means.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean - 1.0) / (variance / n).sqrt()
}

/// A half that decided about itself would stop looking where nothing has been found yet.
#[test]
fn fireflies_count_in_full_where_halves_decide_about_each_other() {
    let z = z_of_fireflies(Half::other);
    assert!(z.abs() < 4.0, "{z}");
    let naive = z_of_fireflies(|half| half);
    assert!(naive < -8.0, "{naive}");
}

/// Fireflies in one tile of four: it gets most of the samples.
#[test]
fn samples_go_where_the_noise_is() {
    let mut description = fireflies(8.0);
    description.surfaces.clear();
    add(&mut description, panel(v(0.25, 0.25, 1.0), 0.5, 0.5));
    description.background = Rgb::ONE;
    let scene = Scene::build(&description);
    let aimed = after(&scene, 48, 1, Half::other);
    let Spread { fewest, mean, most } = aimed.spread;
    assert!(most > 6 * fewest && f64::from(most) > 2.0 * mean, "{:?}", aimed.spread);
    // The quiet tiles still get what all get: a quarter of the rounds.
    assert!(fewest >= 48, "{fewest}");
}

#[test]
fn threads_do_not_change_where_samples_go() {
    let scene = Scene::build(&fireflies(50.0));
    let [one, many] = [1, 3].map(|threads| after(&scene, 30, threads, Half::other));
    assert_eq!(one.image.pixels(), many.image.pixels());
    assert_eq!(one.spread, many.spread);
    assert!(one.spread.most > one.spread.fewest, "{:?}", one.spread);
}

/// What is kept and what is said to be removed are all that there was; light that was scattered once stays as it is.
#[test]
fn clamping_says_what_it_removes() {
    let mut description = scene_for_paths(0.8);
    description.materials[0] = glowing(1.0, 0.8);
    add(&mut description, cube(DVec3::ZERO, 2.0));
    let view = Projection::Perspective { vertical_fov: 1.0 };
    description.cameras.push(camera(DVec3::ZERO, DVec3::X, view));
    description.film = FilmDescription { width: 16, height: 16, samples: 64, ..description.film };
    let mut seen = |clamp: Option<f64>, bounces: Option<u32>| {
        description.integrator = Integrator::Path { bounces };
        description.film.clamp = clamp;
        let rendered = picture(&description);
        (rendered.noise.map_or(0.0, |noise| noise.mean), rendered.clamped)
    };
    let (all, none) = seen(None, None);
    assert_eq!(none, 0.0);
    let (once, nothing) = seen(Some(1e-9), Some(1));
    assert_eq!((once, nothing), (seen(None, Some(1)).0, 0.0));
    let (kept, removed) = seen(Some(0.1), None);
    assert!(removed > 0.05 && kept > once, "{removed} {kept}");
    assert!((kept / (1.0 - removed) / all - 1.0).abs() < 1e-5, "{kept} {removed} {all}");
    let (least, most) = seen(Some(1e-9), None);
    assert!((least / once - 1.0).abs() < 1e-5 && most > removed, "{least} {once} {most}");
}
