//! sim tests: an independent simulator's run. In: the campaign `exact`. Out: whether ours stays with it.

use crate::common::*;
use windfall_model::frames::{EulerXyz, Rotation};
use windfall_model::{Flight, Integrator, Numerics, Plant, Release, TunnelSpeed};

fn exact(test: &str) -> Option<(Plant, Flight, Table)> {
    let folder = shared(test)?.join("data/campaigns/exact");
    let states = Table::read(&folder.join("states.csv"));
    let run = Table::read(&folder.join("run.csv"));
    let q = states.row(0, ["q_w", "q_x", "q_y", "q_z"]);
    let e = EulerXyz::from_rotation(Rotation::from_quaternion(q));
    let release = Release {
        position_m: states.row(0, ["Xcm_m", "Ycm_m", "Zcm_m"]),
        velocity_m_s: states.row(0, ["vX_m_s", "vY_m_s", "vZ_m_s"]),
        attitude_rad: [e.rx_rad, e.ry_rad, e.rz_rad],
        rates_rad_s: states.row(0, ["p_rad_s", "q_rad_s", "r_rad_s"]),
    };
    let mut order = flight(15.0, 150.0, 0.0, release);
    order.speed = TunnelSpeed::History { interval_s: 1.0 / 150.0, vw_m_s: run.column("VW_m_s") };
    order.ps_pa = run.column("ps_Pa")[0];
    order.ts_k = run.column("Ts_K")[0];
    Some((lander(), order, states))
}

fn distances(plant: &Plant, order: &Flight, states: &Table) -> [f64; 7] {
    let truth = flown(plant, order);
    let mut far = [0.0_f64; 7];
    for k in 0..states.rows.len() {
        let i = k * 15;
        let pairs = [
            worst(&truth.p_tunnel_cm[i], &states.row(k, ["Xcm_m", "Ycm_m", "Zcm_m"])),
            worst(&truth.v_tunnel_cm[i], &states.row(k, ["vX_m_s", "vY_m_s", "vZ_m_s"])),
            angle_between(truth.quaternion[i], states.row(k, ["q_w", "q_x", "q_y", "q_z"])),
            worst(&truth.w_tunnel_body[i], &states.row(k, ["p_rad_s", "q_rad_s", "r_rad_s"])),
            worst(&[truth.alpha_t_rad[i]], &states.row(k, ["alphaT_rad"])),
            worst(&[truth.airspeed_m_s[i]], &states.row(k, ["Vinf_m_s"])),
            worst(&[truth.tether_n[i]], &states.row(k, ["Ftr_N"])),
        ];
        for (f, p) in far.iter_mut().zip(pairs) {
            *f = f.max(p);
        }
    }
    far
}

/// The gate of the campaign: 1e-7 m, 1e-7 m/s, 1e-7 rad, 1e-7 rad/s over 15 s; α_T, V_∞ and tether force follow from them.
#[test]
fn pub_independent_simulator_is_followed_for_15_s() {
    let Some((plant, mut order, states)) = exact("pub_independent_simulator_is_followed_for_15_s") else { return };
    for method in [Integrator::Dop853, Integrator::Dopri5] {
        order.numerics = Numerics { method, ..Numerics::default() };
        let far = distances(&plant, &order, &states);
        eprintln!("{method:?}: {far:?}");
        assert!(far.iter().all(|f| *f < 1e-7), "{method:?}: {far:?}");
    }
}
