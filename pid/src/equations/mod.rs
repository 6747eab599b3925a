//! pid: the equations of motion by components and Euler angles (thesis B.5-B.12, B.37-B.66 solved for the rates). In: state, air,
//! parameters. Out: rates of the state, and their derivatives.
//!
//! Written apart from the simulator, which uses quaternions and vectors: a slip in one cannot hide in the other.

/// Three components. A loop around the expression itself: a closure's body is not always compiled into its caller, and then not for
/// the caller's vector unit.
macro_rules! each {
    (|$k:ident| $one:expr) => {{
        let mut all = [Default::default(); 3];
        for ($k, one) in all.iter_mut().enumerate() {
            *one = $one;
        }
        all
    }};
}
pub(crate) use each;

mod local;
mod number;
mod terms;
mod transition;

use crate::PidError;
pub use local::{ADDED, Local, MOTION};
pub use number::{Dual, Scalar};
use terms::Terms;
pub(crate) use transition::{Drive, INPUTS, Segment, Transition, splits};
use windfall_model::{Plant, VARIABLES, Variable};

/// Number of states: c.m. position (m) and Euler angles (rad), then c.m. velocity in tunnel axes (m/s) and body rates (rad/s).
pub const STATES: usize = 12;

/// Velocity squared, m²/s², added to that across the body so that the clock angle has a slope at zero angle: 1e-13 of an
/// airspeed of 7 m/s, and terms that vanish there keep theirs exactly.
const ACROSS_M2_S2: f64 = 1e-24;

/// The air at one instant, as known.
#[derive(Clone, Copy, Debug)]
pub struct TunnelAir {
    /// Time from the run's first sample, s.
    pub t_s: f64,
    /// Density, kg/m³.
    pub density_kg_m3: f64,
    /// Tunnel speed, m/s, upward positive.
    pub vw_m_s: f64,
    /// Its rate, m/s².
    pub vw_rate_m_s2: f64,
}

/// What may come on top: air velocity and its rate (tunnel axes) and increments of the six coefficients. Directions of
/// differentiation, and the way in for gusts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extra<S> {
    pub(crate) velocity: [S; 3],
    pub(crate) acceleration: [S; 3],
    pub(crate) coefficients: [S; 6],
}

impl<S: Scalar> Default for Extra<S> {
    fn default() -> Self {
        let zero = S::real(0.0);
        Self { velocity: [zero; 3], acceleration: [zero; 3], coefficients: [zero; 6] }
    }
}

/// A plant made ready for integration.
#[derive(Clone, Debug)]
pub struct Craft<'a> {
    pub(crate) plant: &'a Plant,
    pub(crate) terms: Terms,
    /// Mass that resists acceleration along each body axis: the vehicle's and that of the air it drags along, kg.
    inert_kg: [f64; 3],
    inertia: [[f64; 3]; 3],
    /// Of inertia with apparent inertia.
    inertia_inverse: [[f64; 3]; 3],
    still: bool,
    /// Rounds in which forces and the accelerations that they depend on are found: one where they do not.
    rounds: usize,
}

/// Rounds for forces that depend on accelerations: each leaves at most the ratio of such a force to inertia, which is 1e-2 for damping
/// forces and under 0.1 for a loose tenth of the mass.
const ROUNDS: usize = 8;

/// Number of states of a loose mass: displacement and rate along body y and z, m and m/s.
pub const LOOSE: usize = 4;

impl<'a> Craft<'a> {
    /// # Errors
    /// [`PidError::NotIntegrable`] for what these equations leave out: apparent and loose mass, forces that depend on
    /// accelerations, delayed or misaligned instruments.
    pub(crate) fn new(plant: &'a Plant) -> Result<Self, PidError> {
        let s = &plant.sensors;
        let left_out = [
            ("apparent mass or a force that depends on accelerations", plant.has_algebraic_loop()),
            ("a loose mass", plant.vehicle.loose.is_some()),
            ("a delayed instrument", s.pose_delay_s != 0.0 || s.wind_delay_s != 0.0),
            ("a misaligned instrument", s.misalignment_rad.iter().any(|a| *a != 0.0)),
        ];
        if let Some((what, _)) = left_out.iter().find(|l| l.1) {
            return Err(PidError::NotIntegrable { what });
        }
        Self::complete(plant)
    }

