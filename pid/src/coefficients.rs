//! pid: experimental coefficients (thesis B.1-B.36, B.60-B.66). In: states and a plant. Out: six coefficients at c.m. and origin.

use crate::PidError;
use crate::smooth::Smoothed;
use crate::states::{State, across, add, cross, dot, state_at, states, sub, transposed};
use windfall_model::{FlowState, Inertia, LooseMass, Plant, Tether, VARIABLES};

/// One sample of the regression.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoefficientRow {
    /// Time, s, as in the states.
    pub t_s: f64,
    /// Flow variables, from the states of this room.
    pub flow: FlowState,
    /// Experimental C_A, C_Y, C_N, C_l, C_m, C_n about the c.m.: what is left for the air when gravity, tether and every other
    /// load that the plant names are taken off.
    pub exp_cm: [f64; 6],
    /// The same with moments about the geometric origin, which is where the model is defined.
    pub exp_origin: [f64; 6],
    /// Dynamic pressure, Pa.
    pub q_pa: f64,
}

/// Force (N) and moment about the c.m. (N m), body axes.
#[derive(Clone, Copy, Default)]
struct Load {
    f: [f64; 3],
    m: [f64; 3],
}

/// Coefficients of every sample, so that `exp_origin − plant.aero.coefficients(&flow)` is the residual of that plant.
#[must_use]
pub fn coefficients(states: &[State], plant: &Plant) -> Vec<CoefficientRow> {
    let loose = plant.vehicle.loose.map(|l| loose_loads(states, &l, plant.environment.gravity_m_s2));
    let start_s = states.first().map_or(0.0, |s| s.t_s);
    states.iter().enumerate().map(|(i, s)| row(s, start_s, loose.as_ref().map(|l| l[i]), plant)).collect()
}

/// [`coefficients`] of the states of a smoothed run, which are kept only where a loose part needs those before.
///
/// # Errors
/// As [`states`].
pub(crate) fn coefficients_of(s: &Smoothed, plant: &Plant) -> Result<Vec<CoefficientRow>, PidError> {
    if plant.vehicle.loose.is_some() {
        return Ok(coefficients(&states(s, plant)?, plant));
    }
    let mut rows = Vec::with_capacity(s.t_s.len());
    let mut start_s = 0.0;
    for i in 0..s.t_s.len() {
        let state = state_at(s, plant, i);
        state.checked()?;
        if i == 0 {
            start_s = state.t_s;
        }
        rows.push(row(&state, start_s, None, plant));
    }
    Ok(rows)
}

#[inline]
fn row(s: &State, start_s: f64, loose: Option<Load>, plant: &Plant) -> CoefficientRow {
    let mut known = gravity(s, plant);
    let mut take = |l: Load| known = Load { f: add(known.f, l.f), m: add(known.m, l.m) };
    if let Some(t) = &plant.tether {
        take(tether(s, t, plant));
    }
    take(apparent(s, plant));
    for contact in &plant.contacts {
        let w = contact.wrench(s.t_s - start_s);
        take(Load { f: w.f.to_array(), m: w.m.to_array() });
    }
    if let Some(load) = loose {
        take(load);
    }
    finish(s, &total(s, plant), &known, plant)
}

/// Force and moment that the motion needs (eqs B.5-B.10).
fn total(s: &State, plant: &Plant) -> Load {
    let m = plant.vehicle.mass_kg;
    let ([u, v, w], [u_dot, v_dot, w_dot], [p, q, r]) = (s.uvw, s.uvw_rate, s.pqr);
    let f = [m * (u_dot + q * w - r * v), m * (v_dot + r * u - p * w), m * (w_dot + p * v - q * u)];
    Load { f, m: inertial_moment(&plant.vehicle.inertia, s.pqr, s.pqr_rate) }
}

/// Eqs B.8-B.10.
fn inertial_moment(i: &Inertia, [p, q, r]: [f64; 3], [p_dot, q_dot, r_dot]: [f64; 3]) -> [f64; 3] {
    let Inertia { xx, yy, zz, xy, xz, yz } = *i;
    [
        xx * p_dot - xy * q_dot - xz * r_dot - yz * q * q + yz * r * r - xz * p * q + xy * p * r + (zz - yy) * q * r,
        -xy * p_dot + yy * q_dot - yz * r_dot + xz * p * p - xz * r * r + yz * p * q + (xx - zz) * p * r - xy * q * r,
        -xz * p_dot - yz * q_dot + zz * r_dot - xy * p * p + xy * q * q + (yy - xx) * p * q - yz * p * r + xz * q * r,
    ]
}

