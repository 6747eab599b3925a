//! scenarios: Arrow IPC files, which Feather version 2 is. In: the bytes. Out: columns of numbers, or why not.
//!
//! The layout is that of the Apache Arrow documentation, "Arrow Columnar Format", sections on the IPC file format and on compression.
//! Only what a table of numbers needs is read: integers, floats, true and false; other flat columns are stepped over.

use super::Reason;
use super::flatbuffer::FlatTable;
use super::variables::Stored;
use crate::columns::Columns;
use std::borrow::Cow;
use std::io::Read as _;

const MAGIC: &[u8] = b"ARROW1";
/// Most bytes that one packed byte can stand for: zstd's runs come to 128 KiB for some four bytes.
const PACKED: u64 = 1 << 16;

/// What a column holds, and so which buffers it has.
#[derive(Clone, Copy)]
enum Kind {
    Numbers(Stored),
    Bits,
    /// So many buffers, and views with some more whose number the batch says.
    Other {
        buffers: usize,
        views: bool,
    },
}

/// A table as it is read.
pub(super) struct ArrowRead {
    names: Vec<String>,
    kinds: Vec<Kind>,
    data: Vec<Vec<f64>>,
}

impl ArrowRead {
    pub(super) fn columns(self) -> Columns {
        let number = |k: &Kind| !matches!(k, Kind::Other { .. });
        let left: Vec<String> = self.names.iter().zip(&self.kinds).filter(|(_, k)| !number(k)).map(|(n, _)| n.clone()).collect();
        let rows = self.data.iter().map(Vec::len).max().unwrap_or(0);
        let (names, data) =
            self.names.into_iter().zip(self.data).zip(&self.kinds).filter(|(_, k)| number(k)).map(|(pair, _)| pair).unzip();
        let mut columns = Columns::new(names, data, (1..=rows).collect());
        columns.leave_out(&left);
        columns
    }
}

pub(super) fn read(bytes: &[u8]) -> Result<ArrowRead, Reason> {
    let body = bytes.strip_prefix(MAGIC).ok_or("it does not start with ARROW1")?;
    let rest = body.strip_suffix(MAGIC).ok_or("it does not end with ARROW1; it may be cut short")?;
    let size = *rest.last_chunk::<4>().ok_or("it has no footer")?;
    let end = bytes.len() - MAGIC.len() - 4;
    let start = end.checked_sub(u32::from_le_bytes(size) as usize).ok_or("its footer is larger than the file")?;
    let footer = FlatTable::root(&bytes[start..end]).ok_or("its footer is damaged")?;
    let schema = footer.table(1).ok_or("it has no schema")?;
    if schema.i16(0) != 0 {
        return Err("it is stored with the high byte first".to_owned());
    }
    let fields = schema.tables(1).ok_or("its schema is damaged")?;
    let mut table = ArrowRead {
        names: fields.iter().map(|f| f.text(0).unwrap_or_default()).collect(),
        kinds: fields.iter().map(|f| kind(*f)).collect::<Result<_, _>>()?,
        data: vec![Vec::new(); fields.len()],
    };
    // A block: where the message starts, its length, the length of its body.
    for block in footer.vector::<24>(3).unwrap_or(&[]) {
        let number = |at: usize| block[at..].first_chunk::<8>().map_or(0, |b| u64::from_le_bytes(*b));
        batch(bytes, number(0), number(8) & 0xffff_ffff, number(16), &mut table)?;
    }
    if table.data.iter().all(Vec::is_empty) { Err("it has no rows of numbers".to_owned()) } else { Ok(table) }
}

fn kind(field: FlatTable<'_>) -> Result<Kind, Reason> {
    let name = || field.text(0).unwrap_or_default();
    let detail = field.table(3);
    if field.table(4).is_some() {
        return Ok(Kind::Other { buffers: 2, views: false });
    }
    let bytes = |bits: i32| usize::try_from(bits / 8).unwrap_or(0);
    Ok(match (field.u8(2), detail) {
        (1, _) => Kind::Other { buffers: 0, views: false },
        (2, Some(t)) => Kind::Numbers(Stored::Int { bytes: bytes(t.i32(0)), signed: t.u8(1) != 0 }),
        (3, Some(t)) if t.i16(0) > 0 => Kind::Numbers(Stored::Float { bytes: if t.i16(0) == 1 { 4 } else { 8 } }),
        (6, _) => Kind::Bits,
        (4 | 5 | 19 | 20, _) => Kind::Other { buffers: 3, views: false },
        (3 | 7..=11 | 15 | 18, _) => Kind::Other { buffers: 2, views: false },
        (23 | 24, _) => Kind::Other { buffers: 2, views: true },
        _ => return Err(format!("column {} is nested", name())),
    })
}

/// Body of a batch and how its buffers are packed.
struct Body<'b> {
    bytes: &'b [u8],
    buffers: &'b [[u8; 16]],
    packed: Option<u8>,
    next: usize,
}

