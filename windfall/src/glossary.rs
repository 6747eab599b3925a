//! windfall: words that the terminal prints. In: what was typed. Out: what each word means, and which verbs print it.

use std::fmt::Write as _;

/// One entry: its names, the first of which heads it; its meaning; who prints it.
struct Entry(&'static [&'static str], &'static str, &'static str);

/// Entries in the order of the alphabet.
const ENTRIES: &[Entry] = &[
    Entry(
        &["95 % covers", "coverage", "coverage (95 % CI)"],
        "Share of 95 % intervals that hold the value put in. Near 95 % where the stated errors are true.",
        "identify --bootstrap, study",
    ),
    Entry(
        &["95 % interval", "interval", "ci95", "±", "95 %"],
        "Range that holds the true value in 95 of 100 campaigns, if the declared model is right: the estimate and 1.96 standard errors to either side.",
        "identify, close",
    ),
    Entry(&["95 % of descents"], "Values between which 95 of 100 descents lie: quantiles 0.025 and 0.975.", "descend"),
    Entry(
        &["95 % over parameters drawn"],
        "Range of 95 of 100 simulations with parameters drawn from the posterior.",
        "resimulate --draws",
    ),
    Entry(&["after"], "With the effects that were found added to the declared model.", "close"),
    Entry(&["after/before"], "The error with the effects over the error without them. Below 1 where they help.", "close"),
    Entry(&["aloft"], "Descents that had not reached the ground when the flight's duration ended.", "descend"),
    Entry(&["at touch-down"], "Quantity when the body reaches the ground.", "descend"),
    Entry(&["before"], "With the declared model alone.", "close"),
    Entry(
        &["between"],
        "Standard deviation of a parameter between campaigns, beside the errors that each states (τ of a random-effects model; Paule and Mandel 1982).",
        "many",
    ),
    Entry(&["bias"], "Mean error of the estimates: their mean less the value put in.", "study"),
    Entry(
        &["bias/s.e."],
        "Mean error of the copies over the stated standard error. Near 0 where the method is unbiased.",
        "identify --bootstrap",
    ),
    Entry(&["bound"], "Largest or smallest figure that a check accepts, with where it comes from in brackets.", "verify"),
    Entry(
        &["chance from noise alone", "chance"],
        "Probability that noise alone makes some effect of the catalogue look as likely as this one.",
        "close",
    ),
    Entry(
        &["coef", "coefficient"],
        "Aerodynamic coefficient in body axes: CA axial, CY side and CN normal force; Cl roll, Cm pitch and Cn yaw moment. A force over dynamic pressure and area; a moment over these and the diameter.",
        "identify, structure, study",
    ),
    Entry(
        &["condition number"],
        "Largest over smallest singular value of the regressors, columns scaled. Large where the runs hardly tell some parameters apart; above 1e5 the estimates lose five digits.",
        "identify",
    ),
    Entry(&["consistent"], "Verdict: the declared model leaves a residual that noise explains.", "close"),
    Entry(&["covariance"], "Squares of the standard errors, and what the errors of two parameters share.", "identification.json"),
    Entry(&["data set"], "Runs that are identified together: one kind of run, or all of them (combined).", "identify"),
    Entry(&["each s"], "Length of each run, s.", "plan"),
    Entry(
        &["effect"],
        "A physical cause of the catalogue that the declared model lacks. Verdict `effect`: one or several explain the residual.",
        "close",
    ),
    Entry(
        &["equation-error"],
        "Method: accelerations from the smoothed record are regressed on the declared terms (Klein and Morelli 2006, ch. 5). Quick; its intervals need perturbed runs.",
        "identify",
    ),
    Entry(
        &["error %", "wanted"],
        "Standard error in percent of the estimate: what the planned runs bring, or what was asked for.",
        "plan",
    ),
    Entry(
        &["error on runs held out", "error on runs held out, rms", "held out", "hold-out"],
        "Error of the model on runs that took no part in the fit. Only the initial state is estimated from them.",
        "close, resimulate",
    ),
    Entry(&["estimate"], "Value of a parameter that fits the runs best by the method.", "identify, close, structure"),
    Entry(
        &["expected log odds"],
        "By how much a planned run raises the log odds of the one effect or the other, on average, if it is the right one.",
        "plan --separate",
    ),
    Entry(&["failed"], "Flights or campaigns that ended in an error, which is counted and named.", "descend, many, study"),
    Entry(
        &["filter-error"],
        "Method: parameters by maximum likelihood of a Kalman filter's innovations, gusts being process noise (Maine and Iliff 1981).",
        "identify",
    ),
    Entry(
        &["flown again"],
        "The run simulated by the model from its estimated initial state, with the recorded tunnel speed.",
        "close, resimulate",
    ),
    Entry(
        &["gain of log-likelihood", "log-likelihood"],
        "Logarithm of the probability density of a record under a model. A gain of 3 is odds of twenty to one.",
        "close",
    ),
    Entry(&["hangs on"], "Parameters that make most of the scatter, each with its share and the sign of its slope.", "descend"),
    Entry(&["held"], "A parameter that is kept at a value and is not estimated (--hold).", "identify"),
    Entry(
        &["identifiability", "tell apart", "errors correlated"],
        "Whether the runs determine each parameter. Errors correlated by nearly 1 or -1 mean that only a combination of two is known.",
        "identify",
    ),
    Entry(&["in folds"], "Share of cross-validation folds (runs left out in turn) that choose the term as well.", "structure"),
    Entry(
        &["innovation"],
        "What was measured less what the filter predicted one step before. White where the model is right.",
        "identify, close",
    ),
    Entry(&["landed"], "Descents that reached the ground.", "descend"),
    Entry(&["mean"], "Average over runs, draws or descents.", "descend, many"),
    Entry(&["mean ± 95 %"], "Mean of a parameter over campaigns with its 95 % interval (Hartung and Knapp 2001).", "many"),
    Entry(&["method"], "How parameters are estimated: thesis, equation-error, output-error or filter-error.", "identify, study"),
    Entry(&["minutes"], "Tunnel time with the time between runs, min.", "plan"),
    Entry(
        &["misfit"],
        "Mean of squared pose residuals over the sensors' variances, where the initial state was estimated. 1 for a right model.",
        "resimulate",
    ),
    Entry(&["n"], "Number of campaigns.", "many"),
    Entry(
        &["noise", "expected_rms"],
        "Root mean square that the instruments' noise alone would leave, as it was learnt from the record.",
        "close",
    ),
    Entry(&["nominal"], "Of the estimates themselves, in even air from the exact start.", "descend"),
    Entry(&["offset m"], "Distance of the release from the tunnel's axis, m.", "plan --separate"),
    Entry(
        &["one more campaign, 95 %", "one more campaign"],
        "Range in which the parameter of one more campaign would lie with 95 % (Nagashima, Noma and Furukawa 2019).",
        "many",
    ),
    Entry(
        &["output-error"],
        "Method: parameters and initial states by maximum likelihood of simulated trajectories (Klein and Morelli 2006, ch. 6). For records without turbulence.",
        "identify",
    ),
    Entry(
        &["over campaigns (random effects)"],
        "A parameter of several campaigns, each with its stated error, pooled by a random-effects model.",
        "many",
    ),
    Entry(
        &["p", "p before", "p after", "p-value", "p value"],
        "Probability that noise alone leaves a residual, or a difference, at least as unlike noise as this. Below 0.01 something is there.",
        "close, identify, many",
    ),
    Entry(
        &["p(white)", "white", "whiteness"],
        "Probability that white noise looks as coloured as the residual (Ljung and Box 1978 for regressions, an F test of the periodogram for trajectories). A small one says that the model lacks something.",
        "identify",
    ),
    Entry(
        &["parameter", "parameters"],
        "A number of the declared model that is estimated. Of descents: share of the scatter that the parameters make.",
        "identify, study, descend",
    ),
    Entry(
        &["partial F"],
        "Increase of the residual's sum of squares when the term is left out, over the residual's variance. What noise adds is below about 10.",
        "structure",
    ),
    Entry(&["posterior"], "Probability of parameters given the runs: estimates with their covariance.", "descend, resimulate"),
    Entry(&["prior"], "What is known of a number before the runs: a mean and a standard deviation.", "identify --prior, close"),
    Entry(
        &["position", "position (m)", "position, flown again (mm)"],
        "Root mean square distance between measured and simulated origin.",
        "close, resimulate",
    ),
    Entry(
        &["attitude", "attitude (deg)", "attitude, flown again (deg)"],
        "Root mean square angle between measured and simulated attitude, deg.",
        "close, resimulate",
    ),
    Entry(
        &["rates", "rates (deg/s)", "body rates, flown again (deg/s)"],
        "Root mean square difference of the body's angular rates, deg/s.",
        "close, resimulate",
    ),
    Entry(
        &["force over mass (m/s2)", "force over mass"],
        "Difference of measured and modelled force, over the mass: an acceleration.",
        "close",
    ),
    Entry(
        &["moment over inertia (rad/s2)", "moment over inertia"],
        "Difference of measured and modelled moment, over the inertia: an angular acceleration.",
        "close",
    ),
    Entry(
        &["quantity"],
        "What is compared: the pole angle Θ or the rate across the axis ω_q,r, as in Table 5.6 of the thesis.",
        "resimulate",
    ),
    Entry(
        &["R²", "R2"],
        "Share of a coefficient's variance that the model explains; 1 is all of it (thesis eq. 4.18).",
        "identify",
    ),
    Entry(
        &["ratio"],
        "Scatter of the estimates over the stated standard error. 1 where the stated errors are true.",
        "identify --bootstrap, study",
    ),
    Entry(&["release deg"], "Angle of the model's axis from the vertical at release, deg.", "plan"),
    Entry(&["residual"], "What was measured less what the model says.", "identify, close"),
    Entry(
        &["residual rms of identified runs"],
        "Root mean square of innovations, channel by channel, on the runs that were fitted.",
        "close",
    ),
    Entry(
        &["residual std"],
        "Standard deviation of the residual (thesis eq. 4.17), in the coefficient's or the channel's unit.",
        "identify",
    ),
    Entry(
        &["rival", "rivals"],
        "Another effect, or set of effects, that explains these runs within odds of twenty to one.",
        "close, plan --separate",
    ),
    Entry(&["rms"], "Root mean square.", "close, identify, resimulate"),
    Entry(
        &["RSE %", "RSE", "relative standard error"],
        "Relative standard error: the standard error in percent of the estimate (thesis eq. 4.21).",
        "identify",
    ),
    Entry(&["run"], "One recorded flight.", "resimulate, plan"),
    Entry(&["runs"], "Number of recorded flights.", "plan"),
    Entry(&["samples"], "Rows of a record.", "identify, simulate, check"),
    Entry(
        &["scatter"],
        "Standard deviation of the estimates from draw to draw, or from copy to copy.",
        "identify --bootstrap, study",
    ),
    Entry(
        &["seed", "seeds"],
        "Number that all chance is drawn from. The same seed gives the same bytes.",
        "simulate, resimulate, descend, study",
    ),
    Entry(&["simulation"], "The statistic of the flights that the identified model makes.", "resimulate"),
    Entry(&["shown"], "A figure of verify that is printed and has no bound.", "verify"),
    Entry(
        &["something-else", "something else"],
        "What no effect of the catalogue is. In a list of sets: smooth loads or instrument errors that vary with anything known along the runs. Where something is unexplained it is in every set.",
        "close",
    ),
    Entry(&["speed swing"], "Amplitude of the tunnel speed's swing, in percent of its mean.", "plan --separate"),
    Entry(&["spin deg/s"], "Roll rate at release, deg/s.", "plan --separate"),
    Entry(&["length s"], "Length of the run, s.", "plan --separate"),
    Entry(&["stated"], "Mean of the standard errors that the method states.", "study"),
    Entry(&["statistic"], "Mean, median or standard deviation of a quantity over a run.", "resimulate"),
    Entry(&["std", "standard deviation", "std over seeds"], "Standard deviation: scatter about the mean.", "descend, resimulate"),
    Entry(
        &["std error", "standard error", "s.e."],
        "Standard deviation of an estimate's error, as the method states it from the residual and its colour.",
        "identify, structure, plan",
    ),
    Entry(&["term"], "A product of powers of flow variables, with one parameter as its factor.", "structure"),
    Entry(&["test"], "The statistic of the measured runs.", "resimulate"),
    Entry(
        &["thesis"],
        "Method: the published one, Fourier smoothing and ordinary least squares (thesis ch. 3 and 4); with figures, the thesis' own.",
        "identify, verify",
    ),
    Entry(&["tumbled"], "Descents with a total angle of attack above 90° somewhere.", "descend"),
    Entry(&["unexplained"], "Verdict: a residual beyond noise remains that no effect of the catalogue accounts for.", "close"),
    Entry(
        &["use"],
        "What a run is for: identify (fitted), select (chooses between sets of effects) or hold-out (only reported).",
        "resimulate, check",
    ),
    Entry(
        &["verdict"],
        "What a closing comes to: consistent, effect or unexplained; of checks: pass or fail.",
        "close, many, verify",
    ),
    Entry(
        &[
            "valid for",
            "envelope",
            "α_T deg",
            "|p| deg/s",
            "|q| deg/s",
            "|r| deg/s",
            "V_∞ m/s",
            "Reynolds",
            "time s",
            "kind, use",
        ],
        "How far the runs of a data set went: largest angle and rates, airspeed, Reynolds number (thesis Table 5.1). Beyond it parameters are extrapolated.",
        "identify, check",
    ),
    Entry(&["what"], "The term in words.", "structure"),
    Entry(
        &["when flown"],
        "Log odds that the run brought when it was flown by the simulator, with the one effect and with the other.",
        "plan --separate",
    ),
    Entry(
        &["white s.e.", "white standard error"],
        "Standard error if residuals were white (thesis eq. 4.20). Too small where they are coloured.",
        "identify",
    ),
    Entry(&["wind_scale"], "Error of an instrument: recorded tunnel speed over true, less 1.", "identify"),
    Entry(
        &["wind_delay_s"],
        "Error of an instrument: by how much the recorded tunnel speed lags behind the pose, s.",
        "identify",
    ),
    Entry(&["angle_delay_s"], "Error of an instrument: by how much the recorded angles lag behind the positions, s.", "identify"),
    Entry(
        &["misalignment_x_rad", "misalignment_y_rad", "misalignment_z_rad", "misalignment"],
        "Error of an instrument: turn of the tracked axes against the body's, about one body axis, rad.",
        "identify",
    ),
    Entry(
        &["lever_x_m", "lever_y_m", "lever_z_m", "lever"],
        "Error of an instrument: place of the tracked point against the declared origin, along one body axis, m.",
        "identify",
    ),
];

