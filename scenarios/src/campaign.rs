//! scenarios: campaign files. In: a path. Out: a checked campaign with its runs read, or every fault.

use crate::error::ReadError;
use crate::free_flight;
use crate::in_memory::named_pieces;
use crate::keys;
use crate::limits;
use crate::open::text_of;
use crate::own::{self, Own};
use crate::plant::{Declared, read_declared};
use crate::point::{Asked, Down, read_own_track};
use crate::point_body::{self, InputSource, RunOwn};
use crate::scenario::{declared_effects, not_overdrawn, run_exists, used};
use crate::table::{Source, Table, number};
use crate::wind_tunnel;
use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};
use windfall_model::{Acts, Campaign, Data, Effect, Knowledge, Measured, Role, Run, Use, effects};

/// What `[[run]]` says, before its file is read.
pub(crate) struct RunEntry {
    file: String,
    pub(crate) path: PathBuf,
    kind: String,
    used: Use,
    window_s: Option<[f64; 2]>,
    pub(crate) inputs: BTreeMap<String, InputSource>,
    own: RunOwn,
    pub(crate) columns: Own,
    span: std::ops::Range<usize>,
}

/// Reads a campaign file and all its runs. What reading the runs bridged, removed or split is in their notes.
///
/// # Errors
/// [`ReadError`] with every fault of the campaign file and its run files.
pub fn read_campaign(path: &Path) -> Result<Campaign, ReadError> {
    read_campaign_with_warnings(path).map(|(campaign, _)| campaign)
}

/// The same with warnings that concern the campaign as a whole or that a reader should see: cause and next step in words.
///
/// # Errors
/// [`ReadError`] with every fault of the campaign file and its run files.
pub fn read_campaign_with_warnings(path: &Path) -> Result<(Campaign, Vec<String>), ReadError> {
    let text = text_of(path)?;
    let source = Source::new(path, &text);
    let root = source.parse()?;
    crate::planet::refuse(&source, &text)?;
    let file = Table::new(&source, "", &root, 0..0, &keys::CAMPAIGN_FILE);
    let name = file.table(&keys::CAMPAIGN).map(|t| {
        t.text_if("note");
        t.text("name")
    });
    let mut declared = read_declared(&file, false);
    let down = down_of(&file, declared.as_ref());
    let entries = entries(&file, declared.as_ref());
    let inputs = inputs_of(&source, &entries);
    if let Some(d) = declared.as_mut() {
        free_flight::parts_and_thrusts(&file, &inputs, &mut d.plant);
    }
    let acts = declared.as_ref().map_or(Acts::Lander, Declared::body);
    let effects = declared_effects(&file, acts, &inputs);
    // Run files are read against the sensors and the plant, so the tables must be right first.
    let Some(declared) = declared.filter(|_| !source.has_faults()) else {
        check_files_exist(&source, &entries);
        return source.finish(None);
    };
    let mut warnings = undeclared_warnings(&source, &file, &declared);
    warnings.extend(inertia_warning(&source, &declared));
    let mut runs = Vec::new();
    for e in &entries {
        match read_run(e, &declared, down, &inputs) {
            Ok(read) => {
                runs.extend(read);
            }
            Err(ReadError::Faults(faults)) => source.add(&faults),
            Err(error) => {
                source.fault(Some(e.span.clone()), "[[run]] file", &e.file, error.to_string(), "a path beside the campaign file")
            }
        }
    }
    warnings.extend(notes_of(&runs));
    enough_samples(&source, &declared, &runs);
    let wind_tunnel = wind_tunnel::tests(&file, &declared);
    effects_in_runs(&source, &effects, &inputs, runs.len());
    let mut campaign = Campaign {
        name: name.unwrap_or_default(),
        declared: declared.free_parameters(),
        plant: declared.plant,
        inputs,
        runs,
        knowledge: Knowledge { effects, wind_tunnel, ..declared.knowledge },
    };
    if let Some([_, density_kg_m3]) = campaign.tunnel_means() {
        let declared = campaign.knowledge.effects.iter_mut().map(|(effect, values)| (*effect, values.as_mut_slice()));
        effects::act(&mut campaign.plant.clone(), declared, density_kg_m3);
    }
    let mut with_effects = campaign.plant.clone();
    campaign.knowledge.effects.iter().for_each(|(e, values)| (e.apply)(&mut with_effects, values));
    for (e, _) in &campaign.knowledge.effects {
        let in_run = |(i, run): (usize, &Run)| with_effects.for_run(i, &run.inputs);
        let mut plants = campaign.runs.iter().enumerate().map(in_run);
        if let Some(plant) = plants.find(|plant| e.overdrawn(&campaign.inputs, plant).is_some()) {
            not_overdrawn(&source, e, &campaign.inputs, &plant);
        }
    }
    source.finish(Some((campaign, warnings)))
}

