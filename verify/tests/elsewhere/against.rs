//! Two simulators that share nothing, each against the other: what a family of the catalogue means in numbers here and in the
//! program's own simulator.

use crate::air::Track;
use crate::algebra::{V, attitude};
use crate::craft::Craft;
use crate::flight::{Plan, STEEP, apart, follow};
use crate::instruments::clean;
use crate::knobs::{Knob as K, Knobs};
use crate::motion::{Drive, World};
use windfall_model::{Acts, CATALOGUE};
use windfall_scenarios::read_bundled;
use windfall_sim::Seed;

/// Largest distance (m) and angle (rad) between both records of the thesis' Appendix C flight with an effect in it.
fn differ(family: &str, values: &[f64], knobs: &[(K, f64)], change: impl Fn(&mut Craft)) -> (f64, f64) {
    let file = read_bundled("appendix-c").expect("bundled");
    let mut plant = file.scenario.plant.clone();
    let mut flight = file.scenario.flights[0].clone();
    flight.sensor_noise = false;
    if let Some(effect) = CATALOGUE.iter().find(|e| e.family == family && e.acts.on(Acts::Lander)) {
        assert_eq!((effect.parameters)(&[]).len(), values.len(), "{family}");
        (effect.apply)(&mut plant, values);
    }
    let flown = windfall_sim::fly(&plant, &flight, Seed { campaign: 1, run: 0 }).expect("it flies");
    let truth = &flown.truth;
    let v = &plant.vehicle;
    let mut craft = Craft::sage();
    craft.mass = v.mass_kg;
    craft.inertia = [v.inertia.xx, v.inertia.yy, v.inertia.zz];
    craft.pressure = flight.ps_pa;
    craft.temperature = flight.ts_k;
    let declared = &file.scenario.plant;
    craft.aero.copy_from_slice(&declared.aero.values);
    let tether = declared.tether.as_ref().expect("the model hangs on a tether");
    craft.drag_area = tether.drag_area_m2;
    craft.line_weight = tether.weight_n;
    craft.hook = tether.p_origin_hook.to_array();
    craft.ring = tether.p_tunnel_ring.to_array();
    change(&mut craft);
    let mut set = Knobs::default();
    knobs.iter().for_each(|(k, value)| set.set(*k, *value));
    let drive = Drive::Given(Track::new(0.0, 1.0 / flight.rate_hz, truth.vw_m_s.clone()));
    // At a trim of 1 m/s lateral winds are given per unit of tunnel speed.
    let world = World::new(&craft, &set, 1.0, drive, 1.0);
    let start: [V; 4] = [truth.p_tunnel_cm[0], truth.attitude_rad[0], truth.v_tunnel_cm[0], truth.w_tunnel_body[0]];
    let plan = Plan {
        name: family.to_owned(),
        kind: "perturbed",
        hold_out: false,
        duration: (truth.len() - 1) as f64 / flight.rate_hz,
        rate_hz: flight.rate_hz,
        start,
        size: 1.0,
        steep: STEEP,
    };
    let here = clean(&follow(&world, &plan).expect("it flies here"), &craft, &set, 1.0);
    let there = &flown.record;
    // The program's instruments continue a late pose before the first sample, these fly it.
    (5..truth.len()).fold((0.0_f64, 0.0_f64), |worst, k| {
        let read = attitude([0, 1, 2].map(|j| there.attitude_rad[j][k]));
        let made = attitude([here[k][4], here[k][5], here[k][6]].map(f64::to_radians));
        let place = [0, 1, 2].map(|j| there.position_m[j][k]);
        let (x, turn) = apart((place, &read), ([here[k][1], here[k][2], here[k][3]], &made));
        (worst.0.max(x), worst.1.max(turn))
    })
}

fn same(family: &str, values: &[f64], knobs: &[(K, f64)], within: f64) {
    same_with(family, values, knobs, within, |_| ());
}

fn same_with(family: &str, values: &[f64], knobs: &[(K, f64)], within: f64, change: impl Fn(&mut Craft)) {
    let (x, turn) = differ(family, values, knobs, change);
    println!("{family:22} {x:.1e} m {turn:.1e} rad");
    assert!(x < within && turn < within, "{family}: {x:.2e} m, {turn:.2e} rad, of {within:.0e}");
}

