//! discover: what the search found, judged on fresh runs. In: hypotheses at their places. Out: explanations with intervals, what
//! these figures separate, and the closing.

use super::super::ensemble::{Rows, history, quantile, true_runs};
use super::super::judge::{self, Spread, Tangent};
use super::super::table::conclusions;
use super::super::{
    Estimated, Explanation, FigureOver, FigureSeparation, Screened, SimulatedHistory, StatisticFigure, StatisticsClosing,
    StatisticsError,
};
use super::{FINAL, Found, Search, WITHIN};
use nalgebra::DMatrix;
use windfall_model::Plant;
use windfall_pid::NORMAL_95;

/// Level of rejection.
const LEVEL: f64 = 0.05;

/// A judged explanation with what later comparisons need.
pub(super) struct Judged {
    pub(super) explanation: Explanation,
    rows: Rows,
    spread: Spread,
    tangent: Tangent,
    found: Found,
}

impl Search<'_> {
    pub(super) fn judge(&self, f: &Found) -> Option<Judged> {
        let runs = self.options.final_runs;
        let (rows, left_section) = self.fly(&f.h, &f.x, FINAL..FINAL + runs).ok()?;
        let spread = Spread::of(&rows, &self.used)?;
        let at = self.mean(&f.h, &f.x)?;
        let tangent = Tangent::new(&spread, &self.derivative(f, &at)?);
        let z = spread.whiten(&(&self.test - &spread.mean));
        let figures = over(&self.setup.figures, &rows);
        let p_value = judge::p_value(&spread, &tangent, &rows, &self.test, &self.used);
        let closes = figures.iter().filter(|f| f.fitted).all(|f| f.inside && f.relative.abs() <= WITHIN);
        let explanation = Explanation {
            families: f.h.families(),
            parameters: parameters(f, &tangent.std_errors(self.options.fine_runs as usize)),
            figures,
            j: tangent.left(&z),
            degrees: tangent.degrees(),
            p_value,
            possible: p_value >= LEVEL,
            closes,
            score: spread.surprise(&self.test) + 2.0 * tangent.rank() as f64,
            left_section,
        };
        Some(Judged { explanation, rows, spread, tangent, found: f.clone() })
    }

    pub(super) fn result(
        &self,
        before: &Rows,
        screened: Vec<Screened>,
        judged: &[Judged],
    ) -> Result<StatisticsClosing, StatisticsError> {
        let o = self.options;
        let nothing = Spread::of(before, &self.used).map(|s| {
            let t = Tangent::new(&s, &DMatrix::zeros(self.used.len(), 0));
            judge::p_value(&s, &t, before, &self.test, &self.used)
        });
        let before_p_value = nothing.unwrap_or(0.0);
        let explanations: Vec<Explanation> = judged.iter().map(|j| j.explanation.clone()).collect();
        let processing = judged.first().map_or(Ok(Vec::new()), |j| self.processing(&j.found))?;
        let separations = self.separations(judged);
        let histories = self.histories(judged.first().map(|j| &j.found))?;
        let verdict = match explanations.first() {
            _ if before_p_value >= LEVEL => "consistent",
            Some(e) if e.closes => "effect",
            _ => "unexplained",
        };
        let mut closing = StatisticsClosing {
            verdict,
            name: self.setup.name.clone(),
            source: self.setup.source.clone(),
            options: *o,
            seed: self.setup.seed,
            search_runs: [0, o.fine_runs],
            final_runs: [FINAL, FINAL + o.final_runs],
            source_simulation: self.setup.figures.iter().map(|f| f.simulation).collect(),
            before: over(&self.setup.figures, before),
            before_p_value,
            screened,
            explanations,
            separations,
            processing,
            histories,
            flights: self.flights.get(),
            conclusions: Vec::new(),
        };
        closing.conclusions = conclusions(&closing);
        Ok(closing)
    }

    /// The first run of the judgement, of the declared model and of the best explanation.
    fn histories(&self, best: Option<&Found>) -> Result<Vec<SimulatedHistory>, StatisticsError> {
        let one = |plant: &Plant, families| history(self.setup, plant, families, FINAL);
        let declared = one(&self.setup.plant, Vec::new())?;
        let best = best.map(|f| one(&f.h.plant(&self.setup.plant, &f.x), f.h.families())).transpose()?;
        Ok(std::iter::once(declared).chain(best).collect())
    }

    fn separations(&self, judged: &[Judged]) -> Vec<FigureSeparation> {
        let possible: Vec<&Judged> = judged.iter().filter(|j| j.explanation.possible || j.explanation.closes).collect();
        let mut all = Vec::new();
        for truth in &possible {
            for other in possible.iter().filter(|o| o.explanation.families != truth.explanation.families) {
                let power = judge::rejected(&other.spread, &other.tangent, &other.rows, &truth.rows, &self.used);
                let (truth, other) = (truth.explanation.families.clone(), other.explanation.families.clone());
                all.push(FigureSeparation { truth, other, power });
            }
        }
        all
    }

    /// Mean figures of the record over those of the truth, less one, in the runs of the fine search.
    fn processing(&self, f: &Found) -> Result<Vec<f64>, StatisticsError> {
        let runs = self.options.fine_runs;
        let (rows, _) = self.fly(&f.h, &f.x, 0..runs)?;
        let plant = f.h.plant(&self.setup.plant, &f.x);
        let truth = true_runs(self.setup, &plant, 0..runs)?;
        let sum = |rows: &Rows, i: usize| rows.iter().map(|r| r[i]).sum::<f64>();
        Ok((0..rows[0].len()).map(|i| sum(&rows, i) / sum(&truth, i) - 1.0).collect())
    }
}

fn parameters(f: &Found, std_errors: &[f64]) -> Vec<Estimated> {
    let searched = f.h.searched();
    (0..f.h.dimension())
        .filter(|i| f.h.held(*i).is_none_or(|v| v != 0.0))
        .map(|i| {
            let (effect, p) = f.h.entry(i);
            let reach = searched.iter().position(|s| *s == i).map_or(f64::INFINITY, |k| NORMAL_95 * std_errors[k]);
            let (low, high) = ((f.x[i] - reach).max(0.0), (f.x[i] + reach).min(1.0));
            let mut ci95 = if reach.is_finite() { [f.h.value(i, low), f.h.value(i, high)] } else { [p.low, p.high] };
            ci95.sort_by(f64::total_cmp);
            Estimated {
                family: effect.family,
                name: p.name.clone(),
                unit: p.unit,
                estimate: f.h.value(i, f.x[i]),
                ci95,
                decided: high - low <= 0.5,
            }
        })
        .collect()
}

/// Figures of a distribution over runs beside the test.
fn over(figures: &[StatisticFigure], rows: &Rows) -> Vec<FigureOver> {
    let n = rows.len() as f64;
    let one = |(i, f): (usize, &StatisticFigure)| {
        let mut x: Vec<f64> = rows.iter().map(|r| r[i]).collect();
        let mean = x.iter().sum::<f64>() / n;
        let std = (x.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt();
        let central90 = [quantile(&mut x, 0.05), quantile(&mut x, 0.95)];
        FigureOver {
            quantity: f.quantity,
            statistic: f.statistic,
            fitted: f.fitted,
            test: f.test,
            mean,
            std,
            central90,
            quantiles: std::array::from_fn(|k| quantile(&mut x, 0.05 * k as f64)),
            relative: mean / f.test - 1.0,
            inside: (central90[0]..=central90[1]).contains(&f.test),
        }
    };
    figures.iter().enumerate().map(one).collect()
}

#[cfg(test)]
mod tests;
