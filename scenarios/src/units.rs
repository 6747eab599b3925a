//! scenarios: is a run physical? In: raw channels. Out: faults that name the unit which was probably meant.
//!
//! Medians are used, so that spikes and dropouts do not matter here.

use crate::columns::fault;
use crate::error::Fault;
use crate::run_columns::{Who, names_of};
use std::path::Path;
use windfall_model::frames::{Body, EulerXyz, Vec3};
use windfall_model::{FlowState, Plant, Record, Sensors, dynamic_pressure_pa};

/// Median of the finite values; NaN when there are none.
pub(crate) fn median(x: &[f64]) -> f64 {
    let mut finite: Vec<f64> = x.iter().copied().filter(|v| v.is_finite()).collect();
    if finite.is_empty() {
        return f64::NAN;
    }
    let middle = finite.len() / 2;
    *finite.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Robust standard deviation of white noise on a smooth signal, from third differences (weights 1, 3, 3, 1: variance 20 σ²).
fn noise(x: &[f64]) -> f64 {
    let differences: Vec<f64> = x.windows(4).map(|w| (w[3] - 3.0 * w[2] + 3.0 * w[1] - w[0]).abs()).collect();
    1.4826 * median(&differences) / 20.0_f64.sqrt()
}

/// Faults of the raw columns of a tunnel run (m, deg, m/s, Pa, K).
pub(crate) fn faults(path: &Path, channels: &[(&str, Vec<f64>)], sensors: &Sensors) -> Vec<Fault> {
    let column = |name: &str| channels.iter().find(|(n, _)| *n == name).map_or(&[][..], |(_, c)| c.as_slice());
    let mut all = Vec::new();
    let mut say = |key: &str, value: f64, allowed: &str, remedy: &str| {
        all.push(fault(path, None, key, &format!("{value:.6} (median)"), allowed, remedy));
    };
    for (name, c) in channels {
        if !names_of(Who::TunnelRunMay).any(|n| n == *name) && !c.iter().any(|v| v.is_finite()) {
            say(name, f64::NAN, "column holds no number", "export it again");
        }
    }
    let (p, temperature, vw) = (median(column("ps_Pa")), median(column("Ts_K")), median(column("VW_m_s")));
    if temperature <= 100.0 || temperature > 1000.0 {
        say("Ts_K", temperature, "must be from 100 to 1000 K", "kelvin: 273.15 + degrees Celsius");
    }
    let hectopascal = (800.0..1100.0).contains(&p) && temperature > 240.0;
    if p <= 200.0 || p > 1e8 || hectopascal {
        let allowed = "must be from 200 to 1e8 Pa, and not 800 to 1100 Pa at room temperature";
        say("ps_Pa", p, allowed, "pascal: 100 x hPa, 1000 x kPa, 47.88 x lb/ft2, 6894.8 x psi");
    }
    if !(-0.5..=150.0).contains(&vw) && vw.is_finite() {
        say("VW_m_s", vw, "must be from 0 to 150 m/s", "metres per second, upward positive: 0.3048 x ft/s");
    }
    for name in ["X_m", "Y_m", "Z_m"] {
        let x = median(column(name));
        if x.abs() > 1e4 {
            say(name, x, "must be within 1e4 m of the tunnel origin", "metres: 0.001 x mm, 0.3048 x ft");
        }
    }
    all.extend(angle_faults(path, [column("Rx_deg"), column("Ry_deg"), column("Rz_deg")], sensors));
    all
}

/// Angles in radians, by their noise; a model on its back, by the off-vertical angle arccos(cos R_y cos R_z).
fn angle_faults(path: &Path, angles: [&[f64]; 3], sensors: &Sensors) -> Vec<Fault> {
    let mut all = Vec::new();
    let small = angles.iter().all(|a| a.iter().filter(|x| x.is_finite()).all(|x| x.abs() <= 3.2));
    let declared = sensors.pitch_yaw_std_rad;
    let radians = |a: &[f64]| {
        let n = noise(a);
        n > 0.3 * declared && n < 3.0 * declared
    };
    if small && declared > 0.0 && radians(angles[1]) && radians(angles[2]) {
        let what = format!(
            "noise of R_y and R_z is {:.5} and {:.5}: the declared {:.4} deg in radians, and no angle exceeds 3.2",
            noise(angles[1]),
            noise(angles[2]),
            declared.to_degrees()
        );
        all.push(fault(path, None, "Rx_deg, Ry_deg, Rz_deg", "", &what, "degrees: 57.29578 x radians"));
    }
    let tilt_deg = |(y, z): (&f64, &f64)| {
        EulerXyz { ry_rad: y.to_radians(), rz_rad: z.to_radians(), ..EulerXyz::default() }.off_vertical_rad().to_degrees()
    };
    let tilt: Vec<f64> = angles[1].iter().zip(angles[2]).map(tilt_deg).collect();
    let middle = median(&tilt);
    if middle > 90.0 {
        let what = format!("the nose is {middle:.1} deg off the downward vertical in most samples");
        all.push(fault(
            path,
            None,
            "Ry_deg, Rz_deg",
            "",
            &what,
            "x-y-z Euler angles in degrees, T = Rx Ry Rz; or `rotates` in [columns.attitude] the other way; or, where their x is up, [columns.axes] tunnel = [\"-x\", \"y\", \"-z\"], and where it \
             is out of the tail, body = [\"-x\", \"y\", \"-z\"]",
        ));
    }
    all
}

/// Names of what a record needs a second look for, when no fault: angles that are suspiciously small.
pub(crate) fn warnings(record: &Record) -> Vec<String> {
    let largest = record.attitude_rad.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs())).to_degrees();
    if largest <= 3.2 && largest > 0.0 {
        vec![format!("no angle exceeds {largest:.2} deg; if the columns are in radians, multiply them by 57.29578")]
    } else {
        Vec::new()
    }
}

