//! model: Froude scaling between full scale and model (thesis §2.1.2, Table 2.2). In: length and density ratios. Out: scaled plant and flight.

use crate::aero::{Aero, Factor};
use crate::flow::Variable;
use crate::plant::{Contact, Plant};
use crate::quantity::{Dimension, PLANT_NUMBERS};
use crate::scenario::{Flight, Operator, Release, TestSection, TunnelSpeed};

/// Ratios full scale over model that keep Froude number V²/(g L), mass ratio m/(ρ L³) and inertia ratio I/(ρ L⁵).
///
/// ```
/// use windfall_model::FroudeScale;
///
/// // A quarter-scale model in air of full-scale density and gravity: half the speed and the time, a 64th of the mass.
/// let scale = FroudeScale { length: 4.0, density: 1.0, gravity: 1.0 };
/// assert_eq!([scale.speed(), scale.time(), scale.mass(), scale.inertia()], [2.0, 2.0, 64.0, 1024.0]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FroudeScale {
    /// Length ratio (4 for a 25 % model).
    pub length: f64,
    /// Density ratio.
    pub density: f64,
    /// Gravity ratio.
    pub gravity: f64,
}

impl FroudeScale {
    /// Mass ratio ρ L³.
    #[must_use]
    pub fn mass(&self) -> f64 {
        self.density * self.length.powi(3)
    }
    /// Inertia ratio ρ L⁵.
    #[must_use]
    pub fn inertia(&self) -> f64 {
        self.density * self.length.powi(5)
    }
    /// Time ratio √(L/g).
    #[must_use]
    pub fn time(&self) -> f64 {
        (self.length / self.gravity).sqrt()
    }
    /// Speed ratio √(L g).
    #[must_use]
    pub fn speed(&self) -> f64 {
        (self.length * self.gravity).sqrt()
    }
    /// Force ratio ρ L³ g.
    #[must_use]
    pub fn force(&self) -> f64 {
        self.mass() * self.gravity
    }
    /// Area ratio L².
    #[must_use]
    pub fn area(&self) -> f64 {
        self.length * self.length
    }
}

impl FroudeScale {
    /// Ratio of numbers of that dimension.
    #[must_use]
    pub fn of(&self, d: Dimension) -> f64 {
        let power = |ratio: f64, n: i8| ratio.powi(i32::from(n));
        power(self.mass(), d.mass) * power(self.length, d.length) * power(self.time(), d.time)
    }

    /// A plant scaled from model to full scale (ratios below one: the other way): every number with a dimension of length,
    /// time or mass, so that the scaled flight is the same in dimensionless numbers. Coefficients, angles and settings stay;
    /// terms in airspeed keep their value at the scaled speed.
    #[must_use]
    pub fn plant(&self, p: &Plant) -> Plant {
        let mut scaled = p.clone();
        for number in PLANT_NUMBERS {
            if let Some(x) = (number.lens)(&mut scaled) {
                *x *= self.of(number.dimension);
            }
        }
        self.aero(&mut scaled.aero);
        scaled.contacts.iter_mut().for_each(|c| self.contact(c));
        scaled
    }

    /// A flight scaled as [`FroudeScale::plant`]; the density ratio goes into the static pressure.
    #[must_use]
    pub fn flight(&self, f: &Flight) -> Flight {
        let (l, t, v) = (self.length, self.time(), self.speed());
        Flight {
            name: f.name.clone(),
            kind: f.kind.clone(),
            used: f.used,
            duration_s: f.duration_s * t,
            rate_hz: f.rate_hz / t,
            release: Release {
                position_m: f.release.position_m.map(|x| x * l),
                velocity_m_s: f.release.velocity_m_s.map(|x| x * v),
                attitude_rad: f.release.attitude_rad,
                rates_rad_s: f.release.rates_rad_s.map(|x| x / t),
            },
            speed: self.tunnel_speed(&f.speed),
            ps_pa: f.ps_pa * self.density,
            ts_k: f.ts_k,
            section: f.section.map(|s| TestSection {
                radius_m: s.radius_m * l,
                top_x_m: s.top_x_m * l,
                bottom_x_m: s.bottom_x_m * l,
            }),
            numerics: f.numerics,
            sensor_noise: f.sensor_noise,
            pushes: f.pushes.iter().map(|c| self.pushed(c)).collect(),
            window_s: f.window_s.map(|w| w.map(|s| s * t)),
        }
    }

    fn aero(&self, a: &mut Aero) {
        let own = a.structure.contributions.iter_mut().map(|c| &mut c.term);
        for term in own.chain(a.extra.iter_mut().map(|(_, _, term)| term)) {
            for factor in &mut term.factors {
                match factor {
                    Factor::Power(Variable::Speed, n) => term.scale /= self.speed().powi(i32::from(*n)),
                    Factor::Bump(Variable::Speed, width) => *width *= self.speed(),
                    _ => {}
                }
            }
        }
    }

    fn pushed(&self, c: &Contact) -> Contact {
        let mut scaled = *c;
        self.contact(&mut scaled);
        scaled
    }

    fn contact(&self, c: &mut Contact) {
        let impulse = self.force() * self.time();
        c.start_s *= self.time();
        c.duration_s *= self.time();
        c.impulse = c.impulse * impulse;
        c.angular_impulse = c.angular_impulse * (impulse * self.length);
    }

    fn tunnel_speed(&self, speed: &TunnelSpeed) -> TunnelSpeed {
        let (t, v) = (self.time(), self.speed());
        match speed {
            TunnelSpeed::Constant(x) => TunnelSpeed::Constant(x * v),
            TunnelSpeed::History { interval_s, vw_m_s } => {
                TunnelSpeed::History { interval_s: interval_s * t, vw_m_s: vw_m_s.iter().map(|x| x * v).collect() }
            }
            TunnelSpeed::Operator(o) => TunnelSpeed::Operator(Operator {
                trim_m_s: o.trim_m_s.map(|x| x * v),
                height_gain_per_s: o.height_gain_per_s / t,
                rate_gain: o.rate_gain,
                integral_gain_per_s2: o.integral_gain_per_s2 / (t * t),
                lag_s: o.lag_s * t,
                unsteady_rms_m_s: o.unsteady_rms_m_s * v,
                unsteady_time_s: o.unsteady_time_s * t,
                hold_x_m: o.hold_x_m * self.length,
            }),
        }
    }
}
