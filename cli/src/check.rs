//! cli: `windfall check`. In: any file of the program. Out: what was understood, or every fault.

use crate::args::CheckArgs;
use crate::session::{Failure, Session};
use serde::Serialize;
use std::fmt::Write as _;
use windfall::files::{Piece, key_reference};
use windfall::model::{Aero, Constant, Data, Effect, Knowledge, Plant, Structure, TunnelSpeed};
use windfall::results::{FALSE_ALARM_RATE, TestTable};
use windfall::{Campaign, Checked, Drawing, Scenario};

/// What is printed with `--json`.
#[derive(Serialize)]
struct Understood {
    kind: &'static str,
    name: String,
    summary: Vec<String>,
    /// What the runs of a tunnel campaign reached (thesis Table 5.1).
    #[serde(skip_serializing_if = "Option::is_none")]
    test_table: Option<TestTable>,
    warnings: Vec<String>,
}

pub(crate) fn run(args: &CheckArgs, session: &mut Session<'_>) -> Result<bool, Failure> {
    let Some(file) = &args.file else {
        session.print(&key_reference())?;
        return Ok(true);
    };
    let checked = windfall::check(file)?;
    let (name, summary) = match &checked {
        Checked::Run(pieces) => (file.display().to_string(), run_lines(pieces)),
        Checked::Campaign(c) => (c.data.name.clone(), campaign_lines(c)),
        Checked::Structure(s) => (s.name.clone(), structure_lines(s)),
        Checked::Study(drawing) => (drawing.prepared().study().name.clone(), study_lines(drawing)),
        Checked::Scenario(s) => (s.file.scenario.name.clone(), scenario_lines(s)),
        Checked::FreeFlight(file) => (file.name.clone(), crate::free::summary(file)),
        Checked::Planet(file) => (file.scenario.name.clone(), crate::planet::summary(&file.scenario)),
    };
    let (table, reached) = windfall::reached(&checked)?;
    let summary = [summary, reached, windfall::looked_at(file, &checked)?].concat();
    // The columns are in the summary.
    let said = |w: &String| ["columns not used: ", "columns that hold no plain numbers: "].iter().any(|s| w.contains(s));
    let warnings = checked.warnings().into_iter().filter(|w| !said(w)).collect();
    let understood = Understood { kind: checked.kind(), name, summary, test_table: table, warnings };
    session.warn_all(&understood.warnings);
    session.show(&understood, || {
        let mut text = format!("{} {}\n", understood.kind, understood.name);
        understood.summary.iter().for_each(|l| {
            let _ = writeln!(text, "  {l}");
        });
        text
    })?;
    Ok(true)
}

fn plant_lines(plant: &Plant, declared: &[bool]) -> Vec<String> {
    let v = &plant.vehicle;
    let area_m2 = plant.free_flight.as_ref().map_or_else(|| v.area_m2(), |free| free.area_m2);
    let mut all = vec![format!("vehicle: {} kg, d = {} m, S = {area_m2:.6} m2", v.mass_kg, v.diameter_m)];
    all.push(match &plant.tether {
        Some(t) => format!("tether: drag area {} m2, effective weight {} N", t.drag_area_m2, t.weight_n),
        None => "no tether: free flight".to_owned(),
    });
    all.push(aero_line(&plant.aero, declared));
    all
}

fn aero_line(aero: &Aero, declared: &[bool]) -> String {
    let parameters = aero.structure.parameters.iter().zip(&aero.values).zip(declared);
    let list: Vec<String> = parameters.filter(|(_, d)| **d).map(|((n, v), _)| format!("{n} = {v}")).collect();
    format!("aero {}: {}", aero.structure.name, if list.is_empty() { "nothing declared".to_owned() } else { list.join(", ") })
}

/// Uncertainties, each beside its value, declared effects, noise.
fn knowledge_lines(known: &Knowledge, plant: &Plant, inputs: &[String]) -> Vec<String> {
    let constant = |c: &Constant| {
        let value = c.value(plant).map_or_else(String::new, |v| format!(" {v}"));
        format!("uncertain {}:{value} ± {} {}", c.name(), c.std, c.unit)
    };
    let prior =
        |(i, std): &(usize, f64)| format!("prior {}: {} ± {std}", plant.aero.structure.parameters[*i], plant.aero.values[*i]);
    let effect = |(e, values): &(&'static Effect, Vec<f64>)| {
        let parameters = (e.parameters)(inputs);
        let list: Vec<String> = parameters.iter().zip(values).map(|(p, v)| format!("{} = {v}", p.name)).collect();
        format!("declared effect {}, from {}", e.family, list.join(", "))
    };
    let mut all: Vec<String> = known.constants.iter().map(constant).collect();
    all.extend(known.priors.iter().map(prior));
    all.extend(known.effects.iter().map(effect));
    if known.exact_noise {
        all.push("noise: exactly as declared".to_owned());
    }
    all
}

