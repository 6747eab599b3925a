//! pid tests: output error on campaigns of an independent simulator, and what it does with settings and hopeless data.

mod common;

use common::{COMBINED, campaign, truth};
use windfall_model::{Campaign, Data};
use windfall_pid::compatibility::Agreement;
use windfall_pid::output_error::{EstimateOptions, Handling, Prior, identify};
use windfall_pid::{DataSet, Method, PidError, SearchKind, StopReason};

fn combined(c: &Campaign, options: &EstimateOptions) -> DataSet {
    identify(c, options).expect("identifies").data_set("combined").expect("there is one").clone()
}

/// Data without noise: what is left is the integrator (4e-8 of a turn in the pitch mode's phase) and 15 printed digits.
#[test]
fn recover_exact_flight() {
    let Some(c) = campaign("recover_exact_flight", "exact") else { return };
    for p in combined(&c, &COMBINED).parameters {
        let error = (p.estimate / truth(&p.name) - 1.0).abs();
        assert!(error < 2e-6, "{} {}: {error}", p.coefficient, p.name);
    }
}

/// Sensor noise alone: every interval of 3 standard errors holds the truth (eleven parameters: 97 % of such campaigns), every channel
/// is noise of the size that was put in.
#[test]
fn recover_open_00_with_white_residuals() {
    let Some(c) = campaign("recover_open_00_with_white_residuals", "open-00") else { return };
    let found = windfall_pid::identify(&c, Method::OutputError).expect("identifies");
    assert!(found.warnings.is_empty(), "{:?}", found.warnings);
    let names: Vec<&str> = found.data_sets.iter().map(|d| d.name.as_str()).collect();
    assert_eq!(names, ["perturbed", "unperturbed", "combined"]);
    let set = found.data_set("combined").expect("there is one");
    assert_eq!(set.parameters.len(), 13, "eleven, two of them under both moments");
    for p in &set.parameters {
        let z = (p.estimate - truth(&p.name)) / p.std_error;
        assert!(z.abs() < 3.0, "{} {}: {z} standard errors", p.coefficient, p.name);
    }
    for (f, std) in set.fits.iter().zip(common::NOISE) {
        // 1e4 samples: 0.7 % a standard deviation. An angle's residual is in degrees, as its name says.
        let std = if f.coefficient.ends_with("_deg") { std.to_degrees() } else { std };
        assert!((f.residual_std / std - 1.0).abs() < 0.03, "{f:?}");
    }
}

/// A held parameter stays, tied ones are one, a prior much narrower than the data decides.
#[test]
fn law_held_tied_and_prior() {
    let Some(c) = campaign("law_held_tied_and_prior", "open-00") else { return };
    let tie = |name: &str, to: &str| (name.to_owned(), Handling::Tied { to: to.to_owned() });
    let options = EstimateOptions {
        handling: vec![("Cl_0".to_owned(), Handling::Held), tie("Cn_1", "Cm_1"), tie("Cn_2", "Cm_2")],
        priors: vec![Prior { name: "CN_sin".to_owned(), mean: 3.513, std: 1e-6 }],
        ..COMBINED
    };
    let set = combined(&c, &options);
    let of = |coefficient: &str, name: &str| set.get(coefficient, name).cloned();
    assert_eq!(of("Cl", "Cl_0"), None);
    for (m, n) in [("Cm_1", "Cn_1"), ("Cm_2", "Cn_2")] {
        let (m, n) = (of("Cm", m).expect("free"), of("Cn", n).expect("tied"));
        assert_eq!((m.estimate, m.std_error), (n.estimate, n.std_error));
    }
    let free = combined(&c, &COMBINED);
    // The bound itself: a held parameter that is off leaves a coloured residual, which widens the intervals.
    let narrower = of("Cm", "Cm_1").expect("free").std_error_white / free.get("Cm", "Cm_1").expect("free").std_error_white;
    assert!(narrower < 0.95, "two axes tell more than one: {narrower}");
    let drawn = of("CN", "CN_sin").expect("free");
    assert!((drawn.estimate - 3.513).abs() < 1e-5 && drawn.std_error < 1.001e-6, "{drawn:?}");
}

#[test]
fn law_settings_that_name_nothing_are_refused() {
    let Some(c) = campaign("law_settings_that_name_nothing_are_refused", "exact") else { return };
    let unknown = |options: EstimateOptions| matches!(identify(&c, &options), Err(PidError::Unknown { .. }));
    assert!(unknown(EstimateOptions { handling: vec![("CX".to_owned(), Handling::Held)], ..COMBINED }));
    let held = |name: &str| (name.to_owned(), Handling::Held);
    let tied = ("Cn_1".to_owned(), Handling::Tied { to: "Cm_1".to_owned() });
    assert!(unknown(EstimateOptions { handling: vec![held("Cm_1"), tied], ..COMBINED }));
    let prior = |std| vec![Prior { name: "CA_T0".to_owned(), mean: 6.0, std }];
    assert!(unknown(EstimateOptions { priors: prior(0.0), ..COMBINED }));
    assert!(unknown(EstimateOptions { priors: prior(1.0), handling: vec![held("CA_T0")], ..COMBINED }));
}

/// A vehicle that does not move as any lander would: the search ends with its reason.
#[test]
fn law_hopeless_record_ends_with_a_reason() {
    let Some(mut c) = campaign("law_hopeless_record_ends_with_a_reason", "exact") else { return };
    c.runs.truncate(1);
    let Data::Tunnel(record) = &mut c.runs[0].data else { panic!("a tunnel run") };
    let n = record.len();
    // Pose and tunnel speed that have nothing to do with each other.
    record.attitude_rad.iter_mut().for_each(|a| a.reverse());
    record.vw_m_s = (0..n).map(|i| 3.0 + (0.01 * i as f64).sin()).collect();
    let found = identify(&c, &COMBINED);
    eprintln!("{found:?}");
    assert!(
        matches!(&found, Err(PidError::NoAnswer { search: SearchKind::OutputError, stop, .. }) if *stop != StopReason::Converged),
        "{found:?}"
    );
}

/// Instruments without error: nothing is found at a chance of 1 %, q_W is recognised as computed, every error lies within 3.5 standard
/// errors of zero (nine of them: one such campaign in 200 fails).
#[test]
fn recover_open_00_instruments_agree() {
    let Some(c) = campaign("recover_open_00_instruments_agree", "open-00") else { return };
    let found = identify(&c, &EstimateOptions { compatibility: true, ..COMBINED }).expect("identifies");
    let told = found.compatibility.expect("asked for");
    assert_eq!(told.verdict, Agreement::Consistent, "{told:?}");
    assert!(told.pressure.is_some_and(|p| p.computed_from_speed));
    let instruments = told.instruments.expect("output error ends");
    assert!(
        instruments.errors.len() == 9 && instruments.errors.iter().all(|e| e.estimate.abs() < 3.5 * e.std_error),
        "{instruments:?}"
    );
}
