//! Physics that no family of the catalogue describes.

use crate::algebra::{V, back, cross, dot};
use crate::knobs::Knob as K;
use crate::motion::{Instant, Loads, STATES, State, World};
use std::f64::consts::TAU;

/// Sines of the flow across the body, along y and z.
pub(crate) fn flow_across(i: &Instant) -> (f64, f64) {
    (i.u[1] / i.speed, i.u[2] / i.speed)
}

/// What else the air does at a place, tunnel axes, m/s.
pub(crate) fn wind(world: &World<'_>, t: f64, x: V, speed_w: f64) -> V {
    let k = world.knobs;
    let mut wind = [0.0; 3];
    if k.any(&[K::Tone]) {
        wind[0] -= k.get(K::Tone) * (TAU * k.get(K::ToneHz) * t + world.phase).sin();
    }
    if k.any(&[K::SideTone]) {
        // A short push that comes again and again.
        wind[1] += k.get(K::SideTone) * (3.0 * ((TAU * k.get(K::SideHz) * t + world.phase).cos() - 1.0)).exp();
    }
    if k.any(&[K::Pole]) {
        let away2 = (x[1] - 0.12).powi(2) + (x[2] + 0.08).powi(2);
        wind[0] += speed_w * k.get(K::Pole) * (-away2 / (2.0 * 0.1 * 0.1)).exp();
    }
    wind[0] -= speed_w * k.get(K::Shear) * x[0];
    wind[1] += speed_w * k.get(K::HeightFlow) * x[0];
    wind
}

/// Density over that of the gas at rest.
pub(crate) fn thinned(world: &World<'_>, x: V) -> f64 {
    if !world.knobs.any(&[K::Plume]) {
        return 1.0;
    }
    let away2 = (x[1] + 0.1).powi(2) + (x[2] - 0.15).powi(2);
    1.0 - world.knobs.get(K::Plume) * (-away2 / (2.0 * 0.15 * 0.15)).exp()
}

/// Where the ring is.
pub(crate) fn ring(world: &World<'_>, t: f64) -> V {
    let (k, mut ring) = (world.knobs, world.craft.ring);
    ring[1] += k.get(K::RingY) + k.get(K::RingSway) * (TAU * 0.35 * t + world.phase).sin();
    ring[2] += k.get(K::RingZ);
    ring
}

/// Pull of the line besides its steady one.
pub(crate) fn line(world: &World<'_>, steady: f64, beyond: f64, rate: f64) -> f64 {
    let k = world.knobs;
    (k.get(K::Stick) + k.get(K::Pulley) * steady) * (rate / 0.02).tanh() + k.get(K::Snap) * (beyond - 0.05).max(0.0)
}

