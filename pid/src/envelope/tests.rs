use super::*;
use crate::equations::tests::plant;
use windfall_model::MeanFlow;
use windfall_model::frames::Vec3;

/// A body that rises steadily at `rise_m_s` in a stream of 7 m/s, its axis 0.1 rad off the vertical, rolling steadily at `rolls_rad_s`.
pub(crate) fn steady(rise_m_s: f64, rolls_rad_s: f64, seconds: usize) -> Record {
    let t_s: Vec<f64> = (0..=100 * seconds).map(|i| 0.01 * i as f64).collect();
    let constant = |x: f64| vec![x; t_s.len()];
    Record {
        position_m: [t_s.iter().map(|t| -rise_m_s * t).collect(), constant(0.0), constant(0.0)],
        attitude_rad: [t_s.iter().map(|t| rolls_rad_s * t).collect(), constant(0.1), constant(0.0)],
        vw_m_s: constant(7.0),
        ps_pa: constant(101_325.0),
        ts_k: constant(288.15),
        t_s,
        ..Record::default()
    }
}

/// The plant of the tests in an even stream, its c.m. at the origin.
pub(crate) fn even() -> Plant {
    let mut even = plant();
    even.flow = MeanFlow::default();
    even.vehicle.p_origin_cm = Vec3::zero();
    even
}

/// By hand: V_∞ = 7 − 0.5, α_T = 0.1 rad, p = −0.2 cos 0.1 and r = −0.2 sin 0.1 (eq. 3.21), Re = 1.225·6.5·0.2125/1.7894e-5 = 94 560.
#[test]
fn exact_steady_rise() {
    let e = Envelope::of_record(&steady(0.5, -0.2, 4), &even()).expect("a stream");
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-7 * (1.0 + b.abs()), "{a} {b}");
    near(e.duration_s, 4.0);
    near(e.max_alpha_t_deg, 0.1_f64.to_degrees());
    near(e.max_p_deg_s, (0.2 * 0.1_f64.cos()).to_degrees());
    near(e.max_q_deg_s, 0.0);
    near(e.max_r_deg_s, (0.2 * 0.1_f64.sin()).to_degrees());
    near(e.speed_m_s[0], 6.5);
    near(e.speed_m_s[1], 6.5);
    let reynolds = e.reynolds_number.expect("air");
    assert!((reynolds - 94_560.0).abs() < 5.0, "{reynolds}");
    let mut helium = even();
    helium.environment.gas_constant_j_kg_k = 2077.0;
    assert_eq!(Envelope::of_record(&steady(0.5, 0.0, 1), &helium).expect("a stream").reynolds_number, None);
}

/// Largest of each, durations added, Reynolds numbers by duration: (55·100 + 18·150)/73 = 112.328 767.
#[test]
fn exact_runs_together() {
    let of = |duration_s, x: f64, speed_m_s, reynolds_number| Envelope {
        duration_s,
        max_alpha_t_deg: x,
        max_p_deg_s: 10.0 - x,
        max_q_deg_s: 2.0 * x,
        max_r_deg_s: 9.0 - x,
        speed_m_s,
        reynolds_number,
    };
    let (a, b) = (of(55.0, 3.0, [7.0, 7.6], Some(100.0)), of(18.0, 5.0, [7.2, 8.0], Some(150.0)));
    let both = Envelope::joined([&a, &b]).expect("two");
    let largest = [both.duration_s, both.max_alpha_t_deg, both.max_p_deg_s, both.max_q_deg_s, both.max_r_deg_s];
    assert!(largest.iter().zip([73.0, 5.0, 7.0, 10.0, 6.0]).all(|(a, b)| (a - b).abs() < 1e-12), "{largest:?}");
    assert!((both.speed_m_s[0] - 7.0).abs() < 1e-12 && (both.speed_m_s[1] - 8.0).abs() < 1e-12);
    assert!((both.reynolds_number.expect("both") - 8200.0 / 73.0).abs() < 1e-9);
    assert_eq!(Envelope::joined([&a, &of(1.0, 1.0, [7.0, 7.0], None)]).expect("two").reynolds_number, None);
    assert_eq!(Envelope::joined([]), None);
}

/// Three periods of 2.6 Hz are 116 samples of 10 ms: they are left out at both ends of 801 samples, of a window only those that it has of them.
/// Where nothing else is left, there is no interior.
#[test]
fn exact_interior() {
    let mut smoothed = smooth(&steady(0.5, 0.2, 8), &Smoother::Auto).expect("a sound record");
    smoothed.bandwidth_hz.fill(1.0);
    smoothed.bandwidth_hz[4] = 2.6;
    assert_eq!(interior(&smoothed, &(0..801)), Some(116..685));
    assert_eq!(interior(&smoothed, &(100..301)), Some(16..201));
    assert_eq!(interior(&smoothed, &(600..801)), Some(0..85));
    assert_eq!(interior(&smoothed, &(20..110)), None);
}

/// The first sample of a recording may jump, and no rate is made of it. Of a window in the middle of a recording its own first samples count,
/// since what is before them is known: the roll rate is 0.2 + 0.1 sin(π t) rad/s up to 4 s, largest at 2.5 s, and none later.
#[test]
fn law_ends_of_the_recording_are_left_out() {
    let mut record = steady(0.5, 0.2, 8);
    for i in 0..400 {
        let t = 0.01 * i as f64;
        record.attitude_rad[0][i] = 0.2 * t + 0.2 * (0.5 * std::f64::consts::PI * t).sin().powi(2) / std::f64::consts::PI;
    }
    (400..=800).for_each(|i| record.attitude_rad[0][i] = 0.8);
    let of = |r: &Record| Envelope::of_record(r, &even()).expect("a stream").max_p_deg_s;
    let all = of(&record);
    let (early, late) = (of(&record.window(100..301)), of(&record.window(500..701)));
    assert!((early / all - 1.0).abs() < 0.05, "{early} {all}");
    assert!(late < 0.1 * all, "after the roll has stopped: {late}");
    let mut jerked = steady(0.5, 0.2, 8);
    jerked.attitude_rad[0][0] = 0.02;
    assert!((of(&jerked) / (0.2 * 0.1_f64.cos()).to_degrees() - 1.0).abs() < 0.05, "{}", of(&jerked));
}
