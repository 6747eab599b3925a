//! report: drawings as PDF. In: lists of marks. Out: one page of vector lines and letters (PDF 1.4; ISO 32000-1, Helvetica and Symbol of
//! the fourteen fonts that every reader has).

use crate::draw::{Anchor, Item, LETTERS, LineDrawing, Look, width};
use std::fmt::Write as _;

/// Bézier handle of a quarter circle over its radius.
const ROUND: f64 = 0.5523;

/// A file; `points`: size of a drawing unit, points.
pub(crate) fn file(d: &LineDrawing, points: f64) -> Vec<u8> {
    let [w, h] = d.size;
    // Drawings have y downward, PDF upward.
    let mut content = format!("{points:.5} 0 0 {points:.5} 0 0 cm\n1 0 0 -1 0 {h:.2} cm\n");
    d.items.iter().for_each(|i| item(&mut content, i));
    let title: String = d.title.chars().map(|c| if c.is_ascii() && !"()\\".contains(c) { c } else { ' ' }).collect();
    let objects = [
        "<< /Type /Catalog /Pages 2 0 R >>".to_owned(),
        "<< /Type /Pages /Kids [3 0 R] /Count 1 >>".to_owned(),
        format!(
            "<< /Type /Page /Parent 2 0 R /MediaBox [0 0 {:.2} {:.2}] /Contents 4 0 R /Resources << /Font << /H 5 0 R /S 6 0 R >> \
             /ExtGState << /Thin << /ca 0.22 >> /Full << /ca 1 >> >> >> >>",
            w * points,
            h * points
        ),
        format!("<< /Length {} >>\nstream\n{content}endstream", content.len()),
        "<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica /Encoding /WinAnsiEncoding >>".to_owned(),
        "<< /Type /Font /Subtype /Type1 /BaseFont /Symbol >>".to_owned(),
        format!("<< /Title ({title}) /Producer (windfall {}) >>", env!("CARGO_PKG_VERSION")),
    ];
    let mut out = String::from("%PDF-1.4\n");
    let mut places = Vec::new();
    for (k, o) in objects.iter().enumerate() {
        places.push(out.len());
        let _ = write!(out, "{} 0 obj\n{o}\nendobj\n", k + 1);
    }
    let start = out.len();
    let _ = write!(out, "xref\n0 {}\n0000000000 65535 f \n", objects.len() + 1);
    for p in places {
        let _ = writeln!(out, "{p:010} 00000 n ");
    }
    let _ = write!(out, "trailer\n<< /Size {} /Root 1 0 R /Info 7 0 R >>\nstartxref\n{start}\n%%EOF\n", objects.len() + 1);
    out.into_bytes()
}

fn colour(look: Look, operator: &str) -> String {
    let [r, g, b] = look.rgb().map(|c| f64::from(c) / 255.0);
    format!("{r:.3} {g:.3} {b:.3} {operator}\n")
}

fn path(points: &[[f64; 2]]) -> String {
    points.iter().enumerate().map(|(k, [x, y])| format!("{x:.2} {y:.2} {}\n", if k == 0 { 'm' } else { 'l' })).collect()
}

fn item(out: &mut String, item: &Item) {
    match item {
        Item::Line { look, pieces } => {
            let dash = look.dash().map_or_else(|| "[] 0 d\n".to_owned(), |[a, b]| format!("[{a} {b}] 0 d\n"));
            *out += &format!("{}{:.2} w 1 j\n{dash}", colour(*look, "RG"), look.width());
            pieces.iter().for_each(|p| *out += &format!("{}S\n", path(p)));
        }
        Item::Area { look, points } => *out += &format!("/Thin gs\n{}{}h f\n/Full gs\n", colour(*look, "rg"), path(points)),
        Item::Rect { look, at: [x, y, w, h] } => *out += &format!("{}{x:.2} {y:.2} {w:.2} {h:.2} re f\n", colour(*look, "rg")),
        Item::Disc { look, at: [x, y], radius: r } => {
            let k = ROUND * r;
            *out += &format!(
                "{}{:.2} {y:.2} m\n{:.2} {:.2} {:.2} {:.2} {x:.2} {:.2} c\n{:.2} {:.2} {:.2} {:.2} {:.2} {y:.2} c\n{:.2} {:.2} {:.2} \
                 {:.2} {x:.2} {:.2} c\n{:.2} {:.2} {:.2} {:.2} {:.2} {y:.2} c\nf\n",
                colour(*look, "rg"),
                x + r,
                x + r,
                y + k,
                x + k,
                y + r,
                y + r,
                x - k,
                y + r,
                x - r,
                y + k,
                x - r,
                x - r,
                y - k,
                x - k,
                y - r,
                y - r,
                x + k,
                y - r,
                x + r,
                y - k,
                x + r
            );
        }
        Item::Text { look, at, anchor, turned, text } => words(out, *look, *at, *anchor, *turned, text),
    }
}

