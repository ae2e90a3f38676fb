//! How a surface, or a medium, scatters light at one point: a handful of lobes, each plain data.
//!
//! A [`Bsdf`] is made for one outgoing direction. `incoming` is where light comes from; both point away from the
//! surface. Inside this module directions are in the frame of the surface, whose third axis is the shading normal on
//! the side of the eye; the sign of the third coordinate decides between reflected and transmitted.

mod albedo;
mod diffuse;
mod fresnel;
mod ggx;
mod glass;
mod layers;
mod principled;
mod sheen;
#[cfg(test)]
mod tests;

pub(crate) use diffuse::Matte;
pub(crate) use fresnel::{Fresnel, Gloss, dielectric};
pub(crate) use ggx::{Ggx, mirrored, refracted};
pub(crate) use glass::Glass;
pub(crate) use layers::{Layers, VARNISH};
pub(crate) use principled::{PrincipledPoint, Wall, principled};

use crate::color::Rgb;
use crate::math::tangents;
use crate::shading::volume::HenyeyGreenstein;
use diffuse::{Eon, cosine_weighted};
use glam::{Vec2, Vec3};
use sheen::Sheen;
use std::f32::consts::FRAC_1_PI;

/// One way of scattering.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Lobe {
    /// Which.
    pub kind: Kind,
    /// What its BSDF is multiplied by.
    pub weight: Rgb,
    /// Probability with which it is picked, 0..1; those of a point add up to 1.
    pub share: f32,
    /// The first two coordinates of its own normal, of length 1, if that is not the frame's: as of varnish over bumps.
    pub tilt: Vec2,
}

/// The shapes of lobes. The sharp ones scatter into one direction only.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Kind {
    /// Matte: the lecture's k_d = R_d / π.
    Lambert,
    /// Matte, seen from behind: what falls on one side leaves on the other.
    LambertThrough,
    /// Matte and rough.
    Eon(Eon),
    /// Facets that reflect.
    Facets {
        /// How they lean.
        facets: Ggx,
        /// What each reflects.
        fresnel: Fresnel,
        /// The fraction of light from the eye that comes out after one reflection, if all is reflected.
        once: f32,
        /// Whether what they reflect leaves on the other side, as of a pane that is rough and has no thickness.
        through: bool,
    },
    /// Facets that reflect and refract.
    Glass {
        /// The boundary.
        glass: Glass,
        /// Colour of what passes.
        tint: Rgb,
        /// What they reflect, if that is not what the index says.
        gloss: Option<Gloss>,
    },
    /// Fibres.
    Sheen(Sheen),
    /// Particles of a medium, between which there is no surface.
    Phase(HenyeyGreenstein),
    /// Sharp: reflected.
    Mirror,
    /// Sharp: bent.
    Refraction {
        /// Index beyond over index here.
        eta: f32,
        /// Cosine beyond.
        cos_beyond: f32,
    },
    /// Sharp: goes on as if nothing were there.
    Straight,
}

/// Axes at a point of a surface: a tangent and the shading normal, both of length 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Frame {
    tangent: Vec3,
    normal: Vec3,
    relief: Option<Relief>,
}

/// Light that falls on a surface whose normals were bent: the bends stand for small hills, which cast shadows.
///
/// Conty Estevez, Lecocq, Stein, *A Microfacet-Based Shadowing Function to Solve the Bump Terminator Problem*, Ray
/// Tracing Gems ch. 12, 2019.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Relief {
    /// The normal before it was bent.
    ground: Vec3,
    /// Square of the width of facets as steep as the bend.
    alpha2: f32,
}

impl Relief {
    /// The fraction of light from `incoming` that hills do not stop.
    fn visible(&self, incoming: Vec3) -> f32 {
        let cos = incoming.dot(self.ground);
        if cos <= 0.0 {
            return 0.0;
        }
        let tan2 = (1.0 - cos * cos).max(0.0) / (cos * cos);
        2.0 / (1.0 + (1.0 + self.alpha2 * tan2).sqrt())
    }
}

impl Frame {
    /// With any tangent.
    #[inline(always)]
    pub(crate) fn around(normal: Vec3) -> Self {
        Self { tangent: tangents(normal.as_dvec3()).0.as_vec3(), normal, relief: None }
    }

