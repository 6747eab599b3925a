//! sim: a flight from release to end. In: plant, flight, seed. Out: truth, and with the instruments the record.

use crate::error::SimError;
use crate::integrate::{integrate, outside, samples};
use crate::record::record;
use crate::seed::Seed;
use crate::setup::Setup;
use crate::smooth::hermite;
use crate::truth::{End, Flown, Truth, angles};
use nalgebra::SVector;
use windfall_model::frames::{EulerXyz, Vec3};
use windfall_model::{Flight, Plant, TestSection};

/// Flies and records. The plant must already be the one of this run (`Plant::for_run`).
///
/// # Errors
/// A number that cannot be flown, something that became NaN, or an integrator that gave up.
pub fn fly(plant: &Plant, flight: &Flight, seed: Seed) -> Result<Flown, SimError> {
    let (truth, end, steps) = flown(plant, flight, seed)?;
    let record = record(plant, flight, &truth, seed);
    Ok(Flown { truth, record, end, steps })
}

/// Flies without instruments.
///
/// # Errors
/// As [`fly`].
pub fn fly_truth(plant: &Plant, flight: &Flight, seed: Seed) -> Result<(Truth, End), SimError> {
    flown(plant, flight, seed).map(|(truth, end, _)| (truth, end))
}

fn flown(plant: &Plant, flight: &Flight, seed: Seed) -> Result<(Truth, End, u64), SimError> {
    let setup = Setup::new(plant, flight, seed)?;
    within(flight)?;
    match setup.states() {
        14 => sampled::<14>(&setup, flight),
        16 => sampled::<16>(&setup, flight),
        18 => sampled::<18>(&setup, flight),
        _ => sampled::<20>(&setup, flight),
    }
}

/// The release must be inside the test section.
pub(crate) fn within(flight: &Flight) -> Result<(), SimError> {
    let p = flight.release.position_m;
    if flight.section.is_some_and(|s| outside(&s, p)) {
        let what = "release position: distance from the middle of the test section, m";
        return Err(SimError::Setup { what, value: p[0].hypot(p[1]).hypot(p[2]), allowed: "inside wall and nets" });
    }
    Ok(())
}

fn sampled<const N: usize>(setup: &Setup<'_>, flight: &Flight) -> Result<(Truth, End, u64), SimError> {
    let (seen, steps) = integrate(setup, flight, start::<N>(setup, flight), |states| {
        let (kept, end) = ended(states, flight);
        let mut truth = Truth::with_capacity(kept);
        for (k, y) in states.iter().take(kept).enumerate() {
            observe(setup, k as f64 / flight.rate_hz, y, &mut truth);
        }
        (truth, end)
    })?;
    Ok((seen.0, seen.1, steps))
}

/// State at release.
pub(crate) fn start<const N: usize>(setup: &Setup<'_>, flight: &Flight) -> SVector<f64, N> {
    let r = flight.release;
    let [rx_rad, ry_rad, rz_rad] = r.attitude_rad;
    let q = EulerXyz { rx_rad, ry_rad, rz_rad }.r_tunnel_body().to_quaternion();
    let mut y = SVector::<f64, N>::zeros();
    y.as_mut_slice()[0..3].copy_from_slice(&r.position_m);
    y.as_mut_slice()[3..6].copy_from_slice(&r.velocity_m_s);
    y.as_mut_slice()[6..10].copy_from_slice(&q);
    y.as_mut_slice()[10..13].copy_from_slice(&r.rates_rad_s);
    if let (Some(hand), Some(k)) = (&setup.hand, setup.hand_index) {
        y.as_mut_slice()[k..k + 2].copy_from_slice(&hand.start());
    }
    y
}

/// Appends one sample to the truth.
fn observe<const N: usize>(setup: &Setup<'_>, t_s: f64, y: &SVector<f64, N>, truth: &mut Truth) {
    let s = setup.sight(y);
    let q = [y[6], y[7], y[8], y[9]];
    let per_norm = 1.0 / q.iter().map(|c| c * c).sum::<f64>().sqrt();
    let [u, v, w] = s.v_air_cm.to_array();
    let rates = Vec3::new(y[10], y[11], y[12]);
    let last_roll = truth.attitude_rad.last().map(|a| a[0]);
    truth.t_s.push(t_s);
    truth.p_tunnel_cm.push(s.p.to_array());
    truth.v_tunnel_cm.push(s.v.to_array());
    truth.quaternion.push(q.map(|c| c * per_norm));
    truth.w_tunnel_body.push(rates.to_array());
    truth.attitude_rad.push(angles(s.r_tunnel_body, last_roll.unwrap_or(0.0)));
    truth.vw_m_s.push(s.vw_m_s);
    truth.alpha_t_rad.push(v.hypot(w).atan2(u));
    truth.airspeed_m_s.push(s.v_air_cm.norm());
    truth.tether_n.push(setup.tether_n(&s, rates));
}

/// How many samples are inside, and how the flight ended.
fn ended<const N: usize>(states: &[SVector<f64, N>], flight: &Flight) -> (usize, End) {
    let count = samples(flight);
    let Some(s) = &flight.section else { return (count.min(states.len()), End::Completed) };
    match states.iter().take(count).position(|y| outside(s, [y[0], y[1], y[2]])) {
        None => (count.min(states.len()), End::Completed),
        Some(k) => (k, crossing(s, (k - 1) as f64 / flight.rate_hz, 1.0 / flight.rate_hz, &states[k - 1], &states[k])),
    }
}

/// The first limit that is crossed between two samples, the time found by bisection on the cubic through both samples'
/// positions and velocities (error of fourth order in the interval: 1e-9 m at 150 Hz).
pub(crate) fn crossing<const N: usize>(s: &TestSection, t_s: f64, dt: f64, a: &SVector<f64, N>, b: &SVector<f64, N>) -> End {
    let place = |x: f64| -> [f64; 3] { std::array::from_fn(|k| hermite(x, dt, [a[k], b[k]], [a[3 + k], b[3 + k]])) };
    let (mut inside, mut beyond) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (inside + beyond);
        if outside(s, place(middle)) { beyond = middle } else { inside = middle }
    }
    let t_s = t_s + beyond * dt;
    let p = place(beyond);
    if p[0] < s.top_x_m {
        End::UpperNet { t_s }
    } else if p[0] > s.bottom_x_m {
        End::LowerNet { t_s }
    } else {
        End::Wall { t_s }
    }
}
