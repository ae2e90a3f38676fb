//! Warnings and errors with a place, a cause and a way out.

use std::borrow::Cow;
use std::fmt;

/// What went wrong with an input or an output, where, and what helps.
///
/// Displayed without control characters as `place: message`, then the source line it is about (if known) and a `help:` line.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Diagnostic {
    /// What is wrong, in one sentence without a full stop.
    pub message: String,
    /// Where: a file, and inside it a line and column, or a part such as `accessors[3]`.
    pub place: Place,
    /// What the user can do about it.
    pub help: Option<String>,
    /// A short name that stays the same from version to version, such as `light-inside`; empty if it has none.
    pub code: &'static str,
}

/// Where in the input a [`Diagnostic`] belongs. Every part may be unknown (empty or `None`).
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Place {
    /// The file, as the user named it.
    pub file: String,
    /// Line, from 1.
    pub line: Option<usize>,
    /// Column in characters, from 1.
    pub column: Option<usize>,
    /// How many characters the complaint is about, for the underline.
    pub length: usize,
    /// The text of the line itself.
    pub source: Option<String>,
    /// A part of a structured file: `nodes[4].mesh`, `accessors[2]`, `byte 1044`.
    pub part: Option<String>,
}

/// The result of everything that reads or writes files.
pub type Result<T> = std::result::Result<T, Box<Diagnostic>>;

impl Diagnostic {
    /// A complaint about `file` as a whole.
    pub fn new(file: impl Into<String>, message: impl Into<String>) -> Self {
        let place = Place { file: file.into(), ..Place::default() };
        Self { message: message.into(), place, ..Self::default() }
    }

    /// Adds the line (from 1) it is about.
    #[must_use]
    pub fn at_line(mut self, line: usize) -> Self {
        self.place.line = Some(line);
        self
    }

    /// Adds the part of a structured file it is about, such as `accessors[3]`.
    #[must_use]
    pub fn at_part(mut self, part: impl Into<String>) -> Self {
        self.place.part = Some(part.into());
        self
    }

    /// Adds the name it is known by.
    #[must_use]
    pub fn code(mut self, code: &'static str) -> Self {
        self.code = code;
        self
    }

    /// Adds what the user can do.
    #[must_use]
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }
}

/// Text from anywhere, fit for a terminal: control characters, which could steer it, are replaced by U+FFFD.
pub fn visible(text: &str) -> Cow<'_, str> {
    if text.contains(char::is_control) {
        text.replace(char::is_control, "\u{fffd}").into()
    } else {
        text.into()
    }
}

impl Place {
    /// Whether it is a file, and no line or part of it.
    pub(crate) fn is_whole_file(&self) -> bool {
        self.line.is_none() && self.part.is_none()
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&visible(&self.file))?;
        if let Some(line) = self.line {
            write!(f, ":{line}")?;
        }
        if let Some(column) = self.column {
            write!(f, ":{column}")?;
        }
        match self.part.as_deref().map(visible) {
            Some(part) if self.file.is_empty() => f.write_str(&part),
            Some(part) => write!(f, ": {part}"),
            None => Ok(()),
        }
    }
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let place = self.place.to_string();
        if !place.is_empty() {
            write!(f, "{place}: ")?;
        }
        f.write_str(&visible(&self.message))?;
        if let (Some(line), Some(source)) = (self.place.line, &self.place.source) {
            write!(f, "\n{line:>5} | {}", visible(source))?;
            if let Some(column) = self.place.column {
                let (blank, mark) =
                    (" ".repeat(column.max(1) - 1), "^".repeat(self.place.length.max(1)));
                write!(f, "\n      | {blank}{mark}")?;
            }
        }
        if let Some(help) = &self.help {
            write!(f, "\n help: {}", visible(help))?;
        }
        Ok(())
    }
}

impl std::error::Error for Diagnostic {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_steers_the_terminal() {
        let hostile = "a\u{1b}[2J\u{9b}31m\r\n\u{7}\u{7f}b";
        let mut error = Diagnostic::new(hostile, hostile).at_line(3).at_part(hostile).help(hostile);
        error.place.source = Some(hostile.into());
        let shown = error.to_string();
        assert!(!shown.replace('\n', "").contains(char::is_control), "{shown:?}");
        assert_eq!((shown.lines().count(), shown.matches("a\u{fffd}[2J").count()), (3, 5));
    }
}
