//! scenarios: planet scenarios. In: a path. Out: planet, body and flights, or every fault.

use crate::dispersions::dispersions;
use crate::error::ReadError;
use crate::hash::fnv1a;
use crate::names::name_of_file;
use crate::numerics::numerics;
use crate::open::text_of;
use crate::plant::inertia;
use crate::profile::{atmosphere, rows};
use crate::structure::read_aero;
use crate::table::{Source, Table};
use crate::{keys, limits};
use std::path::{Path, PathBuf};
use toml::de::DeTable;
use windfall_model::frames::Vec3;
use windfall_model::planet::{
    Dispersions, FlightStart, Geodetic, Gravity, Planet, PlanetBody, PlanetFlight, PlanetScenario, Reference, Spheroid,
    WindTable, Winds,
};
use windfall_model::{ApparentMass, Inertia, Numerics, Structure, Vehicle};

/// Columns of a wind file.
pub(crate) const WIND_COLUMNS: [&str; 3] = ["height_m", "north_m_s", "east_m_s"];

/// A planet scenario with what was read beside it.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanetFile {
    /// What is flown.
    pub scenario: PlanetScenario,
    /// The file's note.
    pub note: Option<String>,
    /// The file's seed, for many descents.
    pub seed: Option<u64>,
    /// Whether the aerodynamic structure is the file's own (and must be written beside a resolved file).
    pub own_structure: bool,
    /// Path.
    pub input: String,
    /// FNV-1a hash of the input's bytes, 64 bits in hexadecimal.
    pub input_hash: String,
}

/// True for the text of a planet scenario: one whose `[environment]` has a key that only planets have, or a flight of which starts from
/// `[flight.initial]`.
pub(crate) fn is_planet(text: &str) -> bool {
    let (root, _) = DeTable::parse_recoverable(text);
    let root = root.get_ref();
    // A campaign of bodies without attitude may have an atmosphere, and has runs.
    if root.contains_key("run") {
        return false;
    }
    let environment = root.get("environment").and_then(|v| v.get_ref().as_table());
    let flights = root.get("flight").map(toml::Spanned::get_ref);
    let starts = |v: &toml::de::DeValue<'_>| v.as_table().is_some_and(|t| t.contains_key("initial"));
    environment
        .is_some_and(|t| ["gravity", "mu_m3_s2", "equatorial_radius_m", "atmosphere", "wind"].iter().any(|k| t.contains_key(*k)))
        || flights.is_some_and(|f| starts(f) || f.as_array().is_some_and(|a| a.iter().any(|v| starts(v.get_ref()))))
}

/// Where a tunnel's files are read, a planet scenario is one fault, not one for each of its keys.
pub(crate) fn refuse(source: &Source<'_>, text: &str) -> Result<(), ReadError> {
    if is_planet(text) {
        let what = "is a planet scenario, which is flown and checked only, not identified, studied or closed";
        source.fault(None, "[environment] gravity", "", what, "windfall simulate, or a tunnel scenario");
        return source.finish(None);
    }
    Ok(())
}

/// Reads a planet scenario.
///
/// # Errors
/// [`ReadError`] with every fault of the file and of the tables that it names.
pub fn read_planet(path: &Path) -> Result<PlanetFile, ReadError> {
    let text = text_of(path)?;
    parsed(Source::new(path, &text), &text, path.display().to_string())
}

/// The bundled planet scenario of that name; `None` where there is none, see [`crate::BUNDLED_PLANETS`].
///
/// # Errors
/// [`ReadError`] with every fault of the file.
pub fn read_bundled_planet(name: &str) -> Result<Option<PlanetFile>, ReadError> {
    let Some(text) = crate::bundled::planet(name) else { return Ok(None) };
    let path = PathBuf::from(format!("{name}.toml (bundled)"));
    parsed(Source::bundled(&path, text), text, name.to_owned()).map(Some)
}