/// Whether `text` has `phrase` as words of their own; both in small letters.
fn has(text: &str, phrase: &str) -> bool {
    let edge = |c: Option<char>| c.is_none_or(|c| !(c.is_alphanumeric() || c == '_' || c == '-'));
    let mut from = 0;
    while let Some(i) = text[from..].find(phrase).map(|i| from + i) {
        let end = i + phrase.len();
        let open = !phrase.starts_with(char::is_alphanumeric) || edge(text[..i].chars().next_back());
        let closed = !phrase.ends_with(char::is_alphanumeric) || edge(text[end..].chars().next());
        if open && closed {
            return true;
        }
        from = i + phrase.chars().next().map_or(1, char::len_utf8);
    }
    false
}

/// Entries whose words were typed. Words within a longer phrase that was found (`std error` in `white std error`) are not explained apart where the
/// phrase is all that was typed.
pub(crate) fn explained(said: &str) -> String {
    let said = said.to_lowercase();
    let is_all = |e: &&Entry| e.0.iter().any(|n| n.to_lowercase() == said.trim());
    let exact: Vec<&Entry> = ENTRIES.iter().filter(is_all).collect();
    let found = if exact.is_empty() {
        ENTRIES.iter().filter(|e| e.0.iter().any(|n| n.chars().count() > 1 && has(&said, &n.to_lowercase()))).collect()
    } else {
        exact
    };
    let mut out = String::new();
    for Entry(names, meaning, verbs) in found {
        let _ = write!(out, "{}: a word on the screen\n  {meaning}\n  printed by: {verbs}\n", names.join(", "));
    }
    out
}

