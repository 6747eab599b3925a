//! report: what a histogram leaves out. In: a figure of densities. Out: its title with the share of each side beyond the ends.

use crate::legend::share;
use windfall_discover::close::{Figure, Role, Series};

/// Share beyond the ends from which it is said.
const SAID: f64 = 0.005;

/// Says in the title of a figure of densities how much of each side lies beyond its ends.
pub(crate) fn say_beyond(f: &mut Figure) {
    if !f.y_label.starts_with("density") {
        return;
    }
    let one = |s: &Series| {
        let beyond = beyond(s).filter(|b| *b >= SAID)?;
        let name = match s.role {
            Role::Measured => "measured",
            Role::Before => "declared model",
            Role::After => "with the effects",
            Role::Noise => return None,
        };
        Some(format!("{name} {}", share(beyond).replace(' ', "\u{a0}")))
    };
    let said: Vec<String> = f.series.iter().filter_map(one).collect();
    if !said.is_empty() {
        f.title = format!("{} (beyond the ends: {})", f.title, said.join(", "));
    }
}

/// Steps, both ends of every bin: one less their area.
fn beyond(s: &Series) -> Option<f64> {
    let steps = s.x.len() > 3 && (s.x[1] - s.x[2]).abs() <= 1e-9 * (s.x[1] - s.x[0]).abs();
    let area = |(x, y): (&[f64], &[f64])| (x[1] - x[0]) * y[0];
    steps.then(|| 1.0 - s.x.chunks_exact(2).zip(s.y.chunks_exact(2)).map(area).sum::<f64>())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two bins of width one with a quarter each: half lies beyond. The bell beside it is no histogram.
    #[test]
    fn exact_half_beyond() {
        let steps = Series { role: Role::Before, x: vec![-1.0, 0.0, 0.0, 1.0], y: vec![0.25; 4], ..Series::default() };
        let bell = Series { role: Role::Noise, x: vec![-1.0, 0.0, 1.0], y: vec![0.1, 0.4, 0.1], ..Series::default() };
        let of = |y_label: &str| {
            let (title, y_label) = ("X".to_owned(), y_label.to_owned());
            let mut f = Figure { title, y_label, series: vec![bell.clone(), steps.clone()], ..Figure::default() };
            say_beyond(&mut f);
            f.title
        };
        assert_eq!(of("density (1)"), "X (beyond the ends: declared model 50.0\u{a0}%)");
        assert_eq!(of("correlation (1)"), "X");
    }
}
