//! scenarios: planet scenarios and their truth, written. In: a checked scenario, columns. Out: text with every default, tables beside it.

use crate::columns::write_columns_csv;
use crate::dispersions::TURBULENCE_COLUMNS;
use crate::error::WriteError;
use crate::keys;
use crate::planet::{GRAVITIES, PlanetFile, WIND_COLUMNS};
use crate::profile::ATMOSPHERE_COLUMNS;
use crate::toml_out::{Toml, aero_table, degrees_of, digits, inertia_line, numerics_table, write_structure_beside};
use crate::write::text_atomically;
use std::fmt::Write as _;
use std::path::Path;
use windfall_model::planet::{Atmosphere, Dispersions, Gravity, GustProfile, Planet, PlanetFlight, Winds};

/// Names of tables that are written beside a resolved planet scenario.
const ATMOSPHERE_FILE: &str = "atmosphere.csv";
const WIND_FILE: &str = "wind.csv";
const TURBULENCE_FILE: &str = "turbulence.csv";

/// Columns of a truth over a planet, by groups: names, unit, meaning.
pub(crate) const PLANET_COLUMNS: [(&str, &str, &str); 5] = [
    ("t_s", "s", "time"),
    ("altitude_m, latitude_deg, longitude_deg", "m, deg", "geodetic place of the c.m."),
    ("v_north_m_s, v_east_m_s, v_down_m_s", "m/s", "velocity over the ground"),
    ("roll_deg, pitch_deg, yaw_deg", "deg", "attitude against north, east, down (rigid bodies)"),
    ("p_deg_s, q_deg_s, r_deg_s", "deg/s", "inertial body rates (rigid bodies)"),
];
/// Axes over a planet.
pub(crate) const AXES_OVER_PLANET: [(&str, &str); 1] = [(
    "north, east, down",
    "local to the ellipsoid below the body; velocities are over the ground, wind is where the air goes to",
)];

impl PlanetFile {
    /// Names of the files that [`write_resolved_planet`] writes beside `scenario.toml`, structures aside.
    #[must_use]
    pub fn tables(&self) -> Vec<String> {
        let planet = &self.scenario.planet;
        let air = matches!(planet.atmosphere, Some(Atmosphere::Table(_))).then_some(ATMOSPHERE_FILE);
        let wind = matches!(planet.wind, Winds::Table(_)).then_some(WIND_FILE);
        let gusts = table_of_gusts(&self.scenario.dispersions).map(|_| TURBULENCE_FILE);
        air.into_iter().chain(wind).chain(gusts).map(str::to_owned).collect()
    }
}

/// Writes a planet scenario with every default, the version and the input's hash, so that reading it gives the same scenario again; its
/// tables and a structure of the user's own go beside it.
///
/// # Errors
/// [`WriteError`] when the system refuses.
pub fn write_resolved_planet(path: &Path, file: &PlanetFile) -> Result<(), WriteError> {
    let planet = &file.scenario.planet;
    if let Some(Atmosphere::Table(table)) = &planet.atmosphere {
        let rows: Vec<[f64; 4]> = table.rows().map(|(h, a)| [h, a.pressure_pa, a.temperature_k, a.gas_constant_j_kg_k]).collect();
        write_rows(&path.with_file_name(ATMOSPHERE_FILE), ATMOSPHERE_COLUMNS, &rows)?;
    }
    if let Winds::Table(table) = &planet.wind {
        write_rows(&path.with_file_name(WIND_FILE), WIND_COLUMNS, table.rows())?;
    }
    if let Some(gusts) = table_of_gusts(&file.scenario.dispersions) {
        let row = |(h, t): &(f64, windfall_model::Turbulence)| {
            [*h, t.axial_rms_m_s, t.lateral_rms_m_s, t.axial_scale_m, t.lateral_scale_m]
        };
        let rows: Vec<[f64; 5]> = gusts.rows().iter().map(row).collect();
        write_rows(&path.with_file_name(TURBULENCE_FILE), TURBULENCE_COLUMNS, &rows)?;
    }
    if file.own_structure {
        write_structure_beside(path, &file.scenario.body.aero.structure)?;
    }
    text_atomically(path, &text(file))
}

/// Gusts that are not the same at all heights.
fn table_of_gusts(d: &Dispersions) -> Option<&GustProfile> {
    d.gusts.as_ref().filter(|g| g.rows().len() > 1)
}

fn write_rows<const N: usize>(path: &Path, names: [&str; N], rows: &[[f64; N]]) -> Result<(), WriteError> {
    let columns: [Vec<f64>; N] = std::array::from_fn(|k| rows.iter().map(|r| r[k]).collect());
    let views: Vec<(&str, &[f64])> = names.into_iter().zip(columns.iter().map(Vec::as_slice)).collect();
    write_columns_csv(path, &views)
}

