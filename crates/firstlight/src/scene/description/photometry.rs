//! What a luminaire gives in each direction, as it was measured.

/// Luminous intensities over a grid of directions, with straight lines between them.
#[derive(Debug, Clone, PartialEq)]
pub struct PhotometricWeb {
    /// Where it came from, for messages.
    pub name: String,
    /// What the angles mean.
    pub goniometer: Goniometer,
    /// Horizontal angles, rad, ascending; at least one. With [`Goniometer::C`] they start at 0 and end below 2π, and
    /// a single one means that all are the same.
    pub horizontal: Vec<f64>,
    /// Vertical angles, rad, ascending; at least one. Outside them it is dark.
    pub vertical: Vec<f64>,
    /// cd; those of one horizontal angle after the other.
    pub intensities: Vec<f32>,
    /// Luminous flux of the lamps inside, lm, if it was given.
    pub lamp_flux: Option<f64>,
}

/// How directions are counted, in the luminaire's own space: its axis, along which it mainly shines, is −z, as if it hung
/// from a ceiling.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Goniometer {
    /// Vertical: from the axis; horizontal: around it, from x towards y. What buildings use.
    C,
    /// Vertical: around x, from the axis towards y; horizontal: from the plane of these, towards x. What floodlights use.
    B,
    /// Horizontal: around y, from the axis towards x; vertical: from the plane of these, towards y. What vehicles use.
    A,
}
