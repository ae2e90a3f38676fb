//! EULUMDAT, as Stockmar wrote it down in 1990: one value on each line.

use super::super::text::{Line, Lines, lossy};
use super::{MOST_DIRECTIONS, Read, intensities, whole_turn};
use crate::diagnostic::Diagnostic;
use crate::scene::description::{Goniometer, PhotometricWeb};

/// Sets of lamps in a luminaire, at most.
const MOST_SETS: usize = 20;

pub(super) fn read(bytes: &[u8], name: &str) -> Read<PhotometricWeb> {
    let mut values = Values { name, lines: Lines::new(bytes), last: Line { number: 0, text: &[] } };
    values.skip(2)?;
    let symmetry = Symmetry::of(values.number("the symmetry")?)
        .ok_or_else(|| values.fail("needs a symmetry from 0 to 4"))?;
    let planes = values.count("a number of C planes")?;
    values.skip(1)?;
    let rows = values.count("a number of intensities in a plane")?;
    // To the name and size of the luminaire.
    values.skip(17)?;
    let factor = values.number("the factor of the intensities")?;
    values.skip(1)?;
    let sets = values.count("a number of sets of lamps")?.min(MOST_SETS);
    let lumens = lamp_flux(&mut values, sets)?;
    values.skip(10)?;
    let angles = values.angles(planes, 360.0, "C angles")?;
    let vertical = values.angles(rows, 180.0, "gamma angles")?;
    if rows.saturating_mul(planes) > MOST_DIRECTIONS {
        return Err(values.fail(format!("has more than {MOST_DIRECTIONS} directions")));
    }
    let angles = symmetry
        .measured(angles)
        .ok_or_else(|| values.fail(format!("{planes} C planes do not fit its symmetry")))?;
    let mut all = Vec::new();
    for _ in 0..angles.len() {
        let plane = (0..rows).map(|_| values.number("an intensity"));
        all.push(plane.collect::<Read<Vec<f64>>>()?);
    }
    if symmetry == Symmetry::C90 {
        // They come from C270 over C0 to C90, which mirror C270 down to C90.
        all.reverse();
    }
    let all = all.concat();
    // Given for 1000 lm of the lamps.
    let all = intensities(&all, factor.max(0.0) * lumens / 1000.0, name)?;
    let (horizontal, intensities) = whole_turn(angles, &all, rows);
    Ok(PhotometricWeb {
        name: name.into(),
        goniometer: Goniometer::C,
        horizontal,
        vertical: vertical.into_iter().map(f64::to_radians).collect(),
        intensities,
        lamp_flux: Some(lumens),
    })
}

/// Flux of all lamps of the first set, lm; the sets are alternatives.
fn lamp_flux(values: &mut Values<'_>, sets: usize) -> Read<f64> {
    let mut first = None;
    for _ in 0..sets {
        values.skip(2)?;
        let flux = values.number("the luminous flux of the lamps")?;
        first.get_or_insert(flux);
        values.skip(3)?;
    }
    let flux = first.unwrap_or_default();
    if flux > 0.0 { Ok(flux) } else { Err(values.fail("needs lamps with a luminous flux")) }
}

/// Which planes are the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Symmetry {
    /// None.
    None,
    /// All.
    Axis,
    /// Mirrored by the plane C0–C180.
    C0,
    /// Mirrored by the plane C90–C270.
    C90,
    /// By both.
    Both,
}

impl Symmetry {
    fn of(number: f64) -> Option<Self> {
        const ALL: [Symmetry; 5] =
            [Symmetry::None, Symmetry::Axis, Symmetry::C0, Symmetry::C90, Symmetry::Both];
        ALL.into_iter()
            .zip(0..)
            .find(|(_, n)| f64::from(*n) == number)
            .map(|(symmetry, _)| symmetry)
    }

    /// Those of the angles that have intensities, or whose mirror images have; `None` if they are not where they have to
    /// be.
    fn measured(self, angles: Vec<f64>) -> Option<Vec<f64>> {
        let [from, to] = match self {
            Self::None => return Some(angles),
            Self::Axis => return Some(vec![0.0]),
            Self::C0 => [0.0, 180.0],
            Self::C90 => [90.0, 270.0],
            Self::Both => [0.0, 90.0],
        };
        let inside: Vec<_> =
            angles.into_iter().filter(|angle| (from..=to).contains(angle)).collect();
        let fits = inside.first() == Some(&from) && inside.last() == Some(&to);
        fits.then_some(inside)
    }
}

/// The values, line by line.
struct Values<'a> {
    name: &'a str,
    lines: Lines<'a>,
    last: Line<'a>,
}

impl Values<'_> {
    fn line(&mut self, what: &str) -> Read<()> {
        let Some(line) = self.lines.next() else {
            let message = format!("the file ends where {what} should be");
            return Err(Box::new(Diagnostic::new(self.name, message)));
        };
        self.last = line;
        Ok(())
    }

    fn skip(&mut self, lines: usize) -> Read<()> {
        (0..lines).try_for_each(|_| self.line("a line of the header"))
    }

    /// The number on the next line; some countries write it with a comma.
    fn number(&mut self, what: &str) -> Read<f64> {
        self.line(what)?;
        let text = lossy(self.last.text.trim_ascii()).replace(',', ".");
        let number = text.parse().ok().filter(|number: &f64| number.is_finite());
        number.ok_or_else(|| self.fail(format!("needs a number: {what}")))
    }

    fn count(&mut self, what: &str) -> Read<usize> {
        let number = self.number(what)?;
        let whole = number.fract() == 0.0 && (1.0..=721.0).contains(&number);
        if whole {
            Ok(number as usize)
        } else {
            Err(self.fail(format!("needs {what} from 1 to 721")))
        }
    }

    /// So many angles, degrees, ascending from 0 to `end`.
    fn angles(&mut self, count: usize, end: f64, what: &str) -> Read<Vec<f64>> {
        let mut angles: Vec<f64> = Vec::new();
        for _ in 0..count {
            let angle = self.number(what)?;
            let ascends = angles.last().is_none_or(|last| angle > *last);
            if !ascends || !(0.0..=end).contains(&angle) {
                return Err(self.fail(format!("needs ascending {what} from 0 to {end} degrees")));
            }
            angles.push(angle);
        }
        Ok(angles)
    }

    fn fail(&self, message: impl Into<String>) -> Box<Diagnostic> {
        Box::new(self.last.complain(self.name, message))
    }
}
