//! model: air and gravity. In: static pressure and temperature. Out: density and dynamic pressure.

/// Surroundings that the record does not carry.
///
/// ```
/// use windfall_model::{Environment, dynamic_pressure_pa};
///
/// // Dry air at sea level of the US Standard Atmosphere 1976: 1.225 kg/m³; at 7.5 m/s 34.45 Pa.
/// let tunnel = Environment { gravity_m_s2: 9.80665, gas_constant_j_kg_k: 287.05287 };
/// let density = tunnel.density_kg_m3(101_325.0, 288.15);
/// assert!((density - 1.225).abs() < 1e-6);
/// assert!((dynamic_pressure_pa(density, 7.5) - 34.453_125).abs() < 1e-4);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Environment {
    /// Acceleration of gravity, m/s², along tunnel +X.
    pub gravity_m_s2: f64,
    /// Specific gas constant of the tunnel's gas, J/(kg K); 287.05287 for dry air (ICAO 1993).
    pub gas_constant_j_kg_k: f64,
}

impl Environment {
    /// Density of an ideal gas, kg/m³, from static pressure in Pa and static temperature in K (both positive).
    #[must_use]
    pub fn density_kg_m3(&self, pressure_pa: f64, temperature_k: f64) -> f64 {
        pressure_pa / (self.gas_constant_j_kg_k * temperature_k)
    }
    /// Dynamic viscosity, Pa s, at a static temperature in K (positive), where the gas is air by its gas constant; none of another gas.
    #[must_use]
    pub fn viscosity_pa_s(&self, temperature_k: f64) -> Option<f64> {
        let is_air = (self.gas_constant_j_kg_k / DRY_AIR_J_KG_K - 1.0).abs() < MOIST;
        is_air.then(|| air_viscosity_pa_s(temperature_k))
    }
}

/// Specific gas constant of dry air, J/(kg K) (ICAO 1993).
const DRY_AIR_J_KG_K: f64 = 287.05287;

/// Share by which the gas constant of air may depart from that of dry air; derived: moist air at 40 °C has up to 1.8 % more, nitrogen 3.4 %.
const MOIST: f64 = 0.02;

/// Dynamic viscosity of air, Pa s, at a temperature in K (positive): Sutherland's formula with the constants of the US Standard Atmosphere
/// 1976, eq. 51. The standard uses it from 187 to 288 K. Pressure does not matter there.
///
/// ```
/// // The standard's table at 0 and 11 km.
/// assert!((windfall_model::air_viscosity_pa_s(288.15) - 1.7894e-5).abs() < 5e-10);
/// assert!((windfall_model::air_viscosity_pa_s(216.65) - 1.4216e-5).abs() < 5e-10);
/// ```
#[must_use]
pub fn air_viscosity_pa_s(temperature_k: f64) -> f64 {
    1.458e-6 * temperature_k * temperature_k.sqrt() / (temperature_k + 110.4)
}

/// Dynamic pressure ½ρV², Pa (thesis eq. B.44).
#[must_use]
#[inline]
pub fn dynamic_pressure_pa(density_kg_m3: f64, speed_m_s: f64) -> f64 {
    0.5 * density_kg_m3 * speed_m_s * speed_m_s
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Dry and moist air are air; nitrogen (296.8), carbon dioxide (188.9) and helium (2077 J/(kg K)) have no viscosity here.
    #[test]
    fn law_viscosity_is_of_air_alone() {
        let of = |gas_constant_j_kg_k| Environment { gravity_m_s2: 9.81, gas_constant_j_kg_k }.viscosity_pa_s(300.0);
        for (gas, is_air) in
            [(287.05287, true), (290.0, true), (296.8, false), (188.9, false), (2077.0, false), (f64::NAN, false)]
        {
            assert_eq!(of(gas).is_some(), is_air, "{gas}");
        }
    }
}
