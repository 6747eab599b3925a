//! verify: which effect explains a residual. In: a fit and the catalogue. Out: every family's best form, its size and p-value.
//!
//! First every family is weighed by one step from the fit (score test with declared parameters free to absorb what they can;
//! random inputs by their likelihood); then the best are fitted in full and compared by penalised likelihood.

use super::evidence::Residual;
use super::fit::{Columns, Fit, Normal, Point, Problem, Whitened};
use super::hypothesis::{Free, Hypothesis, Instance};
use super::likelihood::{Effort, Whitening};
use super::repeat::weighed;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use statrs::distribution::{ChiSquared, ContinuousCDF};
use windfall_model::{Acts, CATALOGUE, Role};

/// A family weighed against the data.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// Best form found, with one-step estimates.
    pub instance: Instance,
    /// Twice the gain of log-likelihood, in the one-step approximation.
    pub statistic: f64,
    /// Strengths.
    pub degrees: usize,
    /// Forms tried (values of shapes, instants, runs).
    pub tried: usize,
    /// Probability of such a gain from noise alone, corrected for the forms tried.
    pub p_value: f64,
    /// Standard error of each mean strength in the best form, by parameter index.
    pub std_errors: Vec<(usize, f64)>,
    /// Upper 95 % bound of each mean strength's size, by parameter index, in the form tried that hides it best.
    pub bounds: Vec<(usize, f64)>,
}

/// Upper tail of χ², corrected for `tried` attempts (Šidák 1967).
#[must_use]
pub fn p_value(statistic: f64, degrees: usize, tried: usize) -> f64 {
    if statistic.is_nan() || statistic <= 0.0 || degrees == 0 {
        return 1.0;
    }
    let one = ChiSquared::new(degrees as f64).map_or(1.0, |d| d.sf(statistic));
    -f64::exp_m1(tried as f64 * f64::ln_1p(-one.min(1.0 - 1e-16)))
}

/// Weighs every family that can act and is not in the fit yet; best first.
#[must_use]
pub fn weigh(problem: &Problem<'_>, fit: &Fit, acts: Acts) -> Vec<Candidate> {
    let h = &fit.hypothesis;
    let Some(weighing) = Weighing::new(problem, fit) else { return Vec::new() };
    let mut all: Vec<Candidate> = CATALOGUE
        .into_par_iter()
        .filter(|e| e.acts.on(acts) && !h.effects.iter().any(|x| x.effect.family == e.family))
        .filter_map(|e| weighing.family(&Instance::null(e, problem.base, problem.inputs)))
        .collect();
    all.sort_by(|a, b| (b.statistic - b.degrees as f64).total_cmp(&(a.statistic - a.degrees as f64)));
    all
}

/// A fit made ready for weighing effects against its residual.
pub struct Weighing<'a> {
    problem: &'a Problem<'a>,
    fit: &'a Fit,
    at: Point,
    point: Whitened,
    columns: Whitened,
    normal: Normal,
    whitening: Whitening,
}

impl<'a> Weighing<'a> {
    /// `None` when the fit's covariance or normal equations have no solution.
    #[must_use]
    pub fn new(problem: &'a Problem<'a>, fit: &'a Fit) -> Option<Self> {
        let h = &fit.hypothesis;
        let plant = h.plant(problem.base);
        problem.evidence.focus(&plant);
        let at = problem.point(&plant);
        let known = h.free(problem.declared, false);
        let columns = problem.columns(h, &known, &at, &fit.sigma);
        let whitening = Whitening::new(&fit.sigma)?;
        let (point, columns) = (at.whitened(&whitening), Whitened::new(&whitening, &columns));
        let normal = Normal::new(&point, &columns);
        Some(Self { problem, fit, at, point, columns, normal, whitening })
    }

    /// Size that each strength of one form of an effect must exceed to be seen: 1.96 standard errors, declared parameters and its
    /// other strengths free; for sizes of random inputs the 95 % bound. `None` where the data say nothing about the form.
    #[must_use]
    pub fn visible(&self, form: &Instance) -> Option<Vec<(usize, f64)>> {
        let random = form.random_strengths().map(|i| (i, self.problem.random_bound(self.fit, form, i)));
        let mut all: Vec<(usize, f64)> = random.collect();
        if form.mean_strengths().next().is_some() {
            all.extend(self.weighed(form.clone())?.std_errors.iter().map(|(i, s)| (*i, 1.96 * s)));
        }
        Some(all)
    }

    /// One form weighed.
    fn weighed(&self, form: Instance) -> Option<Candidate> {
        if self.problem.evidence.witnesses().is_some() {
            weighed(self.problem, self.fit, form)
        } else if form.mean_strengths().next().is_none() {
            self.random(form)
        } else if form.is_local() {
            self.local(form)
        } else {
            self.mean(form)
        }
    }

