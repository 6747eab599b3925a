//! verify: exact checks. In: the lander of Appendix C, stripped until a closed form exists. Out: distances from it.

use super::flown::{REST, density, flight, largest, truth, without_roll};
use super::{Bound, Check, CheckKind, Setups, first};
use crate::VerifyError;
use nalgebra::{Matrix4, RowVector4, Vector3, Vector4};
use windfall_model::frames::Rotation;
use windfall_model::frames::{Body, Tunnel};
use windfall_model::{Flight, Inertia, Plant, Release};
use windfall_sim::trim_speed;

fn torque_free(plant: &Plant, inertia: Inertia) -> Plant {
    let mut p = plant.clone();
    p.vehicle.inertia = inertia;
    p.tether = None;
    p.aero.values.fill(0.0);
    p.environment.gravity_m_s2 = 0.0;
    p
}

/// Torque-free bodies.
pub(super) fn rigid_body(setups: &Setups<'_>) -> Result<Vec<Check>, VerifyError> {
    let (plant, like) = first(setups.appendix_c)?;
    let mut all = conserved(plant, like)?;
    all.push(symmetric_top(plant, like)?);
    Ok(all)
}

fn conserved(plant: &Plant, like: &Flight) -> Result<Vec<Check>, VerifyError> {
    let inertia = Inertia { xx: 0.021, yy: 0.014, zz: 0.012, xy: 0.001, xz: -0.0005, yz: 0.0003 };
    let release = Release { rates_rad_s: [2.0, 3.0, 1.0], ..REST };
    let t = truth(&torque_free(plant, inertia), &flight(like, 30.0, 0.0, release))?;
    let i = inertia.matrix();
    let w = |k: usize| Vector3::from(t.w_tunnel_body[k]);
    // Twice the energy; what counts is its relative drift.
    let energy = |k: usize| w(k).dot(&(i * w(k)));
    let momentum = |k: usize| {
        let r: Rotation<Tunnel, Body> = Rotation::from_quaternion(t.quaternion[k]);
        r.matrix * (i * w(k))
    };
    let n = t.len();
    let source = "Euler's equations without moment; bound of the issue";
    let drift = largest((0..n).map(|k| energy(k) / energy(0) - 1.0));
    let turn = largest((0..n).map(|k| relative(momentum(k), momentum(0))));
    Ok(vec![
        Check::new(
            CheckKind::Exact,
            "torque-free-energy",
            "energy of a torque-free body, all products of inertia, 30 s: relative drift",
            (drift, "1"),
            Bound::at_most(1e-11),
            source,
        ),
        Check::new(
            CheckKind::Exact,
            "torque-free-momentum",
            "its angular momentum in tunnel axes: relative drift",
            (turn, "1"),
            Bound::at_most(1e-11),
            source,
        ),
    ])
}

fn relative(found: Vector3<f64>, known: Vector3<f64>) -> f64 {
    (found - known).norm() / known.norm()
}

fn symmetric_top(plant: &Plant, like: &Flight) -> Result<Check, VerifyError> {
    let (xx, yy) = (0.021, 0.014);
    let inertia = Inertia { xx, yy, zz: yy, ..Inertia::default() };
    let [p, q, r] = [5.0, 1.0, -0.5];
    let t = truth(&torque_free(plant, inertia), &flight(like, 30.0, 0.0, Release { rates_rad_s: [p, q, r], ..REST }))?;
    // q + i r turns at the rate (I_xx − I_yy)/I_yy · p.
    let rate = (xx - yy) / yy * p;
    let error = largest(t.t_s.iter().zip(&t.w_tunnel_body).flat_map(|(t, w)| {
        let (s, c) = (rate * t).sin_cos();
        [w[0] - p, w[1] - (q * c - r * s), w[2] - (q * s + r * c)]
    }));
    let what = "torque-free symmetric top, 30 s: body rates against the closed form";
    Ok(Check::new(
        CheckKind::Exact,
        "symmetric-top",
        what,
        (error, "rad/s"),
        Bound::at_most(1e-10),
        "Landau and Lifshitz, Mechanics, §36",
    ))
}

