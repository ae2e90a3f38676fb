//! `motion = { ... }`: what moves while the shutter is open.

use super::document::{At, Document};
use super::transform::Rotation;
use crate::diagnostic::Result;
use crate::scene::description::Motion;
use crate::units::written::{Angle, Checked, Number, Pair, Point, Written, written};
use glam::DVec3;
use schemars::JsonSchema;
use serde::Deserialize;

/// What a surface, model or instance does while the scene's time runs from 0 to 1, at even speed.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub(super) struct MotionKeys {
    /// How far it goes, m.
    translate: Option<Point>,
    /// How far it turns about an axis; any number of turns.
    rotate: Option<At<Rotation>>,
    /// How far it turns about the x axis.
    rotate_x: Option<At<Angle>>,
    /// How far it turns about the y axis.
    rotate_y: Option<At<Angle>>,
    /// How far it turns about the z axis.
    rotate_z: Option<At<Angle>>,
    /// How many times as large it becomes.
    scale: Option<Growth>,
    /// The point, where it is at time 0, about which it turns and grows, m. Default: its middle.
    about: Option<Point>,
}

impl At<MotionKeys> {
    /// The motion of what has its middle there; `None` if nothing happens.
    pub(super) fn describe(
        &self,
        middle: DVec3,
        document: &Document<'_>,
    ) -> Result<Option<Motion>> {
        let keys = &self.value;
        let about = |axis: DVec3, turn: &Option<At<Angle>>| {
            turn.as_ref().map(|At { span, value: Angle(angle) }| (span.clone(), axis, *angle))
        };
        let free = |At { span, value }: &At<Rotation>| (span.clone(), value.axis(), value.angle());
        let turns = [
            keys.rotate.as_ref().map(free),
            about(DVec3::X, &keys.rotate_x),
            about(DVec3::Y, &keys.rotate_y),
            about(DVec3::Z, &keys.rotate_z),
        ];
        let mut turns = turns.into_iter().flatten();
        let (_, axis, angle) = turns.next().unwrap_or((0..0, DVec3::Z, 0.0));
        if let Some((second, ..)) = turns.next() {
            return Err(document.error(&second, "is one turn too many: there is one axis"));
        }
        let motion = Motion {
            pivot: keys.about.map_or(middle, |Point(point)| point),
            axis,
            angle,
            growth: keys.scale.map_or(1.0, |Growth(factor)| factor),
            shift: keys.translate.map_or(DVec3::ZERO, |Point(shift)| shift),
        };
        Ok((!motion.is_still()).then_some(motion))
    }
}

/// When a shutter opens and closes.
pub(super) fn shutter(shutter: Option<&At<Pair>>, document: &Document<'_>) -> Result<[f64; 2]> {
    let Some(At { span, value: Pair(pair) }) = shutter else { return Ok([0.0, 1.0]) };
    let [opens, closes] = pair.to_array();
    if 0.0 <= opens && opens <= closes && closes <= 1.0 {
        return Ok([opens, closes]);
    }
    let message = "needs [opens, closes], parts of the scene's time from 0 to 1, the first not after the second";
    Err(document.error(span, message))
}

/// How many times as large something becomes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Growth(f64);

impl Written for Growth {
    const EXPECTED: &'static str = "a factor such as 2";
    fn from_number(factor: f64) -> Checked<Self> {
        const SMALLEST: f64 = 1e-6;
        if (SMALLEST..=1.0 / SMALLEST).contains(&factor) {
            return Ok(Self(factor));
        }
        Err(format!("must be between {SMALLEST:e} and {:e}, not {factor}", 1.0 / SMALLEST))
    }
    fn from_text(text: &str) -> Checked<Self> {
        Number::from_text(text).and_then(|Number(factor)| Self::from_number(factor))
    }
}

written! {
    Growth: { "type": "number", "exclusiveMinimum": 0, "examples": [1.2] }
}
