//! pid tests: a planned flight against the balance of weight and drag, information against dense algebra, and prices by trying.

use super::*;
use crate::equations::tests::plant;
use windfall_model::frames::Vec3;
use windfall_model::{FlowState, Freedom, Inertia, MeanFlow, Unknown, UnknownId};

/// A lander on no tether, its mass on its axis, an anemometer that shows too much.
fn free() -> Plant {
    let mut plant = plant();
    plant.tether = None;
    plant.flow = MeanFlow::default();
    plant.vehicle.inertia = Inertia { xy: 0.0, xz: 0.0, yz: 0.0, ..plant.vehicle.inertia };
    plant.vehicle.p_origin_cm = Vec3::new(0.01, 0.0, 0.0);
    plant.sensors.wind_scale = 0.03;
    plant
}

/// Two parameters free, the others as the plant has them.
fn unknown(plant: &Plant) -> Unknowns {
    let freedom = |i: usize, value: f64| match i {
        0 => Freedom::Free(1),
        2 => Freedom::Free(0),
        _ => Freedom::Held(value),
    };
    let names = plant.aero.structure.parameters.iter().zip(&plant.aero.values).enumerate();
    let one = |(i, (name, v)): (usize, (&String, &f64))| Unknown::linear(UnknownId::Parameter(i), name, *v, freedom(i, *v));
    Unknowns::from(names.map(one).collect::<Vec<_>>())
}

fn scene<'s>(plant: &'s Plant, unknowns: &'s Unknowns) -> Scene<'s> {
    let turbulence =
        Turbulence { axial_rms_m_s: 0.11, lateral_rms_m_s: 0.17, axial_scale_m: 0.5, lateral_scale_m: 0.3, bandwidth: 0.0 };
    let mut scene = Scene {
        plant,
        unknowns,
        turbulence,
        noise: [1e-3; CHANNELS],
        jerk_root: 0.2,
        interval_s: 0.07,
        ps_pa: 101_000.0,
        ts_k: 295.0,
        trim_m_s: 0.0,
    };
    scene.trim_m_s = scene.trim(&Craft::new(plant).expect("an inverse")).expect("it hovers");
    scene
}

/// Level it hovers where `½ρV² S C_A = m g`, to rounding. Released, the angle between axis and stream is that asked for; the record
/// begins there, shows what the instruments show, and lasts for the longest run.
#[test]
fn exact_trim_and_release() {
    let plant = free();
    let unknowns = unknown(&plant);
    let scene = scene(&plant, &unknowns);
    let level = FlowState::new(Vec3::new(9.0, 0.0, 0.0), Vec3::new(0.0, 0.0, 0.0), Vec3::new(0.0, 0.0, 0.0), 0.2);
    let density = 101_000.0 / (287.05287 * 295.0);
    let area = std::f64::consts::PI * plant.vehicle.diameter_m.powi(2) / 4.0;
    let square = 2.0 * plant.vehicle.mass_kg * 9.80665 / (density * area * plant.aero.coefficients(&level)[0]);
    assert!((scene.trim_m_s / square.sqrt() - 1.0).abs() < 1e-12, "{} {}", scene.trim_m_s, square.sqrt());
    let (record, first) = scene.fly(5.0).expect("it flies");
    assert_eq!(record.len(), 859, "60 s at 0.07 s, with both ends");
    assert!((record.t_s[858] - 858.0 * 0.07).abs() < 1e-12);
    let attitude = [0, 1, 2].map(|k| record.attitude_rad[k][0]);
    assert!(attitude[0].abs() < 1e-15 && (attitude[1].cos() * attitude[2].cos() - 5.0_f64.to_radians().cos()).abs() < 1e-14);
    assert_eq!(
        [attitude[1], attitude[2], scene.trim_m_s].map(f64::to_bits),
        [first[4], first[5], first[STATES]].map(f64::to_bits)
    );
    // The origin below the c.m. by its arm along the tilted axis.
    assert!((record.position_m[0][0] + 0.01 * 5.0_f64.to_radians().cos()).abs() < 1e-14, "{}", record.position_m[0][0]);
    assert!(record.vw_m_s.iter().all(|v| (v / (1.03 * scene.trim_m_s) - 1.0).abs() < 1e-14));
}

