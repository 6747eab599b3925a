//! pid tests: rows of a pool against the terms themselves.

use super::super::pool::pools;
use super::super::select::tests::{crooked, dense};
use super::*;
use crate::equation_error::tests::run;
use windfall_model::Variable;

fn data<'a>(pool: &'a Pool, rows: Vec<SelectionRows>) -> PoolData<'a> {
    PoolData { pool, runs: &[], linear: vec![4, 2, 0, 1], spectra: Vec::new(), rows }
}

/// What effects add is taken off: of coefficients that are only that, nothing is left.
#[test]
fn exact_response_less_what_effects_add() {
    let mut aero = Aero::new(Structure { name: String::new(), parameters: Vec::new(), contributions: Vec::new() }, Vec::new());
    aero.add(Coefficient::CN, -0.8, 1.3, &[Factor::Power(Variable::Speed, 1)]);
    aero.add(Coefficient::CN, 2.3, 0.7, &[Factor::Power(Variable::SinAlphaT, 2)]);
    let mut run = run(9);
    for row in &mut run.rows {
        row.exp_origin = aero.coefficients(&row.flow);
        row.exp_origin[Coefficient::CN as usize] += 0.3;
    }
    for (coefficient, expected) in [(Coefficient::CN, 0.3), (Coefficient::CA, 0.0)] {
        assert!(response(&run, &aero, coefficient).iter().all(|y| (y - expected).abs() < 1e-14));
    }
}

/// Slopes by the width against differences: their step's square, 1e-10, times third derivatives of 1e3.
#[test]
fn exact_slope_by_the_width() {
    let run = run(9);
    let pools = pools();
    let shaped = pools.iter().flat_map(|p| &p.candidates).find(|c| c.shaped).expect("a bump");
    let (w, h) = (0.17, 1e-5);
    for coefficient in [Coefficient::Cm, Coefficient::Cn, Coefficient::CA] {
        let at = |w: f64| regressor(&run, coefficient, &with_width(shaped, w));
        let slopes = by_width(&run, coefficient, &with_width(shaped, w));
        for ((a, b), slope) in at(w + h).iter().zip(at(w - h)).zip(slopes) {
            assert!((slope - (a - b) / (2.0 * h)).abs() < 1e-6, "{coefficient:?}: {slope}");
        }
    }
}

/// A candidate that is zero now and then acts; one that is zero always does not, whatever the other coefficients.
#[test]
fn law_excited_where_it_acts_anywhere() {
    let mut runs = [run(5), run(4)];
    for run in &mut runs {
        run.rows[2].flow.values[Variable::PitchRate as usize] = 0.0;
        run.rows.iter_mut().for_each(|r| r.flow.values[Variable::RollRate as usize] = 0.0);
    }
    let pools = pools();
    let of = |name: &str| {
        let pool = pools.iter().find(|p| p.candidates.iter().any(|c| c.name == name)).expect("a pool");
        excited(pool.candidates.iter().find(|c| c.name == name).expect("there"), &pool.coefficients, &runs)
    };
    assert_eq!(["CA_qr2", "Cm_q", "CA_p2", "Cl_p"].map(of), [true, true, false, false]);
}

/// Series below one another, nuisance columns left away; a column over all runs, and rows of all, in the runs' order.
#[test]
fn exact_rows_below_one_another() {
    let rows = crooked(&[5, 3, 4]);
    let one = stacked(&rows.iter().map(|r| (r.x.clone(), r.y.clone())).collect::<Vec<_>>(), 3);
    assert_eq!((one.x.shape(), one.y.len()), ((12, 3), 12));
    let pool = pools().remove(0);
    let data = data(&pool, rows.clone());
    let (x, y) = data.base(&[2, 0]);
    let column = DVector::from_fn(12, |i, _| (1.7 * i as f64).sin());
    let wider = data.reduced_with(&column);
    let mut start = 0;
    let mut whole = Vec::new();
    for r in &rows {
        for i in 0..r.y.len() {
            let at = start + i;
            let expected = [r.y[i], r.y[i], r.x[(i, 0)], r.x[(i, 2)], r.x[(i, 2)], r.x[(i, 0)]];
            let found = [one.y[at], y[at], one.x[(at, 0)], one.x[(at, 2)], x[(at, 0)], x[(at, 1)]];
            assert_eq!(found.map(f64::to_bits), expected.map(f64::to_bits), "{at}");
        }
        let mut x = r.x.clone().resize_horizontally(5, 0.0);
        x.set_column(4, &column.rows(start, r.y.len()));
        whole.push(SelectionRows { x, y: r.y.clone() });
        start += r.y.len();
    }
    let rss = wider.solve(&[0, 1, 2], &[1, 4]).expect("their own").rss;
    let expected = dense(&whole.iter().collect::<Vec<_>>(), &[1, 4]).1;
    assert_eq!(wider.columns(), 5);
    assert!((rss / expected - 1.0).abs() < 1e-12, "{rss} {expected}");
}