/// A factor this near, in its logarithm, is taken for a slip of units.
const NEAR: f64 = 0.08;
/// Airspeed below which no coefficient can be determined, m/s.
const STILL_M_S: f64 = 0.5;

/// Faults of a record against physics: air that moves past the model, q_W against ½ρV², and drag against weight for a run that stays in
/// the tunnel.
pub(crate) fn physics_faults(path: &Path, record: &Record, plant: &Plant) -> Vec<Fault> {
    let mut all = Vec::new();
    let v = median(&record.vw_m_s);
    if let Some(fault) = still(path, record) {
        return vec![fault];
    }
    let density = plant.environment.density_kg_m3(median(&record.ps_pa), median(&record.ts_k));
    let q = dynamic_pressure_pa(density, v);
    if let Some(qw) = record.qw_pa.as_ref().map(|q| median(q)).filter(|_| v > 0.5) {
        let ratio = qw / q;
        if !(0.75..=1.33).contains(&ratio) {
            let what = format!(
                "q_W = {qw:.4} Pa and ½ρV² = {q:.4} Pa (density {density:.4} kg/m3, V_W {v:.3} m/s) disagree by a factor {ratio:.4}"
            );
            all.push(fault(path, None, "qW_Pa, VW_m_s, ps_Pa, Ts_K", "", &what, &unit_of(ratio, &OF_PRESSURE)));
            return all;
        }
    }
    if plant.tether.is_some() && v > 0.5 && record.duration_s() > 1.0 {
        let flow = FlowState::new(Vec3::<Body>::new(v, 0.0, 0.0), Vec3::zero(), Vec3::zero(), plant.vehicle.diameter_m);
        let area =
            plant.vehicle.area_m2() * plant.aero.coefficients(&flow)[0] + plant.tether.as_ref().map_or(0.0, |t| t.drag_area_m2);
        let weight = plant.vehicle.mass_kg * plant.environment.gravity_m_s2 + plant.tether.as_ref().map_or(0.0, |t| t.weight_n);
        let ratio = q * area / weight;
        if area > 0.0 && !(0.35..=2.9).contains(&ratio) {
            let what = format!(
                "V_W {v:.3} m/s at density {density:.4} kg/m3 gives {ratio:.3} times the weight in drag; a model that floats needs about 1"
            );
            let of_weight = if (1e4..1e6).contains(&median(&record.ps_pa)) { &OF_MASS[..] } else { &OF_PRESSURE[..] };
            let key = "VW_m_s, [vehicle] mass_kg";
            all.push(fault(path, None, key, "", &what, &unit_of(1.0 / ratio, of_weight)));
        }
    }
    all
}

