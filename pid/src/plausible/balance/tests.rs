//! pid tests: a fit of accelerations against the model whose forces made them, and against dense least squares.

use super::super::change::Act;
use super::super::tests::{instants, spread};
use super::*;
use crate::equations::tests::plant;
use windfall_model::{Factor, Variable};

fn points(plant: &Plant, count: usize) -> Vec<Point> {
    instants(plant, count, 0.1).iter().map(|i| Act::Late(0).apply(i)).collect()
}

/// Rounding of accelerations of 10 m/s² and 30 rad/s², through parameters that the instants tell less well than the best by 1e4.
const ROUNDING: f64 = 1e-8;

/// Declared values a factor off: each comes out over the declared, and nothing is left; a constant moment that is not declared
/// leaves pitch and yaw, unless it is fitted as well.
#[test]
fn recover_parameters_of_the_forces_that_act() {
    let declared = plant();
    let mut truth = declared.clone();
    let factors = [1.3, 0.7, 1.9, 0.4, 1.1, 0.6, 2.2, 1.7, 0.8, 1.2, 0.5];
    truth.aero.values.iter_mut().zip(factors).for_each(|(v, f)| *v *= f);
    let (all, seconds) = ([true; 11], 30.0);
    let found = balance(&points(&truth, 60), &declared, &all, seconds, false).expect("there is flow");
    for (r, expected) in found.ratio.iter().zip(factors) {
        // The hold, 1e-4 of a declared value, and what is left says that the value is sure.
        assert!((r.value - expected).abs() < 1e-4 && r.std < 1e-6, "{r:?} {expected}");
    }
    assert!(found.left.iter().zip(found.signal).all(|(l, s)| *l < 1e-4 * s), "{found:?}");
    // What has no place among the declared is taken off as the plant has it.
    let mut part = all;
    part[1] = false;
    let mut known = declared.clone();
    known.aero.values[1] = truth.aero.values[1];
    let found = balance(&points(&truth, 60), &known, &part, seconds, false).expect("there is flow");
    assert!(found.ratio.iter().all(|r| r.parameter != 1 && (r.value - factors[r.parameter]).abs() < 1e-4), "{found:?}");
    // A centre of mass that is elsewhere.
    truth.aero.add(Coefficient::Cm, 0.3, 1.0, &[]);
    truth.aero.add(Coefficient::Cn, -0.2, 1.0, &[]);
    let of = |offset: bool| balance(&points(&truth, 60), &declared, &all, seconds, offset).expect("there is flow");
    assert!(of(false).left[3] > 0.1 * of(false).signal[3] && of(true).left[3] < 1e-4 * of(true).signal[3]);
    assert!(of(true).ratio.iter().zip(factors).all(|(r, f)| (r.value - f).abs() < 1e-4));
}

/// Estimate and covariance by rows of all equations and of the hold, from singular values.
fn dense(rows: &[DVector<f64>], columns: &[Vec<DVector<f64>>], hold: &[f64], kept: &[usize]) -> (DVector<f64>, DMatrix<f64>) {
    let n = hold.len();
    let of = |r: usize| (kept[r / 6], r % 6);
    let a = DMatrix::from_fn(6 * kept.len() + n, n, |r, k| {
        if r < 6 * kept.len() { columns[of(r).0][k][of(r).1] } else { f64::from(u8::from(r - 6 * kept.len() == k)) / hold[k] }
    });
    let b = DVector::from_fn(a.nrows(), |r, _| if r < 6 * kept.len() { rows[of(r).0][of(r).1] } else { 0.0 });
    let svd = a.svd(true, true);
    let v = svd.v_t.as_ref().expect("asked for").transpose();
    let covariance = &v * DMatrix::from_diagonal(&svd.singular_values.map(|s| s.powi(-2))) * v.transpose();
    (svd.solve(&b, 0.0).expect("asked for"), covariance)
}