    /// With everything that a plant can have; the loose mass' states are then the caller's, who also sees to what instruments do.
    ///
    /// # Errors
    /// [`PidError::NotIntegrable`] for an inertia that has no inverse.
    pub fn complete(plant: &'a Plant) -> Result<Self, PidError> {
        let (vehicle, apparent) = (&plant.vehicle, &plant.vehicle.apparent);
        let inertia = vehicle.inertia.matrix();
        let transverse = nalgebra::Matrix3::from_diagonal(&nalgebra::Vector3::new(0.0, 1.0, 1.0)) * apparent.transverse_kg_m2;
        let inverse = (inertia + transverse).try_inverse();
        let inverse = inverse.ok_or(PidError::NotIntegrable { what: "an inertia that has no inverse" })?;
        let rows = |m: nalgebra::Matrix3<f64>| [0, 1, 2].map(|i| [m[(i, 0)], m[(i, 1)], m[(i, 2)]]);
        let terms = Terms::new(&plant.aero);
        let rounds = if terms.late_forces || vehicle.loose.is_some() { ROUNDS } else { 1 };
        Ok(Self {
            plant,
            inert_kg: [apparent.axial_kg, apparent.radial_kg, apparent.radial_kg].map(|a| vehicle.mass_kg + a),
            inertia: rows(inertia),
            inertia_inverse: rows(inverse),
            still: plant.flow == windfall_model::MeanFlow::default(),
            rounds,
            terms,
        })
    }

    /// The plant that these equations are of.
    #[must_use]
    pub fn plant(&self) -> &Plant {
        self.plant
    }

    /// Coefficient and parameter (none of an effect's) of each term, in the order in which values of terms are left.
    #[must_use]
    pub fn acts(&self) -> &[(usize, Option<usize>)] {
        &self.terms.acts
    }

    /// Slopes of the rates of velocity (tunnel axes) and body rates by a force and a moment in body axes.
    pub fn by_wrench(&self, x: &[f64; STATES]) -> [[f64; 6]; 6] {
        let ((sx, cx), (sy, cy), (sz, cz)) = (x[3].sin_cos(), x[4].sin_cos(), x[5].sin_cos());
        let t = matrix(sx, cx, sy, cy, sz, cz);
        let mut gain = [[0.0; 6]; 6];
        for i in 0..3 {
            for k in 0..3 {
                gain[i][k] = t[i][k] / self.inert_kg[k];
                gain[3 + i][3 + k] = self.inertia_inverse[i][k];
            }
        }
        gain
    }

    /// Velocity (m/s) and rate (m/s²) of the air per unit of tunnel speed and of its rate, at a place and velocity: the wind is
    /// linear in both.
    pub(crate) fn wind_per_speed(&self, x: &[f64; STATES]) -> WindShape<f64> {
        let mut shape = self.wind_shape([x[1], x[2]], [x[7], x[8]]);
        if self.plant.flow.steady_at_m_s != 0.0 {
            (shape.along[1], shape.along[2], shape.rate[1], shape.rate[2]) = (0.0, 0.0, 0.0, 0.0);
        }
        shape
    }

    /// Speed to which lateral flow is in proportion, and its rate.
    #[inline(always)]
    fn across(&self, vw: f64, vw_rate: f64) -> (f64, f64) {
        let steady = self.plant.flow.steady_at_m_s;
        if steady == 0.0 { (vw, vw_rate) } else { (steady, 0.0) }
    }

    #[inline(always)]
    fn wind_shape<S: Scalar>(&self, [y, z]: [S; 2], [vy, vz]: [S; 2]) -> WindShape<S> {
        let zero = S::real(0.0);
        if self.still {
            return WindShape { along: [S::real(-1.0), zero, zero], rate: [zero; 3] };
        }
        let f = &self.plant.flow;
        let ([gy, gz], [ay, az], k, s) = (f.gradient_per_m, f.angularity_rad, f.profile_per_m2, f.swirl_rad_per_m);
        WindShape {
            along: [-((y * y + z * z) * k + y * gy + z * gz + 1.0), -(z * s) + ay, y * s + az],
            rate: [-((y * vy + z * vz) * (2.0 * k) + vy * gy + vz * gz), -(vz * s), vy * s],
        }
    }

