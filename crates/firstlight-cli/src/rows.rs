//! Points to measure, as they are written: six numbers, or rows of them on standard input.

use crate::input::STDIN;
use firstlight::diagnostic::{Diagnostic, Result};
use glam::DVec3;

/// What is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Irradiance,
    Radiance,
}

impl Kind {
    pub(crate) const ALL: [Self; 2] = [Self::Irradiance, Self::Radiance];

    /// Its name on the command line and in reports.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Irradiance => "irradiance",
            Self::Radiance => "radiance",
        }
    }
}

/// Where something is measured, and in which direction: that of the surface's normal, or the ray's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Query {
    pub kind: Kind,
    pub point: DVec3,
    /// A unit vector.
    pub direction: DVec3,
}

impl Query {
    /// From a point and a direction of any length, `x,y,z,dx,dy,dz`.
    pub(crate) fn parse(kind: Kind, text: &str) -> std::result::Result<Self, String> {
        Self::of_fields(kind, &text.split(',').collect::<Vec<_>>())
    }

    fn of_fields(kind: Kind, fields: &[&str]) -> std::result::Result<Self, String> {
        let mut numbers = [0.0; 6];
        if fields.len() != numbers.len() {
            return Err(format!(
                "needs six numbers (a point and a direction), not {}",
                fields.len()
            ));
        }
        for (number, field) in numbers.iter_mut().zip(fields) {
            let value = field.trim().parse().ok().filter(|value: &f64| value.abs() <= 1e15);
            *number = value.ok_or_else(|| {
                let field: String = field.trim().chars().take(40).collect();
                format!("needs six numbers of at most 1e15, not {field:?}")
            })?;
        }
        let [x, y, z, dx, dy, dz] = numbers;
        let (point, direction) = (DVec3::new(x, y, z), DVec3::new(dx, dy, dz));
        // Scaled first, so that no square overflows or vanishes.
        let direction = (direction / direction.abs().max_element()).try_normalize();
        let direction = direction.ok_or("the direction (the last three numbers) has no length")?;
        Ok(Self { kind, point, direction })
    }
}

/// The rows of a table: of one kind, or with the kind in front. Blank lines, lines that start with `#` and a row of
/// headings at the top are passed over.
pub(crate) fn read(text: &str, kind: Option<Kind>) -> Result<Vec<Query>> {
    let mut queries = Vec::new();
    let mut first = true;
    for (index, line) in text.lines().enumerate() {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let fields: Vec<&str> = line.split(',').map(str::trim).collect();
        let is_heading = std::mem::take(&mut first) && is_heading(&fields, kind);
        if !is_heading {
            queries.push(row(&fields, kind).map_err(|message| {
                Diagnostic::new(STDIN, message).at_part(format!("row {}", index + 1))
            })?);
        }
    }
    Ok(queries)
}

/// Whether these are names of columns: as many as there should be, and not a number among them.
fn is_heading(fields: &[&str], kind: Option<Kind>) -> bool {
    let columns = if kind.is_some() { 6 } else { 7 };
    fields.len() == columns && fields.iter().all(|field| field.parse::<f64>().is_err())
}

fn row(fields: &[&str], kind: Option<Kind>) -> std::result::Result<Query, String> {
    match (kind, fields) {
        (Some(kind), fields) => Query::of_fields(kind, fields),
        (None, [name, fields @ ..]) => {
            let kind = Kind::ALL.into_iter().find(|kind| kind.name().eq_ignore_ascii_case(name));
            Query::of_fields(
                kind.ok_or("needs irradiance or radiance in its first column")?,
                fields,
            )
        }
        (None, []) => Err("is empty".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_need_not_be_unit_vectors() {
        let query = Query::parse(Kind::Radiance, " 1, -2 ,3.5,0,0,-7").unwrap();
        assert_eq!((query.point, query.direction), (DVec3::new(1.0, -2.0, 3.5), DVec3::NEG_Z));
        for tiny in ["0,0,0,1e-300,0,0", "0,0,0,1e15,0,0"] {
            assert_eq!(Query::parse(Kind::Radiance, tiny).unwrap().direction, DVec3::X);
        }
    }

    #[test]
    fn bad_numbers_are_refused() {
        let bad = [
            "",
            "1,2,3",
            "1,2,3,0,0,0",
            "a,0,0,0,0,1",
            "nan,0,0,0,0,1",
            "0,0,0,inf,0,1",
            "1e16,0,0,0,0,1",
        ];
        for text in bad {
            assert!(Query::parse(Kind::Irradiance, text).is_err(), "{text}");
        }
    }

    #[test]
    fn tables_may_have_headings_comments_and_blank_lines() {
        let text = "# points\nx,y,z,nx,ny,nz\n\n0,0,0,0,0,1\r\n  # more\n1,0,0,0,0,1\n";
        let queries = read(text, Some(Kind::Irradiance)).unwrap();
        assert_eq!(queries.len(), 2);
        assert_eq!(queries[1].point, DVec3::X);
        let text = "kind,x,y,z,dx,dy,dz\nradiance,0,0,0,0,0,1\nIrradiance,0,0,0,0,0,1";
        let kinds: Vec<_> = read(text, None).unwrap().iter().map(|q| q.kind).collect();
        assert_eq!(kinds, [Kind::Radiance, Kind::Irradiance]);
    }

    #[test]
    fn a_bad_row_is_named() {
        let text = "0,0,0,0,0,1\n\n0,0,x,0,0,1";
        let error = read(text, Some(Kind::Irradiance)).unwrap_err().to_string();
        assert!(error.starts_with("standard input: row 3: needs six numbers"), "{error}");
        let error = read("x,y,z,nx,ny,nz\nx,y,z,nx,ny,nz", Some(Kind::Radiance)).unwrap_err();
        assert_eq!(error.place.part.as_deref(), Some("row 2"));
        assert!(read("illuminance,0,0,0,0,0,1", None).is_err());
        assert!(read("what", None).is_err());
    }
}
