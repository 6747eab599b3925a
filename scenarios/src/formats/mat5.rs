//! scenarios: MATLAB v5 files, whole or compressed element by element. In: the bytes. Out: the variables, or why not.
//!
//! The layout is that of MathWorks, "MAT-File Format", section "Level 5 MAT-File Format". Sizes in the file are believed only as far as
//! there are bytes for them.

use super::Reason;
use super::variables::{Content, FileVariable, Stored};
use std::io::Read as _;

const HEADER: usize = 128;
/// Types of elements.
const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;
/// Classes of arrays.
const CELL: u8 = 1;
const STRUCT: u8 = 2;
const OBJECT: u8 = 3;
const CHAR: u8 = 4;
const SPARSE: u8 = 5;
const FUNCTION: u8 = 16;
const OPAQUE: u8 = 17;
/// Flag of complex arrays.
const COMPLEX: u8 = 0x08;
/// Structs in structs that are looked into.
const DEEPEST: usize = 4;
/// A variable of this kind of file is smaller, in bytes.
const LARGEST: u64 = 1 << 31;

/// Bytes that are read from the front.
struct Bytes<'b> {
    rest: &'b [u8],
    big_endian: bool,
}

/// One element: its type and its bytes.
struct Element<'b> {
    kind: u32,
    bytes: &'b [u8],
}

impl<'b> Bytes<'b> {
    fn take(&mut self, n: usize) -> Result<&'b [u8], Reason> {
        let (head, rest) = self.rest.split_at_checked(n).ok_or_else(|| cut_short(n, self.rest.len()))?;
        self.rest = rest;
        Ok(head)
    }
    fn word(&mut self) -> Result<u32, Reason> {
        let b = *self.take(4)?.first_chunk::<4>().ok_or("four bytes")?;
        Ok(if self.big_endian { u32::from_be_bytes(b) } else { u32::from_le_bytes(b) })
    }
    /// The next element; small ones hold size, type and data in eight bytes, others end on a multiple of eight unless compressed.
    fn element(&mut self) -> Result<Element<'b>, Reason> {
        let first = self.word()?;
        if first >> 16 != 0 {
            let bytes = self.take(4)?;
            let size = (first >> 16) as usize;
            return Ok(Element { kind: first & 0xffff, bytes: bytes.get(..size).ok_or_else(|| cut_short(size, 4))? });
        }
        let size = self.word()? as usize;
        let bytes = self.take(size)?;
        if first != COMPRESSED {
            self.take(((8 - size % 8) % 8).min(self.rest.len()))?;
        }
        Ok(Element { kind: first, bytes })
    }
    fn inside(&self, rest: &'b [u8]) -> Self {
        Self { rest, big_endian: self.big_endian }
    }
}

fn cut_short(needed: usize, left: usize) -> Reason {
    format!("it ends where {needed} bytes more should stand and {left} are; the file may be cut short or damaged")
}

pub(super) fn read(bytes: &[u8]) -> Result<Vec<FileVariable>, Reason> {
    let head = bytes.get(..HEADER).ok_or("it is shorter than the 128 bytes of the header")?;
    let big_endian = match &head[126..] {
        b"IM" => false,
        b"MI" => true,
        _ => return Err("it has no header of version 5 (version 4 files are not read: save with -v7)".to_owned()),
    };
    let mut file = Bytes { rest: &bytes[HEADER..], big_endian };
    let mut all = Vec::new();
    while !file.rest.is_empty() {
        let element = file.element()?;
        let variable = if element.kind == COMPRESSED {
            let inner = inflate(element.bytes, big_endian)?;
            let element = file.inside(&inner).element()?;
            variable(&file, &element, DEEPEST)
        } else {
            variable(&file, &element, DEEPEST)
        }?;
        all.extend(variable.filter(|v| !v.name.is_empty()));
    }
    Ok(all)
}

