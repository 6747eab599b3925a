//! cli: scenarios of rigid bodies in free flight in words. In: such a scenario. Out: its records, truths, the campaign that they make; what `windfall
//! check` says of it.

use crate::args::SimulateArgs;
use crate::session::{Failure, Session};
use windfall::free::{self, FreeFile};

pub(crate) fn simulate(mut file: FreeFile, args: &SimulateArgs, session: &mut Session<'_>) -> Result<bool, Failure> {
    let outputs = free::files(&file);
    let outputs: Vec<&str> = outputs.iter().map(String::as_str).collect();
    let folder = session.outputs(&outputs)?;
    let flown = session.pool()?.install(|| free::fly(&mut file, &args.request))?;
    session.write(folder.as_deref(), |stage| free::write(stage, &file, &flown))?;
    let simulation = free::summary(&file, &flown, folder.is_some());
    for f in &simulation.flights {
        session.say(&format!("{}: {} samples, {} at {:.3} s, {} steps", f.name, f.samples, f.end, f.end_t_s, f.steps));
    }
    session.written(folder.as_deref(), &outputs);
    if session.common.json {
        session.print_json(&simulation)?;
    }
    Ok(true)
}

/// What `windfall check` understood.
pub(crate) fn summary(file: &FreeFile) -> Vec<String> {
    let plant = &file.declared_plant;
    let mut all = vec![format!("vehicle: {} kg, d = {} m", plant.vehicle.mass_kg, plant.vehicle.diameter_m)];
    if let Some(free) = &plant.free_flight {
        all.push(format!(
            "free flight: S = {} m2, displaced air {} kg, {} parts, {} thrusts",
            free.area_m2,
            free.buoyancy_kg,
            free.parts.len(),
            free.thrusts.len()
        ));
    }
    all.extend(file.effects.iter().map(|e| format!("effect in the truth: {}", e.family)));
    all.extend(
        file.flights
            .iter()
            .map(|f| format!("flight {}: {}, {}, {} s at {} Hz", f.name, f.kind, f.used.name(), f.duration_s, f.rate_hz)),
    );
    all
}
