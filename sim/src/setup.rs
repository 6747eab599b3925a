//! sim: a flight made ready. In: plant, flight, seed. Out: checked constants, tunnel speed and gusts drawn beforehand.

use crate::error::SimError;
use crate::noise;
use crate::operator::Hand;
use crate::seed::{Channel, Seed};
use crate::smooth::Smooth;
use crate::state::BASE;
use nalgebra::{Matrix3, Matrix6};
use std::borrow::Cow;
use std::sync::OnceLock;
use windfall_model::{AeroProgram, Disturbance, Entry, Flight, Operator, Plant, TunnelSpeed, trim_speed};

/// Points at most of a grid on which an input is drawn beforehand: a third of a gigabyte.
const GRID_POINTS: f64 = 2e7;

/// Everything that the equations of motion need, constant during a flight.
#[derive(Debug)]
pub(crate) struct Setup<'a> {
    /// The run's own, with what differs from run to run drawn.
    pub(crate) plant: Cow<'a, Plant>,
    pub(crate) program: AeroProgram,
    pub(crate) density_kg_m3: f64,
    pub(crate) area_m2: f64,
    pub(crate) per_mass: f64,
    pub(crate) inertia: Matrix3<f64>,
    pub(crate) inertia_inverse: Matrix3<f64>,
    /// Forces depend on accelerations.
    pub(crate) coupled: bool,
    /// Inverse of how that balance depends on the accelerations at the flight's first instant.
    pub(crate) coupling: OnceLock<Matrix6<f64>>,
    pub(crate) apparent: bool,
    pub(crate) history: Smooth,
    pub(crate) hand: Option<Hand>,
    /// Where the operator's states begin.
    pub(crate) hand_index: Option<usize>,
    /// Gust along a tunnel axis.
    pub(crate) gusts: Vec<(usize, Smooth)>,
    /// Random increment of a coefficient.
    pub(crate) coefficient_noise: Vec<(usize, Smooth)>,
    /// Longest step that cannot overlook an input, s.
    pub(crate) step_max_s: f64,
}

impl<'a> Setup<'a> {
    pub(crate) fn new(plant: &'a Plant, flight: &Flight, seed: Seed) -> Result<Self, SimError> {
        let mut setup = Self::without_history(plant, flight, seed)?;
        setup.history = history(&flight.speed);
        Ok(setup)
    }

    /// As [`Setup::new`], but a given history of the tunnel speed is left to the caller.
    pub(crate) fn without_history(plant: &'a Plant, flight: &Flight, seed: Seed) -> Result<Self, SimError> {
        check(plant, flight)?;
        let own = of_run(plant, flight, seed);
        let plant: &Plant = &own;
        let density_kg_m3 = plant.environment.density_kg_m3(flight.ps_pa, flight.ts_k);
        let inertia = plant.vehicle.inertia.matrix();
        let inertia_inverse = inertia.try_inverse().filter(|_| plant.vehicle.inertia.is_physical()).ok_or(SimError::Setup {
            what: "inertia_kg_m2, determinant",
            value: inertia.determinant(),
            allowed: "positive definite with moments that obey the triangle inequality",
        })?;
        let loose = plant.vehicle.loose.is_some();
        let mut setup = Self {
            plant: own.clone(),
            program: AeroProgram::new(&plant.aero),
            density_kg_m3,
            area_m2: plant.vehicle.area_m2(),
            per_mass: 1.0 / plant.vehicle.mass_kg,
            inertia,
            inertia_inverse,
            coupled: plant.has_algebraic_loop() || loose,
            coupling: OnceLock::new(),
            apparent: !plant.vehicle.apparent.is_null(),
            history: Smooth::new(1.0, &[]),
            hand: None,
            hand_index: None,
            gusts: Vec::new(),
            coefficient_noise: Vec::new(),
            step_max_s: f64::INFINITY,
        };
        if let TunnelSpeed::Operator(order) = &flight.speed {
            let trim = order.trim_m_s.unwrap_or_else(|| trim_speed(plant, density_kg_m3));
            setup.hand = Some(Hand::new(*order, trim, flight.duration_s, seed));
            setup.hand_index = Some(BASE + if loose { 4 } else { 0 });
        }
        setup.draw_disturbances(flight, seed)?;
        setup.limit_step(flight);
        Ok(setup)
    }

    /// Number of states.
    pub(crate) fn states(&self) -> usize {
        BASE + if self.plant.vehicle.loose.is_some() { 4 } else { 0 } + if self.hand.is_some() { 2 } else { 0 }
    }

    fn draw_disturbances(&mut self, flight: &Flight, seed: Seed) -> Result<(), SimError> {
        let speed = mean_airspeed(&self.plant, flight, self.density_kg_m3);
        // What drifts is the record's, and what differs from run to run is in the run's own plant.
        let moves = |d: &Disturbance| matches!(d.entry, Entry::AirVelocity(_) | Entry::Coefficient(_));
        for d in self.plant.disturbances(speed).into_iter().filter(moves) {
            let grid_s = noise::grid_s(&d, self.plant.vehicle.diameter_m, speed);
            let points = flight.duration_s / grid_s;
            demand(
                points <= GRID_POINTS,
                "points of a gust's grid over the flight",
                points,
                "at most 2e7: a coarser scale or a larger body",
            )?;
            self.step_max_s = self.step_max_s.min(4.0 * grid_s);
            let smooth = |channel| noise::smooth(&d, grid_s, flight.duration_s, seed.normals(channel));
            match d.entry {
                Entry::AirVelocity(axis) => self.gusts.push((axis, smooth(Channel::Gust(small(axis))))),
                Entry::Coefficient(index) => self.coefficient_noise.push((index, smooth(Channel::Coefficient(small(index))))),
                Entry::RecordedSpeed | Entry::RecordedPose(_) | Entry::Number(_) => {}
            }
        }
        Ok(())
    }

