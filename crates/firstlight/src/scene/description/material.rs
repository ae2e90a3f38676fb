//! Materials and textures as plain data.

use crate::color::Rgb;
use glam::{Affine2, Vec2};
use schemars::JsonSchema;
use serde::Deserialize;

/// A matte surface, perhaps with a perfect mirror over it: L = (R_d / π) Σ E_i cos θ_i, plus R_a · L_a of ambient light,
/// plus what it mirrors, plus what it emits.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// The name it has in its file.
    pub name: String,
    /// R_d, the fraction of light reflected per channel, 0..1. Its fourth channel is alpha.
    pub reflectance: Texture,
    /// R_a for ambient light; `None`: the same as `reflectance`.
    pub ambient_reflectance: Option<Texture>,
    /// The fraction of light mirrored per channel, 0..1; with R_d at most 1 in all.
    pub mirrored: Texture,
    /// Radiance added to what leaves the surface, W·sr⁻¹·m⁻².
    pub emission: Texture,
    /// Whether the back emits as well as the front, if it can be seen.
    pub emits_behind: bool,
    /// What the alpha channel of `reflectance` means.
    pub alpha: Alpha,
    /// Whether the back of the surface can be seen; otherwise camera rays pass through it.
    pub double_sided: bool,
    /// Whether the camera sees the surface at all.
    pub visible: bool,
}

impl Material {
    /// A double-sided opaque material of one reflectance, each channel 0..1.
    pub fn matte(name: impl Into<String>, reflectance: Rgb) -> Self {
        Self {
            name: name.into(),
            reflectance: Texture::constant(reflectance),
            ambient_reflectance: None,
            mirrored: Texture::constant(Rgb::ZERO),
            emission: Texture::constant(Rgb::ZERO),
            emits_behind: true,
            alpha: Alpha::Opaque,
            double_sided: true,
            visible: true,
        }
    }
}

impl Material {
    /// Whether it mirrors nothing.
    pub(crate) fn is_matte(&self) -> bool {
        self.mirrored.is_constant() && Rgb::from_slice(&self.mirrored.factor) == Rgb::ZERO
    }
}

/// What the alpha channel of a material's reflectance means (glTF's alpha modes).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Alpha {
    /// Nothing: the surface is solid.
    #[default]
    Opaque,
    /// Below the cutoff the surface is not there.
    Mask {
        /// Alpha from which on the surface is there.
        cutoff: f32,
    },
    /// The fraction of the light that the surface stops, chosen at random ray by ray.
    Blend,
}

/// A value over a surface: `factor` × `pattern` × vertex colour, linear RGBA.
#[derive(Debug, Clone, PartialEq)]
pub struct Texture {
    /// Linear RGBA that multiplies the pattern.
    pub factor: [f32; 4],
    /// What varies over the surface.
    pub pattern: Pattern,
    /// Whether the mesh's vertex colours multiply it as well.
    pub vertex_colors: bool,
}

impl Texture {
    /// Whether it is the same everywhere on every surface.
    pub fn is_constant(&self) -> bool {
        self.pattern == Pattern::Constant && !self.vertex_colors
    }

    /// The same colour everywhere, alpha 1.
    pub fn constant(color: Rgb) -> Self {
        Self {
            factor: [color.x, color.y, color.z, 1.0],
            pattern: Pattern::Constant,
            vertex_colors: false,
        }
    }
}

impl Texture {
    /// What is shown where a picture is missing: eight squares of magenta and black along u and v.
    pub fn stand_in() -> Self {
        let colors = [[1.0, 0.0, 1.0, 1.0], [0.0, 0.0, 0.0, 1.0]];
        let pattern = Pattern::Checker { colors, size: Vec2::splat(0.125) };
        Self { factor: [1.0; 4], pattern, vertex_colors: false }
    }
}

/// What varies over a surface, by its texture coordinates. v points up: (0, 0) is the picture's lower left.
#[derive(Debug, Clone, PartialEq)]
pub enum Pattern {
    /// 1 everywhere.
    Constant,
    /// A picture.
    Image {
        /// Index into [`SceneDescription::images`](super::SceneDescription::images).
        image: usize,
        /// Which of the mesh's texture coordinate sets.
        uv_set: usize,
        /// Applied to the coordinates before the look-up.
        transform: UvTransform,
        /// What happens outside 0..1, along u and v.
        wrap: [Wrap; 2],
        /// How pixels are joined.
        sampling: Sampling,
    },
    /// Squares of alternating colour.
    Checker {
        /// The two colours, linear RGBA; the first covers the square at the origin of (u, v).
        colors: [[f32; 4]; 2],
        /// Side of a square in texture coordinates, along u and v (metres on a plane, quad parameters 0..1).
        size: Vec2,
    },
}

/// A map of texture coordinates; identity by default.
pub type UvTransform = Affine2;

/// What a picture does outside 0..1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Wrap {
    /// Starts again.
    #[default]
    Repeat,
    /// Starts again, every second time mirrored.
    Mirror,
    /// Keeps the colour of its edge.
    Clamp,
}

/// How a picture is read between the centres of its pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Sampling {
    /// Weighted by distance.
    #[default]
    Bilinear,
    /// The nearest pixel as it is.
    Nearest,
}

/// A decoded picture: linear RGBA, rows from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Pixels {
    /// Where it came from, for messages.
    pub name: String,
    /// Pixels per row, ≥ 1.
    pub width: u32,
    /// Rows, ≥ 1.
    pub height: u32,
    /// How the numbers are stored.
    pub texels: Texels,
}

/// The numbers of a decoded picture, `width × height` RGBA texels.
#[derive(Debug, Clone, PartialEq)]
pub enum Texels {
    /// sRGB-encoded colour with linear alpha, as in 8-bit PNG, JPEG and WebP.
    Srgb8(Vec<[u8; 4]>),
    /// Linear values.
    Linear(Vec<[f32; 4]>),
}
