//! Buffers and the views into them, and the budget for what is unpacked from them.

use super::document::{Buffer, BufferView, Document, Meshopt};
use super::uri::Uri;
use super::{at, error, meshopt};
use crate::diagnostic::{Diagnostic, Result};
use crate::io::FileAccess;
use std::borrow::Cow;
use std::cell::{Cell, OnceCell};
use std::collections::HashMap;
use std::path::PathBuf;

/// The document with its buffers.
pub(super) struct Data<'a> {
    /// The file, for messages.
    pub(super) name: &'a str,
    /// The JSON.
    pub(super) document: &'a Document,
    /// Which files may be opened.
    pub(super) access: &'a FileAccess,
    buffers: Vec<Option<Cow<'a, [u8]>>>,
    unpacked: Vec<OnceCell<Vec<u8>>>,
    left: Cell<u64>,
}

impl<'a> Data<'a> {
    /// Reads all buffers; `binary` is the one stored in the GLB.
    ///
    /// # Errors
    /// If one cannot be read or is shorter than the document says.
    pub(super) fn load(
        document: &'a Document,
        binary: Option<&'a [u8]>,
        name: &'a str,
        access: &'a FileAccess,
    ) -> Result<Self> {
        let mut files = Files { access, name, read: HashMap::new() };
        let mut buffers = Vec::with_capacity(document.buffers.len());
        for (index, buffer) in document.buffers.iter().enumerate() {
            buffers.push(files.buffer(buffer, index, binary.filter(|_| index == 0))?);
        }
        let unpacked = document.buffer_views.iter().map(|_| OnceCell::new()).collect();
        let bytes: usize = buffers.iter().flatten().map(|buffer| buffer.len()).sum();
        let left = Cell::new(budget(bytes as u64, access.limits.decoded_bytes));
        Ok(Self { name, document, access, buffers, unpacked, left })
    }

    /// A complaint about `part` of this file.
    pub(super) fn error(
        &self,
        part: impl Into<String>,
        cause: impl Into<String>,
    ) -> Box<Diagnostic> {
        error(self.name, part, cause)
    }

    /// The item of the document's `list` that `part` refers to by `index`.
    pub(super) fn at<T>(&self, list: &'a [T], index: u32, kind: &str, part: &str) -> Result<&'a T> {
        at(list, index, kind, part, self.name)
    }

    /// Takes `bytes` from the budget for what the buffers unpack to.
    ///
    /// # Errors
    /// If not so much is left.
    pub(super) fn charge(&self, bytes: u64, part: &str) -> Result<()> {
        match self.left.get().checked_sub(bytes) {
            Some(left) => {
                self.left.set(left);
                Ok(())
            }
            None => {
                let left = self.left.get();
                let cause = format!(
                    "would unpack to {bytes} bytes; {left} are left for a file of this size"
                );
                Err(self.error(part, cause))
            }
        }
    }

    /// How many bytes may still be unpacked.
    pub(super) fn budget(&self) -> u64 {
        self.left.get()
    }

    /// The bytes of a buffer view, decompressed, and its stride.
    ///
    /// # Errors
    /// If the view does not exist, reaches out of its buffer or cannot be decompressed.
    pub(super) fn view(&self, index: u32, part: &str) -> Result<(&[u8], Option<u32>)> {
        let view = self.at(&self.document.buffer_views, index, "bufferView", part)?;
        let meshopt = view.extensions.as_ref().and_then(|e| e.meshopt.as_ref());
        let bytes = match meshopt {
            Some(packed) => self.unpack(index, packed)?,
            None => self.raw(view, index)?,
        };
        Ok((bytes, view.byte_stride))
    }

    fn raw(&self, view: &BufferView, index: u32) -> Result<&[u8]> {
        let part = format!("bufferViews[{index}]");
        self.range(view.buffer, view.byte_offset, view.byte_length, part)
    }

    fn range(&self, buffer: u32, offset: u64, length: u64, part: String) -> Result<&[u8]> {
        at(&self.buffers, buffer, "buffer", &format!("{part}.buffer"), self.name)?;
        let Some(bytes) = self.buffers.get(buffer as usize).and_then(Option::as_deref) else {
            let cause =
                format!("buffer {buffer} has no data: it names no file and is not in a GLB");
            return Err(self.error(part, cause));
        };
        slice(bytes, offset, length).ok_or_else(|| {
            let has = bytes.len();
            let cause = format!(
                "{length} bytes from byte {offset} are not in buffer {buffer}, which has {has}"
            );
            self.error(part, cause)
        })
    }

    fn unpack(&self, index: u32, packed: &Meshopt) -> Result<&[u8]> {
        let part = format!("bufferViews[{index}].extensions.EXT_meshopt_compression");
        let missing = || self.error(&part, "does not exist");
        let cell = self.unpacked.get(index as usize).ok_or_else(missing)?;
        if let Some(bytes) = cell.get() {
            return Ok(bytes);
        }
        let bytes =
            self.range(packed.buffer, packed.byte_offset, packed.byte_length, part.clone())?;
        self.charge(packed.count.saturating_mul(u64::from(packed.byte_stride)), &part)?;
        let decoded = meshopt::decode(packed, bytes).map_err(|cause| self.error(&part, cause))?;
        Ok(cell.get_or_init(|| decoded))
    }
}

/// What `bytes` of buffers may unpack to: plain ones a few times their size, compressed ones more, up to `limit`.
fn budget(bytes: u64, limit: u64) -> u64 {
    limit.min((64 << 20) + 256 * bytes) + 8 * bytes
}

/// `length` bytes from `offset` on, if they are all there.
pub(super) fn slice(bytes: &[u8], offset: u64, length: u64) -> Option<&[u8]> {
    let start = usize::try_from(offset).ok()?;
    let end = start.checked_add(usize::try_from(length).ok()?)?;
    bytes.get(start..end)
}

/// Reads buffers, each file once.
struct Files<'a> {
    access: &'a FileAccess,
    name: &'a str,
    read: HashMap<PathBuf, usize>,
}

