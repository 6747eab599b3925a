//! pid tests: subsets by their triangles against dense normal equations and all that can be tried.

use super::*;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

/// Runs of so many rows of four columns, the second and last with a slope and a scale of its own.
pub(crate) fn crooked(rows: &[usize]) -> Vec<SelectionRows> {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
    let run = |n: &usize| {
        let x = DMatrix::from_fn(*n, 4, |_, j| (normal() + 0.4) * [1.0, 3.0, 0.2, 7.0][j]);
        let y = DVector::from_fn(*n, |i, _| 0.5 + 0.6 * x[(i, 1)] - 0.2 * x[(i, 3)] + 1.3 * normal());
        SelectionRows { x, y }
    };
    rows.iter().map(run).collect()
}

/// Estimate, sum of squares and (XᵀX)⁻¹ of some columns over some runs.
pub(crate) fn dense(runs: &[&SelectionRows], columns: &[usize]) -> (DVector<f64>, f64, DMatrix<f64>) {
    let y = DVector::from_iterator(runs.iter().map(|r| r.y.len()).sum(), runs.iter().flat_map(|r| r.y.iter().copied()));
    if columns.is_empty() {
        return (DVector::zeros(0), y.norm_squared(), DMatrix::zeros(0, 0));
    }
    let one =
        |c: &usize| DVector::from_iterator(y.len(), runs.iter().flat_map(|r| r.x.column(*c).iter().copied().collect::<Vec<_>>()));
    let x = DMatrix::from_columns(&columns.iter().map(one).collect::<Vec<_>>());
    let bread = x.tr_mul(&x).try_inverse().expect("columns of their own");
    let b = &bread * x.tr_mul(&y);
    let rss = (y - x * &b).norm_squared();
    (b, rss, bread)
}

fn all(rows: &[SelectionRows]) -> Vec<&SelectionRows> {
    rows.iter().collect()
}

fn close(found: f64, expected: f64) {
    // A condition of 1e3 squared leaves ten digits.
    assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
}

/// Estimates with their errors, variances, partial F, and sums of squares of rows left out in turn, by doing that.
#[test]
fn exact_numbers_of_a_subset() {
    let rows = crooked(&[9, 7]);
    let reduced = Reduced::new(rows.clone());
    let (all, chosen) = (all(&rows), [3, 1]);
    let (b, rss, bread) = dense(&all, &chosen);
    for (i, (column, estimate, std_error)) in reduced.estimates(&chosen).into_iter().enumerate() {
        assert_eq!(column, chosen[i]);
        close(estimate, b[i]);
        close(std_error, (bread[(i, i)] * rss / 14.0).sqrt());
    }
    let variance = dense(&all, &[0, 1, 2, 3]).1 / 12.0;
    close(reduced.variance(), variance);
    close(reduced.partial_f(&chosen, 1).expect("its own"), (dense(&all, &[3]).1 - rss) / variance);
    close(reduced.partial_f(&chosen, 0).expect("its own"), (rss - dense(&all, &[3, 1, 0]).1) / variance);
    let y: Vec<f64> = rows.iter().flat_map(|r| r.y.iter().copied()).collect();
    let mean = y.iter().sum::<f64>() / 16.0;
    close(reduced.response_variance(), y.iter().map(|y| y * y).sum::<f64>() / 16.0 - mean * mean);
    let mut press = 0.0;
    for (run, r) in rows.iter().enumerate() {
        for i in 0..r.y.len() {
            let mut less = rows.clone();
            less[run] = SelectionRows { x: r.x.clone().remove_row(i), y: r.y.clone().remove_row(i) };
            let b = dense(&less.iter().collect::<Vec<_>>(), &chosen).0;
            press += (r.y[i] - r.x[(i, 3)] * b[0] - r.x[(i, 1)] * b[1]).powi(2);
        }
    }
    close(reduced.press(&chosen).expect("its own"), press);
}

