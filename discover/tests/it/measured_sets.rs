//! discover tests: measured sets of others that are bundled in `benchmarks/measured`. In: their campaigns. Out: what closing says of them.

use super::common::{closed, families, measured};
use windfall_discover::close::{Closing, HeldOut, Verdict};
use windfall_model::{Data, Use};

/// Error on runs held out, before and after, in the unit that `of` gives.
fn held(c: &Closing, of: impl Fn(&HeldOut) -> Option<f64>) -> [f64; 2] {
    [&c.before, &c.after].map(|side| side.hold_out.as_ref().and_then(&of).expect("runs held out"))
}

/// A falling telephone, declared in a vacuum: drag quadratic in speed, as its source found, and nothing beside it. C_D S/2m per run scatters
/// by a fifth about 0.05 /m (attitude), where that of the assumed size and a coefficient of one is 0.044.
#[test]
#[ignore = "slow: nightly"]
fn recover_drag_of_a_falling_telephone() {
    let c = measured("phone-drops/campaign.toml");
    let closing = closed(&c);
    assert_eq!(families(&closing), ["drag"]);
    let cd = &closing.effects[0].parameters[0];
    assert!((0.8..1.8).contains(&cd.estimate) && cd.std_error.is_some_and(|s| s > 0.02 * cd.estimate), "{cd:?}");
    let [before, after] = held(&closing, |h| h.specific_force_rms.map(|f| f[0]));
    // Attitude that differs from run to run, by a fifth of the drag, is not predicted.
    assert!(after < 0.25 * before, "{before} {after} m/s²");
}

/// A pendulum, declared with viscous friction: what it lacks does not follow the rate but hardly depends on it.
#[test]
fn recover_dry_friction_of_a_pendulum() {
    let c = measured("pendulum/campaign.toml");
    let closing = closed(&c);
    assert!(families(&closing).contains(&"pivot-friction"), "{:?}", families(&closing));
    let [before, after] = held(&closing, |h| h.trajectory.and_then(|t| t.attitude_rms_deg));
    assert!(after < 0.5 * before, "{before} {after} deg");
    // Friction in all is not negative, and taking all of it away is said.
    let declared = c.plant.point.pivot.expect("an arm").viscous_n_m_s;
    for viscous in closing.effects.iter().filter(|e| e.family == "viscous-friction").map(|e| &e.parameters[0]) {
        let in_all = declared + viscous.estimate;
        assert!(in_all > -1e-12 * declared && viscous.at_end == (in_all < 1e-9 * declared), "{viscous:?}");
    }
}

/// Coasts of five rockets by their own tables of drag, believed to a tenth: nothing that all lack is named, and the tables are right on
/// average, while single rockets are off by more than an altimeter's errors.
#[test]
fn recover_nothing_from_coasts_of_five_rockets() {
    let closing = closed(&measured("rocket-coasts/campaign.toml"));
    assert_eq!((families(&closing), closing.verdict), (Vec::new(), Verdict::Unexplained));
    let scale = closing.constants.iter().find(|c| c.key.ends_with("CD_scale")).expect("uncertain");
    let std = scale.std_error.expect("seen");
    assert!((scale.estimate - 1.0).abs() < 3.0 * std && std > 0.02, "{scale:?}");
}

/// The same tables believed not at all: a first step of the common factor goes to where a rocket cannot be flown, and back.
#[test]
fn recover_a_factor_common_to_five_rockets_without_a_prior() {
    let mut c = measured("rocket-coasts/campaign.toml");
    c.knowledge.constants.clear();
    c.declared = vec![true];
    let closing = closed(&c);
    assert!(closing.effects.is_empty(), "{:?}", families(&closing));
    let scale = &closing.after.parameters[0];
    let std = scale.std_error.expect("seen");
    // Alone they ask for 0.69 to 1.24.
    assert!((0.69..1.24).contains(&scale.estimate) && (0.02..0.3).contains(&std), "{scale:?}");
}

/// One flight of a rocket alone: the factor on its table is fitted, and nothing beside it is named.
#[test]
fn recover_nothing_from_one_rocket_alone() {
    for rocket in ["andromeda", "erebus-11", "juno-3"] {
        let closing = closed(&measured(&format!("rocket-coasts/{rocket}.toml")));
        assert_eq!(closing.verdict, Verdict::Consistent, "{rocket}");
        assert!(closing.after.parameters[0].std_error.is_some_and(|s| s > 0.01), "{rocket}");
    }
}

