//! pid: constants that are a factor off. In: instants and the declared plant. Out: a fault with the constant and the factor.
//!
//! A wrong mass, size, density or speed leaves the equations of motion closed and moves the aerodynamics that come out of them, all
//! those of a kind by one factor. Single parameters may be half to twice the declared ones in a sound campaign; a refusal takes either
//! more than that, or one factor common to all that it must move beside nothing that it must not.

use super::balance::{Balance, Point, Ratio, balance};
use super::change::Act;
use super::motion::MotionSample;
use super::{GrossFault, median, short};
use windfall_model::{Campaign, Coefficient, Factor, Plant, Variable};

/// Logarithm beyond which aerodynamics are no longer those of the declared vehicle: a factor of 2.3.
const BEYOND: f64 = 0.83;
/// Spread of logarithms about a common factor, of leading and of other parameters, where the factor itself is not beyond; of
/// leading ones less for factors with logarithms below a half, which sound campaigns imitate more often.
const CLOSE: [f64; 2] = [0.13, 0.35];
/// The same where it is, at most: what aerodynamics of sound campaigns differ by. Less where the factor moves the parameters by less
/// than a factor of e².
const LOOSE: [f64; 2] = [0.8, 1.2];
/// Least precise parameter that counts, relative standard error.
const DETERMINED: f64 = 0.12;
/// A factor is that of a unit within this, in logarithms.
const NAMED: f64 = 0.14;
/// Standard gravity, m/s², and how far another may be from it.
const GRAVITY_M_S2: f64 = 9.806_65;
const GRAVITY_WITHIN_M_S2: f64 = 0.1;

/// What a parameter makes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Makes {
    Force,
    Moment,
    Damping,
}

/// One parameter's outcome.
struct Determined {
    makes: Makes,
    /// Multiplies a leading power of the angle or rate, not a higher one.
    leading: bool,
    /// Logarithm of fitted over declared.
    log: f64,
    std: f64,
}

/// A constant that may be wrong, and with which power of its factor the parameters move: of forces, moments, damping.
struct Suspect {
    what: &'static str,
    key: &'static str,
    power: [f64; 3],
    /// Least logarithm of its factor that is refused although the aerodynamics stay within those of sound campaigns.
    least: f64,
    /// Factor declared over true, and its name.
    units: &'static [(f64, &'static str)],
}

const SUSPECTS: &[Suspect] = &[
    Suspect {
        what: "mass",
        key: "[vehicle] mass_kg",
        power: [1.0, 0.0, 0.0],
        least: 0.34,
        units: &[(1e3, "mass is in grams"), (2.204_62, "mass is in pounds"), (0.068_522, "mass is in slugs")],
    },
    Suspect {
        what: "inertia",
        key: "[vehicle] inertia_kg_m2",
        power: [0.0, 1.0, 1.0],
        least: 0.53,
        units: &[
            (1e3, "inertia is in g m2"),
            (1e4, "inertia is in kg cm2"),
            (1e7, "inertia is in g cm2"),
            (1e6, "inertia is in kg mm2"),
            (23.730_4, "inertia is in lb ft2"),
            (3_417.17, "inertia is in lb in2"),
            (0.737_562, "inertia is in slug ft2"),
        ],
    },
    Suspect {
        what: "reference diameter",
        key: "[vehicle] reference_diameter_m",
        power: [-2.0, -3.0, -4.0],
        least: 0.2,
        units: &[
            (0.5, "the reference diameter is a radius"),
            (2.0, "the reference diameter is twice what it is"),
            (1e3, "the reference diameter is in mm"),
            (1e2, "the reference diameter is in cm"),
            (3.280_84, "the reference diameter is in feet"),
            (39.370_1, "the reference diameter is in inches"),
        ],
    },
    Suspect {
        what: "density, from pressure and temperature,",
        key: "ps_Pa, Ts_K",
        power: [-1.0, -1.0, -1.0],
        least: f64::INFINITY,
        units: &[
            (1e-3, "pressure is in kPa"),
            (1e-2, "pressure is in hPa"),
            (1.0 / 47.880_26, "pressure is in lb/ft2"),
            (1.0 / 6_894.757, "pressure is in psi"),
            (1.0 / 101_325.0, "pressure is in atm"),
        ],
    },
    Suspect {
        what: "tunnel speed",
        key: "VW_m_s",
        power: [-2.0, -2.0, -1.0],
        least: f64::INFINITY,
        units: &[
            (3.6, "speed is in km/h"),
            (1.943_84, "speed is in knots"),
            (3.280_84, "speed is in ft/s"),
            (2.236_94, "speed is in mph"),
            (1e2, "speed is in cm/s"),
            (196.850_4, "speed is in ft/min"),
        ],
    },
];