/// Coefficients, force and moment that need no acceleration.
pub(crate) fn early(world: &World<'_>, i: &Instant, state: &State, load: &mut Loads) {
    let (k, a) = (world.knobs, &world.craft.aero);
    let (y, z) = flow_across(i);
    let s = y.hypot(z);
    let hat = 0.5 * world.craft.diameter / i.speed;
    let [p, q, r] = i.w;
    let c = &mut load.c;
    if k.any(&[K::LagN]) {
        let normal = a[1] + a[2] * s * s;
        c[1] -= normal * (state[22] - y);
        c[2] += normal * (state[23] - z);
    }
    c[0] *= 1.0 + k.get(K::Ice) * i.t / 10.0;
    c[0] += k.get(K::AxialBurst) * (8.0 * (TAU * 0.27 * i.t + world.phase).sin()).tanh();
    let mut stiff = a[5] * k.get(K::CmV) * (i.speed / world.trim - 1.0);
    if k.any(&[K::Jump]) {
        stiff += k.get(K::Jump) * 0.5 * (1.0 + ((s - k.get(K::JumpAt)) / 0.01).tanh()) / s.max(0.02);
    }
    c[0] += k.get(K::RollDrag) * (p * hat).powi(2);
    if k.any(&[K::LagM]) {
        let late = a[5] * k.get(K::LagM);
        c[4] += late * (state[23] - z);
        c[5] -= late * (state[22] - y);
    }
    if k.any(&[K::Edge]) {
        let beyond = 0.5 * (1.0 + ((s - k.get(K::EdgeAt)) / 0.02).tanh());
        c[0] -= k.get(K::Edge) * beyond;
        c[1] -= k.get(K::Edge) * beyond * y / s.max(0.01);
        c[2] += k.get(K::Edge) * beyond * z / s.max(0.01);
    }
    c[3] += k.get(K::VaneSpeed) * (i.speed / world.trim - 1.0);
    if k.any(&[K::YawTone]) {
        c[5] += k.get(K::YawTone) * (TAU * k.get(K::YawToneHz) * i.t + world.phase).sin();
    }
    if k.any(&[K::Wavy]) {
        let wave = k.get(K::Wavy) * (6.0 * s).sin() / s.max(0.01);
        c[4] += wave * z;
        c[5] -= wave * y;
    }
    if k.any(&[K::Sag]) {
        c[4] += k.get(K::Sag) * (1.0 - (-i.t.max(0.0) / 4.0).exp());
    }
    c[3] += k.get(K::RollPitch) * y * z;
    c[4] += stiff * z + world.own_cm0 + k.get(K::QQ) * q * q.abs() * hat * hat + k.get(K::CrossDamp) * r * hat;
    c[5] += -stiff * y + k.get(K::QQ) * r * r.abs() * hat * hat - k.get(K::CrossDamp) * q * hat;
    c[4] += k.get(K::OneSided) * z.max(0.0) + k.get(K::Bend) * state[24];
    load.m[0] -= k.get(K::Swivel) * (p / 0.03).tanh();
    if k.any(&[K::Torsion]) {
        load.m[0] -= k.get(K::Torsion) * i.r[2][1].atan2(i.r[1][1]);
    }
    if k.any(&[K::Magnet]) {
        let field = back(&i.r, [0.3, 0.8, 0.52]);
        let torque = cross([0.0, k.get(K::Magnet), 0.0], field);
        load.m = crate::algebra::add(load.m, torque);
    }
    let rotor = cross(i.w, [k.get(K::Gyro), 0.0, 0.0]);
    load.m = crate::algebra::sub(load.m, rotor);
    if k.any(&[K::Wall]) {
        let away2 = i.x[1] * i.x[1] + i.x[2] * i.x[2];
        let size = -i.q * world.craft.area() * k.get(K::Wall) * away2;
        let push = back(&i.r, [0.0, size * i.x[1], size * i.x[2]]);
        load.f = crate::algebra::add(load.f, push);
    }
    if k.any(&[K::WallStiff]) {
        let (away, at) = (i.x[1].hypot(i.x[2]), k.get(K::WallAt));
        if away > at {
            let outward = [0.0, i.x[1] / away, i.x[2] / away];
            let size = (k.get(K::WallStiff) * (away - at) + k.get(K::WallDamp) * dot(outward, i.v)).max(0.0);
            load.f = crate::algebra::sub(load.f, back(&i.r, outward.map(|o| o * size)));
        }
    }
    if k.any(&[K::Fluid]) {
        let coupling = k.get(K::Fluid) / k.get(K::FluidTime);
        for j in 0..3 {
            load.m[j] += coupling * (state[19 + j] - i.w[j]);
        }
    }
}

/// Coefficients that follow wind-angle rates.
pub(crate) fn late(world: &World<'_>, i: &Instant, [alpha_rate, beta_rate]: [f64; 2], c: &mut [f64; 6]) {
    let k = world.knobs;
    if k.any(&[K::Hyst]) {
        let (y, z) = flow_across(i);
        let (s, along) = (y.hypot(z).max(1e-9), z * alpha_rate + y * beta_rate);
        // Opening and closing angles take two branches.
        let branch = k.get(K::Hyst) * (along / s / 0.25).tanh();
        c[4] += branch * z;
        c[5] -= branch * y;
    }
}

/// Rates of the states inside.
pub(crate) fn inner(world: &World<'_>, i: &Instant, y: &State, dy: &mut [f64; STATES]) {
    let k = world.knobs;
    if k.any(&[K::Fluid]) {
        // The fluid's rates in body axes, gyroscopic turning left to the walls.
        for j in 0..3 {
            dy[19 + j] = (i.w[j] - y[19 + j]) / k.get(K::FluidTime);
        }
    }
    if k.any(&[K::LagN, K::LagM]) {
        let ((a, b), late) = (flow_across(i), k.get(K::LagN).max(k.get(K::LagMTime)));
        dy[22] = (a - y[22]) / late;
        dy[23] = (b - y[23]) / late;
    }
    if k.any(&[K::Bend]) {
        let w0 = TAU * k.get(K::BendHz);
        dy[24] = y[25];
        dy[25] = w0 * w0 * (dot(i.u, [0.0, 0.0, 1.0]) / i.speed - y[24]) - 2.0 * 0.03 * w0 * y[25];
    }
}
