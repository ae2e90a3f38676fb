//! Measured luminaires: IES LM-63 and EULUMDAT files → [`PhotometricWeb`].

mod eulumdat;
mod ies;
#[cfg(test)]
mod tests;

use super::text::{Line, Lines};
use crate::diagnostic::{Diagnostic, Result};
use crate::scene::description::PhotometricWeb;

/// Directions of a luminaire, at most.
const MOST_DIRECTIONS: usize = 1 << 22;

/// Reads a luminaire; an EULUMDAT file is recognised by its name (`.ldt`), all others are LM-63.
///
/// # Errors
/// If a line cannot be read, angles are not ascending, intensities are missing, negative or no numbers.
pub fn read(bytes: &[u8], name: &str) -> Result<PhotometricWeb> {
    let is_eulumdat = name.to_ascii_lowercase().ends_with(".ldt");
    if is_eulumdat { eulumdat::read(bytes, name) } else { ies::read(bytes, name) }
}

/// What was read, or the complaint.
type Read<T> = std::result::Result<T, Box<Diagnostic>>;

/// The numbers of a text, wherever its lines end.
struct Numbers<'a> {
    name: &'a str,
    lines: Lines<'a>,
    /// Words of the line that is being read.
    words: Vec<&'a [u8]>,
    line: Line<'a>,
}

impl<'a> Numbers<'a> {
    fn new(name: &'a str, lines: Lines<'a>) -> Self {
        let line = Line { number: 0, text: &[] };
        Self { name, lines, words: Vec::new(), line }
    }

    /// The next number; `what` it is.
    fn number(&mut self, what: &str) -> Read<f64> {
        while self.words.is_empty() {
            let Some(line) = self.lines.next() else {
                let message = format!("the file ends where {what} should be");
                return Err(Box::new(Diagnostic::new(self.name, message)));
            };
            let words = line.text.split(|byte| byte.is_ascii_whitespace() || *byte == b',');
            self.words = words.filter(|word| !word.is_empty()).collect();
            self.words.reverse();
            self.line = line;
        }
        let word = self.words.pop().unwrap_or_default();
        let number = str::from_utf8(word).ok().and_then(|text| text.parse().ok());
        number
            .filter(|number: &f64| number.is_finite())
            .ok_or_else(|| self.fail(format!("needs a number: {what}")))
    }

    /// The next number, which counts something: at least 1.
    fn count(&mut self, what: &str) -> Read<usize> {
        let number = self.number(what)?;
        let whole = number.fract() == 0.0 && (1.0..=MOST_DIRECTIONS as f64).contains(&number);
        let message = || format!("needs {what} from 1 to {MOST_DIRECTIONS}, not {number}");
        if whole { Ok(number as usize) } else { Err(self.fail(message())) }
    }

    /// So many numbers.
    fn list(&mut self, count: usize, what: &str) -> Read<Vec<f64>> {
        // Each takes two bytes at least: a count that lies asks for no more memory than the file has.
        let mut numbers =
            Vec::with_capacity(count.min(self.lines.rest().len() / 2 + self.words.len()));
        for _ in 0..count {
            numbers.push(self.number(what)?);
        }
        Ok(numbers)
    }

    /// So many angles, degrees, ascending between the bounds.
    fn angles(&mut self, count: usize, bounds: [f64; 2], what: &str) -> Read<Vec<f64>> {
        let angles = self.list(count, what)?;
        let inside = |angle: &&f64| !(bounds[0]..=bounds[1]).contains(*angle);
        if let Some(outside) = angles.iter().find(inside) {
            let [from, to] = bounds;
            return Err(
                self.fail(format!("needs {what} from {from} to {to} degrees, not {outside}"))
            );
        }
        match angles.is_sorted_by(|a, b| a < b) {
            true => Ok(angles),
            false => Err(self.fail(format!("needs ascending {what}"))),
        }
    }

    fn fail(&self, message: impl Into<String>) -> Box<Diagnostic> {
        Box::new(self.line.complain(self.name, message))
    }
}

/// Intensities in candela, none negative.
fn intensities(values: &[f64], factor: f64, name: &str) -> Read<Vec<f32>> {
    let candela = |value: &f64| (value * factor) as f32;
    let values: Vec<f32> = values.iter().map(candela).collect();
    match values.iter().find(|value| !(**value >= 0.0 && value.is_finite())) {
        None => Ok(values),
        Some(wrong) => {
            let message = format!("an intensity is {wrong} cd: light is never less than none");
            Err(Box::new(Diagnostic::new(name, message)))
        }
    }
}

/// Angles and intensities of a quarter, a half or the whole of a turn, continued to the whole by its mirror planes.
///
/// `planes`: horizontal angles in degrees, ascending, each with its intensities of `rows` vertical angles.
fn whole_turn(planes: Vec<f64>, values: &[f32], rows: usize) -> (Vec<f64>, Vec<f32>) {
    let (first, last) = (planes[0], planes[planes.len() - 1]);
    let mut all: Vec<(f64, usize)> = planes.iter().copied().zip(0..).collect();
    let mut mirror = |axis: f64| {
        let mirrored: Vec<_> =
            all.iter().map(|(angle, plane)| (2.0 * axis - angle, *plane)).collect();
        all.extend(mirrored);
    };
    match (first, last) {
        // One quarter stands for all four.
        (0.0, 90.0) => {
            mirror(90.0);
            mirror(180.0);
        }
        (0.0, 180.0) => mirror(180.0),
        (90.0, 270.0) => mirror(270.0),
        _ => {}
    }
    all.iter_mut().for_each(|(angle, _)| *angle = angle.rem_euclid(360.0));
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    all.dedup_by_key(|(angle, _)| *angle);
    let angles = all.iter().map(|(angle, _)| angle.to_radians()).collect();
    let values = all.iter().flat_map(|(_, plane)| &values[plane * rows..][..rows]);
    (angles, values.copied().collect())
}