    /// With the tangent nearest to a vector; any if there is none.
    pub(crate) fn along(normal: Vec3, tangent: Vec3) -> Self {
        match (tangent - tangent.dot(normal) * normal).try_normalize() {
            Some(tangent) => Self { tangent, normal, relief: None },
            None => Self::around(normal),
        }
    }

    /// The same frame, for a normal that was bent away from `ground`.
    pub(crate) fn bent_from(self, ground: Vec3) -> Self {
        let cos = self.normal.dot(ground).clamp(0.1, 1.0);
        let alpha2 = 0.125 * (1.0 - cos * cos) / (cos * cos);
        Self { relief: Some(Relief { ground, alpha2 }), ..self }
    }

    /// Whether its normal is the surface's own.
    pub(crate) fn is_upright(&self) -> bool {
        self.relief.is_none()
    }

    /// The fraction of light from the world's direction `incoming` that bends of the normal leave.
    fn visible(&self, incoming: Vec3) -> f32 {
        self.relief.as_ref().map_or(1.0, |relief| relief.visible(incoming))
    }

    /// What a mirror whose normal was bent sends into its own ground, sent off that: hills that mirror lose no light.
    fn out_of_hills(&self, incoming: Vec3) -> Vec3 {
        match &self.relief {
            Some(Relief { ground, .. }) if incoming.dot(*ground) < 0.0 => incoming.reflect(*ground),
            _ => incoming,
        }
    }

    /// The third axis.
    pub(crate) fn normal(self) -> Vec3 {
        self.normal
    }

    /// A direction of the world in proportion to its cosine, and its density, sr⁻¹.
    #[inline(always)]
    fn cosine_weighted(self, u: Vec2) -> (Vec3, f32) {
        let local = cosine_weighted(u);
        (self.to_world(local), local.z * FRAC_1_PI)
    }

    /// From the world into the frame.
    pub(crate) fn to_local(self, v: Vec3) -> Vec3 {
        let bitangent = self.normal.cross(self.tangent);
        Vec3::new(v.dot(self.tangent), v.dot(bitangent), v.dot(self.normal))
    }

    /// From the frame into the world.
    #[inline(always)]
    pub(crate) fn to_world(self, v: Vec3) -> Vec3 {
        v.x * self.tangent + v.y * self.normal.cross(self.tangent) + v.z * self.normal
    }
}

/// All lobes of a point, for one outgoing direction.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bsdf<'a> {
    /// The frame of the surface.
    pub frame: Frame,
    /// Unit vector to the eye, in the world.
    pub outgoing: Vec3,
    /// What there is.
    pub lobes: &'a [Lobe],
}

/// A direction from which light may come, picked by chance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct BsdfSample {
    /// Unit vector, in the world.
    pub incoming: Vec3,
    /// What light from there is multiplied by: BSDF × |cosine| / density.
    pub weight: Rgb,
    /// Density of `incoming`, sr⁻¹; infinite if no other direction was possible.
    pub pdf: f32,
    /// Whether it comes from the other side of the surface.
    pub through: bool,
    /// Whether it goes on as if there were no surface.
    pub straight: bool,
}

impl BsdfSample {
    /// What a matte surface that reflects so much picks, see [`Matte::sample`].
    #[inline(always)]
    pub(crate) fn of_matte(reflectance: Rgb, (incoming, pdf): (Vec3, f32)) -> Option<Self> {
        let sample = Self { incoming, weight: reflectance, pdf, through: false, straight: false };
        (pdf > 0.0).then_some(sample)
    }
}

