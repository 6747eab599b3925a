//! cli tests: words and numbers of a text. In: a page's recorded output, what the program printed. Out: whether they say the same, each number
//! within its last printed digit; where they do not.

use std::ops::Range;

/// A word, or a number with the unit of its last digit.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Token {
    Word(String),
    Number {
        value: f64,
        last: f64,
    },
    /// `...`: something is left out.
    Gap,
}

/// A token and where it stands.
#[derive(Clone, Debug)]
pub(crate) struct Placed {
    pub(crate) token: Token,
    pub(crate) at: Range<usize>,
}

/// A printed number and the unit of its last digit: `+9.85`, `−2.0035`, `4.2e-5`, `4·10⁻⁸`. A whole number is exact.
pub(crate) fn printed(word: &str) -> Option<(f64, f64)> {
    let word = word.replace('−', "-");
    let (digits, power) = match word.split_once("·10") {
        Some((digits, raised)) => {
            let plain = |c: char| match c {
                '⁻' => '-',
                c => "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().position(|s| s == c).and_then(|d| char::from_digit(d as u32, 10)).unwrap_or('x'),
            };
            (digits.to_owned(), Some(raised.chars().map(plain).collect::<String>().parse().ok()?))
        }
        None => match word.split_once('e') {
            Some((digits, power)) => (digits.to_owned(), Some(power.parse().ok()?)),
            None => (word, None),
        },
    };
    let number: f64 = digits.trim_start_matches('+').parse().ok().filter(|x: &f64| x.is_finite())?;
    let places = digits.split_once('.').map(|(_, after)| after.len());
    let last = match (places, power) {
        (None, None) => 0.0,
        (places, power) => 10_f64.powi(power.unwrap_or(0) - i32::try_from(places.unwrap_or(0)).ok()?),
    };
    Some((number * 10_f64.powi(power.unwrap_or(0)), last))
}

fn in_number(c: char) -> bool {
    c.is_ascii_digit() || c == '.'
}

/// End of the number that begins at `from`, where one does.
fn number_end(text: &str, from: usize) -> Option<usize> {
    let rest = &text[from..];
    let sign = rest.chars().next().filter(|c| "+-−".contains(*c)).map_or(0, char::len_utf8);
    let digits = rest[sign..].find(|c| !in_number(c)).unwrap_or(rest.len() - sign);
    let mut end = sign + rest[sign..sign + digits].trim_end_matches('.').len();
    if !rest[sign..end].starts_with(|c: char| c.is_ascii_digit()) {
        return None;
    }
    if let Some(power) = rest[end..].strip_prefix("·10") {
        let raised = power.find(|c| !"⁻⁰¹²³⁴⁵⁶⁷⁸⁹".contains(c)).unwrap_or(power.len());
        end += if raised > 0 { "·10".len() + raised } else { 0 };
    } else if let Some(power) = rest[end..].strip_prefix('e') {
        let sign = usize::from(power.starts_with(['-', '+']));
        let digits = power[sign..].find(|c: char| !c.is_ascii_digit()).unwrap_or(power.len() - sign);
        end += if digits > 0 { 1 + sign + digits } else { 0 };
    }
    Some(from + end)
}

/// Words and numbers of a text; how it is broken into lines does not matter.
pub(crate) fn tokens(text: &str) -> Vec<Placed> {
    let mut all = Vec::new();
    let mut at = 0;
    while let Some(c) = text[at..].chars().next() {
        if c.is_whitespace() {
            at += c.len_utf8();
            continue;
        }
        if text[at..].starts_with("...") {
            all.push(Placed { token: Token::Gap, at: at..at + 3 });
            at += 3;
            continue;
        }
        let number = number_end(text, at).and_then(|end| Some((printed(&text[at..end])?, end)));
        if let Some(((value, last), end)) = number {
            all.push(Placed { token: Token::Number { value, last }, at: at..end });
            at = end;
            continue;
        }
        // A digit within a name (`Cm_2`, `perturbed-1`) is the name's.
        let name = |c: char| c.is_alphanumeric() || c == '_';
        let mut end = at + c.len_utf8();
        if name(c) {
            let more = |(i, d): (usize, char)| !(name(d) || d == '-' && text[at + i + 1..].starts_with(name));
            end = text[at..].char_indices().find(|&p| more(p)).map_or(text.len(), |(i, _)| at + i);
        }
        all.push(Placed { token: Token::Word(text[at..end].to_owned()), at: at..end });
        at = end;
    }
    all
}

