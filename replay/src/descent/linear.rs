//! replay: linear theory of a body that falls steadily. In: planet, body, height. Out: terminal speed, frequency and damping of the pitch.
//!
//! States W (air velocity across, body z), q and θ (nose from the vertical), small, at the terminal speed V (Etkin and Reid 1996, ch. 4,
//! with the flight path downward): `Ẇ = V q − (q̄ S C_N,α/m V) W + g θ`, `I q̇ = q̄ S c (C_m,α W/V + C_m,(q+α̇)/2 (q + Ẇ/V) c/4V + C_m,q q c/2V)`,
//! `θ̇ = q`. Its complex pair is the pitch mode. Products of inertia and roll are left out.

use nalgebra::Matrix3;
use serde::{Deserialize, Serialize};
use windfall_model::frames::Vec3;
use windfall_model::planet::{FlightStart, Geodetic, PlanetBody, PlanetScenario};
use windfall_model::{Coefficient, FlowState, Variable};

/// Angle over which derivatives are taken, rad; terms of third order leave its square.
const SMALL_RAD: f64 = 1e-4;
/// Rounds to the terminal speed where drag depends on speed; it is found at once where it does not.
const ROUNDS: usize = 50;

/// Linear theory at one height.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SteadyFall {
    /// Height, m.
    pub height_m: f64,
    /// Density, kg/m³.
    pub density_kg_m3: f64,
    /// Terminal speed √(2 m g/(ρ S C_A)), m/s.
    pub terminal_speed_m_s: f64,
    /// Frequency of the pitch mode, Hz; none where it does not oscillate.
    pub pitch_frequency_hz: Option<f64>,
    /// Rate at which it decays, 1/s; of the slowest motion where nothing oscillates. Below zero it grows.
    pub pitch_damping_per_s: f64,
}

/// Linear theory of a body at a height of the flight's place; none in a vacuum or for a body that drag does not hold back.
#[must_use]
pub fn steady_fall(scenario: &PlanetScenario, body: &PlanetBody, start: &FlightStart, height_m: f64) -> Option<SteadyFall> {
    let planet = &scenario.planet;
    let density_kg_m3 = planet.atmosphere.as_ref()?.at(height_m).density_kg_m3();
    let place = Geodetic { height_m, ..start.place };
    let down = place.r_inertial_ned() * Vec3::new(0.0, 0.0, 1.0);
    let p = planet.figure.position(&place);
    let gravity = planet.gravity.acceleration(p, down, &planet.figure).dot(down);
    let (mass, area) = (body.vehicle.mass_kg, body.reference.area_m2);
    let mut speed = 10.0;
    for _ in 0..ROUNDS {
        let drag = coefficient(body, Coefficient::CA, speed, 0.0, |_| {});
        let next = (2.0 * mass * gravity / (density_kg_m3 * area * drag)).sqrt();
        let settled = (next - speed).abs() <= 1e-14 * speed;
        speed = next;
        if settled || !speed.is_finite() {
            break;
        }
    }
    speed.is_finite().then(|| {
        mode(
            body,
            SteadyFall { height_m, density_kg_m3, terminal_speed_m_s: speed, pitch_frequency_hz: None, pitch_damping_per_s: 0.0 },
            gravity,
        )
    })
}

/// A coefficient at an angle of attack in the pitch plane, with flow variables changed.
fn coefficient(body: &PlanetBody, which: Coefficient, speed: f64, alpha: f64, change: impl Fn(&mut FlowState)) -> f64 {
    let v = Vec3::new(speed * alpha.cos(), 0.0, speed * alpha.sin());
    let mut flow = FlowState::new(v, Vec3::zero(), Vec3::zero(), body.reference.chord_m);
    change(&mut flow);
    body.aero.coefficients(&flow)[which as usize]
}

fn mode(body: &PlanetBody, mut fall: SteadyFall, gravity: f64) -> SteadyFall {
    let (v, chord, mass) = (fall.terminal_speed_m_s, body.reference.chord_m, body.vehicle.mass_kg);
    let slope = |which| {
        let at = |alpha| coefficient(body, which, v, alpha, |_| {});
        (at(SMALL_RAD) - at(-SMALL_RAD)) / (2.0 * SMALL_RAD)
    };
    let by = |variable: Variable| {
        let at = |x: f64| coefficient(body, Coefficient::Cm, v, 0.0, |f| f.values[variable as usize] = x);
        (at(SMALL_RAD) - at(-SMALL_RAD)) / (2.0 * SMALL_RAD)
    };
    let qs = 0.5 * fall.density_kg_m3 * v * v * body.reference.area_m2;
    let cn = slope(Coefficient::CN);
    // The normal force acts at the origin, ahead of or behind the c.m.
    let cm = slope(Coefficient::Cm) - cn * body.vehicle.p_origin_cm.x() / chord;
    let a = qs * cn / (mass * v);
    let per = qs * chord / body.vehicle.inertia.yy;
    let (both, rate) = (per * by(Variable::PitchDamping) * chord / (4.0 * v), per * by(Variable::PitchRate) * chord / (2.0 * v));
    #[rustfmt::skip]
    let matrix = Matrix3::new(
        -a, v, gravity,
        (per * cm - both * a) / v, 2.0 * both + rate, both * gravity / v,
        0.0, 1.0, 0.0,
    );
    let eigenvalues = matrix.complex_eigenvalues();
    let pair = eigenvalues.iter().find(|e| e.im > 0.0);
    let slowest = eigenvalues.iter().map(|e| -e.re).fold(f64::INFINITY, f64::min);
    fall.pitch_frequency_hz = pair.map(|e| e.im / std::f64::consts::TAU);
    fall.pitch_damping_per_s = pair.map_or(slowest, |e| -e.re);
    fall
}

#[cfg(test)]
mod tests;