    /// Rate of the state; parameters as in the structure. `None` where the flow or the Euler angles are not defined. The terms'
    /// values, by which a parameter acts on its coefficient, are left in `term_values`.
    #[inline(always)]
    pub(crate) fn rate<S: Scalar>(
        &self,
        x: &[S; STATES],
        air: TunnelAir,
        extra: &Extra<S>,
        parameters: &[f64],
        term_values: &mut [f64],
    ) -> Option<[S; STATES]> {
        self.motion(x, &[S::real(0.0); LOOSE], air, extra, parameters, term_values).map(|(rate, _)| rate)
    }

    /// [`Craft::rate`] with a loose mass at displacement and rate `[y, z, ẏ, ż]`, and the loose mass' acceleration.
    ///
    /// Long, for it is the equations of motion in the order of the thesis' appendix B, to be read beside it.
    #[inline(always)]
    pub(crate) fn motion<S: Scalar>(
        &self,
        x: &[S; STATES],
        loose: &[S; LOOSE],
        air: TunnelAir,
        extra: &Extra<S>,
        parameters: &[f64],
        term_values: &mut [f64],
    ) -> Option<([S; STATES], [S; 2])> {
        let [px, py, pz, rx, ry, rz, vx, vy, vz, p, q, r] = *x;
        let (v, w) = ([vx, vy, vz], [p, q, r]);
        let ((sx, cx), (sy, cy), (sz, cz)) = (rx.sin_cos(), ry.sin_cos(), rz.sin_cos());
        let t = matrix(sx, cx, sy, cy, sz, cz);
        // Air (B.37-B.41).
        let shape = self.wind_shape([py, pz], [vy, vz]);
        let (vw, vw_rate) = (air.vw_m_s, air.vw_rate_m_s2);
        let across = self.across(vw, vw_rate);
        let steady = each!(|k| shape.along[k] * if k == 0 { vw } else { across.0 });
        let steady_rate = each!(|k| {
            let (u, u_rate) = if k == 0 { (vw, vw_rate) } else { across };
            shape.along[k] * u_rate + shape.rate[k] * u
        });
        let u = transposed(&t, each!(|k| v[k] - (steady[k] + extra.velocity[k])));
        let vehicle = &self.plant.vehicle;
        let mut f = self.flow(u, w, vehicle.diameter_m);
        let speed = f[Variable::Speed as usize];
        if !(speed.value() > 0.0 && ry.value().abs() < std::f64::consts::FRAC_PI_2) {
            return None;
        }
        let q_pa = speed * speed * (0.5 * air.density_kg_m3);
        let mut early = extra.coefficients;
        self.terms.add_early(&f, parameters, &mut early, term_values);
        // Forces without aerodynamics, body axes (B.27-B.36), and those that inertia stands against.
        let qs = q_pa * vehicle.area_m2();
        let qsd = qs * vehicle.diameter_m;
        let (pull, pull_moment) = self.tether(&t, [px, py, pz], v, w, q_pa);
        let (hit, hit_moment) = self.contacts(air.t_s);
        let follows = self.plant.vehicle.apparent.in_gusts;
        let carried = each!(|k| steady_rate[k] + extra.acceleration[k] * follows);
        let apparent = self.apparent(&t, each!(|k| v[k] - steady[k] - extra.velocity[k] * follows), carried, w);
        let gravity = self.plant.environment.gravity_m_s2 * vehicle.mass_kg;
        let momentum = each!(|i| w[0] * self.inertia[i][0] + w[1] * self.inertia[i][1] + w[2] * self.inertia[i][2]);
        let gyroscopic = cross(w, momentum);
        let other = each!(|k| pull[k] + hit[k] + apparent.0[k] + t[0][k] * gravity);
        let other_moment = each!(|k| pull_moment[k] + hit_moment[k] + apparent.1[k] - gyroscopic[k]);
        let accelerations = |aero: &[S; 3], part: &[S; 3]| each!(|k| (aero[k] + other[k] + part[k]) * (1.0 / self.inert_kg[k]));
        // Accelerations, body axes, with the wind-angle rates (B.49-B.50) and a loose mass that depend on them.
        let (turning, blown) = (cross(w, u), transposed(&t, each!(|k| steady_rate[k] + extra.acceleration[k])));
        let zero = S::real(0.0);
        let force = |c: &[S; 6]| [-(qs * c[0]), qs * c[1], -(qs * c[2])];
        let mut c = early;
        let mut part = ([zero; 3], [zero; 3], [zero; 2]);
        let mut aero = force(&c);
        let mut a = accelerations(&aero, &part.0);
        let mut w_rate = [zero; 3];
        for round in 0..self.rounds {
            if round > 0 {
                aero = force(&c);
                a = accelerations(&aero, &part.0);
            }
            if self.terms.needs_rates() {
                damping(&mut f, u, each!(|k| a[k] - blown[k] - turning[k]), w, vehicle.diameter_m);
                c = early;
                self.terms.add_late(&f, parameters, &mut c, term_values);
            }
            // Eqs B.8-B.10 and B.62-B.66.
            let shift = crossed_by(aero, vehicle.p_origin_cm.to_array());
            let m = each!(|k| qsd * c[3 + k] + shift[k] + other_moment[k] + part.1[k]);
            let inverse = &self.inertia_inverse;
            w_rate = each!(|i| m[0] * inverse[i][0] + m[1] * inverse[i][1] + m[2] * inverse[i][2]);
            if self.rounds > 1 {
                part = self.loose(&t, loose, a, w, w_rate);
            }
        }
        // Eq. 3.20 solved for the Euler rates.
        let rx_rate = (p * cz - q * sz) * cy.recip();
        let euler_rate = [rx_rate, p * sz + q * cz, r - sy * rx_rate];
        let [e0, e1, e2] = euler_rate;
        let [w0, w1, w2] = w_rate;
        let a = times(&t, a);
        Some(([vx, vy, vz, e0, e1, e2, a[0], a[1], a[2], w0, w1, w2], part.2))
    }