/// Weight, body axes (eq. B.12).
fn gravity(s: &State, plant: &Plant) -> Load {
    let mg = plant.vehicle.mass_kg * plant.environment.gravity_m_s2;
    Load { f: transposed(&s.t_bef, [mg, 0.0, 0.0]), m: [0.0; 3] }
}

/// Tether (eqs B.29-B.36, B.30 with the sign of B.31), its size as the plant has it, and its swivel: the roll rate p is opposed by a
/// torque that saturates, `tanh x = (1 − e^(−2x))/(1 + e^(−2x))`.
fn tether(s: &State, tether: &Tether, plant: &Plant) -> Load {
    let t = &s.t_bef;
    let r_to = tether.p_origin_hook.to_array();
    let r_t = sub(r_to, plant.vehicle.p_origin_cm.to_array());
    let r_tr = sub(transposed(t, sub(tether.ring().to_array(), s.p_tunnel_origin)), r_to);
    let length = dot(r_tr, r_tr).sqrt();
    // The hook moves with the origin and turns about it; the line lengthens as the hook leaves the ring.
    let v_hook = add(transposed(t, s.v_tunnel_origin), cross(s.pqr, r_to));
    let pull = tether.pull_n(s.q_pa, length, -dot(r_tr, v_hook) / length);
    let [fx, fy, fz] = r_tr.map(|c| pull * c / length);
    let [x, y, z] = r_t;
    let swivel = if tether.swivel_n_m == 0.0 { 0.0 } else { swivel_torque(tether, s.pqr[0]) };
    Load { f: [fx, fy, fz], m: [y * fz - z * fy + swivel, z * fx - x * fz, x * fy - y * fx] }
}

fn swivel_torque(tether: &Tether, roll_rate: f64) -> f64 {
    let slip = (-2.0 * roll_rate / tether.swivel_rate_rad_s).exp();
    // At a fast negative roll e^(−2x) overflows, and the ratio's limit is −1.
    if slip.is_finite() { -tether.swivel_n_m * (1.0 - slip) / (1.0 + slip) } else { tether.swivel_n_m }
}

/// Reaction of the air that moves with the body (Kirchhoff; Lamb 1932, §124): impulse (m_x u, m_r v, m_r w) and moment of
/// impulse (0, I_r q, I_r r), their rates in turning axes, and the Munk moment of the impulse.
fn apparent(s: &State, plant: &Plant) -> Load {
    let k = &plant.vehicle.apparent;
    let (mx, mr, ir) = (k.axial_kg, k.radial_kg, k.transverse_kg_m2);
    let ([u, v, w], [u_dot, v_dot, w_dot], [p, q, r]) = (s.uvw_air, s.uvw_air_rate, s.pqr);
    let [_, q_dot, r_dot] = s.pqr_rate;
    Load {
        f: [
            -(mx * u_dot + mr * (q * w - r * v)),
            -(mr * v_dot + mx * r * u - mr * p * w),
            -(mr * w_dot + mr * p * v - mx * q * u),
        ],
        m: [0.0, -(ir * q_dot - ir * p * r) - (mx - mr) * u * w, -(ir * r_dot + ir * p * q) + (mx - mr) * u * v],
    }
}

/// What a loose part does along the measured motion. Its oscillator starts at rest; the specific force of its mount, which
/// drives it, is taken as linear between samples, for which the step is exact. To first order in its displacement.
fn loose_loads(states: &[State], loose: &LooseMass, gravity_m_s2: f64) -> Vec<Load> {
    let loose = &LooseMass { in_full: 0.0, ..*loose };
    let turned = windfall_model::frames::Vec3::zero();
    let force = |s: &State| {
        let ([u, v, w], [u_dot, v_dot, w_dot], [p, q, r]) = (s.uvw, s.uvw_rate, s.pqr);
        let g = transposed(&s.t_bef, [gravity_m_s2, 0.0, 0.0]);
        let (x, [_, q_dot, r_dot]) = (loose.x_cm_m, s.pqr_rate);
        // At the mount, x ahead of the c.m.: ω̇ × r + ω × (ω × r) besides.
        [
            u_dot + q * w - r * v - g[0] - x * (q * q + r * r),
            v_dot + r * u - p * w - g[1] + x * (r_dot + p * q),
            w_dot + p * v - q * u - g[2] + x * (p * r - q_dot),
        ]
    };
    let mut xi = [[0.0; 2]; 2];
    let mut before: Option<(f64, [f64; 3])> = None;
    let mut out = Vec::with_capacity(states.len());
    for s in states {
        let now = force(s);
        if let Some((t, was)) = before {
            for (axis, x) in xi.iter_mut().enumerate() {
                *x = oscillate(*x, loose, s.t_s - t, -was[axis + 1], -now[axis + 1]);
            }
        }
        before = Some((s.t_s, now));
        let state = [xi[0][0], xi[1][0], xi[0][1], xi[1][1]];
        let specific = windfall_model::frames::Vec3::from_array(now);
        let wrench = loose.wrench(state, loose.acceleration(state, specific, turned), specific, turned);
        out.push(Load { f: wrench.f.to_array(), m: wrench.m.to_array() });
    }
    out
}