impl Declared {
    /// Whether its runs are tracks.
    pub(crate) fn tracked(&self) -> bool {
        self.point_mass || self.plant.free_flight.is_some()
    }
    /// Kind of the body, for the catalogue of effects.
    fn body(&self) -> Acts {
        match (self.point_mass, &self.plant.free_flight) {
            (true, _) => self.plant.point.body(),
            (false, Some(_)) => Acts::FreeFlight,
            (false, None) => Acts::Lander,
        }
    }
    /// Which parameters of the structure a fit moves: all that are declared, or those with a prior where the others are held.
    fn free_parameters(&self) -> Vec<bool> {
        let known = |i: usize| self.knowledge.priors.iter().any(|(k, _)| *k == i);
        self.declared.iter().enumerate().map(|(i, d)| *d && (!self.held || known(i))).collect()
    }
}

pub(crate) fn down_of(file: &Table<'_>, declared: Option<&Declared>) -> Option<Down> {
    let point_mass = declared.is_some_and(|d| d.point_mass);
    if !point_mass {
        if file.has("axes")
            && declared.is_some()
            && let Some(t) = file.table(&keys::AXES)
        {
            let what = "a run with attitude has tunnel axes (X down)";
            t.source.fault(Some(t.span.clone()), "[axes]", "", what, "[columns.axes]; this table is for [aero.point_mass]");
        }
        return None;
    }
    let pivoted = declared.is_some_and(|d| d.plant.point.pivot.is_some());
    if pivoted {
        if let Some(t) = file.table_if(&keys::AXES) {
            let what = "an angle about a pivot has no axes";
            t.source.fault(Some(t.span.clone()), "[axes]", "", what, "remove the table");
        }
        return None;
    }
    if !file.has("axes") {
        let what = "is missing: which axis of the files points down";
        file.source.fault(None, "[axes] down", "", what, "[axes]\ndown = \"-Z\"");
        return None;
    }
    file.table(&keys::AXES)?.choice("down").map(Down::from_choice)
}

pub(crate) fn entries(file: &Table<'_>, declared: Option<&Declared>) -> Vec<RunEntry> {
    let point = declared.is_some_and(|d| d.point_mass);
    let tracked = declared.is_some_and(Declared::tracked);
    let all_runs = own::read(file, point).unwrap_or_default();
    let all: Vec<RunEntry> = file
        .tables(&keys::RUN)
        .iter()
        .map(|t| {
            let name = t.text("file");
            RunEntry {
                path: limits::beside(file.source, t.at("file"), "[[run]] file", &name),
                file: name,
                kind: t.text("kind"),
                used: used(t),
                window_s: window_of(t),
                inputs: input_values(t, point),
                own: point_body::run_own(t, tracked),
                columns: own::read(t, point).unwrap_or_else(|| all_runs.clone()),
                span: t.span.clone(),
            }
        })
        .collect();
    limits::of_file(file.source, "run", all.len(), 0.0);
    let mut windows: HashMap<Option<String>, Vec<Option<[f64; 2]>>> = HashMap::new();
    for e in &all {
        let before = windows.entry(crate::formats::stem(&e.path)).or_default();
        if before.contains(&e.window_s) && !e.file.is_empty() {
            let what = "appears twice (or another file of the same name)";
            file.source.fault(
                Some(e.span.clone()),
                "[[run]] file",
                &e.file,
                what,
                "name each run once, or give different windows",
            );
        } else {
            before.push(e.window_s);
        }
    }
    all
}

