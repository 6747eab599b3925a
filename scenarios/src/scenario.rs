//! scenarios: scenario files. In: a path or bundled text. Out: a checked scenario with what its resolved file needs, or every fault.

use crate::error::ReadError;
use crate::hash::fnv1a;
use crate::keys;
use crate::limits;
use crate::names::name_of_file;
use crate::numerics::numerics;
use crate::open::text_of;
use crate::plant::{Declared, read_declared};
use crate::table::{Source, Table, allowed_range, nearest, number};
use std::path::{Path, PathBuf};
use toml::de::DeTable;
use windfall_model::effects::{self, Acts, Role};
use windfall_model::frames::Vec3;
use windfall_model::{
    CATALOGUE, Contact, Effect, Flight, Knowledge, Numerics, Operator, Plant, Release, Scenario, TestSection, TunnelSpeed, Use,
};

/// Seed of a scenario that gives none.
pub(crate) const DEFAULT_SEED: u64 = 1;

/// An effect in a scenario's truth.
#[derive(Clone, Debug, PartialEq)]
pub struct EffectValues {
    /// Family of the catalogue.
    pub family: String,
    /// All its parameters in the catalogue's order, each with its value in the unit that the catalogue states.
    pub values: Vec<(String, f64)>,
}

/// A scenario with what was read beside it.
#[derive(Clone, Debug, PartialEq)]
pub struct ScenarioFile {
    /// What is flown.
    pub scenario: Scenario,
    /// The file's note.
    pub note: Option<String>,
    /// The plant without effects: what a campaign made of the flights declares.
    pub declared_plant: Plant,
    /// For each parameter of the structure, whether that campaign declares it.
    pub declared: Vec<bool>,
    /// Uncertainties that it declares, and whether noise is exact.
    pub knowledge: Knowledge,
    /// Effects in the truth with their values.
    pub effects: Vec<EffectValues>,
    /// Whether the structure is the file's own (and must be written beside a resolved file).
    pub own_structure: bool,
    /// Path or bundled name.
    pub input: String,
    /// FNV-1a hash of the input's bytes (Fowler, Noll and Vo 1991), 64 bits in hexadecimal.
    pub input_hash: String,
}

/// Reads a scenario file with what its resolved form and the campaign made of it need.
///
/// # Errors
/// [`ReadError`] with every fault of the file.
pub fn read_scenario_file(path: &Path) -> Result<ScenarioFile, ReadError> {
    parse(path, &text_of(path)?, &path.display().to_string())
}

/// Reads the bundled scenario of that name.
///
/// # Errors
/// [`ReadError`] when there is none of that name; the message lists those that there are.
pub fn read_bundled(name: &str) -> Result<ScenarioFile, ReadError> {
    match crate::bundled::bundled(name) {
        Some(text) => parse(&PathBuf::from(format!("{name}.toml (bundled)")), text, name),
        None => {
            let (planets, free) = (crate::bundled::PLANETS, crate::bundled::FREE);
            let near = nearest(name, &crate::bundled::NAMES).unwrap_or("a path that ends in .toml");
            let what = if planets.contains(&name) {
                "is a planet scenario, which is flown, flown down and checked only".to_owned()
            } else if free.contains(&name) {
                "is a scenario in free flight, which is flown and checked only".to_owned()
            } else {
                let names = [&crate::bundled::NAMES[..], &planets, &free].concat().join(", ");
                format!("is neither a file nor a bundled scenario; bundled: {names}")
            };
            Err(ReadError::Faults(vec![crate::columns::fault(Path::new(name), None, "", "", &what, near)]))
        }
    }
}

