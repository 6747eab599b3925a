//! discover tests: conclusions in words, of closings made by hand.

use super::*;
use crate::close::checks::{hold, of_all, of_gain, said_of_all};
use crate::close::result::Unexplained;
use serde_json::json;

fn effect(family: &str) -> serde_json::Value {
    json!({"family": family, "parameters": [], "p_value": 1e-9, "probability": 0.99, "rivals": [], "held_out_gain": null,
        "physics": "", "source": "", "separate_by": ""})
}

fn side(attitude_deg: f64, position_m: f64, rate_deg_s: f64, log_likelihood: f64) -> serde_json::Value {
    let trajectory = json!({"attitude_rms_deg": attitude_deg, "position_rms_m": position_m, "rate_rms_deg_s": rate_deg_s});
    json!({"parameters": [], "hold_out": {"specific_force_rms": [1.0, 1.0, 1.0], "specific_moment_rms": [1.0, 1.0, 1.0],
        "trajectory": trajectory, "position_rms_m": position_m, "statistics": [], "log_likelihood": log_likelihood}})
}

/// A closing with these effects, of which held-out runs fail a check of `held_out`.
fn closing(effects: &[&str], held_out: Option<&str>) -> Closing {
    let mut c: Closing = serde_json::from_value(json!({
        "campaign": "lander", "verdict": "consistent", "residual": {"per_channel": []}, "residual_after": {"per_channel": []},
        "effects": effects.iter().map(|f| effect(f)).collect::<Vec<_>>(), "candidates": [], "bounds": [], "unexplained": [], "shifts": [],
        "before": side(9.1, 0.465, 3.0, -50.0), "after": side(6.0, 20.139, 3.0, 70.0), "false_alarm_rate": 0.005
    }))
    .expect("a closing");
    c.checks = vec![of_all(CheckedRuns::Identify, "X_m", 0.4), of_all(CheckedRuns::HoldOut, "Rz_deg", 0.4)];
    if let Some(what) = held_out {
        c.checks.push(of_all(CheckedRuns::HoldOut, what, 0.0));
        hold(&mut c.checks);
        c.unexplained.push(Unexplained { channel: "Rz_deg".to_owned(), description: String::new() });
    }
    c.verdict = Verdict::of(&c.effects, &c.unexplained);
    c.with_finding()
}

/// An attitude that falls and a position that rises by a factor of 43: the rise comes first, and nothing is left out.
#[test]
fn law_every_error_is_said_and_rises_come_first() {
    let c = closing(&["tether-length"], None);
    assert_eq!((c.verdict, c.finding.level), (Verdict::Effect, Level::Good));
    let expected = "With it in, errors of runs held out, rms: position rises from 465.0 to 20139\u{a0}mm, body rate stays at \
                    3.000\u{a0}deg/s, attitude falls from 9.100 to 6.000°, log-likelihood rises by 120.0.";
    assert!(c.finding.sentence.contains(expected), "{}", c.finding.sentence);
    let mut less_likely = c.clone();
    less_likely.after.hold_out.as_mut().expect("held out").log_likelihood = Some(-51.0);
    assert!(less_likely.concluded().sentence.contains("rms: log-likelihood falls by 1.000, position rises"));
}

/// Noise is said only where every check passes; a failing check of held-out runs is said first, whatever is named.
#[test]
fn law_noise_is_said_only_where_every_check_passes() {
    for effects in [&[][..], &["swirl"], &["swirl", "mass"]] {
        let sound = closing(effects, None);
        assert_eq!(sound.finding.level, Level::Good);
        assert!(
            sound.finding.sentence.ends_with("The residual that remains is noise, in runs identified on and in runs held out.")
        );
        let failing = closing(effects, Some("Rz_deg"));
        assert_eq!((failing.verdict, failing.finding.level), (Verdict::Unexplained, Level::Contradicted));
        assert!(failing.finding.sentence.starts_with("Runs held out contradict what was identified (Rz_deg)."));
        assert!(!failing.finding.sentence.contains("remains is noise") && !failing.finding.sentence.contains("lacks swirl"));
    }
    let untested = Closing { checks: Vec::new(), ..closing(&[], None) };
    assert!(untested.concluded().sentence.ends_with("no run held out tests it."));
}

/// Odds of e⁻¹² against the effects on held-out runs.
#[test]
fn law_effects_that_held_out_runs_contradict_are_no_success() {
    let mut c = closing(&["swirl"], None);
    c.checks.push(of_gain(-12.0));
    c.unexplained = said_of_all(&c.checks, "Rz_deg");
    c.verdict = Verdict::of(&c.effects, &c.unexplained);
    let found = c.concluded();
    assert_eq!((c.verdict, found.level), (Verdict::Unexplained, Level::Contradicted));
    // A closing without innovations is of tracks, where effects are not weighed beside something else.
    assert!(found.sentence.contains("swirl comes nearest to it, but its form does not hold"), "{}", found.sentence);
    assert!(of_gain(-9.9).ok && !of_gain(f64::NEG_INFINITY).ok && !of_gain(f64::NAN).ok);
}

/// Of what differs from run to run the run that differs most surely is said, with its interval: shares in per cent, lengths in mm.
#[test]
fn exact_words_of_what_differs() {
    let of = |run: &str, unit: &str, value: f64, std_error: f64| RunValue {
        run: run.to_owned(),
        name: "mass".to_owned(),
        unit: unit.to_owned(),
        value,
        std_error,
    };
    let mut c = closing(&["mass-scatter"], None);
    c.effects[0].by_run = vec![of("a", "-", 0.05, 0.03), of("b", "-", -0.012, 0.002), of("c", "-", 0.001, 0.001)];
    assert!(c.lacks().contains("mass-scatter. Run b differs most: mass -1.200 ± 0.3920\u{a0}% (95 %)."), "{}", c.lacks());
    c.effects[0].by_run = vec![of("a", "m", 0.005, 0.001)];
    assert!(c.lacks().contains("Run a differs most: mass +5.000 ± 1.960\u{a0}mm (95 %)."), "{}", c.lacks());
}
