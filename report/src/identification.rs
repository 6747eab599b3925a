//! report: pages of identifications and re-simulations. In: their JSON. Out: parameters with intervals as figure and table, fits,
//! curves with bands, what the runs can tell, how near the flights come.

use crate::chart::Range;
use crate::draw::Look;
use crate::envelope::{envelopes, validity};
use crate::examined::{agreement_section, told};
use crate::html::{Cell, escape, section, table};
use crate::legend::key;
use crate::plot::{Plot, Plots};
use crate::shape::warnings;
use crate::wind_tunnel::{differences, points};
use crate::words::{number, p_value, with_interval};
use serde_json::Value;
use windfall_discover::close::{Figure, Role, Series, Topic};
use windfall_discover::{DataSet, FoundNumber, Identification, Identified, NORMAL_95, TestTable, WindTunnelLine};
use windfall_replay::{Bootstrap, Resimulation, RunComparison};

/// The body of an identification; none for what is none.
pub(crate) fn identification(value: &Value, plots: &mut Plots) -> Option<String> {
    let found: Identified = serde_json::from_value(value.clone()).ok()?;
    let all = &found.found;
    let combined = all.combined()?;
    let reason = all.reason.as_deref().map_or_else(String::new, |r| format!(", taken because {r}"));
    let lead = format!(
        "Method {}{reason}. {} samples of {} runs: {}.",
        all.method,
        combined.n_samples,
        combined.runs.len(),
        combined.runs.join(", ")
    );
    let mut out = format!("<p class=\"lead\">{}</p>\n", escape(&lead));
    let note = "Look whether runs held out go beyond those identified on: there the model is extrapolated. Largest angle of attack and rates, as in the \
                thesis' Table 5.1; records smoothed by splines, Reynolds number of the reference diameter.";
    out += &section("What the runs reached", note, &envelopes(&TestTable::of(all)));
    let mut figures = String::new();
    let mut coefficients: Vec<&str> = combined.parameters.iter().map(|p| p.coefficient.as_str()).collect();
    coefficients.dedup();
    for c in coefficients {
        figures += &estimates(all, c, plots);
    }
    let look = "Look for short bars and for kinds of run that agree: blue are all runs together, grey each kind alone; the dashed line is \
                the estimate of all.";
    out += &section("Parameters", look, &(figures + &parameters(combined) + &beside(combined)));
    for set in all.data_sets.iter().filter(|d| d.name != combined.name) {
        out += &section(&format!("Parameters from {} runs alone", set.name), "The same from one kind of run.", &parameters(set));
    }
    let curves: Vec<Figure> = value["data_sets"]
        .as_array()?
        .iter()
        .filter(|d| d["name"] == combined.name.as_str())
        .flat_map(|d| d.get("curves").and_then(Value::as_array).into_iter().flatten())
        .filter_map(|c| curve(c, &found.wind_tunnel))
        .collect();
    let note = "Look how narrow the bands are where the flight will be; a curve is worth little beyond the angles that were flown. Shaded, \
                and ± in the titles: 95 % at each point, from the covariance of the estimates.";
    let drawn = plots.charts(curves);
    let mut marks = vec![("after", "all runs, shaded: 95 %")];
    if !found.wind_tunnel.is_empty() {
        marks.push(("point", "wind-tunnel points, bar: 95 %"));
    }
    let keys = key(&marks);
    out +=
        &section("Coefficients and damping over the angle", note, &if drawn.is_empty() { drawn } else { keys + &grid(&drawn) });
    let note = "Look for points inside the bands, and for a mean difference that is small beside the rms: what is left is then scatter of the \
                balance. Nothing was fitted to them. Static coefficients about the geometric origin.";
    out += &section("Against the wind tunnel", note, &differences(&found.wind_tunnel, |m| format!("{m} runs")));
    out += &fits(combined);
    let note = "Look for as many combinations as parameters. Pairs of correlated errors are known only together.";
    out +=
        &section("What the runs can tell", note, &all.identifiability.as_ref().map_or_else(String::new, |i| told(i, combined)));
    let note = "Speed against dynamic pressure, and motion against itself.";
    out +=
        &section("Whether the instruments agree", note, &all.compatibility.as_ref().map_or_else(String::new, agreement_section));
    let note = "Look for ratios near one: scatter of the estimates over copies of the campaign, over the stated error.";
    out += &section("Stated errors against copies", note, &found.bootstrap.as_ref().map_or_else(String::new, copies));
    Some(out + &warnings(&all.warnings))
}