fn parse(path: &Path, text: &str, input: &str) -> Result<ScenarioFile, ReadError> {
    let source = Source::new(path, text);
    let root = source.parse()?;
    crate::planet::refuse(&source, text)?;
    let file = Table::new(&source, "", &root, 0..0, &keys::SCENARIO_FILE);
    let head = file.table(&keys::SCENARIO).map(|t| (t.text("name"), t.text_if("note")));
    let seed = file.integer_if("seed").unwrap_or(DEFAULT_SEED);
    if file.has("provenance") {
        file.table(&keys::PROVENANCE);
    }
    let declared = read_declared(&file, true);
    let effects = read_effects(&file);
    let common = Common {
        section: section(&file),
        numerics: numerics(&file, Numerics::default()),
        air: declared.as_ref().map_or([f64::NAN; 2], |d| d.air),
    };
    let flights: Vec<Flight> = file.tables(&keys::FLIGHT).iter().filter_map(|t| flight(t, &common)).collect();
    // A flight alone makes run.csv and truth.csv, whatever its name.
    limits::unique_files(&source, &flights.iter().map(|f| f.name.as_str()).collect::<Vec<_>>(), &[".csv", "-truth.csv"]);
    limits::of_file(&source, "flight", flights.len(), flights.iter().map(|f| f.duration_s * f.rate_hz).sum());
    runs_exist(&source, &effects, flights.len());
    let built = declared.zip(head).filter(|_| !source.has_faults()).map(|(declared, (name, note))| {
        let Declared { plant: declared_plant, declared, knowledge, structure_file, .. } = declared;
        let mut plant = declared_plant.clone();
        let mut values: Vec<Vec<f64>> = effects.iter().map(|e| e.values.iter().map(|v| v.1).collect()).collect();
        let found = effects
            .iter()
            .zip(&mut values)
            .filter_map(|(e, v)| Some((effects::find(&e.family, Acts::Lander)?, v.as_mut_slice())));
        effects::act_in_flights(&mut plant, found, &flights);
        for e in &effects {
            effects::find(&e.family, Acts::Lander).iter().for_each(|effect| not_overdrawn(&source, effect, &[], &plant));
        }
        let families = effects.iter().map(|e| e.family.clone()).collect();
        ScenarioFile {
            scenario: Scenario { name, plant, effects: families, flights, seed },
            note,
            declared_plant,
            declared,
            knowledge,
            effects,
            own_structure: structure_file.is_some(),
            input: input.to_owned(),
            input_hash: format!("{:016x}", fnv1a(text.as_bytes())),
        }
    });
    source.finish(built)
}

/// Effects of a scenario's or study's truth.
pub(crate) fn read_effects(file: &Table<'_>) -> Vec<EffectValues> {
    effect_tables(file, Acts::Lander, &[], false).into_iter().map(|(_, values)| values).collect()
}

/// Effects that a campaign declares, with the names of its run inputs.
pub(crate) fn declared_effects(file: &Table<'_>, acts: Acts, inputs: &[String]) -> Vec<(&'static Effect, Vec<f64>)> {
    let all = effect_tables(file, acts, inputs, true);
    all.into_iter().map(|(effect, e)| (effect, e.values.into_iter().map(|v| v.1).collect())).collect()
}

/// `starting`: values are starting points, for which a shape may be left out, not a truth.
pub(crate) fn effect_tables(
    file: &Table<'_>,
    acts: Acts,
    inputs: &[String],
    starting: bool,
) -> Vec<(&'static Effect, EffectValues)> {
    if !file.has("effects") {
        return Vec::new();
    }
    let spec = if starting { &keys::CAMPAIGN_EFFECTS } else { &keys::EFFECTS };
    let Some(outer) = file.table_named("effects", spec) else { return Vec::new() };
    let families: Vec<&str> = CATALOGUE.iter().filter(|e| e.acts.on(acts)).map(|e| e.family).collect();
    let mut all = Vec::new();
    for (family, body) in outer.entries() {
        let name = family.get_ref().as_ref();
        let table = body.get_ref().as_table();
        match (effects::find(name, acts), table) {
            (None, _) => outer.unknown(family, body, &families),
            (_, None) => {
                let what = "must be a table of parameter = value";
                file.source.fault(
                    Some(body.span()),
                    outer.full(name),
                    file.source.snippet(body.span()),
                    what,
                    format!("[effects.{name}]"),
                );
            }
            (Some(effect), Some(table)) => {
                let t = Table::new(file.source, &format!("effects.{name}"), table, body.span(), spec);
                let values = effect_values(&t, table, &(effect.parameters)(inputs), starting);
                all.push((effect, EffectValues { family: name.to_owned(), values }));
            }
        }
    }
    all
}

