//! replay tests: linear theory of a fall against the equations of plane motion, differentiated by finite differences, and their eigenvalues.

use super::*;
use nalgebra::{Matrix4, Vector4};
use std::path::Path;
use windfall_model::{Aero, Factor, Structure};

const HEIGHT_M: f64 = 700.0;
/// Axial force at rest and with speed, normal and static moment by sin α and its cube, moment by (q + α̇)/2 and by q, place of the c.m.
#[derive(Clone, Copy)]
struct Body {
    ca: [f64; 2],
    cn: [f64; 2],
    cm: [f64; 2],
    both: f64,
    rate: f64,
    x_m: f64,
}

const MASS_KG: f64 = 640.0;
const INERTIA_KG_M2: f64 = 170.0;
const AREA_M2: f64 = 0.83;
const CHORD_M: f64 = 0.71;

/// The bundled descent on Venus, with this body.
fn scenario(b: Body) -> PlanetScenario {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/planet/venus-dispersions.toml");
    let mut s = windfall_scenarios::read_planet(&path).unwrap_or_else(|e| panic!("{e}")).scenario;
    let structure = Structure { name: "plane".to_owned(), parameters: Vec::new(), contributions: Vec::new() };
    let mut aero = Aero::new(structure, Vec::new());
    let power = Factor::Power;
    aero.add(Coefficient::CA, b.ca[0], 1.0, &[power(Variable::CosAlphaT, 1)]);
    aero.add(Coefficient::CA, b.ca[1], 1.0, &[power(Variable::CosAlphaT, 1), power(Variable::Speed, 1)]);
    for (which, [first, third]) in [(Coefficient::CN, b.cn), (Coefficient::Cm, b.cm)] {
        aero.add(which, first, 1.0, &[power(Variable::SinAlphaT, 1), power(Variable::CosPhi, 1)]);
        aero.add(which, third, 1.0, &[power(Variable::SinAlphaT, 3), power(Variable::CosPhi, 1)]);
    }
    aero.add(Coefficient::Cm, b.both, 1.0, &[power(Variable::PitchDamping, 1)]);
    aero.add(Coefficient::Cm, b.rate, 1.0, &[power(Variable::PitchRate, 1)]);
    s.body.aero = aero;
    s.body.vehicle.mass_kg = MASS_KG;
    s.body.vehicle.inertia.yy = INERTIA_KG_M2;
    s.body.vehicle.p_origin_cm = Vec3::new(b.x_m, 0.0, 0.0);
    (s.body.reference.area_m2, s.body.reference.chord_m) = (AREA_M2, CHORD_M);
    s
}

/// Rates of u, w, q, θ in a vertical plane, x axis downward at θ = 0: Newton and Euler with F = q̄ S (−C_A, −C_N), the force at the origin.
fn rates(b: Body, density: f64, gravity: f64, x: Vector4<f64>) -> Vector4<f64> {
    let [u, w, q, theta] = [x[0], x[1], x[2], x[3]];
    let speed = u.hypot(w);
    let (s, c) = (w / speed, u / speed);
    let qs = density / 2.0 * speed.powi(2) * AREA_M2;
    let axial = -qs * (b.ca[0] + b.ca[1] * speed) * c;
    let normal = -qs * (b.cn[0] * s + b.cn[1] * s.powi(3));
    let (du, dw) = (axial / MASS_KG - q * w + gravity * theta.cos(), normal / MASS_KG + q * u + gravity * theta.sin());
    let alpha_rate = (u * dw - w * du) / speed.powi(2);
    let hat = CHORD_M / (2.0 * speed);
    let cm = b.cm[0] * s + b.cm[1] * s.powi(3) + b.both * hat * f64::midpoint(q, alpha_rate) + b.rate * hat * q;
    Vector4::new(du, dw, (qs * CHORD_M * cm + normal * b.x_m) / INERTIA_KG_M2, q)
}

/// Terminal speed: drag is weight, gravity Newton's over a sphere. Frequency and damping: eigenvalues of the four equations' matrix by central
/// differences at that fall, where the fourth motion, that of the speed, is apart. Differences over 1e-5 leave 1e-10, those of the code 1e-8.
/// The second body is unstable and does not oscillate: its slowest motion grows.
#[test]
fn exact_modes_of_plane_motion() {
    let stable = Body { ca: [5.1, 0.23], cn: [3.4, -2.0], cm: [-1.9, 2.5], both: -3.7, rate: -2.9, x_m: 0.13 };
    let unstable = Body { cm: [1.3, 2.5], both: -31.0, rate: -67.0, ..stable };
    for (b, oscillates) in [(stable, true), (unstable, false)] {
        let s = scenario(b);
        let density = s.planet.atmosphere.as_ref().expect("air").at(HEIGHT_M).density_kg_m3();
        let gravity = 3.248_585_92e14 / (6_051_800.0_f64 + HEIGHT_M).powi(2);
        let fall = steady_fall(&s, &s.body, &s.flights[0].start, HEIGHT_M).expect("air");
        let v = fall.terminal_speed_m_s;
        let rest = Vector4::new(v, 0.0, 0.0, 0.0);
        assert!(rates(b, density, gravity, rest).amax() < 1e-11 * gravity, "{fall:?}");
        let columns: [Vector4<f64>; 4] = std::array::from_fn(|k| {
            let mut by = Vector4::zeros();
            by[k] = 1e-5;
            (rates(b, density, gravity, rest + by) - rates(b, density, gravity, rest - by)) / 2e-5
        });
        let eigenvalues = Matrix4::from_columns(&columns).complex_eigenvalues();
        let pair = eigenvalues.iter().find(|e| e.im > 1e-9);
        assert_eq!((pair.is_some(), fall.pitch_frequency_hz.is_some()), (oscillates, oscillates), "{eigenvalues}");
        let slowest = eigenvalues.iter().map(|e| e.re).fold(f64::NEG_INFINITY, f64::max);
        let near = |x: f64, y: f64| assert!((x / y - 1.0).abs() < 1e-7, "{x}, not {y}: {fall:?} {eigenvalues}");
        near(-fall.pitch_damping_per_s, pair.map_or(slowest, |e| e.re));
        if let (Some(e), Some(hz)) = (pair, fall.pitch_frequency_hz) {
            near(std::f64::consts::TAU * hz, e.im);
        }
    }
}

/// The speed that coefficients see is that of the air, whatever the angle of attack; what is changed is changed after.
#[test]
fn exact_coefficient_at_an_angle() {
    let b = Body { ca: [5.1, 0.23], cn: [3.4, -2.0], cm: [-1.9, 2.5], both: -3.7, rate: -2.9, x_m: 0.13 };
    let body = scenario(b).body;
    let (speed, alpha) = (7.3, 0.6_f64);
    let axial = coefficient(&body, Coefficient::CA, speed, alpha, |_| {});
    assert!((axial - (5.1 + 0.23 * speed) * alpha.cos()).abs() < 1e-14);
    let moment = coefficient(&body, Coefficient::Cm, speed, -alpha, |f| f.values[Variable::PitchRate as usize] = 0.3);
    assert!((moment + -1.9 * alpha.sin() + 2.5 * alpha.sin().powi(3) + 2.9 * 0.3).abs() < 1e-14, "{moment}");
}
