//! scenarios: text of a file. In: bytes, packed or not. Out: text and what was done to have it, or what the bytes are.

use super::Reason;
use std::io::Read as _;

/// Most bytes that a packed text may unpack to: so many beside a hundred for each packed one. Records pack to a third; what packs to less than
/// a hundredth says nothing and would fill the memory.
const LARGEST: u64 = 4 << 20;
const PACKED: u64 = 100;

/// The text of UTF-8 or UTF-16, with or without a byte order mark, packed with gzip or not; a note where it is not plain UTF-8.
pub(super) fn text(bytes: Vec<u8>) -> Result<(String, Vec<String>), Reason> {
    if bytes.starts_with(b"\x1F\x8B") {
        let mut all = Vec::new();
        let most = LARGEST + PACKED * bytes.len() as u64;
        let mut stream = flate2::read::MultiGzDecoder::new(&bytes[..]).take(most);
        stream.read_to_end(&mut all).map_err(|e| format!("is packed with gzip and damaged or cut short ({e})"))?;
        if all.len() as u64 == most {
            return Err(format!(
                "is packed with gzip: {} bytes that unpack to {most} or more, which no record does",
                bytes.len()
            ));
        }
        return plain(all);
    }
    plain(bytes)
}

fn plain(bytes: Vec<u8>) -> Result<(String, Vec<String>), Reason> {
    let wide = |high_first: bool, bytes: &[u8]| {
        let word = |b: &[u8; 2]| if high_first { u16::from_be_bytes(*b) } else { u16::from_le_bytes(*b) };
        let words: Vec<u16> = bytes.as_chunks::<2>().0.iter().map(word).collect();
        let text = String::from_utf16(&words).map_err(|_| "is UTF-16 with characters cut in half".to_owned())?;
        Ok((text, vec!["read as UTF-16".to_owned()]))
    };
    match &bytes[..] {
        [0xff, 0xfe, rest @ ..] => return wide(false, rest),
        [0xfe, 0xff, rest @ ..] => return wide(true, rest),
        // A header in Latin letters has a zero in every other byte.
        [a, 0, b, 0, ..] if *a != 0 && *b != 0 => return wide(false, &bytes),
        [0, a, 0, b, ..] if *a != 0 && *b != 0 => return wide(true, &bytes),
        _ => {}
    }
    let bytes = if bytes.starts_with(b"\xEF\xBB\xBF") { bytes[3..].to_vec() } else { bytes };
    if bytes.contains(&0) {
        return Err("has zero bytes: it is no text".to_owned());
    }
    let text = String::from_utf8(bytes).map_err(|e| {
        let at = e.utf8_error().valid_up_to();
        let line = e.as_bytes()[..at].iter().filter(|b| **b == b'\n').count() + 1;
        format!("is not UTF-8: byte {:#04x} in line {line} (it may be Latin-1 or Windows-1252)", e.as_bytes()[at])
    })?;
    Ok((text, Vec::new()))
}
