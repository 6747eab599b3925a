//! scenarios: headers of Parquet's pages. In: the bytes of a column. Out: whether the decoder comes to an end with them. It takes counts as
//! they are: of a list's elements, past the end of the file too, and of a dictionary's values and a page's bytes, for which it makes room. It reads the fields
//! that it knows as what they should be, whatever type is stated, and numbers of any length; what it would read otherwise than here is not sound.

/// Why a header is not read on.
enum Stop {
    /// The bytes end or mean nothing: the decoder says so.
    Cut,
    /// More elements than there are bytes, or what the decoder would read as something else.
    Unsound,
}

/// Deepest structs in structs; the decoder's own limit is 64.
const DEEPEST: usize = 64;

/// Bytes that a page may unpack to, and for each packed one more; writers make pages of about 1 MB.
const MOST_UNPACKED: [i64; 2] = [10_000_000, 100];

/// Whether no page of a column, from its first byte on, states more than it can have. Thrift's compact protocol (Apache Thrift,
/// thrift-compact-protocol.md) and the fields of `PageHeader` (Apache Parquet, parquet.thrift).
pub(crate) fn are_sound(column: &[u8]) -> bool {
    let mut rest = column;
    loop {
        let mut header = Header { rest, left: rest.len(), page: Page::default() };
        match header.fields(Some(0), DEEPEST) {
            Err(Stop::Unsound) => return false,
            Err(Stop::Cut) => return true,
            Ok(()) if !header.page.is_sound() => return false,
            Ok(()) => {}
        }
        let Some(next) = usize::try_from(header.page.packed).ok().and_then(|n| header.rest.get(n..)) else { return true };
        if next.is_empty() {
            return true;
        }
        rest = next;
    }
}

/// What a header says of its page: bytes unpacked and packed, values of a dictionary.
#[derive(Default)]
struct Page {
    size: i64,
    packed: i64,
    values: i64,
}

impl Page {
    fn is_sound(&self) -> bool {
        let most = MOST_UNPACKED[0].saturating_add(MOST_UNPACKED[1].saturating_mul(self.packed));
        (0..=most).contains(&self.size) && (0..=self.size).contains(&self.values)
    }
    /// A whole number in a field of the header, or of the struct in one.
    fn take(&mut self, of: Option<i64>, id: i64, value: i32) {
        let value = i64::from(value);
        match (of, id) {
            (Some(0), 2) => self.size = value,
            (Some(0), 3) => self.packed = value,
            (Some(7), 1) => self.values = value,
            _ => {}
        }
    }
}

/// What a field is that the decoder knows, in the header (0), in what it says of a data page (5, 8) or of a dictionary (7).
enum Known {
    Number,
    Struct,
    Other,
}

impl Known {
    fn of(place: Option<i64>, id: i64) -> Self {
        match (place, id) {
            (Some(0), 1..=4) | (Some(5), 1..=4) | (Some(7), 1..=2) | (Some(8), 1..=6) => Self::Number,
            (Some(0), 5..=8) => Self::Struct,
            _ => Self::Other,
        }
    }
}

/// A header that is read.
struct Header<'a> {
    rest: &'a [u8],
    /// Elements that may still come: one for each byte.
    left: usize,
    page: Page,
}

