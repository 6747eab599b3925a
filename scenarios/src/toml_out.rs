//! scenarios: TOML that this room writes and reads back. In: checked setups. Out: text with every default in it.

use crate::error::WriteError;
use crate::scenario::ScenarioFile;
use crate::write::text_atomically;
use std::fmt::Write as _;
use std::path::Path;
use windfall_model::frames::{Axes, Vec3};
use windfall_model::{
    Aero, Factor, Flight, Inertia, Integrator, Knowledge, Numerics, PLANT_NUMBERS, Plant, PlantNumber, Sensors, Structure,
    TunnelSpeed, Use,
};

/// One run of a campaign that is written.
#[derive(Clone, Debug, PartialEq)]
pub struct RunLine {
    /// File name beside the campaign file.
    pub file: String,
    /// Kind of run.
    pub kind: String,
    /// What it is for.
    pub used: Use,
    /// Part of the file that is used, s; none: all.
    pub window_s: Option<[f64; 2]>,
}

/// Text under construction.
pub(crate) struct Toml(String);

impl std::fmt::Write for Toml {
    fn write_str(&mut self, s: &str) -> std::fmt::Result {
        self.0.write_str(s)
    }
}

impl Toml {
    pub(crate) fn new(first: &str) -> Self {
        Self(first.to_owned())
    }
    pub(crate) fn into_text(self) -> String {
        self.0
    }
    pub(crate) fn table(&mut self, name: &str) {
        let _ = write!(self.0, "\n[{name}]\n");
    }
    pub(crate) fn raw(&mut self, key: &str, value: &str) {
        let _ = writeln!(self.0, "{key} = {value}");
    }
    pub(crate) fn number(&mut self, key: &str, value: f64) {
        self.raw(key, &digits(value));
    }
    /// An angle in degrees under a name that ends in `_deg`.
    fn degrees(&mut self, key: &str, value_rad: f64) {
        self.number(key, degrees_of(value_rad));
    }
    pub(crate) fn text(&mut self, key: &str, value: &str) {
        self.raw(key, &quoted(value));
    }
    /// What a resolved scenario is called, and which file it is made of.
    pub(crate) fn origin(&mut self, name: &str, note: Option<&str>, input: &str, input_hash: &str) {
        self.table("scenario");
        self.text("name", name);
        if let Some(note) = note {
            self.text("note", note);
        }
        self.table("provenance");
        self.text("windfall", env!("CARGO_PKG_VERSION"));
        self.text("input", input);
        self.text("input_hash", input_hash);
    }
    pub(crate) fn numbers(&mut self, key: &str, values: &[f64]) {
        self.raw(key, &format!("[{}]", values.iter().map(|v| digits(*v)).collect::<Vec<_>>().join(", ")));
    }
    fn vector<A: Axes>(&mut self, key: &str, v: Vec3<A>) {
        self.numbers(key, &v.to_array());
    }
}

fn quoted(value: &str) -> String {
    let mut all = String::from("\"");
    for c in value.chars() {
        match c {
            '"' => all.push_str("\\\""),
            '\\' => all.push_str("\\\\"),
            c if c.is_control() => {
                let _ = write!(all, "\\u{:04X}", u32::from(c));
            }
            c => all.push(c),
        }
    }
    all.push('"');
    all
}

/// The shortest digits that give the number back, always a TOML float.
pub(crate) fn digits(value: f64) -> String {
    format!("{value:?}")
}

/// Degrees that become exactly this angle again, when a number of 15 digits or its neighbours does.
pub(crate) fn degrees_of(rad: f64) -> f64 {
    let d = rad.to_degrees();
    let short: f64 = format!("{d:.14e}").parse().unwrap_or(d);
    let back = |x: &f64| x.to_radians().to_bits() == rad.to_bits();
    [short, d, d.next_up(), d.next_down()].into_iter().find(back).unwrap_or(d)
}

/// Inertia as an inline table.
pub(crate) fn inertia_line(i: &Inertia) -> String {
    let pairs = [("xx", i.xx), ("yy", i.yy), ("zz", i.zz), ("xy", i.xy), ("xz", i.xz), ("yz", i.yz)];
    let list = pairs.iter().map(|(n, x)| format!("{n} = {}", digits(*x))).collect::<Vec<_>>().join(", ");
    format!("{{ {list} }}")
}

fn plant_tables(t: &mut Toml, plant: &Plant, knowledge: &Knowledge, air: Option<[f64; 2]>) {
    let v = &plant.vehicle;
    t.table("vehicle");
    t.number("mass_kg", v.mass_kg);
    t.raw("inertia_kg_m2", &inertia_line(&v.inertia));
    t.vector("center_of_mass_m", v.p_origin_cm);
    t.number("reference_diameter_m", v.diameter_m);
    if let Some(tether) = &plant.tether {
        t.table("tether");
        t.vector("attachment_m", tether.p_origin_hook);
        t.vector("ring_m", tether.p_tunnel_ring);
        t.number("drag_area_m2", tether.drag_area_m2);
        t.number("effective_weight_n", tether.weight_n);
    }
    t.table("environment");
    t.number("gravity_m_s2", plant.environment.gravity_m_s2);
    t.number("gas_constant_j_kg_k", plant.environment.gas_constant_j_kg_k);
    if let Some([ps_pa, ts_k]) = air {
        t.number("static_pressure_pa", ps_pa);
        t.number("static_temperature_k", ts_k);
    }
    sensor_table(t, &plant.sensors, knowledge.exact_noise);
    uncertainty_tables(t, &plant.aero.structure, knowledge);
}