fn window_of(t: &Table<'_>) -> Option<[f64; 2]> {
    if !t.has("window_s") {
        return None;
    }
    let window = t.numbers::<2>("window_s");
    if window[0] >= window[1] {
        let what = "must run from an earlier to a later time";
        t.source.fault(t.at("window_s"), t.full("window_s"), format!("{window:?}"), what, "[from, to] in s");
    }
    Some(window)
}

fn input_values(t: &Table<'_>, point: bool) -> BTreeMap<String, InputSource> {
    let mut all = BTreeMap::new();
    let Some(at) = t.has("inputs").then(|| t.value("inputs")).flatten() else { return all };
    let Some(table) = at.get_ref().as_table() else {
        t.source.fault(Some(at.span()), t.full("inputs"), t.source.snippet(at.span()), "must be a table", "{ name = number }");
        return all;
    };
    for (key, value) in table {
        if let Some(read) = point_body::input(t, key.get_ref(), value, point) {
            all.insert(key.get_ref().to_string(), read);
        }
    }
    all
}

/// Names of inputs, sorted; a run that lacks one that others have is a fault.
pub(crate) fn inputs_of(source: &Source<'_>, entries: &[RunEntry]) -> Vec<String> {
    let mut names: Vec<String> = entries.iter().flat_map(|e| e.inputs.keys().cloned()).collect();
    names.sort();
    names.dedup();
    if names.len() > limits::INPUTS {
        let what = format!("at most {} are read from one file", limits::INPUTS);
        source.fault(None, "[[run]] inputs", names.len().to_string(), what, "the same inputs for every run");
        return names;
    }
    for e in entries {
        let missing: Vec<&str> = names.iter().filter(|n| !e.inputs.contains_key(*n)).map(String::as_str).collect();
        if !missing.is_empty() {
            let what = "lacks inputs that other runs have";
            source.fault(
                Some(e.span.clone()),
                format!("[[run]] {} inputs", e.file),
                missing.join(", "),
                what,
                "give every run all inputs",
            );
        }
    }
    names
}

fn check_files_exist(source: &Source<'_>, entries: &[RunEntry]) {
    for e in entries.iter().filter(|e| !e.file.is_empty() && !e.path.is_file()) {
        source.fault(Some(e.span.clone()), "[[run]] file", &e.file, "there is no such file", "a path beside the campaign file");
    }
}

fn read_run(e: &RunEntry, declared: &Declared, down: Option<Down>, inputs: &[String]) -> Result<Vec<Run>, ReadError> {
    let stem = crate::formats::stem(&e.path).unwrap_or_else(|| e.file.clone());
    let constant = |n: &String| match e.inputs.get(n)? {
        InputSource::Constant(x) => Some(*x),
        InputSource::Column { .. } => Some(0.0),
    };
    let mut values: Vec<f64> = inputs.iter().filter_map(constant).collect();
    let run = |values: &[f64], name: String, data, notes| Run {
        name,
        kind: e.kind.clone(),
        used: e.used,
        inputs: values.to_vec(),
        data,
        notes,
    };
    if declared.tracked() {
        let (mut track, notes) = read_own_track(&e.path, &e.columns, &asked(e, declared, down, inputs))?;
        track.own_departures = e.own.departures(&declared.plant);
        track.drag_over_mach.clone_from(&e.own.drag);
        track.recording.clone_from(&e.own.recording);
        // What is constant of a recorded input is its mean, for whoever does not follow it row by row.
        for (place, series) in &track.recorded_inputs {
            values[*place] = series.iter().sum::<f64>() / series.len().max(1) as f64;
        }
        return Ok(vec![run(&values, stem, Data::Point(track), notes)]);
    }
    let columns = crate::formats::read_columns(&e.path)?;
    let pieces = named_pieces(&e.path, &stem, columns, &e.columns, &declared.plant, e.window_s)?;
    Ok(pieces.into_iter().map(|(name, p)| run(&values, name, Data::Tunnel(p.record), p.notes)).collect())
}

