//! Motion in momenta: c.m. and linear momentum in tunnel axes, angular momentum in tunnel axes, attitude by modified Rodrigues
//! parameters from the last sample's, so that they stay small.
//!
//! Air that moves with the body is part of the momenta (Kirchhoff), so accelerations are needed only for wind-angle rates and for
//! what swings inside.

use crate::air::Track;
use crate::algebra::{M, V, add, back, cross, dot, inverse, norm, scale, sub, times, turned, turning};
use crate::craft::{Craft, GRAVITY};
use crate::hand::Hand;
use crate::knobs::{Knob as K, Knobs};
use crate::outside;
use std::f64::consts::TAU;

/// States: place 0-2, parameters 3-5, momentum 6-8, angular momentum 9-11, hand 12-14, loose mass 15-18, fluid 19-21, lagging
/// flow 22-23, outrigger 24-25.
pub(crate) const STATES: usize = 26;
pub(crate) type State = [f64; STATES];

/// Where tunnel speed comes from.
pub(crate) enum Drive {
    Hand(Hand),
    Given(Track),
}

/// All that acts in one run.
pub(crate) struct World<'a> {
    pub(crate) craft: &'a Craft,
    pub(crate) knobs: &'a Knobs,
    pub(crate) trim: f64,
    pub(crate) drive: Drive,
    pub(crate) gusts: Option<[Track; 3]>,
    /// Velocity of the air besides, the same everywhere and at all times, tunnel axes.
    pub(crate) breeze: V,
    pub(crate) shedding: Option<[Track; 2]>,
    /// Number of the run, from one.
    pub(crate) run: f64,
    /// C_m0 of this run alone.
    pub(crate) own_cm0: f64,
    /// A phase for tones.
    pub(crate) phase: f64,
    inertia: M,
    inertia_inverse: M,
    apparent: V,
}

/// What one instant is.
pub(crate) struct Instant {
    pub(crate) t: f64,
    pub(crate) x: V,
    pub(crate) r: M,
    pub(crate) v: V,
    pub(crate) v_body: V,
    pub(crate) w: V,
    pub(crate) speed_w: f64,
    /// Velocity against the air, body axes.
    pub(crate) u: V,
    pub(crate) speed: f64,
    pub(crate) q: f64,
    /// Line from hook to ring: direction (body), length, rate.
    pub(crate) line: (V, f64, f64),
}

/// Coefficients (C_A, C_Y, C_N, C_l, C_m, C_n), and force and moment besides, body axes.
#[derive(Clone, Copy, Default)]
pub(crate) struct Loads {
    pub(crate) c: [f64; 6],
    pub(crate) f: V,
    pub(crate) m: V,
}

impl<'a> World<'a> {
    pub(crate) fn new(craft: &'a Craft, knobs: &'a Knobs, trim: f64, drive: Drive, run: f64) -> Self {
        let [x, y, z] = craft.inertia;
        let (xy, xz, yz) = (knobs.get(K::Ixy), knobs.get(K::Ixz), knobs.get(K::Iyz));
        let across = knobs.get(K::IaR);
        let fluid = knobs.get(K::Fluid);
        let inertia = [[x - fluid, -xy, -xz], [-xy, y + across - fluid, -yz], [-xz, -yz, z + across - fluid]];
        Self {
            craft,
            knobs,
            trim,
            drive,
            gusts: None,
            breeze: [0.0; 3],
            shedding: None,
            run,
            own_cm0: 0.0,
            phase: 0.0,
            inertia,
            inertia_inverse: inverse(&inertia),
            apparent: [knobs.get(K::MaX), knobs.get(K::MaR), knobs.get(K::MaR)],
        }
    }

    /// State of a body at rest or moving.
    pub(crate) fn state(&self, x: V, r: &M, v: V, w: V, hand: [f64; 3]) -> State {
        let mut y = [0.0; STATES];
        let wind = back(r, self.wind(0.0, x, hand[0]));
        let v_body = back(r, v);
        let m = self.mass(0.0);
        let p: V = std::array::from_fn(|k| (m + self.apparent[k]) * v_body[k] - self.apparent[k] * wind[k]);
        y[..3].copy_from_slice(&x);
        y[6..9].copy_from_slice(&times(r, p));
        y[9..12].copy_from_slice(&times(r, times(&self.inertia, w)));
        y[12..15].copy_from_slice(&hand);
        y[19..22].copy_from_slice(&w);
        let u = sub(v_body, wind);
        y[22] = u[1] / norm(u);
        y[23] = u[2] / norm(u);
        y
    }

    fn mass(&self, t: f64) -> f64 {
        self.craft.mass * (1.0 - self.knobs.get(K::Leak) * t / 10.0)
    }