fn sensor_table(t: &mut Toml, s: &Sensors, exact_noise: bool) {
    t.table("sensors");
    t.number("position_std_m", s.position_std_m);
    t.degrees("roll_std_deg", s.roll_std_rad);
    t.degrees("pitch_yaw_std_deg", s.pitch_yaw_std_rad);
    t.number("wind_std_m_s", s.wind_std_m_s);
    if exact_noise {
        t.text("noise", "exact");
    }
}

/// Standard uncertainties in the shapes of the numbers that they belong to; those of inertia under dotted keys.
pub(crate) fn uncertainty_tables(t: &mut Toml, structure: &Structure, knowledge: &Knowledge) {
    let known = |n: &PlantNumber| knowledge.constants.iter().find(|c| (c.key, c.component) == (n.key, n.component));
    let (mut table, mut last) = ("", "");
    for n in PLANT_NUMBERS.iter().filter(|n| knowledge.constants.iter().any(|c| c.key == n.key)) {
        let (head, key) = n.key.split_once('.').unwrap_or(("", n.key));
        if head != table {
            t.table(&format!("uncertainty.{head}"));
            table = head;
        }
        if n.key == last {
            continue;
        }
        last = n.key;
        let std = |n: &PlantNumber| known(n).map_or(0.0, |c| if n.angle { degrees_of(c.std) } else { c.std });
        let all: Vec<f64> = PLANT_NUMBERS.iter().filter(|o| o.key == n.key).map(std).collect();
        if all.len() == 1 { t.number(key, all[0]) } else { t.numbers(key, &all) }
    }
    if !knowledge.priors.is_empty() {
        t.table(&format!("uncertainty.aero.{}", bare(&structure.name)));
        knowledge.priors.iter().for_each(|(i, std)| t.number(&bare(&structure.parameters[*i]), *std));
    }
}

fn structure_name(structure: &Structure) -> String {
    format!("{}-structure.toml", structure.name)
}

fn bare(key: &str) -> String {
    let plain = !key.is_empty() && key.chars().all(|c| c.is_ascii_alphanumeric() || c == '-' || c == '_');
    if plain { key.to_owned() } else { quoted(key) }
}

pub(crate) fn aero_table(t: &mut Toml, aero: &Aero, declared: &[bool], own: bool) {
    t.table(&format!("aero.{}", bare(&aero.structure.name)));
    if own {
        t.text("structure", &structure_name(&aero.structure));
    }
    for (name, value) in aero.structure.parameters.iter().zip(&aero.values) {
        t.number(&bare(name), *value);
    }
    if declared.contains(&false) {
        let names = aero.structure.parameters.iter().zip(declared).filter(|(_, d)| **d).map(|(n, _)| quoted(n));
        t.raw("declared", &format!("[{}]", names.collect::<Vec<_>>().join(", ")));
    }
}

pub(crate) fn numerics_table(t: &mut Toml, n: &Numerics) {
    t.table("numerics");
    t.text("method", if n.method == Integrator::Dopri5 { "dopri5" } else { "dop853" });
    t.number("relative_tolerance", n.relative_tolerance);
    t.number("absolute_tolerance", n.absolute_tolerance);
}

fn flight_table(t: &mut Toml, f: &Flight) {
    let _ = write!(t.0, "\n[[flight]]\n");
    t.text("name", &f.name);
    t.text("kind", &f.kind);
    t.text("use", f.used.name());
    t.number("duration_s", f.duration_s);
    t.number("rate_hz", f.rate_hz);
    t.raw("sensor_noise", if f.sensor_noise { "true" } else { "false" });
    if let Some(window) = f.window_s {
        t.numbers("window_s", &window);
    }
    for push in &f.pushes {
        let _ = write!(t.0, "\n[[flight.push]]\n");
        t.number("start_s", push.start_s);
        t.number("duration_s", push.duration_s);
        t.vector("impulse_n_s", push.impulse);
        t.vector("angular_impulse_n_m_s", push.angular_impulse);
    }
    t.table("flight.release");
    t.numbers("position_m", &f.release.position_m);
    t.numbers("velocity_m_s", &f.release.velocity_m_s);
    t.numbers("attitude_deg", &f.release.attitude_rad.map(degrees_of));
    t.numbers("rates_deg_s", &f.release.rates_rad_s.map(degrees_of));
    match &f.speed {
        TunnelSpeed::Constant(v) => {
            t.table("flight.speed.constant");
            t.number("vw_m_s", *v);
        }
        TunnelSpeed::History { interval_s, vw_m_s } => {
            t.table("flight.speed.history");
            t.number("interval_s", *interval_s);
            t.numbers("vw_m_s", vw_m_s);
        }
        TunnelSpeed::Operator(o) => {
            t.table("flight.speed.operator");
            if let Some(trim) = o.trim_m_s {
                t.number("trim_m_s", trim);
            }
            t.number("height_gain_per_s", o.height_gain_per_s);
            t.number("rate_gain", o.rate_gain);
            t.number("integral_gain_per_s2", o.integral_gain_per_s2);
            t.number("lag_s", o.lag_s);
            t.number("unsteady_rms_m_s", o.unsteady_rms_m_s);
            t.number("unsteady_time_s", o.unsteady_time_s);
            t.number("hold_x_m", o.hold_x_m);
        }
    }
}

