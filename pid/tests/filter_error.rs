//! pid tests: filter error on campaigns of an independent simulator.

mod common;

use common::{COMBINED, campaign, truth};
use std::sync::OnceLock;
use windfall_model::Campaign;
use windfall_pid::output_error::{EstimateOptions, Handling, Prior};
use windfall_pid::{DataSet, filter_error};

fn of_all_runs(campaign: &Campaign) -> (DataSet, Vec<String>) {
    let found = filter_error::identify(campaign, &COMBINED).expect("identifies");
    (found.data_set("combined").expect("there is one").clone(), found.warnings)
}

fn combined(test: &str, name: &str) -> Option<(DataSet, Vec<String>)> {
    Some(of_all_runs(&campaign(test, name)?))
}

/// Of open-03, found once for all tests; each names itself where there is no such data.
fn of_open_03(test: &str) -> Option<(DataSet, Vec<String>)> {
    static FOUND: OnceLock<(DataSet, Vec<String>)> = OnceLock::new();
    let c = campaign(test, "open-03")?;
    Some(FOUND.get_or_init(|| of_all_runs(&c)).clone())
}

/// Every aerodynamic parameter within 3.4 of its standard errors (eleven normal numbers: 99.3 %).
fn assert_covered(set: &DataSet) {
    for p in set.parameters.iter().filter(|p| p.coefficient != "turbulence") {
        let z = (p.estimate - truth(&p.name)) / p.std_error;
        assert!(z.abs() < 3.4, "{} {}: {z} standard errors", p.coefficient, p.name);
    }
}

/// Gusts of 0.1 m/s rms that another simulator made, of a spectrum that is not stated: parameters inside, level within 10 %.
#[test]
fn recover_open_03_with_its_turbulence() {
    let Some((set, warnings)) = of_open_03("recover_open_03_with_its_turbulence") else { return };
    assert_covered(&set);
    assert!(warnings.is_empty(), "{warnings:?}");
    for name in ["axial_rms_m_s", "lateral_rms_m_s"] {
        let found = set.get("turbulence", name).expect("estimated").estimate;
        assert!((found / 0.1 - 1.0).abs() < 0.1, "{name} {found}");
    }
}

/// No turbulence: none is found, that is said, and the parameters are output error's within a tenth of a standard error or so.
#[test]
fn recover_open_00_without_turbulence() {
    let Some((set, warnings)) = combined("recover_open_00_without_turbulence", "open-00") else { return };
    assert_covered(&set);
    assert!(warnings.len() == 1 && warnings[0].contains("no turbulence"), "{warnings:?}");
    for name in ["axial_rms_m_s", "lateral_rms_m_s"] {
        let p = set.get("turbulence", name).expect("bounded");
        assert!(p.estimate == 0.0 && p.ci95[1] < 0.01, "{p:?}");
    }
    let Some(c) = campaign("recover_open_00_without_turbulence", "open-00") else { return };
    let other = windfall_pid::output_error::identify(&c, &COMBINED).expect("identifies");
    for p in set.parameters.iter().filter(|p| p.coefficient != "turbulence") {
        let o = other.data_set("combined").and_then(|d| d.get(&p.coefficient, &p.name)).expect("the same");
        assert!((p.estimate - o.estimate).abs() < 0.3 * o.std_error, "{p:?} {o:?}");
        assert!((p.std_error / o.std_error - 1.0).abs() < 0.1, "{p:?} {o:?}");
    }
}

/// A moment that is no gust's (a c.m. off its place by 2.7 mm): the search ends with random moments in it, and says so.
#[test]
fn law_what_no_gust_explains_ends_with_random_moments() {
    let Some((set, warnings)) = combined("law_what_no_gust_explains_ends_with_random_moments", "open-04") else { return };
    let across = set.get("process-noise", "across_rad_s1_5").expect("estimated");
    assert!(across.ci95[0] > 0.0, "{across:?}");
    assert!(warnings.iter().any(|w| w.contains("random moments")), "{warnings:?}");
    assert!(warnings.iter().any(|w| w.contains("not noise")), "{warnings:?}");
}

/// In gusts too, tied parameters are one unknown that is told better than either, and a prior much narrower than the data decides.
#[test]
fn law_ties_and_priors_in_turbulence() {
    let Some((free, _)) = of_open_03("law_ties_and_priors_in_turbulence") else { return };
    let Some(c) = campaign("law_ties_and_priors_in_turbulence", "open-03") else { return };
    let (mean, std) = free.get("CN", "CN_sin").map(|p| (p.estimate + p.std_error, 0.01 * p.std_error)).expect("free");
    let options = EstimateOptions {
        handling: vec![("Cn_1".to_owned(), Handling::Tied { to: "Cm_1".to_owned() })],
        priors: vec![Prior { name: "CN_sin".to_owned(), mean, std }],
        ..COMBINED
    };
    let found = filter_error::identify(&c, &options).expect("identifies");
    let of = |set: &DataSet, c: &str, n: &str| set.get(c, n).map(|p| (p.estimate, p.std_error)).expect("estimated");
    let set = found.data_set("combined").expect("there is one");
    let (tied, one, other) = (of(set, "Cm", "Cm_1"), of(&free, "Cm", "Cm_1"), of(&free, "Cn", "Cn_1"));
    assert_eq!(tied, of(set, "Cn", "Cn_1"));
    let expected = (one.1.powi(-2) + other.1.powi(-2)).sqrt().recip();
    // Correlation with the gusts' size and with what both share.
    assert!((tied.1 / expected - 1.0).abs() < 0.15, "{tied:?} {expected}");
    let pinned = of(set, "CN", "CN_sin");
    // A hundredth of a standard error to the prior, less than a hundredth of that from it.
    assert!((pinned.0 - mean).abs() < 0.1 * std && pinned.1 < 1.001 * std, "{pinned:?} {mean} {std}");
}
