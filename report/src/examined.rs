//! report: whether instruments agree and what runs can tell, in words and tables. In: the identifier's examination. Out: lines for the
//! terminal, sections of the page.

use crate::html::{Cell, escape, table};
use crate::words::{p_with_sign, with_interval};
use windfall_discover::{
    Compatibility, Correlation, DataSet, Identifiability, InstrumentError, Instruments, NotExamined, Pressure,
};

/// Lines for people: pressure against speed, then what trajectories tell.
#[must_use]
pub fn agreement(c: &Compatibility) -> Vec<String> {
    let mut all: Vec<String> = c.pressure.iter().map(|p| pressure_agreement(p, 0.5 * c.false_alarm_rate)).collect();
    match &c.instruments {
        Some(i) => instruments(i, 0.5 * c.false_alarm_rate, &mut all),
        None => all.push(format!("instruments by trajectories: not examined{}", c.not_examined.map_or("", why))),
    }
    all
}

/// Why trajectories were not examined.
fn why(reason: NotExamined) -> &'static str {
    match reason {
        NotExamined::NotAsked => " (that is a part of output error, which was not run)",
        NotExamined::NoAnswer => " (output error gave no answer)",
        NotExamined::NoAnswerWithErrors => " (output error gave no answer with the instruments' errors as unknowns)",
    }
}

/// Tunnel speed against dynamic pressure, in a line; they disagree where the chance of as much is below `limit`.
#[must_use]
pub fn pressure_agreement(p: &Pressure, limit: f64) -> String {
    let scale = of(p.pressure_scale, p.pressure_scale_ci95);
    if p.computed_from_speed {
        let word = if p.p_value < limit { ": more than moisture makes; check units, p_s, T_s and the gas constant" } else { "" };
        return format!("q_W was computed from V_W and says nothing of it; it is {scale} of ½ρV_W² of dry air{word}");
    }
    let delay = p.delay_s.zip(p.delay_ci95_s).map_or_else(
        || "V_W hardly changes, so no delay is determined".to_owned(),
        |(d, ci)| format!("{} s after V_W", of(d, ci)),
    );
    let (verdict, moist) = if p.p_value < limit { ("disagree", "; moist air makes it up to 0.9 % less") } else { ("agree", "") };
    format!("q_W and V_W {verdict} ({}): q_W is {scale} of ½ρV_W² of dry air{moist}, {delay}", p_with_sign(p.p_value))
}

fn of(x: f64, ci: [f64; 2]) -> String {
    let half = 0.5 * (ci[1] - ci[0]);
    if half < 1e-6 * x.abs() {
        return format!("{x:.6}");
    }
    let (x, half) = with_interval(x, Some(half));
    half.map_or_else(|| x.clone(), |h| format!("{x} ± {h}"))
}

fn error(e: &InstrumentError) -> String {
    format!("{} = {}", e.name, of(e.estimate, e.ci95))
}

fn instruments(i: &Instruments, limit: f64, all: &mut Vec<String>) {
    let list = |errors: &[InstrumentError], and: &str| errors.iter().map(error).collect::<Vec<_>>().join(and);
    if !i.residual.is_empty() {
        all.push(format!(
            "pose and V_W: not decided: the residual is not noise, whatever errors of the instruments are allowed for ({}): the declared \
             model lacks something; windfall close tells what",
            i.residual.join(", ")
        ));
    } else if i.p_value >= limit {
        let within = |e: &InstrumentError| format!("{} {:.1e}", e.name, e.ci95[1].max(-e.ci95[0]));
        let all_within = i.errors.iter().map(within).collect::<Vec<_>>().join(", ");
        all.push(format!("pose and V_W agree ({}); errors at most (95 %): {all_within}", p_with_sign(i.p_value)));
    } else {
        let rivals = if i.rivals.is_empty() {
            String::new()
        } else {
            format!(", or {}, which these runs cannot tell from it", list(&i.rivals, " or "))
        };
        all.push(format!(
            "pose and V_W disagree ({}) under the declared structure: {} accounts for it ({} of what is left){rivals}; correct the \
             record before the parameters are believed",
            p_with_sign(i.p_value),
            list(&i.account, " and "),
            p_with_sign(i.account_p_value)
        ));
    }
    let vague: Vec<String> = i
        .correlations
        .iter()
        .map(|c| format!("{} with {} ({:+.2})", c.second, c.first, c.correlation))
        .chain(i.not_told.iter().map(|n| format!("{n} (not at all)")))
        .collect();
    if !vague.is_empty() {
        all.push(format!("  hardly distinguished by these runs: {}", vague.join(", ")));
    }
}

