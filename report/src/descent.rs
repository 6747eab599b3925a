//! report: the page of descents. In: their statistics. Out: HTML; the touch-down table, bands over height, what they hang on.

use crate::html::{Cell, escape, section, table};
use crate::legend::key;
use crate::number;
use crate::plot::{Plot, Plots};
use crate::shape::warnings;
use crate::words::plain_key;
use windfall_discover::close::{Figure, Role, Series, Topic};
use windfall_replay::descent::{DescentSummary, HeightLine, LandingScatter, ParameterShare, SteadyFall, TouchDownLine};

/// Parameters named beside a quantity, and the smallest share that is named.
const NAMED: usize = 4;
const SMALLEST: f64 = 0.005;

/// The body of a page of descents.
pub(crate) fn descent_body(s: &DescentSummary, plots: &mut Plots) -> String {
    let mut out = format!("<h1>{}</h1>\n<p class=\"lead\">{}</p>\n", escape(&s.scenario), escape(&lead(s)));
    out += &warnings(&s.warnings);
    let of =
        "Mean, standard deviation and the range of 95 % of the descents that landed; nominal: the estimate itself in even air.";
    out += &section("Touch-down", of, &touch_down(&s.touch_down));
    let of = "Look whether the places fill the ellipse: one that is long and thin comes from wind along its axis, and a few places far \
              outside are descents that went otherwise. From the start, in its horizontal plane.";
    out += &section("Where they land", of, &s.landing.as_ref().map_or_else(String::new, |l| landing(l, &s.touch_down, plots)));
    let of = "Median and 95 % of the descents that came to a height.";
    let figures: String = s.over_height.iter().map(|l| plots.put(Plot::Chart(over_height(l)))).collect();
    let marks = key(&[("after", "median, 95 % of the descents"), ("before", "nominal model in even air")]);
    let figures = if figures.is_empty() { figures } else { marks + &figures };
    out += &section("Over height", of, &figures);
    let of = "Share of each quantity's variance that is the uncertain parameters' (the rest is gusts and start), and the share that would go \
              if a parameter were known exactly. A minus: the quantity falls as the parameter grows.";
    out += &section("What it hangs on", of, &(hangs(&s.touch_down) + &narrower(&s.touch_down)));
    let of = "The nominal model at its terminal speed: frequency and decay of small pitching.";
    out += &section("Linear theory", of, &theory(&s.linear_theory, plots));
    let drawn =
        |p: &windfall_replay::descent::DrawnParameter| vec![Cell::text(&p.name), Cell::number(p.nominal), Cell::number(p.std)];
    let rows: Vec<Vec<Cell>> = s.parameters.iter().map(drawn).collect();
    out += &section("Drawn parameters", "", &some(&["parameter", "nominal", "standard uncertainty"], &rows));
    let rows: Vec<Vec<Cell>> =
        s.ends.reasons.iter().map(|r| vec![Cell::text(&r.reason), Cell::Number(r.count.to_string())]).collect();
    out + &section("Failures", "", &some(&["reason", "descents"], &rows))
}

fn some(heads: &[&str], rows: &[Vec<Cell>]) -> String {
    if rows.is_empty() { String::new() } else { table(heads, rows) }
}

fn lead(s: &DescentSummary) -> String {
    let model = s.model.as_ref().map_or_else(
        || "the scenario's own coefficients".to_owned(),
        |m| format!("coefficients of data set {} by {}", m.data_set, m.method),
    );
    let pairs = if s.in_pairs { ", each drawn model twice" } else { "" };
    let e = &s.ends;
    format!(
        "{} descents with {model}{pairs}, seed {}: {} landed, {} tumbled, {} were still aloft, {} failed.",
        s.draws, s.seed, e.landed, e.tumbled, e.aloft, e.failed
    )
}