/// The one element in a compressed one. Its size is the first thing it says; no more is made of it.
fn inflate(packed: &[u8], big_endian: bool) -> Result<Vec<u8>, Reason> {
    let broken = |e: std::io::Error| format!("a compressed variable is damaged ({e})");
    let mut stream = flate2::read::ZlibDecoder::new(packed);
    let mut tag = [0; 8];
    stream.read_exact(&mut tag).map_err(broken)?;
    let size = u64::from(Bytes { rest: &tag[4..], big_endian }.word()?);
    if size >= LARGEST {
        return Err(format!("a compressed variable says that it has {size} bytes, more than this kind of file may hold"));
    }
    let mut all = tag.to_vec();
    stream.take(size).read_to_end(&mut all).map_err(broken)?;
    Ok(all)
}

fn variable(file: &Bytes<'_>, element: &Element<'_>, deepest: usize) -> Result<Option<FileVariable>, Reason> {
    if element.kind != MATRIX || element.bytes.is_empty() {
        return Ok(None);
    }
    let mut b = file.inside(element.bytes);
    let flags = b.element()?;
    let word = file.inside(flags.bytes).word()?.to_le_bytes();
    let (class, flags) = (word[0], word[1]);
    if class == OPAQUE {
        let name = text(b.element()?.bytes);
        return Ok(Some(FileVariable {
            name,
            content: Content::Other("a table or another object; make a struct of it".to_owned()),
        }));
    }
    let dims = b.element()?;
    let mut words = file.inside(dims.bytes);
    let shape = (0..dims.bytes.len() / 4).map(|_| words.word().map(|n| n as usize)).collect::<Result<Vec<_>, _>>()?;
    let name = text(b.element()?.bytes);
    let content = match class {
        STRUCT if deepest > 0 => fields(&mut b, &shape, deepest)?,
        STRUCT => Content::Other("struct in struct in struct".to_owned()),
        CELL => Content::Other("cells".to_owned()),
        OBJECT => Content::Other("an object".to_owned()),
        CHAR => Content::Other("text".to_owned()),
        SPARSE => Content::Other("a sparse matrix".to_owned()),
        FUNCTION => Content::Other("a function".to_owned()),
        _ if flags & COMPLEX != 0 => Content::Other("complex numbers".to_owned()),
        _ => {
            let data = b.element()?;
            let values = stored(data.kind).and_then(|s| s.decode(data.bytes, file.big_endian));
            let values = values.ok_or_else(|| format!("{name} is stored as type {}, which is no number", data.kind))?;
            let size = shape.iter().try_fold(1_usize, |n, d| n.checked_mul(*d));
            if size != Some(values.len()) {
                return Err(format!("{name} says that it is {shape:?} and has {} numbers", values.len()));
            }
            Content::array(&shape, values)
        }
    };
    Ok(Some(FileVariable { name, content }))
}

fn fields(b: &mut Bytes<'_>, shape: &[usize], deepest: usize) -> Result<Content, Reason> {
    let length = b.element()?;
    let length = b.inside(length.bytes).word()? as usize;
    let names = b.element()?.bytes;
    if shape.iter().any(|n| *n != 1) {
        return Ok(Content::Other(format!("an array of structs, {shape:?}; save each as a file of its own")));
    }
    let mut all = Vec::new();
    for name in names.chunks(length.max(1)) {
        let element = b.element()?;
        if let Some(v) = variable(b, &element, deepest - 1)? {
            all.push(FileVariable { name: text(name), content: v.content });
        }
    }
    Ok(Content::Fields(all))
}

fn stored(kind: u32) -> Option<Stored> {
    let int = |bytes, signed| Some(Stored::Int { bytes, signed });
    match kind {
        1 => int(1, true),
        2 => int(1, false),
        3 => int(2, true),
        4 => int(2, false),
        5 => int(4, true),
        6 => int(4, false),
        7 => Some(Stored::Float { bytes: 4 }),
        9 => Some(Stored::Float { bytes: 8 }),
        12 => int(8, true),
        13 => int(8, false),
        _ => None,
    }
}

/// A name, without the zeros that fill its place.
fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes.split(|b| *b == 0).next().unwrap_or(bytes)).into_owned()
}
