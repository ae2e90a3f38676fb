//! Materials and textures as plain data.

use super::Medium;
use crate::color::Rgb;
use glam::{Affine2, Vec2};
use schemars::JsonSchema;
use serde::Deserialize;

/// The list of a material's textures; `$ref` and `$iter` make it one of references that can be changed or not.
macro_rules! texture_list {
    ($material:expr, $iter:ident, $($ref:tt)+) => {{
        let material = $material;
        let mut list = vec![$($ref)+ material.reflectance, $($ref)+ material.emission];
        list.extend(material.ambient_reflectance.$iter());
        list.extend(material.normal.$iter().map(|normal| $($ref)+ normal.texture));
        list.extend(material.bump.$iter().map(|bump| $($ref)+ bump.height.texture));
        list.extend(material.occlusion.$iter().map(|map| $($ref)+ map.open.texture));
        list.extend(material.opacity.$iter().map(|opacity| $($ref)+ opacity.texture));
        match $($ref)+ material.scattering {
            Scattering::Matte { roughness } => list.push($($ref)+ roughness.texture),
            Scattering::Mirror { mirrored } => list.push(mirrored),
            Scattering::Conductor { facets, .. } | Scattering::Dielectric { facets } => {
                list.extend([$($ref)+ facets.roughness.texture, $($ref)+ facets.anisotropy.texture]);
                list.extend(facets.direction.$iter());
            }
            Scattering::ThinGlass { .. } => {}
            Scattering::Principled(p) => {
                let p = $($ref)+ **p;
                list.extend([
                    $($ref)+ p.metallic.texture,
                    $($ref)+ p.facets.roughness.texture,
                    $($ref)+ p.facets.anisotropy.texture,
                    $($ref)+ p.specular.texture,
                    $($ref)+ p.specular_color,
                    $($ref)+ p.transmission.texture,
                    $($ref)+ p.diffuse_transmission.texture,
                    $($ref)+ p.diffuse_transmission_color,
                    $($ref)+ p.clearcoat.texture,
                    $($ref)+ p.clearcoat_roughness.texture,
                    $($ref)+ p.sheen_color,
                    $($ref)+ p.sheen_roughness.texture,
                    $($ref)+ p.iridescence.texture,
                    $($ref)+ p.iridescence_thickness.texture,
                ]);
                list.extend(p.facets.direction.$iter());
                list.extend(p.clearcoat_normal.$iter().map(|map| $($ref)+ map.texture));
            }
            Scattering::Mix { amount, .. } => list.push($($ref)+ amount.texture),
        }
        list
    }};
}

