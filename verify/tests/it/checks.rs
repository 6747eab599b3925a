//! verify tests: the checks of `windfall verify`. In: bundled scenarios. Out: whether all pass.

use windfall_scenarios::read_bundled;
use windfall_verify::{Setups, checks};

#[test]
fn recover_every_check_passes() {
    let read = |name| read_bundled(name).expect("bundled").scenario;
    let (a, f, c) = (read("appendix-c"), read("full-scale-venus-20km"), read("sage-combined"));
    let t = std::time::Instant::now();
    let all = checks(&Setups { appendix_c: &a, full_scale: &f, combined: &c }).expect("checks run");
    eprintln!("{:?}", t.elapsed());
    for c in &all {
        eprintln!("{:?} {} = {:.4e} {} [{}] thesis {:?} | {}", c.verdict, c.id, c.figure, c.unit, c.bound, c.thesis, c.what);
    }
}
