//! scenarios: tables of a FlatBuffer. In: bytes and places in them. Out: fields, or nothing where a place is not in the bytes.
//!
//! The layout is that of the FlatBuffers documentation, "FlatBuffer Internals": a table starts with the distance to its list of fields,
//! which holds for each field its distance from the table, zero when it is absent.

/// A table in a buffer.
#[derive(Clone, Copy)]
pub(super) struct FlatTable<'b> {
    buffer: &'b [u8],
    place: usize,
}

fn bytes<const N: usize>(buffer: &[u8], place: usize) -> Option<[u8; N]> {
    buffer.get(place..)?.first_chunk::<N>().copied()
}

fn distance(buffer: &[u8], place: usize) -> Option<usize> {
    place.checked_add(u32::from_le_bytes(bytes(buffer, place)?) as usize)
}

impl<'b> FlatTable<'b> {
    /// The table that a buffer is.
    pub(super) fn root(buffer: &'b [u8]) -> Option<Self> {
        Some(Self { buffer, place: distance(buffer, 0)? })
    }
    /// Place of field `i`.
    fn field(self, i: usize) -> Option<usize> {
        let back = i64::from(i32::from_le_bytes(bytes(self.buffer, self.place)?));
        let list = usize::try_from(i64::try_from(self.place).ok()? - back).ok()?;
        let size = usize::from(u16::from_le_bytes(bytes(self.buffer, list)?));
        let entry = 4 + 2 * i;
        if entry + 2 > size {
            return None;
        }
        let at = usize::from(u16::from_le_bytes(bytes(self.buffer, list.checked_add(entry)?)?));
        (at != 0).then(|| self.place.checked_add(at)).flatten()
    }
    pub(super) fn u8(self, i: usize) -> u8 {
        self.field(i).and_then(|p| bytes::<1>(self.buffer, p)).map_or(0, |b| b[0])
    }
    pub(super) fn i16(self, i: usize) -> i16 {
        self.field(i).and_then(|p| bytes(self.buffer, p)).map_or(0, i16::from_le_bytes)
    }
    pub(super) fn i32(self, i: usize) -> i32 {
        self.field(i).and_then(|p| bytes(self.buffer, p)).map_or(0, i32::from_le_bytes)
    }
    pub(super) fn i64(self, i: usize) -> i64 {
        self.field(i).and_then(|p| bytes(self.buffer, p)).map_or(0, i64::from_le_bytes)
    }
    pub(super) fn table(self, i: usize) -> Option<Self> {
        Some(Self { buffer: self.buffer, place: distance(self.buffer, self.field(i)?)? })
    }
    /// Elements of `N` bytes each.
    pub(super) fn vector<const N: usize>(self, i: usize) -> Option<&'b [[u8; N]]> {
        let start = distance(self.buffer, self.field(i)?)?;
        let count = u32::from_le_bytes(bytes(self.buffer, start)?) as usize;
        let from = start.checked_add(4)?;
        Some(self.buffer.get(from..from.checked_add(count.checked_mul(N)?)?)?.as_chunks::<N>().0)
    }
    pub(super) fn tables(self, i: usize) -> Option<Vec<Self>> {
        let start = distance(self.buffer, self.field(i)?)?.checked_add(4)?;
        let count = self.vector::<4>(i)?.len();
        (0..count).map(|k| Some(Self { buffer: self.buffer, place: distance(self.buffer, start + 4 * k)? })).collect()
    }
    pub(super) fn text(self, i: usize) -> Option<String> {
        let all = self.vector::<1>(i)?;
        Some(String::from_utf8_lossy(all.as_flattened()).into_owned())
    }
}