/// Constants and effects of the model beside its parameters; nothing where there are none.
fn beside(set: &DataSet) -> String {
    let row = |name: String, p: &FoundNumber| {
        let error = p.std_error.map_or_else(|| Cell::text("held"), Cell::number);
        vec![Cell::text(name), Cell::number(p.estimate), error, Cell::text(if p.unit == "-" { "" } else { &p.unit })]
    };
    let mut rows: Vec<Vec<Cell>> = set.constants.iter().map(|c| row(c.name.clone(), c)).collect();
    for e in &set.effects {
        rows.extend(e.parameters.iter().map(|p| row(format!("{}: {}", e.family, p.name), p)));
    }
    if rows.is_empty() { String::new() } else { table(&["constant or effect of the model", "value", "std error", "unit"], &rows) }
}

/// How well each coefficient is explained; nothing of methods that do not say.
fn fits(set: &DataSet) -> String {
    let fits: Vec<Vec<Cell>> = set
        .fits
        .iter()
        .map(|f| {
            vec![
                Cell::text(&f.coefficient),
                Cell::Number(format!("{:.5}", f.r2)),
                Cell::number(f.residual_std),
                Cell::Number(p_value(f.residual_whiteness_p)),
            ]
        })
        .collect();
    let note =
        "Look for p-values that are not small: then what a fit leaves is white. R²: share of the variance that is explained.";
    let heads = ["channel", "R²", "residual std", "p (white)"];
    section("Fits", note, &if fits.is_empty() { String::new() } else { table(&heads, &fits) })
}

/// Scatter over copies beside the stated errors.
fn copies(b: &Bootstrap) -> String {
    let rows: Vec<Vec<Cell>> = b
        .parameters
        .iter()
        .map(|p| {
            vec![
                Cell::text(&p.coefficient),
                Cell::text(&p.name),
                Cell::number(p.std_error),
                Cell::number(p.scatter),
                Cell::Number(format!("{:.2} ± {:.2}", p.ratio, NORMAL_95 * b.ratio_std_error)),
                Cell::Number(format!("{:+.2}", p.bias_over_std_error)),
                Cell::Number(format!("{:.0} %", 100.0 * p.covered)),
            ]
        })
        .collect();
    let failed = b.failed.iter().map(|f| format!("<li>{}</li>", escape(f))).collect::<String>();
    let failed = if failed.is_empty() { failed } else { format!("<ul>{failed}</ul>\n") };
    let heads = [
        "coefficient",
        "parameter",
        "stated std error",
        "scatter",
        "ratio ± 95 %",
        "bias / std error",
        "95 % intervals that hold",
    ];
    format!("<p>{} copies, {} without an answer.</p>\n", b.draws, b.failed.len()) + &table(&heads, &rows) + &failed
}

fn grid(drawn: &str) -> String {
    if drawn.is_empty() { String::new() } else { format!("<div class=\"grid\">{drawn}</div>\n") }
}

/// Estimates of one coefficient in all data sets, in percent of that of all runs.
fn estimates(all: &Identification, coefficient: &str, plots: &mut Plots) -> String {
    let Some(combined) = all.combined() else { return String::new() };
    let mut ranges = Vec::new();
    for p in combined.parameters.iter().filter(|p| p.coefficient == coefficient && p.estimate.abs() > 0.0) {
        let percent = |x: f64| 100.0 * (x - p.estimate) / p.estimate.abs();
        for set in std::iter::once(combined).chain(all.data_sets.iter().filter(|d| d.name != combined.name)) {
            let Some(e) = set.get(coefficient, &p.name) else { continue };
            let whole = set.name == combined.name;
            let (estimate, half) = with_interval(e.estimate, Some(NORMAL_95 * e.std_error));
            let range = Range {
                name: if whole { p.name.clone() } else { set.name.clone() },
                ends: e.ci95.map(percent),
                inner: None,
                dot: percent(e.estimate),
                note: half.map_or(estimate.clone(), |h| format!("{estimate} ± {h}")),
                look: if whole { Look::After } else { Look::Plain },
            };
            // An interval of many times the estimate would hide all others.
            if range.ends.iter().all(|x| x.abs() < 300.0) {
                ranges.push(range);
            }
        }
    }
    let (title, x_label) = (format!("{coefficient}: estimates and 95 % intervals"), "% from the estimate of all runs".to_owned());
    plots.put(Plot::Ranges { title, x_label, marks: vec![0.0], ranges })
}

