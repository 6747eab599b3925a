//! The page and the verdict fly the same plants. In: flights with an undeclared tether, and what their campaign declares or leaves uncertain. Out:
//! rms of the page's tracks over held-out runs beside the errors of `close.json`.

use super::closing::{flown_for, with};
use super::common::{bundled, families};
use windfall_discover::close::{
    Closing, HeldOutTrajectory, Options, Sides, TrackSignal, close, coefficient_tracks, figures, tracks,
};
use windfall_discover::{DataSet, DiscoverError, FoundNumber, IdentifyOrder, identify};
use windfall_model::frames::EulerXyz;
use windfall_model::{CATALOGUE, Campaign, Coefficient, Constant, Data, PLANT_NUMBERS, Plant, Use};
use windfall_pid::output_error::EstimateOptions;
use windfall_pid::{Method, identify_by, process};
use windfall_replay::hold_out;

/// A drawn series of a signal.
type Drawn = fn(&TrackSignal) -> &Vec<f64>;

/// The declared effect, as it truly is.
const SHIFT: [f64; 3] = [0.0, 0.0, 0.001];
/// The undeclared one: the tether's drag is two and a half times the declared one.
const PULL: [f64; 4] = [1.5, 0.0, 0.0, 0.0];
/// How far the mass is from what is declared, kg, where its uncertainty is given; and that uncertainty.
const HEAVIER_KG: f64 = 0.006;
const MASS_STD_KG: f64 = 0.004;

/// Two runs to identify on and one held out, of seven seconds.
fn campaign(effect: bool, constant: bool) -> Campaign {
    let plant = |plant: &Plant, _| {
        let mut own = with(plant, "tether-geometry", &PULL);
        if effect {
            own = with(&own, "center-of-mass", &SHIFT);
        }
        own.vehicle.mass_kg += if constant { HEAVIER_KG } else { 0.0 };
        own
    };
    let mut campaign = flown_for(7.0, 31, plant);
    campaign.runs[2].used = Use::HoldOut;
    if effect {
        let declared = CATALOGUE.iter().find(|e| e.family == "center-of-mass").expect("in the catalogue");
        campaign.knowledge.effects.push((*declared, SHIFT.to_vec()));
    }
    if constant {
        let mass = PLANT_NUMBERS.iter().find(|n| n.key == "vehicle.mass_kg").expect("in the table");
        let (key, component, unit, lens) = (mass.key, mass.component, mass.unit, mass.lens);
        campaign.knowledge.constants.push(Constant { key, component, unit, lens, std: MASS_STD_KG });
    }
    campaign
}

/// Rms of position (m) and attitude (deg) of a side of the page's tracks of held-out runs, and the most that their six digits may change either: each
/// value by half of its sixth digit, 5e-6 of itself, on both sides of a difference; a norm changes by at most the norm of the change.
fn of_page(campaign: &Campaign, closing: &Closing, side: fn(&TrackSignal) -> &Vec<f64>) -> [[f64; 2]; 2] {
    let page = tracks(campaign, closing).expect("flies");
    let (mut squares, mut largest, mut count) = ([0.0; 2], [0.0_f64; 2], 0.0);
    for run in page.runs.iter().filter(|r| r.used == "hold-out") {
        let of = |name: &str| run.channels.iter().find(|c| c.name == name).expect("a channel of the pose");
        let (position, angles) = (["X", "Y", "Z"].map(of), ["Rx", "Ry", "Rz"].map(of));
        for i in 0..side(position[0]).len() {
            let attitude = |of: &dyn Fn(&TrackSignal) -> f64| {
                let [rx_rad, ry_rad, rz_rad] = angles.map(|c| of(c).to_radians());
                EulerXyz { rx_rad, ry_rad, rz_rad }.r_tunnel_body().matrix
            };
            let (a, b) = (attitude(&|c| c.measured[i]), attitude(&|c| side(c)[i]));
            // A rotation by an angle φ differs from none by √8 sin φ/2.
            let angle_deg = (2.0 * ((a - b).norm() / 8.0_f64.sqrt()).asin()).to_degrees();
            squares[0] += position.map(|c| (c.measured[i] - side(c)[i]).powi(2)).iter().sum::<f64>();
            squares[1] += angle_deg * angle_deg;
            for (most, all) in largest.iter_mut().zip([position, angles]) {
                *most = all.iter().fold(*most, |m, c| m.max(c.measured[i].abs()).max(side(c)[i].abs()));
            }
            count += 1.0;
        }
    }
    // Three channels, two sides.
    [squares.map(|s: f64| (s / count).sqrt()), largest.map(|x| 6.0 * 5e-6 * x)]
}