/// Closed forms with air.
pub(super) fn air(setups: &Setups<'_>) -> Result<Vec<Check>, VerifyError> {
    let (plant, like) = first(setups.appendix_c)?;
    Ok(vec![drop(plant, like)?, hover(plant, like)?, roll(plant, like)?, pitching(plant, like)?, froude(setups)?])
}

/// Fall through still air at zero angle: `V = V_t tanh(g t/V_t + artanh(V_0/V_t))`.
fn drop(plant: &Plant, like: &Flight) -> Result<Check, VerifyError> {
    let mut p = plant.clone();
    p.tether = None;
    let t = truth(&p, &flight(like, 3.0, 0.0, Release { velocity_m_s: [1.0, 0.0, 0.0], ..REST }))?;
    let terminal = trim_speed(&p, density(&p, like));
    let per_s = p.environment.gravity_m_s2 / terminal;
    let start = (1.0 / terminal).atanh();
    let error = largest(t.t_s.iter().zip(&t.v_tunnel_cm).map(|(t, v)| v[0] - terminal * (per_s * t + start).tanh()));
    let what = "fall through still air with drag, 3 s: speed against the closed form";
    Ok(Check::new(
        CheckKind::Exact,
        "fall-with-drag",
        what,
        (error, "m/s"),
        Bound::at_most(1e-10),
        "m V' = m g − ½ρV²C_A S, integrated",
    ))
}

/// At trim speed nothing moves.
fn hover(plant: &Plant, like: &Flight) -> Result<Check, VerifyError> {
    let trim = trim_speed(plant, density(plant, like));
    let t = truth(plant, &flight(like, 10.0, trim, REST))?;
    let error = largest(t.p_tunnel_cm.iter().flatten().copied());
    let what = "at trim speed, upright on the axis, 10 s: distance moved";
    Ok(Check::new(CheckKind::Exact, "trim-hover", what, (error, "m"), Bound::at_most(1e-11), "drag and tether carry the weight"))
}

/// Roll from rest at zero angle: `p = p_s (1 − exp(−t/τ))`, `τ = −2V I_xx/(q S d² C_lp)`.
fn roll(plant: &Plant, like: &Flight) -> Result<Check, VerifyError> {
    let rho = density(plant, like);
    let trim = trim_speed(plant, rho);
    let t = truth(plant, &flight(like, 20.0, trim, REST))?;
    let v = &plant.vehicle;
    let value = |name| plant.aero.value(name).unwrap_or(0.0);
    let steady = -value("Cl_0") / value("Cl_p") * 2.0 * trim / v.diameter_m;
    let moment = 0.5 * rho * trim * trim * v.area_m2() * v.diameter_m;
    let per_s = -value("Cl_p") * moment * v.diameter_m / (2.0 * trim * v.inertia.xx);
    let error = largest(t.t_s.iter().zip(&t.w_tunnel_body).map(|(t, w)| w[0] - steady * -(-per_s * t).exp_m1()));
    let what = "spin-up by C_l0 against C_lp, 20 s: roll rate against the closed form";
    Ok(Check::new(
        CheckKind::Exact,
        "roll-spin-up",
        what,
        (error, "rad/s"),
        Bound::at_most(1e-11),
        "I_xx p' = q S d (C_l0 + C_lp p d/2V), integrated",
    ))
}

/// Model and full scale: the same flight in units of diameter, √(d g) and √(d/g).
fn froude(setups: &Setups<'_>) -> Result<Check, VerifyError> {
    let mut dimensionless = Vec::new();
    for scenario in [setups.appendix_c, setups.full_scale] {
        let (plant, flight) = first(scenario)?;
        let (d, g) = (plant.vehicle.diameter_m, plant.environment.gravity_m_s2);
        let (speed, time) = ((d * g).sqrt(), (d / g).sqrt());
        let t = truth(plant, flight)?;
        let rows: Vec<[f64; 13]> = (0..t.len())
            .map(|k| {
                let (p, v, q, w) = (t.p_tunnel_cm[k], t.v_tunnel_cm[k], t.quaternion[k], t.w_tunnel_body[k]);
                std::array::from_fn(|c| match c {
                    0..3 => p[c] / d,
                    3..6 => v[c - 3] / speed,
                    6..10 => q[c - 6],
                    _ => w[c - 10] * time,
                })
            })
            .collect();
        dimensionless.push(rows);
    }
    let lengths = dimensionless[0].len().abs_diff(dimensionless[1].len());
    let error = if lengths > 0 {
        f64::INFINITY
    } else {
        let pairs = dimensionless[0].iter().flatten().zip(dimensionless[1].iter().flatten());
        largest(pairs.map(|(a, b)| a - b))
    };
    let what = "the run of Appendix C at model and full scale: largest difference of dimensionless states";
    Ok(Check::new(
        CheckKind::Exact,
        "froude-scaling",
        what,
        (error, "1"),
        Bound::at_most(1e-9),
        "Froude similitude, thesis §2.1.2; bound of the issue",
    ))
}

