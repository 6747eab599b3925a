//! sim bench: a 15 s lander flight at 150 Hz, rtol 1e-9, recorded V_W, beside the same model on boost::odeint's dopri5.
//! In: nothing (a V_W history like an operator's is made here). Out: times, their ratio, and the achieved error of both.
//!
//! One thread each. What is not alike: boost's dopri5 tests the largest component of the error against `atol + rtol (|y| + h|ẏ|)`,
//! ours its mean square against `atol + rtol |y|`; the peer has the lander's formulas compiled in, ours reads them as data.

#![expect(clippy::print_stdout, reason = "a bench reports on the terminal")]

#[path = "common/lander.rs"]
mod lander;

use criterion::{Criterion, criterion_group, criterion_main};
use lander::{Peer, distance, plant, processor_s, states};
use std::hint::black_box;
use windfall_model::{Flight, Method, Plant};
use windfall_sim::{Seed, fly, fly_truth};

/// Flights per timing; the best of them counts, which other work on the machine disturbs least.
const REPETITIONS: usize = 400;
/// Best processor time of a flight, µs.
fn best_us(plant: &Plant, flight: &Flight) -> f64 {
    (0..REPETITIONS)
        .map(|_| {
            let start = processor_s();
            black_box(fly_truth(black_box(plant), black_box(flight), Seed::default()).expect("flies"));
            (processor_s() - start) * 1e6
        })
        .fold(f64::INFINITY, f64::min)
}

fn flight(method: Method, relative_tolerance: f64) -> Flight {
    lander::flight(15.0, 150.0, method, relative_tolerance)
}

fn compare() {
    let plant = plant();
    let reference = states(&fly_truth(&plant, &flight(Method::Dop853, 1e-13), Seed::default()).expect("flies").0);
    let orders = [Method::Dop853, Method::Dopri5].map(|m| flight(m, 1e-9));
    println!("15 s lander flight, 150 Hz, rtol 1e-9, atol 1e-11, recorded V_W; best of {REPETITIONS} flights");
    let times = orders.each_ref().map(|order| {
        let flown = fly(&plant, order, Seed::default()).expect("flies");
        let (us, far) = (best_us(&plant, order), distance(&states(&flown.truth), &reference));
        println!("ours  {:?}: {us:8.1} us, {:5} steps, largest error {far:.1e}", order.numerics.method, flown.steps);
        us
    });
    match Peer::new(&[]).and_then(|peer| peer.fly(&plant, &orders[1], REPETITIONS, "dopri5")) {
        Ok(run) => {
            let us = run.best_s * 1e6;
            let far = distance(&run.states, &reference);
            println!("peer  boost dopri5: {us:8.1} us, {:5} steps, largest error {far:.1e}", run.steps);
            println!("ratio ours/peer: {:.2} (Dop853, the default), {:.2} (Dopri5); target 1.0", times[0] / us, times[1] / us);
        }
        Err(why) => println!("peer  skipped: {why}"),
    }
}

fn flights(c: &mut Criterion) {
    compare();
    let plant = plant();
    for method in [Method::Dop853, Method::Dopri5] {
        let order = flight(method, 1e-9);
        c.bench_function(&format!("fly_truth 15 s, 150 Hz, rtol 1e-9, {method:?}"), |b| {
            b.iter(|| fly_truth(black_box(&plant), black_box(&order), Seed::default()).expect("flies"));
        });
    }
}

criterion_group!(benches, flights);
criterion_main!(benches);
