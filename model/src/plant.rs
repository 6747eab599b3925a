//! model: the whole physical model as plain data, and the forces it gives. In: motion and tunnel speed. Out: wrench on the body.

use crate::aero::{Aero, Wrench, wrench_at_cm};
use crate::air::{Environment, dynamic_pressure_pa};
use crate::disturbance::{Disturbance, Drift, RunNumber, RunScatter, Turbulence, WakeShedding};
use crate::flow::{FlowState, MeanFlow};
use crate::frames::{Body, Rotation, Tunnel, Vec3};
use crate::free_flight::FreeFlight;
use crate::point::{CoefficientTable, PointAir, PointMass};
use crate::sensors::Sensors;
use crate::tether::Tether;
use crate::vehicle::Vehicle;

/// Vehicle + aerodynamics + tether + flow + sensors. Every physical effect is a few of its numbers, null when declared absent.
#[derive(Clone, Debug, PartialEq)]
pub struct Plant {
    /// Mass side.
    pub vehicle: Vehicle,
    /// Aerodynamic coefficients.
    pub aero: Aero,
    /// Safety tether; none in free flight.
    pub tether: Option<Tether>,
    /// Mean flow.
    pub flow: MeanFlow,
    /// Random gusts.
    pub turbulence: Turbulence,
    /// Random wake moment.
    pub shedding: WakeShedding,
    /// Slow drift of the instruments.
    pub drift: Drift,
    /// What differs from run to run.
    pub scatter: RunScatter,
    /// Contacts with a pole or line.
    pub contacts: Vec<Contact>,
    /// Gravity and gas.
    pub environment: Environment,
    /// Instruments.
    pub sensors: Sensors,
    /// What a body without attitude has beyond drag; unused by tunnel runs.
    pub point: PointMass,
    /// What a rigid body in free flight through air at rest has beyond its mass; none of other bodies.
    pub free_flight: Option<FreeFlight>,
}

/// Speed (m/s) at which drag and tether carry the weight at zero angle: `q = (m g + W_tr)/(C_A S + (C_D S)_tr)`, in air of
/// the given density (kg/m³). Where C_A depends on speed the balance is iterated.
#[must_use]
pub fn trim_speed(plant: &Plant, density_kg_m3: f64) -> f64 {
    let v = &plant.vehicle;
    let (weight_n, drag_area_m2) = plant.tether.as_ref().map_or((0.0, 0.0), |t| (t.weight_n, t.drag_area_m2));
    let weight = v.mass_kg * plant.environment.gravity_m_s2 + weight_n;
    let balance = |speed: f64| {
        let flow = FlowState::new(Vec3::new(speed, 0.0, 0.0), Vec3::zero(), Vec3::zero(), v.diameter_m);
        let drag = plant.aero.coefficients(&flow)[0] * v.area_m2() + drag_area_m2;
        (2.0 * weight / (drag * density_kg_m3)).sqrt()
    };
    // A fixed point with slope −½ V C_A'/C_A: damped by half it converges for any plausible dependence on speed.
    let mut speed = balance(1.0);
    for _ in 0..200 {
        let next = 0.5 * (speed + balance(speed));
        if (next - speed).abs() <= 1e-15 * speed {
            break;
        }
        speed = next;
    }
    balance(speed)
}

/// A smooth pulse of force and moment inside a run: `sin²(π (t − start)/duration)` in time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Index of the run in its campaign.
    pub run: usize,
    /// Start from the run's first sample, s.
    pub start_s: f64,
    /// Duration, s.
    pub duration_s: f64,
    /// Linear impulse, N s, body axes.
    pub impulse: Vec3<Body>,
    /// Angular impulse about the c.m., N m s, body axes.
    pub angular_impulse: Vec3<Body>,
}

impl Contact {
    /// Force and moment at time `t_s` from the run's first sample.
    #[must_use]
    #[inline]
    pub fn wrench(&self, t_s: f64) -> Wrench {
        let x = (t_s - self.start_s) / self.duration_s;
        if !(0.0..=1.0).contains(&x) {
            return Wrench::default();
        }
        let rate = 2.0 * (std::f64::consts::PI * x).sin().powi(2) / self.duration_s;
        Wrench { f: self.impulse * rate, m: self.angular_impulse * rate }
    }
}