/// A constant that is off.
pub(super) fn fault(campaign: &Campaign, instants: &[MotionSample]) -> Option<GrossFault> {
    if instants.is_empty() {
        return None;
    }
    suspect(campaign, &fitted(campaign, &campaign.plant, instants)?)
}

/// A temperature in degrees Celsius: no gas that is blown is below 60 K.
pub(super) fn celsius(instants: &[MotionSample]) -> Option<GrossFault> {
    let t = median(&instants.iter().map(|i| i.ts_k).collect::<Vec<_>>());
    (!instants.is_empty() && (-60.0..60.0).contains(&t)).then(|| GrossFault {
        place: "Ts_K".to_owned(),
        cause: "temperature is in degrees Celsius".to_owned(),
        evidence: format!("its median is {}, which no air has in kelvin", short(t)),
        change: "with Ts = Ts + 273.15 the record makes sense".to_owned(),
    })
}

fn fitted(campaign: &Campaign, plant: &Plant, instants: &[MotionSample]) -> Option<Balance> {
    let points: Vec<Point> = instants.iter().map(|i| Act::Late(0).apply(i)).collect();
    let seconds: f64 = instants.iter().map(|i| i.span_s).sum();
    balance(&points, plant, &campaign.declared, seconds, false)
}

/// Fitted over declared axial force: how well weight and drag agree.
fn axial(b: &Balance, plant: &Plant) -> Option<f64> {
    let acts = |r: &&Ratio| {
        plant.aero.structure.contributions.iter().any(|c| c.parameter == r.parameter && c.coefficient == Coefficient::CA)
    };
    b.ratio.iter().filter(acts).max_by(|a, b| a.std.total_cmp(&b.std).reverse()).map(|r| r.value)
}

/// Gravity in another unit or of the wrong sign, where weight and drag then agree and as declared do not.
pub(super) fn gravity(campaign: &Campaign, instants: &[MotionSample]) -> Option<GrossFault> {
    let g = campaign.plant.environment.gravity_m_s2;
    if instants.is_empty() || (g - GRAVITY_M_S2).abs() <= GRAVITY_WITHIN_M_S2 {
        return None;
    }
    let mut plant = campaign.plant.clone();
    plant.environment.gravity_m_s2 = GRAVITY_M_S2;
    let other = axial(&fitted(campaign, &plant, instants)?, &plant)?;
    let now = axial(&fitted(campaign, &campaign.plant, instants)?, &campaign.plant)?;
    let agrees = |x: f64| x > 0.0 && x.ln().abs() < BEYOND;
    (agrees(other) && !agrees(now)).then(|| GrossFault {
        place: "[environment] gravity_m_s2".to_owned(),
        cause: if g < 0.0 { "gravity has the wrong sign".to_owned() } else { "gravity is in another unit".to_owned() },
        evidence: format!(
            "the drag that carries the weight is then {} of the declared one, with {} m/s2 it is {}",
            short(other),
            short(g),
            short(now)
        ),
        change: format!("with gravity_m_s2 = {GRAVITY_M_S2} weight and drag agree"),
    })
}

/// What a parameter makes, by its first contribution; none for a constant, which is an asymmetry and as large as it likes.
fn makes(plant: &Plant, parameter: usize) -> Option<(Makes, bool)> {
    let c = plant.aero.structure.contributions.iter().find(|c| c.parameter == parameter)?;
    if c.term.factors.is_empty() {
        return None;
    }
    let rate = |f: &Factor| {
        matches!(
            f.variable(),
            Variable::RollRate | Variable::PitchRate | Variable::YawRate | Variable::PitchDamping | Variable::YawDamping
        )
    };
    let force = matches!(c.coefficient, Coefficient::CA | Coefficient::CY | Coefficient::CN);
    let kind = match (force, c.term.factors.iter().any(rate)) {
        (true, false) => Makes::Force,
        (false, false) => Makes::Moment,
        (false, true) => Makes::Damping,
        (true, true) => return None,
    };
    let higher = |f: &Factor| matches!(f, Factor::Power(_, n) if *n > 1);
    Some((kind, !c.term.factors.iter().any(higher)))
}

fn determined(found: &Balance, plant: &Plant) -> Vec<Determined> {
    let one = |r: &Ratio| {
        let (makes, leading) = makes(plant, r.parameter)?;
        let std = r.std / r.value;
        (r.value > 0.0 && std < DETERMINED).then(|| Determined { makes, leading, log: r.value.ln(), std })
    };
    found.ratio.iter().filter_map(one).collect()
}

