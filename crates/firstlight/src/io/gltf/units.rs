//! In which units a file's lights are: what the specification says, or what its exporter has really written.
//!
//! KHR_lights_punctual: points and spots in cd, parallel light in lx. The exporter of Blender (glTF-Blender-IO) has
//! three modes. *Standard* keeps to that, with 683 lm/W and 4π sr: a lamp of P watts becomes 683 P / 4π cd. *Unitless*
//! leaves out the 683: P / 4π. *Raw*, the only one before version 3.6, leaves out both: P, as if watts were candela.

use super::data::Data;
use super::notes::Notes;
use schemars::JsonSchema;
use serde::Deserialize;
use std::f64::consts::PI;

/// What the numbers of a glTF file's lights are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LightUnits {
    /// cd and lx, as the specification says.
    Spec,
    /// Watts of a lamp that shines everywhere and W/m², as old exports from Blender have them ("raw").
    Blender,
    /// W/sr and W/m², for viewers that know no units.
    Unitless,
}

/// The first version of Blender's exporter that converts units.
const CONVERTS: [u32; 2] = [3, 6];

impl LightUnits {
    /// Radiant intensity (W·sr⁻¹) or irradiance (W·m⁻²) for each 1 in the file, and the unit of that 1.
    pub(super) fn of(self, parallel: bool, efficacy: f64) -> (f64, &'static str) {
        match (self, parallel) {
            (Self::Spec, false) => (1.0 / efficacy, "cd"),
            (Self::Spec, true) => (1.0 / efficacy, "lx"),
            (Self::Blender, false) => (1.0 / (4.0 * PI), "W"),
            (Self::Unitless, false) => (1.0, "W/sr"),
            (Self::Blender | Self::Unitless, true) => (1.0, "W/m²"),
        }
    }

    /// What was asked for, or what the file's generator is known to write; that is told.
    pub(super) fn choose(asked: Option<Self>, data: &Data, notes: &mut Notes) -> Self {
        let generator = data.document.generator();
        let raw = blender_version(generator).is_some_and(|version| version < CONVERTS);
        let has_lights = !data.document.extensions.lights.lights.is_empty();
        if asked.is_none() && raw && has_lights {
            let message = "its lights are taken as watts: Blender wrote them so before version 3.6 of its exporter";
            let help = "if they are candela and lux, as glTF says: --gltf-lights spec, or gltf_lights = \"spec\" in its [models.…]";
            notes.add_with_help("asset.generator", message, Some(help.into()));
        }
        asked.unwrap_or(if raw { Self::Blender } else { Self::Spec })
    }
}

/// The version of Blender's exporter: of `Khronos glTF Blender I/O v1.8.19`, 1 and 8.
fn blender_version(generator: &str) -> Option<[u32; 2]> {
    let (_, version) = generator.split_once("Blender I/O v")?;
    let mut numbers = version.split('.').map(str::parse);
    Some([numbers.next()?.ok()?, numbers.next()?.ok()?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_of_the_exporter_are_read() {
        assert_eq!(blender_version("Khronos glTF Blender I/O v1.8.19"), Some([1, 8]));
        assert_eq!(blender_version("Khronos glTF Blender I/O v4.2.60"), Some([4, 2]));
        for other in ["", "COLLADA2GLTF", "Khronos Blender I/O vx", "Blender I/O v3"] {
            assert_eq!(blender_version(other), None, "{other}");
        }
    }

    /// A lamp of 1000 W in Blender comes out as one of 1000 W from each of its exporter's modes.
    #[test]
    fn every_mode_of_blender_comes_back() {
        let (watts, sun) = (1000.0, 3.0);
        let written = [
            (LightUnits::Spec, watts * 683.0 / (4.0 * PI), sun * 683.0),
            (LightUnits::Unitless, watts / (4.0 * PI), sun),
            (LightUnits::Blender, watts, sun),
        ];
        for (units, point, parallel) in written {
            let power = 4.0 * PI * point * units.of(false, 683.0).0;
            assert!((power / watts - 1.0).abs() < 1e-12, "{units:?}");
            let irradiance = parallel * units.of(true, 683.0).0;
            assert!((irradiance / sun - 1.0).abs() < 1e-12, "{units:?}");
        }
        // Radiance's white, 179 lm/W: 1 W/sr is 179 cd.
        assert!((179.0 * LightUnits::Spec.of(false, 179.0).0 - 1.0).abs() < 1e-12);
    }
}
