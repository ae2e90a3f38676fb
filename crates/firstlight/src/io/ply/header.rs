//! The head of a PLY file: which elements follow, and what each of their rows holds.

use crate::diagnostic::{Diagnostic, Result};
use crate::io::text::{Line, Lines, Parsed, did_you_mean, lossy, quoted};

/// What the text before `end_header` says.
#[derive(Debug)]
pub(super) struct Header<'a> {
    pub(super) format: Format,
    pub(super) elements: Vec<Element>,
    /// The pictures named by `comment TextureFile`.
    pub(super) textures: Vec<String>,
    /// What follows the header.
    pub(super) body: &'a [u8],
    /// Lines of the header.
    pub(super) lines: usize,
}

/// How the values after the header are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Format {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// A kind of row, and how many of them follow each other.
#[derive(Debug)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
    /// The header line that announces it.
    pub(super) line: usize,
}

/// One value of a row, or a list of them.
#[derive(Debug)]
pub(super) struct Property {
    pub(super) name: String,
    /// The type of the value, or of a list's values.
    pub(super) value: Scalar,
    /// For lists, the type of the length in front of the values.
    pub(super) length: Option<Scalar>,
}

/// A type of number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    fn from_name(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    /// Bytes of one value in a binary file.
    pub(super) fn size(self) -> u64 {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

/// More kinds of elements than this are refused.
const MOST_ELEMENTS: usize = 256;

const KEYWORDS: [&str; 6] = ["format", "comment", "obj_info", "element", "property", "end_header"];

impl<'a> Header<'a> {
    /// Reads the header of the file called `name`.
    pub(super) fn read(bytes: &'a [u8], name: &str) -> Result<Self> {
        let mut lines = Lines::new(bytes);
        let first = lines.next().unwrap_or(Line { number: 1, text: &[] });
        if first.text.trim_ascii() != b"ply" {
            let cause = "this is no PLY file: its first line is not \"ply\"";
            return Err(Box::new(first.complain(name, cause)));
        }
        let mut header =
            Self { format: Format::Ascii, elements: vec![], textures: vec![], body: &[], lines: 0 };
        let (mut format, mut last) = (None, first);
        while let Some(line) = lines.next() {
            if line.text.trim_ascii() == b"end_header" {
                let missing = || line.complain(name, "the header has no \"format\" line");
                header.format = format.ok_or_else(missing)?;
                (header.body, header.lines) = (lines.rest(), line.number);
                return Ok(header);
            }
            header.add_line(&line, &mut format).map_err(|cause| {
                let complaint = line.complain(name, cause);
                let word = line.words().next().map(lossy).unwrap_or_default();
                let known = KEYWORDS.contains(&word.as_str());
                let help = if known { None } else { did_you_mean(&word, KEYWORDS) };
                Box::new(Diagnostic { help, ..complaint })
            })?;
            last = line;
        }
        Err(Box::new(last.complain(name, "the header has no end: \"end_header\" is missing")))
    }

    fn add_line(&mut self, line: &Line<'_>, format: &mut Option<Format>) -> Parsed<()> {
        let words: Vec<&[u8]> = line.words().take(6).collect();
        match words.as_slice() {
            [b"format", word, ..] => *format = Some(format_named(word)?),
            [b"comment", b"TextureFile", _, ..] => self.textures.push(texture_name(line)),
            [] | [b"comment" | b"obj_info", ..] => {}
            [b"element", name, count] => self.add_element(name, count, line.number)?,
            [b"property", b"list", length, value, name] => {
                self.add_property(name, value, Some(length))?;
            }
            [b"property", value, name] => self.add_property(name, value, None)?,
            [b"element" | b"property", ..] => {
                return Err("this line has the wrong number of words".into());
            }
            [word, ..] => return Err(format!("{} is no word of a PLY header", quoted(word))),
        }
        Ok(())
    }

    fn add_element(&mut self, name: &[u8], count: &[u8], line: usize) -> Parsed<()> {
        let name = lossy(name);
        if self.elements.len() == MOST_ELEMENTS {
            return Err(format!("more than {MOST_ELEMENTS} kinds of elements"));
        }
        if self.elements.iter().any(|element| element.name == name) {
            return Err("this element is announced twice".into());
        }
        let number = str::from_utf8(count).ok().and_then(|text| text.parse().ok());
        let count = number.ok_or_else(|| format!("{} is no count", quoted(count)))?;
        self.elements.push(Element { name, count, properties: vec![], line });
        Ok(())
    }

    fn add_property(&mut self, name: &[u8], value: &[u8], length: Option<&&[u8]>) -> Parsed<()> {
        let kind = |word: &[u8]| {
            Scalar::from_name(word).ok_or_else(|| format!("{} is no type of number", quoted(word)))
        };
        let (value, length) = (kind(value)?, length.map(|word| kind(word)).transpose()?);
        let element = self.elements.last_mut().ok_or("a property before the first element")?;
        element.properties.push(Property { name: lossy(name), value, length });
        Ok(())
    }
}

fn format_named(word: &[u8]) -> Parsed<Format> {
    match word {
        b"ascii" => Ok(Format::Ascii),
        b"binary_little_endian" => Ok(Format::LittleEndian),
        b"binary_big_endian" => Ok(Format::BigEndian),
        _ => Err(format!("{} is no format of PLY files", quoted(word))),
    }
}

/// What follows `comment TextureFile`.
fn texture_name(line: &Line<'_>) -> String {
    let text = line.after_keyword();
    text.strip_prefix("TextureFile").unwrap_or_default().trim().to_owned()
}
