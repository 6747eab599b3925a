//! Campaign folders and answers.json, as any user's.

use crate::craft::{AERO, Craft, GAS, GRAVITY};
use crate::instruments::Row;
use crate::knobs::Knob;
use crate::spec::{Run, Spec};
use serde_json::{Map, Value, json};
use std::fmt::Write as _;
use std::path::Path;

/// Standard uncertainties of a good laboratory: mass and inertia (relative), c.m., ring, attachment (m), angles (deg), speed.
pub(crate) const LABORATORY: Laboratory =
    Laboratory { mass: 0.002, inertia: 0.005, cm: 3e-4, ring: 0.01, hook: 0.002, angle_deg: 0.05, wind: 0.002 };

/// Standard uncertainties.
pub(crate) struct Laboratory {
    pub(crate) mass: f64,
    pub(crate) inertia: f64,
    pub(crate) cm: f64,
    pub(crate) ring: f64,
    pub(crate) hook: f64,
    pub(crate) angle_deg: f64,
    pub(crate) wind: f64,
}

/// Starting values of a campaign file.
const START: [f64; 11] = [6.6, 3.4, -1.5, 0.01, -5.0, -2.0, 2.0, -3.0, -150.0, -3.0, -150.0];

/// Writes a campaign into a folder of its own.
///
/// # Errors
/// Whatever the disk says.
pub(crate) fn campaign(root: &Path, name: &str, spec: &Spec, runs: &[Run]) -> std::io::Result<()> {
    let folder = root.join(name);
    std::fs::create_dir_all(&folder)?;
    for run in runs {
        std::fs::write(
            folder.join(format!("{}.csv", run.plan.name)),
            csv(&run.rows, &spec.craft, spec.knobs.get(Knob::Heating)),
        )?;
    }
    std::fs::write(folder.join("campaign.toml"), toml(name, spec, runs))
}

fn csv(rows: &[Row], craft: &Craft, heating: f64) -> String {
    let mut text = String::from("t_s,X_m,Y_m,Z_m,Rx_deg,Ry_deg,Rz_deg,ps_Pa,VW_m_s,Ts_K\n");
    for [t, x, y, z, a, b, c, v] in rows {
        let (ps, ts) = (craft.pressure, craft.temperature * (1.0 + heating * t / 10.0));
        let _ = writeln!(text, "{t:.6},{x:.5},{y:.5},{z:.5},{a:.4},{b:.4},{c:.4},{ps:.1},{v:.5},{ts:.3}");
    }
    text
}

fn toml(name: &str, spec: &Spec, runs: &[Run]) -> String {
    let d = &spec.declared;
    let [xx, yy, zz] = d.inertia;
    let mut text = format!(
        "[campaign]\nname = \"{name}\"\nnote = \"declared model only; what else acts is not declared\"\n\n\
         [vehicle]\nmass_kg = {:?}\ninertia_kg_m2 = {{ xx = {xx:?}, yy = {yy:?}, zz = {zz:?}, xy = 0.0, xz = 0.0, yz = 0.0 }}\n\
         center_of_mass_m = {:?}\nreference_diameter_m = {:?}\n\n\
         [tether]\nattachment_m = {:?}\nring_m = {:?}\ndrag_area_m2 = {:?}\neffective_weight_n = {:?}\n\n\
         [environment]\ngravity_m_s2 = {GRAVITY:?}\ngas_constant_j_kg_k = {GAS:?}\n\n\
         [sensors]\nposition_std_m = 7.5e-4\nroll_std_deg = 0.0623\npitch_yaw_std_deg = 0.110\nwind_std_m_s = 2.57e-3\n\n",
        d.mass, d.cm, d.diameter, d.hook, d.ring, d.drag_area, d.line_weight
    );
    if spec.uncertain {
        let l = &LABORATORY;
        let [ix, iy, iz] = d.inertia.map(|i| i * l.inertia);
        let _ = write!(
            text,
            "# standard uncertainty (1 sigma) of the declared values\n[uncertainty.vehicle]\nmass_kg = {:?}\n\
             inertia_kg_m2 = {{ xx = {ix:?}, yy = {iy:?}, zz = {iz:?}, xy = 0.0, xz = 0.0, yz = 0.0 }}\n\
             center_of_mass_m = {:?}\n\n[uncertainty.tether]\nattachment_m = {:?}\nring_m = {:?}\n\n\
             [uncertainty.sensors]\npose_misalignment_deg = {:?}\nwind_scale = {:?}\n\n",
            d.mass * l.mass,
            [l.cm; 3],
            [l.hook; 3],
            [l.ring; 3],
            l.angle_deg,
            l.wind
        );
    }
    text.push_str("[aero.axisymmetric]\n# the declared structure; values are starting points only\n");
    for (name, value) in AERO.iter().zip(START) {
        let _ = writeln!(text, "{name} = {value:?}");
    }
    for run in runs {
        let used = if run.plan.hold_out { "hold-out" } else { "identify" };
        let _ = write!(text, "\n[[run]]\nfile = \"{}.csv\"\nkind = \"{}\"\nuse = \"{used}\"\n", run.plan.name, run.plan.kind);
    }
    text
}

fn object<'a>(rows: impl Iterator<Item = (&'a str, f64)>) -> Value {
    Value::Object(rows.map(|(k, v)| (k.to_owned(), json!(v))).collect::<Map<_, _>>())
}

/// The answer of a campaign.
pub(crate) fn answer(name: &str, spec: &Spec) -> Value {
    let (truth, declared) = (spec.craft.numbers(), spec.declared.numbers());
    let differs: Vec<_> = truth.iter().zip(&declared).filter(|(t, d)| (t.1 - d.1).abs() > 0.0).map(|(t, d)| (*t, *d)).collect();
    let shown = truth.iter().filter(|t| spec.other || differs.iter().any(|(d, _)| d.0 == t.0)).copied();
    let family = match spec.families.as_slice() {
        [] => json!("none"),
        [one] => json!(one),
        all => json!(all),
    };
    let mut a = json!({
        "name": name,
        "group": spec.group,
        "what": spec.what,
        "family": family,
        "rivals": spec.rivals,
        "truth": object(shown.chain(spec.knobs.acting())),
        "declared_differs": object(differs.iter().map(|(_, d)| *d)),
        "seed": spec.seed,
        "aero": object(AERO.iter().copied().zip(spec.craft.aero)),
        "trim_speed_m_s": spec.craft.trim(),
        "tags": spec.tags,
    });
    if let Some(g) = spec.gusts {
        a["flow"] = json!({"kind": g.colour.name(), "axial": g.axial, "lateral": g.lateral, "L": g.length});
    }
    let n = &spec.noise;
    if *n != crate::instruments::Noise::default() {
        a["sensor"] = json!({"gain": n.gain, "ar": n.ar, "student": n.heavy, "drop": n.drop, "gaps": n.gaps, "quantum": n.quantum,
            "hum": n.hum, "outliers": n.outliers, "corner_hz": n.corner_hz, "resampled_hz": n.resampled_hz, "wander": n.wander});
    }
    a
}