    /// Reaction of the air that is dragged along, less what the enlarged inertia on the left side carries (Lamb 1932, §124): with `u`
    /// the velocity seen from the steady air, force `M (Ṫᵀ-free rates) − ω × M u` and moment `−ω × J ω − u × M u`, body axes.
    #[inline(always)]
    fn apparent<S: Scalar>(&self, t: &[[S; 3]; 3], v_air: [S; 3], wind_rate: [S; 3], w: [S; 3]) -> ([S; 3], [S; 3]) {
        let k = &self.plant.vehicle.apparent;
        let zero = S::real(0.0);
        if k.is_null() {
            return ([zero; 3], [zero; 3]);
        }
        let mass = [k.axial_kg, k.radial_kg, k.radial_kg];
        let turning_kg_m2 = k.transverse_kg_m2 * (1.0 - k.unturned);
        let u = transposed(t, v_air);
        let carried = transposed(t, wind_rate);
        let (turning, impulse) = (cross(w, u), each!(|i| u[i] * mass[i]));
        let (spun, munk) = (cross(w, impulse), cross(u, impulse));
        let stirred = cross(w, [zero, w[1] * turning_kg_m2, w[2] * turning_kg_m2]);
        (each!(|i| (carried[i] + turning[i]) * mass[i] - spun[i]), each!(|i| -(stirred[i] + munk[i])))
    }

    /// Force and moment of the loose mass about the c.m. beyond those of a fixed part, and its acceleration along y and z
    /// ([`windfall_model::LooseMass`]), at accelerations in body axes.
    #[inline(always)]
    fn loose<S: Scalar>(
        &self,
        t: &[[S; 3]; 3],
        state: &[S; LOOSE],
        a: [S; 3],
        w: [S; 3],
        w_rate: [S; 3],
    ) -> ([S; 3], [S; 3], [S; 2]) {
        let zero = S::real(0.0);
        let Some(part) = &self.plant.vehicle.loose else { return ([zero; 3], [zero; 3], [zero; 2]) };
        let g = self.plant.environment.gravity_m_s2;
        let x = part.x_cm_m;
        // Specific force of the mount at (x, 0, 0).
        let felt = [
            a[0] - t[0][0] * g - (w[1] * w[1] + w[2] * w[2]) * x,
            a[1] - t[0][1] * g + (w_rate[2] + w[0] * w[1]) * x,
            a[2] - t[0][2] * g + (w[0] * w[2] - w_rate[1]) * x,
        ];
        let omega = std::f64::consts::TAU * part.frequency_hz;
        let along = |s: S, rate: S, f: S| -(s * (omega * omega)) - rate * (2.0 * part.damping_ratio * omega) - f;
        // What the body's turning adds at the displaced place.
        let (off, rate) = ([zero, state[0], state[1]], [zero, state[2], state[3]]);
        let (euler, inward, coriolis) = (cross(w_rate, off), cross(w, cross(w, off)), cross(w, rate));
        let carried = each!(|k| (euler[k] + inward[k] + coriolis[k] * 2.0) * part.in_full);
        let acceleration = [along(state[0], state[2], felt[1] + carried[1]), along(state[1], state[3], felt[2] + carried[2])];
        let m = part.mass_kg;
        let force = [-(carried[0] * m), -((acceleration[0] + carried[1]) * m), -((acceleration[1] + carried[2]) * m)];
        let displaced = cross(off, each!(|k| -(felt[k] * m)));
        let lever = cross([S::real(x), off[1] * part.in_full, off[2] * part.in_full], force);
        let moment = each!(|k| displaced[k] + lever[k]);
        (force, moment, acceleration)
    }

