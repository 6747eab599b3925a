//! model: a rigid body in free flight through air at rest, as declared. In: numbers of a declared model. Out: plain data; its accelerations
//! are `free_body`'s.

use crate::frames::{Body, Tunnel, Vec3};

/// A number that is fixed, or that a run input sets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Setting {
    /// The same in every run.
    Fixed(f64),
    /// The input at this place among the run's inputs, in SI.
    Input(usize),
}

impl Setting {
    /// Its value in a run; NaN when the run lacks the input.
    #[must_use]
    pub fn value(self, inputs: &[f64]) -> f64 {
        match self {
            Self::Fixed(x) => x,
            Self::Input(i) => inputs.get(i).copied().unwrap_or(f64::NAN),
        }
    }
}

/// A point mass at a place that a run may set; not included in the vehicle's mass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovedPart {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Place from the geometric origin, m, body axes.
    pub place_m: [Setting; 3],
}

/// A force along a direction of the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thrust {
    /// Size, N.
    pub size_n: Setting,
    /// Unit vector, body axes.
    pub direction: Vec3<Body>,
    /// Where it acts from the geometric origin, m, body axes.
    pub place_m: [Setting; 3],
}

/// A rigid body in free flight: what it has beyond [`crate::Vehicle`], whose mass, centre of mass and inertia are those without parts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FreeFlight {
    /// Area that the coefficients are of, m². Moments are of area times the vehicle's reference diameter.
    pub area_m2: f64,
    /// True: coefficients are along wind axes (C_A the drag C_D, C_Y the side force C_S, C_N the lift C_L, and moments about the same
    /// axes), turned to body axes by α and β; false: body axes.
    pub wind_axes: bool,
    /// Displaced air, as a mass, kg.
    pub buoyancy_kg: f64,
    /// Where it lifts from the geometric origin, m, body axes.
    pub p_origin_buoyancy: Vec3<Body>,
    /// Moment per body rate about each of the coefficients' axes, N m s; negative damps.
    pub rate_damping_n_m_s: [f64; 3],
    /// Parts that a run moves.
    pub parts: Vec<MovedPart>,
    /// Thrusts.
    pub thrusts: Vec<Thrust>,
    /// Thrusts over those declared, less 1; zero in a declared model, as all that follows.
    pub thrust_excess: f64,
    /// Relative excess of thrusts on the right (y above zero), and lack of those on the left.
    pub thrust_unequal: f64,
    /// Where parts and thrusts truly are less where the runs' inputs say, m, body axes; coordinates that are fixed stay.
    pub part_shift: Vec3<Body>,
    /// Rate damping over that declared, less 1, about each axis.
    pub damping_excess: [f64; 3],
    /// Apparent mass along each body axis, kg (Lamb 1932, §124).
    pub apparent_kg: [f64; 3],
    /// Velocity of the air seen from the room, m/s, tunnel axes.
    pub v_tunnel_air: Vec3<Tunnel>,
    /// The point of the body whose position is recorded, from the geometric origin, m, body axes.
    pub p_origin_tracked: Vec3<Body>,
    /// A steady push, m/s² along tunnel axes: force over mass, at the geometric origin.
    pub push: Vec3<Tunnel>,
    /// A steady turn, rad/s² about body axes: moment over inertia.
    pub turn: Vec3<Body>,
}

impl FreeFlight {
    /// Where a part or thrust is in a run; coordinates that an input sets are off by the shift.
    pub(crate) fn part_place(&self, place_m: [Setting; 3], inputs: &[f64]) -> Vec3<Body> {
        let shift = self.part_shift.to_array();
        let along = |i: usize| place_m[i].value(inputs) + if matches!(place_m[i], Setting::Input(_)) { shift[i] } else { 0.0 };
        Vec3::from_array(std::array::from_fn(along))
    }

    /// Force and moment about the geometric origin of all thrusts, N and N m, body axes.
    #[must_use]
    pub fn thrust(&self, inputs: &[f64]) -> [Vec3<Body>; 2] {
        let mut sum = [Vec3::zero(); 2];
        for t in &self.thrusts {
            let place = self.part_place(t.place_m, inputs);
            let side = if place.y() == 0.0 { 0.0 } else { place.y().signum() * self.thrust_unequal };
            let f = t.direction * (t.size_n.value(inputs) * (1.0 + self.thrust_excess) * (1.0 + side));
            sum[0] += f;
            sum[1] += place.cross(f);
        }
        sum
    }
}