    /// Velocity of the air at a place, tunnel axes.
    fn wind(&self, t: f64, x: V, speed_w: f64) -> V {
        let k = self.knobs;
        let (y, z) = (x[1], x[2]);
        let along = 1.0 + k.get(K::Prof) * (y * y + z * z) / (3.05 * 3.05) + k.get(K::TiltY) * y + k.get(K::TiltZ) * z;
        let (side, turn) = (speed_w / self.trim, k.get(K::Swirl));
        let mut wind = [-speed_w * along, side * (k.get(K::Vy) - turn * z), side * (k.get(K::Vz) + turn * y)];
        if let Some(gusts) = &self.gusts {
            for (w, g) in wind.iter_mut().zip(gusts) {
                *w += g.at(t);
            }
        }
        add(add(wind, self.breeze), outside::wind(self, t, x, speed_w))
    }

    /// Everything of an instant that needs no acceleration. `base` is the attitude from which the parameters count.
    pub(crate) fn instant(&self, t: f64, y: &State, base: &M) -> (Instant, V) {
        let x = [y[0], y[1], y[2]];
        let r = crate::algebra::product(base, &turned([y[3], y[4], y[5]]));
        let speed_w = self.speed_w(t, y);
        let wind = self.wind(t, x, speed_w);
        let (p, wind_body, m) = (back(&r, [y[6], y[7], y[8]]), back(&r, wind), self.mass(t));
        let v_body: V = std::array::from_fn(|k| (p[k] + self.apparent[k] * wind_body[k]) / (m + self.apparent[k]));
        let w = times(&self.inertia_inverse, back(&r, [y[9], y[10], y[11]]));
        let u = sub(v_body, wind_body);
        let speed = norm(u);
        let density = self.craft.density() * (1.0 - self.knobs.get(K::Warm) * t / 10.0)
            / (1.0 + self.knobs.get(K::Heating) * t / 10.0)
            * outside::thinned(self, x);
        let c = self.craft;
        let arm = sub(c.hook, c.cm);
        let to_ring = sub(back(&r, sub(outside::ring(self, t), x)), arm);
        let length = norm(to_ring);
        let direction = scale(to_ring, 1.0 / length);
        let rate = -dot(direction, add(v_body, cross(w, arm)));
        let v = times(&r, v_body);
        let i = Instant {
            t,
            x,
            r,
            v,
            v_body,
            w,
            speed_w,
            u,
            speed,
            q: 0.5 * density * speed * speed,
            line: (direction, length, rate),
        };
        (i, wind)
    }

    pub(crate) fn speed_w(&self, t: f64, y: &State) -> f64 {
        match &self.drive {
            Drive::Hand(_) => y[12],
            Drive::Given(track) => track.at(t),
        }
    }

    /// Rate of the wind that the body meets, by central differences along its path.
    fn wind_rate(&self, i: &Instant, y: &State) -> V {
        const H: f64 = 2e-5;
        let at = |h: f64| {
            let speed_w = match &self.drive {
                Drive::Hand(_) => y[12] + h * y[13],
                Drive::Given(track) => track.at(i.t + h),
            };
            self.wind(i.t + h, add(i.x, scale(i.v, h)), speed_w)
        };
        scale(sub(at(H), at(-H)), 0.5 / H)
    }

