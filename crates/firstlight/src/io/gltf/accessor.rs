//! Accessors: typed elements in a buffer view, strided, normalized, sparse.

use super::data::{Data, slice};
use super::document;
use crate::diagnostic::Result;
use std::borrow::Cow;

/// How one number is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn from_code(code: u32) -> Option<Self> {
        Some(match code {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// The number at the start of `bytes`; 0 if they are too few.
    fn read(self, bytes: &[u8]) -> f64 {
        match (self, bytes) {
            (Self::I8, &[a, ..]) => i8::from_le_bytes([a]).into(),
            (Self::U8, &[a, ..]) => a.into(),
            (Self::I16, &[a, b, ..]) => i16::from_le_bytes([a, b]).into(),
            (Self::U16, &[a, b, ..]) => u16::from_le_bytes([a, b]).into(),
            (Self::U32, &[a, b, c, d, ..]) => u32::from_le_bytes([a, b, c, d]).into(),
            (Self::F32, &[a, b, c, d, ..]) => f32::from_le_bytes([a, b, c, d]).into(),
            _ => 0.0,
        }
    }

    /// The number that a normalized 1 is stored as.
    fn one(self) -> f64 {
        match self {
            Self::I8 => i8::MAX.into(),
            Self::U8 => u8::MAX.into(),
            Self::I16 => i16::MAX.into(),
            Self::U16 => u16::MAX.into(),
            Self::U32 => u32::MAX.into(),
            Self::F32 => 1.0,
        }
    }
}

/// Elements of one to four numbers. Everything is checked when it is opened, so that reading cannot fail.
#[derive(Debug)]
pub(super) struct Accessor<'a> {
    /// How many elements.
    pub(super) count: usize,
    /// Numbers in an element, 1..=4.
    pub(super) components: usize,
    /// How a number is stored.
    pub(super) component: Component,
    /// What is stored for 1, if the numbers stand for fractions.
    one: Option<f64>,
    /// The elements that are not in `sparse`; `None`: zeros.
    dense: Option<Strided<'a>>,
    sparse: Option<Sparse<'a>>,
}

#[derive(Debug)]
struct Strided<'a> {
    bytes: Cow<'a, [u8]>,
    stride: usize,
}

impl Strided<'_> {
    fn at(&self, element: usize) -> &[u8] {
        self.bytes.get(element * self.stride..).unwrap_or_default()
    }
}

/// Elements that replace others; their indices increase.
#[derive(Debug)]
struct Sparse<'a> {
    indices: Vec<u32>,
    values: Strided<'a>,
}

impl<'a> Accessor<'a> {
    /// Tightly packed floats, `components` (1..=4) of them per element.
    pub(super) fn floats(numbers: &[f32], components: usize) -> Self {
        let bytes = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
        Self {
            count: numbers.len() / components.max(1),
            components,
            component: Component::F32,
            one: None,
            dense: Some(Strided { bytes: Cow::Owned(bytes), stride: components * 4 }),
            sparse: None,
        }
    }

    /// The numbers of an element, normalized ones as fractions; 0 where it has fewer than `N`.
    pub(super) fn get<const N: usize>(&self, element: usize) -> [f32; N] {
        let (bytes, size) = (self.bytes(element), self.component.size());
        std::array::from_fn(|i| {
            if i >= self.components {
                return 0.0;
            }
            let number = self.component.read(bytes.get(i * size..).unwrap_or_default());
            self.fraction(number) as f32
        })
    }

    /// The same with integers taken as fractions, as colours are meant even where the file forgets to say so.
    pub(super) fn with_fractions(self) -> Self {
        Self { one: self.one.or(Some(self.component.one())), ..self }
    }

    /// The first number of an element as an index.
    pub(super) fn index(&self, element: usize) -> u32 {
        self.component.read(self.bytes(element)) as u32
    }

    fn fraction(&self, number: f64) -> f64 {
        self.one.map_or(number, |one| (number / one).max(-1.0))
    }

    fn bytes(&self, element: usize) -> &[u8] {
        let sparse = self.sparse.as_ref().and_then(|sparse| {
            let found = sparse.indices.binary_search(&u32::try_from(element).ok()?).ok()?;
            Some(sparse.values.at(found))
        });
        sparse.or_else(|| Some(self.dense.as_ref()?.at(element))).unwrap_or_default()
    }
}

