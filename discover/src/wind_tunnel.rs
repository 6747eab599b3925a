//! discover: identified static coefficients against points of a wind-tunnel balance (thesis figure 5.4). In: a campaign's points, curves.
//! Out: differences at every point and their size. Nothing is fitted to the points.

use serde::{Deserialize, Serialize};
use windfall_model::{Campaign, Plant, StaticPoints};
use windfall_pid::bands::{mean_speed_m_s, static_name, static_value, still_flow};
use windfall_pid::{DataSet, NORMAL_95};

/// One coefficient of one wind-tunnel test beside one or more models.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WindTunnelLine {
    /// Name of the test.
    pub test: String,
    /// `C_A`, `C_N,T` or `C_m`, about the geometric origin.
    pub quantity: String,
    /// Total angle of attack of each point, deg.
    pub angle_deg: Vec<f64>,
    /// Measured, dimensionless.
    pub measured: Vec<f64>,
    /// Standard uncertainty of each as stated; empty where none is.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub std: Vec<f64>,
    /// What it is held against.
    pub models: Vec<WindTunnelModel>,
}

/// A model at the points of a wind-tunnel test.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WindTunnelModel {
    /// Data set of an identification; `before` and `after` of a closing.
    pub model: String,
    /// Its value at each point.
    pub value: Vec<f64>,
    /// Standard error of that, from the covariance of the estimates; empty where it is not known.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub std: Vec<f64>,
    /// Root mean square of measured less model.
    pub rms: f64,
    /// Mean of measured less model.
    pub mean: f64,
    /// Points beyond the largest angle that the runs reached, where the model is extrapolated.
    pub beyond_runs: usize,
    /// Points whose difference is beyond 95 % of both stated uncertainties; none where the test states none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub apart: Option<usize>,
}

/// Points of a campaign beside models that are functions of coefficient and angle (rad).
fn lines(campaign: &Campaign, models: impl Fn(&StaticPoints) -> Vec<WindTunnelModel>) -> Vec<WindTunnelLine> {
    let one = |s: &StaticPoints| {
        let std: Option<Vec<f64>> = s.points.iter().map(|p| p.std).collect();
        Some(WindTunnelLine {
            test: s.test.clone(),
            quantity: static_name(s.coefficient)?.to_owned(),
            angle_deg: s.points.iter().map(|p| p.alpha_t_rad.to_degrees()).collect(),
            measured: s.points.iter().map(|p| p.value).collect(),
            std: std.unwrap_or_default(),
            models: models(s),
        })
    };
    campaign.knowledge.wind_tunnel.iter().filter_map(one).collect()
}

/// `at`: value and, where it is known, standard error at an angle.
fn model(name: &str, s: &StaticPoints, reached_rad: f64, at: impl Fn(f64) -> Option<[f64; 2]>) -> Option<WindTunnelModel> {
    let all: Vec<[f64; 2]> = s.points.iter().map(|p| at(p.alpha_t_rad)).collect::<Option<_>>()?;
    let known = all.iter().all(|x| x[1].is_finite());
    let n = all.len().max(1) as f64;
    let left: Vec<f64> = s.points.iter().zip(&all).map(|(p, m)| p.value - m[0]).collect();
    let far = |p: &windfall_model::StaticPoint, [value, std]: [f64; 2]| {
        let limit = NORMAL_95 * p.std?.hypot(if known { std } else { 0.0 });
        Some((p.value - value).abs() > limit)
    };
    let apart: Option<Vec<bool>> = s.points.iter().zip(&all).map(|(p, m)| far(p, *m)).collect();
    Some(WindTunnelModel {
        model: name.to_owned(),
        value: all.iter().map(|m| m[0]).collect(),
        std: if known { all.iter().map(|m| m[1]).collect() } else { Vec::new() },
        rms: (left.iter().map(|d| d * d).sum::<f64>() / n).sqrt(),
        mean: left.iter().sum::<f64>() / n,
        beyond_runs: s.points.iter().filter(|p| p.alpha_t_rad > reached_rad + 1e-9).count(),
        apart: apart.map(|a| a.into_iter().filter(|x| *x).count()),
    })
}

/// Every data set that has curves at the points of the campaign's wind-tunnel tests.
pub(crate) fn of_data_sets(campaign: &Campaign, sets: &[DataSet]) -> Vec<WindTunnelLine> {
    let speed = mean_speed_m_s(campaign);
    let reached = |d: &DataSet| {
        let ends = d.curves.iter().filter_map(|c| c.angle_deg.last());
        ends.copied().fold(0.0, f64::max).to_radians()
    };
    let of = |s: &StaticPoints, d: &DataSet| {
        let plant = d.plant_in(campaign).ok()?;
        model(&d.name, s, reached(d), |a| static_value(&plant.aero, speed, d, s.coefficient, a))
    };
    lines(campaign, |s| sets.iter().filter(|d| !d.curves.is_empty()).filter_map(|d| of(s, d)).collect())
}

/// Plants of a closing, by name, at the points of the campaign's wind-tunnel tests.
pub(crate) fn of_plants(campaign: &Campaign, plants: &[(&str, &Plant)], reached_rad: f64) -> Vec<WindTunnelLine> {
    let speed = mean_speed_m_s(campaign);
    let of = |s: &StaticPoints, (name, plant): &(&str, &Plant)| {
        let value = |a: f64| plant.aero.coefficients(&still_flow(a, speed))[s.coefficient as usize];
        model(name, s, reached_rad, |a| Some([value(a), f64::NAN]))
    };
    lines(campaign, |s| plants.iter().filter_map(|p| of(s, p)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use windfall_model::{Coefficient, StaticPoint};

    /// Two points off by +0.3 and −0.1: rms √0.05, mean 0.1; the second is within 1.96·√(0.04² + 0.03²) and beyond the runs.
    #[test]
    fn exact_differences() {
        let point = |alpha_t_rad, value| StaticPoint { alpha_t_rad, value, std: Some(0.04) };
        let s =
            StaticPoints { test: "t".to_owned(), coefficient: Coefficient::CN, points: vec![point(0.1, 1.3), point(0.3, 0.9)] };
        let m = model("combined", &s, 0.2, |_| Some([1.0, 0.03])).expect("known");
        assert!((m.rms - 0.05_f64.sqrt()).abs() < 1e-15 && (m.mean - 0.1).abs() < 1e-15);
        assert_eq!((m.beyond_runs, m.apart), (1, Some(2)), "−0.1 is beyond 0.098");
        let near = model("combined", &s, 0.2, |_| Some([0.98, 0.03])).expect("known");
        assert_eq!(near.apart, Some(1), "−0.08 is within it");
        assert!(model("m", &s, 0.2, |_| None).is_none());
    }

    /// A point at the largest angle that the runs reached, to rounding, is not beyond them.
    #[test]
    fn exact_points_beyond_the_runs() {
        let point = |alpha_t_rad| StaticPoint { alpha_t_rad, value: 1.0, std: None };
        let points = [0.1, 0.3 + 1e-15, 0.3 + 1e-8, 0.4].map(point).to_vec();
        let s = StaticPoints { test: "t".to_owned(), coefficient: Coefficient::CA, points };
        assert_eq!(model("m", &s, 0.3, |_| Some([1.0, f64::NAN])).expect("known").beyond_runs, 2);
    }
}
