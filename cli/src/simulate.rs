//! cli: `windfall simulate`. In: a scenario. Out: records, truths, the campaign they make and the resolved scenario.

use crate::args::SimulateArgs;
use crate::session::{Failure, Session};
use windfall::Scenario;

pub(crate) fn run(args: &SimulateArgs, session: &mut Session<'_>) -> Result<bool, Failure> {
    if let Some(file) = windfall::planet::find(&args.scenario)? {
        return crate::planet::simulate(&file, &args.request, session);
    }
    if let Some(file) = windfall::free::find(&args.scenario)? {
        return crate::free::simulate(file, args, session);
    }
    let scenario = Scenario::find(&args.scenario)?;
    let outputs = scenario.files();
    let outputs: Vec<&str> = outputs.iter().map(String::as_str).collect();
    let folder = session.outputs(&outputs)?;
    let flights = session.fly(&scenario, &args.request)?;
    session.write(folder.as_deref(), |stage| flights.write(stage))?;
    let simulation = flights.summary(folder.is_some());
    for f in &simulation.flights {
        session.say(&format!("{}: {} samples, {} at {:.3} s, {} steps", f.name, f.samples, f.end, f.end_t_s, f.steps));
        session.warn_all(f.warning.as_slice());
    }
    session.written(folder.as_deref(), &outputs);
    if session.common.json {
        session.print_json(&simulation)?;
    }
    Ok(true)
}