/// What a surface does with light: what it emits, plus what it scatters of the light that arrives, plus R_a · L_a of
/// ambient light.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// The name it has in its file.
    pub name: String,
    /// R_d, the fraction of light reflected per channel, 0..1; of other materials than matte ones their colour, see
    /// [`Scattering`]. Its fourth channel is alpha.
    pub reflectance: Texture,
    /// R_a for ambient light; `None`: what is scattered in all.
    pub ambient_reflectance: Option<Texture>,
    /// How light is scattered.
    pub scattering: Scattering,
    /// What bends the normals of the surface.
    pub normal: Option<NormalMap>,
    /// What raises the surface, before `normal` bends it further.
    pub bump: Option<BumpMap>,
    /// What keeps ambient light out of its creases, and no other light.
    pub occlusion: Option<OcclusionMap>,
    /// What is behind the surface, if it is the boundary of a transparent solid.
    pub interior: Option<Interior>,
    /// Radiance added to what leaves the surface, W·sr⁻¹·m⁻².
    pub emission: Texture,
    /// What it emits as its file has it; empty if that is not known.
    pub written: String,
    /// Whether the back emits as well as the front, if it can be seen.
    pub emits_behind: bool,
    /// Whether what it emits is a colour for the eye alone (KHR_materials_unlit): it is seen by the camera, in mirrors and
    /// through clear glass, and lights nothing.
    pub unlit: bool,
    /// What the alpha channel of `reflectance` means.
    pub alpha: Alpha,
    /// What multiplies that channel, 0..1; `None`: 1.
    pub opacity: Option<Scalar>,
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
            scattering: Scattering::Matte { roughness: Scalar::constant(0.0) },
            normal: None,
            bump: None,
            occlusion: None,
            interior: None,
            emission: Texture::constant(Rgb::ZERO),
            written: String::new(),
            emits_behind: true,
            unlit: false,
            alpha: Alpha::Opaque,
            opacity: None,
            double_sided: true,
            visible: true,
        }
    }

    /// A perfect mirror over a black ground that reflects the fraction `mirrored`, each channel 0..1.
    pub fn mirror(name: impl Into<String>, mirrored: Rgb) -> Self {
        let scattering = Scattering::Mirror { mirrored: Texture::constant(mirrored) };
        Self { scattering, ..Self::matte(name, Rgb::ZERO) }
    }

    /// Whether it scatters like a matte ground and nothing else.
    pub fn is_matte(&self) -> bool {
        matches!(&self.scattering, Scattering::Matte { roughness } if roughness.is(0.0))
    }

    /// Whether it emits anything, if only for the eye.
    pub fn emits(&self) -> bool {
        let [r, g, b, _] = self.emission.factor;
        r.max(g).max(b) > 0.0
    }

    /// Whether what it emits lights what is around it.
    pub fn is_light(&self) -> bool {
        self.emits() && !self.unlit
    }

    /// Whether a picture bends its normals.
    pub fn has_relief(&self) -> bool {
        self.normal.is_some() || self.bump.is_some()
    }

    /// Whether light passes it without being turned aside: panes of glass, which cast no shadow but their tint.
    pub fn is_pane(&self) -> bool {
        match &self.scattering {
            Scattering::ThinGlass { .. } => true,
            Scattering::Principled(p) => {
                let thin = !p.transmission.is(0.0) && self.interior.is_none();
                thin && p.facets.roughness.is(0.0) && p.facets.anisotropy.is(0.0)
            }
            _ => false,
        }
    }

    /// Whether light passes it on its straight way: panes, and what bounds a medium without bending light.
    pub fn passes_light(&self) -> bool {
        self.is_pane() || self.only_bounds()
    }

    /// Whether it is not there itself and only bounds a medium, as of fog: it bends no light.
    pub fn only_bounds(&self) -> bool {
        let bends = |interior: &Interior| (interior.index - 1.0).abs() >= Interior::NOTHING;
        let smooth = matches!(&self.scattering, Scattering::Dielectric { facets } if facets.roughness.is(0.0));
        smooth && self.interior.as_ref().is_some_and(|interior| !bends(interior))
    }

    /// How much of it is covered by varnish, if any is.
    pub(crate) fn coat(&self) -> Option<&Scalar> {
        let Scattering::Principled(p) = &self.scattering else { return None };
        Some(&p.clearcoat).filter(|coat| !coat.is(0.0))
    }

    /// Whether it hides all that is behind it.
    pub fn is_opaque(&self) -> bool {
        self.alpha == Alpha::Opaque && self.interior.is_none() && !self.is_pane()
    }

    /// Whether what it encloses scatters light.
    pub fn is_cloudy(&self) -> bool {
        self.interior.is_some_and(|interior| interior.scattering != Rgb::ZERO)
    }

    /// Whether much of what it shows comes from one direction or through it, so that the integrator `direct`, which
    /// asks lights alone, shows little of it.
    pub fn shows_its_surroundings(&self) -> bool {
        match &self.scattering {
            Scattering::Matte { .. } => false,
            Scattering::Principled(p) => !p.metallic.is(0.0) || !p.transmission.is(0.0),
            // The bounds of fog.
            Scattering::Dielectric { .. } => !self.passes_light(),
            _ => true,
        }
    }

    /// All its textures.
    pub fn textures(&self) -> Vec<&Texture> {
        texture_list!(self, iter, &)
    }

    /// Those of them that hold colours, or of which alpha alone is read, for which colours leave room.
    pub fn color_textures(&self) -> Vec<&Texture> {
        const ALPHA: usize = 3;
        let mut colors = vec![&self.reflectance, &self.emission];
        colors.extend(&self.ambient_reflectance);
        match &self.scattering {
            Scattering::Mirror { mirrored } => colors.push(mirrored),
            Scattering::Principled(p) => {
                colors.extend([&p.specular_color, &p.diffuse_transmission_color, &p.sheen_color]);
                let numbers =
                    [&p.specular, &p.diffuse_transmission, &p.sheen_roughness, &p.facets.roughness];
                let beside = numbers.into_iter().filter(|scalar| scalar.channel == ALPHA);
                colors.extend(beside.map(|scalar| &scalar.texture));
            }
            _ => {}
        }
        colors
    }

    /// All its textures, to be changed.
    pub fn textures_mut(&mut self) -> Vec<&mut Texture> {
        texture_list!(self, iter_mut, &mut)
    }
}

