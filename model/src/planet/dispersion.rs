//! model: what differs from one descent to the next. In: checked numbers of a scenario file. Out: gusts over height, scatter of the start,
//! uncertainty of the body.

use crate::disturbance::Turbulence;
use crate::vehicle::{Inertia, Vehicle};

/// Gusts over height, one row or more, heights ascending: along the flight's vertical and across it. Between rows linear, beyond them held.
#[derive(Clone, Debug, PartialEq)]
pub struct GustProfile {
    rows: Vec<(f64, Turbulence)>,
}

impl GustProfile {
    /// Gusts that are the same at all heights; `None` as for [`GustProfile::new`].
    #[must_use]
    pub fn steady(turbulence: Turbulence) -> Option<Self> {
        Self::new(vec![(0.0, turbulence)])
    }
    /// Rows of height (m) and gusts; `None` without rows, for a number that is not finite, an rms below zero, a scale that is not above
    /// zero, or heights that do not ascend.
    #[must_use]
    pub fn new(rows: Vec<(f64, Turbulence)>) -> Option<Self> {
        let good = |(h, t): &(f64, Turbulence)| {
            let (rms, scales) = ([t.axial_rms_m_s, t.lateral_rms_m_s], [t.axial_scale_m, t.lateral_scale_m]);
            h.is_finite() && rms.iter().all(|x| x.is_finite() && *x >= 0.0) && scales.iter().all(|x| x.is_finite() && *x > 0.0)
        };
        (!rows.is_empty() && rows.iter().all(good) && rows.windows(2).all(|w| w[0].0 < w[1].0)).then_some(Self { rows })
    }
    /// Height (m) and gusts.
    #[must_use]
    pub fn rows(&self) -> &[(f64, Turbulence)] {
        &self.rows
    }
    /// Gusts at a height, m.
    #[must_use]
    pub fn at(&self, height_m: f64) -> Turbulence {
        let above = self.rows.partition_point(|r| r.0 <= height_m);
        let (Some(before), Some(after)) = (above.checked_sub(1).map(|i| &self.rows[i]), self.rows.get(above)) else {
            return self.rows[above.min(self.rows.len() - 1)].1;
        };
        let part = (height_m - before.0) / (after.0 - before.0);
        let between = |of: fn(&Turbulence) -> f64| of(&before.1) + part * (of(&after.1) - of(&before.1));
        Turbulence {
            axial_rms_m_s: between(|t| t.axial_rms_m_s),
            lateral_rms_m_s: between(|t| t.lateral_rms_m_s),
            axial_scale_m: between(|t| t.axial_scale_m),
            lateral_scale_m: between(|t| t.lateral_scale_m),
            bandwidth: 0.0,
        }
    }
    /// Shortest scale of all rows, m.
    #[must_use]
    pub fn shortest_scale_m(&self) -> f64 {
        self.rows.iter().flat_map(|(_, t)| [t.axial_scale_m, t.lateral_scale_m]).fold(f64::INFINITY, f64::min)
    }
}

/// Standard deviations of the state at the first sample, independent of each other; zero is exact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StartDispersion {
    /// Velocity over the ground toward north, east, down, m/s.
    pub velocity_ned_m_s: [f64; 3],
    /// Turn of the body about its own axes x, y, z, rad.
    pub attitude_body_rad: [f64; 3],
    /// Body rates p, q, r, rad/s.
    pub rates_rad_s: [f64; 3],
}

impl StartDispersion {
    /// True when the start is exact.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        let Self { velocity_ned_m_s, attitude_body_rad, rates_rad_s } = self;
        [velocity_ned_m_s, attitude_body_rad, rates_rad_s].into_iter().flatten().all(|x| *x <= 0.0)
    }
}

/// Standard uncertainties of the mass side; zero is exact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct VehicleDispersion {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Moments and products of inertia, kg m².
    pub inertia: Inertia,
    /// c.m. from the geometric origin, body axes, m.
    pub center_of_mass_m: [f64; 3],
}

/// Place of a number in a vehicle.
pub type VehicleLens = fn(&mut Vehicle) -> &mut f64;

