use super::*;
use crate::envelope::tests::{even, steady};
use windfall_model::Knowledge;

/// A run that rises faster lies on its side.
const MOST_M_S: f64 = 5.0;

fn campaign(runs: &[(&str, &str, Use, f64)]) -> Campaign {
    let run = |&(name, kind, used, rise_m_s): &(&str, &str, Use, f64)| {
        let mut record = steady(rise_m_s, 0.1, 2);
        if rise_m_s > MOST_M_S {
            // The nose is beyond horizontal.
            record.attitude_rad[1].fill(1.6);
        }
        let (name, kind, data) = (name.to_owned(), kind.to_owned(), Data::Tunnel(record));
        Run { name, kind, used, inputs: Vec::new(), data, notes: Vec::new() }
    };
    Campaign::of_flights("made", &even(), &[], &Knowledge::default(), runs.iter().map(run).collect())
}

/// Two kinds in order of appearance, then all; a held-out run has a row and is in no set; one on its side has no row.
#[test]
fn exact_rows_and_sets() {
    let runs = [
        ("a", "perturbed", Use::Identify, 0.5),
        ("b", "unperturbed", Use::Identify, 0.25),
        ("c", "perturbed", Use::Identify, 1.0),
        ("d", "perturbed", Use::HoldOut, 2.0),
        ("e", "perturbed", Use::HoldOut, 7.0),
    ];
    let table = test_table(&campaign(&runs));
    assert_eq!(table.runs.iter().map(|r| r.name.as_str()).collect::<Vec<_>>(), ["a", "b", "c", "d"]);
    let sets: Vec<(&str, String)> = table.data_sets.iter().map(|s| (s.name.as_str(), s.runs.join(""))).collect();
    assert_eq!(sets, [("perturbed", "ac".to_owned()), ("unperturbed", "b".to_owned()), ("combined", "abc".to_owned())]);
    let all = &table.data_sets[2].envelope;
    assert!((all.duration_s - 6.0).abs() < 1e-9, "{all:?}");
    assert!((all.speed_m_s[0] - 6.0).abs() < 1e-6 && (all.speed_m_s[1] - 6.75).abs() < 1e-6, "{all:?}");
    assert_eq!(test_table(&campaign(&[])), TestTable::default());
}

/// An identification has the row of every run; one on its side is an error where it was identified on, and no row where it was not.
#[test]
fn law_an_identification_has_its_envelopes() {
    let set = |runs: &[&str]| crate::DataSet {
        name: "combined".to_owned(),
        runs: runs.iter().map(|r| (*r).to_owned()).collect(),
        parameters: Vec::new(),
        fits: Vec::new(),
        condition_number: 1.0,
        n_samples: 1,
        envelope: None,
        covariance: Vec::new(),
        curves: Vec::new(),
        held: Vec::new(),
        constants: Vec::new(),
        effects: Vec::new(),
        refused: Vec::new(),
    };
    let mut found = Identification {
        method: "made".to_owned(),
        reason: None,
        smoothing: None,
        identifiability: None,
        compatibility: None,
        data_sets: vec![set(&["a"])],
        envelopes: Vec::new(),
        warnings: Vec::new(),
    };
    let c = campaign(&[("a", "k", Use::Identify, 0.5), ("h", "k", Use::HoldOut, 1.0), ("e", "k", Use::HoldOut, 7.0)]);
    add_envelopes(&c, &mut found).expect("the held-out run is not needed");
    assert_eq!(found.envelopes.iter().map(|r| r.name.as_str()).collect::<Vec<_>>(), ["a", "h"]);
    assert_eq!(found.data_sets[0].envelope.as_ref(), Some(&found.envelopes[0].envelope));
    found.data_sets[0] = set(&["a", "e"]);
    assert!(add_envelopes(&c, &mut found).is_err());
}
