//! pid: the identified coefficients as curves with confidence bands (thesis figures 5.4 and 5.5). In: estimates with covariance, the
//! angles that the runs reached. Out: curves over total angle of attack.
//!
//! A coefficient is linear in its parameters, so the variance at an angle is `aᵀ C a` with the terms' values `a`: exact, nothing is
//! linearised. Bands are pointwise: at any one angle they hold the truth in 95 % of campaigns, over the whole curve in fewer.

use crate::PidError;
use crate::identification::{Curve, DataSet, Identification};
use crate::interval::NORMAL_95;
use crate::test_table::{add_envelopes, run_envelope};
use windfall_model::{Aero, Campaign, Coefficient, Data, FlowState, Structure, Term, VARIABLES, Variable};

/// Points of a curve.
const POINTS: usize = 61;

/// A curve's recipe.
struct Sort {
    quantity: &'static str,
    over: &'static str,
    coefficient: Coefficient,
    /// Damping by this variable instead of the value without rates.
    damping: Option<Variable>,
    /// The flow comes from the side (β) instead of from below (α).
    sideways: bool,
}

const SORTS: [Sort; 5] = [
    Sort { quantity: "C_A", over: "alpha_T", coefficient: Coefficient::CA, damping: None, sideways: false },
    Sort { quantity: "C_N,T", over: "alpha_T", coefficient: Coefficient::CN, damping: None, sideways: false },
    Sort { quantity: "C_m", over: "alpha_T", coefficient: Coefficient::Cm, damping: None, sideways: false },
    Sort {
        quantity: "C_m damping",
        over: "alpha",
        coefficient: Coefficient::Cm,
        damping: Some(Variable::PitchDamping),
        sideways: false,
    },
    Sort {
        quantity: "C_n damping",
        over: "beta",
        coefficient: Coefficient::Cn,
        damping: Some(Variable::YawDamping),
        sideways: true,
    },
];

/// Gives every data set its curves, up to the largest angle that its runs reached, and the rows of Table 5.1 ([`add_envelopes`]).
///
/// # Errors
/// A record that cannot be smoothed.
pub fn add_curves(campaign: &Campaign, found: &mut Identification) -> Result<(), PidError> {
    add_envelopes(campaign, found)?;
    for set in &mut found.data_sets {
        let largest_rad = set.envelope.as_ref().map_or(0.0, |e| e.max_alpha_t_deg.to_radians());
        set.curves = curves(&set.plant_in(campaign)?.aero, mean_speed_m_s(campaign), set, largest_rad);
    }
    Ok(())
}

/// Mean tunnel speed of all runs, for what effects add that varies with it; one where there is none.
#[must_use]
pub fn mean_speed_m_s(campaign: &Campaign) -> f64 {
    let all = campaign.runs.iter().filter_map(|r| if let Data::Tunnel(t) = &r.data { Some(&t.vw_m_s) } else { None });
    let (sum, n) = all.flatten().fold((0.0, 0.0), |(s, n), v| (s + v, n + 1.0));
    if n > 0.0 { sum / n } else { 1.0 }
}

/// Largest total angle of attack of a run, rad; zero of one without attitude.
///
/// # Errors
/// A record that cannot be smoothed.
pub fn largest_angle_rad(campaign: &Campaign, run: usize) -> Result<f64, PidError> {
    Ok(run_envelope(campaign, run)?.map_or(0.0, |e| e.max_alpha_t_deg.to_radians()))
}

/// Curves of a data set up to an angle, rad, at a tunnel speed, m/s; those on which no estimate acts are left out. Parameters without
/// estimate count as zero; what effects of the model add, `aero.extra`, counts as exact.
#[must_use]
pub fn curves(aero: &Aero, speed_m_s: f64, set: &DataSet, largest_rad: f64) -> Vec<Curve> {
    if set.covariance.len() != set.parameters.len() {
        return Vec::new();
    }
    SORTS.iter().filter_map(|sort| curve(sort, aero, speed_m_s, set, largest_rad)).collect()
}

