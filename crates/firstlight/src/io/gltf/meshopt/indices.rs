//! Index streams: mode TRIANGLES with a memory of recent edges and vertices, mode INDICES as differences.

use super::Cursor;

/// Decodes `count` indices of mode TRIANGLES, three for each triangle.
pub(super) fn triangles(bytes: &[u8], count: usize) -> Result<Vec<u32>, String> {
    let mut data = Cursor(bytes);
    let version = data.version(0xe0)?;
    if !count.is_multiple_of(3) {
        return Err(format!("{count} indices are not a whole number of triangles"));
    }
    let codes = data.take(count / 3)?;
    let table = data.take_tail(16)?;
    let mut decoder = Triangles::new(data, table, version);
    let mut indices = Vec::with_capacity(count);
    for &code in codes {
        indices.extend(decoder.triangle(code)?);
    }
    decoder.data.finish()?;
    Ok(indices)
}

/// Decodes `count` indices of mode INDICES.
pub(super) fn sequence(bytes: &[u8], count: usize) -> Result<Vec<u32>, String> {
    let mut data = Cursor(bytes);
    data.version(0xd0)?;
    data.take_tail(4)?;
    let mut last = [0_u32; 2];
    let mut indices = Vec::new();
    for _ in 0..count {
        let code = varint(&mut data)?;
        let [even, odd] = &mut last;
        let base = if code & 1 == 0 { even } else { odd };
        *base = base.wrapping_add(unzigzag(code >> 1));
        indices.push(*base);
    }
    data.finish()?;
    Ok(indices)
}

struct Triangles<'a> {
    data: Cursor<'a>,
    table: &'a [u8],
    edges: Recent<[u32; 2]>,
    vertices: Recent<u32>,
    /// The smallest index that has not occurred.
    next: u32,
    /// The last index that was stored as a difference.
    last: u32,
    /// Codes of the third vertex from here on are no places in `vertices`.
    first_special: u8,
}

impl<'a> Triangles<'a> {
    fn new(data: Cursor<'a>, table: &'a [u8], version: u8) -> Self {
        let first_special = if version >= 1 { 13 } else { 15 };
        let (edges, vertices) = (Recent::new([u32::MAX; 2]), Recent::new(u32::MAX));
        Self { data, table, edges, vertices, next: 0, last: 0, first_special }
    }

    fn triangle(&mut self, code: u8) -> Result<[u32; 3], String> {
        match code {
            0x00..0xf0 => self.on_edge(code >> 4, code & 15),
            0xf0..0xfe => {
                let corners = self.table.get(usize::from(code & 15)).copied().unwrap_or_default();
                self.free(0, corners >> 4, corners & 15)
            }
            0xfe.. => {
                let corners = self.data.byte()?;
                if corners == 0 {
                    self.next = 0;
                }
                self.free(if code == 0xfe { 0 } else { 15 }, corners >> 4, corners & 15)
            }
        }
    }

    /// A triangle on a recent edge.
    fn on_edge(&mut self, edge: u8, third: u8) -> Result<[u32; 3], String> {
        let [a, b] = self.edges.back(edge + 1);
        let c = match third {
            0 => self.fresh(),
            place if place < self.first_special => self.vertices.back(place + 1),
            15 => self.stored()?,
            // 13 and 14: one less and one more than the last stored index.
            other => {
                let step = if other == 13 { u32::MAX } else { 1 };
                self.last = self.last.wrapping_add(step);
                self.last
            }
        };
        if third == 0 || third >= self.first_special {
            self.vertices.push(c);
        }
        self.edges.push([c, b]);
        self.edges.push([a, c]);
        Ok([a, b, c])
    }

    /// A triangle of which each corner is fresh (0), recent (1..=14) or stored (15).
    fn free(&mut self, a: u8, b: u8, c: u8) -> Result<[u32; 3], String> {
        // Fresh indices are given out before stored ones are read, and all before any is remembered.
        let [mut first, mut second, mut third] = [a, b, c].map(|code| match code {
            0 => self.fresh(),
            place => self.vertices.back(place),
        });
        for (code, corner) in [(a, &mut first), (b, &mut second), (c, &mut third)] {
            if code == 15 {
                *corner = self.stored()?;
            }
        }
        for (code, corner) in [(a, first), (b, second), (c, third)] {
            if code == 0 || code == 15 {
                self.vertices.push(corner);
            }
        }
        self.edges.push([second, first]);
        self.edges.push([third, second]);
        self.edges.push([first, third]);
        Ok([first, second, third])
    }

    fn fresh(&mut self) -> u32 {
        let index = self.next;
        self.next = self.next.wrapping_add(1);
        index
    }

    fn stored(&mut self) -> Result<u32, String> {
        self.last = self.last.wrapping_add(unzigzag(varint(&mut self.data)?));
        Ok(self.last)
    }
}

/// The last sixteen of something.
struct Recent<T> {
    items: [T; 16],
    next: usize,
}

impl<T: Copy> Recent<T> {
    fn new(empty: T) -> Self {
        Self { items: [empty; 16], next: 0 }
    }

    fn push(&mut self, item: T) {
        self.items[self.next % 16] = item;
        self.next = (self.next + 1) % 16;
    }

    /// The item pushed `steps` (at most 16) pushes ago: 1 is the last one.
    fn back(&self, steps: u8) -> T {
        self.items[(self.next + 16 - usize::from(steps)) % 16]
    }
}

/// A number of up to five bytes, low seven bits first; the high bit says that more follow.
fn varint(data: &mut Cursor) -> Result<u32, String> {
    let mut number = 0;
    for shift in (0..35).step_by(7) {
        let byte = data.byte()?;
        number |= u32::from(byte & 127) << shift;
        if byte < 128 {
            break;
        }
    }
    Ok(number)
}

fn unzigzag(code: u32) -> u32 {
    (code >> 1) ^ (code & 1).wrapping_neg()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_strip_of_two_triangles() {
        // Three fresh corners by table entry 0; then a fresh one on the edge (2, 1): edge 1 before last.
        let mut bytes = vec![0xe1, 0xf0, 0x10];
        bytes.extend([0; 16]);
        assert_eq!(triangles(&bytes, 6).unwrap(), [0, 1, 2, 2, 1, 3]);
    }

    #[test]
    fn stored_corners_are_differences() {
        // 15, 15 | 15: three stored indices, +5, -1, +2.
        let mut bytes = vec![0xe1, 0xff, 0xff, 10, 1, 4];
        bytes.extend([0; 16]);
        assert_eq!(triangles(&bytes, 3).unwrap(), [5, 4, 6]);
    }

    #[test]
    fn sequences_have_two_baselines() {
        let bytes = [0xd1, 40, 3 << 1 | 1, 4, 0, 0, 0, 0];
        assert_eq!(sequence(&bytes, 3).unwrap(), [10, 0_u32.wrapping_sub(2), 11]);
    }

    #[test]
    fn lies_are_refused() {
        assert!(triangles(&[0xe1; 40], 3_000_000_000).unwrap_err().contains("too early"));
        assert!(sequence(&[0xd1; 40], usize::MAX).unwrap_err().contains("too early"));
        assert!(triangles(&[0xe2; 40], 3).unwrap_err().contains("0xe2"));
        let mut bytes = vec![0xe1, 0xf0, 9];
        bytes.extend([0; 16]);
        assert!(triangles(&bytes, 3).unwrap_err().contains("1 bytes are left over"));
    }
}
