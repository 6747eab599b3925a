//! likelihood: gusts that blew. In: a fitted model with gusts. Out: their mean square in the runs over what the model expects.
//!
//! The size that makes a record likeliest is that of the model's spectrum; where the gusts have another, it follows the frequencies that the record
//! shows best. The mean square of the smoothed gusts with what is not known of them (a step of EM: Shumway and Stoffer, An approach to time series
//! smoothing and forecasting using the EM algorithm, J. Time Series Analysis 3, 1982) counts every frequency as far as it is seen, and leaves
//! a size as it is where the spectrum is right.

use crate::engine::Engine;
use crate::filter::Seen;
use crate::model::Model;
use crate::shock::{Blowing, backward};
use nalgebra::{DMatrix, DVector, DVectorView};

/// Gusts along the stream or across it, over the runs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Blown {
    /// Mean square over what the model expects.
    pub(crate) square: f64,
    /// The part of it that the record does not show.
    pub(crate) unseen: f64,
}

/// Sums over nodes and axes: of what is expected, of squares of smoothed gusts, of their variances.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    expected: f64,
    squares: f64,
    variances: f64,
}

impl Sums {
    /// Adds a gust with the score and information that all later innovations give of the states at its node.
    fn add(&mut self, gust: &Blowing, score: &DVector<f64>, information: &DMatrix<f64>) {
        let by = DVectorView::from_slice(&gust.covariance, gust.covariance.len());
        self.expected += gust.expected;
        self.squares += (gust.value + by.dot(score)).powi(2);
        self.variances += gust.covariance[gust.place] - by.dot(&(information * by));
    }

    fn blown(self) -> Option<Blown> {
        let Self { expected, squares, variances } = self;
        (expected > 0.0).then(|| Blown { square: (squares + variances) / expected, unseen: variances / expected })
    }
}

/// Of runs whose filters kept what they knew of gusts: along the stream, across it.
fn blown(runs: &[Seen]) -> [Option<Blown>; 2] {
    let mut sums = [Sums::default(); 2];
    for run in runs {
        backward(&run.trace, run.states, |at, score, information| {
            run.trace.nodes[at].blowing.iter().for_each(|gust| sums[gust.axis.min(1)].add(gust, score, information));
        });
    }
    sums.map(Sums::blown)
}

impl Engine {
    /// Gusts along the stream and across it, of a direction in which none act none; none where a model departs.
    pub(crate) fn blown(&self, model: &Model) -> Option<[Option<Blown>; 2]> {
        self.traced_with_gusts(model).ok().map(|runs| blown(&runs))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::filter::{Keep, PassSetting, pass};
    use crate::noise::declared;
    use crate::run::Prepared;
    use crate::shock::tests::{GUSTS, Linear, STATES};
    use windfall_model::{CATALOGUE, Flight, POSE};
    use windfall_sim::Seed;

    /// Mean squares of states by all measurements, of one Gaussian written out: squares of means and variances, over what is
    /// expected.
    #[test]
    fn exact_mean_square_by_all_measurements() {
        let (linear, mut sums) = (Linear::new(), Sums::default());
        backward(&linear.trace, STATES, |at, score, information| {
            linear.trace.nodes[at].blowing.iter().for_each(|gust| sums.add(gust, score, information));
        });
        let (mut square, mut unseen, mut expected) = (0.0, 0.0, 0.0);
        for (at, (place, variance)) in (0..linear.trace.nodes.len()).flat_map(|at| GUSTS.map(|gust| (at, gust))) {
            let (mean, covariance) = linear.smoothed(at);
            square += mean[place].powi(2);
            unseen += covariance[(place, place)];
            expected += variance;
        }
        let found = sums.blown().expect("gusts");
        let (whole, unseen) = ((square + unseen) / expected, unseen / expected);
        assert!((found.square - whole).abs() < 1e-9 && (found.unseen - unseen).abs() < 1e-9, "{found:?} {whole} {unseen}");
    }

    /// Long gusts, which the motion shows: of the size at which they were flown their mean square is what is expected, within four
    /// errors of a variance over that time; beside a model that has half of it, near four times.
    #[test]
    fn recover_size_that_blew() {
        let file = windfall_scenarios::read_bundled("sage-unperturbed").expect("a bundled scenario");
        let turbulence = CATALOGUE.iter().find(|e| e.family == "turbulence").expect("an effect of the catalogue");
        let plant = |size: f64| {
            let mut plant = file.declared_plant.clone();
            (turbulence.apply)(&mut plant, &[size, size, 1.2, 1.2, 1.5]);
            plant
        };
        let (flown, noise) = (plant(0.1), declared(&file.declared_plant.sensors));
        let duration_s = 20.0;
        let flight = Flight { duration_s, ..file.scenario.flights[0].clone() };
        let record = windfall_sim::fly(&flown, &flight, Seed { campaign: 5, run: 0 }).expect("a flight").record;
        let run = Prepared::new(0, "short", &record, flown.environment.gas_constant_j_kg_k, 0.02, &noise[POSE]);
        let of = |size: f64| {
            let plant = plant(size);
            let seen = pass(&run, &PassSetting { keep: Keep::Gusts, ..PassSetting::plain(&plant, &noise) }).expect("a pass");
            blown(&[seen]).map(|b| b.expect("a gust"))
        };
        // A band of 1.5 V/(2πL) Hz and 20 s hold 60 numbers along the stream, twice as many across it.
        let numbers = 2.0 * 1.5 * 7.4 / (std::f64::consts::TAU * 1.2) * duration_s;
        for ((right, half), count) in of(0.1).into_iter().zip(of(0.05)).zip([numbers, 2.0 * numbers]) {
            assert!((right.square - 1.0).abs() < 4.0 * (2.0 / count).sqrt(), "{right:?}");
            assert!(right.unseen > 0.0 && right.unseen < 0.2, "{right:?}");
            assert!((half.square / right.square - 4.0).abs() < 1.0, "{half:?} {right:?}");
        }
    }
}