impl Data<'_> {
    /// Opens the accessor that `part` refers to; `kinds` are the types that make sense there.
    ///
    /// # Errors
    /// If it does not exist, has another type, or its elements are not all in its buffer views.
    pub(super) fn accessor(&self, index: u32, kinds: &[&str], part: &str) -> Result<Accessor<'_>> {
        let accessor = self.described(index, kinds, part)?;
        self.open(accessor, &format!("accessors[{index}]"))
    }

    /// `values` that were unpacked elsewhere, as the accessor that `part` refers to describes them.
    ///
    /// # Errors
    /// If the accessor does not exist or has another type.
    pub(super) fn unpacked<'v>(
        &self,
        values: Accessor<'v>,
        index: u32,
        kinds: &[&str],
        part: &str,
    ) -> Result<Accessor<'v>> {
        let accessor = self.described(index, kinds, part)?;
        let component = self.component(accessor.component_type, &format!("accessors[{index}]"))?;
        Ok(Accessor { one: accessor.normalized.then(|| component.one()), ..values })
    }

    fn described(&self, index: u32, kinds: &[&str], part: &str) -> Result<&document::Accessor> {
        let accessor = self.at(&self.document.accessors, index, "accessor", part)?;
        if !kinds.contains(&accessor.kind.as_str()) {
            let cause = format!(
                "accessor {index} has type {:?}; here it must be {}",
                accessor.kind,
                kinds.join(" or ")
            );
            return Err(self.error(part, cause));
        }
        Ok(accessor)
    }

    fn open(&self, accessor: &document::Accessor, part: &str) -> Result<Accessor<'_>> {
        let component = self.component(accessor.component_type, part)?;
        let components = match accessor.kind.as_str() {
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            _ => 1,
        };
        let count = u32::try_from(accessor.count).map_err(|_| {
            let cause = format!("{} elements are too many; at most 2^32 - 1", accessor.count);
            self.error(part, cause)
        })? as usize;
        let size = components * component.size();
        let dense = match accessor.buffer_view {
            Some(view) => {
                let source = (view, accessor.byte_offset);
                Some(self.strided(source, count, size, part)?)
            }
            None => None,
        };
        let sparse = match &accessor.sparse {
            Some(sparse) => Some(self.sparse(sparse, count, size, part)?),
            None => None,
        };
        let one = accessor.normalized.then(|| component.one());
        Ok(Accessor { count, components, component, one, dense, sparse })
    }

    fn component(&self, code: u32, part: &str) -> Result<Component> {
        Component::from_code(code).ok_or_else(|| {
            let cause = format!("{code} is no component type; 5120 to 5123, 5125 and 5126 are");
            self.error(format!("{part}.componentType"), cause)
        })
    }

    /// `count` elements of `size` bytes from an offset in a buffer view on.
    fn strided(
        &self,
        (view, offset): (u32, u64),
        count: usize,
        size: usize,
        part: &str,
    ) -> Result<Strided<'_>> {
        let (bytes, stride) = self.view(view, &format!("{part}.bufferView"))?;
        let stride = stride.map_or(size, |stride| stride as usize);
        if stride < size {
            let cause = format!("byteStride is {stride}, but an element has {size} bytes");
            return Err(self.error(format!("bufferViews[{view}]"), cause));
        }
        // Neither factor exceeds 2^32: this cannot overflow.
        let length =
            count.checked_sub(1).map_or(0, |last| last as u64 * stride as u64 + size as u64);
        let Some(bytes) = slice(bytes, offset, length) else {
            let has = bytes.len();
            let cause = format!(
                "needs {length} bytes from byte {offset} of bufferView {view}, which has {has}"
            );
            return Err(self.error(part, cause));
        };
        Ok(Strided { bytes: Cow::Borrowed(bytes), stride })
    }

    fn sparse(
        &self,
        sparse: &document::Sparse,
        count: usize,
        size: usize,
        part: &str,
    ) -> Result<Sparse<'_>> {
        let part = format!("{part}.sparse");
        let component =
            self.component(sparse.indices.component_type, &format!("{part}.indices"))?;
        let Some(number) = usize::try_from(sparse.count).ok().filter(|&number| number <= count)
        else {
            let cause = format!("replaces {} elements of {count}", sparse.count);
            return Err(self.error(part, cause));
        };
        self.charge(4 * number as u64, &part)?;
        let source = (sparse.indices.buffer_view, sparse.indices.byte_offset);
        let indices = self.strided(source, number, component.size(), &format!("{part}.indices"))?;
        let source = (sparse.values.buffer_view, sparse.values.byte_offset);
        let values = self.strided(source, number, size, &format!("{part}.values"))?;
        let indices: Vec<u32> = (0..number).map(|i| component.read(indices.at(i)) as u32).collect();
        let in_order = indices.is_sorted_by(|a, b| a < b);
        if !in_order || indices.last().is_some_and(|&last| last as usize >= count) {
            let cause = format!("must increase and be less than the count, {count}");
            return Err(self.error(format!("{part}.indices"), cause));
        }
        Ok(Sparse { indices, values })
    }
}
