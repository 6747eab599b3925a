//! scenarios: study files. In: a path. Out: a checked study with what it draws from, or every fault.

use crate::error::ReadError;
use crate::hash::fnv1a;
use crate::keys;
use crate::limits;
use crate::open::text_of;
use crate::record::read_record_pieces;
use crate::scenario::{EffectValues, ScenarioFile, read_effects, runs_exist};
use crate::table::{Source, Table, allowed_range, nearest};
use std::ops::Range;
use std::path::{Path, PathBuf};
use windfall_model::study::{
    Distribution, DrawnSetup, FLIGHT_QUANTITIES, Histories, Keep, Quantity, Root, Steps, StopRule, StudyEffect, StudyOrder, Vary,
};
use windfall_model::{Acts, Campaign, Data, Flight, Given, Numerics, PLANT_NUMBERS, Release, Role, TunnelSpeed, effects};

/// Draws in a part when the file does not say.
const PART_DRAWS: u64 = 256;
/// Fewest draws before the stopping rule when the file does not say.
const LEAST_DRAWS: u64 = 100;
/// Most things that vary: each has a stream of its own.
const MOST_VARIED: usize = 120;

/// A study with what was read beside it.
#[derive(Clone, Debug)]
pub struct StudyFile {
    /// The order. Drawn from a campaign, its flights are stand-ins until the loop estimates them from the runs.
    pub study: StudyOrder,
    /// The measured campaign that is drawn from.
    pub campaign: Option<Campaign>,
    /// Identification whose parameters are flown.
    pub model: Option<PathBuf>,
    /// Every input that decides on a draw and the FNV-1a hash of what it says.
    pub inputs: Vec<(String, String)>,
    /// What reading the runs bridged, removed or split.
    pub warnings: Vec<String>,
}

/// What draws start from.
struct Base {
    scenario: Option<ScenarioFile>,
    campaign: Option<Campaign>,
    inputs: Vec<(String, String)>,
    warnings: Vec<String>,
}

impl Base {
    fn flights(&self) -> Vec<Flight> {
        match (&self.scenario, &self.campaign) {
            (Some(s), _) => s.scenario.flights.clone(),
            (_, Some(c)) => c.runs.iter().map(stand_in).collect(),
            _ => Vec::new(),
        }
    }
}

/// A flight in place of a measured run, for the checks of this room.
fn stand_in(run: &windfall_model::Run) -> Flight {
    let speed = match &run.data {
        Data::Tunnel(r) => TunnelSpeed::History { interval_s: r.interval_s(), vw_m_s: r.vw_m_s.clone() },
        Data::Point(_) => TunnelSpeed::Constant(0.0),
    };
    Flight {
        name: run.name.clone(),
        kind: run.kind.clone(),
        used: run.used,
        duration_s: 1.0,
        rate_hz: 1.0,
        release: Release { position_m: [0.0; 3], velocity_m_s: [0.0; 3], attitude_rad: [0.0; 3], rates_rad_s: [0.0; 3] },
        speed,
        ps_pa: 0.0,
        ts_k: 0.0,
        section: None,
        numerics: Numerics::default(),
        sensor_noise: true,
        pushes: Vec::new(),
        window_s: None,
    }
}