fn scenario_text(file: &ScenarioFile) -> String {
    let mut t = Toml(String::from("# Resolved scenario: every default written out. It flies the same run again, bit for bit.\n"));
    let s = &file.scenario;
    t.raw("seed", &s.seed.to_string());
    t.origin(&s.name, file.note.as_deref(), &file.input, &file.input_hash);
    let first = s.flights.first();
    plant_tables(&mut t, &file.declared_plant, &file.knowledge, first.map(|f| [f.ps_pa, f.ts_k]));
    aero_table(&mut t, &file.declared_plant.aero, &file.declared, file.own_structure);
    for e in &file.effects {
        t.table(&format!("effects.{}", e.family));
        e.values.iter().for_each(|(name, value)| t.number(name, *value));
    }
    if let Some(section) = first.and_then(|f| f.section) {
        t.table("section");
        t.number("radius_m", section.radius_m);
        t.number("top_x_m", section.top_x_m);
        t.number("bottom_x_m", section.bottom_x_m);
    }
    if let Some(f) = first {
        numerics_table(&mut t, &f.numerics);
    }
    s.flights.iter().for_each(|f| flight_table(&mut t, f));
    t.0
}

/// Writes a scenario with every default, the seed, the version and the input's hash, so that reading it gives the same scenario
/// again; a structure of the user's own goes beside it.
///
/// # Errors
/// [`WriteError`] when the system refuses.
pub fn write_resolved_scenario(path: &Path, file: &ScenarioFile) -> Result<(), WriteError> {
    write_own_structure(path, file)?;
    text_atomically(path, &scenario_text(file))
}

/// Writes the campaign that a scenario's flights make: the declared model, not the effects. Starting values are those of the scenario.
///
/// # Errors
/// [`WriteError`] when the system refuses.
pub fn write_campaign_toml(path: &Path, file: &ScenarioFile, runs: &[RunLine]) -> Result<(), WriteError> {
    let mut t = Toml(String::new());
    t.0.push_str("[campaign]\n");
    t.text("name", &file.scenario.name);
    t.text("note", &format!("simulated from {} with seed {}", file.input, file.scenario.seed));
    plant_tables(&mut t, &file.declared_plant, &file.knowledge, None);
    aero_table(&mut t, &file.declared_plant.aero, &file.declared, file.own_structure);
    for run in runs {
        let _ = write!(t.0, "\n[[run]]\n");
        t.text("file", &run.file);
        t.text("kind", &run.kind);
        t.text("use", run.used.name());
        if let Some(window) = run.window_s {
            t.numbers("window_s", &window);
        }
    }
    write_own_structure(path, file)?;
    text_atomically(path, &t.0)
}

fn write_own_structure(beside: &Path, file: &ScenarioFile) -> Result<(), WriteError> {
    if file.own_structure { write_structure_beside(beside, &file.declared_plant.aero.structure) } else { Ok(()) }
}

/// Writes a structure under the name by which `[aero.<name>]` refers to it.
pub(crate) fn write_structure_beside(beside: &Path, structure: &Structure) -> Result<(), WriteError> {
    text_atomically(&beside.with_file_name(structure_name(structure)), &structure_text(structure))
}

fn structure_text(s: &Structure) -> String {
    let mut t = Toml(String::new());
    t.raw("parameters", &format!("[{}]", s.parameters.iter().map(|p| quoted(p)).collect::<Vec<_>>().join(", ")));
    for k in &s.contributions {
        let _ = write!(t.0, "\n[[term]]\n");
        t.text("coefficient", k.coefficient.name());
        t.text("parameter", &s.parameters[k.parameter]);
        t.number("scale", k.term.scale);
        let factors = k.term.factors.iter().map(|f| match f {
            Factor::Power(v, n) => format!("[\"{}\", {n}]", v.name()),
            Factor::SinClock(n) => format!("{{ sin_clock = {n} }}"),
            Factor::CosClock(n) => format!("{{ cos_clock = {n} }}"),
            Factor::Bump(v, w) => format!("{{ bump = \"{}\", width = {} }}", v.name(), digits(*w)),
        });
        t.raw("factors", &format!("[{}]", factors.collect::<Vec<_>>().join(", ")));
    }
    t.0
}

/// Writes a structure file that [`crate::read_structure`] reads back.
///
/// # Errors
/// [`WriteError`] when the system refuses.
pub fn write_structure(path: &Path, structure: &Structure) -> Result<(), WriteError> {
    text_atomically(path, &structure_text(structure))
}