/// Logarithm of the common factor by which a suspect is off, and the mean misfit of the parameters over what is allowed, where none
/// is beyond it.
fn common(s: &Suspect, determined: &[Determined], offset: bool) -> Option<(f64, f64)> {
    let power = |t: &Determined| s.power[t.makes as usize];
    let shifts: Vec<f64> = determined.iter().filter(|t| t.leading && power(t).abs() > 0.0).map(|t| t.log / power(t)).collect();
    if shifts.len() < 2 {
        return None;
    }
    let factor = median(&shifts);
    let beyond = determined.iter().filter(|t| (power(t) * factor).abs() > BEYOND && t.log.abs() > BEYOND).count() >= 2;
    let moved = factor.abs() * s.power.iter().fold(0.0, |most: f64, p| most.max(p.abs()));
    let [leading, other] = CLOSE;
    let close = [leading * (2.0 * factor.abs()).min(1.0), other];
    let band = if beyond { LOOSE.map(|b| b * (0.6 * moved).min(1.0)) } else { close };
    let off = |t: &Determined| (t.log - power(t) * factor).abs() / (band[usize::from(!t.leading)] + t.std);
    // With the c.m. off the origin, a force that is far off reaches the moments.
    let reached = |t: &&Determined| beyond && offset && s.power[1].abs() < 0.5 && t.makes != Makes::Force;
    let counted: Vec<&Determined> = determined.iter().filter(|t| !reached(t)).collect();
    let worst = counted.iter().map(|t| off(t)).fold(0.0, f64::max);
    // What must stay as declared must be there to be seen, and so must enough of what moves.
    // Damping alone does not say that inertia is off.
    let seen = determined.iter().filter(|t| t.leading).count() >= 4
        && determined.iter().any(|t| t.makes == Makes::Force)
        && (s.power[0].abs() > 0.0 || determined.iter().any(|t| t.leading && t.makes == Makes::Moment));
    let large = beyond || factor.abs() > s.least;
    let misfit = determined.iter().map(|t| (t.log - power(t) * factor).abs()).sum::<f64>();
    (seen && large && worst < 1.0).then_some((factor, misfit))
}

/// What to declare where the constant is right: the leading aerodynamics as the runs give them.
fn starting(campaign: &Campaign, found: &Balance) -> String {
    let aero = &campaign.plant.aero;
    let leading = found.ratio.iter().filter(|r| makes(&campaign.plant, r.parameter).is_some_and(|(_, leading)| leading));
    let one = |r: &Ratio| format!("{} = {}", aero.structure.parameters[r.parameter], short(r.value * aero.values[r.parameter]));
    format!("; if it is as measured, begin with {}", leading.map(one).collect::<Vec<_>>().join(", "))
}

fn suspect(campaign: &Campaign, found: &Balance) -> Option<GrossFault> {
    let determined = determined(found, &campaign.plant);
    let offset = campaign.plant.vehicle.p_origin_cm.norm() > 0.0;
    let all = SUSPECTS.iter().filter_map(|s| common(s, &determined, offset).map(|c| (s, c)));
    let (s, (factor, _)) = all.min_by(|a, b| a.1.1.total_cmp(&b.1.1))?;
    // Where a factor is beyond doubt the nearest unit is meant, whatever the aerodynamics add.
    let near = if factor.abs() > 2.0 { LOOSE[0] } else { NAMED };
    let apart = |f: f64| (f.ln() - factor).abs();
    let nearest = s.units.iter().min_by(|a, b| apart(a.0).total_cmp(&apart(b.0)));
    let named = nearest.filter(|(f, _)| apart(*f) < near).copied();
    let by = factor.exp();
    let cause =
        named.map_or_else(|| format!("the {} is about {} times what it must be", s.what, short(by)), |(_, name)| name.to_owned());
    let change = match named {
        Some((f, _)) => format!("with {} divided by {} the record makes sense", s.key, short(f)),
        None => format!("with {} about {} times what it is the record makes sense", s.key, short(1.0 / by)),
    };
    // Starting values may themselves be a factor off, all those of a kind by chance.
    let begin = if factor.abs() < BEYOND { starting(campaign, found) } else { String::new() };
    let moved = |k: Makes| {
        let logs: Vec<f64> = determined.iter().filter(|t| t.makes == k && t.leading).map(|t| t.log).collect();
        if logs.is_empty() { "-".to_owned() } else { short(median(&logs).exp()) }
    };
    Some(GrossFault {
        place: s.key.to_owned(),
        cause,
        evidence: format!(
            "the runs give {} times the declared force coefficients, {} times the static moments and {} times the damping",
            moved(Makes::Force),
            moved(Makes::Moment),
            moved(Makes::Damping)
        ),
        change: change + &begin,
    })
}

#[cfg(test)]
mod tests;
