//! Lobes on top of each other: what an upper layer does not reflect is left for those below.
//!
//! Energy is counted from the eye's side: a layer takes what it scatters of light that comes from the eye, whatever
//! direction it goes to, so that nothing is lost and nothing is won. That is not reciprocal where layers lie on top of
//! each other, and neither is [`Layers::facets`]; a path that starts at the eye needs no more.

use super::albedo;
use super::diffuse::Eon;
use super::fresnel::{Fresnel, Gloss, dielectric};
use super::ggx::Ggx;
use super::glass::Glass;
use super::sheen::Sheen;
use super::{Frame, Kind, Lobe, above};
use crate::color::Rgb;
use crate::scene::description::Interior;
use glam::{Vec2, Vec3, Vec3Swizzles};

/// Adds the lobes of one point to a list, from the top.
#[derive(Debug)]
pub(crate) struct Layers<'a> {
    lobes: &'a mut Vec<Lobe>,
    start: usize,
    /// Unit vector to the eye in the frame of the surface; its third coordinate is positive.
    pub outgoing: Vec3,
    /// What is left for the next layer.
    pub left: Rgb,
    /// Whether what facets scatter more than once is added to what they scatter once.
    pub multiple_scattering: bool,
    /// The fraction of light that the lobes scatter, as far as there are any.
    scattered: Rgb,
}

/// What varnish of index 1.5 reflects.
pub(crate) const VARNISH: Fresnel = Fresnel::Schlick { normal: Rgb::splat(0.04), grazing: 1.0 };

/// How wide facets lean along tangent and bitangent: roughness², not yet bounded below.
pub(crate) type Alpha = Vec2;

impl<'a> Layers<'a> {
    /// For light that leaves along `outgoing`.
    pub(crate) fn new(lobes: &'a mut Vec<Lobe>, outgoing: Vec3) -> Self {
        Self {
            start: lobes.len(),
            lobes,
            outgoing,
            left: Rgb::ONE,
            multiple_scattering: true,
            scattered: Rgb::ZERO,
        }
    }

    /// Adds a lobe that scatters the fraction `albedo` of what is left, times `weight`.
    pub(crate) fn add(&mut self, kind: Kind, weight: Rgb, albedo: Rgb) {
        let (weight, scattered) = (self.left * weight, self.left * weight * albedo);
        self.scattered += scattered;
        let share = scattered.max_element();
        if share > 0.0 {
            self.lobes.push(Lobe { share, ..Lobe::new(kind, weight) });
        }
    }

    /// Shares become the probabilities with which lobes are picked. Returns the fraction of light scattered in all.
    pub(crate) fn finish(self) -> Rgb {
        let lobes = &mut self.lobes[self.start..];
        let sum: f32 = lobes.iter().map(|lobe| lobe.share).sum();
        lobes.iter_mut().for_each(|lobe| lobe.share /= sum);
        self.scattered
    }

    /// A matte ground; `roughness` 0 is Lambert's.
    pub(crate) fn matte(&mut self, color: Rgb, roughness: f32) {
        if roughness <= 0.0 {
            return self.add(Kind::Lambert, color, Rgb::ONE);
        }
        let eon = Eon { color, roughness: roughness.min(1.0) };
        self.add(Kind::Eon(eon), Rgb::ONE, eon.albedo(self.outgoing.z));
    }

    /// What light that facets scatter once, the fraction `once` of what they get, is multiplied by to make up for the rest.
    fn gain(&self, once: f32) -> f32 {
        if self.multiple_scattering { 1.0 / once } else { 1.0 }
    }

    /// Facets that reflect by `fresnel`. Returns the fraction that they reflect in all.
    ///
    /// What they scatter more than once is added in the same directions: Turquin, *Practical Multiple Scattering
    /// Compensation for Microfacet Models*, 2019.
    pub(crate) fn facets(&mut self, fresnel: Fresnel, alpha: Alpha) -> Rgb {
        let cos = self.outgoing.z;
        let Some(facets) = rough(alpha) else {
            let reflected = fresnel.at(cos);
            self.add(Kind::Mirror, reflected, Rgb::ONE);
            return reflected;
        };
        let (all, grazing) = albedo::facets(self.outgoing, facets.alpha);
        let normal = fresnel.at(1.0);
        let once = match fresnel {
            Fresnel::Schlick { normal, grazing: f90 } => normal * (all - grazing) + f90 * grazing,
            Fresnel::Conductor { .. } => normal * (all - grazing) + grazing,
        };
        let gain = 1.0 + normal * (self.gain(all) - 1.0);
        let kind = Kind::Facets { facets, fresnel, once: all, through: false };
        self.add(kind, gain, once);
        once * gain
    }

