//! Lines, words, numbers and counted complaints: what the readers of model files share.

use super::Warnings;
use crate::diagnostic::{self, Diagnostic, Place};
use crate::suggest::nearest;

/// What was read, or the cause why not in words; the caller knows the place.
pub(super) type Parsed<T> = Result<T, String>;

/// A line of a text file without its line end.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line<'a> {
    /// Its number, from 1.
    pub(super) number: usize,
    /// Its bytes.
    pub(super) text: &'a [u8],
}

impl<'a> Line<'a> {
    /// The words between blanks, up to a `#` that starts a word.
    pub(super) fn words(&self) -> impl Iterator<Item = &'a [u8]> + use<'a> {
        self.text
            .split(|byte| byte.is_ascii_whitespace())
            .map(|word| word.strip_suffix(b"\\").unwrap_or(word))
            .filter(|word| !word.is_empty())
            .take_while(|word| !word.starts_with(b"#"))
    }

    /// Everything after the first word, without the blanks around it.
    pub(super) fn after_keyword(&self) -> String {
        let text = self.text.trim_ascii();
        let keyword = text.iter().take_while(|byte| !byte.is_ascii_whitespace()).count();
        lossy(text.get(keyword..).unwrap_or_default().trim_ascii())
    }

    /// This line of the file `name`, and its text.
    pub(super) fn place(&self, name: &str) -> Place {
        let source = Some(shortened(self.text.trim_ascii(), 100));
        Place { file: name.into(), line: Some(self.number), source, ..Place::default() }
    }

    /// A complaint about this line of the file `name`, which it shows.
    pub(super) fn complain(&self, name: &str, message: impl Into<String>) -> Diagnostic {
        Diagnostic { message: message.into(), place: self.place(name), ..Diagnostic::default() }
    }
}

/// The lines of a text, ended by `\n`, `\r\n` or `\r`.
#[derive(Debug, Clone)]
pub(super) struct Lines<'a> {
    rest: &'a [u8],
    number: usize,
    joined: bool,
}

impl<'a> Lines<'a> {
    /// The lines of `bytes` as they are, after a byte order mark.
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { rest: without_mark(bytes), number: 0, joined: false }
    }

    /// The same, but a line that ends in `\` (and is no comment) goes on with the next.
    pub(super) fn joined(bytes: &'a [u8]) -> Self {
        Self { joined: true, ..Self::new(bytes) }
    }

    /// What has not been read yet.
    pub(super) fn rest(&self) -> &'a [u8] {
        self.rest
    }

    /// Where the line that starts at `from` ends, and where the next one starts.
    fn line_end(&self, from: usize) -> (usize, usize) {
        let tail = self.rest.get(from..).unwrap_or_default();
        let length = tail.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
        let end = from + length.unwrap_or(tail.len());
        let mark = match self.rest.get(end..) {
            Some([b'\r', b'\n', ..]) => 2,
            Some([_, ..]) => 1,
            _ => 0,
        };
        (end, end + mark)
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = Line<'a>;

    fn next(&mut self) -> Option<Line<'a>> {
        if self.rest.is_empty() {
            return None;
        }
        let number = self.number + 1;
        let joined = self.joined && !self.rest.trim_ascii_start().starts_with(b"#");
        let (mut end, mut next) = self.line_end(0);
        self.number += 1;
        while joined
            && next < self.rest.len()
            && end.checked_sub(1).is_some_and(|last| self.rest.get(last) == Some(&b'\\'))
        {
            (end, next) = self.line_end(next);
            self.number += 1;
        }
        let text = self.rest.get(..end)?;
        self.rest = self.rest.get(next..)?;
        Some(Line { number, text })
    }
}

/// The text after a UTF-8 byte order mark, if there is one.
pub(super) fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes)
}

/// A whole number.
#[inline]
pub(super) fn whole(word: &[u8]) -> Option<i64> {
    let (sign, digits) = match word {
        [b'-', digits @ ..] => (-1, digits),
        [b'+', digits @ ..] => (1, digits),
        digits => (1, digits),
    };
    let more = |number: i64, digit: &u8| {
        let digit = digit.is_ascii_digit().then(|| i64::from(digit - b'0'))?;
        number.checked_mul(10)?.checked_add(sign * digit)
    };
    if digits.is_empty() { None } else { digits.iter().try_fold(0, more) }
}

