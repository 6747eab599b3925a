//! pid tests: windows of a record against printed weights and against the polynomials that they leave as they are.

use super::super::tests::record;
use super::*;

/// Weights of Savitzky and Golay (Anal. Chem. 36, 1964, tables I, IV and VIII, with Steinier's corrections of 1972): the numbers
/// over their norms, by an interval of 0.3 s.
#[test]
fn pub_weights_of_savitzky_and_golay() {
    let h = 0.3;
    let check = |half: usize, numbers: [(&[f64], f64); 3]| {
        for (found, (printed, norm)) in weights(half, h).expect("regular").iter().zip(numbers) {
            assert_eq!(found.len(), printed.len());
            // Powers of at most 3 through normal equations of condition 1e4.
            assert!(found.iter().zip(printed).all(|(w, p)| (w - p / norm).abs() < 1e-11), "{found:?} {printed:?}");
        }
    };
    check(
        2,
        [
            (&[0.0, 0.0, 1.0, 0.0, 0.0], 1.0),
            (&[1.0, -8.0, 0.0, 8.0, -1.0], 12.0 * h),
            (&[-3.0, 48.0, -90.0, 48.0, -3.0], 36.0 * h * h),
        ],
    );
    check(
        3,
        [
            (&[5.0, -30.0, 75.0, 131.0, 75.0, -30.0, 5.0], 231.0),
            (&[22.0, -67.0, -58.0, 0.0, 58.0, 67.0, -22.0], 252.0 * h),
            (&[-117.0, 603.0, -171.0, -630.0, -171.0, 603.0, -117.0], 1188.0 * h * h),
        ],
    );
}

/// Of a pulse in the middle of seven samples 131/231 are left, of one beside it 75/231, at the end 5/231 (the same table).
#[test]
fn pub_smoothed_pulse() {
    let at = |pulse: usize| {
        let r = record(7, 0.02, |i| [f64::from(u8::from(i == pulse)), 0.0, 0.0, 0.0, 0.0, 0.0]);
        instants(&[("r", &r)])[0].motion[0][0]
    };
    for (pulse, printed) in [(3, 131.0), (4, 75.0), (0, 5.0)] {
        assert!((at(pulse) - printed / 231.0).abs() < 1e-11, "{pulse}");
    }
}

/// A quartic of a channel's own, with two derivatives.
fn quartic(channel: usize, t: f64) -> [f64; 3] {
    let c: [f64; 5] = std::array::from_fn(|k| [0.7, -1.3, 0.4, 0.9, -0.3][k] * (1.0 + 0.2 * channel as f64 * (k as f64 - 1.7)));
    [
        c[0] + t * (c[1] + t * (c[2] + t * (c[3] + t * c[4]))),
        c[1] + t * (2.0 * c[2] + t * (3.0 * c[3] + t * 4.0 * c[4])),
        2.0 * c[2] + t * (6.0 * c[3] + t * 12.0 * c[4]),
    ]
}

fn run(count: usize, interval_s: f64) -> Record {
    // Times are counted from the middle, where the numbers are smallest.
    let t = |i: usize| (i as f64 - 0.5 * count as f64) * interval_s;
    let at = |k: usize, i: usize| quartic(k, t(i))[0];
    let mut r = record(count, interval_s, |i| std::array::from_fn(|k| at(k, i)));
    r.t_s = (0..count).map(t).collect();
    r.vw_m_s = (0..count).map(|i| at(6, i)).collect();
    r.ps_pa = (0..count).map(|i| 1e5 + i as f64).collect();
    r
}

/// Windows of quartics give these and their derivatives, in every third sample of two runs of 1301, from half a window of 0.35 s
/// on; V_W also later by steps of 0.15 s, as far as windows reach.
#[test]
fn exact_quartics() {
    let (long, short) = (run(700, 0.025), run(601, 0.025));
    let found = instants(&[("a", &long), ("b", &short)]);
    assert_eq!(found.len(), 224 + 191);
    let near = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-8 * (1.0 + b.abs()));
    for (n, m) in found.iter().enumerate() {
        let (r, i) = if n < 224 { (&long, 14 + 3 * n) } else { (&short, 14 + 3 * (n - 224)) };
        assert!((m.t_s - r.t_s[i]).abs() < 1e-15 && (m.span_s - 0.075).abs() < 1e-15);
        assert!((m.ps_pa - (1e5 + (0.5 * (r.len() - 1) as f64).round())).abs() < 1e-9 && (m.ts_k - 295.0).abs() < 1e-9);
        for (k, x) in m.motion.iter().enumerate() {
            assert!(near(*x, quartic(k, m.t_s)), "{n} {k} {x:?}");
        }
        for (k, x) in m.later.iter().enumerate() {
            assert!(near(*x, quartic(6, r.t_s[(i + 6 * (k + 1)).min(r.len() - 15)])), "{n} {k} {x:?}");
        }
    }
}

/// Angles have windows of their own, 0.2 s to each side: a spike beyond is not seen, and in it is.
#[test]
fn exact_width_of_windows() {
    let at = |spike: usize, channel: usize| {
        let mut r = record(101, 0.025, |_| [0.0; 6]);
        r.channels_mut()[channel][spike] = 1.0;
        let i = instants(&[("r", &r)]).into_iter().find(|m| (m.t_s - 1.25).abs() < 1e-9).expect("the middle");
        i.motion[channel][0].abs() > 1e-9
    };
    for (channel, half) in [(1, 14), (4, 8)] {
        assert!(at(50 - half, channel) && at(50 + half, channel));
        assert!(!at(49 - half, channel) && !at(51 + half, channel));
    }
}

/// A record that is shorter than its windows has one of all that it has; one with a clock in other units has windows of so many
/// samples.
#[test]
fn exact_short_and_slow_records() {
    let short = run(27, 0.025);
    let found = instants(&[("r", &short)]);
    assert_eq!(found.len(), 1);
    assert!((found[0].t_s - short.t_s[13]).abs() < 1e-15);
    let slow = instants(&[("r", &run(120, 0.5))]);
    assert_eq!(slow.len(), 20);
    let fast = instants(&[("r", &run(30, 1e-6))]);
    assert_eq!(fast.len(), 2);
}