/// A run without any flow past the model: no wind, and the model does not sink or climb through still air either.
fn still(path: &Path, record: &Record) -> Option<Fault> {
    let interval_s = record.interval_s();
    let past = record.vw_m_s.iter().zip(slopes(&record.position_m[0], interval_s)).map(|(v, sink)| (v + sink).abs());
    let middle = median(&past.collect::<Vec<f64>>());
    if !middle.is_finite() || middle >= STILL_M_S {
        return None;
    }
    let what = format!(
        "air passes the model at {middle:.4} m/s (median of V_W and the sinking rate of X_m); no force or moment can be determined below \
         {STILL_M_S} m/s"
    );
    Some(fault(
        path,
        None,
        "VW_m_s",
        &format!("{:.6} (median)", median(&record.vw_m_s)),
        &what,
        "the column of the tunnel speed, in m/s",
    ))
}

/// Rate of a channel over half a second on each side, or as far as it reaches.
fn slopes(x: &[f64], interval_s: f64) -> impl Iterator<Item = f64> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a positive count of samples in half a second")]
    let reach = (0.5 / interval_s).ceil().clamp(1.0, 1e6) as usize;
    (0..x.len()).map(move |i| {
        let (a, b) = (i.saturating_sub(reach), (i + reach).min(x.len() - 1));
        if b > a { (x[b] - x[a]) / ((b - a) as f64 * interval_s) } else { 0.0 }
    })
}

/// Factors of expected over computed dynamic pressure, and the slip that each points to.
type Slips = [(f64, &'static str)];
const FT_S: (f64, &str) = (0.3048 * 0.3048, "V_W looks like ft/s: multiply by 0.3048");
const KNOTS: (f64, &str) = (0.514_444 * 0.514_444, "V_W looks like knots: multiply by 0.514444");
const KM_H: (f64, &str) = (0.277_778 * 0.277_778, "V_W looks like km/h: multiply by 0.277778");
const MPH: (f64, &str) = (0.447_04 * 0.447_04, "V_W looks like mph: multiply by 0.44704");
const OF_PRESSURE: [(f64, &str); 8] = [
    FT_S,
    KNOTS,
    KM_H,
    MPH,
    (100.0, "ps_Pa looks like hPa: multiply by 100"),
    (1000.0, "ps_Pa looks like kPa: multiply by 1000"),
    (47.88, "ps_Pa looks like lb/ft2: multiply by 47.88"),
    (1.0 / 47.88, "qW_Pa looks like lb/ft2: multiply by 47.88"),
];
/// Where the static pressure is one of a wind tunnel, a weight that is off by a factor is the mass'.
const OF_MASS: [(f64, &str); 8] = [
    FT_S,
    KNOTS,
    KM_H,
    MPH,
    (1000.0, "mass_kg looks like g: multiply by 0.001"),
    (1.0 / 0.453_592_37, "mass_kg looks like lb: multiply by 0.45359237"),
    (1.0 / 14.593_903, "mass_kg looks like slug: multiply by 14.593903"),
    (0.001, "mass_kg looks like t: multiply by 1000"),
];

/// The slip that a factor points to.
fn unit_of(ratio: f64, known: &Slips) -> String {
    let near = known.iter().filter(|(f, _)| (ratio / f).ln().abs() < NEAR).map(|(_, words)| *words).next();
    near.unwrap_or("check the units of V_W (m/s), p_s (Pa), T_s (K), q_W (Pa), and mass and C_A of the campaign").to_owned()
}