/// A number with at most 15 digits and no exponent, as nearly all in model files are; `None` if it is another one or
/// cannot be rounded like this.
///
/// Digits and power of ten are exact in double precision, so their quotient is rounded right (Clinger, How to Read
/// Floating Point Numbers Accurately, 1990). Rounding once more is right too, unless it is a tie.
#[inline]
fn short_decimal(word: &[u8]) -> Option<f32> {
    const MOST_DIGITS: usize = 15;
    const POWERS: [f64; MOST_DIGITS + 1] =
        [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15];
    const TIE: u64 = 1 << (f64::MANTISSA_DIGITS - f32::MANTISSA_DIGITS - 1);
    let (sign, text) = word.strip_prefix(b"-").map_or((1.0, word), |text| (-1.0, text));
    if text.len() > MOST_DIGITS + 1 {
        return None;
    }
    let (mut number, mut point) = (0_u64, None);
    for (place, byte) in text.iter().enumerate() {
        match byte {
            b'0'..=b'9' => number = 10 * number + u64::from(byte - b'0'),
            b'.' if point.is_none() => point = Some(place),
            _ => return None,
        }
    }
    let digits = text.len() - usize::from(point.is_some());
    let decimals = point.map_or(0, |place| digits - place);
    let value = number as f64 / POWERS.get(decimals)?;
    let sound = (1..=MOST_DIGITS).contains(&digits) && value.to_bits() & (2 * TIE - 1) != TIE;
    sound.then_some(sign * value as f32)
}

/// A number; overflow gives infinity, and what C libraries print for "not a number" gives NaN.
#[inline]
pub(super) fn float(word: &[u8]) -> Option<f32> {
    short_decimal(word).or_else(|| any_float(word))
}

fn any_float(word: &[u8]) -> Option<f32> {
    let text = str::from_utf8(word).ok()?;
    let unsigned = text.trim_start_matches(['+', '-']);
    let not_a_number = unsigned.starts_with("1.#")
        || unsigned.get(..3).is_some_and(|start| start.eq_ignore_ascii_case("nan"));
    text.parse().ok().or(not_a_number.then_some(f32::NAN))
}

/// `N` numbers from the front of `words`, or what is in their place.
pub(super) fn floats<'a, const N: usize>(
    words: &mut impl Iterator<Item = &'a [u8]>,
) -> Parsed<[f32; N]> {
    let mut values = [0.0; N];
    for (found, value) in values.iter_mut().enumerate() {
        let word = words.next().ok_or_else(|| {
            format!("{} expected here, but only {found} found", counted(N, "number"))
        })?;
        *value = float(word).ok_or_else(|| format!("cannot read {} as a number", quoted(word)))?;
    }
    Ok(values)
}

/// A word of a file in quotes, for messages.
pub(super) fn quoted(word: &[u8]) -> String {
    format!("\"{}\"", shortened(word, 40))
}

/// The name among `names` that `word` was probably meant to be, as a help.
pub(super) fn did_you_mean<'a>(
    word: &str,
    names: impl IntoIterator<Item = &'a str>,
) -> Option<String> {
    nearest(word, names.into_iter().take(10_000)).map(|name| format!("did you mean \"{name}\"?"))
}

/// `1 face`, `2 faces`.
pub(super) fn counted(count: usize, thing: &str) -> String {
    format!("{count} {thing}{}", if count == 1 { "" } else { "s" })
}