fn parsed(source: Source<'_>, text: &str, input: String) -> Result<PlanetFile, ReadError> {
    let root = source.parse()?;
    let file = Table::new(&source, "", &root, 0..0, &keys::PLANET_FILE);
    let head = file.table(&keys::SCENARIO).map(|t| (t.text("name"), t.text_if("note")));
    let seed = file.integer_if("seed");
    if file.has("provenance") {
        file.table(&keys::PROVENANCE);
    }
    if file.has("sensors") {
        file.table(&keys::SENSORS);
    }
    if file.has("tether") {
        source.fault(
            file.at("tether"),
            "[tether]",
            "",
            "bodies fly free over a planet: there is no ring to hang from",
            "remove the table",
        );
    }
    let aero = read_aero(&file, false);
    let point = aero.as_ref().is_some_and(|a| a.aero.structure.name == Structure::point_mass().name);
    let body = body(&file, point);
    let environment = file.table(&keys::ENVIRONMENT_PLANET);
    let planet = environment.as_ref().and_then(planet);
    let dispersions: Option<Dispersions> = environment.as_ref().and_then(|e| dispersions(&file, e, point));
    let numerics = numerics(&file, PlanetFlight::default_numerics());
    let flights: Vec<PlanetFlight> =
        file.one_or_more(&keys::FLIGHT_PLANET).iter().filter_map(|t| flight(t, point, numerics)).collect();
    limits::unique_files(&source, &flights.iter().map(|f| f.name.as_str()).collect::<Vec<_>>(), &["-truth.csv"]);
    limits::of_file(&source, "flight", flights.len(), flights.iter().map(|f| f.duration_s * f.rate_hz).sum());
    let built = (|| {
        let ((name, note), (vehicle, reference), aero) = (head?, body?, aero?);
        let own_structure = aero.structure_file.is_some();
        let body = PlanetBody { vehicle, reference, aero: aero.aero, point };
        let scenario = PlanetScenario { name, planet: planet?, body, flights, dispersions: dispersions? };
        let input_hash = format!("{:016x}", fnv1a(text.as_bytes()));
        Some(PlanetFile { scenario, note, seed, own_structure, input, input_hash })
    })();
    source.finish(built)
}

/// Mass side and reference lengths.
fn body(file: &Table<'_>, point: bool) -> Option<(Vehicle, Reference)> {
    let t = file.table(&keys::VEHICLE_PLANET)?;
    let diameter = t.number_if("reference_diameter_m");
    let of_diameter = diameter.map(Reference::of_diameter);
    let length = |key: &str, of: fn(Reference) -> f64, needed: bool| match (t.number_if(key), of_diameter) {
        (Some(x), _) => x,
        (None, Some(r)) => of(r),
        (None, None) if !needed => 0.0,
        (None, None) => {
            let what = "is missing, and there is no reference_diameter_m to stand for it";
            t.source.fault(t.at(key), t.full(key), "", what, "reference_diameter_m = ...");
            f64::NAN
        }
    };
    let reference = Reference {
        area_m2: length("reference_area_m2", |r| r.area_m2, true),
        span_m: length("reference_span_m", |r| r.span_m, !point),
        chord_m: length("reference_chord_m", |r| r.chord_m, !point),
    };
    let inertia = if point && !t.has("inertia_kg_m2") { Some(Inertia::default()) } else { needed_inertia(&t) };
    let vehicle = Vehicle {
        mass_kg: t.number("mass_kg"),
        inertia: inertia?,
        p_origin_cm: if t.has("center_of_mass_m") { Vec3::from_array(t.numbers("center_of_mass_m")) } else { Vec3::zero() },
        diameter_m: diameter.unwrap_or(0.0),
        apparent: ApparentMass::default(),
        loose: None,
    };
    Some((vehicle, reference))
}

fn needed_inertia(t: &Table<'_>) -> Option<Inertia> {
    if !t.has("inertia_kg_m2") {
        missing(
            t,
            "inertia_kg_m2",
            "a rigid body",
            "inertia_kg_m2 = { xx = ..., yy = ..., zz = ..., xy = 0.0, xz = 0.0, yz = 0.0 }",
        );
        return None;
    }
    inertia(t)
}

/// A key that something else in the file asks for.
fn missing(t: &Table<'_>, key: &str, by: &str, remedy: &str) {
    t.source.fault(t.at(key), t.full(key), "", format!("is missing; {by} needs it"), remedy);
}

fn planet(t: &Table<'_>) -> Option<Planet> {
    let gravity = gravity(t);
    let figure =
        Spheroid { equatorial_radius_m: t.number("equatorial_radius_m"), flattening: t.number_if("flattening").unwrap_or(0.0) };
    let atmosphere = if t.has("atmosphere") { Some(atmosphere(t)) } else { None };
    let wind = if t.has("wind") { wind(t) } else { Some(Winds::STILL) };
    Some(Planet {
        figure,
        rotation_rad_s: t.number_if("rotation_rad_s").unwrap_or(0.0),
        gravity: gravity?,
        atmosphere: atmosphere.map_or(Some(None), |a| a.map(Some))?,
        wind: wind?,
    })
}

