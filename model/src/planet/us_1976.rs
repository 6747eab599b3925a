//! model: the US Standard Atmosphere 1976. In: geometric height. Out: state of the air.
//!
//! Source: U.S. Standard Atmosphere, 1976 (NOAA-S/T 76-1562): constants of Table 2, layers of Table 4, eqs 18, 23, 33a, 33b. Up to
//! 86 km, where mean molecular weight is that at sea level to 4e-4; above 80 km the temperature given is the molecular-scale one.

use super::Air;

/// Effective radius for geopotential height, m.
const RADIUS_M: f64 = 6_356_766.0;
/// Gravity at sea level, m/s².
const GRAVITY_M_S2: f64 = 9.806_65;
/// Gas constant over molecular weight at sea level, `8314.32 / 28.9644` J/(kg K).
const GAS_CONSTANT: f64 = 8314.32 / 28.9644;
/// Temperature (K) and pressure (Pa) at sea level.
const SEA_LEVEL: [f64; 2] = [288.15, 101_325.0];
/// Geopotential height of each layer's base, m, and its lapse rate, K/m.
const LAYERS: [[f64; 2]; 7] =
    [[0.0, -6.5e-3], [11e3, 0.0], [20e3, 1e-3], [32e3, 2.8e-3], [47e3, 0.0], [51e3, -2.8e-3], [71e3, -2e-3]];

/// Geometric heights of the standard's tables that are covered here, m.
pub(super) const RANGE_M: [f64; 2] = [-5e3, 86e3];

/// The air at a geometric height, m.
pub(super) fn air(height_m: f64) -> Air {
    let geopotential_m = RADIUS_M * height_m / (RADIUS_M + height_m);
    let [mut temperature_k, mut pressure_pa] = SEA_LEVEL;
    for (i, [base_m, lapse]) in LAYERS.into_iter().enumerate() {
        let top_m = LAYERS.get(i + 1).map_or(f64::INFINITY, |l| l[0]);
        let rise_m = geopotential_m.min(top_m) - base_m;
        let next_k = temperature_k + lapse * rise_m;
        pressure_pa *= if lapse == 0.0 {
            (-GRAVITY_M_S2 * rise_m / (GAS_CONSTANT * temperature_k)).exp()
        } else {
            (temperature_k / next_k).powf(GRAVITY_M_S2 / (GAS_CONSTANT * lapse))
        };
        temperature_k = next_k;
        if geopotential_m <= top_m {
            break;
        }
    }
    Air { pressure_pa, temperature_k, gas_constant_j_kg_k: GAS_CONSTANT }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn geometric_m(geopotential_m: f64) -> f64 {
        RADIUS_M * geopotential_m / (RADIUS_M - geopotential_m)
    }

    /// Base pressures of the layers as the standard gives them, Pa, at geopotential heights; bound: 1e-6, the printed digits.
    #[test]
    fn pub_base_pressures_of_the_layers() {
        for (km, kelvin, pascal) in [
            (0.0, 288.15, 101_325.0),
            (11.0, 216.65, 22_632.06),
            (20.0, 216.65, 5_474.889),
            (32.0, 228.65, 868.018_7),
            (47.0, 270.65, 110.906_3),
            (51.0, 270.65, 66.938_87),
            (71.0, 214.65, 3.956_420),
        ] {
            let air = air(geometric_m(km * 1e3));
            assert!((air.pressure_pa / pascal - 1.0).abs() < 1e-6, "{km} km: {} Pa", air.pressure_pa);
            assert!((air.temperature_k - kelvin).abs() < 1e-9, "{km} km: {} K", air.temperature_k);
        }
    }

    /// Table 1 of the standard at geometric heights: temperature to three decimals, pressure and density to five digits; bound: half
    /// the last digit.
    #[test]
    fn pub_table_over_geometric_height() {
        for (m, kelvin, pascal, density) in [
            (-1e3, 294.651, 1.1393e5, 1.3470),
            (1e3, 281.651, 8.9876e4, 1.1117),
            (5e3, 255.676, 5.4048e4, 7.3643e-1),
            (1e4, 223.252, 2.6500e4, 4.1351e-1),
            (2e4, 216.650, 5.5293e3, 8.8910e-2),
            (3e4, 226.509, 1.1970e3, 1.8410e-2),
            (4e4, 250.350, 2.8714e2, 3.9957e-3),
            (5e4, 270.650, 7.9779e1, 1.0269e-3),
        ] {
            let air = air(m);
            let half = |printed: f64| 0.5 * 10_f64.powf(printed.log10().floor() - 4.0) * (1.0 + 1e-9);
            assert!((air.temperature_k - kelvin).abs() < 5.1e-4, "{m} m: {} K", air.temperature_k);
            assert!((air.pressure_pa - pascal).abs() <= half(pascal), "{m} m: {} Pa", air.pressure_pa);
            assert!((air.density_kg_m3() - density).abs() <= half(density), "{m} m: {} kg/m³", air.density_kg_m3());
        }
    }

    /// NASA/TM-2015-218675, check case 4, simulation 4: the air at 30 000 ft. Bounds: its pressure and density do not give one gas
    /// constant to better than 1e-5, so that one of its constants is cut there.
    #[test]
    fn pub_air_of_nesc_case_4() {
        let air = air(9144.0);
        assert!((air.temperature_k - 228.799_373_934).abs() < 1e-8);
        assert!((air.pressure_pa / 30_148.940_285_8 - 1.0).abs() < 1e-5, "{}", air.pressure_pa);
        assert!((air.density_kg_m3() / 0.459_040_415_405 - 1.0).abs() < 1e-6, "{}", air.density_kg_m3());
    }
}
