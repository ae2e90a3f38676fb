//! `[camera.perspective]` and its sisters.

use super::document::{At, Document, Span};
use crate::diagnostic::Result;
use crate::io::model::UpAxis;
use crate::scene::description::{CameraDescription, Projection};
use crate::units::written::{Angle, Direction, Point, Size};
use glam::DVec3;
use schemars::JsonSchema;
use serde::Deserialize;
use std::f64::consts::PI;

/// A camera of one kind.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(super) enum CameraKeys {
    /// A pinhole: things get smaller with distance.
    Perspective(PerspectiveKeys),
    /// Parallel rays: things keep their size.
    Orthographic(OrthographicKeys),
    /// A round lens: sharp at one distance.
    ThinLens(ThinLensKeys),
}

/// A pinhole camera.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct PerspectiveKeys {
    /// Where it is, m.
    position: Point,
    /// The point it looks at, m. Default [0, 0, 0].
    target: Option<At<Point>>,
    /// What is up in the picture. Default: the scene's `up`.
    up: Option<At<Direction>>,
    /// Vertical field of view, between 0 and 180 degrees. Default 40.
    fov: Option<At<Angle>>,
}

/// A camera with parallel rays.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct OrthographicKeys {
    /// Where it is, m.
    position: Point,
    /// The point it looks at, m. Default [0, 0, 0].
    target: Option<At<Point>>,
    /// What is up in the picture. Default: the scene's `up`.
    up: Option<At<Direction>>,
    /// Height of what is seen, m.
    height: Size,
}

/// A camera with a round lens.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ThinLensKeys {
    /// Where it is, m.
    position: Point,
    /// The point it looks at, m. Default [0, 0, 0].
    target: Option<At<Point>>,
    /// What is up in the picture. Default: the scene's `up`.
    up: Option<At<Direction>>,
    /// Vertical field of view, between 0 and 180 degrees. Default 40.
    fov: Option<At<Angle>>,
    /// Diameter of the lens, m.
    aperture: Size,
    /// Distance along the view direction that is sharp, m. Default: that of the target.
    focus_distance: Option<Size>,
}

/// Where a camera is and looks, whatever its kind.
struct View {
    position: DVec3,
    target: Option<At<Point>>,
    up: Option<At<Direction>>,
}

impl At<CameraKeys> {
    /// The camera in a world where `world_up` is up.
    pub(super) fn describe(
        self,
        name: &str,
        world_up: UpAxis,
        document: &Document<'_>,
    ) -> Result<CameraDescription> {
        let (view, projection) = match self.value {
            CameraKeys::Perspective(PerspectiveKeys { position, target, up, fov }) => {
                let vertical_fov = vertical_fov(fov, document)?;
                (
                    View { position: position.0, target, up },
                    Projection::Perspective { vertical_fov },
                )
            }
            CameraKeys::Orthographic(OrthographicKeys { position, target, up, height }) => {
                let projection = Projection::Orthographic { height: height.0 };
                (View { position: position.0, target, up }, projection)
            }
            CameraKeys::ThinLens(keys) => {
                let ThinLensKeys { position: Point(position), target, up, .. } = keys;
                let to_target = target.as_ref().map_or(DVec3::ZERO, |at| at.value.0) - position;
                let projection = Projection::ThinLens {
                    vertical_fov: vertical_fov(keys.fov, document)?,
                    aperture: keys.aperture.0,
                    focus_distance: keys.focus_distance.map_or(to_target.length(), |size| size.0),
                };
                (View { position, target, up }, projection)
            }
        };
        view.describe(name, projection, world_up, document, &self.span)
    }
}

impl View {
    fn describe(
        self,
        name: &str,
        projection: Projection,
        world_up: UpAxis,
        document: &Document<'_>,
        camera: &Span,
    ) -> Result<CameraDescription> {
        let span = self.target.as_ref().map_or(camera, |at| &at.span);
        let target = self.target.as_ref().map_or(DVec3::ZERO, |at| at.value.0);
        let Some(forward) = (target - self.position).try_normalize() else {
            return Err(document.error(span, "needs a target away from its position"));
        };
        let up = match self.up {
            Some(up) if parallel(up.value.0, forward) => {
                return Err(document.error(&up.span, "must not point along the view direction"));
            }
            Some(up) => up.value.0,
            None if parallel(world_up.direction(), forward) => world_up.north(),
            None => world_up.direction(),
        };
        Ok(CameraDescription { name: name.into(), position: self.position, target, up, projection })
    }
}

fn parallel(a: DVec3, b: DVec3) -> bool {
    a.cross(b).length() < 1e-9
}

fn vertical_fov(fov: Option<At<Angle>>, document: &Document<'_>) -> Result<f64> {
    let Some(At { span, value: Angle(angle) }) = fov else { return Ok(40_f64.to_radians()) };
    if angle > 0.0 && angle < PI {
        return Ok(angle);
    }
    Err(document.error(&span, format!("must be between 0° and 180°, not {}°", angle.to_degrees())))
}
