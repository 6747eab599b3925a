//! report: what colours stand for, and shares in words. In: figures, marks. Out: HTML.

use crate::chart::look;
use crate::html::escape;
use windfall_discover::close::{Figure, Role};

/// Marks by colour what they are, by class.
pub(crate) fn key(marks: &[(&str, &str)]) -> String {
    let one = |(class, name): &(&str, &str)| format!("<span class=\"key {class}\"></span>{}", escape(name));
    format!("<p class=\"note\">{}</p>\n", marks.iter().map(one).collect::<String>())
}

/// What the colours of some figures are.
pub(crate) fn legend(figures: &[Figure]) -> String {
    let names = [(Role::Before, "declared model"), (Role::After, "with the effects added"), (Role::Noise, "noise alone")];
    let any = |points: bool, role: Role| figures.iter().any(|f| f.series.iter().any(|s| s.role == role && s.points == points));
    let mut marks = Vec::new();
    if any(false, Role::Measured) {
        marks.push(("measured", "measured"));
    }
    if any(true, Role::Measured) {
        marks.push(("point", "measured points"));
    }
    let used = names.into_iter().filter(|(role, _)| any(false, *role) || any(true, *role));
    marks.extend(used.map(|(role, name)| (look(role).class(), name)));
    key(&marks)
}

/// A probability in words of percent.
pub(crate) fn share(p: f64) -> String {
    if p > 0.999 { "> 99.9 %".to_owned() } else { format!("{:.1} %", 100.0 * p) }
}