/// Motion at one instant, and its rates. Everything a force may depend on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Time from the run's first sample, s.
    pub t_s: f64,
    /// c.m. position, m.
    pub p_tunnel_cm: Vec3<Tunnel>,
    /// c.m. velocity, m/s.
    pub v_tunnel_cm: Vec3<Tunnel>,
    /// Attitude.
    pub r_tunnel_body: Rotation<Tunnel, Body>,
    /// Body rates p, q, r, rad/s.
    pub w_tunnel_body: Vec3<Body>,
    /// Inertial acceleration of the c.m., m/s², tunnel axes.
    pub a_tunnel_cm: Vec3<Tunnel>,
    /// Rate of the body-rate components, rad/s².
    pub w_tunnel_body_rate: Vec3<Body>,
}

/// The air at one instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AirState {
    /// Tunnel speed V_W, m/s, upward positive.
    pub vw_m_s: f64,
    /// Its rate, m/s².
    pub vw_rate_m_s2: f64,
    /// Density, kg/m³.
    pub density_kg_m3: f64,
    /// Gust velocity and its rate, tunnel axes, m/s and m/s²; zero in a declared model.
    pub gust: Vec3<Tunnel>,
    /// Rate of the gust following the model, m/s².
    pub gust_rate: Vec3<Tunnel>,
    /// Random increments of the six coefficients (C_A, C_Y, C_N, C_l, C_m, C_n); zero in a declared model.
    pub coefficient_noise: [f64; 6],
}

/// Rate of turning below which dry friction gives way, rad/s: a tenth of a degree in two seconds, far below any swing that an encoder
/// sees, so that the step at rest is smooth (Armstrong-Helouvry, Dupont and Canudas de Wit 1994).
const SLIP_RAD_S: f64 = 1e-3;

impl Plant {
    /// Flow variables and dynamic pressure (Pa) of a motion in the air (thesis B.37-B.52).
    #[must_use]
    pub fn flow_state(&self, m: &Motion, air: &AirState) -> (FlowState, f64) {
        let r_body_tunnel = m.r_tunnel_body.inverse();
        let wind = self.flow.wind(m.p_tunnel_cm, m.v_tunnel_cm, air.vw_m_s, air.vw_rate_m_s2);
        let v_air_cm = r_body_tunnel * (m.v_tunnel_cm - wind.v_tunnel_air - air.gust);
        let inertial = r_body_tunnel * (m.a_tunnel_cm - wind.a_tunnel_air - air.gust_rate);
        let v_air_cm_rate = inertial - m.w_tunnel_body.cross(v_air_cm);
        let f = FlowState::new(v_air_cm, v_air_cm_rate, m.w_tunnel_body, self.vehicle.diameter_m);
        (f, dynamic_pressure_pa(air.density_kg_m3, v_air_cm.norm()))
    }

    /// All forces but gravity and inertia, and their moment about the c.m., body axes. The motion's accelerations matter for
    /// wind-angle rates and for apparent mass; the loose mass, which has a state of its own, is not in it.
    #[must_use]
    pub fn wrench(&self, m: &Motion, air: &AirState) -> Wrench {
        let (f, q_pa) = self.flow_state(m, air);
        let mut c = self.aero.coefficients(&f);
        for (ci, noise) in c.iter_mut().zip(air.coefficient_noise) {
            *ci += noise;
        }
        let v = &self.vehicle;
        let mut total = wrench_at_cm(&c, q_pa, v.area_m2(), v.diameter_m, v.p_origin_cm);
        if let Some(tether) = &self.tether {
            let line = tether.line(m.p_tunnel_cm, m.v_tunnel_cm, m.r_tunnel_body, m.w_tunnel_body, v.p_origin_cm);
            total += tether.wrench(&line, q_pa, v.p_origin_cm);
        }
        total += self.apparent_wrench(m, air);
        for contact in &self.contacts {
            total += contact.wrench(m.t_s);
        }
        total
    }

