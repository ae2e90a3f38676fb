//! Several tracers over the same rays, in turns, on the clock.

use firstlight::{Hit, Ray};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::time::{Duration, Instant};

/// Rays of one call: what a renderer's tile has at once.
const BATCH: usize = 4096;
/// Runs before the final.
const HEATS: usize = 2;
/// Tracers slower than the fastest by more than this factor in the heats do not run in the final.
const CLOSE: f64 = 1.25;

/// What is asked about a ray.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Query {
    /// The first thing it hits.
    Closest,
    /// Whether it hits anything.
    Any,
}

/// What tracers write; each uses the parts that it answers in without converting.
#[derive(Default)]
pub(crate) struct Answers {
    /// Closest hits.
    pub(crate) hits: Vec<Hit>,
    /// Whether something is in the way.
    pub(crate) occluded: Vec<bool>,
    /// Distances; infinite: nothing is hit.
    pub(crate) t: Vec<f32>,
}

/// Something that answers rays.
pub(crate) trait Tracer: Sync {
    /// Answers a batch; this is timed.
    fn trace(&self, query: Query, rays: &[Ray], answers: &mut Answers);

    /// The distance of each ray's hit, infinite without; 0 if anything is in the way.
    fn distances(&self, query: Query, answers: &Answers) -> Vec<f32>;

    /// Traces `rays` and tells the distances.
    fn distances_of(&self, query: Query, rays: &[Ray]) -> Vec<f32> {
        let mut answers = Answers::default();
        self.trace(query, rays, &mut answers);
        self.distances(query, &answers)
    }
}

/// A tracer with its name and how long it took.
pub(crate) struct Runner<'a> {
    /// What to call it.
    pub(crate) name: String,
    tracer: Box<dyn Tracer + 'a>,
    times: Vec<Duration>,
}

impl<'a> Runner<'a> {
    /// A tracer that has not run yet.
    pub(crate) fn new(name: impl Into<String>, tracer: impl Tracer + 'a) -> Self {
        Self { name: name.into(), tracer: Box::new(tracer), times: Vec::new() }
    }

    /// Millions of rays per second, median of its runs.
    pub(crate) fn mrays(&self, rays: usize) -> f64 {
        rays as f64 * 1e-6 / median(&self.times).as_secs_f64()
    }
}

/// Times all `teams` over `rays`. First there are heats; then the fastest of each team and those close to it run
/// `runs` times, in turns, so that whatever else the machine does hits all alike. What is left of each team is
/// sorted, the fastest first.
pub(crate) fn race(
    teams: &mut [Vec<Runner<'_>>],
    query: Query,
    rays: &[Ray],
    threads: usize,
    runs: usize,
) {
    run(teams, query, rays, threads, HEATS);
    teams.iter_mut().for_each(keep_fast);
    run(teams, query, rays, threads, runs);
    for team in teams {
        team.sort_by_key(|runner| median(&runner.times));
    }
}

/// Everybody runs, in turns, as often as told.
fn run(teams: &mut [Vec<Runner<'_>>], query: Query, rays: &[Ray], threads: usize, runs: usize) {
    for _ in 0..runs {
        for runner in teams.iter_mut().flatten() {
            runner.times.push(timed(&*runner.tracer, query, rays, threads));
        }
    }
}

/// Sends those home whose best time in the heats is far from the best of their team.
fn keep_fast(team: &mut Vec<Runner<'_>>) {
    let best = |runner: &Runner<'_>| runner.times.iter().min().copied().unwrap_or_default();
    let fastest = team.iter().map(best).min().unwrap_or_default();
    team.retain(|runner| best(runner) <= fastest.mul_f64(CLOSE));
    team.iter_mut().for_each(|runner| runner.times.clear());
}

/// How long a tracer takes over all rays; threads take batches from a common counter.
fn timed(tracer: &dyn Tracer, query: Query, rays: &[Ray], threads: usize) -> Duration {
    let next = AtomicUsize::new(0);
    let work = || {
        let mut answers = Answers::default();
        while let Some(batch) = rays.chunks(BATCH).nth(next.fetch_add(1, Relaxed)) {
            tracer.trace(query, batch, &mut answers);
        }
    };
    let start = Instant::now();
    std::thread::scope(|scope| (0..threads).for_each(|_| drop(scope.spawn(work))));
    start.elapsed()
}

/// The middle one of some times.
pub(crate) fn median(times: &[Duration]) -> Duration {
    let mut sorted = times.to_vec();
    sorted.sort();
    sorted.get(sorted.len() / 2).copied().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use std::sync::Mutex;

    /// Remembers which rays it was given.
    struct Witness(Mutex<Vec<f32>>);

    impl Tracer for &Witness {
        fn trace(&self, _: Query, rays: &[Ray], _: &mut Answers) {
            self.0.lock().unwrap().extend(rays.iter().map(|ray| ray.t_min));
        }

        fn distances(&self, _: Query, _: &Answers) -> Vec<f32> {
            Vec::new()
        }
    }

    #[test]
    fn threads_share_all_rays_out_among_themselves() {
        let ray = |i: u16| Ray { t_min: f32::from(i), ..Ray::new(Vec3::ZERO, Vec3::X) };
        let rays: Vec<_> = (0..10_000).map(ray).collect();
        let witness = Witness(Mutex::default());
        timed(&&witness, Query::Any, &rays, 3);
        let mut seen = witness.0.into_inner().unwrap();
        seen.sort_by(f32::total_cmp);
        assert!(seen.iter().zip(&rays).all(|(seen, ray)| *seen == ray.t_min));
        assert_eq!(seen.len(), rays.len());
    }

    #[test]
    fn the_median_is_the_middle() {
        let times = [5, 1, 100].map(Duration::from_secs);
        assert_eq!(median(&times), Duration::from_secs(5));
    }
}
