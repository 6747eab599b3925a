//! model: Froude scaling between full scale and model (thesis §2.1.2, Table 2.2). In: length and density ratios. Out: scaled plant and flight.

use crate::aero::{Aero, Factor};
use crate::air::Environment;
use crate::disturbance::Turbulence;
use crate::flow::{MeanFlow, Variable};
use crate::plant::{Contact, Plant};
use crate::point::PointMass;
use crate::scenario::{Flight, Operator, Release, TestSection, TunnelSpeed};
use crate::sensors::Sensors;
use crate::tether::Tether;
use crate::vehicle::{ApparentMass, Inertia, LooseMass, Vehicle};

/// Ratios full scale over model that keep Froude number V²/(g L), mass ratio m/(ρ L³) and inertia ratio I/(ρ L⁵).
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
    /// A plant scaled from model to full scale (ratios below one: the other way): every number with a dimension of length,
    /// time or mass, so that the scaled flight is the same in dimensionless numbers. Coefficients, angles and settings stay;
    /// terms in airspeed keep their value at the scaled speed.
    #[must_use]
    pub fn plant(&self, p: &Plant) -> Plant {
        Plant {
            vehicle: self.vehicle(&p.vehicle),
            aero: self.aero(&p.aero),
            tether: p.tether.as_ref().map(|t| self.tether(t)),
            flow: self.flow(&p.flow),
            turbulence: Turbulence {
                axial_rms_m_s: p.turbulence.axial_rms_m_s * self.speed(),
                lateral_rms_m_s: p.turbulence.lateral_rms_m_s * self.speed(),
                axial_scale_m: p.turbulence.axial_scale_m * self.length,
                lateral_scale_m: p.turbulence.lateral_scale_m * self.length,
            },
            shedding: p.shedding,
            contacts: p.contacts.iter().map(|c| self.contact(c)).collect(),
            environment: Environment { gravity_m_s2: p.environment.gravity_m_s2 * self.gravity, ..p.environment },
            sensors: self.sensors(&p.sensors),
            point: PointMass {
                acceleration: p.point.acceleration * self.gravity,
                air_density_kg_m3: p.point.air_density_kg_m3 * self.density,
                ..p.point.clone()
            },
        }
    }

    /// A flight scaled as [`FroudeScale::plant`]; the density ratio goes into the static pressure.
    #[must_use]
    pub fn flight(&self, f: &Flight) -> Flight {
        let (l, t, v) = (self.length, self.time(), self.speed());
        Flight {
            name: f.name.clone(),
            kind: f.kind.clone(),
            hold_out: f.hold_out,
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
        }
    }

    fn vehicle(&self, v: &Vehicle) -> Vehicle {
        let k = self.inertia();
        let Inertia { xx, yy, zz, xy, xz, yz } = v.inertia;
        Vehicle {
            mass_kg: v.mass_kg * self.mass(),
            inertia: Inertia { xx: xx * k, yy: yy * k, zz: zz * k, xy: xy * k, xz: xz * k, yz: yz * k },
            p_origin_cm: v.p_origin_cm * self.length,
            diameter_m: v.diameter_m * self.length,
            apparent: ApparentMass {
                axial_kg: v.apparent.axial_kg * self.mass(),
                radial_kg: v.apparent.radial_kg * self.mass(),
                transverse_kg_m2: v.apparent.transverse_kg_m2 * k,
            },
            loose: v.loose.map(|m| LooseMass {
                mass_kg: m.mass_kg * self.mass(),
                frequency_hz: m.frequency_hz / self.time(),
                damping_ratio: m.damping_ratio,
                x_cm_m: m.x_cm_m * self.length,
            }),
        }
    }

    fn aero(&self, a: &Aero) -> Aero {
        let mut scaled = a.clone();
        let own = scaled.structure.contributions.iter_mut().map(|c| &mut c.term);
        for term in own.chain(scaled.extra.iter_mut().map(|(_, _, term)| term)) {
            for factor in &mut term.factors {
                match factor {
                    Factor::Power(Variable::Speed, n) => term.scale /= self.speed().powi(i32::from(*n)),
                    Factor::Bump(Variable::Speed, width) => *width *= self.speed(),
                    _ => {}
                }
            }
        }
        scaled
    }

    fn tether(&self, t: &Tether) -> Tether {
        Tether {
            p_origin_hook: t.p_origin_hook * self.length,
            p_tunnel_ring: t.p_tunnel_ring * self.length,
            drag_area_m2: t.drag_area_m2 * self.area(),
            weight_n: t.weight_n * self.force(),
            line_rate_n_s_m: t.line_rate_n_s_m * self.force() / self.speed(),
            length_per_m: t.length_per_m / self.length,
            pull_excess: t.pull_excess,
            ring_shift_m: t.ring_shift_m.map(|x| x * self.length),
        }
    }

    fn flow(&self, f: &MeanFlow) -> MeanFlow {
        MeanFlow {
            profile_per_m2: f.profile_per_m2 / self.area(),
            gradient_per_m: f.gradient_per_m.map(|g| g / self.length),
            swirl_rad_per_m: f.swirl_rad_per_m / self.length,
            angularity_rad: f.angularity_rad,
        }
    }

    fn contact(&self, c: &Contact) -> Contact {
        let impulse = self.force() * self.time();
        Contact {
            run: c.run,
            start_s: c.start_s * self.time(),
            duration_s: c.duration_s * self.time(),
            impulse: c.impulse * impulse,
            angular_impulse: c.angular_impulse * (impulse * self.length),
        }
    }

    fn sensors(&self, s: &Sensors) -> Sensors {
        Sensors {
            position_std_m: s.position_std_m * self.length,
            wind_std_m_s: s.wind_std_m_s * self.speed(),
            wind_delay_s: s.wind_delay_s * self.time(),
            pose_delay_s: s.pose_delay_s * self.time(),
            ..*s
        }
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
