//! A scene's text with the overrides laid over it, and the place of everything in them.

use super::complaint::{self, Path, PathStep};
use super::overrides::Override;
use crate::diagnostic::{Diagnostic, Place, Result};
use indexmap::IndexMap;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::de::{Deserialize, DeserializeOwned, Deserializer};
use serde_spanned::Spanned;
use std::borrow::Cow;
use std::ops::Range;
use toml::de::{DeTable, DeValue, ValueDeserializer};

/// Where something stands: a range of bytes in the text, or beyond it in the overrides laid end to end.
pub(super) type Span = Range<usize>;

/// A value and where it was written.
#[derive(Debug, Clone)]
pub(super) struct At<T> {
    pub(super) span: Span,
    pub(super) value: T,
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for At<T> {
    fn deserialize<D: Deserializer<'de>>(source: D) -> std::result::Result<Self, D::Error> {
        let spanned = Spanned::<T>::deserialize(source)?;
        Ok(Self { span: spanned.span(), value: spanned.into_inner() })
    }
}

impl<T: JsonSchema> JsonSchema for At<T> {
    fn inline_schema() -> bool {
        T::inline_schema()
    }
    fn schema_name() -> Cow<'static, str> {
        T::schema_name()
    }
    fn schema_id() -> Cow<'static, str> {
        T::schema_id()
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        T::json_schema(generator)
    }
}

/// Things by their names.
pub(super) type Named<T> = IndexMap<String, At<T>>;

/// The things in the order of the text, overrides last; TOML tables come in the order of names.
pub(super) fn in_order<T>(mut things: Named<T>) -> impl Iterator<Item = (String, At<T>)> {
    things.sort_by(|_, a, _, b| a.span.start.cmp(&b.span.start));
    things.into_iter()
}

/// The text of a scene, its name and what is laid over it.
#[derive(Clone, Copy)]
pub(super) struct Document<'a> {
    pub(super) name: &'a str,
    pub(super) text: &'a str,
    pub(super) overrides: &'a [Override],
    /// The user did not write the text and must not see it.
    pub(super) generated: bool,
}

impl<'a> Document<'a> {
    /// Deserialises the document; errors have their place and path.
    pub(super) fn read<T: DeserializeOwned>(&self) -> Result<T> {
        T::deserialize(ValueDeserializer::from(self.tree()?)).map_err(|error| {
            let span = error.span().unwrap_or_default();
            let path = self.path(&span);
            let (message, help) = complaint::reword(error.message(), &path);
            let message = self.about(&span, &path, message);
            let help = help.or_else(|| self.meant(&span));
            Box::new(Diagnostic {
                message,
                place: self.place(&span),
                help,
                ..Diagnostic::default()
            })
        })
    }

    /// A complaint about the value or key at `span`: its path, then `predicate` ("needs ...", "must ...").
    pub(super) fn error(&self, span: &Span, predicate: impl AsRef<str>) -> Box<Diagnostic> {
        let path = self.path(span);
        let message = self.about(span, &path, format!("{path} {}", predicate.as_ref()));
        Box::new(Diagnostic { message, place: self.place(span), ..Diagnostic::default() })
    }

    /// A file's content, or the complaint about it where the file is named.
    pub(super) fn open<T>(&self, span: &Span, content: Result<T>) -> Result<T> {
        content.map_err(|mut error| {
            if self.hides(span) {
                return error;
            }
            error.message = format!("{}: {}: {}", self.path(span), error.place, error.message);
            error.place = self.place(span);
            error
        })
    }