    fn family(&self, null: &Instance) -> Option<Candidate> {
        let forms = self.forms(null);
        let tried = forms.len();
        let all: Vec<Candidate> = forms.into_par_iter().filter_map(|form| self.weighed(form)).collect();
        let mut bounds: Vec<(usize, f64)> = Vec::new();
        for (i, bound) in all.iter().flat_map(|c| &c.bounds) {
            match bounds.iter_mut().find(|(k, _)| k == i) {
                Some((_, worst)) => *worst = worst.max(*bound),
                None => bounds.push((*i, *bound)),
            }
        }
        let best = all.into_iter().max_by(|a, b| a.statistic.total_cmp(&b.statistic))?;
        let p_value = p_value(best.statistic, best.degrees, tried);
        Some(Candidate { tried, p_value, bounds, ..best })
    }

    /// All combinations of shapes, instants and runs that are tried.
    fn forms(&self, null: &Instance) -> Vec<Instance> {
        let (runs, durations) = (self.problem.evidence.run_indices(), self.problem.evidence.durations_s());
        let mut forms = vec![null.clone()];
        // Instants last: how far they are apart depends on the pulse.
        let (instants, others): (Vec<_>, Vec<_>) = null.parameters.iter().enumerate().partition(|(_, p)| p.role == Role::Instant);
        for (i, p) in others.into_iter().chain(instants) {
            let values = |form: &Instance| -> Vec<f64> {
                match p.role {
                    Role::Strength => vec![form.values[i]],
                    Role::Shape(tried) => tried.to_vec(),
                    Role::Run => runs.iter().map(|r| *r as f64).collect(),
                    Role::Instant => {
                        let run = null.parameters.iter().position(|q| q.role == Role::Run);
                        let index = run.and_then(|r| place(&runs, form.values[r]));
                        instants_s(form, index.map_or(0.0, |k| durations[k]), self.problem.evidence.margin_s())
                    }
                }
            };
            forms = forms
                .iter()
                .flat_map(|form| {
                    values(form).into_iter().map(|v| {
                        let mut next = form.clone();
                        next.values[i] = v;
                        next
                    })
                })
                .collect();
        }
        forms
    }

    fn with(&self, form: &Instance) -> (Hypothesis, usize) {
        let mut h = self.fit.hypothesis.clone();
        h.effects.push(form.clone());
        let k = h.effects.len() - 1;
        (h, k)
    }

    fn mean(&self, form: Instance) -> Option<Candidate> {
        let (h, k) = self.with(&form);
        let strengths: Vec<usize> = form.mean_strengths().collect();
        let free: Vec<Free> = strengths.iter().map(|&i| Free::Effect(k, i)).collect();
        let own = self.problem.columns(&h, &free, &self.at, &self.fit.sigma);
        self.judge(form, &strengths, own)
    }

    /// An effect within one run: columns from that run alone, without copies (a pulse's shape hardly depends on noise).
    fn local(&self, form: Instance) -> Option<Candidate> {
        let run_parameter = form.parameters.iter().position(|p| p.role == Role::Run)?;
        let run = place(&self.problem.evidence.run_indices(), form.values[run_parameter])?;
        let (h, k) = self.with(&form);
        let strengths: Vec<usize> = form.mean_strengths().collect();
        let base = self.problem.evidence.residual_of(&self.fit.hypothesis.plant(self.problem.base), run);
        let a: Vec<Residual> = strengths
            .iter()
            .map(|&i| {
                let f = Free::Effect(k, i);
                let step = h.step(f);
                let mut moved = h.clone();
                moved.set(f, step);
                let z = self.problem.evidence.residual_of(&moved.plant(self.problem.base), run);
                z.iter().zip(&base).map(|(x, y)| (x - y) / step).collect()
            })
            .collect();
        self.judge(form, &strengths, Columns { looped: vec![0.0; a.len()], a, da: Vec::new() })
    }