/// A number of a vehicle that is uncertain.
#[derive(Clone, Copy, Debug)]
pub struct UncertainNumber {
    /// Its key in files with its component.
    pub name: &'static str,
    /// Standard uncertainty, SI, above zero.
    pub std: f64,
    /// Its place in a vehicle.
    pub lens: VehicleLens,
}

impl VehicleDispersion {
    /// The numbers that are uncertain.
    #[must_use]
    pub fn numbers(&self) -> Vec<UncertainNumber> {
        let (i, [x, y, z]) = (&self.inertia, self.center_of_mass_m);
        let all: [(&'static str, f64, VehicleLens); 10] = [
            ("vehicle.mass_kg", self.mass_kg, |v| &mut v.mass_kg),
            ("vehicle.inertia_kg_m2.xx", i.xx, |v| &mut v.inertia.xx),
            ("vehicle.inertia_kg_m2.yy", i.yy, |v| &mut v.inertia.yy),
            ("vehicle.inertia_kg_m2.zz", i.zz, |v| &mut v.inertia.zz),
            ("vehicle.inertia_kg_m2.xy", i.xy, |v| &mut v.inertia.xy),
            ("vehicle.inertia_kg_m2.xz", i.xz, |v| &mut v.inertia.xz),
            ("vehicle.inertia_kg_m2.yz", i.yz, |v| &mut v.inertia.yz),
            ("vehicle.center_of_mass_m.x", x, |v| &mut v.p_origin_cm.xyz.x),
            ("vehicle.center_of_mass_m.y", y, |v| &mut v.p_origin_cm.xyz.y),
            ("vehicle.center_of_mass_m.z", z, |v| &mut v.p_origin_cm.xyz.z),
        ];
        let uncertain = all.into_iter().filter(|(_, std, _)| *std > 0.0);
        uncertain.map(|(name, std, lens)| UncertainNumber { name, std, lens }).collect()
    }
}

/// What differs from one descent to the next besides the aerodynamics. Nothing by default.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Dispersions {
    /// Gusts; none for air that flows evenly.
    pub gusts: Option<GustProfile>,
    /// Scatter of the start.
    pub start: StartDispersion,
    /// Uncertainty of the mass side.
    pub vehicle: VehicleDispersion,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_gusts_are_linear_between_rows_and_held_beyond() {
        let row = |h: f64, x: f64| {
            (
                h,
                Turbulence {
                    axial_rms_m_s: x,
                    lateral_rms_m_s: 2.0 * x,
                    axial_scale_m: 10.0 * x,
                    lateral_scale_m: 20.0 * x,
                    bandwidth: 0.0,
                },
            )
        };
        let gusts = GustProfile::new(vec![row(0.0, 1.0), row(1e3, 3.0)]).expect("ascends");
        for (h, x) in [(-1.0, 1.0), (0.0, 1.0), (250.0, 1.5), (1e3, 3.0), (1e4, 3.0)] {
            assert_eq!(gusts.at(h), row(h, x).1, "{h}");
        }
        assert!(
            GustProfile::new(vec![row(1.0, 1.0), row(1.0, 1.0)]).is_none() && GustProfile::steady(row(0.0, -1.0).1).is_none()
        );
    }

    #[test]
    fn law_a_number_is_its_own_place_in_the_vehicle() {
        let one = VehicleDispersion {
            mass_kg: 1.0,
            inertia: Inertia { xx: 2.0, yy: 3.0, zz: 4.0, xy: 5.0, xz: 6.0, yz: 7.0 },
            center_of_mass_m: [8.0, 9.0, 10.0],
        };
        let mut vehicle = Vehicle {
            mass_kg: 0.0,
            inertia: Inertia::default(),
            p_origin_cm: crate::frames::Vec3::zero(),
            diameter_m: 0.0,
            apparent: crate::vehicle::ApparentMass::default(),
            loose: None,
        };
        for n in one.numbers() {
            *(n.lens)(&mut vehicle) = n.std;
        }
        assert!((vehicle.mass_kg - 1.0).abs() < f64::EPSILON && vehicle.inertia == one.inertia);
        assert!(vehicle.p_origin_cm == crate::frames::Vec3::from_array(one.center_of_mass_m));
        assert!(VehicleDispersion::default().numbers().is_empty());
    }
}