/// Values of every criterion with the first columns of its path: definitions, by dense sums of squares.
#[test]
fn exact_values_of_the_criteria() {
    let rows = crooked(&[9, 7, 6]);
    let reduced = Reduced::new(rows.clone());
    let (all, n) = (all(&rows), 22.0_f64);
    let order = reduced.path(&reduced.runs()).order;
    assert_eq!(order.len(), 4);
    let variance = dense(&all, &[0, 1, 2, 3]).1 / 18.0;
    for (criterion, each) in [
        (Criterion::WhitePse, reduced.response_variance()),
        (Criterion::Pse, 2.0 * variance),
        (Criterion::Bic, n.ln() * variance),
    ] {
        let (chosen, values) = reduced.choose(criterion).expect("chooses");
        assert_eq!(values.len(), 5);
        let best = (0..5).min_by(|a, b| values[*a].total_cmp(&values[*b])).expect("five");
        assert_eq!(chosen.len(), best);
        for (k, value) in values.into_iter().enumerate() {
            close(value, (dense(&all, &order[..k]).1 + each * k as f64) / n);
        }
    }
    for (k, value) in reduced.choose(Criterion::Press).expect("chooses").1.into_iter().enumerate() {
        close(value, reduced.press(&order[..k]).expect("its own") / n);
    }
    let mut sums = vec![0.0; 5];
    for out in 0..3 {
        let others: Vec<&SelectionRows> = (0..3).filter(|r| *r != out).map(|r| &rows[r]).collect();
        let order = reduced.path(&(0..3).filter(|r| *r != out).collect::<Vec<_>>()).order;
        for (k, sum) in sums.iter_mut().enumerate() {
            let b = dense(&others, &order[..k]).0;
            let r = &rows[out];
            let predicted = |i: usize| order[..k].iter().zip(b.iter()).map(|(c, b)| r.x[(i, *c)] * b).sum::<f64>();
            *sum += (0..r.y.len()).map(|i| (r.y[i] - predicted(i)).powi(2)).sum::<f64>();
        }
    }
    for (value, sum) in reduced.choose(Criterion::CrossValidation).expect("three runs").1.into_iter().zip(sums) {
        close(value, sum / n);
    }
}

/// The best of all subsets by trying them densely, one column being in anyway, at prices from nothing to all.
#[test]
fn exact_best_subset() {
    let rows = crooked(&[9, 7]);
    let (reduced, all) = (Reduced::new(rows.clone()), all(&rows));
    let (variance, mut sizes) = (2.7, Vec::new());
    for penalty in [0.0, 0.3, 1.1, 2.0, 4.0, 9.0, 20.0, 300.0] {
        let value = |set: &Vec<usize>| dense(&all, &[&[2], set.as_slice()].concat()).1 / variance + penalty * set.len() as f64;
        let sets = (0..8).map(|s| [0, 1, 3].into_iter().enumerate().filter(|(k, _)| (s >> k) & 1 == 1).map(|(_, c)| c).collect());
        let best = sets.min_by(|a, b| value(a).total_cmp(&value(b))).expect("eight");
        assert_eq!(reduced.subset(&[0, 1], &[2], &[0, 1, 3], variance, penalty), Some(best.clone()), "{penalty}");
        sizes.push(best.len());
    }
    sizes.dedup();
    assert_eq!(sizes, [3, 1, 0], "prices between which they differ");
}

/// A second column of length 100 that is the first but for 1e-6 of it is one of its own from there on, in all three ways of asking.
#[test]
fn exact_column_of_its_own() {
    for (part, own) in [(0.9e-6, false), (1.1e-6, true)] {
        let run = |second: [f64; 3]| {
            let x = DMatrix::from_columns(&[DVector::from_vec(vec![100.0, 0.0, 0.0]), DVector::from_row_slice(&second)]);
            SelectionRows { x, y: DVector::from_vec(vec![1.0, 5.0, 0.1]) }
        };
        let near = run([100.0, 100.0 * part, 0.0]);
        let reduced = Reduced::new(vec![near.clone()]);
        assert_eq!(reduced.solve(&[0], &[0, 1]).is_some(), own);
        let subset = reduced.subset(&[0], &[], &[0, 1], 0.01, 1.0).expect("two");
        assert_eq!(subset.len(), if own { 2 } else { 1 });
        // Of a run that does not tell the column nothing is pooled: the other alone is left, and its square over the variance.
        let reduced = Reduced::new(vec![near, run([0.0, 1e-3, 0.0])]);
        let (b, _, bread) = dense(&all(&reduced.rows), &[0, 1]);
        let alone = b[1] * b[1] / bread[(1, 1)];
        let found = reduced.agreement(&[0], 1, 1.0).expect("told");
        assert_eq!((found / alone - 1.0).abs() < 1e-6, !own, "{found} {alone}");
    }
}

