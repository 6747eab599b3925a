//! model: air and gravity. In: static pressure and temperature. Out: density and dynamic pressure.

/// Surroundings that the record does not carry.
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
