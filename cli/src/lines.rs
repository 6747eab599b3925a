//! cli: text in lines. In: words. Out: lines of at most a hundred characters.

/// Words in lines of at most a hundred characters, `indent` already taken on the first.
pub(crate) fn folded(words: &str, indent: usize) -> String {
    let mut out = String::new();
    let mut at = indent;
    for word in words.split(' ') {
        if at + word.chars().count() > 100 {
            out.push_str("\n  ");
            at = 2;
        } else if !out.is_empty() {
            out.push(' ');
            at += 1;
        }
        out.push_str(word);
        at += word.chars().count();
    }
    out
}
