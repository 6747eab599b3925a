//! study: one draw of a study. In: a study made ready and the draw's number. Out: its row.

use super::closing::close_draw;
use super::columns::{TRAJECTORY, columns};
use super::row::Cells;
use crate::StudyError;
use statrs::distribution::{ContinuousCDF, Normal};
use std::collections::HashMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use windfall_model::study::{Cell, Column, Distribution, DrawnSetup, Root, Row, StudyOrder};
use windfall_model::{Campaign, Data, Flight, Plant, Record, Run, Use};
use windfall_pid::output_error::EstimateOptions;
use windfall_pid::{DataSet, Method, estimated, identify_by};
use windfall_replay::{Replay, ReplayError, hold_out, initial_of};
use windfall_sim::{Channel, Order, Seed, Stepping, Truth, fly, for_each_flown};

/// Stream of the histories, after those of [`StudyOrder::vary`].
const HISTORY_STREAM: u8 = 127;

/// A study ready to draw from.
#[derive(Debug)]
pub struct PreparedStudy {
    study: StudyOrder,
    columns: Vec<Column>,
    places: HashMap<String, usize>,
    methods: Vec<Method>,
    wanted: Vec<(&'static str, String)>,
}

/// What is flown in a draw, the plant that its campaign declares, and the records; or why there are none.
type Flown = (DrawnSetup, Plant, Vec<Record>);

/// A draw whose flights are over.
pub(super) struct FlownRow<'p> {
    out: Cells<'p>,
    flown: Result<Flown, String>,
}

impl PreparedStudy {
    /// Makes a study ready. A study of a measured campaign flies each of its runs again: from the initial state that the study's
    /// plant estimates from the run, with the recorded tunnel speed.
    ///
    /// # Errors
    /// A method that does not exist, a campaign of point masses, or a run that cannot be flown.
    pub fn new(mut study: StudyOrder, campaign: Option<&Campaign>) -> Result<Self, StudyError> {
        let methods = study
            .steps
            .identify
            .iter()
            .map(|name| Method::of_name(name).ok_or_else(|| unknown(name)))
            .collect::<Result<Vec<_>, _>>()?;
        if let Some(campaign) = campaign {
            study.flights = flights_like(campaign, &study.plant)?;
        }
        let columns = columns(&study, &methods);
        let places = columns.iter().enumerate().map(|(i, c)| (c.name.clone(), i)).collect();
        let wanted = estimated(&study.declared_plant, &study.declared);
        Ok(Self { study, columns, places, methods, wanted })
    }
    /// The order.
    #[must_use]
    pub fn study(&self) -> &StudyOrder {
        &self.study
    }
    /// What each row holds after the draw's number.
    #[must_use]
    pub fn columns(&self) -> &[Column] {
        &self.columns
    }
    /// Place of a column in a row.
    #[must_use]
    pub fn place(&self, column: &str) -> Option<usize> {
        self.places.get(column).copied()
    }
    /// Coefficient and name of each parameter that is identified.
    #[must_use]
    pub fn wanted(&self) -> &[(&'static str, String)] {
        &self.wanted
    }
    /// Methods to identify with.
    #[must_use]
    pub fn methods(&self) -> &[Method] {
        &self.methods
    }
    /// The row of a draw. What fails leaves its cells empty and says why in `failure`; the draw counts all the same.
    #[must_use]
    pub fn draw(&self, draw: u64) -> Row {
        self.row(draw, None)
    }

    /// Flies some draws side by side; [`PreparedStudy::row`] does the rest of each, whose bits do not depend on the others. None where the
    /// program's own checks failed: then each is flown by itself, so that the one at fault says so.
    pub(super) fn fly(&self, draws: &[u64]) -> Vec<Option<Box<FlownRow<'_>>>> {
        catch_unwind(AssertUnwindSafe(|| self.flown(draws).into_iter().map(|d| Some(Box::new(d))).collect()))
            .unwrap_or_else(|_| draws.iter().map(|_| None).collect())
    }

    /// The row of a draw; flown here where it is not yet.
    pub(super) fn row(&self, draw: u64, flown: Option<Box<FlownRow<'_>>>) -> Row {
        let mut out = self.empty();
        let filled = catch_unwind(AssertUnwindSafe(|| {
            let drawn = flown.or_else(|| self.flown(&[draw]).pop().map(Box::new)).ok_or_else(String::new)?;
            let drawn = *drawn;
            out = drawn.out;
            self.fill(drawn.flown?, &mut out)
        }));
        let failure = match filled {
            Ok(Ok(())) => String::new(),
            Ok(Err(failure)) => failure,
            Err(_) => "internal: the program's own checks failed in this draw; report it with the study file".to_owned(),
        };
        out.set("failure", Cell::Word(failure));
        Row { draw, cells: out.cells }
    }