fn batch(bytes: &[u8], offset: u64, message: u64, body: u64, table: &mut ArrowRead) -> Result<(), Reason> {
    let slice = |from: u64, size: u64| {
        let from = usize::try_from(from).ok()?;
        bytes.get(from..from.checked_add(usize::try_from(size).ok()?)?)
    };
    let cut = || "a batch of rows lies outside the file; it may be cut short".to_owned();
    let head = slice(offset, message).ok_or_else(cut)?;
    let stored = slice(offset.saturating_add(message), body).ok_or_else(cut)?;
    // Since version 0.15 four bytes of ones stand before the length.
    let head = if head.starts_with(&[0xff; 4]) { head.get(8..) } else { head.get(4..) }.ok_or_else(cut)?;
    let damaged = || "a batch of rows is damaged".to_owned();
    let record = FlatTable::root(head).filter(|m| m.u8(1) == 3).and_then(|m| m.table(2)).ok_or_else(damaged)?;
    let rows = usize::try_from(record.i64(0)).map_err(|_| damaged())?;
    let packed = record.table(3).map(|c| c.u8(0));
    let mut body = Body { bytes: stored, buffers: record.vector::<16>(2).ok_or_else(damaged)?, packed, next: 0 };
    let mut views = record.vector::<8>(4).unwrap_or(&[]).iter();
    for (k, kind) in table.kinds.iter().enumerate() {
        match *kind {
            Kind::Other { buffers, views: more } => {
                let extra = if more { views.next().map_or(0, |n| u64::from_le_bytes(*n)) } else { 0 };
                body.next = body.next.saturating_add(buffers).saturating_add(usize::try_from(extra).unwrap_or(usize::MAX));
            }
            Kind::Numbers(number) => {
                let there = body.take()?;
                let data = body.take()?;
                let needed = rows.checked_mul(number.bytes()).and_then(|n| data.get(..n)).ok_or_else(damaged)?;
                let values = number.decode(needed, false).ok_or_else(|| format!("column {}: unusual size", table.names[k]))?;
                table.data[k].extend(values.into_iter().enumerate().map(|(i, x)| if there_is(&there, i) { x } else { f64::NAN }));
            }
            Kind::Bits => {
                let there = body.take()?;
                let data = body.take()?;
                if rows.div_ceil(8) > data.len() {
                    return Err(damaged());
                }
                let bit = |i: usize| f64::from(data[i / 8] >> (i % 8) & 1);
                table.data[k].extend((0..rows).map(|i| if there_is(&there, i) { bit(i) } else { f64::NAN }));
            }
        }
    }
    Ok(())
}

/// Whether a value is not null; without a list of them all are.
fn there_is(there: &[u8], i: usize) -> bool {
    there.is_empty() || there.get(i / 8).is_some_and(|b| b >> (i % 8) & 1 == 1)
}

impl<'b> Body<'b> {
    /// The next buffer, unpacked.
    fn take(&mut self) -> Result<Cow<'b, [u8]>, Reason> {
        let place = self.buffers.get(self.next).ok_or("a batch of rows has too few buffers")?;
        self.next += 1;
        let [from, size] = [0, 8].map(|at| {
            place[at..].first_chunk::<8>().map_or(usize::MAX, |b| usize::try_from(u64::from_le_bytes(*b)).unwrap_or(usize::MAX))
        });
        let bytes = from.checked_add(size).and_then(|to| self.bytes.get(from..to)).ok_or("a column lies outside its batch")?;
        match self.packed {
            Some(codec) if !bytes.is_empty() => unpack(codec, bytes),
            _ => Ok(Cow::Borrowed(bytes)),
        }
    }
}

/// A packed buffer starts with its size unpacked, -1 when it is not packed after all.
fn unpack(codec: u8, bytes: &[u8]) -> Result<Cow<'_, [u8]>, Reason> {
    let (head, packed) = bytes.split_first_chunk::<8>().ok_or("a packed column is cut short")?;
    let Ok(size) = u64::try_from(i64::from_le_bytes(*head)) else { return Ok(Cow::Borrowed(packed)) };
    if size > PACKED.saturating_mul(packed.len() as u64) {
        return Err(format!("a packed column says that {} bytes stand for {size}", packed.len()));
    }
    let mut all = Vec::new();
    let done = match codec {
        0 => lz4_flex::frame::FrameDecoder::new(packed).take(size).read_to_end(&mut all),
        1 => zstd::stream::read::Decoder::new(packed).and_then(|d| d.take(size).read_to_end(&mut all)),
        _ => return Err("it is packed in a way that is neither lz4 nor zstd".to_owned()),
    };
    done.map_err(|e| format!("a packed column is damaged ({e})"))?;
    if all.len() as u64 == size { Ok(Cow::Owned(all)) } else { Err("a packed column is cut short".to_owned()) }
}
