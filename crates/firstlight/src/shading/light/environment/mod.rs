//! Light from directions that hit nothing: what comes from where, and where it pays to look.

mod blocks;
mod cie;
mod preetham;
mod shares;
mod sky;
mod sun;
mod table;
#[cfg(test)]
mod tests;

pub(crate) use blocks::{Ask, Meet};
pub(crate) use preetham::TURBIDITIES;
pub(crate) use sky::sunlight;
pub(crate) use sun::Sun;
pub(crate) use table::Aim;

use crate::color::Rgb;
use crate::scene::description::Sky;
use glam::{DVec2, Mat3, Vec2, Vec3};
use sky::{Radiance, Spot};
use table::{Cell, DirectionTable, Picked, direction, place};

/// An infinitely large sphere of light around everything.
#[derive(Debug, Clone)]
pub(crate) struct Environment {
    radiance: Radiance,
    /// Multiplies what comes from the sky.
    factor: Rgb,
    /// From the world to the sky's own space: x east, y north, z up.
    to_sky: Mat3,
    /// Where to look; `None` where every direction is as good as another.
    table: Option<DirectionTable>,
}

/// A direction of the environment that chance picked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct EnvironmentSample {
    /// Unit vector to where the light comes from.
    pub incoming: Vec3,
    /// What comes from there, W·sr⁻¹·m⁻².
    pub radiance: Rgb,
    /// Density of `incoming`, sr⁻¹.
    pub pdf: f32,
}

impl Environment {
    /// `to_sky` turns the world into the sky's own space; `factor` multiplies its radiance.
    pub(crate) fn new(sky: &Sky, factor: Rgb, to_sky: Mat3, aim: Aim) -> Self {
        let radiance = Radiance::new(sky);
        let table = radiance.table(aim);
        Self { radiance, factor, to_sky, table }
    }

    /// What comes from the unit direction `incoming`, W·sr⁻¹·m⁻².
    pub(crate) fn radiance(&self, incoming: Vec3) -> Rgb {
        let own = self.to_sky * incoming;
        self.at(own, &self.radiance.spot(place(own.as_dvec3())))
    }

    /// Density with which [`Environment::sample`] picks the unit direction `incoming`, sr⁻¹; 0 where it never looks.
    pub(crate) fn pdf(&self, incoming: Vec3) -> f32 {
        self.density(self.cell(place((self.to_sky * incoming).as_dvec3())))
    }

    /// A direction picked by two numbers in 0..1, bright ones more often; `None` if no direction is to be preferred.
    pub(crate) fn sample(&self, u: Vec2) -> Option<EnvironmentSample> {
        let Picked { around, z, pdf } = self.table.as_ref()?.pick(u.as_dvec2());
        let own = direction(around, z);
        let incoming = self.to_sky.transpose() * own.as_vec3();
        let radiance = self.at(own.as_vec3(), &self.radiance.spot(place(own)));
        Some(EnvironmentSample { incoming, radiance, pdf: pdf as f32 })
    }

    /// What comes from the unit direction `own` in the sky's own space, which has this spot.
    #[inline(always)]
    fn at(&self, own: Vec3, spot: &Spot) -> Rgb {
        self.factor * self.radiance.at(own, spot)
    }

    /// The table's cell of the direction with this [`place`].
    #[inline(always)]
    fn cell(&self, place: DVec2) -> Cell {
        match &self.table {
            Some(table) => table.cell(place),
            None => Cell::default(),
        }
    }

    /// Density of the directions of a cell, sr⁻¹.
    #[inline(always)]
    fn density(&self, cell: Cell) -> f32 {
        match &self.table {
            Some(table) => table.pdf(cell) as f32,
            None => 0.0,
        }
    }
}
