//! sim bench: 30 s lander flights at 100 Hz by fixed steps, side by side on the vector unit, beside the same model by hand on
//! boost::odeint's scalar runge_kutta4. In: nothing. Out: steps per second of both in turn, their ratio and its spread over the
//! rounds, the error of both against Dop853 at 1e-12, and two threads against one.
//!
//! What is not alike: the peer flies one flight again and again with the lander's formulas compiled in, ours many different
//! flights with the formulas read as data; both build their V_W interpolant inside the timing. Best of many short pieces within
//! a round, which other work on the machine disturbs least.

#![expect(clippy::print_stdout, reason = "a bench reports on the terminal")]

#[path = "common/lander.rs"]
mod lander;

use lander::{Peer, distance, flight, plant, processor_s, states};
use std::hint::black_box;
use std::sync::Barrier;
use std::time::Instant;
use windfall_model::{Flight, Integrator, Plant};
use windfall_sim::{Order, Seed, Stepping, fly_truth, for_each_states, for_each_truth};

const DURATION_S: f64 = 30.0;
const RATE_HZ: f64 = 100.0;
const STEPS: f64 = DURATION_S * RATE_HZ;
const STEP: Stepping = Stepping::Rk4 { steps_per_sample: 1 };
/// Flights of a piece.
const SIDE: usize = 32;
const ROUNDS: usize = 9;
/// Pieces of a round, and flights of the peer's.
const PIECES: usize = 16;
const PEER_FLIGHTS: usize = 150;

/// Flights that differ in aerodynamics, mass and release.
fn drawn(k: usize) -> (Plant, Flight) {
    let (mut plant, mut order) = (plant(), flight(DURATION_S, RATE_HZ, Integrator::Dop853, 1e-12));
    let change = 1.0 + 0.0005 * k as f64;
    if k > 0 {
        plant.aero.values.iter_mut().for_each(|v| *v *= change);
        plant.vehicle.mass_kg *= change;
        order.release.attitude_rad[1] *= change;
    }
    (plant, order)
}

fn fly_all(orders: &[Order<'_>], seen: bool) {
    if seen {
        for_each_truth(black_box(orders), STEP, |_, flown| drop(black_box(flown)));
    } else {
        for_each_states(black_box(orders), STEP, |_, flown| drop(black_box(flown)));
    }
}

/// Best processor time of a piece, s.
fn best_s(pieces: usize, mut piece: impl FnMut()) -> f64 {
    let once = |_| {
        let start = processor_s();
        piece();
        processor_s() - start
    };
    (0..pieces).map(once).fold(f64::INFINITY, f64::min)
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Time of a piece on `threads` threads that begin together, the last to end counting; best of many, s.
fn together_s(threads: usize, orders: &[Order<'_>], pieces: usize) -> f64 {
    let barrier = Barrier::new(threads);
    let times: Vec<Vec<(Instant, Instant)>> = std::thread::scope(|scope| {
        let work = || {
            let once = |_| {
                barrier.wait();
                let start = Instant::now();
                fly_all(orders, false);
                (start, Instant::now())
            };
            (0..pieces).map(once).collect()
        };
        let handles: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        handles.into_iter().map(|h| h.join().expect("a thread that flies")).collect()
    });
    let piece = |k: usize| {
        let first = times.iter().map(|t| t[k].0).min().expect("a thread");
        let last = times.iter().map(|t| t[k].1).max().expect("a thread");
        (last - first).as_secs_f64()
    };
    (0..pieces).map(piece).fold(f64::INFINITY, f64::min)
}

fn main() {
    let made: Vec<_> = (0..SIDE).map(drawn).collect();
    let orders: Vec<_> = made.iter().map(|(plant, flight)| Order { plant, flight, seed: Seed::default() }).collect();
    let (plant, order) = &made[0];
    let reference = states(&fly_truth(plant, order, Seed::default()).expect("flies").0);
    let error = |m: u32| {
        let mut far = f64::NAN;
        for_each_states(&orders[..1], Stepping::Rk4 { steps_per_sample: m }, |_, flown| {
            far = distance(flown.expect("flies").0, &reference)
        });
        far
    };
    println!("30 s lander flights, 100 Hz, recorded V_W; unit {:?}", pulp::Arch::new());
    println!("ours  error against Dop853 at 1e-12: {:.1e}; half the step {:.1e}, a quarter {:.1e}", error(1), error(2), error(4));
    let peers = [("-O3", &[][..]), ("-O3 -march=native", &["-march=native"][..])].map(|(name, flags)| (name, Peer::new(flags)));
    for (name, peer) in &peers {
        match peer {
            Err(why) => println!("peer  {name} skipped: {why}"),
            Ok(peer) => {
                let run = peer.fly(plant, order, 1, "rk4").expect("the peer flies");
                println!("peer  {name}: error {:.1e}, {} steps", distance(&run.states, &reference), run.steps);
            }
        }
    }
    for (method, seen) in [("rk4", false), ("rk4-seen", true)] {
        println!("{}", if seen { "angles, airspeed and tether force at every sample:" } else { "states at every sample:" });
        let mut ours = Vec::new();
        let mut theirs: Vec<Vec<f64>> = peers.iter().map(|_| Vec::new()).collect();
        for _ in 0..ROUNDS {
            let piece = best_s(PIECES, || {
                fly_all(&orders, seen);
            });
            ours.push(STEPS * SIDE as f64 / piece);
            for ((_, peer), rates) in peers.iter().zip(&mut theirs) {
                if let Ok(peer) = peer {
                    rates.push(STEPS / peer.fly(plant, order, PEER_FLIGHTS, method).expect("the peer flies").best_s);
                }
            }
        }
        for ((name, _), rates) in peers.iter().zip(&mut theirs).filter(|(_, r)| !r.is_empty()) {
            let mut ratios: Vec<f64> = ours.iter().zip(&*rates).map(|(a, b)| a / b).collect();
            let (middle, least, most) = (median(&mut ratios), ratios[0], ratios[ratios.len() - 1]);
            let rate = median(rates);
            println!(
                "  peer {name}: {:.2} M steps/s; ours/peer {middle:.2} (rounds {least:.2} to {most:.2}); goal 3",
                rate * 1e-6
            );
        }
        println!("  ours: {:.2} M steps/s, {:.0} flights/s a core", median(&mut ours) * 1e-6, median(&mut ours) / STEPS);
    }
    let mut ratios: Vec<f64> =
        (0..ROUNDS).map(|_| 2.0 * together_s(1, &orders, PIECES) / together_s(2, &orders, PIECES)).collect();
    let (middle, least, most) = (median(&mut ratios), ratios[0], ratios[ratios.len() - 1]);
    println!("two threads against one: {middle:.2} (rounds {least:.2} to {most:.2}); goal 1.9");
}