fn alike(a: &Token, b: &Token) -> bool {
    match (a, b) {
        (Token::Number { .. }, Token::Number { .. }) => true,
        (a, b) => a == b,
    }
}

/// Pairs of tokens, expected and got, of a text whose words are those expected; none where they are others. What a gap stands for is left out.
pub(crate) fn pairs<'t>(expected: &'t [Placed], got: &'t [Placed]) -> Option<Vec<(&'t Placed, &'t Placed)>> {
    let mut all = Vec::new();
    let mut from = 0;
    let parts: Vec<&[Placed]> = expected.split(|p| p.token == Token::Gap).collect();
    for (i, part) in parts.iter().enumerate() {
        let fits =
            |at: usize| got.len() >= at + part.len() && part.iter().zip(&got[at..]).all(|(e, g)| alike(&e.token, &g.token));
        let at = match (i == 0, i + 1 == parts.len()) {
            (true, _) => Some(0).filter(|&at| fits(at)),
            (false, true) => got.len().checked_sub(part.len()).filter(|&at| at >= from && fits(at)),
            (false, false) => (from..got.len()).find(|&at| fits(at)),
        }?;
        all.extend(part.iter().zip(&got[at..]));
        from = at + part.len();
    }
    (parts.len() > 1 || from == got.len()).then_some(all)
}

/// Whether a number that is got is the expected one: within a unit of its last digit (half of it by rounding, the other half for another machine's
/// arithmetic).
pub(crate) fn agrees(expected: &Token, got: &Token) -> bool {
    match (expected, got) {
        (Token::Number { value, last }, Token::Number { value: now, .. }) => (now - value).abs() <= last * (1.0 + 1e-9),
        (a, b) => a == b,
    }
}

/// A number written as another one is: as many places, the same exponent's form, the same minus.
pub(crate) fn written_like(pattern: &str, value: f64) -> String {
    let minus = |text: String| if pattern.contains('−') { text.replace('-', "−") } else { text };
    let plus = |text: String| if pattern.starts_with('+') && value >= 0.0 { format!("+{text}") } else { text };
    let places = |digits: &str| digits.split_once('.').map_or(0, |(_, after)| after.len());
    if let Some((digits, _)) = pattern.split_once("·10") {
        let text = format!("{value:.*e}", places(digits));
        let (digits, power) = text.split_once('e').unwrap_or((&text, "0"));
        let raise = |c: char| c.to_digit(10).and_then(|d| "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().nth(d as usize)).unwrap_or('⁻');
        return plus(minus(format!("{digits}·10{}", power.chars().map(raise).collect::<String>())));
    }
    match pattern.split_once('e') {
        Some((digits, _)) => plus(minus(format!("{value:.*e}", places(digits)))),
        None => plus(minus(format!("{value:.*}", places(pattern)))),
    }
}

#[test]
fn law_numbers_agree_within_their_last_digit_and_words_exactly() {
    let same = |expected: &str, got: &str| {
        let (e, g) = (tokens(expected), tokens(got));
        pairs(&e, &g).is_some_and(|all| all.iter().all(|(e, g)| agrees(&e.token, &g.token)))
    };
    assert!(same("z_m 0.00100004 ± 0.00000074 (95 %) m", "z_m    0.00100005 ±\n 0.00000074 (95 %) m"));
    assert!(!same("z_m 0.00100004", "z_m 0.00100006") && !same("z_m 0.001", "y_m 0.001"));
    assert!(same("a 5.5e-8 ± 9.9e-8", "a 5.4e-8 ± 1.00e-7") && !same("a 5.5e-8", "a 5.5e-7"));
    assert!(!same("8 with a result", "7 with a result"), "a count is exact");
    assert!(same("first ... last", "first and much between last") && !same("first ... last", "first and much between"));
    assert!(same("... in the middle 2.0 ...", "begins in the middle 2.1 and ends") && same("... end", "all to the end"));
    assert!(!same("one", "one more") && !same("perturbed-1 1.0", "perturbed-2 1.0"));
    assert_eq!(tokens("[6.66, -1.5e-3]; Cm_2 4·10⁻⁸ 10.").len(), 10);
    assert_eq!(printed("4·10⁻⁸").map(|p| p.0 * 1e8), Some(4.0));
    for (pattern, value, text) in
        [("−2.0035", -2.1, "−2.1000"), ("+9.85", 1.0, "+1.00"), ("4·10⁻⁸", 3.2e-7, "3·10⁻⁷"), ("5.5e-8", 6e-8, "6.0e-8")]
    {
        assert_eq!(written_like(pattern, value), text);
    }
}
