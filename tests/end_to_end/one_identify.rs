//! tests: the program's identification is that of the rooms beneath, which Python calls. In: a campaign with a gap. Out: equal bytes.

use crate::program::{done, folder, text};
use std::fs;
use windfall_discover::{IdentifyOrder, identify};
use windfall_pid::{Held, Method};
use windfall_scenarios::{json_text, read_campaign_with_warnings};

/// Issue 13: held values, compatibility, pressure, curves and the reader's notes are in the one result that both print.
#[test]
fn law_program_and_rooms_give_the_same_bytes() {
    let dir = folder();
    let flights = dir.path().join("flights");
    done(&["simulate", "sage-perturbed", "--out", &text(&flights)]);
    let path = flights.join("campaign.toml");
    // A dropout of two samples, which the reader bridges and counts.
    let run = fs::read_dir(&flights).expect("written").flatten().map(|e| e.path());
    let run = run.into_iter().find(|p| p.extension().is_some_and(|e| e == "csv") && !text(p).contains("truth")).expect("a run");
    let lines = fs::read_to_string(&run).expect("written");
    let kept: Vec<&str> = lines.lines().enumerate().filter(|(i, _)| !(500..502).contains(i)).map(|(_, l)| l).collect();
    fs::write(&run, kept.join("\n") + "\n").expect("written");

    let (campaign, notes) = read_campaign_with_warnings(&path).expect("read");
    assert!(!notes.is_empty(), "a gap is said");
    let hold = vec![Held { name: "Cl_0".to_owned(), value: 0.0125 }];
    let equation = IdentifyOrder { method: Some(Method::EquationError), hold: hold.clone(), ..IdentifyOrder::default() };
    let chosen = IdentifyOrder { combined_only: true, ..IdentifyOrder::default() };
    for (request, words) in
        [(equation, &["--method", "equation-error", "--hold", "Cl_0=0.0125"][..]), (chosen, &["--combined"][..])]
    {
        let found = identify(&campaign, &notes, &request).expect("identified");
        assert_eq!(found.found.warnings[..notes.len()], notes);
        assert!(found.found.compatibility.is_some() && found.found.identifiability.is_some());
        assert!(found.found.data_sets.iter().all(|d| !d.curves.is_empty() && d.held == request.hold));
        let ran = done(&[&["identify", &text(&path), "--json"], words].concat());
        assert_eq!(json_text(&found).expect("JSON"), ran.out, "{words:?}");
        assert_eq!(ran.err.matches(&notes[0]).count(), 1, "said once: {}", ran.err);
    }
}