fn words(out: &mut String, look: Look, [x, y]: [f64; 2], anchor: Anchor, turned: bool, text: &str) {
    let share = match anchor {
        Anchor::Start => 0.0,
        Anchor::Middle => 0.5,
        Anchor::End => 1.0,
    };
    let back = share * width(text);
    // Letters stand upright: their own y is upward.
    let matrix = if turned { format!("0 -1 -1 0 {x:.2} {:.2}", y + back) } else { format!("1 0 0 -1 {:.2} {y:.2}", x - back) };
    *out += &format!("BT\n{}{matrix} Tm\n", colour(look, "rg"));
    for (symbol, codes) in fonts(text) {
        let hex: String = codes.iter().map(|c| format!("{c:02x}")).collect();
        *out += &format!("/{} {LETTERS} Tf <{hex}> Tj\n", if symbol { 'S' } else { 'H' });
    }
    *out += "ET\n";
}

/// Pieces of a text in Helvetica (false) or Symbol (true), as codes of their encodings.
fn fonts(text: &str) -> Vec<(bool, Vec<u8>)> {
    let mut all: Vec<(bool, Vec<u8>)> = Vec::new();
    for c in text.chars() {
        let (symbol, code) = code(c);
        match all.last_mut() {
            Some((same, codes)) if *same == symbol => codes.push(code),
            _ => all.push((symbol, vec![code])),
        }
    }
    all
}

fn code(c: char) -> (bool, u8) {
    const GREEK: [(char, u8); 13] = [
        ('α', b'a'),
        ('β', b'b'),
        ('γ', b'g'),
        ('δ', b'd'),
        ('θ', b'q'),
        ('Θ', b'Q'),
        ('ω', b'w'),
        ('φ', b'f'),
        ('σ', b's'),
        ('√', 0xd6),
        ('→', 0xae),
        ('−', 0x2d),
        ('Σ', b'S'),
    ];
    if let Some((_, code)) = GREEK.iter().find(|(g, _)| *g == c) {
        return (true, *code);
    }
    match c {
        '–' => (false, 0x96),
        '—' => (false, 0x97),
        '’' => (false, 0x92),
        '\u{a0}' => (false, b' '),
        c => (false, u8::try_from(u32::from(c)).unwrap_or(b'?')),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every object is where the table says, and the stream as long as it says.
    #[test]
    fn law_the_table_points_at_objects() {
        let mut d = LineDrawing { title: "Θ (deg)".to_owned(), size: [100.0, 50.0], fixed: false, items: Vec::new() };
        d.text(Look::Ink, [10.0, 20.0], Anchor::Middle, "Θ (deg) ± 3 √Hz");
        d.line(Look::Noise, &[[0.0, 0.0], [10.0, 10.0]]);
        d.items.push(Item::Disc { look: Look::After, at: [5.0, 5.0], radius: 2.0 });
        let text = String::from_utf8(file(&d, 0.7)).expect("letters are written as codes");
        let table = &text[text.rfind("xref\n0").expect("a table")..];
        for (k, line) in table.lines().skip(3).take(7).enumerate() {
            let at: usize = line[..10].parse().expect("a place");
            assert!(text[at..].starts_with(&format!("{} 0 obj", k + 1)), "{line}");
        }
        let length: usize =
            text.split("/Length ").nth(1).and_then(|t| t.split(' ').next()).and_then(|t| t.parse().ok()).expect("a length");
        let (_, after) = text.split_once("stream\n").expect("a stream");
        let (stream, _) = after.split_once("endstream").expect("its end");
        assert_eq!(stream.len(), length);
        assert_eq!(fonts("Θ±"), vec![(true, vec![b'Q']), (false, vec![0xb1])]);
    }
}
