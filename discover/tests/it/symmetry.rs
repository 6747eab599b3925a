//! discover: what does not change a campaign's meaning does not change its closing. In: a flown campaign, and the same one with its runs in
//! another order, turned about the tunnel's axis, mirrored, at another time, split, at half the sample rate, on one thread. Out: the same
//! verdict; numbers within a fiftieth of a standard error, three tenths where samples are averaged.

#![expect(clippy::print_stdout, reason = "a test prints what it measured")]

use super::closing::{flown, with};
use super::common::families;
use windfall_discover::close::{Closing, Options, close};
use windfall_model::frames::Vec3;
use windfall_model::{Campaign, Data, Record, Run, Use};

/// Three runs of a lander with a swirling flow that its model does not declare.
fn campaign() -> Campaign {
    flown(5, |plant, _| with(plant, "swirl", &[0.02, 0.0, 7.5]))
}

fn each(mut c: Campaign, change: impl Fn(&mut Record)) -> Campaign {
    for run in &mut c.runs {
        if let Data::Tunnel(r) = &mut run.data {
            change(r);
        }
    }
    c
}

/// A quarter turn of the tunnel's axes about X: attitudes are `Rx·Ry·Rz`, so that only the first angle changes.
fn turned(mut c: Campaign) -> Campaign {
    let quarter = |v: Vec3<windfall_model::frames::Tunnel>| Vec3::new(v.x(), -v.z(), v.y());
    if let Some(t) = &mut c.plant.tether {
        t.p_tunnel_ring = quarter(t.p_tunnel_ring);
    }
    each(c, |r| {
        let [x, y, z] = r.position_m.clone();
        r.position_m = [x, z.iter().map(|v| -v).collect(), y];
        r.attitude_rad[0].iter_mut().for_each(|a| *a += std::f64::consts::FRAC_PI_2);
    })
}

/// Seen in a mirror across the plane of X and Z.
fn mirrored(mut c: Campaign) -> Campaign {
    let v = &mut c.plant.vehicle;
    v.p_origin_cm = Vec3::new(v.p_origin_cm.x(), -v.p_origin_cm.y(), v.p_origin_cm.z());
    (v.inertia.xy, v.inertia.yz) = (-v.inertia.xy, -v.inertia.yz);
    if let Some(t) = &mut c.plant.tether {
        t.p_tunnel_ring = Vec3::new(t.p_tunnel_ring.x(), -t.p_tunnel_ring.y(), t.p_tunnel_ring.z());
        t.p_origin_hook = Vec3::new(t.p_origin_hook.x(), -t.p_origin_hook.y(), t.p_origin_hook.z());
    }
    each(c, |r| {
        let [_, y, _] = &mut r.position_m;
        y.iter_mut().for_each(|v| *v = -*v);
        let [rx, _, rz] = &mut r.attitude_rad;
        rx.iter_mut().chain(rz).for_each(|a| *a = -*a);
    })
}

/// A record whose columns are made of another's, one like the other.
fn made(r: &Record, of: impl Fn(&[f64]) -> Vec<f64>) -> Record {
    let mut out = r.clone();
    out.bridged.clear();
    let change = |series: &mut Vec<f64>| *series = of(series);
    change(&mut out.t_s);
    out.channels_mut().into_iter().for_each(change);
    out.slow_mut().into_iter().flatten().for_each(change);
    out
}

/// Pairs of samples by their mean: half the rate, nearly all the information.
fn paired(r: &Record) -> Record {
    made(r, |x| x.chunks_exact(2).map(|p| 0.5 * (p[0] + p[1])).collect())
}

fn split(mut c: Campaign) -> Campaign {
    let halves = |run: &Run| -> Vec<Run> {
        let Data::Tunnel(r) = &run.data else { return vec![run.clone()] };
        let half = r.len() / 2;
        let part = |keep: std::ops::Range<usize>| made(r, |x| x[keep.clone()].to_vec());
        let of = |name: &str, r: Record| Run { name: format!("{}-{name}", run.name), data: Data::Tunnel(r), ..run.clone() };
        vec![of("a", part(0..half)), of("b", part(half..r.len()))]
    };
    c.runs = c.runs.iter().flat_map(halves).collect();
    c
}

fn closed(c: &Campaign) -> Closing {
    close(c, &Options::default()).expect("closes")
}

/// Largest difference of a number's size over what `unit` makes of both standard errors: of aerodynamics and of strengths.
fn apart(a: &Closing, b: &Closing, unit: fn(f64, f64) -> f64) -> f64 {
    let of = |c: &Closing| -> Vec<(String, f64, f64)> {
        let aero = c.after.parameters.iter();
        let all = aero.chain(c.effects.iter().flat_map(|e| &e.parameters));
        all.filter_map(|p| Some((p.name.clone(), p.estimate, p.std_error?))).collect()
    };
    let (a, b) = (of(a), of(b));
    assert_eq!(a.len(), b.len(), "as many numbers");
    let one = |(name, x, s): &(String, f64, f64)| {
        let (_, y, other) = b.iter().find(|(n, ..)| n == name).expect("the same numbers");
        (x.abs() - y.abs()).abs() / unit(*s, *other)
    };
    a.iter().map(one).max_by(f64::total_cmp).unwrap_or(f64::NAN)
}

fn same(what: &str, base: &Closing, other: &Closing, within: f64) {
    let apart = apart(base, other, |s, _| s);
    println!("{what:12} {:?} {}, {apart:.4} standard errors apart", other.verdict, families(other).join("+"));
    assert_eq!(families(base), families(other), "{what}");
    assert_eq!(base.verdict, other.verdict, "{what}");
    assert!(apart <= within, "{what}: {apart} of {within}");
}

/// All changes of axes, order and time at once, and the same bytes on one thread. The nightly test has each alone.
#[test]
fn law_the_same_campaign_closes_the_same_in_another_room() {
    let base = campaign();
    let closing = closed(&base);
    assert_eq!(families(&closing), ["swirl"]);
    let mut other = each(mirrored(turned(base.clone())), |r| r.t_s.iter_mut().for_each(|t| *t += 1000.0));
    other.runs.reverse();
    same("all", &closing, &closed(&other), 0.02);
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool");
    let alone = one.install(|| closed(&base));
    assert_eq!(serde_json::to_string(&closing).ok(), serde_json::to_string(&alone).ok(), "the same bytes on one thread");
}

#[test]
#[ignore = "slow: nightly"]
fn law_the_same_campaign_closes_the_same() {
    let base = campaign();
    assert!(base.runs.iter().any(|r| r.used == Use::Identify));
    let closing = closed(&base);
    assert_eq!(families(&closing), ["swirl"]);
    let mut reversed = base.clone();
    reversed.runs.reverse();
    same("order", &closing, &closed(&reversed), 0.02);
    same("turned", &closing, &closed(&turned(base.clone())), 0.02);
    same("mirrored", &closing, &closed(&mirrored(base.clone())), 0.02);
    let later = each(base.clone(), |r| r.t_s.iter_mut().for_each(|t| *t += 1000.0));
    same("later", &closing, &closed(&later), 0.02);
    let rare = each(base.clone(), |r| *r = paired(r));
    same("half rate", &closing, &closed(&rare), 0.3);
    // Parts that go on where another ended are one flight again, whatever their clocks and order.
    let mut parts = each(split(base.clone()), |r| {
        let start_s = r.t_s[0];
        r.t_s.iter_mut().for_each(|t| *t -= start_s);
    });
    same("split", &closing, &closed(&split(base.clone())), 0.02);
    parts.runs.reverse();
    same("split, own clocks", &closing, &closed(&parts), 0.02);
}
