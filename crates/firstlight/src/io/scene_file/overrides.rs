//! `-D key.path=value`: one value of a scene, set from outside.

use crate::diagnostic::{Diagnostic, Place, Result};
use crate::suggest::{nearest, quoted, visible};
use serde_spanned::Spanned;
use std::borrow::Cow;
use std::ops::Range;
use std::str::FromStr;
use toml::de::{DeArray, DeTable, DeValue};

/// A value laid over a scene: `lights.key.point.power=60 W`, `film.samples=64`, `camera.perspective.fov=30`.
///
/// The value is TOML; what is not TOML is taken as text, so that units and colours need no quotation marks.
/// It replaces what is there, and a number in the path picks an element of a list; 0 starts one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Override {
    pub(super) text: String,
    /// The keys and where they stand in `text`.
    keys: Vec<(String, Range<usize>)>,
    /// Where the value stands in `text`, without blanks around it.
    value: Range<usize>,
    /// What the user wrote instead, if it was not `-D`.
    called: Option<String>,
}

impl FromStr for Override {
    type Err = Box<Diagnostic>;

    /// # Errors
    /// If there is no `=` or no key before it.
    fn from_str(text: &str) -> Result<Self> {
        // A quoted key may hold a `=` itself: the first one that leaves a key in front is meant.
        let split = text.match_indices('=').take(8).find_map(|(i, _)| Some((i, keys(&text[..i])?)));
        let Some((equals, keys)) = split else {
            let error = Diagnostic::new(format!("-D {}", visible(text)), "this sets no value");
            return Err(Box::new(error.help("write key.path=value, such as film.samples=64")));
        };
        let after = &text[equals + 1..];
        let start = equals + 1 + (after.len() - after.trim_start().len());
        let value = start..start + after.trim().len();
        Ok(Self { text: text.to_owned(), keys, value, called: None })
    }
}

impl Override {
    /// The same, but complaints call it `name`.
    #[must_use]
    pub fn called(self, name: impl Into<String>) -> Self {
        Self { called: Some(name.into()), ..self }
    }

    /// Whether the user wrote something else than a path and a value.
    pub(super) fn is_called(&self) -> bool {
        self.called.is_some()
    }

    /// The keys that lead to the value: `film`, `samples`.
    pub fn path(&self) -> impl Iterator<Item = &str> {
        self.keys.iter().map(|(key, _)| key.as_str())
    }

    /// Whether it sets what stands under these keys, a part of it, or a table with that in it.
    pub fn sets(&self, keys: &[&str]) -> bool {
        let inner = &keys[self.keys.len().min(keys.len())..];
        self.path().zip(keys).all(|(own, key)| own == *key) && holds(self.value().get_ref(), inner)
    }

