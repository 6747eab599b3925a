//! Gross faults as a table: a name, the word of the cause that the refusal must have, and what is done to a campaign in memory.

use windfall_model::frames::Vec3;
use windfall_model::{Campaign, Data, Record, Use};

/// One fault.
pub(crate) struct Wrong {
    pub(crate) name: &'static str,
    /// One of these is in the message.
    pub(crate) words: &'static [&'static str],
    pub(crate) apply: fn(&mut Campaign),
}

fn records(c: &mut Campaign, f: impl Fn(&mut Record)) {
    for run in &mut c.runs {
        if let Data::Tunnel(r) = &mut run.data {
            f(r);
        }
    }
}

fn first(c: &mut Campaign, f: impl Fn(&mut Record)) {
    if let Data::Tunnel(r) = &mut c.runs[0].data {
        f(r);
    }
}

fn scaled(x: &mut [f64], by: f64) {
    x.iter_mut().for_each(|v| *v *= by);
}

fn positions(c: &mut Campaign, by: [f64; 3]) {
    records(c, |r| (0..3).for_each(|k| scaled(&mut r.position_m[k], by[k])));
}

fn angles(c: &mut Campaign, by: [f64; 3]) {
    records(c, |r| (0..3).for_each(|k| scaled(&mut r.attitude_rad[k], by[k])));
}

fn clock(c: &mut Campaign, by: f64) {
    records(c, |r| scaled(&mut r.t_s, by));
}

fn wind(c: &mut Campaign, by: f64) {
    records(c, |r| scaled(&mut r.vw_m_s, by));
}

fn pressure(c: &mut Campaign, by: f64) {
    records(c, |r| scaled(&mut r.ps_pa, by));
}

fn inertia(c: &mut Campaign, by: f64) {
    let i = &mut c.plant.vehicle.inertia;
    for v in [&mut i.xx, &mut i.yy, &mut i.zz, &mut i.xy, &mut i.xz, &mut i.yz] {
        *v *= by;
    }
}

/// The same attitude as angles of the sequence z-y-x: T = Rz·Ry·Rx.
fn other_sequence(r: &mut Record) {
    let mut turns = 0.0;
    for i in 0..r.len() {
        let [(sx, cx), (sy, cy), (sz, cz)] = [0, 1, 2].map(|k| r.attitude_rad[k][i].sin_cos());
        // Rows of T = Rx·Ry·Rz that the other sequence's angles follow from.
        let (t00, t10) = (cz * cy, cz * sy * sx + sz * cx);
        let (t20, t21, t22) = (sz * sx - cz * sy * cx, sz * sy * cx + cz * sx, cy * cx);
        let roll: f64 = t21.atan2(t22);
        if i > 0 {
            let before = r.attitude_rad[0][i - 1];
            turns = ((before - roll) / std::f64::consts::TAU).round();
        }
        r.attitude_rad[0][i] = roll + turns * std::f64::consts::TAU;
        r.attitude_rad[1][i] = (-t20).asin();
        r.attitude_rad[2][i] = t10.atan2(t00);
    }
}

/// Positions and attitudes as a laboratory has them whose room axes and body axes are others: `room` and `body` are rows, theirs of ours.
fn other_axes(r: &mut Record, room: [[f64; 3]; 3], body: [[f64; 3]; 3]) {
    use windfall_model::frames::EulerXyz;
    for i in 0..r.len() {
        let t = EulerXyz { rx_rad: r.attitude_rad[0][i], ry_rad: r.attitude_rad[1][i], rz_rad: r.attitude_rad[2][i] }
            .r_tunnel_body()
            .matrix;
        let p: [f64; 3] = std::array::from_fn(|k| r.position_m[k][i]);
        let element = |a: usize, b: usize| (0..9).map(|k| room[a][k / 3] * t[(k / 3, k % 3)] * body[b][k % 3]).sum::<f64>();
        let angles =
            [(-element(1, 2)).atan2(element(2, 2)), element(0, 2).clamp(-1.0, 1.0).asin(), (-element(0, 1)).atan2(element(0, 0))];
        for k in 0..3 {
            let before = if i > 0 { r.attitude_rad[k][i - 1] } else { angles[k] };
            r.attitude_rad[k][i] = angles[k] + ((before - angles[k]) / std::f64::consts::TAU).round() * std::f64::consts::TAU;
            r.position_m[k][i] = (0..3).map(|j| room[k][j] * p[j]).sum();
        }
    }
}