fn curve(sort: &Sort, aero: &Aero, speed_m_s: f64, set: &DataSet, largest_rad: f64) -> Option<Curve> {
    let member = members(sort, set);
    let mut c = Curve {
        quantity: sort.quantity.to_owned(),
        over: sort.over.to_owned(),
        angle_deg: Vec::new(),
        value: Vec::new(),
        low: Vec::new(),
        high: Vec::new(),
    };
    let mut acts = false;
    for k in 0..POINTS {
        let angle = largest_rad * k as f64 / (POINTS - 1) as f64;
        let at = point(sort, &aero.structure, set, &member, angle);
        acts |= at.acts;
        let (value, half) = (at.value + added(sort, aero, speed_m_s, angle), NORMAL_95 * at.std);
        c.angle_deg.push(angle.to_degrees());
        c.value.push(value);
        c.low.push(value - half);
        c.high.push(value + half);
    }
    acts.then_some(c)
}

/// Estimates of this coefficient's own data where there are such: C_m and C_n give the static moment apart.
fn members(sort: &Sort, set: &DataSet) -> Vec<usize> {
    (0..set.parameters.len()).filter(|i| set.parameters[*i].coefficient == sort.coefficient.name()).collect()
}

/// A curve at one angle.
struct CurvePoint {
    value: f64,
    std: f64,
    acts: bool,
}

fn point(sort: &Sort, structure: &Structure, set: &DataSet, member: &[usize], angle: f64) -> CurvePoint {
    let terms = slopes(sort, structure, angle);
    let a: Vec<f64> = member.iter().map(|i| structure.index(&set.parameters[*i].name).map_or(0.0, |p| terms[p])).collect();
    let value = a.iter().zip(member).map(|(a, i)| a * set.parameters[*i].estimate).sum();
    let row = |i: usize| a.iter().zip(member).map(|(b, j)| b * set.covariance[i][*j]).sum::<f64>();
    let variance: f64 = a.iter().zip(member).map(|(a, i)| a * row(*i)).sum();
    CurvePoint { value, std: variance.max(0.0).sqrt(), acts: a.iter().any(|a| *a != 0.0) }
}

/// What effects of the model add to a curve at an angle.
fn added(sort: &Sort, aero: &Aero, speed_m_s: f64, angle: f64) -> f64 {
    let mut still = flow(angle, sort.sideways);
    still.values[Variable::Speed as usize] = speed_m_s;
    let own = aero.extra.iter().filter(|(c, ..)| *c == sort.coefficient);
    own.map(|(_, size, term)| size * value_of(sort, term, &still)).sum()
}

/// A term's share of a curve: its value without rates, or what a unit of damping's variable changes.
fn value_of(sort: &Sort, term: &Term, still: &FlowState) -> f64 {
    let Some(variable) = sort.damping else { return term.value(still) };
    let mut moving = *still;
    moving.values[variable as usize] = 1.0;
    term.value(&moving) - term.value(still)
}

/// Name of a static coefficient's curve; none of those that have none.
#[must_use]
pub fn static_name(coefficient: Coefficient) -> Option<&'static str> {
    SORTS.iter().find(|s| s.coefficient == coefficient && s.damping.is_none()).map(|s| s.quantity)
}

/// A static coefficient and its standard error at a total angle of attack, rad, and a tunnel speed, m/s, as a data set has it; none without
/// curve or covariance.
#[must_use]
pub fn static_value(aero: &Aero, speed_m_s: f64, set: &DataSet, coefficient: Coefficient, angle_rad: f64) -> Option<[f64; 2]> {
    let sort = SORTS.iter().find(|s| s.coefficient == coefficient && s.damping.is_none())?;
    let whole = set.covariance.len() == set.parameters.len();
    let at = whole.then(|| point(sort, &aero.structure, set, &members(sort, set), angle_rad))?;
    Some([at.value + added(sort, aero, speed_m_s, angle_rad), at.std])
}

/// Flow from below at a total angle of attack, rad, without rates, at a speed, m/s.
#[must_use]
pub fn still_flow(angle_rad: f64, speed_m_s: f64) -> FlowState {
    let mut still = flow(angle_rad, false);
    still.values[Variable::Speed as usize] = speed_m_s;
    still
}

/// How the curve depends on each of the structure's parameters at an angle.
fn slopes(sort: &Sort, structure: &Structure, angle: f64) -> Vec<f64> {
    let still = flow(angle, sort.sideways);
    let mut slopes = vec![0.0; structure.parameters.len()];
    for k in structure.contributions.iter().filter(|k| k.coefficient == sort.coefficient) {
        slopes[k.parameter] += value_of(sort, &k.term, &still);
    }
    slopes
}

