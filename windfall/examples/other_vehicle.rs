//! Another vehicle is another file: a blunt capsule whose damping changes sign, its terms chosen by its runs.
//!
//! `cargo run --release -p windfall --example other_vehicle`
#![expect(clippy::print_stdout, reason = "an example shows what it found")]

use std::path::Path;
use windfall::prelude::*;

fn main() -> windfall::Result<()> {
    // Vehicle, environment and flights; the structure of its aerodynamics is a file beside it.
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/capsule/scenario.toml");
    let campaign = Scenario::read(&path)?.fly(&Fly::default())?.campaign();
    println!("{}: {} runs, {:.3} kg", campaign.data.name, campaign.data.runs.len(), campaign.data.plant.vehicle.mass_kg);

    // What the file declares, estimated.
    let found = campaign.identify(&Identify { combined: true, ..Identify::default() })?;
    for p in found.found.combined().iter().flat_map(|set| &set.parameters) {
        println!("{:<4}{:<12}{:>12.5} ± {:.5}", p.coefficient, p.name, p.estimate, p.std_error);
    }

    // What the runs would declare, whatever the file says.
    let terms = campaign.structure(&Structure { criterion: windfall::Criterion::Bic })?;
    for c in &terms.coefficients {
        let names: Vec<&str> = c.chosen.iter().map(|t| t.name.as_str()).collect();
        println!("{}: {}", c.coefficient, names.join(" + "));
    }
    Ok(())
}
