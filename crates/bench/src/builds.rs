//! How long trees take to build and how large they are, ours beside Embree's.

use crate::embree::{Embree, Quality, Scene as EmbreeScene, Setup};
use crate::race::median;
use crate::recipe::{Recipe, description};
use crate::report::{print_head, print_row};
use firstlight::render::with_threads;
use firstlight::{BuildQuality, Level, Scene, SceneDescription};
use std::num::NonZeroUsize;
use std::time::{Duration, Instant};

/// Our builds, with their names.
const OURS: [(&str, BuildQuality); 2] =
    [("ours, preview", BuildQuality::Preview), ("ours, final", BuildQuality::Final)];

/// Embree's builds that are compared, with their names.
const EMBREE: [(&str, Setup); 3] = [
    ("medium", Setup { quality: Quality::Medium, robust: false, simd256: false }),
    ("high", Setup { quality: Quality::High, robust: false, simd256: false }),
    ("high, robust", Setup { quality: Quality::High, robust: true, simd256: false }),
];

/// One builder's runs on one mesh.
#[derive(Default)]
struct Builds {
    times: Vec<Duration>,
    /// Bytes of the tree; for Embree also at the peak of building.
    bytes: Vec<usize>,
}

impl Builds {
    fn cells(&self, triangles: usize) -> [String; 2] {
        let bytes = self.bytes.iter().map(|b| format!("{:.1}", *b as f64 / triangles as f64));
        let bytes = bytes.collect::<Vec<_>>().join(" / ");
        [format!("{:.3}", median(&self.times).as_secs_f64()), bytes]
    }
}

/// Builds every recipe's tree with every builder, in turns, and prints medians.
///
/// # Errors
/// If Embree fails.
pub(crate) fn run(
    recipes: &[Recipe],
    embree: Option<&Embree>,
    threads: &[NonZeroUsize],
    runs: usize,
) -> Result<(), String> {
    println!("Building: seconds, medians; bytes per triangle, for Embree at rest / at the peak.\n");
    let names = embree.into_iter().flat_map(|_| EMBREE).map(|(name, _)| format!("Embree {name}"));
    let mut head = ["mesh", "triangles", "threads"].map(String::from).to_vec();
    for name in OURS.map(|(name, _)| name.into()).into_iter().chain(names) {
        head.extend([name, "bytes".into()]);
    }
    print_head(&head);
    for recipe in recipes {
        let described = description(recipe.mesh.clone());
        for threads in threads.iter().map(|threads| threads.get()) {
            let builds = race(recipe, &described, embree, threads, runs)?;
            let triangles = recipe.mesh.triangles.len();
            let mut cells = vec![recipe.name.clone(), triangles.to_string(), threads.to_string()];
            cells.extend(builds.iter().flat_map(|builds| builds.cells(triangles)));
            print_row(&cells);
        }
    }
    println!();
    Ok(())
}

/// All builders in turns: ours first, then Embree's.
fn race(
    recipe: &Recipe,
    described: &SceneDescription,
    embree: Option<&Embree>,
    threads: usize,
    runs: usize,
) -> Result<Vec<Builds>, String> {
    let mut all: Vec<_> = OURS.map(|_| Builds::default()).into();
    all.extend(embree.into_iter().flat_map(|_| EMBREE).map(|_| Builds::default()));
    for _ in 0..runs {
        for (builds, (_, quality)) in all.iter_mut().zip(OURS) {
            let (time, bytes) = build_ours(described, quality, threads);
            builds.times.push(time);
            builds.bytes = vec![bytes];
        }
        let Some(embree) = embree else { continue };
        for (builds, (_, setup)) in all[OURS.len()..].iter_mut().zip(EMBREE) {
            let scene = EmbreeScene::build(embree, &recipe.mesh, setup, threads)?;
            builds.times.push(scene.build_time());
            builds.bytes = scene.memory().to_vec();
        }
    }
    Ok(all)
}

fn build_ours(
    described: &SceneDescription,
    quality: BuildQuality,
    threads: usize,
) -> (Duration, usize) {
    with_threads(threads, || {
        let start = Instant::now();
        let scene = Scene::build_with(described, Level::detect(), quality);
        (start.elapsed(), scene.tree_memory())
    })
}