/// Two digits, so that a small error is not none.
fn rounded(x: f64) -> String {
    if x.abs() < 0.1 { format!("{x:.1e}") } else { format!("{x:.2}") }
}

fn parameters(set: &DataSet) -> String {
    let row = |p: &windfall_discover::Estimate| {
        let own = Some(0.5 * (p.ci95[1] - p.ci95[0])).filter(|h| h.is_finite());
        let (estimate, half) = with_interval(p.estimate, own);
        let end = |x: f64| with_interval(x, own).0;
        vec![
            Cell::text(&p.coefficient),
            Cell::text(&p.name),
            Cell::Number(estimate),
            Cell::Number(half.unwrap_or_else(|| "–".to_owned())),
            Cell::Number(format!("[{}, {}]", end(p.ci95[0]), end(p.ci95[1]))),
            Cell::Number(p.rse_percent.map_or_else(|| "–".to_owned(), |r| format!("{} %", rounded(r)))),
            Cell::number(p.std_error_white),
        ]
    };
    let rows: Vec<Vec<Cell>> = set.parameters.iter().map(row).collect();
    let held: String = set.held.iter().map(|h| format!("<li>{} held at {}</li>", escape(&h.name), number(h.value))).collect();
    let refused = |r: &windfall_discover::Refused| {
        format!("<li>{} {} is not estimated: {}</li>", escape(&r.coefficient), escape(&r.name), escape(&r.reason))
    };
    let held = held + &set.refused.iter().map(refused).collect::<String>();
    let held = if held.is_empty() { String::new() } else { format!("<ul>{held}</ul>\n") };
    let heads = ["coefficient", "parameter", "estimate", "± 95 %", "95 % interval", "RSE", "std error if white"];
    let condition = format!("<p class=\"note\">Condition number {}.</p>\n", number(set.condition_number));
    let valid = |e| format!("<p class=\"note\">{}.</p>\n", escape(&capital(&validity(e))));
    let valid = set.envelope.as_ref().map_or_else(String::new, valid);
    if rows.is_empty() { held } else { table(&heads, &rows) + &valid + &held + &condition }
}

