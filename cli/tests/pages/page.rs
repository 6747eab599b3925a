//! cli tests: a page of the documentation taken apart. In: Markdown. Out: commands, recorded outputs, figures and marks, in the order of the page.
//!
//! Marks are HTML comments, which readers do not see:
//!
//! | mark | says |
//! |---|---|
//! | `<!-- file: NAME -->` | the next block is this file |
//! | `<!-- run: COMMAND -->` | a command that the page needs and does not show |
//! | `<!-- edit: FILE: OLD => NEW -->` | replaces words of a file |
//! | `<!-- exit: N -->` | the exit code of the next command, where it is not 0 |
//! | `<!-- output -->`, `<!-- errors -->` | the next block is what the last command printed; `...` stands for what is left out |
//! | `<!-- = FILE#PLACE -->` | the number before it is this one of a result |
//! | `<!-- made by: WHAT -->` | tables of figures up to the next heading of its level are of a run that no page repeats: by what |
//! | `<!-- not run: REASON -->` | the next command or block of commands is not run |
//! | `<!-- nightly: N min -->` | all that follows on the page is run by the ignored test alone |

use std::ops::Range;

/// What stands at a place.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum What {
    /// A comment's words.
    Mark(String),
    /// Language and text of a fenced block.
    Block(String, String),
    /// Code within a paragraph.
    Code(String),
    /// A heading, by its level.
    Heading(usize),
    /// A table, and how many of its cells are numbers.
    Table(usize),
}

/// Something on a page, with the bytes that it takes (of a block: its text).
#[derive(Clone, Debug)]
pub(crate) struct Item {
    pub(crate) what: What,
    pub(crate) at: Range<usize>,
}

/// Line of a byte, from 1.
pub(crate) fn line(text: &str, at: usize) -> usize {
    text[..at].matches('\n').count() + 1
}

/// Takes a page apart.
pub(crate) fn items(text: &str) -> Vec<Item> {
    let mut all = Vec::new();
    let (mut at, mut paragraph) = (0, 0);
    let lines: Vec<(usize, &str)> = text
        .split_inclusive('\n')
        .map(|l| {
            at += l.len();
            (at - l.len(), l)
        })
        .collect();
    let mut i = 0;
    while i < lines.len() {
        let (from, l) = lines[i];
        let Some(language) = l.trim_start().strip_prefix("```") else {
            i += 1;
            continue;
        };
        within(text, paragraph..from, &mut all);
        let end = (i + 1..lines.len()).find(|&k| lines[k].1.trim_start().starts_with("```")).unwrap_or(lines.len() - 1);
        let inside = from + l.len()..lines[end].0;
        let indent = l.len() - l.trim_start().len();
        let body: String = text[inside.clone()].split_inclusive('\n').map(|l| l.get(indent..).unwrap_or("\n")).collect();
        all.push(Item { what: What::Block(language.trim().to_owned(), body), at: inside });
        paragraph = lines[end].0 + lines[end].1.len();
        i = end + 1;
    }
    within(text, paragraph..text.len(), &mut all);
    all
}

/// Marks, code, headings and tables of running text.
fn within(text: &str, part: Range<usize>, all: &mut Vec<Item>) {
    let mut at = part.start;
    while at < part.end {
        let rest = &text[at..part.end];
        let at_line = at == 0 || text[..at].ends_with('\n');
        if let Some(inside) = rest.strip_prefix("<!--") {
            let length = inside.find("-->").unwrap_or(inside.len());
            all.push(Item { what: What::Mark(words(&inside[..length])), at: at..at + 4 + length });
            at += (4 + length + 3).min(rest.len());
        } else if rest.starts_with('`') {
            let ticks = rest.len() - rest.trim_start_matches('`').len();
            let fence = &rest[..ticks];
            let length = rest[ticks..].find(fence).unwrap_or(0);
            if length > 0 {
                all.push(Item { what: What::Code(words(&rest[ticks..ticks + length])), at: at + ticks..at + ticks + length });
            }
            at += 2 * ticks + length;
        } else {
            if at_line && rest.starts_with('#') {
                let level = rest.len() - rest.trim_start_matches('#').len();
                all.push(Item { what: What::Heading(level), at: at..at + level });
                at += level - 1;
            }
            if at_line && rest.starts_with('|') && !text[..at].ends_with("|\n") {
                let rows = rest.split_inclusive('\n').take_while(|l| l.starts_with('|'));
                let end = at + rows.map(str::len).sum::<usize>();
                all.push(Item { what: What::Table(numbers(&text[at..end])), at: at..end });
            }
            at += rest.chars().next().map_or(1, char::len_utf8);
        }
    }
}

