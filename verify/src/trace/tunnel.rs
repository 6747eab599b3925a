//! verify: evidence from tunnel runs. In: records and the declared plant. Out: residual coefficients per frequency.
//!
//! The residual of the six force and moment balances in coefficient form is projected on sinusoids under a taper that rises
//! quickly at both ends, up to [`BAND_HZ`]. What the motion needs (accelerations) comes from a narrow window, flat over
//! the band; everything that a plant predicts comes from a wide window, so that little sensor noise reaches it. What noise
//! leaves in a bin, and what it does through the predictions, is measured on copies: the data smoothed, and noise added again.

use super::evidence::{BIN, Cov, Evidence, LeadTable, Residual};
use super::fit::Fit;
use crate::VerifyError;
use crate::close::ChannelResidual;
use nalgebra::{Complex, SMatrix, SVector};
use rayon::prelude::*;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};
use std::sync::RwLock;
use windfall_model::{Campaign, Coefficient, Data, Plant, Variable};
use windfall_pid::coefficients::{Row, coefficients};
use windfall_pid::states::states;

mod closed_loop;
mod loads;
mod prepare;
mod random;
mod spectrum;

use closed_loop::{LoopMap, circular};
use loads::{Unit, load_coefficients, without_aero};
use prepare::{Prepared, Series, prepare};
use spectrum::{QUIET_S, RAMP_S, Spectrum, averaged, real_form};

/// Highest frequency used, Hz.
pub const BAND_HZ: f64 = 5.0;
/// Noise that the taper lets into low frequencies sits at its ramps; a pulse is looked for this much farther inside, s.
const BLUR_S: f64 = 0.3;
/// Copies with which fits are corrected for noise in the regressors; all of them measure noise.
const CORRECTING: usize = 8;

/// The latest plant without aerodynamics and contacts (both are added to its rows), and the rows it gives per run and series.
type Focus = (Plant, Vec<Vec<Vec<Row>>>);

/// Evidence of tunnel runs.
pub struct TunnelEvidence {
    runs: Vec<Prepared>,
    noise: Vec<Cov>,
    generic: Vec<Vec<Cov>>,
    copies: usize,
    declared: Plant,
    focus: RwLock<Option<Focus>>,
}

impl TunnelEvidence {
    /// Prepares the runs of a campaign whose indices are given, with `copies` noisy copies drawn from `seed`.
    ///
    /// # Errors
    /// Runs that are too short or whose states cannot be made under the declared plant.
    pub fn new(campaign: &Campaign, indices: &[usize], declared: &Plant, copies: usize, seed: u64) -> Result<Self, VerifyError> {
        let runs = indices
            .par_iter()
            .map(|&i| match &campaign.runs[i].data {
                Data::Tunnel(record) => prepare(record, &campaign.runs[i].inputs, i, declared, copies, seed),
                Data::Point(_) => Err(VerifyError::NotTunnel { run: campaign.runs[i].name.clone() }),
            })
            .collect::<Result<Vec<_>, _>>()?;
        let mut evidence =
            Self { runs, noise: Vec::new(), generic: Vec::new(), copies, declared: declared.clone(), focus: RwLock::new(None) };
        evidence.measure_noise(declared);
        Ok(evidence)
    }