/// Bytes as text, whatever they are.
pub(super) fn lossy(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn shortened(bytes: &[u8], most: usize) -> String {
    let (start, more) = bytes.split_at_checked(most).unwrap_or((bytes, &[]));
    let text: String = lossy(start).chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    if more.is_empty() { text } else { text + "…" }
}

/// A part of the file `name`, as a place.
pub(super) fn part_of(name: &str, part: String) -> Place {
    Place { file: name.into(), part: Some(part), ..Place::default() }
}

/// The same complaint many times over: how often, and where first.
#[derive(Debug, Default)]
pub(super) struct Tally {
    count: usize,
    first: Place,
}

impl Tally {
    /// Counts one more, at `place`.
    pub(super) fn add(&mut self, place: impl FnOnce() -> Place) {
        if self.count == 0 {
            self.first = place();
        }
        self.count += 1;
    }

    /// Counts one more, at `place`, if there is something `wrong`.
    pub(super) fn add_if(&mut self, wrong: bool, place: impl FnOnce() -> Place) {
        if wrong {
            self.add(place);
        }
    }

    /// Counts one more, on `line` of the file `name`, if there is something `wrong`.
    pub(super) fn add_line_if(&mut self, wrong: bool, name: &str, line: &Line<'_>) {
        self.add_if(wrong, || line.place(name));
    }

    /// One error for all, at the first place, if there were any.
    pub(super) fn refuse(self, message: impl FnOnce(usize) -> String) -> diagnostic::Result<()> {
        if self.count == 0 {
            return Ok(());
        }
        let first = if self.count > 1 { ", first here" } else { "" };
        let message = message(self.count) + first;
        Err(Box::new(Diagnostic { message, place: self.first, ..Diagnostic::default() }))
    }

    /// One warning for all, at the first place, if there were any.
    pub(super) fn warn(self, warnings: &mut Warnings, message: impl FnOnce(usize) -> String) {
        if self.count > 0 {
            let message = message(self.count);
            warnings.push(Diagnostic { message, place: self.first, ..Diagnostic::default() });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_in_three_ways_and_keep_their_numbers() {
        let lines: Vec<_> = Lines::joined(b"a\r\nb\rc \\\n d\n\n# e \\\nf").collect();
        let found: Vec<(usize, &[u8])> =
            lines.iter().map(|line| (line.number, line.text)).collect();
        let expected: [(usize, &[u8]); 6] =
            [(1, b"a"), (2, b"b"), (3, b"c \\\n d"), (5, b""), (6, b"# e \\"), (7, b"f")];
        assert_eq!(found, expected);
        let words: Vec<&[u8]> = lines[2].words().collect();
        assert_eq!(words, [b"c", b"d"]);
    }

    #[test]
    fn numbers_of_any_program() {
        assert_eq!(float(b"-1.5e2"), Some(-150.0));
        assert_eq!(float(b"1e99999"), Some(f32::INFINITY));
        assert!(float(b"-nan(ind)").is_some_and(f32::is_nan));
        assert!(float(b"1.#QNAN").is_some_and(f32::is_nan));
        assert_eq!([float(b""), float(b"1,5"), float(b"\xff")], [None; 3]);
    }

    #[test]
    fn whole_numbers_are_what_the_standard_library_reads() {
        let words = "0 7 -12 +3 -0 9223372036854775807 -9223372036854775808 9223372036854775808 \
            -9223372036854775809 99999999999999999999 - + 1.0 1e3 x --1 +-1 /";
        for word in words.split(' ').chain([""]) {
            assert_eq!(whole(word.as_bytes()), word.parse().ok(), "{word}");
        }
    }

    #[test]
    fn decimals_are_rounded_as_the_standard_library_does() {
        let check = |word: &str| {
            let expected = word.parse::<f32>().ok().map(f32::to_bits);
            assert_eq!(float(word.as_bytes()).map(f32::to_bits), expected, "{word}");
        };
        let words = "0 -0 -0.0 +1 1. .5 -.5 . - + 1..2 1.2.3 1-2 0.1 16777217 16777219 \
            999999999999999 9999999999999999 0.00000000000001 0.000000000000001 1e5 1e-46 inf";
        words.split(' ').for_each(check);
        // Next to the middle between two neighbouring numbers it is easiest to be wrong.
        for number in 0..50_000_u32 {
            let below = f64::from(f32::from_bits(1.0_f32.to_bits() + 163 * number));
            let middle = below + f64::from(f32::EPSILON) / 2.0;
            check(&format!("{middle:.14}"));
            check(&format!("-{:.13}", 8.0 * middle));
            check(&format!("{below:.6}"));
        }
    }

    #[test]
    fn long_words_are_shortened() {
        assert_eq!(quoted(b"a\x1b[31m"), "\"a [31m\"");
        assert!(quoted(&[b'x'; 1000]).chars().count() < 50);
    }

    #[test]
    fn near_names_are_found() {
        assert_eq!(did_you_mean("Wod", ["Iron", "Wood"]).unwrap(), "did you mean \"Wood\"?");
        assert_eq!(did_you_mean("Glass", ["Iron", "Wood"]), None);
    }

    #[test]
    fn tallies_warn_once_at_the_first_place() {
        let (mut tally, mut warnings) = (Tally::default(), Warnings::new());
        for number in 3..10 {
            tally.add_line_if(number % 2 == 0, "x", &Line { number, text: b"" });
        }
        tally.warn(&mut warnings, |count| counted(count, "thing"));
        assert_eq!(warnings.len(), 1);
        assert!(warnings[0].to_string().starts_with("x:4: 3 things"), "{}", warnings[0]);
    }
}
