//! replay: what the parameters' errors do to a re-simulated run. In: a model with covariance, runs. Out: bands on Θ and ω_q,r.
//!
//! Parameters are drawn from their joint normal distribution. A run's initial state is not known either: for every draw it is estimated
//! again, because what a parameter moves the initial state partly moves back, and drawn about that estimate. Bands over time are the model's own, without gusts and
//! sensor noise; intervals of statistics, which stand beside measured ones, have both.

use super::statistics::{LINES, Swing, table};
use super::{Initial, Replay, initial};
use crate::ReplayError;
use crate::joint_errors::JointErrors;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use windfall_model::{Campaign, Data, Plant, Record};
use windfall_pid::{DataSet, rates_and_angles};
use windfall_sim::{Channel, Seed};

/// Longest series, points.
const POINTS: usize = 300;
/// Ends of a 95 % interval, as probabilities.
const ENDS: [f64; 3] = [0.025, 0.5, 0.975];

/// One quantity of one run over time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Band {
    /// `theta_deg` or `omega_qr_deg_s`.
    pub quantity: String,
    /// Time from the first sample, s.
    pub t_s: Vec<f64>,
    /// Measured, smoothed.
    pub test: Vec<f64>,
    /// Median over the draws.
    pub median: Vec<f64>,
    /// 2.5 % of the draws lie below.
    pub low: Vec<f64>,
    /// 2.5 % lie above.
    pub high: Vec<f64>,
}

/// A run's bands, and the 95 % interval of each line of Table 5.6.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RunBands {
    pub(super) bands: Vec<Band>,
    /// One per draw, gusts and sensor noise in it.
    pub(super) draws: Vec<Swing>,
}

/// Plants drawn from the data set's estimates. Draw i is a function of i alone.
pub(super) fn drawn(plant: &Plant, set: &DataSet, draws: usize) -> Result<Vec<Plant>, ReplayError> {
    let errors = JointErrors::of(set, &plant.aero.structure)?;
    Ok((0..draws).map(|draw| errors.plant(plant, Seed { campaign: draw as u64, run: 0 })).collect())
}

/// Flies every drawn plant in one run.
pub(super) fn of_run(
    campaign: &Campaign,
    index: usize,
    plants: &[Plant],
    base: &(Replay, Initial),
    test: &Swing,
) -> Result<RunBands, ReplayError> {
    let Data::Tunnel(record) = &campaign.runs[index].data else {
        return Err(ReplayError::NotTunnel { run: campaign.runs[index].name.clone() });
    };
    let (replay, initial) = base;
    let one = |(draw, plant): (usize, &Plant)| -> Result<(Swing, Swing), ReplayError> {
        let own = replay.with(&campaign.plant_for(plant, index));
        let mut normals = Seed { campaign: draw as u64, run: index as u64 }.normals(Channel::Varied(126));
        let z = std::array::from_fn(|_| normals.next().unwrap_or(0.0));
        let release = initial::again(&own, record, &own.sensors(), initial, z).unwrap_or(initial.release);
        let swing = |r: &Record| -> Result<Swing, ReplayError> { Ok(super::swing(&rates_and_angles(r, own.smoother())?)) };
        let noisy = own.draw(release, Seed { campaign: draw as u64, run: index as u64 })?;
        Ok((swing(&own.fly_as_far_as_it_goes(release)?.record)?, swing(&noisy.record)?))
    };
    let both: Vec<(Swing, Swing)> = plants.par_iter().enumerate().map(one).collect::<Result<_, _>>()?;
    let (still, draws): (Vec<Swing>, Vec<Swing>) = both.into_iter().unzip();
    let pick = |s: &Swing, k: usize| if k == 0 { s.theta_deg.clone() } else { s.omega_qr_deg_s.clone() };
    let bands = ["theta_deg", "omega_qr_deg_s"]
        .iter()
        .enumerate()
        .map(|(k, quantity)| band(quantity, record, &pick(test, k), &still.iter().map(|d| pick(d, k)).collect::<Vec<_>>()))
        .collect();
    Ok(RunBands { bands, draws })
}

