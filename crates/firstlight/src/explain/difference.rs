//! What makes two pixels differ.

use super::{Explanation, luminance_of};
use serde::Serialize;

/// A term of which two pixels have different amounts.
#[derive(Debug, Clone, Serialize)]
pub struct Difference {
    /// The light, emitting surface or whatever else it comes from.
    pub source: String,
    /// Scatterings between there and the eye.
    pub reflections: u32,
    /// What the second pixel has more of it than the first, W·sr⁻¹·m⁻².
    pub radiance: [f64; 3],
    /// Its part of all the difference in luminance; negative where it makes up for others. 0 if they are equally bright.
    pub share: f64,
}

/// What the second pixel has more than the first, term by term, the largest difference first.
pub fn differences(first: &Explanation, second: &Explanation) -> Vec<Difference> {
    let mut keys: Vec<_> =
        first.terms.iter().chain(&second.terms).map(|term| (term.key, &term.source)).collect();
    keys.sort();
    keys.dedup();
    let of = |explanation: &Explanation, key| {
        let term = explanation.terms.iter().find(|term| term.key == key);
        term.map_or([0.0; 3], |term| term.radiance)
    };
    let difference = |(key, source): ((_, u32), &String)| {
        let (a, b) = (of(first, key), of(second, key));
        let radiance = std::array::from_fn(|channel| b[channel] - a[channel]);
        Difference { source: source.clone(), reflections: key.1, radiance, share: 0.0 }
    };
    let mut all: Vec<_> = keys.into_iter().map(difference).collect();
    let whole: f64 = all.iter().map(|difference| luminance_of(difference.radiance)).sum();
    for difference in &mut all {
        let own = luminance_of(difference.radiance);
        difference.share = if whole == 0.0 { 0.0 } else { own / whole };
    }
    let size = |difference: &Difference| luminance_of(difference.radiance).abs();
    all.sort_by(|a, b| size(b).total_cmp(&size(a)));
    all
}