impl Bsdf<'_> {
    /// BSDF × |cosine of `incoming`|, sr⁻¹, and the density with which [`Bsdf::sample`] picks it, sr⁻¹; both without
    /// the sharp lobes.
    #[inline(always)]
    pub(crate) fn eval(&self, incoming: Vec3) -> (Rgb, f32) {
        if let [Lobe { kind: Kind::Lambert, weight, share, .. }] = *self.lobes {
            let matte = Matte { normal: self.frame.normal, reflectance: weight };
            let (value, density) = matte.eval(incoming);
            return (value * self.frame.visible(incoming), share * density);
        }
        let local = self.frame.to_local(incoming);
        let (value, pdf) = self.eval_local(self.local_outgoing(), local);
        // What comes through has no hills before it.
        (if local.z > 0.0 { value * self.frame.visible(incoming) } else { value }, pdf)
    }

    fn eval_local(&self, outgoing: Vec3, incoming: Vec3) -> (Rgb, f32) {
        let (mut value, mut pdf) = (Rgb::ZERO, 0.0);
        for lobe in self.lobes {
            let (f, p) = lobe.eval(outgoing, incoming);
            value += lobe.weight * f;
            pdf += lobe.share * p;
        }
        (value, pdf)
    }

    /// A direction picked by three numbers in 0..1: `choice` decides between the lobes. `None` if nothing is scattered
    /// there.
    #[inline(always)]
    pub(crate) fn sample(&self, choice: f32, u: Vec2) -> Option<BsdfSample> {
        if let [Lobe { kind: Kind::Lambert, weight, .. }] = *self.lobes {
            let (incoming, pdf) = self.frame.cosine_weighted(u);
            let visible = self.frame.visible(incoming);
            return BsdfSample::of_matte(weight * visible, (incoming, pdf));
        }
        let (lobe, choice) = self.pick(choice)?;
        let outgoing = self.local_outgoing();
        if let Some(local) = lobe.only_direction(outgoing) {
            // A tilted mirror may show what lies behind its own surface.
            let lost = lobe.kind == Kind::Mirror && local.z <= 0.0;
            let incoming = self.frame.to_world(local);
            return (!lost).then(|| BsdfSample {
                incoming: if local.z > 0.0 { self.frame.out_of_hills(incoming) } else { incoming },
                weight: lobe.weight / lobe.share,
                pdf: f32::INFINITY,
                through: local.z < 0.0,
                straight: lobe.kind == Kind::Straight,
            });
        }
        let local = lobe.sample(outgoing, choice, u)?;
        let incoming = self.frame.to_world(local);
        let (value, pdf) = self.eval(incoming);
        (pdf > 0.0).then(|| BsdfSample {
            incoming,
            weight: value / pdf,
            pdf,
            through: local.z < 0.0,
            straight: false,
        })
    }

    /// The unit vector to the side on which light has to be to be scattered; 0 if it may be anywhere.
    #[inline(always)]
    pub(crate) fn horizon(&self) -> Vec3 {
        let one_side = self.lobes.iter().all(|lobe| !lobe.passes());
        if one_side { self.frame.normal } else { Vec3::ZERO }
    }

    /// The fraction of light that goes on as if nothing were there.
    pub(crate) fn straight(&self) -> Rgb {
        let lobes = self.lobes.iter().filter(|lobe| lobe.kind == Kind::Straight);
        lobes.map(|lobe| lobe.weight).sum()
    }

    /// A lobe by its share, and the choice that is left.
    fn pick(&self, choice: f32) -> Option<(&Lobe, f32)> {
        let mut left = choice;
        for lobe in self.lobes {
            if left < lobe.share {
                return Some((lobe, left / lobe.share));
            }
            left -= lobe.share;
        }
        self.lobes.last().map(|lobe| (lobe, 0.5))
    }

    /// As the facets see the eye: shading normals may turn away from it further than surfaces do.
    fn local_outgoing(&self) -> Vec3 {
        above(self.frame.to_local(self.outgoing))
    }
}

/// The direction, lifted off the horizon.
pub(crate) fn above(direction: Vec3) -> Vec3 {
    const LEAST: f32 = 1e-4;
    if direction.z >= LEAST {
        return direction;
    }
    direction.with_z(LEAST).normalize()
}

impl Lobe {
    /// Along the frame's normal, and alone.
    pub(crate) const fn new(kind: Kind, weight: Rgb) -> Self {
        Self { kind, weight, share: 1.0, tilt: Vec2::ZERO }
    }

    /// BSDF × |cosine|, sr⁻¹, and density, sr⁻¹.
    fn eval(&self, outgoing: Vec3, incoming: Vec3) -> (Rgb, f32) {
        let Some(own) = self.own_frame() else { return self.eval_upright(outgoing, incoming) };
        let turned = own.to_local(incoming);
        // What is tilted only reflects.
        if incoming.z <= 0.0 || turned.z <= 0.0 {
            return same(0.0);
        }
        self.eval_upright(above(own.to_local(outgoing)), turned)
    }

    fn sample(&self, outgoing: Vec3, choice: f32, u: Vec2) -> Option<Vec3> {
        let Some(own) = self.own_frame() else { return self.sample_upright(outgoing, choice, u) };
        let turned = self.sample_upright(above(own.to_local(outgoing)), choice, u)?;
        Some(own.to_world(turned)).filter(|incoming| incoming.z > 0.0)
    }

