//! verify: tables of the closing study. In: what came of every draw. Out: Markdown.

use super::{OUT_OF_RANGE, Planted, Size};
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// Rates, confusions, coverage of intervals and bounds.
pub(crate) fn report(all: &[Planted]) -> String {
    let mut text = String::new();
    let (none, all): (Vec<Planted>, Vec<Planted>) = all.iter().cloned().partition(|p| p.verdict == OUT_OF_RANGE);
    let all = all.as_slice();
    let mut absent: BTreeMap<String, usize> = BTreeMap::new();
    none.iter().for_each(|p| *absent.entry(format!("{} ({:?})", p.draw.families.join(" + "), p.draw.size)).or_default() += 1);
    if !absent.is_empty() {
        let list: Vec<String> = absent.iter().map(|(f, n)| format!("{f} {n}")).collect();
        let _ = writeln!(
            text,
            "Not drawn, since the family cannot be seen so well within its range or the lander could not fly: {}.\n",
            list.join(", ")
        );
    }
    let nulls: Vec<&Planted> = all.iter().filter(|p| p.draw.families.is_empty()).collect();
    let false_alarms = nulls.iter().filter(|p| !p.right()).count();
    let lead = nulls.iter().filter(|p| p.verdict == "unexplained").count();
    let _ = writeln!(text, "Nothing planted: {false_alarms} false alarms in {}, {lead} more called unexplained.\n", nulls.len());
    for size in [Size::Large, Size::Small] {
        rates(&mut text, all, size);
    }
    pairs(&mut text, all);
    intervals(&mut text, all);
    bounds(&mut text, all);
    text
}

fn rates(text: &mut String, all: &[Planted], size: Size) {
    let of: Vec<&Planted> = all.iter().filter(|p| p.draw.families.len() == 1 && p.draw.size == size).collect();
    if of.is_empty() {
        return;
    }
    let right = of.iter().filter(|p| p.right()).count();
    let _ = writeln!(text, "{size:?} effects: right or rival {right} of {} ({:.1} %).\n", of.len(), percent(right, of.len()));
    let _ = writeln!(
        text,
        "| planted | draws | first | rival | nothing | named instead | second effects |\n|---|---|---|---|---|---|---|"
    );
    let mut by: BTreeMap<&str, Vec<&Planted>> = BTreeMap::new();
    of.iter().for_each(|p| by.entry(p.draw.families[0].as_str()).or_default().push(p));
    for (family, draws) in by {
        let first = draws.iter().filter(|p| p.named.first().is_some_and(|n| n.0 == family)).count();
        let right = draws.iter().filter(|p| p.right()).count();
        let none = draws.iter().filter(|p| p.named.is_empty()).count();
        let mut instead: BTreeMap<&str, usize> = BTreeMap::new();
        for p in draws.iter().filter(|p| !p.right()) {
            p.named.first().into_iter().for_each(|n| *instead.entry(&n.0).or_default() += 1);
        }
        let more = draws.iter().filter(|p| p.named.len() > 1).count();
        let instead: Vec<String> = instead.iter().map(|(f, n)| format!("{f} {n}")).collect();
        let _ = writeln!(
            text,
            "| {family} | {} | {first} | {} | {none} | {} | {more} |",
            draws.len(),
            right - first,
            instead.join(", ")
        );
    }
    text.push('\n');
}

fn pairs(text: &mut String, all: &[Planted]) {
    let of: Vec<&Planted> = all.iter().filter(|p| p.draw.families.len() == 2).collect();
    if of.is_empty() {
        return;
    }
    let both = of.iter().filter(|p| p.right()).count();
    let _ = writeln!(text, "Pairs: both found in {both} of {} ({:.1} %).\n", of.len(), percent(both, of.len()));
    let _ = writeln!(text, "| planted | both | draws |\n|---|---|---|");
    let mut by: BTreeMap<String, (usize, usize)> = BTreeMap::new();
    for p in &of {
        let e = by.entry(p.draw.families.join(" + ")).or_default();
        e.0 += usize::from(p.right());
        e.1 += 1;
    }
    for (pair, (n, of)) in by {
        let _ = writeln!(text, "| {pair} | {n} | {of} |");
    }
    text.push('\n');
}

/// z of every strength of a family that was named first, and of the declared parameters beside it.
fn intervals(text: &mut String, all: &[Planted]) {
    let inside = |z: &[f64]| z.iter().filter(|z| z.abs() < 1.96).count();
    let rms = |z: &[f64]| (z.iter().map(|z| z * z).sum::<f64>() / z.len().max(1) as f64).sqrt();
    let mut by: BTreeMap<(String, String), Vec<f64>> = BTreeMap::new();
    let single = || all.iter().filter(|p| p.draw.families.len() == 1 && p.right() && p.draw.size == Size::Large);
    for p in single() {
        for n in p.numbers.iter().filter(|n| n.strength) {
            if let Some((x, s)) = n.found.filter(|(_, s)| s.is_finite() && *s > 0.0) {
                by.entry((n.family.clone(), n.name.clone())).or_default().push((x - n.truth) / s);
            }
        }
    }
    let every: Vec<f64> = by.values().flatten().copied().collect();
    if every.is_empty() {
        return;
    }
    let _ = writeln!(
        text,
        "Intervals of strengths, large effects: {} of {} inside 95 % ({:.1} %); rms z {:.2}.\n",
        inside(&every),
        every.len(),
        percent(inside(&every), every.len()),
        rms(&every)
    );
    let _ = writeln!(text, "| family | strength | draws | inside 95 % | rms z | mean z |\n|---|---|---|---|---|---|");
    for ((family, name), z) in &by {
        let mean = z.iter().sum::<f64>() / z.len() as f64;
        let _ = writeln!(text, "| {family} | {name} | {} | {} | {:.2} | {mean:+.2} |", z.len(), inside(z), rms(z));
    }
    for (what, z) in [
        (
            "without effects",
            all.iter().filter(|p| p.draw.families.is_empty()).flat_map(|p| p.declared_z.clone()).collect::<Vec<_>>(),
        ),
        ("beside the right effect", single().flat_map(|p| p.declared_z.clone()).collect()),
    ] {
        let _ = writeln!(
            text,
            "\nDeclared parameters {what}: {} of {} inside 95 % ({:.1} %); rms z {:.2}.",
            inside(&z),
            z.len(),
            percent(inside(&z), z.len()),
            rms(&z)
        );
    }
    text.push('\n');
}

fn bounds(text: &mut String, all: &[Planted]) {
    let unseen = |p: &&Planted| p.draw.families.len() == 1 && p.named.is_empty();
    let of: Vec<(f64, f64)> = all
        .iter()
        .filter(unseen)
        .flat_map(|p| p.numbers.iter().filter(|n| n.strength && n.truth != 0.0).filter_map(|n| Some((n.truth.abs(), n.bound?))))
        .collect();
    let under = of.iter().filter(|(t, b)| t <= b).count();
    if !of.is_empty() {
        let _ = writeln!(text, "Bounds of effects not found: {under} of {} hold ({:.1} %).", of.len(), percent(under, of.len()));
    }
}

fn percent(n: usize, of: usize) -> f64 {
    100.0 * n as f64 / of.max(1) as f64
}