impl Header<'_> {
    fn byte(&mut self) -> Result<u8, Stop> {
        let (first, rest) = self.rest.split_first().ok_or(Stop::Cut)?;
        self.rest = rest;
        Ok(*first)
    }
    fn bytes(&mut self, count: u64) -> Result<(), Stop> {
        self.rest = usize::try_from(count).ok().and_then(|n| self.rest.get(n..)).ok_or(Stop::Cut)?;
        Ok(())
    }
    fn unsigned(&mut self) -> Result<u64, Stop> {
        let mut value = 0;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            value |= u64::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                return Ok(value);
            }
        }
        Err(Stop::Unsound)
    }
    /// A whole number in zigzag.
    fn signed(&mut self) -> Result<i64, Stop> {
        let value = self.unsigned()?;
        Ok((value >> 1).cast_signed() ^ -(value & 1).cast_signed())
    }
    fn elements(&mut self, count: u64) -> Result<(), Stop> {
        self.left = usize::try_from(count).ok().and_then(|n| self.left.checked_sub(n)).ok_or(Stop::Unsound)?;
        Ok(())
    }
    /// Fields of a struct up to its end: of the header (0), of a struct in one of its fields, or of one deeper.
    fn fields(&mut self, of: Option<i64>, depth: usize) -> Result<(), Stop> {
        let mut id = 0;
        loop {
            let head = self.byte()?;
            if head & 0xf == 0 {
                return Ok(());
            }
            id = if head >> 4 > 0 { id + i64::from(head >> 4) } else { self.signed()? };
            if i16::try_from(id).is_err() {
                return Err(Stop::Unsound);
            }
            match (Known::of(of, id), head & 0xf) {
                (Known::Number, 4..=6) => {
                    let value = self.signed()?;
                    self.page.take(of, id, i32::try_from(value).map_err(|_| Stop::Unsound)?);
                }
                (Known::Struct, 12) => self.fields(Some(id), depth.checked_sub(1).ok_or(Stop::Unsound)?)?,
                (Known::Other, kind) => self.skip(kind, depth)?,
                _ => return Err(Stop::Unsound),
            }
        }
    }
    fn skip(&mut self, kind: u8, depth: usize) -> Result<(), Stop> {
        let deeper = depth.checked_sub(1).ok_or(Stop::Unsound)?;
        match kind {
            1 | 2 => Ok(()),
            3 => self.bytes(1),
            4..=6 => self.unsigned().map(|_| ()),
            7 => self.bytes(8),
            8 => self.unsigned().and_then(|n| self.bytes(n)),
            9 | 10 => {
                let head = self.byte()?;
                let count = if head >> 4 == 15 { self.unsigned()? } else { u64::from(head >> 4) };
                self.elements(count)?;
                (0..count).try_for_each(|_| self.skip(head & 0xf, deeper))
            }
            11 => {
                let count = self.unsigned()?;
                self.elements(count)?;
                let kinds = if count > 0 { self.byte()? } else { 0 };
                (0..count).try_for_each(|_| self.skip(kinds >> 4, deeper).and_then(|()| self.skip(kinds & 0xf, deeper)))
            }
            12 => self.fields(None, deeper),
            13 => self.bytes(16),
            _ => Err(Stop::Cut),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A dictionary's header of `values` values in `size` bytes, 3 packed, by hand, after a field that only a newer writer has.
    fn page(list: &[u8], values: u8, size: u8) -> Vec<u8> {
        let zigzag = |x: u8| 2 * x;
        let mut all = vec![0x15, zigzag(2), 0x15, zigzag(size), 0x15, zigzag(3), 0x4c, 0x15, zigzag(values), 0x15, 0, 0];
        // Field 9 (a list or nothing), then the end and three bytes of the page.
        all.extend_from_slice(list);
        all.extend_from_slice(&[0, 7, 7, 7]);
        all
    }

    #[test]
    fn exact_counts_of_headers() {
        assert!(are_sound(&page(&[], 5, 40)) && are_sound(&page(&[], 40, 40)));
        assert!(!are_sound(&page(&[], 41, 40)));
        let most = MOST_UNPACKED[0] + 3 * MOST_UNPACKED[1];
        let unpacked = |size| Page { size, packed: 3, values: 0 }.is_sound();
        assert!(unpacked(most) && !unpacked(most + 1) && !unpacked(-1));
        let mut negative = page(&[], 5, 40);
        negative[8] = 1;
        assert!(!are_sound(&negative));
        // A list of three truths is none of two million, nor of three in a list of a million lists.
        assert!(are_sound(&page(&[0x29, 0x31], 5, 40)));
        assert!(!are_sound(&page(&[0x29, 0xf1, 0xff, 0xff, 0x7f], 5, 40)));
        assert!(!are_sound(&page(&[0x29, 0xf9, 0xff, 0xff, 0x3f], 5, 40)));
        // Fields that the decoder knows, of another type than theirs, beyond 32 bits or in more bytes than any number has.
        let header = |fields: &[u8]| [fields, &page(&[], 5, 40)].concat();
        for fields in
            [[0x18, 1, 0], [0x15, 4, 0x18], [0x4c, 0x18, 1], [0x5c, 0x18, 1], [0x7c, 0x18, 1], [0x8c, 0x68, 1], [0x55, 2, 0]]
        {
            assert!(!are_sound(&header(&fields)), "{fields:?}");
        }
        for size in [&[0xff, 0xff, 0xff, 0xff, 0x1f][..], &[0x80; 12]] {
            assert!(!are_sound(&header(&[&[0x15, 4, 0x15], size, &[2, 0]].concat())), "{size:?}");
        }
        // A field 0 is nobody's, and what stands in it neither.
        let mut none = vec![0x15, 4, 0x15, 120, 0x15, 6, 0x4c, 0x15, 120, 0x15, 0, 0];
        none.extend([0x0c, 0, 0x25, 2, 0, 0, 7, 7, 7]);
        assert!(are_sound(&none));
        none[8] = 122;
        assert!(!are_sound(&none), "61 values in 60 bytes, not in one");
        // The second page of a column.
        let two = |second: Vec<u8>| [page(&[], 5, 40), second].concat();
        assert!(are_sound(&two(page(&[], 5, 40))) && !are_sound(&two(page(&[], 50, 40))));
        // What is cut or means nothing is for the decoder to say.
        let whole = page(&[0x29, 0x31], 5, 40);
        assert!((0..whole.len()).all(|n| are_sound(&whole[..n])));
    }
}