/// Reads a study file and what it draws from.
///
/// # Errors
/// [`ReadError`] with every fault.
pub fn read_study(path: &Path) -> Result<StudyFile, ReadError> {
    let text = text_of(path)?;
    let source = Source::new(path, &text);
    let root = source.parse()?;
    let file = Table::new(&source, "", &root, 0..0, &keys::STUDY_FILE);
    let Some(head) = file.table(&keys::STUDY) else { return source.finish(None) };
    let name = head.text("name");
    head.text_if("note");
    let counts = [count(&head, "draws"), head.integer_if("seed"), count(&head, "part_draws")];
    if counts[1].is_none() {
        head.value("seed");
    }
    if !source.has_faults() {
        limits::parts(&head, counts[0].unwrap_or(1), counts[2].unwrap_or(PART_DRAWS));
    }
    let base = base(&head);
    let model = model(&head);
    let Some(base) = base else { return source.finish(None) };
    let mut inputs = vec![(path.display().to_string(), hash(text.as_bytes()))];
    inputs.extend(base.inputs.iter().cloned());
    if let Some(m) = &model {
        inputs.push((m.display().to_string(), hash(text_of(m)?.as_bytes())));
    }
    let flights = base.flights();
    let all_effects = merged(base.scenario.as_ref().map_or(&[][..], |s| &s.effects), read_effects(&file));
    runs_exist(&source, &all_effects, flights.len());
    let Some(mut study) = bare(&base, &all_effects, flights) else { return source.finish(None) };
    (study.name, study.draws, study.seed) = (name, counts[0].unwrap_or(1), counts[1].unwrap_or(0));
    study.part_draws = counts[2].unwrap_or(PART_DRAWS);
    study.steps = steps(&file);
    study.keep = keep(&file);
    study.vary = vary(&file, &study, &all_effects);
    study.correlation_root = correlation(&file, &study.vary);
    study.histories = histories(&file, &study, &mut inputs);
    study.stop = stop(&file);
    let Base { campaign, warnings, .. } = base;
    source.finish(Some(StudyFile { study, campaign, model, inputs, warnings }))
}

fn hash(bytes: &[u8]) -> String {
    format!("{:016x}", fnv1a(bytes))
}

/// A whole number of the key's range.
fn count(t: &Table<'_>, name: &str) -> Option<u64> {
    let found = t.integer_if(name);
    if found.is_none() {
        t.value(name);
    }
    found
}

/// The file that a word stands for; none when it climbs out of the study's folder.
fn beside(t: &Table<'_>, at: Option<Range<usize>>, key: &str, word: &str) -> Option<PathBuf> {
    let path = limits::beside(t.source, at, &t.full(key), word);
    (!limits::climbs(word)).then_some(path)
}

fn base(head: &Table<'_>) -> Option<Base> {
    match (head.text_if("scenario"), head.text_if("campaign")) {
        (Some(s), None) => from_scenario(head, &s),
        (None, Some(c)) => from_campaign(head, &c),
        _ => {
            let what = "must hold exactly one of scenario, campaign";
            head.source.fault(Some(head.span.clone()), "[study]", "", what, "scenario = \"sage-perturbed\"");
            None
        }
    }
}

fn from_scenario(head: &Table<'_>, word: &str) -> Option<Base> {
    let bundled = !word.contains(['/', '\\', '.']);
    let path = beside(head, head.at("scenario"), "scenario", word)?;
    let read = if bundled { crate::read_bundled(word) } else { crate::read_scenario_file(&path) };
    let file = report(head, "scenario", word, read)?;
    let label = if bundled { word.to_owned() } else { path.display().to_string() };
    let mut inputs = vec![(label, file.input_hash.clone())];
    if file.own_structure {
        let structure = &file.declared_plant.aero.structure;
        inputs.push((format!("structure {}", structure.name), hash(format!("{structure:?}").as_bytes())));
    }
    Some(Base { scenario: Some(file), campaign: None, inputs, warnings: Vec::new() })
}

fn from_campaign(head: &Table<'_>, word: &str) -> Option<Base> {
    let path = beside(head, head.at("campaign"), "campaign", word)?;
    let (campaign, warnings) = report(head, "campaign", word, crate::read_campaign_with_warnings(&path))?;
    if campaign.has_tracks() {
        let what = "is of point masses; a study flies bodies with attitude";
        head.source.fault(head.at("campaign"), head.full("campaign"), word, what, "a campaign of tunnel runs");
        return None;
    }
    let inputs = vec![(path.display().to_string(), hash(format!("{campaign:?}").as_bytes()))];
    Some(Base { scenario: None, campaign: Some(campaign), inputs, warnings })
}

