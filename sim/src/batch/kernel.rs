//! sim: the equations of motion on lanes, written by components and independently of [`crate::dynamics`], with which they must
//! agree. In: states and tabulated inputs. Out: rates of the states, and what an observer sees.
//!
//! State: c.m. position 0-2 and velocity 3-5 in tunnel axes, quaternion 6-9, body rates 10-12, and for an operator V_W 13 and
//! the integral of the height error 14. Time is not a state: inputs that depend on time alone come from a table.

use super::inputs::Channels;
use super::lane::Lanes;
use super::terms::{Layout, ONE, ROOM, SIN2, V_HAT, W_HAT};
use crate::operator::Hand;
use crate::setup::Setup;
use nalgebra::{Matrix3, Vector3};
use pulp::{Simd, WithSimd};
use windfall_model::{MeanFlow, Tether, Variable, Vehicle};

/// States without operator, and with one.
pub(super) const PLAIN: usize = 13;
pub(super) const HELD: usize = 15;

/// Below this airspeed squared, m²/s², there are no aerodynamic forces: as in [`crate::dynamics`].
const STILL_AIR_M2_S2: f64 = 1e-20;

/// Which parts of the equations a group of flights has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Parts {
    pub(super) tether: bool,
    /// The tether's swivel resists roll.
    pub(super) swivel: bool,
    /// The tether's pull depends on the rate of its length.
    pub(super) line_rate: bool,
    /// Speed varies over the section.
    pub(super) flow: bool,
    pub(super) apparent: bool,
    /// The c.m. is not at the geometric origin.
    pub(super) offset: bool,
    /// Products of inertia.
    pub(super) products: bool,
    pub(super) channels: Channels,
}

type Three<S> = [Lanes<S>; 3];

/// Constants by lane; names and units as in the plant.
#[derive(Clone, Copy, Debug)]
pub(super) struct Constants<S: Simd> {
    /// ½ρ.
    pub(super) half_density: Lanes<S>,
    pub(super) area: Lanes<S>,
    pub(super) diameter: Lanes<S>,
    pub(super) gravity: Lanes<S>,
    /// Mass with the air that is dragged along, inverse, along x and along y and z.
    pub(super) per_mass_axial: Lanes<S>,
    pub(super) per_mass_radial: Lanes<S>,
    pub(super) mass: Lanes<S>,
    pub(super) apparent_axial: Lanes<S>,
    pub(super) apparent_radial: Lanes<S>,
    /// xx, yy, zz, xy, xz, yz of the inertia matrix, and of its inverse; apparent inertia included.
    pub(super) inertia: [Lanes<S>; 6],
    pub(super) per_inertia: [Lanes<S>; 6],
    pub(super) p_origin_cm: Three<S>,
    pub(super) p_cm_hook: Three<S>,
    pub(super) ring: Three<S>,
    pub(super) drag_area: Lanes<S>,
    pub(super) weight: Lanes<S>,
    /// Size of the pull: `size + size_per_m·length`.
    pub(super) size: Lanes<S>,
    pub(super) size_per_m: Lanes<S>,
    pub(super) line_rate: Lanes<S>,
    /// Coulomb torque of the swivel, N m, and 1 over the roll rate over which it grows, s/rad.
    pub(super) swivel: Lanes<S>,
    pub(super) per_swivel_rate: Lanes<S>,
    pub(super) profile: Lanes<S>,
    pub(super) gradient: [Lanes<S>; 2],
    pub(super) swirl: Lanes<S>,
    pub(super) angularity: [Lanes<S>; 2],
    /// Operator: trim speed, gains on height, rate and integral, height held, 1/lag.
    pub(super) hand: [Lanes<S>; 6],
}

/// A group of flights made ready for lanes.
pub(super) struct Kernel<'a, S: Simd> {
    pub(super) parts: Parts,
    pub(super) layout: &'a Layout,
    pub(super) weights: &'a [Lanes<S>],
    pub(super) per_width: &'a [Lanes<S>],
    pub(super) c: Constants<S>,
}