const AS_OURS: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// z up: their x, y, z are our Y, -Z, -X.
const Z_UP: [[f64; 3]; 3] = [[0.0, 1.0, 0.0], [0.0, 0.0, -1.0], [-1.0, 0.0, 0.0]];
/// y up: their x, y, z are our Y, -X, Z.
const Y_UP: [[f64; 3]; 3] = [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
/// A body whose z is out of the nose.
const Z_NOSE: [[f64; 3]; 3] = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]];

/// V_W late by whole samples, early where negative; the ends stay as they are.
pub(crate) fn late(r: &mut Record, samples: isize) {
    let n = r.len();
    let all = r.vw_m_s.clone();
    for (i, v) in r.vw_m_s.iter_mut().enumerate() {
        *v = all[i.saturating_add_signed(-samples).min(n - 1)];
    }
}

/// The attitude from tunnel to body: T transposed.
fn other_way(r: &mut Record) {
    use windfall_model::frames::EulerXyz;
    for i in 0..r.len() {
        let t = EulerXyz { rx_rad: r.attitude_rad[0][i], ry_rad: r.attitude_rad[1][i], rz_rad: r.attitude_rad[2][i] }
            .r_tunnel_body()
            .matrix
            .transpose();
        let angles = [(-t[(1, 2)]).atan2(t[(2, 2)]), t[(0, 2)].clamp(-1.0, 1.0).asin(), (-t[(0, 1)]).atan2(t[(0, 0)])];
        for (angle, series) in angles.into_iter().zip(&mut r.attitude_rad) {
            let before = if i > 0 { series[i - 1] } else { angle };
            series[i] = angle + ((before - angle) / std::f64::consts::TAU).round() * std::f64::consts::TAU;
        }
    }
}

fn frozen(r: &mut Record) {
    let (from, to) = (r.len() / 3, r.len() / 3 + r.len() / 10);
    for x in r.position_m.iter_mut().chain(&mut r.attitude_rad) {
        let held = x[from];
        x[from..to].fill(held);
    }
}

fn repeated(r: &mut Record) {
    let (from, n) = (r.len() / 3, r.len() / 12);
    for x in r.position_m.iter_mut().chain(&mut r.attitude_rad) {
        x.copy_within(from..from + n, from + n);
    }
}

fn from_half(x: &mut [f64], by: f64) {
    let half = x.len() / 2;
    x[half..].iter_mut().for_each(|v| *v += by);
}

