//! sim bench: a 15 s lander flight at 150 Hz, rtol 1e-9, recorded V_W, beside the same model on boost::odeint's dopri5.
//! Alone and side by side on the vector unit. In: nothing (a V_W history like an operator's is made here). Out: times, their ratio, and the achieved error of both.
//!
//! One thread each. What is not alike: boost's dopri5 tests the largest component of the error against `atol + rtol (|y| + h|ẏ|)`,
//! ours its mean square against `atol + rtol |y|`; the peer has the lander's formulas compiled in, ours reads them as data.

#![expect(clippy::print_stdout, reason = "a bench reports on the terminal")]

#[path = "common/lander.rs"]
mod lander;

use criterion::{Criterion, criterion_group, criterion_main};
use lander::{Peer, distance, plant, processor_s, states};
use std::hint::black_box;
use windfall_model::{Flight, Integrator, Plant};
use windfall_sim::{Order, Seed, Stepping, fly, fly_batch, fly_truth, fly_truth_batch};

/// Flights per timing; the best of them counts, which other work on the machine disturbs least.
const REPETITIONS: usize = 400;
/// Best processor time of a flight, µs.
fn best_us(plant: &Plant, flight: &Flight, repetitions: usize) -> f64 {
    (0..repetitions)
        .map(|_| {
            let start = processor_s();
            black_box(fly_truth(black_box(plant), black_box(flight), Seed::default()).expect("flies"));
            (processor_s() - start) * 1e6
        })
        .fold(f64::INFINITY, f64::min)
}

fn flight(method: Integrator, relative_tolerance: f64) -> Flight {
    lander::flight(15.0, 150.0, method, relative_tolerance)
}

fn compare() {
    let plant = plant();
    let reference = states(&fly_truth(&plant, &flight(Integrator::Dop853, 1e-13), Seed::default()).expect("flies").0);
    let orders = [Integrator::Dop853, Integrator::Dopri5].map(|m| flight(m, 1e-9));
    println!("15 s lander flight, 150 Hz, rtol 1e-9, atol 1e-11, recorded V_W; best of {REPETITIONS} flights");
    for order in &orders {
        let flown = fly(&plant, order, Seed::default()).expect("flies");
        let (us, far) = (best_us(&plant, order, REPETITIONS / 4), distance(&states(&flown.truth), &reference));
        println!("ours  {:?}: {us:8.1} us, {:5} steps, largest error {far:.1e}", order.numerics.method, flown.steps);
    }
    let sides: Vec<_> = (0..SIDE).map(|_| Order { plant: &plant, flight: &orders[1], seed: Seed::default() }).collect();
    let side = &fly_batch(&sides[..1], Stepping::Adaptive)[0];
    let side = side.as_ref().expect("flies");
    let far = distance(&states(&side.truth), &reference);
    match Peer::new(&[]) {
        Err(why) => println!("peer  skipped: {why}"),
        Ok(peer) => turns(&plant, &orders, &sides, &peer, &reference),
    }
    println!("ours  Dopri5 side by side: {} steps, largest error {far:.1e}", side.steps);
}

/// Flights of a piece side by side.
const SIDE: usize = 16;
const ROUNDS: usize = 7;

/// All in turn, round by round: medians of the ratios and their range.
fn turns(plant: &Plant, orders: &[Flight; 2], sides: &[Order<'_>], peer: &Peer, reference: &[[f64; 13]]) {
    let mut ratios = [const { Vec::new() }; 3];
    for round in 0..ROUNDS {
        let run = peer.fly(plant, &orders[1], REPETITIONS / ROUNDS, "dopri5").expect("the peer flies");
        let us = run.best_s * 1e6;
        if round == 0 {
            let far = distance(&run.states, reference);
            println!("peer  boost dopri5: {us:8.1} us, {:5} steps, largest error {far:.1e}", run.steps);
        }
        let beside = (0..REPETITIONS / ROUNDS / 4)
            .map(|_| {
                let start = processor_s();
                black_box(fly_truth_batch(black_box(sides), Stepping::Adaptive));
                (processor_s() - start) * 1e6 / SIDE as f64
            })
            .fold(f64::INFINITY, f64::min);
        ratios[0].push(us / best_us(plant, &orders[0], REPETITIONS / ROUNDS));
        ratios[1].push(us / best_us(plant, &orders[1], REPETITIONS / ROUNDS));
        ratios[2].push(us / beside);
    }
    for (name, ratios) in ["Dop853, the default", "Dopri5", "Dopri5 side by side; goal 1.2"].iter().zip(&mut ratios) {
        ratios.sort_by(f64::total_cmp);
        let (middle, last) = (ratios[ROUNDS / 2], ratios[ROUNDS - 1]);
        println!("flights of ours in the time of one of the peer's: {middle:.2} ({:.2} to {last:.2}) ({name})", ratios[0]);
    }
}

fn flights(c: &mut Criterion) {
    compare();
    let plant = plant();
    for method in [Integrator::Dop853, Integrator::Dopri5] {
        let order = flight(method, 1e-9);
        c.bench_function(&format!("fly_truth 15 s, 150 Hz, rtol 1e-9, {method:?}"), |b| {
            b.iter(|| fly_truth(black_box(&plant), black_box(&order), Seed::default()).expect("flies"));
        });
    }
}

criterion_group!(benches, flights);
criterion_main!(benches);
