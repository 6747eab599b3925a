//! report: pieces of a page. In: text and cells. Out: HTML, everything escaped.

use std::fmt::Write as _;

/// Text made safe inside HTML.
pub(crate) fn escape(text: &str) -> String {
    text.chars().fold(String::with_capacity(text.len()), |mut all, c| {
        match c {
            '&' => all.push_str("&amp;"),
            '<' => all.push_str("&lt;"),
            '>' => all.push_str("&gt;"),
            '"' => all.push_str("&quot;"),
            '\'' => all.push_str("&#39;"),
            c => all.push(c),
        }
        all
    })
}

/// One cell of a table.
pub(crate) enum Cell {
    /// Words, to the left.
    Text(String),
    /// A number, to the right.
    Number(String),
    /// HTML made by this room, as it is.
    Made(String),
}

impl Cell {
    pub(crate) fn text(t: impl Into<String>) -> Self {
        Self::Text(t.into())
    }
    pub(crate) fn number(x: f64) -> Self {
        Self::Number(crate::number(x))
    }
}

/// A table; heads of number columns are known by the cells below them.
pub(crate) fn table(heads: &[&str], rows: &[Vec<Cell>]) -> String {
    let mut out = String::from("<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"table\"><table><thead><tr>");
    for (k, h) in heads.iter().enumerate() {
        let right = rows.first().and_then(|r| r.get(k)).is_some_and(|c| matches!(c, Cell::Number(_)));
        let _ = write!(out, "<th scope=\"col\"{}>{}</th>", if right { " class=\"n\"" } else { "" }, escape(h));
    }
    out.push_str("</tr></thead><tbody>");
    for row in rows {
        out.push_str("<tr>");
        for cell in row {
            let _ = match cell {
                Cell::Text(t) => write!(out, "<td>{}</td>", escape(t)),
                Cell::Number(t) => write!(out, "<td class=\"n\">{}</td>", escape(t)),
                Cell::Made(t) => write!(out, "<td>{t}</td>"),
            };
        }
        out.push_str("</tr>");
    }
    out.push_str("</tbody></table></div>\n");
    out
}

/// A section with a heading; nothing when it would be empty.
pub(crate) fn section(title: &str, lead: &str, body: &str) -> String {
    if body.is_empty() {
        return String::new();
    }
    let lead = if lead.is_empty() { String::new() } else { format!("<p class=\"lead\">{}</p>\n", escape(lead)) };
    format!("<section id=\"{}\"><h2>{}</h2>\n{lead}{body}</section>\n", slug(title), escape(title))
}

/// A title as a word for links and file names.
pub(crate) fn slug(title: &str) -> String {
    let plain = |c: char| if c.is_alphanumeric() { c.to_lowercase().next().unwrap_or('-') } else { '-' };
    let joined: String = title.chars().map(plain).collect();
    joined.split('-').filter(|w| !w.is_empty()).collect::<Vec<_>>().join("-")
}

/// The page's own program, and the plots' (see `vendor/uplot/README.md`).
const PROGRAMS: [&str; 9] = [
    include_str!("../vendor/uplot/uPlot.iife.min.js"),
    include_str!("page/data.js"),
    include_str!("page/charts.js"),
    include_str!("page/spectrum.js"),
    include_str!("page/tracks.js"),
    include_str!("page/gl.js"),
    include_str!("page/replay.js"),
    include_str!("page/filter.js"),
    include_str!("page/main.js"),
];

/// The whole page. `data`: what its program reads.
pub(crate) fn page(title: &str, body: &str, data: &str) -> String {
    // Scripts run that carry this word alone; it depends on everything on the page, so that no name in a result can hold it.
    let word = format!("{:016x}{:016x}", fingerprint(body), fingerprint(data));
    // It loads nothing and sends nothing.
    let csp = format!(
        "default-src 'none'; script-src 'nonce-{word}'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'"
    );
    let programs: String = PROGRAMS.iter().map(|p| format!("<script nonce=\"{word}\">\n{p}</script>\n")).collect();
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta http-equiv=\"Content-Security-Policy\" \
         content=\"{csp}\">\n<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<meta name=\"generator\" \
         content=\"windfall {}\">\n<title>{}</title>\n<style>\n{}{}</style>\n</head>\n<body>\n<a class=\"skip\" href=\"#top\">To the \
         results</a>\n{}<main id=\"top\">\n{body}</main>\n<script type=\"application/json\" id=\"data\">{data}</script>\n{programs}\
         </body>\n</html>\n",
        env!("CARGO_PKG_VERSION"),
        escape(title),
        include_str!("../vendor/uplot/uPlot.min.css"),
        include_str!("page/style.css"),
        contents(body),
    )
}

/// Links to the sections of a body.
fn contents(body: &str) -> String {
    let links: String = body
        .match_indices("<section id=\"")
        .filter_map(|(at, tag)| {
            let (id, rest) = body[at + tag.len()..].split_once('"')?;
            let title = rest.split_once("<h2>")?.1.split_once("</h2>")?.0;
            Some(format!("<li><a href=\"#{id}\">{title}</a></li>"))
        })
        .collect();
    if links.is_empty() { String::new() } else { format!("<nav aria-label=\"Sections\"><ul>{links}</ul></nav>\n") }
}

/// FNV-1a (Fowler, Noll, Vo).
fn fingerprint(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |h, b| (h ^ u64::from(b)).wrapping_mul(0x0000_0100_0000_01b3))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn law_a_name_cannot_become_a_tag() {
        let made = page("<script>alert(1)</script>", &section("a & <b>", "<i>", "<p>made</p>"), "{}");
        assert!(!made.contains("<script>alert") && !made.contains("<i>"));
        assert!(made.contains("<section id=\"a-b\"><h2>a &amp; &lt;b&gt;</h2>") && made.contains("href=\"#a-b\""));
        // Every program carries the word that the policy asks for.
        assert_eq!(made.matches("<script nonce=").count(), PROGRAMS.len());
    }
}