/// A few of the words that have an entry.
pub(crate) fn some() -> String {
    ["p(white)", "RSE", "R²", "residual", "condition number", "rivals", "held out"].join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `docs/glossary.md`.
    fn page() -> String {
        let mut out =
            "# Glossary\n\nThe words of the terminal and of the pages. `windfall explain WORD` prints an entry.\n\n".to_owned();
        for Entry(names, meaning, verbs) in ENTRIES {
            let others = if names.len() > 1 { format!(" ({})", names[1..].join(", ")) } else { String::new() };
            let _ = writeln!(out, "- **{}**{others}: {meaning} *{verbs}*", names[0]);
        }
        out
    }

    /// The page is written from the entries: `WINDFALL_WRITE_REFERENCE=1 cargo test -p windfall --lib -- reference`.
    #[test]
    fn frozen_reference_of_words() {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/glossary.md");
        if std::env::var_os("WINDFALL_WRITE_REFERENCE").is_some() {
            std::fs::write(&path, page()).expect("docs are writable");
        }
        let stored = std::fs::read_to_string(&path).expect("docs/glossary.md");
        assert!(stored == page(), "docs/glossary.md is old: run `just references`");
    }

    #[test]
    fn law_words_on_the_screen_are_explained() {
        for word in ["p(white)", "P(WHITE)", "RSE", "residual", "condition number", "95 % interval", "R²", "white s.e."] {
            let text = explained(word);
            assert!(text.contains("a word on the screen") && text.matches("printed by").count() == 1, "{word}: {text}");
        }
        let warning = explained("the residual is not noise in VW_m_s; see condition number");
        assert!(warning.contains("residual:") && warning.contains("condition number:"), "{warning}");
        assert_eq!(explained("nothing of ours here"), "");
        assert_eq!(explained("residuals_of"), "");
    }

    /// Short sentences, each name once.
    #[test]
    fn law_entries_are_short_and_apart() {
        let mut names: Vec<String> = ENTRIES.iter().flat_map(|e| e.0.iter().map(|n| n.to_lowercase())).collect();
        let all = names.len();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), all, "a name in two entries");
        for Entry(names, meaning, verbs) in ENTRIES {
            assert!(!names.is_empty() && !verbs.is_empty(), "{names:?}");
            for sentence in meaning.split(['.', ';', ':']) {
                assert!(sentence.split_whitespace().count() <= 30, "{sentence}");
            }
        }
    }
}