    /// What stands in quotation marks at `span`, if that is in the text and such a value.
    pub(super) fn quoted_text(&self, span: &Span) -> Option<&'a str> {
        let value = self.text.get(span.clone())?;
        ['"', '\''].iter().find_map(|mark| value.strip_prefix(*mark)?.strip_suffix(*mark))
    }

    /// The parsed text with the overrides in it. Theirs are spans beyond the text.
    fn tree(&self) -> Result<Spanned<DeValue<'a>>> {
        let table = DeTable::parse(self.text).map_err(|error| {
            let place = self.place(&error.span().unwrap_or_default());
            let help = complaint::syntax_help(error.message());
            Diagnostic { message: error.message().to_owned(), place, help, ..Diagnostic::default() }
        })?;
        let mut tree = Spanned::new(table.span(), DeValue::Table(table.into_inner()));
        let mut offset = self.text.len() + 1;
        for over in self.overrides {
            over.apply(&mut tree, offset)?;
            offset += over.text.len() + 1;
        }
        Ok(tree)
    }

    /// The keys that lead to `span`; empty if it is nowhere in particular.
    fn path(&self, span: &Span) -> Path {
        // Only errors ask, so that parsing again is cheaper than a copy of every tree.
        let mut path = Path::default();
        if let Ok(tree) = self.tree() {
            find(&tree, span, &mut path);
        }
        path
    }

    /// The file and line, or the override, that `span` lies in.
    fn place(&self, span: &Span) -> Place {
        match self.overriding(span) {
            Some(over) => over.place(),
            None if self.generated => Place { file: self.name.into(), ..Place::default() },
            None => place_in_text(self.name, self.text, span),
        }
    }

    /// The message without the path that it starts with, where the user wrote no path.
    fn about(&self, span: &Span, path: &Path, message: String) -> String {
        let written = !self.hides(span) && !self.overriding(span).is_some_and(Override::is_called);
        let rest = message.strip_prefix(&format!("{path} ")).filter(|_| !written);
        rest.map(str::to_owned).unwrap_or(message)
    }

    /// Whether `span` lies where the user wrote nothing.
    pub(super) fn hides(&self, span: &Span) -> bool {
        self.generated && self.overriding(span).is_none()
    }

    /// The override that `span` lies in, if it is beyond the text.
    fn overriding(&self, span: &Span) -> Option<&'a Override> {
        let mut offset = span.start.checked_sub(self.text.len() + 1)?;
        for over in self.overrides {
            if offset <= over.text.len() {
                return Some(over);
            }
            offset -= over.text.len() + 1;
        }
        None
    }

    /// What an override may have meant that made a new, incomplete thing beside a similar one.
    fn meant(&self, span: &Span) -> Option<String> {
        let over = self.overriding(span)?;
        let tree = Document { overrides: &[], ..*self }.tree().ok()?;
        over.meant(tree.get_ref())
    }
}

/// The line and column of a range of bytes, and the line itself unless it is too long to show.
pub(super) fn place_in_text(name: &str, text: &str, span: &Span) -> Place {
    const LONGEST_SHOWN: usize = 200;
    let boundary = |at: usize| (0..=at.min(text.len())).rev().find(|&i| text.is_char_boundary(i));
    let start = boundary(span.start).unwrap_or(0);
    let end = boundary(span.end).unwrap_or(start).max(start);
    let (before, after) = text.split_at(start);
    let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
    let line_end = start + after.find('\n').unwrap_or(after.len());
    let line = text[line_start..line_end].trim_end_matches('\r');
    let visible = |c: char| if c.is_control() || c == '\u{feff}' { ' ' } else { c };
    Place {
        file: name.into(),
        line: Some(before.matches('\n').count() + 1),
        column: Some(text[line_start..start].chars().count() + 1),
        length: text[start..end.min(line_end).max(start)].chars().count().max(1),
        source: (line.len() <= LONGEST_SHOWN).then(|| line.chars().map(visible).collect()),
        part: None,
    }
}

/// Extends `path` to the key or value with exactly this span, if it is at or below `value`.
fn find(value: &Spanned<DeValue<'_>>, span: &Span, path: &mut Path) -> bool {
    if value.span() == *span {
        return true;
    }
    let mut below = |step: PathStep, key: Option<Span>, value: &Spanned<DeValue<'_>>| {
        path.push(step);
        key.as_ref() == Some(span) || find(value, span, path) || path.pop()
    };
    match value.get_ref() {
        DeValue::Table(table) => table.iter().any(|(key, value)| {
            below(PathStep::Key(key.get_ref().to_string()), Some(key.span()), value)
        }),
        DeValue::Array(list) => {
            list.iter().enumerate().any(|(i, value)| below(PathStep::Index(i), None, value))
        }
        _ => false,
    }
}
