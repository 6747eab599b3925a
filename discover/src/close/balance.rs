//! discover: what the balance of forces and moments leaves in tunnel runs. In: a campaign's runs and a plant. Out: residual coefficients over
//! time, beside what they may vary with; their spectra; the level of noise in them.

use super::Options;
use crate::DiscoverError;
use crate::residual::LeadTable;
use rand::SeedableRng as _;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;
use realfft::RealFftPlanner;
use windfall_model::{Campaign, Data, Plant, Record, Sensors, Variable};
use windfall_pid::coefficients::{CoefficientRow, coefficients};
use windfall_pid::smooth::{Smoothed, Smoother, smooth};
use windfall_pid::states::states;
use windfall_replay::ReplayError;

/// Noisy copies for the level of noise.
const COPIES: u64 = 4;
/// Frequency bands of a spectrum.
const BANDS: usize = 40;
/// Keeps the streams of copies apart from those of a simulator with the same seed: noise that a record has already is no copy.
const STREAM: u64 = 0x636f_7069_6573_0000;

/// Six residual coefficients over a run.
type Left = Vec<[f64; 6]>;

/// Tunnel runs made ready.
pub(super) struct BalanceResidual<'a> {
    campaign: &'a Campaign,
    runs: Vec<Ready>,
}

struct Ready {
    index: usize,
    smoothed: Smoothed,
    /// The record with its noise added once more, smoothed alike.
    copies: Vec<Smoothed>,
}

/// Power of a coefficient's residual in bands of frequency: mean frequency (Hz) and one-sided density (1/Hz).
pub(super) type BandPowers = Vec<(f64, f64)>;

impl<'a> BalanceResidual<'a> {
    /// Smooths the campaign's runs of these indices.
    ///
    /// # Errors
    /// Point masses; runs that cannot be smoothed.
    pub(super) fn new(campaign: &'a Campaign, indices: &[usize], options: &Options) -> Result<Self, DiscoverError> {
        let one = |&index: &usize| -> Result<Ready, DiscoverError> {
            let run = &campaign.runs[index];
            let Data::Tunnel(record) = &run.data else { return Err(ReplayError::NotTunnel { run: run.name.clone() }.into()) };
            let smoothed = smooth(record, &Smoother::Auto)?;
            let alike = Smoother::Spline { knot_s: 0.5 / smoothed.bandwidth_hz[0] };
            let seed = |copy: u64| (options.seed ^ STREAM, (index as u64) << 32 | copy << 8);
            let copies = (1..=COPIES).map(|c| Ok(smooth(&noisy(record, &campaign.plant.sensors, seed(c)), &alike)?));
            let copies = copies.collect::<Result<Vec<_>, DiscoverError>>()?;
            Ok(Ready { index, smoothed, copies })
        };
        Ok(Self { campaign, runs: indices.par_iter().map(one).collect::<Result<_, _>>()? })
    }

    /// What a plant leaves of a smoothed run; nothing where it gives no states.
    fn left(&self, index: usize, smoothed: &Smoothed, plant: &Plant) -> Left {
        let own = self.campaign.plant_for(plant, index);
        let Ok(states) = states(smoothed, &own) else { return Vec::new() };
        coefficients(&states, &own).iter().map(|row| beyond(row, &own)).collect()
    }

    /// Residuals of all runs in a row beside time, place and the flow's variables.
    pub(super) fn lead_table(&self, plant: &Plant) -> LeadTable {
        let names = ["time in the run (s)", "X (m)", "Y (m)", "Z (m)", "distance from the axis (m)"];
        let names = Variable::ALL.iter().map(|v| v.name()).chain(names);
        let mut table =
            LeadTable { residuals: vec![Vec::new(); 6], variables: names.map(|n| (n.to_owned(), Vec::new())).collect() };
        for run in &self.runs {
            let own = self.campaign.plant_for(plant, run.index);
            let Ok(states) = states(&run.smoothed, &own) else { continue };
            for (state, row) in states.iter().zip(coefficients(&states, &own)) {
                table.residuals.iter_mut().zip(beyond(&row, &own)).for_each(|(series, r)| series.push(r));
                let [x, y, z] = state.p_tunnel_origin;
                let values = row.flow.values.into_iter().chain([row.t_s, x, y, z, y.hypot(z)]);
                table.variables.iter_mut().zip(values).for_each(|((_, s), v)| s.push(v));
            }
        }
        table
    }

