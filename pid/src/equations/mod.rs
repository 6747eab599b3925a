//! pid: the equations of motion by components and Euler angles (thesis B.5-B.12, B.37-B.66 solved for the rates). In: state, air,
//! parameters. Out: rates of the state, and their derivatives.
//!
//! Written apart from the simulator, which uses quaternions and vectors: a slip in one cannot hide in the other.

mod number;
mod terms;
mod transition;

use crate::PidError;
pub(crate) use number::{Dual, Number};
use terms::Terms;
pub(crate) use transition::{Drive, INPUTS, Segment, Transition};
use windfall_model::{Plant, VARIABLES, Variable};

/// Number of states: c.m. position (m) and Euler angles (rad), then c.m. velocity in tunnel axes (m/s) and body rates (rad/s).
pub(crate) const STATES: usize = 12;

/// Velocity squared, m²/s², added to that across the body so that the clock angle has a slope at zero angle: 1e-13 of an
/// airspeed of 7 m/s, and terms that vanish there keep theirs exactly.
const ACROSS_M2_S2: f64 = 1e-24;

/// The air at one instant, as known.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Air {
    pub(crate) t_s: f64,
    pub(crate) density_kg_m3: f64,
    pub(crate) vw_m_s: f64,
    pub(crate) vw_rate_m_s2: f64,
}

/// What may come on top: air velocity and its rate (tunnel axes) and increments of the six coefficients. Directions of
/// differentiation, and the way in for gusts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extra<S> {
    pub(crate) velocity: [S; 3],
    pub(crate) acceleration: [S; 3],
    pub(crate) coefficients: [S; 6],
}

impl<S: Number> Default for Extra<S> {
    fn default() -> Self {
        let zero = S::real(0.0);
        Self { velocity: [zero; 3], acceleration: [zero; 3], coefficients: [zero; 6] }
    }
}

