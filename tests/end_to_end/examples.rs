//! tests: the facade by example. In: the sources of `windfall`. Out: no public type without code that shows it.

use std::path::Path;

/// Names of public types of a file, each with whether the text right above it has code.
fn types(text: &str) -> Vec<(String, bool)> {
    let (mut all, mut shown) = (Vec::new(), false);
    for line in text.lines().map(str::trim_start) {
        if line.starts_with("///") {
            shown |= line.starts_with("/// ```");
            continue;
        }
        let name = ["pub struct ", "pub enum ", "pub trait "].iter().find_map(|word| line.strip_prefix(word));
        if let Some(name) = name {
            all.push((name.chars().take_while(|c| c.is_alphanumeric()).collect(), shown));
        }
        shown &= line.starts_with("#[");
    }
    all
}

#[test]
fn law_every_type_of_the_facade_is_shown() {
    let sources = Path::new(env!("CARGO_MANIFEST_DIR")).join("../windfall/src");
    let mut seen = 0;
    for entry in std::fs::read_dir(sources).expect("the facade's sources").flatten() {
        let text = std::fs::read_to_string(entry.path()).expect("text");
        for (name, shown) in types(&text) {
            assert!(shown, "{}: {name} has no example", entry.path().display());
            seen += 1;
        }
    }
    assert!(seen > 20, "{seen} types seen");
}

/// The reader sees what it is meant to see.
#[test]
fn law_a_type_without_code_is_seen() {
    let text = "/// A.\n///\n/// ```\n/// use a;\n/// ```\n#[derive(Debug)]\npub struct A {\n}\n/// B.\npub enum B {}\n/// C.\npub(crate) struct C;";
    assert_eq!(types(text), [("A".to_owned(), true), ("B".to_owned(), false)]);
}