/// Places with their ellipse, and its numbers.
fn landing(l: &LandingScatter, touch_down: &[TouchDownLine], plots: &mut Plots) -> String {
    let most = l.half_axes95_m[0].max(l.mean_m[0].hypot(l.mean_m[1]));
    let (per_m, unit) = if most > 5e3 { (1e-3, "km") } else { (1.0, "m") };
    let (s, c) = l.heading_deg.to_radians().sin_cos();
    let [a, b] = l.half_axes95_m;
    // Upper and lower half, each with ascending abscissae: a chart's curves are functions.
    let edge = |sign: f64| {
        let reach = (a * s).hypot(b * c);
        let east = |k: i32| reach * f64::from(k) / 40.0;
        // North of the edge over east: the ellipse's equation solved.
        let [p, q, r] = [(s / a).powi(2) + (c / b).powi(2), s * c * (a.powi(-2) - b.powi(-2)), (c / a).powi(2) + (s / b).powi(2)];
        let north = |e: f64| (-q * e + sign * (q * q * e * e - r * (p * e * e - 1.0)).max(0.0).sqrt()) / r;
        let x: Vec<f64> = (-40..=40).map(|k| per_m * (l.mean_m[1] + east(k))).collect();
        let y = (-40..=40).map(|k| per_m * (l.mean_m[0] + north(east(k)))).collect();
        Series { role: Role::Noise, x, y, ..Series::default() }
    };
    let mut places = l.places_m.clone();
    places.sort_by(|a, b| a[1].total_cmp(&b[1]));
    let places = Series {
        role: Role::After,
        x: places.iter().map(|p| per_m * p[1]).collect(),
        y: places.iter().map(|p| per_m * p[0]).collect(),
        points: true,
        ..Series::default()
    };
    let nominal = |key: &str| touch_down.iter().find(|t| t.quantity == key).and_then(|t| t.nominal);
    let nominal = nominal("drift_east_m").zip(nominal("drift_north_m")).map(|(e, n)| Series {
        role: Role::Before,
        x: vec![per_m * e],
        y: vec![per_m * n],
        points: true,
        ..Series::default()
    });
    let edges = if a > 0.0 && b > 0.0 { vec![edge(1.0), edge(-1.0)] } else { Vec::new() };
    let figure = Figure {
        topic: Topic::Variable,
        title: "Places of touch-down".to_owned(),
        x_label: format!("east of the start ({unit})"),
        y_label: format!("north of the start ({unit})"),
        series: edges.into_iter().chain([places]).chain(nominal).collect(),
        ..Figure::default()
    };
    let words = format!(
        "<p>Mean {} north and {} east; ellipse of 95 %: half axes {} and {}, the longer heading {:.0}°; {} of the descents \
         are inside. Half of them land within {} of the mean.</p>\n",
        of_unit(l.mean_m[0], per_m, unit),
        of_unit(l.mean_m[1], per_m, unit),
        of_unit(a, per_m, unit),
        of_unit(b, per_m, unit),
        l.heading_deg,
        percent(l.inside),
        of_unit(l.half_within_m, per_m, unit)
    );
    let marks = key(&[("after", "descents"), ("noise", "ellipse of 95 %"), ("before", "nominal model in even air")]);
    words + &marks + &plots.put(Plot::Chart(figure))
}

fn of_unit(x_m: f64, per_m: f64, unit: &str) -> String {
    format!("{}\u{a0}{unit}", number(per_m * x_m))
}

/// A quantity's words and unit.
fn words(quantity: &str) -> String {
    let (name, unit) = plain_key(quantity);
    format!("{name} ({})", unit.unwrap_or("-"))
}

fn touch_down(lines: &[TouchDownLine]) -> String {
    let row = |l: &TouchDownLine| {
        vec![
            Cell::text(words(&l.quantity)),
            Cell::Number(l.nominal.map_or_else(|| "–".to_owned(), number)),
            Cell::number(l.mean),
            Cell::number(l.std),
            Cell::number(l.low),
            Cell::number(l.median),
            Cell::number(l.high),
            Cell::number(l.std_of_parameters),
            Cell::number(l.std_of_flight),
        ]
    };
    let heads =
        ["quantity", "nominal", "mean", "std", "2.5 %", "median", "97.5 %", "std of parameters", "std of gusts and start"];
    some(&heads, &lines.iter().map(row).collect::<Vec<_>>())
}

fn over_height(l: &HeightLine) -> Figure {
    let km: Vec<f64> = l.height_m.iter().map(|h| h / 1e3).collect();
    // Heights to which no descent came have no statistics.
    let there: Vec<usize> = (0..km.len()).filter(|i| l.draws[*i] > 0).collect();
    let of = |x: &[f64]| there.iter().map(|&i| x[i]).collect::<Vec<f64>>();
    let nominal: Vec<f64> = l.nominal.iter().map(|x| x.unwrap_or(f64::NAN)).collect();
    let median =
        Series { role: Role::After, x: of(&km), y: of(&l.median), band: Some([of(&l.low), of(&l.high)]), ..Series::default() };
    let nominal = Series { role: Role::Before, x: km, y: nominal, ..Series::default() };
    figure(&words(&l.quantity), vec![median, nominal])
}

fn figure(label: &str, series: Vec<Series>) -> Figure {
    let title = label.split(" (").next().unwrap_or(label).to_owned();
    let x_label = "height (km)".to_owned();
    Figure { topic: Topic::Variable, title, x_label, y_label: label.to_owned(), series, ..Figure::default() }
}

fn theory(all: &[SteadyFall], plots: &mut Plots) -> String {
    let km: Vec<f64> = all.iter().map(|f| f.height_m / 1e3).collect();
    let one = |label: &str, of: fn(&SteadyFall) -> f64| {
        figure(label, vec![Series { role: Role::After, x: km.clone(), y: all.iter().map(of).collect(), ..Series::default() }])
    };
    if all.is_empty() {
        return String::new();
    }
    let drawn = plots.charts([
        one("terminal speed (m/s)", |f| f.terminal_speed_m_s),
        one("pitch frequency (Hz)", |f| f.pitch_frequency_hz.unwrap_or(f64::NAN)),
        one("pitch damping (1/s)", |f| f.pitch_damping_per_s),
    ]);
    key(&[("after", "nominal model")]) + &drawn
}

