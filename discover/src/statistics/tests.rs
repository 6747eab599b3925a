//! discover tests: a short run of the bundled table, and the tolerances that options give.

use super::*;

/// Two seconds of the bundled run: mean Θ and ω_q,r fitted, largest pitch rate not.
pub(super) fn setup() -> StatisticsSetup {
    let file = windfall_scenarios::bundled_statistics().expect("valid");
    let figure = |quantity, statistic, test, fitted| StatisticFigure { quantity, statistic, test, simulation: None, fitted };
    let figures = vec![
        figure(FigureQuantity::Theta, Moment::Mean, 2.9, true),
        figure(FigureQuantity::OmegaQr, Moment::Mean, 14.0, true),
        figure(FigureQuantity::PitchRate, Moment::LargestSize, 27.0, false),
    ];
    let flight = Flight { duration_s: 2.0, rate_hz: 100.0, ..file.flight };
    StatisticsSetup::new(("short", "by hand"), 56, file.plant, flight, figures).expect("valid")
}

/// The absolute tolerance is a hundredth of the relative one, as options say.
#[test]
fn exact_tolerances() {
    let n = numerics(3e-4);
    assert!((n.relative_tolerance - 3e-4).abs() < 1e-19 && (n.absolute_tolerance - 3e-6).abs() < 1e-19);
}
