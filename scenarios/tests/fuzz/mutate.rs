//! tests: inputs that are nearly right. In: sound files, a seed and a number. Out: the input of that number, always the same.

/// Local chance: splitmix64 (Steele, Lea and Flood 2014).
pub(crate) struct Chance(u64);

impl Chance {
    pub(crate) fn new(seed: u64, reader: &str, index: u64) -> Self {
        let mut all = Self(seed ^ 0x9e37_79b9_7f4a_7c15);
        for b in reader.bytes().map(u64::from).chain([index]) {
            all.0 = all.next() ^ b.wrapping_mul(0xff51_afd7_ed55_8ccd);
        }
        all
    }
    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
    /// A whole number below `n`, 0 for none.
    pub(crate) fn below(&mut self, n: usize) -> usize {
        usize::try_from(self.next() % (n.max(1) as u64)).unwrap_or(0)
    }
    fn of<'a, T: ?Sized>(&mut self, all: &[&'a T]) -> &'a T {
        all[self.below(all.len())]
    }
    fn range(&mut self, length: usize, most: usize) -> std::ops::Range<usize> {
        let from = self.below(length + 1);
        from..(from + self.below(most + 1)).min(length)
    }
}

/// Numbers at which readers break.
const NUMBERS: [&str; 34] = [
    "0",
    "-0.0",
    "1",
    "-1",
    "nan",
    "inf",
    "-inf",
    "1e308",
    "-1e308",
    "1e309",
    "5e-324",
    "1e-30",
    "1e30",
    "1e12",
    "1e6",
    "0.5",
    "255",
    "256",
    "65536",
    "2147483647",
    "-2147483648",
    "4294967295",
    "9223372036854775807",
    "-9223372036854775808",
    "18446744073709551615",
    "99999999999999999999999",
    "0x10",
    "1_000",
    "1.7976931348623157e308",
    "1e-9",
    "1000000",
    "",
    "-",
    "1,5",
];
/// Words of the files, and what is never one.
const WORDS: [&str; 40] = [
    "true",
    "false",
    "null",
    "\"\"",
    "[]",
    "{}",
    "[[",
    "]]",
    "[",
    "]",
    "{",
    "}",
    "\"",
    "'",
    "\"\"\"",
    "'''",
    "#",
    "=",
    ",",
    ";",
    "\t",
    "\n",
    "\r\n",
    "\r",
    "\u{0}",
    "\u{feff}",
    "\u{202e}",
    "é",
    "\u{1f680}",
    "../x",
    "/dev/zero",
    "\\u0000",
    "\\ud800",
    "t_s",
    "X_m",
    "[[run]]",
    "[[flight]]",
    "[numerics]",
    "file = ",
    "1979-05-27T07:32:00Z",
];
/// Whole numbers at the edge of their type, as little-endian bytes.
const EDGES: [u64; 14] = [
    0,
    1,
    0x7f,
    0x80,
    0xff,
    0x7fff,
    0xffff,
    0x7fff_ffff,
    0x8000_0000,
    0xffff_ffff,
    0x10_0000_0000,
    1 << 62,
    i64::MAX as u64,
    u64::MAX,
];
/// Longest input.
const LONGEST: usize = 1 << 17;

/// What the bytes of a reader's files are.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Content {
    /// Lines of text.
    Text,
    /// The same with numbers in columns: separators and encodings change too.
    Table,
    /// Anything.
    Bytes,
}

/// Input `index` of a reader.
pub(crate) fn input(seeds: &[Vec<u8>], content: Content, chance: &mut Chance) -> Vec<u8> {
    let mut made = seeds[chance.below(seeds.len())].clone();
    // Half have one change, a quarter two, and so on.
    let changes = 1 + (chance.next().trailing_ones() as usize).min(12);
    for _ in 0..changes {
        let words = content != Content::Bytes && chance.below(5) > 0;
        if words { change_text(&mut made, seeds, chance) } else { change_bytes(&mut made, seeds, chance) }
    }
    if content == Content::Table {
        made = encoded(made, chance);
    }
    made.truncate(LONGEST);
    made
}

fn change_bytes(made: &mut Vec<u8>, seeds: &[Vec<u8>], chance: &mut Chance) {
    let n = made.len();
    let at = chance.below(n);
    match chance.below(10) {
        0 if n > 0 => made[at] ^= 1 << chance.below(8),
        1 if n > 0 => made[at] = (chance.next() & 0xff) as u8,
        2 => made.truncate(at),
        3 => drop(made.drain(chance.range(n, 64))),
        4 => {
            let piece = made[chance.range(n, 256)].to_vec();
            made.splice(at..at, piece);
        }
        5 => {
            let other = &seeds[chance.below(seeds.len())];
            let piece = other[chance.range(other.len(), 512)].to_vec();
            let to = (at + if chance.below(2) == 0 { piece.len() } else { 0 }).min(n);
            made.splice(at..to, piece);
        }
        6 => {
            // Heads and ends hold the counts.
            let at = match chance.below(3) {
                0 => chance.below(n.min(64)),
                1 => n - chance.below(n.min(64)),
                _ => at,
            };
            let width = [1, 2, 4, 8][chance.below(4)].min(n.saturating_sub(at));
            let mut bytes = EDGES[chance.below(EDGES.len())].to_le_bytes();
            if chance.below(4) == 0 {
                bytes[..width].reverse();
            }
            made[at..at + width].copy_from_slice(&bytes[..width]);
        }
        7 => {
            // A count of one more, one less, or somewhat other.
            if let Some(b) = made.get_mut(at) {
                *b = b.wrapping_add([1, 255, 16, 128][chance.below(4)]);
            }
        }
        8 => {
            let piece: Vec<u8> = (0..1 + chance.below(16)).map(|_| (chance.next() & 0xff) as u8).collect();
            made.splice(at..at, piece);
        }
        _ => {
            let value = [0, 0xff][chance.below(2)];
            let range = chance.range(n, 64);
            made[range].fill(value);
        }
    }
}