    fn judge(&self, mut form: Instance, strengths: &[usize], own: Columns) -> Option<Candidate> {
        if own.a.iter().flatten().any(|x| !x.is_finite()) {
            return None;
        }
        // Strengths that do nothing to these data are left out, and then, one at a time, those that would leave their range.
        let mut live: Vec<usize> = (0..strengths.len()).filter(|&j| own.a[j].iter().any(|x| *x != 0.0)).collect();
        let n = self.normal.g.len();
        let all = self.normal.with(&self.point, &self.columns, &Whitened::new(&self.whitening, &own));
        // A strength that these data do not determine can have any value of its range.
        let mut bounds: Vec<(usize, f64)> = strengths.iter().map(|&i| (i, form.parameters[i].high)).collect();
        let mut first = true;
        loop {
            if live.is_empty() {
                return None;
            }
            let kept: Vec<usize> = (0..n).chain(live.iter().map(|j| n + j)).collect();
            let normal = all.some(&kept);
            let Some(step) = normal.solve() else {
                live.remove(normal.undetermined(|i| i >= n)? - n);
                continue;
            };
            if std::mem::take(&mut first) {
                for (i, &j) in live.iter().enumerate() {
                    let p = &form.parameters[strengths[j]];
                    let (v, s) = (step.delta[n + i].clamp(p.low, p.high).abs(), step.covariance[(n + i, n + i)].sqrt());
                    bounds[j].1 = (v + 1.96 * s).min(p.high);
                }
            }
            let beyond = |i: usize| form.parameters[strengths[live[i]]].beyond(step.delta[n + i]);
            if let Some(worst) = (0..live.len()).filter(|&i| beyond(i) > 0.0).max_by(|a, b| beyond(*a).total_cmp(&beyond(*b))) {
                live.remove(worst);
                continue;
            }
            let m = live.len();
            let estimate = DVector::from_fn(m, |i, _| step.delta[n + i]);
            let covariance = DMatrix::from_fn(m, m, |i, k| step.covariance[(n + i, n + k)]);
            let statistic = (estimate.transpose() * covariance.clone().cholesky()?.inverse() * &estimate)[0];
            let mut std_errors = Vec::new();
            for (i, &j) in live.iter().enumerate() {
                form.values[strengths[j]] = estimate[i];
                std_errors.push((strengths[j], covariance[(i, i)].sqrt()));
            }
            return Some(Candidate { instance: form, statistic, degrees: m, tried: 1, p_value: 1.0, std_errors, bounds });
        }
    }

    fn random(&self, form: Instance) -> Option<Candidate> {
        let (mut h, k) = self.with(&form);
        let (l, _) = self.problem.fit_sizes(&mut h, &self.at.z, Effort::QUICK);
        let degrees = form.random_strengths().count();
        l.is_finite().then(|| Candidate {
            instance: h.effects[k].clone(),
            statistic: 2.0 * (l - self.fit.log_likelihood),
            degrees,
            tried: 1,
            p_value: 1.0,
            std_errors: Vec::new(),
            bounds: Vec::new(),
        })
    }
}

/// Place of a run's index (whole numbers, held as a parameter's value) among the runs of the evidence.
fn place(runs: &[usize], index: f64) -> Option<usize> {
    runs.iter().position(|r| (*r as f64 - index).abs() < 0.5)
}

/// Instants at which a form's pulse is tried in a run: half its own duration apart, so that none falls between two, from `margin_s` to
/// where the pulse ends that far before the run does.
fn instants_s(form: &Instance, duration_s: f64, margin_s: f64) -> Vec<f64> {
    let pulse_s = form.shape_duration_s();
    let end_s = duration_s - margin_s - pulse_s;
    (0..).map(|k: i32| margin_s + 0.5 * f64::from(k) * pulse_s).take_while(|t| *t < end_s).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use windfall_model::CATALOGUE;

    /// For every pulse of the catalogue and every duration that is tried of it.
    #[test]
    fn law_no_pulse_falls_between_two_instants() {
        let mut pulses = 0;
        for effect in CATALOGUE {
            let parameters = (effect.parameters)(&[]);
            let values: Vec<f64> = parameters.iter().map(|p| p.null).collect();
            let random = vec![false; values.len()];
            let null = Instance { effect, parameters, values, random };
            if null.parameters.iter().all(|p| p.role != Role::Instant) {
                continue;
            }
            for (i, p) in null.parameters.iter().enumerate() {
                let (Role::Shape(tried), "s") = (p.role, p.unit) else { continue };
                for &pulse_s in tried {
                    let mut form = null.clone();
                    form.values[i] = pulse_s;
                    let at = instants_s(&form, 10.0, 0.5);
                    let (first, last) = (at[0], at[at.len() - 1]);
                    assert!((first - 0.5).abs() < 1e-12 && last + pulse_s < 9.5, "{first} {last}");
                    assert!(last + 1.5 * pulse_s + 1e-9 >= 9.5, "the end of the run is tried, too: {last}");
                    assert!(at.windows(2).all(|w| w[1] - w[0] <= 0.5 * pulse_s + 1e-12), "pulse of {pulse_s} s");
                    pulses += 1;
                }
            }
        }
        assert!(pulses > 1, "the catalogue has a pulse, of more than one duration");
    }
}
