//! Camera, film and shading settings as plain data.

use super::LuminousEfficacy;
use crate::color::View;
use crate::units::written::{self, Size};
use glam::DVec3;
use schemars::JsonSchema;
use serde::Deserialize;
use std::str::FromStr;

/// A camera in world space.
#[derive(Debug, Clone, PartialEq)]
pub struct CameraDescription {
    /// The name it has in its file.
    pub name: String,
    /// Where it is, m.
    pub position: DVec3,
    /// The point it looks at, m; not `position`.
    pub target: DVec3,
    /// What is up in the picture; not along the view direction.
    pub up: DVec3,
    /// How directions become pixels.
    pub projection: Projection,
    /// When the shutter opens and when it closes, as parts of the scene's time, 0..1.
    pub shutter: [f64; 2],
    /// Where it has got to when the scene's time ends; `None`: it stands still.
    pub motion: Option<CameraPose>,
}

impl CameraDescription {
    /// The shutter of a camera that is not told otherwise: it is open all the time.
    pub const OPEN: [f64; 2] = [0.0, 1.0];
}

/// Where a camera is and looks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraPose {
    /// Where it is, m.
    pub position: DVec3,
    /// The point it looks at, m; not `position`.
    pub target: DVec3,
    /// What is up in the picture; not along the view direction.
    pub up: DVec3,
}

/// How directions become pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Projection {
    /// A pinhole.
    Perspective {
        /// Vertical field of view, rad, in 0..π.
        vertical_fov: f64,
    },
    /// Parallel rays.
    Orthographic {
        /// Height of what is seen, m.
        height: f64,
    },
    /// A pinhole opened to a round lens: sharp at one distance.
    ThinLens {
        /// Vertical field of view, rad, in 0..π.
        vertical_fov: f64,
        /// Diameter of the lens, m.
        aperture: f64,
        /// Distance along the view direction that is sharp, m.
        focus_distance: f64,
    },
}

/// What the film records and how it is developed.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmDescription {
    /// Pixels per row, ≥ 1.
    pub width: u32,
    /// Rows, ≥ 1.
    pub height: u32,
    /// Samples per pixel, ≥ 1.
    pub samples: u32,
    /// The reconstruction filter.
    pub filter: Filter,
    /// How radiance becomes display values.
    pub exposure: Exposure,
    /// What a developed picture looks like.
    pub view: View,
    /// Whether the background becomes alpha 0.
    pub transparent: bool,
    /// The most that light may bring to the eye, in any channel, that was scattered more than once on its way, W·sr⁻¹·m⁻²;
    /// what is above that is left out, with its noise.
    pub clamp: Option<f64>,
    /// Seed of every random number.
    pub seed: u64,
}

impl FilmDescription {
    /// Pixels along one side, at most.
    pub const LARGEST_SIDE: u32 = 65_536;
    /// Pixels of a picture, at most.
    pub const MOST_PIXELS: u64 = 1 << 30;
    /// Samples per pixel, at most.
    pub const MOST_SAMPLES: u32 = 1 << 24;
    /// Stops of exposure, at most, in either direction.
    pub const MOST_STOPS: f64 = 100.0;
}

impl Default for FilmDescription {
    fn default() -> Self {
        Self {
            width: 1280,
            height: 720,
            samples: 16,
            filter: Filter::default(),
            exposure: Exposure::default(),
            view: View::default(),
            transparent: false,
            clamp: None,
            seed: 0,
        }
    }
}

/// How radiance becomes display values: display = radiance × 2^EV.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Exposure {
    /// So many stops. 0: radiance 1 is display white.
    Ev(f64),
    /// Chosen from the picture so that bright matte surfaces come out just below white.
    Auto,
    /// That of a photographer's camera.
    Camera(CameraSettings),
}

impl Exposure {
    /// Stops, where `efficacy` says how bright 1 W is; `None` if the picture is to decide.
    pub fn stops(self, efficacy: LuminousEfficacy) -> Option<f64> {
        match self {
            Self::Ev(stops) => Some(stops),
            Self::Auto => None,
            Self::Camera(settings) => Some((efficacy.0 / settings.white()).log2()),
        }
    }
}

/// What a photographer sets, written as "1/125 f/8 ISO 100".
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraSettings {
    /// Time for which the shutter is open, s.
    pub shutter: f64,
    /// Focal length over diameter of the lens. It says how bright the picture is, not what is sharp.
    pub f_number: f64,
    /// Speed of the film.
    pub iso: f64,
}

impl CameraSettings {
    /// Luminance that comes out just white, nit: 78 / (0.65 · S) · N² / t, by the film's saturation.
    ///
    /// ISO 12232; Lagarde & de Rousiers, *Moving Frostbite to Physically Based Rendering*, 2014, section 5.1.
    pub fn white(self) -> f64 {
        78.0 / (0.65 * self.iso) * self.f_number * self.f_number / self.shutter
    }
}

impl FromStr for CameraSettings {
    type Err = String;