    fn empty(&self) -> Cells<'_> {
        Cells { cells: self.columns.iter().map(|c| Cell::empty(c.kind)).collect(), places: &self.places }
    }

    /// The draws' flights, side by side; what of each fails keeps its reason.
    fn flown(&self, draws: &[u64]) -> Vec<FlownRow<'_>> {
        let mut outs: Vec<Cells<'_>> = draws.iter().map(|_| self.empty()).collect();
        let settings: Vec<_> = draws.iter().zip(&mut outs).map(|(draw, out)| self.setting(*draw, out)).collect();
        // Place of the draw, the flight, its plant and seed.
        let mut flights: Vec<(usize, &Flight, Plant, Seed)> = Vec::new();
        for (i, (draw, setting)) in draws.iter().zip(&settings).enumerate() {
            let Ok((setting, _)) = setting else { continue };
            let truth = with_effects(setting, &self.study);
            for (k, flight) in setting.flights.iter().enumerate() {
                let run = draw * setting.flights.len() as u64 + k as u64;
                flights.push((i, flight, truth.for_run(k, &[]), Seed { campaign: self.study.seed, run }));
            }
        }
        let orders: Vec<Order<'_>> =
            flights.iter().map(|(_, flight, plant, seed)| Order { plant, flight, seed: *seed }).collect();
        let mut records: Vec<Option<Result<Record, String>>> = orders.iter().map(|_| None).collect();
        let mut keep = |order: usize, truth: &Truth, record: Record| {
            let (i, flight, ..) = &flights[order];
            outs[*i].flight(&flight.name, truth);
            Some(Ok(record))
        };
        for_each_flown(&orders, Stepping::Adaptive, |order, flown| {
            let Order { plant, flight, seed } = orders[order];
            records[order] = match flown {
                Ok((truth, record, _)) => keep(order, truth, record),
                // What lanes do not carry, or give up, is flown alone, which says more of why.
                Err(_) => match fly(plant, flight, seed) {
                    Ok(flown) => keep(order, &flown.truth, flown.record),
                    Err(e) => Some(Err(format!("simulate {}: {e}", flight.name))),
                },
            };
        });
        let mut records = records.into_iter().flatten();
        let drawn = |(out, setting): (_, Result<(DrawnSetup, Plant), String>)| {
            let flown = setting.and_then(|(setting, declared)| {
                let own: Vec<_> = records.by_ref().take(setting.flights.len()).collect();
                Ok((setting, declared, own.into_iter().collect::<Result<_, _>>()?))
            });
            FlownRow { out, flown }
        };
        outs.into_iter().zip(settings).map(drawn).collect()
    }

    fn fill(&self, (setting, declared, records): Flown, out: &mut Cells<'_>) -> Result<(), String> {
        if self.methods.is_empty() && !self.study.steps.close {
            return Ok(());
        }
        let campaign = made_campaign(&self.study, &declared, &setting.flights, records);
        let mut failure = Ok(());
        for method in &self.methods {
            let done = self.identified(*method, &campaign, &setting, out);
            failure = failure.and(done.map_err(|e| format!("{}: {e}", method.name())));
        }
        if self.study.steps.close {
            failure = failure.and(close_draw(&campaign, &self.study, &setting, out).map_err(|e| format!("close: {e}")));
        }
        failure
    }

    /// What is flown in this draw, and the plant that its campaign declares.
    fn setting(&self, draw: u64, out: &mut Cells<'_>) -> Result<(DrawnSetup, Plant), String> {
        let s = &self.study;
        let mut truth = DrawnSetup { plant: s.plant.clone(), effect_values: s.effect_values.clone(), flights: s.flights.clone() };
        let mut declared = s.declared_plant.clone();
        let seed = Seed { campaign: s.seed, run: draw * s.flights.len() as u64 };
        let normals = self.normals(seed);
        for (v, z) in s.vary.iter().zip(normals) {
            let value = value(&v.distribution, z);
            out.number(&format!("vary.{}", v.name), value);
            if !(value >= v.range[0] && value <= v.range[1]) {
                return Err(format!("{} drawn outside its range {:?}", v.name, v.range));
            }
            if !truth.set(v.quantity, &v.flights, value) {
                return Err(format!("{} does not exist in this setup", v.name));
            }
            if v.known {
                let mut known = DrawnSetup { plant: declared, effect_values: Vec::new(), flights: Vec::new() };
                known.set(v.quantity, &v.flights, value);
                declared = known.plant;
            }
        }
        if let Some(h) = &s.histories {
            let chosen = choose(unit(normal(seed, HISTORY_STREAM)), h.speeds.len());
            out.number("vary.history", chosen as f64);
            for (_, f) in truth.flights.iter_mut().enumerate().filter(|(i, _)| h.flights.is_empty() || h.flights.contains(i)) {
                f.speed.clone_from(&h.speeds[chosen]);
            }
        }
        if !s.effects.is_empty() {
            // Strengths that are stated at the trim speed are at this draw's.
            let mut there = truth.plant.clone();
            let values = truth.effect_values.iter_mut().enumerate();
            let acting = values.filter_map(|(i, v)| Some((s.effects.iter().find(|e| e.index == i)?.effect, v.as_mut_slice())));
            windfall_model::effects::act_in_flights(&mut there, acting, &truth.flights);
        }
        Ok((truth, declared))
    }

    /// Standard normals behind what varies, correlated as ordered.
    fn normals(&self, seed: Seed) -> Vec<f64> {
        let z = (0..self.study.vary.len()).map(|v| normal(seed, u8::try_from(v).unwrap_or(u8::MAX)));
        correlated(&self.study.correlation_root, z.collect())
    }

    fn identified(
        &self,
        method: Method,
        campaign: &Campaign,
        setting: &DrawnSetup,
        out: &mut Cells<'_>,
    ) -> Result<(), StudyError> {
        let options = EstimateOptions { combined_only: true, ..EstimateOptions::default() };
        let found = identify_by(campaign, method, &options)?;
        let Some(set) = found.of_all_runs() else { return Err(ReplayError::NoDataSet.into()) };
        for (coefficient, name) in &self.wanted {
            if let (Some(p), Some(truth)) = (set.get(coefficient, name), setting.plant.aero.value(name)) {
                out.parameter(&format!("{}.{coefficient}.{name}", method.name()), p, truth);
            }
        }
        if self.study.steps.resimulate {
            resimulated(method, campaign, set, out)?;
        }
        Ok(())
    }
}