/// Lines for the terminal as paragraphs, without their indents.
fn paragraphs(lines: &[String]) -> String {
    lines.iter().map(|l| format!("<p>{}</p>\n", escape(l.trim()))).collect()
}

/// The same for the page: lines, and each error of the instruments with its interval.
pub(crate) fn agreement_section(c: &Compatibility) -> String {
    let lines = paragraphs(&agreement(c));
    let row = |e: &InstrumentError| {
        let half = 0.5 * (e.ci95[1] - e.ci95[0]);
        let (estimate, half) = with_interval(e.estimate, Some(half));
        let unit = if e.unit == "-" { "" } else { e.unit.as_str() };
        vec![Cell::text(&e.name), Cell::Number(estimate), Cell::Number(half.unwrap_or_default()), Cell::text(unit)]
    };
    let rows: Vec<Vec<Cell>> = c.instruments.iter().flat_map(|i| &i.errors).map(row).collect();
    if rows.is_empty() { lines } else { lines + &table(&["error, the others free", "found", "± 95 %", "unit"], &rows) }
}

/// A correlation in four places, or in as many as tell it from one.
fn below_one(r: f64) -> String {
    let from_one = (1.0 - r.abs()).max(1e-12);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "4 to 13")]
    let places = (1.0 - from_one.log10().floor()).clamp(4.0, 13.0) as usize;
    format!("{r:+.places$}")
}

/// What the runs can tell of the declared parameters, in lines.
#[must_use]
pub fn identifiable(seen: &Identifiability) -> Vec<String> {
    let Identifiability { free, rank, condition, .. } = *seen;
    let all = if rank == free { String::new() } else { format!(" and determine {rank} combinations of them") };
    let first =
        format!("these runs tell {} of {free} parameters apart{all} (condition number {condition:.3e})", seen.told_apart());
    let pair = |c: &Correlation| format!("  {} and {}: errors correlated by {}", c.first, c.second, below_one(c.correlation));
    let set = |s: &Vec<String>| {
        format!("  not separable by these runs: {}: hold one, or add a run that excites them apart", s.join(", "))
    };
    std::iter::once(first).chain(seen.correlations.iter().map(pair)).chain(seen.inseparable.iter().map(set)).collect()
}