/// Small pitching at trim speed against the linear equations for (Z, Ż, R_y, q): α = R_y + Ż/V, lift C_N,sin, static and damping
/// moment, tilted drag, and the tether's pull on its hook.
fn pitching(plant: &Plant, like: &Flight) -> Result<Check, VerifyError> {
    let p = without_roll(plant);
    let start = 1e-6;
    let trim = trim_speed(&p, density(&p, like));
    let t = truth(&p, &flight(like, 6.0, trim, Release { attitude_rad: [0.0, start, 0.0], ..REST }))?;
    let a = linear_pitch(&p, density(&p, like), trim);
    let step = (a / like.rate_hz).exp();
    let known = std::iter::successors(Some(Vector4::new(0.0, 0.0, start, 0.0)), |x| Some(step * x)).map(|x| x[3]);
    let flown: Vec<f64> = t.w_tunnel_body.iter().map(|w| w[1]).collect();
    let apart = of_largest(&flown, &known.take(flown.len()).collect::<Vec<f64>>());
    let hertz = a.complex_eigenvalues().iter().map(|e| e.im).fold(0.0, f64::max) / std::f64::consts::TAU;
    let what = format!("small pitching at trim speed, 6 s: pitch rate against linear theory (mode at {hertz:.4} Hz), relative");
    let source = "linear equations of lift, damping and tether about trim, matrix exponential";
    Ok(Check::new(CheckKind::Exact, "pitch-mode-flown", what, (apart, "1"), Bound::at_most(1e-6), source))
}

/// Largest difference over the largest known value.
fn of_largest(found: &[f64], known: &[f64]) -> f64 {
    largest(found.iter().zip(known).map(|(a, b)| a - b)) / largest(known.iter().copied())
}

/// Matrix of the linear pitch plane; c.m. at the origin, hook and ring on the axis.
fn linear_pitch(p: &Plant, rho: f64, speed: f64) -> Matrix4<f64> {
    let v = &p.vehicle;
    let value = |name| p.aero.value(name).unwrap_or(0.0);
    let q_pa = 0.5 * rho * speed * speed;
    let (qs, qsd) = (q_pa * v.area_m2(), q_pa * v.area_m2() * v.diameter_m);
    let (arm, ring, pull) = p.tether.as_ref().map_or((0.0, 1.0, 0.0), |t| {
        let (arm, ring) = (-t.p_origin_hook.x(), -t.p_tunnel_ring.x());
        (arm, ring, t.pull_n(q_pa, ring - arm, 0.0))
    });
    let line = pull / (ring - arm);
    let lift = qs * value("CN_sin");
    // m Z̈, as a row over (Z, Ż, R_y, q).
    let z = RowVector4::new(-line, -lift / speed, qs * value("CA_T0") - lift - line * arm, 0.0) / v.mass_kg;
    let damping = qsd * value("Cm_1") * v.diameter_m / (4.0 * speed);
    let alpha = RowVector4::new(0.0, 1.0 / speed, 1.0, 0.0);
    let turning = RowVector4::new(0.0, 0.0, 0.0, 1.0);
    let hook = RowVector4::new(-line, 0.0, -pull - line * arm, 0.0) * arm;
    let q = (alpha * (qsd * value("Cm_sin")) + (turning * 2.0 + z / speed) * damping + hook) / v.inertia.yy;
    Matrix4::from_rows(&[RowVector4::new(0.0, 1.0, 0.0, 0.0), z, turning, q])
}

#[cfg(test)]
mod tests;
