//! pid: terms that a coefficient could have. In: nothing. Out: candidates, each with the symmetry of the body that admits it and why.
//!
//! What turning the body about its axis and mirroring it leave alone decides (Tobak and Schiff, NASA TR R-456, 1976; Maple and
//! Synge, Q. Appl. Math. 6, 1949). With cross flow e = (sin φ, cos φ) and transverse rate ω = (q, r): forces go with e, x × ω and
//! p x × e; moments with x × e, ω and p e; factors are even in sin α_T. Side force and normal force are one vector, so are pitch
//! and yaw moment: a symmetric term has one parameter in both.

use serde::{Deserialize, Serialize};
use windfall_model::{Coefficient, Factor, Term, Variable};

/// Which bodies may have a term: from the most symmetric down; every body below may have it too.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Symmetry {
    /// A body of revolution.
    Revolution,
    /// Unchanged by a quarter turn and by mirroring in its planes, but not by every turn (four fins, four legs).
    QuarterTurn,
    /// Unchanged by turning but not by mirroring (canted fins, screws).
    Rotation,
    /// Any body: mass, mould or mounting is off its axis.
    None,
}

/// A term that a coefficient could have.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// Parameter name; as in [`windfall_model::Structure::axisymmetric`] where that has the term.
    pub name: &'static str,
    /// Which bodies may have it.
    pub symmetry: Symmetry,
    /// What it is.
    pub why: &'static str,
    /// Where it acts.
    pub contributions: Vec<(Coefficient, Term)>,
    /// True where a factor of it has a width that is sought too.
    pub shaped: bool,
}

/// Coefficients that are one vector, and their candidates.
#[derive(Clone, Debug, PartialEq)]
pub struct Pool {
    /// Coefficients; the last of them names the pool.
    pub coefficients: Vec<Coefficient>,
    /// Their candidates.
    pub candidates: Vec<Candidate>,
}

type Part<'a> = (Coefficient, f64, &'a [Factor]);