    /// No step so long that it could jump over a pulse or a wiggle of an input.
    fn limit_step(&mut self, flight: &Flight) {
        for contact in &self.plant.contacts {
            self.step_max_s = self.step_max_s.min(0.25 * contact.duration_s);
        }
        if let TunnelSpeed::History { interval_s, vw_m_s } = &flight.speed
            && vw_m_s.len() > 1
        {
            self.step_max_s = self.step_max_s.min(16.0 * interval_s);
        }
        if let Some(hand) = &self.hand {
            self.step_max_s = self.step_max_s.min(hand.step_max_s());
        }
    }
}

/// The plant of one run: the flight's pushes among its contacts, numbers that differ from run to run drawn.
fn of_run<'a>(plant: &'a Plant, flight: &Flight, seed: Seed) -> Cow<'a, Plant> {
    let mut own = Cow::Borrowed(plant);
    if !flight.pushes.is_empty() {
        own.to_mut().contacts.extend(&flight.pushes);
    }
    for (place, (number, std)) in (0_u8..).zip(plant.scatter.numbers()) {
        let drawn = std * seed.normals(Channel::Number(place)).next().unwrap_or(0.0);
        own.to_mut().change(number, drawn);
    }
    own
}

fn small(index: usize) -> u8 {
    u8::try_from(index).expect("axes are below 3 and coefficients below 6")
}

fn history(speed: &TunnelSpeed) -> Smooth {
    match speed {
        TunnelSpeed::History { interval_s, vw_m_s } => Smooth::new(*interval_s, vw_m_s),
        TunnelSpeed::Constant(vw_m_s) => Smooth::new(1.0, &[*vw_m_s]),
        TunnelSpeed::Operator(_) => Smooth::new(1.0, &[]),
    }
}

/// Airspeed that sets the time scale of gusts: the mean tunnel speed, or the trim speed where the tunnel stands still.
fn mean_airspeed(plant: &Plant, flight: &Flight, density_kg_m3: f64) -> f64 {
    let mean = match &flight.speed {
        TunnelSpeed::History { vw_m_s, .. } => vw_m_s.iter().sum::<f64>() / vw_m_s.len() as f64,
        TunnelSpeed::Constant(vw) => *vw,
        TunnelSpeed::Operator(Operator { trim_m_s, .. }) => trim_m_s.unwrap_or(0.0),
    };
    if mean > 0.0 { mean } else { trim_speed(plant, density_kg_m3) }
}

fn check(plant: &Plant, flight: &Flight) -> Result<(), SimError> {
    let release = flight.release;
    let vehicle = &plant.vehicle;
    let positive = [
        ("duration_s", flight.duration_s),
        ("rate_hz", flight.rate_hz),
        ("relative_tolerance", flight.numerics.relative_tolerance),
        ("absolute_tolerance", flight.numerics.absolute_tolerance),
        ("static pressure, Pa", flight.ps_pa),
        ("static temperature, K", flight.ts_k),
        ("mass_kg", vehicle.mass_kg),
        ("reference_diameter_m", vehicle.diameter_m),
        ("gas_constant_j_kg_k", plant.environment.gas_constant_j_kg_k),
    ];
    for (what, value) in positive {
        demand(value > 0.0 && value.is_finite(), what, value, "a finite number above zero")?;
    }
    let finite = [
        ("release position, m", release.position_m),
        ("release velocity, m/s", release.velocity_m_s),
        ("release attitude, rad", release.attitude_rad),
        ("release rates, rad/s", release.rates_rad_s),
        ("center_of_mass_m", vehicle.p_origin_cm.to_array()),
    ];
    for (what, values) in finite {
        for value in values {
            demand(value.is_finite(), what, value, "a finite number")?;
        }
    }
    for &value in &plant.aero.values {
        demand(value.is_finite(), "aerodynamic parameter", value, "a finite number")?;
    }
    check_speed(&flight.speed)
}

fn check_speed(speed: &TunnelSpeed) -> Result<(), SimError> {
    match speed {
        TunnelSpeed::Constant(v) => demand(v.is_finite(), "tunnel speed, m/s", *v, "a finite number"),
        TunnelSpeed::History { interval_s, vw_m_s } => {
            demand(*interval_s > 0.0, "interval of the speed history, s", *interval_s, "above zero")?;
            demand(!vw_m_s.is_empty(), "number of speeds in the history", 0.0, "at least one")?;
            vw_m_s.iter().try_for_each(|v| demand(v.is_finite(), "tunnel speed, m/s", *v, "a finite number"))
        }
        TunnelSpeed::Operator(o) => {
            demand(o.lag_s > 0.0, "lag_s of the operator", o.lag_s, "above zero")?;
            let unsteady = o.unsteady_rms_m_s <= 0.0 || o.unsteady_time_s > 0.0;
            demand(unsteady, "unsteady_time_s of the operator", o.unsteady_time_s, "above zero when the hand is unsteady")
        }
    }
}

fn demand(good: bool, what: &'static str, value: f64, allowed: &'static str) -> Result<(), SimError> {
    if good { Ok(()) } else { Err(SimError::Setup { what, value, allowed }) }
}
