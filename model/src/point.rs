//! model: bodies without attitude (balls). In: velocity, density, run settings. Out: acceleration.

use crate::frames::{Tunnel, Vec3};
use crate::plant::Plant;

/// What acts on a point mass beyond gravity and drag; all zero in a declared model. Axes: tunnel (X down).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointMass {
    /// Lift coefficient per unit of each run input, in the order of the campaign's input names. The lift is
    /// `q S C_L (h × v)/|v|` with h the horizontal unit vector across the launch, so that positive lifts.
    pub lift_per_input: Vec<f64>,
    /// Increment of the drag coefficient per unit of each run input, in the same order.
    pub drag_per_input: Vec<f64>,
    /// Lift coefficient that does not depend on inputs.
    pub lift_constant: f64,
    /// Sideways coefficient per unit of each run input (a spin axis that leans), positive along `X × v`: to tunnel +Z for a
    /// flight along +Y.
    pub side_per_input: Vec<f64>,
    /// Sideways coefficient that does not depend on inputs.
    pub side_constant: f64,
    /// Constant acceleration, m/s², tunnel axes.
    pub acceleration: Vec3<Tunnel>,
    /// Air mass that the body drags along, as a fraction of the displaced air (0.5 for a sphere in potential flow).
    pub apparent_fraction: f64,
    /// Buoyancy as a fraction of the displaced air's weight (1: Archimedes).
    pub buoyancy_fraction: f64,
    /// This run's settings.
    pub inputs: Vec<f64>,
    /// Density of the still air, kg/m³, as the campaign gives it.
    pub air_density_kg_m3: f64,
}

impl Plant {
    /// Acceleration of a point mass, m/s², tunnel axes (X down): gravity, quadratic drag along −v, lift across v in the
    /// vertical plane of flight, buoyancy, apparent mass. `v` is the velocity in still air (m/s), density in kg/m³.
    #[must_use]
    pub fn point_acceleration(&self, v: Vec3<Tunnel>, density_kg_m3: f64) -> Vec3<Tunnel> {
        let p = &self.point;
        let d = self.vehicle.diameter_m;
        let displaced_kg = density_kg_m3 * std::f64::consts::PI / 6.0 * d.powi(3);
        let speed = v.norm();
        let half_rho_s = 0.5 * density_kg_m3 * self.vehicle.area_m2();
        let cd = self.aero.values.first().copied().unwrap_or(0.0)
            + self.aero.extra.iter().map(|(_, value, _)| value).sum::<f64>()
            + p.drag_per_input.iter().zip(&p.inputs).map(|(k, u)| k * u).sum::<f64>();
        let drag = v * (-half_rho_s * cd * speed);
        let horizontal = v.y().hypot(v.z());
        let lift = if horizontal > 0.0 {
            let of = |constant: f64, per: &[f64]| constant + per.iter().zip(&p.inputs).map(|(k, u)| k * u).sum::<f64>();
            let (cl, cs) = (of(p.lift_constant, &p.lift_per_input), of(p.side_constant, &p.side_per_input));
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
}
