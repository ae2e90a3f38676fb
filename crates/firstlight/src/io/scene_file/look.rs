//! `look` and `section`: what the picture is for.

use super::document::{At, Document};
use crate::Look;
use crate::diagnostic::Result;
use crate::scene::description::{SceneDescription, Section};
use crate::units::written::{Direction, Point};
use schemars::JsonSchema;
use serde::Deserialize;

/// A look by its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(super) enum LookName {
    /// Shape above all, for visualization and CAD.
    Clarity,
    /// Direct light and soft shadows, for animation and games.
    Balanced,
    /// Every way that light takes.
    Real,
}

/// A plane that cuts the scene open.
#[derive(Debug, Clone, Copy, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct SectionKeys {
    /// A point of it, m.
    point: Point,
    /// The side that is cut away.
    normal: Direction,
}

/// Makes `scene` look as its text wants.
pub(super) fn apply(
    look: Option<At<LookName>>,
    section: Option<At<SectionKeys>>,
    document: &Document<'_>,
    scene: &mut SceneDescription,
) -> Result<()> {
    if let Some(at) = &section
        && look.as_ref().is_none_or(|look| look.value != LookName::Clarity)
    {
        return Err(document.error(&at.span, "is for the look \"clarity\""));
    }
    let section = section.map(|at| Section { point: at.value.point.0, normal: at.value.normal.0 });
    let look = look.map(|at| match at.value {
        LookName::Clarity => Look::Clarity,
        LookName::Balanced => Look::Balanced,
        LookName::Real => Look::Real,
    });
    if let Some(look) = look {
        look.apply(scene, section);
    }
    Ok(())
}
