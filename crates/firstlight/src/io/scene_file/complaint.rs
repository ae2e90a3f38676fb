//! What the TOML reader complains about, in words that name the key and the way out.

use crate::suggest::{did_you_mean, quoted};
use std::fmt;

/// The keys and indices that lead to a value: `lights.key.point`, `surfaces.ball.transform[1]`.
#[derive(Debug, Clone, Default)]
pub(super) struct Path(Vec<PathStep>);

/// One step of a [`Path`].
#[derive(Debug, Clone)]
pub(super) enum PathStep {
    Key(String),
    Index(usize),
}

impl Path {
    pub(super) fn push(&mut self, step: PathStep) {
        self.0.push(step);
    }

    /// Removes the last step; returns false, which reads well where a search goes on.
    pub(super) fn pop(&mut self) -> bool {
        self.0.pop();
        false
    }

    fn ends_with(&self, name: &str) -> bool {
        matches!(self.0.last(), Some(PathStep::Key(key)) if key == name)
    }

    /// The path without its last step if that is `name`.
    fn above(&self, name: &str) -> Self {
        let mut path = self.clone();
        if path.ends_with(name) {
            path.pop();
        }
        path
    }

    /// The path up to a list of tables, if a key inside one is unknown: `[[...]]` is nowhere right here.
    fn table_in_list(&self, message: &str) -> Option<Self> {
        match self.0.as_slice() {
            [list @ .., PathStep::Index(_), PathStep::Key(_)]
                if message.starts_with("unknown field") && list.len() <= 2 =>
            {
                Some(Self(list.to_vec()))
            }
            _ => None,
        }
    }

    /// A table that shows how a thing of this kind is written.
    fn example(&self) -> Option<String> {
        let kind = match self.0.first()? {
            PathStep::Key(key) => match key.as_str() {
                "camera" | "cameras" => "perspective",
                "lights" => "point",
                "materials" => "lambert",
                _ => return None,
            },
            PathStep::Index(_) => return None,
        };
        Some(format!("write it as [{self}.{kind}]"))
    }
}

impl fmt::Display for Path {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.is_empty() {
            return f.write_str("the scene");
        }
        for (i, step) in self.0.iter().enumerate() {
            match step {
                PathStep::Index(index) => write!(f, "[{index}]")?,
                PathStep::Key(key) => {
                    f.write_str(if i == 0 { "" } else { "." })?;
                    let bare = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
                    let plain = !key.is_empty() && key.len() <= 80 && key.chars().all(bare);
                    f.write_str(&if plain { key.clone() } else { quoted(key) })?;
                }
            }
        }
        Ok(())
    }
}

/// Serde's message about the thing at `path`, as a sentence and a help.
///
/// Messages of our own types are predicates ("must be greater than 0, not -1") and get `path` as their subject.
pub(super) fn reword(message: &str, path: &Path) -> (String, Option<String>) {
    let plain = |text: String| (text, None);
    if let Some(table) = path.table_in_list(message) {
        return (format!("{table} is written [[{table}]]"), Some(format!("write [{table}], once")));
    }
    if let Some(rest) = message.strip_prefix("unknown field ") {
        let (name, known) = names(rest);
        let hint = did_you_mean(name, known.iter().copied());
        let message = format!("unknown field {} in {}{hint}", quoted(name), path.above(name));
        return (message, list("it knows", &known));
    }
    if let Some(rest) = message.strip_prefix("unknown variant ") {
        let (name, known) = names(rest);
        let hint = did_you_mean(name, known.iter().copied());
        let message = format!("unknown choice {} in {}{hint}", quoted(name), path.above(name));
        return (message, list("choose one of", &known));
    }
    if let Some(rest) = message.strip_prefix("unexpected keys in table: ") {
        let known = rest.split_once(", available keys: ").map_or("", |(_, known)| known);
        return (format!("unknown field {path}"), Some(format!("it knows {known}")));
    }
    if let Some(rest) = message.strip_prefix("missing field ") {
        return plain(format!("{path} needs {}", quoted(names(rest).0)));
    }
    if message.contains("unit variant, expected") {
        let help = "write it as a table: { name = { key = value } }".to_owned();
        return (format!("{path} needs settings for this choice"), Some(help));
    }
    if let Some((found, expected)) = expected(message) {
        let verb = if expected.starts_with("a whole number") { "must be" } else { "needs" };
        return plain(format!("{path} {verb} {expected}, not {}", describe(found)));
    }
    if message.starts_with("wanted exactly 1 element") {
        return (format!("{path} needs exactly one kind"), path.example());
    }
    if message == "wanted string or table" {
        return (format!("{path} needs a word or a table"), path.example());
    }
    if message.ends_with("overflowed") {
        return plain(format!("{path} has a number that is too large"));
    }
    plain(format!("{path} {message}"))
}

/// A way out of the syntax error that scenes invite most: text without quotation marks.
pub(super) fn syntax_help(message: &str) -> Option<String> {
    let unquoted = message.starts_with("string values must be quoted");
    unquoted.then(|| "what has a unit is text, in quotation marks: \"60 W\"".to_owned())
}

/// The first name in backticks, and those after it.
fn names(message: &str) -> (&str, Vec<&str>) {
    // The first name is the user's and may itself hold backticks; the rest are ours.
    let (name, known) = message.split_once("`, ").unwrap_or((message, ""));
    (name.trim_matches('`'), known.split('`').skip(1).step_by(2).collect())
}

fn list(intro: &str, known: &[&str]) -> Option<String> {
    (!known.is_empty()).then(|| format!("{intro} {}", known.join(", ")))
}

/// Splits "invalid type: A, expected B" and its relatives.
fn expected(message: &str) -> Option<(&str, String)> {
    let kinds = ["invalid type: ", "invalid value: ", "invalid length "];
    let rest = kinds.iter().find_map(|kind| message.strip_prefix(kind))?;
    let (found, expected) = rest.rsplit_once(", expected ")?;
    let expected = match expected {
        "a sequence" => "a list".to_owned(),
        "a string" => "text in quotation marks".to_owned(),
        "a boolean" => "true or false".to_owned(),
        // A number that is whole is out of range.
        "u64" if found.starts_with("integer ") => "a whole number from 0".to_owned(),
        "u32" if found.starts_with("integer ") => format!("a whole number from 0 to {}", u32::MAX),
        "i64" | "u64" | "u32" => "a whole number".to_owned(),
        _ => match expected.strip_prefix("struct ") {
            Some(_) => "a table".to_owned(),
            None => expected.to_owned(),
        },
    };
    Some((found, expected))
}

/// What serde found, in plain words.
fn describe(found: &str) -> String {
    match found {
        "map" => "a table".into(),
        "sequence" => "a list".into(),
        _ => match found.strip_prefix("string ") {
            Some(text) => format!("the text {}", quoted(text.trim_matches('"'))),
            None if found.bytes().all(|b| b.is_ascii_digit()) => format!("{found} values"),
            None => {
                let kinds = ["integer ", "floating point ", "boolean "];
                let value = kinds.iter().find_map(|kind| found.strip_prefix(kind));
                let value = value.unwrap_or(found).replace(" as i128", "").replace('`', "");
                value.chars().take(80).collect()
            }
        },
    }
}
