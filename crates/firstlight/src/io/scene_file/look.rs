//! `look` and `section`: what the picture is for.

use super::document::{At, Document};
use super::overrides::Override;
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
    look.map_or(Ok(()), |look| apply_look(look, section, document.overrides, scene))
}

/// Makes `scene` look so, and leaves to its film what `overrides` set of it.
///
/// # Errors
/// If one of them sets the integrator, which is the look's to choose.
pub fn apply_look(
    look: Look,
    section: Option<Section>,
    overrides: &[Override],
    scene: &mut SceneDescription,
) -> Result<()> {
    let setter = |keys: &[&str]| overrides.iter().find(|set| set.sets(keys));
    if let Some(set) = setter(&["integrator"]) {
        let error = set.error("the look chooses the integrator");
        return Err(Box::new(error.help("leave out one of the two")));
    }
    let (exposure, view) = (scene.film.exposure, scene.film.view);
    look.apply(scene, section);
    if setter(&["film", "exposure"]).is_some() {
        scene.film.exposure = exposure;
    }
    if setter(&["film", "view"]).is_some() {
        scene.film.view = view;
    }
    Ok(())
}
