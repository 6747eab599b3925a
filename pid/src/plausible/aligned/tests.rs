//! pid tests: columns of two recorders moved against each other by hand.

use super::super::tests::{campaign, record};
use super::*;
use crate::equations::tests::plant;

/// X is the sample's number, and so are V_W, p_s and T_s, a hundred, two and three hundred more.
fn numbered(count: usize) -> Record {
    let mut r = record(count, 0.01, |i| [i as f64, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let more = |by: f64| (0..count).map(|i| by + i as f64).collect::<Vec<f64>>();
    (r.vw_m_s, r.ps_pa, r.ts_k) = (more(100.0), more(200.0), more(300.0));
    r.bridged = (0..count).map(|i| i == 50).collect();
    r
}

fn first(campaign: &Campaign) -> &Record {
    match &campaign.runs[0].data {
        Data::Tunnel(r) => r,
        Data::Point(_) => unreachable!("a tunnel run"),
    }
}

/// A lag of 0.0312 s at 100 Hz is three samples: the pose of sample i stands beside the speed of i + 3, and the last three poses are gone; for
/// an early speed the first three. What was filled in on either side is marked.
#[test]
fn exact_columns_are_moved() {
    let whole = campaign(plant(), vec![numbered(100)]);
    for (lag, first_pose, ahead, marked) in [(0.0312, 0.0, 3.0, [47, 50]), (-0.0312, 3.0, -3.0, [47, 50])] {
        let (found, taken_s) = moved(&whole, lag).expect("moved");
        let r = first(&found);
        assert!((taken_s - 0.03 * lag.signum()).abs() < 1e-12 && r.len() == 97);
        for i in 0..97 {
            let pose = r.position_m[0][i];
            assert!((pose - first_pose - i as f64).abs() < 1e-12);
            for (x, by) in [(&r.vw_m_s, 100.0), (&r.ps_pa, 200.0), (&r.ts_k, 300.0)] {
                assert!((x[i] - by - pose - ahead).abs() < 1e-9, "{lag} {i}");
            }
        }
        let marks: Vec<usize> = (0..97).filter(|i| r.bridged[*i]).collect();
        assert_eq!(marks, marked, "{lag}");
    }
}

/// A run whose interval the lag is no multiple of has its speed by a straight line between samples.
#[test]
fn exact_between_samples() {
    let mut other = numbered(100);
    other.t_s.iter_mut().for_each(|t| *t *= 0.8);
    let (found, _) = moved(&campaign(plant(), vec![numbered(100), other]), 0.03).expect("moved");
    let Data::Tunnel(r) = &found.runs[1].data else { unreachable!("a tunnel run") };
    assert_eq!(r.len(), 96);
    assert!((0..96).all(|i| (r.vw_m_s[i] - 103.75 - i as f64).abs() < 1e-9));
}

/// Nothing is moved by less than a sample, nor where less than half of a run would be left.
#[test]
fn exact_what_is_not_moved() {
    let whole = campaign(plant(), vec![numbered(100)]);
    assert!(
        moved(&whole, 0.004).is_none() && moved(&whole, 0.6).is_none() && moved(&campaign(plant(), Vec::new()), 1.0).is_none()
    );
}

/// The effect that makes up for a lag of either sign: with it a plant has just that lag more.
#[test]
fn exact_effect_of_a_lag() {
    let mut plant = plant();
    plant.sensors.wind_delay_s = 0.3;
    for extra in [1.8, -1.0] {
        let (effect, values) = effect_of(&plant, extra).expect("a lag");
        let mut with = plant.clone();
        (effect.apply)(&mut with, &values);
        assert!((lag_s(&with) - 0.3 - extra).abs() < 1e-12, "{}", effect.family);
        assert!((effect.parameters)(&[]).iter().all(|p| (p.low..=p.high).contains(&values[0])));
    }
}
