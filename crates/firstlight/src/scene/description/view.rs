//! Camera, film and shading settings as plain data.

use crate::color::View;
use crate::units::written::{self, Size};
use glam::DVec3;
use schemars::JsonSchema;
use serde::Deserialize;

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
