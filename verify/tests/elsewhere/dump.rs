//! Campaigns onto the disk: numbered folders and one answers.json at the root.

use crate::groups::draw;
use crate::write::{answer, campaign};
use rayon::prelude::*;
use serde_json::Value;
use std::io::Write as _;
use std::path::Path;

/// Groups and counts of a list such as `A:10,B:4`.
///
/// # Panics
/// On anything else.
pub(crate) fn wanted(list: &str) -> Vec<(String, usize)> {
    let one = |part: &str| {
        let (group, count) = part.split_once(':').expect("a group and a count, as A:10");
        (group.trim().to_owned(), count.trim().parse().expect("a whole count"))
    };
    list.split(',').filter(|p| !p.trim().is_empty()).map(one).collect()
}

/// Writes them; the answers, in order.
///
/// # Panics
/// When the disk refuses.
pub(crate) fn dump(root: &Path, list: &[(String, usize)], seed: u64) -> Vec<Value> {
    std::fs::create_dir_all(root).expect("the folder can be made");
    let all: Vec<(usize, &str, usize)> = list
        .iter()
        .flat_map(|(g, n)| (0..*n).map(move |i| (g.as_str(), i)))
        .enumerate()
        .map(|(number, (g, i))| (number, g, i))
        .collect();
    let answers: Vec<Value> = all
        .par_iter()
        .map(|(number, group, i)| {
            let (spec, runs) = draw(group, *i, seed);
            let name = format!("elsewhere-{number:02}");
            campaign(root, &name, &spec, &runs).expect("the folder can be written");
            println!("{name} {group} {i}");
            answer(&name, &spec)
        })
        .collect();
    let text = serde_json::to_string_pretty(&answers).expect("plain data");
    std::fs::write(root.join("answers.json"), text).expect("the answers can be written");
    answers
}

/// `ELSEWHERE_OUT=dir ELSEWHERE_GROUPS=A:10,B:10 ELSEWHERE_SEED=1`.
#[test]
#[ignore = "writes campaigns where ELSEWHERE_OUT says"]
fn dump_groups() {
    let Some(root) = std::env::var_os("ELSEWHERE_OUT") else {
        let _ = writeln!(std::io::stderr(), "skipped: dump_groups: ELSEWHERE_OUT names no folder");
        return;
    };
    let list = std::env::var("ELSEWHERE_GROUPS").unwrap_or_else(|_| "A:2,B:2,C:2,D:2,E:2,F:2,S:2".to_owned());
    let seed = std::env::var("ELSEWHERE_SEED").ok().and_then(|s| s.parse().ok()).unwrap_or(1);
    dump(Path::new(&root), &wanted(&list), seed);
}
