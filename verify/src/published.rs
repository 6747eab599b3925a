//! verify: printed numbers. In: the lander of Appendix C. Out: the program's own figures beside them.

use super::flown::{REST, density, flight, truth, without_roll};
use super::{Bound, Check, CheckKind, Setups, first};
use crate::VerifyError;
use windfall_model::frames::{EulerXyz, Vec3};
use windfall_model::{AirState, Coefficient, Flight, Motion, Plant, dynamic_pressure_pa};
use windfall_pid::tether_fit::table_2_3;
use windfall_sim::trim_speed;

/// Thesis Table 2.2, full scale over model: mass (kg) and inertias (kg m²); lengths are four to one.
const TABLE_2_2: [(&str, f64, f64, i32); 4] =
    [("mass", 840.4, 0.7873, 3), ("Ixx", 360.9, 0.02113, 5), ("Iyy", 235.7, 0.01380, 5), ("Izz", 235.6, 0.01379, 5)];

pub(super) fn checks(setups: &Setups<'_>) -> Result<Vec<Check>, VerifyError> {
    let (plant, like) = first(setups.appendix_c)?;
    let mut all = tether();
    all.extend(trim(plant, like));
    all.push(pitch_mode(plant, like));
    all.push(steady_roll(plant, like)?);
    all.push(off_vertical(plant, like)?);
    all.push(density_ratio());
    Ok(all)
}

fn published(id: &str, what: &str, figure: (f64, &str), bound: Bound, source: &str) -> Check {
    Check::new(CheckKind::Published, id, what, figure, bound, source)
}

fn tether() -> Vec<Check> {
    let fit = table_2_3();
    let source = "thesis Table 2.3 with q = ½·0.00229·V²; Table B.1 prints the fit to fewer digits";
    vec![
        published(
            "tether-drag-area",
            "drag area of the tether from its measured pull",
            (fit.drag_area_ft2, "ft2"),
            Bound::around(0.01401, 5e-6),
            source,
        )
        .beside(0.014),
        published(
            "tether-weight",
            "effective weight of the tether from its measured pull",
            (fit.weight_lbf, "lb"),
            Bound::around(0.00369, 5e-6),
            source,
        )
        .beside(0.0037),
    ]
}

fn trim(plant: &Plant, like: &Flight) -> Vec<Check> {
    let rho = density(plant, like);
    let speed = trim_speed(plant, rho);
    let q = dynamic_pressure_pa(rho, speed);
    let source = "(m g + W_tr)/(C_A S + (C_D S)_tr) with Tables 2.2, 5.5 and B.1; 32.5 is cut, not rounded: 7.43 m/s gives 32.57";
    vec![
        published(
            "trim-pressure",
            "dynamic pressure at which drag and tether carry the weight",
            (q, "Pa"),
            Bound::around(32.5, 0.1),
            source,
        ),
        published("trim-speed", "airspeed there", (speed, "m/s"), Bound::around(7.43, 0.005), source),
    ]
}

/// Natural frequency of the static pitch moment about a fixed c.m. at trim speed. The mode that is flown, with lift, damping and
/// tether, is an exact check.
fn pitch_mode(plant: &Plant, like: &Flight) -> Check {
    let mut p = plant.clone();
    p.tether = None;
    let (small, density_kg_m3) = (1e-4, density(&p, like));
    let motion = Motion {
        t_s: 0.0,
        p_tunnel_cm: Vec3::zero(),
        v_tunnel_cm: Vec3::zero(),
        r_tunnel_body: EulerXyz { ry_rad: small, ..EulerXyz::default() }.r_tunnel_body(),
        w_tunnel_body: Vec3::zero(),
        a_tunnel_cm: Vec3::zero(),
        w_tunnel_body_rate: Vec3::zero(),
    };
    let air = AirState { vw_m_s: trim_speed(plant, density_kg_m3), density_kg_m3, ..AirState::default() };
    let stiffness = -p.wrench(&motion, &air).m.y() / small;
    let frequency = (stiffness / p.vehicle.inertia.yy).sqrt() / std::f64::consts::TAU;
    let what = "natural frequency of the static pitch moment at trim speed";
    published(
        "pitch-mode",
        what,
        (frequency, "Hz"),
        Bound::around(0.96, 0.005),
        "√(q S d |C_m,sin|/I_yy)/2π with Tables 2.2 and 5.5",
    )
}

fn steady_roll(plant: &Plant, like: &Flight) -> Result<Check, VerifyError> {
    let order = flight(like, 60.0, trim_speed(plant, density(plant, like)), REST);
    let t = truth(plant, &order)?;
    let rate = t.w_tunnel_body.last().map_or(f64::NAN, |w| w[0].to_degrees());
    let what = "roll rate after a minute in the tunnel";
    Ok(published("steady-roll", what, (rate, "deg/s"), Bound::around(8.8, 0.05), "−(C_l0/C_lp)(2V/d) with Table 5.5"))
}

/// Steady glide under a small constant pitch moment, without tether: the force is vertical, so Θ = (C_Nα/C_A) α_T.
fn off_vertical(plant: &Plant, like: &Flight) -> Result<Check, VerifyError> {
    let mut p = without_roll(plant);
    p.tether = None;
    p.aero.add(Coefficient::Cm, 0.02, 1.0, &[]);
    let t = truth(&p, &flight(like, 60.0, trim_speed(&p, density(&p, like)), REST))?;
    let ratio = match (t.attitude_rad.last(), t.alpha_t_rad.last()) {
        (Some(&[rx_rad, ry_rad, rz_rad]), Some(alpha_t)) => EulerXyz { rx_rad, ry_rad, rz_rad }.off_vertical_rad() / alpha_t,
        _ => f64::NAN,
    };
    let what = "off-vertical angle over total angle of attack in steady glide";
    Ok(published("off-vertical", what, (ratio, "1"), Bound::around(0.53, 0.005), "C_Nα/C_A with Table 5.5"))
}

/// Air density in the tunnel over that at full scale, from each row of Table 2.2.
fn density_ratio() -> Check {
    let ratios: Vec<f64> = TABLE_2_2.iter().map(|(_, full, model, power)| model / full * 4.0_f64.powi(*power)).collect();
    let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
    let what = "density ratio of model to full scale that Froude scaling needs for mass and inertia, mean of four";
    published(
        "froude-density",
        what,
        (mean, "1"),
        Bound::around(0.05996, 5e-5),
        "thesis Table 2.2, mass / L³ and inertia / L⁵, four digits",
    )
}

#[cfg(test)]
mod tests;
