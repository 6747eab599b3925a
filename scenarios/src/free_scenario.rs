//! scenarios: scenarios of rigid bodies in free flight. In: a path or a bundled name. Out: what is flown, or every fault.
//!
//! The tables of the body are those of a campaign ([`crate::read_campaign`]); flights stand in the place of runs.

use crate::error::ReadError;
use crate::free_flight;
use crate::hash::fnv1a;
use crate::keys;
use crate::limits;
use crate::names::name_of_file;
use crate::open::text_of;
use crate::plant::{Declared, read_declared};
use crate::scenario::{DEFAULT_SEED, EffectValues, effect_tables, used};
use crate::table::{Source, Table, number};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use toml::de::DeTable;
use windfall_model::frames::{Body, Ned, Rotation, Vec3, r_ned_tunnel};
use windfall_model::{Acts, FreeState, Knowledge, Plant, Use};

/// One flight of a rigid body in free flight.
#[derive(Clone, Debug, PartialEq)]
pub struct FreeOrder {
    /// Name of the run it makes.
    pub name: String,
    /// Kind of run.
    pub kind: String,
    /// Use in the campaign that is made.
    pub used: Use,
    /// Duration, s.
    pub duration_s: f64,
    /// Sample rate, Hz.
    pub rate_hz: f64,
    /// Whether sensor noise is added to the record.
    pub sensor_noise: bool,
    /// Settings of the run, in the order of [`FreeFile::inputs`].
    pub inputs: Vec<f64>,
    /// Roll, pitch and heading at the first sample from level, rad; heading zero along tunnel Y.
    pub attitude_rad: [f64; 3],
    /// State at the first sample.
    pub start: FreeState,
}

/// A scenario of a rigid body in free flight.
#[derive(Clone, Debug, PartialEq)]
pub struct FreeFile {
    /// Name.
    pub name: String,
    /// The file's note.
    pub note: Option<String>,
    /// Seed of all chance.
    pub seed: u64,
    /// What is flown, effects included.
    pub plant: Plant,
    /// The plant without effects: what the campaign that is made declares.
    pub declared_plant: Plant,
    /// Whether that campaign holds its coefficients.
    pub held: bool,
    /// Uncertainties that it declares.
    pub knowledge: Knowledge,
    /// Names of the runs' inputs, sorted.
    pub inputs: Vec<String>,
    /// Effects in the truth with their values.
    pub effects: Vec<EffectValues>,
    /// Flights, in order.
    pub flights: Vec<FreeOrder>,
    /// Whether the structure is the file's own (and must be written beside a resolved file).
    pub own_structure: bool,
    /// Path or bundled name.
    pub input: String,
    /// FNV-1a hash of the input's bytes, 64 bits in hexadecimal.
    pub input_hash: String,
}

/// True for the text of such a scenario: it has `[free_flight]` and flights.
pub(crate) fn is_free(text: &str) -> bool {
    let (root, _) = DeTable::parse_recoverable(text);
    let root = root.get_ref();
    root.contains_key("free_flight") && root.contains_key("flight") && !root.contains_key("run")
}

/// Reads a scenario of a rigid body in free flight.
///
/// # Errors
/// [`ReadError`] with every fault of the file.
pub fn read_free(path: &Path) -> Result<FreeFile, ReadError> {
    let text = text_of(path)?;
    parsed(&Source::new(path, &text), &text, path.display().to_string())
}

/// The bundled one of that name; `None` where there is none, see [`crate::BUNDLED_FREE`].
///
/// # Errors
/// [`ReadError`] with every fault of the file.
pub fn read_bundled_free(name: &str) -> Result<Option<FreeFile>, ReadError> {
    let Some(text) = crate::bundled::free(name) else { return Ok(None) };
    let path = PathBuf::from(format!("{name}.toml (bundled)"));
    parsed(&Source::bundled(&path, text), text, name.to_owned()).map(Some)
}

