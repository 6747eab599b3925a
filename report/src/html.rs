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

/// A table; heads of number columns are told by the cells below them.
pub(crate) fn table(heads: &[&str], rows: &[Vec<Cell>]) -> String {
    let mut out = String::from("<div class=\"wide\"><table><thead><tr>");
    for (k, h) in heads.iter().enumerate() {
        let right = rows.first().and_then(|r| r.get(k)).is_some_and(|c| matches!(c, Cell::Number(_)));
        let _ = write!(out, "<th{}>{}</th>", if right { " class=\"n\"" } else { "" }, escape(h));
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
    format!("<section><h2>{}</h2>\n{lead}{body}</section>\n", escape(title))
}

/// What a browser may do with a page: show its own style and pictures within it. It loads nothing, runs nothing and sends nothing.
const CSP: &str = "default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'";

/// The whole page.
pub(crate) fn page(title: &str, body: &str) -> String {
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta http-equiv=\"Content-Security-Policy\" content=\"{CSP}\">\n<meta name=\"viewport\" content=\"width=device-width, \
         initial-scale=1\">\n<meta name=\"generator\" content=\"windfall {}\">\n<title>{}</title>\n<style>\n{}</style>\n</head>\n\
         <body>\n<main>\n{body}</main>\n</body>\n</html>\n",
        env!("CARGO_PKG_VERSION"),
        escape(title),
        include_str!("page.css")
    )
}
