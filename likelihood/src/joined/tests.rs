//! likelihood tests: parts of a flight, and what bridges a gap.

use super::*;
use windfall_model::Use;

/// Ten seconds of a model that swings and rolls, with noise, from a time on.
fn swinging(phase: f64) -> Record {
    let (dt, n) = (1.0 / 150.0, 1500);
    let series = |size: f64, hz: f64, noise: f64, seed: usize| -> Vec<f64> {
        let mut state = seed as f64 * 0.618;
        let mut random = || {
            state = (state * 997.0 + 0.1234).fract();
            state - 0.5
        };
        (0..n)
            .map(|i| {
                size * (std::f64::consts::TAU * hz * (i as f64 * dt + phase)).sin() + noise * (random() + random() + random())
            })
            .collect()
    };
    Record {
        t_s: (0..n).map(|i| i as f64 * dt).collect(),
        position_m: [1, 2, 3].map(|k| series(0.2, 0.3 * k as f64, 3e-4, k)),
        attitude_rad: [series(9.0, 0.05, 1e-3, 4), series(0.3, 1.0, 1e-3, 5), series(0.3, 1.1, 1e-3, 6)],
        vw_m_s: series(0.2, 0.1, 0.01, 7).iter().map(|v| 7.4 + v).collect(),
        ps_pa: vec![1e5; n],
        ts_k: vec![290.0; n],
        ..Record::default()
    }
}

fn part(r: &Record, rows: std::ops::Range<usize>, start_s: f64, roll: f64) -> Record {
    let of = |x: &[f64]| x[rows.clone()].to_vec();
    let [rx, ry, rz] = &r.attitude_rad;
    Record {
        t_s: of(&r.t_s).iter().map(|t| t - r.t_s[rows.start] + start_s).collect(),
        position_m: [0, 1, 2].map(|k| of(&r.position_m[k])),
        attitude_rad: [of(rx).iter().map(|x| x + roll).collect(), of(ry), of(rz)],
        vw_m_s: of(&r.vw_m_s),
        ps_pa: of(&r.ps_pa),
        ts_k: of(&r.ts_k),
        ..Record::default()
    }
}

fn runs(records: Vec<Record>) -> Vec<Run> {
    let run = |(i, record)| Run {
        name: format!("run {i}"),
        kind: "perturbed".to_owned(),
        used: Use::Identify,
        inputs: Vec::new(),
        data: Data::Tunnel(record),
        notes: Vec::new(),
    };
    records.into_iter().enumerate().map(run).collect()
}

fn record(runs: &[Run], i: usize) -> &Record {
    let Data::Tunnel(r) = &runs[i].data else { panic!("a tunnel run") };
    r
}

/// Three parts of one flight, the last first, each on a clock of its own and one a turn of roll away, are the flight again; another
/// flight beside them stays.
#[test]
fn exact_parts_of_a_flight_are_that_flight() {
    let whole = swinging(0.0);
    let parts = [
        part(&whole, 1000..1500, 0.0, std::f64::consts::TAU),
        swinging(3.3),
        part(&whole, 0..400, 0.0, 0.0),
        part(&whole, 400..1000, 0.0, 0.0),
    ];
    let mut c = runs(parts.to_vec());
    assert_eq!(joined(&mut c, &[0, 1, 2, 3]), [1, 2]);
    assert_eq!(record(&c, 1), &swinging(3.3));
    let one = record(&c, 2);
    assert_eq!((&one.position_m, &one.vw_m_s, one.len()), (&whole.position_m, &whole.vw_m_s, whole.len()));
    assert!(one.attitude_rad[0].iter().zip(&whole.attitude_rad[0]).all(|(a, b)| (a - b).abs() < 1e-12));
}

