//! discover: a closing's conclusion in words. In: a closing. Out: its level and sentences, the same for terminal, page, JSON and Python.

use super::checks::failing_channels;
use super::judged::{CheckedRuns, Finding, Level, NotNamed};
use super::{Closing, EffectLine, HeldOut, ParameterLine, RunValue, Verdict};
use crate::words::{listed, number, plain_key};
use windfall_pid::NORMAL_95;

/// Share by which two errors differ that are not called the same: what four printed digits show.
const SAME: f64 = 5e-4;

impl Closing {
    /// Level and sentences. They follow from the other fields alone.
    #[must_use]
    pub fn concluded(&self) -> Finding {
        let level = match self.verdict {
            Verdict::Consistent | Verdict::Effect => Level::Good,
            Verdict::Unexplained if self.held_out_fails() => Level::Contradicted,
            Verdict::Unexplained => Level::Open,
        };
        let sentences = [contradicted(self, level), Some(self.lacks()), self.held_out_errors(), left(self)];
        Finding { level, sentence: sentences.into_iter().flatten().collect::<Vec<_>>().join(" ") }
    }

    /// The same with the finding as it follows from the rest.
    #[must_use]
    pub(super) fn with_finding(mut self) -> Self {
        self.finding = self.concluded();
        self
    }

    /// What the declared model lacks, in a sentence.
    #[must_use]
    pub fn lacks(&self) -> String {
        lacks(self)
    }

    /// All errors of runs held out, those that rose first, in a sentence; none without such runs.
    #[must_use]
    pub fn held_out_errors(&self) -> Option<String> {
        errors(self)
    }

    fn held_out_fails(&self) -> bool {
        self.checks.iter().any(|c| !c.ok && c.used == CheckedRuns::HoldOut)
    }
}

impl Closing {
    /// What is to be said of how runs were taken, what is not named and how the search ended, a text each.
    #[must_use]
    pub fn notes(&self) -> Vec<String> {
        let one_flight = |runs: &String| format!("{runs}: taken as one flight, each goes on where the one before it ended");
        let unfinished = |passes: f64| {
            format!(
                "the search ended unfinished, after {passes:.0} passes over the runs, all that it may do: a likelier set may not have been \
                 tried; with fewer runs or shorter ones it may come to its end"
            )
        };
        let departs = |words: &String| {
            format!("the declared model alone departs ({words}): what stands for before is the model with the effects")
        };
        let not_named = |n: &NotNamed| format!("{} is not named (probability {:.3}): {}", n.family, n.probability, n.reason);
        let carry = "something is unexplained: the errors of the parameters carry how far it may have moved them".to_owned();
        let carry = self.errors_carry_unexplained.then_some(carry);
        let departs = self.declared_departs.iter().map(departs);
        let record = self.record.iter().cloned().chain(windfall_pid::bandwidth::words(&self.bandwidth));
        let taken = record.chain(self.joined.iter().map(one_flight)).chain(departs).chain(self.not_named.iter().map(not_named));
        taken.chain(self.unfinished_passes.map(unfinished)).chain(carry).collect()
    }
}

/// What held-out runs say against it, before all else.
fn contradicted(c: &Closing, level: Level) -> Option<String> {
    let what = failing_channels(&c.checks, CheckedRuns::HoldOut);
    (level == Level::Contradicted).then(|| format!("Runs held out contradict what was identified ({what})."))
}

fn lacks(c: &Closing) -> String {
    let (weighed, names) = (c.candidates.len(), listed(&c.effects.iter().map(effect_name).collect::<Vec<_>>()));
    match c.verdict {
        Verdict::Consistent => {
            format!("The declared model leaves noise: no effect of the {weighed} weighed is needed.{}", moved_words(c))
        }
        Verdict::Effect => {
            let different: String = c.effects.iter().filter_map(EffectLine::most_different).map(difference).collect();
            format!("The declared model lacks {names}.{different}")
        }
        Verdict::Unexplained if c.effects.is_empty() => format!(
            "The declared model leaves a residual beyond noise in {} that no effect of the {weighed} weighed accounts for.",
            listed(&channels(c).iter().map(|u| plain_key(u).0).collect::<Vec<_>>()),
        ),
        Verdict::Unexplained if c.is_of_tracks() => {
            let words = match c.effects.len() {
                1 => "comes nearest to it, but its form does not hold",
                _ => "come nearest to it, but the form of none of them holds",
            };
            format!("The declared model lacks something: {names} {words}.")
        }
        Verdict::Unexplained => {
            format!("The declared model lacks {names}, and something else that no effect of the {weighed} weighed is.")
        }
    }
}

/// Declared parameters of tracks that the runs moved beyond their error. Tunnel runs are fitted from starting values, of which nothing is believed.
fn moved_words(c: &Closing) -> String {
    let far = |p: &&ParameterLine| p.moved().is_some_and(|m| m.abs() > NORMAL_95);
    let one = |p: &ParameterLine| {
        let half = p.std_error.map_or_else(String::new, |s| format!(" ± {}", number(NORMAL_95 * s)));
        format!("{} at {}{half} where the file has {}", p.name, number(p.estimate), number(p.declared.unwrap_or(f64::NAN)))
    };
    let all: Vec<String> = c.after.parameters.iter().filter(far).map(one).collect();
    if all.is_empty() || !c.is_of_tracks() { String::new() } else { format!(" It needs {}.", listed(&all)) }
}