/// A line as a sentence.
fn capital(line: &str) -> String {
    let mut letters = line.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// The body of a re-simulation; none for what is none.
pub(crate) fn resimulation(value: &Value, plots: &mut Plots) -> Option<String> {
    let r: Resimulation = serde_json::from_value(value.clone()).ok()?;
    let rows: Vec<Vec<Cell>> = r.runs.iter().map(run).collect();
    let heads =
        ["run", "use", "attitude (deg)", "position (mm)", "body rates (deg/s)", "misfit (1: noise)", "flown (s)", "of (s)"];
    let lead = format!(
        "Look for a misfit near one and runs flown to their end. Parameters of {} by {}; rms error of each run, flown from its own initial \
         state. All runs: attitude {}°, position {} mm, body rates {} deg/s.",
        r.data_set,
        r.method,
        number(r.trajectory.attitude_rms_deg),
        number(1e3 * r.trajectory.position_rms_m),
        number(r.trajectory.rate_rms_deg_s)
    );
    let mut out =
        section("Identified model, flown again", &lead, &if rows.is_empty() { String::new() } else { table(&heads, &rows) });
    let rows: Vec<Vec<Cell>> = r.statistics.iter().map(statistic).collect();
    let note = "Look for a simulation inside its own spread of the test. Layout of the thesis' Table 5.6.";
    let heads = ["statistic", "test", "simulation", "std over seeds", "95 % over draws"];
    out += &section("Statistics", note, &if rows.is_empty() { String::new() } else { table(&heads, &rows) });
    let figures: Vec<Figure> = value["runs"]
        .as_array()?
        .iter()
        .flat_map(|run| {
            let name = run.get("name").and_then(Value::as_str).unwrap_or_default();
            run.get("bands").and_then(Value::as_array).into_iter().flatten().filter_map(move |b| over_time(name, b))
        })
        .collect();
    let note = "Look for the grey curve inside the blue band: what the errors of the parameters leave open. Shaded: 95 %.";
    let keys = key(&[("measured", "measured"), ("after", "identified model, shaded: 95 %")]);
    let drawn = plots.charts(figures);
    out += &section("Bands of the prediction", note, &if drawn.is_empty() { String::new() } else { keys + &grid(&drawn) });
    let flown: Vec<Vec<Cell>> = r
        .parameters
        .iter()
        .map(|p| {
            vec![Cell::text(&p.name), Cell::number(p.value), Cell::text(if p.identified { "identified" } else { "campaign" })]
        })
        .collect();
    out += &section(
        "Parameters as flown",
        "",
        &if flown.is_empty() { String::new() } else { table(&["parameter", "value", "from"], &flown) },
    );
    Some(out + &warnings(&r.warnings))
}

fn run(r: &RunComparison) -> Vec<Cell> {
    vec![
        Cell::text(&r.name),
        Cell::text(&r.used),
        Cell::number(r.trajectory.attitude_rms_deg),
        Cell::number(1e3 * r.trajectory.position_rms_m),
        Cell::number(r.trajectory.rate_rms_deg_s),
        Cell::Number(r.misfit.map_or_else(|| "–".to_owned(), number)),
        Cell::number(r.flown_s),
        Cell::number(r.duration_s),
    ]
}

fn statistic(s: &windfall_replay::Statistic) -> Vec<Cell> {
    let quantity = if s.quantity == "theta_deg" { "Θ (deg)" } else { "ω_q,r (deg/s)" };
    let interval = s.draws_ci95.map_or_else(|| "–".to_owned(), |[a, b]| format!("[{}, {}]", number(a), number(b)));
    vec![
        Cell::text(format!("{} of {quantity}", s.statistic)),
        Cell::number(s.test),
        Cell::number(s.simulation),
        Cell::Number(s.simulation_std.map_or_else(|| "–".to_owned(), number)),
        Cell::Number(interval),
    ]
}

/// Half the band where it is widest: it may be thinner than the curve.
fn widest([low, high]: &[Vec<f64>; 2]) -> String {
    format!(", ± {} at most", number(low.iter().zip(high).map(|(a, b)| 0.5 * (b - a)).fold(0.0, f64::max)))
}

fn numbers(value: &Value, key: &str) -> Option<Vec<f64>> {
    value.get(key)?.as_array()?.iter().map(Value::as_f64).collect()
}

fn curve(c: &Value, wind_tunnel: &[WindTunnelLine]) -> Option<Figure> {
    let word = |key: &str| c.get(key).and_then(Value::as_str);
    let angle = match word("over")? {
        "alpha" => "α",
        "beta" => "β",
        _ => "α_T",
    };
    let quantity = word("quantity")?;
    let band = [numbers(c, "low")?, numbers(c, "high")?];
    let measured = wind_tunnel.iter().filter(|l| l.quantity == quantity).map(points);
    Some(Figure {
        topic: Topic::Variable,
        title: format!("{quantity} over {angle}{}", widest(&band)),
        x_label: format!("{angle}, deg"),
        y_label: quantity.to_owned(),
        series: std::iter::once(Series {
            role: Role::After,
            x: numbers(c, "angle_deg")?,
            y: numbers(c, "value")?,
            band: Some(band),
            ..Series::default()
        })
        .chain(measured)
        .collect(),
        ..Figure::default()
    })
}

fn over_time(run: &str, b: &Value) -> Option<Figure> {
    let (title, unit) = match b.get("quantity")?.as_str()? {
        "theta_deg" => ("Θ", "deg"),
        _ => ("ω_q,r", "deg/s"),
    };
    let t = numbers(b, "t_s")?;
    let band = [numbers(b, "low")?, numbers(b, "high")?];
    let measured = Series { role: Role::Measured, x: t.clone(), y: numbers(b, "test")?, ..Series::default() };
    Some(Figure {
        topic: Topic::Trajectory,
        title: format!("{run}: {title}{}", widest(&band)),
        x_label: "time, s".to_owned(),
        y_label: format!("{title}, {unit}"),
        series: vec![
            measured,
            Series { role: Role::After, x: t, y: numbers(b, "median")?, band: Some(band), ..Series::default() },
        ],
        ..Figure::default()
    })
}
