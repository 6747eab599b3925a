//! scenarios: which way a record falls. In: its time and positions. Out: the axis that is down, with the acceleration along it.

use super::sheet::{Clock, Found, Sheet, median, seconds};
use super::vectors::Position;

/// Median speed above which positions without a unit are in mm: 0.1 m/s or 100 m/s.
const FAST: f64 = 100.0;

/// Positions without a unit of a body that is not in a tunnel: those that span more than a tunnel are in m where the body is no faster than
/// one that flies.
pub(super) fn far(sheet: &Sheet<'_>, clock: &Clock, mut position: Position) -> Position {
    let Some(t) = sheet.get(&clock.found.name).map(|t| seconds(t, &clock.found.unit)) else { return position };
    let series: Vec<&[f64]> = position.found.iter().filter_map(|f| sheet.get(&f.name)).collect();
    let speed = |i: usize| series.iter().map(|s| (s[i] - s[i - 1]).powi(2)).sum::<f64>().sqrt() / (t[i] - t[i - 1]);
    let middle = median(&(1..t.len()).map(speed).filter(|v| *v > 0.0).collect::<Vec<_>>());
    for f in position.found.iter_mut().filter(|f| f.why.starts_with("GUESS") && f.unit == "mm" && middle < FAST) {
        (f.unit, f.why) = ("m".to_owned(), format!("GUESS: it moves by {middle:.4} a second"));
    }
    position
}

/// The accelerations of a fall, m/s2: g, and what drag takes off or adds.
const FALL_M_S2: [f64; 2] = [5.0, 15.0];

/// The axis along which positions fall, by the parabola through each; of one axis alone its sign. Rows that do not move are left out.
pub(super) fn falls(sheet: &Sheet<'_>, clock: &Clock, position: &[Found]) -> Option<(String, f64)> {
    let t = seconds(sheet.get(&clock.found.name)?, &clock.found.unit);
    let series: Vec<&[f64]> = position.iter().filter_map(|f| sheet.get(&f.name)).collect();
    let moves = |i: usize| series.iter().any(|s| s[i].to_bits() != s[i - 1].to_bits()) && series.iter().all(|s| s[i].is_finite());
    let rows: Vec<usize> = (1..t.len()).filter(|i| moves(*i)).collect();
    let one = |f: &Found| {
        let v = sheet.get(&f.name)?;
        let metres = [("mm", 1e-3), ("cm", 1e-2), ("in", 0.0254), ("ft", 0.3048), ("km", 1e3)]
            .iter()
            .find(|(u, _)| *u == f.unit)
            .map_or(1.0, |u| u.1);
        let a = metres * parabola(&rows.iter().map(|i| (t[*i], v[*i])).collect::<Vec<_>>())?;
        Some((f.ours.chars().next()?, a))
    };
    let all: Vec<(char, f64)> = position.iter().filter_map(one).collect();
    let alone = all.len() == 1;
    let fall = |a: f64| if alone { a.abs() > 2.0 } else { (FALL_M_S2[0]..FALL_M_S2[1]).contains(&a.abs()) };
    let (axis, a) =
        all.into_iter().filter(|(_, a)| fall(*a)).min_by(|a, b| (a.1.abs() - 9.8).abs().total_cmp(&(b.1.abs() - 9.8).abs()))?;
    Some((format!("{}{axis}", if a < 0.0 { "-" } else { "+" }), a))
}

/// Second derivative of the least-squares parabola through points.
fn parabola(points: &[(f64, f64)]) -> Option<f64> {
    let n = points.len();
    if n < 4 {
        return None;
    }
    let middle = |k: fn(&(f64, f64)) -> f64| points.iter().map(k).sum::<f64>() / n as f64;
    let (t0, x0) = (middle(|p| p.0), middle(|p| p.1));
    let sum = |k: i32, l: i32| points.iter().map(|p| (p.0 - t0).powi(k) * (p.1 - x0).powi(l)).sum::<f64>();
    let (s2, s3, s4) = (sum(2, 0), sum(3, 0), sum(4, 0));
    // Normal equations of t and t² - mean, both without their means.
    let q = s4 - s2 * s2 / n as f64;
    let curvature = (sum(2, 1) - s3 * sum(1, 1) / s2) / (q - s3 * s3 / s2);
    Some(2.0 * curvature).filter(|a| a.is_finite())
}
