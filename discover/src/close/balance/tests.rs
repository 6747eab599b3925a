//! discover tests: spectra of what a balance leaves against Fourier sums written out, and the noise that copies add.

use super::*;
use crate::close::tests::{body, sage};
use windfall_model::{Aero, Coefficient, FlowState, Structure};

/// Two series of unlike length and interval whose first lines share a band: means of 2 Δt |Σ w x e^(−2πi k j/n)|²/Σ w². The fifth
/// line of the longer one is beyond 1.5 Hz.
#[test]
fn exact_band_powers() {
    let value = |j: usize, c: usize| (0.7 * (j * j) as f64 + 1.3 * c as f64).sin() + 0.2 * c as f64;
    let left = |n: usize| -> Left { (0..n).map(|j| std::array::from_fn(|c| value(j, c))).collect() };
    let all = [(left(9), 0.3), (left(12), 0.23)];
    let found = banded(&all, 1.5);
    for (c, bands) in found.iter().enumerate() {
        let mut sums = vec![(0.0, 0.0, 0.0); 40];
        for (series, dt) in &all {
            let n = series.len();
            let tau = std::f64::consts::TAU;
            let taper: Vec<f64> = (0..n).map(|j| (0.5 * tau * (2 * j + 1) as f64 / (2 * n) as f64).sin()).collect();
            for k in 1..=n / 2 {
                let f = k as f64 / (n as f64 * dt);
                let Some(band) = sums.iter_mut().enumerate().find(|(b, _)| f < 1.5 * (b + 1) as f64 / 40.0) else { continue };
                let along = |of: fn(f64) -> f64| {
                    (0..n).map(|j| taper[j] * series[j][c] * of(tau * (k * j) as f64 / n as f64)).sum::<f64>()
                };
                let power = along(f64::cos).powi(2) + along(f64::sin).powi(2);
                let s = band.1;
                *s = (s.0 + f, s.1 + 2.0 * dt * power / taper.iter().map(|w| w * w).sum::<f64>(), s.2 + 1.0);
            }
        }
        let expected: Vec<(f64, f64)> = sums.iter().filter(|s| s.2 > 0.0).map(|s| (s.0 / s.2, s.1 / s.2)).collect();
        assert!(sums.iter().any(|s| s.2 > 1.5) && bands.len() == expected.len(), "{bands:?}");
        // Rounding of sums of a dozen.
        assert!(
            bands.iter().zip(&expected).all(|(a, b)| (a.0 - b.0).abs() < 1e-13 && (a.1 - b.1).abs() < 1e-13),
            "{bands:?} {expected:?}"
        );
    }
}

/// Copies are smoothed as the record is, each with other noise of the stated size; a copy without any adds nothing.
#[test]
fn law_copies_add_their_noise_alone() {
    let c = sage(1.5);
    let mut balance = BalanceResidual::new(&c, &[0], &Options::default()).expect("a tunnel run");
    let run = &mut balance.runs[0];
    let bandwidth = run.smoothed.bandwidth_hz[0];
    assert!(
        run.copies.len() == 4 && run.copies.iter().all(|s| (s.bandwidth_hz[0] / bandwidth - 1.0).abs() < 1e-9),
        "{bandwidth}"
    );
    run.copies = vec![run.smoothed.clone()];
    let none = balance.noise(&c.plant);
    assert!(none.iter().all(|bands| !bands.is_empty() && bands.iter().all(|(_, power)| *power == 0.0)), "{none:?}");
    assert!(balance.spectra(&c.plant)[0].iter().any(|(_, power)| *power > 0.0));

    let Data::Tunnel(record) = &c.runs[0].data else { panic!("a tunnel run") };
    let std = c.plant.sensors.std_by_channel();
    let [a, b] = [1, 2].map(|stream| noisy(record, &c.plant.sensors, (3, stream << 8)));
    for (k, raw) in record.channels().iter().enumerate() {
        let of = |copy: &Record| raw.iter().zip(copy.channels()[k]).map(|(x, y)| y - x).collect::<Vec<f64>>();
        let (a, b) = (of(&a), of(&b));
        let mean = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>() / x.len() as f64;
        // Five standard errors.
        let share = 5.0 / (raw.len() as f64).sqrt();
        assert!(
            std[k] > 0.0 && (mean(&a, &a) / std[k].powi(2) - 1.0).abs() < 1.5 * share,
            "{k}: {} {}",
            mean(&a, &a).sqrt(),
            std[k]
        );
        assert!(mean(&a, &b).abs() < share * std[k].powi(2), "{k}");
    }
}

#[test]
fn exact_coefficients_beyond_a_plant() {
    let mut plant = body();
    plant.aero = Aero::new(Structure { name: "none".to_owned(), parameters: Vec::new(), contributions: Vec::new() }, Vec::new());
    plant.aero.add(Coefficient::CA, 0.37, 1.0, &[]);
    plant.aero.add(Coefficient::Cm, -0.2, 1.0, &[]);
    let flow = FlowState { values: [0.1; 14] };
    let row = CoefficientRow { t_s: 0.0, flow, exp_cm: [9.0; 6], exp_origin: [0.5, 0.1, 0.2, 0.3, 0.4, 0.6], q_pa: 30.0 };
    let left = beyond(&row, &plant);
    assert!(left.iter().zip([0.13, 0.1, 0.2, 0.3, 0.6, 0.6]).all(|(a, b)| (a - b).abs() < 1e-15), "{left:?}");
}