fn unknown(name: &str) -> StudyError {
    StudyError::UnknownMethod { name: name.to_owned(), allowed: Method::ALL.map(Method::name).join(", ") }
}

fn resimulated(method: Method, campaign: &Campaign, set: &DataSet, out: &mut Cells<'_>) -> Result<(), StudyError> {
    let held: Vec<usize> = (0..campaign.runs.len()).filter(|&i| campaign.runs[i].used == Use::HoldOut).collect();
    let runs = if held.is_empty() { (0..campaign.runs.len()).collect() } else { held };
    let t = hold_out(campaign, &set.plant_in(campaign)?, &runs, 1)?.trajectory;
    for (name, x) in TRAJECTORY.iter().zip([t.attitude_rms_deg, t.position_rms_m, t.rate_rms_deg_s]) {
        out.number(&format!("{}.resimulate.{name}", method.name()), x);
    }
    Ok(())
}

fn with_effects(setting: &DrawnSetup, study: &StudyOrder) -> Plant {
    let mut plant = setting.plant.clone();
    for e in &study.effects {
        (e.effect.apply)(&mut plant, &setting.effect_values[e.index]);
    }
    plant
}

/// The campaign that a draw's records make: the declared plant, without effects.
fn made_campaign(study: &StudyOrder, declared: &Plant, flights: &[Flight], records: Vec<Record>) -> Campaign {
    let runs = flights.iter().zip(records).map(|(flight, record)| Run::of_flight(flight, record)).collect();
    Campaign::of_flights(&study.name, declared, &study.declared, &study.knowledge, runs)
}

fn flights_like(campaign: &Campaign, plant: &Plant) -> Result<Vec<Flight>, StudyError> {
    let one = |(i, run): (usize, &Run)| {
        let Data::Tunnel(record) = &run.data else { return Err(ReplayError::NotTunnel { run: run.name.clone() }.into()) };
        let replay = Replay::new(record, &campaign.plant_for(plant, i))?;
        let initial = initial_of(&replay, record, &plant.sensors)?;
        Ok(Flight { name: run.name.clone(), kind: run.kind.clone(), used: run.used, ..replay.order(initial.release) })
    };
    campaign.runs.iter().enumerate().map(one).collect()
}

fn normal(seed: Seed, stream: u8) -> f64 {
    seed.normals(Channel::Varied(stream)).next().unwrap_or(0.0)
}

/// Independent normals made correlated; as they are without a root.
fn correlated(root: &Root, z: Vec<f64>) -> Vec<f64> {
    if root.is_empty() {
        return z;
    }
    (0..z.len()).map(|i| (0..=i).map(|j| root[(i, j)] * z[j]).sum()).collect()
}

