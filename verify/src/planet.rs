//! verify: check cases over a planet. In: published and closed-form numbers, in files beside this one. Out: distances from them.
//!
//! Cases of NASA/TM-2015-218675 (NESC), flown by the same code as planet scenarios. NASA states no tolerances; the bounds are those that
//! an independent solution (an integrator of eighth order at 1e-13) met.

use super::flown::largest;
use super::{Bound, Check, CheckKind};
use crate::VerifyError;
use windfall_model::frames::Vec3;
use windfall_model::planet::{
    Atmosphere, Dispersions, FlightStart, Geodetic, Gravity, Planet, PlanetBody, PlanetFlight, PlanetScenario, Reference,
    Spheroid, WindTable, Winds,
};
use windfall_model::{Aero, ApparentMass, Coefficient, Contribution, Factor, Inertia, Structure, Term, Variable, Vehicle};
use windfall_sim::{PlanetTruth, fly_planet};

/// A foot, m.
const FOOT_M: f64 = 0.3048;
/// Mass of the sphere: 1 slug, kg.
const SLUG_KG: f64 = 14.593_902_937_206;
/// Height from which every case starts, m.
const START_M: f64 = 9144.0;
const MU_M3_S2: f64 = 3.986_004_418e14;
/// The brick's moments of inertia, kg m².
const BRICK: [f64; 3] = [0.002_568_217_474_088_241, 0.008_421_011_037_627_137, 0.009_754_655_939_231_492];

pub(super) fn checks() -> Result<Vec<Check>, VerifyError> {
    let mut all = vec![tumbling_brick()?, fast_top()?];
    all.extend(damped_brick()?);
    all.extend(round_earth()?);
    all.extend(sphere(6, "still air", Winds::STILL, include_str!("planet/nesc-06.csv"))?);
    all.extend(sphere(
        7,
        "a steady wind",
        Winds::Steady { north_m_s: 0.0, east_m_s: 20.0 * FOOT_M },
        include_str!("planet/nesc-07.csv"),
    )?);
    all.extend(sphere(8, "a wind that grows with height", shear(), include_str!("planet/nesc-08.csv"))?);
    Ok(all)
}

/// Rows of a file beside this one; the first column is time.
fn rows<const N: usize>(text: &str) -> Vec<[f64; N]> {
    let row = |line: &str| {
        let mut cells = line.split(',').map(|c| c.parse().unwrap_or(f64::NAN));
        std::array::from_fn(|_| cells.next().unwrap_or(f64::NAN))
    };
    text.lines().filter(|l| l.starts_with(|c: char| c.is_ascii_digit())).map(row).collect()
}

/// Largest distance of what a truth has at the rows' times from columns of the rows; infinite when it has not those times.
fn farthest<const N: usize>(rows: &[[f64; N]], truth: &PlanetTruth, columns: [usize; 3], of: impl Fn(usize) -> [f64; 3]) -> f64 {
    let same = truth.len() == rows.len() && rows.iter().zip(&truth.t_s).all(|(r, t)| (r[0] - t).abs() < 1e-9);
    if !same {
        return f64::INFINITY;
    }
    largest((0..rows.len()).flat_map(|k| {
        let flown = of(k);
        (0..3).map(move |c| flown[c] - rows[k][columns[c]]).collect::<Vec<_>>()
    }))
}

fn degrees(rad: [f64; 3]) -> [f64; 3] {
    rad.map(f64::to_degrees)
}

fn wgs_84(atmosphere: Option<Atmosphere>, wind: Winds) -> Planet {
    Planet {
        figure: Spheroid { equatorial_radius_m: 6_378_137.0, flattening: 1.0 / 298.257_223_563 },
        rotation_rad_s: 7.292_115e-5,
        gravity: Gravity::J2 { mu_m3_s2: MU_M3_S2, j2: 1.082_629_82e-3 },
        atmosphere,
        wind,
    }
}

/// Wind from the west of `0.003 h − 20` ft/s, to 100 000 ft.
fn shear() -> Winds {
    let row = |h_ft: f64| [h_ft * FOOT_M, 0.0, (0.003 * h_ft - 20.0) * FOOT_M];
    Winds::Table(WindTable::new(vec![row(0.0), row(1e5)]).expect("two finite rows that ascend"))
}

fn rigid([xx, yy, zz]: [f64; 3], mass_kg: f64, reference: Reference, aero: Aero) -> PlanetBody {
    let vehicle = Vehicle {
        mass_kg,
        inertia: Inertia { xx, yy, zz, ..Inertia::default() },
        p_origin_cm: Vec3::zero(),
        diameter_m: 0.0,
        apparent: ApparentMass::default(),
        loose: None,
    };
    PlanetBody { vehicle, reference, aero, point: false }
}

