//! `transform = [...]`: steps from an object's own space to the world.

use super::document::{At, Document};
use crate::diagnostic::Result;
use crate::units::written::{
    Angle, Checked, Direction, LONGEST, Number, Point, SMALLEST, Written, list, schema, written,
};
use glam::{DAffine3, DMat3, DMat4, DQuat, DVec3, DVec4};
use schemars::JsonSchema;
use serde::Deserialize;
use serde::de::{Deserializer, Error};

/// One step; the first in a list is applied first.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(super) enum Step {
    /// Larger or smaller: one factor, or one along each axis.
    Scale(Scale),
    /// A turn about the x axis, anticlockwise seen from its tip.
    RotateX(Angle),
    /// A turn about the y axis, anticlockwise seen from its tip.
    RotateY(Angle),
    /// A turn about the z axis, anticlockwise seen from its tip.
    RotateZ(Angle),
    /// A turn about any axis through the origin.
    Rotate(Rotation),
    /// A shift, m.
    Translate(Point),
    /// Any affine map: 3 rows of 4 numbers (columns x, y, z, shift), or 4 rows, the last 0 0 0 1.
    Matrix(Matrix),
}

/// A turn about an axis.
#[derive(Debug, Clone, Copy, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Rotation {
    /// The axis, through the origin.
    axis: Direction,
    /// Anticlockwise seen from the axis' tip.
    angle: Angle,
}

/// Factors along the three axes; negative ones mirror.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scale(DVec3);

impl Written for Scale {
    const EXPECTED: &'static str = "a factor such as 2, or three such as [1, 1, 2]";
    fn from_number(factor: f64) -> Checked<Self> {
        Self::from_triple([factor; 3])
    }
    fn from_text(text: &str) -> Checked<Self> {
        Number::from_text(text).and_then(|Number(factor)| Self::from_number(factor))
    }
    fn from_triple(factors: [f64; 3]) -> Checked<Self> {
        match factors.iter().find(|factor| !(SMALLEST..=LONGEST).contains(&factor.abs())) {
            Some(0.0) => Err("must not be 0: nothing would be left".into()),
            Some(factor) => {
                Err(format!("must be between {SMALLEST:e} and {LONGEST:e}, not {factor:e}"))
            }
            None => Ok(Self(factors.into())),
        }
    }
}

written! {
    Scale: {
        "anyOf": [
            { "type": "number" },
            { "type": "array", "items": { "type": "number" }, "minItems": 3, "maxItems": 3 }
        ],
        "examples": [2, [1, 1, 2]]
    }
}

/// Rows of an affine map.
#[derive(Debug, Clone, Copy)]
pub(super) struct Matrix(DAffine3);

impl<'de> Deserialize<'de> for Matrix {
    fn deserialize<D: Deserializer<'de>>(source: D) -> std::result::Result<Self, D::Error> {
        let rows = Vec::<Row>::deserialize(source)?;
        let (x, y, z) = match rows.as_slice() {
            [Row(x), Row(y), Row(z)] => (x, y, z),
            [Row(x), Row(y), Row(z), Row(last)] if *last == DVec4::W => (x, y, z),
            [_, _, _, _] => return Err(D::Error::custom("must have 0, 0, 0, 1 as its fourth row")),
            _ => return Err(D::Error::custom("needs 3 or 4 rows of 4 numbers")),
        };
        Ok(Self(DAffine3::from_mat4(DMat4::from_cols(*x, *y, *z, DVec4::W).transpose())))
    }
}

#[derive(Debug, Clone, Copy)]
struct Row(DVec4);

impl<'de> Deserialize<'de> for Row {
    fn deserialize<D: Deserializer<'de>>(source: D) -> std::result::Result<Self, D::Error> {
        list(source).map(|row: [Number; 4]| Self(row.map(|Number(number)| number).into()))
    }
}

schema!(Matrix: {
    "type": "array", "minItems": 3, "maxItems": 4,
    "items": { "type": "array", "items": { "type": "number" }, "minItems": 4, "maxItems": 4 },
    "examples": [[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 5]]]
});

impl Rotation {
    /// The unit vector it turns about.
    pub(super) fn axis(&self) -> DVec3 {
        self.axis.0
    }

    /// How far, rad.
    pub(super) fn angle(&self) -> f64 {
        self.angle.0
    }
}

impl Step {
    fn affine(&self) -> DAffine3 {
        match self {
            Self::Scale(Scale(factors)) => DAffine3::from_scale(*factors),
            Self::RotateX(Angle(angle)) => DAffine3::from_rotation_x(*angle),
            Self::RotateY(Angle(angle)) => DAffine3::from_rotation_y(*angle),
            Self::RotateZ(Angle(angle)) => DAffine3::from_rotation_z(*angle),
            Self::Rotate(Rotation { axis: Direction(axis), angle: Angle(angle) }) => {
                DAffine3::from_quat(DQuat::from_axis_angle(*axis, *angle))
            }
            Self::Translate(Point(shift)) => DAffine3::from_translation(*shift),
            Self::Matrix(Matrix(affine)) => *affine,
        }
    }
}

/// All steps in one map; the identity if there are none.
///
/// # Errors
/// If the map cannot be undone or its numbers leave the range.
pub(super) fn compose(steps: Option<&At<Vec<Step>>>, document: &Document<'_>) -> Result<DAffine3> {
    let Some(At { span, value: steps }) = steps else { return Ok(DAffine3::IDENTITY) };
    let affine = steps.iter().fold(DAffine3::IDENTITY, |before, step| step.affine() * before);
    if !affine.is_finite() || affine.translation.abs().max_element() > LONGEST {
        return Err(document.error(span, "leads out of the range of numbers"));
    }
    if !invertible(affine.matrix3) {
        return Err(document.error(span, "must not flatten what it moves: it cannot be undone"));
    }
    Ok(affine)
}

/// Whether the columns span space, whatever their lengths.
fn invertible(matrix: DMat3) -> bool {
    let columns = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(DVec3::try_normalize);
    let [Some(x), Some(y), Some(z)] = columns else { return false };
    DMat3::from_cols(x, y, z).determinant().abs() > 1e-12 && matrix.inverse().is_finite()
}
