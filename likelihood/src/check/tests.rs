//! likelihood tests: generic alternatives by the coordinates they belong to, and a line of known frequency and amplitude.

use super::*;
use crate::flown::flown;
use crate::innovations::Innovations;

/// Loads have the slopes and dampings of their own plane (CY by β; CN by α; Cl by p; Cm by α and q; Cn by β and r: Etkin and Reid,
/// Dynamics of Flight, 1996, ch. 4), the rate of the other plane as the one across, and moments the square of their own.
#[test]
fn exact_variables_of_loads() {
    let (alpha, beta) = (1, 2);
    let (roll, pitch, yaw) = (0, 1, 2);
    let (x, none) = (Along::Height, Vec::new());
    let expected = [
        (none.clone(), none.clone(), none.clone()),
        (vec![Basis::Slope(beta, x)], vec![Basis::Rate(pitch)], none.clone()),
        (vec![Basis::Slope(alpha, x)], vec![Basis::Rate(yaw)], none.clone()),
        (vec![Basis::Damping(roll, x)], none.clone(), none),
        (vec![Basis::Slope(alpha, x), Basis::Damping(pitch, x)], vec![Basis::Rate(yaw)], vec![Basis::RateSquare(pitch)]),
        (vec![Basis::Slope(beta, x), Basis::Damping(yaw, x)], vec![Basis::Rate(pitch)], vec![Basis::RateSquare(yaw)]),
    ];
    for (place, (proportional, across, square)) in expected.into_iter().enumerate() {
        let of = |keep: fn(&Basis) -> bool, all: Vec<Vec<Basis>>| all.concat().into_iter().filter(keep).collect::<Vec<_>>();
        let along = |b: &Basis| matches!(b, Basis::Slope(_, Along::Height) | Basis::Damping(_, Along::Height));
        assert_eq!(of(along, in_proportion(place)), proportional, "{}", LOADS[place]);
        assert_eq!(of(|b| matches!(b, Basis::Rate(_)), over_motion(place)), across, "{}", LOADS[place]);
        assert_eq!(of(|b| matches!(b, Basis::RateSquare(_)), over_motion(place)), square, "{}", LOADS[place]);
    }
}

/// Drifts have priors of five standard deviations of a sample, the tunnel speed of a hundredth of it. Innovations begin half a
/// second after the start. A sinusoid of amplitude a among n whitened innovations has a power of a²n/6 behind Hann's window, off which
/// go `ln` of the frequencies looked at, and its own frequency; it is the instrument's from the amplitude on that ten times a
/// plausible load would make.
#[test]
fn exact_sizes_and_lines() {
    let (engine, model) = flown(1.2, "damping-shape", &[0.0, 0.1]);
    for a in alternatives(&engine) {
        let (size, share) = match a.site {
            Site::Channel(c) => (engine.noise[c].std(), 5.0),
            Site::Speed => (engine.runs[0].speed_m_s, 0.01),
            Site::Load(_) => continue,
        };
        assert!((a.prior / size - share).abs() < 1e-12, "{a:?}");
    }
    let found: Vec<Innovations> = engine.innovations(&model).expect("a pass");
    let (run, step_s) = (&engine.runs[0], engine.runs[0].step_s());
    let later = run.nodes.iter().filter(|n| n.t_s - run.nodes[0].t_s > 0.5 - 0.5 * step_s).count();
    assert_eq!(found[0].rows.len(), later);

    let plant = model.plant(&engine.campaign);
    let v = &plant.vehicle;
    let (n, turns, pitch) = (200, 74, 4);
    let hz = turns as f64 / (n as f64 * step_s);
    let load = 0.5 * run.nodes[0].density_kg_m3 * run.speed_m_s.powi(2) * v.area_m2() * v.diameter_m * MOMENT;
    let farthest = 10.0 * load / (v.inertia.yy * (std::f64::consts::TAU * hz).powi(2));
    let mut sum = engine.sum(&model, &[], &[]).expect("a pass");
    sum.channels[pitch][1] = farthest * farthest;
    for (amplitude, of_instrument) in [(0.9, false), (1.1, true)] {
        sum.runs[0].innovations.whitened = (0..20 + n)
            .map(|i| {
                let mut row = [0.0; POSE];
                row[pitch] = amplitude * (std::f64::consts::TAU * hz * step_s * i as f64 + 0.7).sin();
                row
            })
            .collect();
        let found = lines(&engine, &model, &sum);
        assert_eq!((found.len(), found[0].channel.as_str(), found[0].of_instrument), (1, CHANNEL_NAMES[pitch], of_instrument));
        let gain = amplitude * amplitude * n as f64 / 6.0 - (110.0 * POSE as f64).ln();
        assert!((found[0].gain - gain).abs() < 1e-9 * gain, "{} {gain}", found[0].gain);
        assert!((found[0].line_hz.expect("a line") / hz - 1.0).abs() < 1e-12);
    }
}