/// The same for the page, and the error that the sensors' noise alone would leave beside the stated one.
pub(crate) fn told(seen: &Identifiability, set: &DataSet) -> String {
    let lines = paragraphs(&identifiable(seen));
    let rows: Vec<Vec<Cell>> = seen
        .expected
        .iter()
        .map(|(name, expected)| {
            // Regression has a parameter of two coefficients twice, each with its own error.
            let mut stated: Vec<String> =
                set.parameters.iter().filter(|p| &p.name == name).map(|p| crate::number(p.std_error)).collect();
            stated.dedup();
            let stated = if stated.is_empty() { "–".to_owned() } else { stated.join(", ") };
            vec![Cell::text(name), Cell::number(*expected), Cell::Number(stated)]
        })
        .collect();
    let heads = ["parameter", "std error from sensors' noise alone", "std error stated"];
    if rows.is_empty() { lines } else { lines + &table(&heads, &rows) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use windfall_discover::Agreement;

    #[test]
    fn law_what_runs_tell_is_said_in_lines_and_escaped() {
        let seen = Identifiability {
            free: 3,
            rank: 2,
            condition: 429.74,
            correlations: vec![Correlation { first: "Cl_0".to_owned(), second: "<Cl_p>".to_owned(), correlation: -0.999_97 }],
            inseparable: vec![vec!["Cm_1".to_owned(), "Cn_1".to_owned()]],
            expected: vec![("CA_T0".to_owned(), 9.286e-5)],
        };
        let lines = identifiable(&seen);
        assert_eq!(lines.len(), 3);
        assert_eq!(
            lines[0],
            "these runs tell 0 of 3 parameters apart and determine 2 combinations of them (condition number 4.297e2)"
        );
        let set: DataSet = serde_json::from_value(serde_json::json!({
            "name": "combined", "runs": ["a"], "n_samples": 10, "condition_number": 1.0, "fits": [],
            "parameters": [], "covariance": [], "held": []
        }))
        .expect("a data set");
        let page = told(&seen, &set);
        for text in ["<td>CA_T0</td>", "9.286e-5", "&lt;Cl_p&gt;: errors correlated by -0.999970", "Cm_1, Cn_1: hold one"] {
            assert!(page.contains(text), "{text}: {page}");
        }
        assert!(!page.contains("[\"CA_T0\""), "a list of pairs is no text to read");
    }

    fn compatibility(verdict: Agreement, instruments: Option<Instruments>, not_examined: Option<NotExamined>) -> Compatibility {
        Compatibility { verdict, false_alarm_rate: 0.01, pressure: None, instruments, not_examined }
    }

    /// Only where output error was run can it have given no answer.
    #[test]
    fn exact_why_instruments_were_not_examined() {
        for (reason, said) in [
            (None, "not examined"),
            (Some(NotExamined::NotAsked), "not examined (that is a part of output error, which was not run)"),
            (Some(NotExamined::NoAnswer), "not examined (output error gave no answer)"),
        ] {
            let lines = agreement(&compatibility(Agreement::Undecided, None, reason));
            assert_eq!(lines, [format!("instruments by trajectories: {said}")]);
        }
    }

    /// A parameter that stands in a line of those hardly told apart is not among those that are.
    #[test]
    fn law_what_is_told_apart_is_in_no_line_below() {
        let pair = |first: &str, second: &str, correlation: f64| Correlation {
            first: first.to_owned(),
            second: second.to_owned(),
            correlation,
        };
        let seen = Identifiability {
            free: 11,
            rank: 11,
            condition: 1e4,
            correlations: vec![pair("Cl_0", "Cl_p", -0.999_999_7), pair("Cm_1", "Cm_2", 0.93), pair("Cl_0", "CA_T0", 0.91)],
            inseparable: vec![vec!["Cl_0".to_owned(), "Cl_p".to_owned()]],
            expected: Vec::new(),
        };
        let lines = identifiable(&seen);
        assert_eq!(lines[0], "these runs tell 6 of 11 parameters apart (condition number 1.000e4)");
        assert!(lines[1].ends_with("errors correlated by -0.99999970") && lines[2].ends_with("+0.9300"), "{lines:?}");
    }

    #[test]
    fn law_instruments_that_disagree_are_named_with_their_size() {
        let error = |name: &str, estimate: f64| InstrumentError {
            name: name.to_owned(),
            unit: "s".to_owned(),
            estimate,
            std_error: 0.001,
            ci95: [estimate - 0.002, estimate + 0.002],
        };
        let instruments = Instruments {
            errors: vec![error("wind_delay_s", 0.05)],
            p_value: 1e-9,
            account: vec![error("wind_delay_s", 0.05)],
            account_p_value: 0.4,
            rivals: Vec::new(),
            not_told: Vec::new(),
            correlations: Vec::new(),
            residual: Vec::new(),
        };
        let page = agreement_section(&compatibility(Agreement::Inconsistent, Some(instruments), None));
        for text in [
            "pose and V_W disagree",
            "wind_delay_s = 0.0500 ± 0.0020 accounts for it",
            "<td>wind_delay_s</td><td class=\"n\">0.0500</td>",
        ] {
            assert!(page.contains(text), "{text}: {page}");
        }
    }
}