/// A third of a second without samples on one clock is bridged, with samples that count as missing, as far as the model could have
/// gone; on clocks of their own, after longer, or where the pose leads elsewhere the parts are flights of their own.
#[test]
fn law_a_gap_is_bridged_where_the_motion_leads_across() {
    let whole = swinging(0.0);
    let second = |start: usize, start_s: f64| part(&whole, start..1500, start_s, 0.0);
    let joins = |second: Record| {
        let mut c = runs(vec![part(&whole, 0..700, 0.0, 0.0), second]);
        (joined(&mut c, &[0, 1]).len() == 1).then_some(c)
    };
    let c = joins(second(750, whole.t_s[750])).expect("one flight");
    let one = record(&c, 0);
    assert_eq!((one.len(), one.bridged.iter().filter(|b| **b).count()), (1500, 50));
    for k in 700..750 {
        assert!(one.bridged[k]);
        // A cubic over a third of a swing, its slopes known to a fifth of the swing's largest.
        assert!((one.attitude_rad[1][k] - whole.attitude_rad[1][k]).abs() < 0.08, "{k}");
    }
    assert!(joins(second(750, 0.0)).is_none(), "of another clock");
    assert!(joins(second(850, whole.t_s[850])).is_none(), "a second later");
    let mut away = second(750, whole.t_s[750]);
    away.position_m[1].iter_mut().for_each(|y| *y += 1.0);
    assert!(joins(away).is_none(), "a metre away");
}

/// Two flights, each on a clock from zero, that hang in nearly the same place and are cut by gaps that overlap: every piece goes on
/// with its own file's next one, and where that was too short to be kept, with none.
#[test]
fn law_a_piece_goes_on_in_its_own_file() {
    let dt = 1.0 / 150.0;
    let still = |x: f64| {
        let mut r = swinging(0.0);
        r.position_m[0].iter_mut().for_each(|v| *v = 0.01 * *v + x);
        r.attitude_rad.iter_mut().flatten().for_each(|v| *v *= 0.01);
        r
    };
    let flights = [still(0.2), still(0.25)];
    let piece = |flight: usize, rows: std::ops::Range<usize>| {
        let mut r = part(&flights[flight], rows.clone(), rows.start as f64 * dt, 0.0);
        r.piece_of = Some(format!("flight {flight}"));
        r
    };
    let all = [piece(0, 0..700), piece(1, 0..690), piece(0, 730..1500), piece(1, 725..1500)];
    let mut c = runs(all.to_vec());
    assert_eq!(joined(&mut c, &[0, 1, 2, 3]), [0, 1]);
    assert!((record(&c, 0).position_m[0][1000] - flights[0].position_m[0][1000]).abs() < 1e-12);
    assert!((record(&c, 1).position_m[0][1000] - flights[1].position_m[0][1000]).abs() < 1e-12);
    let mut c = runs(vec![all[0].clone(), all[3].clone()]);
    assert_eq!(joined(&mut c, &[0, 1]), [0, 1]);
}

const STEP_S: f64 = 0.01;

/// A record of straight lines: value at the first sample and slope of each channel.
fn straight(lines: PerChannel<[f64; 2]>, n: usize) -> Record {
    let mut record = Record {
        t_s: (0..n).map(|i| i as f64 * STEP_S).collect(),
        ps_pa: vec![1e5; n],
        ts_k: vec![290.0; n],
        ..Record::default()
    };
    for (series, [value, slope]) in record.channels_mut().into_iter().zip(lines) {
        *series = (0..n).map(|i| value + slope * i as f64 * STEP_S).collect();
    }
    record
}

/// Straight lines end and begin as they are, a second record that is turns of roll away as near as may be.
#[test]
fn exact_ends_of_straight_lines() {
    let line = |c: f64| [0.3 + 0.2 * c, 0.7 - 0.4 * c];
    let lines: PerChannel<[f64; 2]> = std::array::from_fn(|c| line(c as f64));
    let (first, second) = (straight(lines, 10), straight(lines.map(|[v, s]| [v + 0.1, 2.0 * s]), 8));
    let mut turned = second.clone();
    turned.attitude_rad[0].iter_mut().for_each(|x| *x -= 2.0 * std::f64::consts::TAU);
    for (c, [value, slope]) in lines.into_iter().enumerate() {
        for record in [&second, &turned] {
            let found = ends(&first, record, c);
            let expected = [[value + 9.0 * STEP_S * slope, slope], [value + 0.1, 2.0 * slope]];
            for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
                assert!((found - expected).abs() < 1e-12, "{c}: {found} {expected}");
            }
        }
    }
}

