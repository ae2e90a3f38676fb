//! Cameras and lights at their nodes.

use super::data::Data;
use super::document::{self, Real, plain};
use super::nodes::Placed;
use super::notes::Notes;
use super::units::LightUnits;
use crate::color::Rgb;
use crate::diagnostic::Result;
use crate::scene::description::{
    CameraDescription, Light, LightDescription, Projection, SpotFalloff,
};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// The camera at a node: it looks along the node's −Z, its up is the node's Y.
///
/// # Errors
/// If it does not exist or its field of view makes no sense.
pub(super) fn camera(
    data: &Data,
    placed: &Placed,
    index: u32,
    notes: &mut Notes,
) -> Result<Option<CameraDescription>> {
    let part = format!("nodes[{}].camera", placed.index);
    let camera = data.at(&data.document.cameras, index, "camera", &part)?;
    let projection = projection(data, camera, index)?;
    let position = placed.transform.translation;
    let target = direction(placed, DVec3::NEG_Z).map(|forward| position + forward);
    let up = direction(placed, DVec3::Y);
    let Some((target, up)) = target.zip(up).filter(|&(t, up)| is_view(t - position, up)) else {
        notes.add(part, "this camera's transform leaves it no direction; it is left out");
        return Ok(None);
    };
    let name = placed.node.name.clone().or_else(|| camera.name.clone());
    let name = name.unwrap_or_else(|| format!("camera {index}"));
    let (shutter, motion) = (CameraDescription::OPEN, None);
    Ok(Some(CameraDescription { name, position, target, up, projection, shutter, motion }))
}

fn is_view(forward: DVec3, up: DVec3) -> bool {
    forward.cross(up).length() > 1e-6
}

fn projection(data: &Data, camera: &document::Camera, index: u32) -> Result<Projection> {
    match (&camera.perspective, &camera.orthographic) {
        (Some(lens), _) if lens.yfov > 0.0 && lens.yfov < PI => {
            Ok(Projection::Perspective { vertical_fov: lens.yfov })
        }
        (Some(lens), _) => {
            let cause = format!(
                "{} is no field of view; it must be more than 0 and less than π",
                lens.yfov
            );
            Err(data.error(format!("cameras[{index}].perspective.yfov"), cause))
        }
        (None, Some(lens)) if lens.ymag != 0.0 => {
            Ok(Projection::Orthographic { height: 2.0 * lens.ymag.abs() })
        }
        (None, Some(_)) => {
            Err(data.error(format!("cameras[{index}].orthographic.ymag"), "must not be 0"))
        }
        (None, None) => {
            let cause = "has neither perspective nor orthographic";
            Err(data.error(format!("cameras[{index}]"), cause))
        }
    }
}

/// The light at a node, along the node's −Z. Its units, with an efficacy in lm/W, make its strength radiometric.
///
/// # Errors
/// If it does not exist, has an unknown type or a strength or cone that makes no sense.
pub(super) fn light(
    data: &Data,
    placed: &Placed,
    index: u32,
    (units, efficacy): (LightUnits, f64),
    notes: &mut Notes,
) -> Result<Option<LightDescription>> {
    let part = format!("nodes[{}].extensions.KHR_lights_punctual.light", placed.index);
    let light = data.at(&data.document.extensions.lights.lights, index, "light", &part)?;
    let own = format!("extensions.KHR_lights_punctual.lights[{index}]");
    let (factor, unit) = units.of(light.kind == "directional", efficacy);
    let strength = strength(data, light, factor, &own)?;
    let position = placed.transform.translation;
    let axis = direction(placed, DVec3::NEG_Z);
    let aimed = match (light.kind.as_str(), axis) {
        ("point", _) => Light::Point { position, intensity: strength },
        ("directional", Some(direction)) => Light::Directional { direction, irradiance: strength },
        ("spot", Some(direction)) => spot(data, light, position, direction, strength, &own)?,
        ("directional" | "spot", None) => {
            notes.add(part, "this light's transform leaves it no direction; it is left out");
            return Ok(None);
        }
        (other, _) => {
            let cause = format!("{other:?} is unknown; point, spot and directional are known");
            return Err(data.error(format!("{own}.type"), cause));
        }
    };
    let name = placed.node.name.clone().or_else(|| light.name.clone());
    let name = name.unwrap_or_else(|| format!("light {index}"));
    let written = format!("{} {unit}", light.intensity.unwrap_or(Real(1.0)).0);
    Ok(Some(LightDescription { written, ..LightDescription::new(name, aimed) }))
}

/// Radiometric channels; `factor` is what 1 stands for.
fn strength(data: &Data, light: &document::Light, factor: f64, part: &str) -> Result<Rgb> {
    let color = Rgb::from_array(light.color.map_or([1.0; 3], plain));
    let intensity = light.intensity.unwrap_or(Real(1.0)).0;
    let strength = color * (f64::from(intensity) * factor) as f32;
    if strength.is_finite() && color.min_element() >= 0.0 && intensity >= 0.0 {
        return Ok(strength);
    }
    let cause = format!("color {color} and intensity {intensity} must be finite and not negative");
    Err(data.error(part, cause))
}

fn spot(
    data: &Data,
    light: &document::Light,
    position: DVec3,
    direction: DVec3,
    intensity: Rgb,
    part: &str,
) -> Result<Light> {
    let cone = light.spot.as_ref();
    let inner_angle = cone.and_then(|cone| cone.inner_cone_angle).unwrap_or(0.0);
    let outer_angle = cone.and_then(|cone| cone.outer_cone_angle).unwrap_or(FRAC_PI_4);
    // Single precision rounds π/2 up.
    if !(0.0 <= inner_angle && inner_angle <= outer_angle && outer_angle < FRAC_PI_2 + 1e-6) {
        let cause = format!(
            "innerConeAngle {inner_angle} and outerConeAngle {outer_angle} must satisfy \
             0 <= inner <= outer <= π/2"
        );
        return Err(data.error(format!("{part}.spot"), cause));
    }
    let falloff = SpotFalloff::Gltf;
    Ok(Light::Spot { position, direction, intensity, inner_angle, outer_angle, falloff })
}

/// A direction of the node's space in the world, if its scale is not 0.
fn direction(placed: &Placed, own: DVec3) -> Option<DVec3> {
    placed.transform.transform_vector3(own).try_normalize()
}