    /// The boundary of a transparent solid; `eta`: index beyond over index here, `tint`: colours what passes, `gloss`: what
    /// it reflects, if that is not what the index says.
    pub(crate) fn glass(&mut self, eta: f32, alpha: Alpha, tint: Rgb, gloss: Option<Gloss>) {
        let cos = self.outgoing.z;
        if (eta - 1.0).abs() < Interior::NOTHING {
            return self.add(Kind::Straight, tint, Rgb::ONE);
        }
        let Some(facets) = rough(alpha) else {
            let (exact, beyond) = dielectric(cos.into(), eta.into());
            let exact = Rgb::splat(exact as f32);
            let reflected = gloss.map_or(exact, |gloss| gloss.at(cos, eta));
            self.add(Kind::Mirror, reflected, Rgb::ONE);
            if let Some(beyond) = beyond {
                let (passes, squeezed) = (Rgb::ONE - reflected, eta * eta);
                let kind = Kind::Refraction { eta, cos_beyond: beyond as f32 };
                self.add(kind, passes / squeezed * tint, Rgb::splat(squeezed));
            }
            return;
        };
        let once = albedo::glass(self.outgoing, facets.alpha, eta);
        let kind = Kind::Glass { glass: Glass { facets, eta, once }, tint, gloss };
        self.add(kind, Rgb::splat(self.gain(once)), Rgb::splat(once));
    }

    /// A pane without thickness that reflects by `fresnel` and lets through what is left, times `tint`.
    pub(crate) fn pane(&mut self, fresnel: Fresnel, alpha: Alpha, tint: Rgb) {
        let reflected = self.facets(fresnel, alpha);
        let passes = (1.0 - reflected.max_element()).max(0.0) * tint;
        let Some(facets) = rough(alpha) else {
            return self.add(Kind::Straight, passes, Rgb::ONE);
        };
        let (all, _) = albedo::facets(self.outgoing, facets.alpha);
        let fresnel = Fresnel::Schlick { normal: Rgb::ONE, grazing: 1.0 };
        let kind = Kind::Facets { facets, fresnel, once: all, through: true };
        self.add(kind, passes * self.gain(all), Rgb::splat(all));
    }

    /// The pane of a window: light goes back and forth between its two smooth sides.
    pub(crate) fn window(&mut self, eta: f32, tint: Rgb) {
        let (once, _) = dielectric(self.outgoing.z.into(), eta.into());
        let reflected = (2.0 * once / (1.0 + once)) as f32;
        self.add(Kind::Mirror, Rgb::splat(reflected), Rgb::ONE);
        self.add(Kind::Straight, (1.0 - reflected) * tint, Rgb::ONE);
    }

    /// A coat of varnish of index 1.5 that covers the fraction `amount`; less is left for what is below. `normal`: its own,
    /// in the frame of the surface.
    pub(crate) fn coat(&mut self, amount: f32, alpha: Alpha, normal: Vec3) {
        let (below, seen, first) = (self.left, self.outgoing, self.lobes.len());
        self.left *= amount;
        let tilt = if normal.z > 0.9999995 { Vec2::ZERO } else { normal.xy() };
        if tilt != Vec2::ZERO {
            self.outgoing = above(Frame::around(normal).to_local(seen));
        }
        let reflected = self.facets(VARNISH, alpha).x;
        self.lobes[first..].iter_mut().for_each(|lobe| lobe.tilt = tilt);
        (self.left, self.outgoing) = (below * (1.0 - amount * reflected), seen);
    }

    /// Cloth's fibres over what is below.
    pub(crate) fn sheen(&mut self, color: Rgb, alpha: f32) {
        let sheen = Sheen { alpha: alpha.max(Sheen::LEAST) };
        // The formula sends back more than all of the light that grazes fine fibres.
        let albedo = albedo::sheen(self.outgoing.z, sheen.alpha);
        let color = color / albedo.max(1.0);
        self.add(Kind::Sheen(sheen), color, Rgb::splat(albedo));
        self.left *= 1.0 - color.max_element() * albedo;
    }
}

fn rough(alpha: Alpha) -> Option<Ggx> {
    (alpha.max_element() >= Ggx::LEAST).then(|| Ggx { alpha: alpha.max(Vec2::splat(Ggx::LEAST)) })
}