/// How a surface scatters light. The material's `reflectance` is a different colour in each.
#[derive(Debug, Clone, PartialEq)]
pub enum Scattering {
    /// Matte: L = (R_d / π) Σ E_i cos θ_i. `reflectance` is R_d.
    Matte {
        /// 0: Lambert's; to 1: rough (EON; Portsmouth, Kutz, Hill 2025).
        roughness: Scalar,
    },
    /// A perfect mirror over a matte ground of R_d `reflectance`.
    Mirror {
        /// The fraction of light mirrored per channel, 0..1; with R_d at most 1 in all.
        mirrored: Texture,
    },
    /// A metal. `reflectance` multiplies what it reflects.
    Conductor {
        /// Complex index n + ik per channel; `None`: `reflectance` is what it reflects at normal incidence.
        index: Option<ComplexIndex>,
        /// How rough it is.
        facets: Facets,
    },
    /// The boundary of a transparent solid, whose [`Material::interior`] says the rest. `reflectance` tints what passes.
    Dielectric {
        /// How rough it is.
        facets: Facets,
    },
    /// A pane of glass without thickness. `reflectance` tints what passes.
    ThinGlass {
        /// Index of refraction, at least 1.
        index: f32,
    },
    /// glTF's metallic-roughness surface. `reflectance` is its base colour.
    Principled(Box<Principled>),
    /// Two other materials, each in a part of all the points that a point is made of.
    Mix {
        /// Their indices in [`SceneDescription::materials`](super::SceneDescription::materials).
        materials: [usize; 2],
        /// The part of the second, 0..1.
        amount: Scalar,
    },
}

impl Scattering {
    /// Whether light gets through the surface, so that it matters what is behind it.
    pub(crate) fn lets_in(&self) -> bool {
        match self {
            Self::Principled(p) => !p.transmission.is(0.0) || !p.diffuse_transmission.is(0.0),
            other => matches!(other, Self::Dielectric { .. } | Self::ThinGlass { .. }),
        }
    }
}

/// Index of refraction of a metal, n + ik per colour channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ComplexIndex {
    /// n, at least 0.
    pub n: Rgb,
    /// k, at least 0.
    pub k: Rgb,
}

/// Normals in a picture, for light to fall as if the surface had relief.
#[derive(Debug, Clone, PartialEq)]
pub struct NormalMap {
    /// Red, green and blue, each 0..1 for −1..1: along growing u, along growing v, out of the surface.
    pub texture: Texture,
    /// What the first two are multiplied by.
    pub scale: f32,
}

/// Heights in a picture, for light to fall as if the surface had relief (Blinn, *Simulation of Wrinkled Surfaces*, 1978).
#[derive(Debug, Clone, PartialEq)]
pub struct BumpMap {
    /// The height, 0..1.
    pub height: Scalar,
    /// What a height of 1 is.
    pub amount: BumpAmount,
}