    /// The three settings in any order.
    fn from_str(text: &str) -> Result<Self, String> {
        let text = text.to_ascii_lowercase().replace("iso", " iso ").replace(" s ", " ");
        let (mut shutter, mut f_number, mut iso) = (None, None, None);
        let mut words = text.split_whitespace();
        while let Some(word) = words.next() {
            let (slot, value) = match (word, word.strip_prefix("f/")) {
                ("iso", _) => (&mut iso, words.next().unwrap_or_default().parse().ok()),
                (_, Some(number)) => (&mut f_number, number.parse().ok()),
                _ => (&mut shutter, seconds(word.trim_end_matches('s'))),
            };
            let value = value.filter(|value: &f64| (1e-9..=1e9).contains(value));
            if slot.replace(value.ok_or_else(expected)?).is_some() {
                return Err(expected());
            }
        }
        let missing = expected;
        Ok(Self {
            shutter: shutter.ok_or_else(missing)?,
            f_number: f_number.ok_or_else(missing)?,
            iso: iso.ok_or_else(missing)?,
        })
    }
}

fn expected() -> String {
    "needs a number of stops, \"auto\", or a camera's settings such as \"1/125 f/8 ISO 100\"".into()
}

/// A time such as 1/125 or 0.5, s.
fn seconds(text: &str) -> Option<f64> {
    match text.split_once('/') {
        Some((part, whole)) => Some(part.parse::<f64>().ok()? / whole.parse::<f64>().ok()?),
        None => text.parse().ok(),
    }
}

impl Default for Exposure {
    fn default() -> Self {
        Self::Ev(0.0)
    }
}

/// Reconstruction filters; radii and deviations are in pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Filter {
    /// The average over a square.
    Box {
        /// Half the side of the square.
        radius: f64,
    },
    /// Falls linearly to the sides.
    Tent {
        /// Where it reaches zero.
        radius: f64,
    },
    /// A bell, cut off and shifted to end at zero.
    Gaussian {
        /// Where it is cut.
        radius: f64,
        /// Its standard deviation.
        sigma: f64,
    },
    /// Mitchell and Netravali's cubic, with slight sharpening.
    Mitchell {
        /// Where it reaches zero.
        radius: f64,
        /// Its blur parameter.
        b: f64,
        /// Its ringing parameter.
        c: f64,
    },
}

impl Default for Filter {
    /// Gaussian of radius 1.5 px and deviation 0.5 px.
    fn default() -> Self {
        Self::Gaussian { radius: 1.5, sigma: 0.5 }
    }
}

/// How light is gathered.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Integrator {
    /// The lecture's sum over all lights, at the surface that is seen.
    #[default]
    Direct,
    /// Every way light can take: from all lights, by any number of surfaces.
    Path {
        /// How many surfaces may reflect it at most; `None`: as many as it takes.
        bounces: Option<u32>,
    },
    /// How much of the sky each point sees, 0..1.
    AmbientOcclusion {
        /// Surfaces further away than this do not count, m; may be infinite.
        distance: f64,
    },
    /// Shape above all: colours as they are, open places brighter than narrow ones, lines where surfaces end or bend.
    Clarity {
        /// Surfaces further away than this make no place narrow, m.
        distance: f64,
        /// Width of the lines, pixels; 0: none.
        lines: f64,
        /// What lies before this plane is cut away.
        section: Option<Section>,
    },
}

/// A plane that cuts a scene open.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Section {
    /// A point of it, m.
    pub point: DVec3,
    /// Unit vector to the side that is cut away.
    pub normal: DVec3,
}

/// How shadow rays are kept from hitting the surface they leave: the lecture's blunder, its two cures, and ours.
#[derive(Debug, Clone, Copy, PartialEq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Shadows {
    /// Start outside the error bound of the computed point. Right at every scale.
    #[default]
    Robust,
    /// No shadow rays at all: every light reaches every surface that faces it.
    Off,
    /// The classic rounding blunder: start at o + t·d, range from 0. Acne.
    Naive,
    /// The lecture's first cure: naive start point, range from `epsilon`.
    TRange {
        /// Start of the range, m.
        #[serde(deserialize_with = "written::size")]
        #[schemars(with = "Size")]
        epsilon: f64,
    },
    /// The lecture's second cure: naive start point moved along the normal.
    MovedStart {
        /// How far, m.
        #[serde(deserialize_with = "written::size")]
        #[schemars(with = "Size")]
        epsilon: f64,
    },
}

#[cfg(test)]
mod tests {
    use super::*;

    /// EV100 of 1/125 s at f/8 is log₂(8² · 125) = 12.97; white is at 1.2 · 2^EV100 nit.
    #[test]
    fn a_cameras_settings_make_its_saturation_white() {
        let settings: CameraSettings = "1/125 s f/8 ISO 100".parse().unwrap();
        assert!((settings.white() - 1.2 * 8000.0).abs() < 1e-9);
        let stops = Exposure::Camera(settings).stops(LuminousEfficacy(683.0)).unwrap();
        assert!((stops - (683.0_f64 / 9600.0).log2()).abs() < 1e-12);
        for same in ["f/8 iso100 1/125", "ISO 400 1/500s F/8", "0.008 f/8 ISO 100"] {
            let other: CameraSettings = same.parse().unwrap();
            assert!((other.white() / settings.white() - 1.0).abs() < 1e-12, "{same}");
        }
    }

    #[test]
    fn half_a_camera_is_refused() {
        for wrong in ["", "f/8", "1/125 f/8", "1/0 f/8 ISO 100", "1 2 f/8 ISO 1", "-1 f/8 ISO 100"]
        {
            assert!(wrong.parse::<CameraSettings>().is_err(), "{wrong}");
        }
    }
}