/// With a declared effect, with an uncertain constant that is off by more than its uncertainty, with both: the curves of the page are as far from the
/// record, before and after, as `close.json` says, and the effect that was found makes them better.
#[test]
fn law_the_page_flies_the_plants_of_the_verdict() {
    for (effect, constant) in [(true, false), (false, true), (true, true)] {
        let campaign = campaign(effect, constant);
        let closing = close(&campaign, &Options::default()).expect("closes");
        assert!(families(&closing).contains(&"tether-geometry"), "{effect} {constant}: {:?}", families(&closing));
        let said = |side: &windfall_discover::close::After| -> HeldOutTrajectory {
            side.hold_out.as_ref().and_then(|h| h.trajectory).expect("a run is held out")
        };
        let sides: [(_, Drawn); 2] = [(said(&closing.before), |c| &c.before), (said(&closing.after), |c| &c.after)];
        let mut positions = Vec::new();
        for (said, side) in sides {
            let [[position_m, angle_deg], [most_m, most_deg]] = of_page(&campaign, &closing, side);
            let expected = [said.position_rms_m, said.attitude_rms_deg.expect("a body with attitude")];
            assert!((position_m - expected[0]).abs() < most_m, "{effect} {constant}: {position_m} m on the page, {expected:?}");
            assert!((angle_deg - expected[1]).abs() < most_deg, "{effect} {constant}: {angle_deg} deg on the page, {expected:?}");
            positions.push(position_m);
        }
        assert!(positions[1] < 0.2 * positions[0], "{positions:?}");
    }
}

/// A closing that was read from a file has no plants: its figures are refused in words, not drawn of others.
#[test]
fn law_a_closing_from_a_file_draws_nothing() {
    let mut campaign = campaign(false, false);
    campaign.runs.truncate(1);
    let plant = campaign.plant.clone();
    let mut closing = Closing { sides: Some(Sides { before: plant, after: None }), ..empty() };
    assert!(figures(&campaign, &closing, &Options::default()).is_ok());
    closing = serde_json::from_str(&serde_json::to_string(&closing).expect("JSON")).expect("as written");
    for refused in [figures(&campaign, &closing, &Options::default()).err(), tracks(&campaign, &closing).err()] {
        assert!(matches!(refused, Some(DiscoverError::NoSides { .. })), "{refused:?}");
    }
}

/// A closing that says nothing.
fn empty() -> Closing {
    let side = serde_json::json!({ "parameters": [], "hold_out": null });
    let none = serde_json::json!({ "per_channel": [] });
    serde_json::from_value(serde_json::json!({
        "campaign": "empty", "verdict": "consistent", "residual": none, "residual_after": none, "effects": [], "candidates": [],
        "bounds": [], "unexplained": [], "shifts": [], "before": side, "after": side, "false_alarm_rate": 0.005
    }))
    .expect("a closing")
}