/// Of one coast, a factor on the table that the runs moved is printed beside what the file has, and numbers that do as well in its place: mass and
/// density stand beside it in the equation of motion. A path aslant, which only adds drag, does not do for a factor below one.
#[test]
fn recover_what_would_do_in_place_of_a_factor() {
    let closing = closed(&measured("rocket-coasts/andromeda.toml"));
    let scale = &closing.after.parameters[0];
    assert_eq!((scale.declared, scale.declared_std), (Some(1.0), None));
    assert!(scale.moved().is_some_and(|m| m < -5.0), "{scale:?}");
    let [found] = closing.instead.as_slice() else { panic!("one parameter moved: {:?}", closing.instead) };
    let keys: Vec<&str> = found.instead.iter().map(|i| i.key.as_str()).collect();
    assert!(["vehicle.mass_kg", "environment.air_density_kg_m3"].iter().all(|k| keys.contains(k)), "{keys:?}");
    assert!(!keys.contains(&"path"), "{keys:?}");
    // Drag over mass is what is seen: the same to the fit's own tolerance, a hundredth of its error.
    let mass = found.instead.iter().find(|i| i.key == "vehicle.mass_kg").expect("is there");
    let error = scale.std_error.expect("seen") / scale.estimate;
    assert!((mass.declared / mass.estimate / scale.estimate - 1.0).abs() < 0.5 * error, "{mass:?}");
}

/// A table that is too high, held as it stands: drag takes a part of it away, and no more than there is.
#[test]
fn recover_drag_below_a_table_that_is_held() {
    let mut c = measured("rocket-coasts/andromeda.toml");
    c.declared = vec![false];
    let closing = closed(&c);
    let drag = closing.effects.iter().find(|e| e.family == "drag");
    let rival = closing.effects.iter().any(|e| e.rivals.iter().any(|r| r == "drag"));
    assert!(rival || drag.is_some_and(|d| d.parameters[0].estimate < 0.0), "{:?}", families(&closing));
}

/// A coast with air brakes: what follows the brakes is named; the flight whose brakes stuck against their command is not predicted by it.
#[test]
fn recover_what_follows_the_air_brakes() {
    let c = measured("rocket-coasts/jackpot.toml");
    let closing = closed(&c);
    // By hand, speeds integrated from the accelerometer back from apogee: C_D 0.47 to 0.49 with the brakes in, 1.55 out; 0.393 is declared.
    let drag = closing.effects.iter().find(|e| e.family == "drag").expect("named");
    let [own, out] = [0, 1].map(|k| drag.parameters[k].estimate);
    assert!((-0.1..0.3).contains(&own) && (0.6..1.2).contains(&out), "{own} {out}");
}

/// A published uncertainty of the drag is a prior, and a rocket within it is consistent.
#[test]
fn recover_nothing_from_a_rocket_within_its_uncertainty() {
    let closing = closed(&measured("rocket-coasts/bella-lui.toml"));
    assert_eq!(closing.verdict, Verdict::Consistent);
    let scale = closing.constants.iter().find(|c| c.key.ends_with("CD_scale")).expect("uncertain");
    assert!(scale.std_error.is_some_and(|s| s <= 0.05) && (scale.estimate - 1.0).abs() < 0.1, "{scale:?}");
}

/// The same windows twice are not more evidence: a decay in windows has no scatter between recordings to speak by.
#[test]
fn law_windows_of_one_recording_are_one_witness() {
    let c = measured("pendulum/campaign.toml");
    let recordings: Vec<_> = c
        .runs
        .iter()
        .filter(|r| r.used == Use::Identify)
        .map(|r| match &r.data {
            Data::Point(p) => p.recording.clone(),
            Data::Tunnel(_) => None,
        })
        .collect();
    assert!(recordings.len() >= 5 && recordings.iter().all(|r| r.as_deref() == Some("A")));
    let runs: Vec<usize> = (0..c.runs.len()).filter(|&i| c.runs[i].used == Use::Identify).collect();
    use windfall_discover::tracks::TrackEvidence;
    assert_eq!(TrackEvidence::new(&c, &runs, &c.plant).expect("swings").witnesses(), None);
}