/// How much of the ambient light comes to each point, as someone has worked it out before.
#[derive(Debug, Clone, PartialEq)]
pub struct OcclusionMap {
    /// The part that does, 0..1.
    pub open: Scalar,
    /// How much of what is kept out is, 0..1.
    pub strength: f32,
}

/// How high a bump map is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum BumpAmount {
    /// So many metres; below 0: hills are valleys.
    Metres(f32),
    /// So many times what is from 0 to 1 of the texture coordinates.
    Relative(f32),
}

/// How the small facets of a rough surface lean.
#[derive(Debug, Clone, PartialEq)]
pub struct Facets {
    /// Perceptual roughness, 0..1; their width alpha is its square.
    pub roughness: Scalar,
    /// How much wider they lean along the direction of `rotation` than across it, 0..1 (KHR_materials_anisotropy).
    pub anisotropy: Scalar,
    /// Direction of the anisotropy, anticlockwise from the direction of growing u, rad.
    pub rotation: f32,
    /// Red and green, each 0..1 for −1..1: the direction in the frame of u and v, before `rotation`.
    pub direction: Option<Texture>,
    /// Whether light that meets several facets on its way out is counted; otherwise it is lost.
    pub multiple_scattering: bool,
}

impl Facets {
    /// Of one roughness for all directions.
    pub fn of(roughness: Scalar) -> Self {
        let anisotropy = Scalar::constant(0.0);
        Self { roughness, anisotropy, rotation: 0.0, direction: None, multiple_scattering: true }
    }
}

/// What is inside of a transparent solid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interior {
    /// Index of refraction at 587.6 nm, more than 0.
    pub index: f32,
    /// 1 / Abbe number (n_d − 1) / (n_F − n_C): how much the index depends on the colour; 0: not at all.
    pub dispersion: f32,
    /// What is absorbed per length, m⁻¹ (Beer & Lambert).
    pub absorption: Rgb,
    /// What is scattered per length, m⁻¹.
    pub scattering: Rgb,
    /// Mean cosine of the angle that it is scattered by; see [`Medium::anisotropy`].
    pub anisotropy: f32,
    /// Where solids overlap, the highest counts; of equals, the one that light entered last.
    pub priority: i32,
}

impl Interior {
    /// Nearer to 1 than this, a ratio of indices turns no light aside.
    pub(crate) const NOTHING: f32 = 1e-4;

    /// What is lost per length, at most, m⁻¹: sums and products of it stay finite.
    pub(crate) const DENSEST: f32 = 1e30;

    /// Clear, of this index.
    pub fn clear(index: f32) -> Self {
        let (absorption, scattering) = (Rgb::ZERO, Rgb::ZERO);
        Self { index, dispersion: 0.0, absorption, scattering, anisotropy: 0.0, priority: 0 }
    }

    /// The same where lengths were written in a unit of so many metres.
    pub(crate) fn in_unit(self, metres: f32) -> Self {
        let Self { absorption, scattering, .. } = self;
        let per_metre = |amount: Rgb| (amount / metres).min(Rgb::splat(Self::DENSEST));
        let (absorption, scattering) = (per_metre(absorption), per_metre(scattering));
        Self { absorption, scattering, ..self }
    }

    /// What it does to light on its way.
    pub(crate) fn medium(&self) -> Medium {
        let Self { absorption, scattering, anisotropy, .. } = *self;
        Medium { absorption, scattering, anisotropy }
    }

    /// The index of a channel: red is that of the hydrogen line C, blue that of F, green lies between
    /// (KHR_materials_dispersion).
    pub fn index_of(&self, channel: usize) -> f32 {
        let spread = 0.5 * (self.index - 1.0) * self.dispersion;
        self.index + spread * (channel as f32 - 1.0)
    }