fn text(file: &PlanetFile) -> String {
    let mut t =
        Toml::new("# Resolved planet scenario: every default written out. It flies the same flight again, bit for bit.\n");
    let s = &file.scenario;
    if let Some(seed) = file.seed {
        t.raw("seed", &seed.to_string());
    }
    t.origin(&s.name, file.note.as_deref(), &file.input, &file.input_hash);
    let v = &s.body.vehicle;
    t.table("vehicle");
    t.number("mass_kg", v.mass_kg);
    if v.diameter_m > 0.0 {
        t.number("reference_diameter_m", v.diameter_m);
    }
    t.number("reference_area_m2", s.body.reference.area_m2);
    if !s.body.point {
        t.number("reference_span_m", s.body.reference.span_m);
        t.number("reference_chord_m", s.body.reference.chord_m);
        t.raw("inertia_kg_m2", &inertia_line(&v.inertia));
        t.numbers("center_of_mass_m", &v.p_origin_cm.to_array());
    }
    environment(&mut t, &s.planet);
    dispersions(&mut t, &s.dispersions);
    let declared = vec![true; s.body.aero.values.len()];
    aero_table(&mut t, &s.body.aero, &declared, file.own_structure);
    if let Some(f) = s.flights.first() {
        numerics_table(&mut t, &f.numerics);
    }
    s.flights.iter().for_each(|f| flight(&mut t, f, s.body.point));
    t.into_text()
}

fn environment(t: &mut Toml, p: &Planet) {
    t.table("environment");
    match p.gravity {
        Gravity::Uniform { gravity_m_s2 } => {
            t.text("gravity", GRAVITIES[0]);
            t.number("gravity_m_s2", gravity_m_s2);
        }
        Gravity::Central { mu_m3_s2 } => {
            t.text("gravity", GRAVITIES[1]);
            t.number("mu_m3_s2", mu_m3_s2);
        }
        Gravity::J2 { mu_m3_s2, j2 } => {
            t.text("gravity", GRAVITIES[2]);
            t.number("mu_m3_s2", mu_m3_s2);
            t.number("j2", j2);
        }
    }
    t.number("equatorial_radius_m", p.figure.equatorial_radius_m);
    t.number("flattening", p.figure.flattening);
    t.number("rotation_rad_s", p.rotation_rad_s);
    match &p.atmosphere {
        None => {}
        Some(Atmosphere::Us1976) => t.text("atmosphere", "us-1976"),
        Some(Atmosphere::Venus) => t.text("atmosphere", "venus"),
        Some(Atmosphere::Table(_)) => t.raw("atmosphere", &format!("{{ file = \"{ATMOSPHERE_FILE}\" }}")),
    }
    match &p.wind {
        Winds::Steady { north_m_s, east_m_s } => {
            t.raw("wind", &format!("{{ north_m_s = {}, east_m_s = {} }}", digits(*north_m_s), digits(*east_m_s)));
        }
        Winds::Table(_) => t.raw("wind", &format!("{{ file = \"{WIND_FILE}\" }}")),
    }
}

/// Gusts end the table of the environment; uncertainties have their own.
fn dispersions(t: &mut Toml, d: &Dispersions) {
    if table_of_gusts(d).is_some() {
        t.raw(keys::TURBULENCE_PLANET.name(), &format!("{{ file = \"{TURBULENCE_FILE}\" }}"));
    } else if let Some((_, g)) = d.gusts.as_ref().and_then(|g| g.rows().first()) {
        let numbers = [g.axial_rms_m_s, g.lateral_rms_m_s, g.axial_scale_m, g.lateral_scale_m];
        let pairs = TURBULENCE_COLUMNS[1..].iter().zip(numbers).map(|(key, x)| format!("{key} = {}", digits(x)));
        t.raw(keys::TURBULENCE_PLANET.name(), &format!("{{ {} }}", pairs.collect::<Vec<_>>().join(", ")));
    }
    if !d.vehicle.numbers().is_empty() {
        t.table("uncertainty.vehicle");
        t.number("mass_kg", d.vehicle.mass_kg);
        t.raw("inertia_kg_m2", &inertia_line(&d.vehicle.inertia));
        t.numbers("center_of_mass_m", &d.vehicle.center_of_mass_m);
    }
    if !d.start.is_exact() {
        t.table("uncertainty.initial");
        t.numbers("velocity_ned_m_s", &d.start.velocity_ned_m_s);
        t.numbers("attitude_body_deg", &d.start.attitude_body_rad.map(degrees_of));
        t.numbers("rates_deg_s", &d.start.rates_rad_s.map(degrees_of));
    }
}

fn flight(t: &mut Toml, f: &PlanetFlight, point: bool) {
    let _ = write!(t, "\n[[flight]]\n");
    t.text("name", &f.name);
    t.number("duration_s", f.duration_s);
    t.number("rate_hz", f.rate_hz);
    t.table("flight.initial");
    t.number("latitude_deg", degrees_of(f.start.place.latitude_rad));
    t.number("longitude_deg", degrees_of(f.start.place.longitude_rad));
    t.number("height_m", f.start.place.height_m);
    t.numbers("velocity_ned_m_s", &f.start.v_ground.to_array());
    if !point {
        t.numbers("attitude_ned_deg", &f.start.attitude_rad.map(degrees_of));
        t.numbers("rates_deg_s", &f.start.w_inertial_body.to_array().map(degrees_of));
    }
}
