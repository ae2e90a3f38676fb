//! GLB: the binary container of a glTF document and its first buffer.

use super::error;
use crate::diagnostic::{Diagnostic, Result};

const MAGIC: &[u8] = b"glTF";
const JSON: u32 = u32::from_le_bytes(*b"JSON");
const BIN: u32 = u32::from_le_bytes(*b"BIN\0");

/// The two things a file holds.
#[derive(Debug, PartialEq)]
pub(super) struct Contents<'a> {
    /// The document.
    pub(super) json: &'a [u8],
    /// The GLB-stored buffer.
    pub(super) binary: Option<&'a [u8]>,
}

/// Splits a GLB into its chunks; anything else is taken as a JSON document.
///
/// # Errors
/// If a file named `.glb` is something else, or a GLB's header or a chunk's length is not what the bytes are.
pub(super) fn split<'a>(bytes: &'a [u8], name: &str) -> Result<Contents<'a>> {
    if bytes.starts_with(MAGIC) {
        return glb(bytes, name);
    }
    let json = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    if json.iter().all(u8::is_ascii_whitespace) {
        return Err(Box::new(Diagnostic::new(name, "this file is empty")));
    }
    if name.to_ascii_lowercase().ends_with(".glb") && !json.trim_ascii_start().starts_with(b"{") {
        let cause = "this is no GLB: it does not begin with the letters glTF";
        return Err(error(name, "byte 0", cause));
    }
    Ok(Contents { json, binary: None })
}

fn glb<'a>(bytes: &'a [u8], name: &str) -> Result<Contents<'a>> {
    let truncated = || error(name, "byte 4", "the GLB header is cut off: it needs 12 bytes");
    let version = u32_at(bytes, 4).ok_or_else(truncated)?;
    let length = u32_at(bytes, 8).ok_or_else(truncated)? as usize;
    if version != 2 {
        let cause = format!("this is GLB version {version}; only version 2 can be read");
        return Err(error(name, "byte 4", cause));
    }
    let Some(file) = bytes.get(..length).filter(|_| length >= 12) else {
        let cause = format!(
            "the header says the file has {length} bytes, but there are {}; it may be cut off",
            bytes.len()
        );
        return Err(error(name, "byte 8", cause));
    };
    let mut chunks = Chunks { file, at: 12, name };
    let Some((JSON, json)) = chunks.next()? else {
        return Err(error(name, "byte 12", "the first chunk must be of type JSON"));
    };
    let binary = chunks.next()?.and_then(|(kind, data)| (kind == BIN).then_some(data));
    Ok(Contents { json, binary })
}

struct Chunks<'a, 'n> {
    file: &'a [u8],
    at: usize,
    name: &'n str,
}

impl<'a> Chunks<'a, '_> {
    /// Type and data of the next chunk.
    fn next(&mut self) -> Result<Option<(u32, &'a [u8])>> {
        if self.at >= self.file.len() {
            return Ok(None);
        }
        let place = format!("byte {}", self.at);
        let header = u32_at(self.file, self.at).zip(u32_at(self.file, self.at + 4));
        let Some((length, kind)) = header else {
            return Err(error(self.name, place, "a chunk's header is cut off: it needs 8 bytes"));
        };
        let start = self.at + 8;
        let data = start.checked_add(length as usize).and_then(|end| self.file.get(start..end));
        let Some(data) = data else {
            let left = self.file.len() - start;
            let cause = format!("this chunk claims {length} bytes, but {left} are left");
            return Err(error(self.name, place, cause));
        };
        // Chunks start at multiples of four; some writers leave the padding out of the length.
        self.at = (start + data.len()).next_multiple_of(4);
        Ok(Some((kind, data)))
    }
}

fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    bytes.get(at..)?.first_chunk().map(|four| u32::from_le_bytes(*four))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(length: u32, chunks: &[(u32, &[u8; 4], &[u8])]) -> Vec<u8> {
        let mut bytes = [b"glTF".as_slice(), &2_u32.to_le_bytes(), &length.to_le_bytes()].concat();
        for (length, kind, data) in chunks {
            bytes.extend([&length.to_le_bytes(), kind.as_slice(), data].concat());
        }
        bytes
    }

    fn complaint(bytes: &[u8]) -> String {
        split(bytes, "m.glb").unwrap_err().to_string()
    }

    #[test]
    fn chunks_are_found() {
        let bytes = file(36, &[(4, b"JSON", b"{}  "), (4, b"BIN\0", &[1, 2, 3, 4])]);
        let contents = split(&bytes, "m.glb").unwrap();
        assert_eq!(contents, Contents { json: b"{}  ", binary: Some(&[1, 2, 3, 4]) });
    }

    #[test]
    fn json_alone_may_start_with_a_byte_order_mark() {
        let contents = split(b"\xef\xbb\xbf{}", "m.gltf").unwrap();
        assert_eq!(contents, Contents { json: b"{}", binary: None });
        assert_eq!(complaint(b"\n "), "m.glb: this file is empty");
    }

    #[test]
    fn another_file_is_no_glb() {
        assert!(complaint(b"GLTF\x02\0\0\0").starts_with("m.glb: byte 0: this is no GLB"));
        assert!(split(b" {}", "m.GLB").is_ok());
        assert!(split(b"GLTF", "m.gltf").is_ok());
    }

    #[test]
    fn lying_headers_are_named_with_their_byte() {
        assert!(complaint(b"glTF\x02\0\0\0").starts_with("m.glb: byte 4: the GLB header is cut"));
        assert!(complaint(b"glTF\x01\0\0\0\0\0\0\0").contains("byte 4: this is GLB version 1"));
        assert!(complaint(&file(100, &[])).contains("byte 8: the header says the file has 100"));
        assert!(complaint(&file(3, &[])).contains("byte 8"));
        assert!(complaint(&file(12, &[])).contains("byte 12: the first chunk must"));
        let long = file(24, &[(u32::MAX, b"JSON", b"{}  ")]);
        assert!(complaint(&long).contains("byte 12: this chunk claims 4294967295 bytes, but 4"));
        let second = file(32, &[(4, b"JSON", b"{}  "), (9, b"BIN\0", &[])]);
        assert!(complaint(&second).contains("byte 24: this chunk claims 9 bytes, but 0 are left"));
        let wrong = file(24, &[(4, b"BIN\0", b"{}  ")]);
        assert!(complaint(&wrong).contains("byte 12: the first chunk must be of type JSON"));
    }
}