fn candidate(name: &'static str, symmetry: Symmetry, why: &'static str, parts: &[Part<'_>]) -> Candidate {
    let contributions: Vec<(Coefficient, Term)> = parts.iter().map(|(c, s, f)| (*c, Term::new(*s, f))).collect();
    let shaped = contributions.iter().any(|(_, t)| t.factors.iter().any(|f| matches!(f, Factor::Bump(..))));
    Candidate { name, symmetry, why, contributions, shaped }
}

use Coefficient as C;
use Factor::{CosClock, Power as P, SinClock};
use Symmetry::{None as NoSymmetry, QuarterTurn, Revolution, Rotation};
use Variable as V;

const SIN_PHI: Factor = P(V::SinPhi, 1);
const COS_PHI: Factor = P(V::CosPhi, 1);

const fn sine(power: u8) -> Factor {
    P(V::SinAlphaT, power)
}

/// Width at which a bump starts, rad.
pub(crate) const START_WIDTH_RAD: f64 = 0.1;

/// All pools: axial force, normal with side force, roll moment, pitch with yaw moment.
#[must_use]
pub fn pools() -> Vec<Pool> {
    vec![axial(), normal(), roll(), pitch()]
}

fn axial() -> Pool {
    let cos = P(V::CosAlphaT, 1);
    let candidates = vec![
        candidate("CA_T0", Revolution, "axial force of the body at zero angle (eq. 4.1)", &[(C::CA, 1.0, &[cos])]),
        candidate("CA_sin2", Revolution, "even in the angle: its curvature", &[(C::CA, 1.0, &[cos, sine(2)])]),
        candidate("CA_sin4", Revolution, "even in the angle: the next power", &[(C::CA, 1.0, &[cos, sine(4)])]),
        candidate("CA_V", Revolution, "Reynolds number", &[(C::CA, 1.0, &[cos, P(V::Speed, 1)])]),
        candidate("CA_p2", Revolution, "even in the spin", &[(C::CA, 1.0, &[P(V::RollRate, 2)])]),
        candidate(
            "CA_qr2",
            Revolution,
            "square of the transverse rate",
            &[(C::CA, 1.0, &[P(V::PitchRate, 2)]), (C::CA, 1.0, &[P(V::YawRate, 2)])],
        ),
        candidate(
            "CA_rate",
            Revolution,
            "rate in the plane of the cross flow: the force lags the angle",
            &[(C::CA, 1.0, &[sine(1), COS_PHI, P(V::PitchRate, 1)]), (C::CA, -1.0, &[sine(1), SIN_PHI, P(V::YawRate, 1)])],
        ),
        candidate("CA_alpha", NoSymmetry, "trimmed off the axis, pitch plane", &[(C::CA, 1.0, &[sine(1), COS_PHI])]),
        candidate("CA_beta", NoSymmetry, "trimmed off the axis, yaw plane", &[(C::CA, 1.0, &[sine(1), SIN_PHI])]),
    ];
    Pool { coefficients: vec![C::CA], candidates }
}

/// A vector along the cross flow, as forces and static moments are: `factors · (cos φ, −sin φ)`.
fn along(name: &'static str, why: &'static str, pair: [C; 2], factor: Factor) -> Candidate {
    candidate(name, Revolution, why, &[(pair[0], 1.0, &[factor, COS_PHI]), (pair[1], -1.0, &[factor, SIN_PHI])])
}

/// A vector along the transverse rate: `factors · (q, r)`.
fn turning(name: &'static str, symmetry: Symmetry, why: &'static str, pair: [C; 2], factors: [&[Factor]; 2]) -> Candidate {
    candidate(name, symmetry, why, &[(pair[0], 1.0, factors[0]), (pair[1], 1.0, factors[1])])
}

const PITCHING: Factor = P(V::PitchDamping, 1);
const YAWING: Factor = P(V::YawDamping, 1);

/// A bump of width [`START_WIDTH_RAD`].
const BUMP: Factor = Factor::Bump(V::AlphaT, START_WIDTH_RAD);

fn magnus(name: &'static str, pair: [C; 2]) -> Candidate {
    let spin = P(V::RollRate, 1);
    let why = "Magnus: spin and cross flow make a force across both";
    candidate(name, Revolution, why, &[(pair[0], 1.0, &[spin, sine(1), SIN_PHI]), (pair[1], 1.0, &[spin, sine(1), COS_PHI])])
}

fn fourfold(name: &'static str, pair: [C; 2]) -> Candidate {
    let why = "gradient of sin⁴ α_T cos 4φ: four legs or fins";
    candidate(name, QuarterTurn, why, &[(pair[0], 1.0, &[sine(3), CosClock(3)]), (pair[1], 1.0, &[sine(3), SinClock(3)])])
}

fn normal() -> Pool {
    let pair = [C::CN, C::CY];
    let (q, r) = (P(V::PitchRate, 1), P(V::YawRate, 1));
    let candidates = vec![
        along("CN_sin", "slope of the normal force (eq. 4.2)", pair, sine(1)),
        along("CN_sin3", "odd in the angle (eq. 4.2)", pair, sine(3)),
        along("CN_sin5", "odd in the angle: the next power", pair, sine(5)),
        turning("CN_q", Revolution, "force of the transverse rate", pair, [&[q], &[r]]),
        turning("CN_q_sin2", Revolution, "the same, even in the angle", pair, [&[sine(2), q], &[sine(2), r]]),
        magnus("CN_p", pair),
        fourfold("CN_4", pair),
        candidate("CN_0", NoSymmetry, "trimmed off the axis, pitch plane", &[(C::CN, 1.0, &[])]),
        candidate("CY_0", NoSymmetry, "trimmed off the axis, yaw plane", &[(C::CY, 1.0, &[])]),
    ];
    Pool { coefficients: vec![C::CY, C::CN], candidates }
}

fn roll() -> Pool {
    let p = P(V::RollRate, 1);
    let across = [(C::Cl, 1.0, &[sine(1), SIN_PHI, P(V::PitchRate, 1)][..]), (C::Cl, 1.0, &[sine(1), COS_PHI, P(V::YawRate, 1)])];
    let candidates = vec![
        candidate("Cl_p", Revolution, "roll damping (eq. 4.6)", &[(C::Cl, 1.0, &[p])]),
        candidate("Cl_pp", Revolution, "roll damping that grows with the spin", &[(C::Cl, 1.0, &[p, P(V::RollRateAbs, 1)])]),
        candidate("Cl_p_sin2", Revolution, "roll damping, even in the angle", &[(C::Cl, 1.0, &[p, sine(2)])]),
        candidate("Cl_cross", Revolution, "transverse rate along the cross flow", &across),
        candidate("Cl_4", QuarterTurn, "four legs or fins in cross flow", &[(C::Cl, 1.0, &[sine(4), SinClock(4)])]),
        candidate("Cl_0", Rotation, "canted surfaces (eq. 4.6)", &[(C::Cl, 1.0, &[])]),
        candidate("Cl_sin2", Rotation, "canted surfaces, even in the angle", &[(C::Cl, 1.0, &[sine(2)])]),
        candidate("Cl_alpha", NoSymmetry, "one side larger, pitch plane", &[(C::Cl, 1.0, &[sine(1), COS_PHI])]),
        candidate("Cl_beta", NoSymmetry, "one side larger, yaw plane", &[(C::Cl, 1.0, &[sine(1), SIN_PHI])]),
    ];
    Pool { coefficients: vec![C::Cl], candidates }
}

fn pitch() -> Pool {
    let pair = [C::Cm, C::Cn];
    let in_plane: [Part<'_>; 4] = [
        (C::Cm, 1.0, &[sine(2), P(V::CosPhi, 2), PITCHING]),
        (C::Cm, -1.0, &[sine(2), COS_PHI, SIN_PHI, YAWING]),
        (C::Cn, -1.0, &[sine(2), COS_PHI, SIN_PHI, PITCHING]),
        (C::Cn, 1.0, &[sine(2), P(V::SinPhi, 2), YAWING]),
    ];
    let powers = |n: u8| [[P(V::Alpha, n), PITCHING], [P(V::Beta, n), YAWING]];
    let ([a2, b2], [a4, b4]) = (powers(2), powers(4));
    let candidates = vec![
        along("Cm_sin", "static moment (eq. 4.7)", pair, sine(1)),
        along("Cm_sin3", "static moment, odd in the angle (eq. 4.7)", pair, sine(3)),
        along("Cm_sin5", "static moment: the next power", pair, sine(5)),
        turning("Cm_1", Revolution, "damping (eqs 4.8-4.9)", pair, [&[PITCHING], &[YAWING]]),
        turning(
            "Cm_q",
            Revolution,
            "damping by the rate apart from that by the change of angle",
            pair,
            [&[P(V::PitchRate, 1)], &[P(V::YawRate, 1)]],
        ),
        turning("Cm_q_sin2", Revolution, "damping, even in the angle", pair, [&[sine(2), PITCHING], &[sine(2), YAWING]]),
        candidate("Cm_q_plane", Revolution, "damping in the plane of the cross flow only, even in the angle", &in_plane),
        turning("Cm_2", QuarterTurn, "damping by each plane's own angle (eqs 4.8-4.9)", pair, [&a2, &b2]),
        turning("Cm_4", QuarterTurn, "damping by each plane's own angle: the next power", pair, [&a4, &b4]),
        magnus("Cm_p", pair),
        fourfold("Cm_4phi", pair),
        candidate("Cm_0", NoSymmetry, "trimmed off the axis, pitch plane", &[(C::Cm, 1.0, &[])]),
        candidate("Cn_0", NoSymmetry, "trimmed off the axis, yaw plane", &[(C::Cn, 1.0, &[])]),
        turning(
            "Cm_bump",
            Revolution,
            "damping that differs within a few degrees of the stream, sech²(α_T/width) (Mitcheltree et al., AIAA 97-3539, 1997)",
            pair,
            [&[BUMP, PITCHING], &[BUMP, YAWING]],
        ),
    ];
    Pool { coefficients: vec![C::Cn, C::Cm], candidates }
}

#[cfg(test)]
mod tests;