fn percent(x: f64) -> String {
    format!("{:.1} %", 100.0 * x)
}

fn hangs(lines: &[TouchDownLine]) -> String {
    let row = |l: &TouchDownLine| {
        let named = l.parameters.iter().filter(|p| p.share >= SMALLEST).take(NAMED);
        let one = |p: &ParameterShare| format!("{} {}{}", p.name, if p.sign < 0 { "−" } else { "+" }, percent(p.share));
        let [low, high] = l.share_ci95;
        vec![
            Cell::text(words(&l.quantity)),
            Cell::Number(format!("{} [{}, {}]", percent(l.share_of_parameters), percent(low), percent(high))),
            Cell::Number(percent(l.share_linear)),
            Cell::text(named.map(one).collect::<Vec<_>>().join(", ")),
        ]
    };
    let heads = ["quantity", "of the parameters [95 %]", "linear in them", "parameters"];
    some(&heads, &lines.iter().map(row).collect::<Vec<_>>())
}

/// What a better known first parameter would do, and how such a run is found.
fn narrower(lines: &[TouchDownLine]) -> String {
    let first = |l: &TouchDownLine| l.parameters.first().filter(|p| p.share >= SMALLEST).cloned();
    let row = |l: &TouchDownLine| {
        let p = first(l)?;
        Some(vec![Cell::text(words(&l.quantity)), Cell::text(p.name), Cell::number(l.std), Cell::number(p.std_if_known)])
    };
    let rows: Vec<Vec<Cell>> = lines.iter().filter_map(row).collect();
    let heads = ["quantity", "parameter", "std now", "std if it were known"];
    let how = "<p>Which run sharpens an aerodynamic parameter, for how much tunnel time: <code>windfall plan CAMPAIGN --target \
               PARAMETER=ERROR</code>.</p>\n";
    if rows.is_empty() { String::new() } else { some(&heads, &rows) + how }
}

#[cfg(test)]
mod tests {
    use super::*;
    use windfall_replay::descent::{DescentEnds, DescentReason};

    fn summary() -> DescentSummary {
        let share =
            ParameterShare { name: "CA_<T0>".to_owned(), share: 0.75, sign: -1, standardised: -0.9, std_if_known: 0.0625 };
        let line = TouchDownLine {
            quantity: "descent_speed_m_s".to_owned(),
            nominal: Some(7.75),
            mean: 7.5,
            std: 0.125,
            low: 7.25,
            median: 7.5,
            high: 7.875,
            std_of_parameters: 0.1,
            std_of_flight: 0.05,
            share_of_parameters: 0.8,
            share_ci95: [0.7, 0.9],
            share_linear: 0.79,
            parameters: vec![share],
        };
        let height = HeightLine {
            quantity: "off_vertical_deg".to_owned(),
            height_m: vec![2000.0, 1000.0, 0.0],
            draws: vec![2, 2, 0],
            nominal: vec![Some(1.0), Some(2.0), None],
            mean: vec![1.0, 2.0, 0.0],
            std: vec![0.5, 0.5, 0.0],
            low: vec![0.5, 1.0, 0.0],
            median: vec![1.0, 2.0, 0.0],
            high: vec![1.5, 3.0, 0.0],
        };
        DescentSummary {
            scenario: "fall <1>".to_owned(),
            flight: "f".to_owned(),
            model: None,
            draws: 4,
            seed: 9,
            step_s: 0.1,
            in_pairs: true,
            parameters: Vec::new(),
            ends: DescentEnds {
                landed: 3,
                tumbled: 1,
                aloft: 0,
                failed: 1,
                reasons: vec![DescentReason { reason: "a & b".to_owned(), count: 1 }],
            },
            touch_down: vec![line],
            landing: None,
            over_height: vec![height],
            linear_theory: Vec::new(),
            warnings: vec!["look <here>".to_owned()],
        }
    }

    #[test]
    fn law_descents_have_a_page_with_their_numbers() {
        let mut plots = Plots::default();
        let body = descent_body(&summary(), &mut plots);
        for text in [
            "fall &lt;1&gt;",
            "3 landed, 1 tumbled",
            "descent speed (m/s)",
            "7.875",
            "−75.0 %",
            "80.0 % [70.0 %, 90.0 %]",
            "0.0625",
            "a &amp; b",
            "look &lt;here&gt;",
        ] {
            assert!(body.contains(text), "{text} in {body}");
        }
        assert!(!body.contains("<T0>") && !body.contains("Linear theory"), "{body}");
        // A height without descents is no point of the band.
        let Plot::Chart(f) = &plots.all[0] else { panic!("a chart first") };
        assert_eq!((f.y_label.as_str(), f.series[0].x.as_slice()), ("off vertical (deg)", [2.0, 1.0].as_slice()));
    }
}