/// Φ(z).
fn unit(z: f64) -> f64 {
    Normal::standard().cdf(z)
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and the number of choices")]
fn choose(u: f64, of: usize) -> usize {
    ((u * of as f64) as usize).min(of - 1)
}

/// The value that a standard normal number stands for: correlations are those of the normals (a Gaussian copula).
fn value(d: &Distribution, z: f64) -> f64 {
    match d {
        Distribution::Normal { mean, std, low, high } => {
            if low.is_infinite() && high.is_infinite() {
                return mean + std * z;
            }
            let (a, b) = (unit((low - mean) / std), unit((high - mean) / std));
            (mean + std * Normal::standard().inverse_cdf(a + (b - a) * unit(z))).clamp(*low, *high)
        }
        Distribution::Uniform { low, high } => low + (high - low) * unit(z),
        Distribution::LogNormal { median, sigma } => median * (sigma * z).exp(),
        Distribution::Choice { values } => values[choose(unit(z), values.len())],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(d: &Distribution) -> Vec<f64> {
        (0..20_000).map(|run| value(d, normal(Seed { campaign: 5, run }, 0))).collect()
    }

    /// Mean and variance against the closed forms, within 4 standard errors of 20,000 draws.
    #[test]
    fn exact_distributions_have_their_moments() {
        let ln = |m: f64, s: f64| (m * (0.5 * s * s).exp(), m * m * (s * s).exp() * (s * s).exp_m1());
        // half-normal: mean sqrt(2/pi), variance 1 - 2/pi
        let half = (0.797_884_560_802_865_4, 0.363_380_227_632_418_6);
        let cases = [
            (Distribution::Normal { mean: 3.0, std: 2.0, low: f64::NEG_INFINITY, high: f64::INFINITY }, (3.0, 4.0)),
            (Distribution::Normal { mean: 0.0, std: 1.0, low: 0.0, high: f64::INFINITY }, half),
            (Distribution::Uniform { low: -1.0, high: 5.0 }, (2.0, 3.0)),
            (Distribution::LogNormal { median: 2.0, sigma: 0.3 }, ln(2.0, 0.3)),
            (Distribution::Choice { values: vec![1.0, 2.0, 6.0] }, (3.0, 14.0 / 3.0)),
        ];
        for (d, (mean, variance)) in cases {
            let x = sample(&d);
            let n = x.len() as f64;
            let m = x.iter().sum::<f64>() / n;
            let squares: Vec<f64> = x.iter().map(|v| (v - mean).powi(2)).collect();
            let v = squares.iter().sum::<f64>() / n;
            let spread = (squares.iter().map(|s| (s - v).powi(2)).sum::<f64>() / n).sqrt();
            assert!((m - mean).abs() < 4.0 * (variance / n).sqrt(), "{d:?}: mean {m}, not {mean}");
            assert!((v - variance).abs() < 4.0 * spread / n.sqrt(), "{d:?}: variance {v}, not {variance}");
        }
        let cut = sample(&Distribution::Normal { mean: 0.0, std: 1.0, low: -0.5, high: 0.25 });
        assert!(cut.iter().all(|x| (-0.5..=0.25).contains(x)));
    }

    /// What a normal number stands for, closed: cut at −1 and 1/2 standard deviations, z = 0 has half of the probability between, 0.425059, whose
    /// quantile is −0.188968 (tables of the normal distribution); cut at the mean alone 0.75 is left at z = 0, quantile 0.674490.
    #[test]
    fn exact_values_of_a_normal_number() {
        let free = f64::INFINITY;
        let cases = [
            (Distribution::Normal { mean: 3.0, std: 2.5, low: -free, high: free }, 1.5, 6.75),
            (Distribution::Normal { mean: 3.0, std: 2.5, low: 0.5, high: 4.25 }, 0.0, 3.0 - 2.5 * 0.188_968_232),
            (Distribution::Normal { mean: 3.0, std: 2.5, low: 3.0, high: free }, 0.0, 3.0 + 2.5 * 0.674_489_75),
            (Distribution::LogNormal { median: 3.0, sigma: 0.4 }, 1.5, 3.0 * 0.6_f64.exp()),
        ];
        for (d, z, by_hand) in cases {
            assert!((value(&d, z) - by_hand).abs() < 1e-6, "{d:?}: {}, not {by_hand}", value(&d, z));
        }
        // The largest number that a cumulative probability rounds to is 1.
        assert_eq!([choose(0.0, 3), choose(0.5, 3), choose(0.99, 3), choose(1.0, 3)], [0, 1, 2, 2]);
    }

    /// Of correlation 0.6 the second normal is 0.6 of the first and 0.8 of its own.
    #[test]
    fn exact_correlated_normals() {
        let root = StudyOrder::root_of_correlation(2, &[(0, 1, 0.6)]).expect("positive definite");
        let z = correlated(&root, vec![0.5, -2.0]);
        assert!((z[0] - 0.5).abs() < 1e-15 && (z[1] - (0.3 - 1.6)).abs() < 1e-15, "{z:?}");
    }
}
