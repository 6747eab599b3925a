//! scenarios: what differs from one descent to the next. In: open tables of a planet scenario. Out: gusts, scatter of the start, uncertain
//! numbers of the body.

use crate::keys;
use crate::profile::rows;
use crate::table::Table;
use windfall_model::planet::{Dispersions, GustProfile, StartDispersion, VehicleDispersion};
use windfall_model::{Inertia, Turbulence};

/// Columns of a file of gusts.
pub(crate) const TURBULENCE_COLUMNS: [&str; 5] =
    ["height_m", "axial_rms_m_s", "lateral_rms_m_s", "axial_scale_m", "lateral_scale_m"];

/// Reads `[environment] turbulence`, `[uncertainty.vehicle]` and `[uncertainty.initial]`; none where one of them is wrong.
pub(crate) fn dispersions(file: &Table<'_>, environment: &Table<'_>, point: bool) -> Option<Dispersions> {
    let gusts = if environment.has(keys::TURBULENCE_PLANET.name()) { Some(turbulence(environment)?) } else { None };
    let outer = file.table_if(&keys::UNCERTAINTY_PLANET);
    if let Some(table) = outer.as_ref().filter(|_| point) {
        let what = "is about a rigid body, and [aero.point_mass] is none";
        table.source.fault(Some(table.span.clone()), "[uncertainty]", "", what, "remove the table");
    }
    let inner = |spec| outer.as_ref().and_then(|t: &Table<'_>| t.table_if(spec));
    let vehicle = inner(&keys::UNCERTAINTY_VEHICLE_PLANET).map_or_else(VehicleDispersion::default, |t| vehicle(&t));
    let start = inner(&keys::UNCERTAINTY_INITIAL).map_or_else(StartDispersion::default, |t| initial(&t));
    Some(Dispersions { gusts, start, vehicle })
}

fn turbulence(environment: &Table<'_>) -> Option<GustProfile> {
    let t = environment.table(&keys::TURBULENCE_PLANET)?;
    let own = TURBULENCE_COLUMNS[1..].iter().map(|k| (*k, t.number_if(k)));
    let own: Vec<(&str, Option<f64>)> = own.collect();
    let of = |[axial_rms_m_s, lateral_rms_m_s, axial_scale_m, lateral_scale_m]: [f64; 4]| Turbulence {
        axial_rms_m_s,
        lateral_rms_m_s,
        axial_scale_m,
        lateral_scale_m,
        bandwidth: 0.0,
    };
    if t.has("file") {
        if own.iter().any(|(_, x)| x.is_some()) {
            let what = "must be either a file or numbers for all heights";
            t.source.fault(t.at("file"), t.full("file"), "", what, "remove one of them");
        }
        let sound = |[_, a, b, c, d]: [f64; 5]| {
            (a >= 0.0 && b >= 0.0 && c > 0.0 && d > 0.0).then_some(()).ok_or("rms must be zero or more, scales above zero")
        };
        let all = rows(&t, TURBULENCE_COLUMNS, sound)?;
        return GustProfile::new(all.into_iter().map(|[h, a, b, c, d]| (h, of([a, b, c, d]))).collect());
    }
    for (key, _) in own.iter().filter(|(_, x)| x.is_none()) {
        let what = "is missing; turbulence without a file needs it";
        t.source.fault(t.at(key), t.full(key), "", what, format!("{key} = ..."));
    }
    let [a, b, c, d] = [0, 1, 2, 3].map(|k| own[k].1);
    GustProfile::steady(of([a?, b?, c?, d?]))
}

fn numbers_or_zero(t: &Table<'_>, key: &str) -> [f64; 3] {
    if t.has(key) { t.numbers(key) } else { [0.0; 3] }
}

fn vehicle(t: &Table<'_>) -> VehicleDispersion {
    let inertia = t.table_if(&keys::UNCERTAINTY_INERTIA);
    let of = |key: &str| inertia.as_ref().and_then(|i| i.number_if(key)).unwrap_or(0.0);
    VehicleDispersion {
        mass_kg: t.number_if("mass_kg").unwrap_or(0.0),
        inertia: Inertia { xx: of("xx"), yy: of("yy"), zz: of("zz"), xy: of("xy"), xz: of("xz"), yz: of("yz") },
        center_of_mass_m: numbers_or_zero(t, "center_of_mass_m"),
    }
}

fn initial(t: &Table<'_>) -> StartDispersion {
    StartDispersion {
        velocity_ned_m_s: numbers_or_zero(t, "velocity_ned_m_s"),
        attitude_body_rad: numbers_or_zero(t, "attitude_body_deg").map(f64::to_radians),
        rates_rad_s: numbers_or_zero(t, "rates_deg_s").map(f64::to_radians),
    }
}
