//! The values after a PLY header, one after the other, as text or binary.

use super::header::{Header, Property, Scalar};
use crate::diagnostic::{Diagnostic, Place};
use crate::io::Warnings;
use crate::io::text::{Parsed, Tally, counted, float, part_of, quoted, whole};

/// Reads one value after the other; every type fits an `f64` without loss.
pub(super) trait Values {
    /// The next value, or why there is none.
    fn next(&mut self, kind: Scalar) -> Parsed<f64>;

    /// How many bytes one value takes at least.
    fn least_size(kind: Scalar) -> u64;

    /// Bytes that have not been read.
    fn left(&self) -> u64;

    /// Where the next value is.
    fn place(&self, name: &str) -> Place;

    /// Bytes that `property` takes at least: of a list, only its length.
    fn least_size_of(property: &Property) -> u64 {
        Self::least_size(property.length.unwrap_or(property.value))
    }

    /// The number of values that follow for `property`, checked against the bytes that are there.
    #[inline]
    fn length(&mut self, property: &Property) -> Parsed<usize> {
        let Some(kind) = property.length else { return Ok(1) };
        let length = self.next(kind)?;
        let bytes = (length as u64).saturating_mul(Self::least_size(property.value));
        if length as u64 as f64 != length || bytes > self.left() {
            let (name, left) = (quoted(property.name.as_bytes()), self.left());
            return Err(format!("list {name} of length {length}, but {left} bytes follow"));
        }
        Ok(length as usize)
    }

    /// Reads over `property`.
    fn skip(&mut self, property: &Property) -> Parsed<()> {
        for _ in 0..self.length(property)? {
            self.next(property.value)?;
        }
        Ok(())
    }

    /// Goes to where the next row starts.
    fn end_row(&mut self, name: &str);

    /// Warns about what was passed over.
    fn warn(self, _warnings: &mut Warnings);

    /// A complaint about the value that comes next.
    fn complain(&self, name: &str, message: String) -> Box<Diagnostic> {
        Box::new(Diagnostic { message, place: self.place(name), ..Diagnostic::default() })
    }
}

const END: &str = "the file ends too early";

/// Values written as words, a line for every row.
#[derive(Debug)]
pub(super) struct Words<'a> {
    rest: &'a [u8],
    line: usize,
    surplus: Tally,
}

impl<'a> Words<'a> {
    pub(super) fn new(header: &Header<'a>) -> Self {
        Self { rest: header.body, line: header.lines + 1, surplus: Tally::default() }
    }
}

impl Values for Words<'_> {
    fn next(&mut self, kind: Scalar) -> Parsed<f64> {
        while let Some((byte, rest)) =
            self.rest.split_first().filter(|(b, _)| b.is_ascii_whitespace())
        {
            self.line += usize::from(*byte == b'\n');
            self.rest = rest;
        }
        let length = self.rest.iter().position(u8::is_ascii_whitespace);
        let (word, rest) = self.rest.split_at(length.unwrap_or(self.rest.len()));
        self.rest = rest;
        if word.is_empty() {
            return Err(END.into());
        }
        number(word, kind).ok_or_else(|| format!("cannot read {} as a number", quoted(word)))
    }

    /// A digit and a blank.
    fn least_size(_kind: Scalar) -> u64 {
        2
    }

    fn left(&self) -> u64 {
        self.rest.len() as u64 + 1
    }

    fn place(&self, name: &str) -> Place {
        Place { file: name.into(), line: Some(self.line), ..Place::default() }
    }

    /// Some programs write more values in a line than their header announces.
    fn end_row(&mut self, name: &str) {
        let length = self.rest.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
        let (surplus, rest) = self.rest.split_at(length.unwrap_or(self.rest.len()));
        if !surplus.trim_ascii().is_empty() {
            let place = self.place(name);
            self.surplus.add(|| place);
        }
        self.rest = rest;
    }

    fn warn(self, warnings: &mut Warnings) {
        self.surplus.warn(warnings, |count| {
            format!(
                "{} with more values than the header says: the rest ignored",
                counted(count, "line")
            )
        });
    }
}

fn number(word: &[u8], kind: Scalar) -> Option<f64> {
    let exact = || str::from_utf8(word).ok()?.parse::<f64>().ok();
    match kind {
        Scalar::F32 => float(word).map(f64::from),
        Scalar::F64 => exact().or_else(|| float(word).map(f64::from)),
        _ => whole(word).map(|value| value as f64).or_else(exact),
    }
}

/// Values written as bytes, the most significant one first if `BIG`.
#[derive(Debug)]
pub(super) struct Binary<'a, const BIG: bool> {
    rest: &'a [u8],
    length: usize,
}

impl<'a, const BIG: bool> Binary<'a, BIG> {
    /// The values of `body`, the end of a file of `length` bytes.
    pub(super) fn new(header: &Header<'a>, length: usize) -> Self {
        Self { rest: header.body, length }
    }

    /// The next `N` bytes, the least significant one first.
    #[inline]
    fn take<const N: usize>(&mut self) -> Parsed<[u8; N]> {
        let (bytes, rest) = self.rest.split_first_chunk().ok_or(END)?;
        self.rest = rest;
        let mut bytes = *bytes;
        if BIG {
            bytes.reverse();
        }
        Ok(bytes)
    }
}

impl<const BIG: bool> Values for Binary<'_, BIG> {
    #[inline]
    fn next(&mut self, kind: Scalar) -> Parsed<f64> {
        Ok(match kind {
            Scalar::I8 => i8::from_le_bytes(self.take()?).into(),
            Scalar::U8 => u8::from_le_bytes(self.take()?).into(),
            Scalar::I16 => i16::from_le_bytes(self.take()?).into(),
            Scalar::U16 => u16::from_le_bytes(self.take()?).into(),
            Scalar::I32 => i32::from_le_bytes(self.take()?).into(),
            Scalar::U32 => u32::from_le_bytes(self.take()?).into(),
            Scalar::F32 => f32::from_le_bytes(self.take()?).into(),
            Scalar::F64 => f64::from_le_bytes(self.take()?),
        })
    }

    fn least_size(kind: Scalar) -> u64 {
        kind.size()
    }

    fn left(&self) -> u64 {
        self.rest.len() as u64
    }

    fn end_row(&mut self, _name: &str) {}

    fn warn(self, _warnings: &mut Warnings) {}

    fn place(&self, name: &str) -> Place {
        part_of(name, format!("byte {}", self.length - self.rest.len()))
    }
}