/// The file, or its faults into the study's.
fn report<T>(t: &Table<'_>, key: &str, word: &str, read: Result<T, ReadError>) -> Option<T> {
    match read {
        Ok(value) => Some(value),
        Err(ReadError::Faults(faults)) => {
            t.source.add(&faults);
            None
        }
        Err(e) => {
            t.source.fault(t.at(key), t.full(key), word, e.to_string(), "a path beside the study file");
            None
        }
    }
}

fn model(head: &Table<'_>) -> Option<PathBuf> {
    let word = head.text_if("model")?;
    if !head.has("campaign") {
        let what = "belongs to a campaign; a scenario has its own aerodynamics";
        head.source.fault(head.at("model"), head.full("model"), word, what, "remove it, or vary aero.<parameter>");
        return None;
    }
    let path = beside(head, head.at("model"), "model", &word)?;
    if !path.is_file() {
        head.source.fault(
            head.at("model"),
            head.full("model"),
            word,
            "there is no such file",
            "the result of `windfall identify`",
        );
        return None;
    }
    Some(path)
}

fn merged(scenario: &[EffectValues], study: Vec<EffectValues>) -> Vec<EffectValues> {
    let replaced = |e: &&EffectValues| !study.iter().any(|s| s.family == e.family);
    let mut all: Vec<EffectValues> = scenario.iter().filter(replaced).cloned().collect();
    all.extend(study);
    all
}

/// The study before its own tables are read.
fn bare(base: &Base, all_effects: &[EffectValues], flights: Vec<Flight>) -> Option<StudyOrder> {
    let (plant, declared, knowledge) = match (&base.scenario, &base.campaign) {
        (Some(s), _) => (s.declared_plant.clone(), s.declared.clone(), s.knowledge.clone()),
        (_, Some(c)) => (c.plant.clone(), c.declared.clone(), c.knowledge.clone()),
        _ => return None,
    };
    // Draws are flown with the effects that the campaign declares, and their campaigns declare them again.
    let flown = match (&base.scenario, &base.campaign) {
        (None, Some(c)) => c.declared_plant(),
        _ => plant.clone(),
    };
    let find =
        |(index, e): (usize, &EffectValues)| effects::find(&e.family, Acts::Lander).map(|effect| StudyEffect { effect, index });
    Some(StudyOrder {
        name: String::new(),
        seed: 0,
        draws: 1,
        part_draws: PART_DRAWS,
        declared_plant: plant,
        plant: flown,
        declared,
        knowledge,
        effects: all_effects.iter().enumerate().filter_map(find).collect(),
        effect_values: all_effects.iter().map(|e| e.values.iter().map(|v| v.1).collect()).collect(),
        flights,
        vary: Vec::new(),
        correlation_root: StudyOrder::root_of_correlation(0, &[]).unwrap_or_default(),
        histories: None,
        steps: Steps::default(),
        keep: Keep { flights: true, estimates: true, intervals: true, resimulation: true, closing: true },
        stop: None,
    })
}

fn steps(file: &Table<'_>) -> Steps {
    let Some(t) = file.table_if(&keys::DO) else { return Steps::default() };
    let identify: Vec<String> =
        if t.has("identify") { t.words("identify").into_iter().map(|w| w.0).collect() } else { Vec::new() };
    let resimulate = t.has("resimulate") && t.bool("resimulate");
    if resimulate && identify.is_empty() {
        let what = "needs an identified model";
        t.source.fault(t.at("resimulate"), t.full("resimulate"), "true", what, "identify = [\"equation-error\"]");
    }
    if let Some(twice) = identify.iter().enumerate().find(|(i, m)| identify[..*i].contains(m)) {
        t.source.fault(t.at("identify"), t.full("identify"), twice.1, "appears twice", "name each method once");
    }
    Steps { identify, resimulate, close: t.has("close") && t.bool("close") }
}

fn keep(file: &Table<'_>) -> Keep {
    let t = file.table_if(&keys::KEEP);
    let kept = |name| t.as_ref().is_none_or(|t| !t.has(name) || t.bool(name));
    Keep {
        flights: kept("flights"),
        estimates: kept("estimates"),
        intervals: kept("intervals"),
        resimulation: kept("resimulation"),
        closing: kept("closing"),
    }
}

