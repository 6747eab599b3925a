//! pid tests: places of ring and attachment by hand.

use super::super::tests::{campaign, record};
use super::*;
use crate::equations::tests::plant;
use windfall_model::frames::Vec3;

/// Air of ½ 1.2 V² with V = 7 m/s, 29.4 Pa, on a drag area of 0.05 m² less 0.4 N: a pull of 1.07 N.
fn with(ring: f64, hook: f64, from: f64, weight_n: f64) -> Option<GrossFault> {
    let mut plant = plant();
    let t = plant.tether.as_mut().expect("declared");
    t.p_tunnel_ring = Vec3::new(ring, 0.1, 0.0);
    t.p_origin_hook = Vec3::new(hook, 0.02, 0.0);
    (t.drag_area_m2, t.weight_n) = (0.05, weight_n);
    let mut r = record(100, 0.01, |i| [from + 0.01 * i as f64, 0.0, 0.0, 0.0, 0.0, 0.0]);
    r.vw_m_s = vec![7.0; 100];
    r.ps_pa = vec![1.2 * plant.environment.gas_constant_j_kg_k * 295.0; 100];
    fault(&campaign(plant, Vec::new()), &[("r", &r)])
}

/// A ring under all of the runs, wherever these are, of a line that pulls: with the weight of the line above its drag it may be
/// there.
#[test]
fn exact_ring_below_the_model() {
    let found = with(17.3, -0.25, 15.0, 0.4).expect("below");
    assert!(found.evidence.contains("with a pull of 1.07 N, and ring_m has X = +17.3 m"), "{}", found.evidence);
    assert!(found.change.contains("X = -17.3"), "{}", found.change);
    assert!(with(17.3, -0.25, 15.0, 1.5).is_none() && with(15.5, -0.25, 15.0, 0.4).is_none());
    // Runs over more than 20 m are in another unit.
    let mut plant = plant();
    plant.tether.as_mut().expect("declared").p_tunnel_ring = Vec3::new(60.0, 0.0, 0.0);
    let r = record(100, 0.01, |i| [0.3 * i as f64, 0.0, 0.0, 0.0, 0.0, 0.0]);
    assert!(fault(&campaign(plant, Vec::new()), &[("r", &r)]).is_none());
}

/// With the ring above, an attachment 0.1 m ahead of the origin, 0.471 of 0.2125 m, is on the other side; a fifth of a diameter is
/// not.
#[test]
fn exact_attachment_on_the_other_side() {
    let found = with(-3.0, 0.1, 0.0, 0.4).expect("beyond");
    assert!(found.evidence.contains("x = +0.1 m, 0.471 reference diameters below"), "{}", found.evidence);
    assert!(with(-3.0, 0.2 * 0.2125, 0.0, 0.4).is_none() && with(0.5, 0.1, 0.0, 0.4).is_none());
}