/// Random effects after DerSimonian and Laird (1986): weights 1/variance of each run, their Q about the mean, between runs
/// `(Q − (k − 1))/(Σw − Σw²/Σw)`, pooled with `1/(1/w + between)`. With rows of other columns the regression over all runs is another
/// estimate; the smaller square counts, its own variance grown as the pooled one's. Where nothing lies between the runs, that is all.
#[test]
fn exact_agreement_by_random_effects() {
    let (mut smaller, mut larger, mut nothing) = (0, 0, 0);
    for (variance, column, chosen) in
        [(0.3, 1, vec![0, 1]), (0.9, 1, vec![0, 1, 3]), (40.0, 1, vec![1, 3]), (0.2, 0, vec![0, 2]), (0.1, 3, vec![3])]
    {
        let rows = crooked(&[9, 7, 6]);
        let reduced = Reduced::new(rows.clone());
        let last: Vec<usize> = chosen.iter().copied().filter(|c| *c != column).chain([column]).collect();
        let n = last.len() - 1;
        let each: Vec<(f64, f64)> =
            rows.iter().map(|r| dense(&[r], &last)).map(|(b, _, bread)| (b[n], bread[(n, n)] * variance)).collect();
        let w: Vec<f64> = each.iter().map(|e| 1.0 / e.1).collect();
        let total: f64 = w.iter().sum();
        let mean = each.iter().zip(&w).map(|(e, w)| e.0 * w).sum::<f64>() / total;
        let q: f64 = each.iter().zip(&w).map(|(e, w)| w * (e.0 - mean) * (e.0 - mean)).sum();
        let between = ((q - 2.0) / (total - w.iter().map(|w| w * w).sum::<f64>() / total)).max(0.0);
        let sum: f64 = each.iter().map(|e| 1.0 / (e.1 + between)).sum();
        let pooled = each.iter().map(|e| e.0 / (e.1 + between)).sum::<f64>() / sum;
        let (b, _, bread) = dense(&all(&rows), &last);
        let together = b[n] * b[n] / (bread[(n, n)] * variance * total / sum);
        let apart = pooled * pooled * sum;
        let expected = if between > 0.0 { together.min(apart) } else { together };
        close(reduced.agreement(&chosen, column, variance).expect("told"), expected);
        let seen = if between <= 0.0 {
            &mut nothing
        } else if together < apart {
            &mut smaller
        } else {
            &mut larger
        };
        *seen += 1;
    }
    assert!(smaller > 0 && larger > 0 && nothing > 0, "{smaller} {larger} {nothing}");
}

/// The first column is nearly the sum of the others, and so is the response: it enters first, the second after it, and the third where its
/// partial F, with the variance that it leaves to 8 − 3 rows, exceeds the threshold; then the first has nothing more to say and leaves.
#[test]
fn exact_stepwise_on_both_sides_of_the_threshold() {
    let columns: [[f64; 8]; 3] = [
        [2.0, 3.0, 1.0, 4.0, 5.0, 1.0, -4.0, -11.0],
        [-1.0, -2.0, 0.0, 1.0, 1.0, 5.0, -3.0, -5.0],
        [1.0, 5.0, 0.0, 4.0, 4.0, -2.0, -2.0, -4.0],
    ];
    let x = DMatrix::from_columns(&columns.map(|c| DVector::from_row_slice(&c)));
    let rows = [SelectionRows { x, y: DVector::from_row_slice(&[0.0, 1.0, 1.0, 4.0, 3.0, 5.0, -6.0, -9.0]) }];
    let rss = |columns: &[usize]| dense(&all(&rows), columns).1;
    let f = (rss(&[0, 1]) - rss(&[0, 1, 2])) / (rss(&[0, 1, 2]) / 5.0);
    let reduced = Reduced::new(rows.to_vec());
    assert_eq!(reduced.stepwise(None, f * (1.0 + 1e-9)), [0, 1]);
    assert_eq!(reduced.stepwise(None, f * (1.0 - 1e-9)), [1, 2]);
}