fn vary(file: &Table<'_>, study: &StudyOrder, all_effects: &[EffectValues]) -> Vec<Vary> {
    if !file.has("vary") {
        return Vec::new();
    }
    let tables = file.tables(&keys::VARY);
    let all: Vec<Vary> = tables.iter().filter_map(|t| varied(t, study, all_effects)).collect();
    for (i, v) in all.iter().enumerate() {
        if all[..i].iter().any(|o| o.name == v.name) {
            file.source.fault(None, "[[vary]] quantity", &v.name, "varies twice", "one [[vary]] per quantity");
        }
    }
    if tables.len() > MOST_VARIED {
        let what = format!("at most {MOST_VARIED} things may vary");
        file.source.fault(None, "[[vary]]", tables.len().to_string(), what, "fewer [[vary]]");
    }
    all
}

fn varied(t: &Table<'_>, study: &StudyOrder, all_effects: &[EffectValues]) -> Option<Vary> {
    let name = t.text("quantity");
    let flights = flights_of(t, study);
    let known = t.has("known") && t.bool("known");
    let distribution = distribution(t);
    let (quantity, range) = quantity(t, &name, study, all_effects)?;
    let distribution = distribution?;
    let is_flight = matches!(quantity, Quantity::Flight(..));
    if !flights.is_empty() && !is_flight {
        let what = "is for quantities of flights; this one belongs to all";
        t.source.fault(t.at("flights"), t.full("flights"), "", what, "remove it");
    }
    if known && (is_flight || matches!(quantity, Quantity::Effect(..))) {
        let what = "is for what a campaign declares: vehicle, tether, environment, sensors, aero";
        t.source.fault(t.at("known"), t.full("known"), "true", what, "remove it");
    }
    let mut trial =
        DrawnSetup { plant: study.plant.clone(), effect_values: study.effect_values.clone(), flights: study.flights.clone() };
    if !trial.set(quantity, &flights, 1.0) {
        let what = "does not exist in what is drawn from";
        t.source.fault(t.at("quantity"), t.full("quantity"), &name, what, "a number that the scenario has");
    }
    check_range(t, &distribution, range);
    let name = match flights.first() {
        Some(&i) => format!("{name}@{}", study.flights[i].name),
        None => name,
    };
    Some(Vary { name, quantity, flights, distribution, range, known })
}

/// Numbers that a distribution may certainly draw must be allowed; tails of a normal are judged draw by draw.
fn check_range(t: &Table<'_>, d: &Distribution, range: [f64; 2]) {
    let certain: Vec<f64> = match d {
        Distribution::Normal { mean, .. } => vec![*mean],
        Distribution::LogNormal { median, .. } => vec![*median],
        Distribution::Uniform { low, high } => vec![*low, *high],
        Distribution::Choice { values } => values.clone(),
    };
    for x in certain.into_iter().filter(|x| x.is_finite() && !(*x >= range[0] && *x <= range[1])) {
        t.source.fault(Some(t.span.clone()), t.full("quantity"), x.to_string(), allowed_range(range, "-"), "values inside");
    }
}

fn flights_of(t: &Table<'_>, study: &StudyOrder) -> Vec<usize> {
    if !t.has("flights") {
        return Vec::new();
    }
    let names: Vec<&str> = study.flights.iter().map(|f| f.name.as_str()).collect();
    let mut all = Vec::new();
    for (word, span) in t.words("flights") {
        match names.iter().position(|n| *n == word) {
            Some(i) => all.push(i),
            None => {
                let what = format!("is no flight; flights: {}", names.join(", "));
                t.source.fault(Some(span), t.full("flights"), &word, what, nearest(&word, &names).unwrap_or("one of these"));
            }
        }
    }
    all
}