fn parsed(source: &Source<'_>, text: &str, input: String) -> Result<FreeFile, ReadError> {
    let root = source.parse()?;
    let file = Table::new(source, "", &root, 0..0, &keys::FREE_FILE);
    let head = file.table(&keys::SCENARIO).map(|t| (t.text("name"), t.text_if("note")));
    let seed = file.integer_if("seed").unwrap_or(DEFAULT_SEED);
    if file.has("provenance") {
        file.table(&keys::PROVENANCE);
    }
    let mut declared = read_declared(&file, false);
    let tables = file.tables(&keys::FLIGHT_FREE);
    let settings: Vec<BTreeMap<String, f64>> = tables.iter().map(settings).collect();
    let inputs: Vec<String> = settings.first().map_or_else(Vec::new, |s| s.keys().cloned().collect());
    for (t, s) in tables.iter().zip(&settings).filter(|(_, s)| !s.keys().eq(inputs.iter())) {
        let found = s.keys().cloned().collect::<Vec<_>>().join(", ");
        source.fault(t.at("inputs"), "[[flight]] inputs", found, "must be those of the first flight", inputs.join(", "));
    }
    if let Some(d) = declared.as_mut() {
        free_flight::parts_and_thrusts(&file, &inputs, &mut d.plant);
    }
    let flights: Vec<FreeOrder> = tables.iter().zip(settings).filter_map(|(t, s)| flight(t, s.into_values().collect())).collect();
    limits::unique_files(source, &flights.iter().map(|f| f.name.as_str()).collect::<Vec<_>>(), &[".csv", "-truth.csv"]);
    limits::of_file(source, "flight", flights.len(), flights.iter().map(|f| f.duration_s * f.rate_hz).sum());
    let effects = effect_tables(&file, Acts::FreeFlight, &inputs, false);
    let built = declared.zip(head).filter(|_| !source.has_faults()).map(|(declared, (name, note))| {
        let Declared { plant: declared_plant, knowledge, structure_file, held, .. } = declared;
        let mut plant = declared_plant.clone();
        for (effect, values) in &effects {
            (effect.apply)(&mut plant, &values.values.iter().map(|v| v.1).collect::<Vec<_>>());
        }
        FreeFile {
            name,
            note,
            seed,
            plant,
            declared_plant,
            held,
            knowledge,
            inputs,
            effects: effects.into_iter().map(|(_, values)| values).collect(),
            flights,
            own_structure: structure_file.is_some(),
            input,
            input_hash: format!("{:016x}", fnv1a(text.as_bytes())),
        }
    });
    source.finish(built)
}

/// Numbers of `inputs = { name = number }`.
fn settings(t: &Table<'_>) -> BTreeMap<String, f64> {
    let mut all = BTreeMap::new();
    let Some(at) = t.has("inputs").then(|| t.value("inputs")).flatten() else { return all };
    for (key, value) in at.get_ref().as_table().into_iter().flatten() {
        let read = number(value).filter(|x| x.is_finite());
        if read.is_none() {
            let (what, remedy) = ("must be a finite number", "{ name = number }");
            t.source.fault(Some(value.span()), t.full("inputs"), t.source.snippet(value.span()), what, remedy);
        }
        all.insert(key.get_ref().to_string(), read.unwrap_or(f64::NAN));
    }
    all
}

fn flight(t: &Table<'_>, inputs: Vec<f64>) -> Option<FreeOrder> {
    let name = t.text("name");
    name_of_file(t, &name);
    let (duration_s, rate_hz) = (t.number("duration_s"), t.number("rate_hz"));
    limits::samples(t, duration_s, rate_hz);
    let release = t.table(&keys::RELEASE_FREE)?;
    let attitude_rad = release.numbers::<3>("attitude_level_deg").map(f64::to_radians);
    let r_tunnel_body = r_ned_tunnel().inverse() * r_ned_body(attitude_rad);
    Some(FreeOrder {
        name,
        kind: t.text("kind"),
        used: used(t),
        duration_s,
        rate_hz,
        sensor_noise: t.bool("sensor_noise"),
        inputs,
        attitude_rad,
        start: FreeState {
            p_tunnel_origin: Vec3::from_array(release.numbers("position_m")),
            attitude: r_tunnel_body.to_quaternion(),
            v_tunnel_origin: Vec3::from_array(release.numbers("velocity_body_m_s")),
            w_tunnel_body: Vec3::from_array(release.numbers::<3>("rates_deg_s").map(f64::to_radians)),
        },
    })
}

/// Level axes (ahead, right, down) from body axes, by roll, pitch and heading.
fn r_ned_body([roll, pitch, heading]: [f64; 3]) -> Rotation<Ned, Body> {
    let ((sr, cr), (sp, cp), (sh, ch)) = (roll.sin_cos(), pitch.sin_cos(), heading.sin_cos());
    Rotation::from_rows([
        [cp * ch, sr * sp * ch - cr * sh, cr * sp * ch + sr * sh],
        [cp * sh, sr * sp * sh + cr * ch, cr * sp * sh - sr * ch],
        [-sp, sr * cp, cr * cp],
    ])
}

#[cfg(test)]
mod tests {
    use super::{r_ned_body, read_bundled_free};

    /// Level is level, nose up lifts the nose, the right wing goes down with roll, heading turns to the right.
    #[test]
    fn exact_attitudes_from_level() {
        let nose = |angles: [f64; 3]| (r_ned_body(angles) * windfall_model::frames::Vec3::new(1.0, 0.0, 0.0)).to_array();
        let wing = |angles: [f64; 3]| (r_ned_body(angles) * windfall_model::frames::Vec3::new(0.0, 1.0, 0.0)).to_array();
        let (s, c) = 0.3_f64.sin_cos();
        for (found, expected) in [
            (nose([0.0, 0.3, 0.0]), [c, 0.0, -s]),
            (nose([0.0, 0.0, 0.3]), [c, s, 0.0]),
            (wing([0.3, 0.0, 0.0]), [0.0, c, s]),
            (wing([0.0, 0.0, 0.3]), [-s, c, 0.0]),
        ] {
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15), "{found:?} {expected:?}");
        }
    }

    #[test]
    fn law_bundled_files_are_well_formed() {
        for name in crate::BUNDLED_FREE {
            let file = read_bundled_free(name).unwrap_or_else(|e| panic!("{name}: {e}")).expect("bundled");
            assert_eq!(file.name, name);
        }
    }
}
