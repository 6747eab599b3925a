//! pid bench: 67 s of data (three runs, 10,053 samples) from records to the table of parameters, one thread. Bound: 50 ms.
#[path = "../tests/common/mod.rs"]
mod common;

use criterion::{Criterion, criterion_group, criterion_main};
use std::hint::black_box;
use windfall_pid::{Method, identify};

/// Measures both methods on `open-00`; says so when the shared data are not there.
fn bench(c: &mut Criterion) {
    let Some(campaign) = common::campaign("bench identify", "open-00") else { return };
    for method in [Method::EquationError, Method::Thesis] {
        c.bench_function(&format!("identify 67 s, {}", method.name()), |b| {
            b.iter(|| identify(black_box(&campaign), method).expect("a good campaign"));
        });
    }
}

criterion_group!(benches, bench);
criterion_main!(benches);
