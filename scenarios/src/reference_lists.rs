//! scenarios: what the key reference says beside tables of keys. In: the catalogue, the flow variables. Out: Markdown of run columns,
//! axes, effects and variables of structures.

use crate::planet_out::{AXES_OVER_PLANET, PLANET_COLUMNS};
use crate::run_columns::{RUN_COLUMNS, Who};
use crate::table::allowed_range;
use std::fmt::Write as _;
use windfall_model::{Acts, CATALOGUE, Effect, Parameter, Role, Variable};

/// Columns of the truth that `windfall simulate` writes beside a record: name, unit, meaning.
pub(crate) const TRUTH_COLUMNS: [(&str, &str, &str); 9] = [
    ("t_s", "s", "time"),
    ("Xcm_m, Ycm_m, Zcm_m", "m", "position of the c.m., tunnel axes"),
    ("vX_m_s, vY_m_s, vZ_m_s", "m/s", "its velocity, tunnel axes"),
    ("p_rad_s, q_rad_s, r_rad_s", "rad/s", "body rates"),
    ("Rx_rad, Ry_rad, Rz_rad", "rad", "Euler angles"),
    ("q_w, q_x, q_y, q_z", "-", "quaternion, body to tunnel"),
    ("VW_m_s", "m/s", "tunnel speed"),
    ("alphaT_rad, Vinf_m_s", "rad, m/s", "total angle of attack and airspeed of the c.m."),
    ("Ftr_N", "N", "pull of the tether"),
];

const AXES: [(&str, &str); 4] = [
    ("tunnel", "X down, Y and Z horizontal, right-handed; origin in the middle of the test section"),
    ("body", "x out of the nose, which points down in flight; y and z across; origin is the geometric origin"),
    (
        "angles",
        "degrees in files where a name ends in `_deg`, radians where it ends in `_rad`; rates p, q, r are about body x, y, z",
    ),
    ("wind", "V_W is upward; a model that floats has V_W past it from below"),
];

/// Everything that is no table of keys.
pub(crate) fn lists(text: &mut String) {
    text.push_str(
        "\n## Run file\n\nCSV or Parquet, one row per sample. A point mass (`[aero.point_mass]`) has `t_s` and any of X_m, Y_m, Z_m, or of fX_m_s2, fY_m_s2, \
         fZ_m_s2 (specific force), or angle_deg (on a pivot). A rigid body in free flight (`[free_flight]`) has `t_s`, X_m, Y_m, Z_m and an attitude.\n",
    );
    text.push_str("\n| column | unit | needed | meaning |\n|---|---|---|---|\n");
    for c in RUN_COLUMNS.iter().filter(|c| c.who != Who::OtherBody) {
        let needed = if c.who == Who::TunnelRun { "yes" } else { "no" };
        let _ = writeln!(text, "| `{}` | {} | {needed} | {} |", c.name, c.quantity.ours().word, c.meaning);
    }
    columns(text, "The truth beside it (`truth.csv`)", &TRUTH_COLUMNS);
    columns(text, "The truth over a planet (`truth.csv`)", &PLANET_COLUMNS);
    text.push_str("\n## Axes\n\n| axes | how they lie |\n|---|---|\n");
    AXES.iter().chain(&AXES_OVER_PLANET).for_each(|(n, m)| text.push_str(&format!("| {n} | {m} |\n")));
    text.push_str(
        "\n## Variables of structure files\n\nFor `factors` of `[[term]]`.\n\n| variable | unit | meaning |\n|---|---|---|\n",
    );
    Variable::ALL.iter().for_each(|v| text.push_str(&format!("| `{}` | {} | {} |\n", v.name(), unit(*v), meaning(*v))));
    text.push_str("\n## Effects\n\nFor `[effects.<family>]`.\n");
    CATALOGUE.iter().for_each(|e| effect(text, e));
}

fn columns(text: &mut String, title: &str, all: &[(&str, &str, &str)]) {
    let _ = write!(text, "\n### {title}\n\n| columns | unit | meaning |\n|---|---|---|\n");
    all.iter().for_each(|(n, u, m)| text.push_str(&format!("| `{}` | {u} | {m} |\n", n.replace(", ", "`, `"))));
}

fn effect(text: &mut String, e: &Effect) {
    let acts = match e.acts {
        Acts::PointMass => " (point mass)",
        Acts::Altimeter => " (point mass with a pressure altimeter)",
        Acts::Pivot => " (point mass on a pivot)",
        Acts::PointOrPivot => " (point mass, free or on a pivot)",
        Acts::FreeFlight => " (rigid body in free flight)",
        Acts::Lander | Acts::Runs | Acts::Attitude | Acts::Any => "",
    };
    let _ = write!(text, "\n### `{}`{acts}\n\n{} Source: {}.\n", e.family, e.physics, e.source);
    text.push_str("\n| parameter | unit | allowed | kind |\n|---|---|---|---|\n");
    // A campaign with inputs of runs has one parameter for each: `<input>` stands for its name.
    (e.parameters)(&["<input>".to_owned()]).iter().for_each(|p| parameter(text, p));
}

fn parameter(text: &mut String, p: &Parameter) {
    let kind = match p.role {
        Role::Strength => "strength",
        Role::Shape(_) => "shape",
        Role::Instant => "instant",
        Role::Run => "number of a run, from 0",
        Role::AeroPlace => "place of a parameter in the aerodynamic structure, from 0",
        Role::Reference => "speed at which strengths are stated; the trim speed where it is 0 or left out",
    };
    let mut range = allowed_range([p.lowest(), p.high], "-").replace("must be a finite number", "finite");
    if p.net.is_some() {
        range += "; not below zero in all";
    }
    let _ = writeln!(text, "| `{}` | {} | {range} | {kind} |", p.name, p.unit);
}

fn unit(v: Variable) -> &'static str {
    match v {
        Variable::Alpha | Variable::Beta | Variable::AlphaT => "rad",
        Variable::Speed => "m/s",
        _ => "-",
    }
}

fn meaning(v: Variable) -> &'static str {
    match v {
        Variable::SinAlphaT => "sine of the total angle of attack",
        Variable::CosAlphaT => "cosine of the total angle of attack",
        Variable::SinPhi => "sine of the clock angle atan2(v, w); 0 without an angle of attack",
        Variable::CosPhi => "cosine of the clock angle; 1 without an angle of attack",
        Variable::Alpha => "angle of attack atan2(w, u)",
        Variable::Beta => "angle of sideslip asin(v/V)",
        Variable::AlphaT => "total angle of attack, 0 to pi",
        Variable::RollRate => "p d/(2V)",
        Variable::PitchRate => "q d/(2V)",
        Variable::YawRate => "r d/(2V)",
        Variable::PitchDamping => "(q + rate of alpha)/2 d/(2V)",
        Variable::YawDamping => "(r - rate of beta)/2 d/(2V)",
        Variable::Speed => "airspeed",
        Variable::RollRateAbs => "size of p d/(2V)",
    }
}