/// The table.
pub(crate) const WRONG: &[Wrong] = &[
    Wrong { name: "X up", words: &["X points up"], apply: |c| positions(c, [-1.0, 1.0, 1.0]) },
    Wrong { name: "Y mirrored", words: &["Y is mirrored"], apply: |c| positions(c, [1.0, -1.0, 1.0]) },
    Wrong { name: "Z mirrored", words: &["Z is mirrored"], apply: |c| positions(c, [1.0, 1.0, -1.0]) },
    Wrong { name: "Y and Z negative", words: &["Y and Z have the wrong sign"], apply: |c| positions(c, [1.0, -1.0, -1.0]) },
    Wrong { name: "X up, Y mirrored", words: &["X points up"], apply: |c| positions(c, [-1.0, -1.0, 1.0]) },
    Wrong { name: "Y and Z swapped", words: &["Y and Z are swapped"], apply: |c| records(c, |r| r.position_m.swap(1, 2)) },
    Wrong { name: "X and Z swapped", words: &["X and Z are swapped"], apply: |c| records(c, |r| r.position_m.swap(0, 2)) },
    Wrong { name: "axes in the order Y, Z, X", words: &["swapped"], apply: |c| records(c, |r| r.position_m.rotate_left(1)) },
    Wrong {
        name: "room with z up, body with z out of the nose",
        words: &["down is -z of the room, and z of the body"],
        apply: |c| records(c, |r| other_axes(r, Z_UP, Z_NOSE)),
    },
    Wrong {
        name: "room with z up, body with z out of the tail",
        words: &["down is -z of the room, and -z of the body"],
        apply: |c| records(c, |r| other_axes(r, Z_UP, Z_UP)),
    },
    Wrong {
        name: "room with y up, body with z out of the nose",
        words: &["down is -y of the room, and z of the body"],
        apply: |c| records(c, |r| other_axes(r, Y_UP, Z_NOSE)),
    },
    Wrong {
        name: "room with z up alone",
        words: &["down is -z of the room, and x of the body"],
        apply: |c| records(c, |r| other_axes(r, Z_UP, AS_OURS)),
    },
    Wrong {
        name: "body with z out of the nose alone",
        words: &["down is x of the room, and z of the body"],
        apply: |c| records(c, |r| other_axes(r, AS_OURS, Z_NOSE)),
    },
    Wrong { name: "all angles negative", words: &["all Euler angles"], apply: |c| angles(c, [-1.0; 3]) },
    Wrong { name: "roll negative", words: &["Euler angle Rx"], apply: |c| angles(c, [-1.0, 1.0, 1.0]) },
    Wrong { name: "pitch negative", words: &["Euler angle Ry"], apply: |c| angles(c, [1.0, -1.0, 1.0]) },
    Wrong { name: "yaw negative", words: &["Euler angle Rz"], apply: |c| angles(c, [1.0, 1.0, -1.0]) },
    Wrong { name: "attitude transposed", words: &["from tunnel to body"], apply: |c| records(c, other_way) },
    Wrong { name: "X in cm among mm", words: &["X is in cm among axes in mm"], apply: |c| positions(c, [0.1, 1.0, 1.0]) },
    Wrong { name: "X in mm among cm", words: &["X is in mm among axes in cm"], apply: |c| positions(c, [10.0, 1.0, 1.0]) },
    Wrong { name: "Z in feet", words: &["Z is in feet"], apply: |c| positions(c, [1.0, 1.0, 1.0 / 0.3048]) },
    Wrong {
        name: "Y mirrored in one run",
        words: &["run ", "Y is mirrored"],
        apply: |c| first(c, |r| scaled(&mut r.position_m[1], -1.0)),
    },
    Wrong { name: "speed in km/h in one run", words: &["km/h"], apply: |c| first(c, |r| scaled(&mut r.vw_m_s, 3.6)) },
    Wrong {
        name: "V_W late by 1 s in one run",
        words: &["clocks of pose and V_W differ otherwise"],
        apply: |c| first(c, |r| late(r, 150)),
    },
    Wrong { name: "sequence z-y-x", words: &["sequence is z-y-x"], apply: |c| records(c, other_sequence) },
    Wrong {
        name: "pitch and yaw swapped",
        words: &["pitch and yaw are swapped"],
        apply: |c| records(c, |r| r.attitude_rad.swap(1, 2)),
    },
    Wrong {
        name: "roll and pitch swapped",
        words: &["roll and pitch are swapped"],
        apply: |c| records(c, |r| r.attitude_rad.swap(0, 1)),
    },
    Wrong {
        name: "radians as degrees",
        words: &["radians where degrees"],
        apply: |c| angles(c, [std::f64::consts::PI / 180.0; 3]),
    },
    Wrong {
        name: "degrees as radians",
        words: &["degrees where radians"],
        apply: |c| angles(c, [180.0 / std::f64::consts::PI; 3]),
    },
    Wrong { name: "positions in mm", words: &["in mm"], apply: |c| positions(c, [1e3; 3]) },
    Wrong { name: "positions in cm", words: &["in cm"], apply: |c| positions(c, [1e2; 3]) },
    Wrong { name: "positions in feet", words: &["in feet"], apply: |c| positions(c, [1.0 / 0.3048; 3]) },
    Wrong { name: "positions in inches", words: &["in inches"], apply: |c| positions(c, [1.0 / 0.0254; 3]) },
    Wrong { name: "speed in km/h", words: &["km/h"], apply: |c| wind(c, 3.6) },
    Wrong { name: "speed in knots", words: &["knots"], apply: |c| wind(c, 1.0 / 0.514_444) },
    Wrong { name: "speed in ft/s", words: &["ft/s"], apply: |c| wind(c, 1.0 / 0.3048) },
    Wrong { name: "speed downward", words: &["V_W points down"], apply: |c| wind(c, -1.0) },
    Wrong { name: "pressure in kPa", words: &["kPa"], apply: |c| pressure(c, 1e-3) },
    Wrong { name: "pressure in hPa", words: &["hPa"], apply: |c| pressure(c, 1e-2) },
    Wrong { name: "pressure in lb/ft2", words: &["lb/ft2"], apply: |c| pressure(c, 1.0 / 47.880_26) },
    Wrong {
        name: "temperature in Celsius",
        words: &["Celsius"],
        apply: |c| records(c, |r| r.ts_k.iter_mut().for_each(|t| *t -= 273.15)),
    },
    Wrong { name: "time in ms", words: &["in ms"], apply: |c| clock(c, 1e3) },
    Wrong { name: "clock twice", words: &["sample rate"], apply: |c| clock(c, 2.0) },
    Wrong { name: "clock half", words: &["sample rate"], apply: |c| clock(c, 0.5) },
    Wrong { name: "clock 0.8", words: &["sample rate"], apply: |c| clock(c, 0.8) },
    Wrong {
        name: "attachment below",
        words: &["attachment"],
        apply: |c| {
            let t = c.plant.tether.as_mut().expect("a tether");
            t.p_origin_hook = Vec3::new(-t.p_origin_hook.x(), t.p_origin_hook.y(), t.p_origin_hook.z());
        },
    },
    Wrong {
        name: "ring below",
        words: &["ring is below"],
        apply: |c| {
            let t = c.plant.tether.as_mut().expect("a tether");
            t.p_tunnel_ring = Vec3::new(-t.p_tunnel_ring.x(), t.p_tunnel_ring.y(), t.p_tunnel_ring.z());
        },
    },
    Wrong { name: "mass in g", words: &["grams"], apply: |c| c.plant.vehicle.mass_kg *= 1e3 },
    Wrong { name: "mass in lb", words: &["pounds"], apply: |c| c.plant.vehicle.mass_kg *= 2.204_62 },
    Wrong { name: "mass 1.5", words: &["mass"], apply: |c| c.plant.vehicle.mass_kg *= 1.5 },
    Wrong { name: "mass half", words: &["mass"], apply: |c| c.plant.vehicle.mass_kg *= 0.5 },
    Wrong { name: "inertia twice", words: &["inertia"], apply: |c| inertia(c, 2.0) },
    Wrong { name: "inertia half", words: &["inertia"], apply: |c| inertia(c, 0.5) },
    Wrong { name: "inertia in g m2", words: &["inertia is in g m2"], apply: |c| inertia(c, 1e3) },
    Wrong { name: "inertia in kg cm2", words: &["inertia is in kg cm2"], apply: |c| inertia(c, 1e4) },
    Wrong { name: "radius for diameter", words: &["radius"], apply: |c| c.plant.vehicle.diameter_m *= 0.5 },
    Wrong { name: "diameter 1.3", words: &["diameter"], apply: |c| c.plant.vehicle.diameter_m *= 1.3 },
    Wrong { name: "diameter in feet", words: &["diameter"], apply: |c| c.plant.vehicle.diameter_m /= 0.3048 },
    Wrong { name: "gravity in ft/s2", words: &["gravity"], apply: |c| c.plant.environment.gravity_m_s2 = 32.174 },
    Wrong { name: "gravity in cm/s2", words: &["gravity"], apply: |c| c.plant.environment.gravity_m_s2 = 980.665 },
    Wrong { name: "gravity upward", words: &["gravity"], apply: |c| c.plant.environment.gravity_m_s2 *= -1.0 },
    Wrong { name: "frozen pose", words: &["frozen pose"], apply: |c| first(c, frozen) },
    Wrong { name: "repeated block", words: &["repeated block"], apply: |c| first(c, repeated) },
    Wrong {
        name: "roll by half a turn",
        words: &["jumps and stays"],
        apply: |c| first(c, |r| from_half(&mut r.attitude_rad[0], std::f64::consts::PI)),
    },
    Wrong { name: "attitude jump", words: &["jumps and stays"], apply: |c| first(c, |r| from_half(&mut r.attitude_rad[1], 0.1)) },
    Wrong { name: "position jump", words: &["jumps and stays"], apply: |c| first(c, |r| from_half(&mut r.position_m[1], 0.05)) },
    Wrong {
        name: "a run twice",
        words: &["given twice"],
        apply: |c| {
            let mut again = c.runs[0].clone();
            again.name.push_str("-again");
            c.runs.push(again);
        },
    },
    Wrong {
        name: "a run also as hold-out",
        words: &["given twice"],
        apply: |c| {
            let mut again = c.runs[1].clone();
            again.name.push_str("-held");
            again.used = Use::HoldOut;
            c.runs.push(again);
        },
    },
];
