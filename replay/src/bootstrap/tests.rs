//! replay tests: scatter over copies by hand, priors as they are measured again.

use super::*;

fn set(estimate: f64, ci95: [f64; 2]) -> DataSet {
    let one = Estimate {
        coefficient: "CA".to_owned(),
        name: "CA_T0".to_owned(),
        estimate,
        std_error: 0.4,
        rse_percent: None,
        ci95,
        std_error_white: 0.4,
    };
    DataSet {
        refused: Vec::new(),
        envelope: None,
        name: "combined".to_owned(),
        runs: Vec::new(),
        parameters: vec![one],
        fits: Vec::new(),
        condition_number: 1.0,
        n_samples: 1,
        covariance: Vec::new(),
        curves: Vec::new(),
        held: Vec::new(),
        constants: Vec::new(),
        effects: Vec::new(),
    }
}

fn plant() -> Plant {
    windfall_scenarios::read_bundled("sage-perturbed").expect("bundled").scenario.plant
}

/// Flown 6.662; copies 1, 2, 3 and 6 above it: bias 3, scatter √(14/3), both over 0.4; two of four intervals hold it. The error of a
/// standard deviation of nine is a quarter of it.
#[test]
fn exact_line_of_four_copies() {
    let flown = 6.662;
    let copies =
        [(3.0, -4.0), (1.0, -1.5), (6.0, -2.0), (2.0, -1.0)].map(|(off, low)| set(flown + off, [flown + off + low, 99.0]));
    let stated = &set(7.0, [0.0; 2]).parameters[0];
    let l = line(stated, &plant(), &copies).expect("four copies");
    let near = |x: f64, y: f64| assert!((x - y).abs() < 1e-13, "{x}, not {y}: {l:?}");
    near(l.flown, flown);
    near(l.scatter, (14.0_f64 / 3.0).sqrt());
    near(l.ratio, (14.0_f64 / 3.0).sqrt() / 0.4);
    near(l.bias_over_std_error, 7.5);
    near(l.covered, 0.5);
    near(ratio_std_error(9), 0.25);
    assert!(line(stated, &plant(), &copies[..1]).is_none());
}

/// Copies' priors are normal about what is flown, with the prior's own standard deviation: mean and variance of 4000 within four standard
/// errors.
#[test]
fn law_priors_are_measured_again() {
    let mut priors = vec![Prior { name: "CA_T0".to_owned(), mean: 99.0, std: 0.05 }; 4000];
    draw_priors(&mut priors, &plant(), 7);
    let z: Vec<f64> = priors.iter().map(|p| (p.mean - 6.662) / p.std).collect();
    let (mean, square) = (z.iter().sum::<f64>() / 4000.0, z.iter().map(|z| z * z).sum::<f64>() / 4000.0);
    assert!(mean.abs() < 4.0 / 4000_f64.sqrt() && (square - 1.0).abs() < 4.0 * (2.0 / 4000_f64).sqrt(), "{mean} {square}");
}
