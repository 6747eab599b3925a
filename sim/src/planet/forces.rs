//! sim: forces on a body over a planet. In: a body, what acts on it at an instant. Out: its accelerations.

use crate::error::SimError;
use nalgebra::Matrix3;
use windfall_model::frames::{Body, Inertial, Rotation, Vec3};
use windfall_model::planet::PlanetBody;
use windfall_model::{Aero, AeroProgram, FlowState, Variable, Wrench, dynamic_pressure_pa};

/// Airspeed squared, m²/s², below which there are no aerodynamic forces, as in the tunnel.
const STILL_AIR_M2_S2: f64 = 1e-20;

/// What acts on a body at an instant, inertial axes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Acting {
    /// Gravitational acceleration, m/s².
    pub(crate) gravity: Vec3<Inertial>,
    /// Velocity of the body seen from the air, m/s.
    pub(crate) v_air: Vec3<Inertial>,
    /// Acceleration of the air following the body, m/s².
    pub(crate) a_air: Vec3<Inertial>,
    /// Density of the air, kg/m³; 0 in a vacuum.
    pub(crate) density_kg_m3: f64,
}

/// A body made ready.
pub(crate) struct BodyForces<'a> {
    body: &'a PlanetBody,
    program: AeroProgram,
    inertia: Matrix3<f64>,
    inertia_inverse: Matrix3<f64>,
}

impl<'a> BodyForces<'a> {
    pub(crate) fn new(body: &'a PlanetBody) -> Result<Self, SimError> {
        let PlanetBody { vehicle, aero, point, .. } = body;
        if !(vehicle.mass_kg > 0.0 && vehicle.mass_kg.is_finite()) {
            return Err(SimError::Setup { what: "mass_kg", value: vehicle.mass_kg, allowed: "positive and finite" });
        }
        let inertia = if *point { Matrix3::identity() } else { vehicle.inertia.matrix() };
        let physical = *point || vehicle.inertia.is_physical();
        let inertia_inverse = inertia.try_inverse().filter(|_| physical).ok_or(SimError::Setup {
            what: "inertia_kg_m2, determinant",
            value: inertia.determinant(),
            allowed: "positive definite with moments that obey the triangle inequality",
        })?;
        if !*point && forces_need_rates(aero) {
            return Err(SimError::Setup {
                what: "terms of CA, CY, CN with a damping variable, number",
                value: 1.0,
                allowed: "none over a planet: forces must not depend on the acceleration that they cause",
            });
        }
        Ok(Self { body, program: AeroProgram::new(aero), inertia, inertia_inverse })
    }

    /// Acceleration of a point mass: gravity and drag against the air.
    pub(crate) fn point(&self, s: &Acting) -> Vec3<Inertial> {
        let body = self.body;
        let drag_coefficient = body.aero.values.first().copied().unwrap_or(0.0);
        let per_speed = 0.5 * s.density_kg_m3 * body.reference.area_m2 * drag_coefficient / body.vehicle.mass_kg;
        s.gravity + s.v_air * (-per_speed * s.v_air.norm())
    }

    /// Acceleration and rate of body rates of a rigid body.
    #[inline]
    pub(crate) fn rigid(
        &self,
        s: &Acting,
        r_inertial_body: Rotation<Inertial, Body>,
        w: Vec3<Body>,
    ) -> (Vec3<Inertial>, Vec3<Body>) {
        let wrench = self.aerodynamic(s, r_inertial_body, w);
        let a = s.gravity + r_inertial_body * (wrench.f * (1.0 / self.body.vehicle.mass_kg));
        let gyroscopic = w.xyz.cross(&(self.inertia * w.xyz));
        (a, (self.inertia_inverse * (wrench.m.xyz - gyroscopic)).into())
    }

    /// Aerodynamic force and moment about the c.m. Rates in the coefficients are those against inertial axes, as in the check cases
    /// (NASA/TM-2015-218675, simulation 4); against the air they would differ by the planet's turning.
    #[inline]
    fn aerodynamic(&self, s: &Acting, r_inertial_body: Rotation<Inertial, Body>, w: Vec3<Body>) -> Wrench {
        let r_body_inertial = r_inertial_body.inverse();
        let v = r_body_inertial * s.v_air;
        if s.density_kg_m3 <= 0.0 || v.dot(v) < STILL_AIR_M2_S2 {
            return Wrench::default();
        }
        let PlanetBody { vehicle, reference, .. } = self.body;
        let qs = dynamic_pressure_pa(s.density_kg_m3, v.norm()) * reference.area_m2;
        // Rates of unit length first; each is then made that of its reference length.
        let mut flow = FlowState::without_rates(v, w, 1.0, self.program.needed());
        for (variable, length_m) in [
            (Variable::RollRate, reference.span_m),
            (Variable::RollRateAbs, reference.span_m),
            (Variable::PitchRate, reference.chord_m),
            (Variable::YawRate, reference.span_m),
        ] {
            flow.values[variable as usize] *= length_m;
        }
        let mut c = [0.0; 6];
        self.program.early(&flow, &mut c);
        let f = Vec3::new(-qs * c[0], qs * c[1], -qs * c[2]);
        if self.program.needs_rates() {
            let a = r_body_inertial * (s.gravity - s.a_air) + f * (1.0 / vehicle.mass_kg);
            flow.set_rates(v, a - w.cross(v), w, 1.0);
            flow.values[Variable::PitchDamping as usize] *= reference.chord_m;
            flow.values[Variable::YawDamping as usize] *= reference.span_m;
            self.program.late(&flow, &mut c);
        }
        let m = Vec3::new(reference.span_m * c[3], reference.chord_m * c[4], reference.span_m * c[5]) * qs;
        Wrench { f, m: m + f.cross(vehicle.p_origin_cm) }
    }
}

/// True when a force depends on the acceleration.
fn forces_need_rates(aero: &Aero) -> bool {
    use windfall_model::Coefficient as C;
    let terms = aero.structure.contributions.iter();
    let force = |c: C| matches!(c, C::CA | C::CY | C::CN);
    terms
        .filter(|k| aero.values[k.parameter] != 0.0)
        .any(|k| force(k.coefficient) && k.term.factors.iter().any(|f| f.needs_rates()))
}