impl<'a> Files<'a> {
    fn buffer(
        &mut self,
        buffer: &Buffer,
        index: usize,
        binary: Option<&'a [u8]>,
    ) -> Result<Option<Cow<'a, [u8]>>> {
        let part = format!("buffers[{index}]");
        let bytes = match (&buffer.uri, binary) {
            (Some(uri), _) => Cow::Owned(self.uri(uri, &part)?),
            (None, Some(binary)) => Cow::Borrowed(binary),
            (None, None) => return Ok(None),
        };
        let wanted =
            usize::try_from(buffer.byte_length).ok().filter(|&wanted| wanted <= bytes.len());
        let Some(wanted) = wanted else {
            let (wanted, has) = (buffer.byte_length, bytes.len());
            let cause = format!("should have {wanted} bytes, but there are only {has}");
            return Err(error(self.name, part, cause));
        };
        Ok(Some(match bytes {
            Cow::Borrowed(bytes) => Cow::Borrowed(bytes.get(..wanted).unwrap_or(bytes)),
            Cow::Owned(mut bytes) => {
                bytes.truncate(wanted);
                Cow::Owned(bytes)
            }
        }))
    }

    fn uri(&mut self, uri: &str, part: &str) -> Result<Vec<u8>> {
        match Uri::parse(uri).map_err(|cause| error(self.name, part, cause))? {
            Uri::Data(bytes) => Ok(bytes),
            Uri::File(file) => self.file(&file).map_err(|cause| {
                let message = format!("cannot read {file:?}: {}", cause.message);
                let complaint = Diagnostic::new(self.name, message).at_part(part);
                Box::new(Diagnostic { help: cause.help, ..complaint })
            }),
        }
    }

    /// A short document that names a long file many times must not take many times its memory.
    fn file(&mut self, file: &str) -> Result<Vec<u8>> {
        const TIMES: usize = 4;
        let path = self.access.resolve(file)?;
        let times = self.read.entry(path.canonicalize().unwrap_or(path)).or_default();
        *times += 1;
        if *times > TIMES {
            let complaint = format!("it is the file of more than {TIMES} buffers");
            return Err(Box::new(Diagnostic::new(file, complaint)));
        }
        self.access.read(file)
    }
}
