//! `[lights.name.photometric]`: luminaires as they were measured.

use super::color::Color;
use super::document::{At, Document};
use super::environment::Strength;
use super::light::{Amount, Intensity, Lighting, Power};
use crate::color::Rgb;
use crate::diagnostic::Result;
use crate::io::model::{UpAxis, upright};
use crate::io::{FileAccess, luminaire};
use crate::scene::description::{Light, PhotometricWeb};
use crate::units::written::{Angle, Direction, Point, Size};
use glam::{DQuat, DVec3};
use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::HashMap;
use std::marker::PhantomData;
use std::path::PathBuf;
use std::sync::Arc;

/// A measured luminaire.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct PhotometricKeys {
    /// IES LM-63 (.ies) or EULUMDAT (.ldt) file, relative to the scene's folder.
    file: At<String>,
    /// Where it is, m.
    position: Point,
    /// The point its axis goes through, m. Default: it hangs from above.
    target: Option<At<Point>>,
    /// The direction of its axis. Default: straight down.
    direction: Option<At<Direction>>,
    /// Turn around its axis, anticlockwise seen from above when it hangs. Default 0: C0 is x.
    rotation: Option<Angle>,
    /// All that it gives: W or lm. Default: what was measured.
    pub(super) power: Option<At<Amount<Power>>>,
    /// Multiplies what was measured. Default 1.
    strength: Option<Strength>,
    /// Its colour. Default white.
    color: Option<Color>,
    /// Radius of a sphere that shines in its place, m: its shadows become soft. Default: it is a point.
    pub(super) radius: Option<Size>,
    /// Whether surfaces in between cast shadows. Default true.
    pub(super) shadows: Option<bool>,
}

/// Measured luminaires, each file once.
pub(super) struct Luminaires<'a> {
    pub(super) document: &'a Document<'a>,
    pub(super) access: &'a FileAccess,
    pub(super) by_file: HashMap<PathBuf, Arc<PhotometricWeb>>,
}

impl Luminaires<'_> {
    fn open(&mut self, file: &At<String>) -> Result<Arc<PhotometricWeb>> {
        let (name, span) = (&file.value, &file.span);
        let path = self.document.open(span, self.access.resolve(name))?;
        if let Some(web) = self.by_file.get(&path) {
            return Ok(Arc::clone(web));
        }
        let bytes = self.document.open(span, self.access.read(name))?;
        let web = Arc::new(self.document.open(span, luminaire::read(&bytes, name))?);
        self.by_file.insert(path, Arc::clone(&web));
        Ok(web)
    }
}

impl Lighting<'_> {
    /// The luminaire as plain data.
    pub(super) fn photometric(
        &self,
        keys: PhotometricKeys,
        luminaires: &mut Luminaires<'_>,
    ) -> Result<Light> {
        let Point(position) = keys.position;
        let direction = self.aim(position, keys.target.as_ref(), keys.direction.as_ref())?;
        let hanging = DQuat::from_mat3(&upright(UpAxis::Z, self.up).matrix3);
        let down = hanging * DVec3::NEG_Z;
        let tilt = DQuat::from_rotation_arc(down, direction.unwrap_or(down));
        let turn = DQuat::from_rotation_z(keys.rotation.map_or(0.0, |Angle(angle)| angle));
        let web = luminaires.open(&keys.file)?;
        let factor = self.per_candela(&keys, &web)?;
        Ok(Light::Photometric { position, rotation: tilt * hanging * turn, web, factor })
    }

    /// Radiant intensity for each candela that was measured.
    fn per_candela(&self, keys: &PhotometricKeys, web: &PhotometricWeb) -> Result<Rgb> {
        let Strength(strength) = keys.strength.unwrap_or(Strength(1.0));
        let span = keys.file.span.clone();
        let Some(power) = &keys.power else {
            let candela = Amount::<Intensity>::Seen(1.0, PhantomData);
            return Ok(strength * self.channels(&At { span, value: candela }, keys.color)?);
        };
        let flux = web.flux();
        if flux <= 0.0 {
            return Err(self.document.error(&span, "gives no light that could be scaled"));
        }
        Ok((strength * self.channels(power, keys.color)?) / flux as f32)
    }
}
