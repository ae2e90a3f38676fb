//! Rays per second of every kind of ray, ours beside Embree's.

use crate::builds;
use crate::embree::{Embree, Mode, Quality, Scene as EmbreeScene, Setup, Width};
use crate::ours::Ours;
use crate::plot;
use crate::race::{Query, Runner, Tracer, race};
use crate::rays::Rays;
use crate::recipe::{Recipe, View, description};
use crate::report::{Agreement, Report, Speeds};
use clap::{Args, ValueEnum};
use firstlight::{BuildQuality, Level, Ray, Scene};
use std::num::NonZeroUsize;
use std::path::PathBuf;

/// What to measure.
#[derive(Debug, Args)]
pub(crate) struct Options {
    /// Trace this model; may be given several times. Without: meshes made on the spot.
    #[arg(long, value_name = "MODEL")]
    mesh: Vec<PathBuf>,
    /// See the model of the same place in order so: eye, target, up, vertical field of view in degrees, light; 13
    /// numbers in the model's coordinates. Without: framed.
    #[arg(long, value_name = "13 NUMBERS", allow_hyphen_values = true)]
    camera: Vec<View>,
    /// Measure only these kinds of work.
    #[arg(long, value_delimiter = ',', default_values = ["build", "camera", "shadow", "bounce", "bounce-any"])]
    only: Vec<Work>,
    /// Numbers of threads to use.
    #[arg(long, value_delimiter = ',', default_values = ["1", "2"])]
    threads: Vec<NonZeroUsize>,
    /// Runs that each median is taken of.
    #[arg(long, default_value = "5")]
    runs: NonZeroUsize,
    /// Embree's library. Without: the one in the Python package `embreex`.
    #[arg(long, value_name = "FILE", env = "FIRSTLIGHT_EMBREE")]
    embree: Option<PathBuf>,
    /// Draw the ratios into this SVG file.
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
}

/// Kinds of work.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Work {
    /// Building the tree.
    Build,
    /// Camera rays, 1024×1024, tile by tile: closest hits.
    Camera,
    /// Rays from what the camera sees to a point light: any hit.
    Shadow,
    /// Rays from what the camera sees, distributed as the cosine: closest hits.
    Bounce,
    /// The same rays, any hit.
    BounceAny,
}

impl Work {
    /// What it is called in tables.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Build => "building",
            Self::Camera => "camera",
            Self::Shadow => "shadow",
            Self::Bounce => "bounce, closest",
            Self::BounceAny => "bounce, any",
        }
    }

    /// The rays of this kind, if there are any, and what is asked about them.
    fn rays(self, rays: &Rays) -> Option<(Query, &[Ray])> {
        let (query, rays) = match self {
            Self::Build => return None,
            Self::Camera => (Query::Closest, &rays.camera),
            Self::Shadow => (Query::Any, &rays.shadow),
            Self::Bounce => (Query::Closest, &rays.bounce),
            Self::BounceAny => (Query::Any, &rays.bounce),
        };
        (!rays.is_empty()).then_some((query, rays))
    }
}

/// Said when there is nothing to compare with.
const NO_EMBREE: &str = "Embree is not measured: python3 knows no package embreex (pip install embreex), and no \
                         --embree names its library.";

/// Measures and prints it all.
///
/// # Errors
/// If a mesh or Embree cannot be loaded or the plot not be written.
pub(crate) fn run(options: &Options) -> Result<(), String> {
    let recipes = recipes(options)?;
    let embree = Embree::find(options.embree.as_deref())?;
    if embree.is_none() {
        println!("{NO_EMBREE}\n");
    }
    let embree = embree.as_ref();
    if options.only.contains(&Work::Build) {
        builds::run(&recipes, embree, &options.threads, options.runs.get())?;
    }
    let mut report = Report::default();
    for recipe in &recipes {
        trace(recipe, embree, options, &mut report)?;
    }
    report.finish();
    options.plot.as_ref().map_or(Ok(()), |path| plot::write(path, &report))
}

fn recipes(options: &Options) -> Result<Vec<Recipe>, String> {
    if options.mesh.is_empty() {
        return Ok(Recipe::generated());
    }
    let view = |i: usize| options.camera.get(i).copied();
    options.mesh.iter().enumerate().map(|(i, path)| Recipe::of_file(path, view(i))).collect()
}

/// Measures all kinds of rays of one recipe.
fn trace(
    recipe: &Recipe,
    embree: Option<&Embree>,
    options: &Options,
    report: &mut Report,
) -> Result<(), String> {
    let described = description(recipe.mesh.clone());
    let built = |level| (level, Scene::build_with(&described, level, BuildQuality::Final));
    let ours: Vec<_> = Level::all().into_iter().map(built).collect();
    let theirs = embree.map_or(Ok(Vec::new()), |embree| embree_scenes(embree, recipe))?;
    let all = Rays::of(recipe, &ours[0].1);
    for &work in &options.only {
        let Some((query, rays)) = work.rays(&all) else { continue };
        for threads in options.threads.iter().map(|threads| threads.get()) {
            let mut teams: Vec<_> = ours.iter().map(our_team).collect();
            teams.extend(theirs.iter().map(|scenes| embree_team(scenes)));
            race(&mut teams, query, rays, threads, options.runs.get());
            let best = |team: &Vec<Runner<'_>>| (team[0].name.clone(), team[0].mrays(rays.len()));
            let mut levels: Vec<_> = teams.iter().map(best).collect();
            let embree = levels.split_off(ours.len());
            report.add(Speeds { mesh: recipe.name.clone(), work, threads, levels, embree });
        }
        let distances = Ours(&ours[ours.len() - 1].1).distances_of(query, rays);
        report.agreements.extend(theirs.iter().map(|scenes| {
            let mode = Mode { scene: &scenes[0], width: Width::One, coherent: false };
            let theirs = mode.distances_of(query, rays);
            Agreement::new(&recipe.name, work, scenes[0].setup(), &distances, &theirs)
        }));
    }
    Ok(())
}

fn our_team((level, scene): &(Level, Scene)) -> Vec<Runner<'_>> {
    vec![Runner::new(level.name(), Ours(scene))]
}

/// Embree's trees: those of its usual and those of its watertight mode, each 128 and 256 bits wide.
fn embree_scenes<'a>(
    embree: &'a Embree,
    recipe: &'a Recipe,
) -> Result<Vec<[EmbreeScene<'a>; 2]>, String> {
    let build = |robust, simd256| {
        let setup = Setup { quality: Quality::High, robust, simd256 };
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        EmbreeScene::build(embree, &recipe.mesh, setup, threads)
    };
    let widths = |robust| Ok([build(robust, false)?, build(robust, true)?]);
    [false, true].into_iter().map(widths).collect()
}

/// Every way to ask Embree.
fn embree_team<'a>(scenes: &'a [EmbreeScene<'a>; 2]) -> Vec<Runner<'a>> {
    let mut team = Vec::new();
    for scene in scenes {
        team.push(Mode { scene, width: Width::One, coherent: false });
        for (width, coherent) in [
            (Width::Eight, false),
            (Width::Eight, true),
            (Width::Sixteen, false),
            (Width::Sixteen, true),
        ] {
            team.push(Mode { scene, width, coherent });
        }
    }
    team.into_iter().map(|mode| Runner::new(mode.name(), mode)).collect()
}
