//! Fly five noisy runs, identify them with something known beforehand, and fly what was found against each.
//!
//! `cargo run --release -p windfall --example simulate_identify`
#![expect(clippy::print_stdout, reason = "an example shows what it found")]

use windfall::prelude::*;

fn main() -> windfall::Result<()> {
    // The seed makes the chance: another one is another campaign of the same lander.
    let flights = Scenario::bundled("sage-combined")?.fly(&Fly { seed: Some(7) })?;
    let campaign = flights.campaign();

    // Roll damping was measured elsewhere; without a method the data say which is right.
    let request = Identify { prior: vec![windfall::prior("Cl_p = -5.7 ± 0.3")?], combined: true, ..Identify::default() };
    let found = campaign.identify(&request)?;
    println!("{}: {}", found.found.method, found.found.reason.as_deref().unwrap_or("as asked for"));
    for p in found.found.combined().iter().flat_map(|set| &set.parameters) {
        println!("{:<4}{:<10}{:>12.5}   [{:.5}, {:.5}]", p.coefficient, p.name, p.estimate, p.ci95[0], p.ci95[1]);
    }

    let again = campaign.resimulate(&found, &Resimulate { seeds: 4, ..Resimulate::default() })?;
    println!("flown again: {:.3} deg rms of attitude", again.trajectory.attitude_rms_deg);
    Ok(())
}