    /// What has to be absorbed per length, m⁻¹, so that white light has this colour after `distance`, m. What would be
    /// black is as good as that.
    pub fn absorption(color: Rgb, distance: f32) -> Rgb {
        color.map(|channel| (-channel.clamp(1e-9, 1.0).ln() / distance).clamp(0.0, Self::DENSEST))
    }
}

/// Parameters of glTF 2.0's metallic-roughness model and KHR_materials_*, with their names, ranges and defaults.
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs, reason = "the names and meanings are glTF's")]
pub struct Principled {
    pub metallic: Scalar,
    pub facets: Facets,
    /// At least 1; 0 is taken as infinite.
    pub ior: f32,
    pub specular: Scalar,
    pub specular_color: Texture,
    pub transmission: Scalar,
    pub diffuse_transmission: Scalar,
    pub diffuse_transmission_color: Texture,
    pub clearcoat: Scalar,
    pub clearcoat_roughness: Scalar,
    /// `None`: the surface's own, not that of its normal map.
    pub clearcoat_normal: Option<NormalMap>,
    pub sheen_color: Texture,
    pub sheen_roughness: Scalar,
    pub iridescence: Scalar,
    pub iridescence_ior: f32,
    /// Between `iridescence_thickness_range`: 0..1.
    pub iridescence_thickness: Scalar,
    /// nm
    pub iridescence_thickness_range: [f32; 2],
}

impl Default for Principled {
    /// What glTF says where a file says nothing.
    fn default() -> Self {
        let [zero, one] = [0.0, 1.0].map(Scalar::constant);
        Self {
            metallic: one.clone(),
            facets: Facets::of(one.clone()),
            ior: 1.5,
            specular: one.clone(),
            specular_color: Texture::constant(Rgb::ONE),
            transmission: zero.clone(),
            diffuse_transmission: zero.clone(),
            diffuse_transmission_color: Texture::constant(Rgb::ONE),
            clearcoat: zero.clone(),
            clearcoat_roughness: zero.clone(),
            clearcoat_normal: None,
            sheen_color: Texture::constant(Rgb::ZERO),
            sheen_roughness: zero.clone(),
            iridescence: zero,
            iridescence_ior: 1.3,
            iridescence_thickness: one,
            iridescence_thickness_range: [100.0, 400.0],
        }
    }
}

/// A number over a surface: one channel of a texture, whose picture holds plain numbers instead of colours.
#[derive(Debug, Clone, PartialEq)]
pub struct Scalar {
    /// What it is read from.
    pub texture: Texture,
    /// 0 to 3: red, green, blue, alpha.
    pub channel: usize,
    /// Whether it is 1 minus that.
    pub complement: bool,
}

impl Scalar {
    /// The same number everywhere.
    pub fn constant(value: f32) -> Self {
        let texture = Texture { factor: [value; 4], ..Texture::constant(Rgb::ONE) };
        Self { texture, channel: 0, complement: false }
    }

    /// What the number in the texture stands for.
    pub fn meant(&self, number: f32) -> f32 {
        if self.complement { 1.0 - number } else { number }
    }

    /// Whether it is this number everywhere.
    pub fn is(&self, value: f32) -> bool {
        let factor = self.texture.factor[self.channel];
        (self.texture.is_constant() || factor == 0.0) && self.meant(factor) == value
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
    /// From one colour to another along a line, and the same beyond its ends.
    Gradient {
        /// The two colours, linear RGBA.
        colors: [[f32; 4]; 2],
        /// Texture coordinates of the first.
        from: Vec2,
        /// Texture coordinates of the second; not those of the first.
        to: Vec2,
    },
    /// Clouds between two colours.
    Noise {
        /// The two colours, linear RGBA.
        colors: [[f32; 4]; 2],
        /// Size of the largest clouds in texture coordinates, along u and v.
        size: Vec2,
        /// How many sizes of clouds there are, each half of the one before.
        octaves: u32,
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
    /// The same, as in PNG and TIFF of 16 bits.
    Srgb16(Vec<[u16; 4]>),
    /// Linear values.
    Linear(Vec<[f32; 4]>),
}
