//! likelihood tests: a node taken channel by channel against the update of all its channels at once.

use super::super::dense::slopes;
use super::super::tests::{noise, numbers, plant, run, state};
use super::super::{Keep, NodeInnovations, PassSetting, Stage, ready};
use super::*;
use crate::columns::{Basis, SensitivityColumn};
use crate::run::Mean;
use crate::shock::{Taken, Trace};
use nalgebra::{DMatrix, DVector};
use windfall_model::Drift;

/// `K = P Hᵀ Σ⁻¹` of all channels at once (Anderson and Moore 1979, §3.1), H by central differences: state, covariance and sensitivities after
/// a node of a model with every kind of state; innovations and their variances one after another are those of Cholesky's factor of Σ. Slopes
/// are good to 1e-10.
#[test]
fn exact_update_of_all_channels_at_once() {
    let (mut plant, noise, mut run) = (plant(), noise(), run());
    plant.drift = Drift { position_rms_m: [0.003, 0.004, 0.002], attitude_rms_rad: [0.002; 3], speed_rms_m_s: 0.05 };
    let (k, mut next) = (6, numbers(2));
    run.nodes[k].pose = Mean { count: 2.0, tau_s: 1.3e-3, tau2_s2: 2e-5 };
    run.nodes[k].t_s = 0.7;
    run.nodes[k].y = std::array::from_fn(|c| [0.1, 0.2, -0.1, 0.4, 0.25, -0.3][c] + 0.1 * next());
    let mut longer = plant.clone();
    longer.sensors.length_scale += 0.02;
    let columns = [
        SensitivityColumn::Generic(Site::Channel(2), Basis::Height(1)),
        SensitivityColumn::Plant(Box::new(longer.clone()), 0.03),
        SensitivityColumn::Declared(1),
        SensitivityColumn::Generic(Site::Channel(4), Basis::Roll(2, true)),
        SensitivityColumn::Generic(Site::Load(4), Basis::Run(0)),
    ];
    let setting = PassSetting { columns: &columns, keep: Keep::Trace, ..PassSetting::plain(&plant, &noise) };
    let f = Filter::new(&run, &setting).expect("a whole model");
    let ready: Vec<Ready<'_>> = columns.iter().map(|c| ready(c, &plant).expect("a column")).collect();
    let (n, states, nc, many) = (f.n, f.states, f.nc, columns.len());
    let mut work = Work::new(&f);
    let z = state(&f, &mut next);
    let view = f.view(&z, k);
    let rate = f.rates(&z, k, Stage::Now, [0.0; 3], &mut work.terms).expect("a state that flies");
    let root = DMatrix::from_fn(n, states, |i, _| if i < states { 0.03 * next() } else { 0.0 });
    let p = &root * root.transpose();
    let s = DMatrix::from_fn(n, nc, |i, j| if i < states && j < many { next() } else { 0.0 });
    let drifts: Vec<(usize, usize)> = f
        .inputs()
        .filter_map(|(at, input)| if let Entry::RecordedPose(channel) = input.entry { Some((channel, at)) } else { None })
        .collect();
    assert_eq!(drifts.len(), POSE);
    let seen_at = |plant: &windfall_model::Plant, z: &[f64]| {
        let mut y = DVector::from_column_slice(&f.shown(plant, z, &rate, k));
        drifts.iter().for_each(|(channel, at)| y[*channel] += z[*at]);
        // The means of coloured noise, which lie before their last samples at the states' end.
        (y[1], y[4]) = (y[1] + z[states - 4], y[4] + z[states - 2]);
        y
    };
    let h = slopes(&z, |z| seen_at(&plant, z));
    let left = DVector::from_column_slice(&run.nodes[k].y) - seen_at(&plant, &z);
    let mut at_once = DMatrix::zeros(POSE, nc);
    at_once[(2, 0)] = z[0] / 0.3;
    at_once.set_column(1, &((seen_at(&longer, &z) - seen_at(&plant, &z)) / 0.03));
    at_once[(4, 3)] = (2.0 * z[3]).sin();
    let d = &h * &s + at_once;
    let white = DMatrix::from_diagonal(&DVector::from_fn(POSE, |c, _| noise[c].white / 2.0));
    let covariance = &h * &p * h.transpose() + white;
    let factor = covariance.clone().cholesky().expect("a covariance");
    let gain = &p * h.transpose() * factor.inverse();
    let l = factor.l();
    let whiten = |m: &DMatrix<f64>| l.solve_lower_triangular(m).expect("a factor");
    let w = whiten(&DMatrix::from_column_slice(POSE, 1, left.as_slice()));
    let columns_seen = whiten(&d);
    let with_states = whiten(&(&h * &p));

    let mut seen = Seen {
        g: DMatrix::zeros(0, 0),
        b: DVector::zeros(0),
        log_likelihood: 0.9,
        channels: std::array::from_fn(|_| std::array::from_fn(|_| next())),
        innovations: NodeInnovations::default(),
        beside: Vec::new(),
        rows: Vec::new(),
        views: Vec::new(),
        numbers: Vec::new(),
        trace: Trace { nodes: vec![Taken::default()] },
        states: n,
    };
    let before = seen.channels;
    let (mut z_after, mut rows) = (z.clone(), Vec::new());
    let of = |m: &DMatrix<f64>| m.transpose().as_slice().to_vec();
    let (mut p_after, mut s_after) = (of(&p), of(&s));
    f.update(k, &mut z_after, &mut p_after, &mut s_after, &rate, &ready, &view, &mut seen, &mut rows, &mut [], &mut work);

    let near = |found: &[f64], expected: &[f64], what: &str| {
        assert_eq!(found.len(), expected.len(), "{what}");
        for (i, (a, b)) in found.iter().zip(expected).enumerate() {
            assert!((a - b).abs() < 1e-8, "{what} {i}: {a} for {b}");
        }
    };
    near(&z_after, (DVector::from_column_slice(&z) + &gain * &left).as_slice(), "state");
    near(&p_after, &of(&(&p - &gain * &h * &p)), "covariance");
    near(&s_after, &of(&(&s - &gain * &d)), "sensitivities");
    let log_likelihood = -0.5 * w.norm_squared() - l.diagonal().map(f64::ln).sum();
    near(&[seen.log_likelihood, seen.innovations.nodes[0]], &[0.9 + log_likelihood, log_likelihood], "likelihood");
    for c in 0..POSE {
        let (root, w) = (l[(c, c)], w[c]);
        let row: Vec<f64> = columns_seen.row(c).iter().take(many).copied().collect();
        near(&rows[c * (many + 1)..][..=many], &[&row[..], &[w]].concat(), "row");
        near(&[seen.innovations.whitened[0][c], seen.innovations.variances[0][c]], &[w, root * root], "innovation");
        let sums = [w * root * w * root, root * root, w * w, 1.0];
        near(&seen.channels[c], &std::array::from_fn::<f64, 4, _>(|i| before[c][i] + sums[i]), "sums");
        let taken = &seen.trace.nodes[0].channels[c];
        near(&taken.slope, &h.row(c).iter().copied().collect::<Vec<_>>(), "slope");
        near(&taken.covariance, (with_states.row(c) * root).transpose().as_slice(), "covariance with the states");
        near(&taken.columns, &row.iter().map(|x| x * root).collect::<Vec<_>>(), "slopes by columns");
        near(&[taken.value, taken.variance], &[w * root, root * root], "taken");
    }
    assert_eq!(rows.len(), POSE * (many + 1));
}
