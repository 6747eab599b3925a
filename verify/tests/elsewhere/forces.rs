//! Aerodynamic coefficients and the tether of a truth, with what the catalogue's families change in them.

use crate::algebra::{V, cross, scale, sub};
use crate::knobs::Knob as K;
use crate::motion::{Instant, Loads, World};
use crate::outside;

/// Coefficients that need no acceleration, and contacts.
pub(crate) fn early(world: &World<'_>, i: &Instant) -> Loads {
    let (a, k) = (&world.craft.aero, world.knobs);
    let (y, z) = outside::flow_across(i);
    let s2 = y * y + z * z;
    let along = i.u[0] / i.speed;
    let hat = 0.5 * world.craft.diameter / i.speed;
    let [p, q, r] = i.w.map(|w| w * hat);
    let mut load = Loads::default();
    let c = &mut load.c;
    c[0] = a[0] * (1.0 + k.get(K::CaV) * (i.speed / world.trim - 1.0)) * along + k.get(K::CA2) * s2 + k.get(K::CA4) * s2 * s2;
    let normal = a[1] + a[2] * s2;
    c[1] = -normal * y + k.get(K::CY0) + k.get(K::CNq) * r + k.get(K::MagF) * p * z;
    c[2] = normal * z + k.get(K::CN0) + k.get(K::CNq) * q + k.get(K::MagF) * p * y;
    c[3] = a[3] + p * (a[4] + k.get(K::Clps) * s2 + k.get(K::Clpp) * p.abs());
    let mut stiff = a[5] + a[6] * s2;
    if k.any(&[K::RpCos, K::RpSin]) {
        let clock = k.get(K::RpN) * y.atan2(z);
        stiff += k.get(K::RpCos) * clock.cos() + k.get(K::RpSin) * clock.sin();
    }
    c[4] = stiff * z + k.get(K::Cm0) + k.get(K::Mag) * p * y;
    c[5] = -stiff * y + k.get(K::Cn0) + k.get(K::Mag) * p * z;
    if let Some(shed) = &world.shedding {
        c[4] += shed[0].at(i.t);
        c[5] += shed[1].at(i.t);
    }
    hit(world, i, &mut load);
    load
}

/// Damping, once the wind-angle rates are known.
pub(crate) fn late(world: &World<'_>, i: &Instant, u_rate: V, c: &mut [f64; 6]) {
    let (a, k) = (&world.craft.aero, world.knobs);
    let [u, v, w] = i.u;
    let plane2 = u * u + w * w;
    let alpha = w.atan2(u);
    let beta = (v / i.speed).asin();
    let alpha_rate = (u * u_rate[2] - w * u_rate[0]) / plane2;
    let speed_rate = (u * u_rate[0] + v * u_rate[1] + w * u_rate[2]) / i.speed;
    let beta_rate = (u_rate[1] - v / i.speed * speed_rate) / plane2.sqrt();
    let hat = 0.25 * world.craft.diameter / i.speed;
    let (pitch, yaw) = ((i.w[1] + alpha_rate) * hat, (i.w[2] - beta_rate) * hat);
    let mut more = 0.0;
    if k.any(&[K::Bump]) {
        let total = v.hypot(w).atan2(u);
        more = k.get(K::Bump) / (total / k.get(K::BumpWidth)).cosh().powi(2);
    }
    let grown = 1.0 + k.get(K::DampTime) * i.t / 10.0;
    c[4] += ((a[7] + a[8] * alpha * alpha) * grown + more) * pitch;
    c[5] += ((a[9] + a[10] * beta * beta) * grown + more) * yaw;
    outside::late(world, i, [alpha_rate, beta_rate], c);
}

/// Force of the line and its moment about the c.m.
pub(crate) fn tether(world: &World<'_>, i: &Instant) -> (V, V) {
    let (c, k) = (world.craft, world.knobs);
    let (direction, length, rate) = i.line;
    let nominal = crate::algebra::norm(c.ring) - crate::algebra::norm(c.hook);
    let steady = i.q * c.drag_area - c.line_weight;
    let slow = steady * (1.0 + k.get(K::TethLen) * (length - nominal)) + outside::line(world, steady, length - nominal, rate);
    let whole = slow + k.get(K::TethC) * rate;
    // Slack, not stiff.
    let pull = if whole < 0.0 && slow > 0.0 {
        0.0
    } else if slow <= 0.0 && whole < slow {
        slow
    } else {
        whole
    };
    let f = scale(direction, pull);
    (f, cross(sub(c.hook, c.cm), f))
}

/// A touch in one run.
fn hit(world: &World<'_>, i: &Instant, load: &mut Loads) {
    let k = world.knobs;
    let x = (i.t - k.get(K::HitAt)) / k.get(K::HitFor);
    if (k.get(K::HitRun) - world.run).abs() < 0.5 && (0.0..1.0).contains(&x) {
        let rate = 2.0 * (std::f64::consts::PI * x).sin().powi(2) / k.get(K::HitFor);
        load.f[1] += k.get(K::HitF) * rate;
        load.m[2] += k.get(K::HitM) * rate;
    }
}
