//! verify tests: every number of the plant's table in both rooms. In: a lander with all parts, one number moved at a time. Out: whether
//! simulator and identifier fly it otherwise, and alike.

use windfall_model::frames::Vec3;
use windfall_model::{
    ApparentMass, Environment, Flight, Inertia, LooseMass, MeanFlow, PLANT_NUMBERS, Plant, PlantNumber, Release, RunScatter,
    Tether, TunnelSpeed, Turbulence, WakeShedding,
};
use windfall_pid::equations::{ADDED, Craft, MOTION, TunnelAir};
use windfall_sim::{Order, Seed, Stepping, Truth, fly_truth, fly_truth_batch};

const SPEED_M_S: f64 = 7.5;
const PS_PA: f64 = 101_000.0;
const TS_K: f64 = 295.0;
const RATE_HZ: f64 = 50.0;
const DURATION_S: f64 = 0.6;
/// Steps of the identifier's equations between two samples, of the classical fourth-order rule: 1 ms, whose error of (ωh)⁴ for the fastest
/// motion here, 30 rad/s, is 1e-6 of a change, well below [`ALIKE`].
const STEPS: u32 = 20;
/// Disagreement allowed of what a moved number does, as a share of it, and in SI: the simulator's tolerance of 1e-9.
const ALIKE: f64 = 1e-4;
const FLOOR: f64 = 1e-8;

/// A lander with every part that both rooms fly, no number of which is null.
fn crowded() -> Plant {
    let mut plant = super::bundled("appendix-c").plant;
    let v = &mut plant.vehicle;
    v.inertia = Inertia { xy: 0.0011, xz: -0.0007, yz: 0.0009, ..v.inertia };
    v.p_origin_cm = Vec3::new(0.011, -0.007, 0.013);
    v.apparent = ApparentMass { axial_kg: 0.05, radial_kg: 0.08, transverse_kg_m2: 0.0008, unturned: 0.3, in_gusts: 0.6 };
    v.loose = Some(LooseMass { mass_kg: 0.04, frequency_hz: 3.0, damping_ratio: 0.2, x_cm_m: 0.05, in_full: 1.0 });
    plant.flow = MeanFlow {
        profile_per_m2: 0.06,
        gradient_per_m: [0.03, -0.05],
        swirl_rad_per_m: 0.07,
        angularity_rad: [0.02, -0.03],
        steady_at_m_s: 6.0,
    };
    let tether = Tether::declared(Vec3::new(-0.25, 0.02, -0.01), Vec3::new(-3.0, 0.1, -0.2), 0.0013, 0.0165);
    plant.tether = Some(Tether {
        line_rate_n_s_m: 0.02,
        length_per_m: 0.3,
        ring_shift_m: [0.05, -0.04],
        swivel_n_m: 0.002,
        swivel_rate_rad_s: 2.0,
        ..tether
    });
    (plant.turbulence, plant.shedding) = (Turbulence::default(), WakeShedding::default());
    plant.environment = Environment { gravity_m_s2: 9.8, gas_constant_j_kg_k: 287.0 };
    plant
}

fn order() -> Flight {
    let mut flight = super::bundled("appendix-c").flights[0].clone();
    (flight.duration_s, flight.rate_hz, flight.sensor_noise, flight.section) = (DURATION_S, RATE_HZ, false, None);
    (flight.speed, flight.ps_pa, flight.ts_k) = (TunnelSpeed::Constant(SPEED_M_S), PS_PA, TS_K);
    flight.release = Release {
        position_m: [0.1, 0.3, -0.2],
        velocity_m_s: [0.2, -0.4, 0.3],
        attitude_rad: [0.4, 0.2, -0.3],
        rates_rad_s: [0.9, 1.1, -0.8],
    };
    flight
}

/// Last state of the simulator's flight: c.m. position and velocity, angles, body rates.
fn simulated(plant: &Plant) -> [f64; 12] {
    last(&fly_truth(plant, &order(), Seed::default()).expect("flies").0)
}

fn last(truth: &Truth) -> [f64; 12] {
    let last = truth.len() - 1;
    let parts = [truth.p_tunnel_cm[last], truth.attitude_rad[last], truth.v_tunnel_cm[last], truth.w_tunnel_body[last]];
    std::array::from_fn(|i| parts[i / 3][i % 3])
}

