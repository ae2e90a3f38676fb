//! EXT_meshopt_compression and KHR_meshopt_compression: buffer views as meshoptimizer packs them.
//!
//! The bitstreams are those of the extensions' pages, appendix A (bitstream) and B (filters). Output grows with
//! the input that was read, so a short stream that claims much is refused early.

mod attributes;
mod filter;
mod indices;

use super::document::Meshopt;

/// Unpacks `bytes` to `count` × `byteStride` bytes.
///
/// # Errors
/// What is wrong, in words.
pub(super) fn decode(packed: &Meshopt, bytes: &[u8]) -> Result<Vec<u8>, String> {
    let count = usize::try_from(packed.count).map_err(|_| "the count is too large")?;
    let stride = packed.byte_stride as usize;
    let mut decoded = match packed.mode.as_str() {
        "ATTRIBUTES" => attributes::decode(bytes, count, stride)?,
        "TRIANGLES" => narrow(indices::triangles(bytes, count)?, stride)?,
        "INDICES" => narrow(indices::sequence(bytes, count)?, stride)?,
        other => return Err(format!("mode {other:?} is unknown")),
    };
    filter::apply(packed.filter.as_deref().unwrap_or("NONE"), &mut decoded, stride)?;
    Ok(decoded)
}

/// Indices as little-endian numbers of two or four bytes.
fn narrow(indices: Vec<u32>, stride: usize) -> Result<Vec<u8>, String> {
    match stride {
        2 => Ok(indices.into_iter().flat_map(|index| (index as u16).to_le_bytes()).collect()),
        4 => Ok(indices.into_iter().flat_map(u32::to_le_bytes).collect()),
        other => Err(format!("byteStride is {other}; for indices it must be 2 or 4")),
    }
}

/// Reads a stream from its front and never past its end.
struct Cursor<'a>(&'a [u8]);

impl<'a> Cursor<'a> {
    fn byte(&mut self) -> Result<u8, String> {
        self.take(1).map(|one| one.first().copied().unwrap_or_default())
    }

    fn take(&mut self, length: usize) -> Result<&'a [u8], String> {
        let (taken, rest) = self.0.split_at_checked(length).ok_or("the stream ends too early")?;
        self.0 = rest;
        Ok(taken)
    }

    /// Cuts `length` bytes off the end.
    fn take_tail(&mut self, length: usize) -> Result<&'a [u8], String> {
        let start = self.0.len().checked_sub(length).ok_or("the stream ends too early")?;
        let (rest, tail) = self.0.split_at(start);
        self.0 = rest;
        Ok(tail)
    }

    /// The stream's version, if its first byte says that it is of this `kind`.
    fn version(&mut self, kind: u8) -> Result<u8, String> {
        match self.byte()? {
            header if header & 0xf0 == kind && header & 0x0f <= 1 => Ok(header & 0x0f),
            header => {
                Err(format!("the stream starts with {header:#04x}; {kind:#04x} was expected"))
            }
        }
    }

    fn finish(&self) -> Result<(), String> {
        match self.0.len() {
            0 => Ok(()),
            more => Err(format!("{more} bytes are left over")),
        }
    }
}