/// Cells of a table that are a decimal number, or begin with one.
fn numbers(table: &str) -> usize {
    let is = |cell: &&str| {
        let first = cell.trim().trim_start_matches('*').split([' ', '*', '<']).next().unwrap_or("");
        first.contains('.') && crate::text::printed(first).is_some()
    };
    table.split('|').filter(is).count()
}

/// Words with single spaces.
pub(crate) fn words(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Programs whose lines make a block one of commands.
const PROGRAMS: [&str; 10] = ["windfall", "$", "cargo", "git", "pip", "python", "just", "for", "sbatch", "cd"];

/// Commands of a block, a line each without what follows `#`; none where it is no block of commands.
pub(crate) fn commands(language: &str, body: &str) -> Vec<String> {
    if !["", "sh", "bash", "text", "console"].contains(&language) {
        return Vec::new();
    }
    let joined = body.replace("\\\n", " ");
    let command = |l: &&str| {
        let first = l.split_whitespace().next().unwrap_or("");
        PROGRAMS.contains(&first)
            || first.starts_with("scripts/")
            || (first.contains('=') && first.starts_with(|c: char| c.is_ascii_uppercase()))
    };
    let lines: Vec<&str> = joined.lines().filter(|l| !l.trim().is_empty()).collect();
    let first = lines.first().filter(|l| command(l));
    if first.is_none() {
        return Vec::new();
    }
    let shown = first.is_some_and(|l| l.starts_with("$ "));
    let own = lines.iter().filter(|l| !shown || l.starts_with("$ "));
    own.flat_map(|l| l.trim_start_matches("$ ").split(" # ").next().unwrap_or("").split(" && ")).map(words).collect()
}

/// Whether words name a command without giving one to run: its verb alone, or capitals and the like in the place of what is one's own.
pub(crate) fn is_mention(command: &str) -> bool {
    let arguments: Vec<&str> = command.split(' ').skip(2).collect();
    let own = |w: &&str| {
        w.contains('…')
            || *w == "i/n"
            || w.split(|c: char| !(c.is_alphanumeric() || c == '_'))
                .any(|p| !p.is_empty() && p.chars().all(|c| c.is_ascii_uppercase()))
    };
    arguments.is_empty() || arguments[0].starts_with("--") || arguments.iter().any(own)
}

#[test]
fn law_pages_are_taken_apart() {
    let text = "# A\n\nRun `windfall check\nappendix-c` <!-- not run: why -->, then 1.5<!-- = a#b -->.\n\n```sh\nwindfall x \\\n  --out a   # b\n```\n| a | 1.5 |\n|---|---|\n";
    let all = items(text);
    let whats: Vec<&What> = all.iter().map(|i| &i.what).collect();
    assert_eq!(whats[0], &What::Heading(1));
    assert_eq!(whats[1], &What::Code("windfall check appendix-c".to_owned()));
    assert_eq!(whats[2], &What::Mark("not run: why".to_owned()));
    assert_eq!(whats[3], &What::Mark("= a#b".to_owned()));
    assert!(matches!(whats[4], What::Block(l, _) if l == "sh"));
    assert_eq!((whats[5], whats.len()), (&What::Table(1), 6));
    assert_eq!(line(text, all[4].at.start), 7);
    assert_eq!(commands("sh", "windfall x \\\n  --out a   # b\n"), ["windfall x --out a"]);
    assert_eq!(commands("", "$ windfall a b\nsays this\n"), ["windfall a b"]);
    assert_eq!(commands("sh", "windfall a && windfall b\n"), ["windfall a", "windfall b"]);
    assert!(commands("", "no command\nwindfall a\n").is_empty() && commands("toml", "windfall a\n").is_empty());
    assert!(
        is_mention("windfall close CAMPAIGN.toml") && is_mention("windfall identify --method") && is_mention("windfall plan")
    );
    assert!(!is_mention("windfall plan f/campaign.toml --target CA_T0=0.05%") && is_mention("windfall study s --shard i/n"));
}
