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
}

/// Dynamic pressure ½ρV², Pa (thesis eq. B.44).
#[must_use]
#[inline]
pub fn dynamic_pressure_pa(density_kg_m3: f64, speed_m_s: f64) -> f64 {
    0.5 * density_kg_m3 * speed_m_s * speed_m_s
}
