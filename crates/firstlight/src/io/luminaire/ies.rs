//! IES LM-63: 1986, 1991, 1995, 2002 and 2019.

use super::super::text::{Line, Lines, lossy};
use super::{MOST_DIRECTIONS, Numbers, Read, intensities, whole_turn};
use crate::diagnostic::Diagnostic;
use crate::scene::description::{Goniometer, PhotometricWeb};

pub(super) fn read(bytes: &[u8], name: &str) -> Read<PhotometricWeb> {
    let mut lines = Lines::new(bytes);
    let tilt = tilt(&mut lines, name)?;
    let mut numbers = Numbers::new(name, lines);
    if tilt == Tilt::Included {
        skip_tilt(&mut numbers)?;
    }
    let lamps = numbers.number("the number of lamps")?;
    let lumens = numbers.number("the lumens of a lamp")?;
    let multiplier = numbers.number("the multiplier")?;
    let rows = numbers.count("a number of vertical angles")?;
    let columns = numbers.count("a number of horizontal angles")?;
    if rows.saturating_mul(columns) > MOST_DIRECTIONS {
        return Err(numbers.fail(format!("has more than {MOST_DIRECTIONS} directions")));
    }
    let goniometer = goniometer(&mut numbers)?;
    numbers.list(4, "the unit and size of the luminaire")?;
    let ballast = numbers.number("the ballast factor")?;
    let ballast_lamp = numbers.number("the ballast-lamp factor")?;
    numbers.number("the input watts")?;
    let (up_and_down, around) = match goniometer {
        Goniometer::C => ([0.0, 180.0], [0.0, 360.0]),
        _ => ([-90.0, 90.0], [-90.0, 90.0]),
    };
    let vertical = numbers.angles(rows, up_and_down, "vertical angles")?;
    let horizontal = numbers.angles(columns, around, "horizontal angles")?;
    let values = numbers.list(rows * columns, "an intensity")?;
    let values = intensities(&values, multiplier * ballast * ballast_lamp, name)?;
    let (horizontal, intensities) = match goniometer {
        Goniometer::C => whole_turn(horizontal, &values, rows),
        _ => (horizontal.into_iter().map(f64::to_radians).collect(), values),
    };
    Ok(PhotometricWeb {
        name: name.into(),
        goniometer,
        horizontal,
        vertical: vertical.into_iter().map(f64::to_radians).collect(),
        intensities,
        // −1 lumens: measured without regard to the lamps.
        lamp_flux: (lumens > 0.0 && lamps > 0.0).then_some(lamps * lumens),
    })
}

/// How the light of the lamps depends on the tilt of the luminaire.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Tilt {
    None,
    Included,
}

/// Skips everything up to the line with `TILT=`.
fn tilt(lines: &mut Lines<'_>, name: &str) -> Read<Tilt> {
    let is_tilt = |line: &Line<'_>| {
        let start = line.text.trim_ascii_start().get(..5);
        start.is_some_and(|start| start.eq_ignore_ascii_case(b"TILT="))
    };
    let Some(line) = lines.find(is_tilt) else {
        let error = Diagnostic::new(name, "this is not an IES file: it has no line with TILT=");
        return Err(Box::new(error.help("IES LM-63 (.ies) and EULUMDAT (.ldt) files can be read")));
    };
    let value = line.text.trim_ascii().get(5..).unwrap_or_default().trim_ascii();
    match value.to_ascii_uppercase().as_slice() {
        b"NONE" => Ok(Tilt::None),
        b"INCLUDE" => Ok(Tilt::Included),
        _ => {
            let message = format!("refers to another file for its tilt: {}", lossy(value));
            let error = line.complain(name, message);
            Err(Box::new(error.help("write TILT=NONE if the luminaire is used as it was measured")))
        }
    }
}

/// Skips how the light of the lamps depends on tilt: the luminaire is used as it was measured.
fn skip_tilt(numbers: &mut Numbers<'_>) -> Read<()> {
    numbers.number("how the lamps lie in the luminaire")?;
    let count = numbers.count("a number of tilt angles")?;
    numbers.list(2 * count, "a tilt angle or its factor")?;
    Ok(())
}

fn goniometer(numbers: &mut Numbers<'_>) -> Read<Goniometer> {
    match numbers.number("the photometric type")? {
        1.0 => Ok(Goniometer::C),
        2.0 => Ok(Goniometer::B),
        3.0 => Ok(Goniometer::A),
        other => Err(numbers.fail(format!("needs photometric type 1, 2 or 3, not {other}"))),
    }
}