    /// Reaction of the air that is accelerated with the body (Kirchhoff; Lamb 1932, §124): with `u` the c.m.'s velocity seen
    /// from the air, `P = (m_x, m_r, m_r)·u` and `H = (0, I_r, I_r)·ω`, force `−(Ṗ + ω × P)` and moment
    /// `−(Ḣ + ω × H + u × P)`. The last term is the Munk moment of steady flow.
    #[must_use]
    pub fn apparent_wrench(&self, m: &Motion, air: &AirState) -> Wrench {
        let k = &self.vehicle.apparent;
        if k.is_null() {
            return Wrench::default();
        }
        let r_body_tunnel = m.r_tunnel_body.inverse();
        let wind = self.flow.wind(m.p_tunnel_cm, m.v_tunnel_cm, air.vw_m_s, air.vw_rate_m_s2);
        let w = m.w_tunnel_body;
        let u = r_body_tunnel * (m.v_tunnel_cm - wind.v_tunnel_air - air.gust * k.in_gusts);
        let u_rate = r_body_tunnel * (m.a_tunnel_cm - wind.a_tunnel_air - air.gust_rate * k.in_gusts) - w.cross(u);
        let mass = |v: Vec3<Body>| Vec3::new(k.axial_kg * v.x(), k.radial_kg * v.y(), k.radial_kg * v.z());
        let inertia = |v: Vec3<Body>| Vec3::new(0.0, k.transverse_kg_m2 * v.y(), k.transverse_kg_m2 * v.z());
        let impulse = mass(u);
        Wrench {
            f: -(mass(u_rate) + w.cross(impulse)),
            m: -(inertia(m.w_tunnel_body_rate) + w.cross(inertia(w)) * (1.0 - k.unturned) + u.cross(impulse)),
        }
    }

    /// True when forces depend on the accelerations they cause (through α̇ in a force, or apparent mass), so that a simulator
    /// must solve for them; moments that depend on α̇ alone do not count.
    #[must_use]
    pub fn has_algebraic_loop(&self) -> bool {
        use crate::aero::{Coefficient as C, Factor};
        use crate::flow::Variable as V;
        let damps = |f: &Factor| {
            matches!(f, Factor::Power(V::PitchDamping | V::YawDamping, _) | Factor::Bump(V::PitchDamping | V::YawDamping, _))
        };
        let force = |c: C| matches!(c, C::CA | C::CY | C::CN);
        !self.vehicle.apparent.is_null()
            || self.aero.structure.contributions.iter().any(|k| force(k.coefficient) && k.term.factors.iter().any(damps))
            || self.aero.extra.iter().any(|(c, _, t)| force(*c) && t.factors.iter().any(damps))
    }

    /// Random inputs at mean airspeed `speed` (m/s), each with its spectrum: turbulence, wake shedding, drift of instruments, and numbers that
    /// differ from run to run.
    #[must_use]
    pub fn disturbances(&self, speed_m_s: f64) -> Vec<Disturbance> {
        let mut all = self.turbulence.disturbances(speed_m_s);
        all.extend(self.shedding.disturbances(speed_m_s, self.vehicle.diameter_m));
        all.extend(self.drift.disturbances());
        all.extend(self.scatter.disturbances());
        all
    }

    /// Changes a number that may differ from run to run by that much, in its unit.
    pub fn change(&mut self, number: RunNumber, by: f64) {
        match number {
            RunNumber::Mass => self.vehicle.mass_kg *= 1.0 + by,
            RunNumber::Attachment(axis) => {
                if let Some(tether) = &mut self.tether {
                    tether.p_origin_hook.xyz[axis] += by;
                }
            }
            RunNumber::Aero(place) => {
                if let Some(value) = self.aero.values.get_mut(place) {
                    *value *= 1.0 + by;
                }
            }
        }
    }

    /// The plant as it acts in run number `run` with that run's known settings: contacts of other runs are dropped, and
    /// settings become available to a point mass.
    #[must_use]
    pub fn for_run(&self, run: usize, inputs: &[f64]) -> Self {
        let mut plant = self.clone();
        plant.contacts.retain(|c| c.run == run);
        plant.point.inputs = inputs.to_vec();
        plant
    }

    /// Drag coefficient of a body without attitude at this run's settings, where its table over Mach number has that value (one without a table).
    fn point_drag(&self, of_table: f64) -> f64 {
        self.aero.values.first().copied().unwrap_or(0.0) * of_table
            + self.aero.extra.iter().map(|(_, value, _)| value).sum::<f64>()
            + self.point.following(0.0, &self.point.drag_per_input)
    }