    /// Highest frequency that smoothing leaves in every run, Hz.
    pub(super) fn top_hz(&self) -> f64 {
        self.runs.iter().map(|r| r.smoothed.bandwidth_hz[0]).fold(f64::INFINITY, f64::min)
    }

    /// Spectra of the six residuals under a plant, runs joined.
    pub(super) fn spectra(&self, plant: &Plant) -> [BandPowers; 6] {
        let all = self.runs.par_iter().map(|r| (self.left(r.index, &r.smoothed, plant), r.smoothed.interval_s));
        banded(&all.collect::<Vec<_>>(), self.top_hz())
    }

    /// Spectra that the sensors' noise leaves under a plant: of what each copy adds.
    pub(super) fn noise(&self, plant: &Plant) -> [BandPowers; 6] {
        let added = |r: &Ready| -> Vec<(Left, f64)> {
            let own = self.left(r.index, &r.smoothed, plant);
            let minus = |c: Left| c.iter().zip(&own).map(|(a, b)| std::array::from_fn(|i| a[i] - b[i])).collect();
            r.copies.iter().map(|c| (minus(self.left(r.index, c, plant)), r.smoothed.interval_s)).collect()
        };
        let all: Vec<Vec<(Left, f64)>> = self.runs.par_iter().map(added).collect();
        banded(&all.concat(), self.top_hz())
    }
}

/// Periodograms under a sine taper up to a frequency (Hz), averaged over bands and over series with their intervals (s).
fn banded(series: &[(Left, f64)], top: f64) -> [BandPowers; 6] {
    let mut sums = [[(0.0, 0.0, 0.0); BANDS]; 6];
    let mut planner = RealFftPlanner::new();
    for (left, dt) in series.iter().filter(|(l, _)| l.len() > 1) {
        let n = left.len();
        let taper: Vec<f64> = (0..n).map(|i| (std::f64::consts::PI * (i as f64 + 0.5) / n as f64).sin()).collect();
        let power: f64 = taper.iter().map(|w| w * w).sum();
        let fft = planner.plan_fft_forward(n);
        let (mut input, mut output) = (fft.make_input_vec(), fft.make_output_vec());
        for (c, sums) in sums.iter_mut().enumerate() {
            input.iter_mut().zip(left).zip(&taper).for_each(|((x, l), w)| *x = l[c] * w);
            if fft.process(&mut input, &mut output).is_err() {
                continue;
            }
            for (k, z) in output.iter().enumerate().skip(1) {
                let f = k as f64 / (n as f64 * dt);
                if f > top {
                    break;
                }
                let b = (0..BANDS).rev().find(|b| f >= top * *b as f64 / BANDS as f64).unwrap_or(0);
                let s = &mut sums[b];
                *s = (s.0 + f, s.1 + 2.0 * dt * z.norm_sqr() / power, s.2 + 1.0);
            }
        }
    }
    sums.map(|bands| bands.iter().filter(|s| s.2 > 0.0).map(|s| (s.0 / s.2, s.1 / s.2)).collect())
}

/// Coefficients about the origin beyond the plant's.
fn beyond(row: &CoefficientRow, plant: &Plant) -> [f64; 6] {
    let c = plant.aero.coefficients(&row.flow);
    std::array::from_fn(|i| row.exp_origin[i] - c[i])
}

/// A record with sensor noise added.
fn noisy(record: &Record, sensors: &Sensors, (seed, stream): (u64, u64)) -> Record {
    let (p, r, a, w) = (sensors.position_std_m, sensors.roll_std_rad, sensors.pitch_yaw_std_rad, sensors.wind_std_m_s);
    let mut copy = record.clone();
    let [x, y, z] = &mut copy.position_m;
    let [rx, ry, rz] = &mut copy.attitude_rad;
    let channels = [(x, p), (y, p), (z, p), (rx, r), (ry, a), (rz, a), (&mut copy.vw_m_s, w)];
    for (c, (series, std)) in (0_u64..).zip(channels) {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(stream | c);
        series.iter_mut().for_each(|v| *v += std * Distribution::<f64>::sample(&StandardNormal, &mut rng));
    }
    copy
}

#[cfg(test)]
mod tests;