/// The page's coefficients are those of the method: what the record needs when it is smoothed as the method smooths, and the model by each
/// coefficient's own estimates, of which the thesis has two of the static moment. The ends that the smoother spoils do not set the scale.
#[test]
fn law_coefficients_over_time_are_the_methods() {
    let mut campaign = flown_for(7.0, 31, |plant, _| plant.clone());
    campaign.runs.truncate(2);
    let of = |method: Method| {
        let options = EstimateOptions { combined_only: true, ..EstimateOptions::default() };
        let found = identify_by(&campaign, method, &options).expect("identifies");
        (coefficient_tracks(&campaign, &found).expect("of this campaign"), found)
    };
    for method in [Method::Thesis, Method::EquationError] {
        let (page, found) = of(method);
        let set = found.of_all_runs().expect("all runs together");
        for (run, tracks) in campaign.runs.iter().zip(&page.runs) {
            let Data::Tunnel(record) = &run.data else { unreachable!("tunnel runs") };
            let own = process(&run.name, &run.kind, record, &campaign.plant, &method.smoother()).expect("smooths");
            for coefficient in [Coefficient::Cm, Coefficient::Cn] {
                let channel = tracks.channels.iter().find(|c| c.name == coefficient.name()).expect("one of six");
                let estimate = |name: &str| set.get(coefficient.name(), name).expect("estimated").estimate;
                let mut aero = campaign.plant.aero.clone();
                for (name, value) in aero.structure.parameters.iter().zip(&mut aero.values) {
                    if set.get(coefficient.name(), name).is_some() {
                        *value = estimate(name);
                    }
                }
                for (i, row) in own.rows.iter().enumerate() {
                    // Six digits are kept.
                    let near = |a: f64, b: f64| (a - b).abs() <= 5.1e-6 * b.abs();
                    assert!(near(channel.measured[i], row.exp_origin[coefficient as usize]), "{method:?} {i}");
                    assert!(near(channel.after[i], aero.coefficients(&row.flow)[coefficient as usize]), "{method:?} {i}");
                }
            }
            let [from_s, to_s] = tracks.interior_s.expect("long enough");
            let most = |inside: bool| {
                let axial = &tracks.channels[0].measured;
                let here = tracks.t_s.iter().zip(axial).filter(|(t, _)| (from_s..=to_s).contains(*t) == inside);
                here.map(|(_, v)| (v - 6.662).abs()).fold(0.0, f64::max)
            };
            assert!(from_s > 0.2 && to_s < 6.8 && to_s - from_s > 3.0, "{from_s} {to_s}");
            assert!(most(true) < most(false), "{method:?}: {} inside, {} at the ends", most(true), most(false));
        }
    }
}

/// The likelihood estimates a declared effect, begun at half its size, and an uncertain mass with the parameters; what it found is in the data set and
/// is what flies. Without it the same parameters are far from the run held out.
#[test]
fn recover_a_declared_effect_that_flies_as_identified() {
    let mut campaign = campaign(true, true);
    // The tether as it truly is: nothing is undeclared.
    campaign.plant = with(&campaign.plant, "tether-geometry", &PULL);
    campaign.knowledge.effects[0].1 = SHIFT.map(|x| 0.5 * x).to_vec();
    let found =
        identify(&campaign, &[], &IdentifyOrder { combined_only: true, ..IdentifyOrder::default() }).expect("identifies").found;
    assert_eq!(found.method, "likelihood");
    let set = found.of_all_runs().expect("all runs together");
    let near = |n: &FoundNumber, truth: f64| {
        let std = n.std_error.expect("estimated");
        assert!((n.estimate - truth).abs() < 4.0 * std, "{n:?} for {truth}");
    };
    let shift = &set.effects.iter().find(|e| e.family == "center-of-mass").expect("declared").parameters;
    shift.iter().zip(SHIFT).for_each(|(n, truth)| near(n, truth));
    let mass = set.constants.iter().find(|c| c.name == "vehicle.mass_kg").expect("uncertain");
    near(mass, bundled("sage-combined").plant.vehicle.mass_kg + HEAVIER_KG);
    let error = |set: &DataSet, campaign: &Campaign| {
        let plant = set.plant_in(campaign).expect("of this campaign");
        hold_out(campaign, &plant, &[2], 1).expect("flies").trajectory.attitude_rms_deg
    };
    let mut bare = campaign.clone();
    bare.knowledge.effects.clear();
    let parameters_alone = DataSet { constants: Vec::new(), effects: Vec::new(), ..set.clone() };
    let (as_found, without) = (error(set, &campaign), error(&parameters_alone, &bare));
    assert!(as_found < 0.5 * without, "{as_found} deg as identified, {without} by the parameters alone");
}