/// A plant made ready for integration.
#[derive(Clone, Debug)]
pub(crate) struct Craft<'a> {
    pub(crate) plant: &'a Plant,
    pub(crate) terms: Terms,
    inertia: [[f64; 3]; 3],
    inertia_inverse: [[f64; 3]; 3],
    still: bool,
}

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
        let inertia = plant.vehicle.inertia.matrix();
        let inverse = inertia.try_inverse().ok_or(PidError::NotIntegrable { what: "an inertia that has no inverse" })?;
        let rows = |m: nalgebra::Matrix3<f64>| [0, 1, 2].map(|i| [m[(i, 0)], m[(i, 1)], m[(i, 2)]]);
        Ok(Self {
            plant,
            terms: Terms::new(&plant.aero),
            inertia: rows(inertia),
            inertia_inverse: rows(inverse),
            still: plant.flow == windfall_model::MeanFlow::default(),
        })
    }

    /// Velocity (m/s) and rate (m/s²) of the air per unit of tunnel speed and of its rate, at a place and velocity: the wind is
    /// linear in both.
    pub(crate) fn wind_per_speed(&self, x: &[f64; STATES]) -> WindShape<f64> {
        self.wind_shape([x[1], x[2]], [x[7], x[8]])
    }

    #[inline(always)]
    fn wind_shape<S: Number>(&self, [y, z]: [S; 2], [vy, vz]: [S; 2]) -> WindShape<S> {
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
    pub(crate) fn rate<S: Number>(
        &self,
        x: &[S; STATES],
        air: Air,
        extra: &Extra<S>,
        parameters: &[f64],
        term_values: &mut [f64],
    ) -> Option<[S; STATES]> {
        let [px, py, pz, rx, ry, rz, vx, vy, vz, p, q, r] = *x;
        let (v, w) = ([vx, vy, vz], [p, q, r]);
        let ((sx, cx), (sy, cy), (sz, cz)) = (rx.sin_cos(), ry.sin_cos(), rz.sin_cos());
        let t = matrix(sx, cx, sy, cy, sz, cz);
        // Air (B.37-B.41).
        let shape = self.wind_shape([py, pz], [vy, vz]);
        let (vw, vw_rate) = (air.vw_m_s, air.vw_rate_m_s2);
        let wind = each(|k| shape.along[k] * vw + extra.velocity[k]);
        let wind_rate = each(|k| shape.along[k] * vw_rate + shape.rate[k] * vw + extra.acceleration[k]);
        let u = transposed(&t, each(|k| v[k] - wind[k]));
        let vehicle = &self.plant.vehicle;
        let mut f = self.flow(u, w, vehicle.diameter_m);
        let speed = f[Variable::Speed as usize];
        if !(speed.value() > 0.0 && ry.value().abs() < std::f64::consts::FRAC_PI_2) {
            return None;
        }
        let q_pa = speed * speed * (0.5 * air.density_kg_m3);
        let mut c = extra.coefficients;
        self.terms.add_early(&f, parameters, &mut c, term_values);
        // Forces, body axes (B.11-B.36).
        let qs = q_pa * vehicle.area_m2();
        let aero = [-(qs * c[0]), qs * c[1], -(qs * c[2])];
        let (pull, pull_moment) = self.tether(&t, [px, py, pz], v, w, q_pa);
        let (hit, hit_moment) = self.contacts(air.t_s);
        let force = each(|k| aero[k] + pull[k] + hit[k]);
        let mut a = times(&t, each(|k| force[k] * (1.0 / vehicle.mass_kg)));
        a[0] = a[0] + self.plant.environment.gravity_m_s2;
        // Moments, the wind-angle rates now known (B.49-B.50, B.8-B.10 and B.62-B.66).
        if self.terms.needs_rates() {
            let turning = cross(w, u);
            let inertial = transposed(&t, each(|k| a[k] - wind_rate[k]));
            damping(&mut f, u, each(|k| inertial[k] - turning[k]), w, vehicle.diameter_m);
            self.terms.add_late(&f, parameters, &mut c, term_values);
        }
        let qsd = qs * vehicle.diameter_m;
        let shift = crossed_by(aero, vehicle.p_origin_cm.to_array());
        let momentum = each(|i| w[0] * self.inertia[i][0] + w[1] * self.inertia[i][1] + w[2] * self.inertia[i][2]);
        let gyroscopic = cross(w, momentum);
        let m = each(|k| qsd * c[3 + k] + shift[k] + pull_moment[k] + hit_moment[k] - gyroscopic[k]);
        let inverse = &self.inertia_inverse;
        let w_rate = each(|i| m[0] * inverse[i][0] + m[1] * inverse[i][1] + m[2] * inverse[i][2]);
        // Eq. 3.20 solved for the Euler rates.
        let rx_rate = (p * cz - q * sz) * cy.recip();
        let euler_rate = [rx_rate, p * sz + q * cz, r - sy * rx_rate];
        let [e0, e1, e2] = euler_rate;
        let [w0, w1, w2] = w_rate;
        Some([vx, vy, vz, e0, e1, e2, a[0], a[1], a[2], w0, w1, w2])
    }

    /// The model's table of flow variables without the two that need accelerations.
    #[inline(always)]
    fn flow<S: Number>(&self, [u, v, w]: [S; 3], [p, q, r]: [S; 3], diameter_m: f64) -> [S; VARIABLES] {
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
    fn tether<S: Number>(&self, t: &[[S; 3]; 3], p_cm: [S; 3], v: [S; 3], w: [S; 3], q_pa: S) -> ([S; 3], [S; 3]) {
        let zero = S::real(0.0);
        let Some(tether) = &self.plant.tether else { return ([zero; 3], [zero; 3]) };
        let (hook, cm) = (tether.p_origin_hook.to_array(), self.plant.vehicle.p_origin_cm.to_array());
        let arm: [f64; 3] = each(|k| hook[k] - cm[k]);
        let ring = tether.ring().to_array();
        let line = transposed(t, each(|k| -p_cm[k] + ring[k]));
        let line = each(|k| line[k] + -arm[k]);
        let length = (line[0] * line[0] + line[1] * line[1] + line[2] * line[2]).sqrt();
        let per_length = length.recip();
        let nominal_m = tether.p_tunnel_ring.norm() - tether.p_origin_hook.norm();
        let steady = q_pa * tether.drag_area_m2 + -tether.weight_n;
        let mut pull = steady * (1.0 + tether.pull_excess);
        if tether.length_per_m != 0.0 {
            pull = pull + steady * (length + -nominal_m) * tether.length_per_m;
        }
        if tether.line_rate_n_s_m != 0.0 {
            // The line lengthens as the hook leaves the ring.
            let v_body = transposed(t, v);
            let turned = crossed_by(w, arm);
            let along = |k: usize| line[k] * (v_body[k] + turned[k]);
            pull = pull - (along(0) + along(1) + along(2)) * per_length * tether.line_rate_n_s_m;
        }
        let size = pull * per_length;
        let force = each(|k| line[k] * size);
        let moment = crossed_by(force, arm);
        (force, each(|k| -moment[k]))
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

/// Three components. A loop around one call: the compiler inlines that, and not three calls or those of the standard library.
#[inline(always)]
pub(crate) fn each<S: Copy + Default>(mut f: impl FnMut(usize) -> S) -> [S; 3] {
    let mut all = [S::default(); 3];
    for (k, one) in all.iter_mut().enumerate() {
        *one = f(k);
    }
    all
}

/// Eqs B.49 and B.50 into the two damping variables.
#[inline(always)]
fn damping<S: Number>(f: &mut [S; VARIABLES], [u, v, w]: [S; 3], [ud, vd, wd]: [S; 3], [_, q, r]: [S; 3], diameter_m: f64) {
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
pub(crate) fn matrix<S: Number>(sx: S, cx: S, sy: S, cy: S, sz: S, cz: S) -> [[S; 3]; 3] {
    [
        [cz * cy, -(sz * cy), sy],
        [cz * sy * sx + sz * cx, cz * cx - sz * sy * sx, -(cy * sx)],
        [sz * sx - cz * sy * cx, sz * sy * cx + cz * sx, cy * cx],
    ]
}

#[inline(always)]
fn times<S: Number>(m: &[[S; 3]; 3], v: [S; 3]) -> [S; 3] {
    each(|i| m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2])
}
#[inline(always)]
fn transposed<S: Number>(m: &[[S; 3]; 3], v: [S; 3]) -> [S; 3] {
    each(|i| m[0][i] * v[0] + m[1][i] * v[1] + m[2][i] * v[2])
}
#[inline(always)]
fn cross<S: Number>(a: [S; 3], b: [S; 3]) -> [S; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
/// `a × b` with a constant `b`.
#[inline(always)]
fn crossed_by<S: Number>(a: [S; 3], b: [f64; 3]) -> [S; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Position of the geometric origin, m: what the motion capture reports.
pub(crate) fn origin(x: &[f64; STATES], p_origin_cm: [f64; 3]) -> [f64; 3] {
    let arm = turned([x[3], x[4], x[5]], p_origin_cm);
    each(|i| x[i] - arm[i])
}

/// Its slopes by the Euler angles, row by row; those by the c.m.'s position are ones.
pub(crate) fn origin_slopes(x: &[f64; STATES], p_origin_cm: [f64; 3]) -> [[f64; 3]; 3] {
    if p_origin_cm.iter().all(|r| *r == 0.0) {
        return [[0.0; 3]; 3];
    }
    turned(each(|k| Dual::<3>::variable(x[3 + k], k)), p_origin_cm).map(|d| d.slopes.map(|s| -s))
}

fn turned<S: Number>([rx, ry, rz]: [S; 3], v: [f64; 3]) -> [S; 3] {
    let ((sx, cx), (sy, cy), (sz, cz)) = (rx.sin_cos(), ry.sin_cos(), rz.sin_cos());
    matrix(sx, cx, sy, cy, sz, cz).map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

#[cfg(test)]
mod tests;