    /// Measures what sensor noise leaves in every bin under a plant: mean over copies and neighbouring frequencies.
    pub fn measure_noise(&mut self, plant: &Plant) {
        self.focus(plant);
        let clean = self.clean(plant);
        let all: Vec<Residual> = (1..=self.copies).into_par_iter().map(|c| self.residual(plant, c)).collect();
        let mut raw = vec![Cov::zeros(); self.bins()];
        for copy in &all {
            for ((m, a), b) in raw.iter_mut().zip(copy.chunks_exact(BIN)).zip(clean.chunks_exact(BIN)) {
                let part = |from: usize| SVector::<f64, 6>::from_fn(|c, _| a[from + c] - b[from + c]);
                let z = part(0).map(|x| Complex::new(x, 0.0)) + part(6).map(|x| Complex::new(0.0, x));
                *m += real_form(&(z * z.adjoint())) / self.copies as f64;
            }
        }
        self.noise.clear();
        let mut start = 0;
        for run in &self.runs {
            // Zero frequency has a real part alone, scaled to the variance of one.
            raw[start] *= 2.0;
            self.noise.extend(averaged(&raw[start..start + run.bins]));
            start += run.bins;
        }
        let bins = self.noise.len();
        self.generic = (0..6)
            .map(|c| {
                let level = self.noise.iter().map(|m| m[(c, c)]).sum::<f64>() / bins as f64;
                let mut unit = Cov::zeros();
                unit[(c, c)] = level;
                unit[(6 + c, 6 + c)] = level;
                vec![unit; bins]
            })
            .collect();
    }

    /// Noise stays as measured; the data are now taken as free of it, so that fits are not corrected for it.
    pub fn forget_copies(&mut self) {
        self.copies = 0;
        if let Ok(mut f) = self.focus.write() {
            *f = None;
        }
    }

    fn rows(&self, plant: &Plant, run: usize, series: Series) -> Option<Vec<Row>> {
        let p = &self.runs[run];
        let own = without_aero(plant).for_run(p.index, &p.inputs);
        Some(coefficients(&states(&p.wide[series.index()], &own).ok()?, &own))
    }

    fn residual_series(&self, plant: &Plant, series: Series) -> Residual {
        (0..self.runs.len()).flat_map(|r| self.residual_run(plant, r, series)).collect()
    }

    fn residual_run(&self, plant: &Plant, run: usize, series: Series) -> Residual {
        let p = &self.runs[run];
        let focus = self.focus.read().ok();
        let bare = without_aero(plant);
        let kept = focus
            .as_deref()
            .and_then(|f| f.as_ref())
            .filter(|(known, _)| *known == bare)
            .and_then(|(_, rows)| rows[run].get(series.index()));
        let fresh;
        let rows = match kept {
            Some(rows) => rows,
            None => match self.rows(plant, run, series) {
                Some(rows) => {
                    fresh = rows;
                    &fresh
                }
                None => return vec![f64::NAN; p.bins * BIN],
            },
        };
        let unit = Unit::new(plant, &self.declared);
        let contacts: Vec<_> = plant.contacts.iter().filter(|c| c.run == p.index).collect();
        let start_s = rows.first().map_or(0.0, |r| r.t_s);
        let missing: Vec<[f64; 6]> = rows
            .iter()
            .zip(&p.q_declared_pa)
            .map(|(row, q)| {
                let mut c = plant.aero.coefficients(&row.flow);
                for contact in &contacts {
                    let load = load_coefficients(&contact.wrench(row.t_s - start_s), row.q_pa, plant);
                    c.iter_mut().zip(load.iter()).for_each(|(c, l)| *c += l);
                }
                unit.convert(std::array::from_fn(|i| row.exp_origin[i] - c[i]), row.q_pa / q)
            })
            .collect();
        let mut z = p.project.project(&missing);
        for (a, b) in z.iter_mut().zip(&p.beyond[series.index()]) {
            *a += b;
        }
        z
    }

    /// Residual series of the data in time, per run: coefficients from wide smoothing, at 25 Hz or more.
    #[must_use]
    pub fn series(&self, plant: &Plant) -> Vec<Vec<(Row, [f64; 6])>> {
        (0..self.runs.len())
            .map(|r| {
                let rows = self.rows(plant, r, Series::Data).unwrap_or_default();
                rows.into_iter()
                    .map(|row| {
                        let c = plant.aero.coefficients(&row.flow);
                        (row, std::array::from_fn(|i| row.exp_origin[i] - c[i]))
                    })
                    .collect()
            })
            .collect()
    }