    /// The frame of a lobe whose normal is tilted, within that of the surface.
    fn own_frame(&self) -> Option<Frame> {
        let up = (1.0 - self.tilt.length_squared()).max(0.0).sqrt();
        (self.tilt != Vec2::ZERO).then(|| Frame::around(self.tilt.extend(up)))
    }

    fn eval_upright(&self, outgoing: Vec3, incoming: Vec3) -> (Rgb, f32) {
        let reflects = incoming.z > 0.0;
        let flipped = incoming.with_z(-incoming.z);
        match self.kind {
            Kind::Lambert if reflects => same(incoming.z * FRAC_1_PI),
            Kind::LambertThrough if flipped.z > 0.0 => same(flipped.z * FRAC_1_PI),
            Kind::Eon(eon) if reflects => {
                (eon.value(outgoing, incoming) * incoming.z, eon.pdf(outgoing, incoming))
            }
            Kind::Sheen(sheen) if reflects => {
                (Rgb::splat(sheen.value(outgoing, incoming) * incoming.z), Sheen::pdf(incoming))
            }
            Kind::Facets { facets, fresnel, once, through } if through != reflects => {
                let incoming = if through { flipped } else { incoming };
                let (value, power) = reflect(facets, fresnel, outgoing, incoming);
                (value, power / once)
            }
            Kind::Glass { glass, tint, gloss } => {
                let (value, pdf) = glass.eval(outgoing, incoming);
                let tint = if reflects { Rgb::ONE } else { tint };
                let glossed =
                    gloss.filter(|_| pdf > 0.0).map(|g| glass.glossed(outgoing, incoming, g));
                (value * tint * glossed.unwrap_or(Rgb::ONE), pdf)
            }
            Kind::Phase(phase) => same(phase.pdf(-outgoing, incoming)),
            _ => same(0.0),
        }
    }

    /// Whether light of many directions on the other side is scattered too.
    fn passes(&self) -> bool {
        match self.kind {
            Kind::LambertThrough | Kind::Glass { .. } | Kind::Phase(_) => true,
            Kind::Facets { through, .. } => through,
            _ => false,
        }
    }

    fn sample_upright(&self, outgoing: Vec3, choice: f32, u: Vec2) -> Option<Vec3> {
        let flip = |v: Vec3| v.with_z(-v.z);
        match self.kind {
            Kind::Lambert => Some(cosine_weighted(u)),
            Kind::LambertThrough => Some(flip(cosine_weighted(u))),
            Kind::Eon(eon) => Some(eon.sample(outgoing, u)),
            Kind::Sheen(_) => Some(Sheen::sample(u)),
            Kind::Facets { facets, through, .. } => {
                let incoming = facets.sample_open(outgoing, (choice, u), |m, _| {
                    Some(mirrored(outgoing, m)).filter(|incoming| incoming.z > 0.0)
                });
                incoming.map(|incoming| if through { flip(incoming) } else { incoming })
            }
            Kind::Glass { glass, .. } => glass.sample(outgoing, choice, u),
            Kind::Phase(phase) => Some(phase.sample(-outgoing, u)),
            Kind::Mirror | Kind::Refraction { .. } | Kind::Straight => None,
        }
    }

    /// Where light must come from, if the lobe is sharp.
    fn only_direction(&self, outgoing: Vec3) -> Option<Vec3> {
        match self.kind {
            Kind::Mirror => {
                let normal = self.own_frame().map_or(Vec3::Z, |own| own.normal);
                Some(mirrored(outgoing, normal))
            }
            Kind::Straight => Some(-outgoing),
            Kind::Refraction { eta, cos_beyond } => {
                Some(refracted(outgoing, Vec3::Z, eta, cos_beyond).normalize())
            }
            _ => None,
        }
    }
}

/// A lobe whose density is its BSDF × cosine.
fn same(density: f32) -> (Rgb, f32) {
    (Rgb::splat(density), density)
}

/// D G F / 4 cos cos, times the cosine; and the same without F.
fn reflect(facets: Ggx, fresnel: Fresnel, outgoing: Vec3, incoming: Vec3) -> (Rgb, f32) {
    let m = (outgoing + incoming).normalize_or(Vec3::Z);
    let cos = outgoing.dot(m).clamp(0.0, 1.0);
    let around = facets.density(m) / (4.0 * outgoing.z);
    let value = around * facets.both_visible(outgoing, incoming);
    (fresnel.at(cos) * value, value)
}
