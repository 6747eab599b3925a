//! model: the vehicle's mass side. In: mass, inertia, offsets. Out: checked constants that both rooms use.

use crate::aero::Wrench;
use crate::frames::{Body, Vec3};
use nalgebra::Matrix3;
use serde::{Deserialize, Serialize};

/// Moments and products of inertia about the c.m., kg m², body axes. Products are the positive integrals
/// `I_xy = ∫ x y dm`, which enter the inertia matrix with a minus sign (thesis eqs B.8-B.10).
///
/// ```
/// use windfall_model::Inertia;
///
/// let rod = Inertia { xx: 0.001, yy: 0.1, zz: 0.1, ..Inertia::default() };
/// assert!(rod.is_positive() && rod.is_physical());
/// // No body resists one axis more than the other two together.
/// assert!(!Inertia { xx: 0.3, ..rod }.is_physical());
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Inertia {
    /// Roll moment of inertia I_xx.
    pub xx: f64,
    /// Pitch moment of inertia I_yy.
    pub yy: f64,
    /// Yaw moment of inertia I_zz.
    pub zz: f64,
    /// Product of inertia I_xy.
    pub xy: f64,
    /// Product of inertia I_xz.
    pub xz: f64,
    /// Product of inertia I_yz.
    pub yz: f64,
}

impl Inertia {
    /// Smallest and largest radius of gyration of a body over its reference diameter: a point has 0, a thin pole of thirty diameters 8.7.
    pub const GYRATION_OVER_DIAMETER: [f64; 2] = [0.01, 10.0];
    /// Inertia matrix, kg m², body axes: moments on the diagonal, minus the products off it.
    #[must_use]
    pub fn matrix(&self) -> Matrix3<f64> {
        Matrix3::new(self.xx, -self.xy, -self.xz, -self.xy, self.yy, -self.yz, -self.xz, -self.yz, self.zz)
    }
    /// True when the matrix is positive definite.
    #[must_use]
    pub fn is_positive(&self) -> bool {
        self.matrix().symmetric_eigenvalues().iter().all(|e| *e > 0.0)
    }
    /// True when the matrix is positive definite and its moments obey the triangle inequality of a real body.
    #[must_use]
    pub fn is_physical(&self) -> bool {
        let e = self.matrix().symmetric_eigenvalues();
        let (a, b, c) = (e[0], e[1], e[2]);
        a > 0.0 && b > 0.0 && c > 0.0 && a + b >= c && b + c >= a && c + a >= b
    }
}

/// Mass, inertia and geometry of the model.
#[derive(Clone, Debug, PartialEq)]
pub struct Vehicle {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Inertia about the c.m.
    pub inertia: Inertia,
    /// c.m. from the geometric origin (pressure-vessel centre), m, body axes: the thesis' r_cm.
    pub p_origin_cm: Vec3<Body>,
    /// Reference diameter d, m; the reference area is π d²/4.
    pub diameter_m: f64,
    /// Air that the model drags along when it accelerates.
    pub apparent: ApparentMass,
    /// A part that can move against the rest, if any.
    pub loose: Option<LooseMass>,
}

impl Vehicle {
    /// Reference area S = π d²/4, m².
    #[must_use]
    pub fn area_m2(&self) -> f64 {
        std::f64::consts::FRAC_PI_4 * self.diameter_m * self.diameter_m
    }
}

/// Apparent mass and inertia of an axisymmetric body (Lamb 1932, §124): zero in a declared model.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ApparentMass {
    /// Along the body's x axis, kg.
    pub axial_kg: f64,
    /// Along y and z, kg.
    pub radial_kg: f64,
    /// About y and z, kg m².
    pub transverse_kg_m2: f64,
    /// How much of the dragged air's angular momentum does not turn with the rolling body: 0 for a rigid body's (Kirchhoff), 1 where
    /// the air resists angular acceleration in body axes alone, as many simulators have it.
    pub unturned: f64,
    /// How much of a gust the dragged air follows: 0 where it sees the steady flow alone, 1 for gusts long beside the body.
    pub in_gusts: f64,
}

impl ApparentMass {
    /// True when there is none.
    #[must_use]
    pub fn is_null(&self) -> bool {
        *self == Self::default()
    }
}

/// A mass on a spring inside the model that moves across the body's x axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LooseMass {
    /// Its mass, kg; included in the vehicle's mass.
    pub mass_kg: f64,
    /// Undamped natural frequency against a fixed body, Hz.
    pub frequency_hz: f64,
    /// Damping ratio, of critical.
    pub damping_ratio: f64,
    /// Rest position from the c.m. along x, m.
    pub x_cm_m: f64,
    /// How much of what is of second order in its displacement acts (the body's turning at the displaced place): 1 in full, 0 to first
    /// order, as textbooks and many simulators have it.
    pub in_full: f64,
}

impl LooseMass {
    /// What the body's turning adds to the part's acceleration at displacement and rate `[y, z, ẏ, ż]` (m, m/s) beyond its mount's,
    /// m/s², body axes: Euler's, centripetal and Coriolis' at body rates `w` (rad/s) and their rate.
    #[must_use]
    pub fn carried(&self, state: [f64; 4], w: Vec3<Body>, w_rate: Vec3<Body>) -> Vec3<Body> {
        let (off, rate) = (Vec3::new(0.0, state[0], state[1]), Vec3::new(0.0, state[2], state[3]));
        (w_rate.cross(off) + w.cross(w.cross(off)) + w.cross(rate) * 2.0) * self.in_full
    }
    /// Relative acceleration (m/s², body y and z) of the loose part at displacement and rate `[y, z, ẏ, ż]` (m, m/s), when its
    /// mount has specific force `a − g` (m/s², body axes): `ξ̈ = −ω²ξ − 2ζω ξ̇ − (a − g) − carried`, across x only.
    #[must_use]
    pub fn acceleration(&self, state: [f64; 4], specific_force: Vec3<Body>, carried: Vec3<Body>) -> [f64; 2] {
        let w = std::f64::consts::TAU * self.frequency_hz;
        let along = |x: f64, rate: f64, f: f64| -w * w * x - 2.0 * self.damping_ratio * w * rate - f;
        let pushed = specific_force + carried;
        [along(state[0], state[2], pushed.y()), along(state[1], state[3], pushed.z())]
    }
    /// What the loose part does to the body beyond a fixed one, about the c.m. (N, N m, body axes): force `−m (ξ̈ + carried)` where it
    /// is, and its weight and inertia displaced by ξ.
    #[must_use]
    pub fn wrench(&self, state: [f64; 4], acceleration: [f64; 2], specific_force: Vec3<Body>, carried: Vec3<Body>) -> Wrench {
        let f = (Vec3::new(0.0, acceleration[0], acceleration[1]) + carried) * -self.mass_kg;
        let off = Vec3::new(0.0, state[0], state[1]);
        let place = Vec3::new(self.x_cm_m, 0.0, 0.0) + off * self.in_full;
        Wrench { f, m: place.cross(f) + off.cross(specific_force * -self.mass_kg) }
    }
}