fn quantity(t: &Table<'_>, name: &str, study: &StudyOrder, all_effects: &[EffectValues]) -> Option<(Quantity, [f64; 2])> {
    let structure = &study.plant.aero.structure;
    if let Some(i) = name.strip_prefix("aero.").and_then(|p| structure.index(p)) {
        return Some((Quantity::Aero(i), [-1e9, 1e9]));
    }
    for (i, e) in all_effects.iter().enumerate() {
        let parameters = effects::find(&e.family, Acts::Lander).map(|f| (f.parameters)(&[])).unwrap_or_default();
        let below = name.strip_prefix("effects.").and_then(|n| n.strip_prefix(&e.family)).and_then(|n| n.strip_prefix('.'));
        if let Some((j, p)) = below.and_then(|n| parameters.iter().enumerate().find(|(_, p)| p.name == n)) {
            let high = if p.role == Role::Run { study.flights.len().saturating_sub(1) as f64 } else { p.high };
            return Some((Quantity::Effect(i, j), [p.low, high]));
        }
    }
    let declared = || PLANT_NUMBERS.iter().filter(|n| n.given == Given::Declared);
    if let Some(n) = declared().find(|n| n.name() == name) {
        return Some((Quantity::Plant(n), n.range));
    }
    let full = |(path, component, _): &(&str, &str, Quantity)| {
        if component.is_empty() { (*path).to_owned() } else { format!("{path}.{component}") }
    };
    if let Some(entry) = FLIGHT_QUANTITIES.iter().find(|q| full(q) == name) {
        return Some((entry.2, key_range(entry.0)));
    }
    let mut all: Vec<String> = declared().map(windfall_model::PlantNumber::name).collect();
    all.extend(FLIGHT_QUANTITIES.iter().map(full));
    all.extend(structure.parameters.iter().map(|p| format!("aero.{p}")));
    for e in all_effects {
        all.extend(e.values.iter().map(|(p, _)| format!("effects.{}.{p}", e.family)));
    }
    let near: Vec<&str> = all.iter().map(String::as_str).collect();
    let what = "is nothing that varies: keys of the scenario with their table (vehicle.mass_kg, flight.release.attitude_deg.Ry), \
                aero.<parameter>, effects.<family>.<parameter> of an effect in [effects]";
    t.source.fault(t.at("quantity"), t.full("quantity"), name, what, nearest(name, &near).unwrap_or("windfall check --keys"));
    None
}

/// Range of a key of the scenario file.
fn key_range(path: &str) -> [f64; 2] {
    let (table, key) = path.rsplit_once('.').unwrap_or(("", path));
    let of_table = |specs: &[&keys::TableSpec]| {
        specs.iter().filter(|s| s.path == table).flat_map(|s| s.keys).find(|k| k.name == key).map(|k| k.range)
    };
    keys::ALL
        .iter()
        .filter(|(title, _)| *title == "Scenario file")
        .find_map(|(_, specs)| of_table(specs))
        .unwrap_or([f64::NAN; 2])
}

fn distribution(t: &Table<'_>) -> Option<Distribution> {
    let given: Vec<&str> = ["normal", "uniform", "log_normal", "choice"].into_iter().filter(|n| t.has(n)).collect();
    let [one] = given[..] else {
        let what = "must hold exactly one of normal, uniform, log_normal, choice";
        t.source.fault(Some(t.span.clone()), "[[vary]]", given.join(", "), what, "normal = { mean = 0.0, std = 1.0 }");
        return None;
    };
    let ordered = |d: &Table<'_>, low: f64, high: f64| {
        if low >= high {
            d.source.fault(d.at("low"), d.full("low"), low.to_string(), format!("must be below high = {high}"), "low < high");
        }
    };
    Some(match one {
        "normal" => {
            let d = t.table_named(one, &keys::NORMAL)?;
            let (low, high) = (d.number_if("low").unwrap_or(f64::NEG_INFINITY), d.number_if("high").unwrap_or(f64::INFINITY));
            let (mean, std) = (d.number("mean"), d.number("std"));
            ordered(&d, low, high);
            if low > mean + 6.0 * std || high < mean - 6.0 * std {
                let what = "cuts all but the last thousand-millionth off (beyond 6 std)";
                d.source.fault(Some(d.span.clone()), "[vary.normal]", "", what, "another mean, or uniform");
            }
            Distribution::Normal { mean, std, low, high }
        }
        "uniform" => {
            let d = t.table_named(one, &keys::UNIFORM)?;
            let (low, high) = (d.number("low"), d.number("high"));
            ordered(&d, low, high);
            Distribution::Uniform { low, high }
        }
        "log_normal" => {
            let d = t.table_named(one, &keys::LOG_NORMAL)?;
            Distribution::LogNormal { median: d.number("median"), sigma: d.number("sigma") }
        }
        _ => Distribution::Choice { values: t.table_named(one, &keys::CHOICE)?.series("values") },
    })
}

