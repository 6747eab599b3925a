//! Vehicle, tether, gas and aerodynamic numbers of a truth; the SAGE model of the thesis and random others.

use crate::algebra::V;
use crate::chance::Chance;

pub(crate) const GRAVITY: f64 = 9.80665;
pub(crate) const GAS: f64 = 287.05287;
/// Names of the aerodynamic numbers, in order.
pub(crate) const AERO: [&str; 11] =
    ["CA_T0", "CN_sin", "CN_sin3", "Cl_0", "Cl_p", "Cm_sin", "Cm_sin3", "Cm_1", "Cm_2", "Cn_1", "Cn_2"];

/// A vehicle on its tether, and the gas.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Craft {
    pub(crate) mass: f64,
    /// Moments of inertia about the c.m.
    pub(crate) inertia: V,
    /// c.m. from the geometric origin.
    pub(crate) cm: V,
    pub(crate) diameter: f64,
    pub(crate) hook: V,
    pub(crate) ring: V,
    pub(crate) drag_area: f64,
    pub(crate) line_weight: f64,
    pub(crate) aero: [f64; 11],
    pub(crate) pressure: f64,
    pub(crate) temperature: f64,
}

impl Craft {
    /// The thesis' model (Tables A.1, B.1 and 5.5).
    pub(crate) fn sage() -> Self {
        Self {
            mass: 0.7873,
            inertia: [0.02113, 0.0138, 0.01379],
            cm: [0.0; 3],
            diameter: 0.2125,
            hook: [-0.25, 0.0, 0.0],
            ring: [-3.0, 0.0, 0.0],
            drag_area: 0.001_300_642_56,
            line_weight: 0.016_458_42,
            aero: [6.662, 3.5129, -2.0035, 0.0125, -5.6816, -2.0655, 2.5278, -3.3025, -205.4289, -3.3025, -205.4289],
            pressure: 101_325.0,
            temperature: 299.083_649_392_031_6,
        }
    }

    /// Another one, with aerodynamics half to twice the thesis'.
    pub(crate) fn other(c: &mut Chance) -> Self {
        let sage = Self::sage();
        let mass = c.uniform(0.5, 1.3);
        let diameter = 0.2125 * (mass / 0.7873).cbrt() * c.factor(0.9, 1.12);
        let xx = mass * diameter * diameter * c.uniform(0.52, 0.75);
        let across = xx * c.uniform(0.6, 0.7);
        let mut aero = sage.aero;
        for a in &mut aero {
            *a *= c.factor(0.5, 2.0);
        }
        aero[3] = c.uniform(-0.02, 0.02);
        aero[9] = aero[7];
        aero[10] = aero[8];
        Self {
            mass,
            inertia: [xx, across, across * c.uniform(0.98, 1.02)],
            cm: [c.uniform(-0.005, 0.005), 0.0, 0.0],
            diameter,
            hook: [-c.uniform(0.2, 0.3), 0.0, 0.0],
            ring: [-c.uniform(2.5, 4.0), 0.0, 0.0],
            drag_area: sage.drag_area * c.factor(0.6, 1.8),
            line_weight: sage.line_weight * c.factor(0.5, 1.6),
            aero,
            pressure: c.uniform(88e3, 103e3),
            temperature: c.uniform(278.0, 303.0),
        }
    }

    /// The same at another length scale, Froude's number and the gas kept.
    pub(crate) fn sized(&self, size: f64) -> Self {
        let long = |v: V| v.map(|x| x * size);
        Self {
            mass: self.mass * size.powi(3),
            inertia: self.inertia.map(|i| i * size.powi(5)),
            cm: long(self.cm),
            diameter: self.diameter * size,
            hook: long(self.hook),
            ring: long(self.ring),
            drag_area: self.drag_area * size.powi(2),
            line_weight: self.line_weight * size.powi(3),
            ..self.clone()
        }
    }
    pub(crate) fn area(&self) -> f64 {
        std::f64::consts::FRAC_PI_4 * self.diameter * self.diameter
    }
    pub(crate) fn density(&self) -> f64 {
        self.pressure / (GAS * self.temperature)
    }
    /// Tunnel speed at which drag and pull hold the weight.
    pub(crate) fn trim(&self) -> f64 {
        let q = (self.mass * GRAVITY + self.line_weight) / (self.area() * self.aero[0] + self.drag_area);
        (2.0 * q / self.density()).sqrt()
    }
    /// Its numbers by the names of answers.json.
    pub(crate) fn numbers(&self) -> Vec<(&'static str, f64)> {
        let a = &self.aero;
        vec![
            ("m", self.mass),
            ("Ixx", self.inertia[0]),
            ("Iyy", self.inertia[1]),
            ("Izz", self.inertia[2]),
            ("xcm", self.cm[0]),
            ("ycm", self.cm[1]),
            ("zcm", self.cm[2]),
            ("S", self.area()),
            ("d", self.diameter),
            ("CA0", a[0]),
            ("CN1", a[1]),
            ("CN3", a[2]),
            ("Cl0", a[3]),
            ("Clp", a[4]),
            ("Cm1", a[5]),
            ("Cm3", a[6]),
            ("Cq0", a[7]),
            ("Cq2", a[8]),
            ("CDS", self.drag_area),
            ("Wtr", self.line_weight),
            ("xt", self.hook[0]),
            ("yt", self.hook[1]),
            ("zt", self.hook[2]),
            ("Xr", self.ring[0]),
            ("Yr", self.ring[1]),
            ("Zr", self.ring[2]),
            ("ps", self.pressure),
            ("Ts", self.temperature),
        ]
    }
}