/// One exact step of `ξ̈ + 2ζω ξ̇ + ω² ξ = f`, f linear in time from `f0` to `f1`: particular solution plus free oscillation.
fn oscillate([x, rate]: [f64; 2], loose: &LooseMass, h: f64, f0: f64, f1: f64) -> [f64; 2] {
    let w = std::f64::consts::TAU * loose.frequency_hz;
    let (zeta, w2) = (loose.damping_ratio, w * w);
    let slope = (f1 - f0) / h;
    // ξ_p = a + b t with ω² b = slope, ω² a + 2ζω b = f0.
    let b = slope / w2;
    let a = (f0 - 2.0 * zeta * w * b) / w2;
    let (x0, v0) = (x - a, rate - b);
    let sigma = zeta * w;
    let k = 1.0 - zeta * zeta;
    // cos ω_d h and sin ω_d h / ω_d, or their hyperbolic forms above critical damping.
    let wd = w * k.abs().sqrt();
    let (c, s) = match k {
        k if k > 1.0e-12 => ((wd * h).cos(), (wd * h).sin() / wd),
        k if k < -1.0e-12 => ((wd * h).cosh(), (wd * h).sinh() / wd),
        _ => (1.0, h),
    };
    let decay = (-sigma * h).exp();
    let free = decay * (x0 * c + (v0 + sigma * x0) * s);
    let free_rate = decay * (v0 * c - (sigma * v0 + w2 * x0) * s);
    [a + b * h + free, b + free_rate]
}

/// Coefficients from what is left for the air (eqs B.21-B.26), shifted to the origin (eqs B.64-B.66 the other way).
fn finish(s: &State, needed: &Load, known: &Load, plant: &Plant) -> CoefficientRow {
    let d = plant.vehicle.diameter_m;
    let qs = s.q_pa * plant.vehicle.area_m2();
    let [fx, fy, fz] = sub(needed.f, known.f).map(|f| f / qs);
    let [cl, cm, cn] = sub(needed.m, known.m).map(|m| m / (qs * d));
    let (ca, cy, c_n) = (-fx, fy, -fz);
    let [x, y, z] = plant.vehicle.p_origin_cm.to_array().map(|c| c / d);
    CoefficientRow {
        t_s: s.t_s,
        flow: flow(s, d),
        exp_cm: [ca, cy, c_n, cl, cm, cn],
        exp_origin: [ca, cy, c_n, cl - c_n * y - cy * z, cm + c_n * x - ca * z, cn + cy * x + ca * y],
        q_pa: s.q_pa,
    }
}

/// The model's table of flow variables, from the wind angles of eqs B.45-B.50.
fn flow(s: &State, d: f64) -> FlowState {
    let hat = d / (2.0 * s.speed);
    let ([p, q, r], [u, v, w]) = (s.pqr, s.uvw_air);
    // Of α_T and φ (eqs B.47-B.48); on the axis φ is 0.
    let across = across(v, w);
    let (sin_phi, cos_phi) = if across > 0.0 { (v / across, w / across) } else { (0.0, 1.0) };
    let values: [f64; VARIABLES] = [
        across / s.speed,
        u / s.speed,
        sin_phi,
        cos_phi,
        s.alpha,
        s.beta,
        s.alpha_t,
        p * hat,
        q * hat,
        r * hat,
        0.5 * (q + s.alpha_dot) * hat,
        0.5 * (r - s.beta_dot) * hat,
        s.speed,
        (p * hat).abs(),
    ];
    FlowState { values }
}