/// By how much a run differs from what all have in common.
fn difference(r: &RunValue) -> String {
    let (scale, unit) = if r.unit == "-" { (100.0, "%") } else { (1e3, "mm") };
    let [value, half] = [r.value, NORMAL_95 * r.std_error].map(|x| scale * x);
    let sign = if value < 0.0 { "-" } else { "+" };
    format!(" Run {} differs most: {} {sign}{} ± {}\u{a0}{unit} (95 %).", r.run, r.name, number(value.abs()), number(half))
}

fn effect_name(e: &EffectLine) -> String {
    if e.rivals.is_empty() {
        e.family.clone()
    } else {
        format!("{} (or {}, which these data cannot tell from it)", e.family, e.rivals.join(" or "))
    }
}

/// Channels beyond noise, each once.
fn channels(c: &Closing) -> Vec<&str> {
    let mut all: Vec<&str> = Vec::new();
    for u in &c.unexplained {
        if !all.contains(&u.channel.as_str()) {
            all.push(&u.channel);
        }
    }
    all
}

/// An error of runs held out, with its unit as it follows a number.
type NamedError = (&'static str, f64, &'static str);

/// Every error of runs held out that there is, in one order.
fn named_errors(h: &HeldOut) -> Vec<NamedError> {
    let t = h.trajectory;
    let force = h.specific_force_rms.filter(|_| h.specific_moment_rms.is_none());
    let all = [
        t.and_then(|t| t.attitude_rms_deg).map(|x| ("attitude", x, "°")),
        h.position_rms_m.map(|x| ("position", 1e3 * x, "\u{a0}mm")),
        t.and_then(|t| t.rate_rms_deg_s).map(|x| ("body rate", x, "\u{a0}deg/s")),
        force.map(|f| ("specific force", f.iter().map(|x| x * x).sum::<f64>().sqrt(), "\u{a0}m/s²")),
    ];
    all.into_iter().flatten().collect()
}

/// All errors of runs held out, those that rose first; of a closing without effects as they are.
fn errors(c: &Closing) -> Option<String> {
    let (b, a) = (c.before.hold_out.as_ref()?, c.after.hold_out.as_ref()?);
    let after = named_errors(a);
    if c.effects.is_empty() || c.declared_departs.is_some() {
        let all: Vec<String> = after.iter().map(|(what, x, unit)| format!("{what} {}{unit}", number(*x))).collect();
        return (!all.is_empty()).then(|| format!("Errors of runs held out, rms: {}{}.", all.join(", "), of_noise(a)));
    }
    let before = named_errors(b);
    let pair = |(what, x, unit): &NamedError| Some((*what, before.iter().find(|o| o.0 == *what)?.1, *x, *unit));
    let mut pairs: Vec<_> = after.iter().filter_map(pair).collect();
    pairs.sort_by(|p, q| (q.2 / q.1).total_cmp(&(p.2 / p.1)));
    let mut all: Vec<String> = pairs.iter().map(|(what, b, a, unit)| went(what, *b, *a, unit)).collect();
    if let Some(gain) = a.log_likelihood.zip(b.log_likelihood).map(|(a, b)| a - b).filter(|g| g.is_finite()) {
        let way = if gain < 0.0 { "falls" } else { "rises" };
        let words = format!("log-likelihood {way} by {}", number(gain.abs()));
        all.insert(if gain < 0.0 { 0 } else { all.len() }, words);
    }
    let them = if c.effects.len() > 1 { "them" } else { "it" };
    (!all.is_empty()).then(|| format!("With {them} in, errors of runs held out, rms: {}{}.", all.join(", "), of_noise(a)))
}

/// What of it sensors' noise makes, where a run is flown from its first samples.
fn of_noise(h: &HeldOut) -> String {
    let Some(noise) = h.trajectory_of_noise else { return String::new() };
    let attitude = noise.attitude_rms_deg.map_or_else(String::new, |x| format!("attitude {}°, ", number(x)));
    format!(
        "; noise in the first samples, from which each run is flown, makes {attitude}position {}\u{a0}mm",
        number(1e3 * noise.position_rms_m)
    )
}

fn went(what: &str, before: f64, after: f64, unit: &str) -> String {
    let ratio = after / before;
    if (ratio - 1.0).abs() < SAME {
        return format!("{what} stays at {}{unit}", number(after));
    }
    let way = if ratio > 1.0 { "rises" } else { "falls" };
    format!("{what} {way} from {} to {}{unit}", number(before), number(after))
}

/// What remains, and in which runs that was looked at.
fn left(c: &Closing) -> Option<String> {
    match c.verdict {
        Verdict::Unexplained if c.effects.is_empty() => None,
        Verdict::Unexplained => Some(format!("A residual beyond noise remains in {}.", listed(&channels(c)))),
        Verdict::Effect | Verdict::Consistent => Some(remains(c).to_owned()),
    }
}

/// What is meant by noise.
fn remains(c: &Closing) -> &'static str {
    let tested = c.checks.iter().any(|l| l.used == CheckedRuns::HoldOut);
    match (c.noise_is_scatter, tested) {
        (false, true) => "The residual that remains is noise, in runs identified on and in runs held out.",
        (false, false) => "The residual that remains is noise in runs identified on; no run held out tests it.",
        (true, true) => {
            "The residual that remains repeats in no channel from run to run, identified on or held out; runs scatter by more than the sensors' noise."
        }
        (true, false) => {
            "The residual that remains repeats in no channel from run to run; runs scatter by more than the sensors' noise."
        }
    }
}

#[cfg(test)]
mod tests;
