//! verify: random inputs seen in tunnel runs. In: a run and a plant with gusts or shedding. Out: their cross-spectra in the
//! residual for the likelihood, and draws of what they leave there.

use super::super::evidence::{BIN, Cov, Residual};
use super::loads::{load_coefficients, motion, still};
use super::prepare::Prepared;
use super::spectrum::real_form;
use nalgebra::{Complex, Matrix6, SVector};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;
use realfft::{ComplexToReal, RealFftPlanner};
use windfall_model::frames::Vec3;
use windfall_model::{AirState, Disturbance, Entry, Plant};
use windfall_pid::states::{State, states};

/// Seed of draws, apart from the copies'.
const SEED: u64 = 0x6775_7374;
/// A drawn input repeats after this many lengths of a run, so that its ends do not know of each other.
const PERIODS: usize = 2;

/// Cross-spectra that random inputs leave in a run: the squared gain of the balance to each input, averaged along the run,
/// times the input's density.
pub(super) fn spectra(run: &Prepared, plant: &Plant) -> Vec<Cov> {
    let mut out = vec![Cov::zeros(); run.bins];
    let Some(inputs) = Inputs::new(run, plant, 4) else { return out };
    for (d, gains) in &inputs.each {
        let (mut steady, mut rate, mut cross) = (Matrix6::zeros(), Matrix6::zeros(), Matrix6::zeros());
        for (g, h) in gains {
            let n = gains.len() as f64;
            steady += g * g.transpose() / n;
            rate += h * h.transpose() / n;
            cross += (h * g.transpose() - g * h.transpose()) / n;
        }
        for (k, m) in out.iter_mut().enumerate() {
            let w = run.omega(k);
            // (G + iωH)(G + iωH)ᴴ
            let s = (steady + rate * (w * w)).zip_map(&(cross * w), Complex::new);
            *m += real_form(&s) * d.density(w);
        }
    }
    out
}

/// Draws of what random inputs leave in a run, each with the gain of its moment (an axial gust weighs by the angle, so that it
/// acts where the angle is large): sums of sinusoids with normal amplitudes (Shinozuka and Jan, J. Sound Vib. 25, 1972).
pub(super) fn draws(run: &Prepared, plant: &Plant, count: usize) -> Vec<Residual> {
    let Some(inputs) = Inputs::new(run, plant, 1) else { return vec![vec![0.0; run.bins * BIN]; count] };
    let inverse = RealFftPlanner::new().plan_fft_inverse(PERIODS * run.states.len());
    (0..count)
        .into_par_iter()
        .map(|c| {
            let mut series = vec![[0.0; 6]; run.states.len()];
            for (i, (d, gains)) in inputs.each.iter().enumerate() {
                let mut rng = ChaCha8Rng::seed_from_u64(SEED);
                rng.set_stream((run.index as u64) << 32 | (c as u64) << 8 | i as u64);
                let (value, rate) = input(d, inverse.as_ref(), run.duration_s, &mut rng);
                for ((s, (g, h)), (x, v)) in series.iter_mut().zip(gains).zip(value.iter().zip(&rate)) {
                    s.iter_mut().zip((g * *x + h * *v).iter()).for_each(|(s, y)| *s += y);
                }
            }
            run.project.project(&series)
        })
        .collect()
}

/// A draw of an input and its rate at the samples of a run.
fn input(d: &Disturbance, inverse: &dyn ComplexToReal<f64>, duration_s: f64, rng: &mut ChaCha8Rng) -> (Vec<f64>, Vec<f64>) {
    let step = std::f64::consts::TAU / (PERIODS as f64 * duration_s);
    let (mut value, mut rate) = (inverse.make_input_vec(), inverse.make_input_vec());
    let mut normal = || -> f64 { StandardNormal.sample(rng) };
    value[0] = Complex::new(normal() * (0.5 * d.density(0.0) * step).sqrt(), 0.0);
    // The last frequency, whose imaginary part has no meaning, stays zero.
    for k in 1..value.len() - 1 {
        let w = step * k as f64;
        let amplitude = Complex::new(normal(), normal()) * (0.5 * (d.density(w) * step).sqrt());
        value[k] = amplitude;
        rate[k] = amplitude * Complex::new(0.0, w);
    }
    let to_time = |mut x: Vec<Complex<f64>>| {
        let mut y = inverse.make_output_vec();
        if inverse.process(&mut x, &mut y).is_err() {
            y.fill(f64::NAN);
        }
        y.truncate(inverse.len() / PERIODS);
        y
    };
    (to_time(value), to_time(rate))
}

/// Change of the six coefficients per unit of an input, and per unit of its rate.
type Gains = (SVector<f64, 6>, SVector<f64, 6>);

/// The random inputs of a plant in a run, each with its gains along the run.
struct Inputs {
    each: Vec<(Disturbance, Vec<Gains>)>,
}

impl Inputs {
    /// Gains at every `stride`-th state; `None` when the plant gives no states or has no random input.
    fn new(run: &Prepared, plant: &Plant, stride: usize) -> Option<Self> {
        let own = plant.for_run(run.index, &run.inputs);
        if own.disturbances(1.0).is_empty() {
            return None;
        }
        let all = states(run.data(), &own).ok()?;
        let some: Vec<&State> = all.iter().step_by(stride).collect();
        let speed = some.iter().map(|s| s.speed).sum::<f64>() / some.len() as f64;
        let along = |d: Disturbance| (d, some.iter().map(|s| gains(s, &own, d.entry)).collect());
        Some(Self { each: own.disturbances(speed).into_iter().map(along).collect() })
    }
}

/// Change of the six coefficients at the origin per unit of a random input, and per unit of its rate.
fn gains(s: &State, plant: &Plant, entry: Entry) -> Gains {
    let axis = match entry {
        Entry::Coefficient(i) => {
            let mut g = SVector::<f64, 6>::zeros();
            g[i] = 1.0;
            return (g, SVector::zeros());
        }
        Entry::AirVelocity(axis) => axis,
    };
    let (motion, still) = (motion(s), still(s));
    let unit = |x: f64| {
        let mut v = [0.0; 3];
        v[axis] = x;
        Vec3::from_array(v)
    };
    let coefficients = |air: &AirState| load_coefficients(&plant.wrench(&motion, air), s.q_pa, plant);
    let h = 1e-3;
    let base = coefficients(&still);
    (
        (coefficients(&AirState { gust: unit(h), ..still }) - base) / h,
        (coefficients(&AirState { gust_rate: unit(h), ..still }) - base) / h,
    )
}
