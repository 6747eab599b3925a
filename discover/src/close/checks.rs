//! discover: absolute checks of a closing. In: mean squares of innovations, p-values. Out: which runs and channels are noise, all held to one
//! level, and what is said of those that are not.

use super::judged::{CheckLine, CheckedRuns};
use super::result::Unexplained;
use crate::residual::ChannelResidual;
use crate::words::{listed, number, p_with_sign};
use windfall_likelihood::{CONTRADICTED, MeanSquare};
use windfall_model::CHANNEL_NAMES;

/// Chance that any check fails where the model and its noise are right (chosen: as of identification's tests).
pub(super) const LEVEL: f64 = 0.01;
/// What the check is called in which numbers may move within what identification leaves of them.
pub(super) const PARAMETERS: &str = "parameters";
/// What the check is called of held-out runs under the declared model and with effects.
pub(super) const LIKELIHOOD: &str = "log-likelihood";

/// Mean squares of runs as checks, not yet held to a level.
pub(super) fn of_squares(used: CheckedRuns, squares: &[MeanSquare]) -> Vec<CheckLine> {
    let one = |s: &MeanSquare| CheckLine {
        run: s.run.clone(),
        used,
        what: CHANNEL_NAMES[s.channel].to_owned(),
        mean_square: Some(s.mean_square).filter(|m| m.is_finite()),
        p_value: s.p_value(),
        ok: true,
    };
    squares.iter().map(one).collect()
}

/// Channels of tracks as checks of all runs together, not yet held to a level.
pub(super) fn of_channels(used: CheckedRuns, channels: &[ChannelResidual]) -> Vec<CheckLine> {
    let one = |c: &ChannelResidual| CheckLine {
        mean_square: Some((c.rms / c.expected_rms).powi(2)).filter(|m| m.is_finite()),
        ..of_all(used, &c.channel, if c.p_value.is_finite() { c.p_value } else { 0.0 })
    };
    channels.iter().map(one).collect()
}

/// A check of all runs of a use together.
pub(super) fn of_all(used: CheckedRuns, what: &str, p_value: f64) -> CheckLine {
    CheckLine { run: String::new(), used, what: what.to_owned(), mean_square: None, p_value, ok: true }
}

/// Holds checks to [`LEVEL`], all together (Holm 1979): the k-th least p-value of n fails below `level/(n - k)` where all before it fail.
pub(super) fn hold(checks: &mut [CheckLine]) {
    let mut order: Vec<usize> = (0..checks.len()).collect();
    order.sort_by(|a, b| checks[*a].p_value.total_cmp(&checks[*b].p_value));
    let n = order.len();
    for (k, i) in order.into_iter().enumerate() {
        if checks[i].p_value >= LEVEL / (n - k) as f64 {
            break;
        }
        checks[i].ok = false;
    }
}

/// Whether the held-out runs are likelier with the effects, at the odds from which they contradict them. Beside the level: odds are no p-value.
pub(super) fn of_gain(gain: f64) -> CheckLine {
    CheckLine { ok: gain >= -CONTRADICTED, ..of_all(CheckedRuns::HoldOut, LIKELIHOOD, gain.exp().min(1.0)) }
}

/// What is said of the checks that fail in runs of a use: the worst of them, and how many there are; none where all hold.
pub(super) fn said(checks: &[CheckLine], used: CheckedRuns) -> Option<Unexplained> {
    let own: Vec<&CheckLine> =
        checks.iter().filter(|c| c.used == used && ![PARAMETERS, LIKELIHOOD].contains(&c.what.as_str())).collect();
    let failed: Vec<&&CheckLine> = own.iter().filter(|c| !c.ok).collect();
    let size = |c: &CheckLine| c.mean_square.unwrap_or(f64::INFINITY);
    let worst = failed.iter().max_by(|a, b| b.p_value.total_cmp(&a.p_value).then(size(a).total_cmp(&size(b))))?;
    let runs = if used == CheckedRuns::HoldOut { "held-out run" } else { "run" };
    let of = if worst.run.is_empty() { format!("{runs}s: ") } else { format!("{runs} {}: ", worst.run) };
    let times = worst.mean_square.map_or("the model departs".to_owned(), |m| {
        format!("the mean square of what is left is {} of noise's ({})", number(m), p_with_sign(worst.p_value))
    });
    let more = match failed.len() - 1 {
        0 => String::new(),
        n => format!("; {n} more of {} checks of runs and channels fail", own.len()),
    };
    Some(Unexplained { channel: worst.what.clone(), description: format!("{of}{times}{more}") })
}

/// What is said where held-out runs ask for other numbers than those identified, or are less likely with the effects than without.
pub(super) fn said_of_all(checks: &[CheckLine], channel: &str) -> Vec<Unexplained> {
    let words = |c: &&CheckLine| match c.what.as_str() {
        PARAMETERS => Some(format!(
            "varies with run: the held-out runs ask for other values of the parameters than those identified ({})",
            p_with_sign(c.p_value)
        )),
        LIKELIHOOD => Some(format!(
            "varies with run: the held-out runs are less likely with what is named here than without (odds {} to one against it); it is of \
             another form, or does not act in them",
            number(1.0 / c.p_value.max(1e-300))
        )),
        _ => None,
    };
    let failed = checks.iter().filter(|c| !c.ok);
    failed.filter_map(|c| words(&c)).map(|description| Unexplained { channel: channel.to_owned(), description }).collect()
}

/// Names of the channels that fail in runs of a use, each once.
pub(crate) fn failing_channels(checks: &[CheckLine], used: CheckedRuns) -> String {
    let mut all: Vec<&str> = checks.iter().filter(|c| !c.ok && c.used == used).map(|c| c.what.as_str()).collect();
    all.sort_unstable();
    all.dedup();
    listed(&all)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(p_value: f64) -> CheckLine {
        of_all(CheckedRuns::HoldOut, CHANNEL_NAMES[0], p_value)
    }

    /// Of four checks the least must be below 0.25 %, the next below 0.33 %, the next below 0.5 %, the last below 1 %.
    #[test]
    fn exact_all_together_at_one_level() {
        let held = |p: [f64; 4]| {
            let mut all: Vec<CheckLine> = p.into_iter().map(line).collect();
            hold(&mut all);
            all.into_iter().map(|c| c.ok).collect::<Vec<_>>()
        };
        assert_eq!(held([0.009, 0.0026, 0.5, 0.7]), [true; 4]);
        assert_eq!(held([0.009, 0.0024, 0.5, 0.0032]), [true, false, true, false]);
        assert_eq!(held([0.0099, 0.0024, 0.0049, 0.0032]), [false; 4]);
    }

    /// A mean square of 1.4 known to a tenth: χ² of 200 degrees above 280, `e⁻¹⁴⁰ Σ 140ᵏ/k!` over k below 100.
    #[test]
    fn exact_a_mean_square() {
        let square = MeanSquare { run: "r".to_owned(), channel: 3, mean_square: 1.4, std: 0.1 };
        let lines = of_squares(CheckedRuns::HoldOut, &[square.clone(), MeanSquare { mean_square: f64::NAN, ..square }]);
        assert!((lines[0].p_value / 1.610_571_747e-4 - 1.0).abs() < 1e-6, "{}", lines[0].p_value);
        assert!(lines[1].p_value.abs() < 1e-300 && lines[1].mean_square.is_none());
    }
}