/// Words of the kinds of gravity, in the order of the key's choice.
pub(crate) const GRAVITIES: [&str; 3] = ["uniform", "central", "j2"];

fn gravity(t: &Table<'_>) -> Option<Gravity> {
    let kind = t.choice("gravity")?;
    let word = format!("gravity = \"{}\"", GRAVITIES[kind]);
    let needed: &[&str] = [&["gravity_m_s2"][..], &["mu_m3_s2"], &["mu_m3_s2", "j2", "flattening", "rotation_rad_s"]][kind];
    for key in needed.iter().filter(|k| !t.has(k)) {
        missing(t, key, &word, &format!("{key} = ..."));
    }
    let foreign: &[&str] = [&["mu_m3_s2", "j2"][..], &["gravity_m_s2", "j2"], &["gravity_m_s2"]][kind];
    for key in foreign.iter().filter(|k| t.number_if(k).is_some_and(|x| x != 0.0)) {
        t.source.fault(t.at(key), t.full(key), "", format!("has no part in {word}"), "remove it, or choose another gravity");
    }
    let number = |key: &str| t.number_if(key).unwrap_or(f64::NAN);
    Some(match kind {
        0 => Gravity::Uniform { gravity_m_s2: number("gravity_m_s2") },
        1 => Gravity::Central { mu_m3_s2: number("mu_m3_s2") },
        _ => Gravity::J2 { mu_m3_s2: number("mu_m3_s2"), j2: number("j2") },
    })
}

fn wind(t: &Table<'_>) -> Option<Winds> {
    let w = t.table(&keys::WIND_PLANET)?;
    let (north, east) = (w.number_if("north_m_s"), w.number_if("east_m_s"));
    if w.has("file") {
        if north.is_some() || east.is_some() {
            let what = "must be either a file or north_m_s and east_m_s";
            w.source.fault(w.at("file"), w.full("file"), "", what, "remove one of them");
        }
        return WindTable::new(rows(&w, WIND_COLUMNS, |_| Ok(()))?).map(Winds::Table);
    }
    let part = |key: &str, value: Option<f64>| {
        if value.is_none() {
            missing(&w, key, "a wind without a file", &format!("{key} = 0.0"));
        }
        value
    };
    let (north, east) = (part("north_m_s", north), part("east_m_s", east));
    Some(Winds::Steady { north_m_s: north?, east_m_s: east? })
}

fn flight(t: &Table<'_>, point: bool, numerics: Numerics) -> Option<PlanetFlight> {
    let name = t.text_if("name").unwrap_or_else(|| "flight".to_owned());
    name_of_file(t, &name);
    for key in ["kind", "use", "sensor_noise"].into_iter().filter(|k| t.has(k)) {
        match key {
            "kind" => drop(t.text(key)),
            "use" => drop(t.choice(key)),
            _ if t.bool(key) => {
                t.source.fault(
                    t.at(key),
                    t.full(key),
                    "true",
                    "there are no instruments over a planet, only the truth",
                    "sensor_noise = false",
                );
            }
            _ => {}
        }
    }
    let (duration_s, rate_hz) = (t.number("duration_s"), t.number("rate_hz"));
    limits::samples(t, duration_s, rate_hz);
    let start = start(&t.table(&keys::INITIAL)?, point);
    Some(PlanetFlight { name, duration_s, rate_hz, start, numerics })
}

fn start(t: &Table<'_>, point: bool) -> FlightStart {
    let height_m = t.number("height_m");
    if height_m < 0.0 {
        let what = "is below the surface: heights are over the ellipsoid, upward";
        t.source.fault(t.at("height_m"), t.full("height_m"), height_m.to_string(), what, "zero or more, in m");
    }
    let turned = |key: &str| {
        if t.has(key) {
            t.numbers::<3>(key).map(f64::to_radians)
        } else {
            if !point {
                missing(t, key, "a rigid body", &format!("{key} = [0.0, 0.0, 0.0]"));
            }
            [0.0; 3]
        }
    };
    FlightStart {
        place: Geodetic {
            latitude_rad: t.number("latitude_deg").to_radians(),
            longitude_rad: t.number("longitude_deg").to_radians(),
            height_m,
        },
        v_ground: Vec3::from_array(t.numbers("velocity_ned_m_s")),
        attitude_rad: turned("attitude_ned_deg"),
        w_inertial_body: Vec3::from_array(turned("rates_deg_s")),
    }
}