    /// Frequency of every bin, Hz, and its run.
    #[must_use]
    pub fn frequencies(&self) -> Vec<(usize, f64)> {
        self.runs.iter().enumerate().flat_map(|(r, p)| (0..p.bins).map(move |k| (r, k as f64 / p.duration_s))).collect()
    }
}

impl Evidence for TunnelEvidence {
    fn bins(&self) -> usize {
        self.runs.iter().map(|r| r.bins).sum()
    }
    fn samples(&self) -> usize {
        self.bins() * BIN
    }
    fn copies(&self) -> usize {
        self.copies.min(CORRECTING)
    }
    fn noisy(&self) -> usize {
        self.copies
    }
    fn residual(&self, plant: &Plant, copy: usize) -> Residual {
        self.residual_series(plant, Series::of_copy(copy))
    }
    fn clean(&self, plant: &Plant) -> Residual {
        self.residual_series(plant, Series::Clean)
    }
    fn residual_of(&self, plant: &Plant, run: usize) -> Residual {
        let mut all = Vec::with_capacity(self.samples());
        for (r, p) in self.runs.iter().enumerate() {
            if r == run {
                all.extend(self.residual_run(plant, r, Series::Data));
            } else {
                all.extend(std::iter::repeat_n(0.0, p.bins * BIN));
            }
        }
        all
    }
    fn noise(&self) -> &[Cov] {
        &self.noise
    }
    fn generic(&self) -> &[Vec<Cov>] {
        &self.generic
    }
    fn random(&self, plant: &Plant) -> Vec<Cov> {
        let mut out = Vec::with_capacity(self.bins());
        for run in &self.runs {
            out.extend(random::spectra(run, plant));
        }
        out
    }
    fn random_draws(&self, plant: &Plant, count: usize) -> Vec<Residual> {
        let per_run: Vec<Vec<Residual>> = self.runs.iter().map(|r| random::draws(r, plant, count)).collect();
        (0..count).map(|c| per_run.iter().flat_map(|d| d[c].iter().copied()).collect()).collect()
    }
    fn closed_loop(&self, sigma: &[Cov], plant: &Plant, moved: &[(Plant, f64)]) -> Vec<f64> {
        let starts = self.runs.iter().scan(0, |at, r| {
            let start = *at;
            *at += r.bins;
            Some(start)
        });
        let runs: Vec<(&Prepared, usize)> = self.runs.iter().zip(starts).collect();
        let share = |bin: usize| circular(&(sigma[bin] - self.noise[bin]));
        let idle = (0..sigma.len()).all(|b| {
            (sigma[b] - self.noise[b]).diagonal().iter().zip(self.noise[b].diagonal().iter()).all(|(d, n)| *d < 1e-3 * n)
        });
        if idle {
            return vec![0.0; moved.len()];
        }
        let prepared: Vec<Option<(LoopMap, Vec<Spectrum>)>> = runs
            .par_iter()
            .map(|(run, start)| {
                let map = LoopMap::new(run, plant, &self.declared)?;
                let back = (0..run.bins)
                    .map(|k| {
                        let bin = start + k;
                        let p = share(bin) * circular(&sigma[bin]).try_inverse()?;
                        let l = map.at(run.omega(k)).try_inverse()?;
                        Some(l * p * Complex::new(2.0 * run.wide_gain[k], 0.0))
                    })
                    .map(|m| m.unwrap_or_else(SMatrix::zeros))
                    .collect();
                Some((map, back))
            })
            .collect();
        moved
            .par_iter()
            .map(|(to, step)| {
                let mut sum = 0.0;
                for ((run, _), prepared) in runs.iter().zip(&prepared) {
                    let (Some((map, back)), Some(other)) = (prepared, LoopMap::new(run, to, &self.declared)) else { continue };
                    for (k, b) in back.iter().enumerate().skip(1) {
                        sum += ((other.at(run.omega(k)) - map.at(run.omega(k))) * b).trace().re;
                    }
                }
                sum / step
            })
            .collect()
    }
    fn focus(&self, plant: &Plant) {
        let bare = without_aero(plant);
        if self.focus.read().is_ok_and(|f| f.as_ref().is_some_and(|(known, _)| *known == bare)) {
            return;
        }
        let rows: Option<Vec<Vec<Vec<Row>>>> = (0..self.runs.len())
            .map(|r| {
                let all: Vec<Series> = Series::all(self.copies()).collect();
                all.into_par_iter().map(|s| self.rows(plant, r, s)).collect::<Option<Vec<_>>>()
            })
            .collect();
        if let (Ok(mut f), Some(rows)) = (self.focus.write(), rows) {
            *f = Some((bare, rows));
        }
    }
    fn durations_s(&self) -> Vec<f64> {
        self.runs.iter().map(|r| r.duration_s).collect()
    }
    fn run_indices(&self) -> Vec<usize> {
        self.runs.iter().map(|r| r.index).collect()
    }
    fn margin_s(&self) -> f64 {
        QUIET_S + RAMP_S + BLUR_S
    }
    fn settle(&mut self, plant: &Plant) {
        self.measure_noise(plant);
    }
    fn channel_residuals(&self, z: &[f64], expected: &[Cov], fitted: usize) -> Vec<ChannelResidual> {
        Coefficient::ALL
            .iter()
            .enumerate()
            .map(|(c, name)| {
                let parts = || {
                    z.chunks_exact(BIN).zip(expected).flat_map(move |(z, m)| [(z[c], m[(c, c)]), (z[6 + c], m[(6 + c, 6 + c)])])
                };
                let numbers = parts().count() as f64;
                // Density per rad/s times the width of a bin, summed: the variance in the band.
                let width = std::f64::consts::TAU * BAND_HZ / (0.5 * numbers);
                let (sum, expected, ratio) = parts().fold((0.0, 0.0, 0.0), |(a, b, r), (z, v)| (a + z * z, b + v, r + z * z / v));
                let degrees = (numbers - fitted as f64 / 6.0).max(1.0);
                // Noise is known from the copies, each averaged over neighbours that repeat about every seventh bin.
                let known = numbers * self.copies as f64;
                let p_value = FisherSnedecor::new(degrees, known).map_or(1.0, |f| f.sf(ratio / degrees));
                ChannelResidual {
                    channel: name.name().to_owned(),
                    rms: (sum * width).sqrt(),
                    expected_rms: (expected * width).sqrt(),
                    p_value,
                }
            })
            .collect()
    }
    fn lead_table(&self, plant: &Plant) -> LeadTable {
        let mut table = LeadTable { residuals: vec![Vec::new(); 6], variables: Vec::new() };
        let names = ["time in the run (s)", "X (m)", "Y (m)", "Z (m)", "distance from the axis (m)"];
        table.variables = Variable::ALL
            .iter()
            .map(|v| v.name().to_owned())
            .chain(names.iter().map(|n| (*n).to_owned()))
            .map(|n| (n, Vec::new()))
            .collect();
        for (run, series) in self.runs.iter().zip(self.series(plant)) {
            for (state, (row, e)) in run.states.iter().zip(series) {
                table.residuals.iter_mut().zip(e).for_each(|(r, e)| r.push(e));
                let [x, y, z] = state.p_tunnel_origin;
                let own = [row.t_s, x, y, z, y.hypot(z)];
                let values = row.flow.values.iter().chain(&own);
                table.variables.iter_mut().zip(values).for_each(|((_, s), v)| s.push(*v));
            }
        }
        table
    }
    fn peak_hz(&self, fit: &Fit, channel: usize) -> Option<f64> {
        let ratios = fit.residual.chunks_exact(BIN).zip(&self.noise);
        ratios
            .zip(self.frequencies())
            .map(|((z, m), (_, f))| ((z[channel].powi(2) + z[6 + channel].powi(2)) / m[(channel, channel)], f))
            .max_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, f)| f)
    }
}