fn effect_values(t: &Table<'_>, table: &DeTable<'_>, parameters: &[effects::Parameter], starting: bool) -> Vec<(String, f64)> {
    let names: Vec<&str> = parameters.iter().map(|p| p.name.as_str()).collect();
    for (key, value) in t.entries().filter(|(k, _)| !names.contains(&k.get_ref().as_ref())) {
        t.unknown(key, value, &names);
    }
    let one = |p: &effects::Parameter| match table.get(p.name.as_str()) {
        Some(at) => match number(at).filter(|x| x.is_finite() && *x >= p.lowest() && *x <= p.high) {
            Some(x) => x,
            None => {
                let value = t.source.snippet(at.span());
                t.source.fault(
                    Some(at.span()),
                    t.full(&p.name),
                    value,
                    allowed_range([p.lowest(), p.high], p.unit),
                    "a plausible value",
                );
                f64::NAN
            }
        },
        None if matches!(p.role, Role::Strength | Role::Reference)
            || (matches!(p.role, Role::Shape(_)) && (starting || p.null <= p.low)) =>
        {
            p.left_out()
        }
        None => {
            let what = format!(
                "is missing ({}); only strengths and shapes whose absence is zero may be left out",
                allowed_range([p.lowest(), p.high], p.unit)
            );
            t.source.fault(t.at(&p.name), t.full(&p.name), "", what, format!("{} = {}", p.name, p.null));
            f64::NAN
        }
    };
    parameters.iter().map(|p| (p.name.clone(), one(p))).collect()
}

/// Effects in one run must name one of those that there are.
pub(crate) fn runs_exist(source: &Source<'_>, effects: &[EffectValues], flights: usize) {
    for e in effects {
        let parameters = effects::find(&e.family, Acts::Lander).map(|f| (f.parameters)(&[])).unwrap_or_default();
        for (p, (_, value)) in parameters.iter().zip(&e.values).filter(|(p, _)| p.role == Role::Run) {
            run_exists(source, &e.family, p, *value, flights, "flight");
        }
    }
}

pub(crate) fn run_exists(source: &Source<'_>, family: &str, p: &effects::Parameter, value: f64, runs: usize, what: &str) {
    if value.is_finite() && (value.fract() != 0.0 || value >= runs as f64) {
        let allowed = format!("must be the number of a {what}, 0 to {}", runs.saturating_sub(1));
        source.fault(None, format!("[effects.{family}] {}", p.name), value.to_string(), allowed, format!("{} = 0", p.name));
    }
}

/// An effect may take away what is declared of an amount (drag, friction, apparent mass), and no more.
pub(crate) fn not_overdrawn(source: &Source<'_>, effect: &Effect, inputs: &[String], plant: &Plant) {
    if let Some((p, in_all)) = effect.overdrawn(inputs, plant) {
        let unit = if p.unit == "-" { String::new() } else { format!(" {}", p.unit) };
        let allowed = format!("takes away more than is declared: {in_all:.6}{unit} are left, and none is the least");
        let key = format!("[effects.{}] {}", effect.family, p.name);
        source.fault(None, key, "", allowed, "a change that leaves zero or more with all other effects in");
    }
}

/// What a run or flight is for; a wrong word is a fault.
pub(crate) fn used(t: &Table<'_>) -> Use {
    t.choice("use").map_or(Use::Identify, |place| Use::ALL[place])
}

/// What all flights of a file share.
struct Common {
    section: Option<TestSection>,
    numerics: Numerics,
    air: [f64; 2],
}

fn section(file: &Table<'_>) -> Option<TestSection> {
    if !file.has("section") {
        return None;
    }
    let t = file.table(&keys::SECTION)?;
    let s = TestSection { radius_m: t.number("radius_m"), top_x_m: t.number("top_x_m"), bottom_x_m: t.number("bottom_x_m") };
    if s.top_x_m >= s.bottom_x_m {
        let what = "must be above the lower net: X points down, so top_x_m < bottom_x_m";
        t.source.fault(t.at("top_x_m"), t.full("top_x_m"), s.top_x_m.to_string(), what, "-3.81");
    }
    Some(s)
}

