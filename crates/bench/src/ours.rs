//! Firstlight in the race.

use crate::race::{Answers, Query, Tracer};
use firstlight::{Ray, Scene};

/// A scene as its library answers rays.
pub(crate) struct Ours<'a>(pub(crate) &'a Scene);

impl Tracer for Ours<'_> {
    fn trace(&self, query: Query, rays: &[Ray], answers: &mut Answers) {
        match query {
            Query::Closest => self.0.closest_hits(rays, &mut answers.hits),
            Query::Any => self.0.occluded(rays, &mut answers.occluded),
        }
    }

    fn distances(&self, query: Query, answers: &Answers) -> Vec<f32> {
        match query {
            Query::Closest => {
                let distance =
                    |hit: &firstlight::Hit| if hit.is_some() { hit.t } else { f32::INFINITY };
                answers.hits.iter().map(distance).collect()
            }
            Query::Any => {
                let distance = |&hit: &bool| if hit { 0.0 } else { f32::INFINITY };
                answers.occluded.iter().map(distance).collect()
            }
        }
    }
}
