//! discover tests: means over settings and time against the analysis of variance by hand; residuals of tracks over time.

use super::*;

/// A variable of three values gives three means, one of a single value none; of a smooth one all intervals.
#[test]
fn exact_means_over_settings() {
    let setting: Vec<f64> = (0..90).map(|i| f64::from(i % 3)).collect();
    let residual: Vec<f64> = (0..90).map(|i| f64::from(i % 3) * 2.0 + if i % 2 == 0 { 0.1 } else { -0.1 }).collect();
    let m = means(&setting, &residual).expect("three settings");
    assert_eq!(m.x, [0.0, 1.0, 2.0]);
    assert!(m.y.iter().zip([0.0, 2.0, 4.0]).all(|(a, b)| (a - b).abs() < 0.02) && m.share > 0.9);
    assert!(means(&[0.238; 90], &residual).is_none());
    let rounded: Vec<f64> = (0..90).map(|i| if i % 2 == 0 { 0.238 } else { 0.238 + 3e-17 }).collect();
    assert!(means(&rounded, &residual).is_none());
    let time: Vec<f64> = (0..90).map(f64::from).collect();
    assert!(means(&time, &residual).is_some_and(|m| m.x.len() >= INTERVALS - 1));
}

/// Twelve intervals of ten neighbours each; settings of unlike counts have a share of variance of one less what is left within
/// them. Neither the unit of a variable nor where it has its zero matters, as long as its steps are above rounding.
#[test]
fn exact_intervals_and_share_of_variance() {
    let time: Vec<f64> = (0..120).map(f64::from).collect();
    let by_time = means(&time, &time).expect("intervals");
    let places: Vec<f64> = (0..12).map(|k| 10.0 * f64::from(k) + 4.5).collect();
    assert!(by_time.x.len() == 12 && by_time.x.iter().zip(&places).all(|(a, b)| (a - b).abs() < 1e-12), "{:?}", by_time.x);

    let sizes = [(20, -0.7), (31, 0.4), (39, 2.3)];
    let setting: Vec<f64> = sizes.iter().enumerate().flat_map(|(k, (n, _))| vec![k as f64; *n]).collect();
    let scatter = |i: usize| 0.3 * (1.7 * i as f64).sin();
    let y: Vec<f64> = sizes.iter().flat_map(|(n, m)| (0..*n).map(move |i| m + scatter(i))).collect();
    let square = |y: &[f64]| {
        let mean = y.iter().sum::<f64>() / y.len() as f64;
        y.iter().map(|y| (y - mean).powi(2)).sum::<f64>()
    };
    let within = square(&y[..20]) + square(&y[20..51]) + square(&y[51..]);
    let m = means(&setting, &y).expect("three settings");
    assert!((m.share - (1.0 - within / square(&y))).abs() < 1e-12, "{}", m.share);
    for (unit, zero) in [(1e-5, 0.0), (1e-6, 1000.0)] {
        let moved: Vec<f64> = setting.iter().map(|x| zero + unit * x).collect();
        let moved = means(&moved, &y).expect("three settings");
        assert!((moved.share - m.share).abs() < 1e-12 && moved.x.len() == 3, "{unit} {zero}");
    }
}

/// Blocks end with a fifth of a second and where the clock goes back to another run's start; each has its mean.
#[test]
fn exact_means_of_neighbours_in_time() {
    let t = vec![10.0, 10.1, 10.15, 10.25, 10.3, 10.46, 3.0, 3.05];
    let table = LeadTable {
        residuals: vec![vec![1.0, 2.0, 6.0, -3.0, 4.0, 7.0, 5.0, -1.0]],
        variables: vec![("time in the run (s)".to_owned(), t.clone()), ("u".to_owned(), t)],
    };
    let slow = slow(table);
    assert_eq!(slow.residuals, [[3.0, 0.5, 7.0, 2.0]]);
    let times = [10.25 / 3.0 + 20.0 / 3.0, 10.275, 10.46, 3.025];
    assert!(slow.variables.iter().all(|(_, x)| x.iter().zip(times).all(|(a, b)| (a - b).abs() < 1e-12)), "{:?}", slow.variables);
}

#[test]
fn exact_size_over_noise() {
    let line =
        |channel: &str, rms, expected_rms, p_value| ChannelResidual { channel: channel.to_owned(), rms, expected_rms, p_value };
    let all = [line("X", 3.0, 2.0, 0.001), line("Y", 9.0, 2.0, 0.2), line("Z", 4.0, 0.5, 0.004)];
    assert_eq!(beyond_noise(&all, 0.005), [(0, 1.5, "X".to_owned()), (2, 8.0, "Z".to_owned())]);
}

/// Two runs of positions in mm: root mean squares of what falls into one fortieth of the time, at its mean time.
#[test]
fn exact_size_of_tracks_over_time() {
    let run = |t_s: [f64; 3], e: [f64; 3]| TrackResidual {
        run: 0,
        measured: Measured::Position,
        t_s: t_s.to_vec(),
        residual_m: [None, Some(e.to_vec()), None, None, None, None],
        position_m: [0.0; 3],
        velocity_m_s: [0.0; 3],
    };
    let runs = vec![run([0.0, 0.51, 1.0], [0.003, -0.007, 0.002]), run([0.01, 0.505, 0.99], [0.004, 0.001, -0.006])];
    let all = tracks(&[(Role::Before, runs)]);
    assert_eq!(all.len(), 1, "one axis was measured");
    let s = &all[0].series[0];
    let rms = |a: f64, b: f64| ((a * a + b * b) / 2.0).sqrt();
    let expected = [(0.005, rms(3.0, 4.0)), (0.5075, rms(7.0, 1.0)), (0.995, rms(2.0, 6.0))];
    // Six digits are kept.
    let near = |x: f64, y: f64| (x - y).abs() < 1e-5 * y;
    assert!(s.x.len() == 3 && s.x.iter().zip(&s.y).zip(expected).all(|((x, y), e)| near(*x, e.0) && near(*y, e.1)), "{s:?}");
}