/// Parameters with the terms that each has.
fn structure(name: &str, parameters: &[(&str, f64)], terms: &[(Coefficient, usize, f64, &[Factor])]) -> Aero {
    let contributions = terms.iter().map(|&(coefficient, parameter, scale, factors)| Contribution {
        coefficient,
        parameter,
        term: Term::new(scale, factors),
    });
    let names = parameters.iter().map(|(n, _)| (*n).to_owned()).collect();
    let structure = Structure { name: name.to_owned(), parameters: names, contributions: contributions.collect() };
    Aero::new(structure, parameters.iter().map(|(_, v)| *v).collect())
}

/// The brick with `C_l,p`, `C_m,q` and `C_n,r` of one value.
fn brick(damping: f64) -> PlanetBody {
    use Factor::Power as P;
    let aero = structure(
        "rate-damping",
        &[("Cl_p", damping), ("Cm_q", damping), ("Cn_r", damping)],
        &[
            (Coefficient::Cl, 0, 1.0, &[P(Variable::RollRate, 1)]),
            (Coefficient::Cm, 1, 1.0, &[P(Variable::PitchRate, 1)]),
            (Coefficient::Cn, 2, 1.0, &[P(Variable::YawRate, 1)]),
        ],
    );
    let reference = Reference { area_m2: 2.0 / 9.0 * FOOT_M * FOOT_M, span_m: FOOT_M / 3.0, chord_m: 2.0 / 3.0 * FOOT_M };
    rigid(BRICK, 2.267_961_895_856_376, reference, aero)
}

/// From rest over the ground at 30 000 ft over the equator, looking north.
fn truth(planet: Planet, body: PlanetBody, rates: [f64; 3], duration_s: f64, rate_hz: f64) -> Result<PlanetTruth, VerifyError> {
    let start = FlightStart {
        place: Geodetic { height_m: START_M, ..Geodetic::default() },
        v_ground: Vec3::zero(),
        attitude_rad: [0.0; 3],
        w_inertial_body: Vec3::from_array(rates),
    };
    let name = "check".to_owned();
    let flight = PlanetFlight { name: name.clone(), duration_s, rate_hz, start, numerics: PlanetFlight::default_numerics() };
    let scenario = PlanetScenario { name, planet, body, flights: Vec::new(), dispersions: Dispersions::default() };
    Ok(fly_planet(&scenario, &flight)?.truth)
}

fn tumbling() -> [f64; 3] {
    [10.0_f64, 20.0, 30.0].map(f64::to_radians)
}

fn tumbling_brick() -> Result<Check, VerifyError> {
    let t = truth(wgs_84(None, Winds::STILL), brick(0.0), tumbling(), 30.0, 1.0)?;
    let known = rows::<4>(include_str!("planet/tumbling-brick.csv"));
    let far = farthest(&known, &t, [1, 2, 3], |k| t.w_inertial_body[k]).to_degrees();
    let what = "tumbling brick over the turning Earth (NESC case 2), 30 s: body rates against the closed form";
    let source = "Jacobi elliptic functions, 30 digits; constants of NASA/TM-2015-218675";
    Ok(Check::new(CheckKind::Exact, "nesc-02-rates", what, (far, "deg/s"), Bound::at_most(1e-9), source))
}

fn fast_top() -> Result<Check, VerifyError> {
    let body = rigid([1.0, 2.0, 2.6], 1.0, Reference::of_diameter(1.0), structure("none", &[], &[]));
    let t = truth(wgs_84(None, Winds::STILL), body, [1.0, 15.0, 1.0], 10.0, 2.0)?;
    let known = rows::<4>(include_str!("planet/fast-top.csv"));
    let far = farthest(&known, &t, [1, 2, 3], |k| t.w_inertial_body[k]);
    let what = "fast top beside its unstable axis, 15 rad/s, 10 s: body rates against the closed form";
    let source = "Jacobi elliptic functions, 30 digits; after van Zon and Schofield 2007";
    Ok(Check::new(CheckKind::Exact, "fast-top-rates", what, (far, "rad/s"), Bound::at_most(1e-9), source))
}

fn damped_brick() -> Result<Vec<Check>, VerifyError> {
    let t = truth(wgs_84(Some(Atmosphere::Us1976), Winds::STILL), brick(-1.0), tumbling(), 30.0, 1.0)?;
    let known = rows::<7>(include_str!("planet/nesc-03.csv"));
    let angles = farthest(&known, &t, [1, 2, 3], |k| degrees(t.attitude_rad[k]));
    let rates = farthest(&known, &t, [4, 5, 6], |k| degrees(t.w_inertial_body[k]));
    let source = "NASA/TM-2015-218675 case 3, simulation 4: damping on inertial rates; S, b, c = 2/9 ft², 1/3, 2/3 ft";
    let published = |id, what, figure, bound| Check::new(CheckKind::Published, id, what, figure, Bound::at_most(bound), source);
    Ok(vec![
        published("nesc-03-rates", "brick with rate damping (NESC case 3), 30 s: body rates", (rates, "deg/s"), 2e-5),
        published("nesc-03-angles", "its roll, pitch and yaw from north-east-down", (angles, "deg"), 2e-4),
    ])
}

