//! sim: air and wind over height as a table. In: a planet. Out: density, wind and its change with height at a price of a few additions.

use windfall_model::planet::Planet;

/// Distance of rows, m. Density between rows is linear: with a scale height of 5 km or more its error is below `step²/8H² = 5e-7`.
const STEP_M: f64 = 10.0;

/// Density (kg/m³) and wind toward north and east (m/s) at equal steps of height.
#[derive(Debug)]
pub(super) struct Profile {
    low_m: f64,
    rows: Vec<[f64; 3]>,
}

/// The air at one height.
#[derive(Clone, Copy, Debug)]
pub(super) struct AirAt {
    pub(super) density_kg_m3: f64,
    /// Wind toward north and east, m/s.
    pub(super) wind: [f64; 2],
    /// Its change with height, 1/s.
    pub(super) shear: [f64; 2],
}

impl Profile {
    /// From just below the ground to `top_m`.
    pub(super) fn new(planet: &Planet, top_m: f64) -> Self {
        let low_m = -2.0 * STEP_M;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "heights are checked positive and below 1e8 m"
        )]
        let n = ((top_m - low_m) / STEP_M).ceil() as usize + 2;
        let row = |i: usize| {
            let height_m = low_m + STEP_M * i as f64;
            let (wind, _) = planet.wind.at(height_m);
            [planet.atmosphere.as_ref().map_or(0.0, |a| a.at(height_m).density_kg_m3()), wind.x(), wind.y()]
        };
        Self { low_m, rows: (0..n).map(row).collect() }
    }
    #[inline]
    pub(super) fn at(&self, height_m: f64) -> AirAt {
        let place = ((height_m - self.low_m) / STEP_M).clamp(0.0, (self.rows.len() - 2) as f64);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to the table")]
        let i = (place as usize).min(self.rows.len() - 2);
        let part = place - i as f64;
        let (a, b) = (self.rows[i], self.rows[i + 1]);
        let d = [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
        AirAt {
            density_kg_m3: a[0] + part * d[0],
            wind: [a[1] + part * d[1], a[2] + part * d[2]],
            shear: [d[1] / STEP_M, d[2] / STEP_M],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use windfall_model::planet::{Atmosphere, Gravity, Spheroid, WindTable, Winds};

    /// Density to the bound of [`STEP_M`] (scale height of Venus' lower air 9 km at least, and kinks at its rows), wind to round-off.
    #[test]
    fn law_the_table_is_the_planet() {
        let planet = Planet {
            figure: Spheroid { equatorial_radius_m: 6_051_800.0, flattening: 0.0 },
            rotation_rad_s: 0.0,
            gravity: Gravity::Uniform { gravity_m_s2: 8.87 },
            atmosphere: Some(Atmosphere::Venus),
            wind: Winds::Table(WindTable::new(vec![[0.0, 0.0, -1.0], [5e3, 2.0, -3.0], [1e4, 2.0, -8.0]]).expect("ascends")),
        };
        let profile = Profile::new(&planet, 20_000.0);
        for k in 0..400 {
            let h = 50.03 * f64::from(k);
            let (at, density) = (profile.at(h), planet.atmosphere.as_ref().expect("Venus").at(h).density_kg_m3());
            let (wind, shear) = planet.wind.at(h);
            assert!((at.density_kg_m3 / density - 1.0).abs() < 5e-7, "{h}: {}", at.density_kg_m3 / density - 1.0);
            assert!((at.wind[0] - wind.x()).abs() < 1e-11 && (at.wind[1] - wind.y()).abs() < 1e-11, "{h}");
            let beside_a_row = (h % 5e3) < STEP_M || (h % 5e3) > 5e3 - STEP_M;
            assert!(beside_a_row || (at.shear[1] - shear.y()).abs() < 1e-13, "{h}");
        }
        // Held beyond its ends.
        let (top, far) = (profile.at(20_000.0), profile.at(1e6));
        assert!((far.density_kg_m3 / top.density_kg_m3 - 1.0).abs() < 1e-12, "{far:?} {top:?}");
    }
}