fn flight(t: &Table<'_>, common: &Common) -> Option<Flight> {
    let name = t.text("name");
    name_of_file(t, &name);
    let release = t.table(&keys::RELEASE).map(|r| Release {
        position_m: r.numbers("position_m"),
        velocity_m_s: r.numbers("velocity_m_s"),
        attitude_rad: r.numbers::<3>("attitude_deg").map(f64::to_radians),
        rates_rad_s: r.numbers::<3>("rates_deg_s").map(f64::to_radians),
    });
    let (duration_s, rate_hz) = (t.number("duration_s"), t.number("rate_hz"));
    let speed = t.table(&keys::SPEED).and_then(|s| speed(&s, duration_s));
    limits::samples(t, duration_s, rate_hz);
    Some(Flight {
        name,
        kind: t.text("kind"),
        used: used(t),
        duration_s,
        rate_hz,
        sensor_noise: t.bool("sensor_noise"),
        pushes: pushes(t),
        window_s: window(t, duration_s, rate_hz),
        release: release?,
        speed: speed?,
        ps_pa: common.air[0],
        ts_k: common.air[1],
        section: common.section,
        numerics: common.numerics,
    })
}

/// Pushes of a flight; the number of their run is that of the first, and is not looked at.
fn pushes(t: &Table<'_>) -> Vec<Contact> {
    if !t.has("push") {
        return Vec::new();
    }
    let vector = |p: &Table<'_>, key: &str| {
        let [x, y, z] = p.numbers::<3>(key);
        Vec3::new(x, y, z)
    };
    let one = |p: &Table<'_>| Contact {
        run: 0,
        start_s: p.number("start_s"),
        duration_s: p.number("duration_s"),
        impulse: vector(p, "impulse_n_s"),
        angular_impulse: vector(p, "angular_impulse_n_m_s"),
    };
    t.tables(&keys::PUSH).iter().map(one).collect()
}

/// Part of a flight that its campaign uses: inside the flight, and at least two samples.
fn window(t: &Table<'_>, duration_s: f64, rate_hz: f64) -> Option<[f64; 2]> {
    if !t.has("window_s") {
        return None;
    }
    let window = t.numbers::<2>("window_s");
    let [from, to] = window;
    if to > duration_s || to - from < 2.0 / rate_hz {
        let what =
            format!("must run from an earlier to a later time, two samples at least, within the {duration_s} s of the flight");
        t.source.fault(t.at("window_s"), t.full("window_s"), format!("{window:?}"), what, "[from, to] in s");
    }
    Some(window)
}

fn speed(t: &Table<'_>, duration_s: f64) -> Option<TunnelSpeed> {
    let given: Vec<&str> = ["operator", "history", "constant"].into_iter().filter(|n| t.has(n)).collect();
    let [one] = given[..] else {
        let what = "must hold exactly one of operator, history, constant";
        t.source.fault(Some(t.span.clone()), format!("[{}]", t.path), given.join(", "), what, "[flight.speed.operator]");
        return None;
    };
    Some(match one {
        "operator" => TunnelSpeed::Operator(operator(&t.table_named(one, &keys::OPERATOR)?, duration_s)),
        "history" => {
            let h = t.table_named(one, &keys::HISTORY)?;
            TunnelSpeed::History { interval_s: h.number("interval_s"), vw_m_s: h.series("vw_m_s") }
        }
        _ => TunnelSpeed::Constant(t.table_named(one, &keys::CONSTANT)?.number("vw_m_s")),
    })
}

fn operator(t: &Table<'_>, duration_s: f64) -> Operator {
    let unsteady_time_s = t.number("unsteady_time_s");
    // The hand is drawn on a grid of a thirty-second of its time.
    limits::grid(t, "unsteady_time_s", unsteady_time_s, unsteady_time_s / 32.0, duration_s);
    Operator {
        trim_m_s: t.number_if("trim_m_s"),
        height_gain_per_s: t.number("height_gain_per_s"),
        rate_gain: t.number("rate_gain"),
        integral_gain_per_s2: t.number("integral_gain_per_s2"),
        lag_s: t.number("lag_s"),
        unsteady_rms_m_s: t.number("unsteady_rms_m_s"),
        unsteady_time_s,
        hold_x_m: t.number("hold_x_m"),
    }
}
