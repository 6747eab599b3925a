//! sim tests: a flight allocates for its inputs and its samples, never for a step. In: a counting allocator. Out: counts.
//!
//! A binary of its own, with one test: the counter sees every thread.

use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use std::alloc::System;
use windfall_model::frames::Vec3;
use windfall_model::{ApparentMass, Contact, Flight, Integrator, LooseMass, Numerics, Plant, Release, TunnelSpeed};
use windfall_sim::{Seed, fly};

/// The tests' lander.
#[path = "it/sage.rs"]
mod sage;

#[global_allocator]
static GLOBAL: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

fn plant() -> Plant {
    let contact =
        Contact { run: 0, start_s: 1.0, duration_s: 1.0, impulse: Vec3::new(0.01, 0.0, 0.0), angular_impulse: Vec3::zero() };
    Plant { contacts: vec![contact], ..sage::lander() }
}

/// Allocations and accepted steps of one flight at a tolerance.
fn counted(plant: &Plant, method: Integrator, relative_tolerance: f64) -> (usize, u64) {
    let order = Flight {
        name: "test".into(),
        kind: "perturbed".into(),
        used: windfall_model::Use::Identify,
        duration_s: 5.0,
        rate_hz: 100.0,
        release: Release { position_m: [0.0; 3], velocity_m_s: [0.0; 3], attitude_rad: [0.0, 0.3, 0.2], rates_rad_s: [0.0; 3] },
        speed: TunnelSpeed::Constant(7.43),
        ps_pa: 101_325.0,
        ts_k: 299.0,
        section: None,
        numerics: Numerics { method, relative_tolerance, absolute_tolerance: relative_tolerance },
        sensor_noise: false,
        pushes: Vec::new(),
        window_s: None,
    };
    // The test harness' own thread may allocate meanwhile, which only adds: the least of several counts is the flight's.
    let once = || {
        let region = Region::new(GLOBAL);
        let steps = fly(plant, &order, Seed::default()).expect("flies").steps;
        let change = region.change();
        (change.allocations + change.reallocations, steps)
    };
    (0..10).map(|_| once()).min().expect("ten counts")
}

#[test]
fn law_no_allocation_per_step() {
    let mut crowded = plant();
    crowded.vehicle.apparent =
        ApparentMass { axial_kg: 0.1, radial_kg: 0.1, transverse_kg_m2: 0.001, unturned: 0.0, in_gusts: 0.0 };
    crowded.vehicle.loose = Some(LooseMass { mass_kg: 0.05, frequency_hz: 2.0, damping_ratio: 0.1, x_cm_m: 0.1, in_full: 1.0 });
    for plant in [plant(), crowded] {
        for method in [Integrator::Dop853, Integrator::Dopri5] {
            let (few, short) = counted(&plant, method, 1e-5);
            let (many, long) = counted(&plant, method, 1e-12);
            assert!(long > 2 * short, "{short} and {long} steps");
            assert_eq!(few, many, "{method:?}: {short} and {long} steps");
        }
    }
}