fn correlation(file: &Table<'_>, vary: &[Vary]) -> Root {
    if !file.has("correlation") {
        return Root::default();
    }
    let mut entries: Vec<(usize, usize, f64)> = Vec::new();
    let names: Vec<&str> = vary.iter().map(|v| v.name.as_str()).collect();
    for t in file.tables(&keys::CORRELATION) {
        let mut pair = Vec::new();
        for (word, span) in t.words("between") {
            match names.iter().position(|n| *n == word) {
                Some(i) => pair.push(i),
                None => {
                    let what = format!("does not vary; [[vary]] has {}", names.join(", "));
                    t.source.fault(Some(span), t.full("between"), &word, what, nearest(&word, &names).unwrap_or("one of these"));
                }
            }
        }
        let r = t.number("coefficient");
        match pair[..] {
            [i, j] if i != j && !entries.iter().any(|e| [e.0, e.1] == [i.min(j), i.max(j)]) => {
                entries.push((i.min(j), i.max(j), r));
            }
            _ => {
                let what = "must name two different quantities that vary, each pair once";
                t.source.fault(t.at("between"), t.full("between"), "", what, "[\"aero.Cm_sin\", \"aero.Cm_sin3\"]");
            }
        }
    }
    if file.source.has_faults() {
        return Root::default();
    }
    StudyOrder::root_of_correlation(vary.len(), &entries).unwrap_or_else(|| {
        let what = "these correlations contradict each other: their matrix is not positive definite";
        file.source.fault(None, "[[correlation]]", "", what, "smaller coefficients");
        Root::default()
    })
}

fn histories(file: &Table<'_>, study: &StudyOrder, inputs: &mut Vec<(String, String)>) -> Option<Histories> {
    let t = file.table_if(&keys::HISTORIES)?;
    let flights = flights_of(&t, study);
    let mut speeds = Vec::new();
    for (word, span) in t.words("files") {
        let Some(path) = beside(&t, Some(span.clone()), "files", &word) else { continue };
        match read_record_pieces(&path, &study.plant.sensors, None) {
            Ok(pieces) if pieces.len() == 1 => {
                let r = &pieces[0].record;
                inputs.push((path.display().to_string(), hash(format!("{r:?}").as_bytes())));
                speeds.push(TunnelSpeed::History { interval_s: r.interval_s(), vw_m_s: r.vw_m_s.clone() });
            }
            Ok(_) => t.source.fault(Some(span), t.full("files"), &word, "has long gaps", "a run of one piece"),
            Err(ReadError::Faults(faults)) => t.source.add(&faults),
            Err(e) => t.source.fault(Some(span), t.full("files"), &word, e.to_string(), "a path beside the study file"),
        }
    }
    if speeds.is_empty() && !t.source.has_faults() {
        t.source.fault(t.at("files"), t.full("files"), "[]", "must name one run file or more", "[\"run-1.csv\"]");
    }
    Some(Histories { flights, speeds })
}

fn stop(file: &Table<'_>) -> Option<StopRule> {
    let t = file.table_if(&keys::STOP)?;
    Some(StopRule {
        column: t.text("column"),
        half_width: t.number("half_width"),
        least_draws: t.integer_if("least_draws").unwrap_or(LEAST_DRAWS),
    })
}