fn campaign_lines(campaign: &Campaign) -> Vec<String> {
    let c = &campaign.data;
    let mut summary = plant_lines(&c.plant, &c.declared);
    summary.extend(knowledge_lines(&c.knowledge, &c.plant, &c.inputs));
    for run in &c.runs {
        let (samples, seconds) = match &run.data {
            Data::Tunnel(r) => (r.len(), r.duration_s()),
            Data::Point(p) => (p.t_s.len(), p.t_s.last().zip(p.t_s.first()).map_or(0.0, |(b, a)| b - a)),
        };
        summary.push(format!("run {}: {}, {}, {samples} samples, {seconds:.3} s", run.name, run.kind, run.used.name()));
    }
    summary.extend(c.knowledge.wind_tunnel.iter().map(|s| {
        let end = s.points.last().map_or(0.0, |p| p.alpha_t_rad.to_degrees());
        format!("wind tunnel {}: {} points of {} up to {end:.1} deg", s.test, s.points.len(), s.coefficient.name())
    }));
    if let Some(p) = campaign.pressure() {
        summary.push(windfall::report::pressure_agreement(&p, FALSE_ALARM_RATE));
    }
    summary
}

fn scenario_lines(scenario: &Scenario) -> Vec<String> {
    let s = &scenario.file;
    let mut summary = plant_lines(&s.declared_plant, &s.declared);
    summary.extend(knowledge_lines(&s.knowledge, &s.declared_plant, &[]));
    for e in &s.effects {
        let values: Vec<String> = e.values.iter().map(|(n, v)| format!("{n} = {v}")).collect();
        summary.push(format!("effect {}: {}", e.family, values.join(", ")));
    }
    for f in &s.scenario.flights {
        let speed = match &f.speed {
            TunnelSpeed::Operator(_) => "operator".to_owned(),
            TunnelSpeed::History { vw_m_s, .. } => format!("history of {} speeds", vw_m_s.len()),
            TunnelSpeed::Constant(v) => format!("constant {v} m/s"),
        };
        let noise = if f.sensor_noise { "with" } else { "without" };
        summary.push(format!(
            "flight {}: {}, {} s at {} Hz, {speed}, {noise} sensor noise",
            f.name, f.kind, f.duration_s, f.rate_hz
        ));
    }
    summary.push(format!("seed {}", s.scenario.seed));
    summary
}

fn study_lines(drawing: &Drawing) -> Vec<String> {
    let s = drawing.prepared().study();
    let mut summary =
        vec![format!("{} draws of {} flights, seed {}, {} draws a part", s.draws, s.flights.len(), s.seed, s.part_draws)];
    summary.extend(s.vary.iter().map(|v| format!("varies {}: {:?}", v.name, v.distribution)));
    summary.extend(s.histories.iter().map(|h| format!("tunnel speed: one of {} histories", h.speeds.len())));
    summary.extend(s.effects.iter().map(|e| format!("effect {}", e.effect.family)));
    summary.push(format!("steps: simulate{}", s.steps.identify.iter().map(|m| format!(", identify {m}")).collect::<String>()));
    summary.push(format!(
        "columns: {}",
        drawing.prepared().columns().iter().map(|c| c.name.as_str()).collect::<Vec<_>>().join(", ")
    ));
    summary
}

fn structure_lines(s: &Structure) -> Vec<String> {
    s.contributions.iter().map(|k| format!("{}: {} x {:?}", k.coefficient.name(), s.parameters[k.parameter], k.term)).collect()
}

fn run_lines(pieces: &[Piece]) -> Vec<String> {
    pieces
        .iter()
        .map(|p| {
            format!(
                "{} samples from {} s, {:.3} s long, every {:.6} s",
                p.record.len(),
                p.record.t_s[0],
                p.record.duration_s(),
                p.record.interval_s()
            )
        })
        .collect()
}