/// Rates behind a call, which the steps of their own length go through: written out at every stage of every method the equations would be
/// compiled a hundred times, at the same speed. The call leaves the vector unit, `vectorize` comes back to it.
struct Called<'a, S: Simd, const N: usize> {
    simd: S,
    kernel: &'a Kernel<'a, S>,
    y: &'a [Lanes<S>; N],
    row: &'a [f64],
    slots: &'a mut [Lanes<S>; ROOM],
    rates: &'a mut [Lanes<S>; N],
}

impl<S: Simd, const N: usize> WithSimd for Called<'_, S, N> {
    type Output = ();
    #[inline(always)]
    fn with_simd<T: Simd>(self, _: T) {
        *self.rates = self.kernel.rate(self.simd, self.y, self.row, self.slots);
    }
}

#[inline(never)]
fn call<S: Simd, const N: usize>(called: Called<'_, S, N>) {
    called.simd.vectorize(called);
}

/// Attitude and air at one instant.
pub(super) struct LaneSight<S: Simd> {
    /// Rows of the matrix from body to tunnel axes.
    pub(super) m: [Three<S>; 3],
    /// Velocity seen from the air and the air's acceleration, body axes.
    pub(super) b: Three<S>,
    a_air: Three<S>,
    /// What gusts add to both, body axes; apparent mass does not see them.
    gust: Three<S>,
    gust_rate: Three<S>,
    pub(super) vw: Lanes<S>,
    vw_rate: Lanes<S>,
    height_error: Lanes<S>,
}

#[inline(always)]
fn dot<S: Simd>(a: Three<S>, b: Three<S>) -> Lanes<S> {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]))
}
#[inline(always)]
fn cross<S: Simd>(a: Three<S>, b: Three<S>) -> Three<S> {
    [a[2].neg_mul_add(b[1], a[1] * b[2]), a[0].neg_mul_add(b[2], a[2] * b[0]), a[1].neg_mul_add(b[0], a[0] * b[1])]
}
#[inline(always)]
fn plus<S: Simd>(a: Three<S>, b: Three<S>) -> Three<S> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}
#[inline(always)]
fn minus<S: Simd>(a: Three<S>, b: Three<S>) -> Three<S> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}
/// Tunnel components to body components.
#[inline(always)]
fn to_body<S: Simd>(m: &[Three<S>; 3], v: Three<S>) -> Three<S> {
    [
        m[0][0].mul_add(v[0], m[1][0].mul_add(v[1], m[2][0] * v[2])),
        m[0][1].mul_add(v[0], m[1][1].mul_add(v[1], m[2][1] * v[2])),
        m[0][2].mul_add(v[0], m[1][2].mul_add(v[1], m[2][2] * v[2])),
    ]
}
/// Symmetric matrix xx, yy, zz, xy, xz, yz times a vector.
#[inline(always)]
fn symmetric<S: Simd>(k: &[Lanes<S>; 6], v: Three<S>) -> Three<S> {
    [dot([k[0], k[3], k[4]], v), dot([k[3], k[1], k[5]], v), dot([k[4], k[5], k[2]], v)]
}

/// Three channels of the table from `first` on.
#[inline(always)]
pub(super) fn three<S: Simd>(simd: S, row: &[f64], first: usize) -> Three<S> {
    [channel(simd, row, first), channel(simd, row, first + 1), channel(simd, row, first + 2)]
}
#[inline(always)]
pub(super) fn channel<S: Simd>(simd: S, row: &[f64], k: usize) -> Lanes<S> {
    Lanes::load(simd, &row[k * S::F64_LANES..(k + 1) * S::F64_LANES])
}