/// The same of the identifier's equations of motion.
fn identified(plant: &Plant) -> [f64; 12] {
    let craft = Craft::complete(plant).expect("an inertia that has an inverse");
    let density_kg_m3 = PS_PA / (plant.environment.gas_constant_j_kg_k * TS_K);
    let Release { position_m, velocity_m_s, attitude_rad, rates_rad_s } = order().release;
    let mut x = [0.0; MOTION];
    for (k, part) in [position_m, attitude_rad, velocity_m_s, rates_rad_s].into_iter().enumerate() {
        x[3 * k..3 * k + 3].copy_from_slice(&part);
    }
    let mut terms = Vec::new();
    let mut rates = |x: &[f64; MOTION], t_s: f64| {
        let air = TunnelAir { t_s, density_kg_m3, vw_m_s: SPEED_M_S, vw_rate_m_s2: 0.0 };
        craft.rates(x, air, &[0.0; ADDED], &mut terms).expect("the nose points down")
    };
    let h = 1.0 / (RATE_HZ * f64::from(STEPS));
    let along = |x: &[f64; MOTION], k: &[f64; MOTION], h: f64| std::array::from_fn(|i| x[i] + h * k[i]);
    for step in 0..(DURATION_S * RATE_HZ).round() as usize * STEPS as usize {
        let t = step as f64 * h;
        let a = rates(&x, t);
        let b = rates(&along(&x, &a, 0.5 * h), t + 0.5 * h);
        let c = rates(&along(&x, &b, 0.5 * h), t + 0.5 * h);
        let d = rates(&along(&x, &c, h), t + h);
        x = std::array::from_fn(|i| x[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
    }
    std::array::from_fn(|i| x[i])
}

/// The same of the batch, which has equations of its own as well.
fn in_batch(plant: &Plant) -> [f64; 12] {
    let flight = order();
    let orders = [Order { plant, flight: &flight, seed: Seed::default() }];
    let (truth, _) = fly_truth_batch(&orders, Stepping::Rk4 { steps_per_sample: STEPS }).remove(0).expect("flies");
    last(&truth)
}

/// Without what the batch refuses.
fn for_batch(plant: &Plant) -> Plant {
    let mut plant = plant.clone();
    (plant.vehicle.loose, plant.flow.steady_at_m_s) = (None, 0.0);
    (plant.vehicle.apparent.unturned, plant.vehicle.apparent.in_gusts) = (0.0, 0.0);
    plant
}

fn largest(x: [f64; 12]) -> f64 {
    x.iter().fold(0.0, |m, v| m.max(v.abs()))
}

fn less(a: [f64; 12], b: [f64; 12]) -> [f64; 12] {
    std::array::from_fn(|i| a[i] - b[i])
}

/// What is wrong with a number that is moved by a twentieth, with the flights of the lander unmoved: by simulator and identifier, and, of
/// what the batch flies, by simulator and batch.
fn faults(n: &PlantNumber, base: &Plant, [whole, plain]: &[[[f64; 12]; 2]; 2]) -> Vec<String> {
    let mut plant = base.clone();
    let Some(x) = (n.lens)(&mut plant).filter(|x| x.abs() > 0.0) else {
        return vec!["give it a value in `crowded`".to_owned()];
    };
    *x *= 1.05;
    let mut all = Vec::new();
    let mut held = |room: &str, simulator: [f64; 12], other: [f64; 12]| {
        let (size, apart) = (largest(simulator), largest(less(simulator, other)));
        for (who, moved) in [("the simulator", simulator), (room, other)] {
            if largest(moved) < 100.0 * FLOOR {
                all.push(format!("not seen by {who}"));
            }
        }
        if apart > ALIKE * size + FLOOR {
            all.push(format!("simulator and {room} fly it {apart:.1e} apart, of {size:.1e}"));
        }
    };
    held("the identifier", less(simulated(&plant), whole[0]), less(identified(&plant), whole[1]));
    if !n.key.contains("loose") && n.key != "flow.steady_at_m_s" {
        let plant = for_batch(&plant);
        held("the batch", less(simulated(&plant), plain[0]), less(in_batch(&plant), plain[1]));
    }
    all
}

/// Whether a number of gusts, wake, drift or scatter shapes the random inputs.
fn shapes(n: &PlantNumber, base: &Plant) -> bool {
    let (rms, scale) = (0.1, 0.8);
    let turbulence =
        Turbulence { axial_rms_m_s: rms, lateral_rms_m_s: rms, axial_scale_m: scale, lateral_scale_m: scale, bandwidth: 0.0 };
    let shedding = WakeShedding { moment_rms: 0.01, strouhal: 0.2, bandwidth: 0.1 };
    let scatter = RunScatter { aero: 0.1, ..RunScatter::default() };
    let blown = Plant { turbulence, shedding, scatter, ..base.clone() };
    let mut moved = blown.clone();
    if let Some(x) = (n.lens)(&mut moved) {
        *x += 0.5;
    }
    blown.disturbances(SPEED_M_S) != moved.disturbances(SPEED_M_S)
}

/// A number that acts on the lander's motion acts in both rooms and in the batch, which have equations of their own, and alike: who forgets
/// the twin of a force, or to declare where its number is seen, is told so here. Numbers of gusts, wakes, drift and scatter shape random inputs, which both
/// rooms have of one function; those of instruments have their own tests (`pid/tests`, `sim/tests`), and bodies without attitude, pivots
/// and free flight their forces in one place, `model`.
#[test]
fn law_every_quantity_is_seen() {
    let base = crowded();
    let plain = for_batch(&base);
    let before = [[simulated(&base), identified(&base)], [simulated(&plain), in_batch(&plain)]];
    let (mut seen, mut wrong) = (0, Vec::new());
    for n in PLANT_NUMBERS {
        let of_points = ["environment.air_density_kg_m3", "environment.launch_height_m"];
        let found = match n.key.split('.').next().unwrap_or_default() {
            "sensors" | "point" | "pivot" | "free_flight" => continue,
            _ if of_points.contains(&n.key) => continue,
            "turbulence" | "shedding" | "drift" | "scatter" if shapes(n, &base) => Vec::new(),
            "turbulence" | "shedding" | "drift" | "scatter" => vec!["shapes no random input".to_owned()],
            "vehicle" | "tether" | "flow" | "environment" => faults(n, &base, &before),
            _ => vec!["say in this test where it is seen".to_owned()],
        };
        wrong.extend(found.into_iter().map(|what| format!("{}: {what}", n.name())));
        seen += 1;
    }
    // A forgotten number alone: with another flight, the others' shares move a little as well.
    if wrong.iter().any(|w| w.contains("not seen")) {
        wrong.retain(|w| w.contains("not seen"));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    for [one, other] in before {
        let apart = largest(less(one, other));
        assert!(apart < 1e-6, "{apart} apart with every number as it is");
    }
    assert!(seen > 40, "{seen} numbers moved");
}
