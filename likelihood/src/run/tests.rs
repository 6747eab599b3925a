//! likelihood tests: nodes against sums over their samples, and the start against least squares.

use super::*;
use nalgebra::{DMatrix, DVector};

/// Nodes of three samples, some not measured: their instants, density, means of times, of their squares and of channels; and the
/// start, a cubic by least squares through what was measured in the first quarter of a second, at the first node.
#[test]
fn exact_nodes_and_start() {
    let (dt, n, gas) = (0.01, 61, 287.0);
    let channel = |c: usize| (0..n).map(|i| 0.1 * c as f64 + (0.37 * (c + 1) as f64 * i as f64).sin()).collect::<Vec<f64>>();
    let record = Record {
        t_s: (0..n).map(|i| i as f64 * dt).collect(),
        position_m: [0, 1, 2].map(channel),
        attitude_rad: [3, 4, 5].map(channel),
        vw_m_s: vec![7.0; n],
        ps_pa: (0..n).map(|i| 1e5 + 30.0 * i as f64).collect(),
        ts_k: (0..n).map(|i| 290.0 + 0.1 * i as f64).collect(),
        bridged: (0..n).map(|i| i % 7 == 4 || (9..12).contains(&i)).collect(),
        ..Record::default()
    };
    // A little more than three intervals.
    let run = Prepared::new(0, "short", &record, gas, 0.032, &ChannelNoise::white(1e-3));
    assert_eq!((run.block, run.nodes.len()), (3, 20));
    for (k, node) in run.nodes.iter().enumerate() {
        let t = (3 * k + 1) as f64 * dt;
        let mean = |rows: &[usize], of: &dyn Fn(usize) -> f64| {
            rows.iter().map(|i| of(*i)).sum::<f64>() / if rows.is_empty() { 1.0 } else { rows.len() as f64 }
        };
        let all = [3 * k, 3 * k + 1, 3 * k + 2];
        let rows: Vec<usize> = all.into_iter().filter(|&i| record.is_measured(i)).collect();
        let tau = |i: usize| record.t_s[i] - t;
        let close = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-14, "{k}: {found} {expected}");
        close(node.t_s, t);
        close(node.density_kg_m3, mean(&all, &|i| record.ps_pa[i] / (gas * record.ts_k[i])));
        close(node.pose.count, rows.len() as f64);
        close(node.pose.tau_s, mean(&rows, &tau));
        close(node.pose.tau2_s2, mean(&rows, &|i| tau(i).powi(2)));
        (0..POSE).for_each(|c| close(node.y[c], mean(&rows, &|i| record.channels()[c][i])));
    }
    // 0.25 s are 25 samples; powers of the time from the first node, by the normal equations.
    let rows: Vec<usize> = (0..25).filter(|&i| record.is_measured(i)).collect();
    let a = DMatrix::from_fn(rows.len(), 4, |r, c| (record.t_s[rows[r]] - dt).powi([0, 1, 2, 3][c]));
    for (c, start) in run.start.iter().enumerate() {
        let y = DVector::from_fn(rows.len(), |r, _| record.channels()[c][rows[r]]);
        let p = (a.transpose() * &a).lu().solve(&(a.transpose() * y)).expect("enough samples");
        // The normal equations' condition, some 1e9, times rounding.
        assert!((start[0] - p[0]).abs() < 1e-6 && (start[1] - p[1]).abs() < 1e-5, "{c}: {start:?} {p}");
    }
}
