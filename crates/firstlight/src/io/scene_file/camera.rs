//! `[camera.perspective]` and its sisters.

use super::document::{At, Document, Span};
use super::motion;
use crate::diagnostic::Result;
use crate::io::model::UpAxis;
use crate::scene::description::{CameraDescription, CameraPose, Projection};
use crate::units::written::{Angle, Direction, Pair, Point, Size};
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
    /// When the shutter opens and closes, as parts of the scene's time. Default [0, 1].
    shutter: Option<At<Pair>>,
    /// Where it has got to when the scene's time ends. Default: it stands still.
    motion: Option<At<PoseKeys>>,
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
    /// When the shutter opens and closes, as parts of the scene's time. Default [0, 1].
    shutter: Option<At<Pair>>,
    /// Where it has got to when the scene's time ends. Default: it stands still.
    motion: Option<At<PoseKeys>>,
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
    /// When the shutter opens and closes, as parts of the scene's time. Default [0, 1].
    shutter: Option<At<Pair>>,
    /// Where it has got to when the scene's time ends. Default: it stands still.
    motion: Option<At<PoseKeys>>,
}

/// Where a camera has got to; what is not given stays as it is.
#[derive(Debug, Clone, Copy, Default, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub(super) struct PoseKeys {
    /// Where it is, m.
    position: Option<Point>,
    /// The point it looks at, m.
    target: Option<Point>,
    /// What is up in the picture.
    up: Option<Direction>,
}

/// Where a camera is and looks, whatever its kind.
struct View {
    position: DVec3,
    target: Option<At<Point>>,
    up: Option<At<Direction>>,
    shutter: Option<At<Pair>>,
    motion: Option<At<PoseKeys>>,
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
            CameraKeys::Perspective(keys) => {
                let vertical_fov = vertical_fov(keys.fov, document)?;
                let PerspectiveKeys {
                    position: Point(position), target, up, shutter, motion, ..
                } = keys;
                (
                    View { position, target, up, shutter, motion },
                    Projection::Perspective { vertical_fov },
                )
            }
            CameraKeys::Orthographic(keys) => {
                let projection = Projection::Orthographic { height: keys.height.0 };
                let OrthographicKeys {
                    position: Point(position), target, up, shutter, motion, ..
                } = keys;
                (View { position, target, up, shutter, motion }, projection)
            }
            CameraKeys::ThinLens(keys) => {
                let ThinLensKeys { position: Point(position), target, up, shutter, motion, .. } =
                    keys;
                let to_target = target.as_ref().map_or(DVec3::ZERO, |at| at.value.0) - position;
                let projection = Projection::ThinLens {
                    vertical_fov: vertical_fov(keys.fov, document)?,
                    aperture: keys.aperture.0,
                    focus_distance: keys.focus_distance.map_or(to_target.length(), |size| size.0),
                };
                (View { position, target, up, shutter, motion }, projection)
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
        let shutter = motion::shutter(self.shutter.as_ref(), document)?;
        let first = CameraPose { position: self.position, target, up };
        let pose = |motion: &At<PoseKeys>| motion.value.after(first, &motion.span, document);
        let motion = self.motion.as_ref().map(pose).transpose()?.filter(|last| *last != first);
        let name = name.into();
        let CameraPose { position, target, up } = first;
        Ok(CameraDescription { name, position, target, up, projection, shutter, motion })
    }
}

impl PoseKeys {
    /// Where a camera gets to from `first`.
    fn after(&self, first: CameraPose, span: &Span, document: &Document<'_>) -> Result<CameraPose> {
        let last = CameraPose {
            position: self.position.map_or(first.position, |Point(position)| position),
            target: self.target.map_or(first.target, |Point(target)| target),
            up: self.up.map_or(first.up, |Direction(up)| up),
        };
        match (last.target - last.position).try_normalize() {
            None => Err(document.error(span, "needs a target away from its position")),
            Some(forward) if parallel(last.up, forward) => {
                Err(document.error(span, "must not end with up along the view direction"))
            }
            Some(_) => Ok(last),
        }
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