    /// The model's table of flow variables without the two that need accelerations.
    #[inline(always)]
    fn flow<S: Scalar>(&self, [u, v, w]: [S; 3], [p, q, r]: [S; 3], diameter_m: f64) -> [S; VARIABLES] {
        let across2 = v * v + w * w + ACROSS_M2_S2;
        let across = across2.sqrt();
        let speed = (u * u + across2).sqrt();
        let per_speed = speed.recip();
        let per_across = across.recip();
        let hat = per_speed * (0.5 * diameter_m);
        let p_hat = p * hat;
        let zero = S::real(0.0);
        let needed = |v: Variable| self.terms.needed[v as usize];
        let if_needed = |variable: Variable, y: S, x: S| if needed(variable) { y.atan2(x) } else { zero };
        let uw = if needed(Variable::Beta) { (u * u + w * w).sqrt() } else { zero };
        [
            across * per_speed,
            u * per_speed,
            v * per_across,
            w * per_across,
            if_needed(Variable::Alpha, w, u),
            if_needed(Variable::Beta, v, uw),
            if_needed(Variable::AlphaT, across, u),
            p_hat,
            q * hat,
            r * hat,
            zero,
            zero,
            speed,
            p_hat.abs(),
        ]
    }

    /// Force and moment of the tether (B.29-B.36).
    #[inline(always)]
    fn tether<S: Scalar>(&self, t: &[[S; 3]; 3], p_cm: [S; 3], v: [S; 3], w: [S; 3], q_pa: S) -> ([S; 3], [S; 3]) {
        let zero = S::real(0.0);
        let Some(tether) = &self.plant.tether else { return ([zero; 3], [zero; 3]) };
        let (hook, cm) = (tether.p_origin_hook.to_array(), self.plant.vehicle.p_origin_cm.to_array());
        let arm: [f64; 3] = each!(|k| hook[k] - cm[k]);
        let ring = tether.ring().to_array();
        let line = transposed(t, each!(|k| -p_cm[k] + ring[k]));
        let line = each!(|k| line[k] + -arm[k]);
        let length = (line[0] * line[0] + line[1] * line[1] + line[2] * line[2]).sqrt();
        let per_length = length.recip();
        let nominal_m = tether.p_tunnel_ring.norm() - tether.p_origin_hook.norm();
        let steady = q_pa * tether.drag_area_m2 + -tether.weight_n;
        let mut pull = steady;
        if tether.length_per_m != 0.0 {
            pull = pull + steady * (length + -nominal_m) * tether.length_per_m;
        }
        if tether.line_rate_n_s_m != 0.0 {
            // The line lengthens as the hook leaves the ring.
            let v_body = transposed(t, v);
            let turned = crossed_by(w, arm);
            let along = |k: usize| line[k] * (v_body[k] + turned[k]);
            // Where the rate would make the line push, it goes slack: max(pull + c rate, min(pull, 0)).
            let with = pull - (along(0) + along(1) + along(2)) * per_length * tether.line_rate_n_s_m;
            let slack = (pull - pull.abs()) * 0.5;
            pull = (with + slack + (with - slack).abs()) * 0.5;
        }
        let size = pull * per_length;
        let force = each!(|k| line[k] * size);
        let moment = crossed_by(force, arm);
        let mut moment = each!(|k| -moment[k]);
        if tether.swivel_n_m != 0.0 {
            moment[0] = moment[0] - (w[0] * (1.0 / tether.swivel_rate_rad_s)).tanh() * tether.swivel_n_m;
        }
        (force, moment)
    }