/// Information of a run's first part: slopes over variances, `AᵀWA`, of the samples up to that time.
#[test]
fn exact_information_of_the_first_part() {
    let plant = free();
    let unknowns = unknown(&plant);
    let scene = scene(&plant, &unknowns);
    let (mut record, first) = scene.fly(5.0).expect("it flies");
    for series in record.position_m.iter_mut().chain(&mut record.attitude_rad) {
        series.truncate(30);
    }
    for series in [&mut record.t_s, &mut record.vw_m_s, &mut record.ps_pa, &mut record.ts_k] {
        series.truncate(30);
    }
    let run = PreparedRun::planned(&record, &plant, first, 0.2, scene.noise).expect("an inverse");
    let lengths = [0.3, 0.7, f64::INFINITY];
    let found = scene.information(&run, &lengths).expect("it flies");
    let random = Random { turbulence: scene.turbulence, turning: [0.0; 2] };
    let seen =
        Filter::new(&run, scene.noise).run(&random, &FreeColumns::of(&unknowns), &mut Transition::default()).expect("it flies");
    let rows = seen.pass.variance.len();
    let slopes = DMatrix::from_row_slice(rows, 2, &seen.by_parameter);
    for (length, found) in lengths.into_iter().zip(found) {
        let weight = |row: usize| if 0.07 * (row / CHANNELS) as f64 <= length { 1.0 / seen.pass.variance[row] } else { 0.0 };
        let expected = slopes.tr_mul(&DMatrix::from_fn(rows, 2, |i, j| slopes[(i, j)] * weight(i)));
        assert!((found - &expected).component_div(&expected).amax() < 1e-10, "{length}: {expected}");
    }
}

/// An error by the inverse, where the information is scaled or not; what is not excited at all does not count, and has none itself.
#[test]
fn exact_errors_by_information() {
    let m = DMatrix::from_row_slice(3, 3, &[25.0, 3.0, -2e3, 3.0, 0.7, 60.0, -2e3, 60.0, 9e5]);
    let inverse = m.clone().try_inverse().expect("it has one");
    for k in 0..3 {
        assert!((std_error(&m, k).expect("told") / inverse[(k, k)].sqrt() - 1.0).abs() < 1e-12);
    }
    let less = m.clone().insert_row(1, 0.0).insert_column(1, 0.0);
    assert_eq!(std_error(&less, 1), None);
    assert!((std_error(&less, 2).expect("told") / inverse[(1, 1)].sqrt() - 1.0).abs() < 1e-12);
}

/// Fewest runs by trying one after the other; tunnel time is theirs and what lies between; of one release the cheapest length is kept,
/// and the cheapest release comes first.
#[test]
fn exact_fewest_runs_for_an_error() {
    let plant = free();
    let unknowns = unknown(&plant);
    let scene = scene(&plant, &unknowns);
    let of = |a: f64, b: f64, c: f64| DMatrix::from_row_slice(2, 2, &[a, b, b, c]);
    let now = of(30.0, 5.0, 40.0);
    let kinds = [
        (5.0, 10.0, of(9.0, 2.0, 3.0)),
        (5.0, 30.0, of(31.0, 4.0, 11.0)),
        (15.0, 20.0, of(70.0, -9.0, 31.0)),
        (5.0, 45.0, of(32.0, 4.0, 12.0)),
    ];
    let name = unknowns.names()[1].clone();
    let estimate = plant.aero.values[0];
    let (wanted, between) = (0.021, 35.0);
    let error = |m: DMatrix<f64>| m.try_inverse().expect("it has one")[(1, 1)].sqrt();
    let cheapest = |release: f64| {
        let priced = kinds.iter().filter(|k| (k.0 - release).abs() < 1e-9).map(|(_, run_s, m)| {
            let n = (1..5000).find(|n| error(&now + m * f64::from(*n)) <= wanted).expect("enough");
            (f64::from(n) * (run_s + between) / 60.0, n, *run_s, error(&now + m * f64::from(n)))
        });
        priced.min_by(|a, b| a.0.total_cmp(&b.0)).expect("one")
    };
    for error in [Wanted::Absolute(wanted), Wanted::Percent(100.0 * wanted / estimate.abs())] {
        let found = scene.target(&Target { parameter: name.clone(), error }, &now, &kinds, between).expect("a target");
        assert!((found.estimate - estimate).abs() < 1e-15 && (found.std_error_wanted - wanted).abs() < 1e-15);
        assert!((found.std_error_now - (30.0_f64 / (30.0 * 40.0 - 25.0)).sqrt()).abs() < 1e-12);
        assert_eq!(found.options.iter().map(|o| o.release_deg.round()).collect::<Vec<_>>(), [15.0, 5.0]);
        for o in found.options {
            let (minutes, runs, run_s, error) = cheapest(o.release_deg);
            assert_eq!(o.runs, runs);
            assert!(
                (o.minutes - minutes).abs() < 1e-9
                    && (o.run_s - run_s).abs() < 1e-12
                    && (o.std_error / error - 1.0).abs() < 1e-12
            );
        }
    }
}
