//! likelihood: the filter against the Gaussian likelihood written out. Tests only: one covariance matrix of all measurements of a short
//! run, from slopes of the flown motion by central differences at steps four times as fine, without a single update.

use super::{Filter, PassSetting, Ready, Work};
use crate::noise::ChannelNoise;
use crate::run::Prepared;
use nalgebra::{DMatrix, DVector};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use windfall_model::{CATALOGUE, POSE, PerChannel, Plant, Record};

/// Nodes, and their distance, s.
const NODES: usize = 30;
const STEP_S: f64 = 1.0 / 75.0;
/// Steps of the written-out likelihood within a step of the filter.
const FINER: usize = 4;

/// A model aslant and at rest in the stream, as a record that is replaced later.
fn record(interval_s: f64, n: usize) -> Record {
    Record {
        t_s: (0..n).map(|i| i as f64 * interval_s).collect(),
        position_m: [vec![0.1; n], vec![0.2; n], vec![-0.1; n]],
        attitude_rad: [vec![0.4; n], vec![0.15; n], vec![-0.1; n]],
        vw_m_s: vec![7.0; n],
        ps_pa: vec![101_325.0; n],
        ts_k: vec![299.0; n],
        ..Record::default()
    }
}

fn prepared(interval_s: f64, n: usize) -> Prepared {
    Prepared::new(0, "short", &record(interval_s, n), 287.05, interval_s, &ChannelNoise::white(1e-5))
}

/// What the pose shows at a state.
fn seen(f: &Filter<'_>, z: &[f64], k: usize) -> DVector<f64> {
    let mut terms = Vec::new();
    let rate = f.rates(z, k, super::Stage::Now, [0.0; 3], &mut terms).expect("a state that flies");
    DVector::from_column_slice(&f.shown(f.plant, z, &rate, k))
}

/// The state a step later, and the noise that the step adds.
fn stepped(f: &Filter<'_>, z: &[f64], k: usize) -> (Vec<f64>, DMatrix<f64>) {
    let (n, mut work, mut next) = (f.n, Work::new(f), z.to_vec());
    let view = f.view(z, k);
    let mut no_columns: Vec<Ready<'_>> = Vec::new();
    f.predict(k, &mut next, &mut vec![0.0; n * n], &mut Vec::new(), &mut no_columns, &view, &mut [], &mut work)
        .expect("a state that flies");
    (next, DMatrix::from_fn(n, n, |i, j| work.q[i.max(j) * n + i.min(j)]))
}

/// Slopes of `of` at `z` by central differences.
pub(super) fn slopes(z: &[f64], of: impl Fn(&[f64]) -> DVector<f64>) -> DMatrix<f64> {
    const SMALL: f64 = 1e-5;
    let columns: Vec<DVector<f64>> = (0..z.len())
        .map(|i| {
            let at = |by: f64| {
                let mut moved = z.to_vec();
                moved[i] += by;
                of(&moved)
            };
            (at(SMALL) - at(-SMALL)) / (2.0 * SMALL)
        })
        .collect();
    DMatrix::from_columns(&columns)
}

/// Mean of all measurements, what an uncertain start adds to their covariance, and what gusts and instruments do.
fn written_out(plant: &Plant, noise: &PerChannel<ChannelNoise>) -> (DVector<f64>, DMatrix<f64>, DMatrix<f64>) {
    let run = prepared(STEP_S / FINER as f64, NODES * FINER);
    let f = Filter::new(&run, &PassSetting::plain(plant, noise)).expect("a whole model");
    let (mut z, p) = (f.start(), f.start_covariance(&f.random));
    let n = f.n;
    let is_motion = |i: usize| i < f.nm;
    let from = |keep: &dyn Fn(usize) -> bool| DMatrix::from_fn(n, n, |i, j| if keep(i) && keep(j) { p[i * n + j] } else { 0.0 });
    // Sources of randomness one by one: their covariance, and what they do to the state now.
    let mut sources =
        vec![(from(&|i| is_motion(i)), DMatrix::identity(n, n)), (from(&|i| !is_motion(i)), DMatrix::identity(n, n))];
    let mut mean = DVector::zeros(NODES * POSE);
    let mut done: Vec<DMatrix<f64>> = vec![DMatrix::zeros(NODES * POSE, n); sources.len()];
    for k in 0..NODES * FINER {
        if k % FINER == 0 {
            let row = k / FINER * POSE;
            mean.rows_mut(row, POSE).copy_from(&seen(&f, &z, k));
            let h = slopes(&z, |z| seen(&f, z, k));
            done.iter_mut().zip(&sources).for_each(|(d, (_, phi))| d.rows_mut(row, POSE).copy_from(&(&h * phi)));
        }
        let phi = slopes(&z, |z| DVector::from_vec(stepped(&f, z, k).0));
        let (next, q) = stepped(&f, &z, k);
        sources.iter_mut().for_each(|(_, before)| *before = &phi * &*before);
        sources.push((q, DMatrix::identity(n, n)));
        done.push(DMatrix::zeros(NODES * POSE, n));
        z = next;
    }
    let all: Vec<DMatrix<f64>> = done.iter().zip(&sources).map(|(d, (q, _))| d * q * d.transpose()).collect();
    let white = DMatrix::from_diagonal(&DVector::from_fn(NODES * POSE, |i, _| noise[i % POSE].white));
    (mean, all[0].clone(), all[1..].iter().sum::<DMatrix<f64>>() + white)
}

/// Gusts too weak to bend the motion's slopes (0.2 m/s differ by 0.23 nats), of both forms: the filter's log-likelihood of measurements drawn
/// from the matrix is that of the matrix, and so is what a wrong size of the gusts costs.
#[test]
fn exact_against_one_gaussian() {
    let file = windfall_scenarios::read_bundled("sage-unperturbed").expect("a bundled scenario");
    let turbulence = CATALOGUE.iter().find(|e| e.family == "turbulence").expect("an effect of the catalogue");
    let noise: PerChannel<ChannelNoise> = [7.5e-4, 7.5e-4, 7.5e-4, 1.1e-3, 1.9e-3, 1.9e-3, 1e-5].map(ChannelNoise::white);
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    for bandwidth in [0.0, 1.5] {
        let mut differences = Vec::new();
        let mut drawn: Option<DVector<f64>> = None;
        for size in [0.02, 0.05] {
            let mut plant = file.declared_plant.clone();
            (turbulence.apply)(&mut plant, &[size, size, 0.4, 0.4, bandwidth]);
            let (mean, of_start, rest) = written_out(&plant, &noise);
            let y = drawn.get_or_insert_with(|| {
                let root = rest.clone().cholesky().expect("a covariance").l();
                &mean + root * DVector::from_fn(NODES * POSE, |_, _| StandardNormal.sample(&mut rng))
            });
            let factor = (of_start + rest).cholesky().expect("a covariance");
            let left = &*y - mean;
            let dense = -0.5 * left.dot(&factor.solve(&left)) - factor.l().diagonal().map(f64::ln).sum();
            let mut run = prepared(STEP_S, NODES);
            run.nodes
                .iter_mut()
                .enumerate()
                .for_each(|(k, node)| node.y.copy_from_slice(&y.as_slice()[k * POSE..(k + 1) * POSE]));
            let filter = super::pass(&run, &PassSetting::plain(&plant, &noise)).expect("a pass").log_likelihood;
            differences.push(filter - dense);
        }
        assert!(differences.iter().all(|d| d.abs() < 0.05), "{differences:?}");
    }
}