fn change_text(made: &mut Vec<u8>, seeds: &[Vec<u8>], chance: &mut Chance) {
    let n = made.len();
    match chance.below(12) {
        0..=3 => {
            if let Some(range) = token(made, chance, |b| b.is_ascii_digit() || matches!(b, b'.' | b'-' | b'+' | b'e')) {
                made.splice(range, chance.of(&NUMBERS).bytes());
            }
        }
        4 => {
            if let Some(range) = token(made, chance, |b| b.is_ascii_alphanumeric() || b == b'_') {
                made.splice(range, chance.of(&WORDS).bytes());
            }
        }
        5 => {
            let at = chance.below(n + 1);
            made.splice(at..at, chance.of(&WORDS).bytes());
        }
        // A value in the place of another.
        6 | 7 => {
            let other = &seeds[chance.below(seeds.len())];
            let word = |b: u8| !matches!(b, b'=' | b',' | b'\n' | b'{' | b'}' | b':' | b';' | b'\t');
            if let (Some(to), Some(from)) = (token(made, chance, word), token(other, chance, word)) {
                made.splice(to, other[from].to_vec());
            }
        }
        8..=10 => change_lines(made, seeds, chance),
        _ => {
            // Deep nesting, and long words.
            let piece = chance.of(&["[", "{\"a\":", "[[", "a.", "{a=", "9", "x", "\"", ","]).repeat(1 << chance.below(13));
            let at = chance.below(n + 1);
            made.splice(at..at, piece.bytes());
        }
    }
}

/// Lines that go, come twice, change places, or come from another file.
fn change_lines(made: &mut Vec<u8>, seeds: &[Vec<u8>], chance: &mut Chance) {
    let mut lines: Vec<&[u8]> = made.split_inclusive(|b| *b == b'\n').collect();
    let other: Vec<&[u8]> = seeds[chance.below(seeds.len())].split_inclusive(|b| *b == b'\n').collect();
    let (i, k, count) = (chance.below(lines.len()), chance.below(lines.len()), chance.below(8));
    if lines.is_empty() || other.is_empty() {
        return;
    }
    match chance.below(4) {
        0 => drop(lines.drain(i..(i + 1 + count).min(lines.len()))),
        1 => {
            let piece = lines[i..(i + 1 + count).min(lines.len())].to_vec();
            lines.splice(k..k, piece);
        }
        2 => lines.swap(i, k),
        _ => {
            let from = chance.below(other.len());
            lines.splice(k..k, other[from..(from + 1 + count).min(other.len())].iter().copied());
        }
    }
    *made = lines.concat();
}

/// A stretch of bytes of one kind, about a place by chance.
fn token(text: &[u8], chance: &mut Chance, is: impl Fn(u8) -> bool) -> Option<std::ops::Range<usize>> {
    let start = chance.below(text.len());
    let from = start + text[start..].iter().position(|b| is(*b))?;
    let from = text[..from].iter().rposition(|b| !is(*b)).map_or(0, |p| p + 1);
    Some(from..from + text[from..].iter().position(|b| !is(*b)).unwrap_or(text.len() - from))
}

/// Other separators and other encodings, of one table in four.
fn encoded(mut made: Vec<u8>, chance: &mut Chance) -> Vec<u8> {
    match chance.below(20) {
        way @ 0..=1 => {
            let separator = [b';', b'\t'][way];
            made.iter_mut().filter(|b| **b == b',').for_each(|b| *b = separator);
            made
        }
        2 => {
            // Decimal commas.
            let other = |b: &u8| match b {
                b',' => b';',
                b'.' => b',',
                b => *b,
            };
            made.iter().map(other).collect()
        }
        way @ 3..=4 => {
            let text = String::from_utf8_lossy(&made).into_owned();
            let mark = if chance.below(2) == 0 { "\u{feff}" } else { "" };
            mark.encode_utf16()
                .chain(text.encode_utf16())
                .flat_map(|u| if way == 3 { u.to_le_bytes() } else { u.to_be_bytes() })
                .collect()
        }
        5 => [&b"\xEF\xBB\xBF"[..], &made].concat(),
        _ => made,
    }
}