    /// Sets the value in the table `root`; spans are those in the override's text plus `offset`.
    pub(super) fn apply<'a>(
        &'a self,
        root: &mut Spanned<DeValue<'a>>,
        offset: usize,
    ) -> Result<()> {
        self.set(root, &self.keys, offset)
    }

    /// "did you mean ..." for the first key that `tree` lacks, if it has a similar one.
    pub(super) fn meant(&self, tree: &DeValue<'_>) -> Option<String> {
        let mut value = tree;
        for (key, _) in &self.keys {
            let table = value.as_table()?;
            let Some(next) = table.get(key.as_str()) else {
                let near = nearest(key, table.keys().map(|known| known.get_ref().as_ref()))?;
                return Some(format!("did you mean \"{near}\" where it says \"{key}\"?"));
            };
            value = next.get_ref();
        }
        None
    }

    fn set<'a>(
        &'a self,
        slot: &mut Spanned<DeValue<'a>>,
        keys: &'a [(String, Range<usize>)],
        offset: usize,
    ) -> Result<()> {
        let Some(((key, span), rest)) = keys.split_first() else {
            *slot = shifted(self.value(), self.value.start + offset);
            return Ok(());
        };
        let span = span.start + offset..span.end + offset;
        let empty = || Spanned::new(span.clone(), self.empty(keys));
        let inner = match slot.get_mut() {
            DeValue::Table(table) => table
                .entry(Spanned::new(span.clone(), Cow::Borrowed(key.as_str())))
                .or_insert_with(empty),
            DeValue::Array(list) => {
                let length = list.len();
                if length == 0 && key == "0" {
                    list.push(empty());
                }
                let element = key.parse().ok().and_then(|index: usize| list.get_mut(index));
                element.ok_or_else(|| {
                    let key = quoted(key);
                    self.error(match length {
                        0 => format!("there is no list yet to have an element {key}"),
                        _ => format!("{key} is no element of a list of {length}"),
                    })
                })?
            }
            _ => return Err(self.error(format!("there is nothing inside to be {}", quoted(key)))),
        };
        self.set(inner, rest, offset)
    }

    /// What is made for the first of `keys` if there is nothing: a list for the number after it, else a table.
    /// A number after the scene's own keys is the name of a thing: `lights.0`.
    fn empty(&self, keys: &[(String, Range<usize>)]) -> DeValue<'static> {
        let below_root = keys.len() < self.keys.len();
        let number = keys.get(1).is_some_and(|(next, _)| next.parse::<usize>().is_ok());
        if below_root && number {
            DeValue::Array(DeArray::new())
        } else {
            DeValue::Table(DeTable::new())
        }
    }

    /// The value as TOML or, failing that, as text.
    fn value(&self) -> Spanned<DeValue<'_>> {
        let text = self.text.get(self.value.clone()).unwrap_or("");
        DeValue::parse(text)
            .unwrap_or_else(|_| Spanned::new(0..text.len(), DeValue::String(Cow::Borrowed(text))))
    }

    /// The override itself as the place of a complaint.
    pub(super) fn place(&self) -> Place {
        let file = match &self.called {
            Some(name) => visible(name),
            None => format!("-D {}", visible(&self.text)),
        };
        Place { file, ..Place::default() }
    }

    pub(super) fn error(&self, message: impl Into<String>) -> Box<Diagnostic> {
        Box::new(Diagnostic {
            message: message.into(),
            place: self.place(),
            ..Diagnostic::default()
        })
    }
}

/// Whether something stands under these keys in a value.
fn holds(value: &DeValue<'_>, keys: &[&str]) -> bool {
    let Some((key, rest)) = keys.split_first() else { return true };
    let inner = value.as_table().and_then(|table| table.get(*key));
    inner.is_some_and(|inner| holds(inner.get_ref(), rest))
}

/// The bare or quoted keys of a dotted key, each with its place.
fn keys(text: &str) -> Option<Vec<(String, Range<usize>)>> {
    let source = format!("{text}=0");
    let mut table = &DeTable::parse(&source).ok()?.into_inner();
    let mut keys = Vec::new();
    loop {
        let mut entries = table.iter();
        let (Some((key, value)), None) = (entries.next(), entries.next()) else { return None };
        keys.push((key.get_ref().to_string(), key.span()));
        match value.get_ref() {
            DeValue::Table(inner) => table = inner,
            DeValue::Integer(_) => return Some(keys),
            _ => return None,
        }
    }
}

/// The value with `by` added to all its spans.
fn shifted<'a>(value: Spanned<DeValue<'a>>, by: usize) -> Spanned<DeValue<'a>> {
    let later = |span: Range<usize>| span.start + by..span.end + by;
    let span = later(value.span());
    let value = match value.into_inner() {
        DeValue::Array(list) => {
            DeValue::Array(list.into_iter().map(|element| shifted(element, by)).collect())
        }
        DeValue::Table(table) => {
            let entry = |(key, value): (Spanned<_>, _)| {
                (Spanned::new(later(key.span()), key.into_inner()), shifted(value, by))
            };
            DeValue::Table(table.into_iter().map(entry).collect())
        }
        plain => plain,
    };
    Spanned::new(span, value)
}