    /// Rate of the state.
    pub(crate) fn rate(&self, t: f64, y: &State, base: &M) -> State {
        let (i, wind) = self.instant(t, y, base);
        let (c, k) = (self.craft, self.knobs);
        let mut early = crate::forces::early(self, &i);
        outside::early(self, &i, y, &mut early);
        let qs = i.q * c.area();
        let aero = [-qs * early.c[0], qs * early.c[1], -qs * early.c[2]];
        let (pull, pull_moment) = crate::forces::tether(self, &i);
        let rates_of_wind = back(&i.r, self.wind_rate(&i, y));
        let wind_body = back(&i.r, wind);
        let wind_body_rate = sub(rates_of_wind, cross(i.w, wind_body));
        let (p, h) = (back(&i.r, [y[6], y[7], y[8]]), back(&i.r, [y[9], y[10], y[11]]));
        let (m, leak) = (self.mass(t), -c.mass * k.get(K::Leak) / 10.0);
        let gravity = back(&i.r, [m * GRAVITY, 0.0, 0.0]);
        let munk = cross(i.u, std::array::from_fn(|j| self.apparent[j] * i.u[j]));
        let loose = k.get(K::SloshM) > 0.0;
        let mut swing = [0.0; 2];
        let (mut specific, mut w_rate, mut force, mut moment) = ([0.0; 3], [0.0; 3], [0.0; 3], [0.0; 3]);
        // The loose mass pushes what pushes it: until it moves no more. A heavy one takes dozens of rounds.
        for round in 0..if loose { 60 } else { 1 } {
            let before = swing;
            let mut inside = Loads::default();
            if loose {
                (inside, swing) = self.swinging(&i, y, swing, w_rate, specific);
            }
            force = add(add(add(aero, pull), add(gravity, early.f)), add(inside.f, scale(i.v_body, leak)));
            let p_rate = sub(force, cross(i.w, p));
            let v_rate: V = std::array::from_fn(|j| {
                (p_rate[j] - leak * i.v_body[j] + self.apparent[j] * wind_body_rate[j]) / (m + self.apparent[j])
            });
            let mut coefficients = early.c;
            crate::forces::late(self, &i, sub(v_rate, wind_body_rate), &mut coefficients);
            let own = [3, 4, 5].map(|j| qs * c.diameter * coefficients[j]);
            let outer = add(add(own, cross(aero, c.cm)), add(pull_moment, early.m));
            moment = sub(add(outer, inside.m), munk);
            w_rate = times(&self.inertia_inverse, sub(moment, cross(i.w, h)));
            specific = sub(add(v_rate, cross(i.w, i.v_body)), scale(gravity, 1.0 / m));
            if round > 0 && (0..2).all(|j| (swing[j] - before[j]).abs() < 1e-12 * (1.0 + swing[j].abs())) {
                break;
            }
        }
        let mut dy = [0.0; STATES];
        dy[6..9].copy_from_slice(&times(&i.r, force));
        dy[9..12].copy_from_slice(&times(&i.r, moment));
        dy[..3].copy_from_slice(&i.v);
        dy[3..6].copy_from_slice(&turning([y[3], y[4], y[5]], i.w));
        if let Drive::Hand(hand) = &self.drive {
            dy[12..15].copy_from_slice(&hand.rates(t, i.x[0], i.v[0], [y[12], y[13], y[14]]));
        }
        dy[15..19].copy_from_slice(&[y[17], y[18], swing[0], swing[1]]);
        outside::inner(self, &i, y, &mut dy);
        dy
    }

    /// Load of the loose mass on the body, and its relative acceleration: a point mass on a spring across x, in full.
    fn swinging(&self, i: &Instant, y: &State, swing: [f64; 2], w_rate: V, specific: V) -> (Loads, [f64; 2]) {
        let k = self.knobs;
        let (mass, rest) = (k.get(K::SloshM), [k.get(K::SloshX), 0.0, 0.0]);
        let (off, rate) = ([0.0, y[15], y[16]], [0.0, y[17], y[18]]);
        let carried = |r: V| add(cross(w_rate, r), cross(i.w, cross(i.w, r)));
        let coriolis = scale(cross(i.w, rate), 2.0);
        let relative = add(add([0.0, swing[0], swing[1]], coriolis), carried(off));
        let mount = add(specific, carried(rest));
        let f = scale(relative, -mass);
        let m = scale(add(cross(add(rest, off), relative), cross(off, mount)), -mass);
        let w0 = TAU * k.get(K::SloshHz);
        let pushed = add(add(mount, carried(off)), coriolis);
        let next = [0, 1].map(|j| -w0 * w0 * y[15 + j] - 2.0 * k.get(K::SloshZeta) * w0 * y[17 + j] - pushed[1 + j]);
        (Loads { f, m, ..Loads::default() }, next)
    }

    /// One step by extrapolated midpoint rule (Gragg 1965; Bulirsch and Stoer 1966) of order eight, from zero parameters.
    pub(crate) fn step(&self, t: f64, y: &State, base: &M, h: f64) -> State {
        const PARTS: [usize; 4] = [2, 4, 6, 8];
        let mut table = PARTS.map(|n| self.midpoints(t, y, base, h, n));
        for column in 1..PARTS.len() {
            for row in (column..PARTS.len()).rev() {
                let ratio = PARTS[row] as f64 / PARTS[row - column] as f64;
                let per = 1.0 / (ratio * ratio - 1.0);
                let coarser = table[row - 1];
                table[row].iter_mut().zip(coarser).for_each(|(fine, coarse)| *fine += (*fine - coarse) * per);
            }
        }
        table[PARTS.len() - 1]
    }

    fn midpoints(&self, t: f64, y: &State, base: &M, h: f64, n: usize) -> State {
        let d = h / n as f64;
        let along = |y: &State, f: &State, k: f64| std::array::from_fn::<f64, STATES, _>(|j| y[j] + k * f[j]);
        let mut before = *y;
        let mut now = along(y, &self.rate(t, y, base), d);
        for m in 1..n {
            let next = along(&before, &self.rate(t + m as f64 * d, &now, base), 2.0 * d);
            before = now;
            now = next;
        }
        let f = self.rate(t + h, &now, base);
        std::array::from_fn(|j| 0.5 * (now[j] + before[j] + d * f[j]))
    }
}