/// Flow at an angle from below or from the side, without rates.
fn flow(angle: f64, sideways: bool) -> FlowState {
    let mut values = [0.0; VARIABLES];
    let mut set = |v: Variable, x: f64| values[v as usize] = x;
    set(Variable::SinAlphaT, angle.sin());
    set(Variable::CosAlphaT, angle.cos());
    set(if sideways { Variable::SinPhi } else { Variable::CosPhi }, 1.0);
    set(if sideways { Variable::Beta } else { Variable::Alpha }, angle);
    set(Variable::AlphaT, angle);
    set(Variable::Speed, 1.0);
    FlowState { values }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identification::Estimate;
    use windfall_model::{Knowledge, Record, Run, Use};

    /// Mean over all samples, not over runs; one where there is none.
    #[test]
    fn exact_mean_speed() {
        let run = |vw_m_s: &[f64]| Run {
            name: String::new(),
            kind: String::new(),
            used: Use::Identify,
            inputs: Vec::new(),
            data: Data::Tunnel(Record { vw_m_s: vw_m_s.to_vec(), ..Record::default() }),
            notes: Vec::new(),
        };
        let of = |runs| Campaign::of_flights("two", &crate::equations::tests::plant(), &[], &Knowledge::default(), runs);
        let speed = mean_speed_m_s(&of(vec![run(&[7.0, 7.5]), run(&[8.25, 9.0, 6.5])]));
        assert!((speed - 38.25 / 5.0).abs() < 1e-14, "{speed}");
        assert!((mean_speed_m_s(&of(Vec::new())) - 1.0).abs() < 1e-15);
    }

    /// C_m = a s + b s³ with correlated errors: value and variance by hand, and the damping's a + b α².
    #[test]
    fn exact_bands_of_the_moment() {
        let estimate = |coefficient: &str, name: &str, estimate: f64| Estimate {
            coefficient: coefficient.into(),
            name: name.into(),
            estimate,
            std_error: 1.0,
            rse_percent: Some(1.0),
            ci95: [0.0; 2],
            std_error_white: 1.0,
        };
        let set = DataSet {
            name: "combined".into(),
            runs: Vec::new(),
            parameters: vec![
                estimate("Cm", "Cm_sin", -2.0),
                estimate("Cm", "Cm_sin3", 2.5),
                estimate("Cm", "Cm_1", -3.0),
                estimate("Cm", "Cm_2", -200.0),
            ],
            fits: Vec::new(),
            condition_number: 1.0,
            n_samples: 1,
            covariance: vec![
                vec![0.04, -0.1, 0.0, 0.0],
                vec![-0.1, 0.5, 0.0, 0.0],
                vec![0.0, 0.0, 0.01, -0.2],
                vec![0.0, 0.0, -0.2, 9.0],
            ],
            curves: Vec::new(),
            held: Vec::new(),
            constants: Vec::new(),
            effects: Vec::new(),
            refused: Vec::new(),
            envelope: None,
        };
        let aero = Aero::new(Structure::axisymmetric(), vec![0.0; Structure::axisymmetric().parameters.len()]);
        let all = curves(&aero, 7.0, &set, 0.4);
        assert_eq!(all.iter().map(|c| c.quantity.as_str()).collect::<Vec<_>>(), ["C_m", "C_m damping"]);
        let (s, last) = (0.4_f64.sin(), POINTS - 1);
        let (value, std) = (-2.0 * s + 2.5 * s.powi(3), (0.04 * s * s - 0.2 * s.powi(4) + 0.5 * s.powi(6)).sqrt());
        assert!((all[0].value[last] - value).abs() < 1e-14 && (all[0].high[last] - value - 1.959_963_985 * std).abs() < 1e-14);
        let (value, std) = (-3.0 - 200.0 * 0.16, (0.01 - 0.4 * 0.16 + 9.0 * 0.16_f64.powi(2)).sqrt());
        assert!((all[1].value[last] - value).abs() < 1e-12 && (all[1].low[last] - value + 1.959_963_985 * std).abs() < 1e-12);
        assert!(all[0].low[0] == 0.0 && all[0].high[0] == 0.0, "no moment at no angle");
    }
}
