//! Complaints that do not stop the reading.

use crate::diagnostic::Diagnostic;
use crate::io::Warnings;
use crate::io::pictures::MISSING;
use indexmap::IndexMap;

/// Collects complaints about one file: a thousand of the same become one line with the count.
pub(super) struct Notes<'a> {
    file: &'a str,
    entries: IndexMap<String, Note>,
}

pub(super) struct Note {
    part: String,
    help: Option<String>,
    code: &'static str,
    count: usize,
}

impl<'a> Notes<'a> {
    pub(super) fn new(file: &'a str) -> Self {
        Self { file, entries: IndexMap::new() }
    }

    /// Notes `message` about `part`; only the first part is kept.
    pub(super) fn add(&mut self, part: impl Into<String>, message: impl Into<String>) {
        self.add_many(part, message, 1);
    }

    /// Notes `message` for `count` things of which the first is at `part`.
    pub(super) fn add_many(
        &mut self,
        part: impl Into<String>,
        message: impl Into<String>,
        count: usize,
    ) {
        if count > 0 {
            self.note(part.into(), message.into()).count += count;
        }
    }

    /// Notes a complaint that came with advice.
    pub(super) fn add_with_help(
        &mut self,
        part: impl Into<String>,
        message: impl Into<String>,
        help: Option<String>,
    ) -> &mut Note {
        let note = self.note(part.into(), message.into());
        note.help = help;
        note.count += 1;
        note
    }

    /// Notes that a picture cannot be used, perhaps with advice.
    pub(super) fn add_missing(
        &mut self,
        part: impl Into<String>,
        message: impl Into<String>,
        help: Option<String>,
    ) {
        self.add_with_help(part, message, help).code = MISSING;
    }

    fn note(&mut self, part: String, message: String) -> &mut Note {
        self.entries.entry(message).or_insert(Note { part, help: None, code: "", count: 0 })
    }

    pub(super) fn finish(self, warnings: &mut Warnings) {
        for (message, note) in self.entries {
            let message = match note.count {
                1 => message,
                many => format!("{message} ({many} times, first here)"),
            };
            let warning = Diagnostic::new(self.file, message).at_part(note.part).code(note.code);
            warnings.push(Diagnostic { help: note.help, ..warning });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thousand_of_the_same_are_one_line() {
        let mut notes = Notes::new("a.gltf");
        for i in 0..1000 {
            notes.add(format!("nodes[{i}]"), "is odd");
        }
        let mut warnings = Warnings::new();
        notes.finish(&mut warnings);
        let texts: Vec<_> = warnings.iter().map(ToString::to_string).collect();
        assert_eq!(texts, ["a.gltf: nodes[0]: is odd (1000 times, first here)"]);
    }
}
