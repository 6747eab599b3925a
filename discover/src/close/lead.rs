//! discover: a lead for the engineer. In: a residual that no family explains. Out: where it is, what it varies with, its frequency.

use super::{ChannelResidual, Options, Unexplained};
use crate::tracks::{TrackEvidence, TrackFit};
use statrs::distribution::{ContinuousCDF, FisherSnedecor};
use windfall_model::Campaign;

/// Intervals of a variable over which the residual's mean is compared.
const INTERVALS: usize = 10;

/// Describes every channel beyond noise: the variable whose smooth curve explains most of it, and the strongest frequency.
pub(super) fn describe(
    campaign: &Campaign,
    evidence: &TrackEvidence,
    fit: &TrackFit,
    left: &[ChannelResidual],
    options: &Options,
) -> Vec<Unexplained> {
    let plant = fit.hypothesis.plant(&campaign.plant);
    let table = evidence.lead_table(&plant);
    left.iter()
        .enumerate()
        .filter(|(_, c)| c.p_value < options.false_alarm)
        .map(|(k, c)| {
            let size = format!("rms {:.3e} where noise leaves {:.3e} (p = {:.1e})", c.rms, c.expected_rms, c.p_value);
            let curve = table
                .variables
                .iter()
                .filter_map(|(name, x)| Some((name, curve(x, table.residuals.get(k)?)?)))
                .max_by(|a, b| a.1.share.total_cmp(&b.1.share));
            let varies = match curve {
                Some((name, c)) if c.p_value < options.false_alarm => follows(name, &c),
                _ => "; no flow variable, position or time explains it".to_owned(),
            };
            let peak =
                evidence.peak_hz(&fit.residual, k).map_or(String::new(), |f| format!("; strongest at {f:.2} Hz against noise"));
            Unexplained { channel: c.channel.clone(), description: format!("{size}{varies}{peak}") }
        })
        .collect()
}

fn follows(name: &str, c: &Curve) -> String {
    let points: Vec<String> = c.points.iter().map(|(x, y)| format!("{x:.3}→{y:+.2e}")).collect();
    format!("; {:.0} % of its variance below 2 Hz follows {name}: {}", 100.0 * c.share, points.join(", "))
}

struct Curve {
    share: f64,
    p_value: f64,
    points: Vec<(f64, f64)>,
}

/// Means over intervals of equal count: share of variance between them, with the F test of one-way analysis of variance on a
/// number of samples thinned to independent ones (one in ten).
fn curve(x: &[f64], y: &[f64]) -> Option<Curve> {
    let mut order: Vec<usize> = (0..x.len().min(y.len())).collect();
    if order.len() < 20 * INTERVALS {
        return None;
    }
    order.sort_by(|a, b| x[*a].total_cmp(&x[*b]));
    let mean = order.iter().map(|&i| y[i]).sum::<f64>() / order.len() as f64;
    let total: f64 = order.iter().map(|&i| (y[i] - mean).powi(2)).sum();
    let mut between = 0.0;
    let mut points = Vec::new();
    for part in order.chunks(order.len().div_ceil(INTERVALS)) {
        let n = part.len() as f64;
        let my = part.iter().map(|&i| y[i]).sum::<f64>() / n;
        points.push((part.iter().map(|&i| x[i]).sum::<f64>() / n, my));
        between += n * (my - mean).powi(2);
    }
    let independent = order.len() as f64 / 10.0;
    let (d1, d2) = (INTERVALS as f64 - 1.0, independent - INTERVALS as f64);
    let f = (between / d1) / ((total - between).max(f64::MIN_POSITIVE) / d2);
    let p_value = FisherSnedecor::new(d1, d2).ok()?.sf(f);
    Some(Curve { share: between / total, p_value, points })
}

#[cfg(test)]
mod tests;
