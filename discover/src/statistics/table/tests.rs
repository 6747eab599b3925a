//! discover tests: percentages in the conclusions.

use super::*;
use crate::statistics::{FigureQuantity, Moment, StatisticsOptions};

fn figure(quantity: FigureQuantity, relative: f64, inside: bool) -> FigureOver {
    FigureOver {
        quantity,
        statistic: Moment::Mean,
        fitted: true,
        test: 3.0,
        mean: 3.0 * (1.0 + relative),
        std: 0.4,
        central90: [1.1, 2.2],
        quantiles: [0.0; 21],
        relative,
        inside,
    }
}

fn explanation(families: &[&'static str], relative: [f64; 2], closes: bool) -> Explanation {
    let figures = vec![figure(FigureQuantity::Theta, relative[0], closes), figure(FigureQuantity::OmegaQr, relative[1], true)];
    Explanation {
        families: families.to_vec(),
        parameters: Vec::new(),
        figures,
        j: 1.0,
        degrees: 1,
        p_value: 0.3,
        possible: true,
        closes,
        score: 5.0,
        left_section: 0.374,
    }
}

/// Shares are printed as percentages, signed where they are differences.
#[test]
fn exact_percentages() {
    let separated =
        |truth: &'static str, other: &'static str, power| FigureSeparation { truth: vec![truth], other: vec![other], power };
    let closing = StatisticsClosing {
        verdict: "effect",
        name: "t".to_owned(),
        source: "s".to_owned(),
        options: StatisticsOptions::default(),
        seed: 1,
        search_runs: [0, 4],
        final_runs: [9, 13],
        source_simulation: vec![None, None],
        before: vec![figure(FigureQuantity::Theta, -0.481, false), figure(FigureQuantity::OmegaQr, 0.913, false)],
        before_p_value: 0.0123,
        screened: Vec::new(),
        explanations: vec![
            explanation(&["turbulence"], [0.01, -0.02], true),
            explanation(&["asymmetry"], [0.234, -0.177], false),
        ],
        separations: vec![separated("turbulence", "asymmetry", 0.421), separated("asymmetry", "turbulence", 0.868)],
        processing: vec![0.011, -0.0213],
        histories: Vec::new(),
        flights: 7,
        conclusions: Vec::new(),
    };
    let text = conclusions(&closing).join("\n");
    for words in [
        "Declared model: mean theta_deg -48 %, mean omega_qr_deg_s +91 %; probability of the test 0.0123.",
        "asymmetry does not close: mean theta_deg +23 %, outside 90 %; mean omega_qr_deg_s -18 %.",
        "between turbulence; asymmetry: had one of them been true, another would be rejected at 5 % in 42 to 87 % of",
        "37 % of its runs would have left",
        "change a mean figure by 2.1 % at most.",
    ] {
        assert!(text.contains(words), "{words}\n{text}");
    }
}