/// Paths that are as bent as any may be: accelerated all the way, or to one side in the first half and back in the second, of
/// places and of angles; accelerated by less, they are as much less bent.
#[test]
fn exact_farthest_paths() {
    let (gap_s, n, slope) = (0.2, 12, 1.7);
    for (c, farthest) in [(1, ACCELERATION), (4, TURNING)] {
        for share in [1.0, -0.3] {
            let a = share * farthest;
            for (aside, after) in [(0.5 * a * gap_s * gap_s, slope + a * gap_s), (0.25 * a * gap_s * gap_s, slope)] {
                let mut lines: PerChannel<[f64; 2]> = [[0.4, 0.0]; 7];
                lines[c] = [0.2, slope];
                let first = straight(lines, n);
                let end = 0.2 + slope * (n - 1) as f64 * STEP_S;
                lines[c] = [end + slope * gap_s + aside, after];
                let found = bent(&first, &straight(lines, n), gap_s);
                assert!((found - share.abs()).abs() < 1e-9, "{c} {share}: {found}");
            }
        }
    }
}

/// A second record goes on with a straight line; not where the samples beside the cut were not measured, or where it begins
/// elsewhere.
#[test]
fn law_what_was_not_measured_goes_on_with_nothing() {
    let line = [[0.3, 0.7]; 7];
    let (first, second) = (straight(line, 20), straight(line.map(|[v, s]| [v + 20.0 * STEP_S * s, s]), 20));
    assert!(goes_on(&first, &second, &[1e-12; 7]));
    let mut elsewhere = second.clone();
    elsewhere.position_m[2].iter_mut().for_each(|x| *x += 1e-3);
    assert!(!goes_on(&first, &elsewhere, &[1e-12; 7]));
    for (a, b) in [(15, 20), (20, 4)] {
        let cut = |record: &Record, at: usize| Record { bridged: (0..20).map(|i| i == at).collect(), ..record.clone() };
        assert!(!goes_on(&cut(&first, a), &cut(&second, b), &[1e-12; 7]));
    }
}

/// Across a gap each channel is the cubic with the values and slopes of both ends, by its four equations.
#[test]
fn exact_bridge_is_the_cubic_of_both_ends() {
    let (n, missing) = (11, 4);
    let first: PerChannel<[f64; 2]> = std::array::from_fn(|c| [0.3 + 0.1 * c as f64, 0.5 - 0.3 * c as f64]);
    let second = first.map(|[v, s]| [v + 0.07, 1.0 - 0.6 * s]);
    let mut record = straight(first, n);
    append(&mut record, &straight(second, n), missing);
    assert_eq!((record.len(), record.bridged.iter().filter(|b| **b).count()), (2 * n + missing, missing));
    let gap_s = 5.0 * STEP_S;
    #[rustfmt::skip]
    let equations = DMatrix::from_row_slice(4, 4, &[
        1.0, 0.0, 0.0, 0.0,
        0.0, 1.0, 0.0, 0.0,
        1.0, gap_s, gap_s.powi(2), gap_s.powi(3),
        0.0, 1.0, 2.0 * gap_s, 3.0 * gap_s.powi(2),
    ]);
    for (c, series) in record.channels().iter().enumerate() {
        let ([value, slope], [v, s]) = (first[c], second[c]);
        let ends = DVector::from_vec(vec![value + slope * (n - 1) as f64 * STEP_S, slope, v, s]);
        let p = equations.clone().lu().solve(&ends).expect("a cubic");
        for k in 1..=missing {
            let t = k as f64 * STEP_S;
            let expected = p[0] + t * (p[1] + t * (p[2] + t * p[3]));
            assert!((series[n - 1 + k] - expected).abs() < 1e-12, "{c} {k}");
        }
    }
}