fn band(quantity: &str, record: &Record, test: &[f64], draws: &[Vec<f64>]) -> Band {
    let n = draws.iter().map(Vec::len).min().unwrap_or(0).min(test.len());
    let every = n.div_ceil(POINTS).max(1);
    let mut b = Band {
        quantity: quantity.to_owned(),
        t_s: Vec::new(),
        test: Vec::new(),
        median: Vec::new(),
        low: Vec::new(),
        high: Vec::new(),
    };
    for i in (0..n).step_by(every) {
        let [low, median, high] = quantiles(draws.iter().map(|d| d[i]).collect());
        b.t_s.push(record.t_s[i] - record.t_s[0]);
        b.test.push(test[i]);
        b.median.push(median);
        b.low.push(low);
        b.high.push(high);
    }
    b
}

/// At [`ENDS`], linear between neighbours (Hyndman and Fan 1996, type 6: another draw lies inside with 95 % from 39 draws on).
fn quantiles(mut x: Vec<f64>) -> [f64; 3] {
    x.sort_by(f64::total_cmp);
    ENDS.map(|p| {
        let place = (p * (x.len() + 1) as f64 - 1.0).max(0.0);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place in the list")]
        let i = place as usize;
        x[i] + (place - i as f64) * (x[(i + 1).min(x.len() - 1)] - x[i])
    })
}

/// 95 % interval of each line of Table 5.6 over joined draws.
pub(super) fn intervals(draws: &[Swing]) -> Vec<[f64; 2]> {
    let tables: Vec<[f64; 6]> = draws.iter().map(table).collect();
    (0..LINES.len())
        .map(|k| {
            let [low, _, high] = quantiles(tables.iter().map(|t| t[k]).collect());
            [low, high]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_quantiles() {
        // 39 draws: the ends are the smallest and the largest.
        let q = quantiles((0..39).map(f64::from).collect());
        assert!((q[0] - 0.0).abs() < 1e-12 && (q[1] - 19.0).abs() < 1e-12 && (q[2] - 38.0).abs() < 1e-12, "{q:?}");
        // 59 draws k²: places 0.5, 29 and 57.5 from the first. Of three, the ends are the ends.
        let q = quantiles((0..59).map(|k| f64::from(k * k)).collect());
        assert!((q[0] - 0.5).abs() < 1e-12 && (q[1] - 841.0).abs() < 1e-12 && (q[2] - (3249.0 + 57.5)).abs() < 1e-9, "{q:?}");
        let of_three = quantiles(vec![5.0, 1.5, 3.0]);
        assert!(of_three.iter().zip([1.5, 3.0, 5.0]).all(|(q, end)| (q - end).abs() < 1e-15), "{of_three:?}");
        let [_, median, _] = quantiles(vec![1.0, 9.0, 4.0, 2.0]);
        assert!((median - 3.0).abs() < 1e-15);
    }

    /// 700 samples are shown by every third, from the first on, as far as the shortest draw goes; time is from the first sample, at 3.7 s.
    #[test]
    fn exact_band_of_a_long_run() {
        let record = Record { t_s: (0..700).map(|i| 3.7 + 0.01 * f64::from(i)).collect(), ..Record::default() };
        let test: Vec<f64> = (0..700).map(f64::from).collect();
        let draws = [690, 700, 695].map(|n| (0..n).map(|i| f64::from(i) + f64::from(n)).collect::<Vec<f64>>());
        let b = band("theta_deg", &record, &test, &draws);
        assert_eq!([b.t_s.len(), b.low.len(), b.test.len()], [230; 3]);
        for (i, t) in b.t_s.iter().enumerate() {
            let k = 3.0 * i as f64;
            assert!((t - 0.01 * k).abs() < 1e-12 && (b.test[i] - k).abs() < 1e-12);
            assert!((b.low[i] - k - 690.0).abs() + (b.median[i] - k - 695.0).abs() + (b.high[i] - k - 700.0).abs() < 1e-12);
        }
    }
}
