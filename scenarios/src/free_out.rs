//! scenarios: scenarios of rigid bodies in free flight and the campaigns that they make, written. In: a checked scenario. Out: text that reads back
//! the same.

use crate::error::WriteError;
use crate::free_scenario::{FreeFile, FreeOrder};
use crate::toml_out::{RunLine, Toml, aero_table, degrees_of, inertia_line, uncertainty_tables, write_structure_beside};
use crate::write::text_atomically;
use std::fmt::Write as _;
use std::path::Path;
use windfall_model::{Plant, Setting};

/// Columns of a record in free flight beside its time, and the words by which the campaign says so.
pub(crate) const QUATERNION: [&str; 4] = ["q_w", "q_x", "q_y", "q_z"];

fn setting(s: Setting, inputs: &[String]) -> String {
    match s {
        Setting::Fixed(x) => format!("{x:?}"),
        Setting::Input(i) => format!("\"{}\"", inputs[i]),
    }
}

fn settings(all: [Setting; 3], inputs: &[String]) -> String {
    format!("[{}]", all.map(|s| setting(s, inputs)).join(", "))
}

/// `{ name = number, ... }` of a flight's inputs.
fn inputs_line(file: &FreeFile, flight: &FreeOrder) -> Option<String> {
    let one = |(name, value): (&String, &f64)| format!("{name} = {value:?}");
    let list: Vec<String> = file.inputs.iter().zip(&flight.inputs).map(one).collect();
    (!list.is_empty()).then(|| format!("{{ {} }}", list.join(", ")))
}

fn body(t: &mut Toml, file: &FreeFile, plant: &Plant) {
    let v = &plant.vehicle;
    t.table("vehicle");
    t.number("mass_kg", v.mass_kg);
    t.raw("inertia_kg_m2", &inertia_line(&v.inertia));
    t.numbers("center_of_mass_m", &v.p_origin_cm.to_array());
    t.number("reference_diameter_m", v.diameter_m);
    if let Some(free) = &plant.free_flight {
        t.table("free_flight");
        t.number("reference_area_m2", free.area_m2);
        t.text("coefficient_axes", if free.wind_axes { "wind" } else { "body" });
        t.text("coefficients", if file.held { "held" } else { "fitted" });
        t.number("buoyancy_kg", free.buoyancy_kg);
        t.numbers("center_of_buoyancy_m", &free.p_origin_buoyancy.to_array());
        t.numbers("rate_damping_n_m_s", &free.rate_damping_n_m_s);
        for part in &free.parts {
            let _ = write!(t, "\n[[part]]\n");
            t.number("mass_kg", part.mass_kg);
            t.raw("place_m", &settings(part.place_m, &file.inputs));
        }
        for thrust in &free.thrusts {
            let _ = write!(t, "\n[[thrust]]\n");
            t.raw("size_n", &setting(thrust.size_n, &file.inputs));
            t.numbers("direction", &thrust.direction.to_array());
            t.raw("place_m", &settings(thrust.place_m, &file.inputs));
        }
    }
    t.table("environment");
    t.number("gravity_m_s2", plant.environment.gravity_m_s2);
    t.number("air_density_kg_m3", plant.point.air_density_kg_m3);
    let s = &plant.sensors;
    t.table("sensors");
    t.number("position_std_m", s.position_std_m);
    t.number("roll_std_deg", degrees_of(s.roll_std_rad));
    t.number("pitch_yaw_std_deg", degrees_of(s.pitch_yaw_std_rad));
    if file.knowledge.exact_noise {
        t.text("noise", "exact");
    }
    uncertainty_tables(t, &plant.aero.structure, &file.knowledge);
    let declared = vec![true; plant.aero.values.len()];
    aero_table(t, &plant.aero, &declared, file.own_structure);
}

/// Writes the scenario with every default, so that reading it gives the same again; a structure of the user's own goes beside it.
///
/// # Errors
/// [`WriteError`] when the system refuses.
pub fn write_resolved_free(path: &Path, file: &FreeFile) -> Result<(), WriteError> {
    let mut t = Toml::new("# Resolved scenario: every default written out. It flies the same runs again, bit for bit.\n");
    t.raw("seed", &file.seed.to_string());
    t.origin(&file.name, file.note.as_deref(), &file.input, &file.input_hash);
    body(&mut t, file, &file.declared_plant);
    for e in &file.effects {
        t.table(&format!("effects.{}", e.family));
        e.values.iter().for_each(|(name, value)| t.number(name, *value));
    }
    for f in &file.flights {
        let _ = write!(t, "\n[[flight]]\n");
        t.text("name", &f.name);
        t.text("kind", &f.kind);
        t.text("use", f.used.name());
        t.number("duration_s", f.duration_s);
        t.number("rate_hz", f.rate_hz);
        t.raw("sensor_noise", if f.sensor_noise { "true" } else { "false" });
        if let Some(line) = inputs_line(file, f) {
            t.raw("inputs", &line);
        }
        t.table("flight.release");
        t.numbers("position_m", &f.start.p_tunnel_origin.to_array());
        t.numbers("velocity_body_m_s", &f.start.v_tunnel_origin.to_array());
        t.numbers("attitude_level_deg", &f.attitude_rad.map(degrees_of));
        t.numbers("rates_deg_s", &f.start.w_tunnel_body.to_array().map(degrees_of));
    }
    structure(path, file)?;
    text_atomically(path, &t.into_text())
}

/// Writes the campaign that the flights make: the declared model, not the effects.
///
/// # Errors
/// [`WriteError`] when the system refuses.
pub fn write_free_campaign(path: &Path, file: &FreeFile, runs: &[RunLine]) -> Result<(), WriteError> {
    let mut t = Toml::new("[campaign]\n");
    t.text("name", &file.name);
    t.text("note", &format!("simulated from {} with seed {}", file.input, file.seed));
    body(&mut t, file, &file.declared_plant);
    t.table("columns.attitude");
    t.raw("quaternion", &format!("[\"{}\"]", QUATERNION.join("\", \"")));
    t.text("scalar", "first");
    t.text("rotates", "body-to-world");
    for (run, f) in runs.iter().zip(&file.flights) {
        let _ = write!(t, "\n[[run]]\n");
        t.text("file", &run.file);
        t.text("kind", &run.kind);
        t.text("use", run.used.name());
        if let Some(line) = inputs_line(file, f) {
            t.raw("inputs", &line);
        }
    }
    structure(path, file)?;
    text_atomically(path, &t.into_text())
}

fn structure(path: &Path, file: &FreeFile) -> Result<(), WriteError> {
    if file.own_structure { write_structure_beside(path, &file.declared_plant.aero.structure) } else { Ok(()) }
}