/// What is declared only, and every family that moves the model: 1e-6 m and rad after 15 s, which leaves room for tunnel speed
/// between samples.
#[test]
fn exact_both_simulators_agree_on_every_family() {
    const CLOSE: f64 = 1e-6;
    same("none", &[], &[], CLOSE);
    same("apparent-mass", &[0.035, 0.022, 5e-4, 0.0, 0.0], &[(K::MaX, 0.035), (K::MaR, 0.022), (K::IaR, 5e-4)], CLOSE);
    let asymmetry = [(K::Cm0, 0.03), (K::Cn0, -0.02), (K::CY0, 0.04), (K::CN0, 0.05)];
    same("asymmetry", &[0.03, -0.02, 0.04, 0.05], &asymmetry, CLOSE);
    same("axial-shape", &[-2.0, 3.0], &[(K::CA2, -2.0), (K::CA4, 3.0)], CLOSE);
    same("axial-speed", &[-0.03 * 6.662, 1.0], &[(K::CaV, -0.03)], CLOSE);
    same("damping-shape", &[7.0, 0.1], &[(K::Bump, 7.0), (K::BumpWidth, 0.1)], CLOSE);
    same("magnus", &[6.0, 4.0], &[(K::Mag, 6.0), (K::MagF, 4.0)], CLOSE);
    same("rate-force", &[9.0], &[(K::CNq, 9.0)], CLOSE);
    same("roll-damping-shape", &[-30.0, -200.0], &[(K::Clps, -30.0), (K::Clpp, -200.0)], CLOSE);
    same("roll-periodic", &[0.2, -0.1, 3.0], &[(K::RpCos, 0.2), (K::RpSin, -0.1), (K::RpN, 3.0)], CLOSE);
    let profile = [(K::Prof, 0.03 * 3.05 * 3.05), (K::TiltY, 0.02), (K::TiltZ, -0.01)];
    same("flow-profile", &[0.03, 0.02, -0.01], &profile, CLOSE);
    same("swirl", &[0.02, 0.0, 7.5], &[(K::Swirl, 0.02)], CLOSE);
    same("cross-flow", &[0.01, -0.02, 0.0, 7.5], &[(K::Vy, 0.01), (K::Vz, -0.02)], CLOSE);
    same("tether-line-rate", &[0.6], &[(K::TethC, 0.6)], CLOSE);
    same("tether-length", &[2.0], &[(K::TethLen, 2.0)], CLOSE);
    let pulled = |c: &mut Craft| {
        c.drag_area *= 4.0;
        c.line_weight *= 4.0;
    };
    same_with("tether-geometry", &[3.0, 3.0, 0.5, -0.3], &[(K::RingY, 0.5), (K::RingZ, -0.3)], CLOSE, pulled);
    same_with("center-of-mass", &[0.002, -0.001, 0.0025], &[], CLOSE, |c| c.cm = [0.002, -0.001, 0.0025]);
    // The moment about y is already the vehicle's.
    same("inertia", &[3e-4, -4e-4, 2e-4, 1e-4], &[(K::Ixy, 3e-4), (K::Ixz, -4e-4), (K::Iyz, 2e-4)], CLOSE);
    let loose = [(K::SloshM, 0.03), (K::SloshHz, 2.5), (K::SloshZeta, 0.05), (K::SloshX, 0.1)];
    // Its resonance makes more of what tunnel speed does between samples.
    same("loose-mass", &[0.03, 2.5, 0.05, 0.1, 1.0], &loose, 5.0 * CLOSE);
    let heavy = [(K::SloshM, 0.154), (K::SloshHz, 2.38), (K::SloshZeta, 0.047), (K::SloshX, -0.1)];
    same("loose-mass", &[0.154, 2.38, 0.047, -0.1, 1.0], &heavy, 5.0 * CLOSE);
    same("pose-misalignment", &[0.003, 0.01, -0.006], &[(K::MisX, 0.003), (K::MisY, 0.01), (K::MisZ, -0.006)], CLOSE);
    // Early samples are left out, the rest is interpolated by cubics.
    same("pose-delay", &[0.012], &[(K::PoseDelay, 0.012)], CLOSE);
}