/// Notes of all runs, each once with the names of the runs that have it.
fn notes_of(runs: &[Run]) -> Vec<String> {
    let mut all: Vec<(Vec<&str>, &String)> = Vec::new();
    let mut place_of: HashMap<&String, usize> = HashMap::new();
    for run in runs {
        for note in &run.notes {
            let place = *place_of.entry(note).or_insert(all.len());
            match all.get_mut(place) {
                Some((names, _)) => names.push(&run.name),
                None => all.push((vec![&run.name], note)),
            }
        }
    }
    all.into_iter().map(|(names, note)| format!("{}: {note}", names.join(", "))).collect()
}

/// What a run's file is read for.
pub(crate) fn asked<'a>(e: &'a RunEntry, declared: &Declared, down: Option<Down>, inputs: &[String]) -> Asked<'a> {
    let sensors = &declared.plant.sensors;
    let column = |(i, n): (usize, &String)| match e.inputs.get(n)? {
        InputSource::Column { name, zero, one } => Some((i, name.as_str(), [*zero, *one])),
        InputSource::Constant(_) => None,
    };
    Asked {
        measured: declared.measured,
        down: down.unwrap_or(Down { axis: 0, negative: false }),
        std: match declared.measured {
            Measured::Position | Measured::Pose | Measured::PositionAndForce => sensors.position_std_m,
            Measured::SpecificForce => sensors.specific_force_std_m_s2,
            Measured::Angle => sensors.angle_std_rad,
        },
        force_std: sensors.specific_force_std_m_s2,
        window_s: e.window_s,
        inputs: inputs.iter().enumerate().filter_map(column).collect(),
    }
}

fn undeclared_warnings(source: &Source<'_>, file: &Table<'_>, declared: &Declared) -> Vec<String> {
    let structure = &declared.plant.aero.structure;
    let Some(model) = file
        .entries()
        .find(|(k, _)| k.get_ref() == "aero")
        .and_then(|(_, v)| v.get_ref().as_table()?.values().next()?.get_ref().as_table())
    else {
        return Vec::new();
    };
    let nonzero = |i: usize| model.get(structure.parameters[i].as_str()).and_then(number).is_some_and(|x| x != 0.0);
    (0..structure.parameters.len())
        .filter(|i| !declared.declared[*i] && nonzero(*i))
        .map(|i| {
            let name = &structure.parameters[i];
            format!(
                "{}: {name} has a value but is not in `declared`; it is taken as zero (declare it to use it)",
                source.path().display()
            )
        })
        .collect()
}

/// An inertia that no rigid body has, where it may be that of the air as well.
fn inertia_warning(source: &Source<'_>, declared: &Declared) -> Option<String> {
    let odd = declared.plant.free_flight.is_some() && !declared.plant.vehicle.inertia.is_physical();
    odd.then(|| {
        format!(
            "{}: [vehicle] inertia_kg_m2 is no rigid body's: one principal moment is larger than the sum of the others; it is taken \
             as declared (is the air's apparent inertia in it?)",
            source.path().display()
        )
    })
}

/// A declared effect in one run must name one of the runs, split ones counted piece by piece.
fn effects_in_runs(source: &Source<'_>, effects: &[(&'static Effect, Vec<f64>)], inputs: &[String], runs: usize) {
    for (effect, values) in effects {
        for (p, value) in (effect.parameters)(inputs).iter().zip(values).filter(|(p, _)| p.role == Role::Run) {
            run_exists(source, effect.family, p, *value, runs, "run");
        }
    }
}

/// Fewer samples to identify on than parameters cannot be identified.
fn enough_samples(source: &Source<'_>, declared: &Declared, runs: &[Run]) {
    let parameters = declared.declared.iter().filter(|d| **d).count();
    let samples: usize = runs
        .iter()
        .filter(|r| r.used == Use::Identify)
        .map(|r| match &r.data {
            Data::Tunnel(record) => record.len(),
            Data::Point(track) => track.t_s.len(),
        })
        .sum();
    if !source.has_faults() && samples <= parameters {
        let what = format!("{samples} samples to identify {parameters} parameters on");
        source.fault(None, "[[run]]", "", what, "at least one longer run with use = \"identify\"");
    }
}