    /// Least drag coefficient at this run's settings: over Mach number of a body without attitude, at angles of zero of a rigid one. Below zero
    /// the air would push a body on.
    #[must_use]
    pub fn least_drag(&self) -> f64 {
        if self.free_flight.is_some() {
            return self.aero.coefficients(&FlowState::ahead())[crate::aero::Coefficient::CA as usize];
        }
        let table = self.point.drag_over_mach.as_ref().map_or([1.0; 2], CoefficientTable::ends);
        table.map(|of_table| self.point_drag(of_table)).into_iter().fold(f64::INFINITY, f64::min)
    }

    /// Acceleration of a point mass, m/s², tunnel axes (X down): gravity, quadratic drag along −v, lift across v in the
    /// vertical plane of flight, buoyancy, apparent mass. `v` is the velocity in still air, m/s.
    #[must_use]
    pub fn point_acceleration_in(&self, v: Vec3<Tunnel>, air: PointAir) -> Vec3<Tunnel> {
        let density_kg_m3 = air.density_kg_m3;
        let p = &self.point;
        let d = self.vehicle.diameter_m;
        let displaced_kg = density_kg_m3 * std::f64::consts::PI / 6.0 * d.powi(3);
        let speed = v.norm();
        let half_rho_s = 0.5 * density_kg_m3 * self.vehicle.area_m2();
        let of_table = p.drag_over_mach.as_ref().map_or(1.0, |t| t.value(speed / air.sound_m_s));
        let cd = self.point_drag(of_table);
        let drag = v * (-half_rho_s * cd * speed);
        let horizontal = v.y().hypot(v.z());
        let lift = if horizontal > 0.0 {
            let cl = p.following(p.lift_constant, &p.lift_per_input);
            let cs = p.following(p.side_constant, &p.side_per_input);
            // In the vertical plane of flight, perpendicular to v, upward (tunnel −X) for a level launch.
            let up = Vec3::new(-horizontal, v.x() * v.y() / horizontal, v.x() * v.z() / horizontal);
            let aside = Vec3::new(0.0, -v.z(), v.y()) * (speed / horizontal);
            (up * cl + aside * cs) * (half_rho_s * speed)
        } else {
            Vec3::zero()
        };
        let g = self.environment.gravity_m_s2;
        let m = self.vehicle.mass_kg;
        let weight = Vec3::new((m - p.buoyancy_fraction * displaced_kg) * g, 0.0, 0.0);
        (weight + drag + lift) * (1.0 / (m + p.apparent_fraction * displaced_kg)) + p.acceleration
    }

    /// Angular acceleration about a pivot, rad/s², of the angle from hanging down (rad) and its rate (rad/s):
    /// `J θ'' = −m g a sin θ − k θ' − T sgn θ' − ½ ρ S C_D a³ θ'|θ'|`, `J = I + m a²`. The air that the arm displaces or drags along, and
    /// bending of arm and frame, are left out. Zero without a pivot.
    #[must_use]
    pub fn pivot_acceleration_rad_s2(&self, angle_rad: f64, rate_rad_s: f64) -> f64 {
        let Some(pivot) = &self.point.pivot else { return 0.0 };
        let (m, g, a) = (self.vehicle.mass_kg, self.environment.gravity_m_s2, pivot.arm_m);
        let of_air = 0.5 * self.point.air_density_kg_m3 * self.vehicle.area_m2() * self.point_drag(1.0) * a.powi(3);
        let torque = m * g * a * angle_rad.sin()
            + pivot.viscous_n_m_s * rate_rad_s
            + pivot.dry_n_m * (rate_rad_s / SLIP_RAD_S).tanh()
            + of_air * rate_rad_s * rate_rad_s.abs();
        -torque / (pivot.inertia_kg_m2 + m * a * a)
    }

    /// What an altimeter reads too much, m, at a velocity through the air: `−C_p v²/2g`, the height of a static pressure that is off by
    /// C_p times the dynamic pressure (Gracey, NASA RP-1046, 1980, ch. 3).
    #[must_use]
    pub fn altimeter_error_m(&self, v: Vec3<Tunnel>) -> f64 {
        let p = &self.point;
        let cp = p.following(p.pressure_coefficient, &p.pressure_per_input);
        if cp == 0.0 { 0.0 } else { -cp * v.dot(v) / (2.0 * self.environment.gravity_m_s2) }
    }
}