/// Noise on all accelerations, two instants that are far off, a parameter without an effect and one that is not declared: values,
/// errors and what is left as from dense weighted least squares, twice, the second time without the worst twentieth.
#[test]
fn exact_fit_is_weighted_least_squares() {
    let mut plant = plant();
    plant.aero.structure.parameters.push("no effect".to_owned());
    plant.aero.values.push(0.05);
    plant.aero.add(Coefficient::CA, 0.4, 1.3, &[Factor::Power(Variable::SinAlphaT, 2)]);
    let mut points = points(&plant, 40);
    for (i, p) in points.iter_mut().enumerate() {
        (0..6).for_each(|k| p.motion[k][2] += if k < 3 { 0.4 } else { 4.0 } * spread(i + 100, k));
    }
    points[7].motion[1][2] += 9.0;
    points[23].motion[0][2] -= 8.0;
    let mut declared = [true; 12];
    declared[3] = false;
    let free: Vec<usize> = (0..12).filter(|i| declared[*i]).collect();
    let seconds = 7.3;
    for offset in [false, true] {
        let found = balance(&points, &plant, &declared, seconds, offset).expect("there is flow");
        let density = |p: &Point| p.ps_pa / (plant.environment.gas_constant_j_kg_k * p.ts_k);
        let states: Vec<State> = points.iter().map(|p| state(p.t_s, &p.motion, density(p), &plant)).collect();
        let rates: Vec<[f64; 6]> = states
            .iter()
            .zip(&points)
            .map(|(s, p)| [p.motion[0][2], p.motion[1][2], p.motion[2][2], s.pqr_rate[0], s.pqr_rate[1], s.pqr_rate[2]])
            .collect();
        let signal = |which: &[usize]| {
            let of = |k: &[usize]| {
                let sum: f64 = which.iter().flat_map(|i| k.iter().map(|k| rates[*i][*k].powi(2))).sum();
                (sum / (which.len() * k.len()) as f64).sqrt()
            };
            [of(&[0]), of(&[1, 2]), of(&[3]), of(&[4, 5])]
        };
        let all: Vec<usize> = (0..40).collect();
        let rough = signal(&all);
        let v = &plant.vehicle;
        // Unexplained accelerations of an instant by values of parameters, and of the two constant moments.
        let residual = |r: &CoefficientRow, x: &DVector<f64>| {
            let mut aero = plant.aero.clone();
            free.iter().zip(x.iter()).for_each(|(i, x)| aero.values[*i] = *x);
            let c = aero.coefficients(&r.flow);
            let force = r.q_pa * std::f64::consts::FRAC_PI_4 * v.diameter_m.powi(2);
            let body = [
                v.mass_kg,
                v.mass_kg,
                v.mass_kg,
                v.inertia.xx / v.diameter_m,
                v.inertia.yy / v.diameter_m,
                v.inertia.zz / v.diameter_m,
            ];
            DVector::from_fn(6, |k, _| {
                let constant = if k > 3 { x.get(free.len() + k - 4).copied().unwrap_or(0.0) } else { 0.0 };
                force / body[k] * (r.exp_origin[k] - c[k] - constant)
            })
        };
        let n = free.len() + if offset { 2 } else { 0 };
        let start = DVector::from_fn(n, |k, _| free.get(k).map_or(0.0, |i| plant.aero.values[*i]));
        let weighted = |r: DVector<f64>| DVector::from_fn(6, |k, _| r[k] / rough[GROUP[k]]);
        let equations = coefficients(&states, &plant);
        let rows: Vec<DVector<f64>> = equations.iter().map(|r| weighted(residual(r, &start))).collect();
        let column = |r: &CoefficientRow, k: usize| {
            let mut x = start.clone();
            x[k] += 1.0;
            weighted(residual(r, &start) - residual(r, &x))
        };
        let columns: Vec<Vec<DVector<f64>>> = equations.iter().map(|r| (0..n).map(|k| column(r, k)).collect()).collect();
        let hold: Vec<f64> = start.iter().map(|v| 1e4 * v.abs().max(0.1)).collect();
        let size = |i: usize, step: &DVector<f64>| weighted(residual(&equations[i], &(&start + step))).norm_squared();
        let (first, _) = dense(&rows, &columns, &hold, &all);
        let mut kept = all.clone();
        kept.sort_by(|a, b| size(*a, &first).total_cmp(&size(*b, &first)));
        assert!(kept[38..].contains(&7) && kept[38..].contains(&23));
        kept.truncate(38);
        let (step, covariance) = dense(&rows, &columns, &hold, &kept);
        let of_group = |g: usize| GROUP.iter().filter(|h| **h == g).count() as f64;
        let left: [f64; 4] = std::array::from_fn(|g| {
            let sum: f64 = kept
                .iter()
                .flat_map(|i| {
                    let r = residual(&equations[*i], &(&start + &step));
                    (0..6).filter(|k| GROUP[*k] == g).map(|k| r[k].powi(2)).collect::<Vec<_>>()
                })
                .sum();
            (sum / (of_group(g) * 38.0)).sqrt()
        });
        let near = |a: f64, b: f64| (a - b).abs() < ROUNDING * (1.0 + b.abs());
        assert!((0..4).all(|g| near(found.left[g], left[g]) && near(found.signal[g], signal(&kept)[g])), "{found:?} {left:?}");
        assert_eq!(found.ratio.iter().map(|r| r.parameter).collect::<Vec<_>>(), free);
        // The group of each parameter's first contribution: C_A, C_N (2), C_l, C_m (4), C_n (2), and none.
        let groups = [0, 1, 1, 2, 3, 3, 3, 3, 3, 3, 0];
        for (k, r) in found.ratio.iter().enumerate() {
            let std = (covariance[(k, k)] * 40.0 / (2.0 * seconds)).sqrt() * left[groups[k]] / rough[groups[k]] / start[k].abs();
            assert!(near(r.value, 1.0 + step[k] / start[k]), "{k} {r:?} {}", 1.0 + step[k] / start[k]);
            assert!((r.std / std - 1.0).abs() < 1e-6, "{k} {r:?} {std}");
        }
    }
}

/// Four of forty instants at which the nose is level are too many, three are not.
#[test]
fn exact_share_of_instants_without_flow() {
    let plant = plant();
    let of = |level: usize| {
        let mut points = points(&plant, 40);
        points[..level].iter_mut().for_each(|p| p.motion[4][0] = std::f64::consts::FRAC_PI_2);
        balance(&points, &plant, &[true; 11], 5.0, false)
    };
    assert!(of(3).is_some() && of(4).is_none());
    assert!(balance(&[], &plant, &[true; 11], 5.0, false).is_none());
}
