//! What tests have in common.
#![allow(dead_code, unused_imports, reason = "each test file uses its part")]

pub(crate) use firstlight::verify::scenes::*;
pub(crate) use firstlight::verify::{Random, differing, escaped, reintersections, terminator};

#[track_caller]
pub(crate) fn close(value: impl Into<f64>, expected: f64, relative: f64) {
    let value = value.into();
    let error = if expected == 0.0 { value.abs() } else { (value / expected - 1.0).abs() };
    assert!(error <= relative, "{value} is not {expected} within {relative}: off by {error:e}");
}
