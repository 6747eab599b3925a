//! report: errors of a study over what was varied. In: first draws with their errors, varied quantities. Out: a section of figures.

use crate::html::section;
use crate::legend::key;
use crate::plot::Plots;
use crate::words::{plain_key, with_unit};
use windfall_discover::NORMAL_95;
use windfall_discover::close::{Figure, Role, Series, Topic};
use windfall_study::{RecoveryLine, VariedLine};

/// Varied quantities that are shown at most.
const SHOWN: usize = 4;

/// A figure for each coefficient and varied quantity; nothing where nothing varies.
pub(crate) fn over_varied(title: &str, own: &[&RecoveryLine], varied: &[VariedLine], plots: &mut Plots) -> String {
    let mut coefficients: Vec<&str> = own.iter().map(|l| l.coefficient.as_str()).collect();
    coefficients.dedup();
    let mut all = Vec::new();
    for v in varied.iter().filter(|v| differs(&v.values)).take(SHOWN) {
        for c in &coefficients {
            let lines: Vec<&RecoveryLine> = own.iter().copied().filter(|l| l.coefficient == *c).collect();
            all.extend(figure(c, &lines, v));
        }
    }
    let drawn = plots.charts(all);
    if drawn.is_empty() {
        return drawn;
    }
    let marks = key(&[("after", "inside its 95 % interval"), ("before", "outside"), ("noise", "95 %")]);
    let lead = "Look for points that lean or open to one side: then the method is biased, or its intervals are too short, where the varied \
                quantity is large. One point in twenty may lie outside the dashed lines. Each a parameter in one draw.";
    section(title, lead, &format!("{marks}<div class=\"grid\">{drawn}</div>\n"))
}

/// What is varied, in words and unit: its key without the table that it is in.
pub(crate) fn quantity(key: &str) -> (String, Option<&'static str>) {
    let mut parts: Vec<&str> = key.split('.').collect();
    let table = parts.remove(0);
    if parts.is_empty() || table == "aero" {
        return (parts.pop().unwrap_or(table).to_owned(), None);
    }
    let (names, units): (Vec<String>, Vec<Option<&str>>) = parts.into_iter().map(plain_key).unzip();
    (names.join(" "), units.into_iter().flatten().next_back())
}

/// Whether values lie over decades, all above zero.
pub(crate) fn decades(values: &[f64]) -> bool {
    let (low, high) = values.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), v| (a.min(*v), b.max(*v)));
    low > 0.0 && high > 30.0 * low
}

fn differs(values: &[f64]) -> bool {
    values.iter().any(|v| (v - values[0]).abs() > 0.0)
}

fn figure(coefficient: &str, lines: &[&RecoveryLine], v: &VariedLine) -> Option<Figure> {
    let at = |row: u64| v.values.get(usize::try_from(row).ok()?).copied();
    let draws = lines.iter().flat_map(|l| &l.draws);
    let mut points: Vec<[f64; 2]> = draws.filter_map(|d| Some([at(d.row)?, (d.estimate - d.truth) / d.std_error])).collect();
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let (first, last) = (points.first()?[0], points.last()?[0]);
    let level = |y: f64| Series { role: Role::Noise, x: vec![first, last], y: vec![y; 2], ..Series::default() };
    let of = |role: Role, inside: bool| {
        let own = points.iter().filter(|p| (p[1].abs() <= NORMAL_95) == inside);
        let (x, y) = own.map(|[a, b]| (*a, *b)).unzip();
        Series { role, x, y, points: true, ..Series::default() }
    };
    let clouds = [of(Role::After, true), of(Role::Before, false)].into_iter().filter(|s| !s.x.is_empty());
    let (name, unit) = quantity(&v.name);
    Some(Figure {
        topic: Topic::Variable,
        title: format!("{coefficient}: errors over {name}"),
        x_label: with_unit(&name, unit),
        y_label: "error (stated standard errors)".to_owned(),
        log_x: decades(&[first, last]),
        series: [level(NORMAL_95), level(-NORMAL_95)].into_iter().chain(clouds).collect(),
        ..Figure::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::Plot;

    #[test]
    fn exact_quantities_in_words() {
        assert_eq!(quantity("flight.release.attitude_deg.Ry"), ("release attitude Ry".to_owned(), Some("deg")));
        assert_eq!(quantity("aero.CA_T0"), ("CA_T0".to_owned(), None));
        assert_eq!(quantity("effects.turbulence.axial_rms_m_s"), ("turbulence axial rms".to_owned(), Some("m/s")));
    }

    /// Rows 0 and 2 have estimates: their errors of one and three standard errors stand at the first and third value.
    #[test]
    fn exact_rows_and_colours() {
        let line: RecoveryLine = serde_json::from_value(serde_json::json!({"method": "m", "coefficient": "CA", "name": "p", "reliability": [],
            "draws": [{"truth": 1.0, "estimate": 1.5, "std_error": 0.5, "row": 0}, {"truth": 1.0, "estimate": -0.5, "std_error": 0.5, "row": 2}]}))
        .expect("a line");
        let varied = [VariedLine { name: "vehicle.mass_kg".to_owned(), values: vec![2.0, 3.0, 1.0] }];
        let mut plots = Plots::default();
        let html = over_varied("t", &[&line], &varied, &mut plots);
        assert!(html.contains("CA: errors over mass") && html.contains("mass (kg)"), "{html}");
        let Plot::Chart(f) = &plots.all[0] else { panic!("a chart") };
        assert_eq!((f.series[2].x.as_slice(), f.series[2].y.as_slice()), (&[2.0][..], &[1.0][..]));
        assert_eq!((f.series[3].x.as_slice(), f.series[3].y.as_slice()), (&[1.0][..], &[-3.0][..]));
        let same = [VariedLine { name: "a".to_owned(), values: vec![2.0; 3] }];
        assert!(over_varied("t", &[&line], &same, &mut plots).is_empty());
    }
}