impl<S: Simd> Kernel<'_, S> {
    /// Attitude and air at state `y` with inputs `row`.
    #[inline(always)]
    pub(super) fn sight<const N: usize>(&self, simd: S, y: &[Lanes<S>; N], row: &[f64]) -> LaneSight<S> {
        let [w, x, yy, z] = [y[6], y[7], y[8], y[9]];
        let norm2 = w.mul_add(w, x.mul_add(x, yy.mul_add(yy, z * z)));
        let s = Lanes::splat(simd, 2.0) / norm2;
        let (sx, sy, sz) = (s * x, s * yy, s * z);
        let (xx, xy, xz, xw) = (sx * x, sx * yy, sx * z, sx * w);
        let (yyy, yz, yw, zz, zw) = (sy * yy, sy * z, sy * w, sz * z, sz * w);
        let one = Lanes::splat(simd, 1.0);
        let m = [[one - (yyy + zz), xy - zw, xz + yw], [xy + zw, one - (xx + zz), yz - xw], [xz - yw, yz + xw, one - (xx + yyy)]];
        let (vw, vw_rate, height_error) = self.tunnel_speed(simd, y, row);
        let v = [y[3], y[4], y[5]];
        let (mut b, mut a_air);
        if self.parts.flow {
            let (v_air, a) = self.section_air(simd, y, vw, vw_rate);
            b = to_body(&m, minus(v, v_air));
            a_air = to_body(&m, a);
        } else {
            // Uniform flow: the air moves with −V_W along tunnel X.
            b = to_body(&m, [v[0] + vw, v[1], v[2]]);
            let k = -vw_rate;
            a_air = [k * m[0][0], k * m[0][1], k * m[0][2]];
        }
        let zero = Lanes::zero(simd);
        let (mut gust, mut gust_rate) = ([zero; 3], [zero; 3]);
        if let Some(first) = self.parts.channels.gusts() {
            gust = to_body(&m, three(simd, row, first));
            gust_rate = to_body(&m, three(simd, row, first + 3));
            b = minus(b, gust);
            a_air = plus(a_air, gust_rate);
        }
        LaneSight { m, b, a_air, gust, gust_rate, vw, vw_rate, height_error }
    }

    /// Tunnel speed, its rate, and the operator's height error.
    #[inline(always)]
    fn tunnel_speed<const N: usize>(&self, simd: S, y: &[Lanes<S>; N], row: &[f64]) -> (Lanes<S>, Lanes<S>, Lanes<S>) {
        let (first, second) = (channel(simd, row, 0), channel(simd, row, 1));
        if N < HELD {
            return (first, second, Lanes::zero(simd));
        }
        // V̇_W = (V_trim + K_h e + K_r Ẋ + K_i ∫e + n − V_W)/lag; n stands where a recorded V_W would.
        let [trim, height, rate, integral, hold, per_lag] = self.c.hand;
        let (vw, error) = (y[N - 2], y[0] - hold);
        let wanted = height.mul_add(error, rate.mul_add(y[3], integral.mul_add(y[N - 1], trim + first)));
        (vw, (wanted - vw) * per_lag, error)
    }

    /// Velocity of the air and its rate following the vehicle, where speed varies over the section, tunnel axes.
    #[inline(always)]
    fn section_air<const N: usize>(&self, simd: S, y: &[Lanes<S>; N], vw: Lanes<S>, vw_rate: Lanes<S>) -> (Three<S>, Three<S>) {
        let c = &self.c;
        let [gy, gz] = c.gradient;
        let one = Lanes::splat(simd, 1.0);
        let shape = one + c.profile.mul_add(y[1].mul_add(y[1], y[2] * y[2]), gy.mul_add(y[1], gz * y[2]));
        let shape_rate = (c.profile * y[1].mul_add(y[4], y[2] * y[5])).scale(2.0) + gy.mul_add(y[4], gz * y[5]);
        let (ly, lz) = (c.swirl.neg_mul_add(y[2], c.angularity[0]), c.swirl.mul_add(y[1], c.angularity[1]));
        let turn = vw * c.swirl;
        let v_air = [-(vw * shape), vw * ly, vw * lz];
        let along = vw_rate.mul_add(shape, vw * shape_rate);
        (v_air, [-along, turn.neg_mul_add(y[5], vw_rate * ly), turn.mul_add(y[4], vw_rate * lz)])
    }

    /// Rates of the states `y` with inputs `row`. `slots` is scratch.
    #[inline(always)]
    pub(super) fn rate<const N: usize>(
        &self,
        simd: S,
        y: &[Lanes<S>; N],
        row: &[f64],
        slots: &mut [Lanes<S>; ROOM],
    ) -> [Lanes<S>; N] {
        let c = &self.c;
        let s = self.sight(simd, y, row);
        let w = [y[10], y[11], y[12]];
        let flow = Flow::new(simd, &s, c);
        self.variables(simd, &flow, w, slots);
        let mut k = [Lanes::zero(simd); 8];
        if let Some(first) = self.parts.channels.noise() {
            let (force, moment) = (three(simd, row, first), three(simd, row, first + 3));
            k[..3].copy_from_slice(&force);
            k[3..6].copy_from_slice(&moment);
        }
        self.layout.add(false, self.weights, self.per_width, slots, &mut k);
        let qs = flow.q * c.area;
        let f_air = [-(qs * k[0]), qs * k[1], -(qs * k[2])];
        let mut f = f_air;
        let mut m = if self.parts.offset { cross(f_air, c.p_origin_cm) } else { [Lanes::zero(simd); 3] };
        if self.parts.tether {
            let pull = self.pull(&s, y, flow.q);
            f = plus(f, pull);
            m = plus(m, cross(c.p_cm_hook, pull));
            if self.parts.swivel {
                m[0] = m[0] - c.swivel * (w[0] * c.per_swivel_rate).tanh();
            }
        }
        if let Some(first) = self.parts.channels.contacts() {
            f = plus(f, three(simd, row, first));
            m = plus(m, three(simd, row, first + 3));
        }
        let a = self.acceleration(&s, w, &mut f, &mut m);
        if self.layout.needs_rates() {
            self.damping(&s, &flow, w, a, slots);
            self.layout.add(true, self.weights, self.per_width, slots, &mut k);
        }
        let qsd = qs * c.diameter;
        let m = [qsd.mul_add(k[3], m[0]), qsd.mul_add(k[4], m[1]), qsd.mul_add(k[5], m[2])];
        let spin = self.spin(w, m);
        self.assemble(y, &s, a, spin)
    }

    /// As [`Kernel::rate`], behind a call.
    #[inline(always)]
    pub(super) fn rate_by_call<const N: usize>(
        &self,
        simd: S,
        y: &[Lanes<S>; N],
        row: &[f64],
        slots: &mut [Lanes<S>; ROOM],
    ) -> [Lanes<S>; N] {
        let mut rates = *y;
        call(Called { simd, kernel: self, y, row, slots, rates: &mut rates });
        rates
    }

    /// Euler's equation: rate of body rates under a moment.
    #[inline(always)]
    fn spin(&self, w: Three<S>, m: Three<S>) -> Three<S> {
        let (i, per) = (&self.c.inertia, &self.c.per_inertia);
        if self.parts.products {
            return symmetric(per, minus(m, cross(w, symmetric(i, w))));
        }
        let net = minus(m, cross(w, [i[0] * w[0], i[1] * w[1], i[2] * w[2]]));
        [per[0] * net[0], per[1] * net[1], per[2] * net[2]]
    }

    #[inline(always)]
    fn assemble<const N: usize>(&self, y: &[Lanes<S>; N], s: &LaneSight<S>, a: Three<S>, spin: Three<S>) -> [Lanes<S>; N] {
        let [qw, qx, qy, qz] = [y[6], y[7], y[8], y[9]];
        // q̇ = ½ q ∘ (0, ω).
        let [p, q, r] = [y[10].scale(0.5), y[11].scale(0.5), y[12].scale(0.5)];
        let mut dy = *y;
        dy[0] = y[3];
        dy[1] = y[4];
        dy[2] = y[5];
        dy[3] = dot(s.m[0], a);
        dy[4] = dot(s.m[1], a);
        dy[5] = dot(s.m[2], a);
        dy[6] = -dot([qx, qy, qz], [p, q, r]);
        dy[7] = qz.neg_mul_add(q, qw.mul_add(p, qy * r));
        dy[8] = qx.neg_mul_add(r, qw.mul_add(q, qz * p));
        dy[9] = qy.neg_mul_add(p, qw.mul_add(r, qx * q));
        dy[10] = spin[0];
        dy[11] = spin[1];
        dy[12] = spin[2];
        if N == HELD {
            dy[N - 2] = s.vw_rate;
            dy[N - 1] = s.height_error;
        }
        dy
    }

    /// Flow variables that need no acceleration, those that the terms are made of.
    #[inline(always)]
    fn variables(&self, simd: S, flow: &Flow<S>, w: Three<S>, slots: &mut [Lanes<S>; ROOM]) {
        use Variable as V;
        let needs = &self.layout.needs;
        let [u, v, ww] = flow.b;
        slots[SIN2] = flow.cross2 * flow.per_speed * flow.per_speed;
        slots[ONE] = Lanes::splat(simd, 1.0);
        slots[V_HAT] = v * flow.per_speed;
        slots[W_HAT] = ww * flow.per_speed;
        slots[V::CosAlphaT as usize] = u * flow.per_speed;
        slots[V::Speed as usize] = flow.speed;
        let hat = flow.hat.scale(2.0);
        slots[V::RollRate as usize] = w[0] * hat;
        slots[V::PitchRate as usize] = w[1] * hat;
        slots[V::YawRate as usize] = w[2] * hat;
        slots[V::RollRateAbs as usize] = (w[0] * hat).abs();
        if needs[V::SinAlphaT as usize] || needs[V::AlphaT as usize] {
            let cross = flow.cross2.sqrt();
            slots[V::SinAlphaT as usize] = cross * flow.per_speed;
            if needs[V::AlphaT as usize] {
                slots[V::AlphaT as usize] = cross.atan2(u);
            }
        }
        if needs[V::SinPhi as usize] || needs[V::CosPhi as usize] {
            let per_cross = flow.cross2.sqrt().recip();
            slots[V::SinPhi as usize] = flow.cross2.where_above(0.0, v * per_cross, Lanes::zero(simd));
            slots[V::CosPhi as usize] = flow.cross2.where_above(0.0, ww * per_cross, Lanes::splat(simd, 1.0));
        }
        if needs[V::Alpha as usize] {
            slots[V::Alpha as usize] = ww.atan2(u);
        }
        if needs[V::Beta as usize] {
            slots[V::Beta as usize] = v.atan2(flow.uw);
        }
    }

    /// The two damping variables, from the acceleration `a` (inertial, body axes).
    #[inline(always)]
    fn damping(&self, s: &LaneSight<S>, flow: &Flow<S>, w: Three<S>, a: Three<S>, slots: &mut [Lanes<S>; ROOM]) {
        let [u, v, ww] = flow.b;
        let [ud, vd, wd] = minus(minus(a, s.a_air), cross(w, s.b));
        // α̇ = (u ẇ − w u̇)/(u² + w²), β̇ = (v̇ (u² + w²) − v (u u̇ + w ẇ))/(V² √(u² + w²)).
        let per_uw = flow.uw.recip();
        let alpha_rate = ww.neg_mul_add(ud, u * wd) * per_uw * per_uw;
        let along = u.mul_add(ud, ww * wd);
        let beta_rate = v.neg_mul_add(along, vd * flow.uw2) * (flow.per_speed * flow.per_speed * per_uw);
        let zero = flow.uw2.scale(0.0);
        let half = flow.hat;
        slots[Variable::PitchDamping as usize] = (w[1] + flow.uw2.where_above(0.0, alpha_rate, zero)) * half;
        slots[Variable::YawDamping as usize] = (w[2] - flow.uw2.where_above(0.0, beta_rate, zero)) * half;
    }

    /// Pull of the tether, body axes, N.
    #[inline(always)]
    fn pull<const N: usize>(&self, s: &LaneSight<S>, y: &[Lanes<S>; N], q: Lanes<S>) -> Three<S> {
        let (size, direction) = self.tension(s, y, q);
        [size * direction[0], size * direction[1], size * direction[2]]
    }

    /// Pull toward the ring, N, and its direction, body axes.
    #[inline(always)]
    pub(super) fn tension<const N: usize>(&self, s: &LaneSight<S>, y: &[Lanes<S>; N], q: Lanes<S>) -> (Lanes<S>, Three<S>) {
        let c = &self.c;
        let line = minus(to_body(&s.m, minus(c.ring, [y[0], y[1], y[2]])), c.p_cm_hook);
        let length = dot(line, line).sqrt();
        let per = length.recip();
        let direction = [line[0] * per, line[1] * per, line[2] * per];
        let mut pull = (q * c.drag_area - c.weight) * c.size_per_m.mul_add(length, c.size);
        if self.parts.line_rate {
            let v_hook = plus(to_body(&s.m, [y[3], y[4], y[5]]), cross([y[10], y[11], y[12]], c.p_cm_hook));
            // A line cannot push: it goes slack.
            let slack = (pull - pull.abs()).scale(0.5);
            pull = c.line_rate.neg_mul_add(dot(direction, v_hook), pull).max(slack);
        }
        (pull, direction)
    }

    /// Dynamic pressure, Pa.
    #[inline(always)]
    pub(super) fn pressure(&self, s: &LaneSight<S>) -> Lanes<S> {
        self.c.half_density * dot(s.b, s.b)
    }

    /// Inertial acceleration of the c.m., body axes; adds to the moment what the air dragged along does.
    ///
    /// With P = (m_x, m_r, m_r)·u, the force −(m_k u̇ + ω × P) with u̇ = a − a_air − ω × u leaves
    /// `(m + m_k) a = f + m g + m_k (a_air + ω × u) − ω × P`: no loop, since the vehicle's own forces do not depend on a.
    #[inline(always)]
    fn acceleration(&self, s: &LaneSight<S>, w: Three<S>, f: &mut Three<S>, m: &mut Three<S>) -> Three<S> {
        let c = &self.c;
        let weight = c.mass * c.gravity;
        let mut total = [weight.mul_add(s.m[0][0], f[0]), weight.mul_add(s.m[0][1], f[1]), weight.mul_add(s.m[0][2], f[2])];
        if self.parts.apparent {
            let (u, a_air) = (plus(s.b, s.gust), minus(s.a_air, s.gust_rate));
            let mass = [c.apparent_axial, c.apparent_radial, c.apparent_radial];
            let impulse = [mass[0] * u[0], mass[1] * u[1], mass[2] * u[2]];
            let (carried, turned) = (plus(a_air, cross(w, u)), cross(w, impulse));
            total = [
                mass[0].mul_add(carried[0], total[0] - turned[0]),
                mass[1].mul_add(carried[1], total[1] - turned[1]),
                mass[2].mul_add(carried[2], total[2] - turned[2]),
            ];
            *m = minus(*m, cross(u, impulse));
        }
        [total[0] * c.per_mass_axial, total[1] * c.per_mass_radial, total[2] * c.per_mass_radial]
    }
}