    fn contacts(&self, t_s: f64) -> ([f64; 3], [f64; 3]) {
        let mut sum = ([0.0; 3], [0.0; 3]);
        for contact in &self.plant.contacts {
            let w = contact.wrench(t_s);
            for k in 0..3 {
                sum.0[k] += w.f.xyz[k];
                sum.1[k] += w.m.xyz[k];
            }
        }
        sum
    }
}

/// Air velocity and its rate, both per unit of tunnel speed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WindShape<S> {
    /// Velocity per speed; also rate per rate of speed.
    pub(crate) along: [S; 3],
    /// Rate per speed, from moving through a flow that varies.
    pub(crate) rate: [S; 3],
}

/// Eqs B.49 and B.50 into the two damping variables.
#[inline(always)]
fn damping<S: Scalar>(f: &mut [S; VARIABLES], [u, v, w]: [S; 3], [ud, vd, wd]: [S; 3], [_, q, r]: [S; 3], diameter_m: f64) {
    let speed = f[Variable::Speed as usize];
    let uw2 = u * u + w * w;
    let per_uw2 = uw2.recip();
    let alpha_rate = (u * wd - ud * w) * per_uw2;
    let along = u * ud + v * vd + w * wd;
    let beta_rate = (vd - v * along * (speed * speed).recip()) * per_uw2.sqrt();
    let hat = speed.recip() * (0.25 * diameter_m);
    f[Variable::PitchDamping as usize] = (q + alpha_rate) * hat;
    f[Variable::YawDamping as usize] = (r - beta_rate) * hat;
}

/// Body-to-tunnel matrix (eq. B.14).
#[inline(always)]
pub(crate) fn matrix<S: Scalar>(sx: S, cx: S, sy: S, cy: S, sz: S, cz: S) -> [[S; 3]; 3] {
    [
        [cz * cy, -(sz * cy), sy],
        [cz * sy * sx + sz * cx, cz * cx - sz * sy * sx, -(cy * sx)],
        [sz * sx - cz * sy * cx, sz * sy * cx + cz * sx, cy * cx],
    ]
}

#[inline(always)]
fn times<S: Scalar>(m: &[[S; 3]; 3], v: [S; 3]) -> [S; 3] {
    each!(|i| m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2])
}
#[inline(always)]
fn transposed<S: Scalar>(m: &[[S; 3]; 3], v: [S; 3]) -> [S; 3] {
    each!(|i| m[0][i] * v[0] + m[1][i] * v[1] + m[2][i] * v[2])
}
#[inline(always)]
fn cross<S: Scalar>(a: [S; 3], b: [S; 3]) -> [S; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
/// `a × b` with a constant `b`.
#[inline(always)]
fn crossed_by<S: Scalar>(a: [S; 3], b: [f64; 3]) -> [S; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Position of the geometric origin, m: what the motion capture reports.
pub fn origin(x: &[f64; STATES], p_origin_cm: [f64; 3]) -> [f64; 3] {
    let arm = turned([x[3], x[4], x[5]], p_origin_cm);
    each!(|i| x[i] - arm[i])
}

/// Its slopes by the Euler angles, row by row; those by the c.m.'s position are ones.
pub(crate) fn origin_slopes(x: &[f64; STATES], p_origin_cm: [f64; 3]) -> [[f64; 3]; 3] {
    if p_origin_cm.iter().all(|r| *r == 0.0) {
        return [[0.0; 3]; 3];
    }
    turned(each!(|k| Dual::<3>::variable(x[3 + k], k)), p_origin_cm).map(|d| d.slopes.map(|s| -s))
}

fn turned<S: Scalar>([rx, ry, rz]: [S; 3], v: [f64; 3]) -> [S; 3] {
    let ((sx, cx), (sy, cy), (sz, cz)) = (rx.sin_cos(), ry.sin_cos(), rz.sin_cos());
    matrix(sx, cx, sy, cy, sz, cz).map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

#[cfg(test)]
pub(crate) mod tests;