/// A sphere as a rigid body: drag along the velocity whatever its attitude.
fn round_earth() -> Result<Vec<Check>, VerifyError> {
    use Factor::Power as P;
    let (sin, cos) = (P(Variable::SinAlphaT, 1), P(Variable::CosAlphaT, 1));
    let aero = structure(
        "sphere",
        &[("CD", 0.1)],
        &[
            (Coefficient::CA, 0, 1.0, &[cos]),
            (Coefficient::CY, 0, -1.0, &[sin, P(Variable::SinPhi, 1)]),
            (Coefficient::CN, 0, 1.0, &[sin, P(Variable::CosPhi, 1)]),
        ],
    );
    let planet = Planet {
        figure: Spheroid { equatorial_radius_m: 6_371_007.180_9, flattening: 0.0 },
        rotation_rad_s: 0.0,
        gravity: Gravity::Central { mu_m3_s2: MU_M3_S2 },
        atmosphere: Some(Atmosphere::Us1976),
        wind: Winds::STILL,
    };
    let t = truth(planet, rigid([4.880_944_613_992_92; 3], SLUG_KG, sphere_reference(), aero), tumbling(), 30.0, 1.0)?;
    let known = rows::<6>(include_str!("planet/nesc-04.csv"));
    let height = farthest(&known, &t, [1; 3], |k| [t.place[k].height_m; 3]);
    let speed = farthest(&known, &t, [2; 3], |k| [t.v_ground_ned[k][2]; 3]);
    let angles = farthest(&known, &t, [3, 4, 5], |k| degrees(t.attitude_rad[k]));
    let source = "NASA/TM-2015-218675 case 4, simulation 4";
    let published = |id, what, figure, bound| Check::new(CheckKind::Published, id, what, figure, Bound::at_most(bound), source);
    Ok(vec![
        published(
            "nesc-04-altitude",
            "sphere dropped over a round Earth at rest (NESC case 4), 30 s: altitude",
            (height, "m"),
            2e-5,
        ),
        published("nesc-04-speed", "its speed downward", (speed, "m/s"), 1e-5),
        published("nesc-04-angles", "its roll, pitch and yaw", (angles, "deg"), 2e-8),
    ])
}

fn sphere_reference() -> Reference {
    Reference { area_m2: 0.196_349_5 * FOOT_M * FOOT_M, span_m: 1.0, chord_m: 1.0 }
}

/// The sphere as a point mass over the turning ellipsoid, with drag.
fn sphere(case: u32, air: &str, wind: Winds, published: &str) -> Result<Vec<Check>, VerifyError> {
    let aero = Aero::new(Structure::point_mass(), vec![0.1]);
    let body = PlanetBody { point: true, ..rigid([1.0; 3], SLUG_KG, sphere_reference(), aero) };
    let t = truth(wgs_84(Some(Atmosphere::Us1976), wind), body, [0.0; 3], 30.0, 1.0)?;
    let known = rows::<5>(published);
    // Longitude as distance on the ground.
    let metres: Vec<[f64; 5]> = known.iter().map(|r| [r[0], r[1], r[2].to_radians() * 6_378_137.0, r[3], r[4]]).collect();
    let place = farthest(&metres, &t, [1, 2, 2], |k| {
        let east = t.place[k].longitude_rad * 6_378_137.0;
        [t.place[k].height_m, east, east]
    });
    let speed = farthest(&metres, &t, [3, 4, 4], |k| {
        let [_, east, down] = t.v_ground_ned[k];
        [east, down, down]
    });
    let source = format!("NASA/TM-2015-218675 case {case}, simulation 4");
    let check = |id: &str, what: String, figure, bound| {
        Check::new(CheckKind::Published, format!("nesc-0{case}-{id}"), what, figure, Bound::at_most(bound), &source)
    };
    Ok(vec![
        check(
            "position",
            format!("sphere dropped over the turning ellipsoid in {air} (NESC case {case}), 30 s: altitude and east"),
            (place, "m"),
            1e-3,
        ),
        check("velocity", "its velocity east and down".to_owned(), (speed, "m/s"), 1e-5),
    ])
}

#[cfg(test)]
mod tests;