/// Lengths and quotients of the velocity seen from the air.
struct Flow<S: Simd> {
    b: Three<S>,
    /// v² + w², u² + w² and its root.
    cross2: Lanes<S>,
    uw2: Lanes<S>,
    uw: Lanes<S>,
    speed: Lanes<S>,
    per_speed: Lanes<S>,
    /// d/4V.
    hat: Lanes<S>,
    /// Dynamic pressure, Pa; zero in still air.
    q: Lanes<S>,
}

impl<S: Simd> Flow<S> {
    #[inline(always)]
    fn new(simd: S, s: &LaneSight<S>, c: &Constants<S>) -> Self {
        let [u, v, w] = s.b;
        let cross2 = v.mul_add(v, w * w);
        let uw2 = u.mul_add(u, w * w);
        let speed2 = u.mul_add(u, cross2);
        let q = speed2.where_above(STILL_AIR_M2_S2, c.half_density * speed2, Lanes::zero(simd));
        let speed = speed2.max(Lanes::splat(simd, STILL_AIR_M2_S2)).sqrt();
        let per_speed = speed.recip();
        Self { b: s.b, cross2, uw2, uw: uw2.sqrt(), speed, per_speed, hat: (c.diameter * per_speed).scale(0.25), q }
    }
}

impl<S: Simd> Constants<S> {
    /// Constants of the lanes' flights, one setup a lane.
    pub(super) fn gather(simd: S, setups: &[&Setup<'_>]) -> Self {
        let one = |of: &dyn Fn(&Setup<'_>) -> f64| Lanes::load(simd, &setups.iter().map(|s| of(s)).collect::<Vec<_>>());
        let vehicle = |of: &dyn Fn(&Vehicle) -> f64| one(&|s| of(&s.plant.vehicle));
        let flow = |of: &dyn Fn(&MeanFlow) -> f64| one(&|s| of(&s.plant.flow));
        let tether = |of: &dyn Fn(&Tether) -> f64| one(&|s| s.plant.tether.as_ref().map_or(0.0, of));
        let hand = |of: &dyn Fn(&Hand) -> f64| one(&|s| s.hand.as_ref().map_or(0.0, of));
        let three = |of: &dyn Fn(&Setup<'_>) -> [f64; 3]| [one(&|s| of(s)[0]), one(&|s| of(s)[1]), one(&|s| of(s)[2])];
        let six = |of: &dyn Fn(&Setup<'_>) -> Matrix3<f64>| {
            [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)].map(|place| one(&|s| of(s)[place]))
        };
        Self {
            half_density: one(&|s| 0.5 * s.density_kg_m3),
            area: one(&|s| s.area_m2),
            diameter: vehicle(&|v| v.diameter_m),
            gravity: one(&|s| s.plant.environment.gravity_m_s2),
            mass: vehicle(&|v| v.mass_kg),
            apparent_axial: vehicle(&|v| v.apparent.axial_kg),
            apparent_radial: vehicle(&|v| v.apparent.radial_kg),
            per_mass_axial: vehicle(&|v| 1.0 / (v.mass_kg + v.apparent.axial_kg)),
            per_mass_radial: vehicle(&|v| 1.0 / (v.mass_kg + v.apparent.radial_kg)),
            inertia: six(&total_inertia),
            per_inertia: six(&|s| total_inertia(s).try_inverse().unwrap_or(s.inertia_inverse)),
            p_origin_cm: three(&|s| s.plant.vehicle.p_origin_cm.to_array()),
            p_cm_hook: three(&|s| {
                s.plant.tether.as_ref().map_or([0.0; 3], |t| (t.p_origin_hook - s.plant.vehicle.p_origin_cm).to_array())
            }),
            ring: three(&|s| s.plant.tether.as_ref().map_or([0.0; 3], |t| t.ring().to_array())),
            drag_area: tether(&|t| t.drag_area_m2),
            weight: tether(&|t| t.weight_n),
            size: tether(&|t| 1.0 - t.length_per_m * (t.p_tunnel_ring.norm() - t.p_origin_hook.norm())),
            size_per_m: tether(&|t| t.length_per_m),
            line_rate: tether(&|t| t.line_rate_n_s_m),
            swivel: tether(&|t| t.swivel_n_m),
            per_swivel_rate: tether(&|t| 1.0 / t.swivel_rate_rad_s),
            profile: flow(&|f| f.profile_per_m2),
            gradient: [flow(&|f| f.gradient_per_m[0]), flow(&|f| f.gradient_per_m[1])],
            swirl: flow(&|f| f.swirl_rad_per_m),
            angularity: [flow(&|f| f.angularity_rad[0]), flow(&|f| f.angularity_rad[1])],
            hand: [
                hand(&|h| h.trim_m_s),
                hand(&|h| h.order.height_gain_per_s),
                hand(&|h| h.order.rate_gain),
                hand(&|h| h.order.integral_gain_per_s2),
                hand(&|h| h.order.hold_x_m),
                hand(&|h| 1.0 / h.order.lag_s),
            ],
        }
    }
}

/// Inertia with that of the air dragged along, kg m².
fn total_inertia(s: &Setup<'_>) -> Matrix3<f64> {
    let extra = s.plant.vehicle.apparent.transverse_kg_m2;
    s.inertia + Matrix3::from_diagonal(&Vector3::new(0.0, extra, extra))
}
