//! pid tests: the symmetry that a term has is the one that it is said to have.

use super::*;
use windfall_model::{FlowState, VARIABLES};

/// Cross flow and rates of one flow, the transverse ones as (y, z) of body axes.
#[derive(Clone, Copy)]
struct Flow {
    cross: [f64; 2],
    spin: f64,
    rate: [f64; 2],
    damping: [f64; 2],
}

const FLOW: Flow = Flow { cross: [0.21, 0.34], spin: 0.17, rate: [-0.23, 0.41], damping: [0.31, 0.12] };

/// Forces and moments in body axes: (X, Y, Z, L, M, N) = (−C_A, C_Y, −C_N, C_l, C_m, C_n).
fn acts(candidate: &Candidate, f: Flow) -> [f64; 6] {
    let [y, z] = f.cross;
    let sine = y.hypot(z);
    let mut flow = FlowState { values: [0.0; VARIABLES] };
    let (alpha, beta) = (z.atan2((1.0 - sine * sine).sqrt()), y.asin());
    for (v, value) in [
        (V::SinAlphaT, sine),
        (V::CosAlphaT, (1.0 - sine * sine).sqrt()),
        (V::AlphaT, sine.asin()),
        (V::SinPhi, y / sine),
        (V::CosPhi, z / sine),
        (V::Alpha, alpha),
        (V::Beta, beta),
        (V::RollRate, f.spin),
        (V::RollRateAbs, f.spin.abs()),
        (V::PitchRate, f.rate[0]),
        (V::YawRate, f.rate[1]),
        (V::PitchDamping, f.damping[0]),
        (V::YawDamping, f.damping[1]),
        (V::Speed, 7.4),
    ] {
        flow.values[v as usize] = value;
    }
    let mut out = [0.0; 6];
    for (coefficient, term) in &candidate.contributions {
        let (place, sign) = match coefficient {
            C::CA => (0, -1.0),
            C::CY => (1, 1.0),
            C::CN => (2, -1.0),
            C::Cl => (3, 1.0),
            C::Cm => (4, 1.0),
            C::Cn => (5, 1.0),
        };
        out[place] += sign * term.value(&flow);
    }
    out
}

/// Largest difference between what acts in the moved flow and what acts, moved. Turning takes (y, z) of every vector along; mirroring in
/// the plane of x and z takes y of the flow and of the force the other way, and of spin, rate and moment all but y.
fn differs(candidate: &Candidate, turn: Option<f64>) -> f64 {
    let moved = |f: Flow, [x, y, z, l, m, n]: [f64; 6]| match turn {
        Some(angle) => {
            let (s, c) = angle.sin_cos();
            let by = |[y, z]: [f64; 2]| [c * y - s * z, s * y + c * z];
            let ([y, z], [m, n]) = (by([y, z]), by([m, n]));
            let f = Flow { cross: by(f.cross), rate: by(f.rate), damping: by(f.damping), ..f };
            (f, [x, y, z, l, m, n])
        }
        None => {
            let along = |[q, r]: [f64; 2]| [q, -r];
            let f = Flow { cross: [-f.cross[0], f.cross[1]], spin: -f.spin, rate: along(f.rate), damping: along(f.damping) };
            (f, [x, -y, z, -l, m, -n])
        }
    };
    let (f, expected) = moved(FLOW, acts(candidate, FLOW));
    acts(candidate, f).iter().zip(expected).map(|(a, b)| (a - b).abs()).max_by(f64::total_cmp).unwrap_or(f64::NAN)
}

/// Each term is unchanged by what its symmetry allows, to rounding, and by no more. Turned by a quarter the sideslip is the angle of
/// attack only where the two are small, so for terms by each plane's own angle to a tenth of their size.
#[test]
fn law_terms_have_the_symmetry_that_they_are_said_to_have() {
    for c in pools().iter().flat_map(|p| &p.candidates) {
        let size = acts(c, FLOW).iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        let round = 1e-14;
        let own_angle = c.contributions.iter().any(|(_, t)| t.factors.iter().any(|f| matches!(f, P(V::Alpha | V::Beta, _))));
        let quarter = differs(c, Some(std::f64::consts::FRAC_PI_2)) < if own_angle { 0.1 * size } else { round };
        let [any, mirror] = [differs(c, Some(0.7)) < round, differs(c, None) < round];
        let expected = match c.symmetry {
            Revolution => [true, true, true],
            QuarterTurn => [false, true, true],
            Rotation => [true, true, false],
            NoSymmetry => [false, false, mirror],
        };
        assert_eq!([any, quarter, mirror], expected, "{}: {size}", c.name);
    }
}
