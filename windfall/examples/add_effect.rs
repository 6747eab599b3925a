//! Would my test see it? Put an effect into what is flown, leave it out of what is declared, and look whether it is found.
//!
//! The effect is one of the catalogue (`windfall::model::CATALOGUE`). A new one is a file in `model/src/effects/` and its name in the
//! catalogue: see `docs/architecture.md`.
//!
//! `cargo run --release -p windfall --example add_effect`
#![expect(clippy::print_stdout, reason = "an example shows what it found")]

use windfall::prelude::*;

fn main() -> windfall::Result<()> {
    // Centre of mass two millimetres off along body z; the campaign still declares it where the drawing has it.
    let scenario = Scenario::bundled("sage-perturbed")?.with_effect("center-of-mass", &[("z_m", 0.002)])?;
    let campaign = scenario.fly(&Fly::default())?.campaign();

    let closing = campaign.close(&Close::default())?;
    println!("verdict: {:?}", closing.verdict);
    for e in &closing.effects {
        for p in &e.parameters {
            println!("{} {} = {:.5} {}", e.family, p.name, p.estimate, p.unit);
        }
    }
    Ok(())
}
